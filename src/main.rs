//! Arguments in, exit status out.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;

use clap::Parser;
use penumbra::cli::{self, Arguments};
use penumbra::io::crash;

fn main() -> ExitCode {
    crash::report_to(own_folder());
    // A panic has been reported when it gets here.
    catch_unwind(AssertUnwindSafe(run)).unwrap_or(ExitCode::FAILURE)
}

fn run() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return cli::explain(&error),
    };
    match &arguments.command {
        Some(command) => cli::run(command),
        None => open_window(arguments),
    }
}

#[cfg(not(feature = "window"))]
fn own_folder() -> Option<std::path::PathBuf> {
    None
}

#[cfg(feature = "window")]
fn own_folder() -> Option<std::path::PathBuf> {
    penumbra::window::own_folder()
}

#[cfg(not(feature = "window"))]
fn open_window(_: Arguments) -> ExitCode {
    eprintln!("error: this build has no window; use `penumbra render FILE -o OUT`");
    ExitCode::FAILURE
}

#[cfg(feature = "window")]
fn open_window(arguments: Arguments) -> ExitCode {
    match penumbra::window::run(arguments.file) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::FAILURE
        }
    }
}
