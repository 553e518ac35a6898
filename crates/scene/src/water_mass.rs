//! Added mass of water beside a scene's body.

use core::fmt;
use std::collections::{BTreeMap, BTreeSet, HashSet};

use powerhouse_elements::{FaceMass, WaterMass};
use powerhouse_model::{EngineError, Facet};
use thiserror::Error;

use crate::remark::{Kind, described};
use crate::stage::surface_of;
use crate::{Scene, Topic};

/// Speed of sound in water (m/s), of a bulk modulus of 2.2 GPa and 1000 kg/m3.
const SOUND: f64 = 1483.0;
/// Angle from the vertical (degrees) from which facets lean too much for the formula of a vertical wall.
const LEANING: f64 = 30.0;

/// Water beside a facet set, whose mass moves with the body in the dynamic run, normal to the facets.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct WaterBeside {
    /// Facet set.
    pub set: String,
    /// Mass per area.
    pub water: WaterMass,
}

impl WaterBeside {
    /// Water beside a facet set of the mesh.
    pub fn new(set: impl Into<String>, water: WaterMass) -> Self {
        Self {
            set: set.into(),
            water,
        }
    }
}

/// Error of an added mass of water.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum WaterError {
    /// Facets or parameters for which the mass is not defined.
    #[error("added mass of the facet set '{set}': {source}")]
    Facets {
        /// The facet set.
        set: String,
        /// Cause.
        source: EngineError,
    },
    /// Facet set without facets on the surface of the body in the run.
    #[error(
        "none of the {count} facets of '{set}' is on the surface of the body in the run, where water could be beside it"
    )]
    NotOnSurface {
        /// The facet set.
        set: String,
        /// Number of its facets.
        count: usize,
    },
    /// Facet with added mass by two tables.
    #[error("a facet of element {element} has the added mass of both '{first}' and '{second}'")]
    Twice {
        /// Facet set of the first one.
        first: String,
        /// Facet set of the second one.
        second: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
    /// Facet that absorbs waves and has added mass: the free field, which enters there, has no water.
    #[error(
        "the facet set '{set}' with added mass and the absorbing face '{face}' both contain a facet of element {element}"
    )]
    Absorbing {
        /// Facet set of the added mass.
        set: String,
        /// Absorbing face.
        face: String,
        /// Number of the element in the mesh file.
        element: u64,
    },
}

impl WaterError {
    /// The facet set that it concerns, the second one of two.
    pub fn set(&self) -> &str {
        match self {
            Self::Facets { set, .. }
            | Self::NotOnSurface { set, .. }
            | Self::Absorbing { set, .. } => set,
            Self::Twice { second, .. } => second,
        }
    }
}

/// What water adds to the mass of a body.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct AddedWater {
    /// Facet set.
    pub set: String,
    /// Formula of the mass.
    pub kind: &'static str,
    /// Area of the facets below the level (m2).
    pub area: f64,
    /// Integral of the mass per area (kg).
    pub mass: f64,
    /// Mass of a motion of all facets along x, y and z (kg).
    pub along: [f64; 3],
    /// Number of facets of the set that are not on the surface of the body in the run, and have none.
    pub left_out: usize,
    /// Element sets of the parts beside the water, with their masses in the run (kg).
    pub parts: Vec<(String, f64)>,
    /// For Westergaard's formula, the greatest angle of a facet from the vertical (degrees), and the lowest frequency of
    /// sound in the basin (Hz).
    pub limits: Option<[f64; 2]>,
}

impl AddedWater {
    /// Whether the facets lean so much that the formula, that of a vertical wall, does not hold.
    pub fn is_warning(&self) -> bool {
        self.limits.is_some_and(|[lean, _]| lean > LEANING)
    }
}

described!(AddedWater, |water| Kind::warning_if(
    water.is_warning(),
    Topic::Run
));

impl fmt::Display for AddedWater {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.along;
        write!(
            f,
            "added mass of water beside '{}' ({}): {:.4e} kg on {:.4e} m2, normal to the facets (a motion along x has {x:.3e} kg of it, y {y:.3e}, z {z:.3e}), in the run alone and without weight; the part beside it has ",
            self.set, self.kind, self.mass, self.area
        )?;
        for (index, (part, mass)) in self.parts.iter().enumerate() {
            let and = if index > 0 { ", " } else { "" };
            write!(f, "{and}{mass:.4e} kg ('{part}')")?;
        }
        if self.left_out > 0 {
            write!(
                f,
                "; {} facets of the set are not on the surface of the body in the run, and have none",
                self.left_out
            )?;
        }
        if let Some([lean, sound]) = self.limits {
            write!(
                f,
                "; the water is not compressed, as is right well below {sound:.1} Hz"
            )?;
            if lean > 1.0 {
                write!(
                    f,
                    "; facets lean up to {lean:.0} degrees, and the formula is that of a vertical wall"
                )?;
            }
        }
        Ok(())
    }
}

