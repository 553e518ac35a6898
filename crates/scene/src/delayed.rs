//! Slices and bays whose sides are delayed against each other: a long structure, or an endless row of bays, along y under waves of any
//! azimuth.

use std::collections::HashSet;

use powerhouse_elements::BoltLine;
use powerhouse_model::{
    DelayedPairs, Facet, IncidentField, PeriodicPairs, Precision, StiffElements, Support, Vec3,
};
use powerhouse_wavefield::{Angle, LayeredWave, PlaneWave, WaveKind};

use crate::remark::{Kind, described};
use crate::{Boundary, DelayedError, Error, InitialMotion, Part, Scene, Topic};
use powerhouse_laws::Damping;

/// Largest product of the slowness along y and the speed of P waves of a part: of the ground, up to which plane waves are
/// exact to the discretisation, and of a structure in it.
const MOST_IN_GROUND: f64 = 0.99;
const MOST_IN_STRUCTURE: f64 = 1.6;
/// The same of all parts of a bay: of linear ones, and of those with other laws.
const MOST_IN_BAY: f64 = 0.95;
const MOST_OF_LAWS: f64 = 0.9;
/// Component along y of the direction of a bolt up to which it is across y.
const ALONG: f64 = 0.02;
/// The same product of a structure above which it is stiff: a part of its inertia along the axis is moved to the ground around it.
const STIFF: f64 = 0.95;
/// Largest share of its density that a stiff part gives to the motion along y; the rest is moved.
const MOST_SHARE: f64 = 0.5;
/// Difference of the slownesses of two waves, over the larger one, that rounding of angles explains.
const SAME: f64 = 1e-6;
/// Slowness along y, over that of the wave, below which it travels across y: rounding.
const ACROSS: f64 = 1e-12;
/// Component along y of the unit normal of a facet of the ends, of those whose nodes are all in pairs: those of a slice are, too, at its sides.
const ACROSS_END: f64 = 0.5;
/// Component along y of the unit vector that a support holds below which it does not hold y: rounding of normals of facets.
const HELD: f64 = 1e-9;

/// Stiff part of a slice with delayed sides: one in which P waves are faster than the motion along y, or nearly so.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StiffPart {
    /// Element set of the part.
    pub set: String,
    /// Speed of its P waves over that of the motion along y (1).
    pub ratio: f64,
}

impl StiffPart {
    /// Error of the axial stress (1) as the tests of rings bound it, all of them of the side of too large stresses.
    pub fn error(&self) -> f64 {
        if self.ratio < WELL_BELOW { 0.03 } else { 0.08 }
    }
}

/// Ratio of a stiff part up to which the axial stress of the rings of the tests errs by 3 %, and by 8 % above.
const WELL_BELOW: f64 = 1.35;

described!(StiffPart, |_| Kind::Warning(Topic::Run));

impl core::fmt::Display for StiffPart {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { set, ratio } = self;
        write!(
            f,
            "P waves of part '{set}' travel at {ratio:.2} of the speed of the motion along y: a part of its inertia along the axis is moved to the ground around it, and its axial stress is within {:.0} %, too large, if it is thin as a lining is; below {STIFF} it is exact",
            100.0 * self.error()
        )
    }
}

fn with(what: impl Into<String>, way: &'static str) -> DelayedError {
    DelayedError::With {
        what: what.into(),
        way,
    }
}

/// Largest product of the slowness along y and the speed of P waves of a part, which is ground or a structure in it, of a slice or a bay.
fn most_ratio(part: &Part, is_ground: bool, is_bay: bool) -> f64 {
    match (is_bay, is_ground) {
        (true, _) if part.material.is_linear() && !matches!(part.damping, Damping::Flat { .. }) => {
            MOST_IN_BAY
        }
        (true, _) => MOST_OF_LAWS,
        (false, true) => MOST_IN_GROUND,
        (false, false) => MOST_IN_STRUCTURE,
    }
}

/// Speed (m/s) of the fastest P waves of a part: with flat damping they are faster than without.
fn speed_in(part: &Part) -> f64 {
    let moving = part.moving_material();
    let material = moving.as_ref().unwrap_or(&part.material);
    material.medium().p_speed()
}

/// A plane wave in homogeneous or layered ground, as slices see it.
struct SliceWave<'s> {
    name: &'s str,
    kind: WaveKind,
    azimuth: Angle,
    /// Speed of the incident wave (m/s).
    speed: f64,
    /// Speed (m/s) of the fastest of all waves into which it splits.
    fastest: f64,
    /// Slowness along y (s/m), zero for a wave across it.
    along_y: f64,
    is_causal: bool,
}

