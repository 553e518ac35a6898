//! `powerhouse picture`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::Args;
use powerhouse::file_name;
use powerhouse::io::{SectionPlane, shown_number};
use powerhouse::model::Vec3;
use powerhouse_report::fields::{
    Animation, DeformationFactor, FieldPart, FieldPicture, RecordedFields,
};

use crate::terminal::{say, say_warning};
use crate::{Outcome, check_ending};

/// Time that an animation takes (s) by default.
const LENGTH: f64 = 8.0;
/// Longest time for which one of its pictures is shown (s) by default.
const SLOWEST: f64 = 0.5;
/// Greatest factor of a deformation.
const MOST_DEFORMED: f64 = 1e12;
/// Least and greatest width and height (pixels).
const PIXELS: std::ops::RangeInclusive<u32> = 64..=4096;

/// Arguments of `powerhouse picture`.
#[derive(Args)]
pub(crate) struct PictureArguments {
    /// Folder of the results of a run with [output.snapshots], or a VTU file, such as results/tunnel/envelope.vtu.
    results: PathBuf,
    /// Quantity: a field, and after a point what of it, such as damage, displacement, displacement.z, stress.greatest,
    /// stress.mises or stress.xx; without any the quantities and times are listed.
    quantity: Option<String>,
    /// Time (s), of which the nearest snapshot is drawn; by default the last.
    #[arg(long, value_name = "SECONDS", value_parser = finite, allow_negative_numbers = true)]
    time: Option<f64>,
    /// Element set that is drawn, in place of all; may be repeated.
    #[arg(long = "set", value_name = "NAME")]
    sets: Vec<String>,
    /// Draw the body deformed, by displacements relative to the mean motion times a factor, such as `--deformed=200`; without a
    /// number it is one with which they are well visible.
    #[arg(
        long,
        value_name = "FACTOR",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "auto",
        value_parser = deformation
    )]
    deformed: Option<DeformationFactor>,
    /// Direction of view: x, y or z, along this axis, or -x, -y, -z, against it.
    #[arg(long, value_name = "AXIS", value_parser = axis, allow_hyphen_values = true)]
    view: Option<Vec3>,
    /// Plane that cuts the body open, such as y=6.85 (m): elements with their centroid on the viewer's side are not drawn. By
    /// default it is in the middle of the elements, where most of them are.
    #[arg(long, value_name = "AXIS=VALUE", value_parser = cut)]
    cut: Option<SectionPlane>,
    /// Draw the whole body, without a cut.
    #[arg(long, conflicts_with = "cut")]
    whole: bool,
    /// Numbers at the ends of the colours, in the unit of the picture, such as -2,1.
    #[arg(long, value_name = "LOW,HIGH", value_parser = range, allow_hyphen_values = true)]
    range: Option<[f64; 2]>,
    /// Width and height (pixels), such as 1200x900.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = size)]
    size: Option<[u32; 2]>,
    /// Draw all snapshots, one after the other, as an animation (APNG, which browsers play).
    #[arg(long, conflicts_with = "time")]
    animate: bool,
    /// First time of an animation (s).
    #[arg(long, value_name = "SECONDS", value_parser = finite, allow_negative_numbers = true, requires = "animate")]
    from: Option<f64>,
    /// Last time of an animation (s).
    #[arg(long, value_name = "SECONDS", value_parser = finite, allow_negative_numbers = true, requires = "animate")]
    to: Option<f64>,
    /// Pictures of an animation in a second, 0.1 to 100; by default as many as make it last eight seconds.
    #[arg(long, value_name = "COUNT", value_parser = rate, allow_negative_numbers = true, requires = "animate")]
    rate: Option<f64>,
    /// PNG file; by default in the folder pictures of the results, or beside the VTU file.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Draws a field after a run, or lists what can be drawn.
pub(crate) fn picture(arguments: PictureArguments) -> Outcome {
    let fields = RecordedFields::at(&arguments.results)?;
    let Some(quantity) = &arguments.quantity else {
        return list(&fields);
    };
    let mut picture = FieldPicture::new(quantity);
    picture.sets = arguments.sets;
    picture.deformation = arguments.deformed;
    picture.view = arguments.view;
    picture.cut = arguments.cut;
    picture.whole = arguments.whole;
    picture.range = arguments.range;
    if let Some(size) = arguments.size {
        picture.size = size;
    }
    let index = instant(&fields, arguments.time)?;
    let instants = fields.between(arguments.from, arguments.to);
    if arguments.animate && instants.len() < 2 {
        let known = span(&fields).map_or("no snapshots are here".into(), |[first, last]| {
            format!("snapshots are from {first} to {last} s")
        });
        let chosen = instants.len();
        let text = format!(
            "an animation needs two snapshots or more, and {chosen} would be drawn; {known}"
        );
        return Err(text.into());
    }
    let file = match arguments.out {
        Some(file) => {
            check_ending(&file, ("picture", "png"))?;
            file
        }
        None => {
            let mut parts = vec![quantity.clone()];
            parts.extend(picture.sets.iter().cloned());
            if picture.deformation.is_some() {
                parts.push("deformed".into());
            }
            if let Some(direction) = picture.view {
                parts.push(format!("view{}", axis_name(direction)));
            }
            if let Some(SectionPlane { point, normal }) = &picture.cut {
                let value = shown_number(point.dot(normal));
                parts.push(format!("cut{}{value}", axis_name(*normal)));
            }
            let when = match (arguments.animate, fields.times().nth(index)) {
                (true, _) => "-animation".into(),
                (false, Some(time)) => format!("-{}s", shown_number(time)),
                (false, None) => String::new(),
            };
            let name = format!("{}{when}.png", file_name(&parts.join("-")));
            fields.place("pictures", &name)
        }
    };
    if !arguments.animate {
        picture.write(&fields, index, &file)?;
        return written(&file);
    }
    let by_default = (LENGTH / instants.len() as f64).clamp(0.02, SLOWEST);
    let seconds = arguments.rate.map_or(by_default, |rate| 1.0 / rate);
    let animation = Animation { instants, seconds };
    picture.animate(&fields, &animation, &file)?;
    written(&file)
}

