//! Report on the mesh of a bay.

use core::fmt;
use std::collections::BTreeMap;

use powerhouse::model::{Mesh, Vec3};

use super::quality::scaled_jacobians;
use super::sets::{MonitoringPoint, position};
use super::{Bay, BayPart};
use crate::BayError;

/// Position of a monitoring point in the mesh of a bay.
#[derive(Clone, Debug, PartialEq)]
pub struct PointReport {
    /// Name of the point in the paper: `A` to `F`, `O1`, `O2`.
    pub name: &'static str,
    /// Position of its node (m).
    pub position: Vec3,
    /// Distance (m) of the node from the intended position.
    pub offset: f64,
}

/// Numbers of elements, mesh quality, volumes and monitoring points of the mesh of a bay.
#[derive(Clone, Debug, PartialEq)]
pub struct BayReport {
    /// Numbers of grid cells across the halls (x), along them (y) and in height (z).
    pub cells: [usize; 3],
    /// Number of nodes of the mesh.
    pub nodes: usize,
    /// Number of nodes that are duplicated where the joint between rock and lining splits the mesh.
    pub doubled_nodes: usize,
    /// Number of elements of each part.
    pub parts: BTreeMap<BayPart, usize>,
    /// Scaled Jacobian (1) of the elements: minimum, 1st percentile and median.
    pub scaled_jacobian: [f64; 3],
    /// Lengths of the shortest and the longest edge (m).
    pub edges: [f64; 2],
    /// Largest aspect ratio of an element: longest over shortest edge.
    pub aspect: f64,
    /// Volume of each part (m3).
    pub volumes: BTreeMap<BayPart, f64>,
    /// Excavated volumes (m3) with exactly circular arches, for comparison: main powerhouse, transformer cavern.
    pub round_excavations: [f64; 2],
    /// Area of the joint between rock and structure (m2).
    pub joint_area: f64,
    /// Number of facets of the joint between rock and structure.
    pub joint_facets: usize,
    /// Positions of the monitoring points.
    pub points: Vec<PointReport>,
}

impl BayReport {
    pub(super) fn of(
        bay: &Bay,
        cells: [usize; 3],
        mesh: &Mesh,
        parts: &BTreeMap<BayPart, usize>,
        points: &[MonitoringPoint],
    ) -> Result<Self, BayError> {
        let quality = mesh.check()?;
        let mut jacobians = scaled_jacobians(mesh);
        jacobians.sort_by(f64::total_cmp);
        let share = |share: f64| jacobians[(share * (jacobians.len() - 1) as f64) as usize];
        let split = mesh.split_between(
            mesh.element_set(BayPart::Rock.name())?,
            mesh.element_set("structure")?,
        )?;
        let joint = split.first.iter();
        let mut volumes = BTreeMap::new();
        for &part in parts.keys() {
            let elements = mesh.element_set(part.name())?;
            volumes.insert(part, mesh.volume_of(elements));
        }
        Ok(Self {
            cells,
            nodes: mesh.node_count(),
            doubled_nodes: split.copies.len(),
            parts: parts.clone(),
            scaled_jacobian: [quality.least_scaled_jacobian, share(0.01), share(0.5)],
            edges: [quality.shortest_edge, quality.longest_edge],
            aspect: quality.largest_aspect,
            volumes,
            round_excavations: bay.dimensions.excavated_volumes(),
            joint_area: joint.map(|&facet| mesh.facet_geometry(facet).area()).sum(),
            joint_facets: split.first.len(),
            points: (points.iter())
                .map(|point| PointReport {
                    name: point.name,
                    position: position(mesh, point),
                    offset: point.offset,
                })
                .collect(),
        })
    }

    /// Number of all elements of the mesh, including those of the voids.
    pub fn elements(&self) -> usize {
        self.parts.values().sum()
    }
    /// Number of concrete elements.
    pub fn concrete(&self) -> usize {
        let concrete = self.parts.iter().filter(|(part, _)| part.is_concrete());
        concrete.map(|(_, count)| count).sum()
    }
    /// Number of elements of the voids, which are excavated and not replaced.
    pub fn void(&self) -> usize {
        self.elements_of("void_main") + self.elements_of("void_transformer")
    }
    /// Excavated volumes (m3) of the mesh: main powerhouse, transformer cavern.
    pub fn excavations(&self) -> [f64; 2] {
        let of = |transformer: bool| {
            let excavated = self.volumes.iter().filter(|(part, _)| {
                **part != BayPart::Rock && part.is_in_transformer() == transformer
            });
            excavated.map(|(_, volume)| volume).sum()
        };
        [of(false), of(true)]
    }
    /// Number of elements of the part with a name; 0 for an unknown name.
    pub fn elements_of(&self, part: &str) -> usize {
        let of = self.parts.iter().filter(|(known, _)| known.name() == part);
        of.map(|(_, count)| count).sum()
    }
}

impl fmt::Display for BayReport {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let [nx, ny, nz] = self.cells;
        writeln!(
            f,
            "cells              {nx} x {ny} x {nz} (across, along, in height)"
        )?;
        writeln!(
            f,
            "hexahedra          {} in the mesh: {} rock, {} concrete, {} void",
            self.elements(),
            self.elements_of("rock"),
            self.concrete(),
            self.void(),
        )?;
        writeln!(
            f,
            "nodes              {}, and {} duplicated at the joint",
            self.nodes, self.doubled_nodes
        )?;
        let [least, hundredth, median] = self.scaled_jacobian;
        writeln!(
            f,
            "scaled Jacobian    least {least:.3}, 1 % below {hundredth:.3}, median {median:.3}"
        )?;
        writeln!(
            f,
            "edges              {:.3} to {:.2} m, aspect up to {:.1}",
            self.edges[0], self.edges[1], self.aspect
        )?;
        let (mesh, round) = (self.excavations(), self.round_excavations);
        writeln!(
            f,
            "excavated          main {:.1} m3 ({:.1} under a round arch), transformer {:.1} ({:.1})",
            mesh[0], round[0], mesh[1], round[1]
        )?;
        writeln!(
            f,
            "joint              {} facets, {:.0} m2",
            self.joint_facets, self.joint_area
        )?;
        for (part, count) in &self.parts {
            let volume = self.volumes.get(part).copied().unwrap_or(0.0);
            writeln!(f, "  {:<18} {count:>6}  {volume:>11.1} m3", part.name())?;
        }
        for point in &self.points {
            let at = point.position;
            writeln!(
                f,
                "  point {:<12} ({:.2}, {:.2}, {:.2}) m, {:.2} m from its intended position",
                point.name, at.x, at.y, at.z, point.offset
            )?;
        }
        Ok(())
    }
}
