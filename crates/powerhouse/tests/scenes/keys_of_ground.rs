//! Records, waves and ground: every key of a scene file is equivalent to its counterpart in Rust.

use core::f64::consts::PI;
use std::sync::Arc;

use powerhouse::engine::Prescribed;
use powerhouse::model::Vec3;
use powerhouse::wavefield::{
    Angle, BaselineCorrection, EndDisplacement, HarmonicBurst, InputConvention, PlaneWave,
    PlaneWaveParameters, QuietStartLimits, Ricker, RickerQuantity, Signal, Site, SmoothPulse,
    Superposition, SurfaceComponent, TimeHistory, WaveKind, ZeroMeanPulse, first_hit_corner,
};
use powerhouse::{Error, Registry, Remark, RenderFault as _, Scene, keys, remark};

use super::support::*;

fn parameters(kind: WaveKind, incidence: f64, azimuth: f64) -> PlaneWaveParameters {
    let mut parameters = PlaneWaveParameters::vertical(kind, ROCK, 0.0);
    parameters.incidence = Angle::from_degrees(incidence);
    parameters.azimuth = Angle::from_degrees(azimuth);
    let (low, high) = cube().bounding_box();
    parameters.reference = first_hit_corner(&low, &high, &parameters.direction());
    parameters
}

fn smooth(displacement: f64) -> Arc<dyn Signal> {
    Arc::new(SmoothPulse::new(displacement, 0.4).unwrap())
}

/// The cube's scene under a wave that is delayed so that the body starts at rest.
fn under(parameters: PlaneWaveParameters, signal: Arc<dyn Signal>) -> Scene {
    let wave = PlaneWave::new(parameters, signal).unwrap();
    let (low, high) = cube().bounding_box();
    let corner = |i: usize| {
        Vec3::from_fn(|axis, _| {
            if i >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        })
    };
    let corners: Vec<Vec3> = (0..8).map(corner).collect();
    let wave = if wave.start_level(&corners, 0.0).unwrap().largest() < 1e-4 {
        wave
    } else {
        let limits = QuietStartLimits::default();
        wave.with_quiet_start(&corners, 0.0, &limits).unwrap().0
    };
    cube_scene().with_field(wave)
}

