//! The suite: what the picture must be, told by closed forms, densities and oracles.

mod analytic;
mod common;
mod density;
mod noise;
mod oracle;
