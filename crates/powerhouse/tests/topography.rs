//! Surfaces that are not flat inside the box: a canyon against a series, a hill, and what is reported.

use std::f64::consts::PI;
use std::sync::Arc;

use powerhouse::boundary::{Spreading, ViscousSpring};
use powerhouse::engine::PeriodicPairs;
use powerhouse::engine::observe::Motion;
use powerhouse::io::write_gmsh;
use powerhouse::material::LinearElastic;
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, Complex, PlaneWave, PlaneWaveParameters, Ricker, RickerQuantity, WaveKind,
};
use powerhouse::{
    Boundary, FileScene, Material, OutputPlan, Part, Registry, Remark, RunHooks, Scene, remark,
};
use powerhouse_test_support::TestFolder;

/// Rock with S waves of 1 m/s, so that times are in radii of the canyon over their speed.
fn rock() -> ElasticMedium {
    ElasticMedium::new(2.5, 0.25, 1.0).unwrap()
}

/// Bessel functions of the first and second kind of orders 0 to `count` - 1 at `x` > 0: the first by Miller's backward recurrence,
/// the second forwards from Neumann's series for the order 0 and the Wronskian (M. Abramowitz, I. A. Stegun, 1964, Handbook of
/// Mathematical Functions, 9.1.16, 9.1.27, 9.1.88, 9.12).
fn bessel(x: f64, count: usize) -> (Vec<f64>, Vec<f64>) {
    let start = 2 * ((x as usize + count + 40) / 2);
    let mut j = vec![0.0; start + 2];
    j[start] = 1e-300;
    for n in (1..=start).rev() {
        j[n - 1] = 2.0 * n as f64 / x * j[n] - j[n + 1];
        if j[n - 1].abs() > 1e200 {
            j.iter_mut().for_each(|value| *value *= 1e-200);
        }
    }
    let even = (1..=start / 2).map(|k| j[2 * k]).sum::<f64>();
    let scale = 1.0 / (j[0] + 2.0 * even);
    j.iter_mut().for_each(|value| *value *= scale);
    const EULER: f64 = 0.577_215_664_901_532_9;
    let series = (1..start / 2).map(|k| {
        let sign = if k % 2 == 1 { 1.0 } else { -1.0 };
        sign * j[2 * k] / k as f64
    });
    let zero = 2.0 / PI * ((0.5 * x).ln() + EULER) * j[0] + 4.0 / PI * series.sum::<f64>();
    let mut y = vec![zero];
    y.push((j[1] * zero - 2.0 / (PI * x)) / j[0]);
    for n in 1..count {
        y.push(2.0 * n as f64 / x * y[n] - y[n - 1]);
    }
    j.truncate(count + 1);
    (j, y)
}

/// Motion at a point for unit incident SH waves with the wavenumber k from a side, at an angle from the vertical: that of a
/// half-space with a semicircular canyon of radius 1, the phase zero of the incident wave at its centre.
///
/// Source: M. D. Trifunac (1973), Bull. Seism. Soc. Am. 63, 1267-1281. With the angle t from +x downwards, `u = 2 exp(-i k x sin g)
/// cos(k d cos g) + sum A_n H_n(k r) cos n t`, `A_n = -c_n J_n'(k) / H_n'(k)`, H the Hankel functions of the second kind,
/// `c_0 = 2`, `c_n = 2 (exp(-i n g) + (-1)^n exp(i n g))`.
fn canyon(k: f64, incidence: f64, point: [f64; 2]) -> Complex {
    let [x, z] = point;
    let (radius, angle) = (x.hypot(z), (-z).atan2(x));
    // Orders far above the argument add nothing, and their functions overflow.
    let count = (1.5 * k) as usize + 18;
    let (j, y) = bessel(k, count + 1);
    let (jr, yr) = bessel(k * radius, count + 1);
    let g = incidence;
    let i = Complex::new(0.0, 1.0);
    let free = (-i * k * x * incidence.sin()).exp() * 2.0 * (k * z * incidence.cos()).cos();
    let scattered = (0..count).map(|n| {
        let derivative = |f: &[f64]| match n {
            0 => -f[1],
            _ => f[n - 1] - n as f64 / k * f[n],
        };
        let hankel = Complex::new(derivative(&j), -derivative(&y));
        let own = (-i * n as f64 * g).exp();
        let sign = if n % 2 == 0 { 1.0 } else { -1.0 };
        let c = match n {
            0 => Complex::new(2.0, 0.0),
            _ => (own + own.conj() * sign) * 2.0,
        };
        let outgoing = Complex::new(jr[n], -yr[n]);
        -c * derivative(&j) / hankel * outgoing * (n as f64 * angle).cos()
    });
    free + scattered.sum::<Complex>()
}

