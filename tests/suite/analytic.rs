//! Radiance against closed forms and quadrature.

mod lights;
