//! The command line: `render`, `info` and `verify`, without a window.

use std::io::{Write, stderr, stdout};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::Context;
use clap::{Args, Parser, Subcommand};

use crate::geometry::AcceleratorKind;
use crate::io::scene_file::Override;
use crate::io::{printable, printable_ends};
use crate::session::admit::{admit_threads, threads_that_fit};
use crate::threads;

mod info;
mod progress;
mod render;
mod verify;

/// See how a picture is made of light.
///
/// Without a command, opens the window on a scene, a mesh or a snapshot; without FILE, on the
/// final scene of the gallery.
#[derive(Debug, Parser)]
#[command(name = "penumbra", version, args_conflicts_with_subcommands = true)]
pub struct Arguments {
    /// Scene (.toml), mesh (.obj) or snapshot (.png) to open in the window
    pub file: Option<PathBuf>,
    /// What to do without a window
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// What can be done without a window.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene, a mesh or a snapshot to a picture
    Render(RenderArguments),
    /// Say what a scene or mesh holds
    Info(InfoArguments),
    /// Render a snapshot's scene again and compare every byte
    Verify(VerifyArguments),
}

/// Options of `render`.
#[derive(Debug, Args)]
pub struct RenderArguments {
    /// Scene (.toml), mesh (.obj) or snapshot (.png)
    file: PathBuf,
    /// Picture to write: .png (8-bit sRGB, carries its scene), .exr or .hdr (linear)
    #[arg(short, long, value_name = "OUT")]
    output: PathBuf,
    /// Samples per pixel
    #[arg(short, long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1..=1_048_576))]
    samples: Option<u32>,
    /// Stop at the first whole pass after this many seconds
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true, value_parser = positive)]
    time: Option<f64>,
    /// Stop when the estimated noise falls below this
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = positive)]
    noise: Option<f64>,
    /// Width in pixels
    #[arg(long, value_name = "W", allow_negative_numbers = true, value_parser = whole(1..=16_384))]
    width: Option<u32>,
    /// Height in pixels
    #[arg(long, value_name = "H", allow_negative_numbers = true, value_parser = whole(1..=16_384))]
    height: Option<u32>,
    /// Seed of all random numbers
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = whole(0..=u32::MAX))]
    seed: Option<u32>,
    /// Threads to render with; all if not given
    #[arg(short, long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1..=1024))]
    threads: Option<u32>,
    /// Set a parameter of the scene, as camera.aperture_radius=0.1; may be repeated
    #[arg(long = "set", value_name = "PATH=VALUE", value_parser = Override::parse)]
    sets: Vec<Override>,
    /// How rays find what they meet: wide-bvh, kd-tree, kd-midpoint or brute-force; changes no pixel
    #[arg(long, value_name = "NAME", value_parser = accelerator, default_value = "wide-bvh")]
    accelerator: AcceleratorKind,
    /// No progress and no warnings
    #[arg(long)]
    quiet: bool,
    /// Print one JSON object about the result
    #[arg(long)]
    json: bool,
}

/// Options of `info`.
#[derive(Debug, Args)]
pub struct InfoArguments {
    /// Scene (.toml), mesh (.obj) or snapshot (.png)
    file: PathBuf,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Options of `verify`.
#[derive(Debug, Args)]
pub struct VerifyArguments {
    /// Snapshot to render again
    shot: PathBuf,
    /// Threads to render with; all if not given
    #[arg(short, long, value_name = "N", allow_negative_numbers = true, value_parser = whole(1..=1024))]
    threads: Option<u32>,
    /// No progress and no warnings
    #[arg(long)]
    quiet: bool,
}

/// How a command failed.
#[derive(Debug)]
pub enum Failure {
    /// The command line is wrong: exit status 2.
    Usage(String),
    /// Anything else: exit status 1.
    Other(anyhow::Error),
    /// The result is a "no" that has been told: exit status 1.
    Different,
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Other(error.into())
    }
}

