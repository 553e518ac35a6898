//! Motions of stations in H5DRM files.

use std::path::Path;

use hdf5_pure::{Dataset, File};

use super::order::other_order;
use super::{StationFileFault, StationForm, StationMotions, check_memory};

const POSITIONS: &str = "/DRM_Data/xyz";
const INNER: &str = "/DRM_Data/internal";
const ROWS: &str = "/DRM_Data/data_location";
const DISPLACEMENT: &str = "/DRM_Data/displacement";
const VELOCITY: &str = "/DRM_Data/velocity";
const STEP: &str = "/DRM_Metadata/dt";
const START: &str = "/DRM_Metadata/tstart";
const END: &str = "/DRM_Metadata/tend";
const ORIGIN: &str = "/DRM_Metadata/drmbox_x0";
const CONTROL: &str = "/DRM_QA_Data/displacement";
const CONTROL_POSITION: &str = "/DRM_QA_Data/xyz";

/// How many times larger than a file its numbers can be: the greatest ratio of deflate, 1032, and room for a second filter.
const LARGEST_RATIO: u64 = 2048;
/// Greatest number of stations, of the order of what a mesh can have in a layer.
const MOST_STATIONS: u64 = 10_000_000;
/// Greatest number of samples: those of an hour at 1000 a second.
const MOST_SAMPLES: u64 = 4_000_000;
/// Difference of the declared end of the motions from their last sample that is warned of, over the step.
const OTHER_END: f64 = 1.5;

/// Reads an H5DRM file station by station.
pub(super) fn read(path: &Path, most: u64) -> Result<StationMotions, StationFileFault> {
    let size = std::fs::metadata(path).map_err(StationFileFault::Read)?;
    if !size.is_file() {
        let error = std::io::Error::other(crate::Unread::NotRegular);
        return Err(StationFileFault::Read(error));
    }
    let file = File::open_streaming(path).map_err(|error| damaged("the file", error))?;
    let source = Source {
        file,
        size: size.len(),
    };
    source.motions(most)
}

fn damaged(object: &'static str, error: hdf5_pure::Error) -> StationFileFault {
    let reason = error.to_string();
    if reason.ends_with("not found: DRM_Data") {
        return StationFileFault::NotH5drm;
    }
    StationFileFault::Damaged { object, reason }
}

/// Checks that as many numbers were read as the shape of their object has: a damaged object may have fewer.
fn check_count(object: &'static str, found: usize, expected: u64) -> Result<(), StationFileFault> {
    if found as u64 == expected {
        Ok(())
    } else {
        Err(StationFileFault::Damaged {
            object,
            reason: format!("{found} numbers are there, {expected} expected"),
        })
    }
}

struct Source {
    file: File,
    size: u64,
}

impl Source {
    fn dataset(&self, object: &'static str) -> Result<Dataset, StationFileFault> {
        self.file
            .dataset(object)
            .map_err(|error| damaged(object, error))
    }

    /// Object with its lengths, which the file can hold.
    fn shaped(&self, object: &'static str) -> Result<(Dataset, Vec<u64>), StationFileFault> {
        let dataset = self.dataset(object)?;
        let shape = dataset.shape().map_err(|error| damaged(object, error))?;
        let numbers = shape
            .iter()
            .try_fold(1_u64, |n, length| n.checked_mul(*length));
        let claimed = numbers.and_then(|n| n.checked_mul(8)).unwrap_or(u64::MAX);
        if claimed / LARGEST_RATIO <= self.size {
            Ok((dataset, shape))
        } else {
            Err(StationFileFault::Endless {
                object,
                claimed,
                size: self.size,
            })
        }
    }

