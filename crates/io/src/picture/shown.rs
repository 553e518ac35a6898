//! Units, numbers and colour ranges of pictures.

/// Units of files and those of pictures, with the number of the second in one of the first.
const UNITS: [(&str, &str, f64); 3] = [("Pa", "MPa", 1e-6), ("m", "mm", 1e3), ("1", "", 1.0)];
/// Share of the numbers of a field that its colours span, where the greatest is a spike.
const SPANNED: f64 = 0.995;
/// Greatest number over that at the end of the colours from which on it is a spike.
const SPIKE: f64 = 2.0;

/// Unit in which pictures have a quantity of a unit of files (MPa for Pa, mm for m), and the factor between them.
pub fn shown_unit(unit: &str) -> (&str, f64) {
    let known = UNITS.iter().find(|(of_files, ..)| *of_files == unit);
    known.map_or((unit, 1.0), |(_, shown, factor)| (*shown, *factor))
}

/// A number with four digits.
pub fn shown_number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if (1e-2..1e5).contains(&size) => {
            let digits = (3 - size.log10().floor() as i32).max(0) as usize;
            format!("{value:.digits$}")
        }
        _ => format!("{value:.3e}"),
    }
}

/// Ends of the colours of a field with a spike at one end, which they leave out; `None` without a spike.
pub fn colour_range(values: &[f64]) -> Option<[f64; 2]> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let (least, most) = (*sorted.first()?, *sorted.last()?);
    let beyond = ((1.0 - SPANNED) * sorted.len() as f64) as usize;
    let (lower, upper) = (sorted[beyond], sorted[sorted.len() - 1 - beyond]);
    let is_high = upper > 0.0 && most > SPIKE * upper;
    let is_low = lower < 0.0 && least < SPIKE * lower;
    (is_high || is_low).then_some([
        if is_low { lower } else { least },
        if is_high { upper } else { most },
    ])
}
