//! Meshes as arrays.

use std::collections::BTreeMap;
use std::sync::Arc;

use numpy::{PyArray1, PyArray2, PyReadonlyArray2};
use powerhouse::model::{self, ElementKind, Facet};
use pyo3::prelude::*;

use crate::arrays::{components, of_list, of_rows};
use crate::fault::exception;

/// Kinds of elements by their names in arrays of cells.
const KINDS: [(&str, ElementKind); 6] = [
    ("hex8", ElementKind::Hex8),
    ("wedge6", ElementKind::Wedge6),
    ("pyramid5", ElementKind::Pyramid5),
    ("tet4", ElementKind::Tet4),
    ("tet10", ElementKind::Tet10),
    ("bar2", ElementKind::Bar2),
];

/// A finite element mesh: points (m), elements with their nodes by index, and sets.
#[pyclass(frozen, module = "powerhouse_fe._core")]
pub(crate) struct Mesh {
    /// The mesh.
    pub(crate) mesh: Arc<model::Mesh>,
}

/// Elements of one kind: indices of the elements, and of their nodes, one row each.
type Cells<'py> = (String, Bound<'py, PyArray1<u32>>, Bound<'py, PyArray2<u32>>);

#[pymethods]
impl Mesh {
    /// A mesh of points and of blocks of elements: kind, and nodes by index, one row for an element; element sets by
    /// index in the order of the blocks; facet sets as rows of the nodes of each facet; node sets by index.
    #[new]
    fn new(
        py: Python<'_>,
        points: PyReadonlyArray2<'_, f64>,
        blocks: Vec<(String, PyReadonlyArray2<'_, i64>)>,
        elements: BTreeMap<String, Vec<i64>>,
        facets: BTreeMap<String, Vec<PyReadonlyArray2<'_, i64>>>,
        nodes: BTreeMap<String, Vec<i64>>,
    ) -> PyResult<Self> {
        let refused = |message: String| exception(py, "InputError", &message);
        let points = points.as_array();
        if points.ncols() != 3 {
            let found = points.ncols();
            return Err(refused(format!(
                "points have {found} coordinates, expected 3: x, y, z in metres"
            )));
        }
        let mut builder = model::Mesh::builder();
        for (index, point) in points.outer_iter().enumerate() {
            let position = model::Vec3::new(point[0], point[1], point[2]);
            builder.node(index as u64, position);
        }
        let count = points.nrows() as i64;
        let tag = |what: &str, index: i64| {
            if (0..count).contains(&index) {
                Ok(index as u64)
            } else {
                Err(refused(format!(
                    "{what}: node {index} is none of the {count} points, whose indices begin with 0"
                )))
            }
        };
        let mut count_of_elements = 0;
        for (name, cells) in &blocks {
            let kind = KINDS.iter().find(|(known, _)| known == name);
            let Some((_, kind)) = kind else {
                let known: Vec<&str> = KINDS.iter().map(|(known, _)| *known).collect();
                let known = known.join(", ");
                return Err(refused(format!(
                    "elements of kind '{name}' are not known; available: {known}"
                )));
            };
            let cells = cells.as_array();
            let (found, expected) = (cells.ncols(), kind.node_count());
            if found != expected {
                return Err(refused(format!(
                    "cells of kind '{name}' have {found} nodes, expected {expected}"
                )));
            }
            for cell in cells.outer_iter() {
                let nodes = cell.iter().map(|node| tag(name, *node));
                let nodes: Vec<u64> = nodes.collect::<PyResult<_>>()?;
                builder.element(count_of_elements, *kind, &nodes, &[] as &[&str]);
                count_of_elements += 1;
            }
        }
        for (name, facets) in &facets {
            for rows in facets {
                for facet in rows.as_array().outer_iter() {
                    let nodes = facet.iter().map(|node| tag(name, *node));
                    let nodes: Vec<u64> = nodes.collect::<PyResult<_>>()?;
                    builder.facet(name, &nodes);
                }
            }
        }
        for (name, members) in &nodes {
            let members = members.iter().map(|node| tag(name, *node));
            let members: Vec<u64> = members.collect::<PyResult<_>>()?;
            builder.node_set(name, &members);
        }
        let mut mesh = builder
            .build()
            .map_err(|error| refused(error.to_string()))?;
        for (name, members) in elements {
            let member = |index: i64| {
                if (0..count_of_elements as i64).contains(&index) {
                    Ok(index as u32)
                } else {
                    Err(refused(format!(
                        "element set '{name}': element {index} is none of the {count_of_elements} elements, whose indices \
                     begin with 0"
                    )))
                }
            };
            let members: Vec<u32> = members.into_iter().map(member).collect::<PyResult<_>>()?;
            let set = mesh.set_element_set(&name, members);
            set.map_err(|error| refused(error.to_string()))?;
        }
        let mesh = Arc::new(mesh);
        Ok(Self { mesh })
    }
    /// A box of bricks between two corners (m) with the facet sets `left`, `right`, `front`, `back`, `bottom` and `top`.
    #[staticmethod]
    fn box_of_bricks(
        py: Python<'_>,
        low: [f64; 3],
        high: [f64; 3],
        counts: [usize; 3],
        set: &str,
    ) -> PyResult<Self> {
        let mesh = model::Mesh::box_of_hexes(low.into(), high.into(), counts, set);
        let mesh = mesh.map_err(|error| exception(py, "InputError", &error.to_string()))?;
        let mesh = Arc::new(mesh);
        Ok(Self { mesh })
    }
    /// Positions of the nodes (m), one row each.
    #[getter]
    fn points<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        of_rows(py, components(self.mesh.positions().iter().copied()), 3)
    }
    /// Elements of each kind: indices of the elements, and of their nodes in Gmsh's order.
    #[getter]
    fn cells<'py>(&self, py: Python<'py>) -> PyResult<Vec<Cells<'py>>> {
        let mut found = Vec::new();
        for (name, kind) in KINDS {
            let all = 0..self.mesh.element_count() as u32;
            let elements: Vec<u32> = all.filter(|e| self.mesh.kind(*e) == kind).collect();
            if !elements.is_empty() {
                let nodes = elements.iter().flat_map(|e| self.mesh.nodes_of(*e));
                let nodes = of_rows(py, nodes.copied().collect(), kind.node_count())?;
                found.push((name.to_owned(), of_list(py, elements), nodes));
            }
        }
        Ok(found)
    }
    /// Number of nodes.
    #[getter]
    fn node_count(&self) -> usize {
        self.mesh.node_count()
    }
    /// Number of elements.
    #[getter]
    fn element_count(&self) -> usize {
        self.mesh.element_count()
    }
    /// Numbers of the nodes in the mesh file.
    #[getter]
    fn node_numbers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        of_list(py, self.mesh.node_tags().to_vec())
    }
    /// Numbers of the elements in the mesh file.
    #[getter]
    fn element_numbers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<u64>> {
        of_list(py, self.mesh.element_tags().to_vec())
    }
    /// Indices of the elements of each element set.
    #[getter]
    fn element_sets<'py>(&self, py: Python<'py>) -> BTreeMap<String, Bound<'py, PyArray1<u32>>> {
        let sets = self.mesh.element_sets().iter();
        sets.map(|(name, set)| (name.clone(), of_list(py, set.clone())))
            .collect()
    }
    /// Indices of the nodes of each node set.
    #[getter]
    fn node_sets<'py>(&self, py: Python<'py>) -> BTreeMap<String, Bound<'py, PyArray1<u32>>> {
        let sets = self.mesh.node_sets().iter();
        sets.map(|(name, set)| (name.clone(), of_list(py, set.clone())))
            .collect()
    }
    /// Indices of the nodes of each facet of each facet set.
    #[getter]
    fn facet_sets(&self) -> BTreeMap<String, Vec<Vec<u32>>> {
        let nodes_of = |facets: &[Facet]| {
            let facets = facets.iter().map(|facet| self.mesh.facet_nodes(*facet));
            facets.collect()
        };
        let sets = self.mesh.facet_sets().iter();
        sets.map(|(name, set)| (name.clone(), nodes_of(set)))
            .collect()
    }
}
