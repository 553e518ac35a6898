//! Elastic response spectra of design codes.

use powerhouse_model::ParameterError;

use crate::WaveError;

/// Elastic response spectrum of absolute (pseudo-)acceleration for design: of a code, or a table of an office.
///
/// ```
/// use powerhouse_wavefield::{DesignSpectrum, Eurocode8, Eurocode8Ground, Eurocode8Type};
/// let target = DesignSpectrum::eurocode_8(&Eurocode8 {
///     kind: Eurocode8Type::One,
///     ground: Eurocode8Ground::B,
///     peak: 2.0,
///     damping: 0.05,
/// })?;
/// // The plateau is 2.5 S ag, with S = 1.2.
/// assert_eq!(target.acceleration(0.3), Some(2.5 * 1.2 * 2.0));
/// assert_eq!(target.acceleration(6.0), None);
/// # Ok::<(), powerhouse_wavefield::WaveError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct DesignSpectrum {
    name: String,
    damping: f64,
    branches: Vec<Branch>,
}

/// Part of a spectrum between two periods.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Branch {
    first: f64,
    last: f64,
    shape: Shape,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    /// Straight between the values at the two ends (m/s2).
    Line { first: f64, last: f64 },
    /// `first` (m/s2) at the first period, times the ratio of periods to the power `exponent`.
    Power { first: f64, exponent: f64 },
}

/// Shape of the elastic spectrum of Eurocode 8 by the earthquakes that contribute most to the hazard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eurocode8Type {
    /// Surface-wave magnitudes above 5.5.
    One,
    /// Magnitudes up to 5.5.
    Two,
}

/// Ground type of Eurocode 8 (EN 1998-1:2004, table 3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Eurocode8Ground {
    /// Rock, S speed above 800 m/s.
    A,
    /// Very dense sand, gravel or very stiff clay.
    B,
    /// Deep dense or medium-dense sand, gravel or stiff clay.
    C,
    /// Loose to medium cohesionless or soft to firm cohesive soil.
    D,
    /// A surface layer of C or D, 5 to 20 m thick, over A.
    E,
}

/// Parameters of the horizontal elastic spectrum of Eurocode 8 (EN 1998-1:2004, 3.2.2.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eurocode8 {
    /// Type of the spectrum.
    pub kind: Eurocode8Type,
    /// Ground type.
    pub ground: Eurocode8Ground,
    /// Design ground acceleration on type A ground, a_g (m/s2), above zero.
    pub peak: f64,
    /// Damping ratio, 0 to 0.3.
    pub damping: f64,
}

/// Site class of GB 18306-2015 and of NB 35047-2015.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ChineseSite {
    /// Hard rock.
    I0,
    /// Rock and very dense soil.
    I1,
    /// Medium-dense soil: the class to which the zone's period refers.
    II,
    /// Soft soil.
    III,
    /// Very soft soil.
    IV,
}

/// Parameters of the standard design spectrum of hydraulic structures (NB 35047-2015, section 4.3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nb35047 {
    /// Peak ground acceleration of the site (m/s2), above zero.
    pub peak: f64,
    /// Amplification of the plateau, beta_max, 1 to 5: 2.5 for arch dams, 2.25 for most other structures of concrete,
    /// 2.0 for gravity dams, 1.6 for embankments.
    pub amplification: f64,
    /// Characteristic period T_g (s) of the site, 0.1 to 2: [`characteristic_period`].
    pub characteristic_period: f64,
    /// Damping ratio for which `amplification` holds, 0 to 0.3.
    pub damping: f64,
}

/// Parameters of the design spectrum of ASCE 7-16 (11.4.6), at 5 % damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Asce7 {
    /// Design acceleration at short periods, S_DS (m/s2), above zero.
    pub short: f64,
    /// Design acceleration at 1 s, S_D1 (m/s2), above zero.
    pub one_second: f64,
    /// Period from which displacement is constant, T_L (s), above `one_second / short`.
    pub long_period: f64,
}

/// Characteristic period (s) of a site class where the zone has a period of 0.35, 0.40 or 0.45 s for class II
/// (GB 18306-2015, table 1).
///
/// # Errors
/// If the zone's period is none of the three.
pub fn characteristic_period(zone: f64, site: ChineseSite) -> Result<f64, WaveError> {
    const PERIODS: [[f64; 5]; 3] = [
        [0.20, 0.25, 0.35, 0.45, 0.65],
        [0.25, 0.30, 0.40, 0.55, 0.75],
        [0.30, 0.35, 0.45, 0.65, 0.90],
    ];
    let row = PERIODS.iter().find(|row| row[2] == zone);
    match row {
        Some(row) => Ok(row[site as usize]),
        None => Err(WaveError::ZonePeriod { given: zone }),
    }
}