    /// Small object of some numbers.
    fn numbers(
        &self,
        object: &'static str,
        expected: &[u64],
    ) -> Result<Vec<f64>, StationFileFault> {
        let (dataset, shape) = self.shaped(object)?;
        // A scalar may be written as one row of one number.
        let is_one = |shape: &[u64]| shape.iter().all(|length| *length == 1);
        if shape != expected && !(is_one(&shape) && is_one(expected)) {
            return Err(StationFileFault::Shape {
                object,
                found: shape,
                expected: format!("{expected:?}"),
            });
        }
        let numbers = dataset.read_f64().map_err(|error| damaged(object, error))?;
        let count = expected.iter().product();
        check_count(object, numbers.len(), count)?;
        match numbers.iter().position(|number| !number.is_finite()) {
            None => Ok(numbers),
            Some(index) => Err(StationFileFault::Value {
                object,
                index,
                value: numbers[index],
                expected: "a finite number".into(),
            }),
        }
    }

    fn number(&self, object: &'static str) -> Result<f64, StationFileFault> {
        Ok(self.numbers(object, &[])?[0])
    }

    fn motions(&self, most: u64) -> Result<StationMotions, StationFileFault> {
        let (_, shape) = self.shaped(POSITIONS)?;
        let &[stations @ 1..=MOST_STATIONS, 3] = &shape[..] else {
            return Err(StationFileFault::Shape {
                object: POSITIONS,
                found: shape,
                expected: format!("[n, 3] of 1 to {MOST_STATIONS} stations"),
            });
        };
        let (displacement, shape) = self.shaped(DISPLACEMENT)?;
        let &[rows, samples @ 2..=MOST_SAMPLES] = &shape[..] else {
            return Err(StationFileFault::Shape {
                object: DISPLACEMENT,
                found: shape,
                expected: format!("[3 n, samples] of 2 to {MOST_SAMPLES} samples"),
            });
        };
        if rows < 3 * stations {
            return Err(StationFileFault::Shape {
                object: DISPLACEMENT,
                found: shape,
                expected: format!("three rows for each of {stations} stations"),
            });
        }
        let velocity = match self.file.dataset(VELOCITY) {
            Err(_) => None,
            Ok(_) => {
                let (velocity, shape) = self.shaped(VELOCITY)?;
                if shape != [rows, samples] {
                    return Err(StationFileFault::Shape {
                        object: VELOCITY,
                        found: shape,
                        expected: format!("that of the displacement, [{rows}, {samples}]"),
                    });
                }
                Some(velocity)
            }
        };
        let width = if velocity.is_some() { 6 } else { 3 };
        check_memory(stations, samples, width, most)?;
        let (step, start) = (self.number(STEP)?, self.number(START)?);
        if step <= 0.0 {
            return Err(StationFileFault::Value {
                object: STEP,
                index: 0,
                value: step,
                expected: "a time step (s) above zero".into(),
            });
        }
        let positions = self.numbers(POSITIONS, &[stations, 3])?;
        let mut motions = StationMotions {
            form: StationForm::H5drm,
            positions: positions
                .chunks(3)
                .map(|at| [at[0], at[1], at[2]])
                .collect(),
            inner: self.sides(stations)?,
            origin: self.origin()?,
            start,
            step,
            samples: samples as usize,
            has_velocity: velocity.is_some(),
            motion: Vec::with_capacity((stations * samples * width) as usize),
            other_order: None,
            warnings: Vec::new(),
        };
        for first in self.first_rows(stations, rows)? {
            let u = self.rows(&displacement, DISPLACEMENT, first, samples)?;
            let v = match &velocity {
                Some(velocity) => self.rows(velocity, VELOCITY, first, samples)?,
                None => Vec::new(),
            };
            let samples = samples as usize;
            for sample in 0..samples {
                for rows in [&u, &v] {
                    let of_sample = rows.iter().skip(sample).step_by(samples);
                    motions.motion.extend(of_sample);
                }
            }
        }
        motions.warnings.extend(self.other_end(&motions));
        motions.other_order = self.other_order(&motions);
        Ok(motions)
    }

