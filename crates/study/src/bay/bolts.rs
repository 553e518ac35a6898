//! The pattern of rock bolts of a bay.

/// Rock bolts in rows across a cavern, normal to the rock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BayBolts {
    /// The facet set in which their heads stand.
    pub facets: &'static str,
    /// Diameter (m).
    pub diameter: f64,
    /// Length (m).
    pub length: f64,
    /// Distance around the opening (m); along it there are [`BAY_BOLT_ROWS`] rows in a bay.
    pub spacing: f64,
}

/// Rows of bolts in a bay; none stands on its ends.
pub const BAY_BOLT_ROWS: usize = 9;

/// The pattern, assumed: one bolt for 1.5 m by 1.5 m as in many caverns, as long as the rules of thumb
/// for roofs, 2 m + 0.15 of the width, and walls, 2 m + 0.15 of the height, ask for.
pub const BAY_BOLTS: [BayBolts; 4] = [
    BayBolts {
        facets: "roof_main",
        diameter: 0.028,
        length: 6.0,
        spacing: 1.5,
    },
    BayBolts {
        facets: "walls_main",
        diameter: 0.032,
        length: 8.0,
        spacing: 1.5,
    },
    BayBolts {
        facets: "roof_transformer",
        diameter: 0.028,
        length: 5.0,
        spacing: 1.5,
    },
    BayBolts {
        facets: "walls_transformer",
        diameter: 0.028,
        length: 6.0,
        spacing: 1.5,
    },
];