/// Series against amplitudes of another solution, the motion over that of the incident wave at x = -2, -1, 0, 1 and 2 radii, for
/// diameters of half, one and two wavelengths.
#[test]
fn the_series_is_that_of_another_solution() {
    for (eta, degrees, expected) in [
        (0.5, 0.0, [2.699, 2.742, 2.035, 2.742, 2.699]),
        (0.5, 30.0, [2.000, 3.099, 1.385, 1.756, 2.142]),
        (0.5, 60.0, [1.426, 3.436, 1.709, 1.072, 1.196]),
        (1.0, 30.0, [1.587, 3.290, 2.299, 1.812, 2.208]),
        (1.0, 60.0, [2.827, 3.736, 0.938, 0.863, 1.202]),
        (2.0, 0.0, [1.922, 2.657, 2.017, 2.657, 1.922]),
        (2.0, 60.0, [2.588, 3.852, 2.456, 0.973, 1.491]),
    ] {
        for (x, expected) in [-2.0f64, -1.0, 0.0, 1.0, 2.0].into_iter().zip(expected) {
            let z = -(1.0 - x * x).max(0.0).sqrt();
            let found = canyon(PI * eta, f64::to_radians(degrees), [x, z]).norm();
            assert!(
                (found - expected).abs() < 6e-4,
                "{eta} {degrees} {x}: {found} {expected}"
            );
        }
    }
}

/// Central frequency of the Ricker pulse, whose wave is as long as the canyon is wide, and the time at which it passes the
/// canyon's centre: the body is still at rest at zero.
const FREQUENCY: f64 = 0.5;
const DELAY: f64 = 9.0;
/// Its displacement (radii): velocities stay far below those of the waves.
const AMPLITUDE: f64 = 0.01;

/// Slice of a box of 6 by 3 radii around a semicircular canyon of radius 1: rays go from `around` points of the wall to as many of
/// the outer faces, in `out` steps.
fn canyon_body([around, out]: [usize; 2]) -> Mesh {
    let thickness = 0.1;
    let high = Vec3::new(1.0, thickness, 1.0);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, [around, 1, out], "rock").unwrap();
    let place = |at: Vec3| {
        let angle = PI * (1.0 + at.x);
        let wall = [angle.cos(), angle.sin()];
        let way = 12.0 * at.x;
        let outer = match way {
            way if way < 3.0 => [-3.0, -way],
            way if way < 9.0 => [way - 6.0, -3.0],
            way => [3.0, way - 12.0],
        };
        let [x, z]: [f64; 2] = core::array::from_fn(|k| outer[k] + at.z * (wall[k] - outer[k]));
        let rounded = |value: f64| if value.abs() < 1e-12 { 0.0 } else { value };
        Vec3::new(rounded(x), at.y, rounded(z))
    };
    let mut mesh = mesh.map_positions(place).unwrap();
    let outer = mesh.facet_set("bottom").unwrap().to_vec();
    mesh.set_facet_set("outer", outer).unwrap();
    mesh
}

/// Stations on the wall, every 30 degrees, and on the surface beside it.
fn stations() -> Vec<[f64; 2]> {
    let on_wall = (0..=6).map(|i| {
        let angle = PI * (1.0 + f64::from(i) / 6.0);
        [angle.cos(), angle.sin()]
    });
    let beside = [-2.0, -1.5, 1.5, 2.0].map(|x| [x, 0.0]);
    on_wall.chain(beside).collect()
}

