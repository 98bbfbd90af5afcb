//! What each key and each motion of the mouse does: one table that binds the keys, names them in
//! tooltips and fills the help overlay.

use super::views::View;
use egui::{Key, Modifiers};

/// Something a key, a button or a menu makes the window do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Action {
    /// Moves the camera so that the whole scene is in the picture.
    FrameAll,
    /// Back to the camera the scene was opened with.
    HomeCamera,
    /// Looks from +Z.
    ViewFront,
    /// Looks from +X.
    ViewSide,
    /// Looks from +Y.
    ViewTop,
    /// Stops refining, or goes on.
    Pause,
    /// Starts the picture again from its first sample.
    Restart,
    /// Half a stop brighter.
    Brighter,
    /// Half a stop darker.
    Darker,
    /// The next tone curve.
    NextOperator,
    /// Closes the lens, or opens it as it was.
    ToggleLens,
    /// Writes the picture on show to a file.
    Snapshot,
    /// Shows or hides the box that renders a picture of any size to a file.
    RenderPicture,
    /// Saves the scene where it came from.
    Save,
    /// Saves the scene under another name.
    SaveAs,
    /// Asks for a file to open.
    Open,
    /// Shows the start page with the gallery, or goes back to the scene.
    Gallery,
    /// Closes the scene.
    CloseScene,
    /// Puts the picture on the clipboard.
    CopyImage,
    /// Takes the last edit back.
    Undo,
    /// Makes the edit again that was taken back.
    Redo,
    /// Pins the picture to compare with, or lets it go.
    Compare,
    /// Shows the pinned picture alone, while its key is held.
    ShowPinned,
    /// Shows another view of the scene.
    Show(View),
    /// Opens or closes the magnifier.
    Loupe,
    /// Shows the panel, or hides it.
    TogglePanel,
    /// Fills the screen, or goes back to a window.
    FullScreen,
    /// Makes text and controls larger.
    LargerText,
    /// Makes text and controls smaller.
    SmallerText,
    /// Text and controls as large as the system wants them.
    UsualText,
    /// Shows or hides the list of keys.
    Help,
    /// Stops what is under way: loading, a choice, an overlay.
    Cancel,
}

impl Action {
    /// As the file of keys calls it: `frame-all`.
    pub(super) fn name(self) -> String {
        let mut name = String::new();
        for c in format!("{self:?}").chars().filter(char::is_ascii_alphanumeric) {
            if c.is_ascii_uppercase() && !name.is_empty() {
                name.push('-');
            }
            name.push(c.to_ascii_lowercase());
        }
        name
    }

    /// Whether a key that is held does it again and again.
    fn repeats(self) -> bool {
        matches!(
            self,
            Self::Brighter
                | Self::Darker
                | Self::Undo
                | Self::Redo
                | Self::LargerText
                | Self::SmallerText
        )
    }
}

/// A key with its modifiers, and what it does.
#[derive(Clone, Copy, Debug)]
pub(super) struct Binding {
    /// What happens.
    pub(super) action: Action,
    /// `COMMAND` is Ctrl, and Cmd on macOS.
    pub(super) modifiers: Modifiers,
    /// Pressed together with the modifiers.
    pub(super) key: Key,
    /// As the help overlay says it.
    pub(super) does: &'static str,
}

const COMMAND_SHIFT: Modifiers = Modifiers { shift: true, command: true, ..Modifiers::NONE };

/// One line of the help for the keys of all views.
const VIEWS: &str = "picture, albedo, normals, depth, blur, cost, samples, noise";

