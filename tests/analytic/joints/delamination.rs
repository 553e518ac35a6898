//! Two arms that are pulled apart along a bond with a fracture energy, against beam theory.

use std::sync::{Arc, Mutex};

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse_contact::{
    Cohesive, CohesiveParameters, Joint, JointSurface, StrengthReduction, SurfaceOptions,
};
use powerhouse_elements::SolidKernel;
use powerhouse_model::{
    BlockOptions, Bond, Cadence, ElasticMedium, Fields, Flow, Mesh, ModelError, Observer,
    Prescribed, RunOptions, StepChoice, StepView, Support, Vec3,
};
use powerhouse_tests::elastic;

/// Young's modulus (Pa), with no lateral strain.
const YOUNG: f64 = 20e9;
/// Fracture energy in opening (J/m2).
const ENERGY: f64 = 100.0;
/// Length of the arms, of the part without a bond, and height of an arm (m).
const LENGTH: f64 = 20.0;
const OPEN: f64 = 4.0;
const HEIGHT: f64 = 1.0;
/// Deflection of each arm at the end (m), at which the crack of beam theory is 9.9 m long.
const DEFLECTION: f64 = 8.0e-3;
const DURATION: f64 = 5.0;

/// Compares the shear force (N/m) in the upper arm with that of beam theory, over the last 40 % of the run, in which the crack
/// grows from 7.6 to 9.9 m.
struct Shear {
    elements: Vec<u32>,
    /// Height of an element (m).
    size: f64,
    /// Deflection of an arm by time (m, s).
    pulled: fn(f64) -> f64,
    ratios: Arc<Mutex<Vec<f64>>>,
}

impl Observer for Shear {
    fn name(&self) -> &str {
        "shear"
    }
    fn fields(&self) -> Fields {
        Fields::default().with_stress(true)
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(20)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        if view.time() > 0.6 * DURATION {
            let elements = self.elements.iter();
            let force: f64 = elements
                .map(|&element| view.stress(element).0[5] * self.size)
                .sum();
            let stiffness = YOUNG * HEIGHT.powi(3) / 12.0;
            let crack = (3.0 * (self.pulled)(view.time()) * (stiffness / ENERGY).sqrt()).sqrt();
            let expected = (ENERGY * stiffness).sqrt() / crack;
            self.ratios.lock().unwrap().push(force.abs() / expected);
        }
        Ok(Flow::Continue)
    }
}

/// Deflection of each arm (m) at a time (s): smooth at the start, then steady.
fn pulled(time: f64) -> f64 {
    const RISE: f64 = 0.2;
    let rate = DEFLECTION / (DURATION - 0.5 * RISE);
    if time < RISE {
        0.5 * rate * time * time / RISE
    } else {
        rate * (time - 0.5 * RISE)
    }
}

