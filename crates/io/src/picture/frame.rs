//! Picture with its title and colour scale.

use powerhouse_model::Vec3;

use super::colour::{ColourMap, Rgb, darkened, set_colour};
use super::lettering::Lettering;
use super::raster::{Point, Raster};
use super::surface::{Patch, Surface, colours_of_sets};
use super::{Picture, PictureField};
use crate::scale::Scale;

const BACKGROUND: Rgb = [255; 3];
const INK: Rgb = [40, 40, 40];
/// Factor of the finer resolution in both directions, which is averaged afterwards.
const FINER: usize = 2;
const MARGIN: usize = 16;
/// Width of the colour scale with its numbers (pixels).
const SIDE: usize = 150;
const BAR: usize = 22;
/// Offset of lines in front of their surface, relative to the size of the body.
const LIFT: f64 = 1e-3;
/// Brightness of a facet under grazing light.
const SHADE: f64 = 0.68;

/// Pixels of the picture by rows from the top.
pub(super) struct Frame {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) pixels: Vec<Rgb>,
}

/// Draws a picture whose settings are valid; `None` if it shows nothing.
pub(super) fn draw(picture: &Picture) -> Option<Frame> {
    let surface = Surface::new(picture);
    if surface.is_empty() {
        return None;
    }
    let range = range(picture, &surface);
    let mut raster = Raster::new(
        FINER * picture.width as usize,
        FINER * picture.height as usize,
        BACKGROUND,
    );
    let painter = Painter::new(picture, &surface, range);
    painter.draw_facets(&mut raster);
    painter.draw_bars(&mut raster);
    let lettering = lettering(picture);
    let triad = Triad::new(picture, lettering.line());
    if let Some(triad) = &triad {
        triad.draw(&mut raster);
    }
    let mut frame = Frame {
        width: picture.width as usize,
        height: picture.height as usize,
        pixels: raster.reduced(FINER),
    };
    for (number, line) in picture.title.lines().enumerate() {
        let top = MARGIN / 2 + number * lettering.line();
        lettering.write(&mut frame, [MARGIN, top], line, INK);
    }
    match range {
        Some(_) if !picture.names.is_empty() => {
            let top = below_title(picture, lettering.line());
            draw_label(&mut frame, &picture.label, (top, &lettering));
            draw_names(&mut frame, picture.names.iter().copied(), (top, &lettering));
        }
        Some(range) => {
            let below = triad.as_ref().map_or(0, |triad| triad.height);
            draw_scale(&mut frame, picture, (range, &lettering), below);
        }
        None => {
            let sets = picture.mesh.element_sets().keys();
            let top = below_title(picture, lettering.line());
            draw_names(&mut frame, sets.map(String::as_str), (top, &lettering));
        }
    }
    if let Some(triad) = &triad {
        triad.write(&mut frame, &lettering);
    }
    Some(frame)
}

/// Numbers at the ends of the colour scale.
fn range(picture: &Picture, surface: &Surface) -> Option<[f64; 2]> {
    let [low, high] = surface.range(picture)?;
    Some(match (picture.range, picture.colours) {
        (Some(range), _) => range,
        (None, ColourMap::BlueRed) => {
            let most = low.abs().max(high.abs());
            [-most, most]
        }
        (None, _) => [low, high],
    })
}

/// Lettering in proportion to the picture.
fn lettering(picture: &Picture) -> Lettering {
    let size = picture.width.min(picture.height) as f32 / 50.0;
    Lettering::new(size.clamp(10.0, 36.0))
}

/// Mapping of numbers to colours and of positions to pixels.
struct Painter<'a> {
    picture: &'a Picture<'a>,
    surface: &'a Surface,
    colours_of_sets: Vec<Rgb>,
    range: [f64; 2],
    axes: [Vec3; 3],
    middle: Vec3,
    /// Scale: pixels (of the finer resolution) per metre.
    pixels_per_metre: f64,
    /// Pixel of `middle`.
    centre: [f64; 2],
    lift: f64,
}

impl<'a> Painter<'a> {
    fn new(picture: &'a Picture, surface: &'a Surface, range: Option<[f64; 2]>) -> Self {
        let axes = picture.view.axes();
        let mut low = Vec3::repeat(f64::INFINITY);
        let mut high = -low;
        let mut include = |position: Vec3| {
            let seen = Vec3::from_fn(|i, _| axes[i].dot(&position));
            (low, high) = (low.inf(&seen), high.sup(&seen));
        };
        match picture.extents {
            Some(ends) => (0..8).for_each(|corner| {
                include(Vec3::from_fn(|axis, _| ends[corner >> axis & 1][axis]));
            }),
            None => {
                let nodes = surface.nodes(picture.mesh);
                nodes.for_each(|node| include(surface.positions[node as usize]));
            }
        }
        let seen = 0.5 * (low + high);
        let top = MARGIN + picture.title.lines().count() * lettering(picture).line();
        let width = (picture.width as usize)
            .saturating_sub(2 * MARGIN + SIDE)
            .max(16);
        let height = (picture.height as usize)
            .saturating_sub(top + MARGIN)
            .max(16);
        let size = high - low;
        let fits = |pixels: usize, metres: f64| (FINER * pixels) as f64 / metres;
        let pixels_per_metre = fits(width, size.x).min(fits(height, size.y));
        Self {
            picture,
            surface,
            colours_of_sets: colours_of_sets(picture.mesh),
            range: range.unwrap_or([0.0, 1.0]),
            middle: axes[0] * seen.x + axes[1] * seen.y + axes[2] * seen.z,
            axes,
            pixels_per_metre: if pixels_per_metre.is_finite() {
                pixels_per_metre
            } else {
                1.0
            },
            centre: [
                (FINER * MARGIN) as f64 + 0.5 * (FINER * width) as f64,
                (FINER * top) as f64 + 0.5 * (FINER * height) as f64,
            ],
            lift: LIFT * size.norm(),
        }
    }

