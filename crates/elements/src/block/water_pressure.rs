//! Pressure of water at rest by height.

use std::sync::Arc;

use powerhouse_model::ParameterError;

/// Pressure of water at rest by height: hydrostatic below a level, or a table.
///
/// ```
/// use powerhouse_elements::WaterPressure;
/// let below = WaterPressure::hydrostatic(-3.0, 9810.0)?;
/// assert_eq!((below.pressure(-5.0), below.pressure(1.0)), (19_620.0, 0.0));
/// // Water that seeps down: less than hydrostatic below 10 m.
/// let seeping = WaterPressure::table(&[[0.0, 0.0], [-10.0, 98_100.0], [-20.0, 150e3]])?;
/// assert_eq!(seeping.pressure(-15.0), 124_050.0);
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct WaterPressure(Profile);

#[derive(Clone, Debug, PartialEq)]
enum Profile {
    /// Height z of the level (m) and weight per volume (N/m3).
    Level([f64; 2]),
    /// Heights z (m) and pressures (Pa), from the top downwards.
    Table(Arc<[[f64; 2]]>),
}

impl WaterPressure {
    /// Hydrostatic pressure below a level at a height z (m), for a weight per volume (N/m3); zero above.
    ///
    /// # Errors
    /// A level that is not finite, or a weight that is not positive.
    pub fn hydrostatic(level: f64, weight: f64) -> Result<Self, ParameterError> {
        ParameterError::check("level", level, -f64::MAX, f64::MAX)?;
        ParameterError::check("weight", weight, f64::MIN_POSITIVE, f64::MAX)?;
        Ok(Self(Profile::Level([level, weight])))
    }
    /// Pressures (Pa, 0 or above) at heights z (m) from the top downwards, with straight lines between; beyond the ends that of the
    /// end.
    ///
    /// # Errors
    /// Fewer than two heights, heights that do not fall, or a pressure below 0.
    pub fn table(points: &[[f64; 2]]) -> Result<Self, ParameterError> {
        ParameterError::check("number of heights", points.len() as f64, 2.0, f64::MAX)?;
        let mut above = f64::MAX;
        for &[height, pressure] in points {
            ParameterError::check("height", height, -f64::MAX, above)?;
            ParameterError::check("pressure", pressure, 0.0, f64::MAX)?;
            above = height.next_down();
        }
        Ok(Self(Profile::Table(points.into())))
    }
    /// Height z of the level (m) below which the pressure is hydrostatic; none of a table.
    pub fn level(&self) -> Option<f64> {
        match &self.0 {
            Profile::Level([level, _]) => Some(*level),
            Profile::Table(_) => None,
        }
    }
    /// Lowest and highest height z (m) for which the pressure is given; any height below and above a level.
    pub fn range(&self) -> [f64; 2] {
        match &self.0 {
            Profile::Level(_) => [f64::NEG_INFINITY, f64::INFINITY],
            Profile::Table(points) => [points[points.len() - 1][0], points[0][0]],
        }
    }
    /// Heights z (m), from the top downwards, at which the slope of the pressure changes.
    pub fn bends(&self) -> Vec<f64> {
        match &self.0 {
            Profile::Level([level, _]) => vec![*level],
            Profile::Table(points) => points.iter().map(|[height, _]| *height).collect(),
        }
    }
    /// Pressure (Pa) at a height z (m).
    pub fn pressure(&self, height: f64) -> f64 {
        match &self.0 {
            Profile::Level([level, weight]) => weight * (level - height).max(0.0),
            Profile::Table(points) => match segment(points, height) {
                Ok([[upper, pressure], _]) => pressure + self.slope(height) * (height - upper),
                Err(end) => end,
            },
        }
    }
    /// Increase of the pressure per height z (Pa/m) at a height (m), at a bend that below it.
    pub fn slope(&self, height: f64) -> f64 {
        match &self.0 {
            Profile::Level([level, weight]) if height <= *level => -weight,
            Profile::Level(_) => 0.0,
            Profile::Table(points) => match segment(points, height) {
                Ok([[upper, above], [lower, below]]) => (above - below) / (upper - lower),
                Err(_) => 0.0,
            },
        }
    }
}

/// The two points of a table around a height, or the pressure of the end beyond which it is.
fn segment(points: &[[f64; 2]], height: f64) -> Result<[[f64; 2]; 2], f64> {
    let below = points.partition_point(|[of_point, _]| *of_point >= height);
    match below {
        0 => Err(points[0][1]),
        _ if below == points.len() => Err(points[below - 1][1]),
        _ => Ok([points[below - 1], points[below]]),
    }
}
