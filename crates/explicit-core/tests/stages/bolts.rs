//! Rock bolts.

use nalgebra::DMatrix;
use powerhouse_elements::{
    BoltEnd, BoltLine, BoltParameters, BoltPattern, BoltSet, Grout, NodalForce,
};
use powerhouse_explicit_core::{BuildModel, Leapfrog, Model, run, run_stages};
use powerhouse_model::{
    BlockContext, BlockPart, Cadence, ElasticMedium, ElementBlock, EnergyCheck, Mesh, NodalView,
    NodalViewMut, Operator, Prescribed, Quad, RunOptions, Stage, StageModel, State, StaticOptions,
    StepChoice, StepTime, Strain, Support, Vec3,
};
use powerhouse_observe::BoltHistories;

use super::{
    GRAVITY, absorbing, bent_box, elastic, elastic_body, face_nodes, largest, on_rollers, rock,
};

/// A step of a length (s), at time zero.
fn when(number: u64, step: f64) -> StepTime {
    StepTime {
        number,
        time: 0.0,
        step,
    }
}

fn all_elements(mesh: &Mesh) -> Vec<u32> {
    (0..mesh.element_count() as u32).collect()
}

/// The axial forces of bolts in a body of which every node has a displacement.
fn forces_under(mesh: &Mesh, bolts: &BoltSet, displacement: impl Fn(&Vec3) -> Vec3) -> Vec<f64> {
    let mut model = elastic_body(mesh)
        .embed(Box::new(bolts.clone()))
        .build()
        .unwrap();
    let field: Vec<Vec3> = mesh.positions().iter().map(displacement).collect();
    let still = vec![Vec3::zeros(); mesh.node_count()];
    model.set_initial(&field, &still).unwrap();
    // Nothing moves in so short a step.
    let options = RunOptions::steps(2).with_step(StepChoice::Unchecked(1.0e-14));
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    bolts.axial_forces(&model.state()).unwrap()
}

/// Bars at any angle across bent elements bear `N_0 + E A b . e b` under a uniform strain `e`, to
/// 1e-8 in every segment, and no more than the force at which they yield; segments add up to the
/// bar. A rigid turn leaves them as they are.
#[test]
fn a_bar_has_the_strain_of_the_rock() {
    let mesh = bent_box(Vec3::new(8.0, 6.0, 6.0), [6, 5, 4], 0.4);
    let lines = [
        ([1.0, 1.0, 0.5], [7.0, 5.0, 5.5]),
        ([0.0, 3.0, 3.0], [8.0, 3.0, 3.0]),
        ([4.0, 3.0, 6.0], [4.3, 2.6, 0.7]),
        ([7.5, 5.5, 5.0], [0.7, 0.4, 1.3]),
    ]
    .map(|(head, toe)| BoltLine {
        head: head.into(),
        toe: toe.into(),
    });
    let strain = Strain([3.0e-4, -2.0e-4, 1.0e-4, 4.0e-4, -1.0e-4, 2.5e-4]);
    let [xx, yy, zz, xy, yz, zx] = strain.0;
    let stretched = |p: &Vec3| {
        Vec3::new(
            xx * p.x + xy * p.y,
            yy * p.y + yz * p.z,
            zx * p.x + zz * p.z,
        )
    };
    let steel = BoltParameters {
        pretension: 20.0e3,
        ..BoltParameters::steel(0.025).unwrap()
    };
    let yielding = BoltParameters {
        yield_force: 30.0e3,
        ..steel
    };
    for parameters in [steel, yielding] {
        let hosts = all_elements(&mesh);
        let bolts = BoltSet::new("bolts", &mesh, &hosts, &lines, parameters).unwrap();
        let forces = forces_under(&mesh, &bolts, stretched);
        let turned = forces_under(&mesh, &bolts, |p| {
            Vec3::new(1.0, -2.0, 0.5) + Vec3::new(1.0e-3, 2.0e-3, -1.0e-3).cross(p)
        });
        let mut place = 0;
        for (bolt, line) in lines.iter().enumerate() {
            let along = line.toe - line.head;
            let b = along.normalize();
            let [x, y, z] = [b.x, b.y, b.z];
            let stretch =
                xx * x * x + yy * y * y + zz * z * z + xy * x * y + yz * y * z + zx * z * x;
            let free = parameters.pretension + parameters.young * parameters.area * stretch;
            let expected = free.clamp(-parameters.yield_force, parameters.yield_force);
            let segments = bolts.segments(bolt);
            assert!(segments.len() > 4, "{}", segments.len());
            let mut length = 0.0;
            for segment in segments {
                assert!((forces[place] - expected).abs() < 1.0e-8 * expected.abs());
                assert!((turned[place] - parameters.pretension).abs() < 1.0e-8 * 20.0e3);
                assert!((segment.start - length).abs() < 1.0e-9 * along.norm());
                length += segment.length;
                place += 1;
            }
            assert!((length - along.norm()).abs() < 1.0e-9 * along.norm());
        }
        assert_eq!(place, forces.len());
    }
}

