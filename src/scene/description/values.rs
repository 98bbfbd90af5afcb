//! Values of a scene file that may be written in more than one way.
//!
//! Each is read by its first look: a number, a string or an array decides what follows, so that
//! an error speaks of what was meant.

use std::fmt;

use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};

/// Three numbers: a point, a direction, a colour or three factors.
pub type Triple = [f64; 3];

/// A constant colour, or the name of a texture.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum ColorOrTexture {
    /// Linear RGB.
    Color(Triple),
    /// The name of an entry of `[[textures]]`.
    Texture(String),
}

/// A number, or an array of one or two.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrTwo {
    /// The same in both directions.
    One(f64),
    /// An array of one.
    Single([f64; 1]),
    /// Width and height.
    Two([f64; 2]),
}

impl OneOrTwo {
    /// Width and height; one number stands for both.
    pub fn pair(self) -> [f64; 2] {
        match self {
            Self::One(size) | Self::Single([size]) => [size, size],
            Self::Two(pair) => pair,
        }
    }
}

/// One factor, or one for each axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum OneOrThree {
    /// The same along every axis.
    One(f64),
    /// Along x, y and z.
    Three(Triple),
}

impl OneOrThree {
    /// The three factors.
    pub fn triple(self) -> Triple {
        match self {
            Self::One(factor) => [factor; 3],
            Self::Three(factors) => factors,
        }
    }
}

impl<'de> Deserialize<'de> for ColorOrTexture {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match deserializer
            .deserialize_any(AnyForm("a colour of three numbers or a texture's name"))?
        {
            Form::Text(name) => Ok(Self::Texture(name)),
            Form::Numbers(numbers) => three(&numbers).map(Self::Color),
            Form::Number(number) => Err(de::Error::custom(format_args!(
                "expected a colour of three numbers or a texture's name, found {number:?}"
            ))),
        }
    }
}

impl<'de> Deserialize<'de> for OneOrTwo {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match deserializer.deserialize_any(AnyForm("a number or an array of one or two"))? {
            Form::Number(number) => Ok(Self::One(number)),
            Form::Numbers(numbers) => match numbers[..] {
                [size] => Ok(Self::Single([size])),
                [width, height] => Ok(Self::Two([width, height])),
                _ => Err(de::Error::invalid_length(numbers.len(), &"one or two numbers")),
            },
            Form::Text(text) => Err(de::Error::custom(format_args!(
                "expected a number or an array of one or two, found {text:?}"
            ))),
        }
    }
}

impl<'de> Deserialize<'de> for OneOrThree {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        match deserializer.deserialize_any(AnyForm("a number or an array of three"))? {
            Form::Number(number) => Ok(Self::One(number)),
            Form::Numbers(numbers) => three(&numbers).map(Self::Three),
            Form::Text(text) => Err(de::Error::custom(format_args!(
                "expected a number or an array of three, found {text:?}"
            ))),
        }
    }
}

fn three<E: de::Error>(numbers: &[f64]) -> Result<Triple, E> {
    numbers.try_into().map_err(|_| E::invalid_length(numbers.len(), &"three numbers"))
}

/// What a value looks like before anything is known of its meaning.
enum Form {
    Number(f64),
    Numbers(Vec<f64>),
    Text(String),
}

/// Reads any [`Form`]; holds what was expected, for the message when it is none.
struct AnyForm(&'static str);

impl<'de> Visitor<'de> for AnyForm {
    type Value = Form;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_i64<E: de::Error>(self, number: i64) -> Result<Form, E> {
        Ok(Form::Number(number as f64))
    }

    fn visit_u64<E: de::Error>(self, number: u64) -> Result<Form, E> {
        Ok(Form::Number(number as f64))
    }

    fn visit_f64<E: de::Error>(self, number: f64) -> Result<Form, E> {
        Ok(Form::Number(number))
    }

    fn visit_str<E: de::Error>(self, text: &str) -> Result<Form, E> {
        Ok(Form::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Form, A::Error> {
        let mut numbers = Vec::new();
        while let Some(number) = sequence.next_element()? {
            numbers.push(number);
        }
        Ok(Form::Numbers(numbers))
    }
}
