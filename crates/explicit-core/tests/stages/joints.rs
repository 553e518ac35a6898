//! Joints in static equilibrium.

use nalgebra::{Rotation3, Unit};
use powerhouse_contact::{
    BondedCoulomb, Cohesive, CohesiveParameters, Frictionless, Joint, JointSurface,
    StrengthReduction, SurfaceOptions, Tied,
};
use powerhouse_elements::SolidKernel;
use powerhouse_explicit_core::{BuildModel, Model, run_stages};
use powerhouse_model::{
    BlockOptions, Bond, ContactLaw, ContactState, JointRecord, Mesh, ModelSpec, Prescribed, Stage,
    StageModel, State, StaticError, StaticMethod, StaticOptions, Support, Vec3,
};

use super::{Elastic, elastic, elastic_body, face_nodes, largest, rock};

/// Box that a plane joint cuts in two at a share of its height, with irregular bricks, turned about an oblique axis.
struct Cut {
    mesh: Mesh,
    surface: JointSurface,
    upper: Vec<u32>,
    turn: Rotation3<f64>,
    size: Vec3,
}

impl Cut {
    fn new(size: Vec3, cells: [usize; 3], share: f64, degrees: f64) -> Self {
        Self::around(size, cells, degrees, |at| at.z >= share * size.z)
    }

    /// Whose upper part has the elements with centroids that a condition holds for.
    fn around(
        size: Vec3,
        cells: [usize; 3],
        degrees: f64,
        is_upper: impl Fn(&Vec3) -> bool,
    ) -> Self {
        let whole = Mesh::box_of_hexes(Vec3::zeros(), size, cells, "ground").unwrap();
        let all = 0..whole.element_count() as u32;
        let (upper, lower): (Vec<u32>, Vec<u32>) =
            all.partition(|&element| is_upper(&whole.centroid(element)));
        let axis = Unit::new_normalize(Vec3::new(0.3, -1.0, 0.4));
        let turn = Rotation3::from_axis_angle(&axis, degrees.to_radians());
        let split = whole.split_between(&lower, &upper).unwrap();
        let turned = split.mesh.map_positions(|position| {
            let half = position.component_div(&size) * core::f64::consts::PI;
            let bump = 0.05 * size.x.min(size.y) * half.x.sin() * half.y.sin();
            turn * (position + Vec3::new(1.0, -0.7, 0.0) * bump)
        });
        let mesh = turned.unwrap();
        let options = SurfaceOptions::within(1e-9 * size.norm()).unwrap();
        let surface = JointSurface::between(&mesh, &split.first, &split.second, &options).unwrap();
        Self {
            mesh,
            surface,
            upper,
            turn,
            size,
        }
    }

    /// Three of different shapes, sizes and directions.
    fn several() -> [Self; 3] {
        [
            Self::new(Vec3::new(4.0, 3.0, 2.0), [3, 2, 2], 0.5, 0.0),
            Self::new(Vec3::new(40.0, 30.0, 90.0), [3, 3, 6], 1.0 / 3.0, 37.0),
            Self::new(Vec3::new(0.3, 0.9, 0.6), [2, 3, 4], 0.75, 110.0),
        ]
    }

    fn nodes(&self, face: &str) -> Vec<u32> {
        face_nodes(&self.mesh, face)
    }

    fn all(&self) -> Vec<u32> {
        (0..self.mesh.node_count() as u32).collect()
    }

    fn roller(&self, nodes: Vec<u32>, normal: Vec3) -> Support {
        Support::roller(nodes, self.turn * normal)
    }

    /// The body on rollers at its left, front and bottom faces.
    fn body(&self) -> ModelSpec<'_> {
        let faces = [
            ("left", Vec3::x()),
            ("front", Vec3::y()),
            ("bottom", Vec3::z()),
        ];
        let body = elastic_body(&self.mesh);
        faces.into_iter().fold(body, |body, (face, normal)| {
            body.support(self.roller(self.nodes(face), normal))
        })
    }

    /// Moves a face by a displacement (m).
    fn moved(&self, face: &str, displacement: Vec3) -> Prescribed {
        let size = displacement.norm();
        Prescribed {
            nodes: self.nodes(face),
            direction: self.turn * displacement,
            displacement: Box::new(move |_: f64| size),
        }
    }

    fn joint(&self, name: &str, law: impl ContactLaw + 'static) -> Joint<Box<dyn ContactLaw>> {
        let law: Box<dyn ContactLaw> = Box::new(law);
        Joint::new(name, self.surface.pairs.clone(), law).unwrap()
    }
}

