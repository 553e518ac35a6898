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
    drawn.finish()
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

/// Path in steps of tenths of a pixel, each relative to the point before: half as long as with their positions.
#[derive(Default)]
struct Drawn {
    text: String,
    /// Last point that is written, and a further one on a level line from it, in tenths of a pixel.
    last: [i64; 2],
    level: Option<[i64; 2]>,
}

impl Drawn {
    fn point(&mut self, (x, y): (f64, f64)) {
        let point = [x, y].map(|of| (10.0 * of).round() as i64);
        if self.text.is_empty() {
            self.text.push('M');
            self.number(point[0], true);
            self.number(point[1], false);
            self.text.push('l');
            self.last = point;
            return;
        }
        let from = self.level.unwrap_or(self.last);
        let is_on = |level: i64| point[1] == level && point[0] >= from[0];
        if is_on(self.last[1]) && (self.level.is_none() || is_on(from[1])) {
            self.level = Some(point);
            return;
        }
        self.end_level();
        self.line_to(point);
    }

    /// Writes the end of a level line.
    fn end_level(&mut self) {
        if let Some(end) = self.level.take() {
            self.line_to(end);
        }
    }

    fn line_to(&mut self, point: [i64; 2]) {
        for (axis, to) in point.into_iter().enumerate() {
            let is_first = axis == 0 && self.text.ends_with('l');
            self.number(to - self.last[axis], is_first);
        }
        self.last = point;
    }

    /// A number of tenths, with a blank before it where it needs one.
    fn number(&mut self, tenths: i64, is_first: bool) {
        if tenths >= 0 && !is_first {
            self.text.push(' ');
        }
        let sign = if tenths < 0 { "-" } else { "" };
        let (whole, part) = (tenths.abs() / 10, tenths.abs() % 10);
        let _ = match (whole, part) {
            (_, 0) => write!(self.text, "{sign}{whole}"),
            (0, _) => write!(self.text, "{sign}.{part}"),
            _ => write!(self.text, "{sign}{whole}.{part}"),
        };
    }

    /// The path, with the end of its last line.
    fn finish(mut self) -> String {
        self.end_level();
        // A single point has no steps.
        if self.text.ends_with('l') {
            self.text.push_str("0 0");
        }
        self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a path (pixels).
    fn points(path: &str) -> Vec<[f64; 2]> {
        let (start, steps) = path.strip_prefix('M').unwrap().split_once('l').unwrap();
        let numbers = |text: &str| -> Vec<f64> {
            let apart = text.replace('-', " -");
            let words = apart.split_whitespace();
            words.map(|number| number.parse().unwrap()).collect()
        };
        let mut at = <[f64; 2]>::try_from(numbers(start)).unwrap();
        let mut all = vec![at];
        for step in numbers(steps).chunks(2) {
            at = [at[0] + step[0], at[1] + step[1]].map(|of| (10.0 * of).round() / 10.0);
            all.push(at);
        }
        all
    }

    /// A path of any number of points is short and includes the greatest value.
    #[test]
    fn a_long_curve_keeps_its_peak() {
        let count = 100_000;
        let curve = (0..count).map(|i| {
            let y = if i == 77_777 {
                -5.3
            } else {
                100.0 + (i % 7) as f64
            };
            (800.0 * i as f64 / count as f64, y)
        });
        let drawn = points(&path(curve));
        let peak = drawn.iter().find(|[_, y]| *y == -5.3).unwrap();
        assert!((peak[0] - 800.0 * 0.77777).abs() <= 0.05);
        assert!(drawn.len() < 4 * 1601);
    }

    /// A curve with decreasing horizontal positions, and one with few points, are drawn point by point, to a tenth of a pixel.
    #[test]
    fn a_curve_that_turns_back_is_kept() {
        let turning = [(0.0, 1.0), (0.1, 2.0), (0.05, 3.0), (0.0, 4.0)];
        assert_eq!(
            points(&path(turning.into_iter())),
            [[0.0, 1.0], [0.1, 2.0], [0.1, 3.0], [0.0, 4.0]]
        );
        let few = [(0.0, 1.0), (1.0, 2.0), (2.0, 1.5)];
        assert_eq!(path(few.into_iter()), "M0 1l1 1 1-.5");
        assert_eq!(path([(3.0, -0.24)].into_iter()), "M3-.2l0 0");
    }

    /// Level lines are drawn from end to end, and only where they go on in their direction.
    #[test]
    fn level_lines_have_two_points() {
        let level = (0..1000).map(|i| (f64::from(i), if i == 500 { 7.0 } else { 4.0 }));
        assert_eq!(path(level), "M0 4l499 0 1 3 1-3 498 0");
        let back = [(0.0, 4.0), (5.0, 4.0), (2.0, 4.0), (2.0, 8.0)];
        assert_eq!(path(back.into_iter()), "M0 4l5 0-3 0 0 4");
        assert_eq!(path(std::iter::empty()), "");
    }
}
