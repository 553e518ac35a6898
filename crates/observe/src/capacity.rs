//! Capacity of a reinforced concrete section under normal force and bending moment.

use powerhouse_model::ParameterError;

/// Strain of concrete at the compressed edge at failure in bending (1), EN 1992-1-1, table 3.1, up to C50/60.
const CRUSHING: f64 = 3.5e-3;
/// The same at failure without bending (1).
const SHORTENING: f64 = 1.75e-3;
/// Depth of the rectangular stress block over that of the neutral axis (1), EN 1992-1-1, 3.1.7.
const BLOCK: f64 = 0.8;
/// Young's modulus of reinforcing steel (Pa), EN 1992-1-1, 3.2.7.
const STEEL: f64 = 2.0e11;
/// Depth of the neutral axis over the thickness at which a section counts as compressed without bending (1).
const FAR: f64 = 1.0e9;
/// Halvings that find a depth of the neutral axis to rounding.
const HALVINGS: usize = 200;

/// Reinforcement of a section, and the strength of its concrete: what a metre of a lining, wall or slab bears.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionReinforcement {
    /// Compressive strength of the concrete (Pa), above 0: a design value includes its factors.
    pub concrete_strength: f64,
    /// Areas of the bars per metre (m2/m) at the face of negative and of positive `t`, not negative.
    pub bars: [f64; 2],
    /// Distance of the axes of the bars from their face (m), not negative and below half of the thickness.
    pub cover: f64,
    /// Yield stress of the bars (Pa), above 0, a design value likewise.
    pub yield_stress: f64,
}

/// Capacity of a metre of a lining, wall or slab of reinforced concrete: which normal forces and moments it bears together.
///
/// Plane sections remain plane; concrete bears no tension, and in compression a constant stress over 0.8 of the depth of
/// the neutral axis; bars are elastic and perfectly plastic with 200 GPa. The section fails when the compressed edge
/// reaches a strain of 3.5 per mille, or the middle 1.75 per mille where all of it is compressed. Concrete that bars displace is not
/// taken off. Normal forces are positive in tension, moments with tension at positive `t`, as those of
/// [`SectionForces`](crate::SectionForces) per metre, about the middle of the thickness.
///
/// Source: EN 1992-1-1 (2004), 3.1.7, 3.2.7 and 6.1.
///
/// ```
/// use powerhouse_observe::{SectionCapacity, SectionReinforcement};
/// let lining = SectionCapacity::new(0.5, SectionReinforcement {
///     concrete_strength: 16.7e6,
///     bars: [1571e-6, 1571e-6], // 20 mm every 200 mm
///     cover: 0.06,
///     yield_stress: 435e6,
/// })?;
/// let [least, greatest] = lining.moments(-2.0e6).unwrap();
/// assert!(greatest > 0.5e6 && (greatest + least).abs() < 1.0);
/// assert!(lining.utilisation(-2.0e6, 0.5 * greatest) < 1.0);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionCapacity {
    thickness: f64,
    reinforcement: SectionReinforcement,
}

