//! A pressure step in a spherical cavity, with three absorbing boundaries at small distances.
//!
//! Builds on `absorbing_box`. The waves spread spherically, as the springs of the boundaries assume: one octant of the ground
//! between three planes of symmetry, out to two, three and five radii of the cavity.
//!
//! ```text
//!   z  |  outside: springs and dashpots
//!      |---...__
//!      |        `-.
//!      |--._       `.     rock
//!      |    `.  p    \
//!      |  p   \      |
//!      +-------|-----|----  x       all three planes on rollers
//!      0       a     R
//! ```
//!
//! The wall moves outwards, overshoots its static displacement by a quarter and stops. The boundary changes this
//! static displacement: with dashpots it is that of a hollow sphere with a free outside, with springs that of a sphere on an
//! elastic foundation. Both have closed forms, and so has the reflection of a spherical wave at every frequency. Springs of
//! `4 G/R` have the static stiffness of the ground outside the mesh, with which the static displacement is exact.
//!
//! Run: `cargo run --release --example spherical_cavity`

use std::process::ExitCode;

use powerhouse::boundary::{AxisParameters, InputMode, Viscous, ViscousSpring};
use powerhouse::engine::observe::{HistoryTable, Motion};
use powerhouse::engine::{FacePressure, Profile, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{AbsorbingBoundary, ElasticMedium, Vec3};
use powerhouse::wavefield::Complex;
use powerhouse::{Boundary, Material, OutputPlan, Part, RunHooks, Scene};
use powerhouse_examples::reference::ReferenceTable;
use powerhouse_examples::{Figures, Outcome};
use powerhouse_study::ShellOctant;

const CAVITY: f64 = 10.0;
const PRESSURE: f64 = 1.0e6;
/// Rise time of the pressure (s), so that its front is not shorter than an element.
const RISE: f64 = 1.0e-3;
/// Duration (s) after which every model here has stopped.
const DURATION: f64 = 0.3;

fn rock() -> Outcome<ElasticMedium> {
    Ok(ElasticMedium::new(1.0e10, 0.25, 2700.0)?)
}

/// Boundary on the outer face.
struct Outside {
    /// Name in the names of figures and in the table of reflections.
    name: &'static str,
    tabled: &'static str,
    springs: Springs,
    /// Coefficient B of the dashpots.
    speed_ratio: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Springs {
    None,
    /// `(lambda + 2 G)/((1 + A) R)`, A = 0.8.
    Paper,
    /// `4 G / R`, the static stiffness of the ground outside the mesh.
    Static,
}

const BOUNDARIES: [Outside; 4] = [
    Outside {
        name: "viscous",
        tabled: "Lysmer B=1 K=0",
        springs: Springs::None,
        speed_ratio: 1.0,
    },
    Outside {
        name: "springs_b11",
        tabled: "VSB A=.8 B=1.1",
        springs: Springs::Paper,
        speed_ratio: 1.1,
    },
    Outside {
        name: "springs_b10",
        tabled: "A=.8 B=1",
        springs: Springs::Paper,
        speed_ratio: 1.0,
    },
    Outside {
        name: "static",
        tabled: "B=1 K=4G/R (static-exact)",
        springs: Springs::Static,
        speed_ratio: 1.0,
    },
];

impl Outside {
    /// Spring stiffness at a distance (N/m3).
    fn bed(&self, far: f64) -> Outcome<f64> {
        let rock = rock()?;
        Ok(match self.springs {
            Springs::None => 0.0,
            Springs::Paper => rock.constrained() / (1.8 * far),
            Springs::Static => 4.0 * rock.shear() / far,
        })
    }

    fn condition(&self, far: f64) -> Outcome<Box<dyn AbsorbingBoundary>> {
        let input = InputMode::Nothing;
        if self.springs == Springs::None {
            return Ok(Box::new(Viscous { input }));
        }
        // The distance at which the paper's springs have this stiffness.
        let distance = rock()?.constrained() / (1.8 * self.bed(far)?);
        Ok(Box::new(ViscousSpring {
            axes: [AxisParameters::new(0.8, self.speed_ratio, Some(distance))?; 3],
            input,
            ..ViscousSpring::default()
        }))
    }
}

/// Mesh density.
#[derive(Clone, Copy)]
struct Division {
    /// Numbers of elements along a side of a patch, and along the radius per radius of the cavity at the wall.
    around: usize,
    along: f64,
}

/// Histories of the radial displacements of wall and outer face, `wall.ux` and `outside.ux`.
fn motion(far: f64, division: Division, outside: &Outside) -> Outcome<HistoryTable> {
    let rings = (division.along * (far / CAVITY).ln()).ceil() as usize;
    let (inner, outer, around) = (CAVITY, far, division.around);
    let mesh = ShellOctant {
        inner,
        outer,
        around,
        rings,
    }
    .mesh()?;
    let wall = mesh.facet_set("wall")?;
    let history = Box::new(|time: f64| PRESSURE * (time / RISE).min(1.0));
    let pressure = FacePressure::new(&mesh, wall, Profile::Uniform, history)?;
    let mut supports = Vec::new();
    for (cut, normal) in [
        ("left", Vec3::x()),
        ("front", Vec3::y()),
        ("bottom", Vec3::z()),
    ] {
        supports.push(Support::roller(
            mesh.nodes_of_facets(mesh.facet_set(cut)?),
            normal,
        ));
    }
    let output = OutputPlan::default()
        .with_every(1.0e-4)
        .history("wall", Vec3::new(CAVITY, 0.0, 0.0), Motion::DISPLACEMENT)
        .history("outside", Vec3::new(far, 0.0, 0.0), Motion::DISPLACEMENT);
    let scene = Scene::new("spherical cavity", mesh)
        .part(Part::new(
            "rock",
            Material::from(LinearElastic::new(rock()?)),
        ))
        .with_boundary(
            Boundary::new(outside.condition(far)?, ["outside"]).with_scatterer(Vec3::zeros()),
        )
        .load(pressure)
        .with_duration(DURATION)
        .with_output(output);
    let scene = supports.into_iter().fold(scene, Scene::support);
    Ok(scene
        .prepare()?
        .run(RunHooks::default())?
        .histories()
        .clone())
}

fn column<'a>(table: &'a HistoryTable, name: &str) -> Outcome<&'a [f64]> {
    let column = table
        .column(name)
        .ok_or_else(|| format!("no column '{name}'"))?;
    Ok(&column.values)
}