/// Motion of the stations at some times by the series: of a Ricker pulse as the sum of its frequencies.
fn by_series(degrees: f64, times: &[f64]) -> Vec<Vec<f64>> {
    // The sum repeats itself after this time, in which all has died out.
    let period = 60.0;
    let highest = (4.0 * FREQUENCY * period) as usize;
    let of_station = |point: [f64; 2]| {
        let spectrum = (1..=highest).map(|index| {
            let frequency = index as f64 / period;
            let share = frequency / FREQUENCY;
            let size = 2.0 / PI.sqrt() / FREQUENCY * share * share * (-share * share).exp();
            let omega = 2.0 * PI * frequency;
            let motion = canyon(omega, degrees.to_radians(), point);
            (omega, motion * (2.0 * AMPLITUDE * size / period))
        });
        let spectrum: Vec<(f64, Complex)> = spectrum.collect();
        let at = |time: &f64| {
            let terms = spectrum
                .iter()
                .map(|(omega, value)| (value * Complex::new(0.0, omega * (time - DELAY)).exp()).re);
            terms.sum::<f64>()
        };
        times.iter().map(at).collect()
    };
    stations().into_iter().map(of_station).collect()
}

/// Relative L2 error of the motion of all stations, and the largest difference of a station over its peak.
fn canyon_error(cells: [usize; 2], degrees: f64) -> [f64; 2] {
    let mesh = canyon_body(cells);
    let of = |set: &str| mesh.nodes_of_facets(mesh.facet_set(set).unwrap());
    let pairs = PeriodicPairs::by_translation(&mesh, &of("front"), &of("back"), 1e-6).unwrap();
    let mut parameters = PlaneWaveParameters::vertical(WaveKind::SH, rock(), 0.0);
    parameters.incidence = Angle::from_degrees(degrees);
    let pulse = Ricker::new(RickerQuantity::Displacement, AMPLITUDE, FREQUENCY, DELAY).unwrap();
    let boundary = ViscousSpring {
        spreading: Spreading::Cylindrical,
        ..ViscousSpring::default()
    };
    let mut output = OutputPlan::default().with_every(0.05);
    for (index, [x, z]) in stations().into_iter().enumerate() {
        let point = Vec3::new(x, 0.0, z);
        output = output.history(&format!("s{index}"), point, Motion::DISPLACEMENT);
    }
    let scene = Scene::new("canyon", mesh)
        .part(Part::new(
            "rock",
            Material::from(LinearElastic::new(rock())),
        ))
        .with_plane_waves(vec![PlaneWave::new(parameters, Arc::new(pulse)).unwrap()])
        .unwrap()
        .with_boundary(Boundary::new(boundary, ["outer"]).with_scatterer(Vec3::zeros()))
        .with_periodic_pairs(pairs)
        .allow_magnitudes()
        .with_duration(22.0)
        .with_output(output);
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let exact = by_series(degrees, &results.histories().times);
    let (mut missed, mut all, mut worst) = (0.0, 0.0, 0.0f64);
    for (index, exact) in exact.iter().enumerate() {
        let column = results.histories().column(&format!("s{index}.uy")).unwrap();
        let (mut largest, mut peak) = (0.0f64, 0.0f64);
        for (found, exact) in column.values.iter().zip(exact) {
            missed += (found - exact).powi(2);
            all += exact * exact;
            largest = largest.max((found - exact).abs());
            peak = peak.max(exact.abs());
        }
        worst = worst.max(largest / peak);
    }
    [(missed / all).sqrt(), worst]
}

/// A canyon under SH waves of 0, 30 and 60 degrees, in a box of 6 by 3 radii whose faces carry the flat half-space's field, moves like
/// Trifunac's solution: within 3 % (relative L2 over the stations) and 4 % of a station's peak with 40 elements to the
/// wavelength of the pulse's central frequency; the error falls at least by half with half the elements' size.
#[test]
fn a_canyon_moves_like_its_closed_form() {
    for degrees in [0.0, 30.0, 60.0] {
        let [coarse, fine] = [[120, 32], [240, 64]].map(|cells| canyon_error(cells, degrees));
        println!("figure canyon.sh_{degrees} {coarse:?} {fine:?}");
        assert!(fine[0] <= 0.03 && fine[1] <= 0.04, "{degrees}: {fine:?}");
        assert!(fine[0] <= 0.5 * coarse[0], "{degrees}: {coarse:?} {fine:?}");
    }
}