impl SectionCapacity {
    /// Capacity of a section of a thickness (m) with a reinforcement.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(
        thickness: f64,
        reinforcement: SectionReinforcement,
    ) -> Result<Self, ParameterError> {
        let least = f64::MIN_POSITIVE;
        let r = &reinforcement;
        ParameterError::check("thickness", thickness, least, 1.0e6)?;
        ParameterError::check("concrete_strength", r.concrete_strength, least, 1.0e12)?;
        ParameterError::check("bars", r.bars[0], 0.0, thickness)?;
        ParameterError::check("bars", r.bars[1], 0.0, thickness)?;
        ParameterError::check("cover", r.cover, 0.0, 0.5 * thickness)?;
        ParameterError::check("yield_stress", r.yield_stress, least, 1.0e12)?;
        Ok(Self {
            thickness,
            reinforcement,
        })
    }

    /// Thickness of the section (m).
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Normal force (N/m) and moment (N m/m) at failure with a depth of the neutral axis (m, above 0) from the compressed
    /// face, with tension at positive `t` or, `turned`, at negative `t`.
    fn at_failure(&self, depth: f64, turned: bool) -> [f64; 2] {
        let r = &self.reinforcement;
        let h = self.thickness;
        let edge = if depth <= h {
            CRUSHING
        } else {
            SHORTENING * (depth / (depth - 0.5 * h))
        };
        let block = (BLOCK * depth).min(h);
        let crushed = r.concrete_strength * block;
        let mut axial = -crushed;
        let mut moment = crushed * 0.5 * (h - block);
        let [near, far] = if turned {
            [r.bars[1], r.bars[0]]
        } else {
            r.bars
        };
        for (area, from_edge) in [(near, r.cover), (far, h - r.cover)] {
            // Elongation, positive beyond the neutral axis.
            let strain = edge * (from_edge - depth) / depth;
            let stress = (STEEL * strain).clamp(-r.yield_stress, r.yield_stress);
            axial += area * stress;
            moment += area * stress * (from_edge - 0.5 * h);
        }
        [axial, if turned { -moment } else { moment }]
    }

    /// Least and greatest normal force (N/m) that the section bears.
    pub fn axial_range(&self) -> [f64; 2] {
        let r = &self.reinforcement;
        let [least, _] = self.at_failure(FAR * self.thickness, false);
        [least, (r.bars[0] + r.bars[1]) * r.yield_stress]
    }

    /// Moment (N m/m) at failure with a normal force (N/m) in the range, with tension at positive `t` or, `turned`, at negative.
    fn moment(&self, axial: f64, turned: bool) -> f64 {
        let (mut low, mut high) = (
            f64::MIN_POSITIVE.max(1e-12 * self.thickness),
            FAR * self.thickness,
        );
        // Near the greatest pressure the normal force is the same at all depths: the least of them has the moment.
        let [least, greatest] = self.axial_range();
        let rounding = 1e-12 * (greatest - least);
        // The normal force falls as the neutral axis goes deeper; depths differ by orders.
        for _ in 0..HALVINGS {
            let middle = (low * high).sqrt();
            if middle <= low || middle >= high {
                break;
            }
            let [found, _] = self.at_failure(middle, turned);
            if found > axial + rounding {
                low = middle;
            } else {
                high = middle;
            }
        }
        let [[more, of_more], [less, of_less]] =
            [low, high].map(|depth| self.at_failure(depth, turned));
        // Between the two the moment is linear, where bars yield at one depth.
        let share = if more > less {
            ((more - axial) / (more - less)).clamp(0.0, 1.0)
        } else {
            0.0
        };
        of_more + share * (of_less - of_more)
    }

    /// Least and greatest moment (N m/m) that the section bears with a normal force (N/m); none if it does not bear
    /// that force.
    pub fn moments(&self, axial: f64) -> Option<[f64; 2]> {
        let [least, greatest] = self.axial_range();
        let is_borne = (least..=greatest).contains(&axial);
        is_borne.then(|| [self.moment(axial, true), self.moment(axial, false)])
    }

    /// Utilisation of a normal force (N/m) and a moment (N m/m): distance of the moment from the middle of those that the section
    /// bears with the same normal force, over half of their range; of a normal force that it does not bear, that force over
    /// the one it bears. Above one it fails; infinite where nothing is borne.
    pub fn utilisation(&self, axial: f64, moment: f64) -> f64 {
        let Some([least, greatest]) = self.moments(axial) else {
            let [pressure, tension] = self.axial_range();
            return axial / if axial > 0.0 { tension } else { pressure };
        };
        let half = 0.5 * (greatest - least);
        let distance = (moment - 0.5 * (least + greatest)).abs();
        match half > 0.0 {
            true => distance / half,
            false if distance == 0.0 => 0.0,
            false => f64::INFINITY,
        }
    }

    /// Interaction diagram: the closed line of normal forces (N/m) and moments (N m/m) at failure, in `2 count` points.
    pub fn interaction(&self, count: usize) -> Vec<[f64; 2]> {
        let [least, greatest] = self.axial_range();
        let count = count.max(2);
        let axial = |index: usize| {
            // Points are close where the line is steep, at both ends.
            let share = index as f64 / (count - 1) as f64;
            let share = 0.5 - 0.5 * (core::f64::consts::PI * share).cos();
            (least + share * (greatest - least)).clamp(least, greatest)
        };
        let up = (0..count).map(|index| [axial(index), self.moment(axial(index), false)]);
        let down = (0..count).rev();
        let down = down.map(|index| [axial(index), self.moment(axial(index), true)]);
        let mut line: Vec<[f64; 2]> = up.chain(down).collect();
        line.push(line[0]);
        line
    }
}
