//! Motion at one point of the ground for unit incident waves.

use std::f64::consts::PI;

use super::stack::{Stack, transfer};
use crate::{Angle, Complex, Ground, SurfaceReflection, WaveError, WaveKind};

/// Frequency (Hz) in place of zero, where a damped modulus may vanish.
const LEAST: f64 = 1e-6;

/// Ground, and the depth of a point in it.
pub(crate) struct ResponsePlace {
    pub(crate) ground: Ground,
    /// Depth below the surface (m).
    pub(crate) depth: f64,
}

impl ResponsePlace {
    /// Travel time (s) of the slowest wave that passes every layer twice, and from the point to the surface and back.
    pub(crate) fn longest_delay(&self) -> f64 {
        let ground = &self.ground;
        let layers = (0..ground.layers().len()).map(|index| {
            let [top, bottom] = ground.extent(index);
            2.0 * (top - bottom) / ground.medium(index).s_speed()
        });
        let below = (self.depth - (ground.surface() - ground.base())).max(0.0);
        layers.sum::<f64>() + 2.0 * below / ground.half_space().s_speed()
    }
}

/// Transfer functions of P, SV and SH waves at a point, each of its own horizontal slowness: motion for a unit incident wave at
/// the top of the half-space below it.
pub(crate) struct Response<'a> {
    place: &'a ResponsePlace,
    p_sv: Option<[Stack; 2]>,
    sh: Option<Stack>,
}

impl<'a> Response<'a> {
    /// Response to waves of some angles of incidence in the half-space.
    pub(crate) fn new(
        place: &'a ResponsePlace,
        p_sv: Option<[Angle; 2]>,
        sh: Option<Angle>,
    ) -> Result<Self, WaveError> {
        let half_space = place.ground.half_space();
        let stack = |kind: WaveKind, incidence: Angle| {
            let reflection = SurfaceReflection::new(kind, incidence, &half_space)?;
            let slowness = reflection.horizontal_slowness;
            Ok::<_, WaveError>(Stack::new(&place.ground, kind, slowness))
        };
        let p_sv = match p_sv {
            Some([p, sv]) => Some([stack(WaveKind::P, p)?, stack(WaveKind::SV, sv)?]),
            None => None,
        };
        let sh = match sh {
            Some(sh) => Some(stack(WaveKind::SH, sh)?),
            None => None,
        };
        Ok(Self { place, p_sv, sh })
    }

    fn state(&self, stack: &Stack, frequency: f64) -> [Complex; 4] {
        let ResponsePlace { ground, depth } = self.place;
        let frequency = Complex::new(2.0 * PI * frequency.max(LEAST), 0.0);
        transfer(ground, stack, ground.surface() - depth, frequency)
    }

    /// Motion along the direction of travel and up (rows) of P and SV (columns) at a frequency (Hz).
    pub(crate) fn in_plane(&self, frequency: f64) -> Option<[[Complex; 2]; 2]> {
        let [p, sv] = self.p_sv.as_ref()?;
        let [along, up, ..] = self.state(p, frequency);
        let [of_sv, up_of_sv, ..] = self.state(sv, frequency);
        Some([[along, of_sv], [up, up_of_sv]])
    }

    /// Motion across the direction of travel of SH at a frequency (Hz).
    pub(crate) fn across(&self, frequency: f64) -> Option<Complex> {
        Some(self.state(self.sh.as_ref()?, frequency)[0])
    }
}
