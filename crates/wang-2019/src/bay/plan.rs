//! Columns, layers and rows of the undeformed grid, with their assignment to the structure.

use super::dimensions::BayDimensions;
use super::spacing::{graded, graded_from_both_ends, positions};
use super::{Bay, BayCells};

/// Square loop of cells around the axis of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Ring {
    Pit,
    Pier,
    Windshield,
    Beyond,
}

/// Region that a column of cells (constant x) runs through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    Rock,
    MainWall,
    MainHall(Ring),
    TransformerWall,
    TransformerHall,
}

/// Region that a layer of cells (constant y) runs through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layer {
    Bay(Ring),
    BeyondEnds,
}

/// Horizontal band in which a row of cells lies, from the bottom up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Row {
    Below,
    Base,
    Mass,
    TurbineFloor,
    TurbineStorey,
    BusbarFloor,
    GeneratorStorey,
    GeneratorFloor,
    Hall,
    Arch,
    Above,
}

/// Grid lines before the deformation, with the regions between them.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// x of the grid lines (m), and the columns between them.
    pub(super) x: Vec<f64>,
    pub(super) columns: Vec<Column>,
    /// y of the grid lines (m), and the layers between them.
    pub(super) y: Vec<f64>,
    pub(super) layers: Vec<Layer>,
    /// Band of each row.
    pub(super) rows: Vec<Row>,
    /// Height of each line of rows within its band, as shares from the band's lower horizon; the
    /// last one of a band is the first of the next.
    pub(super) shares: Vec<f64>,
}

impl Plan {
    pub(super) fn of(bay: &Bay) -> Self {
        let (dimensions, cells) = (&bay.dimensions, &bay.cells);
        let (x, columns) = columns(dimensions, cells);
        let (y, layers) = layers(bay);
        let (rows, shares) = rows(dimensions, cells);
        Self {
            x,
            columns,
            y,
            layers,
            rows,
            shares,
        }
    }

    /// Numbers of cells along x, y and z.
    pub(super) fn cells(&self) -> [usize; 3] {
        [self.columns.len(), self.layers.len(), self.rows.len()]
    }
}

/// Spacings from the axis through the rings to `end` (m), and the ring of each.
fn half_profile(
    dimensions: &BayDimensions,
    rings: [usize; 3],
    beyond: usize,
    end: f64,
) -> Vec<(f64, Ring)> {
    let inner = dimensions.ring_radius - dimensions.windshield;
    let ends = [
        0.0,
        dimensions.pit_radius,
        inner,
        dimensions.ring_radius,
        end,
    ];
    let kinds = [Ring::Pit, Ring::Pier, Ring::Windshield, Ring::Beyond];
    let counts = [rings[0], rings[1], rings[2], beyond];
    let mut profile = Vec::new();
    for ((bounds, ring), count) in ends.windows(2).zip(kinds).zip(counts) {
        let spacing = (bounds[1] - bounds[0]) / count as f64;
        profile.extend(std::iter::repeat_n((spacing, ring), count));
    }
    profile
}

/// The mirror image of a half profile, followed by the half profile.
fn whole<T: Clone>(half: &[T]) -> Vec<T> {
    half.iter().rev().chain(half).cloned().collect()
}

fn columns(dimensions: &BayDimensions, cells: &BayCells) -> (Vec<f64>, Vec<Column>) {
    let half_main = 0.5 * dimensions.main_width;
    let right = dimensions.transformer_axis() + 0.5 * dimensions.transformer_width;
    let side = graded(
        dimensions.side,
        cells.side,
        cells.first_beside,
        cells.longest,
    );
    let pillar = graded_from_both_ends(
        dimensions.pillar,
        cells.pillar,
        cells.first_beside,
        cells.longest,
    );
    let wall = vec![dimensions.wall_lining / cells.lining as f64; cells.lining];
    let clear_end = half_main - dimensions.wall_lining;
    let hall = half_profile(dimensions, cells.ring, cells.ring_to_wall, clear_end);
    let clear = dimensions.transformer_width - 2.0 * dimensions.wall_lining;
    let transformer = vec![clear / cells.transformer as f64; cells.transformer];
    let mut found: Vec<(f64, Column)> = Vec::new();
    let mut put = |spacings: &[f64], column: Column| {
        found.extend(spacings.iter().map(|&spacing| (spacing, column)));
    };
    put(
        &side.iter().rev().copied().collect::<Vec<_>>(),
        Column::Rock,
    );
    put(&wall, Column::MainWall);
    for (spacing, ring) in whole(&hall) {
        put(&[spacing], Column::MainHall(ring));
    }
    put(&wall, Column::MainWall);
    put(&pillar, Column::Rock);
    put(&wall, Column::TransformerWall);
    put(&transformer, Column::TransformerHall);
    put(&wall, Column::TransformerWall);
    put(&side, Column::Rock);
    let (spacings, columns): (Vec<f64>, Vec<Column>) = found.into_iter().unzip();
    let start = -half_main - dimensions.side;
    let mut x = positions(start, &spacings, right + dimensions.side);
    straighten(&mut x, &columns, dimensions);
    (x, columns)
}

