//! Consistency checks of material parameters against each other.

use core::fmt;

use powerhouse_model::ElasticMedium;

use crate::{DruckerPrager, HoekBrown, LeeFenves, MohrCoulomb, TwoSurface, YieldSurface};

/// Relative difference of strengths above which it is reported.
const NOTABLE: f64 = 0.05;
/// Poisson's ratio above which volumetric locking is reported.
const NEARLY_INCOMPRESSIBLE: f64 = 0.49;

/// Inconsistency or unusual value in the parameters of a valid material.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Finding {
    /// The tension cut-off of a [`MohrCoulomb`] surface is beyond the apex and has no effect.
    InactiveCutOff {
        /// Tensile strength as listed (Pa).
        listed: f64,
        /// Mean stress at the apex, `c cot(phi)` (Pa).
        apex: f64,
        /// Uniaxial tensile stress at which the surface yields (Pa).
        in_force: f64,
    },
    /// The surface has another uniaxial tensile strength than the listed one, by more than 5 %; that of [`MohrCoulomb`] a
    /// lower one, though its cut-off is active.
    TensileStrength {
        /// Tensile strength as listed (Pa).
        listed: f64,
        /// Uniaxial tensile stress at which the surface yields (Pa).
        in_force: f64,
    },
    /// The surface has another uniaxial compressive strength than the listed one, by more than 5 %.
    CompressiveStrength {
        /// Compressive strength as listed (Pa).
        listed: f64,
        /// Uniaxial compressive stress at which the surface yields (Pa).
        in_force: f64,
    },
    /// The cohesion of a [`TwoSurface`] is below the least one that is consistent with its compressive strength, which
    /// replaces it.
    Cohesion {
        /// Cohesion as listed (Pa).
        listed: f64,
        /// Cohesion of the surface under confinement (Pa).
        in_force: f64,
    },
    /// Crushing of a [`LeeFenves`] law hardens before its peak: flow over a wide body before localisation dissipates an
    /// energy that depends on the mesh.
    Hardening {
        /// Uniaxial compressive stress at first flow (Pa).
        limit: f64,
        /// Uniaxial compressive strength (Pa).
        strength: f64,
        /// Strains at the strength (1) in elements of widths of 0.1 and 1 m.
        strains: [f64; 2],
    },
    /// Poisson's ratio is above 0.49, so near 0.5 that elements lock and the stable step decreases.
    NearlyIncompressible {
        /// Poisson's ratio (1).
        poisson: f64,
    },
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::InactiveCutOff {
                listed,
                apex,
                in_force,
            } => write!(
                f,
                "the tensile strength of {listed:.4e} Pa is beyond the apex c cot(phi) = \
                 {apex:.4e} Pa and is without effect: uniaxial tension yields at {in_force:.4e} Pa"
            ),
            Self::TensileStrength { listed, in_force } => write!(
                f,
                "uniaxial tension yields at {in_force:.4e} Pa, not at the listed {listed:.4e} Pa"
            ),
            Self::CompressiveStrength { listed, in_force } => write!(
                f,
                "the surface has a uniaxial compressive strength of {in_force:.4e} Pa, not the listed \
                 {listed:.4e} Pa"
            ),
            Self::Cohesion { listed, in_force } => write!(
                f,
                "the compressive strength requires a cohesion of {in_force:.4e} Pa under \
                 confinement, not the listed {listed:.4e} Pa"
            ),
            Self::Hardening {
                limit,
                strength,
                strains: [narrow, wide],
            } => write!(
                f,
                "crushing begins at {limit:.4e} Pa and hardens up to {strength:.4e} Pa: the energy \
                 that it dissipates depends on the mesh, and the strength is at a strain of {:.2} per mille in elements \
                 of 0.1 m, of {:.2} in those of 1 m (concrete: some 2)",
                1e3 * narrow,
                1e3 * wide
            ),
            Self::NearlyIncompressible { poisson } => write!(
                f,
                "Poisson's ratio {poisson} is nearly 0.5: elements lock and the stable step decreases"
            ),
        }
    }
}

impl MohrCoulomb {
    /// Inconsistencies of the parameters, given the uniaxial compressive strength that the material is
    /// listed with (Pa), if there is one.
    ///
    /// ```
    /// use powerhouse_material_damage::{MohrCoulomb, presets};
    ///
    /// let rock = MohrCoulomb::new(presets::PAPER_ROCK)?;
    /// for finding in rock.findings(Some(35.0e6)) {
    ///     println!("{finding}");
    /// }
    /// assert_eq!(rock.findings(Some(35.0e6)).len(), 2);
    /// # Ok::<(), powerhouse_material_damage::MaterialError>(())
    /// ```
    pub fn findings(&self, listed_compression: Option<f64>) -> Vec<Finding> {
        let mut findings = Vec::new();
        let in_force = self.uniaxial_tension();
        if let Some(listed) = self.parameters().tension_strength {
            let apex = self.apex();
            if listed > apex {
                findings.push(Finding::InactiveCutOff {
                    listed,
                    apex,
                    in_force,
                });
            } else if in_force < listed * (1.0 - NOTABLE) {
                findings.push(Finding::TensileStrength { listed, in_force });
            }
        }
        findings.extend(of_compression(self, listed_compression));
        findings.extend(Finding::of_medium(&self.medium()));
        findings
    }
}

