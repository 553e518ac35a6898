//! Motions at stations from a file: their place and direction in the mesh, and the field that they are.

use super::draft::Draft;
use powerhouse_boundary::ReductionLayer;
use powerhouse_io::{StationForm, StationMotions, available_memory, read_station_motions};
use powerhouse_model::Vec3;
use powerhouse_wavefield::{StationField, StationParameters};

use super::vector;
use crate::spec::{At, Finite, Interpolation, SceneSpec, StationAxis, Stations};
use powerhouse_scene::{Error, Fault, Problem, Remark, SceneText, magnitude, remark};

/// Share of the available memory that motions may take.
const SHARE_OF_MEMORY: u64 = 2;
/// Memory (bytes) that motions may take where the available memory is not known.
const MOST_MEMORY: u64 = 4 << 30;
/// Default tolerance (m).
const TOLERANCE: f64 = 1e-3;
/// Directions of rows and of coordinates.
const EAST_NORTH_DOWN: [StationAxis; 3] = [StationAxis::X, StationAxis::Y, StationAxis::MinusZ];
const NORTH_EAST_DOWN: [StationAxis; 3] = [StationAxis::Y, StationAxis::X, StationAxis::MinusZ];
const OF_MESH: [StationAxis; 3] = [StationAxis::X, StationAxis::Y, StationAxis::Z];
/// Hint on rows in another order than those of the control point.
const OTHER_ROWS: &str = "`rows` says which direction of the mesh each row of the stations has; some versions of ShakerMaker write vertical, east, north: `rows = [\"-z\", \"x\", \"y\"]`";

/// Stations of a scene file, if there are any. They take the place of waves and need a region around which they lie.
pub(super) fn section(file: &SceneSpec) -> Result<Option<&At<Stations>>, Fault> {
    let Some(boundary) = &file.boundary else {
        return Ok(None);
    };
    let Some(stations) = &boundary.stations else {
        return Ok(None);
    };
    let others = [
        ("wave", !file.waves.is_empty()),
        ("motion", !file.motions.is_empty()),
        ("layer", !file.layers.is_empty()),
    ];
    if let Some((key, _)) = others.iter().find(|(_, is_given)| *is_given) {
        let problem = Problem::Value {
            found: format!("stations beside a [[{key}]]"),
            expected: "one of them: the motions at the stations are the whole free field".into(),
        };
        return Err(Fault::new(stations.span(), problem));
    }
    if boundary.region.is_none() {
        let key = "region".into();
        let fault = Fault::new(stations.span(), Problem::MissingKey { key });
        return Err(fault.with_help(
            "motions at stations have no stress: they enter through the layer of elements around a region, not through springs and dashpots",
        ));
    }
    Ok(Some(stations))
}

