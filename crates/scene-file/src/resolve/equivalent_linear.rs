//! Equivalent linear layers of a scene file: modulus and damping at the strain that the motion causes.

use super::draft::Draft;
use std::collections::BTreeMap;

use powerhouse_material_damage::{
    DampingBand, DarendeliSoil, LinearElastic, ReferenceFrequency, RelaxationSpectrum, StrainCurves,
};
use powerhouse_model::{ElasticMedium, FieldMotion, IncidentField, Mat3, ModelError, Vec3};
use powerhouse_wavefield::{Ground, LayerDamping, LayeredWave, TimeHistory};

use super::record::PreparedRecord;
use super::{layers, named, ordered};
use crate::spec::{self, At, EquivalentLinear, Layer, Positive, SceneSpec};
use powerhouse_laws::{Damping, Material};
use powerhouse_scene::internal::damping_of_layer;
use powerhouse_scene::{EquivalentLayer, Fault, Problem, Remark, remark};

/// Law of the materials of these layers.
const LAW: &str = "elastic";
/// Default effective strain over the greatest one, as is usual since Schnabel, Lysmer and Seed (1972).
const STRAIN_RATIO: f64 = 0.65;
/// Defaults of the tolerance, of the greatest number of iterations and of the band of the damping (Hz).
const TOLERANCE: f64 = 0.01;
const ITERATIONS: usize = 30;
const BAND: [f64; 2] = [0.5, 20.0];
/// Time (s) after the end of the longest record in which layers still ring.
const RINGING: f64 = 2.0;
/// Effective strain (1) above which the method is warned of.
const LARGE: f64 = 2e-3;
/// Number of relaxation mechanisms.
const MECHANISMS: usize = 3;
/// Least modulus at the first strain of curves over that of small strain.
const LEAST_FIRST: f64 = 0.9;
/// Greatest damping ratio of flat damping.
const GREATEST_RATIO: f64 = 0.2;
/// Distance of the points from which strains are taken, over the thickness of the layer.
const APART: f64 = 0.02;
/// Most samples of the strain of a layer.
const SAMPLES: f64 = 1e5;

/// A layer with strain curves.
struct Soil<'f> {
    /// Place among the layers.
    index: usize,
    material: &'f At<String>,
    place: core::ops::Range<usize>,
    curves: StrainCurves,
    /// Medium at small strain.
    whole: ElasticMedium,
    /// Secant modulus over that at small strain, and damping ratio.
    modulus: f64,
    ratio: f64,
    /// Effective shear strain of ground with these at all frequencies.
    strain: f64,
    /// Frequency (Hz) at which the waves of the run have the modulus: the mean of the logarithm over the power of the strain.
    frequency: f64,
}

/// Shear strain of a layer over a motion.
struct Shear {
    /// Greatest engineering strain (1), of any direction: the difference of the greatest and least principal strain.
    greatest: f64,
    /// Frequency (Hz) at the mean of its logarithm over the power of the strain.
    frequency: f64,
}

