//! What is set for a rendered picture: size, samples, kind of file and where it goes.

use super::output::pictures_folder;
use super::panels::Limits;
use crate::io::output::OutputFormat;
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// How large the rendered picture is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum ExportSize {
    /// As many pixels as the live picture has.
    #[default]
    Live,
    /// Twice as many along each side.
    Double,
    /// 3840 x 2160.
    Uhd,
    /// As typed.
    Custom,
}

/// Where the rendered picture goes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Destination {
    /// A file under a new number.
    #[default]
    File,
    /// The clipboard, tone-mapped.
    Clipboard,
}

/// What is set in the box, and remembered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct ExportSettings {
    /// Which size.
    pub(super) size: ExportSize,
    /// Width and height in pixels where the size is [`ExportSize::Custom`].
    pub(super) custom: [u32; 2],
    /// Samples a pixel; `None` is what the scene says.
    #[serde(skip)]
    pub(super) samples: Option<u32>,
    /// What may end it before its samples are reached.
    #[serde(skip)]
    pub(super) limits: Limits,
    /// Kind of file.
    pub(super) format: OutputFormat,
    /// File or clipboard.
    pub(super) destination: Destination,
    /// Folder of the file; `None` is the user's pictures.
    pub(super) folder: Option<PathBuf>,
}

impl Default for ExportSettings {
    fn default() -> Self {
        Self {
            size: ExportSize::Live,
            custom: [1920, 1080],
            samples: None,
            limits: Limits::default(),
            format: OutputFormat::Png,
            destination: Destination::File,
            folder: None,
        }
    }
}

impl ExportSettings {
    /// Width and height in pixels, beside a live picture of that size.
    pub(super) fn pixels(&self, live: [u32; 2]) -> [u32; 2] {
        let held = |n: u32| n.clamp(1, 16384);
        match self.size {
            ExportSize::Live => live,
            ExportSize::Double => live.map(|n| held(n * 2)),
            ExportSize::Uhd => [3840, 2160],
            ExportSize::Custom => self.custom.map(held),
        }
    }

    /// Where files go.
    pub(super) fn folder(&self) -> PathBuf {
        self.folder.clone().unwrap_or_else(pictures_folder)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_follow_the_live_picture_or_what_was_typed() {
        let mut settings = ExportSettings { custom: [0, 20_000], ..ExportSettings::default() };
        for (size, pixels) in [
            (ExportSize::Live, [800, 500]),
            (ExportSize::Double, [1600, 1000]),
            (ExportSize::Uhd, [3840, 2160]),
            (ExportSize::Custom, [1, 16384]),
        ] {
            settings.size = size;
            assert_eq!(settings.pixels([800, 500]), pixels, "{size:?}");
        }
    }
}