/// Adds the motions at the stations of a file to the scene, as its field.
pub(super) fn field(
    text: &SceneText,
    stations: &At<Stations>,
    mut scene: Draft,
) -> Result<Draft, Fault> {
    let place = stations.file.span();
    scene.places.field = place.clone();
    if scene.places.start.is_empty() {
        scene.places.start = place.clone();
    }
    let path = text.folder().join(&*stations.file);
    let most = available_memory().map_or(MOST_MEMORY, |memory| memory / SHARE_OF_MEMORY);
    let mut motions =
        read_station_motions(&path, most).map_err(|error| Fault::refused(place.clone(), error))?;
    let (scale, axes, rows) = match motions.form {
        StationForm::H5drm => (1000.0, NORTH_EAST_DOWN, EAST_NORTH_DOWN),
        _ => (1.0, OF_MESH, OF_MESH),
    };
    let scale = stations.scale.as_ref().map_or(scale, |scale| scale.get());
    let axes = directions(stations.axes.as_ref(), axes)?;
    if let (Some(order), None) = (motions.other_order, &stations.rows) {
        let place = stations.span();
        let number = order.map(|row| (row + 1).to_string());
        let found = format!(
            "stations whose rows are not in the order of the control point's (DRM_QA_Data): by their strength its rows 1, 2, 3 are their rows {}",
            number.join(", ")
        );
        let expected = "one order of the rows, or `rows`".into();
        return Err(Fault::new(place, Problem::Value { found, expected }).with_help(OTHER_ROWS));
    }
    let rows = directions(stations.rows.as_ref(), rows)?;
    let origin = stations
        .origin
        .as_ref()
        .map_or(Vec3::zeros(), |at| vector(at));
    let from = motions.origin;
    let positions = motions.positions.iter().map(|position| {
        let mut point = origin;
        for ((x, from), axis) in position.iter().zip(from).zip(axes) {
            let (axis, sign) = axis.direction();
            point[axis] += sign * scale * (x - from);
        }
        point
    });
    let positions: Vec<Vec3> = positions.collect();
    if stations.interpolation.as_deref() == Some(&Interpolation::Linear) {
        without_velocity(&mut motions);
    }
    if let (Some(interpolation), false) = (&stations.interpolation, motions.has_velocity)
        && **interpolation == Interpolation::Cubic
    {
        let found = "cubic interpolation of motions without velocities".into();
        let expected = "linear, or a file with velocities".into();
        return Err(Fault::new(
            interpolation.span(),
            Problem::Value { found, expected },
        ));
    }
    let factor = stations.factor.map_or(1.0, Finite::get);
    for vector in motions.motion.chunks_exact_mut(3) {
        let of_rows = [vector[0], vector[1], vector[2]];
        for (number, axis) in of_rows.into_iter().zip(rows) {
            let (axis, sign) = axis.direction();
            vector[axis] = sign * factor * number;
        }
    }
    let name = stations.file.display().to_string();
    let field = StationField::new(StationParameters {
        name: name.clone(),
        positions,
        inner: Some(motions.inner),
        medium: medium(&scene).map_err(|error| Fault::refused(place.clone(), error))?,
        start: motions.start,
        step: motions.step,
        samples: motions.samples,
        has_velocity: motions.has_velocity,
        motion: motions.motion,
        tolerance: stations.tolerance.as_ref().map_or(TOLERANCE, |at| at.get()),
    });
    let field = field.map_err(|error| Fault::refused(stations.span(), error))?;
    let report = *field.report();
    if !scene.magnitudes_allowed {
        let sampled = magnitude::RECORD_STEP.check("time between samples", report.step);
        let peak = report.peak_acceleration;
        let strong = if peak > 0.0 {
            magnitude::RECORDED_PEAK.check("peak acceleration of the stations", peak)
        } else {
            Ok(())
        };
        let checked = sampled.and(strong);
        checked.map_err(|magnitude| Fault::of_magnitude(stations.span(), magnitude))?;
    }
    scene.remarks.push(Remark::from(remark::Stations {
        file: name.clone(),
        scale,
        axes: axes.map(StationAxis::name),
        rows: rows.map(StationAxis::name),
        report,
    }));
    for warning in motions.warnings {
        let name = name.clone();
        scene
            .remarks
            .push(remark::RecordFile { name, warning }.into());
    }
    let end = scene.start + scene.duration;
    let start = scene.start;
    if end > report.end + 0.5 * report.step || scene.start < report.start {
        scene.remarks.push(Remark::from(remark::StationWindow {
            file: name,
            run: [start, end],
            report,
        }));
    }
    scene.change(|scene| Ok(scene.with_field(field)))
}

/// Directions of three coordinates or rows, each along another axis.
fn directions(
    given: Option<&At<[StationAxis; 3]>>,
    default: [StationAxis; 3],
) -> Result<[StationAxis; 3], Fault> {
    let Some(given) = given else {
        return Ok(default);
    };
    let mut axes = given.map(|axis| axis.direction().0);
    axes.sort_unstable();
    if axes == [0, 1, 2] {
        return Ok(**given);
    }
    let found = format!("{:?}", given.map(StationAxis::name));
    let expected = "one direction along each of x, y and z".into();
    Err(Fault::new(given.span(), Problem::Value { found, expected }))
}

/// Takes the velocities out.
fn without_velocity(motions: &mut StationMotions) {
    if motions.has_velocity {
        let mut index = 0;
        motions.motion.retain(|_| {
            index += 1;
            (index - 1) % 6 < 3
        });
        motions.has_velocity = false;
    }
}

/// Medium of the elements of the layer around the region, which is checked when the model is built; of any part if there is
/// none.
fn medium(scene: &Draft) -> Result<powerhouse_model::ElasticMedium, Error> {
    let region = scene.boundary.as_ref().and_then(|b| b.region.as_deref());
    let layer = ReductionLayer::elements(&scene.mesh, region.unwrap_or_default());
    let owner = scene.part_of_elements()?;
    let part = layer.first().and_then(|element| owner[*element as usize]);
    Ok(scene.parts[part.unwrap_or(0)].material.medium())
}