impl Scene {
    /// Adds water beside a facet set, whose mass moves with the body in the dynamic run.
    #[must_use]
    pub fn water_beside(mut self, water: WaterBeside) -> Self {
        self.waters.push(water);
        self
    }

    /// Added masses of the water, of the elements that are present in the run, and what they amount to.
    pub(crate) fn added_masses(
        &self,
        present: Option<&[bool]>,
    ) -> Result<Vec<(FaceMass, AddedWater)>, crate::Error> {
        if self.waters.is_empty() {
            return Ok(Vec::new());
        }
        let all = vec![true; self.mesh.element_count()];
        let present = present.unwrap_or(&all);
        let mut owner: BTreeMap<Facet, &str> = BTreeMap::new();
        let mut found = Vec::with_capacity(self.waters.len());
        for WaterBeside { set, water } in &self.waters {
            let of_set = self.mesh.facet_set(set)?;
            if of_set.is_empty() {
                // Such as of a part of the mesh that was cut off.
                continue;
            }
            let facets = surface_of(&self.mesh, present, of_set);
            if facets.is_empty() {
                let (set, count) = (set.clone(), of_set.len());
                return Err(WaterError::NotOnSurface { set, count }.into());
            }
            for &facet in &facets {
                if let Some(first) = owner.insert(facet, set) {
                    let (first, second) = (first.to_owned(), set.clone());
                    let element = self.mesh.element_tags()[facet.element as usize];
                    let twice = WaterError::Twice {
                        first,
                        second,
                        element,
                    };
                    return Err(twice.into());
                }
            }
            self.check_not_absorbing(set, &facets)?;
            let mass = FaceMass::new(&self.mesh, &facets, water).map_err(|source| {
                let set = set.clone();
                WaterError::Facets { set, source }
            })?;
            let given: HashSet<Vec<u32>> = of_set.iter().map(|&facet| self.key(facet)).collect();
            let report = AddedWater {
                set: set.clone(),
                kind: match water {
                    WaterMass::Westergaard { .. } => "Westergaard",
                    WaterMass::Conduit { .. } => "conduit",
                    _ => "table",
                },
                area: mass.area(),
                mass: mass.total(),
                along: mass.along_axes(),
                left_out: given.len() - facets.len(),
                parts: self.masses_of_parts(&facets, present)?,
                limits: match water {
                    WaterMass::Westergaard { depth, .. } => {
                        let lean = facets.iter().map(|&facet| self.lean(facet));
                        Some([lean.fold(0.0, f64::max), SOUND / (4.0 * depth)])
                    }
                    _ => None,
                },
            };
            found.push((mass, report));
        }
        Ok(found)
    }

    /// Nodes of a facet in rising order, the same from both of its sides.
    fn key(&self, facet: Facet) -> Vec<u32> {
        let mut nodes = self.mesh.facet_nodes(facet);
        nodes.sort_unstable();
        nodes
    }

    /// Angle of a facet from the vertical (degrees).
    fn lean(&self, facet: Facet) -> f64 {
        let normal = self.mesh.facet_geometry(facet).normal();
        normal.z.abs().min(1.0).asin().to_degrees()
    }

    fn check_not_absorbing(&self, set: &str, facets: &[Facet]) -> Result<(), crate::Error> {
        if self.boundary.is_none() {
            return Ok(());
        }
        let own: BTreeSet<Facet> = facets.iter().copied().collect();
        for (face, absorbing) in self.absorbing_facets()? {
            if let Some(facet) = absorbing.iter().find(|facet| own.contains(facet)) {
                let element = self.mesh.element_tags()[facet.element as usize];
                let (set, face) = (set.to_owned(), face.to_owned());
                let absorbing = WaterError::Absorbing { set, face, element };
                return Err(absorbing.into());
            }
        }
        Ok(())
    }

    /// Element sets and masses (kg) of the parts to which the elements of some facets belong, of the elements that are
    /// present.
    fn masses_of_parts(
        &self,
        facets: &[Facet],
        present: &[bool],
    ) -> Result<Vec<(String, f64)>, crate::Error> {
        let beside: BTreeSet<u32> = facets.iter().map(|facet| facet.element).collect();
        let mut masses = Vec::new();
        for part in &self.parts {
            let elements = self.mesh.element_set(&part.set)?.iter().copied();
            let elements: Vec<u32> = elements.filter(|&e| present[e as usize]).collect();
            if elements.iter().any(|element| beside.contains(element)) {
                let density = part.material.medium().density;
                let mass = density * self.mesh.volume_of(&elements);
                masses.push((part.set.clone(), mass));
            }
        }
        Ok(masses)
    }
}
