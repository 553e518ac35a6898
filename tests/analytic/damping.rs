//! Columns with frequency-independent damping over a band.

use core::f64::consts::{FRAC_PI_2, TAU};

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::{
    DampingBand, FlatDamping, LinearElastic, ReferenceFrequency, RelaxationSpectrum, media,
};
use powerhouse_model::{
    BlockOptions, ConstitutiveLaw, EnergyCheck, Mesh, RunOptions, Support, Vec3,
};
use powerhouse_tests::{elastic, motion_at};

const BRICKS: usize = 40;

fn damped() -> FlatDamping<LinearElastic> {
    let band = DampingBand {
        ratio: 0.05,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 3,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let rock = LinearElastic::new(media::ROCK);
    FlatDamping::new(rock, spectrum, ReferenceFrequency::Centre).unwrap()
}

/// A column of a given height, one element wide.
fn column(height: f64) -> Mesh {
    let width = height / BRICKS as f64;
    let size = Vec3::new(width, width, height);
    Mesh::box_of_hexes(Vec3::zeros(), size, [1, 1, BRICKS], "ground").unwrap()
}

/// The column on a fixed foot in shear along x, with the velocity of its first mode.
fn swinging(mesh: &Mesh) -> Model {
    let factory = SolidKernel::ONE_POINT.factory("ground", damped(), BlockOptions::default());
    let all: Vec<u32> = (0..mesh.node_count() as u32).collect();
    let mut model = Model::builder(mesh)
        .elements("ground", factory)
        .support(Support::roller(all.clone(), Vec3::y()))
        .support(Support::roller(all, Vec3::z()))
        .support(Support::fixed(
            mesh.nodes_of_facets(mesh.facet_set("bottom").unwrap()),
        ))
        .build()
        .unwrap();
    let height = mesh.bounding_box().1.z;
    let velocity: Vec<Vec3> = (mesh.positions().iter())
        .map(|p| Vec3::x() * (FRAC_PI_2 * p.z / height).sin())
        .collect();
    let rest = vec![Vec3::zeros(); velocity.len()];
    model.set_initial(&rest, &velocity).unwrap();
    model
}

/// The oscillator of the first mode: `u'' = -w^2 (u + sum y_l (u - v_l))`,
/// `v_l' = w_l (u - v_l)`, by the Runge-Kutta method of fourth order; `w` that of static moduli.
fn oscillator(spectrum: &RelaxationSpectrum, angular: f64, times: &[f64]) -> Vec<f64> {
    let mechanisms = spectrum.mechanisms();
    let rate = |state: &[f64]| -> Vec<f64> {
        let mut out = vec![state[1], -angular * angular * state[0]];
        for (mechanism, v) in mechanisms.iter().zip(&state[2..]) {
            out[1] -= angular * angular * mechanism.weight * (state[0] - v);
            out.push(TAU * mechanism.frequency * (state[0] - v));
        }
        out
    };
    let along = |state: &[f64], slope: &[f64], step: f64| -> Vec<f64> {
        let pairs = state.iter().zip(slope);
        pairs.map(|(x, dx)| x + step * dx).collect()
    };
    let mut state = vec![0.0; 2 + mechanisms.len()];
    state[1] = 1.0;
    let mut now = 0.0;
    let mut motion = Vec::new();
    for &time in times {
        let parts = 8;
        let step = (time - now) / f64::from(parts);
        for _ in 0..parts {
            let a = rate(&state);
            let b = rate(&along(&state, &a, 0.5 * step));
            let c = rate(&along(&state, &b, 0.5 * step));
            let d = rate(&along(&state, &c, step));
            for (i, x) in state.iter_mut().enumerate() {
                *x += step / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
            }
        }
        now = time;
        motion.push(state[0]);
    }
    motion
}

/// The first mode of a damped column has the motion of the damped oscillator of its frequency, at 0.7, 3 and 12
/// Hz. With 40 elements per quarter wave the error is at most 1e-4 of a period, and 2 pi times that of the
/// amplitude in each of six periods.
#[test]
fn a_damped_column_is_a_damped_oscillator() {
    let law = damped();
    for frequency in [0.7, 3.0, 12.0] {
        let mesh = column(media::ROCK.s_speed() / (4.0 * frequency));
        let mut model = swinging(&mesh);
        let top = mesh.nodes_of_facets(mesh.facet_set("top").unwrap())[0];
        let motion = motion_at(&mut model, top, 6.0 / frequency);
        let times: Vec<f64> = motion.iter().map(|(time, _)| *time).collect();
        let relaxed = TAU * frequency * law.velocity(1.0e-9);
        let expected = oscillator(law.spectrum().unwrap(), relaxed, &times);
        let largest = expected.iter().fold(0.0_f64, |most, u| most.max(u.abs()));
        let worst = (motion.iter().zip(&expected))
            .fold(0.0_f64, |most, ((_, u), e)| most.max((u.x - e).abs()));

        let peaks: Vec<f64> = (motion.windows(3))
            .map(|w| [w[0].1.x, w[1].1.x, w[2].1.x])
            .filter(|[a, b, c]| b > a && b >= c && *b > 0.0)
            .map(|[_, b, _]| b)
            .collect();
        let decrement = (peaks[1] / peaks[4]).ln() / 3.0;
        println!(
            "{frequency:4.1} Hz: free decay of {:.2} % of critical, misfit {:.1e}",
            100.0 * decrement / TAU.hypot(decrement),
            worst / largest
        );
        assert!(worst < 6.0 * TAU * 1.0e-4 * largest, "{worst} {largest}");
    }
}

/// The energy balance closes with relaxation as a term of its own: in the end the mechanisms have dissipated
/// the initial energy, and plastic flow, damage and rounding nothing.
#[test]
fn the_energy_balance_closes_with_relaxation() {
    let mesh = column(media::ROCK.s_speed() / 12.0);
    let mut model = swinging(&mesh);
    let options = RunOptions::seconds(8.0).with_energy(EnergyCheck::every(100));
    let report = run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    assert!(
        report.energy_residual < 1.0e-12,
        "{}",
        report.energy_residual
    );
    let column = |name| {
        let mut columns = report.energies.iter();
        columns.find(|(column, _)| *column == name).unwrap().1
    };
    for none in ["plastic", "damage", "recovery", "integration"] {
        assert_eq!(column(none), 0.0, "{none}");
    }
    // Half the mass of the column vibrates with 1 m/s at its top.
    let width = mesh.bounding_box().1.x;
    let height = mesh.bounding_box().1.z;
    let begun = 0.25 * media::ROCK.density * width * width * height;
    let taken = column("relaxation");
    assert!((taken / begun - 1.0).abs() < 1.0e-3, "{taken} {begun}");
}

/// The energy balance has the same bits however often it is read: the stored energy, computed at readings alone, is that of the
/// step, and the work between them is that of every step.
#[test]
fn the_energy_balance_has_the_same_bits_however_often_it_is_read() {
    let mesh = column(media::ROCK.s_speed() / 12.0);
    let balance = |every: u64| {
        let options = RunOptions::seconds(0.5).with_energy(EnergyCheck::every(every));
        let model = &mut swinging(&mesh);
        run(model, &Leapfrog, &options, &mut [], &mut |_| {})
            .unwrap()
            .energies
    };
    let in_every_step = balance(1);
    let relaxed = in_every_step.iter().find(|(name, _)| *name == "relaxation");
    assert!(relaxed.unwrap().1 > 0.0);
    for every in [7, 100, u64::MAX] {
        let residual = |(name, _): &&(&str, f64)| *name != "residual";
        let known: Vec<_> = in_every_step.iter().filter(residual).collect();
        let found = balance(every);
        assert_eq!(known, found.iter().filter(residual).collect::<Vec<_>>());
    }
}

/// Damping of 5 % over 0.5 to 20 Hz costs at most 12 % of the stable step of the undamped column,
/// however fine its elements.
#[test]
fn flat_damping_costs_little_of_the_step() {
    for height in [4.0, 400.0] {
        let mesh = column(height);
        let kernel = SolidKernel::Hex8OnePoint(Default::default());
        let plain = elastic("ground", kernel, media::ROCK, BlockOptions::default());
        let plain = Model::builder(&mesh).elements("ground", plain).build();
        let plain = plain.unwrap().stable_step(&Leapfrog).unwrap().step;
        let damped = swinging(&mesh).stable_step(&Leapfrog).unwrap().step;
        assert!(damped > 0.88 * plain, "{damped} {plain}");
    }
}

/// A damped run that is continued by another model has the same bits as an uninterrupted one.
#[test]
fn a_continued_damped_run_has_the_same_bits() {
    let mesh = column(100.0);
    let go = |model: &mut Model, steps| {
        let options = RunOptions::steps(steps);
        run(model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    };
    let mut whole = swinging(&mesh);
    go(&mut whole, 700);
    let mut first = swinging(&mesh);
    go(&mut first, 300);
    let state = first.state();
    let mut second = swinging(&mesh);
    second.set_state(&state).unwrap();
    go(&mut second, 400);
    for node in 0..mesh.node_count() as u32 {
        assert_eq!(whole.displacement(node), second.displacement(node));
        assert_eq!(whole.velocity(node), second.velocity(node));
    }
    assert!(damped().history().len() == state.history.len());
}
