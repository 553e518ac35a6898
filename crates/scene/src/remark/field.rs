//! Remarks about the free field at supports, periodic pairs and surfaces of the body.

use powerhouse_model::Vec3;

/// The way out for slices along y, of a body whose ends are not delayed already.
fn delayed(has_delayed_ends: bool) -> &'static str {
    if has_delayed_ends {
        ""
    } else {
        "; both sides of a slice of a long structure along y may be `[[support]] kind = \"delayed\"`, under waves of any azimuth"
    }
}

remark! {
    /// Warning: supports restrain nodes in a direction in which the free field moves with more than 1 % of its largest
    /// velocity during the run, and reflect waves.
    pub struct RestrainedField {
        /// Largest velocity of the field along restrained directions over its largest velocity (1).
        pub share: f64,
        /// Number of the node with this velocity in the mesh file.
        pub node: u64,
        /// Whether the body has delayed ends.
        pub has_delayed_ends: bool,
    }
    Warning(Input),
    "the supports restrain node {node} in a direction in which the free field moves with {:.1} % of its largest velocity: they reflect the incident waves{}",
    100.0 * share,
    delayed(*has_delayed_ends)
}

remark! {
    /// Supports on a plane about which the free field is not symmetric: its traction there, in the directions that they
    /// leave free, acts on no element of the model.
    pub struct AsymmetricField {
        /// Largest such traction of the free field over the wave stress: impedance of S waves times largest velocity.
        pub share: f64,
        /// Number of the node with this traction in the mesh file.
        pub node: u64,
        /// Least apparent speed of the plane waves along the normal of the plane (m/s); none for other fields, and
        /// for waves that travel along the plane.
        pub speed: Option<f64>,
        /// Whether the body has delayed ends.
        pub has_delayed_ends: bool,
    }
    Warning(Input),
    "on the side of node {node} the free field has a traction of {:.1} % of the wave stress (impedance of S waves times largest velocity) in directions that the supports leave free: rollers make that side a plane of symmetry, which the field does not have{}; let the waves travel along that side (`azimuth`), or make it absorbing{}",
    100.0 * share,
    travels(*speed, "through that side"),
    delayed(*has_delayed_ends)
}

remark! {
    /// Periodic pairs whose two nodes move differently in the free field.
    pub struct PeriodicField {
        /// Largest difference of the velocities of the free field over its largest velocity.
        pub share: f64,
        /// Largest strain of the free field along a pair (difference of displacements over distance) over the wave
        /// strain: largest velocity over speed of S waves.
        pub strain: f64,
        /// Numbers of the nodes of the pair with the largest difference in the mesh file.
        pub nodes: [u64; 2],
        /// Distance of these nodes (m).
        pub distance: f64,
        /// Least apparent speed of the plane waves along the pair (m/s); none for other fields, and for waves that
        /// travel across the pair.
        pub speed: Option<f64>,
        /// Whether the body has delayed ends.
        pub has_delayed_ends: bool,
    }
    Warning(Input),
    "the free field moves the periodic pair of nodes {} and {}, {distance:.3} m apart, differently, by {:.1} % of its largest velocity, and strains it by {:.1} % of the wave strain (largest velocity over speed of S waves), but periodic pairs move as one{}; let the waves travel across the pairs (`azimuth`), or make both sides absorbing{}",
    nodes[0],
    nodes[1],
    100.0 * share,
    100.0 * strain,
    travels(*speed, "along the pair"),
    delayed(*has_delayed_ends)
}

remark! {
    /// Warning: an absorbing face has a facet on or above the free surface of the half-space, where waves should be
    /// reflected.
    pub struct AbsorbingSurface {
        /// Facet set of the face.
        pub face: String,
    }
    Warning(Input),
    "the absorbing face '{face}' lies on the free surface of the half-space: scattered waves leave through it instead of being reflected"
}

remark! {
    /// Warning: the free field has traction on a free surface of the mesh beside the absorbing faces, because its own
    /// free surface lies elsewhere or does not exist.
    pub struct LoadedSurface {
        /// Largest traction of the field there over the product of shear impedance and peak velocity (1), above 0.01.
        pub share: f64,
        /// Position of the point with the largest traction (m).
        pub position: Vec3,
    }
    Warning(Run),
    "the free surface at ({:.3}, {:.3}, {:.3}) m has a free-field traction of {:.1} % of the wave stress: the free surface of the field lies elsewhere, or it has none",
    position.x,
    position.y,
    position.z,
    100.0 * share
}

remark! {
    /// Fact: the surface of the body is not flat, while the free field is that of flat ground, as it is at the absorbing faces.
    pub struct Relief {
        /// Height z of the surface of the flat ground (m).
        pub surface: f64,
        /// Lowest height z of the surface of the body (m).
        pub lowest: f64,
        /// Greatest height z of the surface of the body (m).
        pub highest: f64,
    }
    Fact(Run),
    "the surface of the body lies between z = {lowest:.3} and {highest:.3} m, and that of the ground around it at {surface:.3} m: the waves that come in are those of flat ground, and what the relief scatters leaves through the absorbing faces"
}

/// Apparent speed (m/s) with which a wave travels, in words, if it is known.
fn travels(speed: Option<f64>, way: &str) -> String {
    let words =
        |speed| format!(", and a wave travels {way} with an apparent speed of {speed:.0} m/s");
    speed.map_or_else(String::new, words)
}