/// Gives layers with strain curves, and the parts of their materials, the modulus and damping of the strain that the waves cause
/// in them; returns the damping of all layers above the half-space.
pub(super) fn apply(
    file: &SceneSpec,
    scene: &mut Draft,
    records: &BTreeMap<String, PreparedRecord>,
    materials: &mut BTreeMap<String, Material>,
) -> Result<Vec<LayerDamping>, Fault> {
    let Some((last, above)) = file.layers.split_last() else {
        return unused(file, Vec::new());
    };
    if let Some(curves) = &last.strain_curves {
        let expected = "a half-space of one modulus, without `strain_curves`";
        return Err(value(
            curves.span(),
            "strain curves of the last layer",
            expected,
        ));
    }
    let dampings: Result<Vec<LayerDamping>, Fault> = above.iter().map(layers::damping_of).collect();
    let mut dampings = dampings?;
    let mut soils = Vec::new();
    for (index, layer) in above.iter().enumerate() {
        if let Some(curves) = &layer.strain_curves {
            soils.push(soil(file, materials, (index, layer), curves)?);
        }
    }
    let is_driven = !(file.waves.is_empty() && file.motions.is_empty()) && scene.boundary.is_some();
    if soils.is_empty() || !is_driven {
        return unused(file, dampings);
    }
    let settings = file.ground.equivalent_linear.as_deref();
    let share = |key: fn(&EquivalentLinear) -> Option<spec::Share>, default: f64| {
        settings.and_then(key).map_or(default, |share| share.get())
    };
    let strain_ratio = share(|s| s.strain_ratio, STRAIN_RATIO);
    let tolerance = share(|s| s.tolerance, TOLERANCE);
    let most = settings.and_then(|s| s.iterations.as_ref());
    if let Some(none) = most.filter(|most| ***most == 0) {
        return Err(value(none.span(), "0", "at least 1"));
    }
    let most = most.map_or(ITERATIONS, |most| **most);
    let band = match settings.and_then(|s| s.band.as_ref()) {
        Some(band) => {
            ordered(band.span(), band.map(Positive::get)).map(|()| band.map(Positive::get))?
        }
        None => BAND,
    };
    // The strain is that of the whole motion, whatever the duration of the run: a shorter run is of the same ground.
    let lengths = records.values().map(|record| record.history.duration());
    let duration = lengths.fold(scene.duration, f64::max) + RINGING;
    let mut change = 0.0_f64;
    let shears = |soils: &[Soil], scene: &Draft, ground: &Ground| {
        let waves = layers::waves(file, scene, records, (ground, duration))?.waves;
        let of = soils.iter().map(|soil| {
            let shear = shear(scene, duration, ground, (&waves, soil.index));
            shear.map_err(|error| Fault::refused(soil.place.clone(), error))
        });
        of.collect::<Result<Vec<Shear>, Fault>>()
    };
    for iteration in 1..=most {
        for soil in &soils {
            let medium = soil.medium()?;
            let material = Material::from(LinearElastic::new(medium));
            materials.insert(soil.material.to_string(), material);
            dampings[soil.index] = match soil.ratio {
                0.0 => LayerDamping::None,
                ratio => LayerDamping::Hysteretic { ratio },
            };
        }
        let ground = layers::ground(file, scene, materials, &dampings)?;
        change = 0.0;
        let found = shears(&soils, scene, &ground)?;
        for (soil, shear) in soils.iter_mut().zip(found) {
            soil.strain = strain_ratio * shear.greatest;
            soil.frequency = shear.frequency.clamp(band[0], band[1]);
            change = change.max(soil.change());
        }
        if change <= tolerance {
            let of_parts = soils.iter().map(|soil| soil.damping(band));
            let of_parts = of_parts.collect::<Result<Vec<Damping>, Fault>>()?;
            for (soil, damping) in soils.iter().zip(&of_parts) {
                dampings[soil.index] = damping_of_layer(damping).unwrap_or(LayerDamping::None);
            }
            finish(file, scene, materials, &soils, &of_parts)?;
            let ground = layers::ground(file, scene, materials, &dampings)?;
            let in_run = shears(&soils, scene, &ground)?.into_iter();
            let in_run = in_run.map(|shear| strain_ratio * shear.greatest);
            let large = soils.iter().filter(|soil| soil.strain > LARGE);
            let large: Vec<String> = large.map(|soil| soil.material.to_string()).collect();
            if !large.is_empty() {
                scene.remarks.push(Remark::from(remark::LargeStrains {
                    materials: large,
                    limit: LARGE,
                }));
            }
            let beyond = soils.iter().filter_map(|soil| {
                let greatest = soil.curves.greatest_strain();
                (soil.strain > greatest).then(|| {
                    Remark::from(remark::BeyondStrainCurves {
                        material: soil.material.to_string(),
                        strain: soil.strain,
                        greatest,
                    })
                })
            });
            scene.remarks.extend(beyond);
            scene.remarks.push(Remark::from(remark::EquivalentLinear {
                layers: soils
                    .iter()
                    .zip(in_run)
                    .map(|(soil, in_run)| soil.told(in_run))
                    .collect(),
                strain_ratio,
                iterations: iteration,
                change,
            }));
            return Ok(dampings);
        }
        soils.iter_mut().for_each(Soil::follow);
    }
    let found = format!(
        "a change of modulus or damping by {:.2} % in iteration {most}",
        100.0 * change
    );
    let expected = format!(
        "at most {} %; more `iterations` or a greater `tolerance` in `equivalent_linear` of the ground",
        100.0 * tolerance
    );
    Err(value(soils[0].place.clone(), &found, &expected))
}

fn value(span: core::ops::Range<usize>, found: &str, expected: &str) -> Fault {
    let (found, expected) = (found.into(), expected.into());
    Fault::new(span, Problem::Value { found, expected })
}

/// Refuses settings of the method that no layer needs.
fn unused(file: &SceneSpec, dampings: Vec<LayerDamping>) -> Result<Vec<LayerDamping>, Fault> {
    let needed = file
        .layers
        .iter()
        .any(|layer| layer.strain_curves.is_some());
    match &file.ground.equivalent_linear {
        Some(settings) if !needed => {
            let expected = "a layer with `strain_curves`";
            Err(value(
                settings.span(),
                "settings of the equivalent linear method",
                expected,
            ))
        }
        _ => Ok(dampings),
    }
}

