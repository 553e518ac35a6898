//! Input forces against Eq. 3 of Wang, Chen & Xiao (2019), node by node.

use powerhouse_boundary::{InputMode, Viscous, ViscousSpring, nodes_in_other_media};
use powerhouse_model::{
    AbsorbingBoundary, BoundarySite, ElasticMedium, FieldMotion, FieldSampler, IncidentField,
    ModelError, SiteFace, SiteNode, Stress, Vec3,
};

fn rock() -> ElasticMedium {
    ElasticMedium::new(9.0e9, 0.27, 2750.0).unwrap()
}

/// A field whose motion differs at every point and in every component.
#[derive(Clone, Copy)]
struct Smooth {
    amplitude: f64,
    knows_incident: bool,
}

const FULL: Smooth = Smooth {
    amplitude: 1.0,
    knows_incident: true,
};
const INCIDENT: Smooth = Smooth {
    amplitude: 0.3,
    knows_incident: true,
};

impl Smooth {
    fn motion(&self, point: &Vec3, time: f64) -> FieldMotion {
        let wave =
            |k: f64| self.amplitude * (k * point.x - 0.3 * k * point.y + point.z + time).sin();
        FieldMotion {
            displacement: Vec3::new(wave(0.1), wave(0.2), wave(0.3)),
            velocity: Vec3::new(wave(0.4), wave(0.5), wave(0.6)),
            stress: Stress([0.7, 0.8, 0.9, 1.0, 1.1, 1.2].map(|k| 1.0e7 * wave(k))),
        }
    }
}

struct Points(Smooth, Vec<Vec3>);

impl FieldSampler for Points {
    fn len(&self) -> usize {
        self.1.len()
    }
    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        for (point, motion) in self.1.iter().zip(motion) {
            *motion += self.0.motion(point, time);
        }
    }
}

impl IncidentField for Smooth {
    fn name(&self) -> &str {
        "smooth"
    }
    fn medium(&self) -> ElasticMedium {
        rock()
    }
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        self.knows_incident
            .then(|| Box::new(INCIDENT) as Box<dyn IncidentField>)
    }
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        Ok(Box::new(Points(*self, points.to_vec())))
    }
}

/// 700 nodes on two faces and their edge; `tilt` turns the second face's normal off the axes.
fn site(tilt: f64, field: Option<&dyn IncidentField>) -> BoundarySite<'_> {
    let side = Vec3::new(1.0, tilt, 0.0).normalize();
    let nodes = (0..700).map(|i| {
        let along = 0.37 * f64::from(i);
        let share = |face, normal, area| SiteFace {
            face,
            medium: rock(),
            normal,
            area,
        };
        let base = share(0, -Vec3::z(), 1.0 + 0.01 * along);
        let side = share(1, side, 2.0 - 0.003 * along);
        SiteNode {
            node: 3 * i,
            position: Vec3::new(60.0, along, -40.0),
            faces: match i % 3 {
                0 => vec![base],
                1 => vec![side],
                _ => vec![base, side],
            },
        }
    });
    let faces = vec!["base".into(), "side".into()];
    BoundarySite::new(faces, nodes.collect(), Vec3::zeros(), field)
}

/// The forces on all nodes (mesh indices) at a time; each load may hold a node once.
fn forces(boundary: &impl AbsorbingBoundary, site: &BoundarySite, time: f64) -> Vec<Vec3> {
    let mut all = vec![Vec3::zeros(); 2100];
    for mut load in boundary.build(site).unwrap().loads {
        let nodes = load.nodes().to_vec();
        // What is there already must stay: loads add.
        let mut values = vec![Vec3::repeat(1.0); nodes.len()];
        load.add_forces(-1.0, &mut values.clone());
        load.add_forces(time, &mut values);
        for (node, value) in nodes.iter().zip(values) {
            all[*node as usize] += value - Vec3::repeat(1.0);
        }
    }
    all
}

