//! Small renders against the CPU reference and against known answers.

mod support;

use billeter_plv::{Accumulation, Evaluation, Options, Tessellation};
use support::{boxes, draw, errors, point, reference, spot, sun};

const F32: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

fn exact() -> Options {
    Options {
        target_format: F32,
        evaluation: Evaluation::Quadrature { panels: 1 },
        tessellation: Tessellation::Full,
        accumulation: Accumulation::F32,
        clamp_negative: false,
    }
}

#[test]
fn scratch() {
    for (name, light) in [("point", point()), ("spot", spot(0.6, 0.6)), ("soft", spot(0.3, 0.6)), ("sun", sun())] {
        let scene = boxes(light, 0.1);
        let view = scene.camera.view(160, 120);
        let truth = reference(&scene, &view);
        let e = truth.auto_exposure();
        truth.write_png(std::path::Path::new(&format!("/tmp/{name}_ref.png")), e).unwrap();
        for size in [256, 512] {
            let full = draw(&scene, &view, &exact(), size).unwrap();
            full.write_png(std::path::Path::new(&format!("/tmp/{name}_{size}.png")), e).unwrap();
            println!("{name} {size}: {:?}", errors(&full, &truth));
            let a = draw(&scene, &view, &Options{tessellation: Tessellation::Adaptive{tolerance:5e-4}, ..exact()}, size).unwrap();
            a.write_png(std::path::Path::new(&format!("/tmp/{name}_{size}a.png")), e).unwrap();
            println!("  adaptive: {:?}", errors(&a, &truth));
            if name != "soft" { let t = draw(&scene, &view, &Options{evaluation: Options::paper(F32).evaluation, ..exact()}, size).unwrap();
            println!("  table: {:?}", errors(&t, &truth)); }
        }
    }
}
