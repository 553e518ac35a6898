//! Mesh of a scene file: read or generated, then scaled, cut and refined.

use std::path::Path;
use std::sync::Arc;

use powerhouse_io::gmsh::{GmshGroup, GmshReport};
use powerhouse_io::inp::InpReport;
use powerhouse_io::{MeshOptions, PackedMesh};
use powerhouse_model::{Mesh, ParameterError, Vec3};

use super::ordered;
use crate::Registry;
use crate::spec::{self, At, Finite};
use powerhouse_scene::internal::InUse;
use powerhouse_scene::{Error, Fault, Remark, SceneText, remark};

type AnyError = Box<dyn std::error::Error + Send + Sync>;

/// Largest number of refinements: three make 512 elements of each.
const MOST_REFINEMENTS: u32 = 3;
/// Why elements of a packed mesh are not lowered.
const PACKED: &str = "a packed mesh has elements of its own order: `order = 1` is for the file from which it is made";
/// Highest order of elements.
const HIGHEST_ORDER: u32 = 2;

/// Mesh of a scene file, remarks about it, and the check of the file that it shares its numbers with, if there is one.
pub(super) fn mesh(
    text: &SceneText,
    scene: &spec::SceneSpec,
    registry: &Registry,
) -> Result<(Mesh, Vec<Remark>, Option<InUse>), Fault> {
    let table = &scene.mesh;
    let (mut remarks, mut in_use) = (Vec::new(), None);
    // Curves of a file are bars where a part names them.
    let of_stages = scene.stages.iter().flat_map(|stage| &stage.parts);
    let of_stages = of_stages.map(|part| part.set.as_str());
    let parts = scene.parts.iter().map(|part| part.set.as_str());
    let parts: Vec<&str> = parts.chain(of_stages).collect();
    let options = order_options(table)?.with_bars(&parts);
    let refused = |error: AnyError| Fault::refused(table.file.span(), error);
    let path = text.folder().join(&*table.file);
    let mesh = match &table.generator {
        Some(generator) => registry.mesh_generator(generator)?(&path).map_err(refused)?,
        None => {
            let found = read(&path, options).map_err(refused)?;
            remarks.extend(found.remarks);
            in_use = found.packed.map(|packed| -> InUse {
                Arc::new(move || {
                    packed
                        .check()
                        .map_err(|error| Error::MeshInUse(error.into()))
                })
            });
            found.mesh
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
    Ok((mesh, remarks, in_use))
}

/// A mesh file as it is read.
struct FoundMesh {
    mesh: Mesh,
    remarks: Vec<Remark>,
    /// The file that the mesh shares its numbers with.
    packed: Option<PackedMesh>,
}

/// Mesh of a Gmsh file or an Abaqus input file, by its content, or of a packed mesh by its extension `.phm`, with
/// remarks about what was left out or changed.
///
/// # Errors
/// Those of [`read_gmsh`](powerhouse_io::read_gmsh), [`read_inp`](powerhouse_io::read_inp) and
/// [`read_packed_mesh`](powerhouse_io::read_packed_mesh); `first_order` for a packed mesh.
pub fn read_mesh(path: &Path, options: MeshOptions<'_>) -> Result<(Mesh, Vec<Remark>), AnyError> {
    let found = read(path, options)?;
    Ok((found.mesh, found.remarks))
}

fn read(path: &Path, options: MeshOptions<'_>) -> Result<FoundMesh, AnyError> {
    if powerhouse_io::is_packed_mesh(path) {
        if options.first_order {
            return Err(PACKED.into());
        }
        let (mesh, packed) = powerhouse_io::read_packed_mesh(path)?;
        let changed = packed.changed_source().map(|source| {
            Remark::from(remark::OldPackedMesh {
                packed: path.into(),
                source,
            })
        });
        Ok(FoundMesh {
            mesh: if options.straighten {
                mesh.with_straight_edges()
            } else {
                mesh
            },
            remarks: changed.into_iter().collect(),
            packed: Some(packed),
        })
    } else if powerhouse_io::is_inp(path) {
        let inp = powerhouse_io::read_inp_with(path, options)?;
        Ok(FoundMesh {
            mesh: inp.mesh,
            remarks: of_inp(inp.report),
            packed: None,
        })
    } else {
        let gmsh = powerhouse_io::read_gmsh_with(path, options)?;
        Ok(FoundMesh {
            remarks: of_gmsh(&gmsh.report).collect(),
            mesh: gmsh.mesh,
            packed: None,
        })
    }
}

/// Options of reading elements of second order; keys for a mesh file are refused with a generator, and straight edges
/// without midpoints.
fn order_options<'n>(table: &spec::MeshFile) -> Result<MeshOptions<'n>, Fault> {
    let mut options = MeshOptions::default();
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
            options.first_order = true;
        }
    }
    if let Some(straighten) = table.straighten.as_ref().filter(|straighten| ***straighten) {
        of_file(straighten.span(), "straighten")?;
        options.straighten = true;
    }
    Ok(options)
}

