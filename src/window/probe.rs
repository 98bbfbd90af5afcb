//! What is under the resting cursor: depth, object, and how large its blur is.

use super::status::{PixelUnderCursor, Probed};
use super::structure::Part;
use crate::render::{Feature, Seen};
use crate::scene::Assets;
use crate::scene::assets::MeshKey;
use crate::scene::description::{ObjectDescription, SceneDescription};
use crate::scene::orbit;
use crate::session::{Frame, Picked, Session};
use std::time::Duration;

/// The cursor rests this long before the renderer is asked, in seconds.
const REST_SECS: f64 = 0.12;

/// The question about the pixel under the cursor, and its answer.
#[derive(Debug, Default)]
pub(super) struct Probe {
    at: Option<[u32; 2]>,
    since: f64,
    asked: bool,
    answer: Option<Probed>,
}

impl Probe {
    /// Follows the cursor; asks once where it rests. What is `known` needs no question. `is_free`
    /// is false while the renderer owes another answer.
    pub(super) fn follow(
        &mut self,
        ctx: &egui::Context,
        hovered: Option<[u32; 2]>,
        known: Option<Probed>,
        is_free: bool,
        session: &Session,
    ) {
        let now = ctx.input(|input| input.time);
        if hovered != self.at {
            *self = Self { at: hovered, since: now, asked: false, answer: None };
        }
        if known.is_some() {
            self.answer = known;
            return;
        }
        let Some([x, y]) = hovered else { return };
        if self.asked || !is_free {
            return;
        }
        let rested = now - self.since;
        if REST_SECS <= rested {
            self.asked = true;
            session.pick(x as f32 + 0.5, y as f32 + 0.5);
        } else {
            ctx.request_repaint_after(Duration::from_secs_f64(REST_SECS - rested));
        }
    }

    /// Takes an answer of the renderer, if it is about the pixel under the cursor.
    pub(super) fn take(
        &mut self,
        picked: &Picked,
        scene: &SceneDescription,
        assets: &Assets,
        height: u32,
    ) {
        let Some([x, y]) = self.at else { return };
        if (picked.x, picked.y) == (x as f32 + 0.5, y as f32 + 0.5) {
            let feature = picked.pick.map_or(Feature::NOTHING, |pick| pick.feature);
            self.answer = Some(described(&feature, scene, assets, height));
        }
    }

    /// What is known of the pixel under the cursor.
    pub(super) fn answer(&self) -> Option<&Probed> {
        self.answer.as_ref()
    }
}

/// The linear value of a pixel of the picture, from a frame that may be coarser.
pub(super) fn pixel_at(frame: &Frame, [x, y]: [u32; 2]) -> Option<PixelUnderCursor> {
    let picture = &frame.picture;
    let (column, row) = (x / frame.scale.max(1), y / frame.scale.max(1));
    if picture.width <= column || picture.height <= row {
        return None;
    }
    let index = row as usize * picture.width as usize + column as usize;
    let linear = *picture.pixels.get(index)?;
    Some(PixelUnderCursor { at: [x, y], linear })
}

/// What a pixel sees, where the frame's map is as fine as its picture will be: a coarse one would
/// name the neighbour.
pub(super) fn feature_at(frame: &Frame, [x, y]: [u32; 2]) -> Option<&Feature> {
    let map = frame.maps.features.as_ref()?;
    let is_full = (map.width, map.height) == (frame.job.width, frame.job.height);
    map.get(x, y).filter(|_| is_full)
}

/// What a feature is called in this scene, and how large its blur is in a picture of that height.
pub(super) fn described(
    feature: &Feature,
    scene: &SceneDescription,
    assets: &Assets,
    height: u32,
) -> Probed {
    let depth = f64::from(feature.depth);
    let (object, material) = match (feature.seen, part_of(feature, scene)) {
        (Seen::Nothing, _) => ("background".to_owned(), String::new()),
        // The scene has changed since.
        (_, None) => (String::new(), String::new()),
        (Seen::Light(_), Some((_, index))) => (scene.lights[index].name.clone(), String::new()),
        (Seen::Object(_), Some((_, index))) => {
            let object = &scene.objects[index];
            (object.name.clone(), material_name(object, feature.slot, assets))
        }
    };
    let blur_px = orbit::blur_px(&scene.camera, depth, f64::from(height));
    Probed { object, material, depth, blur_px }
}

