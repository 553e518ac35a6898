//! Loss of stiffness and of neighbouring elements, and softening.

use powerhouse::Material;
use powerhouse::engine::{BuildModel, Model};
use powerhouse_material_damage::{media, presets};
use powerhouse_model::{Rayleigh, State, Vec3};

use super::cell::{Refusal, Row};
use super::column::{Column, SET};
use super::trial::{Trial, elastic, irregular, shaken};

pub(super) fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    for (name, speed) in [
        ("concrete that cracks", 0.3),
        ("concrete cracked and crushed all over", 20.0),
    ] {
        rows.push(Row::new(name, move |column| {
            Trial::of(column).play(|damping| {
                let law = presets::paper_concrete()?;
                cracking(column, Material::from(law), (0.5, speed), damping)
            })
        }));
    }
    for share in [0.999, 1.001] {
        let name = format!("elements {share} times as wide as the one that snaps back");
        rows.push(Row::new(name, move |column| {
            Trial::of(column).play(|damping| {
                let law = presets::paper_concrete()?;
                let largest = law.largest_size().ok_or("no size snaps back")?;
                // The width is the cube root of the volume.
                let of_cell = (column.elements_per_cell() as f64).cbrt();
                let size = share * largest * of_cell;
                cracking(column, Material::from(law), (size, 0.3), damping)
            })
        }));
    }
    for (name, left) in [
        ("every second element excavated", 2),
        ("all elements but the first excavated", usize::MAX),
        ("all elements excavated", 0),
    ] {
        rows.push(Row::new(name, move |column| {
            Trial::of(column).play(|damping| excavated(column, left, damping))
        }));
    }
    rows
}

/// A box of concrete, its cells of a size (m), in random motion of a speed (m/s).
fn cracking(
    column: &Column,
    concrete: Material,
    (size, speed): (f64, f64),
    damping: Rayleigh,
) -> Result<Model, Refusal> {
    let mesh = column.boxed(size * Vec3::new(3.0, 2.0, 2.0), [3, 2, 2])?;
    let factory = column.factory(&concrete, damping);
    let builder = Model::builder(&mesh).elements(SET, factory);
    shaken(builder.threads(1).build()?, speed)
}

/// A body of which every n-th element is left, including the first, or none.
fn excavated(column: &Column, left: usize, damping: Rayleigh) -> Result<Model, Refusal> {
    let mesh = irregular(column)?;
    let goes = |&element: &u32| left == 0 || !(element as usize).is_multiple_of(left);
    let gone: Vec<u32> = (0..mesh.element_count() as u32).filter(goes).collect();
    let mut state = State::at_rest(mesh.node_count());
    state.remove(&gone);
    let factory = column.factory(&elastic(media::ROCK), damping);
    let builder = Model::builder(&mesh).elements(SET, factory).start(state);
    shaken(builder.threads(1).build()?, 1.0)
}
