//! A technique that draws no more of a scene's fog than a model says.

use common::Scene;
use common::gpu::{LightBinding, PassTimer, Unshadowed, UnshadowedInputs};
use common::need::{Model, Shaft};

use super::{Frame, Method, Technique};
use crate::peers::reach;

/// A technique for the lights with shadows, and a full-screen pass for those without. What the model leaves out is handed
/// to neither.
pub(super) struct Reduced {
    model: Model,
    shadowed: Option<Box<dyn Technique>>,
    unshadowed: Option<Box<Unshadowed>>,
}

impl Method {
    /// As [`Method::make`], to draw what `model` says of a scene of so many lights.
    pub(crate) fn make_reduced(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        (model, lights): (&Model, usize),
    ) -> Result<Box<dyn Technique>, String> {
        if let Some(problem) = model.problem(lights) {
            return Err(format!("the model {problem}"));
        }
        if model.is_full() {
            return self.make(device, queue, format, size);
        }
        let is_cloud = self.technique == super::CLOUDS;
        if is_cloud && model.has(lights, Shaft::Unshadowed) {
            return Err(format!("{}: a cloud shadows itself; a light is `shadowed` or `off`", self.name));
        }
        let shadowed = model.has(lights, Shaft::Shadowed) || is_cloud;
        Ok(Box::new(Reduced {
            shadowed: shadowed.then(|| self.make(device, queue, format, size)).transpose()?,
            unshadowed: model
                .has(lights, Shaft::Unshadowed)
                .then(|| Box::new(Unshadowed::new(device, format))),
            model: model.clone(),
        }))
    }
}

impl Reduced {
    /// The part of a frame's scene and lights that is drawn in one way.
    fn part(&self, frame: &Frame<'_>, shaft: Shaft) -> (Scene, Vec<LightBinding>) {
        let scene = Scene {
            lights: self.model.of(&frame.scene.lights, shaft).cloned().collect(),
            medium: self.model.medium(&frame.scene.medium),
            // Everything is in its place, and a motion may be that of a light that is gone.
            animation: Vec::new(),
            ..frame.scene.clone()
        };
        (scene, self.model.of(frame.lights, shaft).cloned().collect())
    }
}

impl Technique for Reduced {
    fn prepare(&mut self, frame: &Frame<'_>) -> Result<(), String> {
        let Frame { device, queue, view, depth, .. } = *frame;
        let (scene, lights) = self.part(frame, Shaft::Unshadowed);
        if let Some(unshadowed) = &mut self.unshadowed {
            let (medium, reach) = (&scene.medium, reach(&scene, view));
            let inputs = UnshadowedInputs { view, medium, lights: &lights, depth, reach };
            unshadowed.prepare(device, queue, &inputs);
        }
        let (scene, lights) = self.part(frame, Shaft::Shadowed);
        match &mut self.shadowed {
            Some(shadowed) => shadowed.prepare(&Frame { scene: &scene, lights: &lights, ..*frame }),
            None => Ok(()),
        }
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView, timer: &mut PassTimer) {
        if let Some(shadowed) = &self.shadowed {
            shadowed.encode(encoder, target, timer);
        }
        if let Some(unshadowed) = &self.unshadowed {
            unshadowed.encode(encoder, target, timer);
        }
    }

    fn adaptive_triangles(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Option<u32> {
        self.shadowed.as_ref()?.adaptive_triangles(device, queue)
    }

    fn silhouette_edges(&self) -> Option<u64> {
        self.shadowed.as_ref()?.silhouette_edges()
    }
}

#[cfg(test)]
mod tests;
