//! Springs and dashpots of a face.

use powerhouse_model::{BoundarySite, ElasticMedium, Mat3, NodalImpedance, SiteFace, Vec3};

/// Springs and dashpots per area of a face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceCoefficients {
    /// Spring along the normal (N/m3).
    pub normal_spring: f64,
    /// Spring along any tangent (N/m3).
    pub tangential_spring: f64,
    /// Dashpot along the normal (N s/m3).
    pub normal_dashpot: f64,
    /// Dashpot along any tangent (N s/m3).
    pub tangential_dashpot: f64,
}

impl FaceCoefficients {
    /// Dashpots with the impedance of each wave, no springs:
    /// `C_N = rho cp`, `C_T = rho cs`.
    ///
    /// Source: Lysmer & Kuhlemeyer (1969).
    pub fn viscous(medium: &ElasticMedium) -> Self {
        Self {
            normal_spring: 0.0,
            tangential_spring: 0.0,
            normal_dashpot: medium.density * medium.p_speed(),
            tangential_dashpot: medium.density * medium.s_speed(),
        }
    }

    /// Springs and dashpots at a distance `r` (m) from the scatterer:
    ///
    /// `K_N = (lambda + 2 G) / ((1 + A) r)`, `K_T = G / ((1 + A) r)`,
    /// `C_N = B rho cp`, `C_T = B rho cs`.
    ///
    /// Source: Wang, Chen & Xiao (2019), Eqs. 1 and 2, with `amplitude_ratio` A (their alpha)
    /// and `speed_ratio` B (their beta).
    pub fn viscous_spring(
        medium: &ElasticMedium,
        amplitude_ratio: f64,
        speed_ratio: f64,
        distance: f64,
    ) -> Self {
        let dashpots = Self::viscous(medium);
        let share = 1.0 / ((1.0 + amplitude_ratio) * distance);
        Self {
            normal_spring: share * medium.constrained(),
            tangential_spring: share * medium.shear(),
            normal_dashpot: speed_ratio * dashpots.normal_dashpot,
            tangential_dashpot: speed_ratio * dashpots.tangential_dashpot,
        }
    }

    /// The same with the springs multiplied.
    #[must_use]
    pub fn with_springs_scaled(mut self, factor: f64) -> Self {
        self.normal_spring *= factor;
        self.tangential_spring *= factor;
        self
    }
}

/// `area (normal n n^T + tangential (I - n n^T))`
fn about_normal(normal: &Vec3, area: f64, along: f64, across: f64) -> Mat3 {
    let projector = normal * normal.transpose();
    area * (along * projector + across * (Mat3::identity() - projector))
}

/// The normal without the components that rounding left in it.
///
/// Faces along the axes have to give exactly diagonal matrices: coordinates with an error in the
/// last digit would otherwise put every node on the slow path. What is dropped changes the
/// normal by less than 1e-9.
fn without_rounding(normal: &Vec3) -> Vec3 {
    normal
        .map(|component| {
            if component.abs() < 1.0e-9 {
                0.0
            } else {
                component
            }
        })
        .normalize()
}

/// What a face's share adds to the impedance of its node: spring (N/m) and dashpot (N s/m).
pub(crate) fn share_impedance(share: &SiteFace, coefficients: &FaceCoefficients) -> (Mat3, Mat3) {
    let normal = without_rounding(&share.normal);
    (
        about_normal(
            &normal,
            share.area,
            coefficients.normal_spring,
            coefficients.tangential_spring,
        ),
        about_normal(
            &normal,
            share.area,
            coefficients.normal_dashpot,
            coefficients.tangential_dashpot,
        ),
    )
}

/// The coefficients of every share, in the order of the site's nodes and their faces.
pub(crate) type ShareCoefficients = Vec<Vec<FaceCoefficients>>;

/// The impedance of every node: the sum over its shares.
pub(crate) fn nodal_impedance(
    site: &BoundarySite,
    coefficients: &ShareCoefficients,
) -> Vec<NodalImpedance> {
    let of_node = site.nodes.iter().zip(coefficients);
    of_node
        .map(|(node, coefficients)| {
            let (mut spring, mut dashpot) = (Mat3::zeros(), Mat3::zeros());
            for (share, coefficients) in node.faces.iter().zip(coefficients) {
                let (share_spring, share_dashpot) = share_impedance(share, coefficients);
                spring += share_spring;
                dashpot += share_dashpot;
            }
            NodalImpedance::new(node.node, spring, dashpot)
        })
        .collect()
}
