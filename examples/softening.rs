//! A bar with softening in one element, for examples of concrete.

use powerhouse::material::{Control, PointDriver};
use powerhouse::model::ConstitutiveLaw;

use crate::Outcome;

/// Dissipated energy over `energy x area` of a bar of 1 m2 section, divided into elements of which one is weaker.
///
/// A strain path along the bar is applied to the weak element; the other, equal elements follow its stress. The bar has a
/// length (m) and a number of elements; energy (N/m) and strength (Pa, negative for compression) are those of the law.
///
/// # Errors
/// An element size that is invalid for the law, or a path without a solution.
pub fn dissipated<M: ConstitutiveLaw>(
    weak: M,
    strong: M,
    (length, count): (f64, usize),
    (energy, strength): (f64, f64),
) -> Outcome<f64> {
    const STEPS: usize = 1500;
    let size = length / count as f64;
    weak.accept_size(size)?;
    let young = weak.medium().young;
    // Up to four times the final opening of a linearly softening crack.
    let opening = 8.0 * energy / (strength.abs() * size) * strength.signum();
    let mut breaking = PointDriver::new(weak).with_size(size)?;
    let mut others = PointDriver::new(strong).with_size(size)?;
    // Up to the peak in fine steps.
    let first = strength / young;
    let mut ends: Vec<f64> = (1..=20).map(|k| 0.05 * f64::from(k) * first).collect();
    ends.extend((1..=STEPS).map(|k| first + (opening * k as f64) / STEPS as f64));
    for end in ends {
        let stress = breaking.advance(Control::uniaxial(end), 1)?[0].stress.0[2];
        let mut target = Control::uniaxial(0.0);
        target[2] = Control::Stress(stress);
        others.advance(target, 1)?;
    }
    let work = breaking.state().work + (count - 1) as f64 * others.state().work;
    // The elastic energy of the remaining stress is recoverable.
    let stress = breaking.state().stress.0[2];
    let held = 0.5 * stress * stress / young * count as f64;
    Ok((work - held) * size / energy)
}
