//! Colour maps: numbers as colours.

/// Red, green and blue of a pixel, 0 to 255 each.
pub(super) type Rgb = [u8; 3];

/// Colour map of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum ColourMap {
    /// Viridis, from dark violet over green to yellow, perceptually uniform and readable without colour:
    /// nine points of matplotlib's (van der Walt and Smith, 2015; public domain).
    #[default]
    Viridis,
    /// Blue over white to red, for numbers of both signs.
    BlueRed,
    /// Dark to light grey.
    Grey,
}

const VIRIDIS: [Rgb; 9] = [
    [68, 1, 84],
    [71, 45, 123],
    [59, 82, 139],
    [44, 114, 142],
    [33, 145, 140],
    [40, 174, 128],
    [94, 201, 98],
    [173, 220, 48],
    [253, 231, 37],
];
const BLUE_RED: [Rgb; 5] = [
    [31, 78, 156],
    [134, 176, 221],
    [242, 242, 242],
    [232, 150, 122],
    [168, 28, 28],
];
const GREY: [Rgb; 2] = [[40, 40, 40], [235, 235, 235]];

/// Colours of element sets, in the order of their names.
const SETS: [Rgb; 8] = [
    [176, 190, 197],
    [214, 170, 110],
    [120, 170, 200],
    [150, 185, 130],
    [205, 135, 135],
    [165, 145, 195],
    [225, 205, 120],
    [125, 190, 180],
];

impl ColourMap {
    /// Colour at a position on the scale, from 0 to 1; outside, that of the nearer end.
    pub(super) fn colour(self, share: f64) -> Rgb {
        let points: &[Rgb] = match self {
            Self::Viridis => &VIRIDIS,
            Self::BlueRed => &BLUE_RED,
            Self::Grey => &GREY,
        };
        let last = points.len() - 1;
        let position = share.clamp(0.0, 1.0) * last as f64;
        let below = (position as usize).min(last - 1);
        mixed(points[below], points[below + 1], position - below as f64)
    }
}

/// Colour of the element set with this index; `None` for elements of no set.
pub(super) fn set_colour(set: Option<usize>) -> Rgb {
    set.map_or([200, 200, 200], |set| SETS[set % SETS.len()])
}

pub(super) fn mixed(from: Rgb, to: Rgb, share: f64) -> Rgb {
    core::array::from_fn(|i| {
        let (from, to) = (f64::from(from[i]), f64::from(to[i]));
        // To the nearest: a conversion cuts off what is behind the point.
        (from + (to - from) * share + 0.5) as u8
    })
}

pub(super) fn darkened(colour: Rgb, factor: f64) -> Rgb {
    mixed([0; 3], colour, factor)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A colour map has its own colours at the ends and the points between; outside it is constant.
    #[test]
    fn a_scale_ends_where_it_should() {
        assert_eq!(ColourMap::Viridis.colour(0.0), VIRIDIS[0]);
        assert_eq!(ColourMap::Viridis.colour(1.0), VIRIDIS[8]);
        assert_eq!(ColourMap::Viridis.colour(0.25), VIRIDIS[2]);
        assert_eq!(ColourMap::BlueRed.colour(0.5), [242, 242, 242]);
        assert_eq!(ColourMap::Grey.colour(7.0), GREY[1]);
        assert_eq!(ColourMap::Grey.colour(-7.0), GREY[0]);
    }
}