/// A layer with strain curves, and what it must not have beside them.
fn soil<'f>(
    file: &'f SceneSpec,
    materials: &BTreeMap<String, Material>,
    (index, layer): (usize, &'f Layer),
    table: &At<spec::StrainCurves>,
) -> Result<Soil<'f>, Fault> {
    if let Some(damping) = &layer.damping {
        let expected = "no damping of a layer with `strain_curves`, which has that of the curves";
        return Err(value(damping.span(), "a damping", expected));
    }
    let name = layer.material.as_str();
    let whole = named("material", &layer.material, materials)?.medium();
    let of_file = file.materials.iter().find(|of| of.name.as_str() == name);
    if let Some(law) = of_file.map(|of| &of.law).filter(|law| law.as_str() != LAW) {
        let found = format!("the law '{}' of a layer with `strain_curves`", law.as_str());
        let expected = "the law 'elastic', with the moduli of small strain";
        return Err(value(law.span(), &found, expected));
    }
    if let Some(water) = of_file.and_then(|of| of.pore_water.as_ref()) {
        let expected = "no `pore_water` in a layer with `strain_curves`, whose moduli are those of the whole medium";
        return Err(value(water.span(), "water in the pores", expected));
    }
    if (file.layers.iter().enumerate()).any(|(of, l)| of != index && l.material.as_str() == name) {
        let expected = "a material of its own for each layer with `strain_curves`";
        return Err(value(
            layer.material.span(),
            "a material of two layers",
            expected,
        ));
    }
    let damped = file
        .parts
        .iter()
        .filter(|part| part.material.as_str() == name);
    if let Some(damping) = damped.filter_map(|part| part.damping.as_ref()).next() {
        let expected =
            "no damping of a part in a layer with `strain_curves`, which has that of the curves";
        return Err(value(damping.span(), "a damping", expected));
    }
    let curves = curves(table)?;
    let first = curves.modulus(0.0);
    if first < LEAST_FIRST {
        let found = format!("{first} of the shear modulus at the first strain of the curves");
        let expected = "curves that begin at a small strain, with at least 0.9 of its modulus";
        return Err(value(table.span(), &found, expected));
    }
    Ok(Soil {
        index,
        material: &layer.material,
        place: table.span(),
        whole,
        modulus: curves.modulus(0.0),
        ratio: curves.damping(0.0),
        strain: 0.0,
        frequency: 1.0,
        curves,
    })
}

fn curves(table: &At<spec::StrainCurves>) -> Result<StrainCurves, Fault> {
    let made = match &**table {
        spec::StrainCurves::Points {
            strain,
            modulus,
            damping_ratio,
        } => StrainCurves::new(
            strain.iter().map(|of| of.get()).collect(),
            modulus.iter().map(|of| of.get()).collect(),
            damping_ratio.iter().map(|of| of.get()).collect(),
        ),
        spec::StrainCurves::Darendeli {
            plasticity,
            pressure,
            overconsolidation,
            frequency,
            cycles,
        } => {
            let usual = DarendeliSoil::new(plasticity.get(), pressure.get());
            let or = |given: &Option<Positive>, usual: f64| given.map_or(usual, |of| of.get());
            StrainCurves::darendeli(&DarendeliSoil {
                overconsolidation: or(overconsolidation, usual.overconsolidation),
                frequency: or(frequency, usual.frequency),
                cycles: or(cycles, usual.cycles),
                ..usual
            })
        }
    };
    made.map_err(|error| Fault::refused(table.span(), error))
}

impl Soil<'_> {
    /// Medium with the secant shear modulus and the bulk modulus of small strain.
    fn medium(&self) -> Result<ElasticMedium, Fault> {
        let (bulk, shear) = (self.whole.bulk(), self.modulus * self.whole.shear());
        let young = 9.0 * bulk * shear / (3.0 * bulk + shear);
        let poisson = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
        ElasticMedium::new(young, poisson, self.whole.density)
            .map_err(|error| Fault::refused(self.place.clone(), error))
    }

    /// Damping in a band (Hz).
    fn damping(&self, [lowest, highest]: [f64; 2]) -> Result<Damping, Fault> {
        if self.ratio == 0.0 {
            return Ok(Damping::None);
        }
        if self.ratio > GREATEST_RATIO {
            let found = format!(
                "a damping ratio of {:.3} at an effective shear strain of {:.3e} of '{}'",
                self.ratio,
                self.strain,
                self.material.as_str()
            );
            let expected = "at most 0.2, the most that flat damping has: the motion is too strong for the equivalent linear method";
            return Err(value(self.place.clone(), &found, expected));
        }
        let band = DampingBand {
            ratio: self.ratio,
            lowest,
            highest,
            mechanisms: MECHANISMS,
        };
        let spectrum = RelaxationSpectrum::fit(band)
            .map_err(|error| Fault::refused(self.place.clone(), error))?;
        Ok(Damping::Flat {
            spectrum,
            reference: ReferenceFrequency::At(self.frequency),
        })
    }

    /// The larger change of modulus and damping over their values if both became those of the strain.
    fn change(&self) -> f64 {
        let change = |new: f64, old: f64| {
            if new == old {
                0.0
            } else {
                (new / old - 1.0).abs()
            }
        };
        let of_modulus = change(self.curves.modulus(self.strain), self.modulus);
        of_modulus.max(change(self.curves.damping(self.strain), self.ratio))
    }

    /// Takes modulus and damping of the strain.
    fn follow(&mut self) {
        self.modulus = self.curves.modulus(self.strain);
        self.ratio = self.curves.damping(self.strain);
    }

    fn told(&self, in_run: f64) -> EquivalentLayer {
        let mut layer = EquivalentLayer::new(self.material.to_string());
        (layer.strain, layer.in_run) = (self.strain, in_run);
        (layer.modulus, layer.damping) = (self.modulus, self.ratio);
        layer.frequency = self.frequency;
        layer
    }
}

