//! Which key does what, and which motion of the mouse.

use super::number_pad::PAD;
use super::{Action, Binding};
use crate::window::views::View;
use egui::{Key, Modifiers};

const COMMAND_SHIFT: Modifiers = Modifiers { shift: true, command: true, ..Modifiers::NONE };

/// One line of the help for the keys of all views.
const VIEWS: &str = "picture, albedo, normals, depth, blur, cost, samples, noise";

/// Every key the window listens to, where the file of keys says nothing else. Where one action has
/// several, the first is named in tooltips.
pub(in crate::window) const BINDINGS: &[Binding] = &[
    key(Action::FrameAll, Modifiers::NONE, Key::Home, "frame all"),
    key(Action::HomeCamera, Modifiers::NONE, Key::Backspace, "back to the scene's own camera"),
    key(Action::ViewFront, Modifiers::NONE, PAD[1], "front view"),
    key(Action::ViewFront, Modifiers::CTRL, Key::Num1, "front view"),
    key(Action::ViewSide, Modifiers::NONE, PAD[3], "side view"),
    key(Action::ViewSide, Modifiers::CTRL, Key::Num3, "side view"),
    key(Action::ViewTop, Modifiers::NONE, PAD[7], "top view"),
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
pub(in crate::window) const MOTIONS: &[(&str, &str)] = &[
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

const fn key(action: Action, modifiers: Modifiers, key: Key, does: &'static str) -> Binding {
    Binding { action, modifiers, key, does }
}
