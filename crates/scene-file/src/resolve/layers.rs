//! Layered ground of a scene file, and the waves in it.

use super::draft::Draft;
use std::collections::BTreeMap;

use powerhouse_model::{IncidentField, ModelError, Vec3};
use powerhouse_wavefield::{
    Angle, Ground, GroundLayer, InputConvention, LayerDamping, LayeredWave, LayeredWaveParameters,
    PlaneWaveParameters, QuietStart, QuietStartLimits, Signal, WaveError, first_hit_corner,
};

use super::damping::damping;
use super::ground::{FASTER, QUIETER, motion, note_arrivals, refused_wave, unclear_axis};
use super::motion::{Split, split};
use super::origin::Origin;
use super::record::PreparedRecord;
use super::{named, vector};
use crate::spec::{Azimuth, Layer, SceneSpec, Space};
use powerhouse_laws::Material;
use powerhouse_scene::internal::{box_corners, damping_of_layer};
use powerhouse_scene::{Fault, InitialMotion, LayerError, Problem, Remark, remark};

/// Time after the run (s), and over its duration, up to which the field is known as well: spectra of the input fade out there.
const AFTER: f64 = 1.0;
const AFTER_SHARE: f64 = 0.05;
/// Share of a layer's thickness by which its interface may be off a plane of the mesh.
const OFF_PLANE: f64 = 1e-3;

/// Adds the sum of all waves in layered ground to the scene; `damping` is that of the layers above the half-space.
pub(super) fn field(
    file: &SceneSpec,
    mut scene: Draft,
    records: &BTreeMap<String, PreparedRecord>,
    materials: &BTreeMap<String, Material>,
    damping: &[LayerDamping],
) -> Result<Draft, Fault> {
    let ground = ground(file, &scene, materials, damping)?;
    let (low, high) = scene.mesh.bounding_box();
    let points = outermost(&ground, &low, &high);
    for table in &file.waves {
        scene.remarks.extend(unclear_axis(table, file));
    }
    let Waves {
        waves,
        origins,
        splits,
    } = waves(file, &scene, records, (&ground, scene.duration))?;
    for wave in &waves[..file.waves.len()] {
        let convention = wave.parameters().convention;
        if convention != InputConvention::Incident {
            scene.remarks.push(Remark::from(remark::Conversion {
                wave: wave.name().into(),
                convention: convention.name(),
                conversion: *wave.conversion(),
            }));
        }
    }
    let nodes = nodes_of_faces(&scene)?;
    for wave in &waves {
        let bytes = wave.bytes_for(&nodes);
        let place = scene.places.field.clone();
        let bytes = bytes.map_err(|error| Fault::refused(place, error))?;
        scene.remarks.push(Remark::from(remark::Layered {
            wave: wave.name().into(),
            report: wave.report(),
            bytes,
        }));
    }
    let waves = quiet(waves, &origins, &points, &mut scene)?;
    let arrivals: Vec<f64> = waves.iter().map(|wave| wave.parameters().arrival).collect();
    let remarks = splits.iter();
    let remarks = remarks.map(|(last, split)| split.remark(arrivals[*last]));
    scene.remarks.extend(remarks);
    note_arrivals(&origins, &mut scene, &arrivals);
    let place = scene.places.field.clone();
    let driven = scene.change(|scene| scene.with_layered_waves(waves));
    driven.map_err(|error| Fault::refused(place, error))
}

/// Waves of a file in layered ground, those of `[[wave]]` before those of `[[motion]]`.
pub(super) struct Waves<'r> {
    pub(super) waves: Vec<LayeredWave>,
    origins: Vec<Origin<'r>>,
    /// Motions that were split into waves, with the index of the last wave of each.
    splits: Vec<(usize, Split<'r>)>,
}

