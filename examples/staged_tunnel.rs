//! Construction stages before an earthquake: in-situ stress, excavation, lining, bolts, and the transition to the dynamic
//! stage.
//!
//! Builds on `column` and `joint_slip`. First a tunnel in yielding rock under 30 MPa, compared with the closed form of
//! Salencon (1969); the case is that of FLAC's verification manual. Then a trench in ground with a dipping seam: four stages,
//! and a dynamic stage without input, in which nothing may move.
//!
//! ```text
//!      z = 20   --------.          .--------   lining of 2 m, cast after the excavation
//!               | | | | #|        |# | | | |   bolts in grout, across the seam
//!      z = 12   | | | | #|________|# | | | |
//!               | | | | | |     __.--''| | |
//!      z = 8    |_____ | __.--''  seam with friction
//!               |    ''                    |
//!      z = 0    ----------------------------
//! ```
//!
//! Run from the top of the project: `cargo run --release --example staged_tunnel`

use std::process::ExitCode;

use powerhouse::boundary::ViscousSpring;
use powerhouse::contact::{
    BondedCoulomb, BondedCoulombParameters, Joint, JointSurface, SurfaceOptions,
};
use powerhouse::engine::{
    BlockOptions, BoltEnd, BoltParameters, BoltPattern, BoltSet, BuildModel, FacePressure, Grout,
    Hex8OnePoint, Leapfrog, Model, ModelSpec, Precision, Profile, RunOptions, SolidKernel, Stage,
    StageError, StageEvent, StageModel, StaticOptions, StressField, Support, run, run_stages,
};
use powerhouse::material::{
    ElastoPlastic, LinearElastic, MohrCoulomb, MohrCoulombParameters, media,
};
use powerhouse::model::{
    AbsorbingBoundary, BoundarySite, ElasticMedium, JointPair, Mesh, ModelError, State, Stress,
    Vec3,
};
use powerhouse_examples::Figures;

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const BRICK: SolidKernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT);
const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);

fn nodes(mesh: &Mesh, face: &str) -> Result<Vec<u32>, ModelError> {
    Ok(mesh.nodes_of_facets(mesh.facet_set(face)?))
}

/// Prints the result of a stage.
fn tell(event: StageEvent) {
    if let StageEvent::Equilibrated { report, .. } = event {
        println!(
            "    {}: {} increments, {} corrections, moved by {:.3e} m, residual {:.1e}",
            report.name,
            report.solution.increments,
            report.solution.corrections,
            report.largest_displacement.0,
            report.solution.residual
        );
    }
}

/// Numbers of elements of the ring: along the radius within the tunnel and outside, and around a quarter.
const CORE: usize = 4;
const ROCK: usize = 120;
const AROUND: usize = 24;

/// A quarter of a ring from 0.7 to 60 m: rock, and the core of the tunnel of 1 m.
fn ring() -> Outcome<(Mesh, Vec<u32>)> {
    let cells = [CORE + ROCK, AROUND, 1];
    let size = Vec3::new((CORE + ROCK) as f64, 1.0, 0.5);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, cells, "rock")?;
    let mesh = mesh.map_positions(|p| {
        let radius = match p.x - CORE as f64 {
            inside if inside < 0.0 => 0.7_f64.powf(-inside / CORE as f64),
            outside => 60.0_f64.powf(outside / ROCK as f64),
        };
        let angle = core::f64::consts::FRAC_PI_2 * p.y;
        Vec3::new(radius * angle.cos(), radius * angle.sin(), p.z)
    })?;
    let inside = |&element: &u32| {
        let middle = mesh.centroid(element);
        middle.x.hypot(middle.y) < 1.0
    };
    let core = (0..mesh.element_count() as u32).filter(inside).collect();
    Ok((mesh, core))
}

/// In-situ pressure around the tunnel (Pa).
const PRESSURE: f64 = 30.0e6;

/// Adds that pressure on a face.
fn pressed<'a>(
    builder: ModelSpec<'a>,
    mesh: &Mesh,
    face: &str,
) -> Result<ModelSpec<'a>, ModelError> {
    let history = Box::new(|_: f64| PRESSURE);
    let load = FacePressure::new(mesh, mesh.facet_set(face)?, Profile::Uniform, history)?;
    Ok(builder.load(Box::new(load)))
}

