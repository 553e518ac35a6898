//! A block that slides on a shaken base, whatever holds the base.

use core::f64::consts::PI;

use powerhouse::engine::{BuildModel, Leapfrog, run};
use powerhouse_contact::{BondedCoulomb, Joint};
use powerhouse_elements::SolidKernel;
use powerhouse_model::{
    ElasticMedium, ModelSpec, Prescribed, RunOptions, StaticMethod, Support, Vec3,
};

use super::{Body, Cut, settled, spec_with};

const GRAVITY: f64 = 9.81;
const FRICTION: f64 = 0.4;
/// Peak of the acceleration (m/s2) and its duration (s).
const PULSE: (f64, f64) = (7.0, 0.4);

/// Without lateral strain, whose shear at the foot would exceed the friction at its edges.
const BLOCK: ElasticMedium = ElasticMedium {
    young: 9.0e9,
    poisson: 0.0,
    density: 2750.0,
};

/// How the base is held.
#[derive(Clone, Copy, Debug)]
enum Base {
    /// Its lower face.
    Face,
    /// All of its nodes.
    Whole,
    /// The same by prescribed motions that stay zero.
    Prescribed,
    /// Its lower face, of half of base and block behind a mirror plane along the push.
    Mirror,
}

impl Base {
    fn on<'a>(self, body: &Body, spec: ModelSpec<'a>) -> ModelSpec<'a> {
        let below = || body.faces(2, &[-1.0]);
        let whole = || body.mesh.nodes_of_set("first").unwrap();
        match self {
            Self::Face => spec.support(Support::fixed(below())),
            Self::Whole => spec.support(Support::fixed(whole())),
            Self::Prescribed => {
                [Vec3::x(), Vec3::y(), Vec3::z()]
                    .into_iter()
                    .fold(spec, |spec, direction| {
                        spec.prescribed(Prescribed {
                            nodes: whole(),
                            direction,
                            displacement: Box::new(|_: f64| 0.0),
                        })
                    })
            }
            Self::Mirror => {
                let mirror = Support::roller(body.faces(1, &[-1.0]), Vec3::y());
                spec.support(Support::fixed(below())).support(mirror)
            }
        }
    }
}

/// Slip (m) of a rigid block under the pulse (Newmark 1965): it moves with `a - mu g` from the time at which `a` exceeds
/// `mu g` until its velocity is zero.
fn rigid_slip() -> f64 {
    let (peak, duration) = PULSE;
    let (step, mut time, mut speed, mut slip) = (1.0e-6, 0.0, 0.0_f64, 0.0);
    while time < 4.0 * duration {
        let push = if time < duration {
            peak * (PI * time / duration).sin()
        } else {
            0.0
        };
        let next = (speed + step * (push - FRICTION * GRAVITY)).max(0.0);
        slip += 0.5 * step * (speed + next);
        (speed, time) = (next, time + step);
    }
    slip
}

/// A block on a base under a pulse of horizontal acceleration slips as far as a rigid one, to 0.5 %, however the base is held:
/// by its lower face, by all of its nodes, by prescribed motions or beside a mirror plane.
#[test]
fn a_block_slips_as_far_as_newmarks() {
    let expected = rigid_slip();
    assert!(expected > 0.1, "{expected}");
    for base in [Base::Face, Base::Whole, Base::Prescribed, Base::Mirror] {
        // Half of the body behind the mirror plane.
        let half = [2, if matches!(base, Base::Mirror) { 1 } else { 2 }, 1];
        let brick = Vec3::new(0.5, 0.25, 0.5);
        let body = Body::new(Cut::Plane { dip: 0.0 }, half, brick, &Vec3::zeros());
        let law = || BondedCoulomb::unbonded(FRICTION, FRICTION).unwrap();
        let built = || {
            let joint = Joint::new("foot", body.surface.pairs.clone(), law()).unwrap();
            let spec = spec_with(&body, SolidKernel::Hex8Natural, [BLOCK; 2], Box::new(joint))
                .gravity(Vec3::z() * -GRAVITY, Box::new(|_: f64| 1.0));
            base.on(&body, spec)
        };
        let state = settled(&body, built(), StaticMethod::ConjugateGradients, 1.0e-9);
        let push = |t: f64| {
            if t < PULSE.1 {
                (PI * t / PULSE.1).sin()
            } else {
                0.0
            }
        };
        let spec = built().gravity(Vec3::x() * PULSE.0, Box::new(push));
        let mut model = spec.start(state).build().unwrap();
        model.hand_over(1.0e-6).unwrap();
        let options = RunOptions::seconds(2.0 * PULSE.1);
        run(&mut model, &Leapfrog, &options, &mut [], &mut |_| {}).unwrap();
        for pair in &body.surface.pairs {
            // The undamped block rattles: what it moves while it is lifted by some micrometres is no slip of a pair.
            let [below, above] = pair.nodes.map(|node| model.displacement(node));
            let slip = (above - below).x;
            let error = (slip / expected - 1.0).abs();
            assert!(error < 0.005, "{base:?}: {slip} {expected}");
        }
    }
}
