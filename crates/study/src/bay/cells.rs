//! How finely a bay is cut.

use serde::Deserialize;

/// Sizes of the mesh of a bay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BaySize {
    /// About 16,000 hexahedra: linings of one element.
    #[default]
    Coarse,
    /// About 50,000: linings of two elements, floors of one.
    Medium,
    /// About 130,000, as many as Wang, Chen & Xiao (2019) have: linings and floors of two.
    Paper,
}

impl BaySize {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Coarse, Self::Medium, Self::Paper];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coarse => "coarse",
            Self::Medium => "medium",
            Self::Paper => "paper",
        }
    }

    /// Its numbers of elements.
    pub fn cells(self) -> BayCells {
        match self {
            Self::Coarse => BayCells {
                lining: 1,
                floor: 1,
                ring: [1, 1, 1],
                ring_to_wall: 2,
                ring_to_end: 1,
                transformer: 6,
                pillar: 7,
                side: 9,
                above: 18,
                below: 9,
                storeys: [6, 2, 2, 2],
                longest: 12.0,
                first_beside: 4.0,
                first_above: 3.0,
                first_below: 3.0,
            },
            Self::Medium => BayCells {
                lining: 2,
                floor: 1,
                ring: [2, 1, 1],
                ring_to_wall: 3,
                ring_to_end: 1,
                transformer: 8,
                pillar: 12,
                side: 15,
                above: 30,
                below: 17,
                storeys: [8, 3, 2, 3],
                longest: 7.0,
                first_beside: 2.0,
                first_above: 2.0,
                first_below: 2.0,
            },
            Self::Paper => BayCells {
                lining: 2,
                floor: 2,
                ring: [2, 2, 1],
                ring_to_wall: 4,
                ring_to_end: 2,
                transformer: 12,
                pillar: 16,
                side: 19,
                above: 46,
                below: 24,
                storeys: [10, 4, 3, 4],
                longest: 4.38,
                first_beside: 1.5,
                first_above: 1.3,
                first_below: 1.4,
            },
        }
    }
}

/// Numbers of elements of a bay. Far from the caverns there are more where the rock reaches farther
/// than they can at their longest spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BayCells {
    /// Through the thickness of the linings.
    pub lining: usize,
    /// Through the thickness of the floors.
    pub floor: usize,
    /// From the axis through the pit, the pier and the windshield.
    pub ring: [usize; 3],
    /// From the windshield to the wall of the main powerhouse.
    pub ring_to_wall: usize,
    /// From the windshield to the end of the bay.
    pub ring_to_end: usize,
    /// Across the transformer cavern between its walls, an even number.
    pub transformer: usize,
    /// Across the pillar.
    pub pillar: usize,
    /// From the outermost walls to the sides.
    pub side: usize,
    /// From the crowns to the surface.
    pub above: usize,
    /// Below the main powerhouse.
    pub below: usize,
    /// Between arch, generator, busbar and turbine floor and base slab.
    pub storeys: [usize; 4],
    /// Longest spacing of the grid in rock (m); where its lines lean edges are longer.
    pub longest: f64,
    /// First spacing beside the caverns (m).
    pub first_beside: f64,
    /// First spacing above them (m).
    pub first_above: f64,
    /// First spacing below the main powerhouse (m).
    pub first_below: f64,
}
