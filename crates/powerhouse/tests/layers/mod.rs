//! Layered ground: boxes without a structure against their free field, and scenes with layers.

mod column;
mod equivalent_linear;
mod shake;

use std::path::PathBuf;
use std::sync::Arc;

use powerhouse::boundary::{Spreading, ViscousSpring};
use powerhouse::engine::PeriodicPairs;
use powerhouse::engine::observe::Motion;
use powerhouse::material::{DampingBand, LinearElastic, ReferenceFrequency, RelaxationSpectrum};
use powerhouse::model::{ElasticMedium, FieldMotion, IncidentField, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, Ground, GroundLayer, LayerDamping, LayerMechanism, LayeredWave, LayeredWaveParameters,
    Ricker, RickerQuantity, WaveKind,
};
use powerhouse::{
    Boundary, Damping, Error, FileScene, LayerError, Material, OutputPlan, Part, Registry, Remark,
    RenderFault as _, RunHooks, Scene, remark,
};

/// Names and lower ends (m) of the layers, the half-space last, and their media.
fn layers() -> [(&'static str, f64, ElasticMedium); 3] {
    // Speeds of S waves 200, 400 and 900 m/s, of P waves 500, 1000 and 2000 m/s.
    [
        ("clay", -20.0, (1800.0, 200.0, 500.0)),
        ("gravel", -40.0, (2000.0, 400.0, 1000.0)),
        ("rock", -60.0, (2300.0, 900.0, 2000.0)),
    ]
    .map(|(name, bottom, (density, cs, cp))| {
        let (shear, constrained) = (density * cs * cs, density * cp * cp);
        let lambda: f64 = constrained - 2.0 * shear;
        let poisson = lambda / (2.0 * (lambda + shear));
        let medium = ElasticMedium::new(2.0 * shear * (1.0 + poisson), poisson, density);
        (name, bottom, medium.unwrap())
    })
}

/// Box of 100 m by 60 m, one element of `size` thick, with a part for every layer.
fn body(size: f64) -> Mesh {
    let (low, high) = (Vec3::new(-50.0, 0.0, -60.0), Vec3::new(50.0, size, 0.0));
    let cells = [(100.0 / size) as usize, 1, (60.0 / size) as usize];
    let mut mesh = Mesh::box_of_hexes(low, high, cells, "all").unwrap();
    let mut top = 0.0;
    for (name, bottom, _) in layers() {
        let lies_in = |element: &u32| (bottom..top).contains(&mesh.centroid(*element).z);
        let elements = (0..mesh.element_count() as u32).filter(lies_in).collect();
        mesh.set_element_set(name, elements).unwrap();
        top = bottom;
    }
    mesh
}

/// Flat damping of 2 %, as of bodies and of layers.
fn flat() -> (Damping, LayerDamping) {
    let band = DampingBand {
        ratio: 0.02,
        lowest: 0.5,
        highest: 20.0,
        mechanisms: 3,
    };
    let spectrum = RelaxationSpectrum::fit(band).unwrap();
    let mechanisms = spectrum.mechanisms().iter().map(|m| LayerMechanism {
        frequency: m.frequency,
        weight: m.weight,
    });
    let reference = ReferenceFrequency::Centre;
    let layer = LayerDamping::Flat {
        mechanisms: mechanisms.collect(),
        velocity: reference.velocity(&spectrum).unwrap(),
    };
    let damping = Damping::Flat {
        spectrum,
        reference,
    };
    (damping, layer)
}

fn wave(kind: WaveKind, degrees: f64, delay: f64, damping: &LayerDamping) -> LayeredWave {
    let [clay, gravel, (.., rock)] = layers();
    let above = [clay, gravel]
        .map(|(_, bottom, medium)| GroundLayer::new(bottom, medium).with_damping(damping.clone()));
    let ground = Ground::new(0.0, above.to_vec(), rock).unwrap();
    let mut parameters = LayeredWaveParameters::vertical(kind, ground, -60.0);
    parameters.incidence = Angle::from_degrees(degrees);
    parameters.reference = Vec3::new(-50.0, 0.0, -60.0);
    parameters.until = Some(10.0);
    let ricker = Ricker::new(RickerQuantity::Displacement, 0.01, 3.0, delay).unwrap();
    LayeredWave::new(parameters, Arc::new(ricker)).unwrap()
}

/// Relative L2 error of the displacement at 20 points of a box under a wave, from rest.
fn error(size: f64, kind: WaveKind, degrees: f64, delay: f64, damped: bool) -> f64 {
    let mesh = body(size);
    let on = |y: f64| {
        mesh.nodes_in_box(
            &Vec3::new(-51.0, y - 0.1, -61.0),
            &Vec3::new(51.0, y + 0.1, 1.0),
        )
    };
    let pairs = PeriodicPairs::by_translation(&mesh, &on(0.0), &on(size), 1e-6).unwrap();
    let (damping, of_layer) = if damped {
        flat()
    } else {
        (Damping::None, LayerDamping::None)
    };
    let wave = wave(kind, degrees, delay, &of_layer);
    let boundary = ViscousSpring {
        spreading: Spreading::Cylindrical,
        ..ViscousSpring::default()
    };
    let mut points = Vec::new();
    for x in [-36.0, -12.0, 12.0, 36.0] {
        for z in [0.0, -8.0, -20.0, -32.0, -52.0] {
            points.push(Vec3::new(x, 0.0, z));
        }
    }
    let mut output = OutputPlan::default().with_every(2e-3);
    for (index, point) in points.iter().enumerate() {
        output = output.history(&format!("p{index}"), *point, Motion::DISPLACEMENT);
    }
    let mut scene = Scene::new("layers", mesh)
        .with_layered_waves(vec![wave.clone()])
        .unwrap()
        .with_boundary(
            Boundary::new(boundary, ["left", "right", "bottom"]).with_scatterer(Vec3::new(
                0.0,
                0.5 * size,
                0.0,
            )),
        )
        .with_periodic_pairs(pairs)
        .with_duration(delay + 2.0)
        .with_output(output);
    for (index, (name, _, medium)) in layers().into_iter().enumerate() {
        let part = Part::new(name, Material::from(LinearElastic::new(medium)));
        scene = scene.part(match index {
            2 => part,
            _ => part.with_damping(damping.clone()),
        });
    }
    let simulation = scene.prepare().unwrap();
    let warned = simulation
        .remarks()
        .iter()
        .any(|r| matches!(r, Remark::DampedRim(_)));
    assert!(!warned, "the field is damped like the body");
    let results = simulation.run(RunHooks::default()).unwrap();
    let sampler = wave.prepare(&points).unwrap();
    let (mut missed, mut all) = (0.0, 0.0);
    for (row, time) in results.histories().times.iter().enumerate() {
        let mut exact = vec![FieldMotion::default(); points.len()];
        sampler.add_motion(*time, &mut exact);
        for (index, exact) in exact.iter().enumerate() {
            for (axis, name) in ["ux", "uy", "uz"].into_iter().enumerate() {
                let column = results
                    .histories()
                    .column(&format!("p{index}.{name}"))
                    .unwrap();
                missed += (column.values[row] - exact.displacement[axis]).powi(2);
                all += exact.displacement[axis].powi(2);
            }
        }
    }
    (missed / all).sqrt()
}

/// A box of two layers over rock moves like its free field under an SV wave at 15 degrees: within 0.04, 0.01
/// and 0.003 (relative L2) with elements of 4, 2 and 1 m, 17, 33 and 67 to the wavelength in clay; the error
/// falls with the square of their size.
#[test]
fn a_layered_box_moves_like_its_free_field() {
    let errors = [4.0, 2.0, 1.0].map(|size| error(size, WaveKind::SV, 15.0, 0.7, false));
    println!("figure layers.sv_15 {errors:?}");
    for (error, limit) in errors.iter().zip([0.04, 0.01, 0.003]) {
        assert!(error <= &limit, "{errors:?}");
    }
    assert!(
        errors[0] > 3.0 * errors[1] && errors[1] > 3.0 * errors[2],
        "{errors:?}"
    );
}

/// So it does under P and SH waves, and past the critical angle, where the wave is delayed until its
/// forerunner is small at the start.
#[test]
fn other_waves_move_a_layered_box_like_their_free_field() {
    for (kind, degrees, delay) in [
        (WaveKind::P, 30.0, 0.7),
        (WaveKind::SH, 30.0, 0.7),
        (WaveKind::SV, 40.0, 3.0),
    ] {
        let errors = [4.0, 2.0].map(|size| error(size, kind, degrees, delay, false));
        println!("figure layers.{kind}_{degrees} {errors:?}");
        assert!(
            errors[0] <= 0.05 && errors[1] <= 0.014,
            "{kind} {degrees}: {errors:?}"
        );
    }
}

/// A box with flat damping moves like the field of layers with the same damping.
#[test]
fn a_damped_box_moves_like_damped_layers() {
    let errors = [4.0, 2.0].map(|size| error(size, WaveKind::SV, 15.0, 0.7, true));
    println!("figure layers.damped_sv_15 {errors:?}");
    assert!(errors[0] <= 0.04 && errors[1] <= 0.01, "{errors:?}");
}

const SITE: &str = include_str!("../../../../data/scenes/layered_site.toml");

fn read(text: &str) -> Result<Scene, Error> {
    let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../data/scenes/test.toml");
    FileScene::from_toml(text, path, &Registry::default()).map(FileScene::into_scene)
}

/// Message of a scene with one passage replaced, from reading or preparing it.
fn told(old: &str, new: &str) -> String {
    assert!(SITE.contains(old), "{old}");
    let scene = read(&SITE.replacen(old, new, 1)).and_then(Scene::prepare);
    match scene {
        Err(error) => error.to_string(),
        Ok(_) => panic!("{new} was accepted"),
    }
}

/// Layers of a scene become the ground of its wave, with the media of its materials; a run reports the memory
/// of the tables.
#[test]
fn a_scene_has_layers() {
    let scene = read(SITE).unwrap();
    let [wave] = scene.layered_waves() else {
        panic!("one wave");
    };
    let ground = &wave.parameters().ground;
    assert_eq!(ground.interfaces(), [-20.0, -40.0]);
    assert!((ground.medium_at(-10.0).young - 0.2e9).abs() < 1.0);
    assert!((ground.half_space().young - 5e9).abs() < 1.0);
    assert!(scene.plane_waves().is_empty());
    let tables = scene.remarks().iter().find_map(|remark| match remark {
        Remark::Layered(remark::Layered { bytes, .. }) => Some(*bytes),
        _ => None,
    });
    assert!((100_000..50_000_000).contains(&tables.unwrap()));
    // An interface is moved to a plane of the mesh that is nearer than a thousandth.
    let moved = read(&SITE.replacen("bottom = -20 ", "bottom = -20.015 ", 1)).unwrap();
    assert_eq!(
        moved.layered_waves()[0].parameters().ground.interfaces(),
        [-20.0, -40.0]
    );
    // Layers may go on below the mesh, and may be damped.
    let damped = SITE.replacen(
        "bottom = -20 ",
        "damping = { kind = \"flat\", ratio = 0.02, band = [0.5, 20] }\nbottom = -20 ",
        1,
    );
    let damped = read(&damped).unwrap();
    assert_ne!(
        damped.layered_waves()[0].parameters().ground.layers()[0].damping,
        LayerDamping::None
    );
}

/// What does not fit is refused at its place, and names depth, face, media and ways out.
#[test]
fn layers_that_do_not_fit_are_refused() {
    for (old, new, message) in [
        (
            "material = \"clay\"\nbottom",
            "material = \"klay\"\nbottom",
            "no material 'klay'",
        ),
        (
            "material = \"clay\"\nbottom",
            "material = \"gravel\"\nbottom",
            "18.0000 m deep: the part 'clay' has 1800 kg/m3",
        ),
        (
            "bottom = -20 ",
            "bottom = -21 ",
            "from the next nodes of the absorbing faces or, where it crosses none, of the mesh, at z = -20 m",
        ),
        (
            "bottom = -20 ",
            "bottom = -20.03 ",
            "more than a thousandth",
        ),
        ("bottom = -40", "bottom = -10", "is not below its top"),
        ("bottom = -20 ", "bottom = -0.0001 ", "thick"),
        ("bottom = -20 ", "# ", "the key 'bottom' is missing"),
        (
            "[[layer]]                       # without",
            "[ground]\nspace = \"full-space\"\n[[layer]] #",
            "half-space",
        ),
        (
            "material = \"rock\"\n\n[[support]]",
            "material = \"rock\"\nbottom = -80\n\n[[support]]",
            "half-space below the others",
        ),
        (
            "material = \"rock\"\n\n[[support]]",
            "material = \"rock\"\ndamping = { kind = \"flat\", ratio = 0.02, band = [0.5, 20] }\n\n[[support]]",
            "elastic half-space",
        ),
        (
            "bottom = -20 ",
            "damping = { kind = \"coefficients\", mass = 1, stiffness = 0 }\nbottom = -20 ",
            "\"flat\"",
        ),
        ("incidence = 15 ", "incidence = 90 ", "above 89.9 degrees"),
    ] {
        let told = told(old, new);
        assert!(told.contains(message), "{new}: {told}");
    }
}

/// Past the critical angle a slow motion moves the ground long before it arrives: the error names the way out.
#[test]
fn a_motion_that_is_too_slow_for_its_angle_is_refused() {
    let slow = |frequency: f64| {
        let text = SITE.replacen("incidence = 15 ", "incidence = 60 ", 1);
        let text = text.replacen("frequency = 3 ", &format!("frequency = {frequency} "), 1);
        read(&text).err().map(|error| match error {
            Error::Scene(fault) => fault.render(false),
            other => panic!("{other}"),
        })
    };
    let told = slow(0.05).unwrap();
    for passage in ["20 s of padding", "help", "high-pass"] {
        assert!(told.contains(passage), "{told}");
    }
    assert_eq!(slow(1.0), None);
}

/// From Rust, too: an interface between the nodes of a face, and a medium that is not the layer's.
#[test]
fn a_body_of_other_layers_is_refused() {
    let scene = |interface: f64, swapped: bool| {
        let [(_, _, clay), (_, _, gravel), (_, _, rock)] = layers();
        let above = vec![
            GroundLayer::new(interface, clay),
            GroundLayer::new(-40.0, gravel),
        ];
        let ground = Ground::new(0.0, above, rock).unwrap();
        let parameters = LayeredWaveParameters::vertical(WaveKind::SH, ground, -60.0);
        let ricker = Ricker::new(RickerQuantity::Displacement, 0.01, 3.0, 0.7).unwrap();
        let wave = LayeredWave::new(parameters, Arc::new(ricker)).unwrap();
        let media = if swapped {
            [gravel, clay, rock]
        } else {
            [clay, gravel, rock]
        };
        let mut scene = Scene::new("layers", body(4.0))
            .with_field(wave)
            .with_boundary(
                Boundary::new(ViscousSpring::default(), ["left", "right", "bottom"])
                    .with_scatterer(Vec3::new(0.0, 2.0, 0.0)),
            );
        for ((name, ..), medium) in layers().into_iter().zip(media) {
            scene = scene.part(Part::new(name, Material::from(LinearElastic::new(medium))));
        }
        scene.prepare().err()
    };
    assert!(scene(-20.0, false).is_none());
    let off = scene(-18.0, false);
    assert!(
        matches!(
            off,
            Some(Error::Layers(LayerError::OffPlane {
                interface: -18.0,
                ..
            }))
        ),
        "{off:?}"
    );
    let swapped = scene(-20.0, true);
    assert!(
        matches!(&swapped, Some(Error::Layers(LayerError::OtherMedium { set, .. })) if set == "clay" || set == "gravel"),
        "{swapped:?}"
    );
}
