//! Locations of integration points, for laws with properties that vary in space.

use powerhouse_model::{ElementKernel, PointAdapter};

use super::*;
use powerhouse_elements::{AnyLaw, Hex8Full, Pyramid5, Tet4, Tet10, Wedge6};

/// Isotropic damage with a stiffness and a threshold that vary in space: `d = k / (k + threshold)` by the
/// largest norm `k` of the strain so far, with a modulus of 100 times the threshold times that of the medium.
#[derive(Clone)]
struct Graded {
    medium: ElasticMedium,
    threshold: Threshold,
}

#[derive(Clone)]
enum Threshold {
    Uniform(f64),
    /// By layers of 2 m, from the position.
    OfLayer,
    /// Linear in all coordinates.
    OfPosition,
    /// From the element number.
    OfElement,
}

/// Threshold of the elements with a number.
fn of_element(number: u64) -> f64 {
    1e-3 * (1 + number % 7) as f64
}

/// Threshold at a position (m).
fn of_position<L: Lane>([x, y, z]: [L; 3]) -> L {
    let number = |value: f64| x.constant(value);
    let sum = x.mul_add(number(0.01), y.mul_add(number(0.02), z * number(0.1)));
    (number(1.0) + sum) * number(1e-3)
}

/// Threshold in the layer of a height (m).
fn of_layer<L: Lane>(z: L) -> L {
    let layer = z.mul_add(z.constant(0.5), z.constant(-0.5)).round();
    (z.constant(1.0) + layer) * z.constant(1e-3)
}

impl ConstitutiveLaw for Graded {
    fn name(&self) -> &str {
        "graded"
    }
    fn medium(&self) -> ElasticMedium {
        self.medium
    }
    fn history(&self) -> &'static [HistoryVariable] {
        const { &[HistoryVariable::amount("largest_strain", "1")] }
    }
    fn uses_location(&self) -> bool {
        !matches!(self.threshold, Threshold::Uniform(_))
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        let any = input.strain.0[0];
        let threshold = match self.threshold {
            Threshold::Uniform(threshold) => any.constant(threshold),
            Threshold::OfLayer => of_layer(input.position()[2]),
            Threshold::OfPosition => of_position(input.position()),
            Threshold::OfElement => {
                let elements = input.elements();
                L::build(any.token(), |lane| of_element(elements[lane]))
            }
        };
        let mut square = any.constant(0.0);
        for i in 0..6 {
            square = input.strain.0[i].mul_add(input.strain.0[i], square);
        }
        new[0] = input.history[0].max(square.sqrt());
        let share = threshold / (new[0] + threshold) * (threshold * any.constant(100.0));
        let lambda = any.constant(self.medium.lambda());
        let shear = any.constant(self.medium.shear());
        Stress::elastic(lambda, shear, &input.strain) * share
    }
}

fn law(threshold: Threshold) -> Graded {
    Graded {
        medium: rock(),
        threshold,
    }
}

/// A column of 11 cells of 2 m with element numbers that are not their indices.
fn column(kind: ElementKind) -> Mesh {
    let (low, high) = (Vec3::zeros(), Vec3::new(2.0, 2.0, 22.0));
    let mesh = generator(kind)(low, high, [1, 1, 11], "rock").unwrap();
    of_kind(kind, mesh)
}

/// Forces, tangent products, element forces and histories of a block over some steps.
fn numbers(fixture: &mut Fixture, lanes_of: &str) -> Vec<f64> {
    let mut numbers = Vec::new();
    for step in 0..3 {
        let (u, v) = (fixture.noise(step, 3e-3), fixture.noise(step + 9, 1e-1));
        let views = (NodalView::F64(&u), NodalView::F64(&v));
        let context = BlockContext::new(when(step, 1e-4), views.0, views.1);
        let forces = fixture.forces_at(&context).expect(lanes_of);
        numbers.extend(forces.iter().flat_map(|force| force.iter()));
        fixture.block.commit();
        let product = {
            fixture.static_forces(&u);
            fixture.apply(Operator::Tangent, &v)
        };
        numbers.extend(product.iter().flat_map(|force| force.iter()));
    }
    // Nothing flows: the elements' own histories stay zero.
    let fields = fixture.block.history().into_iter();
    for field in fields.filter(|field| field.name != "element_history") {
        numbers.extend(field.values);
    }
    numbers
}

