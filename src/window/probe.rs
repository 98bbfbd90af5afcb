//! What is under the resting cursor: depth, object, and how large its blur is.

use super::status::Probed;
use crate::scene::description::SceneDescription;
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
    /// Follows the cursor; asks once where it rests. `is_free` is false while the renderer owes
    /// another answer.
    pub(super) fn follow(
        &mut self,
        ctx: &egui::Context,
        hovered: Option<[u32; 2]>,
        is_free: bool,
        session: &Session,
    ) {
        let now = ctx.input(|input| input.time);
        if hovered != self.at {
            *self = Self { at: hovered, since: now, asked: false, answer: None };
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
    pub(super) fn take(&mut self, picked: &Picked, scene: &SceneDescription, height: u32) {
        let Some([x, y]) = self.at else { return };
        if (picked.x, picked.y) != (x as f32 + 0.5, y as f32 + 0.5) {
            return;
        }
        self.answer = picked.pick.map(|pick| {
            let depth = f64::from(pick.depth);
            let mut enabled = scene.objects.iter().filter(|object| object.enabled);
            Probed {
                object: enabled
                    .nth(pick.object as usize)
                    .map_or_else(String::new, |object| object.name.clone()),
                depth,
                blur_px: orbit::blur_px(&scene.camera, depth, f64::from(height)),
            }
        });
    }

    /// What is known of the pixel under the cursor.
    pub(super) fn answer(&self) -> Option<&Probed> {
        self.answer.as_ref()
    }
}
