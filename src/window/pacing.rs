//! Input for the interface, dealt out so that nothing of it is lost however long a frame takes.
//!
//! The interface looks at the cursor once a frame: of a press, a motion and a release that come
//! together it would see no drag, and of a press and a motion another place than was pressed.

use egui::Event;
use std::collections::VecDeque;

/// Events that wait for a later frame.
#[derive(Debug, Default)]
pub(super) struct Pacing {
    waiting: VecDeque<Event>,
}

impl Pacing {
    /// Leaves in `events` what the next frame is to see: motions, then a button that is pressed, let
    /// go or clicked. What comes behind a button waits, and so does its release behind a motion.
    pub(super) fn pace(&mut self, events: &mut Vec<Event>) {
        self.waiting.extend(events.drain(..));
        let (mut has_moved, mut has_pressed, mut has_released) = (false, false, false);
        while let Some(event) = self.waiting.front() {
            let waits = match event {
                Event::PointerButton { pressed: false, .. } => has_moved || has_released,
                _ => has_pressed || has_released,
            };
            if waits {
                break;
            }
            match event {
                Event::PointerMoved(_) => has_moved = true,
                Event::PointerButton { pressed: true, .. } => {
                    (has_moved, has_pressed) = (false, true);
                }
                Event::PointerButton { pressed: false, .. } => has_released = true,
                _ => {}
            }
            events.extend(self.waiting.pop_front());
        }
    }

    /// Whether another frame is needed at once.
    pub(super) fn is_waiting(&self) -> bool {
        !self.waiting.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, PointerButton, Pos2, Rect, Sense, Vec2, pos2, vec2};

    fn button(pos: Pos2, pressed: bool) -> Event {
        let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
        Event::PointerButton { pos, button, pressed, modifiers }
    }

    /// Presses at `from`, moves in five steps and lets go.
    fn drag(from: Pos2, by: Vec2) -> Vec<Event> {
        let mut events = vec![Event::PointerMoved(from), button(from, true)];
        events
            .extend((1..=5_u8).map(|step| Event::PointerMoved(from + by * f32::from(step) / 5.0)));
        events.push(button(from + by, false));
        events
    }

    /// How far each half of the window was dragged, and how often it was clicked, when all events
    /// come in one frame.
    fn felt(events: Vec<Event>) -> [(Vec2, u32); 2] {
        let (ctx, mut pacing) = (egui::Context::default(), Pacing::default());
        let halves = [0.0, 100.0].map(|x| Rect::from_min_size(pos2(x, 0.0), vec2(100.0, 100.0)));
        let mut felt = [(Vec2::ZERO, 0); 2];
        let mut events = Some(events);
        // The first frame only shows where the halves are.
        for n_frame in 0..40 {
            // A second each: a click that took two frames would be none.
            let mut input = egui::RawInput {
                screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(200.0, 100.0))),
                time: Some(f64::from(n_frame)),
                ..egui::RawInput::default()
            };
            if 0 < n_frame {
                input.events = events.take().unwrap_or_default();
            }
            pacing.pace(&mut input.events);
            let mut output = ctx.run_ui(input, |ui| {
                for (index, half) in halves.iter().enumerate() {
                    let response =
                        ui.interact(*half, egui::Id::unique(index), Sense::click_and_drag());
                    felt[index].0 += response.drag_delta();
                    felt[index].1 += u32::from(response.clicked());
                }
            });
            output.textures_delta.clear();
        }
        assert!(!pacing.is_waiting(), "some of the input was never seen");
        felt
    }

    #[test]
    fn drags_within_one_frame_are_felt_whole_where_they_began() {
        let mut events = drag(pos2(90.0, 50.0), vec2(60.0, 20.0));
        events.extend(drag(pos2(90.0, 50.0), vec2(-40.0, 0.0)));
        events.extend(drag(pos2(150.0, 50.0), vec2(0.0, 30.0)));
        let expected = [(vec2(20.0, 20.0), 0), (vec2(0.0, 30.0), 0)];
        assert_eq!(felt(events), expected, "motions and clicks of both halves");
    }

    #[test]
    fn clicks_within_one_frame_are_felt_where_they_were() {
        let click = |at| [Event::PointerMoved(at), button(at, true), button(at, false)];
        let events = [pos2(50.0, 50.0), pos2(150.0, 50.0), pos2(60.0, 20.0)].map(click).concat();
        let expected = [(Vec2::ZERO, 2), (Vec2::ZERO, 1)];
        assert_eq!(felt(events), expected, "motions and clicks of both halves");
    }

    #[test]
    fn motions_alone_wait_for_nothing() {
        let mut pacing = Pacing::default();
        let moves: Vec<Event> =
            (0..9_u8).map(|x| Event::PointerMoved(pos2(f32::from(x), 0.0))).collect();
        let mut events = moves.clone();
        pacing.pace(&mut events);
        assert_eq!(events, moves, "other events");
        assert!(!pacing.is_waiting(), "motions are held back");
    }
}
