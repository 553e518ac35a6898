//! Properties that vary in space, and kernels of one's own, leave the bits as they are.

use powerhouse::engine::{BuildModel, Leapfrog, Model, run};
use powerhouse::{Kernel, Material};
use powerhouse_elements::{AnyLaw, Hex8Full, SolidKernel};
use powerhouse_material_damage::{ElastoPlastic, MohrCoulomb, presets};
use powerhouse_model::{
    BlockLaw, BlockLawInput, BlockOptions, ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane,
    LawInput, Mesh, PointLaw, PointLocation, Precision, RunOptions, State, StepChoice, Stress,
    Vec3,
};

/// Cells of the column, each 1 m high.
const CELLS: usize = 9;

/// Soil that softens by the largest shear strain so far; its strength grows with depth, layer by layer.
#[derive(Clone)]
struct Soil {
    medium: ElasticMedium,
    /// The layer of all points, counted from below; none if it is that of their position.
    layer: Option<f64>,
}

/// Reference strain in a layer.
fn reference<L: Lane>(layer: L) -> L {
    layer.constant(1e-3) / (layer.constant(1.0) + layer)
}

impl ConstitutiveLaw for Soil {
    fn name(&self) -> &str {
        "soil"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &[HistoryVariable] {
        const { &[HistoryVariable::amount("largest_shear_strain", "1")] }
    }
    fn uses_location(&self) -> bool {
        self.layer.is_none()
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new_history: &mut [L]) -> Stress<L> {
        let [.., xy, yz, zx] = input.strain.0;
        let layer = match self.layer {
            Some(layer) => xy.constant(layer),
            None => (input.position()[2] - xy.constant(0.5)).round(),
        };
        let strain = xy.mul_add(xy, yz.mul_add(yz, zx * zx)).sqrt();
        new_history[0] = input.history[0].max(strain);
        let share = reference(layer) / (reference(layer) + new_history[0]);
        let lambda = xy.constant(self.medium.lambda());
        let shear = xy.constant(self.medium.shear());
        Stress::elastic(lambda, shear, &input.strain) * share
    }
}

/// A law for one point, evaluated for all points of a block at once.
struct InBlocks(AnyLaw);

impl BlockLaw for InBlocks {
    fn name(&self) -> &str {
        PointLaw::name(&self.0)
    }
    fn medium(&self) -> ElasticMedium {
        PointLaw::medium(&self.0)
    }
    fn history(&self) -> &[HistoryVariable] {
        PointLaw::history(&self.0)
    }
    fn uses_location(&self) -> bool {
        PointLaw::uses_location(&self.0)
    }
    fn stress_changes(&self, points: &BlockLawInput, stresses: &mut [Stress], new: &mut [f64]) {
        // All of the column are one block.
        assert!(points.len() >= CELLS, "{}", points.len());
        for (point, (stress, new)) in stresses.iter_mut().zip(new.chunks_mut(1)).enumerate() {
            let input = LawInput::new(points.strains[point], points.history_of(point))
                .with_initial(points.initial[point])
                .with_extents(points.extents[point]);
            *stress = match points.positions.get(point) {
                None => self.0.stress_change(&input, new),
                Some(&position) => {
                    let location = PointLocation::new(position, &points.elements[point..=point]);
                    self.0.stress_change(&input.with_location(&location), new)
                }
            };
        }
    }
}

fn soil(layer: Option<f64>) -> Soil {
    Soil {
        medium: ElasticMedium::new(100.0e6, 0.3, 1900.0).unwrap(),
        layer,
    }
}

/// A column of cells, each an element set of its own if they are apart.
fn column(apart: bool) -> Mesh {
    let high = Vec3::new(1.0, 1.0, CELLS as f64);
    let mut mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [1, 1, CELLS], "soil").unwrap();
    if apart {
        for cell in 0..CELLS {
            mesh.set_element_set(&format!("soil {cell}"), vec![cell as u32])
                .unwrap();
        }
    }
    mesh
}

