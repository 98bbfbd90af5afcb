//! What keys, buttons and menus can do.

use crate::window::views::View;

/// Something a key, a button or a menu makes the window do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::window) enum Action {
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

/// What the help lists together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::window) enum Group {
    /// Where the picture is taken from, and through which lens.
    Camera,
    /// The picture and how it is shown.
    Picture,
    /// Files and edits.
    Scene,
    /// The window itself.
    Window,
}

impl Group {
    /// The title in the help.
    pub(in crate::window) fn title(self) -> &'static str {
        match self {
            Self::Camera => "Camera",
            Self::Picture => "Picture",
            Self::Scene => "Scene",
            Self::Window => "Window",
        }
    }
}

impl Action {
    /// Where the help lists it.
    pub(in crate::window) fn group(self) -> Group {
        match self {
            Self::FrameAll
            | Self::HomeCamera
            | Self::ViewFront
            | Self::ViewSide
            | Self::ViewTop
            | Self::ToggleLens => Group::Camera,
            Self::Pause
            | Self::Restart
            | Self::Brighter
            | Self::Darker
            | Self::NextOperator
            | Self::Snapshot
            | Self::RenderPicture
            | Self::CopyImage
            | Self::Compare
            | Self::ShowPinned
            | Self::Show(_)
            | Self::Loupe => Group::Picture,
            Self::Save
            | Self::SaveAs
            | Self::Open
            | Self::Gallery
            | Self::CloseScene
            | Self::Undo
            | Self::Redo => Group::Scene,
            Self::TogglePanel
            | Self::FullScreen
            | Self::LargerText
            | Self::SmallerText
            | Self::UsualText
            | Self::Help
            | Self::Cancel => Group::Window,
        }
    }

    /// As the file of keys calls it: `frame-all`.
    pub(in crate::window) fn name(self) -> String {
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
    pub(super) fn repeats(self) -> bool {
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