fn written(file: &Path) -> Outcome {
    say!("{}", file.display());
    Ok(ExitCode::SUCCESS)
}

/// Lists times and quantities.
fn list(fields: &RecordedFields) -> Outcome {
    let times: Vec<f64> = fields.times().collect();
    if let [first, .., last] = times[..] {
        let [first, last] = [first, last].map(shown_number);
        say!("{} snapshots from {first} to {last} s", times.len());
    }
    let grid = fields.read(fields.nearest(None))?;
    for (place, list) in [("nodes", &grid.at_nodes), ("elements", &grid.in_elements)] {
        for field in list {
            let parts = FieldPart::names(field.components).iter();
            let parts: Vec<String> = parts.map(|part| format!(".{part}")).collect();
            let whole = if field.components == 3 { ", " } else { "" };
            let parts = format!("{whole}{}", parts.join(", "));
            say!(
                "{:<28} {:<6} of {place}",
                format!("{}{parts}", field.name),
                field.unit
            );
        }
    }
    let sets: Vec<&str> = grid
        .mesh
        .element_sets()
        .keys()
        .map(String::as_str)
        .collect();
    say!("element sets: {}", sets.join(", "));
    Ok(ExitCode::SUCCESS)
}

/// First and last time of snapshots as texts (s); none of one file that is no snapshot.
fn span(fields: &RecordedFields) -> Option<[String; 2]> {
    let first = fields.times().next()?;
    let last = fields.times().last()?;
    Some([first, last].map(shown_number))
}

/// Index of the instant nearest to a time (s), with a warning if the time is outside of the snapshots.
pub(crate) fn instant(
    fields: &RecordedFields,
    time: Option<f64>,
) -> Result<usize, Box<dyn std::error::Error>> {
    let index = fields.nearest(time);
    if let Some(time) = time {
        let Some([first, last]) = span(fields) else {
            return Err(
                "a time is for the snapshots in the folder of the results: this file has none"
                    .into(),
            );
        };
        let is_within =
            fields.times().any(|own| own <= time) && fields.times().any(|own| own >= time);
        if !is_within {
            say_warning!(
                "snapshots are from {first} to {last} s: the nearest to {time} s is taken"
            );
        }
    }
    Ok(index)
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = finite(text)
        .ok()
        .filter(|rate| (0.1..=100.0).contains(rate));
    rate.ok_or_else(|| "a number of pictures in a second from 0.1 to 100".into())
}

/// Reads a finite number.
pub(crate) fn finite(text: &str) -> Result<f64, String> {
    let number = text.trim().parse::<f64>().ok();
    number
        .filter(|number| number.is_finite())
        .ok_or_else(|| "a finite number".into())
}

/// Reads numbers that commas separate.
pub(crate) fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|part| finite(part).ok()).collect();
    numbers?.try_into().ok()
}

fn deformation(text: &str) -> Result<DeformationFactor, String> {
    match text {
        "auto" => Ok(DeformationFactor::Automatic),
        text => finite(text)
            .ok()
            .filter(|factor| factor.abs() <= MOST_DEFORMED)
            .map(DeformationFactor::Factor)
            .ok_or_else(|| format!("`auto` or a factor of at most {MOST_DEFORMED:e}")),
    }
}

fn axis(text: &str) -> Result<Vec3, String> {
    let (sign, name) = match text.strip_prefix('-') {
        Some(name) => (-1.0, name),
        None => (1.0, text),
    };
    let unit = match name {
        "x" => Vec3::x(),
        "y" => Vec3::y(),
        "z" => Vec3::z(),
        _ => return Err("x, y, z, -x, -y or -z".into()),
    };
    Ok(sign * unit)
}

/// Name of an axis with its sign.
fn axis_name(direction: Vec3) -> String {
    let axis = direction.iamax();
    let sign = if direction[axis] < 0.0 { "-" } else { "" };
    format!("{sign}{}", ["x", "y", "z"][axis])
}

/// Reads a plane.
fn cut(text: &str) -> Result<SectionPlane, String> {
    let plane = text.split_once('=').and_then(|(name, value)| {
        let axis = axis(name).ok()?;
        let value = finite(value).ok()?;
        Some(SectionPlane {
            point: axis * value,
            normal: axis,
        })
    });
    plane.ok_or_else(|| "a plane such as y=6.85".into())
}

fn range(text: &str) -> Result<[f64; 2], String> {
    let ends = numbers::<2>(text).filter(|[low, high]| low < high);
    ends.ok_or_else(|| "two numbers, the lower first, such as -2,1".into())
}

fn size(text: &str) -> Result<[u32; 2], String> {
    let size = text.split_once('x').and_then(|(width, height)| {
        let pixels = |text: &str| text.parse::<u32>().ok().filter(|n| PIXELS.contains(n));
        Some([pixels(width)?, pixels(height)?])
    });
    size.ok_or_else(|| "a width and a height from 64 to 4096, such as 1200x900".into())
}
