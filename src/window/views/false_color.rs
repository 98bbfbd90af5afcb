//! From maps to colours: a figure a pixel, a ramp that tells it, and a legend.

use super::View;
use super::legend::{Legend, Ramp};
use super::scale::{Scale, rounded_down, rounded_up};
use crate::color::srgb_from_linear;
use crate::geometry::TraversalCost;
use crate::render::{Feature, PixelMap, Sampling, Seen};
use crate::scene::Camera;
use crate::session::Frame;
use egui::{Color32, ColorImage};

/// Where there is no figure: the colour of nothing.
const NOTHING: Color32 = Color32::from_gray(20);
/// Figures that are looked at to find the ends of a scale.
const MOST_LOOKED_AT: usize = 20_000;

/// A view of a frame.
pub(in crate::window) struct Painted {
    /// As many pixels as the map has.
    pub(in crate::window) image: ColorImage,
    /// What the colours mean.
    pub(in crate::window) legend: Legend,
}

/// A view of a frame; `None` for the picture itself and where the map is not there yet.
pub(in crate::window) fn paint(view: View, frame: &Frame) -> Option<Painted> {
    let features = frame.maps.features.as_deref();
    match view {
        View::Picture => None,
        View::Albedo => features.map(albedo),
        View::Normals => features.map(normals),
        View::Depth => features.map(depth),
        View::Blur => features.map(|map| blur(map, &frame.job.scene.camera, frame.job.height)),
        View::Cost => frame.maps.costs.as_deref().map(cost),
        View::Samples => frame.maps.sampling.as_deref().map(samples),
        View::Noise => frame.maps.sampling.as_deref().and_then(noise),
    }
}

/// Diameter of the blur of a point at `depth`, in pixels of a picture `height` pixels high: below 0
/// nearer than the plane of focus.
pub(in crate::window) fn signed_blur_px(camera: &Camera, depth: f32, height: u32) -> f64 {
    let focus = f64::from(camera.focal_distance);
    // 1 - focus / depth, which is 1 for what is infinitely far.
    let share = 1.0 - focus / f64::from(depth);
    let pixel = 2.0 * f64::from(camera.tan_half_fov) * focus / f64::from(height);
    2.0 * f64::from(camera.aperture_radius) * share / pixel
}

fn albedo(map: &PixelMap<Feature>) -> Painted {
    let byte = |x: f32| (srgb_from_linear(x) * 255.0).round() as u8;
    let color = |feature: &Feature| match feature.seen {
        Seen::Object(_) => {
            let [r, g, b] = feature.albedo.to_array().map(byte);
            Color32::from_rgb(r, g, b)
        }
        Seen::Nothing | Seen::Light(_) => NOTHING,
    };
    let note = "all that a surface reflects or lets through, 0 to 1";
    colored(map, color, Legend::words(View::Albedo, note))
}

fn normals(map: &PixelMap<Feature>) -> Painted {
    let byte = |x: f32| ((x * 0.5 + 0.5) * 255.0).round().clamp(0.0, 255.0) as u8;
    let color = |feature: &Feature| {
        if feature.normal == glam::Vec3::ZERO {
            return NOTHING;
        }
        let [r, g, b] = feature.normal.to_array().map(byte);
        Color32::from_rgb(r, g, b)
    };
    let note = "red faces +X, green +Y, blue +Z of the world";
    colored(map, color, Legend::words(View::Normals, note))
}

fn depth(map: &PixelMap<Feature>) -> Painted {
    let value = |feature: &Feature| f64::from(feature.depth);
    let (low, high) = range(map, value, 0.002, 0.97);
    let low = rounded_down(low);
    let scale = Scale::Logarithmic { low, high: rounded_up(high).max(low * 1.5) };
    let legend = Legend::figures(View::Depth, "scene units", "", Ramp::GREY, scale);
    figures(map, |feature| Some(value(feature)).filter(|depth| depth.is_finite()), legend)
}

fn blur(map: &PixelMap<Feature>, camera: &Camera, height: u32) -> Painted {
    let value = |feature: &Feature| signed_blur_px(camera, feature.depth, height);
    let (_, most) = range(map, |feature| value(feature).abs(), 0.0, 0.995);
    let scale = Scale::Signed { most: rounded_up(most.max(1.0)) };
    let note = if camera.aperture_radius > 0.0 {
        "blue is nearer than the focus, orange farther"
    } else {
        "the lens is closed: everything is sharp"
    };
    let legend = Legend::figures(View::Blur, "px wide", note, Ramp::DIVERGING, scale);
    figures(map, |feature| Some(value(feature)), legend)
}