/// The sum of blocks of one element each, with a uniform law for each element, node by node in the order
/// of the elements; histories one after another.
fn element_by_element(
    mesh: &Mesh,
    kernel: SolidKernel,
    options: BlockOptions,
    threshold: impl Fn(u32) -> f64,
) -> Vec<f64> {
    let count = mesh.node_count() as u32;
    let backwards: Vec<u32> = (0..count).rev().collect();
    let (mut sums, mut histories) = (Vec::new(), Vec::new());
    for element in 0..mesh.element_count() as u32 {
        let law = law(Threshold::Uniform(threshold(element)));
        let part_elements = [element];
        let part = BlockPart::new(mesh, &part_elements, &backwards);
        let block = kernel.factory("rock", law, options).build(&part).unwrap();
        let mut fixture = Fixture {
            mesh: mesh.clone(),
            block,
        };
        let mut own = numbers(&mut fixture, "one element");
        let points = kernel.points();
        histories.extend(own.split_off(own.len() - points));
        sums.resize(own.len(), 0.0);
        for (sum, number) in sums.iter_mut().zip(own) {
            *sum += number;
        }
    }
    sums.extend(histories);
    sums
}

/// One law with properties that vary by layer, by position or by element gives the same bits as a uniform law
/// for each element, for every kernel, in one lane and in many, for laws in lanes and for laws at one point.
#[test]
fn a_graded_law_has_the_bits_of_many_uniform_ones() {
    for kernel in SolidKernel::ALL {
        let mesh = column(kernel.kind());
        let corners = |element: u32| {
            let nodes = mesh.nodes_of(element).iter();
            nodes.map(|&node| mesh.positions()[node as usize])
        };
        let centre = |element: u32| {
            let count = mesh.nodes_of(element).len() as f64;
            corners(element).sum::<Vec3>() / count
        };
        let by_number = |element: u32| of_element(mesh.element_tags()[element as usize]);
        let by_layer = |element: u32| of_layer(centre(element).z);
        for lanes in [LaneWidth::One, LaneWidth::Native] {
            let options = options(Precision::F64, lanes, 2e-4);
            let bits = |numbers: Vec<f64>| -> Vec<u64> {
                assert!(numbers.iter().any(|number| *number != 0.0));
                // Sums of one element each have no negative zeros.
                numbers.iter().map(|n| (n + 0.0).to_bits()).collect()
            };
            for (threshold, expected) in [
                (
                    Threshold::OfElement,
                    element_by_element(&mesh, kernel, options, by_number),
                ),
                (
                    Threshold::OfLayer,
                    element_by_element(&mesh, kernel, options, by_layer),
                ),
            ] {
                let expected = bits(expected);
                let graded = law(threshold);
                let point = PointAdapter::new(AnyLaw::new(graded.clone()));
                let mut in_lanes = Fixture::of(mesh.clone(), kernel, graded, options);
                let mut at_points = Fixture::of(mesh.clone(), kernel, point, options);
                let name = kernel.name();
                assert!(bits(numbers(&mut in_lanes, name)) == expected, "{name}");
                assert!(bits(numbers(&mut at_points, name)) == expected, "{name}");
            }
        }
    }
}

