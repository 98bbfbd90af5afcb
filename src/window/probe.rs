//! What is under the resting cursor: depth, object, and how large its blur is.

use super::status::Probed;
use super::structure::Part;
use crate::render::{Feature, Seen};
use crate::scene::Assets;
use crate::scene::assets::MeshKey;
use crate::scene::description::{ObjectDescription, SceneDescription};
use crate::scene::orbit;
use crate::session::{Picked, Session};
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
