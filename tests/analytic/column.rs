//! Columns of hexahedra: natural periods, and vertical waves under a free surface.

use powerhouse::engine::BuildModel;
use powerhouse_boundary::{InputMode, Viscous};
use powerhouse_elements::SolidKernel;
use powerhouse_model::{ElasticMedium, ModelSpec, Support, Vec3};
use powerhouse_tests::{Ground, field_misfit, motion_at, oblique_waves};
use powerhouse_wavefield::WaveKind;

/// A column with a number of elements in height, one element wide.
fn column(height: f64, width: f64, bricks: usize, medium: ElasticMedium) -> Ground {
    let kernel = SolidKernel::Hex8OnePoint(Default::default());
    Ground::boxed(
        Vec3::new(width, width, height),
        [1, 1, bricks],
        medium,
        kernel,
    )
}

/// Restricts the nodes to motion along one axis.
fn along<'a>(ground: &Ground, builder: ModelSpec<'a>, axis: usize) -> ModelSpec<'a> {
    let all: Vec<u32> = (0..ground.mesh.node_count() as u32).collect();
    let across = (0..3)
        .filter(|&other| other != axis)
        .map(|other| Vec3::ith(other, 1.0));
    across.fold(builder, |builder, normal| {
        builder.support(Support::roller(all.clone(), normal))
    })
}

/// The period of a column that is fixed at its foot and starts with the velocity of its first
/// mode along `axis`; `confined` columns move along that axis only.
fn first_period(medium: ElasticMedium, axis: usize, confined: bool, expected: f64) -> f64 {
    let height = 800.0;
    let ground = column(height, 100.0, 64, medium);
    let mut builder = ground.free();
    if confined {
        builder = along(&ground, builder, axis);
    }
    let foot = ground.face_nodes("bottom");
    let mut model = builder.support(Support::fixed(foot)).build().unwrap();
    let mode = |p: &Vec3| (core::f64::consts::FRAC_PI_2 * p.z / height).sin();
    let positions = ground.mesh.positions();
    let velocity: Vec<Vec3> = positions.iter().map(|p| Vec3::ith(axis, mode(p))).collect();
    let rest = vec![Vec3::zeros(); velocity.len()];
    model.set_initial(&rest, &velocity).unwrap();
    let top = ground.face_nodes("top")[0];
    let motion = motion_at(&mut model, top, 2.2 * expected);
    // Times at which the displacement passes zero on its way down and up again.
    let crossings: Vec<f64> = motion
        .windows(2)
        .filter_map(|pair| {
            let [(t0, u0), (t1, u1)] = [pair[0], pair[1]];
            let (u0, u1) = (u0[axis], u1[axis]);
            (u0 != 0.0 && u0 * u1 <= 0.0).then(|| t0 + (t1 - t0) * u0 / (u0 - u1))
        })
        .collect();
    crossings[2] - crossings[0]
}

/// A medium of density 1 from bulk and shear modulus (Pa).
fn of_moduli(bulk: f64, shear: f64) -> ElasticMedium {
    let young = 9.0 * bulk * shear / (3.0 * bulk + shear);
    let poisson = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear);
    ElasticMedium::new(young, poisson, 1.0).unwrap()
}

/// A column on a fixed foot vibrates with the period 4 H / c, with c of P waves for axial motion with confined
/// sides and c of S waves for shear.
///
/// With 64 linear elements per quarter wave the relative error is at most (k h)^2 / 24 = 2.5e-5.
#[test]
fn columns_swing_with_four_transits() {
    let confined = of_moduli(2.0e4, 0.428562e4);
    let period = 4.0 * 800.0 / confined.p_speed();
    let found = first_period(confined, 2, true, period);
    assert!((found - period).abs() < 3e-5 * period, "{found} {period}");
    // FLAC's verification manual lists 19.956 s for this case and 32 s for the next.
    assert!((period - 19.956).abs() < 1e-3);

    let sheared = of_moduli(1.0e4, 1.0e4);
    let found = first_period(sheared, 0, true, 32.0);
    assert!((found - 32.0).abs() < 3e-5 * 32.0, "{found}");
}

/// With free sides the axial stiffness is Young's modulus; lateral inertia increases the period by (nu k r)^2 /
/// 2, with r^2 = w^2 / 6 the squared polar radius of gyration of the section.
#[test]
fn a_free_column_swings_with_the_speed_of_a_bar() {
    let medium = of_moduli(2.0e4, 0.428562e4);
    let bar = 4.0 * 800.0 / (medium.young / medium.density).sqrt();
    let wave_number = core::f64::consts::FRAC_PI_2 / 800.0;
    let inertia = 0.5 * (medium.poisson * wave_number).powi(2) * 100.0 * 100.0 / 6.0;
    let found = first_period(medium, 2, false, bar);
    // The foot, fixed laterally, too, stiffens the column over about one width of its height.
    assert!(
        found < bar * (1.0 + inertia) && found > 0.98 * bar,
        "{found} {bar} {inertia}"
    );
}

/// A pulse incident at the foot of a column is doubled at its free top after one transit time, and has left the
/// column after two; for S and P waves, with the full field or only the incident wave at the dashpots.
///
/// The column is that of OpenSees' example of an absorbing boundary: 140 m, E 3 GPa, nu 0.3,
/// 2100 kg/m3; an S wave needs 0.18887 s.
#[test]
fn a_vertical_pulse_doubles_at_the_surface_and_leaves() {
    let medium = ElasticMedium::new(3.0e9, 0.3, 2100.0).unwrap();
    let transit = 140.0 / medium.s_speed();
    assert!((transit - 0.18887).abs() < 1e-5);
    let incident_only = InputMode::IncidentOnly {
        faces: vec!["bottom".into()],
    };
    for (kind, axis) in [(WaveKind::SV, 0), (WaveKind::P, 2)] {
        for input in [InputMode::FullField, incident_only.clone()] {
            let ground = column(140.0, 1.0, 140, medium);
            let size = Vec3::new(1.0, 1.0, 140.0);
            let field = oblique_waves(medium, size, &[(kind, 0.0)], 0.0, 0.2);
            let model = || {
                let boundary = Viscous {
                    input: input.clone(),
                };
                let builder = ground.with_boundary(&boundary, &["bottom"], Some(&field));
                along(&ground, builder, axis).build().unwrap()
            };
            let misfit = field_misfit(&mut model(), &field, 0.7);
            assert!(misfit < 2e-3, "{kind:?} {input:?}: {misfit}");
            let top = ground.face_nodes("top")[0];
            let motion = motion_at(&mut model(), top, 0.7);
            let peak = motion
                .iter()
                .map(|(_, u)| u[axis].abs())
                .fold(0.0, f64::max);
            assert!((peak - 2.0).abs() < 4e-3, "{kind:?} {input:?}: {peak}");
            let last = motion.last().unwrap().1;
            assert!(last.norm() < 1e-3, "{kind:?} {input:?}: {last}");
        }
    }
}