/// Two halves of a body, cut at x = 0, that are drawn apart by an opening: the greatest axial force
/// of a bolt across the cut.
fn drawn(opening: f64, parameters: BoltParameters) -> f64 {
    let mut builder = Mesh::builder();
    let halves = [(-3.0, "left"), (0.0, "right")];
    let (mut tag, mut element) = (0, 0);
    for (from, set) in halves {
        let half = Mesh::box_of_hexes(
            Vec3::new(from, -0.5, -0.5),
            Vec3::new(from + 3.0, 0.5, 0.5),
            [6, 2, 2],
            set,
        )
        .unwrap();
        for p in half.positions() {
            tag += 1;
            builder.node(tag, *p);
        }
        let before = tag - half.node_count() as u64 + 1;
        for e in 0..half.element_count() as u32 {
            element += 1;
            let nodes = half.nodes_of(e).iter().map(|&n| before + u64::from(n));
            let nodes: Vec<u64> = nodes.collect();
            builder.element(element, half.kind(e), &nodes, &[set]);
        }
    }
    let mesh = builder.build().unwrap();
    let line = BoltLine {
        head: Vec3::new(-3.0, 0.1, 0.2),
        toe: Vec3::new(3.0, 0.1, 0.2),
    };
    let bolts = BoltSet::new("bolts", &mesh, &all_elements(&mesh), &[line], parameters).unwrap();
    let nodes = |set: &str| mesh.nodes_of_elements(mesh.element_set(set).unwrap());
    let mut model = Model::builder(&mesh)
        .elements("left", elastic("left", rock()))
        .elements("right", elastic("right", rock()))
        .support(Support::fixed(nodes("left")))
        .support(Support::roller(nodes("right"), Vec3::y()))
        .support(Support::roller(nodes("right"), Vec3::z()))
        .prescribed(Prescribed {
            nodes: nodes("right"),
            direction: Vec3::x(),
            displacement: Box::new(move |_: f64| opening),
        })
        .embed(Box::new(bolts.clone()))
        .build()
        .unwrap();
    let options = StaticOptions::default().with_increments(10);
    model.equilibrate(&options, &mut |_| {}).unwrap();
    let forces = bolts.axial_forces(&model.state()).unwrap();
    forces.into_iter().fold(0.0, f64::max)
}

/// A bolt that is drawn out of rigid rock on both sides of a cut: with `a = sqrt(k / E A)` and half
/// the opening `w` the force at a distance `y` from the cut is
/// `E A a w sinh(a (L - y)) / cosh(a L)` while the grout holds; `c (x - y)` more than
/// `E A a tanh(a (L - x)) c / k` once it slips over a length `x`, and `c (L - y)` in the end; all to
/// 1 %. A bar that yields bears its yield force.
#[test]
fn a_bolt_is_drawn_out_of_its_grout() {
    let grout = Grout {
        stiffness: 1.0e8,
        strength: 1.2e5,
        head: BoltEnd::Free,
        toe: BoltEnd::Free,
    };
    let parameters = BoltParameters {
        grout: Some(grout),
        longest_segment: 0.1,
        ..BoltParameters::steel(0.025).unwrap()
    };
    let axial = parameters.young * parameters.area;
    let (k, c, length) = (grout.stiffness, grout.strength, 3.0);
    // The force of a segment is that in its middle.
    let y = 0.05;
    let a = (k / axial).sqrt();
    let first_slip = c / k;
    let elastic = drawn(1.6 * first_slip, parameters);
    let share = (a * (length - y)).sinh() / (a * length).cosh();
    let expected = axial * a * share * 0.8 * first_slip;
    assert!(
        (elastic / expected - 1.0).abs() < 0.01,
        "{elastic} {expected}"
    );

    // Half the opening: w = c / k + (N x + c x^2 / 2) / E A with the force N at the slip's end.
    let x = 1.2;
    let held = axial * a * (a * (length - x)).tanh() * first_slip;
    let half = first_slip + (held * x + 0.5 * c * x * x) / axial;
    let sliding = drawn(2.0 * half, parameters);
    let expected = held + c * (x - y);
    assert!(
        (sliding / expected - 1.0).abs() < 0.01,
        "{sliding} {expected}"
    );

    let out = drawn(0.1, parameters);
    assert!((out / (c * (length - y)) - 1.0).abs() < 0.01, "{out}");
    let weak = BoltParameters {
        yield_force: 0.7 * c * length,
        ..parameters
    };
    let yielding = drawn(0.1, weak);
    assert!(
        (yielding / weak.yield_force - 1.0).abs() < 1.0e-9,
        "{yielding}"
    );
}