/// Moves grid lines with given coordinates to these exactly, since sums of spacings are rounded.
fn straighten(x: &mut [f64], columns: &[Column], dimensions: &BayDimensions) {
    let half = 0.5 * dimensions.main_width;
    let axis = dimensions.transformer_axis();
    let half_transformer = 0.5 * dimensions.transformer_width;
    let wall = dimensions.wall_lining;
    let walls = [
        -half,
        wall - half,
        0.0,
        half - wall,
        half,
        axis - half_transformer,
        axis - half_transformer + wall,
        axis,
        axis + half_transformer - wall,
        axis + half_transformer,
    ];
    let least = columns.len() as f64 * f64::EPSILON * (axis + dimensions.side);
    for line in x {
        if let Some(wall) = walls
            .iter()
            .find(|wall| (*line - **wall).abs() < 8.0 * least)
        {
            *line = *wall;
        }
    }
}

fn layers(bay: &Bay) -> (Vec<f64>, Vec<Layer>) {
    let (dimensions, cells) = (&bay.dimensions, &bay.cells);
    let half = half_profile(
        dimensions,
        cells.ring,
        cells.ring_to_end,
        0.5 * dimensions.length,
    );
    let (spacings, rings): (Vec<f64>, Vec<Ring>) = whole(&half).into_iter().unzip();
    let mut layers: Vec<Layer> = rings.into_iter().map(Layer::Bay).collect();
    let mut y = positions(0.0, &spacings, dimensions.length);
    let middle = spacings.len() / 2;
    y[middle] = 0.5 * dimensions.length;
    if let Some(ends) = &bay.ends {
        let first = 0.5 * dimensions.length - dimensions.ring_radius;
        let first = first / cells.ring_to_end as f64;
        let beyond = graded(ends.rock, ends.cells, first, cells.longest);
        let far = positions(0.0, &beyond, ends.rock);
        let before = far[1..].iter().rev().map(|distance| -distance);
        let after = far[1..].iter().map(|distance| dimensions.length + distance);
        y = before.chain(y.iter().copied()).chain(after).collect();
        let rock = vec![Layer::BeyondEnds; beyond.len()];
        layers = [&rock[..], &layers, &rock].concat();
    }
    (y, layers)
}

fn rows(dimensions: &BayDimensions, cells: &BayCells) -> (Vec<Row>, Vec<f64>) {
    let below = graded(
        dimensions.below,
        cells.below,
        cells.first_below,
        cells.longest,
    );
    let above = graded(
        dimensions.cover,
        cells.above,
        cells.first_above,
        cells.longest,
    );
    let equal = |count: usize| vec![1.0; count];
    let [hall, generator, turbine, mass] = cells.storeys;
    let bands = [
        (Row::Below, below.into_iter().rev().collect()),
        (Row::Base, equal(cells.floor)),
        (Row::Mass, equal(mass)),
        (Row::TurbineFloor, equal(cells.floor)),
        (Row::TurbineStorey, equal(turbine)),
        (Row::BusbarFloor, equal(cells.floor)),
        (Row::GeneratorStorey, equal(generator)),
        (Row::GeneratorFloor, equal(cells.floor)),
        (Row::Hall, equal(hall)),
        (Row::Arch, equal(cells.lining)),
        (Row::Above, above),
    ];
    let (mut rows, mut shares) = (Vec::new(), vec![0.0]);
    for (row, spacings) in bands {
        let whole: f64 = spacings.iter().sum();
        let heights = positions(0.0, &spacings, whole);
        rows.extend(std::iter::repeat_n(row, spacings.len()));
        shares.extend(heights[1..].iter().map(|height| height / whole));
    }
    (rows, shares)
}
