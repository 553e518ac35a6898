//! Construction stages, bolts and in-situ stress from scene files.

use super::draft::Draft;
use std::collections::BTreeMap;

use powerhouse_elements::{BoltLine, BoltParameters, BoltPattern, WaterPressure};
#[cfg(feature = "direct")]
use powerhouse_model::Linearisation;
use powerhouse_model::{Facet, Mesh, StaticMethod, StaticOptions, Stress, StressField, Support};

use super::loads::{self, direction, mean_normal};
use super::pore_water::{PressureKeys, given_pressure};
use super::{Names, named, one_of, vector};
use crate::spans::StageSpans;
use crate::spec::{self, At, Finite, NonNegative, Positive, SceneSpec, StageSupport};
use powerhouse_laws::Material;
use powerhouse_scene::internal::{GRAVITY, Timeline, check_removal, surface_of};
use powerhouse_scene::{
    BoltLayout, Fault, InSituStress, Problem, SceneBolts, SceneStage, SceneText, StageWater,
    WeightLayer,
};

/// Young's modulus of steel (Pa).
const STEEL: f64 = 200.0e9;

/// Composes and checks stages, bolts and in-situ stress.
pub(super) fn stages(
    text: &SceneText,
    names: &Names,
    file: &SceneSpec,
    materials: &BTreeMap<String, Material>,
    scene: &mut Draft,
) -> Result<(), Fault> {
    scene.places.stages = stage_spans(file);
    if let Some(stress) = &file.in_situ_stress {
        scene.in_situ_stress = Some(in_situ(text, names.mesh, stress)?);
    }
    for bolts in &file.bolts {
        scene.bolts.push(self::bolts(names, bolts)?);
    }
    for stage in &file.stages {
        scene.stages.push(self::stage(names, stage, materials)?);
    }
    let timeline = Timeline::of(scene).map_err(|error| {
        let span = scene.places.of(&error).unwrap_or_default();
        Fault::refused(span, error)
    })?;
    let Some(timeline) = timeline else {
        return Ok(());
    };
    for (index, stage) in file.stages.iter().enumerate() {
        let present = timeline.present_in(index);
        for load in &stage.loads {
            if let Some(name) = load.removed_in() {
                let checked = check_removal(&scene.stages, index, name);
                checked.map_err(|error| Fault::refused(name.span(), error))?;
            }
            let facets = |set: &At<String>| -> Result<Vec<Facet>, Fault> {
                let facets = surface_of(names.mesh, present, names.facets(set)?);
                if facets.is_empty() {
                    let found = "facets inside the body or of inactive elements".into();
                    let expected = "facets on its surface".into();
                    return Err(Fault::new(set.span(), Problem::Value { found, expected }));
                }
                Ok(facets)
            };
            let own = &mut scene.stages[index];
            match loads::load(names, load, &facets)? {
                loads::LoadOrWeight::Load(load) => own.loads.push(load),
                loads::LoadOrWeight::Weight(acceleration, history) => {
                    own.weights.push((acceleration, history.into()));
                }
            }
        }
    }
    Ok(())
}

