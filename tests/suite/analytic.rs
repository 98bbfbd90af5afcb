//! Radiance against closed forms and quadrature.

mod coordinates;
mod emitters;
mod extremes;
mod furnace;
mod glass;
mod gloss;
mod lens;
mod lights;
mod surfaces;
mod tangents;
