//! Texts of pictures.

use ab_glyph::{Font, FontRef, Glyph, PxScale, ScaleFont, point};

use super::colour::{Rgb, mixed};
use super::frame::Frame;

/// DejaVu Sans: Latin and Greek letters and some signs, without hints.
const FONT: &[u8] = include_bytes!("font/DejaVuSans-subset.ttf");
/// Height of a line over that of its letters.
const LINE: f32 = 1.25;

/// Font of pictures in a size.
pub(super) struct Lettering {
    font: Option<FontRef<'static>>,
    scale: PxScale,
}

impl Lettering {
    /// Letters of a height (pixels) from the lowest to the highest.
    pub(super) fn new(height: f32) -> Self {
        Self {
            font: FontRef::try_from_slice(FONT).ok(),
            scale: PxScale::from(height),
        }
    }

    /// Height of a line (pixels).
    pub(super) fn line(&self) -> usize {
        (LINE * self.scale.y).round() as usize
    }

    /// Width of a text (pixels).
    pub(super) fn width(&self, text: &str) -> usize {
        self.placed(text).1.ceil() as usize
    }

    /// Letters of a text from the left end of their base line, and the width of the text (pixels). Characters that the
    /// font has not become `?`.
    fn placed(&self, text: &str) -> (Vec<Glyph>, f32) {
        let Some(font) = &self.font else {
            return (Vec::new(), 0.0);
        };
        let scaled = font.as_scaled(self.scale);
        let (mut letters, mut end) = (Vec::new(), 0.0);
        let mut last = None;
        for letter in text.chars() {
            let known = font.glyph_id(letter);
            let id = match known.0 {
                0 => font.glyph_id('?'),
                _ => known,
            };
            if let Some(last) = last {
                end += scaled.kern(last, id);
            }
            letters.push(id.with_scale_and_position(self.scale, point(end, 0.0)));
            end += scaled.h_advance(id);
            last = Some(id);
        }
        (letters, end)
    }

    /// Draws a text with its top left corner at a pixel, clipped to the picture.
    pub(super) fn write(&self, frame: &mut Frame, [left, top]: [usize; 2], text: &str, ink: Rgb) {
        let Some(font) = &self.font else {
            return;
        };
        let base = font.as_scaled(self.scale).ascent();
        for letter in self.placed(text).0 {
            let Some(outline) = font.outline_glyph(letter) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            let (x, y) = (left as f32 + corner.x, top as f32 + base + corner.y);
            outline.draw(|column, row, covered| {
                let (column, row) = (x.round() + column as f32, y.round() + row as f32);
                if column >= 0.0 && row >= 0.0 {
                    frame.blend([column as usize, row as usize], ink, f64::from(covered));
                }
            });
        }
    }
}

impl Frame {
    /// Mixes a share of a colour into a pixel, if it is in the picture.
    fn blend(&mut self, [column, row]: [usize; 2], colour: Rgb, share: f64) {
        if column < self.width && row < self.height {
            let pixel = &mut self.pixels[row * self.width + column];
            *pixel = mixed(*pixel, colour, share.clamp(0.0, 1.0));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every printable character has a shape of its own, as have accents, Greek letters and powers; others are those of `?`.
    #[test]
    fn letters_have_shapes() {
        let lettering = Lettering::new(16.0);
        let font = lettering.font.as_ref().unwrap();
        for letter in ('!'..='~').chain("äéßøσγεμ²³°·×−–".chars()) {
            let id = font.glyph_id(letter);
            assert_ne!(id.0, 0, "{letter}");
            assert!(font.outline(id).is_some(), "{letter}");
        }
        assert_eq!(lettering.width("漢"), lettering.width("?"));
        assert!(lettering.width("mm") > 2 * lettering.width("ii"));
    }

    /// A text marks pixels within its width and line, and nothing beyond the picture.
    #[test]
    fn texts_stay_within_their_lines() {
        let lettering = Lettering::new(16.0);
        let mut frame = Frame {
            width: 60,
            height: 40,
            pixels: vec![[255; 3]; 60 * 40],
        };
        lettering.write(&mut frame, [10, 5], "gÄ|", [0; 3]);
        let (width, line) = (lettering.width("gÄ|"), lettering.line());
        let mut marked = 0;
        for (index, pixel) in frame.pixels.iter().enumerate() {
            if *pixel != [255; 3] {
                let (column, row) = (index % 60, index / 60);
                assert!((9..=10 + width).contains(&column), "{column}");
                assert!((5..=6 + line).contains(&row), "{row}");
                marked += 1;
            }
        }
        assert!(marked > 50, "{marked}");
        lettering.write(&mut frame, [50, 35], "a long text", [0; 3]);
    }
}
