//! Short messages at the foot of the picture: saves that pass by, errors that stay until read.

use super::theme;
use egui::{Align2, Id, RichText, Vec2};
use std::time::Duration;

/// How long a message that needs no answer stays.
const SHOWN_FOR: Duration = Duration::from_secs(6);
/// How long a hint stays, which has to be read beside a picture that is new.
const HINT_SHOWN_FOR: Duration = Duration::from_secs(20);
/// More than this at once would hide the picture. What passes by makes room; errors wait unseen
/// until newer ones are closed.
const MOST: usize = 4;
/// A message is broken into lines of at most this width, in points.
const TEXT_WIDTH: f32 = 440.0;

/// The messages on show, oldest first.
#[derive(Debug, Default)]
pub(super) struct Toasts {
    shown: Vec<Toast>,
    n_ever: u64,
    last_time: f64,
}

#[derive(Debug)]
struct Toast {
    id: u64,
    text: String,
    kind: Kind,
    left: Duration,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Goes by itself.
    Passing,
    /// Stays until it is closed.
    Warning,
    /// Stays until it is closed, and stands out.
    Error,
}

impl Toasts {
    /// Says something that passes by.
    pub(super) fn say(&mut self, text: impl Into<String>) {
        self.push(text.into(), Kind::Passing, SHOWN_FOR);
    }

    /// Says something that passes by, in place of what was said with the same beginning.
    pub(super) fn say_anew(&mut self, beginning: &str, rest: &str) {
        let is_old =
            |toast: &Toast| toast.kind == Kind::Passing && toast.text.starts_with(beginning);
        self.shown.retain(|toast| !is_old(toast));
        self.say(format!("{beginning}{rest}"));
    }

    /// Says something that passes by slowly.
    pub(super) fn hint(&mut self, text: impl Into<String>) {
        self.push(text.into(), Kind::Passing, HINT_SHOWN_FOR);
    }

    /// Says what went wrong; stays until it is closed.
    pub(super) fn fail(&mut self, text: impl Into<String>) {
        self.push(text.into(), Kind::Error, SHOWN_FOR);
    }

    /// Says what was not as it should be; stays until it is closed.
    pub(super) fn warn(&mut self, text: impl Into<String>) {
        self.push(text.into(), Kind::Warning, SHOWN_FOR);
    }

    /// Takes back what was said, where it is still there: it is so no longer.
    pub(super) fn settle(&mut self, said: &mut Option<String>) {
        if let Some(text) = said.take() {
            self.shown.retain(|toast| toast.text != text);
        }
    }

    /// Closes the newest message. False where there was none.
    pub(super) fn dismiss(&mut self) -> bool {
        self.shown.pop().is_some()
    }

    /// Shows the messages above `bottom_center` and lets time pass for them.
    pub(super) fn show(&mut self, ctx: &egui::Context, bottom_center: egui::Pos2) {
        let now = ctx.input(|input| input.time);
        let passed = Duration::from_secs_f64((now - self.last_time).clamp(0.0, 1.0));
        self.last_time = now;
        let mut closed = Vec::new();
        let mut above = 0.0;
        for toast in self.shown.iter_mut().rev().take(MOST) {
            // What passes by is in nobody's way: the hand goes through it to the picture.
            let area = egui::Area::new(Id::unique(("toast", toast.id)))
                .order(egui::Order::Foreground)
                .interactable(toast.kind != Kind::Passing)
                .pivot(Align2::CENTER_BOTTOM)
                .fixed_pos(bottom_center - Vec2::new(0.0, above))
                .show(ctx, |ui| toast_ui(ui, toast));
            above += area.response.rect.height() + 8.0;
            if toast.kind == Kind::Passing {
                toast.left = toast.left.saturating_sub(passed);
            }
            if area.inner || toast.left.is_zero() {
                closed.push(toast.id);
            }
        }
        self.shown.retain(|toast| !closed.contains(&toast.id));
        if self.shown.iter().any(|toast| toast.kind == Kind::Passing) {
            ctx.request_repaint_after(Duration::from_millis(200));
        }
    }

    fn push(&mut self, text: String, kind: Kind, left: Duration) {
        self.shown.retain(|toast| toast.text != text);
        self.n_ever += 1;
        self.shown.push(Toast { id: self.n_ever, text, kind, left });
        while MOST < self.shown.len() {
            let oldest = self.shown.iter().position(|toast| toast.kind == Kind::Passing);
            match oldest {
                Some(oldest) => self.shown.remove(oldest),
                None => break,
            };
        }
    }
}

/// One message; gives back whether it was closed.
fn toast_ui(ui: &mut egui::Ui, toast: &Toast) -> bool {
    let line = match toast.kind {
        Kind::Passing => theme::hairline(ui.visuals()).color,
        Kind::Warning => theme::accent(ui.visuals()),
        Kind::Error => ui.visuals().error_fg_color,
    };
    egui::Frame::popup(ui.style())
        .inner_margin(egui::Margin::symmetric(12, 8))
        .stroke(egui::Stroke::new(1.0, line))
        .show(ui, |ui| {
            ui.set_max_width(520.0);
            ui.horizontal(|ui| {
                let (text, stays) = match toast.kind {
                    Kind::Passing => (RichText::new(&toast.text), false),
                    Kind::Warning => (RichText::new(&toast.text), true),
                    Kind::Error => (RichText::new(&toast.text).strong(), true),
                };
                ui.scope(|ui| {
                    ui.set_max_width(TEXT_WIDTH);
                    ui.add(egui::Label::new(text).wrap().selectable(stays));
                });
                stays && ui.button("Close").on_hover_text("closes this message (Esc)").clicked()
            })
            .inner
        })
        .inner
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_shown_once_and_the_oldest_make_room() {
        let mut toasts = Toasts::default();
        for text in ["a", "b", "b"] {
            toasts.say(text);
        }
        assert_eq!(toasts.shown.len(), 2, "the same is said twice");
        for text in ["c", "d", "e"] {
            toasts.say(text);
        }
        let texts: Vec<&str> = toasts.shown.iter().map(|toast| toast.text.as_str()).collect();
        assert_eq!(texts, ["b", "c", "d", "e"], "other messages are shown");
    }

    #[test]
    fn what_is_said_anew_takes_the_place_of_what_was_said() {
        let mut toasts = Toasts::default();
        toasts.fail("text at fault");
        for percent in ["110 %", "120 %"] {
            toasts.say_anew("text at ", percent);
        }
        let texts: Vec<&str> = toasts.shown.iter().map(|toast| toast.text.as_str()).collect();
        assert_eq!(texts, ["text at fault", "text at 120 %"], "other messages are shown");
    }

    #[test]
    fn what_passes_by_makes_room_for_errors_and_errors_for_nothing() {
        let mut toasts = Toasts::default();
        toasts.say("passing");
        for text in ["a", "b", "c", "d", "e"] {
            toasts.fail(text);
        }
        toasts.say("too late");
        let texts: Vec<&str> = toasts.shown.iter().map(|toast| toast.text.as_str()).collect();
        assert_eq!(texts, ["a", "b", "c", "d", "e"], "an error is lost");
    }
}
