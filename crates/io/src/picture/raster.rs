//! Rasterisation of triangles and lines with a depth buffer.

use super::colour::{Rgb, mixed};

/// Corner of a triangle or end of a line: pixels to the right and down, depth away from the
/// viewer, and a value that is interpolated.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) depth: f64,
    pub(super) value: f64,
}

pub(super) struct Raster {
    width: usize,
    height: usize,
    pixels: Vec<Rgb>,
    depth: Vec<f32>,
}

impl Raster {
    pub(super) fn new(width: usize, height: usize, background: Rgb) -> Self {
        Self {
            width,
            height,
            pixels: vec![background; width * height],
            depth: vec![f32::INFINITY; width * height],
        }
    }

    /// Fills the pixels whose centre is in a triangle and which nothing nearer covers.
    pub(super) fn triangle(&mut self, corners: [Point; 3], colour: impl Fn(f64) -> Rgb) {
        let [a, b, c] = corners;
        let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if area.abs() < 1e-12 {
            return;
        }
        let least = |f: fn(&Point) -> f64| corners.iter().map(f).fold(f64::INFINITY, f64::min);
        let most = |f: fn(&Point) -> f64| corners.iter().map(f).fold(f64::NEG_INFINITY, f64::max);
        let columns = span(least(|p| p.x), most(|p| p.x), self.width);
        // Shares of the corners b and c, linear in both coordinates.
        let along = [(c.y - a.y) / area, -(b.y - a.y) / area];
        let down = [-(c.x - a.x) / area, (b.x - a.x) / area];
        for row in span(least(|p| p.y), most(|p| p.y), self.height) {
            let y = row as f64 + 0.5;
            let at_left = [0, 1].map(|i| (y - a.y) * down[i] - a.x * along[i]);
            let edges = [
                (1.0 - at_left[0] - at_left[1], -along[0] - along[1]),
                (at_left[0], along[0]),
                (at_left[1], along[1]),
            ];
            for column in inside(edges, columns.clone()) {
                let x = column as f64 + 0.5;
                let [of_b, of_c] = [0, 1].map(|i| at_left[i] + x * along[i]);
                let of_a = 1.0 - of_b - of_c;
                let depth = of_a * a.depth + of_b * b.depth + of_c * c.depth;
                let index = row * self.width + column;
                if (depth as f32) < self.depth[index] {
                    self.depth[index] = depth as f32;
                    let value = of_a * a.value + of_b * b.value + of_c * c.value;
                    self.pixels[index] = colour(value);
                }
            }
        }
    }

    /// Draws a line over what is not nearer, blended by `strength`.
    pub(super) fn line(&mut self, ends: [Point; 2], strength: f64, colour: impl Fn(f64) -> Rgb) {
        let [a, b] = ends;
        let length = (b.x - a.x).abs().max((b.y - a.y).abs());
        let count = length.ceil().max(1.0) as usize;
        for i in 0..=count {
            let share = i as f64 / count as f64;
            let at = |from: f64, to: f64| from + share * (to - from);
            let (x, y) = (at(a.x, b.x), at(a.y, b.y));
            if x < 0.0 || y < 0.0 || x >= self.width as f64 || y >= self.height as f64 {
                continue;
            }
            let index = y as usize * self.width + x as usize;
            if at(a.depth, b.depth) as f32 <= self.depth[index] {
                let colour = colour(at(a.value, b.value));
                self.pixels[index] = mixed(self.pixels[index], colour, strength);
            }
        }
    }

    /// Picture at a lower resolution: the mean of squares of `factor` pixels a side.
    pub(super) fn reduced(&self, factor: usize) -> Vec<Rgb> {
        let (width, height) = (self.width / factor, self.height / factor);
        let mut out = Vec::with_capacity(width * height);
        for row in 0..height {
            for column in 0..width {
                let mut sum = [0_u32; 3];
                for y in 0..factor {
                    let start = (row * factor + y) * self.width + column * factor;
                    for pixel in &self.pixels[start..start + factor] {
                        for (sum, &part) in sum.iter_mut().zip(pixel) {
                            *sum += u32::from(part);
                        }
                    }
                }
                let count = (factor * factor) as u32;
                out.push(sum.map(|sum| ((sum + count / 2) / count) as u8));
            }
        }
        out
    }
}

/// Columns of some range at whose centres three shares are not negative, each with its value at the left edge and its
/// slope.
fn inside(shares: [(f64, f64); 3], columns: core::ops::Range<usize>) -> core::ops::Range<usize> {
    /// Least share of a corner that counts as none: neighbours leave no gap.
    const LEAST: f64 = -1e-9;
    let (mut low, mut high) = (columns.start as f64, columns.end as f64);
    for (value, slope) in shares {
        let reached = (LEAST - value) / slope - 0.5;
        if slope > 0.0 {
            low = low.max(reached.ceil());
        } else if slope < 0.0 {
            high = high.min(reached.floor() + 1.0);
        } else if value < LEAST {
            return 0..0;
        }
    }
    low as usize..(high.max(low) as usize)
}

/// Pixels whose centre may be between two positions.
fn span(low: f64, high: f64, size: usize) -> core::ops::Range<usize> {
    let from = (low - 0.5).ceil().max(0.0) as usize;
    let to = ((high - 0.5).floor() + 1.0).clamp(0.0, size as f64) as usize;
    from.min(to)..to
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(raster: &mut Raster, depth: f64, colour: Rgb) {
        let corner = |x: f64, y: f64| Point {
            x,
            y,
            depth,
            value: 0.0,
        };
        let corners = [
            corner(1.0, 1.0),
            corner(3.0, 1.0),
            corner(3.0, 3.0),
            corner(1.0, 3.0),
        ];
        raster.triangle([corners[0], corners[1], corners[2]], |_| colour);
        raster.triangle([corners[0], corners[2], corners[3]], |_| colour);
    }

    /// Two triangles fill a square without a gap, and the nearer of two squares is visible in either
    /// order of drawing.
    #[test]
    fn the_nearer_is_seen() {
        let (near, far, ground) = ([1, 1, 1], [2, 2, 2], [0, 0, 0]);
        for order in [[(1.0, near), (2.0, far)], [(2.0, far), (1.0, near)]] {
            let mut raster = Raster::new(4, 4, ground);
            for (depth, colour) in order {
                square(&mut raster, depth, colour);
            }
            for (index, &pixel) in raster.pixels.iter().enumerate() {
                let inside = [index / 4, index % 4].iter().all(|i| (1..3).contains(i));
                assert_eq!(pixel, if inside { near } else { ground });
            }
        }
    }

    /// Triangles outside of the picture change nothing in it.
    #[test]
    fn what_is_outside_is_left_out() {
        let mut raster = Raster::new(4, 4, [9; 3]);
        let corner = |x: f64, y: f64| Point {
            x,
            y,
            depth: 0.0,
            value: 0.0,
        };
        raster.triangle(
            [corner(-9.0, -9.0), corner(-1.0, -9.0), corner(-9.0, 1e9)],
            |_| [0; 3],
        );
        raster.line([corner(-5.0, -5.0), corner(-1.0, 9.0)], 1.0, |_| [0; 3]);
        assert!(raster.pixels.iter().all(|&pixel| pixel == [9; 3]));
    }
}