/// Remark about elements of second order that are computed otherwise than the file has them.
fn changed(lowered: usize, curved: usize, largest: f64) -> Option<Remark> {
    let found = Remark::from(remark::MeshOrder {
        lowered,
        curved,
        largest,
    });
    (lowered + curved > 0).then_some(found)
}

/// Remark about nodes and elements of the mesh file that are left out or belong to no set.
fn unused(nodes: usize, dropped: usize, ungrouped: usize) -> Option<Remark> {
    let found = Remark::from(remark::MeshFile {
        nodes,
        dropped,
        ungrouped,
    });
    (nodes + dropped + ungrouped > 0).then_some(found)
}

/// Remarks about a Gmsh file.
fn of_gmsh(report: &GmshReport) -> impl Iterator<Item = Remark> {
    let grouped = |group: &GmshGroup| group.dimension == 3 || group.dimension == 1;
    // A mesh without groups is one set.
    let ungrouped = if report.groups.iter().any(grouped) {
        report.ungrouped_elements
    } else {
        0
    };
    let unused = unused(report.dropped_nodes, report.dropped_elements, ungrouped);
    let (lowered, curved) = (report.lowered_elements, report.curved_nodes);
    let changed = changed(lowered, curved, report.largest_curve);
    let (curves, collapsed) = (report.curve_elements, report.collapsed_elements);
    let content = content(curves, collapsed, Vec::new());
    unused.into_iter().chain(changed).chain(content)
}

/// Remark about what a mesh file has otherwise than the mesh.
fn content(curves: usize, collapsed: usize, instances: Vec<(String, u64)>) -> Option<Remark> {
    let is_any = curves + collapsed + instances.len() > 0;
    is_any.then_some(Remark::from(remark::MeshContent {
        curves,
        collapsed,
        instances,
    }))
}

/// Remarks about an Abaqus input file.
fn of_inp(report: InpReport) -> Vec<Remark> {
    // A mesh without sets is one set.
    let ungrouped = if report.has_element_sets {
        report.ungrouped_elements
    } else {
        0
    };
    let unused = unused(report.dropped_nodes, 0, ungrouped);
    let (lowered, curved) = (report.lowered_elements, report.curved_nodes);
    let changed = changed(lowered, curved, report.largest_curve);
    let skipped = report.skipped_keywords;
    let keywords = (!skipped.is_empty()).then_some(Remark::from(remark::MeshKeywords { skipped }));
    let content = content(0, report.collapsed_elements, report.instances);
    let (coupled, omitted) = (report.coupled_elements, report.omitted_coordinates);
    let left_out = report.left_out;
    let is_less = coupled + omitted + left_out.len() > 0;
    let less = is_less.then_some(Remark::from(remark::MeshLeftOut {
        left_out,
        coupled,
        omitted,
    }));
    Vec::from_iter(
        unused
            .into_iter()
            .chain(changed)
            .chain(content)
            .chain(less)
            .chain(keywords),
    )
}

/// Plane slice of a mesh.
fn sliced(mesh: &Mesh, slice: &At<spec::Slice>) -> Result<Mesh, Fault> {
    let sliced = mesh.plane_slice(slice.across, slice.at.get());
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