    fn point(&self, node: u32, value: f64) -> Point {
        let [right, up, away] = self.axes;
        let from_middle = self.surface.positions[node as usize] - self.middle;
        Point {
            x: self.centre[0] + self.pixels_per_metre * right.dot(&from_middle),
            y: self.centre[1] - self.pixels_per_metre * up.dot(&from_middle),
            depth: away.dot(&from_middle),
            value,
        }
    }

    fn value(&self, element: u32, node: u32) -> f64 {
        match self.picture.field {
            PictureField::Sets => 0.0,
            PictureField::Nodal(values) => values[node as usize],
            PictureField::Elemental(values) => values[element as usize],
            PictureField::Facets(field) => field.values[node as usize],
        }
    }

    fn colour(&self, element: u32, value: f64) -> Rgb {
        if self.picture.field == PictureField::Sets {
            return self.colours_of_sets[element as usize];
        }
        if !self.picture.names.is_empty() {
            // Between two corners of different kinds each has the nearer half.
            let last = self.picture.names.len() - 1;
            return set_colour(Some((value.round().max(0.0) as usize).min(last)));
        }
        let [low, high] = self.range;
        // Halved, so that the difference of two huge numbers stays finite.
        let width = 0.5 * high - 0.5 * low;
        let share = if width > 0.0 {
            (0.5 * value - 0.5 * low) / width
        } else {
            0.5
        };
        self.picture.colours.colour(share)
    }

    fn draw_facets(&self, raster: &mut Raster) {
        let [right, up, away] = self.axes;
        let light = (0.45 * up - 0.3 * right - away).normalize();
        let corners = |element: u32, nodes: &[u32]| -> Vec<Point> {
            let point = |&node: &u32| self.point(node, self.value(element, node));
            nodes.iter().map(point).collect()
        };
        for Patch { element, nodes } in &self.surface.patches {
            let position = |i: usize| self.surface.positions[nodes[i] as usize];
            let last = nodes.len() - 1;
            let normal = (position(2) - position(0)).cross(&(position(last) - position(1)));
            let shine = normal
                .try_normalize(0.0)
                .map_or(0.0, |n| n.dot(&light).abs());
            let factor = SHADE + (1.0 - SHADE) * shine;
            let corners = corners(*element, nodes);
            for i in 1..last {
                raster.triangle([corners[0], corners[i], corners[i + 1]], |value| {
                    darkened(self.colour(*element, value), factor)
                });
            }
        }
        if !self.picture.edges {
            return;
        }
        for Patch { element, nodes } in &self.surface.patches {
            let corners = corners(*element, nodes);
            for i in 0..corners.len() {
                let mut ends = [corners[i], corners[(i + 1) % corners.len()]];
                ends.iter_mut().for_each(|end| end.depth -= self.lift);
                // Each inner edge is drawn twice.
                raster.line(ends, 0.3, |_| INK);
            }
        }
    }

    fn draw_bars(&self, raster: &mut Raster) {
        for &bar in &self.surface.bars {
            let nodes = self.picture.mesh.nodes_of(bar);
            let ends = [nodes[0], nodes[1]].map(|node| {
                let mut end = self.point(node, self.value(bar, node));
                end.depth -= self.lift;
                end
            });
            for [right, down] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]] {
                let moved = ends.map(|end| Point {
                    x: end.x + right,
                    y: end.y + down,
                    ..end
                });
                raster.line(moved, 1.0, |value| darkened(self.colour(bar, value), 0.8));
            }
        }
    }
}