/// Every key the window listens to, where the file of keys says nothing else. Where one action has
/// several, the first is named in tooltips.
pub(super) const BINDINGS: &[Binding] = &[
    key(Action::FrameAll, Modifiers::NONE, Key::Home, "frame all"),
    key(Action::HomeCamera, Modifiers::NONE, Key::Backspace, "back to the scene's own camera"),
    key(Action::ViewFront, Modifiers::CTRL, Key::Num1, "front view"),
    key(Action::ViewSide, Modifiers::CTRL, Key::Num3, "side view"),
    key(Action::ViewTop, Modifiers::CTRL, Key::Num7, "top view"),
    key(Action::Pause, Modifiers::NONE, Key::Space, "pause"),
    key(Action::Restart, Modifiers::NONE, Key::R, "restart"),
    key(Action::Brighter, Modifiers::NONE, Key::E, "half a stop brighter"),
    key(Action::Darker, Modifiers::SHIFT, Key::E, "half a stop darker"),
    key(Action::NextOperator, Modifiers::NONE, Key::T, "next tone curve"),
    key(Action::ToggleLens, Modifiers::NONE, Key::D, "lens open or closed"),
    key(Action::Snapshot, Modifiers::NONE, Key::F12, "snapshot of the picture as it is"),
    key(Action::RenderPicture, Modifiers::SHIFT, Key::F12, "render a picture to a file…"),
    key(Action::Save, Modifiers::COMMAND, Key::S, "save the scene"),
    key(Action::SaveAs, COMMAND_SHIFT, Key::S, "save the scene as…"),
    key(Action::Open, Modifiers::COMMAND, Key::O, "open…"),
    key(Action::Gallery, Modifiers::COMMAND, Key::G, "gallery and recent files"),
    key(Action::CloseScene, Modifiers::COMMAND, Key::W, "close the scene"),
    key(Action::CopyImage, Modifiers::COMMAND, Key::C, "copy the picture"),
    key(Action::Undo, Modifiers::COMMAND, Key::Z, "undo"),
    key(Action::Redo, COMMAND_SHIFT, Key::Z, "redo"),
    key(Action::Redo, Modifiers::COMMAND, Key::Y, "redo"),
    key(Action::Compare, Modifiers::NONE, Key::X, "pin the picture and compare"),
    key(Action::ShowPinned, Modifiers::NONE, Key::Backtick, "hold: the pinned picture"),
    key(Action::Show(View::Picture), Modifiers::NONE, Key::Num1, VIEWS),
    key(Action::Show(View::Albedo), Modifiers::NONE, Key::Num2, VIEWS),
    key(Action::Show(View::Normals), Modifiers::NONE, Key::Num3, VIEWS),
    key(Action::Show(View::Depth), Modifiers::NONE, Key::Num4, VIEWS),
    key(Action::Show(View::Blur), Modifiers::NONE, Key::Num5, VIEWS),
    key(Action::Show(View::Cost), Modifiers::NONE, Key::Num6, VIEWS),
    key(Action::Show(View::Samples), Modifiers::NONE, Key::Num7, VIEWS),
    key(Action::Show(View::Noise), Modifiers::NONE, Key::Num8, VIEWS),
    key(Action::Loupe, Modifiers::NONE, Key::L, "loupe; hold for a look"),
    key(Action::TogglePanel, Modifiers::NONE, Key::N, "panel"),
    key(Action::FullScreen, Modifiers::NONE, Key::F11, "full screen"),
    key(Action::LargerText, Modifiers::COMMAND, Key::Plus, "larger text and controls"),
    key(Action::LargerText, Modifiers::COMMAND, Key::Equals, "larger text and controls"),
    key(Action::SmallerText, Modifiers::COMMAND, Key::Minus, "smaller text and controls"),
    key(Action::UsualText, Modifiers::COMMAND, Key::Num0, "text and controls of usual size"),
    key(Action::Help, Modifiers::NONE, Key::H, "this help"),
    key(Action::Help, Modifiers::NONE, Key::F1, "this help"),
    key(Action::Cancel, Modifiers::NONE, Key::Escape, "cancel, close; never quits"),
];

/// Motions of the mouse over the picture, and what they do: for the help overlay.
pub(super) const MOTIONS: &[(&str, &str)] = &[
    ("left drag", "orbit"),
    ("middle drag, Shift + left drag", "pan"),
    ("wheel, Ctrl + right drag", "nearer, farther"),
    ("right drag", "look about"),
    ("right drag with W A S D, Q E", "fly"),
    ("left click", "its object and material in the panel"),
    ("Ctrl + left click", "focus here"),
    ("double click", "orbit about this point"),
    ("drop a file", "open it"),
];

/// The keys in force.
#[derive(Clone, Debug)]
pub(super) struct Keys {
    /// In the order of [`BINDINGS`]; where one action has several, the first is named in tooltips.
    pub(super) bindings: Vec<Binding>,
}

impl Default for Keys {
    fn default() -> Self {
        Self { bindings: BINDINGS.to_vec() }
    }
}

impl Keys {
    /// The actions whose keys were pressed, taken out of the input. Keys alone do nothing while a
    /// field has the focus; with Ctrl they do, but for those that text fields use themselves. While
    /// the camera is `flying`, letters belong to it; Escape belongs to an open menu. A key that is
    /// held does its action once, but for those that step.
    pub(super) fn pressed(&self, ctx: &egui::Context, flying: bool) -> Vec<Action> {
        let typing = ctx.memory(|memory| memory.focused().is_some());
        let in_menu = egui::Popup::is_any_open(ctx);
        let mut actions = Vec::new();
        ctx.input_mut(|input| {
            // Those with more modifiers first: Ctrl+Shift+Z is not Ctrl+Z.
            for binding in self.most_specific_first() {
                let works_while_typing = match binding.action {
                    Action::Undo | Action::Redo | Action::CopyImage => false,
                    Action::Snapshot | Action::RenderPicture | Action::FullScreen => true,
                    _ => binding.modifiers.command,
                };
                if typing && !works_while_typing {
                    continue;
                }
                if flying && !binding.modifiers.command {
                    continue;
                }
                if in_menu && binding.action == Action::Cancel {
                    continue;
                }
                if !binding.action.repeats() {
                    input.events.retain(|event| !is_repeat(event, binding));
                }
                if is_system_copy(binding) {
                    // The system's copy arrives as an event of its own, without a key.
                    let asked = |event: &egui::Event| matches!(event, egui::Event::Copy);
                    if input.events.iter().any(asked) {
                        actions.push(binding.action);
                    }
                }
                if input.consume_key(binding.modifiers, binding.key) {
                    actions.push(binding.action);
                }
            }
        });
        actions.dedup();
        actions
    }