/// The waves of a file in a ground, known for a duration (s) from the start of the run, before any delay for a start at rest.
pub(super) fn waves<'r>(
    file: &SceneSpec,
    scene: &Draft,
    records: &'r BTreeMap<String, PreparedRecord>,
    (ground, duration): (&Ground, f64),
) -> Result<Waves<'r>, Fault> {
    let (low, high) = scene.mesh.bounding_box();
    let points = outermost(ground, &low, &high);
    let end = scene.start + duration + AFTER.max(AFTER_SHARE * duration);
    let (mut waves, mut origins) = (Vec::new(), Vec::new());
    // Strains are taken in the middle of their layers, which may reach below the mesh.
    let soft = file.layers.iter().zip(ground.layers());
    let bottoms = soft.filter(|(table, _)| table.strain_curves.is_some());
    let bottoms = bottoms.map(|(_, layer)| layer.bottom);
    let lowest = bottoms.fold(low.z.min(ground.surface()), f64::min);
    for table in &file.waves {
        let mut parameters = LayeredWaveParameters::vertical(table.kind, ground.clone(), lowest);
        parameters.incidence = Angle::from_degrees(table.incidence.get());
        parameters.azimuth = Angle::from_degrees(table.azimuth.map_or(0.0, Azimuth::get));
        parameters.reference = match &table.reference {
            Some(reference) => vector(reference),
            None => {
                let (half_space, surface) = (ground.half_space(), ground.surface());
                let mut plane = PlaneWaveParameters::vertical(table.kind, half_space, surface);
                plane.incidence = parameters.incidence;
                plane.azimuth = parameters.azimuth;
                first_hit_corner(&low, &high, &plane.direction())
            }
        };
        let motion = motion(table, records, scene.magnitudes_allowed)?;
        parameters.convention = motion.convention;
        parameters.arrival = table.arrival.as_ref().map_or(0.0, |arrival| arrival.get());
        parameters.arrival -= motion.lead;
        parameters.until = Some(needed(&parameters, &*motion.signal, &points, end));
        let wave = (scene.known_waves)
            .wave(parameters, motion.signal)
            .map_err(|error| refused_wave(table, motion.span, error))?;
        origins.push(Origin::of_wave(table, records)?);
        waves.push(wave);
    }
    let mut splits = Vec::with_capacity(file.motions.len());
    for table in &file.motions {
        let split = split(table, ground, records, scene)?;
        let parameters = split.waves.iter().map(|wave| {
            let mut parameters = LayeredWaveParameters::vertical(wave.kind, ground.clone(), lowest);
            parameters.incidence = wave.incidence;
            parameters.azimuth = split.azimuth;
            parameters.reference = split.reference;
            parameters
        });
        let parameters: Vec<LayeredWaveParameters> = parameters.collect();
        let travel = parameters.iter().map(|wave| earliest(wave, &points));
        let arrival = split.arrival(travel, scene.start);
        for (mut parameters, wave) in parameters.into_iter().zip(&split.waves) {
            parameters.arrival = arrival - split.origin.lead;
            parameters.until = Some(needed(&parameters, &*wave.signal, &points, end));
            let wave = scene.known_waves.wave(parameters, wave.signal.clone());
            waves.push(wave.map_err(|error| Fault::refused(table.incidence.span(), error))?);
            origins.push(split.origin.clone());
        }
        splits.push((waves.len() - 1, split));
    }
    Ok(Waves {
        waves,
        origins,
        splits,
    })
}

