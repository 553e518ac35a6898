//! Observers of steps with prescribed fields.

mod accelerations;
mod beam;
mod capacity;
mod envelope;
mod history;
mod plain;
mod principal;
mod ring;
mod section;
mod section_ends;
mod section_periods;
mod snapshots;

use powerhouse_model::{Observer, StepView, Stress, Vec3};

/// A field of nodes or elements and of time.
type Field<'a, T> = Box<dyn Fn(u32, f64) -> T + 'a>;

/// The forces of elements; whether they are known.
type Forces<'a> = Box<dyn Fn(u32, &mut [Vec3]) -> bool + 'a>;

/// A step whose fields are functions of place and time.
struct Fields<'a> {
    time: f64,
    step: f64,
    nodes: usize,
    displacement: Field<'a, Vec3>,
    velocity: Field<'a, Vec3>,
    acceleration: Field<'a, Vec3>,
    stress: Field<'a, Stress>,
    forces: Forces<'a>,
    energies: Vec<(&'static str, f64)>,
}

impl Fields<'_> {
    /// A body of so many nodes at rest.
    fn at_rest(nodes: usize) -> Self {
        let nothing = || Box::new(|_, _| Vec3::zeros());
        Self {
            time: 0.0,
            step: 1e-3,
            nodes,
            displacement: nothing(),
            velocity: nothing(),
            acceleration: nothing(),
            stress: Box::new(|_, _| Stress::default()),
            forces: Box::new(|_, _| false),
            energies: Vec::new(),
        }
    }
    /// Shows observers so many steps, each when it is due; they are saved and restored before each step.
    fn run(&mut self, observers: &mut [&mut dyn Observer], steps: u64) {
        self.time = 0.0;
        for number in 0..steps {
            for observer in &mut *observers {
                let saved = observer.save_state().unwrap();
                observer.restore_state(&saved).unwrap();
                let due = observer.cadence().is_due(number, self.time, self.step);
                if due || number + 1 == steps {
                    observer.observe(self).unwrap();
                }
            }
            self.time += self.step;
        }
        for observer in observers {
            observer.finish().unwrap();
        }
    }
    /// Shows an observer the step at a time.
    fn show(&mut self, observer: &mut dyn Observer, time: f64) {
        self.time = time;
        observer.observe(self).unwrap();
    }
}

impl StepView for Fields<'_> {
    fn number(&self) -> u64 {
        (self.time / self.step).round() as u64
    }
    fn time(&self) -> f64 {
        self.time
    }
    fn step(&self) -> f64 {
        self.step
    }
    fn node_count(&self) -> usize {
        self.nodes
    }
    fn displacement(&self, node: u32) -> Vec3 {
        (self.displacement)(node, self.time)
    }
    fn velocity(&self, node: u32) -> Vec3 {
        (self.velocity)(node, self.time)
    }
    fn acceleration(&self, node: u32) -> Vec3 {
        (self.acceleration)(node, self.time)
    }
    fn stress(&self, element: u32) -> Stress {
        (self.stress)(element, self.time)
    }
    fn element_forces(&self, element: u32, out: &mut [Vec3]) -> bool {
        (self.forces)(element, out)
    }
    fn energies(&self) -> &[(&'static str, f64)] {
        &self.energies
    }
}

/// A number in [-1, 1) that depends on nothing but its seed.
fn noise(seed: u64) -> f64 {
    let mut x = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^= x >> 31;
    (x >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