    /// Whether a key of an action is held down, and no field has the focus.
    pub(super) fn is_held(&self, ctx: &egui::Context, action: Action) -> bool {
        let typing = ctx.memory(|memory| memory.focused().is_some());
        let mut bindings = self.bindings.iter().filter(|binding| binding.action == action);
        !typing && ctx.input(|input| bindings.any(|binding| input.key_down(binding.key)))
    }

    /// The keys of an action as a person reads them: "Ctrl+Shift+S". Empty where it has none.
    pub(super) fn shown(&self, action: Action) -> String {
        let first = self.bindings.iter().find(|binding| binding.action == action);
        first.map_or_else(String::new, keys_of)
    }

    /// A tooltip: what the button does, and its key.
    pub(super) fn hint(&self, text: &str, action: Action) -> String {
        match self.shown(action) {
            keys if keys.is_empty() => text.to_owned(),
            keys => format!("{text} ({keys})"),
        }
    }

    fn most_specific_first(&self) -> impl Iterator<Item = &Binding> {
        let n_modifiers = |binding: &Binding| {
            let Modifiers { shift, command, ctrl, alt, .. } = binding.modifiers;
            [shift, command, ctrl, alt].into_iter().filter(|held| *held).count()
        };
        let mut all: Vec<&Binding> = self.bindings.iter().collect();
        all.sort_by_key(|binding| std::cmp::Reverse(n_modifiers(binding)));
        all.into_iter()
    }
}

/// Whether the system turns this key into its own "copy".
fn is_system_copy(binding: &Binding) -> bool {
    let Modifiers { shift, command, alt, .. } = binding.modifiers;
    binding.key == Key::C && command && !shift && !alt
}

/// Whether a held key sent this event.
fn is_repeat(event: &egui::Event, binding: &Binding) -> bool {
    matches!(event, egui::Event::Key { key, modifiers, pressed: true, repeat: true, .. }
        if *key == binding.key && modifiers.matches_logically(binding.modifiers))
}

/// The keys of one binding as a person reads them.
pub(super) fn keys_of(binding: &Binding) -> String {
    let mut text = String::new();
    if binding.modifiers.command || binding.modifiers.ctrl {
        text.push_str(if cfg!(target_os = "macos") { "Cmd+" } else { "Ctrl+" });
    }
    if binding.modifiers.shift {
        text.push_str("Shift+");
    }
    if binding.modifiers.alt {
        text.push_str("Alt+");
    }
    text.push_str(binding.key.name());
    text
}

const fn key(action: Action, modifiers: Modifiers, key: Key, does: &'static str) -> Binding {
    Binding { action, modifiers, key, does }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn press(key: Key, modifiers: Modifiers) -> Vec<Action> {
        let (ctx, keys) = (egui::Context::default(), Keys::default());
        let mut input = egui::RawInput::default();
        input.events.push(egui::Event::ModifiersChanged(modifiers));
        input.events.push(egui::Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        });
        let mut actions = Vec::new();
        let mut output = ctx.run_ui(input, |ui| actions.extend(keys.pressed(ui.ctx(), false)));
        output.textures_delta.clear();
        actions
    }

    #[test]
    fn every_key_of_the_table_does_its_own_action_and_no_other() {
        for binding in BINDINGS {
            let mut modifiers = binding.modifiers;
            modifiers.ctrl |= modifiers.command;
            modifiers.command |= modifiers.ctrl;
            let actions = press(binding.key, modifiers);
            assert_eq!(actions, [binding.action], "{} does {actions:?}", keys_of(binding));
        }
    }

    #[test]
    fn no_two_actions_share_a_key() {
        for (index, one) in BINDINGS.iter().enumerate() {
            for other in &BINDINGS[index + 1..] {
                let same = one.key == other.key && one.modifiers == other.modifiers;
                assert!(!same, "{:?} and {:?} share {}", one.action, other.action, keys_of(one));
            }
        }
    }

    #[test]
    fn keys_read_as_people_say_them() {
        let keys = Keys::default();
        assert_eq!(keys.shown(Action::SaveAs), "Ctrl+Shift+S", "modifiers in another order");
        assert_eq!(keys.shown(Action::Snapshot), "F12", "F12 is named differently");
    }
}
