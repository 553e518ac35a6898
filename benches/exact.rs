//! Cost of exact sums: a term, the rounding, and the merging of partial sums.
//!
//! `cargo bench --bench exact`. Terms of one size, and of sizes over twelve orders of magnitude.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use powerhouse::engine::ExactSum;

const TERMS: u64 = 100_000;

/// Repeatable numbers in `[-1, 1)`.
fn noise(index: u64) -> f64 {
    let mixed = (index + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mixed = (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (mixed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn sums(criterion: &mut Criterion) {
    let one_size: Vec<f64> = (0..TERMS).map(noise).collect();
    let sizes = |index: u64| noise(index) * 2.0_f64.powi((index % 40) as i32 - 20);
    let many_sizes: Vec<f64> = (0..TERMS).map(sizes).collect();
    let mut group = criterion.benchmark_group("exact_sum");
    group.throughput(Throughput::Elements(TERMS));
    for (name, terms) in [("one_size", &one_size), ("many_sizes", &many_sizes)] {
        group.bench_function(name, |bencher| {
            bencher.iter(|| black_box(terms).iter().copied().collect::<ExactSum>());
        });
    }
    group.finish();
    let sum: ExactSum = many_sizes.into_iter().collect();
    criterion.bench_function("exact_sum/round", |bencher| {
        bencher.iter(|| black_box(&sum).round());
    });
    criterion.bench_function("exact_sum/merge", |bencher| {
        let mut all = ExactSum::new();
        bencher.iter(|| all.merge(black_box(&sum)));
    });
}

criterion_group!(benches, sums);
criterion_main!(benches);
