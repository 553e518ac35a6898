//! Rock bolt pattern of a machine bay.

/// Pattern of rock bolts normal to one excavated surface of a cavern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BayBolts {
    /// Name of the facet set on which the bolt heads lie.
    pub facets: &'static str,
    /// Bolt diameter (m).
    pub diameter: f64,
    /// Bolt length (m).
    pub length: f64,
    /// Spacing (m) of the bolts of a row around the opening; along the halls there are [`BAY_BOLT_ROWS`] rows in a bay.
    pub spacing: f64,
}

/// Number of bolt rows along a bay; no row lies on the ends of the bay.
pub const BAY_BOLT_ROWS: usize = 9;

/// Assumed bolt patterns of roofs and walls of both caverns.
///
/// One bolt for 1.5 m by 1.5 m, as in many caverns; lengths by the rules of thumb 2 m + 0.15 of the width for roofs
/// and 2 m + 0.15 of the height for walls.
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