/// Kind, angles, arrival, reference, factor, pulse and space of a wave agree with those of Rust.
#[test]
fn waves() {
    use WaveKind::{P, SH, SV};
    let variants = Variants::new("waves");
    let with = |mut parameters: PlaneWaveParameters, arrival: f64, reference: Option<Vec3>| {
        parameters.arrival = arrival;
        parameters.reference = reference.unwrap_or(parameters.reference);
        parameters
    };
    let pulse = "pulse = { kind = \"smooth\", displacement = 0.01, duration = 0.4 }";
    let ricker =
        |delay: f64| Arc::new(Ricker::new(RickerQuantity::Displacement, 0.01, 8.0, delay).unwrap());
    let mut full = parameters(P, 90.0, 0.0);
    full.site = Site::FullSpace;
    for (keys, twin) in [
        (
            format!("kind = \"p\"\nincidence = 35\nazimuth = -120\n{pulse}"),
            under(parameters(P, 35.0, -120.0), smooth(0.01)),
        ),
        (
            format!("kind = \"sh\"\nincidence = 50\n{pulse}\nfactor = -0.5"),
            under(parameters(SH, 50.0, 0.0), smooth(-0.5 * 0.01)),
        ),
        (
            format!("kind = \"sv\"\nincidence = 0\n{pulse}\narrival = 0.1"),
            under(with(parameters(SV, 0.0, 0.0), 0.1, None), smooth(0.01)),
        ),
        (
            format!("kind = \"sv\"\nincidence = 10\n{pulse}\nreference = [0, 10, -400]"),
            under(
                with(parameters(SV, 10.0, 0.0), 0.0, Some(Vec3::new(0.0, 10.0, -400.0))),
                smooth(0.01),
            ),
        ),
        (
            format!("kind = \"sv\"\nincidence = 45\n{}", pulse.replace("smooth", "zero-mean")),
            under(
                parameters(SV, 45.0, 0.0),
                Arc::new(ZeroMeanPulse::new(0.01, 0.4).unwrap()),
            ),
        ),
        (
            "kind = \"sv\"\nincidence = 10\npulse = { kind = \"ricker\", displacement = 0.01, frequency = 8 }".into(),
            under(parameters(SV, 10.0, 0.0), ricker(1.5 / 8.0)),
        ),
        (
            "kind = \"sv\"\nincidence = 10\npulse = { kind = \"ricker\", displacement = 0.01, frequency = 8, delay = 0.3 }".into(),
            under(parameters(SV, 10.0, 0.0), ricker(0.3)),
        ),
        (
            "kind = \"sv\"\nincidence = 10\npulse = { kind = \"burst\", displacement = 0.01, frequency = 8, cycles = 3 }".into(),
            under(
                parameters(SV, 10.0, 0.0),
                Arc::new(HarmonicBurst::new(0.01, 8.0, 3.0).unwrap()),
            ),
        ),
        (
            format!("kind = \"p\"\nincidence = 90\n{pulse}\n[ground]\nspace = \"full-space\""),
            under(full, smooth(0.01)),
        ),
        (
            format!("kind = \"p\"\nincidence = 5\n{pulse}\n[ground]\nspace = \"half-space\"\nsurface = 25"),
            under(
                PlaneWaveParameters {
                    site: Site::HalfSpace { surface: 25.0 },
                    ..parameters(P, 5.0, 0.0)
                },
                smooth(0.01),
            ),
        ),
    ] {
        variants.equal((WAVE, &format!("[[wave]]\n{keys}\n")), twin);
    }
    // Waves are superposed.
    let waves = [(P, 15.0, 0.1), (SH, 25.0, 0.0)].map(|(kind, angle, arrival)| {
        PlaneWave::new(
            with(parameters(kind, angle, 0.0), arrival, None),
            smooth(0.01),
        )
        .unwrap()
    });
    let fields = waves.map(|wave| Box::new(wave) as _).into();
    let twin = cube_scene().with_field(Superposition::new(fields).unwrap());
    let keys = format!(
        "[[wave]]\nkind = \"p\"\nincidence = 15\narrival = 0.1\n{pulse}\n[[wave]]\nkind = \"sh\"\nincidence = 25\n{pulse}\n"
    );
    variants.equal((WAVE, &keys), twin);
}

/// Record with zero acceleration at both ends (m/s2).
fn samples(count: usize) -> Vec<f64> {
    let window = |i: usize| (PI * i as f64 / 60.0).sin().powi(2);
    let sample = |i: usize| 0.37 * (0.7 * i as f64).sin() * window(i);
    (0..count)
        .map(|i| if i <= 60 { sample(i) } else { 0.0 })
        .collect()
}

fn text(samples: &[f64]) -> String {
    let lines: Vec<String> = samples.iter().map(f64::to_string).collect();
    lines.join("\n")
}

const REST: BaselineCorrection = BaselineCorrection::VelocityPolynomial { order: 3 };

fn history() -> TimeHistory {
    TimeHistory::new(0.01, samples(90)).unwrap()
}

fn corrected(history: &TimeHistory, correction: BaselineCorrection) -> (TimeHistory, f64) {
    let (history, report) = history.corrected(correction).unwrap();
    (history, report.leading_pad)
}