/// Runs a command to its exit status. Errors go to stderr as one message.
pub fn run(command: &Command) -> ExitCode {
    let result = match command {
        Command::Render(arguments) => render::run(arguments),
        Command::Info(arguments) => info::run(arguments),
        Command::Verify(arguments) => verify::run(arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(Failure::Usage(message)) => {
            tell("error", &message);
            ExitCode::from(2)
        }
        Err(Failure::Other(error)) => {
            tell("error", &format!("{error:#}"));
            ExitCode::FAILURE
        }
        Err(Failure::Different) => ExitCode::FAILURE,
    }
}

/// The threads of a command: as many as were asked for, or none. Where nobody asks: one a processor,
/// or as many as there is room for, and the one that there is where there is room for no other.
fn pool(name: &'static str, n_wanted: Option<u32>) -> anyhow::Result<rayon::ThreadPool> {
    let n_threads = n_wanted.map_or_else(threads::available, |n| n as usize);
    let n_fit = threads_that_fit(n_threads);
    Ok(match n_wanted {
        Some(2..) => {
            admit_threads(n_threads)?;
            threads::pool(name, n_threads)?
        }
        Some(_) | None if n_fit == 0 => threads::pool_of_caller()?,
        Some(_) => threads::pool(name, 1)?,
        None => threads::pool_of_at_most(name, n_fit)?,
    })
}

/// Shows what is wrong with a command line, or the help that it asks for. What it repeats of the
/// command line cannot reach the terminal as an escape sequence.
pub fn explain(error: &clap::Error) -> ExitCode {
    let text = error.to_string();
    let safe: Vec<String> = text.lines().map(printable_ends).collect();
    let told = if text.lines().eq(safe.iter()) {
        error.print()
    } else {
        writeln!(stderr(), "{}", safe.join("\n"))
    };
    // Where nobody is left to be told, the status still says it: of help that was asked for, too.
    match (told, error.exit_code()) {
        (Err(failure), 0) => {
            tell("error", &format!("the standard output: {failure}"));
            ExitCode::FAILURE
        }
        (_, status) => ExitCode::from(u8::try_from(status).unwrap_or(2)),
    }
}

/// The one place that prints results; a result that reaches nobody is an error.
fn print(text: &str) -> anyhow::Result<()> {
    let mut out = stdout().lock();
    writeln!(out, "{text}").and_then(|()| out.flush()).context("the standard output")
}

/// Prints a JSON object. Characters that could mean something to a terminal are escaped, which
/// changes nothing for whoever reads it as JSON.
fn print_json(value: &serde_json::Value) -> anyhow::Result<()> {
    let mut text = String::new();
    for c in value.to_string().chars() {
        if c.is_ascii() || printable(c.encode_utf8(&mut [0; 4])).chars().eq([c]) {
            text.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                text += &format!("\\u{unit:04x}");
            }
        }
    }
    print(&text)
}

/// The one place that prints anything else.
fn tell(kind: &str, message: &str) {
    // Where stderr is closed, nobody is left to be told.
    let _ = writeln!(stderr(), "{kind}: {message}");
}

fn warn(lines: &[String], is_quiet: bool) {
    if !is_quiet {
        for line in lines {
            tell("warning", line);
        }
    }
}

fn whole(
    range: RangeInclusive<u32>,
) -> impl Fn(&str) -> Result<u32, String> + Clone + Send + Sync + 'static {
    move |text| {
        let number = text.parse().ok().filter(|number| range.contains(number));
        let (low, high) = (range.start(), range.end());
        number.ok_or_else(|| format!("give a whole number from {low} to {high}"))
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("give a number above 0".to_owned()),
    }
}

fn accelerator(text: &str) -> Result<AcceleratorKind, String> {
    AcceleratorKind::from_name(text).ok_or_else(|| {
        let names = AcceleratorKind::ALL.map(AcceleratorKind::name).join(", ");
        format!("there is no accelerator of that name; give one of {names}")
    })
}
