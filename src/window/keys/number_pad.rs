//! The digits of the number pad, which are keys of their own.
//!
//! egui knows one key for a digit, wherever it is. The pad's stand in its table as function keys
//! that no keyboard has; [`tell_apart`] makes them so before egui sees them. What they type stays.

use egui::Key;
use winit::event::KeyEvent;
use winit::keyboard::{KeyCode, NamedKey, PhysicalKey};

/// The keys of the pad's digits, in their order.
pub(super) const PAD: [Key; 10] = [
    Key::F26,
    Key::F27,
    Key::F28,
    Key::F29,
    Key::F30,
    Key::F31,
    Key::F32,
    Key::F33,
    Key::F34,
    Key::F35,
];

/// The same where they come from: the place on the keyboard, and the two names of its function key.
const CODES: [(KeyCode, KeyCode, NamedKey); 10] = [
    (KeyCode::Numpad0, KeyCode::F26, NamedKey::F26),
    (KeyCode::Numpad1, KeyCode::F27, NamedKey::F27),
    (KeyCode::Numpad2, KeyCode::F28, NamedKey::F28),
    (KeyCode::Numpad3, KeyCode::F29, NamedKey::F29),
    (KeyCode::Numpad4, KeyCode::F30, NamedKey::F30),
    (KeyCode::Numpad5, KeyCode::F31, NamedKey::F31),
    (KeyCode::Numpad6, KeyCode::F32, NamedKey::F32),
    (KeyCode::Numpad7, KeyCode::F33, NamedKey::F33),
    (KeyCode::Numpad8, KeyCode::F34, NamedKey::F34),
    (KeyCode::Numpad9, KeyCode::F35, NamedKey::F35),
];

/// Makes a digit of the pad a key of its own. Without Num Lock the pad's keys are arrows, Home and
/// End, and stay what they are.
pub(in crate::window) fn tell_apart(event: &mut KeyEvent) {
    let is_digit = matches!(event.logical_key, winit::keyboard::Key::Character(_));
    if let Some((code, name)) = own_key(event.physical_key).filter(|_| is_digit) {
        event.physical_key = PhysicalKey::Code(code);
        event.logical_key = winit::keyboard::Key::Named(name);
    }
}

fn own_key(key: PhysicalKey) -> Option<(KeyCode, NamedKey)> {
    let own = CODES.iter().find(|(pad, ..)| key == PhysicalKey::Code(*pad));
    own.map(|(_, code, name)| (*code, *name))
}

/// "Numpad 7" for a key of the pad.
pub(super) fn pad_name(key: Key) -> Option<String> {
    PAD.iter().position(|pad| *pad == key).map(|digit| format!("Numpad {digit}"))
}

/// The key of the pad that is called "Numpad 7".
pub(super) fn pad_key(name: &str) -> Option<Key> {
    let (pad, digit) = name.split_at_checked(6)?;
    let digit: usize = digit.trim().parse().ok()?;
    PAD.get(digit).copied().filter(|_| pad.eq_ignore_ascii_case("numpad"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_digit_of_the_pad_is_a_key_of_its_own() {
        for (digit, (pad, ..)) in CODES.iter().enumerate() {
            assert_eq!(format!("{pad:?}"), format!("Numpad{digit}"), "in another order");
            let (code, name) = own_key(PhysicalKey::Code(*pad)).expect("a key of its own");
            let key = PAD[digit];
            let named = [format!("{code:?}"), format!("{name:?}"), key.name().to_owned()];
            assert!(named.iter().all(|one| *one == named[0]), "{pad:?} is {named:?}");
        }
        assert_eq!(own_key(PhysicalKey::Code(KeyCode::Digit1)), None, "a digit of the row");
    }

    #[test]
    fn keys_of_the_pad_are_called_by_their_digit() {
        for (digit, key) in PAD.into_iter().enumerate() {
            assert_eq!(pad_name(key), Some(format!("Numpad {digit}")), "{key:?}");
            for name in [format!("Numpad {digit}"), format!("numpad{digit}")] {
                assert_eq!(pad_key(&name), Some(key), "{name}");
            }
        }
        assert_eq!((pad_name(Key::Num1), pad_key("Numpad")), (None, None), "no key of the pad");
        assert_eq!(pad_key("Numpad 10"), None, "no key of the pad");
    }
}