impl TwoSurface {
    /// Inconsistencies of the parameters.
    ///
    /// ```
    /// use powerhouse_material_damage::{TwoSurface, presets};
    ///
    /// let concrete = TwoSurface::new(presets::PAPER_CONCRETE_LISTED)?;
    /// println!("{}", concrete.findings()[0]);
    /// # Ok::<(), powerhouse_material_damage::MaterialError>(())
    /// ```
    pub fn findings(&self) -> Vec<Finding> {
        let (listed, in_force) = (self.parameters().cohesion, self.cohesion());
        let differs = listed < in_force * (1.0 - NOTABLE);
        let cohesion = differs.then_some(Finding::Cohesion { listed, in_force });
        let all = cohesion
            .into_iter()
            .chain(Finding::of_medium(&self.medium()));
        all.collect()
    }
}

impl DruckerPrager {
    /// Inconsistencies of the parameters, given the strengths in uniaxial tension and compression that
    /// the material is listed with (Pa), if there are any.
    pub fn findings(&self, listed: [Option<f64>; 2]) -> Vec<Finding> {
        of_strengths(self, listed)
    }
}

impl HoekBrown {
    /// Inconsistencies of the parameters, given the strengths in uniaxial tension and compression that
    /// the rock mass is listed with (Pa), if there are any.
    ///
    /// ```
    /// use powerhouse_material_damage::{HoekBrown, HoekBrownParameters, media};
    ///
    /// let rock = HoekBrown::new(HoekBrownParameters {
    ///     medium: media::ROCK,
    ///     intact_strength: 60.0e6,
    ///     intact_constant: 12.0,
    ///     strength_index: 55.0,
    ///     disturbance: 0.0,
    ///     dilation_share: 0.0,
    /// })?;
    /// // The rock mass has a strength of 4.8 MPa, not that of the intact rock.
    /// println!("{}", rock.findings([None, Some(60.0e6)])[0]);
    /// # Ok::<(), powerhouse_material_damage::MaterialError>(())
    /// ```
    pub fn findings(&self, listed: [Option<f64>; 2]) -> Vec<Finding> {
        of_strengths(self, listed)
    }
}

impl LeeFenves {
    /// Inconsistencies of the parameters.
    pub fn findings(&self) -> Vec<Finding> {
        let (limit, strength) = {
            let p = self.parameters();
            (p.compression_limit, p.compression_strength)
        };
        let hardens = differ(strength, limit);
        let hardening = hardens.then_some(Finding::Hardening {
            limit,
            strength,
            strains: [0.1, 1.0].map(|size| self.strain_at_strength(size)),
        });
        let all = hardening
            .into_iter()
            .chain(Finding::of_medium(&self.parameters().medium));
        all.collect()
    }
}

/// Inconsistencies of a surface with listed strengths in tension and compression (Pa), and of its medium.
fn of_strengths(surface: &impl YieldSurface, listed: [Option<f64>; 2]) -> Vec<Finding> {
    let mut findings = Vec::new();
    let in_force = surface.uniaxial_tension();
    if let Some(listed) = listed[0]
        && differ(listed, in_force)
    {
        findings.push(Finding::TensileStrength { listed, in_force });
    }
    findings.extend(of_compression(surface, listed[1]));
    findings.extend(Finding::of_medium(&surface.medium()));
    findings
}

/// Whether the strength of the surface differs notably from the listed one (Pa).
fn differ(listed: f64, in_force: f64) -> bool {
    (in_force - listed).abs() > NOTABLE * listed
}

/// Inconsistency of a surface with a listed compressive strength (Pa), if there is one.
fn of_compression(surface: &impl YieldSurface, listed: Option<f64>) -> Option<Finding> {
    let in_force = surface.uniaxial_compression();
    let listed = listed.filter(|&listed| differ(listed, in_force))?;
    Some(Finding::CompressiveStrength { listed, in_force })
}

impl Finding {
    /// Finding of near incompressibility: Poisson's ratio above 0.49; `None` for other media.
    pub fn of_medium(medium: &ElasticMedium) -> Option<Self> {
        let poisson = medium.poisson;
        (poisson > NEARLY_INCOMPRESSIBLE).then_some(Self::NearlyIncompressible { poisson })
    }
}
