//! Parameters of published materials.

use powerhouse_model::{ElasticMedium, ParameterError};

use crate::{
    LeeFenvesParameters, MaterialError, MazarsParameters, MazarsTension, MohrCoulomb,
    MohrCoulombParameters, PlasticDamage, PlasticDamageParameters, Softening, TwoSurfaceParameters,
    media,
};

/// Mohr-Coulomb rock of the paper: phi 42 degrees, c 1.05 MPa, dilation zero (the paper gives none).
///
/// The listed tensile strength of 1.3 MPa is beyond the apex (1.166 MPa): the surface yields at
/// 0.935 MPa in uniaxial tension and at 4.717 MPa in uniaxial compression, not at the listed 35 MPa.
/// [`PAPER_ROCK_LISTED`] has the listed strengths.
///
/// Source: Wang, Chen & Xiao (2019), Table 1.
pub const PAPER_ROCK: MohrCoulombParameters = MohrCoulombParameters {
    medium: media::ROCK,
    friction: 42.0,
    dilation: 0.0,
    cohesion: 1.05e6,
    tension_strength: Some(1.3e6),
};

/// Mohr-Coulomb concrete of the paper, C25: phi 47.7 degrees, c 1.3 MPa, dilation zero (the paper gives
/// none).
///
/// The listed tensile strength of 1.27 MPa is beyond the apex (1.183 MPa): the surface yields at
/// 1.006 MPa in uniaxial tension and at 6.721 MPa in uniaxial compression, not at the listed
/// 16.7 MPa. [`PAPER_CONCRETE_LISTED`], [`PAPER_CONCRETE_LEE_FENVES`] and
/// [`PAPER_CONCRETE_MAZARS`] have the listed strengths.
///
/// Source: Wang, Chen & Xiao (2019), Table 1.
pub const PAPER_CONCRETE: MohrCoulombParameters = MohrCoulombParameters {
    medium: media::CONCRETE,
    friction: 47.7,
    dilation: 0.0,
    cohesion: 1.3e6,
    tension_strength: Some(1.27e6),
};

/// Concrete of the paper with its listed strengths: 1.27 MPa in uniaxial tension, 16.7 MPa in
/// uniaxial compression, and phi 47.7 degrees under confinement, dilation zero. The cohesion under
/// confinement is 3.23 MPa, which these strengths require, instead of the listed 1.3 MPa.
///
/// Source: Wang, Chen & Xiao (2019), Table 1.
pub const PAPER_CONCRETE_LISTED: TwoSurfaceParameters = TwoSurfaceParameters {
    medium: media::CONCRETE,
    friction: 47.7,
    dilation: 0.0,
    cohesion: 1.3e6,
    tension_strength: 1.27e6,
    compression_strength: 16.7e6,
};

/// Rock of the paper with its listed strengths: 1.3 MPa in uniaxial tension, 35 MPa in uniaxial
/// compression, and phi 42 degrees under confinement, dilation zero. The cohesion under confinement
/// is 7.79 MPa, which these strengths require, instead of the listed 1.05 MPa.
///
/// Source: Wang, Chen & Xiao (2019), Table 1.
pub const PAPER_ROCK_LISTED: TwoSurfaceParameters = TwoSurfaceParameters {
    medium: media::ROCK,
    friction: 42.0,
    dilation: 0.0,
    cohesion: 1.05e6,
    tension_strength: 1.3e6,
    compression_strength: 35.0e6,
};

/// Plastic-damage concrete of the paper, C25: [`PAPER_CONCRETE`] with Eq. (25).
///
/// The paper gives no softening. Here the fracture energy is 133 N/m in tension (fib Model Code 2010:
/// `73 f_cm^0.18` with 28 MPa) and 36 kN/m in compression (Nakamura & Higai 2001: `8.8 sqrt(f_c)` N/mm
/// with 16.7 MPa), both thresholds are zero; closed cracks recover their stiffness, and the residual
/// stiffness is a thousandth. It yields and crushes as [`PAPER_CONCRETE`] does, below the listed
/// strengths.
///
/// # Errors
/// None with these numbers.
pub fn paper_concrete() -> Result<PlasticDamage<MohrCoulomb>, MaterialError> {
    cracking(PAPER_CONCRETE, 133.0, 35.96e3)
}

/// Mazars concrete of the paper, C25: `e0 = f_t / E` with 1.27 MPa, `A_t` 0.9, `B_t = 1 / e0`,
/// `A_c` 1.175, `B_c` 2965, which peaks at 16.7 MPa in uniaxial compression.
///
/// Source: the rule of thumb of code_aster for Mazars' law (R7.01.08), with the strengths of Wang,
/// Chen & Xiao (2019), Table 1.
pub const PAPER_CONCRETE_MAZARS: MazarsParameters = MazarsParameters {
    medium: media::CONCRETE,
    threshold: 5.08e-5,
    tension: MazarsTension::Rates {
        share: 0.9,
        rate: 1.0 / 5.08e-5,
    },
    compression_share: 1.175,
    compression_rate: 2965.0,
    residual_stiffness: 1.0e-3,
};

