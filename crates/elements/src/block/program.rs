//! Program of one element: the arithmetic of the forces of a dynamic step as data.
//!
//! It follows [`Elastic`](super::operations::Elastic) and [`Material`](super::operations::Material) operation by
//! operation, so that its results have their bits.

use powerhouse_model::{
    ElementKernel, Extents, Geometry, Hourglass, KernelArithmetic, Lane, LawInput, NodalView,
    OwnStep, Program, ProgramError, RemainingStiffness, Stress, Vec3,
};
use powerhouse_program::{Names, Traced, check_law, component_names, record};

use super::Block;
use super::law::BatchLaw;
use super::own::{elastic_share, flows, kept};
use super::remaining::{damped_share, times};
use super::transfer::NodeScalar;

/// Names of the components of vectors.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Numbers of the inputs of a program, taken one after the other.
struct Inputs<'a, L> {
    rest: &'a [L],
}

impl<'a, L: Lane> Inputs<'a, L> {
    fn take(&mut self, count: usize) -> &'a [L] {
        let (taken, rest) = self.rest.split_at(count);
        self.rest = rest;
        taken
    }
    fn six(&mut self) -> [L; 6] {
        let taken = self.take(6);
        core::array::from_fn(|i| taken[i])
    }
    fn nodal<const N: usize>(&mut self) -> [[L; 3]; N] {
        let taken = self.take(3 * N);
        core::array::from_fn(|a| core::array::from_fn(|i| taken[3 * a + i]))
    }
}

