//! Animations as PNG files of several pictures (APNG).

use std::path::{Path, PathBuf};

use powerhouse_model::ParameterError;

use super::frame::{self, Frame};
use super::{Picture, encoder};
use crate::{IoError, write_whole};

/// Least and greatest time for which a picture is shown (s).
const SHOWN: (f64, f64) = (0.01, 10.0);
/// Greatest number of pictures.
const MOST: f64 = 10_000.0;

/// Animated PNG file (APNG, PNG specification, third edition), which browsers play and other programs show as its first
/// picture.
///
/// Pictures are drawn and compressed as they are added; the file is written when the last one has been.
pub struct AnimationFile {
    file: PathBuf,
    pictures: u32,
    seconds: f64,
    added: u32,
    /// Encoder with the size of the pictures, from the first one on.
    writer: Option<([usize; 2], png::Writer<Output>)>,
    output: Output,
}

/// Bytes of the file, which its encoder and the animation share.
#[derive(Clone, Default)]
struct Output(std::rc::Rc<std::cell::RefCell<Vec<u8>>>);

impl std::io::Write for Output {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.borrow_mut().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

impl AnimationFile {
    /// Animation of a number of pictures, 1 to 10,000, each shown for a time (s), 0.01 to 10; it is repeated for ever.
    ///
    /// # Errors
    /// A number or a time outside its range.
    pub fn new(file: impl Into<PathBuf>, pictures: usize, seconds: f64) -> Result<Self, IoError> {
        let file = file.into();
        let setting = |source| IoError::Setting {
            file: file.clone(),
            source,
        };
        ParameterError::check("pictures", pictures as f64, 1.0, MOST).map_err(setting)?;
        ParameterError::check("seconds", seconds, SHOWN.0, SHOWN.1).map_err(setting)?;
        Ok(Self {
            file,
            pictures: pictures as u32,
            seconds,
            added: 0,
            writer: None,
            output: Output::default(),
        })
    }

    /// Draws the next picture; the file is written with the last one.
    ///
    /// # Errors
    /// As [`write_picture`](super::write_picture); a picture of another size than the first, or one more than announced.
    pub fn add(&mut self, picture: &Picture) -> Result<(), IoError> {
        picture.check(&self.file)?;
        if self.added == self.pictures {
            return Err(self.error(format!("there are more than {} pictures", self.pictures)));
        }
        let Some(image) = frame::draw(picture) else {
            return Err(IoError::NothingToDraw {
                file: self.file.clone(),
            });
        };
        let size = [image.width, image.height];
        let (of_first, mut writer) = match self.writer.take() {
            Some(writer) => writer,
            None => (size, self.begin(&image).map_err(|error| self.error(error))?),
        };
        if size != of_first {
            let [[width, height], [first, high]] = [size, of_first];
            return Err(self.error(format!(
                "a picture has {width} by {height} pixels, the first {first} by {high}"
            )));
        }
        let written = writer.write_image_data(image.pixels.as_flattened());
        written.map_err(|error| self.error(error))?;
        self.added += 1;
        if self.added < self.pictures {
            self.writer = Some((size, writer));
            return Ok(());
        }
        writer.finish().map_err(|error| self.error(error))?;
        write_whole(&self.file, &self.output.0.borrow())
    }

    /// Path of the file.
    pub fn file(&self) -> &Path {
        &self.file
    }

    fn begin(&self, image: &Frame) -> Result<png::Writer<Output>, png::EncodingError> {
        let mut encoder = encoder(self.output.clone(), image);
        encoder.set_animated(self.pictures, 0)?;
        encoder.set_frame_delay((1000.0 * self.seconds).round() as u16, 1000)?;
        encoder.write_header()
    }

    fn error(&self, error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> IoError {
        IoError::file(&self.file)(std::io::Error::other(error))
    }
}
