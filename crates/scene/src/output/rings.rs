//! Section forces around linings.

use powerhouse_model::{Mesh, ModelError};
use powerhouse_observe::{SectionReinforcement, SectionRing};

use super::{OutputPlan, SectionRequest};
use crate::{Remark, remark};

/// Request for the sections around a lining, whose forces are written and drawn against their angles as well.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct RingRequest {
    /// Name of the ring, of its table and of its plot.
    pub name: String,
    /// Angles of the sections (degrees) and their names among the requests for sections, in the order of the angles; the
    /// largest gap of a ring that is not closed lies before the first, whose angle may be negative.
    pub sections: Vec<(f64, String)>,
    /// Number of rays.
    pub rays: usize,
}

impl RingRequest {
    /// Warning about rays that meet no element.
    pub(super) fn partial(&self) -> Option<Remark> {
        let missed = self.rays - self.sections.len();
        let step = 360.0 / self.rays as f64;
        let ray_of = |angle: &f64| ((angle / step).round() as isize).rem_euclid(self.rays as isize);
        let met: Vec<isize> = self.sections.iter().map(|(of, _)| ray_of(of)).collect();
        let mut none = (0..self.rays).filter(|ray| !met.contains(&(*ray as isize)));
        let first = none.next()?;
        let last = none.next_back().unwrap_or(first);
        Some(Remark::from(remark::PartialRing {
            ring: self.name.clone(),
            missed: [missed, self.rays],
            angles: [first, last].map(|ray| step * ray as f64),
        }))
    }
}

/// Sections in the order of their angles from behind the largest gap between two of them.
fn from_gap(mut sections: Vec<(f64, String)>) -> Vec<(f64, String)> {
    let count = sections.len();
    let gap = |index: usize| {
        let before = sections[(index + count - 1) % count].0;
        (sections[index].0 - before).rem_euclid(360.0)
    };
    // Of equal gaps, as of a closed ring, the one before upward.
    let mut first = 0;
    for index in 1..count {
        if gap(index) > gap(first) + 1e-6 {
            first = index;
        }
    }
    sections.rotate_left(first);
    if first > 0 {
        for (angle, _) in &mut sections[..count - first] {
            *angle -= 360.0;
        }
    }
    sections
}

impl OutputPlan {
    /// Adds the forces of sections around the lining of an element set, with a reinforcement if one is given.
    ///
    /// # Errors
    /// A set that is not in the mesh; those of [`SectionRing::sections`].
    pub fn ring(
        mut self,
        mesh: &Mesh,
        set: &str,
        ring: &SectionRing,
        reinforcement: Option<SectionReinforcement>,
    ) -> Result<Self, ModelError> {
        let mut sections = Vec::new();
        for of_ring in ring.sections(mesh, mesh.element_set(set)?)? {
            sections.push((of_ring.angle, of_ring.section.name.clone()));
            let mut request = SectionRequest::new(set, of_ring.section);
            request.elements = Some(of_ring.elements);
            request.reinforcement = reinforcement;
            self.cuts.push(request);
        }
        self.rings.push(RingRequest {
            name: ring.name.clone(),
            sections: from_gap(sections),
            rays: ring.rays,
        });
        Ok(self)
    }
}
