//! Which edits belong together: all between a press and a release, all of one burst of scrolling.

use egui::Event;

/// Scrolling that rests this long has ended, in seconds.
const REST_SECS: f64 = 0.4;

/// A number that stays the same during one motion of the hand. Edits of one number are one step of
/// undo.
#[derive(Clone, Debug, Default)]
pub(super) struct Gesture {
    id: u64,
    last_scroll: f64,
    /// A button was let go: the last edit of its drag comes in the same frame, the next motion
    /// begins after it.
    released: bool,
    /// It began while a menu was open: its click closes that and does nothing else.
    closes_menu: bool,
}

impl Gesture {
    /// Looks at the input of a new frame.
    pub(super) fn update(&mut self, ctx: &egui::Context) {
        if std::mem::take(&mut self.released) {
            self.next();
        }
        let (time, scrolled, begins) = ctx.input(|input| {
            self.released = input.pointer.any_released();
            let begins = input.events.iter().any(|event| match event {
                Event::PointerButton { pressed, .. } => *pressed,
                Event::AccessKitActionRequest(_) => true,
                // A key that is held repeats: flying and nudging are one motion.
                Event::Key { pressed, repeat, .. } => *pressed && !*repeat,
                _ => false,
            });
            let scrolled = input
                .events
                .iter()
                .any(|event| matches!(event, Event::MouseWheel { .. } | Event::Zoom(_)));
            (input.time, scrolled, begins)
        });
        let scroll_begins = scrolled && REST_SECS < time - self.last_scroll;
        if scrolled {
            self.last_scroll = time;
        }
        if begins || scroll_begins {
            self.closes_menu = egui::Popup::is_any_open(ctx);
            self.next();
        }
    }

    /// Whether a click of this motion only closes an open menu.
    pub(super) fn closes_menu(&self) -> bool {
        self.closes_menu
    }

    /// Ends the motion: what follows is a step of its own.
    pub(super) fn next(&mut self) {
        self.id += 1;
    }

    /// The number of this motion.
    pub(super) fn id(&self) -> u64 {
        self.id
    }
}
