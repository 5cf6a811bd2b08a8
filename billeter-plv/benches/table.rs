//! What the look-up table costs on the CPU when the phase function changes.

use billeter_plv::table::{build_tables, compute_ahead};
use common::Lobe;
use criterion::{Criterion, criterion_group, criterion_main};

fn tables(criterion: &mut Criterion) {
    let lobe = Lobe::HenyeyGreenstein { g: 0.5 };
    criterion.bench_function("one entry", |b| b.iter(|| compute_ahead(lobe, 0.7, 0.2)));
    let mut group = criterion.benchmark_group("table");
    group.sample_size(10);
    for (width, height) in [(256, 128), (1024, 512)] {
        group.bench_function(format!("{width}x{height}"), |b| b.iter(|| build_tables(lobe, width, height)));
    }
    group.finish();
}

criterion_group!(benches, tables);
criterion_main!(benches);