/// Height of the hill, half its width, and the size of elements (m).
const HILL: f64 = 10.0;
const WIDTH: f64 = 24.0;
const SIZE: f64 = 4.0;

/// Writes the mesh of a box about x = y = 0 with a hill on its top: half as wide as `half`, as deep as it; a ridge along y if the
/// box is one element thick.
fn write_hill(folder: &TestFolder, [half, thickness]: [f64; 2], height: f64) {
    let low = Vec3::new(-half, -0.5 * thickness, -half);
    let high = Vec3::new(half, 0.5 * thickness, 0.0);
    let cells = [2.0 * half, thickness, half].map(|length| (length / SIZE).round() as usize);
    let mesh = Mesh::box_of_hexes(low, high, cells, "rock").unwrap();
    let is_ridge = cells[1] == 1;
    let raised = mesh.map_positions(|at| {
        let distance = if is_ridge {
            at.x.abs()
        } else {
            at.x.hypot(at.y)
        };
        let share = (distance / WIDTH).min(1.0);
        let rise = height * 0.5 * (1.0 + (PI * share).cos());
        Vec3::new(at.x, at.y, at.z + rise * (1.0 + at.z / half))
    });
    write_gmsh(folder.join("hill.msh"), &raised.unwrap()).unwrap();
}

const SITE: &str = r#"
title = "hill"
[mesh]
file = "hill.msh"
[[material]]
name = "rock"
law = "elastic"
young = 2e9
poisson = 0.25
density = 2200
[[part]]
set = "rock"
material = "rock"
[[wave]]
kind = "sv"
incidence = 15
azimuth = 20
reference = [0, 0, -60]
arrival = 0.2
pulse = { kind = "ricker", displacement = 0.01, frequency = 6 }
[boundary]
kind = "viscous-spring"
faces = ["left", "right", "front", "back", "bottom"]
scatterer = [0, 0, 0]
[time]
duration = 0.9
step = 1e-3
[output]
every = 0.002
[[output.history]]
name = "crest"
at = [0, 0, 10]
"#;

fn read(folder: &TestFolder, text: &str) -> Result<Scene, String> {
    let scene = FileScene::from_toml(text, folder.join("hill.toml"), &Registry::default())
        .map(FileScene::into_scene);
    scene.map_err(|error| error.to_string())
}

/// Displacement of the crest of a hill in a box of some half width.
fn crest(half: f64) -> Vec<f64> {
    let folder = TestFolder::new("hill");
    write_hill(&folder, [half, 2.0 * half], HILL);
    let scene = read(&folder, SITE).unwrap();
    let results = scene.prepare().unwrap().run(RunHooks::default()).unwrap();
    let columns = ["crest.ux", "crest.uy", "crest.uz"].into_iter();
    let columns = columns.map(|name| results.histories().column(name).unwrap().values.clone());
    columns.flatten().collect()
}

/// The crest of a hill moves alike in a box and in one twice as wide and deep, to 5 %; and otherwise than the flat ground.
#[test]
fn a_hill_moves_alike_in_a_larger_box() {
    let [small, large] = [36.0, 72.0].map(crest);
    let folder = TestFolder::new("flat");
    write_hill(&folder, [36.0, 72.0], 0.0);
    let flat = read(&folder, &SITE.replace("at = [0, 0, 10]", "at = [0, 0, 0]")).unwrap();
    let flat = flat.prepare().unwrap().run(RunHooks::default()).unwrap();
    let norm = |values: &mut dyn Iterator<Item = f64>| values.map(|u| u * u).sum::<f64>().sqrt();
    let all = norm(&mut large.iter().copied());
    let apart = norm(&mut small.iter().zip(&large).map(|(a, b)| a - b)) / all;
    let flat = &flat.histories().column("crest.ux").unwrap().values;
    let relief = norm(&mut flat.iter().zip(&large).map(|(a, b)| a - b)) / all;
    println!("figure hill.box {apart} {relief}");
    assert!(apart <= 0.05, "{apart}");
    assert!(relief > 0.1, "{relief}");
}

