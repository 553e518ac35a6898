//! Shear modulus and damping of soils against the amplitude of cyclic shear strain.

use powerhouse_model::ParameterError;

/// Curves of the secant shear modulus and the damping ratio of a soil against the amplitude of its cyclic shear strain, for the
/// equivalent linear method.
///
/// Between the given strains values are interpolated against the logarithm of the strain; below the first and above the last
/// they are those of the first and last.
///
/// ```
/// use powerhouse_material_damage::StrainCurves;
/// let curves = StrainCurves::new(vec![1e-6, 1e-4, 1e-2], vec![1.0, 0.8, 0.2], vec![0.01, 0.03, 0.15])?;
/// assert!((curves.modulus(1e-3) - 0.5).abs() < 1e-12);
/// assert_eq!(curves.damping(1e-9), 0.01);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct StrainCurves {
    /// Amplitudes of the engineering shear strain (1), rising.
    strain: Vec<f64>,
    /// Secant shear modulus over that at small strain (1).
    modulus: Vec<f64>,
    /// Damping ratio (1).
    damping: Vec<f64>,
}

/// State of a soil from which the curves of Darendeli (2001) follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DarendeliSoil {
    /// Plasticity index (percent), 0 to 200.
    pub plasticity: f64,
    /// Overconsolidation ratio (1), 1 to 50.
    pub overconsolidation: f64,
    /// Mean effective confining pressure (Pa), 1 kPa to 10 MPa.
    pub pressure: f64,
    /// Frequency of the cycles (Hz), 0.1 to 100.
    pub frequency: f64,
    /// Number of cycles, 1 to 1000.
    pub cycles: f64,
}

impl DarendeliSoil {
    /// A soil of a plasticity index (percent) under a mean effective pressure (Pa): normally consolidated, ten cycles of 1 Hz.
    pub fn new(plasticity: f64, pressure: f64) -> Self {
        Self {
            plasticity,
            overconsolidation: 1.0,
            pressure,
            frequency: 1.0,
            cycles: 10.0,
        }
    }
}

/// Greatest shear strain of curves (1): numbers beyond are of per cent.
const GREATEST: f64 = 0.2;
/// Pressure of one atmosphere (Pa), to which the pressures of Darendeli refer.
const ATMOSPHERE: f64 = 101_325.0;
/// Range of shear strains that the curves of Darendeli cover (1).
const COVERED: [f64; 2] = [1e-6, 1e-2];
/// Strains in a decade of these curves.
const PER_DECADE: usize = 8;

impl StrainCurves {
    /// Curves by amplitudes of the engineering shear strain (1), rising from above 0 to 0.2 at most, with the secant modulus over
    /// that at small strain, 0.001 to 1 and not rising, and the damping ratio, from 0 to below 1, at each.
    ///
    /// # Errors
    /// Lists that are empty or of unequal length (named after their numbers of values); a value outside its range.
    pub fn new(
        strain: Vec<f64>,
        modulus: Vec<f64>,
        damping: Vec<f64>,
    ) -> Result<Self, ParameterError> {
        let count = strain.len() as f64;
        let lengths = [modulus.len() as f64, damping.len() as f64];
        ParameterError::check("number of values of strain", count, 1.0, 1e4)?;
        ParameterError::check("number of values of modulus", lengths[0], count, count)?;
        ParameterError::check(
            "number of values of damping_ratio",
            lengths[1],
            count,
            count,
        )?;
        let mut least = f64::MIN_POSITIVE;
        for &value in &strain {
            ParameterError::check("strain, which rises,", value, least, GREATEST)?;
            least = value.next_up();
        }
        let mut most = 1.0;
        for &value in &modulus {
            ParameterError::check("modulus, which does not rise,", value, 1e-3, most)?;
            most = value;
        }
        for &value in &damping {
            ParameterError::check("damping_ratio", value, 0.0, 0.99)?;
        }
        Ok(Self {
            strain,
            modulus,
            damping,
        })
    }