/// Static displacement of the wall in infinite ground (m): `p a / (4 G)`.
fn resting_place() -> Outcome<f64> {
    Ok(PRESSURE * CAVITY / (4.0 * rock()?.shear()))
}

/// Static displacement of the wall over that in infinite ground, with an elastic foundation (N/m3) on the outer face.
///
/// `u = c1 r + c2/r^2`, `sigma = (3 lambda + 2 G) c1 - 4 G c2/r^3`, with `sigma(a) = -p` and
/// `sigma(R) = -bed u(R)`.
fn rests_at(far: f64, bed: f64) -> Outcome<f64> {
    let rock = rock()?;
    let even = 3.0 * rock.lambda() + 2.0 * rock.shear();
    let stress = |r: f64| [even, -4.0 * rock.shear() / r.powi(3)];
    let moved = |r: f64| [r, 1.0 / (r * r)];
    let [[a1, a2], [b1, b2]] = [
        stress(CAVITY),
        [0, 1].map(|i| stress(far)[i] + bed * moved(far)[i]),
    ];
    let of_pressure = -PRESSURE / (a1 * b2 - a2 * b1);
    let wall = moved(CAVITY);
    Ok(of_pressure * (wall[0] * b2 - wall[1] * b1) / resting_place()?)
}

/// Reflection coefficient of the outer face for a spherical wave, at `number = w R / cp`.
///
/// With the potential `(F exp(-ikr) + H exp(ikr))/r` the displacement is
/// `F o(r) + H conj(o(r))`, `o(r) = -(1 + ikr) exp(-ikr)/r^2`; those of wall and outer face
/// determine `|H/F|`.
fn returned_share(table: &HistoryTable, far: f64, number: f64) -> Outcome<f64> {
    let wave_number = number / far;
    let frequency = wave_number * rock()?.p_speed();
    let spectrum = |name: &str| -> Outcome<Complex> {
        let values = column(table, name)?.windows(2).zip(&table.times);
        let terms = values.map(|(u, t)| Complex::from_polar(u[1] - u[0], -frequency * t));
        Ok(terms.sum())
    };
    let outgoing = |r: f64| {
        let kr = wave_number * r;
        -Complex::new(1.0, kr) * Complex::from_polar(1.0 / (r * r), -kr)
    };
    let (wall, outside) = (spectrum("wall.ux")?, spectrum("outside.ux")?);
    let (near, away) = (outgoing(CAVITY), outgoing(far));
    let out = wall * away.conj() - outside * near.conj();
    let back = near * outside - away * wall;
    Ok(back.norm() / out.norm())
}

fn figures(distances: &[f64], division: Division) -> Outcome<Figures> {
    let mut figures = Figures::default();
    let reflections = ReferenceTable::read("sphere_boundary_reflection.csv")?;
    let numbers = reflections.column("w R/cp")?;
    let open = ReferenceTable::read("sphere_pressure_step.csv")?.column("u_r(a)_m")?;
    let open_peak = open.iter().fold(0.0_f64, |peak, u| peak.max(*u));
    for &radii in distances {
        let far = radii * CAVITY;
        for outside in &BOUNDARIES {
            let name = outside.name;
            let table = motion(far, division, outside)?;
            let wall = column(&table, "wall.ux")?;
            let peak = wall.iter().fold(0.0_f64, |peak, u| peak.max(*u));
            // Elements that grow outwards trap some of the front's shortest waves at the wall.
            let late = &wall[wall.len() * 2 / 3..];
            let last = late.iter().sum::<f64>() / late.len() as f64 / resting_place()?;
            let expected = rests_at(far, outside.bed(far)?)?;
            let returns = reflections.column(outside.tabled)?;
            println!(
                "{name} at {radii} a: static displacement of the wall {last:.4} (expected {expected:.4})"
            );
            let mut worst = 0.0_f64;
            for (number, expected) in numbers.iter().zip(&returns) {
                // Longer waves hardly radiate from the cavity, shorter ones are not resolved.
                if !(0.5..=5.0).contains(number) {
                    continue;
                }
                let found = returned_share(&table, far, *number)?;
                println!("    w R/cp = {number}: reflection {found:.4} (expected {expected:.4})");
                worst = worst.max((found - expected).abs());
            }
            let figure = format!("spherical_cavity.{name}.{radii}a");
            figures.at_most(
                &format!("{figure}.peak_error"),
                (peak / open_peak - 1.0).abs(),
                0.01,
            );
            figures.at_most(
                &format!("{figure}.late_error"),
                (last - expected).abs(),
                0.005,
            );
            figures.at_most(&format!("{figure}.reflection_error"), worst, 0.01);
        }
    }
    Ok(figures)
}

const DIVISION: Division = Division {
    around: 8,
    along: 40.0,
};

fn main() -> Outcome<ExitCode> {
    Ok(figures(&[2.0, 3.0, 5.0], DIVISION)?.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With the boundary nearest to the cavity every figure meets its limit.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(figures(&[2.0], DIVISION).unwrap().missed(), 0);
    }
}