/// The coordinate axes as the picture shows them, below the colour scale.
struct Triad {
    /// Pixel of the origin.
    origin: [f64; 2],
    /// Ends of the axes x, y, z (pixels), the farthest first, each with its name.
    ends: Vec<([f64; 2], &'static str)>,
    /// Height of all of it (pixels).
    height: usize,
}

impl Triad {
    /// Axes for a picture with lines of a height (pixels); `None` where it would leave the scale too little room.
    fn new(picture: &Picture, line: usize) -> Option<Self> {
        let length = 2.0 * line as f64;
        let height = 6 * line;
        if (picture.height as usize) < 4 * height {
            return None;
        }
        let origin = [
            picture.width as f64 - 0.5 * SIDE as f64,
            picture.height as f64 - MARGIN as f64 - 0.5 * height as f64,
        ];
        let [right, up, away] = picture.view.axes();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| away[b].total_cmp(&away[a]));
        let end = |axis: usize| {
            let across = origin[0] + length * right[axis];
            let down = origin[1] - length * up[axis];
            ([across, down], ["x", "y", "z"][axis])
        };
        Some(Self {
            origin,
            ends: order.map(end).to_vec(),
            height,
        })
    }

    /// Draws the axes in front of everything.
    fn draw(&self, raster: &mut Raster) {
        let point = |[x, y]: [f64; 2]| Point {
            x: FINER as f64 * x,
            y: FINER as f64 * y,
            depth: -1e30,
            value: 0.0,
        };
        for (end, _) in &self.ends {
            for [right, down] in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
                let ends = [self.origin, *end].map(|at| {
                    let mut at = point(at);
                    (at.x, at.y) = (at.x + right, at.y + down);
                    at
                });
                raster.line(ends, 1.0, |_| INK);
            }
        }
    }

    /// Writes the names beyond the ends of the axes that are not seen along their length.
    fn write(&self, frame: &mut Frame, lettering: &Lettering) {
        for (end, name) in &self.ends {
            let along = [end[0] - self.origin[0], end[1] - self.origin[1]];
            let length = along[0].hypot(along[1]);
            let half = 0.5 * lettering.line() as f64;
            if length < half {
                continue;
            }
            let beyond = 1.0 + 1.2 * half / length;
            let across = self.origin[0] + beyond * along[0] - 0.5 * lettering.width(name) as f64;
            let down = self.origin[1] + beyond * along[1] - half;
            let corner = [across, down].map(|pixel| pixel.max(0.0) as usize);
            lettering.write(frame, corner, name, INK);
        }
    }
}

/// Draws the colour scale with round numbers at the right, with some rows of pixels left free below.
fn draw_scale(
    frame: &mut Frame,
    picture: &Picture,
    ([low, high], lettering): ([f64; 2], &Lettering),
    below: usize,
) {
    let line = lettering.line();
    let top = below_title(picture, line) + 2 * line;
    let bottom = frame.height.saturating_sub(2 * MARGIN + below);
    let bottom = bottom.max(top + 2);
    let left = frame.width.saturating_sub(SIDE - 16);
    let scale = Scale::new(low, high, 12, false);
    let mut label = picture.label.clone();
    if scale.exponent != 0 {
        label.push_str(&format!(" ×10^{}", scale.exponent));
    }
    draw_label(frame, &label, (below_title(picture, line), lettering));
    // With equal ends the axis is wider than the colours; all of it has the middle colour.
    let flat = low == high;
    for row in top..=bottom {
        let share = (bottom - row) as f64 / (bottom - top) as f64;
        let colour = picture.colours.colour(if flat { 0.5 } else { share });
        frame.fill([left, row], [BAR, 1], colour);
    }
    for &mark in &scale.marks {
        let share = scale.share_of_mark(mark).clamp(0.0, 1.0);
        let row = bottom - (share * (bottom - top) as f64).round() as usize;
        frame.fill([left + BAR, row], [6, 1], INK);
        let text = scale.text(mark);
        let corner = [left + BAR + 10, row.saturating_sub(line / 2)];
        lettering.write(frame, corner, &text, INK);
    }
}

/// Draws the label of the colour scale at the top right.
fn draw_label(frame: &mut Frame, label: &str, (top, lettering): (usize, &Lettering)) {
    let start = (frame.width).saturating_sub(lettering.width(label) + MARGIN / 2);
    lettering.write(frame, [start, top], label, INK);
}

/// First row of pixels below the title, with lines of a height (pixels).
fn below_title(picture: &Picture, line: usize) -> usize {
    MARGIN / 2 + picture.title.lines().count() * line
}

/// Draws names with their colours at the right.
fn draw_names<'a>(
    frame: &mut Frame,
    names: impl Iterator<Item = &'a str>,
    (top, lettering): (usize, &Lettering),
) {
    let line = lettering.line();
    let left = frame.width.saturating_sub(SIDE - 8);
    for (number, name) in names.enumerate() {
        let row = top + 2 * line + number * 3 * line / 2;
        frame.fill([left, row], [line, line], set_colour(Some(number)));
        lettering.write(frame, [left + line + 6, row], name, INK);
    }
}

impl Frame {
    /// Fills a rectangle, clipped to the picture.
    pub(super) fn fill(&mut self, [left, top]: [usize; 2], [wide, high]: [usize; 2], colour: Rgb) {
        for row in top..(top + high).min(self.height) {
            for column in left..(left + wide).min(self.width) {
                self.pixels[row * self.width + column] = colour;
            }
        }
    }
}
