//! Joints from scene files: doubles the nodes of the mesh along them, before nodes of other items are resolved.

use powerhouse_contact::{JointSurface, SurfaceOptions};
use powerhouse_model::{ContactLaw, Facet, Mesh, Stress};

use super::pore_water::{PressureKeys, water_pressure};
use super::{Names, check_reach, no_such_set, one_of, vector};
use crate::spec::{self, At, Finite, Gap, JointSection, Positive, Zone};
use powerhouse_scene::{
    Fault, GroundStress, InitialGap, JointWater, JointZone, Preload, Problem, SceneJoint,
};

/// Doubles the nodes of a mesh between the sets of its joints, and pairs the nodes of the two sides of all joints.
pub(super) fn joints(
    mut mesh: Mesh,
    sections: &[JointSection],
    laws: Vec<Box<dyn ContactLaw>>,
) -> Result<(Mesh, Vec<SceneJoint>), Fault> {
    let mut sides = Vec::with_capacity(sections.len());
    for (index, section) in sections.iter().enumerate() {
        if sections[..index]
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
    for ((section, law), ([first, second], span)) in sections.iter().zip(laws).zip(&sides) {
        let options = options(&mesh, section)?;
        let surface = JointSurface::between(&mesh, first, second, &options);
        let surface = surface.map_err(|error| Fault::refused(span.clone(), error))?;
        let mut joint = SceneJoint::new(section.name.to_string(), surface, law);
        start(
            &Names {
                mesh: &mesh,
                layer: None,
            },
            section,
            &mut joint,
        )?;
        joints.push(joint);
    }
    Ok((mesh, joints))
}

/// Initial state of a joint: gap, unbonded zones and preload.
fn start(names: &Names, section: &JointSection, joint: &mut SceneJoint) -> Result<(), Fault> {
    let check = |joint: &SceneJoint, span| {
        let checked = joint.check(names.mesh);
        checked.map_err(|error| Fault::refused(span, error))
    };
    if let Some(gap) = &section.gap {
        joint.gap = match **gap {
            Gap::Meshed => InitialGap::Meshed,
            Gap::Distance(distance) => InitialGap::Distance(distance),
        };
        check(joint, gap.span())?;
    }
    for zone in section.unbonded.iter().flatten() {
        joint.unbonded.push(self::zone(names, zone, zone.span())?);
        check(joint, zone.span())?;
    }
    if let Some(water) = &section.water {
        let at_rest = water_pressure(
            water.span(),
            PressureKeys::new(&water.level, &water.pressures, water.density),
        )?;
        joint.water = Some(at_rest.map_or_else(JointWater::default, JointWater::new));
        check(joint, water.span())?;
    }
    if let Some(preload) = &section.preload {
        joint.preload = Some(self::preload(preload)?);
        check(joint, preload.span())?;
    }
    Ok(())
}

fn preload(preload: &At<spec::Preload>) -> Result<Preload, Fault> {
    Ok(match &**preload {
        spec::Preload::Pressure { pressure } => Preload::Pressure(pressure.get()),
        spec::Preload::Traction { traction } => Preload::Traction(vector(traction)),
        spec::Preload::Stress { stress } => Preload::Stress(Stress(stress.map(Finite::get))),
        spec::Preload::Ground {
            level,
            density,
            lateral,
        } => {
            let ground = GroundStress::new(level.get(), density.get(), lateral.get());
            Preload::Ground(ground.map_err(|error| Fault::refused(preload.span(), error))?)
        }
    })
}

/// Default of the largest distance of a point from the node that it selects (m).
const WITHIN: f64 = 1e-3;

/// Zone of exactly one of the keys; `span` is the byte range of the table.
pub(super) fn zone(
    names: &Names,
    zone: &Zone,
    span: core::ops::Range<usize>,
) -> Result<JointZone, Fault> {
    let missing = |key: &str| {
        let key = key.into();
        Fault::new(span.clone(), Problem::MissingKey { key })
    };
    let corners = match (&zone.low, &zone.high) {
        (Some(low), Some(high)) => Some((low, high)),
        (Some(_), None) => return Err(missing("high")),
        (None, Some(_)) => return Err(missing("low")),
        (None, None) => None,
    };
    if let (Some(within), None) = (&zone.within, &zone.at) {
        let key = "at".into();
        return Err(Fault::new(within.span(), Problem::MissingKey { key }));
    }
    if let Some(within) = &zone.within {
        check_reach(names.mesh, (within.get(), within.span()))?;
    }
    Ok(match (&zone.at, &zone.node, &zone.set, corners) {
        (Some(at), None, None, None) => JointZone::Near {
            position: vector(at),
            within: zone.within.as_ref().map_or(WITHIN, |within| within.get()),
        },
        (None, Some(node), None, None) => {
            names.node(node)?;
            JointZone::Node(**node)
        }
        (None, None, Some(set), None) => {
            names.nodes(set)?;
            JointZone::Set(set.to_string())
        }
        (None, None, None, Some((low, high))) => JointZone::Box {
            low: vector(low),
            high: vector(high),
        },
        (at, node, set, corners) => {
            let given = [
                at.is_some(),
                node.is_some(),
                set.is_some(),
                corners.is_some(),
            ];
            return Err(one_of(span, &["at", "node", "set", "low"], &given));
        }
    })
}

fn options(mesh: &Mesh, section: &JointSection) -> Result<SurfaceOptions, Fault> {
    let (low, high) = mesh.bounding_box();
    let tolerance = section
        .tolerance
        .map_or(1e-6 * (high - low).norm(), Positive::get);
    let corner = section.corner.as_ref();
    let angle = corner.map_or(SurfaceOptions::CORNER_ANGLE, |at| at.get().to_radians());
    let span = corner.map_or(section.name.span(), At::span);
    SurfaceOptions::new(tolerance, angle).map_err(|error| Fault::refused(span, error))
}

/// Members of two sets.
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