/// The stable limit `2 / w` of elastic blocks from their dense operators.
fn dense_limit(nodes: usize, blocks: &[Box<dyn ElementBlock>]) -> f64 {
    let mut mass = vec![0.0; nodes];
    let mut matrix = DMatrix::<f64>::zeros(3 * nodes, 3 * nodes);
    for block in blocks {
        let of_block = block.nodes();
        let mut own = vec![0.0; of_block.len()];
        block.add_mass(&mut own);
        for (&node, own) in block.nodes().iter().zip(&own) {
            mass[node as usize] += own;
        }
        for column in 0..3 * nodes {
            let mut unit = vec![Quad::<f64>::default(); of_block.len()];
            if let Some(place) = (of_block.iter()).position(|&node| node as usize == column / 3) {
                unit[place].values[column % 3] = 1.0;
            }
            let mut out = vec![Quad::<f64>::default(); own.len()];
            let view = NodalView::F64(&unit);
            block.apply(Operator::Elastic, view, NodalViewMut::F64(&mut out));
            for (&node, force) in block.nodes().iter().zip(&out) {
                for c in 0..3 {
                    matrix[(3 * node as usize + c, column)] += force.values[c];
                }
            }
        }
    }
    for i in 0..3 * nodes {
        for j in 0..3 * nodes {
            matrix[(i, j)] /= (mass[i / 3] * mass[j / 3]).sqrt();
        }
    }
    2.0 / matrix.symmetric_eigenvalues().max().sqrt()
}

/// Bolts of 25 mm, tied or in grout, at a metre from each other in elements of a metre, cost at most
/// 0.2 % of the step, and never lengthen it.
#[test]
fn bolts_cost_no_step() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(3.0), [3; 3], "ground").unwrap();
    let mut lines = Vec::new();
    for i in 0..3 {
        for j in 0..3 {
            let (x, y) = (0.5 + f64::from(i), 0.4 + f64::from(j));
            lines.push(BoltLine {
                head: Vec3::new(x, y, 3.0),
                toe: Vec3::new(x, y + 0.1, 0.3),
            });
        }
    }
    let hosts = all_elements(&mesh);
    let numbers: Vec<u32> = (0..mesh.node_count() as u32).collect();
    let solid = || {
        let part = BlockPart::new(&mesh, &hosts, &numbers);
        elastic("ground", rock()).build(&part).unwrap()
    };
    let plain = dense_limit(numbers.len(), &[solid()]);
    let tied = BoltParameters::steel(0.025).unwrap();
    let grouted = BoltParameters {
        grout: Some(Grout {
            stiffness: 1.0e10,
            strength: f64::INFINITY,
            head: BoltEnd::Anchored,
            toe: BoltEnd::Free,
        }),
        ..tied
    };
    for parameters in [tied, grouted] {
        let bolts = BoltSet::new("bolts", &mesh, &hosts, &lines, parameters).unwrap();
        let block = bolts.block();
        let ratio = dense_limit(numbers.len(), &[solid(), block]) / plain;
        println!("step with bolts over step without: {ratio}");
        assert!(ratio > 0.998 && ratio < 1.0 + 1.0e-12, "{ratio}");
    }
}

