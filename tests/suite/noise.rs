//! The noise figure against the true error.

use std::sync::atomic::AtomicBool;

use penumbra::render::{Film, World, plan, render_pass};

use crate::common::job;

const SOFT: &str = "[[materials]]\nname = 'm'\ndiffuse = [0.7, 0.6, 0.5]\n\
    [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n\
    [[objects]]\ntype = 'sphere'\ncenter = [0, 1, 0]\nradius = 1\nmaterial = 'm'\n\
    [[lights]]\ntype = 'disk'\nposition = [3, 5, 2]\nsize = 2\npower = [300, 300, 300]\n";

const GLOWING: &str = "[[materials]]\nname = 'm'\ndiffuse = [0.7, 0.6, 0.5]\n\
    specular = [0.2, 0.2, 0.2]\n\
    [[materials]]\nname = 'glow'\nemission = [9, 8, 7]\n\
    [[objects]]\ntype = 'box'\nmin = [-4, 0, -4]\nmax = [4, 5, 5]\nmaterial = 'm'\n\
    [[objects]]\ntype = 'sphere'\ncenter = [0, 1, 0]\nradius = 1\nmaterial = 'm'\n\
    [[objects]]\ntype = 'sphere'\ncenter = [2, 3, 1]\nradius = 0.7\nmaterial = 'glow'\n";

/// The spread of pictures that differ only in their seed is the true error; the figure, which knows
/// one picture alone, comes near it with either sampler, at powers of two and between.
#[test]
fn the_noise_figure_is_near_the_true_error() {
    const N_SEEDS: u32 = 6;
    for (body, integrator) in [(SOFT, "direct"), (GLOWING, "path")] {
        for (sampler, goal) in
            [("random", 32), ("random", 96), ("sobol", 16), ("sobol", 64), ("sobol", 96)]
        {
            let films: Vec<Film> = (0..N_SEEDS)
                .map(|seed| {
                    let text = format!(
                        "[render]\nwidth = 24\nheight = 18\nintegrator = '{integrator}'\n\
                         sampler = '{sampler}'\nseed = {seed}\nmax_depth = 3\n\
                         [camera]\neye = [0.5, 1.5, 4.5]\ntarget = [0, 1, 0]\n{body}"
                    );
                    let job = job(&text);
                    let world = World::new(job.clone());
                    let mut film = Film::new(job.width, job.height).unwrap();
                    while film.n_samples() < goal {
                        let n = plan::pass_samples(film.n_samples(), goal);
                        render_pass(&world, &mut film, n, &AtomicBool::new(false)).unwrap();
                    }
                    film
                })
                .collect();
            let (mut variance, mut mean) = (0.0, 0.0);
            for y in 0..18 {
                for x in 0..24 {
                    let values = films.iter().map(|film| {
                        let [r, g, b] = film.mean(x, y).map(f64::from);
                        0.2126 * r + 0.7152 * g + 0.0722 * b
                    });
                    let values: Vec<f64> = values.collect();
                    let middle = values.iter().sum::<f64>() / f64::from(N_SEEDS);
                    let spread: f64 = values.iter().map(|v| (v - middle).powi(2)).sum();
                    variance += spread / f64::from(N_SEEDS - 1) / (18.0 * 24.0);
                    mean += middle / (18.0 * 24.0);
                }
            }
            let truth = 100.0 * variance.sqrt() / mean;
            let figures = films.iter().map(|film| film.noise_percent().unwrap().powi(2));
            let figure = (figures.sum::<f64>() / f64::from(N_SEEDS)).sqrt();
            let ratio = figure / truth;
            let what = format!("{figure} %, not {truth} %, at {goal} {sampler} samples");
            assert!((0.7..1.4).contains(&ratio), "{integrator}: {what}");
        }
    }
}
