//! Joints: the mesh is cut open where they are, before any of its nodes are looked up.

use powerhouse_contact::{JointSurface, SurfaceOptions};
use powerhouse_model::{ContactLaw, Facet, Mesh};

use super::no_such_set;
use crate::Registry;
use crate::fault::{Fault, Problem};
use crate::format::{At, JointSection, Positive};
use crate::scene::SceneJoint;

/// Cuts a mesh open between the parts of its joints and matches the sides of all of them.
pub(super) fn joints(
    mut mesh: Mesh,
    sections: &[JointSection],
    registry: &Registry,
) -> Result<(Mesh, Vec<SceneJoint>), Fault> {
    let mut sides = Vec::with_capacity(sections.len());
    for (place, section) in sections.iter().enumerate() {
        if sections[..place]
            .iter()
            .any(|other| other.name == section.name)
        {
            let name = section.name.to_string();
            let what = "joint";
            return Err(Fault::new(
                section.name.span(),
                Problem::Duplicate { what, name },
            ));
        }
        sides.push(match (&section.between, &section.facets) {
            (Some(sets), None) => {
                let [first, second] = named(sets, |set| mesh.element_set(set))?;
                let split = mesh.split_between(&first, &second);
                let split = split.map_err(|error| Fault::refused(sets.span(), error))?;
                mesh = split.mesh;
                ([split.first, split.second], sets.span())
            }
            (None, Some(sets)) => {
                let of = |set: &str| mesh.facet_set(set);
                (named::<Facet>(sets, of)?, sets.span())
            }
            (between, facets) => {
                let found = usize::from(between.is_some()) + usize::from(facets.is_some());
                let keys = &["between", "facets"];
                return Err(Fault::new(
                    section.name.span(),
                    Problem::OneOf { keys, found },
                ));
            }
        });
    }
    let mut joints = Vec::with_capacity(sections.len());
    for (section, ([first, second], place)) in sections.iter().zip(&sides) {
        let law: Box<dyn ContactLaw> = registry.joint_law(section)?;
        let options = options(&mesh, section)?;
        let surface = JointSurface::between(&mesh, first, second, &options);
        joints.push(SceneJoint {
            name: section.name.to_string(),
            surface: surface.map_err(|error| Fault::refused(place.clone(), error))?,
            law,
        });
    }
    Ok((mesh, joints))
}

fn options(mesh: &Mesh, section: &JointSection) -> Result<SurfaceOptions, Fault> {
    let (low, high) = mesh.bounding_box();
    let tolerance = section
        .tolerance
        .map_or(1e-6 * (high - low).norm(), Positive::get);
    let corner = section.corner.as_ref();
    let angle = corner.map_or(SurfaceOptions::CORNER_ANGLE, |at| at.get().to_radians());
    let place = corner.map_or(section.name.span(), At::span);
    SurfaceOptions::new(tolerance, angle).map_err(|error| Fault::refused(place, error))
}

/// What two sets hold.
fn named<'m, T: Clone + 'm>(
    sets: &At<[String; 2]>,
    look_up: impl Fn(&str) -> Result<&'m [T], powerhouse_model::MeshError>,
) -> Result<[Vec<T>; 2], Fault> {
    let of = |name: &String| {
        let found = look_up(name).map(<[T]>::to_vec);
        found.map_err(|error| no_such_set(&At::new(name.clone(), sets.span()), error))
    };
    Ok([of(&sets[0])?, of(&sets[1])?])
}