/// Errors of the plastic radius and of the displacement of the wall, for an angle of dilation
/// (degrees) and the displacement after Salencon (m).
fn salencon(dilation: f64, expected: f64) -> Outcome<[f64; 2]> {
    let (bulk, shear) = (3.9e9_f64, 2.8e9_f64);
    let young = 9.0 * bulk * shear / (3.0 * bulk + shear);
    let poisson = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear);
    let law = ElastoPlastic::new(MohrCoulomb::new(MohrCoulombParameters {
        medium: ElasticMedium::new(young, poisson, 2700.0)?,
        friction: 30.0,
        dilation,
        cohesion: 3.45e6,
        tension_strength: None,
    })?);
    let (mesh, core) = ring()?;
    let rock: Box<StageModel> = Box::new(|builder| {
        let builder = builder
            .elements("rock", BRICK.factory("rock", law, BlockOptions::default()))
            .support(Support::roller(nodes(&mesh, "front")?, Vec3::y()))
            .support(Support::roller(nodes(&mesh, "back")?, Vec3::x()))
            .support(Support::roller(nodes(&mesh, "bottom")?, Vec3::z()))
            .support(Support::roller(nodes(&mesh, "top")?, Vec3::z()));
        pressed(builder, &mesh, "right")
    });
    let whole: Box<StageModel> = Box::new(|builder| pressed(rock(builder)?, &mesh, "left"));
    let options = StaticOptions::default();
    let stages = [
        Stage::new("rock under pressure", &whole).options(options),
        Stage::new("tunnel", &rock)
            .excavate(&core)
            .options(options.with_increments(4)),
    ];
    let mut first = State::at_rest(mesh.node_count());
    let stress = Stress([-PRESSURE, -PRESSURE, -PRESSURE, 0.0, 0.0, 0.0]);
    first.initial_stress = vec![stress; mesh.element_count()];
    let (state, _) = run_stages(&mesh, first, &stages, &mut tell)?;

    let radius = |node: u32| {
        let p = mesh.positions()[node as usize];
        p.x.hypot(p.y)
    };
    let on_wall = |&node: &u32| (radius(node) - 1.0).abs() < 1.0e-9;
    let wall = (0..mesh.node_count() as u32).filter(on_wall);
    let wall = wall.fold(0.0_f64, |most, node| {
        most.max(state.displacement[node as usize].norm())
    });
    // The border between the last element that has yielded and the first that has not.
    let mut plastic = 1.0_f64;
    let strains = state.history.iter();
    for field in strains.filter(|field| field.name == "equivalent_plastic_strain") {
        for (&element, &strain) in field.elements.iter().zip(&field.values) {
            if strain > 0.0 {
                let outermost = mesh.nodes_of(element).iter().map(|&node| radius(node));
                plastic = outermost.fold(plastic, f64::max);
            }
        }
    }
    println!(
        "dilation {dilation:.0}: wall {:.3} mm (expected {:.3}), plastic to {plastic:.4} m (1.7350)",
        1e3 * wall,
        1e3 * expected
    );
    Ok([plastic / 1.734998 - 1.0, wall / expected - 1.0].map(f64::abs))
}

const FACES: [(&str, Vec3); 5] = [
    ("left", Vec3::new(1.0, 0.0, 0.0)),
    ("right", Vec3::new(1.0, 0.0, 0.0)),
    ("front", Vec3::new(0.0, 1.0, 0.0)),
    ("back", Vec3::new(0.0, 1.0, 0.0)),
    ("bottom", Vec3::new(0.0, 0.0, 1.0)),
];

/// Ground with a dipping seam and a trench.
struct Site {
    mesh: Mesh,
    seam: Vec<JointPair>,
    trench: Vec<u32>,
    /// Elements of the trench that become its lining.
    lining: Vec<u32>,
    /// All elements except the lining.
    ground: Vec<u32>,
    bolts: BoltSet,
}

