//! What may stand in a scene file: the sections, their keys in the order in which they are
//! written, and what each key's value must be.
//!
//! The tables here and the structs of [`crate::scene::description`] say the same; a test holds
//! them together. Messages about a value are made from its row.

use super::range::Range;

use Presence::{Optional, Required, Written};
use Rule::{
    Blades, ColorOrTexture, Colors, Direction, File, Flag, Number, OneOrThree, OneOrTwo, Table,
    Text, Triple, Whole, Word,
};

/// A part of a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Section {
    /// `[render]`
    Render,
    /// `[camera]`
    Camera,
    /// `[tone_mapping]`
    ToneMapping,
    /// `[environment]`
    Environment,
    /// `[[textures]]`
    Textures,
    /// `[[materials]]`
    Materials,
    /// `[[lights]]`
    Lights,
    /// `[[objects]]`
    Objects,
}

impl Section {
    /// All of them, as they follow each other in a file.
    pub const ALL: [Self; 8] = [
        Self::Render,
        Self::Camera,
        Self::ToneMapping,
        Self::Environment,
        Self::Textures,
        Self::Materials,
        Self::Lights,
        Self::Objects,
    ];

    /// As the file spells it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Render => "render",
            Self::Camera => "camera",
            Self::ToneMapping => "tone_mapping",
            Self::Environment => "environment",
            Self::Textures => "textures",
            Self::Materials => "materials",
            Self::Lights => "lights",
            Self::Objects => "objects",
        }
    }

    /// The section of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|section| section.name() == name)
    }

    /// What one entry of a list is called; `None` for a section that is there once.
    pub fn entry_noun(self) -> Option<&'static str> {
        match self {
            Self::Render | Self::Camera | Self::ToneMapping | Self::Environment => None,
            Self::Textures => Some("texture"),
            Self::Materials => Some("material"),
            Self::Lights => Some("light"),
            Self::Objects => Some("object"),
        }
    }

    /// The keys it knows, in the order in which they are written.
    pub fn keys(self) -> &'static [Key] {
        match self {
            Self::Render => RENDER,
            Self::Camera => CAMERA,
            Self::ToneMapping => TONE_MAPPING,
            Self::Environment => ENVIRONMENT,
            Self::Textures => TEXTURES,
            Self::Materials => MATERIALS,
            Self::Lights => LIGHTS,
            Self::Objects => OBJECTS,
        }
    }
}

/// One key of a section.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// As the file spells it.
    pub name: &'static str,
    /// What its value is, for messages: "a roughness".
    pub noun: &'static str,
    /// Whether it must be there.
    pub presence: Presence,
    /// What its value must look like.
    pub rule: Rule,
}

/// Whether a key must be there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// A file without it is refused.
    Required,
    /// Has a default, but is written even so: a reader wants to see it.
    Written,
    /// Has a default, and is left out where it has that value.
    Optional,
}

/// What a value must look like.
#[derive(Clone, Copy, Debug)]
pub enum Rule {
    /// One number, integer or not.
    Number(Range),
    /// An integer between two bounds, both included.
    Whole(u32, u32),
    /// The blades of a lens: 0, or 3..=16.
    Blades,
    /// `true` or `false`.
    Flag,
    /// One of these strings.
    Word(&'static [&'static str]),
    /// Any string.
    Text,
    /// A string of at least one character.
    File,
    /// Three numbers.
    Triple(Range),
    /// Three numbers that are not all zero.
    Direction,
    /// Three numbers, or the name of a texture.
    ColorOrTexture(Range),
    /// An array of colours.
    Colors,
    /// A number, or an array of one or two.
    OneOrTwo(Range),
    /// A number, or an array of three.
    OneOrThree(Range),
    /// A table of its own.
    Table(&'static [Key]),
}

impl Rule {
    /// What would be right, to be put after "give".
    pub fn remedy(self) -> String {
        match self {
            Self::Number(range) => range.say("a number"),
            Self::Whole(least, most) => format!("a whole number from {least} to {most}"),
            Self::Blades => "0 for a round lens, or a whole number from 3 to 16".into(),
            Self::Flag => "true or false".into(),
            Self::Word(words) => one_of(words),
            Self::Text => "a string".into(),
            Self::File => "the path of a file, as a string".into(),
            Self::Triple(range) => range.say("three numbers"),
            Self::Direction => "three numbers that are not all 0".into(),
            Self::ColorOrTexture(range) => {
                format!("{}, or the name of a texture", range.say("three numbers"))
            }
            Self::Colors => "an array of colours, each three numbers of at least 0".into(),
            Self::OneOrTwo(range) => {
                format!("{}, or an array of one or two", range.say("a number"))
            }
            Self::OneOrThree(range) => format!("{}, or an array of three", range.say("a number")),
            Self::Table(keys) => {
                let names: Vec<_> = keys.iter().map(|key| format!("{} = …", key.name)).collect();
                format!("{{ {} }}", names.join(", "))
            }
        }
    }
}

/// Words to choose from: `"a", "b" or "c"`.
fn one_of(words: &[&str]) -> String {
    let quoted: Vec<_> = words.iter().map(|word| format!("{word:?}")).collect();
    match quoted.split_last() {
        Some((last, [])) => last.clone(),
        Some((last, others)) => format!("{} or {last}", others.join(", ")),
        None => String::new(),
    }
}

const fn key(name: &'static str, noun: &'static str, presence: Presence, rule: Rule) -> Key {
    Key { name, noun, presence, rule }
}