/// A fault in a bolt names an element of the mesh that the bolt crosses there, and the bolt: the node
/// that is lost belongs to that element.
#[test]
fn a_fault_names_the_element_that_the_bolt_crosses() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(4.0), [4; 3], "ground").unwrap();
    let line = |x: f64| BoltLine {
        head: Vec3::new(x, 0.5, 4.0),
        toe: Vec3::new(x, 0.6, 0.2),
    };
    let steel = BoltParameters::steel(0.025).unwrap();
    let hosts = all_elements(&mesh);
    let bolts = BoltSet::new("bolts", &mesh, &hosts, &[line(0.5), line(3.5)], steel).unwrap();
    let mut block = bolts.block();
    let lost = mesh.nodes_in_box(&Vec3::new(4.0, 0.0, 1.0), &Vec3::new(4.0, 0.0, 1.0));
    let mut moved = vec![Quad::<f64>::default(); block.nodes().len()];
    let still = moved.clone();
    let place = (block.nodes().iter()).position(|&node| node == lost[0]);
    moved[place.unwrap()].values[2] = f64::NAN;
    let views = (NodalView::F64(&moved), NodalView::F64(&still));
    let context = BlockContext::new(when(0, 1.0e-3), views.0, views.1);
    let mut out = vec![Quad::<f64>::default(); block.nodes().len()];
    let fault = block
        .forces(&context, NodalViewMut::F64(&mut out))
        .unwrap_err();
    let crossed: Vec<u32> = bolts.segments(1).map(|segment| segment.element).collect();
    assert!(crossed.contains(&fault.element), "{fault:?}");
    assert!(mesh.nodes_of(fault.element).contains(&lost[0]), "{fault:?}");
    assert!(fault.reason.contains("bolt 1"), "{fault:?}");
}

/// Bolts with a pretension hold soft ground together before the earthquake and through it: after the
/// hand-over nothing moves without input, with it the energies of rock, bars and grout balance, and
/// a state carries their history variables.
#[test]
fn bolts_go_through_stages() {
    let mesh = bent_box(Vec3::new(12.0, 10.0, 10.0), [6, 5, 5], 0.5);
    let soft = ElasticMedium::new(0.5e9, 0.3, 2200.0).unwrap();
    let top = BoltPattern {
        along: Vec3::x(),
        spacing: [2.0, 3.0],
        length: 5.0,
    };
    let hosts = all_elements(&mesh);
    let lines = top
        .lines(&mesh, mesh.facet_set("top").unwrap(), &hosts)
        .unwrap();
    assert_eq!(lines.len(), 4 * 5);
    assert!(
        lines
            .iter()
            .all(|line| (line.toe - line.head + 5.0 * Vec3::z()).norm() < 1e-9)
    );
    let parameters = BoltParameters {
        pretension: 100.0e3,
        yield_force: 110.0e3,
        grout: Some(Grout {
            stiffness: 2.0e8,
            strength: 2.0e3,
            head: BoltEnd::Anchored,
            toe: BoltEnd::Anchored,
        }),
        longest_segment: 0.5,
        ..BoltParameters::steel(0.025).unwrap()
    };
    let bolts = BoltSet::new("roof", &mesh, &hosts, &lines, parameters).unwrap();
    let body: Box<StageModel> = Box::new(|builder| {
        let builder = builder.elements("ground", elastic("ground", soft));
        Ok(on_rollers(&mesh, builder).gravity(GRAVITY, Box::new(|_: f64| 1.0)))
    });
    let bolted: Box<StageModel> =
        Box::new(|builder| Ok(body(builder)?.embed(Box::new(bolts.clone()))));
    let options = StaticOptions::default().with_tolerance(1.0e-7);
    let stages = [
        Stage::new("weight", &body).options(options),
        Stage::new("bolts", &bolted).options(options),
    ];
    let first = State::at_rest(mesh.node_count());
    let (state, _) = run_stages(&mesh, first, &stages, &mut |_| {}).unwrap();
    let forces = bolts.axial_forces(&state).unwrap();
    // Installed in a body that has settled: the pretension less what the rock gives way.
    assert!(
        forces.iter().all(|&n| n < 100.0e3 && n > 90.0e3),
        "{forces:?}"
    );

    let dynamic = |state: &State| {
        let pulse = |t: f64| (core::f64::consts::PI * (t / 0.05).min(1.0)).sin().powi(2);
        let push = NodalForce::new(
            face_nodes(&mesh, "top"),
            Vec3::new(3.0e5, 0.0, 6.0e5),
            Box::new(move |t: f64| if t > 1.0 { pulse(t - 1.0) } else { 0.0 }),
        );
        let builder = Model::builder(&mesh).start(state.clone());
        let builder = builder.elements("ground", elastic("ground", soft));
        absorbing(&mesh, builder, 10.0)
            .embed(Box::new(bolts.clone()))
            .load(Box::new(push))
            .gravity(GRAVITY, Box::new(|_: f64| 1.0))
            .build()
            .unwrap()
    };
    let mut model = dynamic(&state);
    model.hand_over(1.0e-9).unwrap();
    let step = model.stable_step(&Leapfrog).unwrap().step;
    let still = RunOptions::seconds(0.97).with_step(StepChoice::Fixed(step));
    run(&mut model, &Leapfrog, &still, &mut [], &mut |_| {}).unwrap();
    let nodes = || 0..mesh.node_count() as u32;
    let moved = nodes().map(|n| model.displacement(n) - state.displacement[n as usize]);
    let speeds = nodes().map(|n| model.velocity(n));
    let (moved, speed) = (largest(moved), largest(speeds));
    println!("bolts: {speed:.2e} m/s, {moved:.2e} m");
    assert!(speed < 1.0e-10 && moved < 1.0e-10, "{speed} {moved}");

    let shaken = RunOptions::steps(400)
        .with_step(StepChoice::Fixed(step))
        .with_energy(EnergyCheck::every(20));
    let middle = model.state();
    let report = run(&mut model, &Leapfrog, &shaken, &mut [], &mut |_| {}).unwrap();
    assert!(
        report.energy_residual < 1.0e-9,
        "{}",
        report.energy_residual
    );
    let slip = |state: &State| -> f64 {
        let fields = state.history.iter();
        let slips = fields.filter(|field| field.name == "roof/grout_slip");
        slips
            .flat_map(|f| &f.values)
            .fold(0.0, |most, s| most.max(s.abs()))
    };
    let after = model.state();
    assert!(slip(&after) > 0.0, "the grout slips under the pulse");
    let mut second = dynamic(&middle);
    run(&mut second, &Leapfrog, &shaken, &mut [], &mut |_| {}).unwrap();
    assert!(second.state() == after);
}

