//! Stiffness operators as matrices: nodal diagonals, and secant and tangent stiffness in the present state.

use powerhouse_model::{
    ElementKernel, Extents, Geometry, Hourglass, KernelArithmetic, LawInput, Mat3, Operator,
    Strain, Stress, Vec3,
};

use super::Block;
use super::law::ErasedLaw;
use super::operations::Moduli;
use super::transfer::NodeScalar;

/// Stiffness `d stress / d strain` at an integration point, rows of stress (Pa).
pub(super) type Stiffness = [[f64; 6]; 6];

/// Step of the difference quotient, relative to the larger of the strain and this number.
const STRAIN_STEP: f64 = 1e-6;

/// Elastic stiffness of an isotropic medium with Lame's constants (Pa).
fn isotropic(lambda: f64, shear: f64) -> Stiffness {
    core::array::from_fn(|j| {
        let mut strain = Strain([0.0; 6]);
        strain.0[j] = 1.0;
        // Symmetric, so that columns may be written as rows.
        Stress::elastic(lambda, shear, &strain).0
    })
}

fn times(stiffness: &Stiffness, strain: &Strain) -> Stress {
    Stress(stiffness.map(|row| row.iter().zip(strain.0).map(|(c, e)| c * e).sum()))
}

/// Secant stiffness: the elastic stiffness scaled so that its stress does the work of the law's stress.
fn secant(law: &(impl ErasedLaw + ?Sized), input: &LawInput<f64>, new: &mut [f64]) -> Stiffness {
    let medium = law.medium();
    let (lambda, shear) = (medium.lambda(), medium.shear());
    let elastic = Stress::elastic(lambda, shear, &input.strain).work(&input.strain);
    let work = law.stress_change(input, new).work(&input.strain);
    let share = if elastic > 0.0 { work / elastic } else { 1.0 };
    let share = share.clamp(0.0, 1.0);
    isotropic(share * lambda, share * shear)
}

/// Tangent stiffness: the law's own, or central differences.
fn tangent(law: &(impl ErasedLaw + ?Sized), input: &LawInput<f64>, new: &mut [f64]) -> Stiffness {
    if let Some(tangent) = law.tangent(input) {
        return tangent;
    }
    let size = input.strain.0.iter().fold(0.0, |m: f64, e| m.max(e.abs()));
    let step = STRAIN_STEP * size.max(STRAIN_STEP);
    let mut stiffness = [[0.0; 6]; 6];
    for j in 0..6 {
        let mut at = |offset: f64| {
            let mut moved = *input;
            moved.strain.0[j] += offset;
            law.stress_change(&moved, new)
        };
        let (plus, minus) = (at(step), at(-step));
        for i in 0..6 {
            stiffness[i][j] = (plus.0[i] - minus.0[i]) / (2.0 * step);
        }
    }
    stiffness
}

/// Strains at the points that equilibrium within an element determines.
struct InnerStrains<const P: usize> {
    volumes: [f64; P],
    /// Strains of unit numbers of the element's own history.
    strains: Vec<[Strain; P]>,
    /// Inverse of their stiffness, padded by ones.
    inverse: Mat3,
}

impl<const P: usize> InnerStrains<P> {
    /// Those of an element with a stiffness at each point; none if its kernel has none, or their stiffness is singular.
    fn new<K, const N: usize>(
        kernel: &K,
        geometry: Geometry<f64>,
        stiffness: &[Stiffness; P],
    ) -> Option<Self>
    where
        K: ElementKernel<N, P>,
    {
        let count = kernel.own_strains();
        if count == 0 {
            return None;
        }
        let strains = (0..count).map(|k| {
            let mut history = vec![0.0; kernel.own_history()];
            history[k] = 1.0;
            let mut strains = [Strain([0.0; 6]); P];
            kernel.add_own_strains(geometry, &history, &mut strains);
            strains
        });
        let mut inner = Self {
            volumes: kernel.volumes(geometry),
            strains: strains.collect(),
            inverse: Mat3::identity(),
        };
        let mut matrix = Mat3::identity();
        for column in 0..count {
            let work = inner.work(stiffness, &inner.strains[column]);
            for row in 0..count {
                matrix[(row, column)] = work[row];
            }
        }
        inner.inverse = matrix.try_inverse()?;
        Some(inner)
    }

    /// Work of the stress of some strains on each unit strain.
    fn work(&self, stiffness: &[Stiffness; P], strains: &[Strain; P]) -> Vec3 {
        let mut work = Vec3::zeros();
        for (row, unit) in self.strains.iter().enumerate() {
            let of_points =
                (0..P).map(|p| times(&stiffness[p], &strains[p]).work(&unit[p]) * self.volumes[p]);
            work[row] = of_points.sum();
        }
        work
    }

