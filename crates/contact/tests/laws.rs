//! Laws of joints, point by point and without a mesh.

use powerhouse_contact::{
    BondedCoulomb, BondedCoulombParameters, Frictionless, Paper, PaperParameters, SlipWeakening,
    SlipWeakeningParameters, Tied,
};
use powerhouse_model::{Bond, ContactLaw, ContactState, JointInput, JointState, Vec3};

use ContactState::{Open, Slide, Stick};

/// Cohesion 2, tensile strength 1, friction 0.8 at rest and 0.5 sliding.
const TABLE: BondedCoulombParameters = BondedCoulombParameters {
    cohesion: 2.0,
    tensile_strength: 1.0,
    static_friction: 0.8,
    dynamic_friction: 0.5,
    cohesion_loss: true,
};

fn bonded() -> BondedCoulomb {
    BondedCoulomb::new(TABLE).unwrap()
}

fn paper() -> Paper {
    Paper::new(PaperParameters {
        cohesion: TABLE.cohesion,
        tensile_strength: TABLE.tensile_strength,
        static_friction: TABLE.static_friction,
        dynamic_friction: TABLE.dynamic_friction,
    })
    .unwrap()
}

fn state(contact: ContactState, bond: Bond) -> JointState {
    JointState::new(contact, bond)
}

/// Admitted traction and new state of a law without history.
fn admitted(law: &(impl ContactLaw + ?Sized), trial: Vec3, old: &JointState) -> (Vec3, JointState) {
    let response = law.admissible(&JointInput::new(trial, old), &mut []);
    assert_eq!(response.dilation, 0.0);
    (response.traction, response.state)
}

/// A traction of normal part `n` whose shear `s` points anywhere in the plane.
fn traction(n: f64, s: f64) -> Vec3 {
    let angle = 0.7_f64;
    Vec3::new(n, s * angle.cos(), s * angle.sin())
}

/// The response to `trial` is the traction `(n, s)` along the shear of the trial, and the state.
#[track_caller]
fn expect(
    law: &impl ContactLaw,
    (n, s): (f64, f64),
    old: JointState,
    (found_n, found_s): (f64, f64),
    new: JointState,
) {
    let (found, state) = admitted(law, traction(n, s), &old);
    let expected = traction(found_n, found_s);
    assert!((found - expected).norm() < 1e-14, "{found} {expected}");
    assert_eq!(state, new);
}

/// Every law that there is, with friction 0 and 10 and strengths 0 and infinite.
fn all_laws() -> Vec<Box<dyn ContactLaw>> {
    let mut laws: Vec<Box<dyn ContactLaw>> = vec![Box::new(Tied), Box::new(Frictionless)];
    for friction in [0.0, 0.5, 10.0] {
        let slip = SlipWeakeningParameters {
            static_friction: friction,
            dynamic_friction: 0.5 * friction,
            slip_distance: 1e-3,
        };
        laws.push(Box::new(SlipWeakening::new(slip).unwrap()));
        for cohesion in [0.0, 2.0, f64::INFINITY] {
            for tensile_strength in [0.0, 1.0, f64::INFINITY] {
                laws.push(Box::new(
                    Paper::new(PaperParameters {
                        cohesion,
                        tensile_strength,
                        static_friction: friction,
                        dynamic_friction: 0.5 * friction,
                    })
                    .unwrap(),
                ));
                for cohesion_loss in [true, false] {
                    laws.push(Box::new(
                        BondedCoulomb::new(BondedCoulombParameters {
                            cohesion,
                            tensile_strength,
                            static_friction: friction,
                            dynamic_friction: 0.5 * friction,
                            cohesion_loss,
                        })
                        .unwrap(),
                    ));
                }
            }
        }
    }
    laws
}

/// The bond carries what lies in its envelope, `n <= ft` and `s <= c - mu_s n`, to the bit.
#[test]
fn a_bond_carries_what_lies_in_its_envelope() {
    let (law, intact) = (bonded(), state(Stick, Bond::Intact));
    for n in [-5.0, -1.0, 0.0, 0.5, 1.0] {
        for share in [0.0, 0.5, 1.0 - 1e-12] {
            let trial = traction(n, share * (2.0 - 0.8 * n));
            assert_eq!(admitted(&law, trial, &intact), (trial, intact));
        }
    }
}

