//! What a frame costs on the CPU: silhouettes, the order of their planes, and the tables.

use biri_ss::table::{build_airlight, build_lambert, build_phong};
use biri_ss::{Bsp, Connectivity, Origin, Silhouette};
use common::Lobe;
use common::scene::builtin;
use criterion::{Criterion, criterion_group, criterion_main};
use glam::Vec3;

fn silhouettes(criterion: &mut Criterion) {
    let scene = builtin::build("complex-camera", None).expect("a built-in scene");
    let meshes: Vec<Connectivity> =
        scene.objects.iter().map(|object| Connectivity::new(&object.mesh)).collect();
    let origin = Origin::of(&scene.lights[0]);
    let mut group = criterion.benchmark_group(format!("{} triangles", scene.triangle_count()));
    group.sample_size(10);
    group.bench_function("connectivity", |b| {
        b.iter(|| scene.objects.iter().map(|o| Connectivity::new(&o.mesh).report().triangles).sum::<usize>())
    });
    // One core; objects of built-in scenes stand in the world already.
    group.bench_function("silhouettes", |b| {
        b.iter(|| meshes.iter().map(|mesh| Silhouette::new(mesh, origin).edges.len()).sum::<usize>())
    });
    let edges: Vec<([Vec3; 2], u32)> = meshes
        .iter()
        .flat_map(|mesh| {
            let found = Silhouette::new(mesh, origin);
            found.edges.into_iter().map(|e| ([e.from, e.to].map(|v| mesh.position(v)), e.weight))
        })
        .collect();
    group.bench_function(format!("order of {} planes", edges.len()), |b| b.iter(|| Bsp::new(origin, &edges)));
    let bsp = Bsp::new(origin, &edges);
    group.bench_function(format!("walk of {} pieces", bsp.pieces().len()), |b| {
        b.iter(|| bsp.order(scene.camera.eye).len())
    });
    group.finish();
}

fn tables(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("tables");
    group.sample_size(10);
    for (name, lobe) in [("isotropic", Lobe::Isotropic), ("g = 0.8", Lobe::HenyeyGreenstein { g: 0.8 })] {
        group.bench_function(format!("airlight, {name}"), |b| {
            b.iter(|| build_airlight(lobe, [256, 512], true))
        });
        group.bench_function(format!("Lambert, {name}"), |b| b.iter(|| build_lambert(lobe, true)));
        group.bench_function(format!("Phong, {name}"), |b| b.iter(|| build_phong(lobe, true)));
    }
    group.finish();
}

criterion_group!(benches, silhouettes, tables);
criterion_main!(benches);