/// Shear strain over a duration (s) in the middle of a layer.
fn shear(
    scene: &Draft,
    duration: f64,
    ground: &Ground,
    (waves, index): (&[LayeredWave], usize),
) -> Result<Shear, ModelError> {
    let bottom = ground.layers()[index].bottom;
    let top = match index {
        0 => ground.surface(),
        _ => ground.layers()[index - 1].bottom,
    };
    let (low, high) = scene.mesh.bounding_box();
    let middle = Vec3::new(
        0.5 * (low.x + high.x),
        0.5 * (low.y + high.y),
        0.5 * (top + bottom),
    );
    let apart = APART * (top - bottom);
    let axes = [Vec3::x(), Vec3::y(), Vec3::z()];
    let points = axes.map(|axis| [middle + axis * apart, middle - axis * apart]);
    let mut samplers = Vec::with_capacity(waves.len());
    let mut step = f64::INFINITY;
    for wave in waves {
        samplers.push(wave.prepare(points.as_flattened())?);
        step = step.min(wave.report().step);
    }
    let step = step.max(duration / SAMPLES);
    let count = (duration / step).ceil() as usize;
    let mut greatest = 0.0_f64;
    let mut histories = [(); 6].map(|()| Vec::with_capacity(count + 1));
    for sample in 0..=count {
        let mut motion = [FieldMotion::default(); 6];
        for sampler in &samplers {
            sampler.add_motion(scene.start + step * sample as f64, &mut motion);
        }
        let slopes = [0, 1, 2].map(|axis| {
            (motion[2 * axis].displacement - motion[2 * axis + 1].displacement) / (2.0 * apart)
        });
        let gradient = Mat3::from_columns(&slopes);
        let strain = (gradient + gradient.transpose()) * 0.5;
        let principal = strain.symmetric_eigenvalues();
        greatest = greatest.max(principal.max() - principal.min());
        let shear = strain - Mat3::identity() * (strain.trace() / 3.0);
        let components = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];
        for (history, component) in histories.iter_mut().zip(components) {
            history.push(shear[component]);
        }
    }
    let (mut power, mut sum) = (0.0, 0.0);
    for (component, history) in histories.into_iter().enumerate() {
        // A strain off the diagonal is there twice.
        let share = if component < 3 { 1.0 } else { 2.0 };
        let history = TimeHistory::new(step, history).map_err(ModelError::from)?;
        for line in history.fourier_spectrum().iter().skip(1) {
            let own = share * line.amplitude * line.amplitude;
            power += own;
            sum += own * line.frequency.ln();
        }
    }
    let frequency = if power > 0.0 {
        (sum / power).exp()
    } else {
        1.0
    };
    Ok(Shear {
        greatest,
        frequency,
    })
}

/// Gives the parts of the layers their media and damping, and in stages the medium of small strain.
fn finish(
    file: &SceneSpec,
    scene: &mut Draft,
    materials: &BTreeMap<String, Material>,
    soils: &[Soil],
    dampings: &[Damping],
) -> Result<(), Fault> {
    for (part, table) in scene.parts.iter_mut().zip(&file.parts) {
        let of = (soils.iter().zip(dampings))
            .find(|(soil, _)| soil.material.as_str() == table.material.as_str());
        let Some((soil, damping)) = of else {
            continue;
        };
        part.static_material = Some(Material::from(LinearElastic::new(soil.whole)));
        part.material = named("material", &table.material, materials)?.clone();
        part.damping = damping.clone();
        let moving = part.moving_material();
        moving.map_err(|error| Fault::refused(table.material.span(), error))?;
    }
    Ok(())
}
