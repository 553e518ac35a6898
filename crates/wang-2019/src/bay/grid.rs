//! Node positions of the grid.

use powerhouse::model::Vec3;

use super::Bay;
use super::dimensions::{BayDimensions, Levels, arch_radius};
use super::plan::{Layer, Plan, Row};
use super::spacing::{positions, relaxed, smooth_step};

/// Columns keep their positions up to this distance above the crowns and below the main powerhouse (m).
const STRAIGHT: f64 = 6.0;
/// Distance from the main powerhouse (m) beyond which layers are equal.
const LAYERS_EVEN: f64 = 8.0;
/// Share of the lower rows that is shaped as an octagon.
const OCTAGON_BELOW: f64 = 0.5;

/// Heights of the lines that bound the rows above the main powerhouse's generator floor (m).
#[derive(Clone, Copy, Debug)]
struct Roof {
    extrados: f64,
    intrados: f64,
}

/// The nodes of the grid.
pub(super) struct Grid<'a> {
    plan: &'a Plan,
    dimensions: &'a BayDimensions,
    levels: Levels,
    roofs: Vec<Roof>,
    /// Positions of the columns with smoothed spacings (m).
    even_x: Vec<f64>,
    /// Positions of equal layers (m).
    even_y: Vec<f64>,
    /// Heights of the rows with smoothed spacings at the left and the right side (m).
    even_z: [Vec<f64>; 2],
}

impl<'a> Grid<'a> {
    pub(super) fn new(bay: &'a Bay, plan: &'a Plan) -> Self {
        let dimensions = &bay.dimensions;
        let levels = dimensions.levels();
        let roofs: Vec<Roof> = plan.x.iter().map(|&x| roof(dimensions, x)).collect();
        let longest = bay.cells.longest;
        let steps =
            |at: &[f64]| -> Vec<f64> { at.windows(2).map(|pair| pair[1] - pair[0]).collect() };
        let last = plan.x.len() - 1;
        let even_x = positions(plan.x[0], &relaxed(&steps(&plan.x), longest), plan.x[last]);
        let mut grid = Self {
            plan,
            dimensions,
            levels,
            roofs,
            even_x,
            even_y: even_layers(plan, dimensions.length),
            even_z: [Vec::new(), Vec::new()],
        };
        grid.even_z = [0, last].map(|column| {
            let heights: Vec<f64> = (0..=plan.rows.len())
                .map(|k| grid.height(column, k))
                .collect();
            let eased = relaxed(&steps(&heights), longest);
            positions(heights[0], &eased, 0.0)
        });
        grid
    }

    /// The node on line `i` of columns, `j` of layers and `k` of rows (m).
    pub(super) fn node(&self, i: usize, j: usize, k: usize) -> Vec3 {
        let (plan, dimensions) = (self.plan, self.dimensions);
        let x = plan.x[i];
        let z = self.eased_height(i, k);
        let half = 0.5 * dimensions.main_width;
        let levels = &self.levels;
        // Columns: as planned around the caverns, smoothed at the surface and at the bottom.
        let up = (z - levels.crown - STRAIGHT) / (dimensions.cover - STRAIGHT);
        let down = (levels.base[1] - STRAIGHT - z) / (dimensions.below - STRAIGHT);
        let even = smooth_step(up.max(down));
        let column = x + even * (self.even_x[i] - x);
        // Layers: as planned at the main powerhouse, equal around it.
        let beside = (x.abs() - half).max(0.0);
        let over = (z - levels.crown).max(levels.base[1] - z).max(0.0);
        let even = smooth_step(beside.hypot(over) / LAYERS_EVEN);
        let layer = plan.y[j] + even * (self.even_y[j] - plan.y[j]);
        let [dx, dy] = self.octagon(i, j, k);
        Vec3::new(column - dx, layer - dy, z)
    }

    /// The height of a row's line at a column (m), before smoothing.
    fn height(&self, i: usize, k: usize) -> f64 {
        let band = self.plan.rows[k.saturating_sub(1)];
        let [low, high] = self.horizons(i, band);
        match self.plan.shares[k] {
            1.0 => high,
            share => low + share * (high - low),
        }
    }

    /// The height of a row's line at a column (m), smoothed towards the sides.
    fn eased_height(&self, i: usize, k: usize) -> f64 {
        let (x, z) = (self.plan.x[i], self.height(i, k));
        let dimensions = self.dimensions;
        let left = -0.5 * dimensions.main_width - x;
        let right = x - dimensions.transformer_axis() - 0.5 * dimensions.transformer_width;
        let (distance, side) = if left > right { (left, 0) } else { (right, 1) };
        let even = smooth_step(distance / dimensions.side);
        z + even * (self.even_z[side][k] - z)
    }