/// Eq. 3 for one share: `(K u + C v) + area sigma n`, the matrices from the boundary built for
/// this share alone.
fn share_force(
    boundary: &impl AbsorbingBoundary,
    node: &SiteNode,
    share: &SiteFace,
    motion: &FieldMotion,
) -> Vec3 {
    let faces = vec!["base".into(), "side".into()];
    let nodes = vec![SiteNode {
        faces: vec![*share],
        ..node.clone()
    }];
    let alone = BoundarySite::new(faces, nodes, Vec3::zeros(), None);
    let impedance = boundary.build(&alone).unwrap().impedance[0];
    impedance.spring * motion.displacement
        + impedance.dashpot * motion.velocity
        + share.area * motion.stress.traction(&share.normal)
}

/// Whether all forces agree with Eq. 3, given the field of each share.
fn agrees(
    boundary: &impl AbsorbingBoundary,
    site: &BoundarySite,
    field_of: impl Fn(&SiteFace) -> Smooth,
) -> bool {
    let time = 0.8;
    let found = forces(boundary, site, time);
    site.nodes.iter().all(|node| {
        let shares = node.faces.iter().map(|share| {
            let motion = field_of(share).motion(&node.position, time);
            share_force(boundary, node, share, &motion)
        });
        let expected: Vec3 = shares.sum();
        // The forces carry the rounding of the load's start value, 1 N.
        (found[node.node as usize] - expected).norm() < 1e-13 * expected.norm() + 1e-8
    })
}

/// On straight and on oblique faces, inside and on edges, every node gets the force of the full
/// free field once.
#[test]
fn every_node_gets_the_force_of_the_full_field() {
    for tilt in [0.0, 0.35] {
        let site = site(tilt, Some(&FULL));
        assert!(agrees(&ViscousSpring::default(), &site, |_| FULL));
        assert!(agrees(&Viscous::default(), &site, |_| FULL));
    }
}

/// With incident-only input the named face gets the incident wave and every other face the full
/// field, at their common edge each its own.
#[test]
fn the_incident_wave_alone_can_be_put_on_one_face() {
    for tilt in [0.0, 0.35] {
        let boundary = ViscousSpring {
            input: InputMode::IncidentOnly {
                faces: vec!["base".into()],
            },
            ..ViscousSpring::default()
        };
        let site = site(tilt, Some(&FULL));
        let of_share = |share: &SiteFace| if share.face == 0 { INCIDENT } else { FULL };
        assert!(agrees(&boundary, &site, of_share));
    }
}

/// Large sites are cut into loads of bounded size, so that threads can share them.
#[test]
fn loads_hold_a_bounded_number_of_nodes() {
    let parts = Viscous::default().build(&site(0.35, Some(&FULL))).unwrap();
    assert!(parts.loads.len() >= 3);
    assert!(parts.loads.iter().all(|load| load.nodes().len() <= 256));
}

/// A site without a field and a boundary that admits no input have no loads.
#[test]
fn absorbing_alone_makes_no_loads() {
    let quiet = Viscous::default().build(&site(0.0, None)).unwrap();
    assert!(quiet.loads.is_empty() && quiet.impedance.len() == 700);
    let closed = Viscous {
        input: InputMode::Nothing,
    };
    assert!(
        closed
            .build(&site(0.0, Some(&FULL)))
            .unwrap()
            .loads
            .is_empty()
    );
}

/// Incident-only input on a face that does not exist, or from a field without a separate
/// incident part, is refused before a run.
#[test]
fn impossible_input_is_refused() {
    let on = |face: &str| Viscous {
        input: InputMode::IncidentOnly {
            faces: vec![face.into()],
        },
    };
    let error = on("bottom").build(&site(0.0, Some(&FULL))).err().unwrap();
    let text = error.to_string();
    assert!(
        text.contains("'bottom'") && text.contains("base, side"),
        "{text}"
    );
    let mute = Smooth {
        knows_incident: false,
        ..FULL
    };
    let error = on("base").build(&site(0.0, Some(&mute))).err().unwrap();
    assert!(error.to_string().contains("'smooth'"), "{error}");
}