fn records(model: &Model) -> Vec<JointRecord> {
    model
        .joints()
        .flat_map(|joint| joint.records.to_vec())
        .collect()
}

fn unbonded(friction: f64) -> BondedCoulomb {
    BondedCoulomb::unbonded(friction, friction).unwrap()
}

fn laws() -> [Box<dyn ContactLaw>; 2] {
    [Box::new(unbonded(0.5)), Box::new(Frictionless)]
}

/// A body that is stretched along its joint, on which then nothing rests, is in equilibrium by conjugate gradients, with no
/// traction but rounding and the pairs closed, with friction or without; likewise one on which nothing acts.
#[test]
fn a_joint_without_traction_is_closed() {
    for cut in Cut::several() {
        for stretch in [0.0, 1e-4] {
            for law in laws() {
                let name = law.name().to_owned();
                let mut body = cut.body().constraint(Box::new(cut.joint("seam", law)));
                if stretch > 0.0 {
                    body = body.prescribed(cut.moved("right", Vec3::x() * stretch * cut.size.x));
                }
                let mut model = body.build().unwrap();
                (model.equilibrate(&StaticOptions::default(), &mut |_| {})).unwrap();
                for record in records(&model) {
                    let error = record.traction.norm() / (rock().young * 1e-4);
                    assert!(error < 1e-7, "{name}: {error:e}");
                    assert_ne!(record.state.contact, ContactState::Open, "{name}");
                }
            }
        }
    }
}

/// A joint that opens, slides, or whose gap closes is refused by name, with the number of its pairs, when conjugate gradients cannot
/// solve it; one that a small share of the load would slide is, too.
#[test]
fn a_joint_that_moves_is_named() {
    let gap = 1e-5;
    for cut in Cut::several() {
        let stretch = |along: Vec3, share: f64| along.component_mul(&cut.size) * share;
        let opens = (stretch(Vec3::z(), 1e-4), 0.0, 0.5);
        let closes = (stretch(Vec3::z(), -1e-3), gap * cut.size.z, 0.5);
        let slides = (stretch(Vec3::new(1e-4, 0.0, -1.0), 1e-4), 0.0, 1e-5);
        for (case, (moved, gap, friction)) in [opens, closes, slides].into_iter().enumerate() {
            let joint = cut.joint("seam", unbonded(friction));
            let joint = joint.with_gaps(|_| gap).unwrap();
            let body = elastic_body(&cut.mesh)
                .support(Support::fixed(cut.nodes("bottom")))
                .support(cut.roller(cut.nodes("top"), Vec3::y()))
                .prescribed(cut.moved("top", Vec3::new(0.0, 0.0, moved.z)))
                .prescribed(cut.moved("top", Vec3::new(moved.x.max(1e-30), 0.0, 0.0)));
            let mut model = body.constraint(Box::new(joint)).build().unwrap();
            let refused = model.equilibrate(&StaticOptions::default(), &mut |_| {});
            let Err(StaticError::JointMoves { joint, pairs, of }) = refused else {
                panic!("{refused:?}");
            };
            let count = cut.surface.pairs.len();
            assert!(joint == "seam" && of == count && pairs > 0 && pairs <= of);
            // All of them open or close.
            assert!(case == 2 || pairs == of, "{case}: {pairs} of {of}");
        }
    }
}

