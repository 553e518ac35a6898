//! A bar that softens in one element, for examples of concrete.

use powerhouse::material::{Control, PointDriver};
use powerhouse::model::ConstitutiveLaw;

use crate::Outcome;

/// Dissipated energy over `energy x area` of a bar (1 m2 across) in `count` elements, of which one
/// is weaker. The weak element is led to a strain along the bar; the others, all alike, follow its
/// stress. The bar has a length (m) and a number of elements; energy (N/m) and strength (Pa, negative for
/// pressing) are those of the law.
///
/// # Errors
/// Elements that the law refuses for their size, or a path that it cannot follow.
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
    // As far as a crack that softened linearly would open four times.
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
    // What is left of the stress would be given back.
    let stress = breaking.state().stress.0[2];
    let held = 0.5 * stress * stress / young * count as f64;
    Ok((work - held) * size / energy)
}