/// Pulls the arms apart with bricks of a size (m); returns force over that of beam theory at the same deflection, and impact
/// over the energy of the bond.
fn delaminate(size: f64, tensile_strength: f64, reduction: StrengthReduction) -> (f64, f64) {
    let medium = ElasticMedium::new(YOUNG, 0.0, 2500.0).unwrap();
    let cells = [LENGTH / size, 1.0, 2.0 * HEIGHT / size].map(|count| count.round() as usize);
    let low = Vec3::new(0.0, 0.0, -HEIGHT);
    let extent = Vec3::new(LENGTH, size, 2.0 * HEIGHT);
    let mesh = Mesh::box_of_hexes(low, extent, cells, "arms").unwrap();
    let half = |above: bool| -> Vec<u32> {
        let all = 0..mesh.element_count() as u32;
        all.filter(|&e| (mesh.centroid(e).z > 0.0) == above)
            .collect()
    };
    let split = mesh.split_between(&half(false), &half(true)).unwrap();
    let options = SurfaceOptions::within(1e-6).unwrap();
    let surface = JointSurface::between(&split.mesh, &split.first, &split.second, &options);
    let mut pairs = surface.unwrap().pairs;
    pairs.retain(|pair| pair.position.x > OPEN - 1e-6);
    let law = Cohesive::new(CohesiveParameters {
        tensile_strength,
        cohesion: 2.0 * tensile_strength,
        opening_energy: ENERGY,
        shear_energy: 10.0 * ENERGY,
        mode_exponent: 2.0,
        static_friction: 0.0,
        dynamic_friction: 0.0,
        reduction,
    });
    let joint = Joint::new("bond", pairs, law.unwrap()).unwrap();

    let mesh = split.mesh;
    let nodes = |is: &dyn Fn(&Vec3) -> bool| -> Vec<u32> {
        let all = (0..).zip(mesh.positions());
        all.filter(|(_, position)| is(position))
            .map(|(node, _)| node)
            .collect()
    };
    let mut damped = BlockOptions::default();
    damped.damping.mass = 30.0;
    let arms = elastic("arms", SolidKernel::Hex8Natural, medium, damped);
    let elements = half(true);
    let ends = |above: bool| -> Vec<u32> {
        let of_half: Vec<u32> = half(above);
        let mut own: Vec<u32> = of_half
            .iter()
            .flat_map(|&e| mesh.nodes_of(e).to_vec())
            .collect();
        own.retain(|&node| mesh.positions()[node as usize].x == 0.0);
        own.sort_unstable();
        own.dedup();
        own
    };
    let pull = |above: bool| Prescribed {
        nodes: ends(above),
        direction: Vec3::z() * if above { 1.0 } else { -1.0 },
        displacement: Box::new(pulled),
    };
    let mut model: Model = Model::builder(&mesh)
        .threads(1)
        .elements("arms", arms)
        .support(Support::roller(nodes(&|_| true), Vec3::y()))
        .support(Support::roller(nodes(&|p| p.x == LENGTH), Vec3::x()))
        .prescribed(pull(true))
        .prescribed(pull(false))
        .constraint(Box::new(joint))
        .build()
        .unwrap();
    let column = |element: &u32| (mesh.centroid(*element).x - 1.0 - 0.5 * size).abs() < 1e-6;
    let ratios = Arc::new(Mutex::new(Vec::new()));
    let shear = Shear {
        elements: elements.into_iter().filter(column).collect(),
        size,
        pulled,
        ratios: ratios.clone(),
    };
    let step = 0.9 * model.stable_step(&Leapfrog).unwrap().step;
    let options = RunOptions::seconds(DURATION).with_step(StepChoice::Fixed(step));
    run(
        &mut model,
        &Leapfrog,
        &options,
        &mut [Box::new(shear)],
        &mut |_| {},
    )
    .unwrap();
    let ratios = ratios.lock().unwrap();
    let ratio = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let records: Vec<_> = model
        .joints()
        .flat_map(|joint| joint.records.to_vec())
        .collect();
    let failed = records
        .iter()
        .filter(|record| record.state.bond == Bond::Broken)
        .count();
    assert!(failed > 0 && failed < records.len());
    let sum = |of: fn(&powerhouse_model::JointRecord) -> f64| records.iter().map(of).sum::<f64>();
    let lost = sum(|record| record.impact.abs()) / sum(|record| record.bond_energy);
    println!("{size} m, {tensile_strength:e} Pa: {ratio:.3}, lost {lost:.1e}");
    (ratio, lost)
}

/// Where the mesh resolves the zone in which the bond softens, the arms come apart under the force of beam theory for the
/// same deflection and fracture energy, within 5 % with bricks of a quarter of an arm and 2 % with an eighth, and no energy is
/// lost but that of the bond.
#[test]
fn arms_come_apart_under_the_force_of_the_fracture_energy() {
    for (size, tolerance) in [(0.25, 0.05), (0.125, 0.02)] {
        let (ratio, lost) = delaminate(size, 1e6, StrengthReduction::ByMedia);
        assert!((ratio - 1.0).abs() < tolerance, "{size} m: {ratio}");
        assert!(lost < 1e-3, "{size} m: {lost}");
    }
}

/// On coarse meshes the force is 1.7 to 3 times as large as the energy admits unless the strength is reduced; then it is
/// right within 30 %, half a meter and three times the strength being the worst: every pair that fails makes the arms ring,
/// which takes energy.
#[test]
fn reduced_strength_keeps_the_force_on_coarse_meshes() {
    let reduced = StrengthReduction::Modulus(YOUNG);
    for (size, strength, tolerance) in [(0.25, 3e6, 0.05), (0.5, 3e6, 0.3), (1.0, 1e6, 0.16)] {
        let (ratio, lost) = delaminate(size, strength, reduced);
        let name = format!("{size} m, {strength:e} Pa: {ratio}, {lost}");
        assert!((ratio - 1.0).abs() < tolerance && lost < 1e-2, "{name}");
    }
    for (size, strength) in [(0.5, 3e6), (1.0, 1e6)] {
        let (ratio, _) = delaminate(size, strength, StrengthReduction::None);
        assert!(ratio > 1.5, "{size} m: {ratio}");
    }
}