    /// Curves of Darendeli (2001), "Development of a new family of normalized modulus reduction and material damping
    /// curves", dissertation, University of Texas at Austin, chapter 9: mean values, strains from 1e-6 to 1e-2.
    ///
    /// ```
    /// use powerhouse_material_damage::{DarendeliSoil, StrainCurves};
    /// let sand = StrainCurves::darendeli(&DarendeliSoil::new(0.0, 101_325.0))?;
    /// // Its reference strain is 0.0352 %, where half of the modulus is left.
    /// assert!((sand.modulus(3.52e-4) - 0.5).abs() < 2e-3);
    /// # Ok::<(), powerhouse_model::ParameterError>(())
    /// ```
    ///
    /// # Errors
    /// A value of the soil outside its range.
    pub fn darendeli(soil: &DarendeliSoil) -> Result<Self, ParameterError> {
        ParameterError::check("plasticity", soil.plasticity, 0.0, 200.0)?;
        ParameterError::check("overconsolidation", soil.overconsolidation, 1.0, 50.0)?;
        ParameterError::check("pressure", soil.pressure, 1e3, 1e7)?;
        ParameterError::check("frequency", soil.frequency, 0.1, 100.0)?;
        ParameterError::check("cycles", soil.cycles, 1.0, 1000.0)?;
        let pressure = soil.pressure / ATMOSPHERE;
        let (plasticity, history) = (soil.plasticity, soil.overconsolidation);
        // In percent, as there.
        let reference =
            (0.0352 + 0.0010 * plasticity * history.powf(0.3246)) * pressure.powf(0.3483);
        let curvature: f64 = 0.9190;
        let small = (0.8005 + 0.0129 * plasticity * history.powf(-0.1069))
            * pressure.powf(-0.2889)
            * (1.0 + 0.2919 * soil.frequency.ln());
        let scale = 0.6329 - 0.0057 * soil.cycles.ln();
        let square = curvature * curvature;
        let factors = [
            -1.1143 * square + 1.8618 * curvature + 0.2523,
            0.0805 * square - 0.0710 * curvature - 0.0095,
            -0.0005 * square + 0.0002 * curvature + 0.0003,
        ];
        let decades = (COVERED[1] / COVERED[0]).log10();
        let count = (decades * PER_DECADE as f64).round() as usize;
        let (mut strain, mut modulus, mut damping) = (Vec::new(), Vec::new(), Vec::new());
        for index in 0..=count {
            let at = COVERED[0] * 10f64.powf(index as f64 / PER_DECADE as f64);
            let percent = 100.0 * at;
            let left = 1.0 / (1.0 + (percent / reference).powf(curvature));
            let ratio = percent / reference;
            // Damping of a Masing loop of the hyperbola with curvature 1 (percent), then of this curvature.
            let loss = 4.0 * (ratio - ratio.ln_1p()) * (1.0 + ratio) / (ratio * ratio) - 2.0;
            let masing = 100.0 / std::f64::consts::PI * loss;
            let [first, second, third] = factors;
            let of_curvature = masing * (first + masing * (second + masing * third));
            strain.push(at);
            modulus.push(left);
            damping.push(0.01 * (scale * left.powf(0.1) * of_curvature + small).max(0.0));
        }
        Self::new(strain, modulus, damping)
    }

    /// Secant shear modulus over that at small strain (1) at an amplitude of the engineering shear strain (1).
    pub fn modulus(&self, strain: f64) -> f64 {
        self.interpolate(&self.modulus, strain)
    }

    /// Damping ratio (1) at an amplitude of the engineering shear strain (1).
    pub fn damping(&self, strain: f64) -> f64 {
        self.interpolate(&self.damping, strain)
    }

    /// Greatest strain (1) of the curves.
    pub fn greatest_strain(&self) -> f64 {
        self.strain[self.strain.len() - 1]
    }

    fn interpolate(&self, values: &[f64], strain: f64) -> f64 {
        let above = self.strain.partition_point(|&of| of <= strain);
        let Some(below) = above.checked_sub(1) else {
            return values[0];
        };
        if above == values.len() {
            return values[below];
        }
        let [from, to] = [self.strain[below], self.strain[above]];
        let share = (strain / from).ln() / (to / from).ln();
        values[below] + share * (values[above] - values[below])
    }
}