/// Past its envelope a bond breaks for good: no tension, no cohesion, and friction is the dynamic
/// one until the pair sticks again.
#[test]
fn a_broken_bond_stays_broken() {
    let (law, intact) = (bonded(), state(Stick, Bond::Intact));
    let cracked = state(Open, Bond::Broken);
    expect(&law, (1.0 + 1e-12, 0.0), intact, (0.0, 0.0), cracked);
    expect(&law, (0.5, 1.7), intact, (0.0, 0.0), cracked);
    let slid = state(Slide, Bond::Broken);
    expect(&law, (-1.0, 2.8 + 1e-12), intact, (-1.0, 0.5), slid);
    expect(&law, (0.1, 0.0), slid, (0.0, 0.0), cracked);
    expect(&law, (-1.0, 0.51), cracked, (-1.0, 0.5), slid);
    let stuck = state(Stick, Bond::Broken);
    expect(&law, (-1.0, 0.5), cracked, (-1.0, 0.5), stuck);
    expect(&law, (1e-9, 0.0), stuck, (0.0, 0.0), cracked);
}

/// A sliding pair sticks again when the trial is within `mu_d N`, and slips again past `mu_s N`.
#[test]
fn friction_depends_on_whether_the_pair_slid() {
    let law = bonded();
    let (stuck, slid) = (state(Stick, Bond::Broken), state(Slide, Bond::Broken));
    expect(&law, (-2.0, 1.01), slid, (-2.0, 1.0), slid);
    expect(&law, (-2.0, 0.99), slid, (-2.0, 0.99), stuck);
    expect(&law, (-2.0, 1.59), stuck, (-2.0, 1.59), stuck);
    expect(&law, (-2.0, 1.61), stuck, (-2.0, 1.0), slid);
}

/// With cohesion loss off slip leaves the bond: cohesion acts along with friction, in tension too,
/// until a crack takes both.
#[test]
fn cohesion_can_outlast_slip() {
    let law = BondedCoulomb::new(BondedCoulombParameters {
        cohesion_loss: false,
        ..TABLE
    })
    .unwrap();
    let (intact, slid) = (state(Stick, Bond::Intact), state(Slide, Bond::Intact));
    expect(&law, (-1.0, 3.0), intact, (-1.0, 2.5), slid);
    expect(&law, (-1.0, 2.49), slid, (-1.0, 2.49), intact);
    expect(&law, (0.5, 3.0), slid, (0.5, 1.75), slid);
    let cracked = state(Open, Bond::Broken);
    expect(&law, (1.1, 0.0), slid, (0.0, 0.0), cracked);
    let broken = state(Slide, Bond::Broken);
    expect(&law, (-1.0, 3.0), cracked, (-1.0, 0.5), broken);
}

/// The paper's law is Eqs. (22) to (24) as printed: shear is dropped in tension, cracks and slip
/// take the cohesion alone, the threshold is always `mu_s`.
#[test]
fn the_papers_law_is_as_printed() {
    let (law, intact) = (paper(), state(Stick, Bond::Intact));
    // Eq. (22).
    expect(
        &law,
        (1.1, 5.0),
        intact,
        (0.0, 0.0),
        state(Open, Bond::Broken),
    );
    // Eq. (23).
    expect(
        &law,
        (0.9, 5.0),
        intact,
        (0.9, 0.0),
        state(Slide, Bond::Intact),
    );
    // Eq. (24), first with the cohesion, then without.
    expect(&law, (-1.0, 2.79), intact, (-1.0, 2.79), intact);
    let slid = state(Slide, Bond::Broken);
    expect(&law, (-1.0, 2.81), intact, (-1.0, 0.5), slid);
    expect(&law, (-1.0, 0.81), slid, (-1.0, 0.5), slid);
    let stuck = state(Stick, Bond::Broken);
    expect(&law, (-1.0, 0.79), slid, (-1.0, 0.79), stuck);
    // The tensile strength outlasts slip; an open pair is not pulled.
    expect(&law, (0.9, 0.0), stuck, (0.9, 0.0), slid);
    let open = state(Open, Bond::Broken);
    expect(&law, (0.9, 0.0), open, (0.0, 0.0), open);
}

/// Friction falls linearly with slip down to its dynamic value.
#[test]
fn friction_weakens_with_slip() {
    let law = SlipWeakening::new(SlipWeakeningParameters {
        static_friction: 0.7,
        dynamic_friction: 0.5,
        slip_distance: 0.4,
    })
    .unwrap();
    for (slip, friction) in [(0.0, 0.7), (0.1, 0.65), (0.4, 0.5), (7.0, 0.5)] {
        let old = law.initial().with_slip(slip);
        let slid = old.with_contact(Slide);
        expect(
            &law,
            (-2.0, 2.0 * friction + 0.1),
            old,
            (-2.0, 2.0 * friction),
            slid,
        );
        expect(
            &law,
            (-2.0, 2.0 * friction - 0.1),
            old,
            (-2.0, 2.0 * friction - 0.1),
            old,
        );
    }
    expect(
        &law,
        (0.1, 1.0),
        law.initial(),
        (0.0, 0.0),
        state(Open, Bond::Never),
    );
}