/// Names of nodal vectors.
fn nodal_names(prefix: &str, nodes: usize) -> impl Iterator<Item = String> {
    (0..nodes).flat_map(move |a| AXES.map(|axis| format!("{prefix}.{a}.{axis}")))
}

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    /// Whether the program of a nonlinear law has velocities among its inputs.
    fn program_reads_velocity(&self) -> bool {
        self.damping.stiffness != 0.0 || self.follows_flow()
    }

    /// Program of one element in dynamic steps of a length (s).
    pub(super) fn recorded(&self, step: f64, forks: usize) -> Result<Program, ProgramError> {
        let law = self.law.static_form().map(|law| law.for_step(step));
        if let Some(law) = &law {
            check_law(law.name(), law.is_in_lanes(), law.uses_location())?;
        }
        let mut names = Names {
            program: self.label.to_string(),
            inputs: nodal_names("displacement", N).collect(),
            outputs: nodal_names("force", N).collect(),
        };
        if law.is_some() && self.program_reads_velocity() {
            names.inputs.extend(nodal_names("velocity", N));
        }
        let geometry = 0..self.kernel.geometry_len();
        names
            .inputs
            .extend(geometry.map(|i| format!("geometry.{i}")));
        if let Some(law) = &law {
            names.inputs.extend(component_names("initial"));
            names.inputs.extend(component_names("extents"));
            let of_points = (0..P).flat_map(|p| {
                let variables = law.history().iter();
                variables.map(move |variable| format!("history.{p}.{}", variable.name))
            });
            let own = (0..self.kernel.own_history()).map(|i| format!("element_history.{i}"));
            let history: Vec<String> = of_points.chain(own).collect();
            names.inputs.extend(history.iter().cloned());
            names.outputs.extend(history);
        }
        record::<S>(names, forks, |inputs| match &law {
            Some(law) => self.material_program(law.as_ref(), step, inputs),
            None => self.elastic_program(inputs),
        })
    }

    /// Inputs of the program for an element, in the order of their names.
    pub(super) fn inputs_of(
        &self,
        element: usize,
        displacement: NodalView,
        velocity: NodalView,
    ) -> Vec<f64> {
        let nodes = &self.connectivity.as_slice()[element];
        // As nodal values are gathered: in single precision relative to the first node.
        let single = size_of::<S>() < size_of::<f64>();
        let relative = |values: [Vec3; N], rounded: bool| {
            let first = if rounded { values[0] } else { Vec3::zeros() };
            let rounded = move |value: f64| S::from_f64(value).to_f64();
            values.map(|value| (value - first).map(rounded))
        };
        let is_linear = self.is_linear();
        let moved = core::array::from_fn(|a| {
            let local = nodes[a] as usize;
            let mut moved = displacement.vector(local);
            if is_linear && self.damping.stiffness != 0.0 {
                moved += velocity.vector(local) * self.damping.stiffness;
            }
            let from = self.reference.as_ref();
            moved - from.map_or(Vec3::zeros(), |from| from[local].to_vector())
        });
        let flat = |values: [Vec3; N]| values.into_iter().flat_map(<[f64; 3]>::from);
        let mut inputs: Vec<f64> = flat(relative(moved, single)).collect();
        if !is_linear && self.program_reads_velocity() {
            let values = core::array::from_fn(|a| velocity.vector(nodes[a] as usize));
            let in_double = matches!(velocity, NodalView::F64(_));
            inputs.extend(flat(relative(values, single && in_double)));
        }
        let start = inputs.len();
        inputs.resize(start + self.kernel.geometry_len(), 0.0);
        self.geometry_of(element, &mut inputs[start..]);
        if !is_linear {
            inputs.extend(self.initial_of(element));
            inputs.extend(self.extents_of(element).0);
            let history = self.history.of_element(&self.arrangement, element);
            inputs.extend(history.map(|number| number.to_f64()));
        }
        inputs
    }

    fn elastic_program(&self, inputs: &[Traced<S>]) -> Vec<Traced<S>> {
        let mut inputs = Inputs { rest: inputs };
        let number = |value: f64| Traced::<S>::splat((), value);
        let nodal = inputs.nodal::<N>();
        let geometry = Geometry::new((), inputs.take(self.kernel.geometry_len()));
        let moduli = [number(self.moduli.lambda), number(self.moduli.shear)];
        let modes = self.kernel.modes(&nodal);
        let forces = self.kernel.elastic_forces(geometry, moduli, &modes);
        let forces = forces.unwrap_or_else(|| {
            let strains = self.kernel.strains(geometry, &modes);
            let stresses = strains.map(|strain| Stress::elastic(moduli[0], moduli[1], &strain));
            let hourglass = Hourglass::new(self.moduli.hourglass.map(number));
            (self.kernel).forces(geometry, &stresses, &hourglass, &modes)
        });
        let forces = self.kernel.nodal_forces(&forces);
        forces.into_iter().flatten().collect()
    }

    fn material_program(
        &self,
        law: &dyn BatchLaw<S>,
        step: f64,
        inputs: &[Traced<S>],
    ) -> Vec<Traced<S>> {
        let mut inputs = Inputs { rest: inputs };
        let number = |value: f64| Traced::<S>::splat((), value);
        let (zero, one) = (number(0.0), number(1.0));
        let nodal = inputs.nodal::<N>();
        let velocity = self.program_reads_velocity().then(|| inputs.nodal::<N>());
        let geometry = Geometry::new((), inputs.take(self.kernel.geometry_len()));
        let initial = Stress(inputs.six());
        let extents = Extents(inputs.six());
        let variables = law.history().len();
        let old = inputs.take(P * variables);
        let mut own = inputs.rest.to_vec();

        let mut modes = self.kernel.modes(&nodal);
        let mut strains = self.kernel.strains(geometry, &modes);
        if !own.is_empty() {
            self.kernel.own_at_start(&mut own);
            (self.kernel).add_own_strains(geometry, &own, &mut strains);
        }
        let mut new = old.to_vec();
        let mut remaining = [RemainingStiffness::whole(one); P];
        let mut stresses = [Stress([zero; 6]); P];
        for p in 0..P {
            let here = p * variables..(p + 1) * variables;
            let input = LawInput::new(strains[p], &old[here.clone()])
                .with_initial(initial)
                .with_extents(extents);
            (stresses[p], remaining[p]) = law.record(&input, &mut new[here]);
        }

        let resist = self.moduli.resist();
        let mut share = one;
        if resist {
            share = remaining[0].hourglass;
            for point in &remaining[1..] {
                share = share + point.hourglass;
            }
            share = share * number(1.0 / P as f64);
            share = share.max(number(self.kernel.least_hourglass_share()));
        }
        let whole = self.moduli.hourglass.map(number);
        let rates = velocity.map(|velocity| self.kernel.modes(&velocity));
        if !own.is_empty() {
            let before = own.clone();
            let after = OwnStep::new(&before, &modes, &stresses);
            match (&rates, resist) {
                (Some(rates), true) => {
                    if flows(&remaining) {
                        let moved = times(rates, number(step));
                        let strains = self.kernel.strains(geometry, &moved);
                        let elastic = elastic_share(&remaining, &strains);
                        let shear = number(self.moduli.shear);
                        let kept = kept(&remaining, &stresses, &initial, shear);
                        let after = after.with_flow(&moved, whole, [elastic, kept]);
                        self.kernel.own_history_after(geometry, &after, &mut own);
                    }
                }
                _ => self.kernel.own_history_after(geometry, &after, &mut own),
            }
        }
        let moduli = whole.map(|modulus| modulus * share);
        if let (Some(rates), true) = (&rates, self.damping.stiffness != 0.0) {
            let coefficient = self.damping.stiffness;
            let lambda = number(coefficient * self.moduli.lambda);
            let shear = number(coefficient * self.moduli.shear);
            let strain_rates = self.kernel.strains(geometry, rates);
            for p in 0..P {
                let resisted = Stress::elastic(lambda, shear, &strain_rates[p]);
                let share = damped_share(&remaining[p], &resisted, &strain_rates[p], step);
                stresses[p] = stresses[p] + resisted * share;
            }
            let coefficient = number(coefficient);
            for (mode, rate) in modes.iter_mut().zip(rates) {
                for i in 0..3 {
                    mode[i] = rate[i].mul_add(coefficient, mode[i]);
                }
            }
        }
        let hourglass = Hourglass::new(moduli).with_history(&own);
        let forces = (self.kernel).forces(geometry, &stresses, &hourglass, &modes);
        let forces = self.kernel.nodal_forces(&forces);
        forces.into_iter().flatten().chain(new).chain(own).collect()
    }
}