impl<'s> SliceWave<'s> {
    fn homogeneous(wave: &'s PlaneWave) -> Self {
        let parameters = wave.parameters();
        Self {
            name: IncidentField::name(wave),
            kind: parameters.kind,
            azimuth: parameters.azimuth,
            speed: parameters.kind.speed(&parameters.medium),
            fastest: fastest(parameters.kind).speed(&parameters.medium),
            along_y: along_y(parameters.slowness()),
            is_causal: wave.is_causal(),
        }
    }

    fn layered(wave: &'s LayeredWave) -> Self {
        let parameters = wave.parameters();
        let (kind, ground) = (parameters.kind, &parameters.ground);
        let layers = ground.layers().iter().map(|layer| &layer.medium);
        let speeds = layers.map(|medium| fastest(kind).speed(medium));
        Self {
            name: IncidentField::name(wave),
            kind,
            azimuth: parameters.azimuth,
            speed: kind.speed(&ground.half_space()),
            fastest: speeds.fold(fastest(kind).speed(&ground.half_space()), f64::max),
            along_y: along_y(parameters.slowness()),
            is_causal: wave.is_causal(),
        }
    }
}

/// Type of the fastest waves into which an incident one splits at surface and interfaces.
fn fastest(kind: WaveKind) -> WaveKind {
    match kind {
        WaveKind::SH => WaveKind::SH,
        WaveKind::P | WaveKind::SV => WaveKind::P,
    }
}

/// The part of a slowness (s/m) along y, zero if there is none to rounding.
fn along_y(slowness: Vec3) -> f64 {
    if slowness.y.abs() > ACROSS * slowness.norm() {
        slowness.y
    } else {
        0.0
    }
}

impl Scene {
    /// Makes the body a slice of a long structure along y under waves of any azimuth: pairs of all nodes of its two sides,
    /// of which the side of larger y moves later. In construction stages they move as one.
    #[must_use]
    pub fn with_delayed_sides(mut self, pairs: PeriodicPairs) -> Self {
        self.delayed = Some(pairs);
        self
    }

    /// Pairs of nodes of the sides of a slice under waves of any azimuth; none for any other body.
    pub fn delayed_sides(&self) -> Option<&PeriodicPairs> {
        self.delayed.as_ref()
    }