fn cost(map: &PixelMap<TraversalCost>) -> Painted {
    let value = |cost: &TraversalCost| f64::from(cost.total());
    let (_, high) = range(map, value, 0.0, 0.999);
    let mean = |of: fn(&TraversalCost) -> u32| {
        let sum: u64 = map.pixels.iter().map(|cost| u64::from(of(cost))).sum();
        sum as f64 / map.pixels.len().max(1) as f64
    };
    let (nodes, tests) = (mean(|cost| cost.n_nodes), mean(|cost| cost.n_primitives));
    let note = format!("on the mean {nodes:.1} nodes and {tests:.1} tests");
    let scale = Scale::Linear { high: rounded_up(high.max(1.0)) };
    let unit = "nodes and tests a ray";
    figures(
        map,
        |cost| Some(value(cost)),
        Legend::figures(View::Cost, unit, &note, Ramp::HEAT, scale),
    )
}

fn samples(map: &PixelMap<Sampling>) -> Painted {
    let value = |pixel: &Sampling| f64::from(pixel.n_samples);
    let (low, high) = range(map, value, 0.0, 1.0);
    let (note, scale) = if low < high {
        let scale = Scale::Logarithmic { low: rounded_down(low), high: rounded_up(high) };
        (format!("from {low} to {high}"), scale)
    } else {
        (format!("{high} in every pixel"), Scale::Linear { high: rounded_up(high.max(1.0)) })
    };
    let legend = Legend::figures(View::Samples, "samples", &note, Ramp::LAND, scale);
    figures(map, |pixel| Some(value(pixel)), legend)
}

/// `None` while there are too few samples to tell.
fn noise(map: &PixelMap<Sampling>) -> Option<Painted> {
    let value = |pixel: &Sampling| f64::from(pixel.error_percent);
    let (_, high) = range(map, value, 0.0, 0.999);
    let high = rounded_up(high);
    let scale = Scale::Logarithmic { low: high / 1000.0, high };
    let legend = Legend::figures(
        View::Noise,
        "% of the picture's mean",
        "standard error of a pixel, as estimated",
        Ramp::HEAT,
        scale,
    );
    let is_known = |pixel: &Sampling| pixel.error_percent.is_finite();
    let is_any_known = map.pixels.iter().any(is_known);
    is_any_known.then(|| figures(map, |pixel| is_known(pixel).then(|| value(pixel)), legend))
}

/// The figures below which the shares `low` and `high` of all finite ones above 0 lie.
fn range<T>(map: &PixelMap<T>, value: impl Fn(&T) -> f64, low: f64, high: f64) -> (f64, f64) {
    let step = map.pixels.len().div_ceil(MOST_LOOKED_AT).max(1);
    let looked_at = map.pixels.iter().step_by(step).map(value);
    let mut values: Vec<f64> = looked_at.filter(|x| x.is_finite() && 0.0 < *x).collect();
    values.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| {
        let last = values.len().checked_sub(1)?;
        values.get((share * last as f64).round() as usize).copied()
    };
    (at(low).unwrap_or(1.0), at(high).unwrap_or(1.0))
}

/// Colours by the legend's own ramp and scale.
fn figures<T>(map: &PixelMap<T>, value: impl Fn(&T) -> Option<f64>, legend: Legend) -> Painted {
    let image = match &legend.figures {
        Some(figures) => {
            let (ramp, scale) = (figures.ramp, figures.scale);
            let color = |pixel: &T| value(pixel).map_or(NOTHING, |x| ramp.at(scale.place(x)));
            image_of(map, color)
        }
        None => image_of(map, |_| NOTHING),
    };
    Painted { image, legend }
}

fn colored<T>(map: &PixelMap<T>, color: impl Fn(&T) -> Color32, legend: Legend) -> Painted {
    Painted { image: image_of(map, color), legend }
}

fn image_of<T>(map: &PixelMap<T>, color: impl Fn(&T) -> Color32) -> ColorImage {
    let size = [map.width as usize, map.height as usize];
    ColorImage::new(size, map.pixels.iter().map(color).collect())
}