/// Ground of the layers of a file, their interfaces on planes of the mesh; `damping` is that of the layers above the
/// half-space.
pub(super) fn ground(
    file: &SceneSpec,
    scene: &Draft,
    materials: &BTreeMap<String, Material>,
    damping: &[LayerDamping],
) -> Result<Ground, Fault> {
    let Some((last, above)) = file.layers.split_last() else {
        return Err(Fault::new(
            0..0,
            Problem::MissingKey {
                key: "layer".into(),
            },
        ));
    };
    let value = |span, found: &str, expected: &str| {
        let (found, expected) = (found.into(), expected.into());
        Fault::new(span, Problem::Value { found, expected })
    };
    if file.ground.space == Space::FullSpace {
        let expected = "layers of a half-space: without `space = \"full-space\"`";
        return Err(value(
            last.material.span(),
            "layers in a full space",
            expected,
        ));
    }
    if let Some(bottom) = &last.bottom {
        let expected = "no `bottom` of the last layer, which is the half-space below the others";
        return Err(value(bottom.span(), &format!("{}", bottom.get()), expected));
    }
    if let Some(damping) = (last.damping.as_ref()).filter(|damping| !damping.is_none()) {
        let expected = "an elastic half-space: incident waves would grow with depth";
        return Err(value(damping.span(), "damping of the last layer", expected));
    }
    let level = scene.level_of_sides();
    let level = level.map_err(|error| Fault::refused(scene.places.faces.clone(), error))?;
    let surface = file.ground.surface.as_ref().map_or(level, |at| at.get());
    let half_space = named("material", &last.material, materials)?.medium();
    let mut layers = Vec::with_capacity(above.len());
    for layer in above {
        let Some(bottom) = &layer.bottom else {
            let key = "bottom".into();
            return Err(Fault::new(
                layer.material.span(),
                Problem::MissingKey { key },
            ));
        };
        let medium = named("material", &layer.material, materials)?.medium();
        let layer = GroundLayer::new(bottom.get(), medium);
        layers.push(layer.with_damping(damping[layers.len()].clone()));
    }
    let made = |layers: Vec<GroundLayer>| {
        Ground::new(surface, layers, half_space).map_err(|error| {
            let index = match &error {
                WaveError::Layer { index, .. } => *index,
                _ => 0,
            };
            let layer = &file.layers[index.min(above.len())];
            let bottom = layer.bottom.as_ref().map(|bottom| bottom.span());
            Fault::refused(bottom.unwrap_or(layer.material.span()), error)
        })
    };
    let given = made(layers.clone())?;
    let moved = on_planes(&given, scene)?;
    for (layer, (bottom, table)) in layers.iter_mut().zip(moved.into_iter().zip(above)) {
        layer.bottom = bottom.map_err(|error| {
            let span = table.bottom.as_ref().map_or(0..0, |bottom| bottom.span());
            Fault::refused(span, error)
        })?;
    }
    made(layers)
}

/// Damping of a layer by its own key.
pub(super) fn damping_of(layer: &Layer) -> Result<LayerDamping, Fault> {
    let Some(table) = &layer.damping else {
        return Ok(LayerDamping::None);
    };
    damping_of_layer(&damping(table)?).ok_or_else(|| {
        let (found, expected) = ("Rayleigh damping".into(), "damping of kind \"flat\"".into());
        Fault::new(table.span(), Problem::Value { found, expected })
    })
}

/// Interfaces moved to the heights of the next nodes of the mesh, as far as it reaches: of those of the absorbing faces where
/// the interface crosses these, else of any, as of a column whose sides are periodic.
fn on_planes(ground: &Ground, scene: &Draft) -> Result<Vec<Result<f64, LayerError>>, Fault> {
    let of = |points: &[Vec3]| -> Vec<f64> { points.iter().map(|point| point.z).collect() };
    let range = |heights: &[f64]| {
        let heights = heights.iter();
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| {
            [a.min(*z), b.max(*z)]
        })
    };
    let of_faces = of(&nodes_of_faces(scene)?);
    let [low_face, high_face] = range(&of_faces);
    let of_mesh = of(scene.mesh.positions());
    let [lowest, _] = range(&of_mesh);
    let layers = ground.layers();
    let top = |index: usize| match index {
        0 => ground.surface(),
        _ => layers[index - 1].bottom,
    };
    let thickness = |index: usize| top(index) - layers[index].bottom;
    let moved = layers.iter().enumerate().map(|(index, layer)| {
        let below = (index + 1 < layers.len()).then(|| thickness(index + 1));
        let thickness = thickness(index).min(below.unwrap_or(f64::INFINITY));
        let tolerance = OFF_PLANE * thickness;
        let interface = layer.bottom;
        let is_crossed = interface >= low_face - tolerance && interface <= high_face + tolerance;
        let heights = if is_crossed { &of_faces } else { &of_mesh };
        let distance = |height: &&f64| (**height - interface).abs();
        let nearest = heights
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let Some(&nearest) = nearest.filter(|_| interface > lowest - tolerance) else {
            return Ok(interface);
        };
        let off = (nearest - interface).abs();
        if off <= tolerance {
            Ok(nearest)
        } else {
            Err(LayerError::NoPlane {
                interface,
                nearest,
                off,
                thickness,
            })
        }
    });
    Ok(moved.collect())
}