/// Byte ranges of stages and of the values in them.
fn stage_spans(file: &SceneSpec) -> StageSpans {
    let mut spans = StageSpans::default();
    let mut put = |stage: Option<&At<String>>, key, value: &str, span| {
        let stage = stage.map(|stage| stage.to_string());
        spans.items.insert((stage, key, value.to_owned()), span);
    };
    for bolts in &file.bolts {
        put(None, "bolt", bolts.name.as_str(), bolts.name.span());
    }
    let needing_stages = [
        file.in_situ_stress.as_ref().map(At::span),
        file.bolts.first().map(|bolts| bolts.name.span()),
    ];
    if let Some(span) = needing_stages.into_iter().flatten().next() {
        put(None, "stage", "", span);
    }
    put(None, "initial", "", file.time.initial.span());
    for name in file.loads.iter().filter_map(|load| load.removed_in()) {
        put(None, "removed_in", name.as_str(), name.span());
    }
    for joint in &file.joints {
        if let Some(preload) = &joint.preload {
            put(None, "preload", joint.name.as_str(), preload.span());
        }
    }
    for stage in &file.stages {
        let of_stage = Some(&stage.name);
        for (key, values) in [
            ("excavate", &stage.excavate),
            ("cast", &stage.cast),
            ("bolts", &stage.bolts),
            ("joint", &stage.tied),
            ("joint", &stage.grouted),
        ] {
            for value in values {
                put(of_stage, key, value.as_str(), value.span());
            }
        }
        for part in &stage.parts {
            put(of_stage, "part", part.set.as_str(), part.set.span());
        }
        for water in &stage.water {
            match &water.set {
                Some(set) => put(of_stage, "water", set.as_str(), set.span()),
                None => put(of_stage, "water", "", water.span()),
            }
        }
        if let Some(undrained) = &stage.undrained {
            put(of_stage, "undrained", "", undrained.span());
        }
        if let Some(tolerance) = &stage.tolerance {
            put(of_stage, "options", "tolerance", tolerance.span());
        }
        if let Some(increments) = &stage.increments {
            put(of_stage, "options", "increments", increments.span());
        }
        if let Some(release) = &stage.release {
            put(of_stage, "options", "release", release.span());
        }
    }
    let names = file.stages.iter();
    spans.names = names
        .map(|stage| (stage.name.to_string(), stage.name.span()))
        .collect();
    spans
}

fn in_situ(
    text: &SceneText,
    mesh: &Mesh,
    stress: &At<spec::InSituStress>,
) -> Result<InSituStress, Fault> {
    match &**stress {
        spec::InSituStress::Ground {
            level,
            density,
            lateral,
            lateral_y,
            water,
        } => {
            let lateral = [*lateral, lateral_y.unwrap_or(*lateral)].map(NonNegative::get);
            let (level, unit_weight) = (level.get(), density.get() * GRAVITY);
            let found = match water {
                None => {
                    StressField::geostatic(level, unit_weight, lateral).map(InSituStress::Field)
                }
                Some(water) => {
                    let bottom = f64::NEG_INFINITY;
                    let layer = WeightLayer {
                        bottom,
                        unit_weight,
                        lateral,
                    };
                    InSituStress::layers_in_water(level, &[layer], &ground_water(stress, water)?)
                }
            };
            found.map_err(|error| Fault::refused(stress.span(), error))
        }
        spec::InSituStress::Layers {
            level,
            layers,
            water,
        } => {
            let layers = weight_layers(level.get(), layers)?;
            let found = match water {
                None => InSituStress::layers(level.get(), &layers),
                Some(water) => {
                    let water = ground_water(stress, water)?;
                    InSituStress::layers_in_water(level.get(), &layers, &water)
                }
            };
            found.map_err(|error| Fault::refused(stress.span(), error))
        }
        spec::InSituStress::Linear {
            level,
            stress,
            gradient,
        } => Ok(InSituStress::Field(StressField {
            surface: level.get(),
            at_surface: stress.map_or(Stress::default(), |stress| Stress(stress.map(Finite::get))),
            gradient: Stress(gradient.map(Finite::get)),
            ends: false,
        })),
        spec::InSituStress::Elements { file } => {
            let path = text.folder().join(&**file);
            InSituStress::read(&path, mesh).map_err(|error| Fault::refused(file.span(), error))
        }
    }
}

/// Pressure of the water in the ground of an in-situ stress.
pub(super) fn ground_water(
    stress: &At<spec::InSituStress>,
    water: &spec::GroundWater,
) -> Result<WaterPressure, Fault> {
    let keys = PressureKeys::new(&water.level, &water.pressures, water.density);
    given_pressure(stress.span(), keys)
}

