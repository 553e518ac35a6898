//! Spring and dashpot coefficients of boundary faces, and the nodal impedance that they add up to.

use powerhouse_model::{BoundarySite, ElasticMedium, Mat3, NodalImpedance, SiteFace, Vec3};

use crate::BoundaryError;

/// Spring and dashpot coefficients of a boundary face per unit area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceCoefficients {
    /// Stiffness of the normal spring per area (N/m3).
    pub normal_spring: f64,
    /// Stiffness of the spring along any tangent per area (N/m3).
    pub tangential_spring: f64,
    /// Coefficient of the normal dashpot per area (N s/m3).
    pub normal_dashpot: f64,
    /// Coefficient of the dashpot along any tangent per area (N s/m3); in a delayed slice, of the tangent across y.
    pub tangential_dashpot: f64,
    /// Coefficient of the dashpot along y per area (N s/m3) of a face parallel to y, which differs from the tangential one in
    /// a delayed slice alone.
    pub axial_dashpot: f64,
    /// Gyroscopic coefficient g per area (N s/m3) of a face parallel to y in a delayed slice, zero everywhere else: the
    /// tractions `-g v_y` along the normal and `g v_n` along y.
    pub coupling: f64,
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
            axial_dashpot: medium.density * medium.s_speed(),
            coupling: 0.0,
        }
    }

    /// Coefficients of a viscous boundary for waves that leave a delayed slice along the normal of a face parallel to y,
    /// with the slowness `s` (s/m) along y that all its motion has. With the slownesses along the normal
    /// `xi = sqrt(1/cp^2 - s^2)` of P waves and `eta = sqrt(1/cs^2 - s^2)` of S waves, and `D = xi eta + s^2`:
    ///
    /// `C_N = rho eta / D`, `C_T = G eta`, `C_Y = rho xi / D`, `g = s (rho - 2 G D) / D`.
    ///
    /// They follow from the tractions of the P and the two S waves of these slownesses, and are those of
    /// [`viscous`](Self::viscous) where `s` is zero. Past `s = 1/cp` no P wave leaves and the numbers are not finite.
    pub fn matched(medium: &ElasticMedium, slowness: f64) -> Self {
        let along = |speed: f64| (1.0 / (speed * speed) - slowness * slowness).sqrt();
        let (xi, eta) = (along(medium.p_speed()), along(medium.s_speed()));
        let sum = xi * eta + slowness * slowness;
        let (density, shear) = (medium.density, medium.shear());
        Self {
            normal_spring: 0.0,
            tangential_spring: 0.0,
            normal_dashpot: density * eta / sum,
            tangential_dashpot: shear * eta,
            axial_dashpot: density * xi / sum,
            coupling: slowness * (density - 2.0 * shear * sum) / sum,
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
            axial_dashpot: speed_ratio * dashpots.axial_dashpot,
            coupling: 0.0,
        }
    }

    /// These coefficients with the dashpots [matched](Self::matched) to a slowness along y (s/m), times a factor
    /// (`speed_ratio`); the springs are unchanged. Where the slowness is zero so are the dashpots.
    #[must_use]
    pub fn with_dashpots_matched(
        mut self,
        medium: &ElasticMedium,
        slowness: f64,
        speed_ratio: f64,
    ) -> Self {
        if slowness != 0.0 {
            let matched = Self::matched(medium, slowness);
            self.normal_dashpot = speed_ratio * matched.normal_dashpot;
            self.tangential_dashpot = speed_ratio * matched.tangential_dashpot;
            self.axial_dashpot = speed_ratio * matched.axial_dashpot;
            self.coupling = speed_ratio * matched.coupling;
        }
        self
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

/// Contribution of a face's share to the impedance of its node: spring (N/m), dashpot and gyroscopic matrix (N s/m).
pub(crate) fn share_impedance(share: &SiteFace, coefficients: &FaceCoefficients) -> [Mat3; 3] {
    let normal = without_rounding(&share.normal);
    let spring = about_normal(
        &normal,
        share.area,
        coefficients.normal_spring,
        coefficients.tangential_spring,
    );
    let mut dashpot = about_normal(
        &normal,
        share.area,
        coefficients.normal_dashpot,
        coefficients.tangential_dashpot,
    );
    let axial = coefficients.axial_dashpot - coefficients.tangential_dashpot;
    if axial == 0.0 && coefficients.coupling == 0.0 {
        return [spring, dashpot, Mat3::zeros()];
    }
    let along = Vec3::y();
    dashpot += along * along.transpose() * (share.area * axial);
    let across = normal * along.transpose() - along * normal.transpose();
    let gyroscopic = across * (share.area * coefficients.coupling);
    [spring, dashpot, gyroscopic]
}

/// Coefficients of every share of a face, in the order of the site's nodes and their faces.
pub(crate) type ShareCoefficients = Vec<Vec<FaceCoefficients>>;

/// Refuses faces that are not parallel to y in a delayed slice, and ground in which its motion is no wave.
pub(crate) fn check_delayed(site: &BoundarySite) -> Result<(), BoundaryError> {
    if site.slowness == 0.0 {
        return Ok(());
    }
    for share in site.nodes.iter().flat_map(|node| &node.faces) {
        if share.normal.y.abs() > ALONG_AXIS {
            return Err(BoundaryError::FaceAcrossAxis {
                face: site.faces[share.face].clone(),
            });
        }
        let ratio = site.slowness.abs() * share.medium.p_speed();
        if ratio.is_nan() || ratio >= 1.0 {
            return Err(BoundaryError::PastCritical {
                face: site.faces[share.face].clone(),
                slowness: site.slowness,
                largest: 1.0 / share.medium.p_speed(),
            });
        }
    }
    Ok(())
}

/// Component along y of a unit normal below which a face is parallel to y; rounded coordinates bend a face by less.
const ALONG_AXIS: f64 = 1e-6;

/// Spring and dashpot matrices of every node: the sums over its shares of faces.
pub(crate) fn nodal_impedance(
    site: &BoundarySite,
    coefficients: &ShareCoefficients,
) -> Vec<NodalImpedance> {
    let of_node = site.nodes.iter().zip(coefficients);
    of_node
        .map(|(node, coefficients)| {
            let mut sums = [Mat3::zeros(); 3];
            for (share, coefficients) in node.faces.iter().zip(coefficients) {
                let of_share = share_impedance(share, coefficients);
                for (sum, matrix) in sums.iter_mut().zip(of_share) {
                    *sum += matrix;
                }
            }
            let [spring, dashpot, gyroscopic] = sums;
            NodalImpedance::new(node.node, spring, dashpot).with_gyroscopic(gyroscopic)
        })
        .collect()
}
