//! Reflection of plane waves by a boundary, measured in a strip that is periodic along the face.
//!
//! ```text
//!        boundary under test
//!      ----------------------   z = 0
//!      |   P  \ ^     ^ / SV |
//!  =   |       \|     |/     |   =    left and right are coupled; the strip is one
//!  =   |       /|     |\     |   =    trace wavelength wide
//!      |  ----------------   |   two rows of nodes separate the four waves
//!      ----------------------
//!         shaken, and the boundary under test again
//! ```
//!
//! In a strip one trace wavelength wide, shaken evenly along z and as `sin kx` and `cos kx` along x,
//! the motion consists of two P and two SV waves with that wave number, one of each towards the face and one away from it.
//! Their amplitudes at one frequency follow from the motion of two rows; shaking the strip twice, along and across, separates
//! the reflections of both waves.

use core::f64::consts::PI;

use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};
use powerhouse::boundary::reflection::BodyWave;
use powerhouse::engine::observe::{HistoryTable, Motion};
use powerhouse::engine::{NodalForce, PeriodicPairs, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{AbsorbingBoundary, ElasticMedium, Mesh, Vec3};
use powerhouse::wavefield::Complex;
use powerhouse::{Boundary, Material, OutputPlan, Part, ResidualLimit, RunHooks, Scene};

use crate::Outcome;

/// Elements per shear wavelength, along the height of the strip, and across it.
const PER_WAVELENGTH: f64 = 32.0;
const ROWS: usize = 24;
const COLUMNS: usize = 32;
/// Index of the recorded row next to the face.
const FIRST_ROW: usize = 2;

/// Plane wave incident on a face.
#[derive(Clone, Copy, Debug)]
pub struct Arriving {
    /// Elastic medium.
    pub medium: ElasticMedium,
    /// Wave type: P or SV.
    pub wave: BodyWave,
    /// Angle of incidence from the normal of the face (degrees).
    pub degrees: f64,
    /// Angular frequency (rad/s).
    pub frequency: f64,
}

/// A wave type in the strip: sine and cosine of its angle, and its wave number normal to the face.
#[derive(Clone, Copy)]
struct Partner {
    kind: BodyWave,
    sine: f64,
    cosine: Complex,
    wave_number: f64,
}

impl Partner {
    /// Displacements along x and z, the first times `sin kx`, the second times `cos kx`, of a unit
    /// wave towards (+1) or away from (-1) the face, at a height below it (m).
    ///
    /// Half of a wave that travels to +x and half of its mirror image: P `(-i sin, +-cos)`,
    /// SV `(-+i cos, -sin)`, times `exp(-+ i k cos z)`.
    fn motion(&self, sense: f64, z: f64) -> [Complex; 2] {
        let i = Complex::i();
        let along = self.cosine * sense;
        let phase = (-i * along * self.wave_number * z).exp();
        match self.kind {
            BodyWave::P => [-i * self.sine * phase, along * phase],
            BodyWave::Sv => [-i * along * phase, phase * -self.sine],
        }
    }

    /// Conditioning of the separation of the two senses of travel by two rows at a distance.
    fn resolution(&self, apart: f64) -> f64 {
        (self.cosine * self.wave_number * apart).sin().norm()
    }
}

impl Arriving {
    /// The P (first) and the SV wave with the same trace wavelength.
    fn partners(&self) -> [Partner; 2] {
        let of = |kind: BodyWave| match kind {
            BodyWave::P => self.medium.p_speed(),
            BodyWave::Sv => self.medium.s_speed(),
        };
        let slowness = self.degrees.to_radians().sin() / of(self.wave);
        [BodyWave::P, BodyWave::Sv].map(|kind| {
            let sine = slowness * of(kind);
            let square = (1.0 - sine) * (1.0 + sine);
            let cosine = if square >= 0.0 {
                Complex::new(square.sqrt(), 0.0)
            } else {
                Complex::new(0.0, -(-square).sqrt())
            };
            let wave_number = self.frequency / of(kind);
            Partner {
                kind,
                sine,
                cosine,
                wave_number,
            }
        })
    }

    fn brick(&self) -> f64 {
        2.0 * PI * self.medium.s_speed() / self.frequency / PER_WAVELENGTH
    }

    /// The second recorded row: the one with the best separation of all waves.
    fn second_row(&self) -> usize {
        let partners = self.partners();
        let worst = |row: &usize| {
            let apart = (row - FIRST_ROW) as f64 * self.brick();
            partners[0]
                .resolution(apart)
                .min(partners[1].resolution(apart))
        };
        let rows = FIRST_ROW + 1..ROWS - 2;
        rows.max_by(|a, b| worst(a).total_cmp(&worst(b)))
            .unwrap_or(FIRST_ROW + 1)
    }

    /// Burst at the lower end of the strip, so long that it does not contain the frequencies at which one of
    /// the waves travels along the face; with its rate (1/s) and the duration of the run (s).
    fn burst(&self) -> (f64, f64) {
        let gap = |partner: &Partner| (1.0 - partner.sine.abs()).abs();
        let [p, sv] = self.partners().map(|partner| gap(&partner));
        let rate = self.frequency * 0.25_f64.min(p.min(sv) / 3.5);
        (rate, 9.0 / rate + 20.0 * 2.0 * PI / self.frequency)
    }

    /// Spectra of the motion along x and z of both rows when the lower end is shaken along an axis.
    fn shaken(
        &self,
        condition: Box<dyn AbsorbingBoundary>,
        axis: Vec3,
    ) -> Outcome<Vector4<Complex>> {
        let brick = self.brick();
        let trace = self.partners()[0];
        let wave_number = trace.sine * trace.wave_number;
        let width = if wave_number > 0.0 {
            2.0 * PI / wave_number
        } else {
            COLUMNS as f64 * brick
        };
        let low = Vec3::new(0.0, 0.0, -(ROWS as f64) * brick);
        let high = Vec3::new(width, brick, 0.0);
        let mesh = Mesh::box_of_hexes(low, high, [COLUMNS, 1, ROWS], "rock")?;
        let nodes =
            |face: &str| -> Outcome<Vec<u32>> { Ok(mesh.nodes_of_facets(mesh.facet_set(face)?)) };
        let cuts = [nodes("front")?, nodes("back")?].concat();
        let (left, right) = (nodes("left")?, nodes("right")?);
        let pairs = PeriodicPairs::by_translation(&mesh, &left, &right, 1.0e-6 * brick)?;

        let (rate, duration) = self.burst();
        let (frequency, middle) = (self.frequency, 4.5 / rate);
        let mut shakers = Vec::new();
        for node in nodes("bottom")? {
            let x = mesh.positions()[node as usize].x;
            let (sine, cosine) = (wave_number * x).sin_cos();
            let shape = if wave_number == 0.0 {
                Vec3::repeat(1.0)
            } else {
                Vec3::new(sine, 0.0, cosine)
            };
            // Nodes at the ends of the period are coupled.
            let share = if x == 0.0 || x == width { 0.5e6 } else { 1.0e6 };
            let history = move |time: f64| {
                let x = rate * (time - middle);
                (-0.5 * x * x).exp() * (frequency * time).sin()
            };
            let force = share * shape.component_mul(&axis);
            shakers.push(NodalForce::new(vec![node], force, Box::new(history)));
        }
        // Every step is recorded.
        let mut output = OutputPlan::default().with_every(f64::MIN_POSITIVE);
        for (name, row) in [("near", FIRST_ROW), ("far", self.second_row())] {
            let z = -(row as f64) * brick;
            let quarter = Vec3::new(0.25 * width, 0.0, z);
            output = output
                .history(&format!("{name} sine"), quarter, Motion::DISPLACEMENT)
                .history(
                    &format!("{name} cosine"),
                    Vec3::new(0.0, 0.0, z),
                    Motion::DISPLACEMENT,
                );
        }
        let scene = Scene::new("strip", mesh)
            .part(Part::new(
                "rock",
                Material::from(LinearElastic::new(self.medium)),
            ))
            .support(Support::roller(cuts, Vec3::y()))
            .with_periodic_pairs(pairs)
            .with_boundary(Boundary::new(condition, ["top", "bottom"]))
            .with_energy_residual(ResidualLimit::Unchecked)
            .with_duration(duration)
            .with_output(output);
        let scene = shakers.into_iter().fold(scene, Scene::load);
        let results = scene.prepare()?.run(RunHooks::default())?;
        let spectrum = |name: &str| spectrum(results.histories(), name, frequency);
        Ok(Vector4::new(
            spectrum("near sine.ux")?,
            spectrum("near cosine.uz")?,
            spectrum("far sine.ux")?,
            spectrum("far cosine.uz")?,
        ))
    }

    /// Amplitudes of the P and the SV wave that a boundary reflects, for an incident wave of unit amplitude.
    ///
    /// # Errors
    /// Any error of the run.
    pub fn returned(
        &self,
        condition: &dyn Fn() -> Outcome<Box<dyn AbsorbingBoundary>>,
    ) -> Outcome<[f64; 2]> {
        let partners = self.partners();
        let mut waves = Matrix4::zeros();
        for (row, place) in [FIRST_ROW, self.second_row()].into_iter().enumerate() {
            let z = -(place as f64) * self.brick();
            for (column, (sense, partner)) in [
                (1.0, &partners[0]),
                (1.0, &partners[1]),
                (-1.0, &partners[0]),
                (-1.0, &partners[1]),
            ]
            .into_iter()
            .enumerate()
            {
                let [x, z] = partner.motion(sense, z);
                (waves[(2 * row, column)], waves[(2 * row + 1, column)]) = (x, z);
            }
        }
        let waves = waves.lu();
        let (mut arriving, mut leaving) = (Matrix2::zeros(), Matrix2::zeros());
        for (run, axis) in [Vec3::x(), Vec3::z()].into_iter().enumerate() {
            let spectra = self.shaken(condition()?, axis)?;
            let found = waves
                .solve(&spectra)
                .ok_or("rows that see the same waves")?;
            arriving.set_column(run, &Vector2::new(found[0], found[1]));
            leaving.set_column(run, &Vector2::new(found[2], found[3]));
        }
        let inverse = arriving
            .try_inverse()
            .ok_or("two runs with the same waves")?;
        let returned = leaving * inverse;
        let column = match self.wave {
            BodyWave::P => 0,
            BodyWave::Sv => 1,
        };
        Ok([returned[(0, column)].norm(), returned[(1, column)].norm()])
    }
}

/// The sum of `u exp(-i w t)` over a column.
fn spectrum(table: &HistoryTable, name: &str, frequency: f64) -> Outcome<Complex> {
    let column = table
        .column(name)
        .ok_or_else(|| format!("no column '{name}'"))?;
    let terms = table.times.iter().zip(&column.values);
    Ok(terms
        .map(|(time, u)| Complex::from_polar(*u, -frequency * time))
        .sum())
}
