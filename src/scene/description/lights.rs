//! Lights as a person writes them.

use serde::{Deserialize, Serialize};

use super::{OneOrTwo, Triple, defaults};

/// `[[lights]]`: a source of light of a given power.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightDescription {
    /// Unique among lights. A file that gives none means "light-1", "light-2" and so on.
    #[serde(default)]
    pub name: String,
    /// What shape it has.
    #[serde(rename = "type")]
    pub kind: LightKind,
    /// Its centre.
    pub position: Triple,
    /// The emitting side faces this point.
    #[serde(default)]
    pub target: Triple,
    /// Turns a rectangle about its axis.
    #[serde(default = "defaults::y_axis")]
    pub up: Triple,
    /// Rectangle: width and height; disk and sphere: diameter; sun: angular diameter in degrees.
    #[serde(default = "defaults::point_size")]
    pub size: OneOrTwo,
    /// Radiant flux per channel, at least 0. Sun: irradiance of a surface that faces it.
    pub power: Triple,
    /// Whether the camera and mirrors see it.
    #[serde(default = "defaults::yes")]
    pub visible: bool,
    /// Whether it is there at all.
    #[serde(default = "defaults::yes")]
    pub enabled: bool,
}

/// What shape a light has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LightKind {
    /// A one-sided rectangle.
    Rectangle,
    /// A one-sided disk.
    Disk,
    /// A sphere.
    Sphere,
    /// A point that shines equally in all directions.
    Point,
    /// Parallel light, or a cap of the sky.
    Sun,
}
