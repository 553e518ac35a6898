//! Independence of the bits from threads and lane width.

use powerhouse::engine::{BuildModel, Leapfrog, run};
use powerhouse_boundary::ViscousSpring;
use powerhouse_contact::TiedPairs;
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{IncidentField, LaneWidth, Precision, RunOptions, Vec3};
use powerhouse_tests::{Ground, oblique_waves};
use powerhouse_wavefield::WaveKind;

const FACES: [&str; 5] = ["left", "right", "front", "back", "bottom"];
const SIZE: Vec3 = Vec3::new(150.0, 130.0, 110.0);

/// Configuration of a run.
struct Case {
    kernel: SolidKernel,
    precision: Precision,
    field: Box<dyn IncidentField>,
}

impl Case {
    /// A kernel, and SV and P waves below the critical angle or an SV wave past it.
    fn new(kernel: SolidKernel, precision: Precision, past_critical: bool) -> Self {
        let below = [(WaveKind::SV, 30.0), (WaveKind::P, 10.0)];
        let past = [(WaveKind::SV, 42.0)];
        let waves = if past_critical { &past[..] } else { &below };
        Self {
            kernel,
            precision,
            field: Box::new(oblique_waves(media::ROCK, SIZE, waves, 37.0, 0.1)),
        }
    }

    /// The bits of every node's displacement and velocity after 60 steps through a box with an
    /// absorbing boundary and two tied nodes. The box is large enough for several blocks and
    /// loads, and its cells fill no lane evenly.
    fn bits(&self, lanes: LaneWidth, threads: usize) -> Vec<u64> {
        let mut ground = Ground::boxed(SIZE, [15, 13, 11], media::ROCK, self.kernel)
            .mapped(|p| p + 2.0 * Vec3::new((p.y * 0.1).sin(), (p.x * 0.09).cos(), 0.0));
        ground.options.precision = self.precision;
        ground.options.lanes = lanes;
        ground.threads = Some(threads);
        let tie = TiedPairs::new("tie", &[[700, 1900]]).unwrap();
        let mut model = ground
            .with_boundary(&ViscousSpring::default(), &FACES, Some(self.field.as_ref()))
            .constraint(Box::new(tie))
            .block_size(512)
            .build()
            .unwrap();
        let options = RunOptions::steps(60);
        run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        let nodes = 0..ground.mesh.node_count() as u32;
        let largest = nodes.clone().map(|node| model.displacement(node).norm());
        assert!(
            largest.fold(0.0, f64::max) > 0.05,
            "the wave has not arrived"
        );
        nodes
            .flat_map(|node| [model.displacement(node), model.velocity(node)])
            .flat_map(|v| [v.x, v.y, v.z])
            .map(f64::to_bits)
            .collect()
    }

    /// Fails if threads or lanes change a bit.
    fn check(&self) {
        let case = format!("{} {:?}", self.kernel.name(), self.precision);
        let reference = self.bits(LaneWidth::Native, 1);
        for threads in [2, 4] {
            let found = self.bits(LaneWidth::Native, threads);
            assert!(reference == found, "{case}: {threads} threads");
        }
        let one = self.bits(LaneWidth::One, 2);
        assert!(reference == one, "{case}: one lane");
    }
}

/// One, two and four threads, and one or several lanes, give the same bits for every kernel.
#[test]
fn threads_and_lanes_do_not_change_a_bit() {
    for kernel in SolidKernel::ALL {
        Case::new(kernel, Precision::F64, false).check();
    }
}

/// Threads and lanes do not change a bit in mixed and in single precision.
#[test]
fn threads_and_lanes_do_not_change_a_bit_in_single_precision() {
    for precision in [Precision::Mixed, Precision::F32] {
        Case::new(SolidKernel::ALL[0], precision, false).check();
    }
}

/// Threads and lanes do not change a bit past the critical angle, where the field is tabulated.
#[test]
fn threads_and_lanes_do_not_change_a_bit_past_the_critical_angle() {
    Case::new(SolidKernel::ALL[0], Precision::F64, true).check();
}
