//! Programs of constitutive laws.

use powerhouse_model::{
    ConstitutiveLaw, Extents, LawInput, Program, ProgramError, Scalar, Strain, Stress,
};

use crate::{Names, record};

/// Names of the components of symmetric tensors.
const COMPONENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "yz", "zx"];

/// Names `prefix.xx` to `prefix.zx` of the six components of a symmetric tensor, of strains with engineering shears.
pub fn component_names(prefix: &str) -> impl Iterator<Item = String> {
    COMPONENTS
        .map(|name| format!("{prefix}.{name}"))
        .into_iter()
}

/// Refuses a law that cannot be recorded.
///
/// # Errors
/// [`ProgramError::OnePoint`] for a law that is evaluated one point at a time, [`ProgramError::Location`] for one that
/// depends on the location of the point.
pub fn check_law(law: &str, in_lanes: bool, uses_location: bool) -> Result<(), ProgramError> {
    let law = law.to_owned();
    match (in_lanes, uses_location) {
        (false, _) => Err(ProgramError::OnePoint { law }),
        (true, true) => Err(ProgramError::Location { law }),
        (true, false) => Ok(()),
    }
}

/// Program of a law at one integration point, with numbers in the format `S`.
///
/// Inputs are `strain` (6), `initial` stress (6), `extents` of the element (6, m2) and the committed `history` variables by their names;
/// outputs are `stress_change` (6) and the new `history`. `forks` is that of [`record`]. Laws that depend on time are discretised for the
/// length of the step first, by [`ConstitutiveLaw::for_step`].
///
/// ```
/// use powerhouse_model::*;
/// # #[derive(Clone)]
/// # struct Linear(ElasticMedium);
/// # impl ConstitutiveLaw for Linear {
/// #     fn name(&self) -> &str { "linear" }
/// #     fn medium(&self) -> ElasticMedium { self.0 }
/// #     fn history(&self) -> &'static [HistoryVariable] { &[] }
/// #     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
/// #         let one = input.strain.0[0].constant(1.0);
/// #         Stress::elastic(one.constant(self.0.lambda()), one.constant(self.0.shear()), &input.strain)
/// #     }
/// # }
/// let law = Linear(ElasticMedium::new(2.5, 0.25, 1.0)?);
/// let program = powerhouse_program::law_program::<f32, _>(&law, 1)?;
/// assert_eq!((program.inputs().len(), program.outputs().len()), (18, 6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// Those of [`check_law`], and [`ProgramError::SingleLanes`] for a law that reads or builds numbers of single lanes.
pub fn law_program<S: Scalar, M: ConstitutiveLaw>(
    law: &M,
    forks: usize,
) -> Result<Program, ProgramError> {
    check_law(law.name(), law.is_in_lanes(), law.uses_location())?;
    let history = || law.history().iter().map(|h| format!("history.{}", h.name));
    let inputs = ["strain", "initial", "extents"].into_iter();
    let names = Names {
        program: law.name().to_owned(),
        inputs: inputs.flat_map(component_names).chain(history()).collect(),
        outputs: component_names("stress_change").chain(history()).collect(),
    };
    record::<S>(names, forks, |x| {
        let six = |first: usize| core::array::from_fn(|i| x[first + i]);
        let input = LawInput::new(Strain(six(0)), &x[18..])
            .with_initial(Stress(six(6)))
            .with_extents(Extents(six(12)));
        let mut new = x[18..].to_vec();
        let change = law.stress_change(&input, &mut new);
        change.0.into_iter().chain(new).collect()
    })
}
