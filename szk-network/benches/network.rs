//! What a cloud costs on the CPU: particles, the phase matrix and its components.

use std::hint::black_box;

use common::scene::builtin;
use common::{Lobe, Phase};
use criterion::{Criterion, criterion_group, criterion_main};
use szk_network::{DirectionSet, Options, Particles, PhaseMatrix, Plan, Quadrature, Sampling};

fn loading(criterion: &mut Criterion) {
    let scene = builtin::build("cloud", None).expect("a built-in scene");
    let cloud = scene.cloud.as_ref().expect("the scene has a cloud");
    let particles = Particles::sample(cloud, 4096, Sampling::Even).expect("a cloud with medium in it");
    let mut group = criterion.benchmark_group("cloud");
    group.sample_size(10);
    group.bench_function("4096 particles", |b| {
        b.iter(|| Particles::sample(black_box(cloud), 4096, Sampling::Even).map(|p| p.list.len()))
    });
    group.bench_function("plan", |b| {
        b.iter(|| Plan::new(black_box(&particles), &Options::default()).map(|p| p.pixels))
    });
    group.finish();
}

fn phase(criterion: &mut Criterion) {
    let phase: Phase = Lobe::HenyeyGreenstein { g: 0.5 }.into();
    let mut group = criterion.benchmark_group("phase matrix");
    group.sample_size(10);
    for count in [128, 512] {
        let directions = DirectionSet::Fibonacci.directions(count);
        group.bench_function(format!("{count} directions"), |b| {
            b.iter(|| PhaseMatrix::new(&directions, black_box(&phase), Quadrature::Cells).conserving())
        });
        let matrix = PhaseMatrix::new(&directions, &phase, Quadrature::Cells).conserving();
        group.bench_function(format!("components of {count}"), |b| {
            b.iter(|| black_box(&matrix).components(0.03).values.len())
        });
    }
    group.finish();
}

criterion_group!(benches, loading, phase);
criterion_main!(benches);