impl Site {
    fn new() -> Outcome<Self> {
        let size = Vec3::new(24.0, 16.0, 20.0);
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [12, 4, 10], "ground")?;
        let within = |mesh: &Mesh, low: [f64; 3], high: [f64; 3]| {
            mesh.elements_in_box(&low.into(), &high.into())
        };
        let lower = within(&mesh, [0.0; 3], [24.0, 16.0, 8.0]);
        let upper = within(&mesh, [0.0, 0.0, 8.0], [24.0, 16.0, 20.0]);
        let trench = within(&mesh, [8.0, 0.0, 12.0], [16.0, 16.0, 20.0]);
        let mut lining = within(&mesh, [8.0, 0.0, 12.0], [10.0, 16.0, 20.0]);
        lining.extend(within(&mesh, [14.0, 0.0, 12.0], [16.0, 16.0, 20.0]));
        let split = mesh.split_between(&lower, &upper)?;
        // A slope of one in ten at the seam; the outer faces are unchanged.
        let dip = |p: Vec3| p + Vec3::z() * (0.1 * (p.x - 12.0) * p.z * (20.0 - p.z) / 96.0);
        let mesh = split.mesh.map_positions(dip)?;
        let options = SurfaceOptions::within(1e-6)?;
        let surface = JointSurface::between(&mesh, &split.first, &split.second, &options)?;
        let all = || 0..mesh.element_count() as u32;
        let rest: Vec<u32> = all().filter(|element| !trench.contains(element)).collect();
        let pattern = BoltPattern {
            along: Vec3::y(),
            spacing: [3.0, 3.0],
            length: 15.0,
        };
        let shoulders: Vec<_> = (mesh.facet_set("top")?.iter().copied())
            .filter(|facet| !trench.contains(&facet.element))
            .collect();
        let lines = pattern.lines(&mesh, &shoulders, &rest)?;
        let parameters = BoltParameters {
            pretension: 80.0e3,
            grout: Some(Grout {
                stiffness: 1.0e9,
                strength: 2.0e5,
                head: BoltEnd::Anchored,
                toe: BoltEnd::Anchored,
            }),
            ..BoltParameters::steel(0.025)?
        };
        Ok(Self {
            seam: surface.pairs.clone(),
            ground: all().filter(|element| !lining.contains(element)).collect(),
            bolts: BoltSet::new("bolts", &mesh, &rest, &lines, parameters)?,
            lining,
            trench,
            mesh,
        })
    }

    /// Yielding rock at the walls of the trench, the seam, and their weight; the elements of the lining are
    /// rock or concrete.
    fn body<'a>(
        &self,
        builder: ModelSpec<'a>,
        seam: BondedCoulombParameters,
        lined: bool,
        precision: Precision,
    ) -> Result<ModelSpec<'a>, ModelError> {
        let mut options = BlockOptions::default();
        options.precision = precision;
        let law = ElastoPlastic::new(MohrCoulomb::new(MohrCoulombParameters {
            medium: media::ROCK,
            friction: 30.0,
            dilation: 10.0,
            cohesion: 20.0e3,
            tension_strength: None,
        })?);
        let concrete = LinearElastic::new(media::CONCRETE);
        let lining = if lined {
            BRICK.factory("lining", concrete, options)
        } else {
            BRICK.factory("lining", law, options)
        };
        let joint = Joint::new("seam", self.seam.clone(), BondedCoulomb::new(seam)?)?;
        Ok(builder
            .elements(self.ground.clone(), BRICK.factory("ground", law, options))
            .elements(self.lining.clone(), lining)
            .constraint(Box::new(joint))
            .gravity(GRAVITY, Box::new(|_: f64| 1.0)))
    }

    fn on_rollers<'a>(&self, builder: ModelSpec<'a>) -> Result<ModelSpec<'a>, ModelError> {
        FACES.iter().try_fold(builder, |builder, (face, normal)| {
            Ok(builder.support(Support::roller(nodes(&self.mesh, face)?, *normal)))
        })
    }

    fn absorbing<'a>(&self, builder: ModelSpec<'a>) -> Outcome<ModelSpec<'a>> {
        let mut named = Vec::new();
        for (face, _) in FACES {
            named.push((face, self.mesh.facet_set(face)?));
        }
        let middle = Vec3::new(12.0, 8.0, 12.0);
        let site = BoundarySite::from_mesh(&self.mesh, &named, |_| media::ROCK, middle, None);
        Ok(builder.boundary(ViscousSpring::default().build(&site)?))
    }

    /// The stages: ground with a lateral stress ratio of 0.6, the trench in two steps, its lining, bolts.
    fn stages(&self, seam: BondedCoulombParameters) -> Result<State, StageError> {
        let made = |lined: bool, bolted: bool| -> Box<StageModel> {
            Box::new(move |builder| {
                let builder = self.body(builder, seam, lined, Precision::F64)?;
                let builder = self.on_rollers(builder)?;
                Ok(if bolted {
                    builder.embed(Box::new(self.bolts.clone()))
                } else {
                    builder
                })
            })
        };
        let options = StaticOptions::default().with_tolerance(1.0e-6);
        let stages = [
            Stage::new("ground", made(false, false)).options(options),
            Stage::new("trench, 60 % of it", made(false, false))
                .excavate(&self.trench)
                .options(options.with_increments(2).with_release(0.6)),
            Stage::new("lining, the rest of the release", made(true, false))
                .cast(&self.lining)
                .options(options),
            Stage::new("bolts", made(true, true)).options(options),
        ];
        let weight = media::ROCK.density * GRAVITY.norm();
        let mut first = State::at_rest(self.mesh.node_count());
        first.initial_stress = StressField {
            surface: 20.0,
            at_surface: Stress::default(),
            gradient: Stress([-0.6 * weight, -0.6 * weight, -weight, 0.0, 0.0, 0.0]),
            ends: true,
        }
        .of_elements(&self.mesh);
        Ok(run_stages(&self.mesh, first, &stages, &mut tell)?.0)
    }

    /// The greatest velocity (m/s) and displacement (m) of a dynamic stage without input.
    fn stillness(&self, state: &State, precision: Precision) -> Outcome<[f64; 2]> {
        let builder = Model::builder(&self.mesh).start(state.clone());
        let builder = self.body(builder, SEAM, true, precision)?;
        let builder = self.absorbing(builder)?.embed(Box::new(self.bolts.clone()));
        let mut model = builder.build()?;
        let report = model.hand_over(1.0e-3)?;
        println!(
            "    handed over: {:.3e} N stand on, changed by {:.1e}",
            report.carried_forces, report.difference
        );
        let mut still = [0.0_f64; 2];
        for _ in 0..20 {
            let steps = RunOptions::steps(500);
            run(&mut model, &Leapfrog, &steps, &mut [], &mut |_| {})?;
            for node in 0..self.mesh.node_count() as u32 {
                let moved = model.displacement(node) - state.displacement[node as usize];
                still[0] = still[0].max(model.velocity(node).norm());
                still[1] = still[1].max(moved.norm());
            }
        }
        Ok(still)
    }
}

