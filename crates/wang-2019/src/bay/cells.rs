//! Mesh density of a machine bay.

use serde::Deserialize;

/// Predefined mesh density of a machine bay.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum BaySize {
    /// About 16,000 hexahedra: one element through linings and floors.
    #[default]
    Coarse,
    /// About 50,000 hexahedra: two elements through linings, one through floors.
    Medium,
    /// About 130,000 hexahedra, as many as in Wang, Chen & Xiao (2019): two elements through linings and floors.
    Paper,
}

impl BaySize {
    /// All mesh densities, coarse to fine.
    pub const ALL: [Self; 3] = [Self::Coarse, Self::Medium, Self::Paper];

    /// Name of the mesh density in bay files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coarse => "coarse",
            Self::Medium => "medium",
            Self::Paper => "paper",
        }
    }

    /// Numbers of elements and spacings of this mesh density.
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

/// Numbers of elements and grid spacings of a machine bay.
///
/// Far from the caverns elements are added where the given number at the longest spacing would not fill the rock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BayCells {
    /// Number of elements through the thickness of the linings.
    pub lining: usize,
    /// Number of elements through the thickness of the floors.
    pub floor: usize,
    /// Numbers of elements along the radius through the pit, the pier and the windshield.
    pub ring: [usize; 3],
    /// Number of elements from the windshield to the wall of the main powerhouse.
    pub ring_to_wall: usize,
    /// Number of elements from the windshield to the end of the bay.
    pub ring_to_end: usize,
    /// Number of elements across the transformer cavern between its walls; even.
    pub transformer: usize,
    /// Number of elements across the rock pillar between the caverns.
    pub pillar: usize,
    /// Number of elements from the outermost walls to the sides of the block.
    pub side: usize,
    /// Number of elements from the crowns to the ground surface.
    pub above: usize,
    /// Number of elements below the main powerhouse.
    pub below: usize,
    /// Numbers of elements in height between arch and generator floor, generator and busbar floor, busbar and turbine
    /// floor, and turbine floor and base slab.
    pub storeys: [usize; 4],
    /// Longest spacing of the grid in rock (m); edges along inclined grid lines are longer.
    pub longest: f64,
    /// Spacing of the first element beside the caverns (m).
    pub first_beside: f64,
    /// Spacing of the first element above the caverns (m).
    pub first_above: f64,
    /// Spacing of the first element below the main powerhouse (m).
    pub first_below: f64,
}