const RENDER: &[Key] = &[
    key("width", "a width", Written, Whole(1, 16384)),
    key("height", "a height", Written, Whole(1, 16384)),
    key("samples", "a number of samples", Written, Whole(1, 1_048_576)),
    key("max_depth", "a depth", Written, Whole(0, 1024)),
    key("integrator", "an integrator", Written, Word(&["direct", "path"])),
    key("seed", "a seed", Optional, Whole(0, u32::MAX)),
    key("filter", "a filter", Optional, Word(&["box"])),
    key("adaptive", "a switch", Optional, Flag),
    key("sampler", "a sampler", Optional, Word(&["sobol", "random"])),
];

const CAMERA: &[Key] = &[
    key("eye", "a point", Required, Triple(Range::ANY)),
    key("target", "a point", Required, Triple(Range::ANY)),
    key("up", "a direction", Optional, Direction),
    key("vertical_fov", "an angle of view", Written, Number(Range::FIELD_OF_VIEW)),
    key("aperture_radius", "a lens radius", Written, Number(Range::AT_LEAST_0)),
    key("focal_distance", "a distance", Optional, Number(Range::ABOVE_0)),
    key("aperture_blades", "a number of blades", Optional, Blades),
];

const TONE_MAPPING: &[Key] = &[
    key("exposure", "an exposure", Written, Number(Range::EXPOSURE)),
    key("operator", "a tone operator", Written, Word(&["linear", "reinhard", "aces", "agx"])),
];

const ENVIRONMENT: &[Key] = &[
    key("ambient", "a colour", Written, Triple(Range::LIGHT)),
    key("background", "a background", Written, ColorOrTexture(Range::LIGHT)),
];

const TEXTURES: &[Key] = &[
    key("name", "a name", Required, Text),
    key(
        "type",
        "a type of texture",
        Required,
        Word(&["solid", "checker", "image", "spots", "marble", "clouds", "wood"]),
    ),
    key("file", "a file", Optional, File),
    key("scale", "a scale", Optional, Number(Range::ABOVE_0)),
    key("octaves", "a number of octaves", Optional, Whole(1, 12)),
    key("lacunarity", "a frequency ratio", Optional, Number(Range::LACUNARITY)),
    key("gain", "an amplitude ratio", Optional, Number(Range::GAIN)),
    key("distortion", "a distortion", Optional, Number(Range::ANY)),
    key("colors", "a list of colours", Optional, Colors),
];

const MATERIALS: &[Key] = &[
    key("name", "a name", Required, Text),
    key("diffuse", "a reflectance", Written, ColorOrTexture(Range::UNIT)),
    key("specular", "a reflectance", Optional, Triple(Range::UNIT)),
    key("alpha_x", "a roughness", Optional, Number(Range::ABOVE_0)),
    key("alpha_y", "a roughness", Optional, Number(Range::ABOVE_0)),
    key("ward", "a form of Ward's gloss", Optional, Word(&["original", "duer", "bounded"])),
    key("tangent", "a direction", Optional, Direction),
    key("reflection", "a reflectance", Optional, Triple(Range::UNIT)),
    key("transmission", "a transmittance", Optional, Triple(Range::UNIT)),
    key("ior", "an index of refraction", Optional, Number(Range::ABOVE_0)),
    key("emission", "a radiance", Optional, Triple(Range::LIGHT)),
    key("bump", "a bump map", Optional, Table(BUMP)),
];

const BUMP: &[Key] = &[
    key("texture", "the name of a texture", Required, Text),
    key("height", "a height", Required, Number(Range::ANY)),
];

const LIGHTS: &[Key] = &[
    key("name", "a name", Written, Text),
    key(
        "type",
        "a type of light",
        Required,
        Word(&["rectangle", "disk", "sphere", "point", "sun"]),
    ),
    key("position", "a point", Required, Triple(Range::ANY)),
    key("target", "a point", Optional, Triple(Range::ANY)),
    key("up", "a direction", Optional, Direction),
    key("size", "a size", Optional, OneOrTwo(Range::AT_LEAST_0)),
    key("power", "a power", Required, Triple(Range::LIGHT)),
    key("visible", "a switch", Optional, Flag),
    key("enabled", "a switch", Optional, Flag),
];

const OBJECTS: &[Key] = &[
    key("name", "a name", Written, Text),
    key(
        "type",
        "a type of object",
        Required,
        Word(&["mesh", "sphere", "plane", "box", "cone", "cylinder"]),
    ),
    key("file", "a file", Optional, File),
    key("normals", "a kind of normals", Optional, Word(&["file", "smooth", "flat"])),
    key("crease_angle", "an angle", Optional, Number(Range::CREASE)),
    key("center", "a point", Optional, Triple(Range::ANY)),
    key("point", "a point", Optional, Triple(Range::ANY)),
    key("normal", "a direction", Optional, Direction),
    key("min", "a point", Optional, Triple(Range::ANY)),
    key("max", "a point", Optional, Triple(Range::ANY)),
    key("base", "a point", Optional, Triple(Range::ANY)),
    key("tip", "a point", Optional, Triple(Range::ANY)),
    key("top", "a point", Optional, Triple(Range::ANY)),
    key("radius", "a radius", Optional, Number(Range::ABOVE_0)),
    key("material", "the name of a material", Optional, Text),
    key("translate", "a shift", Optional, Triple(Range::ANY)),
    key("rotate", "a rotation", Optional, Triple(Range::ANY)),
    key("scale", "a scale", Optional, OneOrThree(Range::NOT_0)),
    key("enabled", "a switch", Optional, Flag),
];
