//! What a pulse leaves behind in a column of elements of each kind: the ringing of their lumped masses.

use powerhouse::engine::{BuildModel, Leapfrog, run};
use powerhouse_boundary::{InputMode, Viscous};
use powerhouse_elements::SolidKernel;
use powerhouse_material_damage::media;
use powerhouse_model::{EnergyCheck, RunOptions, Support, Vec3};
use powerhouse_tests::Ground;

use super::stable_step::scatter;

/// Node spacing (m).
const SPACING: f64 = 0.5;

/// Root of the energy that a P pulse as long as `nodes` node spacings leaves in a column, over that which it had, after
/// dashpots have absorbed it; along one of the axes of the mesh.
fn left(kernel: SolidKernel, nodes: usize, (turned, jitter): (bool, f64)) -> f64 {
    // A cell of elements with midpoints is two spacings wide.
    let width = if kernel == SolidKernel::Tet10 { 1 } else { 2 };
    let along = 4 * nodes * width / 2;
    let (length, side) = (SPACING * (4 * nodes) as f64, 2.0 * SPACING);
    let axis = if turned { 0 } else { 2 };
    let (size, cells) = if turned {
        (Vec3::new(length, side, side), [along, width, width])
    } else {
        (Vec3::new(side, side, length), [width, width, along])
    };
    // Corners are moved along the axis, so that the sides stay plane.
    let mut ground = Ground::boxed(size, cells, media::ROCK, kernel).mapped(|x| {
        let inside = x[axis] > 0.1 * SPACING && x[axis] < length - 0.1 * SPACING;
        let seed = 7.0 * x.x + 113.0 * x.y + 1009.0 * x.z;
        let moved = if inside {
            jitter * scatter((16.0 * seed) as usize)
        } else {
            0.0
        };
        x + Vec3::ith(axis, moved)
    });
    ground.threads = Some(1);
    let speed = media::ROCK.p_speed();
    let pulse = SPACING * nodes as f64;
    // A bell from one to two lengths of the pulse, on its way to the far end.
    let motion = |x: &Vec3| {
        let phase = (x[axis] / pulse - 1.0).clamp(0.0, 1.0) * core::f64::consts::TAU;
        let slope = 0.5 * phase.sin() * core::f64::consts::TAU / pulse;
        (0.5 * (1.0 - phase.cos()), -speed * slope)
    };
    let boundary = Viscous {
        input: InputMode::Nothing,
    };
    let ends = [["left", "right"], ["front", "back"], ["bottom", "top"]];
    let model = || {
        let mut spec = ground.with_boundary(&boundary, &ends[axis], None);
        for (other, faces) in ends.iter().enumerate().filter(|(other, _)| *other != axis) {
            for face in faces {
                let nodes = ground.face_nodes(face);
                spec = spec.support(Support::roller(nodes, Vec3::ith(other, 1.0)));
            }
        }
        let mut model = spec.build().unwrap();
        let along = |value: f64| Vec3::ith(axis, value);
        let (u, v): (Vec<Vec3>, Vec<Vec3>) = (ground.mesh.positions().iter())
            .map(|x| (along(motion(x).0), along(motion(x).1)))
            .unzip();
        model.set_initial(&u, &v).unwrap();
        model
    };
    let energy = |steps: u64| {
        let options = RunOptions::steps(steps).with_energy(EnergyCheck::every(steps));
        let report = run(&mut model(), &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        let of = |name| {
            let mut columns = report.energies.iter();
            columns.find(|(column, _)| *column == name).unwrap().1
        };
        of("kinetic") + of("elastic") + of("hourglass") + of("bending")
    };
    let step = model().stable_step(&Leapfrog).unwrap().step;
    let steps = (4.0 * pulse / speed / step) as u64;
    (energy(steps) / energy(1)).sqrt()
}

/// A pulse of 28 node spacings leaves some hundredths of its amplitude in bricks, wedges, pyramids and tetrahedra of four nodes,
/// and at least three times as much in tetrahedra with midpoints, whose masses are uneven, whichever way it travels; on an
/// irregular mesh, on which all ring, half as much more.
#[test]
fn tetrahedra_with_midpoints_ring() {
    for regular in [true, false] {
        for turned in [false, true] {
            let way = (turned, if regular { 0.0 } else { 0.15 * SPACING });
            let of = |kernel| left(kernel, 28, way);
            let bricks = of(SolidKernel::Hex8Natural);
            println!("ringing of bricks = {bricks:.4}, regular {regular}, turned {turned}");
            for kernel in SolidKernel::ALL {
                let (found, half) = (of(kernel), left(kernel, 14, way));
                println!("ringing of {} = {found:.4}, {half:.4}", kernel.name());
                if kernel == SolidKernel::Tet10 {
                    let least = if regular { 3.0 } else { 1.5 };
                    assert!(found > least * bricks && found < 0.12, "{way:?} {found}");
                } else {
                    assert!(found < 2.0 * bricks, "{} {way:?} {found}", kernel.name());
                }
            }
        }
    }
}
