//! Spring and dashpot coefficients of boundary faces, and the nodal impedance that they add up to.

use powerhouse_model::{BoundarySite, ElasticMedium, Mat3, NodalImpedance, SiteFace, Vec3};

/// Spring and dashpot coefficients of a boundary face per unit area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceCoefficients {
    /// Stiffness of the normal spring per area (N/m3).
    pub normal_spring: f64,
    /// Stiffness of the spring along any tangent per area (N/m3).
    pub tangential_spring: f64,
    /// Coefficient of the normal dashpot per area (N s/m3).
    pub normal_dashpot: f64,
    /// Coefficient of the dashpot along any tangent per area (N s/m3).
    pub tangential_dashpot: f64,
}

impl FaceCoefficients {
    /// Coefficients of a viscous boundary: dashpots with the impedance of P and S waves, no springs,
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

    /// Coefficients of a viscous-spring boundary at a distance `r` (m) from the scatterer:
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

    /// These coefficients with both springs multiplied by `factor`; the dashpots are unchanged.
    #[must_use]
    pub fn with_springs_scaled(mut self, factor: f64) -> Self {
        self.normal_spring *= factor;
        self.tangential_spring *= factor;
        self
    }
}

/// Matrix that is isotropic about a normal: `area (normal n n^T + tangential (I - n n^T))`.
fn about_normal(normal: &Vec3, area: f64, along: f64, across: f64) -> Mat3 {
    let projector = normal * normal.transpose();
    area * (along * projector + across * (Mat3::identity() - projector))
}

/// Unit normal without components below 1e-9, which are rounding errors of the coordinates.
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

/// Contribution of a face's share to the impedance of its node: spring (N/m) and dashpot (N s/m).
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

/// Coefficients of every share of a face, in the order of the site's nodes and their faces.
pub(crate) type ShareCoefficients = Vec<Vec<FaceCoefficients>>;

/// Spring and dashpot matrices of every node: the sums over its shares of faces.
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
