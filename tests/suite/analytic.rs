//! Radiance against closed forms and quadrature.

mod gloss;
mod lens;
mod lights;
