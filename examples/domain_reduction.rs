//! Domain reduction method: the incident field enters through a layer of elements, and only scattered waves leave the region.
//!
//! Builds on `free_field`. The domain reduction method of Bielak et al. (2003): effective forces on one
//! layer around a region, and an absorbing boundary far outside. Without a scatterer the motion outside the layer is zero.
//!
//! ```text
//!      --------------------------   free surface, z = 120 m
//!      |     |            |     |
//!  =)) |     |   whole    |     | ((=   dashpots and springs, under scattered
//!      |     |   motion   |     |       waves alone
//!      |     `------------'     |
//!      |        layer           |
//!      |    scattered motion    |
//!      --------------------------
//! ```
//!
//! Two fields are applied: the motion of the same mesh under the wave, recorded at the nodes, with which the outside motion
//! is rounding; and the wave in closed form, which differs from it by the error of the mesh.
//!
//! Run: `cargo run --release --example domain_reduction`

use std::collections::HashMap;
use std::process::ExitCode;
use std::sync::{Arc, Mutex};

use powerhouse::boundary::{DomainReduction, ViscousSpring};
use powerhouse::material::{LinearElastic, media};
use powerhouse::model::{
    Cadence, ElasticMedium, FieldMotion, FieldSampler, Fields, Flow, IncidentField, Mesh,
    ModelError, Observer, StepView, Vec3,
};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind, first_hit_corner,
};
use powerhouse::{Boundary, Material, Part, RunHooks, Scene, reduction_layer};
use powerhouse_examples::{Figures, Outcome};

const EDGE: f64 = 120.0;
/// Peak of the incident displacement (m).
const PEAK: f64 = 0.01;

/// Displacements of all nodes at every step, recorded.
type Frames = Vec<Vec<Vec3>>;

/// Observer that records the displacements.
struct Recorder(Arc<Mutex<Frames>>);

impl Observer for Recorder {
    fn name(&self) -> &str {
        "recorder"
    }
    fn fields(&self) -> Fields {
        Fields::default()
    }
    fn cadence(&self) -> Cadence {
        Cadence::Steps(1)
    }
    fn observe(&mut self, view: &dyn StepView) -> Result<Flow, ModelError> {
        let nodes = 0..view.node_count() as u32;
        let frame = nodes.map(|node| view.displacement(node)).collect();
        let mut frames = self
            .0
            .lock()
            .map_err(|e| ModelError::refused("recorder", e.to_string()))?;
        frames.push(frame);
        Ok(Flow::Continue)
    }
}

/// Field of a motion that was recorded at the nodes of a mesh, defined at these nodes and steps only.
struct Recorded {
    frames: Arc<Frames>,
    step: f64,
    node_at: HashMap<[u64; 3], usize>,
}

fn bits(position: &Vec3) -> [u64; 3] {
    (*position).map(f64::to_bits).into()
}

impl IncidentField for Recorded {
    fn name(&self) -> &str {
        "recorded"
    }
    fn medium(&self) -> ElasticMedium {
        media::ROCK
    }
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        None
    }
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        let node = |point: &Vec3| {
            let node = self.node_at.get(&bits(point)).copied();
            node.ok_or_else(|| ModelError::refused("recorded field", format!("no node at {point}")))
        };
        Ok(Box::new(RecordedNodes {
            frames: self.frames.clone(),
            step: self.step,
            nodes: points.iter().map(node).collect::<Result<_, _>>()?,
        }))
    }
}

struct RecordedNodes {
    frames: Arc<Frames>,
    step: f64,
    nodes: Vec<usize>,
}

impl FieldSampler for RecordedNodes {
    fn len(&self) -> usize {
        self.nodes.len()
    }
    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        let frame = (time / self.step).round() as usize;
        if let Some(frame) = self.frames.get(frame) {
            for (motion, &node) in motion.iter_mut().zip(&self.nodes) {
                motion.displacement += frame[node];
            }
        }
    }
}

/// A cube of ground under a shear wave at 20 degrees.
struct Ground {
    mesh: Mesh,
    part: Part,
    wave: PlaneWave,
    /// The elements of the region inside the layer.
    inside: Vec<u32>,
}

impl Ground {
    fn new(cells: usize) -> Outcome<Self> {
        let (low, high) = (Vec3::zeros(), Vec3::repeat(EDGE));
        let mesh = Mesh::box_of_hexes(low, high, [cells; 3], "rock")?;
        let mut parameters = PlaneWaveParameters::vertical(WaveKind::SV, media::ROCK, EDGE);
        parameters.incidence = Angle::from_degrees(20.0);
        parameters.azimuth = Angle::from_degrees(30.0);
        parameters.reference = first_hit_corner(&low, &high, &parameters.direction());
        let quarter = EDGE / 4.0;
        let region = (
            Vec3::new(quarter, quarter, 2.0 * quarter),
            Vec3::new(3.0 * quarter, 3.0 * quarter, EDGE),
        );
        Ok(Self {
            inside: mesh.elements_in_box(&region.0, &region.1),
            part: Part::new("rock", Material::from(LinearElastic::new(media::ROCK))),
            wave: PlaneWave::new(parameters, Arc::new(SmoothPulse::new(PEAK, 0.12)?))?,
            mesh,
        })
    }

