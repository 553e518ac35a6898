//! Damping of parts from scene files.

use super::draft::Draft;
use powerhouse_material_damage::{DampingBand, ReferenceFrequency, RelaxationSpectrum};
use powerhouse_model::Rayleigh;

use super::ordered;
use crate::spec::{self, At, SceneSpec};
use powerhouse_laws::Damping;
use powerhouse_scene::{Error, Fault};

/// Default number of relaxation mechanisms.
const MECHANISMS: usize = 3;

/// Damping of a scene table.
pub(super) fn damping(table: &At<spec::Damping>) -> Result<Damping, Fault> {
    match &**table {
        spec::Damping::None | spec::Damping::High { .. } => Ok(Damping::None),
        spec::Damping::Rayleigh { ratio, frequencies } => {
            let [first, second] = frequencies.map(|frequency| frequency.get());
            let rayleigh = Rayleigh::from_ratio(ratio.get(), first, second);
            let rayleigh = rayleigh.map_err(|error| Fault::refused(table.span(), error))?;
            Ok(rayleigh.into())
        }
        spec::Damping::Coefficients { mass, stiffness } => {
            let (mass, stiffness) = (mass.get(), stiffness.get());
            Ok(Rayleigh { mass, stiffness }.into())
        }
        spec::Damping::Flat {
            ratio,
            band,
            mechanisms,
            reference,
            high: _,
        } => {
            ordered(band.span(), band.map(|end| end.get()))?;
            let spectrum = RelaxationSpectrum::fit(DampingBand {
                ratio: ratio.get(),
                lowest: band[0].get(),
                highest: band[1].get(),
                mechanisms: mechanisms.as_ref().map_or(MECHANISMS, |count| **count),
            });
            let spectrum = spectrum.map_err(|error| {
                let span = match (error.name, mechanisms) {
                    ("ratio", _) => ratio.span(),
                    ("mechanisms", Some(count)) => count.span(),
                    _ => band.span(),
                };
                Fault::refused(span, error)
            })?;
            let (span, reference) = match reference {
                None => (table.span(), ReferenceFrequency::Centre),
                Some(at) => (at.span(), **at),
            };
            let velocity = reference.velocity(&spectrum);
            velocity.map_err(|error| Fault::refused(span, error))?;
            Ok(Damping::Flat {
                spectrum,
                reference,
            })
        }
    }
}

/// Damping ratio of a scene table at the highest natural frequency of elements; zero without one.
pub(super) fn high(table: &spec::Damping) -> f64 {
    match table {
        spec::Damping::High { ratio } => ratio.get(),
        spec::Damping::Flat { high, .. } => high.as_ref().map_or(0.0, |ratio| ratio.get()),
        _ => 0.0,
    }
}

/// Gives rims to parts that have the damping of their preset and touch an absorbing face, unless the field is damped alike.
pub(super) fn default_rims(file: &SceneSpec, scene: &mut Draft) -> Result<(), Fault> {
    // A damped field has the damping of its layers, which a rim has not.
    if scene.boundary.is_none() || scene.has_damped_layers() {
        return Ok(());
    }
    let place = scene.places.faces.clone();
    let fault = |error: Error| Fault::refused(place.clone(), error);
    let faces = scene
        .absorbing_facets()
        .map_err(|error| fault(error.into()))?;
    let mut rims = Vec::new();
    for index in scene.parts_at_faces().map_err(fault)? {
        let (table, part) = (&file.parts[index], &scene.parts[index]);
        let is_default = table.damping.is_none() && part.damping != Damping::None;
        let is_open = is_default && table.elastic_rim.is_none();
        if is_open && !scene.is_damped_like_field(index, &faces).map_err(fault)? {
            rims.push(index);
        }
    }
    for index in rims {
        scene.parts[index].rim = Some(0.0);
    }
    Ok(())
}