/// Nodes in a medium other than the field's are found, so that a check can warn of them.
#[test]
fn nodes_in_a_foreign_medium_are_found() {
    let mut site = site(0.0, Some(&FULL));
    assert!(nodes_in_other_media(&site).is_empty());
    site.nodes[5].faces[1].medium.young *= 1.01;
    assert_eq!(nodes_in_other_media(&site), [15]);
}

/// A field whose horizontal normal stress is the stiffness of the medium of a point.
struct Jumping {
    soft: ElasticMedium,
}

struct JumpingPoints(Vec<ElasticMedium>);

impl FieldSampler for JumpingPoints {
    fn len(&self) -> usize {
        self.0.len()
    }
    fn add_motion(&self, _: f64, motion: &mut [FieldMotion]) {
        for (medium, motion) in self.0.iter().zip(motion) {
            motion.stress.0[0] += medium.young;
        }
    }
}

impl IncidentField for Jumping {
    fn name(&self) -> &str {
        "jumping"
    }
    fn medium(&self) -> ElasticMedium {
        rock()
    }
    fn interfaces(&self) -> &[f64] {
        &[-1.0]
    }
    fn medium_at(&self, point: &Vec3) -> ElasticMedium {
        if point.z > -1.0 { self.soft } else { rock() }
    }
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        None
    }
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        let media = points.iter().map(|point| self.medium_at(point)).collect();
        Ok(Box::new(JumpingPoints(media)))
    }
    fn prepare_in(
        &self,
        _: &[Vec3],
        media: &[ElasticMedium],
    ) -> Result<Box<dyn FieldSampler>, ModelError> {
        Ok(Box::new(JumpingPoints(media.to_vec())))
    }
}

/// A node on an interface of layers has the stress of each layer on the share of its area in that layer, and
/// the impedance of each; its medium is foreign if it is neither.
#[test]
fn a_node_on_an_interface_has_the_stress_of_both_layers() {
    let soft = ElasticMedium::new(0.2e9, 0.4, 1800.0).unwrap();
    let field = Jumping { soft };
    let share = |medium, area| SiteFace {
        face: 0,
        medium,
        normal: Vec3::x(),
        area,
    };
    let nodes = vec![
        SiteNode {
            node: 3,
            position: Vec3::new(0.0, 0.0, -1.0),
            faces: vec![share(rock(), 0.5), share(soft, 0.25)],
        },
        SiteNode {
            node: 4,
            position: Vec3::zeros(),
            faces: vec![share(soft, 0.25)],
        },
    ];
    let site = BoundarySite::new(vec!["side".into()], nodes, Vec3::zeros(), Some(&field));
    assert!(nodes_in_other_media(&site).is_empty());
    let mut parts = Viscous::default().build(&site).unwrap();
    let mut sums = [0.0; 5];
    for load in &mut parts.loads {
        let mut forces = vec![Vec3::zeros(); load.nodes().len()];
        load.add_forces(0.0, &mut forces);
        for (node, force) in load.nodes().iter().zip(forces) {
            sums[*node as usize] += force.x;
        }
    }
    let expected = 0.5 * rock().young + 0.25 * soft.young;
    assert!((sums[3] - expected).abs() < 1e-9 * expected, "{sums:?}");
    assert!(
        (sums[4] - 0.25 * soft.young).abs() < 1e-9 * expected,
        "{sums:?}"
    );
    let dashpot = parts.impedance[0].dashpot[(0, 0)];
    let of = |medium: ElasticMedium| medium.density * medium.p_speed();
    let expected = 0.5 * of(rock()) + 0.25 * of(soft);
    assert!((dashpot - expected).abs() < 1e-9 * expected);
    let mut foreign = site;
    foreign.nodes[1].faces[0].medium = rock();
    assert_eq!(nodes_in_other_media(&foreign), [4]);
}