/// What an observer keeps of bolts are the forces of the states of the run: at every look the greatest of
/// the state with as many steps, and of each segment the greatest of all of these with its time. Bolts
/// that the body does not have are refused.
#[test]
fn forces_of_bolts_are_kept_over_a_run() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(4.0), [4; 3], "ground").unwrap();
    let line = |x: f64| BoltLine {
        head: Vec3::new(x, 0.5, 4.0),
        toe: Vec3::new(x, 0.6, 0.2),
    };
    let steel = BoltParameters::steel(0.025).unwrap();
    let hosts = all_elements(&mesh);
    let bolts = BoltSet::new("roof", &mesh, &hosts, &[line(0.5), line(3.5)], steel).unwrap();
    let body = || {
        let push = NodalForce::new(
            face_nodes(&mesh, "top"),
            Vec3::new(0.0, 0.0, 1.0e5),
            Box::new(|t: f64| (1.0e3 * t).sin()),
        );
        let builder = on_rollers(&mesh, elastic_body(&mesh)).embed(Box::new(bolts.clone()));
        builder.load(Box::new(push)).build().unwrap()
    };
    let step = body().stable_step(&Leapfrog).unwrap().step;
    let options = |steps| RunOptions::steps(steps).with_step(StepChoice::Fixed(step));
    let watch = |bolts| {
        let watch = BoltHistories::new(Cadence::Steps(1), [bolts]).unwrap();
        (watch.recording(), Box::new(watch))
    };
    let (recording, observer) = watch(&bolts);
    run(
        &mut body(),
        &Leapfrog,
        &options(60),
        &mut [observer],
        &mut |_| {},
    )
    .unwrap();

    let mut model = body();
    let forces = |model: &mut Model| bolts.axial_forces(&model.state()).unwrap();
    let mut states = vec![forces(&mut model)];
    for _ in 0..60 {
        run(&mut model, &Leapfrog, &options(1), &mut [], &mut |_| {}).unwrap();
        states.push(forces(&mut model));
    }
    let tables = recording.copy();
    let most = |forces: &Vec<f64>| forces.iter().copied().fold(f64::MIN, f64::max);
    let column = tables.history.column("roof.greatest").unwrap();
    assert_eq!(column.values.len(), 60);
    for (row, &greatest) in column.values.iter().enumerate() {
        assert_eq!(greatest, most(&states[row]), "row {row}");
    }
    let peaks = &tables.peaks[0].greatest;
    assert!(most(&peaks.values) > 10.0, "the bolts bear something");
    for (segment, (&value, &time)) in peaks.values.iter().zip(&peaks.times).enumerate() {
        let of_states = states[..60].iter().map(|forces| forces[segment]);
        assert_eq!(value, of_states.fold(f64::MIN, f64::max));
        let row = tables
            .history
            .times
            .iter()
            .position(|&t| t == time)
            .unwrap();
        assert_eq!(states[row][segment], value);
    }

    let other = BoltSet::new("walls", &mesh, &hosts, &[line(1.5)], steel).unwrap();
    let (_, observer) = watch(&other);
    let refused = run(
        &mut body(),
        &Leapfrog,
        &options(2),
        &mut [observer],
        &mut |_| {},
    );
    let refused = refused.unwrap_err().to_string();
    assert!(refused.contains("no bolts 'walls'"), "{refused}");
}