/// The surface of the field is that of the faces; a hill and a canyon are reported, a flat surface is not; no traction of the field is warned
/// of; and so it is in a slice between rollers, whose nodes reach above the field.
#[test]
fn relief_is_reported() {
    let folder = TestFolder::new("relief");
    let slice = SITE
        .replace("\"front\", \"back\", ", "")
        .replace("azimuth = 20", "azimuth = 0")
        .replace(
            "[boundary]",
            "[[support]]\nkind = \"roller\"\nset = \"front\"\n[[support]]\nkind = \"roller\"\nset = \"back\"\n[boundary]\nspreading = \"cylindrical\"",
        );
    for (text, thickness) in [(SITE, 72.0), (&slice, SIZE)] {
        for height in [HILL, -HILL, 0.0] {
            write_hill(&folder, [36.0, thickness], height);
            let text = text.replace("at = [0, 0, 10]", &format!("at = [0, 0, {height}]"));
            let scene = read(&folder, &text).unwrap();
            assert_eq!(scene.surface(), Some(0.0));
            let simulation = scene.prepare().unwrap();
            let remarks = simulation.remarks();
            let told = remarks.iter().find_map(|remark| match remark {
                Remark::Relief(remark::Relief {
                    surface,
                    lowest,
                    highest,
                }) => Some([*surface, *lowest, *highest]),
                _ => None,
            });
            let expected = [0.0, height.min(0.0), height.max(0.0)];
            assert_eq!(
                told,
                (height != 0.0).then_some(expected),
                "{height} {thickness}"
            );
            let loaded = remarks
                .iter()
                .any(|r| matches!(r, Remark::LoadedSurface(_)));
            assert!(!loaded, "{height} {thickness}");
        }
    }
}

/// A field above its surface is refused: a surface that is given below the upper edge of the faces, and a start from the field's own
/// motion, which no hill has.
#[test]
fn no_field_is_above_its_surface() {
    let folder = TestFolder::new("above");
    write_hill(&folder, [36.0, 72.0], HILL);
    let low = format!("[ground]\nsurface = -8\n{SITE}").replace("\ntitle = \"hill\"", "");
    let low = format!("title = \"hill\"\n{low}");
    let told = read(&folder, &low).and_then(|s| s.prepare().map_err(|e| e.to_string()));
    let told = told.err().unwrap();
    assert!(told.contains("above the free surface"), "{told}");
    let moving = SITE.replace("duration = 0.9", "duration = 0.9\ninitial = \"field\"");
    let simulation = read(&folder, &moving)
        .unwrap()
        .prepare()
        .map_err(|e| e.to_string());
    let told = simulation.and_then(|s| s.run(RunHooks::default()).map_err(|e| e.to_string()));
    let told = told.err().unwrap();
    assert!(told.contains("above the free surface"), "{told}");
}

/// A hill is in equilibrium under its weight after a stage, in which what lies above the level of the in-situ stress settles, as a warning
/// says; then it stays at rest until the wave arrives.
#[test]
fn a_hill_rests_under_its_weight() {
    let folder = TestFolder::new("weight");
    write_hill(&folder, [36.0, 72.0], HILL);
    let rollers = ["left", "right", "front", "back", "bottom"]
        .map(|set| format!("{{ kind = \"roller\", set = \"{set}\" }}"));
    let stage = format!(
        "[in_situ_stress]\nkind = \"ground\"\nlevel = 0\ndensity = 2200\nlateral = 0.5\n[[load]]\nkind = \"gravity\"\n[[stage]]\nname = \"weight\"\nsupport = [{}]\n[time]",
        rollers.join(", ")
    );
    let text = SITE
        .replace("[time]", &stage)
        .replace("duration = 0.9", "duration = 0.1")
        .replace("arrival = 0.2", "arrival = 1");
    let simulation = read(&folder, &text).unwrap().prepare().unwrap();
    let mut remarks = simulation.remarks().iter();
    assert!(remarks.any(
        |r| matches!(r, Remark::AboveGround(remark::AboveGround { top, .. }) if *top == HILL)
    ));
    let results = simulation.run(RunHooks::default()).unwrap();
    let crest = &results.histories().column("crest.vz").unwrap().values;
    let fastest = crest.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    assert!(fastest < 1e-9, "{fastest}");
}