    /// The motion of all nodes under a field that enters through a layer or through the boundary, with the
    /// step (s).
    fn moved(&self, field: impl IncidentField + 'static, by_layer: bool) -> Outcome<(Frames, f64)> {
        let faces = ["left", "right", "front", "back", "bottom"];
        let springs = ViscousSpring::default();
        let boundary = if by_layer {
            let layer = reduction_layer(&self.mesh, &self.inside, &self.part)?;
            Boundary::new(DomainReduction::new(layer, springs), faces)
        } else {
            Boundary::new(springs, faces)
        };
        let frames = Arc::new(Mutex::new(Frames::new()));
        let hooks = RunHooks::default().with_observer(Recorder(frames.clone()));
        let results = Scene::new("domain reduction", self.mesh.clone())
            .part(self.part.clone())
            .with_boundary(boundary.with_scatterer(Vec3::new(0.5 * EDGE, 0.5 * EDGE, EDGE)))
            .with_field(field)
            .with_duration(0.4)
            .prepare()?
            .run(hooks)?;
        let frames = std::mem::take(&mut *frames.lock().map_err(|e| e.to_string())?);
        Ok((frames, results.run.step))
    }

    /// The largest displacement outside the layer's inner side and the largest difference from
    /// another motion on and inside it, over the incident peak.
    fn apart(&self, motion: &Frames, other: &Frames) -> [f64; 2] {
        let mut is_inside = vec![false; self.mesh.node_count()];
        for node in self.mesh.nodes_of_elements(&self.inside) {
            is_inside[node as usize] = true;
        }
        let mut worst = [0.0_f64; 2];
        for (frame, other) in motion.iter().zip(other) {
            for (node, displacement) in frame.iter().enumerate() {
                let (place, size) = if is_inside[node] {
                    (1, (displacement - other[node]).norm())
                } else {
                    (0, displacement.norm())
                };
                worst[place] = if size <= worst[place] {
                    worst[place]
                } else {
                    size
                };
            }
        }
        worst.map(|size| size / PEAK)
    }
}

fn figures(cells: &[usize]) -> Outcome<Figures> {
    let mut figures = Figures::default();
    let mut outside_of_wave = Vec::new();
    for &cells in cells {
        let ground = Ground::new(cells)?;
        let (through_faces, step) = ground.moved(ground.wave.clone(), false)?;
        let through_faces = Arc::new(through_faces);
        let positions = ground.mesh.positions().iter().enumerate();
        let recorded = Recorded {
            frames: through_faces.clone(),
            step,
            node_at: positions
                .map(|(node, position)| (bits(position), node))
                .collect(),
        };
        let (of_recorded, _) = ground.moved(recorded, true)?;
        let [outside, inside] = ground.apart(&of_recorded, &through_faces);
        let figure = |of: &str| format!("domain_reduction.{of}.{cells}");
        figures.at_most(&figure("outside.discrete"), outside, 1.0e-10);
        figures.at_most(&figure("inside.discrete"), inside, 1.0e-10);
        let (of_wave, _) = ground.moved(ground.wave.clone(), true)?;
        let [outside, inside] = ground.apart(&of_wave, &through_faces);
        figures.report(
            &figure("outside.analytic"),
            outside,
            "the wave in closed form",
        );
        figures.report(
            &figure("inside.analytic"),
            inside,
            "from the motion through the boundary",
        );
        outside_of_wave.push(outside);
    }
    // Twice as many elements: a quarter of the error.
    let fall = outside_of_wave
        .windows(2)
        .map(|pair| pair[1] / pair[0])
        .fold(0.0, f64::max);
    figures.at_most("domain_reduction.outside.analytic.fall", fall, 0.4);
    Ok(figures)
}

fn main() -> Outcome<ExitCode> {
    Ok(figures(&[8, 16, 32])?.verdict())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every figure meets its limit, on the coarser meshes.
    #[test]
    fn figures_meet_their_limits() {
        assert_eq!(figures(&[8, 16]).unwrap().missed(), 0);
    }

    /// A region without surrounding ground is an error, since it has no layer.
    #[test]
    fn a_region_that_is_all_is_refused() {
        let ground = Ground::new(4).unwrap();
        let all: Vec<u32> = (0..ground.mesh.element_count() as u32).collect();
        let refused = reduction_layer(&ground.mesh, &all, &ground.part).err();
        let expected = "the layer around the region has 0 elements";
        assert!(refused.unwrap().to_string().contains(expected));
    }
}