/// A block of bolts that takes over the history of another one goes on as that would have: the same forces
/// of bar and grout, and the same energies, held and dissipated, now and as the grout slips and the bar
/// yields further; yielding bars without grout alike.
#[test]
fn bolts_go_on_from_a_history() {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(4.0), [4; 3], "ground").unwrap();
    let line = |x: f64| BoltLine {
        head: Vec3::new(x, 0.5, 3.9),
        toe: Vec3::new(x, 0.7, 0.3),
    };
    let hosts = all_elements(&mesh);
    let steel = BoltParameters {
        pretension: 20.0e3,
        yield_force: 60.0e3,
        ..BoltParameters::steel(0.025).unwrap()
    };
    let in_grout = |end: BoltEnd| BoltParameters {
        grout: Some(Grout {
            stiffness: 2.0e8,
            strength: 3.0e4,
            head: BoltEnd::Anchored,
            toe: end,
        }),
        pretension: 0.0,
        ..steel
    };
    for parameters in [steel, in_grout(BoltEnd::Free), in_grout(BoltEnd::Anchored)] {
        let lines = [line(0.5), line(3.4)];
        let bolts = BoltSet::new("roof", &mesh, &hosts, &lines, parameters).unwrap();
        let moved = |size: f64| -> Vec<Quad<f64>> {
            let at = |p: &Vec3| Vec3::new(0.0, 0.1 * p.x, p.z * p.z + p.x) * size;
            let block = bolts.block();
            let positions = (block.nodes().iter()).map(|&node| &mesh.positions()[node as usize]);
            positions.map(|p| Quad::from_vector(&at(p))).collect()
        };
        let still = moved(0.0);
        let go = |block: &mut dyn ElementBlock, size: f64| {
            let field = moved(size);
            let views = (NodalView::F64(&field), NodalView::F64(&still));
            let context = BlockContext::new(when(0, 1.0e-3), views.0, views.1);
            let mut out = vec![Quad::<f64>::default(); block.nodes().len()];
            block.forces(&context, NodalViewMut::F64(&mut out)).unwrap();
            block.commit();
            (out, block.energy(&context))
        };
        let make = || {
            let mut block = bolts.block();
            block.set_reference_displacement(NodalView::F64(&still));
            block
        };
        let (mut first, mut second) = (make(), make());
        let before = go(first.as_mut(), 2.0e-3).1;
        assert!(before.plastic > 1.0, "{before:?}");
        second.set_history(&first.history());
        let views = (NodalView::F64(&still), NodalView::F64(&still));
        let context = BlockContext::new(when(0, 1.0e-3), views.0, views.1);
        assert_eq!(second.energy(&context), before);
        for size in [2.5e-3, 1.0e-3, 3.0e-3] {
            let (forces, energy) = go(first.as_mut(), size);
            let (others, other) = go(second.as_mut(), size);
            assert_eq!(energy, other);
            assert!(
                forces
                    .iter()
                    .zip(&others)
                    .all(|(a, b)| a.values == b.values)
            );
        }
    }
}
