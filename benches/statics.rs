//! Cost of static solutions: cubes of hexahedra by conjugate gradients and by the direct solver, and the stages of an
//! elastoplastic cavern.
//!
//! `cargo bench --bench statics --features direct -- bricks 30` prints iterations, entries of the
//! factor, time and the greatest memory of a cube of 30 bricks a side under its weight, by both
//! solvers; `-- gradients 60` and `-- cholesky 60` by one of them, so that each has the memory of a
//! process of its own. `-- cavern` equilibrates 134,232 hexahedra of yielding rock (Mohr-Coulomb, no dilation) under their
//! weight and an overburden, and excavates a cavern in three increments; a further word picks the method: `gradients` (or none), `cholesky`, `tangent`,
//! `relaxation`. Without arguments: cubes of 30, then the cavern.

use std::time::Instant;

use powerhouse::engine::{
    BlockOptions, BuildModel, FacePressure, Hex8OnePoint, Model, Profile, SolidKernel, Stage,
    StageEvent, StageModel, StaticMethod, StaticOptions, Support, run_stages, solid,
};
use powerhouse::io::peak_memory;
use powerhouse::material::{ElastoPlastic, LinearElastic, MohrCoulomb, MohrCoulombParameters};
use powerhouse::model::{ElasticMedium, Mesh, State, Vec3};

const GRAVITY: Vec3 = Vec3::new(0.0, 0.0, -9.81);
/// Numbers of elements as in the paper's model, with edges in metres.
const CAVERN_CELLS: [usize; 3] = [56, 51, 47];
const CAVERN_EDGE: f64 = 2.5;
/// Rock above the model (m).
const OVERBURDEN: f64 = 150.0;

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2750.0).expect("valid rock")
}

fn print_memory() {
    match peak_memory() {
        Some(bytes) => println!("  peak memory {:.2} GB", bytes as f64 / 1e9),
        None => println!("  peak memory unknown on this system"),
    }
}

/// The static method with a name.
fn method(name: &str) -> StaticMethod {
    match name {
        "gradients" => StaticMethod::ConjugateGradients,
        #[cfg(feature = "direct")]
        "cholesky" => StaticMethod::Cholesky(powerhouse::engine::Linearisation::Elastic),
        #[cfg(feature = "direct")]
        "tangent" => StaticMethod::Cholesky(powerhouse::engine::Linearisation::Tangent),
        "relaxation" => StaticMethod::DynamicRelaxation,
        other => panic!("no method '{other}' (with or without the feature 'direct')"),
    }
}

/// A cube of hexahedra under its weight, supported at the bottom.
fn bricks(side: usize, name: &str) {
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), Vec3::repeat(90.0), [side; 3], "rock");
    let mesh = mesh.expect("a box");
    let foot = mesh.nodes_of_facets(mesh.facet_set("bottom").expect("a foot"));
    let law = LinearElastic::new(rock());
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::default());
    let mut model = Model::builder(&mesh)
        .elements("rock", kernel.factory("rock", law, BlockOptions::default()))
        .support(Support::fixed(foot))
        .gravity(GRAVITY, Box::new(|_: f64| 1.0))
        .build()
        .expect("a model");
    let options = StaticOptions::default().with_method(method(name));
    let start = Instant::now();
    let report = model
        .equilibrate(&options, &mut |_| {})
        .expect("static equilibrium");
    let time = start.elapsed().as_secs_f64();
    println!("{side}^3 bricks by {name}: {time:.2} s, {report:?}");
    print_memory();
}

/// Construction stages of a cavern in yielding rock.
fn cavern(name: &str) {
    let size = Vec3::from_fn(|c, _| CAVERN_EDGE * CAVERN_CELLS[c] as f64);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, CAVERN_CELLS, "rock").expect("a box");
    let middle = 0.5 * size;
    let half = Vec3::new(12.5, 40.0, 22.5);
    let cavern = mesh.elements_in_box(&(middle - half), &(middle + half));
    let law = ElastoPlastic::new(
        MohrCoulomb::new(MohrCoulombParameters {
            medium: rock(),
            friction: 40.0,
            dilation: 0.0,
            cohesion: 0.6e6,
            tension_strength: Some(0.2e6),
        })
        .expect("valid rock"),
    );
    let nodes = |face: &str| mesh.nodes_of_facets(mesh.facet_set(face).expect("a face"));
    let above = rock().density * GRAVITY.norm() * OVERBURDEN;
    let body: Box<StageModel> = Box::new(|builder| {
        let rock = solid(
            "rock",
            Hex8OnePoint::default(),
            law,
            BlockOptions::default(),
        );
        let top = mesh.facet_set("top")?;
        let weight =
            FacePressure::new(&mesh, top, Profile::Uniform, Box::new(move |_: f64| above))?;
        Ok(builder
            .elements("rock", rock)
            .support(Support::roller(nodes("left"), Vec3::x()))
            .support(Support::roller(nodes("right"), Vec3::x()))
            .support(Support::roller(nodes("front"), Vec3::y()))
            .support(Support::roller(nodes("back"), Vec3::y()))
            .support(Support::roller(nodes("bottom"), Vec3::z()))
            .load(Box::new(weight))
            .gravity(GRAVITY, Box::new(|_: f64| 1.0)))
    });
    let options = StaticOptions::default()
        .with_tolerance(1.0e-6)
        .with_method(method(name));
    let stages = [
        Stage::new("gravity", &body).options(options),
        Stage::new("excavation", &body)
            .excavate(&cavern)
            .options(options.with_increments(3)),
    ];
    let start = Instant::now();
    println!(
        "{} bricks, {} of them excavated, by {name}",
        mesh.element_count(),
        cavern.len()
    );
    let mut shown = start;
    let first = State::at_rest(mesh.node_count());
    let (state, _) = run_stages(&mesh, first, &stages, &mut |event| {
        if let StageEvent::Equilibrated { report, .. } = event {
            let time = shown.elapsed().as_secs_f64();
            println!("  {report:?}: {time:.1} s");
            shown = Instant::now();
        }
    })
    .expect("static equilibrium");
    let fields = state.history.iter();
    let strains = fields.filter(|field| field.name.contains("equivalent_plastic_strain"));
    let yielded = strains
        .flat_map(|field| &field.values)
        .filter(|e| **e > 0.0);
    println!(
        "  {} points yielded, {:.1} s in all",
        yielded.count(),
        start.elapsed().as_secs_f64()
    );
    print_memory();
}

fn main() {
    let words: Vec<String> = std::env::args()
        .skip(1)
        .filter(|w| w != "--bench")
        .collect();
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let side = |word: &str| word.parse().expect("a number of bricks");
    match words[..] {
        ["bricks", count] => {
            bricks(side(count), "gradients");
            if cfg!(feature = "direct") {
                bricks(side(count), "cholesky");
            }
        }
        ["cavern"] => cavern("gradients"),
        ["cavern", name] => cavern(name),
        [name, count] => bricks(side(count), name),
        _ => {
            bricks(30, "gradients");
            if cfg!(feature = "direct") {
                bricks(30, "cholesky");
            }
            cavern("gradients");
        }
    }
}