/// Format, unit, cut, taper, baseline, peak and end displacement of a record are those of Rust.
#[test]
fn records() {
    let variants = Variants::new("records");
    let write = |name: &str, text: &str| std::fs::write(variants.0.join(name), text).unwrap();
    write("one.txt", &text(&samples(90)));
    let rows = samples(90).into_iter().enumerate();
    let rows: Vec<String> = rows
        .map(|(i, a)| format!("{} {a}", i as f64 * 0.01))
        .collect();
    write("two.txt", &rows.join("\n"));
    let header =
        "PEER\nEVENT\nACCELERATION TIME SERIES IN UNITS OF G\nNPTS=   90, DT=   .0100 SEC\n";
    write("r.at2", &format!("{header}{}", text(&samples(90))));
    let few = header.replace("   90", "   99");
    write("few.at2", &format!("{few}{}", text(&samples(90))));
    let one = "file = \"one.txt\"\ntime_step = 0.01\nunits = \"m/s2\"\n";
    let in_rows: Vec<String> = samples(90)
        .chunks(7)
        .map(|row| row.iter().map(|a| format!("{a} ")).collect())
        .collect();
    write("rows.txt", &in_rows.join("\n"));
    let rows = samples(90).into_iter().enumerate();
    let three: Vec<String> = rows
        .map(|(i, a)| format!("{a} 7 {}", i as f64 * 0.01))
        .collect();
    write(
        "three.txt",
        &format!("1940 El Centro\n{}", three.join("\n")),
    );
    let times_of_all = "#StationCode: A\n#RecordLength(sec): 0.9\n#SampleRate(Hz): 100\n#AmplitudeUnit: gal.\n#DataSequence: Time U(+); N(+)\n";
    let rows = samples(90).into_iter().enumerate();
    let both: Vec<String> = rows
        .map(|(i, a)| format!("{:.3} 0.5 {a}", i as f64 * 0.01))
        .collect();
    write("station.dat", &format!("{times_of_all}{}", both.join("\n")));
    let baseline = "baseline = { kind = \"velocity-polynomial\", order = 3 }\n";
    let plain = || corrected(&history(), REST);
    let times = |factor: f64| {
        let samples = samples(90).into_iter().map(|a| factor * a).collect();
        corrected(&TimeHistory::new(0.01, samples).unwrap(), REST)
    };
    let by = |correction| corrected(&history(), correction);
    let cut = |taper: f64| {
        let from = TimeHistory::new(0.01, samples(90)[5..].to_vec()).unwrap();
        corrected(&from.truncated(0.6, taper).unwrap(), REST)
    };
    for (keys, (history, lead)) in [
        (format!("{one}{baseline}"), plain()),
        (
            format!("file = \"two.txt\"\nunits = \"m/s2\"\n{baseline}"),
            plain(),
        ),
        (
            format!("file = \"two.txt\"\nunits = \"cm/s2\"\n{baseline}"),
            times(0.01),
        ),
        (
            format!("file = \"two.txt\"\nunits = \"gal\"\n{baseline}"),
            times(0.01),
        ),
        (format!("file = \"r.at2\"\n{baseline}"), times(9.80665)),
        (
            format!("file = \"few.at2\"\ncount = \"as-found\"\n{baseline}"),
            times(9.80665),
        ),
        (
            format!("file = \"r.at2\"\ncount = \"as-declared\"\n{baseline}"),
            times(9.80665),
        ),
        (
            format!(
                "file = \"rows.txt\"\nvalues_in_a_row = 7\ntime_step = 0.01\nunits = \"m/s2\"\n{baseline}"
            ),
            plain(),
        ),
        (
            format!(
                "file = \"three.txt\"\nskip = 1\ncolumns = {{ time = 3, acceleration = 1 }}\nunits = \"m/s2\"\n{baseline}"
            ),
            plain(),
        ),
        (
            format!("file = \"station.dat\"\nchannel = \"N\"\n{baseline}"),
            times(0.01),
        ),
        (
            format!("file = \"station.dat\"\nchannel = \"2\"\nunits = \"cm/s2\"\n{baseline}"),
            times(0.01),
        ),
        (format!("{one}cut = [0.05, 0.65]\n{baseline}"), cut(0.0)),
        (
            format!("{one}cut = [0.05, 0.65]\ntaper = 0.1\n{baseline}"),
            cut(0.1),
        ),
        (
            format!("{one}{baseline}peak = 2.5\n"),
            (plain().0.scaled_to_peak(2.5).unwrap(), 0.0),
        ),
        (
            format!("{one}baseline = {{ kind = \"high-pass\", corner = 2, order = 2 }}\n"),
            by(BaselineCorrection::HighPass {
                corner: 2.0,
                order: 2,
            }),
        ),
    ] {
        let record = format!("[[record]]\nname = \"r\"\nconvention = \"incident\"\n{keys}");
        let wave = "[[wave]]\nkind = \"sv\"\nincidence = 20\nrecord = \"r\"\n";
        let mut parameters = parameters(WaveKind::SV, 20.0, 0.0);
        parameters.arrival -= lead;
        let signal = history.into_signal(EndDisplacement::Declared(0.0)).unwrap();
        let twin = under(parameters, Arc::new(signal));
        variants.equal((WAVE, &format!("{record}{wave}")), twin);
    }
    for (keys, correction) in [
        ("kind = \"mean\"", BaselineCorrection::Mean),
        (
            "kind = \"acceleration-polynomial\", order = 1",
            BaselineCorrection::AccelerationPolynomial { order: 1 },
        ),
        (
            "kind = \"least-velocity\", order = 2",
            BaselineCorrection::LeastVelocity { order: 2 },
        ),
    ] {
        // These have an end displacement, which must be declared.
        let (history, _) = by(correction);
        let end = history.report().end_displacement;
        let record = format!(
            "[[record]]\nname = \"r\"\nconvention = \"incident\"\n{one}baseline = {{ {keys} }}\nend_displacement = {end:?}\n"
        );
        let wave = "[[wave]]\nkind = \"sv\"\nincidence = 20\nrecord = \"r\"\n";
        let signal = history.into_signal(EndDisplacement::Declared(end)).unwrap();
        let twin = under(parameters(WaveKind::SV, 20.0, 0.0), Arc::new(signal));
        variants.equal((WAVE, &format!("{record}{wave}")), twin);
    }
}

