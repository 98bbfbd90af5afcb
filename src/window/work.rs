//! The scene as a job: built from the document each frame, resolved again only where it changed,
//! handed to the session, which finds out what is new.

use super::panels::{Limits, SizeMode};
use super::state::InterfaceState;
use crate::geometry::AcceleratorKind;
use crate::math::Aabb;
use crate::render::{Noise, RenderJob, RenderSettings};
use crate::scene::description::SceneDescription;
use crate::scene::resolve::{ResolveError, resolve};
use crate::scene::{Assets, Scene};
use crate::session::{Frame, Goal, Session};
use std::sync::Arc;

/// Noise estimates kept for the graph.
const MOST_ESTIMATES: usize = 400;

/// The renderer, and what was last asked of it.
pub(super) struct RenderWork {
    pub(super) session: Session,
    pub(super) assets: Arc<Assets>,
    resolved: Option<Resolved>,
    job: Option<RenderJob>,
    /// Samples and noise of the picture being refined.
    noise: Vec<(u32, Noise)>,
    noise_of: u64,
}

struct Resolved {
    description: SceneDescription,
    scene: Arc<Scene>,
}

impl RenderWork {
    /// A renderer without a scene.
    pub(super) fn new(session: Session) -> Self {
        Self {
            session,
            assets: Arc::default(),
            resolved: None,
            job: None,
            noise: Vec::new(),
            noise_of: 0,
        }
    }

    /// Takes the files of a newly opened scene.
    pub(super) fn set_assets(&mut self, assets: Arc<Assets>) {
        self.assets = assets;
        self.resolved = None;
        self.job = None;
    }

    /// The scene as last resolved.
    pub(super) fn scene(&self) -> Option<&Arc<Scene>> {
        self.resolved.as_ref().map(|resolved| &resolved.scene)
    }

    /// The box around everything but planes; empty where there is nothing.
    pub(super) fn bounds(&self) -> Aabb {
        let objects = self.scene().map_or(&[][..], |scene| &scene.objects);
        objects.iter().filter_map(|object| object.instance.bounds()).fold(Aabb::EMPTY, Aabb::union)
    }

    /// Submits the job that the description, the settings and this picture size make. Gives back
    /// what keeps the description from being a scene, if anything does.
    pub(super) fn submit(
        &mut self,
        description: &SceneDescription,
        interface: &InterfaceState,
        [width, height]: [u32; 2],
    ) -> Result<(), ResolveError> {
        let is_current = self
            .resolved
            .as_ref()
            .is_some_and(|resolved| same_picture(&resolved.description, description));
        if !is_current {
            let scene = Arc::new(resolve(description, &self.assets)?);
            self.resolved = Some(Resolved { description: description.clone(), scene });
        }
        let Some(resolved) = &self.resolved else { return Ok(()) };
        let render = &description.render;
        let accelerator = AcceleratorKind::ALL
            .get(interface.accelerator)
            .copied()
            .unwrap_or(AcceleratorKind::KdTree);
        let job = RenderJob {
            scene: Arc::clone(&resolved.scene),
            width,
            height,
            settings: RenderSettings::new(render, accelerator),
        };
        let Limits { seconds, noise_percent } = interface.limits;
        let goal = Goal { samples: render.samples, seconds, noise_percent };
        self.session.submit(&job, goal);
        self.job = Some(job);
        Ok(())
    }

    /// What was last asked of the renderer.
    pub(super) fn job(&self) -> Option<&RenderJob> {
        self.job.as_ref()
    }

    /// Whether a frame shows the scene as it is now.
    pub(super) fn is_current(&self, frame: &Frame) -> bool {
        self.job.as_ref() == Some(&frame.job)
    }

    /// Samples and noise of the picture of that generation, in order of samples; of another one
    /// nothing is known yet.
    pub(super) fn noise_of(&self, generation: u64) -> &[(u32, Noise)] {
        if self.noise_of == generation { &self.noise } else { &[] }
    }

    /// Keeps the newest estimate of the noise for the graph; another picture starts it anew.
    pub(super) fn note_noise(&mut self, generation: u64, samples: u32, noise: Option<Noise>) {
        if self.noise_of != generation
            || self.noise.last().is_some_and(|(before, _)| samples < *before)
        {
            self.noise.clear();
            self.noise_of = generation;
        }
        let is_new = self.noise.last().is_none_or(|(before, _)| *before < samples);
        if let Some(noise) = noise
            && is_new
            && 0 < samples
            && noise.percent.is_finite()
        {
            self.noise.push((samples, noise));
        }
        if MOST_ESTIMATES < self.noise.len() {
            let mut index = 0;
            self.noise.retain(|_| {
                index += 1;
                index % 2 == 0
            });
        }
    }
}

/// The picture's size in pixels: from the viewport's, the one the file gives, or both.
pub(super) fn picture_size(
    description: &SceneDescription,
    mode: SizeMode,
    viewport: [u32; 2],
) -> [u32; 2] {
    let given = [description.render.width, description.render.height];
    match mode {
        SizeMode::Fit => {
            let [room, of] = [viewport, given].map(|size| size.map(f64::from));
            let scale = (room[0] / of[0]).min(room[1] / of[1]);
            of.map(|side| (side * scale).round().max(1.0) as u32)
        }
        SizeMode::Fill => viewport,
        SizeMode::Fixed => given,
    }
}

/// Whether both descriptions resolve to the same scene: all but display and render settings.
fn same_picture(a: &SceneDescription, b: &SceneDescription) -> bool {
    a.camera == b.camera
        && a.environment == b.environment
        && a.lights == b.lights
        && a.objects == b.objects
        && a.materials == b.materials
        && a.textures == b.textures
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Course;

    #[test]
    fn the_noise_of_one_picture_is_not_told_of_another() {
        let mut work = RenderWork::new(Session::new(1, || {}).unwrap());
        let noise = |percent| Noise { percent, uncertainty: 0.1, course: Course::even(0.5) };
        for samples in [4, 8] {
            work.note_noise(3, samples, Some(noise(10.0)));
        }
        assert_eq!(work.noise_of(3).len(), 2, "its own");
        assert!(work.noise_of(4).is_empty(), "of a picture that has only begun");
        work.note_noise(4, 4, Some(noise(20.0)));
        assert!(work.noise_of(3).is_empty(), "of a picture that is over");
        assert_eq!(work.noise_of(4).len(), 1, "its own");
    }
}
