//! Cost of a law at one point in double precision, one point after the other: inside the
//! surface, and flowing by a hundredth of the strain in a step.
//!
//! `cargo bench -p powerhouse-material-damage`; the inverse of the throughput is the time per point.

use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use powerhouse_material_damage::{
    ConeFit, DruckerPrager, DruckerPragerParameters, ElastoPlastic, HoekBrown, HoekBrownParameters,
    LeeFenves, LinearElastic, Mazars, MohrCoulomb, SofteningPlasticity,
    SofteningPlasticityParameters, StrengthFall, TwoSurface, media, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain};

const POINTS: usize = 1000;

/// Strains of every direction, the largest component at most the amplitude.
fn strains(amplitude: f64) -> Vec<[f64; 6]> {
    let noise = |k: usize| (12.9898 * k as f64 + 0.3).sin();
    let strain = |point: usize| core::array::from_fn(|i| amplitude * noise(7 * point + i));
    (0..POINTS).map(strain).collect()
}

fn measure<M: ConstitutiveLaw>(
    group: &mut BenchmarkGroup<'_, criterion::measurement::WallTime>,
    name: &str,
    law: M,
    amplitude: f64,
) {
    let count = law.history().len();
    for (state, size) in [("elastic", 1.0e-4), ("flowing", 1.0)] {
        let strains = strains(size * amplitude);
        let mut old = vec![0.0; count * POINTS];
        let mut new = old.clone();
        let step = |old: &[f64], new: &mut [f64], share: f64| {
            let mut sum = 0.0;
            for (point, strain) in strains.iter().enumerate() {
                let range = count * point..count * (point + 1);
                let strain = Strain(strain.map(|e| share * e));
                let input = LawInput::new(strain, &old[range.clone()]).with_size(0.2);
                sum += law.stress_change(&input, &mut new[range]).0[0];
            }
            sum
        };
        step(&old, &mut new, 1.0);
        old.copy_from_slice(&new);
        group.bench_function(format!("{name}/{state}"), |bench| {
            bench.iter(|| step(&old, &mut new, 1.01));
        });
    }
}

fn points(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("point");
    group.throughput(Throughput::Elements(POINTS as u64));
    let sound = "the parameters of the benchmark are sound";
    measure(
        &mut group,
        "elastic",
        LinearElastic::new(media::ROCK),
        1.0e-2,
    );
    let surface = MohrCoulomb::new(presets::PAPER_ROCK).expect(sound);
    measure(
        &mut group,
        "mohr-coulomb",
        ElastoPlastic::new(surface),
        1.0e-2,
    );
    let surface = DruckerPrager::new(DruckerPragerParameters {
        medium: media::ROCK,
        friction: 42.0,
        dilation: 10.0,
        cohesion: 1.05e6,
        fit: ConeFit::Inscribed,
    });
    measure(
        &mut group,
        "drucker-prager",
        ElastoPlastic::new(surface.expect(sound)),
        1.0e-2,
    );
    let surface = TwoSurface::new(presets::PAPER_ROCK_LISTED).expect(sound);
    measure(
        &mut group,
        "two-surface",
        ElastoPlastic::new(surface),
        1.0e-2,
    );
    let surface = HoekBrown::new(HoekBrownParameters {
        medium: media::ROCK,
        intact_strength: 50.0e6,
        intact_constant: 10.0,
        strength_index: 45.0,
        disturbance: 0.0,
        dilation_share: 0.3,
    });
    measure(
        &mut group,
        "hoek-brown",
        ElastoPlastic::new(surface.expect(sound)),
        1.0e-2,
    );
    let law = SofteningPlasticity::new(SofteningPlasticityParameters {
        surface: MohrCoulomb::new(presets::PAPER_ROCK).expect(sound),
        fall: StrengthFall::FractureEnergy { energy: 2.0e4 },
        residual_strength: 0.2,
    });
    measure(&mut group, "softening", law.expect(sound), 1.0e-2);
    let law = presets::paper_concrete().expect(sound);
    measure(&mut group, "plastic-damage", law, 1.0e-3);
    let law = LeeFenves::new(presets::PAPER_CONCRETE_LEE_FENVES).expect(sound);
    measure(&mut group, "lee-fenves", law, 1.0e-3);
    let law = Mazars::new(presets::PAPER_CONCRETE_MAZARS).expect(sound);
    measure(&mut group, "mazars", law, 2.0e-4);
    group.finish();
}

criterion_group!(benches, points);
criterion_main!(benches);