    /// Rows of a station.
    fn rows(
        &self,
        dataset: &Dataset,
        object: &'static str,
        first: u64,
        samples: u64,
    ) -> Result<Vec<f64>, StationFileFault> {
        let rows = dataset.read_f64_rows(first, 3);
        let rows = rows.map_err(|error| damaged(object, error))?;
        check_count(object, rows.len(), 3 * samples)?;
        match rows.iter().position(|number| !number.is_finite()) {
            None => Ok(rows),
            Some(index) => Err(StationFileFault::Value {
                object,
                index: (first * samples) as usize + index,
                value: rows[index],
                expected: "a finite number".into(),
            }),
        }
    }

    /// First row of every station.
    fn first_rows(&self, stations: u64, rows: u64) -> Result<Vec<u64>, StationFileFault> {
        let firsts = self.numbers(ROWS, &[stations])?;
        let is_row =
            |first: f64| first >= 0.0 && first.fract() == 0.0 && first + 3.0 <= rows as f64;
        match firsts.iter().position(|first| !is_row(*first)) {
            None => Ok(firsts.into_iter().map(|first| first as u64).collect()),
            Some(index) => Err(StationFileFault::Value {
                object: ROWS,
                index,
                value: firsts[index],
                expected: format!("a row of which two follow, 0 to {}", rows - 3),
            }),
        }
    }

    /// Whether each station is on the inner side: a Boolean, which is an enumeration of bytes in HDF5, or a number.
    fn sides(&self, stations: u64) -> Result<Vec<bool>, StationFileFault> {
        let (dataset, shape) = self.shaped(INNER)?;
        if shape != [stations] {
            return Err(StationFileFault::Shape {
                object: INNER,
                found: shape,
                expected: format!("[{stations}]"),
            });
        }
        let sides = dataset.read_i32().map_err(|error| damaged(INNER, error))?;
        check_count(INNER, sides.len(), stations)?;
        match sides.iter().position(|side| *side != 0 && *side != 1) {
            None => Ok(sides.into_iter().map(|side| side == 1).collect()),
            Some(index) => Err(StationFileFault::Value {
                object: INNER,
                index,
                value: f64::from(sides[index]),
                expected: "0 or 1".into(),
            }),
        }
    }

    fn origin(&self) -> Result<[f64; 3], StationFileFault> {
        let origin = self.numbers(ORIGIN, &[3])?;
        Ok([origin[0], origin[1], origin[2]])
    }

    /// Warning about a declared end that is not that of the samples. Writers state the time of the last sample, or of the step
    /// after it.
    fn other_end(&self, motions: &StationMotions) -> Option<String> {
        let declared = self.number(END).ok()?;
        let last = motions.start + motions.step * (motions.samples - 1) as f64;
        let off = (declared - last).abs() / motions.step;
        (off > OTHER_END).then(|| {
            format!(
                "the file declares tend = {declared} s, its last sample of {} is at {last} s: the samples are taken",
                motions.samples
            )
        })
    }

    /// Other order of the components of the station nearest to the control point, if there is a control point.
    fn other_order(&self, motions: &StationMotions) -> Option<[usize; 3]> {
        let at = self.numbers(CONTROL_POSITION, &[1, 3]).ok()?;
        let control = self.numbers(CONTROL, &[3, motions.samples as u64]).ok()?;
        let strength =
            |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| x * x).sum::<f64>().sqrt();
        let mut rows = control.chunks(motions.samples);
        let control = [0; 3].map(|_| {
            rows.next()
                .map_or(0.0, |row| strength(&mut row.iter().copied()))
        });
        let distance = |station: &[f64; 3]| -> f64 {
            station
                .iter()
                .zip(&at)
                .map(|(a, b)| (a - b) * (a - b))
                .sum()
        };
        let stations = motions.positions.iter().enumerate();
        let nearest = stations
            .min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))?
            .0;
        let width = if motions.has_velocity { 6 } else { 3 };
        let own = &motions.motion[nearest * motions.samples * width..][..motions.samples * width];
        let own =
            [0, 1, 2].map(|axis| strength(&mut own.iter().skip(axis).step_by(width).copied()));
        other_order(control, own)
    }
}
