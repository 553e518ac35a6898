//! Closed-form solution of a scene without a structure: its incident field.

use powerhouse::io::TableColumn;
use powerhouse::model::{FieldMotion, Vec3};
use powerhouse::spec::{At, Support};
use powerhouse::{Damping, Error, Scene, SceneSpec};

use crate::StudyError;
use crate::advice::inner_free_surface;

/// Reason in a scene's keys why its motion differs from the incident field.
fn disturbance(spec: &SceneSpec) -> Option<&'static str> {
    let holds = |support: &At<Support>| {
        matches!(
            **support,
            Support::Fixed { .. } | Support::Prescribed { .. }
        )
    };
    if !spec.loads.is_empty() || !spec.bolts.is_empty() {
        return Some("it has loads or bolts");
    }
    if !spec.added_masses.is_empty() {
        return Some("it has added masses");
    }
    if spec.supports.iter().any(holds) {
        return Some("it has fixed or prescribed nodes");
    }
    let region = spec
        .boundary
        .as_ref()
        .and_then(|boundary| boundary.region.as_ref());
    region.map(|_| "its waves enter only around a region")
}

/// The motion of the incident field at the recorded points of a scene, at given times (s).
///
/// # Errors
/// [`StudyError::NoClosedForm`] for a scene whose motion differs from its incident field.
pub(super) fn closed_form(
    (scene, spec): (&Scene, &SceneSpec),
    times: &[f64],
) -> Result<Vec<TableColumn>, StudyError> {
    let no_closed_form = |reason| StudyError::NoClosedForm { reason };
    if let Some(reason) = disturbance(spec) {
        return Err(no_closed_form(reason));
    }
    let field = scene
        .field()
        .ok_or(no_closed_form("it has no incident field"))?;
    if field.stations().is_some() {
        return Err(no_closed_form("its field is given at stations alone"));
    }
    if scene.boundary().is_none() {
        return Err(no_closed_form("it has no absorbing boundary"));
    }
    if scene.joints().next().is_some() || !scene.stages().is_empty() {
        return Err(no_closed_form("it has joints or stages"));
    }
    let of_field = |part: &powerhouse::Part| {
        part.material.is_linear()
            && part.material.medium() == field.medium()
            && part.damping == Damping::None
    };
    if !scene.parts().iter().all(of_field) {
        return Err(no_closed_form(
            "a part is not the undamped elastic ground of its field",
        ));
    }
    if !inner_free_surface(scene)?.is_empty() {
        return Err(no_closed_form("it has an opening, which scatters waves"));
    }
    let mut columns = vec![TableColumn::new("time", "s", times.to_vec())];
    for request in &scene.output().histories {
        let points = request.place.points(scene.mesh());
        let sampler = field.prepare(&points).map_err(Error::from)?;
        let mut motions = vec![FieldMotion::default(); points.len()];
        let mut found = [const { Vec::new() }; 6];
        for &time in times {
            motions.fill(FieldMotion::default());
            sampler.add_motion(time, &mut motions);
            let share = 1.0 / points.len() as f64;
            let mean = |of: fn(&FieldMotion) -> Vec3| -> Vec3 {
                motions.iter().map(of).sum::<Vec3>() * share
            };
            let (u, v) = (mean(|m| m.displacement), mean(|m| m.velocity));
            for axis in 0..3 {
                found[axis].push(u[axis]);
                found[3 + axis].push(v[axis]);
            }
        }
        let names = ["ux", "uy", "uz", "vx", "vy", "vz"];
        for (index, (name, values)) in names.into_iter().zip(found).enumerate() {
            let (wanted, unit) = match index {
                0..3 => (request.motion.displacement, "m"),
                _ => (request.motion.velocity, "m/s"),
            };
            if wanted {
                columns.push(TableColumn::new(
                    format!("{}.{name}", request.name),
                    unit,
                    values,
                ));
            }
        }
    }
    Ok(columns)
}