    /// All pairs of nodes on opposite faces: periodic ones, and those of delayed sides.
    pub(crate) fn all_pairs(&self) -> impl Iterator<Item = (u32, u32)> + '_ {
        let all = self.periodic.iter().chain(&self.delayed);
        all.flat_map(|pairs| pairs.pairs.iter().copied())
    }

    /// Slowness along y (s/m) of the motion of a slice with delayed sides, zero for any other body.
    pub fn slowness_along_y(&self) -> f64 {
        let first = self.waves_of_slice().next();
        let first = first.filter(|_| self.delayed.is_some());
        first.map_or(0.0, |wave| wave.along_y)
    }

    /// Whether the delayed sides are those of a bay of an endless row: there are nodes between them.
    pub fn is_bay(&self) -> bool {
        let delayed = self.delayed.as_ref();
        delayed.is_some_and(|sides| DelayedPairs::make_bay(&self.mesh, &sides.pairs))
    }

    /// Refuses bolts that run along y in a bay: their strain would need the delay of their ends.
    pub(crate) fn check_bolts_of_bay(&self, name: &str, lines: &[BoltLine]) -> Result<(), Error> {
        if !self.is_bay() || self.slowness_along_y() == 0.0 {
            return Ok(());
        }
        let along = |line: &BoltLine| {
            let axis = line.toe - line.head;
            axis.y.abs() / axis.norm()
        };
        let Some(place) = lines.iter().position(|line| along(line) > ALONG) else {
            return Ok(());
        };
        let what = format!(
            "bolts '{name}', of which number {} runs along y by {:.3} of its length, above {ALONG}",
            place + 1,
            along(&lines[place])
        );
        let way = "a bay takes bolts across y; leave those along y out, or take several bays with their whole length";
        Err(with(what, way).into())
    }

    /// All plane waves, in homogeneous or in layered ground.
    fn waves_of_slice(&self) -> impl Iterator<Item = SliceWave<'_>> {
        let layered = self.layered_waves().iter().map(SliceWave::layered);
        self.plane_waves()
            .iter()
            .map(SliceWave::homogeneous)
            .chain(layered)
    }

    /// Speed of P waves of the fastest part over that of the motion along y (1) if a slice with delayed sides took the place of this body, a bay
    /// or one without delayed ends; none where waves, parts, supports, loads or boundary have no place in such a slice, where it is not exact, or
    /// where waves travel across y.
    pub fn ratio_in_delayed_slice(&self) -> Option<f64> {
        let (first, boundary) = (self.waves_of_slice().next()?, self.boundary.as_ref()?);
        let is_slice = self.delayed.is_some() && !self.is_bay();
        let in_double = self.precision == Precision::F64 && self.fibres.is_none();
        if is_slice || !in_double || !self.waters.is_empty() {
            return None;
        }
        self.check_waves_of_slice().ok()?;
        self.check_parts_of_slice(false).ok()?;
        self.check_motions_of_slice().ok()?;
        check_boundary_of_slice(boundary).ok()?;
        if self.is_held_beside_ends() {
            return None;
        }
        let speeds = self
            .parts
            .iter()
            .map(|part| part.material.medium().p_speed());
        let ratio = first.along_y.abs() * speeds.fold(0.0, f64::max);
        (0.0 < ratio && ratio <= STIFF).then_some(ratio)
    }

    /// Parts of a slice with delayed sides in which P waves are faster than the motion along y, or nearly so; none in any other body.
    pub fn stiff_parts(&self) -> Vec<StiffPart> {
        let ratios = self.parts.iter().map(|part| StiffPart {
            set: part.set.clone(),
            ratio: self.slowness_along_y().abs() * part.material.medium().p_speed(),
        });
        let Ok(ground) = self.parts_behind_boundary() else {
            return Vec::new();
        };
        if self.is_bay() {
            return Vec::new();
        }
        let is_stiff =
            |(index, part): &(usize, StiffPart)| part.ratio > STIFF && !ground.contains(index);
        let stiff = ratios.enumerate().filter(is_stiff);
        stiff.map(|(_, part)| part).collect()
    }

    /// The elements of stiff parts with what they keep of their inertia along the axis.
    pub(crate) fn stiff_elements(&self) -> Vec<StiffElements> {
        let slowness = self.slowness_along_y();
        let of_part = |stiff: StiffPart| {
            let part = self.parts.iter().find(|part| part.set == stiff.set)?;
            let medium = part.material.medium();
            let kept = [medium.s_speed(), medium.p_speed()].map(|speed| {
                let share = (slowness * speed).powi(2);
                (MOST_SHARE / share).min(1.0)
            });
            let elements = self.mesh.element_set(&part.set).ok()?.to_vec();
            Some(StiffElements { elements, kept })
        };
        self.stiff_parts().into_iter().filter_map(of_part).collect()
    }

    /// Refuses what a slice with delayed sides does not take.
    pub(super) fn check_delayed(&self) -> Result<(), Error> {
        if self.delayed.is_none() {
            return Ok(());
        }
        self.check_waves_of_slice()?;
        if self.slowness_along_y() == 0.0 {
            // Sides that move at the same time are periodic.
            return Ok(());
        }
        self.check_speeds_of_slice()?;
        self.check_parts_of_slice(self.is_bay())?;
        self.check_company_of_slice()?;
        Ok(())
    }

    fn check_waves_of_slice(&self) -> Result<(), DelayedError> {
        let Some(first) = self.waves_of_slice().next() else {
            let field = self.field();
            return field.map_or(Ok(()), |field| {
                Err(DelayedError::OtherField {
                    field: field.name().into(),
                })
            });
        };
        for wave in self.waves_of_slice() {
            let slownesses = [first.along_y, wave.along_y];
            let [least, most] = slownesses.map(f64::abs);
            if (slownesses[1] - slownesses[0]).abs() > SAME * least.max(most) {
                return Err(DelayedError::Slownesses {
                    first: first.name.into(),
                    second: wave.name.into(),
                    slownesses,
                });
            }
            self.check_causal(&wave)?;
        }
        Ok(())
    }

    fn check_causal(&self, wave: &SliceWave) -> Result<(), DelayedError> {
        if wave.along_y == 0.0 || wave.is_causal {
            return Ok(());
        }
        Err(DelayedError::PastCritical {
            wave: wave.name.into(),
            largest: self.largest_incidence(wave),
        })
    }

    /// Refuses a plane wave past the critical angle in homogeneous ground, where the body has delayed ends.
    ///
    /// # Errors
    /// [`DelayedError::PastCritical`].
    pub fn check_wave_at_ends(&self, wave: &PlaneWave) -> Result<(), DelayedError> {
        let has_ends = self.delayed.is_some();
        let wave = has_ends.then(|| SliceWave::homogeneous(wave));
        wave.map_or(Ok(()), |wave| self.check_causal(&wave))
    }

    /// Refuses a plane wave past a critical angle in layered ground, where the body has delayed ends.
    ///
    /// # Errors
    /// [`DelayedError::PastCritical`].
    pub fn check_layered_wave_at_ends(&self, wave: &LayeredWave) -> Result<(), DelayedError> {
        let has_ends = self.delayed.is_some();
        let wave = has_ends.then(|| SliceWave::layered(wave));
        wave.map_or(Ok(()), |wave| self.check_causal(&wave))
    }

    /// Refuses a facet set that is a delayed end among absorbing faces.
    ///
    /// # Errors
    /// [`DelayedError::Absorbing`].
    pub fn check_absorbing_end(&self, face: &str) -> Result<(), DelayedError> {
        let Some(delayed) = &self.delayed else {
            return Ok(());
        };
        let ends: HashSet<u32> = (delayed.pairs.iter()).flat_map(|&(a, b)| [a, b]).collect();
        let is_of_end = |facet: &Facet| {
            let mut nodes = self.mesh.facet_nodes(*facet).into_iter();
            nodes.all(|node| ends.contains(&node))
                && self.mesh.facet_geometry(*facet).normal().y.abs() > ACROSS_END
        };
        let facets = self.mesh.facet_set(face).unwrap_or_default();
        if facets.iter().any(is_of_end) {
            return Err(DelayedError::Absorbing { face: face.into() });
        }
        Ok(())
    }

    /// The largest incidence (degrees, rounded down to tenths) of a wave at its azimuth that neither a part nor the critical angle
    /// refuses.
    fn largest_incidence(&self, wave: &SliceWave) -> f64 {
        let own = wave.speed;
        let along = wave.azimuth.radians().sin().abs();
        let ground = self.parts_behind_boundary().unwrap_or_default();
        let is_bay = self.is_bay();
        let of_part = |(index, part): (usize, &Part)| {
            let most = most_ratio(part, ground.contains(&index), is_bay);
            most * own / (speed_in(part) * along)
        };
        let parts = self.parts.iter().enumerate().map(of_part);
        let sine = parts.fold(own / wave.fastest, f64::min);
        (10.0 * sine.asin().to_degrees()).floor() / 10.0
    }

    /// Refuses parts whose P waves are too fast for the motion along y.
    fn check_speeds_of_slice(&self) -> Result<(), Error> {
        let slowness = self.slowness_along_y().abs();
        let ground = self.parts_behind_boundary()?;
        let is_bay = self.is_bay();
        for (index, part) in self.parts.iter().enumerate() {
            let most = most_ratio(part, ground.contains(&index), is_bay);
            let speed = speed_in(part);
            let ratio = slowness * speed;
            if ratio <= most {
                continue;
            }
            let largest = |wave: SliceWave| {
                let (azimuth, kind) = (wave.azimuth.degrees(), wave.kind);
                let degrees = self.largest_incidence(&wave);
                format!(
                    "at azimuth {azimuth:.1} degrees the incidence of {kind} waves is at most {degrees:.1} degrees"
                )
            };
            let ways: Vec<String> = self.waves_of_slice().map(largest).collect();
            return Err(DelayedError::Fast {
                set: part.set.clone(),
                speed,
                apparent: 1.0 / slowness,
                ratio,
                most,
                way: ways.join(", "),
            }
            .into());
        }
        Ok(())
    }

    /// Whether supports along y, or periodic pairs, are not at the two ends of the body along y, which those of a slice take the place of.
    fn is_held_beside_ends(&self) -> bool {
        let (low, high) = self.mesh.bounding_box();
        let tolerance = DelayedPairs::AT_END * (high.y - low.y);
        let y = |node: &u32| self.mesh.positions()[*node as usize].y;
        let at_end = |node: &u32| (y(node) - low.y).min(high.y - y(node)) <= tolerance;
        let pairs = self.periodic.iter().flat_map(|pairs| &pairs.pairs);
        let mut supports = self.supports.iter();
        pairs
            .clone()
            .any(|(a, b)| !(at_end(a) && at_end(b)) || (y(b) - y(a)).abs() <= tolerance)
            || supports.any(|support| holds_along_y(support) && !support.nodes().iter().all(at_end))
    }

    /// Refuses damping and water of parts.
    fn check_parts_of_slice(&self, is_bay: bool) -> Result<(), DelayedError> {
        for part in &self.parts {
            let set = &part.set;
            if matches!(part.damping, Damping::Flat { .. }) && !is_bay {
                let way = "give the part, and a layer of it, Rayleigh damping proportional to mass, or none, and no `strain_curves`; or give the mesh two layers of elements along y, a bay, which takes flat damping";
                return Err(with(format!("the flat damping of part '{set}'"), way));
            }
            if part.damping.rayleigh().stiffness != 0.0 || part.high != 0.0 {
                let way = if is_bay {
                    "give the part flat damping without `high`, damping proportional to mass (`kind = \"coefficients\"`, `stiffness = 0`), or none"
                } else {
                    "give the part damping proportional to mass (`kind = \"coefficients\"`, `stiffness = 0`), or none"
                };
                return Err(with(format!("the stiffness damping of part '{set}'"), way));
            }
            if part.material.pore_water().is_some() {
                let way = "compute the part without water in its pores";
                return Err(with(format!("water in the pores of part '{set}'"), way));
            }
        }
        Ok(())
    }

    /// Refuses joints, bolts, loads and boundaries that have no place in a slice.
    fn check_company_of_slice(&self) -> Result<(), DelayedError> {
        if let Some(joint) = self.joints.first().filter(|_| !self.is_bay()) {
            let way = "give the mesh two layers of elements along y, a bay, which takes joints, or take a body with its whole length along y";
            return Err(with(format!("joint '{}'", joint.name), way));
        }
        if !(self.bolts.is_empty() || self.is_bay()) {
            let way = "give the mesh two layers of elements along y, a bay, which takes bolts across y, or take a body with its whole length along y";
            return Err(with("bolts", way));
        }
        if !(self.periodic.is_empty() || self.is_bay()) {
            return Err(with(
                "periodic pairs beside them",
                "absorb at the sides across x",
            ));
        }
        self.check_motions_of_slice()?;
        if self.supports.iter().any(holds_along_y) {
            let way = "absorb at the bottom and at the sides across x; the delayed ends need no other support";
            return Err(with("supports along y", way));
        }
        self.boundary
            .as_ref()
            .map_or(Ok(()), check_boundary_of_slice)
    }

    /// Refuses motions, constraints and loads that have no place in a slice.
    fn check_motions_of_slice(&self) -> Result<(), DelayedError> {
        if !self.prescribed.is_empty() {
            return Err(with(
                "prescribed motions",
                "let waves enter through absorbing faces",
            ));
        }
        if !self.constraints.is_empty() {
            let way = "take a body with its whole length along y";
            return Err(with("constraints", way));
        }
        let all = self
            .loads
            .iter()
            .chain(self.stages.iter().flat_map(|stage| &stage.loads));
        let weights = self
            .weights
            .iter()
            .chain(self.stages.iter().flat_map(|stage| &stage.weights));
        let changing = all.map(|staged| powerhouse_model::NodalLoad::is_constant(&staged.load));
        let changing = changing.chain(weights.map(|(_, history)| history.is_constant()));
        if changing.into_iter().any(|constant| !constant) {
            let way = "a load that changes in time would travel along the axis with the waves; take a body with its whole length along y";
            return Err(with("loads that change in time", way));
        }
        if self.initial == InitialMotion::Field {
            return Err(with(
                "the motion of the field at the start",
                "start at rest",
            ));
        }
        Ok(())
    }
}

/// Whether a support holds y.
fn holds_along_y(support: &Support) -> bool {
    let held = support.held_direction();
    held.is_none_or(|held| held.y.abs() > HELD)
}

/// Refuses boundaries that do not follow the motion along y.
fn check_boundary_of_slice(boundary: &Boundary) -> Result<(), DelayedError> {
    if !boundary.through.is_empty() {
        let way = "what runs along y is in the body anyhow; end it before the other faces";
        return Err(with("structures `through` its faces", way));
    }
    if boundary.region.is_some() {
        return Err(with(
            "a region around which the field enters",
            "let it enter through the faces",
        ));
    }
    let name = powerhouse_model::AbsorbingBoundary::name(&*boundary.condition);
    if !["viscous", "viscous-spring"].contains(&name) {
        let what =
            format!("the boundary '{name}', whose dashpots do not follow the slowness along y");
        return Err(with(what, "take 'viscous-spring' or 'viscous'"));
    }
    Ok(())
}