/// The convention of a record fixes the size of the incident wave, which is reported.
#[test]
fn conventions() {
    use SurfaceComponent::{X, Y, Z};
    let variants = Variants::new("conventions");
    std::fs::write(variants.0.join("one.txt"), text(&samples(90))).unwrap();
    let surface = InputConvention::SurfaceComponent;
    let within = |component, regularisation| InputConvention::Within {
        depth: 80.0,
        component,
        regularisation: Some(regularisation),
    };
    for (kind, name, keys, convention) in [
        (WaveKind::SV, "sv", "\"outcrop\"", InputConvention::Outcrop),
        (WaveKind::SV, "sv", "\"surface-x\"", surface(X)),
        (WaveKind::SV, "sv", "\"surface-along\"", surface(X)),
        (WaveKind::SH, "sh", "\"surface-across\"", surface(Y)),
        (WaveKind::SH, "sh", "\"surface-y\"", surface(Y)),
        (WaveKind::P, "p", "\"surface-z\"", surface(Z)),
        (
            WaveKind::SV,
            "sv",
            "{ within = { depth = 80, component = \"x\", regularisation = 0.3 } }",
            within(X, 0.3),
        ),
        (
            WaveKind::SH,
            "sh",
            "{ within = { depth = 80, component = \"y\", regularisation = 0.2 } }",
            within(Y, 0.2),
        ),
        (
            WaveKind::P,
            "p",
            "{ within = { depth = 80, component = \"z\", regularisation = 0.2 } }",
            within(Z, 0.2),
        ),
    ] {
        let record = format!(
            "[[record]]\nname = \"r\"\nconvention = {keys}\nfile = \"one.txt\"\ntime_step = 0.01\nunits = \"m/s2\"\nbaseline = {{ kind = \"velocity-polynomial\", order = 3 }}\n"
        );
        let wave = format!("[[wave]]\nkind = \"{name}\"\nincidence = 20\nrecord = \"r\"\n");
        let mut parameters = parameters(kind, 20.0, 0.0);
        parameters.convention = convention;
        let (history, _) = corrected(&history(), REST);
        let signal = history.into_signal(EndDisplacement::Declared(0.0)).unwrap();
        let signal = Arc::new(signal);
        let expected = *PlaneWave::new(parameters, signal.clone())
            .unwrap()
            .conversion();
        let keys = format!("{record}{wave}");
        let scene = variants.read(WAVE, &keys).unwrap();
        let told = scene.remarks().iter().any(|remark| {
            matches!(remark, Remark::Conversion(remark::Conversion { conversion, .. }) if *conversion == expected)
        });
        assert!(told, "{keys}");
        // The run is as long as it takes for the wave to come.
        let padding = scene.remarks().iter().find_map(|remark| match remark {
            Remark::QuietStart(remark::QuietStart { padding, .. }) => Some(*padding),
            _ => None,
        });
        let duration = 0.6 + padding.unwrap_or(0.0).ceil();
        let text = CUBE.replace(WAVE, &keys);
        let text = text.replace("duration = 0.6\n", &format!("duration = {duration}\n"));
        variants.equal(
            (CUBE, &text),
            under(parameters, signal).with_duration(duration),
        );
    }
}