/// Bodies in contact without friction, on a plane or in a notch with an edge, that slide on each other under an oblique weight, have
/// by conjugate gradients the displacements of dynamic relaxation, to 1e-6, and no shear; sticking pairs would give others.
#[test]
fn sides_without_friction_slide_in_equilibrium() {
    let notch = |size: Vec3, cells, degrees| {
        Cut::around(size, cells, degrees, move |at| {
            at.z > 0.5 * size.z && at.x < 0.5 * size.x
        })
    };
    let [_, plane, other] = Cut::several();
    let cuts = [
        plane,
        other,
        notch(Vec3::new(4.0, 3.0, 2.0), [4, 2, 4], 25.0),
        notch(Vec3::new(20.0, 50.0, 30.0), [2, 3, 4], 80.0),
    ];
    for cut in &cuts {
        let weight = cut.turn * Vec3::new(4.0, -2.0, -9.0);
        let at_rest = |method: StaticMethod, law: Box<dyn ContactLaw>| {
            let on = |face, normal| cut.roller(cut.nodes(face), normal);
            let mut model = elastic_body(&cut.mesh)
                .support(Support::fixed(cut.nodes("bottom")))
                .support(on("front", Vec3::y()))
                .support(on("right", Vec3::x()))
                .gravity(weight, Box::new(|_: f64| 1.0))
                .constraint(Box::new(cut.joint("seam", law)))
                .build()
                .unwrap();
            let options = StaticOptions::default()
                .with_method(method)
                .with_tolerance(1e-10);
            model.equilibrate(&options, &mut |_| {}).unwrap();
            let moved: Vec<Vec3> = (cut.all().iter())
                .map(|&node| model.displacement(node))
                .collect();
            (moved, records(&model))
        };
        let relaxed = at_rest(StaticMethod::DynamicRelaxation, Box::new(Frictionless)).0;
        let (found, records) = at_rest(StaticMethod::ConjugateGradients, Box::new(Frictionless));
        let (tied, _) = at_rest(StaticMethod::ConjugateGradients, Box::new(Tied));
        let apart = |one: &[Vec3], other: &[Vec3]| {
            let all = one.iter().zip(other).map(|(a, b)| (a - b).norm());
            all.fold(0.0, f64::max) / largest(other.iter().copied())
        };
        println!("{} {}", apart(&found, &relaxed), apart(&tied, &relaxed));
        assert!(apart(&found, &relaxed) < 1e-6);
        assert!(apart(&tied, &relaxed) > 1e-2);
        assert!(records.iter().any(|record| record.traction.x < -1e3));
        for record in records {
            assert!(record.traction.y.hypot(record.traction.z) == 0.0);
        }
    }
}

/// A body that is cast on another one with a joint between rests on it with its weight, whatever the method in the stage in
/// which it was not there and whether the joint was tied there: stress and joint are those of a body that was cast on one that
/// had settled.
#[test]
fn what_is_cast_on_a_joint_rests_on_it() {
    for cut in Cut::several() {
        let gravity = cut.turn * Vec3::z() * -9.81;
        for law in 0..2 {
            let body: Box<StageModel> = Box::new(|builder: ModelSpec| {
                let joint = cut.joint("seam", laws().into_iter().nth(law).unwrap());
                let on = |face| {
                    cut.roller(
                        cut.nodes(face),
                        if face == "left" { Vec3::x() } else { Vec3::y() },
                    )
                };
                Ok(builder
                    .elements("ground", elastic("ground", rock()))
                    .support(Support::fixed(cut.nodes("bottom")))
                    .support(on("left"))
                    .support(on("front"))
                    .gravity(gravity, Box::new(|_: f64| 1.0))
                    .constraint(Box::new(joint)))
            });
            for method in [
                StaticMethod::ConjugateGradients,
                StaticMethod::DynamicRelaxation,
            ] {
                let options = StaticOptions::default().with_tolerance(1e-10);
                let relaxed = options.with_method(StaticMethod::DynamicRelaxation);
                let stages = [
                    Stage::new("below", &body).options(options.with_method(method)),
                    Stage::new("cast", &body).options(relaxed).cast(&cut.upper),
                ];
                let mut start = State::at_rest(cut.mesh.node_count());
                start.remove(&cut.upper);
                let (state, _) = run_stages(&cut.mesh, start, &stages, &mut |_| {}).unwrap();
                let joint = &state.joints[0];
                let pressed: f64 = (joint.records.iter().zip(&cut.surface.pairs))
                    .map(|(record, pair)| -record.traction.x * pair.projected_area)
                    .sum();
                let weight: f64 = (cut.upper.iter())
                    .map(|&element| cut.mesh.volume(element) * rock().density * 9.81)
                    .sum();
                assert!(
                    (pressed - weight).abs() < 1e-6 * weight,
                    "{law} {method:?}: {pressed} {weight}"
                );
            }
        }
    }
}

