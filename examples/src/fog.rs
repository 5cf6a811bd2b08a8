//! **Here two techniques go into a renderer**: polygonal light volumes for its lamp, sampling planes for its sun.
//!
//! A technique is made once ([`Fog::new`]), told about every frame ([`Fog::prepare`]), and draws into the renderer's own
//! encoder behind the surfaces ([`Fog::encode`]). What it needs: the matrices that the eye's depth is drawn
//! with, that depth as a texture, the lights' shadow maps with *their* matrices, and a target to add to.

use anyhow::Result;
use common::gpu::{ForeignMap, PassTimer};
use common::{DirectionalLight, Light, Lobe, Medium, SpotLight, View};
use glam::Vec3;

use crate::scene::{Moment, SIGMA_T};

/// The fog, and what draws light in it.
pub struct Fog {
    medium: Medium,
    lamp_map: ForeignMap,
    sun_map: ForeignMap,
    volumes: billeter_plv::Renderer,
    planes: chen_planes::Renderer,
}

/// Which lights are seen in the fog.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shafts {
    /// The lamp's, by `billeter-plv`.
    pub lamp: bool,
    /// The sun's, by `chen-planes`.
    pub sun: bool,
}

impl Fog {
    /// Once: the techniques, for a target of `format`, and the renderer's shadow maps, whatever their format.
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        format: wgpu::TextureFormat,
        [lamp_map, sun_map]: [&wgpu::Texture; 2],
    ) -> Result<Self> {
        // Lit intervals along each ray: of the light volume's two forms the faster one.
        let volumes = billeter_plv::Options::rays(format);
        let planes = chen_planes::Options { target_format: format, ..Default::default() };
        Ok(Self {
            medium: Medium::grey(SIGMA_T, 0.9, Lobe::HenyeyGreenstein { g: 0.4 }.into()),
            lamp_map: ForeignMap::new(lamp_map, 0..1)?,
            sun_map: ForeignMap::new(sun_map, 0..1)?,
            volumes: billeter_plv::Renderer::new(device, queue, &volumes)?,
            planes: chen_planes::Renderer::new(device, queue, &planes)?,
        })
    }

    /// Every frame, before it is submitted: what is where. `depth` is the eye's depth buffer, of `width` × `height` pixels;
    /// where that size has changed, the techniques change theirs.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        moment: &Moment,
        depth: &wgpu::TextureView,
        shafts: Shafts,
    ) -> Result<()> {
        // The eye, from the renderer's own matrices: they say what its depth means.
        let (width, height) = (depth.texture().width(), depth.texture().height());
        let view = View::from_matrices(moment.view_from_world, moment.clip_from_view, width, height)?;

        if shafts.lamp {
            // The light, with the renderer's own shadow map and the matrix that it was drawn with.
            let light = spot_light(moment);
            let matrices = [moment.lamp.clip_from_world];
            let lights = [self.lamp_map.prepare(device, queue, &light, &matrices, moment.bounds)?];
            let inputs = billeter_plv::Inputs { view: &view, medium: &self.medium, lights: &lights, depth };
            self.volumes.prepare(device, queue, &inputs)?;
        }
        if shafts.sun {
            let light = sun_light(moment);
            let matrices = [moment.sun.clip_from_world];
            let reach =
                chen_planes::reach(&view, Some(moment.bounds), std::slice::from_ref(&light), &self.medium);
            let lights = [self.sun_map.prepare(device, queue, &light, &matrices, moment.bounds)?];
            let inputs =
                chen_planes::Inputs { view: &view, medium: &self.medium, lights: &lights, depth, reach };
            self.planes.prepare(device, queue, &inputs)?;
        }
        Ok(())
    }

    /// Every frame, behind the passes that draw shadow maps, depth and surfaces: adds light in fog to the radiance.
    pub fn encode(&self, encoder: &mut wgpu::CommandEncoder, radiance: &wgpu::TextureView, shafts: Shafts) {
        let mut timer = PassTimer::off();
        if shafts.lamp {
            self.lamp_map.encode(encoder, &mut timer);
            self.volumes.encode(encoder, radiance, &mut timer);
        }
        if shafts.sun {
            self.sun_map.encode(encoder, &mut timer);
            self.planes.encode(encoder, radiance, &mut timer);
        }
    }
}

/// The renderer's lamp in the techniques' words.
fn spot_light(moment: &Moment) -> Light {
    let lamp = &moment.lamp;
    let [inner_angle, outer_angle] = lamp.angles;
    Light::Spot(SpotLight {
        position: lamp.position,
        direction: lamp.direction,
        up: Vec3::Y,
        intensity: lamp.intensity,
        inner_angle,
        outer_angle,
        light_map: None,
    })
}

/// The renderer's sun.
fn sun_light(moment: &Moment) -> Light {
    let sun = &moment.sun;
    Light::Directional(DirectionalLight { direction: sun.direction, irradiance: sun.irradiance })
}