/// Friction law of the seam.
const SEAM: BondedCoulombParameters = BondedCoulombParameters {
    cohesion: 0.3e6,
    tensile_strength: 0.1e6,
    static_friction: 0.8,
    dynamic_friction: 0.6,
    cohesion_loss: true,
};

fn figures() -> Outcome<Figures> {
    let mut figures = Figures::default();
    // Displacements of the wall of a tunnel of 1 m, from the closed form.
    let [associated, constant] = [salencon(30.0, 28.10346e-3)?, salencon(0.0, 12.16712e-3)?];
    let worst = |i: usize| associated[i].max(constant[i]);
    figures.at_most("staged_tunnel.salencon.radius_error", worst(0), 0.01);
    figures.at_most("staged_tunnel.salencon.displacement_error", worst(1), 0.01);

    let site = Site::new()?;
    let state = site.stages(SEAM)?;
    let yielded = (state.history.iter())
        .filter(|field| field.name == "equivalent_plastic_strain")
        .flat_map(|field| &field.values)
        .filter(|&&strain| strain > 0.0)
        .count();
    if yielded == 0 {
        return Err("nothing has yielded: stillness would show little".into());
    }
    let forces = site.bolts.axial_forces(&state).unwrap_or_default();
    let least = forces.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "{yielded} elements have yielded; {} bolts bear {:.1} kN and more",
        site.bolts.len(),
        1e-3 * least
    );
    let [velocity, displacement] = site.stillness(&state, Precision::F64)?;
    figures.at_most("staged_tunnel.stillness.velocity", velocity, 1.0e-10);
    figures.at_most(
        "staged_tunnel.stillness.displacement",
        displacement,
        1.0e-10,
    );
    for (precision, name) in [(Precision::Mixed, "mixed"), (Precision::F32, "f32")] {
        let [velocity, displacement] = site.stillness(&state, precision)?;
        let velocity_of = format!("staged_tunnel.stillness.velocity_{name}");
        figures.report(&velocity_of, velocity, "m/s, no limit");
        let displacement_of = format!("staged_tunnel.stillness.displacement_{name}");
        figures.report(&displacement_of, displacement, "m, no limit");
    }
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    Ok(figures()?.verdict())
}

#[cfg(test)]
mod tests {
    use powerhouse::engine::StaticError;

    use super::*;

    /// Every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(figures().unwrap().missed(), 0);
    }

    /// With less friction than the dip requires, the error names the seam and the stage.
    #[test]
    fn a_seam_that_would_slide_is_refused() {
        let smooth = BondedCoulombParameters {
            cohesion: 0.0,
            tensile_strength: 0.0,
            static_friction: 0.02,
            dynamic_friction: 0.02,
            cohesion_loss: true,
        };
        let refused = Site::new().unwrap().stages(smooth).unwrap_err();
        assert!(
            matches!(
                &refused,
                StageError::NotEquilibrated { stage, source: StaticError::JointMoves { joint, .. } }
                    if stage == "ground" && joint == "seam"
            ),
            "{refused}"
        );
    }
}