impl DesignSpectrum {
    /// Horizontal elastic spectrum of Eurocode 8, from 0 to 4 s.
    ///
    /// # Errors
    /// If a parameter is outside its range.
    pub fn eurocode_8(code: &Eurocode8) -> Result<Self, WaveError> {
        use Eurocode8Ground::{A, B, C, D, E};
        ParameterError::check("peak", code.peak, 1e-6, 1e3)?;
        ParameterError::check("damping", code.damping, 0.0, 0.3)?;
        // Soil factor S and corner periods T_B, T_C, T_D: tables 3.2 and 3.3.
        let (soil, [rise, plateau, long]) = match (code.kind, code.ground) {
            (Eurocode8Type::One, A) => (1.0, [0.15, 0.4, 2.0]),
            (Eurocode8Type::One, B) => (1.2, [0.15, 0.5, 2.0]),
            (Eurocode8Type::One, C) => (1.15, [0.2, 0.6, 2.0]),
            (Eurocode8Type::One, D) => (1.35, [0.2, 0.8, 2.0]),
            (Eurocode8Type::One, E) => (1.4, [0.15, 0.5, 2.0]),
            (Eurocode8Type::Two, A) => (1.0, [0.05, 0.25, 1.2]),
            (Eurocode8Type::Two, B) => (1.35, [0.05, 0.25, 1.2]),
            (Eurocode8Type::Two, C) => (1.5, [0.1, 0.25, 1.2]),
            (Eurocode8Type::Two, D) => (1.8, [0.1, 0.3, 1.2]),
            (Eurocode8Type::Two, E) => (1.6, [0.05, 0.25, 1.2]),
        };
        let correction = (10.0 / (5.0 + 100.0 * code.damping)).sqrt().max(0.55);
        let ground = soil * code.peak;
        let top = 2.5 * correction * ground;
        let name = format!(
            "Eurocode 8, type {}, ground {:?}",
            code.kind as usize + 1,
            code.ground
        );
        Ok(Self::new(name, code.damping)
            .line(rise, ground, top)
            .power(plateau, top, 0.0)
            .falling(long, -1.0)
            .falling(4.0, -2.0))
    }

    /// Standard design spectrum of hydraulic structures of NB 35047-2015, from 0 to 6 s: linear to the plateau at 0.1 s, beyond T_g it
    /// falls with the power 0.6 of the period, to not less than a fifth of the plateau. With an amplification of 2.5 it has the
    /// plateau of GB 18306-2015.
    ///
    /// # Errors
    /// If a parameter is outside its range.
    pub fn nb_35047(code: &Nb35047) -> Result<Self, WaveError> {
        ParameterError::check("peak", code.peak, 1e-6, 1e3)?;
        ParameterError::check("amplification", code.amplification, 1.0, 5.0)?;
        ParameterError::check(
            "characteristic_period",
            code.characteristic_period,
            0.1,
            2.0,
        )?;
        ParameterError::check("damping", code.damping, 0.0, 0.3)?;
        const EXPONENT: f64 = 0.6;
        const LEAST: f64 = 0.2;
        const LAST: f64 = 6.0;
        let top = code.amplification * code.peak;
        let least = code.characteristic_period * LEAST.powf(-1.0 / EXPONENT);
        let spectrum = Self::new("NB 35047-2015".to_string(), code.damping)
            .line(0.1, code.peak, top)
            .power(code.characteristic_period, top, 0.0)
            .falling(least.min(LAST), -EXPONENT);
        Ok(if least < LAST {
            spectrum.power(LAST, LEAST * top, 0.0)
        } else {
            spectrum
        })
    }

    /// Design spectrum of ASCE 7-16, at 5 % damping, from 0 to four times T_L.
    ///
    /// # Errors
    /// If a parameter is outside its range.
    pub fn asce_7(code: &Asce7) -> Result<Self, WaveError> {
        ParameterError::check("short", code.short, 1e-6, 1e3)?;
        ParameterError::check("one_second", code.one_second, 1e-6, 1e3)?;
        let plateau = code.one_second / code.short;
        ParameterError::check("long_period", code.long_period, plateau, 1e3)?;
        Ok(Self::new("ASCE 7-16".to_string(), 0.05)
            .line(0.2 * plateau, 0.4 * code.short, code.short)
            .power(plateau, code.short, 0.0)
            .falling(code.long_period, -1.0)
            .falling(4.0 * code.long_period, -2.0))
    }