/// Whatever the parameters, a law gives numbers, never more shear than the trial's nor than it
/// says for sliding, no tension without a bond, nothing to an open pair, and admits what it gave.
#[test]
fn laws_hold_their_own_limits() {
    for law in all_laws() {
        for bond in [Bond::Never, Bond::Intact, Bond::Broken] {
            for contact in [Stick, Slide, Open] {
                for n in [-1e9, -3.0, -1e-300, 0.0, 1e-300, 0.7, 1e9] {
                    for s in [0.0, 1e-150, 1.0, 1e9] {
                        let (old, trial) = (state(contact, bond), traction(n, s));
                        let (t, new) = admitted(law.as_ref(), trial, &old);
                        let name = format!("{} {trial} {old:?} -> {t} {new:?}", law.name());
                        assert!(t.iter().all(|x| x.is_finite()), "{name}");
                        let shear = t.y.hypot(t.z);
                        assert!(shear <= s * (1.0 + 1e-12), "{name}");
                        match new.contact {
                            Stick => assert_eq!(t, trial, "{name}"),
                            Open => assert_eq!(t, Vec3::zeros(), "{name}"),
                            Slide => {
                                let input = JointInput::new(trial, &new);
                                let strength = law.sliding_strength(t.x, &input);
                                assert!(shear <= strength * (1.0 + 1e-12), "{name}");
                            }
                        }
                        if law.name() != "tied" && law.name() != "paper" && new.bond != Bond::Intact
                        {
                            assert!(t.x <= 0.0, "{name}");
                        }
                        // A bond never comes back.
                        if bond != Bond::Intact {
                            assert_eq!(new.bond, bond, "{name}");
                        }
                        let cut = Vec3::new(t.x, 0.999_999 * t.y, 0.999_999 * t.z);
                        if new.contact == Slide && t.x <= 0.0 {
                            let (again, _) = admitted(law.as_ref(), cut, &new);
                            assert!((again - cut).norm() <= 1e-12 * cut.norm(), "{name} {again}");
                        }
                    }
                }
            }
        }
    }
}

/// Turning the trial in the plane of the joint turns the answer, and nothing else.
#[test]
fn laws_prefer_no_direction() {
    let turn = |t: &Vec3| Vec3::new(t.x, -t.z, t.y);
    for law in all_laws() {
        for contact in [Stick, Slide, Open] {
            for (n, s) in [(-1.0, 0.3), (-1.0, 9.0), (0.4, 0.2), (0.4, 9.0)] {
                let (old, trial) = (state(contact, Bond::Intact), traction(n, s));
                let (plain, turned) = (
                    admitted(law.as_ref(), trial, &old),
                    admitted(law.as_ref(), turn(&trial), &old),
                );
                assert!((turn(&plain.0) - turned.0).norm() <= 1e-15 * 9.0);
                assert_eq!(plain.1, turned.1);
            }
        }
    }
}

/// A law starts bonded if it has any strength, and a parameter out of range is named.
#[test]
fn parameters_are_checked() {
    assert_eq!(bonded().initial().bond, Bond::Intact);
    let plain = BondedCoulomb::unbonded(0.6, 0.6).unwrap();
    assert_eq!(plain.initial().bond, Bond::Never);
    let refused = |change: fn(&mut BondedCoulombParameters)| {
        let mut parameters = TABLE;
        change(&mut parameters);
        BondedCoulomb::new(parameters).unwrap_err().name
    };
    assert_eq!(refused(|p| p.cohesion = -1.0), "cohesion");
    assert_eq!(refused(|p| p.cohesion = f64::NAN), "cohesion");
    assert_eq!(refused(|p| p.tensile_strength = -1.0), "tensile_strength");
    assert_eq!(
        refused(|p| p.static_friction = f64::INFINITY),
        "static_friction"
    );
    assert_eq!(refused(|p| p.dynamic_friction = 0.9), "dynamic_friction");
    let slip = SlipWeakeningParameters {
        static_friction: 0.6,
        dynamic_friction: 0.6,
        slip_distance: 0.0,
    };
    assert_eq!(SlipWeakening::new(slip).unwrap_err().name, "slip_distance");
}
