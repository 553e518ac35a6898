use powerhouse_elements::{FacePressure, FaceTraction, Profile};
use powerhouse_model::{ElementKind, Mesh, NodalLoad, Vec3};

/// One element with a face of some corners, in turn seen from outside, and an apex behind it.
pub(super) fn element(face: &[Vec3]) -> Mesh {
    let mut builder = Mesh::builder();
    let middle: Vec3 = face.iter().sum::<Vec3>() / face.len() as f64;
    let normal = (face[1] - face[0]).cross(&(face[2] - face[0])).normalize();
    let mut tag = 0;
    let mut node = |builder: &mut powerhouse_model::MeshBuilder, at: Vec3| {
        tag += 1;
        builder.node(tag, at);
        tag
    };
    let nodes: Vec<u64> = face.iter().map(|x| node(&mut builder, *x)).collect();
    let apex = middle - normal * 2.0;
    match face.len() {
        3 => {
            let apex = node(&mut builder, apex);
            // The face is seen from outside: the apex lies behind it.
            let corners = [nodes[0], nodes[2], nodes[1], apex];
            builder.element(1, ElementKind::Tet4, &corners, &["rock"]);
        }
        _ => {
            let back: Vec<u64> = face
                .iter()
                .map(|x| node(&mut builder, x - normal * 2.0))
                .collect();
            let corners = [0, 1, 2, 3]
                .map(|i| back[i])
                .into_iter()
                .chain(nodes.iter().copied());
            builder.element(
                1,
                ElementKind::Hex8,
                &corners.collect::<Vec<_>>(),
                &["rock"],
            );
        }
    }
    builder.facet("face", &nodes);
    builder.build().unwrap()
}

/// Force and moment about the origin of a load with a unit factor.
fn resultant(mesh: &Mesh, load: &mut dyn NodalLoad) -> [Vec3; 2] {
    let nodes = load.nodes().to_vec();
    let mut forces = vec![Vec3::zeros(); nodes.len()];
    load.add_forces(0.0, &mut forces);
    let at = |node: &u32| mesh.positions()[*node as usize];
    let moment = nodes
        .iter()
        .zip(&forces)
        .map(|(node, force)| at(node).cross(force))
        .sum();
    [forces.iter().sum(), moment]
}

/// Force and moment of the pressure of water on a plane polygon: of the polygon that the level cuts off, in triangles with a
/// linear pressure.
fn closed_form(face: &[Vec3], level: f64) -> [Vec3; 2] {
    let mut below: Vec<Vec3> = Vec::new();
    for (i, &from) in face.iter().enumerate() {
        let to = face[(i + 1) % face.len()];
        if from.z <= level {
            below.push(from);
        }
        if (from.z < level && to.z > level) || (from.z > level && to.z < level) {
            below.push(from + (to - from) * ((level - from.z) / (to.z - from.z)));
        }
    }
    let (mut force, mut moment) = (Vec3::zeros(), Vec3::zeros());
    for i in 1..below.len().saturating_sub(1) {
        let x = [below[0], below[i], below[i + 1]];
        let p = x.map(|x| 9810.0 * (level - x.z));
        let area = -0.5 * (x[1] - x[0]).cross(&(x[2] - x[0]));
        force += area * (p.iter().sum::<f64>() / 3.0);
        let weighted: Vec3 = (0..3).map(|i| x[i] * p[i]).sum();
        let lever = weighted + x.iter().sum::<Vec3>() * p.iter().sum::<f64>();
        moment += lever.cross(&area) / 12.0;
    }
    [force, moment]
}

fn compare(mesh: &Mesh, face: &[Vec3], level: f64, tolerance: f64) {
    let facets = mesh.facet_set("face").unwrap();
    let one = || Box::new(|_: f64| 1.0);
    let mut load = FacePressure::new(mesh, facets, Profile::water(level), one()).unwrap();
    let [force, moment] = resultant(mesh, &mut load);
    let [right, lever] = closed_form(face, level);
    let scale = 9810.0 * 30.0;
    assert!(
        (force - right).norm() < tolerance * scale,
        "{face:?} {level}: {force:?} {right:?}"
    );
    assert!(
        (moment - lever).norm() < 5.0 * tolerance * scale,
        "{level}: {moment:?} {lever:?}"
    );
    let along = Vec3::new(1.0, -2.0, 0.5);
    let mut load = FaceTraction::new(mesh, facets, along, Profile::water(level), one()).unwrap();
    let [drag, _] = resultant(mesh, &mut load);
    assert!(
        (drag - along * right.norm()).norm() < tolerance * scale,
        "{level}: {drag:?}"
    );
}

/// Force and moment of water on a facet are those of the part below the level, wherever it cuts: triangles, rectangles,
/// parallelograms, and trapezoids and kites whose coordinates are not linear in space, vertical and inclined.
#[test]
fn water_acts_below_its_level_alone() {
    let faces: [&[[f64; 2]]; 7] = [
        &[[0.0, 0.0], [2.0, 0.3], [0.4, 3.0]],
        &[[0.0, 3.0], [-1.0, 1.0], [2.0, 0.0]],
        &[[0.0, 0.0], [2.0, 0.0], [2.0, 3.0], [0.0, 3.0]],
        &[[0.0, 0.0], [2.0, 1.0], [2.5, 3.0], [0.5, 2.0]],
        &[[0.0, 0.0], [3.0, 0.0], [1.0, 3.0], [0.5, 3.0]],
        &[[0.0, 0.0], [2.0, 0.7], [1.5, 3.0], [-0.5, 1.0]],
        &[[2.5, 3.0], [0.5, 2.0], [0.0, 0.0], [2.0, 1.0]],
    ];
    for face in faces {
        for [lean, turn] in [[0.0, 0.0], [0.4, 0.3], [1.1, -0.7]] {
            let place = |[a, b]: &[f64; 2]| {
                let x = Vec3::new(*a, b * f64::sin(lean), b * f64::cos(lean));
                let (sin, cos) = f64::sin_cos(turn);
                Vec3::new(
                    cos * x.x - sin * x.y + 1.0,
                    sin * x.x + cos * x.y - 2.0,
                    x.z + 0.2,
                )
            };
            let face: Vec<Vec3> = face.iter().map(place).collect();
            let mesh = element(&face);
            for step in -1..=22 {
                compare(&mesh, &face, 0.2 + 0.15 * f64::from(step), 1e-9);
            }
            for corner in &face {
                compare(&mesh, &face, corner.z, 1e-9);
            }
        }
    }
}

/// Water on the triangles of a tetrahedron of second order acts below its level alone, with force and moment as on their
/// corners' triangle.
#[test]
fn water_on_triangles_with_midpoints_acts_below_its_level_alone() {
    let high = Vec3::new(2.0, 2.0, 3.0);
    let lean = |x: Vec3| x + Vec3::new(0.3 * x.z, 0.1 * x.x, 0.2 * x.y - 0.1 * x.x);
    let mesh = Mesh::box_of_tets(Vec3::zeros(), high, [1, 1, 1], "rock").unwrap();
    let mesh = mesh.map_positions(lean).unwrap().with_midpoints().unwrap();
    for facet in mesh.boundary_facets() {
        let face = mesh.facet_corners(facet);
        let face: Vec<Vec3> = face
            .iter()
            .map(|&node| mesh.positions()[node as usize])
            .collect();
        let mut single = mesh.clone();
        single.set_facet_set("face", vec![facet]).unwrap();
        for step in -1..=22 {
            compare(&single, &face, 0.15 * f64::from(step), 1e-12);
        }
    }
}