    /// Spectrum of a table of periods (s) and accelerations (m/s2), for example of uniform hazard: straight between its
    /// points in logarithmic axes; a point at period zero is joined to the next one by a straight line in linear axes.
    ///
    /// # Errors
    /// If there are fewer than two points, periods do not rise from zero or above, or an acceleration is not above zero.
    pub fn table(name: &str, damping: f64, points: &[(f64, f64)]) -> Result<Self, WaveError> {
        ParameterError::check("damping", damping, 0.0, 0.99)?;
        if points.len() < 2 {
            return Err(WaveError::TooFewSamples {
                operation: "a table of a spectrum",
                given: points.len(),
                least: 2,
            });
        }
        ParameterError::check("period", points[0].0, 0.0, 1e3)?;
        let mut spectrum = Self::new(name.to_string(), damping);
        for &(_, acceleration) in points {
            ParameterError::check("acceleration", acceleration, 1e-9, 1e6)?;
        }
        for pair in points.windows(2) {
            let [(first, from), (last, to)] = [pair[0], pair[1]];
            ParameterError::check("period", last, first * (1.0 + 1e-9) + 1e-9, 1e3)?;
            let shape = if first == 0.0 {
                Shape::Line {
                    first: from,
                    last: to,
                }
            } else {
                Shape::Power {
                    first: from,
                    exponent: (to / from).ln() / (last / first).ln(),
                }
            };
            spectrum.branches.push(Branch { first, last, shape });
        }
        Ok(spectrum)
    }

    /// The spectrum with all ordinates multiplied by a factor above zero.
    ///
    /// # Errors
    /// If the factor is not in (0, 1e6].
    pub fn scaled(mut self, factor: f64) -> Result<Self, WaveError> {
        ParameterError::check("factor", factor, 1e-6, 1e6)?;
        for branch in &mut self.branches {
            match &mut branch.shape {
                Shape::Line { first, last } => {
                    *first *= factor;
                    *last *= factor;
                }
                Shape::Power { first, .. } => *first *= factor,
            }
        }
        Ok(self)
    }

    /// Name of the code or table.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Damping ratio of the oscillators.
    pub fn damping(&self) -> f64 {
        self.damping
    }
    /// First and last period (s) at which the spectrum is defined.
    pub fn periods(&self) -> (f64, f64) {
        let last = self.branches.len() - 1;
        (self.branches[0].first, self.branches[last].last)
    }

    /// Spectral acceleration (m/s2) at a period (s), `None` outside [`DesignSpectrum::periods`].
    pub fn acceleration(&self, period: f64) -> Option<f64> {
        let branch = self
            .branches
            .iter()
            .find(|branch| (branch.first..=branch.last).contains(&period))?;
        Some(branch.acceleration(period))
    }

    fn new(name: String, damping: f64) -> Self {
        Self {
            name,
            damping,
            branches: Vec::new(),
        }
    }
    /// Adds a branch to a period; one without length is left out.
    fn branch(mut self, last: f64, shape: Shape) -> Self {
        let first = self.branches.last().map_or(0.0, |branch| branch.last);
        if last > first {
            self.branches.push(Branch { first, last, shape });
        }
        self
    }
    fn line(self, last: f64, from: f64, to: f64) -> Self {
        self.branch(
            last,
            Shape::Line {
                first: from,
                last: to,
            },
        )
    }
    fn power(self, last: f64, first: f64, exponent: f64) -> Self {
        self.branch(last, Shape::Power { first, exponent })
    }
    /// Goes on from the end of the last branch with a power of the period.
    fn falling(self, last: f64, exponent: f64) -> Self {
        let end = self.branches[self.branches.len() - 1];
        self.power(last, end.acceleration(end.last), exponent)
    }
}

impl Branch {
    fn acceleration(&self, period: f64) -> f64 {
        match self.shape {
            Shape::Line { first, last } => {
                first + (last - first) * (period - self.first) / (self.last - self.first)
            }
            Shape::Power { first, exponent } => first * (period / self.first).powf(exponent),
        }
    }
}