/// Positions of the nodes of the absorbing faces.
fn nodes_of_faces(scene: &Draft) -> Result<Vec<Vec3>, Fault> {
    let place = scene.places.faces.clone();
    let faces = scene.absorbing_facets();
    let faces = faces.map_err(|error| Fault::refused(place, error))?;
    let nodes = faces
        .iter()
        .flat_map(|(_, facets)| scene.mesh.nodes_of_facets(facets));
    Ok(nodes
        .map(|node| scene.mesh.positions()[node as usize])
        .collect())
}

/// Corners of the mesh, and the points of its vertical edges on interfaces.
fn outermost(ground: &Ground, low: &Vec3, high: &Vec3) -> Vec<Vec3> {
    let top = high.z.min(ground.surface());
    let mut points = box_corners(low, &Vec3::new(high.x, high.y, top)).to_vec();
    for interface in ground
        .interfaces()
        .iter()
        .filter(|z| **z > low.z && **z < top)
    {
        let corners = box_corners(low, high);
        points.extend(
            corners[..4]
                .iter()
                .map(|corner| Vec3::new(corner.x, corner.y, *interface)),
        );
    }
    points
}

/// Earliest arrival of the time zero of a wave's signal at some points (s).
fn earliest(parameters: &LayeredWaveParameters, points: &[Vec3]) -> f64 {
    let arrivals = points.iter().map(|point| parameters.arrival_at(point));
    arrivals.fold(f64::INFINITY, f64::min)
}

/// Time (s) from the arrival of a wave at the first of some points to the end of the time in which it is known.
fn needed(
    parameters: &LayeredWaveParameters,
    signal: &dyn Signal,
    points: &[Vec3],
    end: f64,
) -> f64 {
    let earliest = earliest(parameters, points) + signal.support().start;
    (end - earliest).max(0.0)
}

/// Delays all waves so that the field is negligible at the start of a body at rest.
fn quiet(
    waves: Vec<LayeredWave>,
    origins: &[Origin],
    points: &[Vec3],
    scene: &mut Draft,
) -> Result<Vec<LayeredWave>, Fault> {
    if scene.initial == InitialMotion::Field {
        return Ok(waves);
    }
    let limits = QuietStartLimits::default();
    let mut quiet: Vec<(LayeredWave, Option<QuietStart>)> = Vec::with_capacity(waves.len());
    for (wave, origin) in waves.into_iter().zip(origins) {
        let refused = |error: ModelError| Fault::refused(origin.incidence.clone(), error);
        let of_ends = scene.check_layered_wave_at_ends(&wave);
        of_ends.map_err(|error| Fault::refused(origin.incidence.clone(), error))?;
        let level = wave.start_level(points, scene.start).map_err(refused)?;
        if level.largest() < limits.threshold {
            quiet.push((wave, None));
            continue;
        }
        let lead = origin.lead;
        let arrival = earliest(wave.parameters(), points) + lead;
        if origin.is_timed && arrival < scene.start {
            return Err(origin.early(wave.name(), level.largest(), scene));
        }
        let delayed = wave.with_quiet_start(points, scene.start, &limits);
        let (wave, start) = delayed.map_err(|error| {
            if lead > 0.0 {
                refused(error).with_help(QUIETER)
            } else {
                refused(error).with_help(FASTER)
            }
        })?;
        quiet.push((wave, Some(start)));
    }
    let own = |start: &Option<QuietStart>| start.map_or(0.0, |start| start.padding);
    let paddings = quiet.iter().map(|(_, start)| own(start));
    let padding = paddings.fold(0.0, f64::max);
    let delayed = quiet
        .iter()
        .map(|(wave, start)| wave.later(padding - own(start)));
    let delayed: Vec<LayeredWave> = delayed.collect();
    let needed = quiet.into_iter();
    let needed = needed.filter_map(|(wave, start)| Some((wave.name().to_owned(), start?)));
    let waves: Vec<(String, QuietStart)> = needed.collect();
    if !waves.is_empty() {
        scene
            .remarks
            .push(remark::QuietStart { padding, waves }.into());
    }
    Ok(delayed)
}
