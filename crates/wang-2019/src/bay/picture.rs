//! Picture of the mesh of a bay.

use std::path::Path;

use powerhouse::io::{IoError, Picture, PictureField, PictureView, SectionPlane, write_picture};
use powerhouse::model::Vec3;

use super::{BayMesh, BayPart};
use crate::BayError;

/// Width of the rock that is drawn around the caverns (m).
const AROUND: f64 = 10.0;

/// Kinds of parts that a picture distinguishes by colour.
const KINDS: [&str; 8] = [
    "rock", "arch", "wall", "base", "mass", "pier", "shield", "floor",
];

/// The index of a part's kind in [`KINDS`].
fn kind(part: BayPart) -> usize {
    match part {
        BayPart::ArchMain | BayPart::ArchTransformer => 1,
        BayPart::WallMain | BayPart::WallTransformer => 2,
        BayPart::BaseMain | BayPart::FloorTransformer => 3,
        BayPart::Mass => 4,
        BayPart::Pier => 5,
        BayPart::Windshield => 6,
        BayPart::FloorGenerator | BayPart::FloorBusbar | BayPart::FloorTurbine => 7,
        BayPart::Rock | BayPart::VoidMain | BayPart::VoidTransformer => 0,
    }
}

impl BayMesh {
    /// Index in [`BayPart::ALL`] of the part of each element, in the order of the elements.
    ///
    /// # Errors
    /// A mesh without the element sets of a bay.
    pub fn part_numbers(&self) -> Result<Vec<f64>, BayError> {
        let mut numbers = vec![0.0; self.mesh.element_count()];
        for (number, part) in BayPart::ALL.into_iter().enumerate() {
            for &element in self.mesh.element_set(part.name())? {
                numbers[element as usize] = number as f64;
            }
        }
        Ok(numbers)
    }

    /// Draws a section through the caverns and the rock around them at mid-bay into a PNG file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn draw(&self, file: &Path) -> Result<(), BayError> {
        let numbers = self.part_numbers()?;
        let structure = self
            .mesh
            .nodes_of_elements(self.mesh.element_set("structure")?);
        let infinite = Vec3::repeat(f64::INFINITY);
        let (low, high) = structure
            .iter()
            .fold((infinite, -infinite), |(low, high), &node| {
                let position = self.mesh.positions()[node as usize];
                (low.inf(&position), high.sup(&position))
            });
        let around = Vec3::new(AROUND, 0.0, AROUND);
        let near = self.mesh.elements_in_box(&(low - around), &(high + around));
        let is_there = |element: &u32| {
            let part = BayPart::ALL[numbers[*element as usize] as usize];
            part == BayPart::Rock || part.is_concrete()
        };
        let mut shown = vec![false; self.mesh.element_count()];
        for element in near.into_iter().filter(is_there) {
            shown[element as usize] = true;
        }
        let kind = |number: &f64| kind(BayPart::ALL[*number as usize]) as f64;
        let values: Vec<f64> = numbers.iter().map(kind).collect();
        let mut picture = Picture::new(&self.mesh, PictureField::Elemental(&values), "part");
        picture.present = Some(&shown);
        picture.title = "machine bay, section at its middle".into();
        picture.names = &KINDS;
        picture.view = PictureView::along(Vec3::y());
        picture.section = Some(SectionPlane {
            point: (low + high) / 2.0,
            normal: -Vec3::y(),
        });
        picture.width = 1600;
        write_picture(file, &picture).map_err(|error: IoError| powerhouse::Error::from(error))?;
        Ok(())
    }
}
