//! `powerhouse look`.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use powerhouse::io::{
    MeshOptions, Picture, PictureField, is_inp, is_packed_mesh, known_format, write_picture,
};
use powerhouse::model::{Facet, Mesh};

use crate::report::point;
use crate::terminal::say;
use crate::{Outcome, check_ending};

/// Deviation of the nodes of a facet set from a plane, over the size of the mesh, up to which the set counts as plane.
const PLANE: f64 = 1e-6;

/// Whether a file is that of a record: neither a mesh nor a file of another known format.
pub(crate) fn is_record(file: &Path) -> bool {
    let mut head = Vec::new();
    let read = File::open(file).and_then(|file| file.take(4096).read_to_end(&mut head));
    let is_named_mesh = file
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("msh"));
    read.is_ok()
        && !is_named_mesh
        && !is_packed_mesh(file)
        && !is_inp(file)
        && known_format(&head).is_none()
}

/// Prints sizes, quality and sets of a mesh file, and draws its element sets if a file is given.
pub(crate) fn look(file: &Path, picture: Option<PathBuf>, first_order: bool) -> Outcome {
    if let Some(file) = &picture {
        check_ending(file, ("picture", "png"))?;
    }
    let mut options = MeshOptions::default();
    options.straighten = true;
    options.first_order = first_order;
    let (mesh, remarks) =
        powerhouse::read_mesh(file, options).map_err(|error| error.to_string())?;
    let quality = mesh.check()?;
    let (low, high) = mesh.bounding_box();
    say!("{}", file.display());
    say!(
        "  {} nodes, {} elements",
        mesh.node_count(),
        mesh.element_count()
    );
    say!("  {} to {} m", point(&low), point(&high));
    say!(
        "  edges {:.3} to {:.3} m, aspect ratio of an element at most {:.2}",
        quality.shortest_edge,
        quality.longest_edge,
        quality.largest_aspect
    );
    say!(
        "  least scaled Jacobian {:.3}, of element {}",
        quality.least_scaled_jacobian,
        quality.worst_element
    );
    if quality.parts > 1 {
        say!("  {} bodies that share no nodes", quality.parts);
    }
    for remark in remarks {
        say!("  {remark}");
    }
    say!("\nelement sets");
    for (name, elements) in mesh.element_sets() {
        let kinds = kinds(&mesh, elements);
        say!("  {name:<16} {kinds}, {:.6} m3", mesh.volume_of(elements));
    }
    if !mesh.facet_sets().is_empty() {
        say!("\nfacet sets");
    }
    for (name, facets) in mesh.facet_sets() {
        let area: f64 = facets
            .iter()
            .map(|facet| mesh.facet_geometry(*facet).area())
            .sum();
        let plane = plane(&mesh, facets, (high - low).norm());
        let sides = both_sides(&mesh, facets);
        say!(
            "  {name:<16} {} facets, {area:.6} m2{plane}{sides}",
            facets.len()
        );
    }
    if !mesh.node_sets().is_empty() {
        say!("\nnode sets");
    }
    for (name, nodes) in mesh.node_sets() {
        say!("  {name:<16} {} nodes", nodes.len());
    }
    if let Some(picture) = picture {
        draw(&mesh, &picture)?;
        say!("\nfiles\n  {}", picture.display());
    }
    Ok(ExitCode::SUCCESS)
}

/// Numbers of the elements of a set by kind.
fn kinds(mesh: &Mesh, elements: &[u32]) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for &element in elements {
        *counts.entry(mesh.kind(element).name()).or_default() += 1;
    }
    let counts: Vec<String> = (counts.iter())
        .map(|(kind, count)| format!("{count} {kind}"))
        .collect();
    counts.join(", ")
}

/// How many facets of a set are the two sides of one face between elements, which count twice.
fn both_sides(mesh: &Mesh, facets: &[Facet]) -> String {
    let mut faces: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    for &facet in facets {
        let mut nodes = mesh.facet_nodes(facet);
        nodes.sort_unstable();
        *faces.entry(nodes).or_default() += 1;
    }
    match faces.values().filter(|count| **count > 1).count() {
        0 => String::new(),
        inner => format!(
            ", of them {} as both sides of {inner} faces within the body",
            2 * inner
        ),
    }
}

/// The plane of a facet set, if it is in one that is normal to an axis.
fn plane(mesh: &Mesh, facets: &[Facet], size: f64) -> String {
    let nodes = mesh.nodes_of_facets(facets);
    let positions = || nodes.iter().map(|&node| mesh.positions()[node as usize]);
    let Some(first) = positions().next() else {
        return String::new();
    };
    let (low, high) =
        positions().fold((first, first), |(low, high), x| (low.inf(&x), high.sup(&x)));
    let flat = (0..3).find(|&axis| high[axis] - low[axis] <= PLANE * size);
    flat.map_or_else(String::new, |axis| {
        format!(
            ", in the plane {} = {:.6} m",
            ["x", "y", "z"][axis],
            first[axis]
        )
    })
}

/// Draws the element sets from above and aside, each element in the colour of its set; of overlapping sets that of the last.
fn draw(mesh: &Mesh, file: &Path) -> Outcome {
    let mut values = vec![0.0; mesh.element_count()];
    let names: Vec<&str> = mesh.element_sets().keys().map(String::as_str).collect();
    for (number, elements) in mesh.element_sets().values().enumerate() {
        for &element in elements {
            values[element as usize] = number as f64;
        }
    }
    let mut picture = Picture::new(mesh, PictureField::Elemental(&values), "element set");
    picture.title = file
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned();
    picture.names = &names;
    write_picture(file, &picture)?;
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use powerhouse::model::Vec3;

    use super::*;

    /// A face between two elements that is in a set from both of them is counted as such, faces of the outside are not.
    #[test]
    fn inner_faces_are_counted() {
        let size = Vec3::new(2.0, 1.0, 1.0);
        let mesh = Mesh::box_of_hexes(Vec3::zeros(), size, [2, 1, 1], "rock").unwrap();
        let all: Vec<Facet> = (0..2)
            .flat_map(|element| (0..6).map(move |side| Facet { element, side }))
            .collect();
        let text = both_sides(&mesh, &all);
        assert_eq!(text, ", of them 2 as both sides of 1 faces within the body");
        assert_eq!(both_sides(&mesh, &all[..6]), "");
    }
}
