//! Input files for tests.

use powerhouse_io::inp::{InpFault, InpPlace};
use powerhouse_io::{InpError, InpMesh, parse_inp};
use powerhouse_model::{ElementKind, Mesh};

/// A cube of 1 m, a wedge on its top, and a point outside of both.
pub(crate) const HOUSE: &str = "\
*HEADING
a house
** nodes
*NODE, NSET=every
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
9, 0.5, 0., 1.5
10, 0.5, 1., 1.5
77, 9., 9., 9.
*ELEMENT, TYPE=C3D8R, ELSET=walls
1, 1, 2, 3, 4, 5, 6, 7, 8
*ELEMENT, TYPE=C3D6, ELSET=roof
2, 5, 9, 6, 8, 10, 7
*NSET, NSET=ground, GENERATE
1, 4
*ELSET, ELSET=house
walls, roof
*SURFACE, NAME=floor, TYPE=ELEMENT
walls, S1
*SURFACE, NAME=gables
roof, S1
2, S2
*MATERIAL, NAME=stone
*ELASTIC
9.E9, 0.25
";

/// The house in a part, an instance and an assembly.
pub(crate) fn house_of_parts() -> String {
    let (mesh, rest) = HOUSE.split_at(HOUSE.find("*SURFACE").unwrap());
    format!(
        "{}*Part, name=Part-1\n{}*End Part\n*Assembly, name=Assembly\n*Instance, name=House-1, part=Part-1\n\
         *End Instance\n*Elset, elset=_floor_S1, internal, instance=House-1\n1,\n*Surface, type=ELEMENT, name=floor\n\
         _floor_S1, S1\n*Surface, name=gables\nHouse-1.roof, S1\nHouse-1.2, S2\n*End Assembly\n{}",
        "*HEADING\n",
        &mesh[mesh.find("*NODE").unwrap()..],
        &rest[rest.find("*MATERIAL").unwrap()..]
    )
}

/// Name of the type of a kind in the format.
pub(crate) fn type_of(kind: ElementKind) -> &'static str {
    match kind {
        ElementKind::Hex8 => "C3D8",
        ElementKind::Wedge6 => "C3D6",
        ElementKind::Pyramid5 => "C3D5",
        ElementKind::Tet4 => "C3D4",
        ElementKind::Tet10 => "C3D10",
        _ => "T3D2",
    }
}

/// Nodes and elements of a mesh of one kind, in the order of the format.
pub(crate) fn text_of(mesh: &Mesh, set: &str) -> String {
    let mut text = String::from("*Node\n");
    for (tag, position) in mesh.node_tags().iter().zip(mesh.positions()) {
        let [x, y, z] = [position.x, position.y, position.z];
        text += &format!("{tag}, {x:?}, {y:?}, {z:?}\n");
    }
    text += &format!("*Element, type={}, elset={set}\n", type_of(mesh.kind(0)));
    for element in 0..mesh.element_count() as u32 {
        let nodes = mesh.nodes_of(element).iter();
        let mut tags: Vec<u64> = nodes.map(|&n| mesh.node_tags()[n as usize]).collect();
        if tags.len() == 10 {
            // The format has the midpoint of the edge 1-3 before that of 2-3.
            tags.swap(8, 9);
        }
        let words: Vec<String> = tags.iter().map(u64::to_string).collect();
        text += &format!(
            "{}, {}\n",
            mesh.element_tags()[element as usize],
            words.join(", ")
        );
    }
    text
}

pub(crate) fn read(text: &str) -> InpMesh {
    parse_inp(text.as_bytes()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Position and fault of an invalid file.
pub(crate) fn fault(text: &str) -> (InpPlace, InpFault) {
    match parse_inp(text.as_bytes()) {
        Err(InpError::Content { place, fault, .. }) => (place, *fault),
        Err(other) => panic!("{other}"),
        Ok(read) => panic!("read without an error: {:?}\n{text}", read.report),
    }
}

/// A text with one passage replaced, which it must have.
pub(crate) fn edit(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from}");
    text.replacen(from, to, 1)
}
