//! What each key and each motion of the mouse does: one table that binds the keys, names them in
//! tooltips and fills the help overlay.

mod action;
pub(super) mod file;
pub(super) mod number_pad;
mod table;

pub(super) use action::{Action, Group};
pub(super) use table::{BINDINGS, MOTIONS};

use egui::{Key, Modifiers};
use number_pad::pad_name;

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
    /// text field has the focus; with Ctrl they do, but for those that text fields use themselves.
    /// Space presses the button that has the focus. While the camera is `flying`, letters belong to
    /// it; Escape belongs to an open menu. A key that is held does its action once, but for those
    /// that step.
    pub(super) fn pressed(&self, ctx: &egui::Context, flying: bool) -> Vec<Action> {
        let typing = ctx.text_edit_focused();
        let has_focus = ctx.memory(|memory| memory.focused().is_some());
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
                if has_focus && binding.key == Key::Space && binding.modifiers.is_none() {
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

    /// Whether a key of an action is held down, and no text field has the focus.
    pub(super) fn is_held(&self, ctx: &egui::Context, action: Action) -> bool {
        let typing = ctx.text_edit_focused();
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
    text += &pad_name(binding.key).unwrap_or_else(|| binding.key.name().to_owned());
    text
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