/// In elements with one integration point the position is their centre, in the reference configuration.
#[test]
fn one_point_elements_have_the_position_of_their_centre() {
    let kernel = SolidKernel::Hex8OnePoint(Hex8OnePoint::DEFAULT);
    let mesh = distorted(ElementKind::Hex8, [1, 1, 5]);
    let options = options(Precision::F64, LaneWidth::Native, 0.0);
    let expected = element_by_element(&mesh, kernel, options, |element| {
        // In the order of the shape functions.
        let nodes = mesh.nodes_of(element).iter();
        let positions = nodes.map(|&node| mesh.positions()[node as usize]);
        let centre = positions.fold(Vec3::zeros(), |sum, x| sum + x * 0.125);
        of_position([centre.x, centre.y, centre.z])
    });
    let mut graded = Fixture::of(mesh, kernel, law(Threshold::OfPosition), options);
    assert_eq!(numbers(&mut graded, "graded"), expected);
}

/// A law whose history variables are the position of its point and the number of its element.
#[derive(Clone)]
struct Recorded(ElasticMedium);

impl ConstitutiveLaw for Recorded {
    fn name(&self) -> &str {
        "recorded"
    }
    fn medium(&self) -> ElasticMedium {
        self.0
    }
    fn history(&self) -> &'static [HistoryVariable] {
        const {
            &[
                HistoryVariable::amount("x", "m"),
                HistoryVariable::amount("y", "m"),
                HistoryVariable::amount("z", "m"),
                HistoryVariable::amount("element", "1"),
            ]
        }
    }
    fn uses_location(&self) -> bool {
        true
    }
    #[inline(always)]
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        let any = input.strain.0[0];
        new[..3].copy_from_slice(&input.position());
        let elements = input.elements();
        new[3] = L::build(any.token(), |lane| elements[lane] as f64);
        let lambda = any.constant(self.0.lambda());
        Stress::elastic(lambda, any.constant(self.0.shear()), &input.strain)
    }
}

/// A law receives the position of each integration point and the user's number of its element, in many lanes
/// and in one, in blocks of equal and of distorted elements.
#[test]
fn every_point_has_its_own_position() {
    fn check<K, const N: usize, const P: usize>(of_name: SolidKernel, kernel: &K)
    where
        K: ElementKernel<N, P>,
    {
        let regular = column(kernel.kind());
        for mesh in [regular, distorted(kernel.kind(), [2, 2, 3])] {
            for lanes in [LaneWidth::One, LaneWidth::Native] {
                let options = options(Precision::F64, lanes, 0.0);
                let elements: Vec<u32> = (0..mesh.element_count() as u32).rev().collect();
                let nodes: Vec<u32> = (0..mesh.node_count() as u32).collect();

                let part = BlockPart::new(&mesh, &elements, &nodes);
                let factory = of_name.factory("rock", Recorded(rock()), options);
                let mut fixture = Fixture {
                    mesh: mesh.clone(),
                    block: factory.build(&part).unwrap(),
                };
                let rest = zeros(nodes.len());
                fixture.forces(&rest, &rest);
                fixture.block.commit();
                let fields = fixture.block.history();
                for (index, &element) in elements.iter().enumerate() {
                    let corners = core::array::from_fn(|a| {
                        mesh.positions()[mesh.nodes_of(element)[a] as usize]
                    });
                    for (p, position) in kernel.point_positions(&corners).iter().enumerate() {
                        let value = |field: usize| fields[field].values[index * P + p];
                        assert_eq!(
                            [value(0), value(1), value(2)],
                            [position.x, position.y, position.z]
                        );
                        assert_eq!(value(3), mesh.element_tags()[element as usize] as f64);
                    }
                }
            }
        }
    }
    let one_point = Hex8OnePoint::DEFAULT;
    check(SolidKernel::Hex8OnePoint(one_point), &one_point);
    check(SolidKernel::Hex8Full, &Hex8Full);
    check(SolidKernel::Wedge6, &Wedge6);
    check(SolidKernel::Tet4, &Tet4);
    check(SolidKernel::Pyramid5, &Pyramid5);
    check(SolidKernel::Tet10, &Tet10::new(&rock()));
}
