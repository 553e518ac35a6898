//! Viscous-spring boundary: springs and dashpots.

#[cfg(feature = "keys")]
use powerhouse_model::keys::*;
use powerhouse_model::{
    AbsorbingBoundary, BoundaryParts, BoundarySite, ModelError, ParameterError, SiteFace, SiteNode,
    Vec3,
};

use crate::BoundaryError;
use crate::coefficients::{FaceCoefficients, ShareCoefficients, check_delayed, nodal_impedance};
use crate::input::{InputMode, input_loads};

/// Viscous-spring parameters of the faces whose normal is nearest to one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisParameters {
    /// A: amplitude ratio of plane to scattered waves (1), from 0 to 100.
    pub amplitude_ratio: f64,
    /// B: ratio of physical to apparent wave speed (1), from 0.1 to 10.
    pub speed_ratio: f64,
    /// Distance from the scatterer to the faces (m), 1e-3 to 1e7; without one it is taken from the
    /// geometry, node by node.
    pub distance: Option<f64>,
}

impl AxisParameters {
    /// A = 0.8, B = 1.1, as Wang, Chen & Xiao (2019) advise; the distance from the geometry. Such
    /// dashpots reflect 4.8 % of the amplitude at normal incidence.
    pub const PAPER: Self = Self {
        amplitude_ratio: 0.8,
        speed_ratio: 1.1,
        distance: None,
    };

    /// Parameters from A, B and a distance (m), each checked against its range.
    ///
    /// # Errors
    /// [`ParameterError`] names the field, its value and the permitted range.
    pub fn new(
        amplitude_ratio: f64,
        speed_ratio: f64,
        distance: Option<f64>,
    ) -> Result<Self, ParameterError> {
        let parameters = Self {
            amplitude_ratio,
            speed_ratio,
            distance,
        };
        parameters.check()?;
        Ok(parameters)
    }

    fn check(&self) -> Result<(), ParameterError> {
        ParameterError::check("amplitude_ratio", self.amplitude_ratio, 0.0, 100.0)?;
        ParameterError::check("speed_ratio", self.speed_ratio, 0.1, 10.0)?;
        match self.distance {
            Some(distance) => ParameterError::check("distance", distance, 1.0e-3, 1.0e7),
            None => Ok(()),
        }
    }
}

impl Default for AxisParameters {
    /// A = 0.8, B = 1: dashpots with the impedance of plane waves; the distance from the geometry.
    fn default() -> Self {
        Self {
            speed_ratio: 1.0,
            ..Self::PAPER
        }
    }
}

/// Geometrical spreading of the scattered waves, which sets the stiffness of the springs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "keys", derive(Deserialize, JsonSchema))]
#[cfg_attr(feature = "keys", serde(rename_all = "kebab-case"))]
pub enum Spreading {
    /// Spherical waves, from a compact structure: the springs of Eq. 1.
    #[default]
    Spherical,
    /// Cylindrical waves, from a long structure of which the model is a slice: half the spring
    /// stiffness, the same dashpots.
    Cylindrical,
}

/// Viscous-spring boundary: springs and dashpots after Eqs. 1 and 2 of Wang, Chen & Xiao (2019); see
/// [`FaceCoefficients::viscous_spring`].
///
/// The distance r of a face at a node is the distance from the scatterer along the outward
/// normal, or that of the axis nearest to the normal if one is given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViscousSpring {
    /// Parameters of the faces whose normals are nearest to x, y and z, in this order.
    pub axes: [AxisParameters; 3],
    /// Geometrical spreading of the scattered waves.
    pub spreading: Spreading,
    /// Part of the free field that enters through the boundary.
    pub input: InputMode,
}

/// Least distance of a face, relative to the diagonal of the boundary's box.
const LEAST_RELATIVE_DISTANCE: f64 = 1.0e-3;

impl ViscousSpring {
    /// Boundary with the [parameters](AxisParameters::PAPER) that Wang, Chen & Xiao (2019) advise on all faces.
    pub fn paper() -> Self {
        Self {
            axes: [AxisParameters::PAPER; 3],
            ..Self::default()
        }
    }

    fn share_coefficients(
        &self,
        site: &BoundarySite,
        node: &SiteNode,
        share: &SiteFace,
        least: f64,
    ) -> Result<FaceCoefficients, BoundaryError> {
        let axis = &self.axes[share.normal.iamax()];
        let distance = axis
            .distance
            .unwrap_or_else(|| (node.position - site.scatterer).dot(&share.normal));
        if axis.distance.is_none() && (distance.is_nan() || distance < least) {
            return Err(BoundaryError::Distance {
                face: site.faces[share.face].clone(),
                distance,
                least,
            });
        }
        let coefficients = FaceCoefficients::viscous_spring(
            &share.medium,
            axis.amplitude_ratio,
            axis.speed_ratio,
            distance,
        );
        let coefficients =
            coefficients.with_dashpots_matched(&share.medium, site.slowness, axis.speed_ratio);
        Ok(match self.spreading {
            Spreading::Spherical => coefficients,
            Spreading::Cylindrical => coefficients.with_springs_scaled(0.5),
        })
    }
}

/// Diagonal of the box around the boundary's nodes (m).
fn extent(site: &BoundarySite) -> f64 {
    let mut positions = site.nodes.iter().map(|node| node.position);
    let first = positions.next().unwrap_or_else(Vec3::zeros);
    let (low, high) = positions.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
    (high - low).norm()
}

impl AbsorbingBoundary for ViscousSpring {
    fn name(&self) -> &str {
        "viscous-spring"
    }
    fn speed_ratios(&self) -> Option<[f64; 3]> {
        Some(self.axes.map(|axis| axis.speed_ratio))
    }
    fn build(&self, site: &BoundarySite) -> Result<BoundaryParts, ModelError> {
        for axis in &self.axes {
            axis.check()?;
        }
        check_delayed(site)?;
        let least = LEAST_RELATIVE_DISTANCE * extent(site);
        let coefficients = site
            .nodes
            .iter()
            .map(|node| {
                let shares = node.faces.iter();
                shares
                    .map(|share| self.share_coefficients(site, node, share, least))
                    .collect()
            })
            .collect::<Result<ShareCoefficients, BoundaryError>>()?;
        Ok(BoundaryParts::default()
            .with_impedance(nodal_impedance(site, &coefficients))
            .with_loads(input_loads(site, &coefficients, &self.input)?))
    }
}
