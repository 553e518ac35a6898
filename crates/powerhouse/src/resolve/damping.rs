//! Damping of parts from scene files.

use powerhouse_material_damage::{DampingBand, ReferenceFrequency, RelaxationSpectrum};
use powerhouse_model::Rayleigh;

use super::ordered;
use crate::Damping;
use crate::fault::Fault;
use crate::format::{self, At, Reference};

/// Default number of relaxation mechanisms.
const MECHANISMS: usize = 3;

/// Damping of a scene table.
pub(super) fn damping(table: &At<format::Damping>) -> Result<Damping, Fault> {
    match &**table {
        format::Damping::None => Ok(Damping::None),
        format::Damping::Rayleigh { ratio, frequencies } => {
            let [first, second] = frequencies.map(|frequency| frequency.get());
            let rayleigh = Rayleigh::from_ratio(ratio.get(), first, second);
            let rayleigh = rayleigh.map_err(|error| Fault::refused(table.span(), error))?;
            Ok(rayleigh.into())
        }
        format::Damping::Coefficients { mass, stiffness } => {
            let (mass, stiffness) = (mass.get(), stiffness.get());
            Ok(Rayleigh { mass, stiffness }.into())
        }
        format::Damping::Flat {
            ratio,
            band,
            mechanisms,
            reference,
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
                Some(at) => {
                    let reference = match **at {
                        Reference::Centre => ReferenceFrequency::Centre,
                        Reference::Static => ReferenceFrequency::Static,
                        Reference::Frequency(frequency) => ReferenceFrequency::At(frequency),
                    };
                    (at.span(), reference)
                }
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
