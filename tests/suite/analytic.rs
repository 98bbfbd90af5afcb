//! Radiance against closed forms and quadrature.

mod emitters;
mod furnace;
mod glass;
mod gloss;
mod lens;
mod lights;
mod surfaces;
