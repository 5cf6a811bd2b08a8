mod support;
use chen_planes::{Factor, Options, Placement, Visibility};
use common::gpu::bench;
use support::*;
#[test]
fn scratch() {
    let format = bench::context().radiance_format();
    let mut scene = boxes(point(), 0.1);
    for open in [false, true] {
        if open {
            scene.objects.clear();
        }
        let view = scene.camera.view(80, 60);
        let truth = reference(&scene, &view);
        for reach in [15.0, 30.0] {
            println!(
                "{:?}",
                chen_planes::slabs(Placement::Integrand, 16, reach, &view, &scene.medium, &scene.lights[0])
            );
            for p in [Placement::Even, Placement::EquiAngular, Placement::Transmittance, Placement::Integrand]
            {
                for (planes, samples) in [(1, 8), (1, 64), (16, 1), (16, 8), (64, 1), (64, 8)] {
                    let o = Options {
                        placement: p,
                        planes,
                        visibility: Visibility::PerFragment { samples },
                        offset: false,
                        ..Options::best(format)
                    };
                    let image = draw_to(&scene, &view, &o, 256, reach).unwrap();
                    let e = common::metrics::compare(&image, &truth).unwrap();
                    println!(
                        "open {open} reach {reach} {p:?} {planes} {samples}: {:.5} bias {:.5} max {:.4}",
                        e.rel_rmse, e.bias, e.max
                    );
                }
            }
        }
    }
}
