//! Arguments in, exit status out.

use std::process::ExitCode;

use clap::Parser;
use penumbra::cli::{self, Arguments};

fn main() -> ExitCode {
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