/// Layers of ground under their own weight, each below the one before, of which the last alone has no lower end.
fn weight_layers(
    level: f64,
    layers: &At<Vec<spec::StressLayer>>,
) -> Result<Vec<WeightLayer>, Fault> {
    let fault = |span, found: String, expected: String| {
        Err(Fault::new(span, Problem::Value { found, expected }))
    };
    let Some(last) = layers.len().checked_sub(1) else {
        return fault(layers.span(), "no layers".into(), "at least one".into());
    };
    let mut found = Vec::with_capacity(layers.len());
    let mut top = level;
    for (index, layer) in layers.iter().enumerate() {
        let bottom = match &layer.bottom {
            Some(bottom) if index == last => {
                let given = format!("a lower end of the last layer, {} m", bottom.get());
                let expected = "a last layer without `bottom`, which reaches to any depth";
                return fault(bottom.span(), given, expected.into());
            }
            Some(bottom) if bottom.get() >= top => {
                let expected = format!("a lower end below {top} m, the upper one of the layer");
                return fault(bottom.span(), format!("{} m", bottom.get()), expected);
            }
            None if index < last => {
                let given = format!("layer {} of {} without `bottom`", index + 1, last + 1);
                let expected = "the lower end (m) of every layer but the last";
                return fault(layers.span(), given, expected.into());
            }
            Some(bottom) => bottom.get(),
            None => f64::NEG_INFINITY,
        };
        top = bottom;
        let along_y = layer.lateral_y.unwrap_or(layer.lateral);
        found.push(WeightLayer {
            bottom,
            unit_weight: layer.density.get() * GRAVITY,
            lateral: [layer.lateral, along_y].map(NonNegative::get),
        });
    }
    Ok(found)
}

fn bolts(names: &Names, bolts: &spec::Bolt) -> Result<SceneBolts, Fault> {
    let span = bolts.name.span();
    let area = match (&bolts.diameter, &bolts.section) {
        (Some(diameter), None) => 0.25 * core::f64::consts::PI * diameter.get().powi(2),
        (None, Some(section)) => section.get(),
        (diameter, section) => {
            let given = [diameter.is_some(), section.is_some()];
            return Err(one_of(span, &["diameter", "section"], &given));
        }
    };
    let layout = match (&bolts.lines, &bolts.pattern) {
        (Some(lines), None) => BoltLayout::Lines(
            (lines.iter())
                .map(|[head, toe]| BoltLine {
                    head: vector(head),
                    toe: vector(toe),
                })
                .collect(),
        ),
        (None, Some(pattern)) => {
            names.facets(&pattern.facets)?;
            BoltLayout::Pattern {
                facets: pattern.facets.to_string(),
                pattern: BoltPattern {
                    along: direction(&pattern.along)?,
                    spacing: pattern.spacing.map(Positive::get),
                    length: pattern.length.get(),
                },
            }
        }
        (lines, pattern) => {
            let given = [lines.is_some(), pattern.is_some()];
            return Err(one_of(span, &["lines", "pattern"], &given));
        }
    };
    let or_unlimited =
        |value: &Option<At<Positive>>| value.as_ref().map_or(f64::INFINITY, |v| v.get());
    let parameters = BoltParameters {
        young: bolts.young.as_ref().map_or(STEEL, |young| young.get()),
        area,
        yield_force: or_unlimited(&bolts.yield_force),
        pretension: bolts.pretension.as_ref().map_or(0.0, |force| force.get()),
        grout: bolts
            .grout
            .as_ref()
            .map(|grout| powerhouse_elements::Grout {
                stiffness: grout.stiffness.get(),
                strength: grout.strength.map_or(f64::INFINITY, Positive::get),
                head: grout.head,
                toe: grout.toe,
            }),
        longest_segment: or_unlimited(&bolts.longest_segment),
    };
    parameters.check().map_err(|error| {
        let keys = [
            ("pretension", bolts.pretension.as_ref().map(At::span)),
            ("yield_force", bolts.yield_force.as_ref().map(At::span)),
            ("young", bolts.young.as_ref().map(At::span)),
            (
                "longest_segment",
                bolts.longest_segment.as_ref().map(At::span),
            ),
        ];
        let key = keys.into_iter().find(|(name, _)| *name == error.name);
        Fault::refused(key.and_then(|(_, of_key)| of_key).unwrap_or(span), error)
    })?;
    Ok(SceneBolts {
        name: bolts.name.to_string(),
        layout,
        parameters,
    })
}

