//! How long it takes to place a frame's planes.

use std::hint::black_box;

use chen_planes::{Placement, slabs};
use common::scene::builtin;
use criterion::{Criterion, criterion_group, criterion_main};

fn placement(criterion: &mut Criterion) {
    let scene = builtin::amphora(1_000);
    let view = scene.camera.view(640, 512);
    for placement in [Placement::EquiAngular, Placement::Transmittance, Placement::Integrand] {
        criterion.bench_function(&format!("{placement:?}"), |bencher| {
            bencher.iter(|| slabs(placement, 16, 20.0, black_box(&view), &scene.medium, &scene.lights[0]));
        });
    }
}

criterion_group!(benches, placement);
criterion_main!(benches);