const BOND: CohesiveParameters = CohesiveParameters {
    tensile_strength: 5e5,
    cohesion: 1e6,
    opening_energy: 0.0,
    shear_energy: 0.0,
    mode_exponent: 2.0,
    static_friction: 0.0,
    dynamic_friction: 0.0,
    reduction: StrengthReduction::None,
};

/// A body whose bond is drawn, or pressed and sheared, by a prescribed displacement bears, by dynamic relaxation, the traction at which
/// the strain of the body and the separation add up to it, to 1e-6, in one increment and in several: no pseudo-motion damages the
/// bond, which dissipates the energy of its separation and is intact below its strength. Drawn back, it bears less in
/// proportion to its separation.
#[test]
fn a_bond_softens_by_its_displacement_alone() {
    let drawn = (rock().constrained(), BOND.tensile_strength);
    let sheared = (rock().shear(), BOND.cohesion);
    for cut in Cut::several() {
        for (along, (modulus, strength)) in [(Vec3::z(), drawn), (Vec3::x(), sheared)] {
            let is_drawn = along.z > 0.0;
            // The separation at failure is twelve times what the body is strained at its strength.
            let elastic = strength * cut.size.z / modulus;
            let last = 12.0 * elastic;
            let energy = 0.5 * strength * last;
            let law = Cohesive::new(CohesiveParameters {
                opening_energy: if is_drawn { energy } else { 0.1 * energy },
                shear_energy: if is_drawn { 10.0 * energy } else { energy },
                ..BOND
            });
            let (law, pressure) = (law.unwrap(), if is_drawn { 0.0 } else { 1e5 });
            let built = |whole: f64| {
                let joint = cut.joint("bond", law);
                let joint = joint.with_preload(|pair| pair.normal * -pressure);
                // Bricks that resist modes in which every other node softens.
                let bricks = SolidKernel::Hex8Full;
                let bricks = bricks.factory("ground", Elastic(rock()), BlockOptions::default());
                Model::builder(&cut.mesh)
                    .elements("ground", bricks)
                    .support(cut.roller(cut.all(), Vec3::new(along.z, 0.0, along.x)))
                    .support(cut.roller(cut.all(), Vec3::y()))
                    .support(cut.roller(cut.nodes("bottom"), along))
                    .prescribed(cut.moved("top", along * whole))
                    .constraint(Box::new(joint.unwrap()))
            };
            let check = |model: &Model, bearing: f64, lost: f64, bond: Bond| {
                for (record, pair) in records(model).iter().zip(&cut.surface.pairs) {
                    let found = if is_drawn {
                        record.traction.x
                    } else {
                        record.traction.y.hypot(record.traction.z)
                    };
                    let error = (found - bearing).abs() / strength;
                    assert!(error < 1e-6, "{along:?}: {found} {bearing}");
                    let error = (record.bond_energy / pair.projected_area - lost).abs();
                    assert!(error < 1e-6 * energy, "{along:?}: {error} {lost}");
                    assert_eq!(record.state.bond, bond);
                }
            };
            for (separation, increments) in [(0.2, 1), (0.6, 6)] {
                let options = StaticOptions::default()
                    .with_method(StaticMethod::DynamicRelaxation)
                    .with_tolerance(1e-10)
                    .with_increments(increments);
                let mut intact = built(0.9 * elastic).build().unwrap();
                intact.equilibrate(&options, &mut |_| {}).unwrap();
                check(&intact, 0.9 * strength, 0.0, Bond::Intact);

                let bearing = strength * (1.0 - separation);
                let whole = separation * last + elastic * bearing / strength;
                let mut model = built(whole).build().unwrap();
                let report = model.equilibrate(&options, &mut |_| {}).unwrap();
                println!("{along:?} {separation} {report:?}");
                check(&model, bearing, separation * energy, Bond::Softening);

                let state = model.state().next_stage(cut.mesh.node_count());
                let mut back = built(0.5 * whole).start(state).build().unwrap();
                back.equilibrate(&options, &mut |_| {}).unwrap();
                check(&back, 0.5 * bearing, separation * energy, Bond::Softening);
            }
        }
    }
}
