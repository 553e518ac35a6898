//! Mesh of a scene file: read or generated, then scaled, cut and refined.

use std::path::PathBuf;

use powerhouse_io::gmsh::{GmshGroup, GmshOptions, GmshReport};
use powerhouse_model::{Axis, Mesh, ParameterError, Vec3};

use super::ordered;
use crate::fault::{Fault, SceneText};
use crate::format::{self, At, Finite};
use crate::{Registry, Remark, SceneRemark};

type AnyError = Box<dyn std::error::Error + Send + Sync>;

/// Largest number of refinements: three make 512 elements of each.
const MOST_REFINEMENTS: u32 = 3;
/// Highest order of elements.
const HIGHEST_ORDER: u32 = 2;

pub(super) fn mesh(
    text: &SceneText,
    table: &format::MeshFile,
    registry: &Registry,
) -> Result<(Mesh, Vec<Remark>), Fault> {
    let mut remarks = Vec::new();
    let options = order_options(table)?;
    let refused = |error: AnyError| Fault::refused(table.file.span(), error);
    let path: PathBuf = text.folder().join(&*table.file);
    let mesh = match &table.generator {
        Some(generator) => registry.mesh_generator(generator)?(&path).map_err(refused)?,
        None => {
            let read = powerhouse_io::read_gmsh_with(path, options);
            let read = read.map_err(|error| refused(error.into()))?;
            remarks.extend(unused(&read.report));
            remarks.extend(changed(&read.report));
            read.mesh
        }
    };
    let mesh = match table.scale.get() {
        1.0 => mesh,
        scale => mesh
            .map_positions(|x| x * scale)
            .map_err(|e| refused(e.into()))?,
    };
    let mesh = match &table.within {
        None => mesh,
        Some(within) => {
            let pairs = [within.x, within.y, within.z];
            for pair in pairs.into_iter().flatten() {
                ordered(within.span(), pair.map(Finite::get))?;
            }
            let end = |end: usize, otherwise: f64| {
                let coordinate = |pair: [Finite; 2]| pair[end].get();
                Vec3::from(pairs.map(|pair| pair.map_or(otherwise, coordinate)))
            };
            let (low, high) = (end(0, f64::NEG_INFINITY), end(1, f64::INFINITY));
            let part = mesh.within(&low, &high);
            part.map_err(|error| Fault::refused(within.span(), error))?
        }
    };
    let mesh = match &table.slice {
        None => mesh,
        Some(slice) => sliced(&mesh, slice)?,
    };
    let mesh = match &table.refine {
        None => mesh,
        Some(times) => {
            refined(mesh, **times).map_err(|error| Fault::refused(times.span(), error))?
        }
    };
    let mesh = match &table.order {
        Some(order) if **order == HIGHEST_ORDER => {
            let found = mesh.with_midpoints();
            found.map_err(|error| Fault::refused(order.span(), error))?
        }
        _ => mesh,
    };
    Ok((mesh, remarks))
}

/// Options of reading elements of second order; keys for a mesh file are refused with a generator, and straight edges
/// without midpoints.
fn order_options(table: &format::MeshFile) -> Result<GmshOptions, Fault> {
    let mut options = GmshOptions::default();
    let of_file = |span: core::ops::Range<usize>, key: &str| match table.generator {
        None => Ok(()),
        Some(_) => {
            let text = format!("`{key}` is about a mesh file; the mesh has a generator");
            Err(Fault::refused(span, text))
        }
    };
    if let Some(order) = &table.order {
        let (value, highest) = (f64::from(**order), f64::from(HIGHEST_ORDER));
        ParameterError::check("order", value, 1.0, highest)
            .map_err(|error| Fault::refused(order.span(), error))?;
        if **order == 1 {
            of_file(order.span(), "order = 1")?;
            options = options.with_first_order();
        }
    }
    if let Some(straighten) = table.straighten.as_ref().filter(|straighten| ***straighten) {
        of_file(straighten.span(), "straighten")?;
        options = options.with_straight_edges();
    }
    Ok(options)
}

/// Remark about elements of second order that are computed otherwise than the file has them.
fn changed(report: &GmshReport) -> Option<Remark> {
    let found = SceneRemark::MeshOrder {
        lowered: report.lowered_elements,
        curved: report.curved_nodes,
        largest: report.largest_curve,
    };
    (report.lowered_elements + report.curved_nodes > 0).then_some(Remark::Scene(found))
}

/// Remark about nodes and elements of the mesh file that are left out or belong to no physical group.
fn unused(report: &GmshReport) -> Option<Remark> {
    let (nodes, dropped) = (report.dropped_nodes, report.dropped_elements);
    let grouped = |group: &GmshGroup| group.dimension == 3 || group.dimension == 1;
    // A mesh without groups is one set.
    let ungrouped = match report.groups.iter().any(grouped) {
        true => report.ungrouped_elements,
        false => 0,
    };
    let found = SceneRemark::MeshFile {
        nodes,
        dropped,
        ungrouped,
    };
    (nodes + dropped + ungrouped > 0).then_some(Remark::Scene(found))
}

/// Plane slice of a mesh.
fn sliced(mesh: &Mesh, slice: &At<format::Slice>) -> Result<Mesh, Fault> {
    let axis = match slice.across {
        format::SliceAxis::X => Axis::X,
        format::SliceAxis::Y => Axis::Y,
        format::SliceAxis::Z => Axis::Z,
    };
    let sliced = mesh.plane_slice(axis, slice.at.get());
    sliced.map_err(|error| Fault::refused(slice.span(), error))
}

/// Mesh after a number of uniform refinements.
fn refined(mut mesh: Mesh, times: u32) -> Result<Mesh, AnyError> {
    ParameterError::check("refine", times.into(), 0.0, MOST_REFINEMENTS.into())?;
    for _ in 0..times {
        mesh = mesh.refined()?;
    }
    Ok(mesh)
}
