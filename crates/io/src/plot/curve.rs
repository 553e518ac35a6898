//! Curve as an SVG path.

use std::fmt::Write as _;

/// SVG path of points (pixels), whether or not their horizontal positions rise.
pub(super) fn path(points: impl Iterator<Item = (f64, f64)> + Clone) -> String {
    let rising = points
        .clone()
        .zip(points.clone().skip(1))
        .all(|(a, b)| a.0 <= b.0);
    let mut drawn = Drawn::default();
    if rising {
        let mut column: Option<Column> = None;
        for point in points {
            match &mut column {
                Some(column) if column.holds(point) => column.add(point),
                _ => {
                    if let Some(done) = column.replace(Column::new(point)) {
                        done.draw(&mut drawn);
                    }
                }
            }
        }
        if let Some(done) = column {
            done.draw(&mut drawn);
        }
    } else {
        points.for_each(|point| drawn.point(point));
    }
    drawn.text
}

/// Points within half a pixel: the first and the last, the least and the greatest.
struct Column {
    half_pixel: f64,
    points: [(usize, (f64, f64)); 4],
    count: usize,
}

impl Column {
    fn new(point: (f64, f64)) -> Self {
        Self {
            half_pixel: half_pixel(point),
            points: [(0, point); 4],
            count: 1,
        }
    }
    fn holds(&self, point: (f64, f64)) -> bool {
        half_pixel(point) == self.half_pixel
    }
    fn add(&mut self, point: (f64, f64)) {
        let [_, least, greatest, last] = &mut self.points;
        let entry = (self.count, point);
        if point.1 < least.1.1 {
            *least = entry;
        }
        if point.1 > greatest.1.1 {
            *greatest = entry;
        }
        *last = entry;
        self.count += 1;
    }
    fn draw(mut self, drawn: &mut Drawn) {
        self.points.sort_by_key(|&(order, _)| order);
        let mut before = None;
        for (order, point) in self.points {
            if before.replace(order) != Some(order) {
                drawn.point(point);
            }
        }
    }
}

fn half_pixel(point: (f64, f64)) -> f64 {
    (2.0 * point.0).floor()
}

#[derive(Default)]
struct Drawn {
    text: String,
}

impl Drawn {
    fn point(&mut self, (x, y): (f64, f64)) {
        let letter = if self.text.is_empty() { "M" } else { " " };
        let _ = write!(self.text, "{letter}{x:.1} {y:.1}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A path of any number of points is short and includes the greatest value.
    #[test]
    fn a_long_curve_keeps_its_peak() {
        let count = 100_000;
        let points = (0..count).map(|i| {
            let y = if i == 77_777 {
                -5.25
            } else {
                100.0 + (i % 7) as f64
            };
            (800.0 * i as f64 / count as f64, y)
        });
        let path = path(points);
        assert!(path.split_whitespace().any(|number| number == "-5.2"));
        assert!(path.split_whitespace().count() < 2 * 4 * 1601);
    }

    /// A curve with decreasing horizontal positions, and one with few points, are drawn point by point.
    #[test]
    fn a_curve_that_turns_back_is_kept() {
        let points = [(0.0, 1.0), (0.1, 2.0), (0.05, 3.0), (0.0, 4.0)];
        assert_eq!(path(points.into_iter()), "M0.0 1.0 0.1 2.0 0.1 3.0 0.0 4.0");
        let few = [(0.0, 1.0), (1.0, 2.0), (2.0, 1.5)];
        assert_eq!(path(few.into_iter()), "M0.0 1.0 1.0 2.0 2.0 1.5");
    }
}
