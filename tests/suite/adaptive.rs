//! Samples that go where the error is: how many, how much better, and not darker.

use std::sync::atomic::AtomicBool;

use penumbra::render::{Film, World, render_pass};

use crate::common::job;

const WIDTH: u32 = 32;
const HEIGHT: u32 = 24;

/// A penumbra and a lamp out of focus in a picture that is quiet elsewhere.
fn film(sampler: &str, is_adaptive: bool, seed: u32, n_samples: u32) -> Film {
    let job = job(&format!(
        "[render]\nwidth = {WIDTH}\nheight = {HEIGHT}\nsampler = '{sampler}'\nseed = {seed}\n\
         adaptive = {is_adaptive}\n\
         [camera]\neye = [0, 1, 6]\ntarget = [0, 1, 0]\naperture_radius = 0.2\n\
         [environment]\nbackground = [0.2, 0.3, 0.4]\n\
         [[materials]]\nname = 'm'\ndiffuse = [0.7, 0.6, 0.5]\n\
         [[materials]]\nname = 'lamp'\nemission = [60, 50, 40]\n\
         [[objects]]\ntype = 'plane'\npoint = [0, 0, 0]\nnormal = [0, 1, 0]\nmaterial = 'm'\n\
         [[objects]]\ntype = 'sphere'\ncenter = [1, 0.5, 1]\nradius = 0.5\nmaterial = 'm'\n\
         [[objects]]\ntype = 'sphere'\ncenter = [-5, 3, -14]\nradius = 0.15\nmaterial = 'lamp'\n\
         [[lights]]\ntype = 'disk'\nposition = [4, 3, 2]\nsize = 1\npower = [30, 30, 30]\n"
    ));
    let world = World::new(job);
    let mut film = Film::new(WIDTH, HEIGHT).unwrap();
    render_pass(&world, &mut film, n_samples, &AtomicBool::new(false)).unwrap();
    film
}

fn luminances(film: &Film) -> Vec<f64> {
    let of = |p: &[f32; 3]| {
        let [r, g, b] = p.map(f64::from);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    film.picture().pixels.iter().map(of).collect()
}

fn counts(film: &Film) -> Vec<u32> {
    (0..HEIGHT)
        .flat_map(|y| (0..WIDTH).map(move |x| (x, y)))
        .map(|(x, y)| film.samples_at(x, y))
        .collect()
}

#[test]
fn the_mean_of_all_pixels_has_the_samples_that_were_asked_for() {
    for n in [1, 15, 16, 20, 32, 50, 100, 128] {
        let counts = counts(&film("sobol", true, 1, n));
        let mean = f64::from(counts.iter().sum::<u32>()) / counts.len() as f64;
        assert!((mean / f64::from(n) - 1.0).abs() < 0.01, "{mean}, not {n}");
        let (least, most) = (counts.iter().min().unwrap(), counts.iter().max().unwrap());
        if n <= 16 {
            assert!(*least == n && *most == n, "{least} to {most} before the first decision");
        } else {
            assert!(*least >= n.div_ceil(4) && *most > n, "{least} to {most} of {n}");
        }
        let are_powers = counts.iter().all(|count| count.is_power_of_two());
        assert!(are_powers || !n.is_power_of_two(), "what Sobol points want, at {n}");
    }
}

/// Against the mean of many pictures, at the same number of samples.
#[test]
fn the_error_is_smaller_for_the_same_samples() {
    const N_SEEDS: u32 = 4;
    for (sampler, least_gain) in [("random", 1.7), ("sobol", 1.5)] {
        let squared_error = |is_adaptive: bool| {
            let pictures: Vec<Vec<f64>> = (0..N_SEEDS)
                .map(|seed| luminances(&film(sampler, is_adaptive, seed, 256)))
                .collect();
            let spread = |place: usize| {
                let values = pictures.iter().map(|picture| picture[place]);
                let mean = values.clone().sum::<f64>() / f64::from(N_SEEDS);
                values.map(|value| (value - mean).powi(2)).sum::<f64>()
            };
            (0..pictures[0].len()).map(spread).sum::<f64>()
        };
        let gain = squared_error(false) / squared_error(true);
        assert!(gain > least_gain, "{sampler}: squared error {gain} times smaller");
    }
}

/// The rare light of the lamp is missed by some pixels and found by others. If that decided how many
/// samples they get, the picture would be darker on the mean. A z-test over seeds, for the whole
/// picture and for the pixels around the lamp's image.
#[test]
fn the_picture_is_not_darker_for_it() {
    const N_SEEDS: u32 = 120;
    let means = |is_adaptive: bool, first_seed: u32| -> Vec<f64> {
        (first_seed..first_seed + N_SEEDS)
            .map(|seed| {
                let picture = luminances(&film("random", is_adaptive, seed, 32));
                picture.iter().sum::<f64>() / picture.len() as f64
            })
            .collect()
    };
    let statistics = |values: &[f64]| {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean, variance / n)
    };
    let (adaptive, its_variance) = statistics(&means(true, 1000));
    let (even, other_variance) = statistics(&means(false, 5000));
    let z = (adaptive - even) / (its_variance + other_variance).sqrt();
    assert!(z.abs() < 3.3, "{adaptive} against {even}: z = {z}");
}