/// A record along x or y of a wave has a warning if the azimuth is not 0, unless its convention is unambiguous.
#[test]
fn turned_axes_are_warned_of() {
    let variants = Variants::new("axes");
    std::fs::write(variants.0.join("one.txt"), text(&samples(90))).unwrap();
    let within =
        |component: &str| format!("{{ within = {{ depth = 80, component = \"{component}\" }} }}");
    let names = ["x", "y", "z", "along", "across"];
    let conventions = names
        .map(|name| (name, within(name)))
        .into_iter()
        .chain(names.map(|name| (name, format!("\"surface-{name}\""))));
    for (name, convention) in conventions.chain([("", "\"outcrop\"".to_owned())]) {
        let kind = match name {
            "y" | "across" => "sh",
            "z" => "p",
            _ => "sv",
        };
        for azimuth in [0.0, 90.0, 180.0, -35.0, 360.0] {
            let keys = format!(
                "[[record]]\nname = \"r\"\nconvention = {convention}\nfile = \"one.txt\"\ntime_step = 0.01\nunits = \"m/s2\"\nbaseline = {{ kind = \"velocity-polynomial\", order = 3 }}\n\
                 [[wave]]\nkind = \"{kind}\"\nincidence = 20\nazimuth = {azimuth}\nrecord = \"r\"\n"
            );
            let scene = variants.read(WAVE, &keys).unwrap();
            let warned = scene
                .remarks()
                .iter()
                .any(|remark| matches!(remark, Remark::RotatedAxis(_)) && remark.is_warning());
            let expected = azimuth % 360.0 != 0.0 && ["x", "y"].contains(&name);
            assert_eq!(warned, expected, "{convention} {azimuth}");
        }
    }
}

