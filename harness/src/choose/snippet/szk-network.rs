/// The cloud as particles.
pub fn particles(cloud: &common::Cloud) -> Result<szk_network::Particles, szk_network::Error> {
    use szk_network::*;
    Particles::sample(cloud, 1024, Sampling::Random { seed: 1 })
}

/// Options of `szk_network::Renderer` for targets of a format.
pub fn options(target_format: wgpu::TextureFormat) -> szk_network::Options {
    use szk_network::*;
    Options {
        target_format,
        colours: Colours::Rgb,
        conserving: false,
        corrected: false,
        direction_set: DirectionSet::Random { seed: 1 },
        directions: 128,
        incidence: Incidence::Nearest,
        opacity: Opacity::Link,
        overlap: 2.0,
        per_fragment: false,
        quadrature: Quadrature::Points,
        samples: 1,
        scattering: Scattering::Full,
        turned: false,
        window: None,
    }
}

/// How much of the scene's fog is drawn: which lights are handed to the renderer, and in which medium.
pub fn model() -> common::need::Model {
    use common::need::*;
    Model { lights: vec![Shaft::Shadowed, Shaft::Off], grey: true, phase: PhaseModel::Isotropic }
}
