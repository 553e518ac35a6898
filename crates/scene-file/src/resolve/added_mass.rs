//! Added masses of water from scene files.

use powerhouse_elements::WaterMass;
use powerhouse_scene::{Fault, Problem, WaterBeside};

use super::draft::Draft;
use super::{Names, one_of};
use crate::spec::{AddedMass, At, Finite, water_density};

/// Adds the water beside facet sets to a scene.
pub(super) fn added_masses(
    names: &Names,
    masses: &[At<AddedMass>],
    scene: &mut Draft,
) -> Result<(), Fault> {
    for table in masses {
        let set = table.set();
        names.facets(set)?;
        let water = water(table)?;
        (scene.places.added_masses).insert(set.to_string(), set.span());
        scene.waters.push(WaterBeside::new(set.to_string(), water));
    }
    Ok(())
}

fn water(table: &At<AddedMass>) -> Result<WaterMass, Fault> {
    match &**table {
        AddedMass::Westergaard {
            level,
            depth,
            bottom,
            density: given,
            ..
        } => {
            let level = level.get();
            let depth = match (depth, bottom) {
                (Some(depth), None) => depth.get(),
                (None, Some(bottom)) if bottom.get() < level => level - bottom.get(),
                (None, Some(bottom)) => {
                    let found = format!("{} m", bottom.get());
                    let expected = format!("a bottom below the level, {level} m");
                    return Err(Fault::new(
                        bottom.span(),
                        Problem::Value { found, expected },
                    ));
                }
                (depth, bottom) => {
                    let given = [depth.is_some(), bottom.is_some()];
                    return Err(one_of(table.span(), &["depth", "bottom"], &given));
                }
            };
            Ok(WaterMass::Westergaard {
                density: water_density(*given),
                level,
                depth,
            })
        }
        AddedMass::Conduit {
            diameter,
            density: given,
            ..
        } => Ok(WaterMass::Conduit {
            density: water_density(*given),
            diameter: diameter.get(),
        }),
        AddedMass::Table {
            level,
            depths,
            masses,
            ..
        } => Ok(WaterMass::Table {
            level: level.get(),
            depths: rows(depths, "depths that rise from 0, two at least", |depths| {
                let rises = depths.windows(2).all(|pair| pair[0] < pair[1]);
                depths.len() > 1 && depths[0] == 0.0 && rises
            })?,
            masses: rows(
                masses,
                "as many masses as depths, none negative",
                |masses| masses.len() == depths.len() && masses.iter().all(|mass| *mass >= 0.0),
            )?,
        }),
    }
}

/// Numbers of a list that are as expected.
fn rows(
    list: &At<Vec<Finite>>,
    expected: &str,
    is_expected: impl Fn(&[f64]) -> bool,
) -> Result<Vec<f64>, Fault> {
    let numbers: Vec<f64> = list.iter().map(|number| number.get()).collect();
    if is_expected(&numbers) {
        return Ok(numbers);
    }
    let (found, expected) = (format!("{numbers:?}"), expected.into());
    Err(Fault::new(list.span(), Problem::Value { found, expected }))
}