/// Displacements, velocities and history variables of the shaken column, with the materials of its sets.
fn shaken(
    kernel: &Kernel,
    precision: Precision,
    mesh: &Mesh,
    parts: &[(String, Material)],
) -> State {
    let mut options = BlockOptions::default();
    options.precision = precision;
    options.damping.stiffness = 1e-5;
    let mut builder = Model::builder(mesh);
    for (set, material) in parts {
        builder = builder.elements(set.as_str(), kernel.factory(set, material, options));
    }
    let mut model = builder.threads(1).build().unwrap();
    let velocity = |x: &Vec3| Vec3::new((0.7 * x.z).sin(), 0.3 * (0.4 * x.z).cos(), 0.1 * x.x);
    let velocities: Vec<Vec3> = mesh.positions().iter().map(velocity).collect();
    let rest = vec![Vec3::zeros(); mesh.node_count()];
    model.set_initial(&rest, &velocities).unwrap();
    let options = RunOptions::steps(200).with_step(StepChoice::Unchecked(2e-4));
    run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
    model.state()
}

fn motion(state: &State) -> Vec<u64> {
    let vectors = state.displacement.iter().chain(&state.velocity);
    let numbers = vectors.flat_map(|v| v.iter());
    numbers.map(|n| n.to_bits()).collect()
}

/// A strength that grows with depth in one law for one element set gives the same motion, bit by bit in double
/// precision, as an element set with a uniform law for each cell; also as a law for one point, and for a block at once.
#[test]
fn a_graded_law_has_the_motion_of_many_sets() {
    for kernel in [SolidKernel::ALL[0], SolidKernel::Hex8Full] {
        let kernel = Kernel::from(kernel);
        let layers: Vec<(String, Material)> = (0..CELLS)
            .map(|cell| {
                let law = soil(Some(cell as f64));
                (format!("soil {cell}"), Material::new(law))
            })
            .collect();
        let expected = shaken(&kernel, Precision::F64, &column(true), &layers);
        let uniform = Material::new(soil(Some(0.0)));
        for (material, equal) in [
            (Material::new(soil(None)), true),
            (Material::from_point_law(AnyLaw::new(soil(None))), true),
            (
                Material::from_block_law(InBlocks(AnyLaw::new(soil(None)))),
                true,
            ),
            (uniform, false),
        ] {
            let parts = [("soil".to_string(), material)];
            let found = shaken(&kernel, Precision::F64, &column(false), &parts);
            let same = motion(&found) == motion(&expected);
            assert_eq!(same, equal, "{}", kernel.name());
        }
    }
}

/// A user's kernel evaluates laws in lanes: in mixed precision too it has the bits of the same kernel of the software
/// (in bricks that are neither boxes nor parallelepipeds, for which that one has shorter arithmetic), with a law that yields and with a linear one.
#[test]
fn an_own_kernel_has_the_bits_of_a_built_in_one() {
    let twisted = |x: Vec3| {
        x + Vec3::new(
            0.1 * x.y * x.z.sin(),
            0.1 * x.x * x.z.cos(),
            0.1 * x.x * x.y,
        )
    };
    let mesh = column(false).map_positions(twisted).unwrap();
    let rock = ElastoPlastic::new(MohrCoulomb::new(presets::PAPER_ROCK).unwrap());
    let linear = powerhouse_material_damage::LinearElastic::new(presets::PAPER_ROCK.medium);
    for material in [Material::from(rock), Material::from(linear)] {
        for precision in [Precision::F64, Precision::Mixed] {
            let parts = [("soil".to_string(), material.clone())];
            let of = |kernel: Kernel| motion(&shaken(&kernel, precision, &mesh, &parts));
            let built_in = of(Kernel::from(SolidKernel::Hex8Full));
            assert!(of(Kernel::own(Hex8Full)) == built_in, "{}", material.name());
        }
    }
}
