//! Parameters of published materials.

use crate::{MohrCoulombParameters, media};

/// The rock of the paper: phi 42 degrees, c 1.05 MPa, dilation zero (the paper gives none).
///
/// The listed tensile strength of 1.3 MPa lies beyond the apex (1.166 MPa): the surface in force
/// yields at 0.935 MPa in uniaxial tension and at 4.717 MPa in uniaxial compression, not at the
/// listed 35 MPa.
///
/// Source: Wang, Chen & Xiao (2019), Table 1.
pub const PAPER_ROCK: MohrCoulombParameters = MohrCoulombParameters {
    medium: media::ROCK,
    friction: 42.0,
    dilation: 0.0,
    cohesion: 1.05e6,
    tension_strength: Some(1.3e6),
};

/// The concrete of the paper, C25: phi 47.7 degrees, c 1.3 MPa, dilation zero (the paper gives
/// none).
///
/// The listed tensile strength of 1.27 MPa lies beyond the apex (1.183 MPa): the surface in force
/// yields at 1.006 MPa in uniaxial tension and at 6.721 MPa in uniaxial compression, not at the
/// listed 16.7 MPa.
///
/// Source: Wang, Chen & Xiao (2019), Table 1.
pub const PAPER_CONCRETE: MohrCoulombParameters = MohrCoulombParameters {
    medium: media::CONCRETE,
    friction: 47.7,
    dilation: 0.0,
    cohesion: 1.3e6,
    tension_strength: Some(1.27e6),
};