/// The light or the object that a feature belongs to, and its index in the description: what is
/// rendered are the enabled ones.
pub(super) fn part_of(feature: &Feature, scene: &SceneDescription) -> Option<(Part, usize)> {
    fn nth(enabled: impl Iterator<Item = bool>, n: u32) -> Option<usize> {
        enabled.enumerate().filter(|(_, is_enabled)| *is_enabled).nth(n as usize).map(|(i, _)| i)
    }
    match feature.seen {
        Seen::Nothing => None,
        Seen::Light(n) => Some((Part::Light, nth(scene.lights.iter().map(|l| l.enabled), n)?)),
        Seen::Object(n) => Some((Part::Object, nth(scene.objects.iter().map(|o| o.enabled), n)?)),
    }
}

/// The material of an object, or of a slot of its mesh.
fn material_name(object: &ObjectDescription, slot: u32, assets: &Assets) -> String {
    if let Some(name) = &object.material {
        return name.clone();
    }
    let mesh = MeshKey::of(object).and_then(|key| assets.meshes.get(&key));
    let slots = mesh.map_or(&[][..], |mesh| &mesh.slots[..]);
    let last = slots.len().saturating_sub(1);
    match slots.get((slot as usize).min(last)) {
        Some(Some(slot)) => slot.description.name.clone(),
        Some(None) | None => "neutral grey".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::Picture;
    use crate::render::{PixelMap, RenderJob, RenderSettings};
    use crate::scene::resolve;
    use crate::session::Maps;
    use crate::window::tests::small_scene;
    use std::sync::Arc;

    /// A frame of a job of 8 x 4, `scale` times coarser; pixels and depths count its pixels.
    fn frame(scale: u32) -> Frame {
        let description = small_scene();
        let scene = Arc::new(resolve(&description, &Assets::default()).unwrap());
        let settings = RenderSettings::new(&description.render, Default::default());
        let (width, height) = (8 / scale, 4 / scale);
        let count = |index: u32| index as f32;
        let pixels = (0..width * height).map(|index| [count(index); 3]).collect();
        let feature = |index| Feature { depth: count(index), ..Feature::NOTHING };
        let of_pixels = (0..width * height).map(feature).collect();
        let features = Some(Arc::new(PixelMap { width, height, pixels: of_pixels }));
        Frame {
            generation: 1,
            sequence: 1,
            job: RenderJob { scene, width: 8, height: 4, settings },
            scale,
            picture: Picture { width, height, pixels },
            samples: 1,
            noise: None,
            maps: Maps { features, ..Maps::default() },
        }
    }

    #[test]
    fn a_pixel_of_a_preview_is_that_of_its_block() {
        for (scale, at, expected) in [
            (1, [7, 3], Some(31.0)),
            (1, [2, 1], Some(10.0)),
            (2, [0, 0], Some(0.0)),
            (2, [3, 1], Some(1.0)),
            (2, [7, 3], Some(7.0)),
            (4, [5, 2], Some(1.0)),
            (1, [8, 0], None),
            (1, [0, 4], None),
            (2, [8, 3], None),
        ] {
            let found = pixel_at(&frame(scale), at);
            let value = found.as_ref().map(|pixel| pixel.linear[0]);
            assert_eq!(value, expected, "{at:?} at a scale of {scale}");
            assert!(found.is_none_or(|pixel| pixel.at == at), "another place than {at:?}");
        }
    }

    #[test]
    fn a_coarse_map_names_nothing() {
        let depth = |scale| feature_at(&frame(scale), [2, 1]).map(|feature| feature.depth);
        assert_eq!(depth(1), Some(10.0), "the map is as fine as the picture");
        assert_eq!(depth(2), None, "the neighbour is named");
    }
}
