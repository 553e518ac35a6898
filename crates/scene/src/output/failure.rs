//! What limited the step of a run that failed, and what may help.

use powerhouse_model::{RunError, RunReport};

/// Share of the stable step above which a step counts as the stable one.
const AT_LIMIT: f64 = 0.9;

/// Advice on a failed run: what limited its time step, and what may help; empty where the error says it all.
pub(crate) fn advice(error: &RunError, run: &RunReport) -> Vec<String> {
    let diverged = matches!(
        error,
        RunError::Diverged { .. } | RunError::Element { .. } | RunError::EnergyResidual { .. }
    );
    if !diverged {
        return Vec::new();
    }
    let mut advice = Vec::new();
    let step = run.step;
    if let Some(stable) = &run.stable {
        let share = 100.0 * step / stable.step;
        let mut text = format!("the step of {step:.4e} s is {share:.0} % of the stable one");
        if !stable.set.is_empty() {
            text += &format!(
                ", which element {} of set '{}' limits ({})",
                stable.element,
                stable.set,
                stable.term.name()
            );
        }
        advice.push(text);
        if step >= AT_LIMIT * stable.step {
            advice.push(format!(
                "the stable step is that of the elastic body: laws that stiffen, joints that close and stiffness damping \
                 after cracking shorten it; try a step of {:.4e} s in [time]",
                0.5 * step
            ));
        }
    }
    let set = match error {
        RunError::Diverged { set, .. }
        | RunError::Element { set, .. }
        | RunError::EnergyResidual { set, .. } => set,
        _ => return advice,
    };
    advice.push(format!(
        "look at set '{set}': the files hold the results until then (state.vtu and envelope.vtu show where), \
         and `check` names its worst elements; with an elastic law for it a run shows whether its law is the cause"
    ));
    advice
}
