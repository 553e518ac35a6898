//! Pictures of a case: section through the middle of its structure.

use std::path::{Path, PathBuf};

use powerhouse::Results;
use powerhouse::io::{ColourMap, Picture, PictureField, PictureView, SectionPlane, write_picture};
use powerhouse::model::{Mesh, Vec3};

use super::damage::{Damage, STRUCTURE};
use crate::StudyError;
use crate::excerpt::excerpt;

/// Names of the causes of damage, by their numbers; crushing counts as shear.
const KINDS: [&str; 4] = ["none", "tension", "shear", "both"];

/// Draws the greatest damage, its cause and the greatest principal stress of the structure into a folder, as far as
/// they are available; nothing without an element set `structure`. Returns the files.
pub(super) fn draw(
    folder: &Path,
    mesh: &Mesh,
    results: &Results,
) -> Result<Vec<PathBuf>, StudyError> {
    let present = results.present.as_deref();
    let is_there = |element: &u32| present.is_none_or(|present| present[*element as usize]);
    let structure: Vec<u32> = match mesh.element_set(STRUCTURE) {
        Ok(structure) => structure.iter().copied().filter(is_there).collect(),
        Err(_) => Vec::new(),
    };
    if structure.is_empty() {
        return Ok(Vec::new());
    }
    let mut files = Vec::new();
    let body = excerpt(mesh, &structure)?;
    let (low, high) = body.bounding_box();
    let mut draw =
        |name: &str, label: &str, (range, kinds), values: &[f64]| -> Result<(), StudyError> {
            let mut picture = Picture::new(&body, PictureField::Elemental(values), label);
            picture.names = kinds;
            picture.view = PictureView {
                direction: Vec3::new(-0.35, 1.0, -0.3),
                up: Vec3::z(),
            };
            picture.section = Some(SectionPlane {
                point: (low + high) / 2.0,
                normal: -Vec3::y(),
            });
            picture.range = range;
            picture.colours = ColourMap::default();
            let file = folder.join(format!("pictures/structure-{name}.png"));
            write_picture(&file, &picture).map_err(powerhouse::Error::from)?;
            files.push(file);
            Ok(())
        };
    let of = |elements: &[u32], values: &[f64]| -> Vec<f64> {
        let known: std::collections::HashMap<u32, f64> = elements
            .iter()
            .copied()
            .zip(values.iter().copied())
            .collect();
        let value = |element: &u32| known.get(element).copied().unwrap_or(0.0);
        structure.iter().map(value).collect()
    };
    if let Some(state) = &results.state {
        let damages = state.peaks.iter();
        for (variable, peaks) in damages.filter(|(v, _)| v.name.starts_with("damage")) {
            let values = of(&state.elements, &peaks.values);
            let range = (Some([0.0, 1.0]), &[][..]);
            draw(variable.name, variable.name, range, &values)?;
        }
        if let Some(damage) = Damage::of(mesh, state) {
            let of = structure.iter();
            let kinds: Vec<f64> = of.map(|&e| damage.kinds[e as usize]).collect();
            draw("damage-type", "damaged by", (None, &KINDS[..]), &kinds)?;
        }
    }
    if let Some(envelope) = &results.envelope
        && !envelope.greatest_stress.values.is_empty()
    {
        let values = of(&envelope.elements, &envelope.greatest_stress.values);
        let values: Vec<f64> = values.iter().map(|stress| 1e-6 * stress).collect();
        let label = "greatest principal stress (MPa)";
        draw("stress", label, (None, &[]), &values)?;
    }
    Ok(files)
}