/// Lee-Fenves concrete of the paper, with its listed strengths: biaxial ratio 1.16, `K_c`
/// 2/3 and dilation 36 degrees of ordinary concrete, energies as in [`paper_concrete`], damage 0.5
/// at half the tensile strength (Lee & Fenves 1998: 0.51), and half of that rate in compression.
///
/// Source of strengths and medium: Wang, Chen & Xiao (2019), Table 1.
pub const PAPER_CONCRETE_LEE_FENVES: LeeFenvesParameters = LeeFenvesParameters {
    medium: media::CONCRETE,
    tension_strength: 1.27e6,
    compression_strength: 16.7e6,
    compression_limit: 16.7e6,
    biaxial_ratio: 1.16,
    meridian_ratio: 2.0 / 3.0,
    dilation: 36.0,
    tension_energy: 133.0,
    compression_energy: 35.96e3,
    tension_damage: 1.0,
    compression_damage: 0.5,
    stiffness_recovery: 1.0,
    residual_stiffness: 1.0e-3,
};

/// Plastic-damage concrete of a characteristic cylinder strength (MPa), 12 to 50.
///
/// Eurocode 2 (EN 1992-1-1:2004, Table 3.1): `f_cm = f_ck + 8`, `f_ctm = 0.3 f_ck^(2/3)`, `E_cm =
/// 22 (f_cm / 10)^0.3` GPa, Poisson's ratio 0.2, 2500 kg/m3. The surface goes
/// [through](MohrCoulombParameters::through_strengths) `f_cm` and `f_ctm`. Softening as in
/// [`paper_concrete`], with `f_cm`.
///
/// # Errors
/// If the strength is outside the range of the table.
pub fn eurocode_concrete(strength: f64) -> Result<PlasticDamage<MohrCoulomb>, MaterialError> {
    let concrete = Eurocode::new(strength)?;
    let parameters = MohrCoulombParameters::through_strengths(
        concrete.medium,
        concrete.compression_strength,
        concrete.tension_strength,
    )?;
    cracking(
        parameters,
        concrete.cracking_energy,
        concrete.crushing_energy,
    )
}

/// Lee-Fenves parameters of the concrete of [`eurocode_concrete`]: the same medium, strengths and energies,
/// all else as in [`PAPER_CONCRETE_LEE_FENVES`].
///
/// # Errors
/// If the strength is outside the range of the table.
pub fn eurocode_lee_fenves(strength: f64) -> Result<LeeFenvesParameters, MaterialError> {
    let concrete = Eurocode::new(strength)?;
    Ok(LeeFenvesParameters {
        medium: concrete.medium,
        tension_strength: concrete.tension_strength,
        compression_strength: concrete.compression_strength,
        compression_limit: concrete.compression_strength,
        tension_energy: concrete.cracking_energy,
        compression_energy: concrete.crushing_energy,
        ..PAPER_CONCRETE_LEE_FENVES
    })
}

/// Properties of a concrete by Eurocode 2.
struct Eurocode {
    medium: ElasticMedium,
    /// Mean strengths (Pa).
    tension_strength: f64,
    compression_strength: f64,
    /// Fracture energies per area (N/m).
    cracking_energy: f64,
    crushing_energy: f64,
}

impl Eurocode {
    /// Properties for a characteristic cylinder strength (MPa).
    fn new(strength: f64) -> Result<Self, MaterialError> {
        ParameterError::check("strength", strength, 12.0, 50.0)?;
        let compressive = strength + 8.0;
        let young = 22.0e9 * (compressive / 10.0).powf(0.3);
        Ok(Self {
            medium: ElasticMedium::new(young, 0.2, 2500.0)?,
            tension_strength: 1.0e6 * (0.3 * strength.powf(2.0 / 3.0)),
            compression_strength: 1.0e6 * compressive,
            cracking_energy: 73.0 * compressive.powf(0.18),
            crushing_energy: 8.8e3 * compressive.sqrt(),
        })
    }
}

/// Softening by fracture energies of cracking and crushing (N/m).
fn cracking(
    parameters: MohrCoulombParameters,
    cracking: f64,
    crushing: f64,
) -> Result<PlasticDamage<MohrCoulomb>, MaterialError> {
    let by_energy = |energy| Softening::FractureEnergy {
        energy,
        threshold: 0.0,
    };
    PlasticDamage::new(PlasticDamageParameters {
        surface: MohrCoulomb::new(parameters)?,
        tension: by_energy(cracking),
        compression: by_energy(crushing),
        stiffness_recovery: 1.0,
        residual_stiffness: 1.0e-3,
    })
}