/// Stage without its loads, which depend on the active elements.
fn stage(
    names: &Names,
    table: &spec::Stage,
    materials: &BTreeMap<String, Material>,
) -> Result<SceneStage, Fault> {
    let of_water = table.water.iter().filter_map(|water| water.set.as_ref());
    for set in table.excavate.iter().chain(&table.cast).chain(of_water) {
        names.elements(set)?;
    }
    let mut stage = SceneStage::new(table.name.to_string());
    for (values, add) in [
        (
            &table.excavate,
            SceneStage::excavate::<String> as fn(SceneStage, String) -> SceneStage,
        ),
        (&table.cast, SceneStage::cast::<String>),
        (&table.bolts, SceneStage::install::<String>),
        (&table.tied, SceneStage::tie::<String>),
        (&table.grouted, SceneStage::bond::<String>),
    ] {
        stage = values
            .iter()
            .fold(stage, |stage, value| add(stage, value.to_string()));
    }
    for part in &table.parts {
        let material = named("material", &part.material, materials)?;
        stage = stage.part(part.set.to_string(), material.clone());
    }
    for support in &table.supports {
        stage = stage.support(match &**support {
            StageSupport::Fixed { set } => Support::fixed(names.nodes(set)?),
            StageSupport::Roller { set, normal } => {
                let normal = match normal {
                    Some(normal) => direction(normal)?,
                    None => mean_normal(names, set)?,
                };
                Support::roller(names.nodes(set)?, normal)
            }
        });
    }
    for water in &table.water {
        let keys = PressureKeys::new(&water.level, &water.pressures, water.density);
        let level = StageWater::new(given_pressure(water.span(), keys)?);
        stage = stage.water(match &water.set {
            Some(set) => level.within(set.to_string()),
            None => level,
        });
    }
    if table
        .undrained
        .as_ref()
        .is_some_and(|undrained| **undrained)
    {
        stage = stage.undrained();
    }
    let mut options = StaticOptions::default();
    if let Some(method) = &table.method {
        options = options.with_method(static_method(method)?);
    }
    if let Some(tolerance) = &table.tolerance {
        options = options.with_tolerance(tolerance.get());
    }
    if let Some(increments) = &table.increments {
        options = options.with_increments(increments.get());
    }
    if let Some(release) = &table.release {
        options = options.with_release(release.get());
    }
    Ok(stage.with_options(options))
}

fn static_method(method: &At<spec::StaticMethod>) -> Result<StaticMethod, Fault> {
    match **method {
        spec::StaticMethod::ConjugateGradients => Ok(StaticMethod::ConjugateGradients),
        spec::StaticMethod::DynamicRelaxation => Ok(StaticMethod::DynamicRelaxation),
        #[cfg(feature = "direct")]
        spec::StaticMethod::Cholesky => Ok(StaticMethod::Cholesky(Linearisation::Elastic)),
        #[cfg(feature = "direct")]
        spec::StaticMethod::Newton => Ok(StaticMethod::Cholesky(Linearisation::Tangent)),
        #[cfg(not(feature = "direct"))]
        spec::StaticMethod::Cholesky | spec::StaticMethod::Newton => {
            let found = "a direct solver, which this build does not include".into();
            let expected = "conjugate-gradients or dynamic-relaxation".into();
            let fault = Fault::new(method.span(), Problem::Value { found, expected });
            Err(fault.with_help("build with `--features direct`"))
        }
    }
}