    /// Adds the strains that bring an element to equilibrium within.
    fn relax(&self, stiffness: &[Stiffness; P], strains: &mut [Strain; P]) {
        let numbers = -(self.inverse * self.work(stiffness, strains));
        for (unit, number) in self.strains.iter().zip(numbers.iter()) {
            for p in 0..P {
                for i in 0..6 {
                    strains[p].0[i] += number * unit[p].0[i];
                }
            }
        }
    }
}

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    /// Geometry numbers of one element.
    pub(super) fn geometry_of(&self, element: usize, out: &mut [f64]) {
        let (length, width) = (out.len(), self.arrangement.width);
        // There is one batch if all elements are alike, or if there are no more.
        let is_one_batch = self.geometry.as_slice().len() == length * width;
        let element = if is_one_batch {
            element % width
        } else {
            element
        };
        for (index, number) in out.iter_mut().enumerate() {
            let index = self.arrangement.place(element, index, length);
            *number = self.geometry.as_slice()[index].to_f64();
        }
    }

    /// Initial stress of an element (Pa); zero if there is none.
    pub(super) fn initial_of(&self, element: usize) -> [f64; 6] {
        let initial = self.initial.as_slice();
        core::array::from_fn(|i| {
            let value = initial.get(self.arrangement.place(element, i, 6));
            value.map_or(0.0, |value| value.to_f64())
        })
    }

    /// Widths of an element.
    pub(super) fn extents_of(&self, element: usize) -> Extents<f64> {
        let (numbers, width) = (self.extents.as_slice(), self.arrangement.width);
        let is_one_batch = numbers.len() == 6 * width;
        let element = if is_one_batch {
            element % width
        } else {
            element
        };
        let index = |i| self.arrangement.place(element, i, 6);
        Extents(core::array::from_fn(|i| numbers[index(i)].to_f64()))
    }

    /// Displacement (m) of a node, by its index in the block, at the last static forces; zero before.
    fn last_static_displacement(&self, node: usize) -> Vec3 {
        let value = self.static_displacement.get(node);
        value.map_or_else(Vec3::zeros, |value| value.to_vector())
    }

    /// Moduli of the initial stiffness for an operator: those of dynamic steps for [`Operator::Elastic`], those of static states
    /// otherwise.
    pub(super) fn moduli_of(&self, operator: Operator) -> Moduli {
        match operator {
            Operator::Elastic => self.moduli,
            _ => self.moduli.at_rest(),
        }
    }

    /// Stiffness at each integration point of an element for an operator, and hourglass moduli (Pa).
    fn stiffness(
        &self,
        operator: Operator,
        element: usize,
        geometry: &[f64],
    ) -> ([Stiffness; P], [f64; 3]) {
        let moduli = self.moduli_of(operator);
        let elastic = isotropic(moduli.lambda, moduli.shear);
        let is_initial = matches!(operator, Operator::Elastic | Operator::Static);
        let law = match self.law.static_form() {
            Some(law) if !(is_initial || law.takes_blocks()) => law,
            _ => return ([elastic; P], self.moduli.hourglass),
        };
        let nodal = self.connectivity.as_slice()[element]
            .map(|local| self.last_static_displacement(local as usize).into());
        let geometry = Geometry::<f64>::new((), geometry);
        let mut strains = self.kernel.strains(geometry, &self.kernel.modes(&nodal));
        let own = self.history.own_of_element(&self.arrangement, element);
        if !own.is_empty() {
            self.kernel.add_own_strains(geometry, &own, &mut strains);
        }
        let stiffness = self.at_points(element, &strains, |input, new| match operator {
            Operator::Secant => secant(law, input, new),
            _ => tangent(law, input, new),
        });
        (stiffness, self.hourglass_moduli(law, element, &strains))
    }

    /// Hourglass moduli (Pa) of an element at some strains, from the committed history variables.
    pub(super) fn hourglass_moduli(
        &self,
        law: &(impl ErasedLaw + ?Sized),
        element: usize,
        strains: &[Strain; P],
    ) -> [f64; 3] {
        let whole = self.moduli.hourglass;
        if !self.moduli.resist() {
            return whole;
        }
        let left = self.at_points(element, strains, |input, new| {
            let change = law.stress_change(input, new);
            law.hourglass_share(input, new, &change)
        });
        let mean = left.iter().sum::<f64>() / P as f64;
        whole.map(|modulus| modulus * mean.max(self.kernel.least_hourglass_share()))
    }

    /// Results of a function at each integration point of an element at some strains: it takes the input of
    /// a law with the committed history variables, and room for new ones.
    pub(super) fn at_points<T>(
        &self,
        element: usize,
        strains: &[Strain; P],
        mut evaluate: impl FnMut(&LawInput<f64>, &mut [f64]) -> T,
    ) -> [T; P] {
        let initial = self.initial_of(element);
        let extents = self.extents_of(element);
        let variables = self.history.variables();
        let mut new = vec![0.0; variables];
        core::array::from_fn(|p| {
            let old: Vec<f64> = (0..variables)
                .map(|h| self.history.value(&self.arrangement, element, (p, h)))
                .collect();
            let locations = self.locations.as_ref();
            let location =
                locations.map(|locations| locations.of_element(&self.arrangement, element, p));
            let mut input = LawInput::new(strains[p], &old)
                .with_initial(Stress(initial))
                .with_extents(extents);
            if let Some(location) = &location {
                input = input.with_location(location);
            }
            evaluate(&input, &mut new)
        })
    }

    /// Calls a function with every active element and its map from nodal displacements to nodal forces.
    pub(super) fn each_element(
        &self,
        operator: Operator,
        mut visit: impl FnMut(usize, &dyn Fn(&[[f64; 3]; N]) -> [[f64; 3]; N]),
    ) {
        let mut numbers = vec![0.0; self.kernel.geometry_len()];
        for element in 0..self.elements.len() {
            if self.active.as_ref().is_some_and(|active| !active[element]) {
                continue;
            }
            self.geometry_of(element, &mut numbers);
            let (stiffness, moduli) = self.stiffness(operator, element, &numbers);
            let geometry = Geometry::<f64>::new((), &numbers);
            let inner = InnerStrains::new(&self.kernel, geometry, &stiffness);
            visit(element, &|nodal| {
                let modes = self.kernel.modes(nodal);
                let mut strains = self.kernel.strains(geometry, &modes);
                if let Some(inner) = &inner {
                    inner.relax(&stiffness, &mut strains);
                }
                let stresses = core::array::from_fn(|p| times(&stiffness[p], &strains[p]));
                let hourglass = Hourglass::new(moduli);
                let forces = (self.kernel).forces(geometry, &stresses, &hourglass, &modes);
                self.kernel.nodal_forces(&forces)
            });
        }
    }

    /// Calls a function with the stiffness matrix of every active element.
    pub(super) fn visit_matrices(&self, operator: Operator, visit: &mut dyn FnMut(&[u32], &[f64])) {
        let size = 3 * N;
        let mut matrix = vec![0.0; size * size];
        self.each_element(operator, |element, forces| {
            for column in 0..size {
                let mut nodal = [[0.0; 3]; N];
                nodal[column / 3][column % 3] = 1.0;
                let forces = forces(&nodal);
                for row in 0..size {
                    matrix[row * size + column] = forces[row / 3][row % 3];
                }
            }
            visit(&self.connectivity.as_slice()[element], &matrix);
        });
    }

    /// Adds the nodal forces of uniform element stresses.
    pub(super) fn add_forces_of_stress(&self, stresses: &[Stress], out: &mut [Vec3]) {
        let hourglass = Hourglass::new(self.moduli.hourglass);
        let mut numbers = vec![0.0; self.kernel.geometry_len()];
        for (element, &stress) in stresses.iter().enumerate().take(self.elements.len()) {
            if !self.is_active(element) {
                continue;
            }
            self.geometry_of(element, &mut numbers);
            let geometry = Geometry::<f64>::new((), &numbers);
            let modal = (self.kernel).forces(geometry, &[stress; P], &hourglass, &[[0.0; 3]; N]);
            let nodal = self.kernel.nodal_forces(&modal);
            for (&local, force) in self.connectivity.as_slice()[element].iter().zip(nodal) {
                out[local as usize] += Vec3::from(force);
            }
        }
    }

    /// Adds the nodal 3 x 3 diagonal blocks of an operator.
    pub(super) fn add_diagonal(&self, operator: Operator, out: &mut [Mat3]) {
        self.each_element(operator, |element, forces| {
            for a in 0..N {
                let block = &mut out[self.connectivity.as_slice()[element][a] as usize];
                for j in 0..3 {
                    let mut nodal = [[0.0; 3]; N];
                    nodal[a][j] = 1.0;
                    let column = forces(&nodal)[a];
                    for i in 0..3 {
                        block[(i, j)] += column[i];
                    }
                }
            }
        });
    }
}
