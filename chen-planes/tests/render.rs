//! Small renders against the CPU reference and against known answers.

mod support;

use chen_planes::{Factor, Options, Placement, Visibility};
use common::gpu::bench;
use support::{assert_sane, boxes, draw, errors, point, reference, spot, sun};

fn format() -> wgpu::TextureFormat {
    bench::context().radiance_format()
}

#[test]
fn boxes_are_drawn_as_by_the_reference() {
    for (name, light, bound) in [
        ("point", point(), 0.03),
        ("spot", spot(0.6, 0.6), 0.03),
        ("soft", spot(0.3, 0.6), 0.03),
        ("sun", sun(), 0.03),
    ] {
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(80, 60);
        let truth = reference(&scene, &view);
        for (setting, options) in [
            ("best", Options::best(format())),
            ("best without offset", Options { offset: false, ..Options::best(format()) }),
            ("best, 64 planes", Options { planes: 64, offset: false, ..Options::best(format()) }),
            ("best, even", Options { placement: Placement::Even, offset: false, ..Options::best(format()) }),
            ("paper", Options::paper(format())),
            ("paper, 400", Options { planes: 400, ..Options::paper(format()) }),
            ("paper + attenuation", Options { factor: Factor::Attenuation, ..Options::paper(format()) }),
            ("paper + integrated", Options { factor: Factor::Integrated, ..Options::paper(format()) }),
            (
                "paper, lattice",
                Options { visibility: Visibility::PerLatticePoint, ..Options::paper(format()) },
            ),
        ] {
            let image = draw(&scene, &view, &options, 256).unwrap();
            assert_sane(&image, name);
            let (rms, worst) = errors(&image, &truth);
            println!("{name}, {setting}: {rms:.5} rms, {worst:.3} worst");
            assert!(rms < 10.0 * bound, "{name}: {rms}");
        }
    }
}