/// The components of a station have one length and one scale factor; each wave uses its own, and a prescribed motion may
/// use one, too.
#[test]
fn components() {
    let variants = Variants::new("components");
    let write = |name: &str, samples: &[f64]| {
        std::fs::write(variants.0.join(name), text(samples)).unwrap();
    };
    let half: Vec<f64> = samples(80).iter().map(|a| 0.5 * a).collect();
    write("x.txt", &samples(90));
    write("z.txt", &half);
    let table = "[[record]]\nname = \"r\"\nconvention = \"incident\"\ncomponents = { x = \"x.txt\", z = \"z.txt\" }\ntime_step = 0.01\nunits = \"m/s2\"\nbaseline = { kind = \"velocity-polynomial\", order = 3 }\npeak = 2\n";
    let of_record = |component: &str| {
        format!(
            "[[wave]]\nkind = \"sv\"\nincidence = 20\nrecord = \"r\"\ncomponent = \"{component}\"\n"
        )
    };
    for (length, count) in [
        ("", 90),
        ("length = \"pad\"\n", 90),
        ("length = \"cut\"\n", 80),
    ] {
        let part = |samples: Vec<f64>| {
            let mut samples = samples;
            samples.resize(count, 0.0);
            corrected(&TimeHistory::new(0.01, samples).unwrap(), REST).0
        };
        let (x, z) = (part(samples(90)), part(half.clone()));
        let largest = |history: &TimeHistory| {
            let samples = history.acceleration().into_iter();
            samples.fold(0.0_f64, |most, a| most.max(a.abs()))
        };
        let factor = 2.0 / largest(&x);
        assert!(largest(&z) < largest(&x));
        let signal = |history: &TimeHistory| {
            let scaled = history.scaled(factor).unwrap();
            scaled.into_signal(EndDisplacement::Declared(0.0)).unwrap()
        };
        for (component, history) in [("x", &x), ("z", &z)] {
            let keys = format!("{table}{length}{}", of_record(component));
            let parameters = parameters(WaveKind::SV, 20.0, 0.0);
            variants.equal((WAVE, &keys), under(parameters, Arc::new(signal(history))));
        }
        let mesh = cube();
        let signal = signal(&z);
        let twin = cube_scene().prescribed(Prescribed {
            nodes: mesh.nodes_of_facets(mesh.facet_set("top").unwrap()),
            direction: Vec3::x(),
            displacement: Box::new(move |t: f64| signal.motion(t).displacement),
        });
        let keys = format!(
            "{table}{length}[[support]]\nkind = \"prescribed\"\nset = \"top\"\ndirection = [1, 0, 0]\nrecord = \"r.z\"\n[time]"
        );
        variants.equal(("[time]", &keys), twin);
    }
    // A component that does not exist, and a missing choice of component.
    for wave in [
        of_record("y"),
        of_record("x").replace("component = \"x\"\n", ""),
    ] {
        let Err(Error::Scene(fault)) = variants.read(WAVE, &format!("{table}{wave}")) else {
            panic!("{wave} was accepted")
        };
        assert!(
            fault.render(false).contains("available: r.x, r.z"),
            "{fault}"
        );
    }
}

/// The names that programs take from [`powerhouse::keys`] are keys and values of scene files.
#[test]
fn names_for_programs_are_those_of_scene_files() {
    let registry = Registry::default();
    let of = |name| registry.boundary_keys(name).unwrap();
    assert_eq!(of(keys::VISCOUS), [keys::INPUT]);
    let mut springs = vec![keys::AMPLITUDE_RATIO, keys::SPEED_RATIO, keys::DISTANCE];
    springs.extend(keys::AXES);
    springs.extend([keys::SPREADING, keys::INPUT]);
    springs.sort_unstable();
    assert_eq!(of(keys::VISCOUS_SPRING), springs);
    let variants = Variants::new("keys");
    let read = |more: &str| {
        let kind = format!("{} = \"{}\"", keys::KIND, keys::VISCOUS_SPRING);
        variants.read(&kind, &format!("{kind}\n{more}"))
    };
    let (input, ratio) = (keys::INPUT, keys::SPEED_RATIO);
    for more in [
        format!(
            "{} = {{ {} = 90, {ratio} = 1.1 }}",
            keys::AXES[2],
            keys::DISTANCE
        ),
        format!("{input} = \"{}\"", keys::FULL_FIELD),
        format!("{input} = {{ {} = [\"bottom\"] }}", keys::INCIDENT_ONLY),
        format!("{} = \"{}\"", keys::SPREADING, keys::CYLINDRICAL),
    ] {
        assert!(read(&more).is_ok(), "{more}");
        let wrong = more.replacen(" = ", "s = ", 1);
        assert!(read(&wrong).is_err(), "{wrong}");
    }
}