    /// The horizons below and above a band of rows at a column (m).
    fn horizons(&self, i: usize, band: Row) -> [f64; 2] {
        let (levels, roof) = (&self.levels, self.roofs[i]);
        match band {
            Row::Below => [levels.model_bottom, levels.base[1]],
            Row::Base => [levels.base[1], levels.base[0]],
            Row::Mass => [levels.base[0], levels.turbine[1]],
            Row::TurbineFloor => [levels.turbine[1], levels.turbine[0]],
            Row::TurbineStorey => [levels.turbine[0], levels.busbar[1]],
            Row::BusbarFloor => [levels.busbar[1], levels.busbar[0]],
            Row::GeneratorStorey => [levels.busbar[0], levels.generator[1]],
            Row::GeneratorFloor => [levels.generator[1], levels.generator[0]],
            Row::Hall => [levels.generator[0], roof.intrados],
            Row::Arch => [roof.intrados, roof.extrados],
            Row::Above => [roof.extrados, 0.0],
        }
    }

    /// Shift of a node towards the axis of the machine along x and y (m) that turns the square loops of pit, pier and
    /// windshield into octagons.
    fn octagon(&self, i: usize, j: usize, k: usize) -> [f64; 2] {
        let dimensions = self.dimensions;
        let radius = dimensions.ring_radius;
        let x = self.plan.x[i];
        let y = self.plan.y[j] - 0.5 * dimensions.length;
        let wall = 0.5 * dimensions.main_width - dimensions.wall_lining;
        let fade = |distance: f64, end: f64| ((end - distance) / (end - radius)).clamp(0.0, 1.0);
        let near = fade(x.abs(), wall) * fade(y.abs(), 0.5 * dimensions.length);
        let shift = (1.0 - core::f64::consts::FRAC_1_SQRT_2) * x.abs().min(y.abs()).min(radius);
        let shift = shift * near * self.octagon_share(k);
        // On the axes the shift is zero, whatever the sign of zero is.
        [x.signum() * shift, y.signum() * shift]
    }

    /// Share of the octagonal shift that a line of rows receives, from 0 to 1.
    fn octagon_share(&self, k: usize) -> f64 {
        let share = self.plan.shares[k];
        match self.plan.rows[k.saturating_sub(1)] {
            Row::Below => {
                let lines = self
                    .plan
                    .rows
                    .iter()
                    .filter(|row| **row == Row::Below)
                    .count() as f64;
                let above_bottom = k as f64 / lines;
                ((above_bottom - OCTAGON_BELOW) / (1.0 - OCTAGON_BELOW)).max(0.0)
            }
            Row::Hall => 1.0 - share,
            Row::Arch | Row::Above => 0.0,
            _ => 1.0,
        }
    }
}

/// Positions of layers of equal thickness within the bay, unchanged beyond its ends.
fn even_layers(plan: &Plan, length: f64) -> Vec<f64> {
    let within = |layer: &Layer| matches!(layer, Layer::Bay(_));
    let before = plan.layers.iter().position(within).unwrap_or(0);
    let count = plan.layers.iter().filter(|layer| within(layer)).count();
    let position = |(j, &y): (usize, &f64)| match j.checked_sub(before) {
        Some(line) if line <= count => length * line as f64 / count as f64,
        _ => y,
    };
    plan.y.iter().enumerate().map(position).collect()
}

/// The roof at a position across the halls (m): the arch within a cavern, a straight line between both.
fn roof(dimensions: &BayDimensions, x: f64) -> Roof {
    let main = Arch::of(dimensions, dimensions.main_width);
    let transformer = Arch::of(dimensions, dimensions.transformer_width);
    let axis = dimensions.transformer_axis();
    let (from_main, from_transformer) = (x - main.half, axis - transformer.half - x);
    if from_main <= 0.0 {
        return main.at(x);
    }
    if from_transformer <= 0.0 {
        return transformer.at(x - axis);
    }
    let (a, b) = (main.at(main.half), transformer.at(transformer.half));
    let share = from_main / (from_main + from_transformer);
    Roof {
        extrados: a.extrados + share * (b.extrados - a.extrados),
        intrados: a.intrados + share * (b.intrados - a.intrados),
    }
}

/// The arch of a cavern: two concentric arcs.
struct Arch {
    /// Half the span of the excavation (m).
    half: f64,
    /// Half the width between the walls' inner faces (m).
    clear: f64,
    crown: f64,
    radius: f64,
    thickness: f64,
}

impl Arch {
    fn of(dimensions: &BayDimensions, width: f64) -> Self {
        Self {
            half: 0.5 * width,
            clear: 0.5 * width - dimensions.wall_lining,
            crown: -dimensions.cover,
            radius: arch_radius(width, dimensions.rise * width),
            thickness: dimensions.arch_lining,
        }
    }

    /// The roof at a distance from the axis (m), constant beyond the walls.
    fn at(&self, x: f64) -> Roof {
        let x = x.abs().min(self.half);
        let centre = self.crown - self.radius;
        let arc = |radius: f64, x: f64| (radius * radius - x * x).sqrt();
        let inner = self.radius - self.thickness;
        // The intrados ends at the inner face of the wall and goes on straight through it.
        let within = x.min(self.clear);
        let slope = self.clear / arc(inner, self.clear);
        Roof {
            extrados: centre + arc(self.radius, x),
            intrados: centre + arc(inner, within) - slope * (x - within),
        }
    }
}
