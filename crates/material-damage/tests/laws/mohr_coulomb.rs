//! Mohr-Coulomb surface and its law.

use nalgebra::Vector3;
use powerhouse_material_damage::{
    ElastoPlastic, MaterialError, MohrCoulomb, MohrCoulombParameters, YieldSurface, media, presets,
};
use powerhouse_model::{ConstitutiveLaw, LawInput, Strain, Stress};

use super::exhaustive::{Face, cut_off_faces, passive_ratio, search, shear_faces};
use super::random::Random;

/// The rock of the reference table: E 9 GPa, nu 0.27, phi 42 degrees, c 1.05 MPa.
fn rock(dilation: f64, tension_strength: Option<f64>) -> MohrCoulomb {
    MohrCoulomb::new(MohrCoulombParameters {
        dilation,
        tension_strength,
        ..presets::PAPER_ROCK
    })
    .unwrap()
}

/// Trial and returned principal stresses (Pa): associated, dilation 10 degrees, associated with a
/// cut-off of 0.5 MPa. Computed by an independent solver of the return equations.
const TABLE: [[[f64; 3]; 4]; 5] = [
    [
        [3.0e6, -2.0e6, -20.0e6],
        [-3259403.3675726103, -4003057.491745111, -21159328.08333521],
        [-2533860.240151775, -2818924.7301872787, -17499194.316097405],
        [-3259403.367572606, -4003057.491745108, -21159328.08333521],
    ],
    [
        [0.0, -1.0e6, -15.0e6],
        [-2129070.3719065594, -2129070.37190656, -15457158.481967457],
        [-1830760.263293126, -1830760.2632931261, -13952279.088338938],
        [-2129070.37190656, -2129070.37190656, -15457158.481967459],
    ],
    [
        [1.0e6, -12.0e6, -12.2e6],
        [-1593451.8716169205, -12755133.90868489, -12755133.908684889],
        [
            -1391544.2679200298,
            -11736574.418251714,
            -11736574.418251714,
        ],
        [
            -1593451.8716169205,
            -12755133.908684887,
            -12755133.908684889,
        ],
    ],
    [
        [0.0, -0.1e6, -30.0e6],
        [-5304155.216088818, -5304155.216088818, -31474449.271210693],
        [-4342031.270915751, -4342031.270915751, -26620840.70280725],
        [-5304155.216088818, -5304155.216088818, -31474449.271210693],
    ],
    [
        [2.0e6, 1.9e6, -8.0e6],
        [-804050.6663967739, -804050.6663967739, -8772856.497560577],
        [-299737.79717540415, -299737.79717540415, -6228758.852460741],
        [-804050.6663967732, -804050.6663967733, -8772856.497560581],
    ],
];

/// Returns to plane and edges agree with an independent solver of the return equations, with
/// and without dilation and cut-off.
#[test]
fn returns_agree_with_the_reference_table() {
    let surfaces = [rock(42.0, None), rock(10.0, None), rock(42.0, Some(0.5e6))];
    for [trial, expected @ ..] in TABLE {
        for (surface, expected) in surfaces.iter().zip(expected) {
            let returned = surface.return_principal(&trial).stress;
            for i in 0..3 {
                let error = (returned[i] - expected[i]).abs();
                assert!(
                    error < 1e-10 * expected[2].abs(),
                    "{returned:?} {expected:?}"
                );
            }
        }
    }
}

/// All faces of the surface in unsorted principal stresses.
fn faces(p: &MohrCoulombParameters) -> Vec<Face> {
    let [n, m] = [p.friction, p.dilation].map(passive_ratio);
    let mut faces = shear_faces(n, m, 2.0 * p.cohesion * n.sqrt());
    faces.extend(p.tension_strength.into_iter().flat_map(cut_off_faces));
    faces
}

/// Trials of every kind: far and near, and near edges, apex and corners of the cut-off.
fn trial(random: &mut Random, case: usize, surface: &MohrCoulomb) -> [f64; 3] {
    let cohesion = surface.parameters().cohesion;
    let mut s: [f64; 3] = core::array::from_fn(|_| 20.0 * cohesion * random.signed());
    let near = 10.0_f64.powf(-12.0 * random.unit()) * cohesion;
    match case % 6 {
        0 => {}
        1 => s[1] = s[0] + near * random.signed(),
        2 => s[1] = s[2] + near * random.signed(),
        3 => {
            let corner = surface.cut_off();
            s = core::array::from_fn(|_| corner + near * random.signed());
        }
        4 => {
            let n = surface.uniaxial_compression();
            let least = surface.cut_off() - n * random.unit();
            s = [
                surface.cut_off() + near,
                least + near * random.signed(),
                least,
            ];
        }
        _ => s = s.map(|x| 0.2 * x),
    }
    s.sort_by(|a, b| b.total_cmp(a));
    s
}

/// Ten thousand trials, near edges and corners among them, come to where an exhaustive search
/// over all faces finds the closest point (associated) or solves the return equations.
#[test]
fn returns_agree_with_an_exhaustive_search() {
    let mut random = Random(11);
    let mut worst = [0.0_f64; 2];
    let angles = [
        (42.0, 42.0),
        (42.0, 0.0),
        (42.0, 15.0),
        (10.0, 10.0),
        (60.0, 20.0),
    ];
    for case in 0..10_000 {
        let (friction, dilation) = angles[case % angles.len()];
        let tension = [None, Some(0.5e6), Some(0.02e6), Some(0.0)][case / 7 % 4];
        let p = MohrCoulombParameters {
            friction,
            dilation,
            tension_strength: tension,
            ..presets::PAPER_ROCK
        };
        let surface = MohrCoulomb::new(p).unwrap();
        let s = trial(&mut random, case, &surface);
        let with_apex = MohrCoulombParameters {
            tension_strength: Some(surface.cut_off()),
            ..p
        };
        let expected = search(
            &faces(&with_apex),
            &p.medium,
            p.cohesion,
            p.dilation == p.friction,
            s,
        );
        if surface.excess(&s) <= 0.0 {
            continue;
        }
        let returned = Vector3::from(surface.return_principal(&s).stress);
        let scale = p.cohesion.max(Vector3::from(s).norm());
        let error = (returned - expected).norm() / scale;
        let outside = surface.excess(&returned.into()) / p.cohesion.max(returned.norm());
        assert!(
            error < 1e-8,
            "{case}: {s:?} {returned:?} {expected:?} {p:?}"
        );
        // The yield function is scaled by N + 1.
        let ratio = surface.uniaxial_compression() / surface.uniaxial_tension().max(1.0);
        assert!(
            outside < 1e-12 * (1.0 + ratio.min(20.0)),
            "{case}: {outside:e}"
        );
        worst = [worst[0].max(error), worst[1].max(outside)];
    }
    println!(
        "largest error {:.1e}, largest excess {:.1e}",
        worst[0], worst[1]
    );
}

fn follow(
    law: &ElastoPlastic<MohrCoulomb>,
    strains: &[[f64; 6]],
    initial: Stress,
) -> (Stress, [f64; 8]) {
    let (mut old, mut new) = ([0.0; 8], [0.0; 8]);
    let mut stress = Stress::default();
    for strain in strains {
        let input = LawInput::new(Strain(*strain), &old).with_initial(initial);
        stress = initial + law.stress_change(&input, &mut new);
        old = new;
    }
    (stress, old)
}

/// The principal stresses of a point compressed to yield under lateral pressures are those of the
/// closed form `s3 = N s1 - 2 c sqrt(N)`, at plane, edges and apex.
#[test]
fn yield_stresses_are_closed_forms() {
    for (friction, cohesion) in [(42.0, 1.05e6), (47.7, 1.3e6), (0.0, 2.0e5), (25.0, 0.0)] {
        let p = MohrCoulombParameters {
            friction,
            dilation: 0.0,
            cohesion,
            tension_strength: None,
            medium: media::ROCK,
        };
        let surface = MohrCoulomb::new(p).unwrap();
        let (sine, cosine) = f64::to_radians(friction).sin_cos();
        let n = (1.0 + sine) / (1.0 - sine);
        let ucs = 2.0 * cohesion * cosine / (1.0 - sine);
        assert!((surface.uniaxial_compression() - ucs).abs() <= 1e-12 * ucs);
        let pressure = 3.0e6;
        let scale = n * pressure + ucs;
        let on_surface = [
            [0.0, 0.0, -ucs],
            [0.0, -ucs, -ucs],
            [-pressure, -pressure, -n * pressure - ucs],
            [-pressure, -n * pressure - ucs, -n * pressure - ucs],
            [cohesion * cosine, 0.0, -cohesion * cosine],
            [ucs / n, 0.0, 0.0],
            [-pressure, -2.0 * pressure, -n * pressure - ucs],
        ];
        for s in on_surface {
            assert!(surface.excess(&s).abs() < 1e-10 * scale, "{s:?}");
        }
        if friction > 0.0 {
            let apex = cohesion * cosine / sine;
            assert!((surface.cut_off() - apex).abs() <= 1e-10 * apex);
            assert!((surface.apex() - apex).abs() <= 1e-10 * apex);
        }
    }
    // The strengths that result from the paper's Table 1.
    for (p, compression, tension, apex) in [
        (presets::PAPER_ROCK, 4.716677e6, 0.934980e6, 1.166143e6),
        (presets::PAPER_CONCRETE, 6.720590e6, 1.005864e6, 1.182909e6),
    ] {
        let surface = MohrCoulomb::new(p).unwrap();
        assert!((surface.uniaxial_compression() - compression).abs() < 1.0);
        assert!((surface.uniaxial_tension() - tension).abs() < 1.0);
        assert!((surface.apex() - apex).abs() < 1.0);
    }
}

/// The end of a straight path of strain in equal parts.
fn split(law: &ElastoPlastic<MohrCoulomb>, end: [f64; 6], parts: usize) -> (Stress, [f64; 8]) {
    let strains: Vec<[f64; 6]> = (1..=parts)
        .map(|k| end.map(|e| e * k as f64 / parts as f64))
        .collect();
    follow(law, &strains, Stress::default())
}

/// On a straight path, along which faces become active one after the other and stay so, the end
/// state does not depend on the number of increments.
#[test]
fn split_increments_end_alike() {
    for dilation in [42.0, 10.0, 0.0] {
        let law = ElastoPlastic::new(rock(dilation, None));
        for end in [
            [1.0e-3, 1.0e-3, -4.0e-3, 0.0, 0.0, 0.0],
            [-2.0e-3, 1.0e-3, 0.0, 1.0e-3, 0.0, 0.0],
            [1.0e-3, 1.0e-3, 1.0e-3, 0.0, 0.0, 0.0],
            [0.0, 2.0e-3, 0.0, 0.0, 0.0, 0.0],
        ] {
            let (whole, history) = split(&law, end, 1);
            assert!(history[6] > 1.0e-4, "the path must yield");
            let largest = whole
                .0
                .iter()
                .fold(1.05e6, |most: f64, x| most.max(x.abs()));
            for parts in [10, 1000] {
                let (stress, parted) = split(&law, end, parts);
                for i in 0..6 {
                    assert!((stress.0[i] - whole.0[i]).abs() < 1e-8 * largest);
                    assert!((parted[i] - history[i]).abs() < 1e-8 * 4.0e-3);
                }
            }
        }
    }
}

/// Along a path whose principal axes turn, the end state converges with the first power of the
/// increment.
#[test]
fn turning_paths_converge_with_first_order() {
    let law = ElastoPlastic::new(rock(10.0, None));
    let end = |parts: usize| {
        let strains: Vec<[f64; 6]> = (1..=parts)
            .map(|k| {
                let (sine, cosine) = (2.0 * k as f64 / parts as f64).sin_cos();
                let (sine, cosine) = (2.0e-3 * sine, 2.0e-3 * (1.0 - cosine));
                [-cosine, 0.5 * sine, -sine, 2.0 * sine, cosine, 0.0]
            })
            .collect();
        follow(&law, &strains, Stress::default()).0
    };
    let limit = end(1 << 16);
    let error = |parts| (end(parts) - limit).matrix().norm();
    let slope = (error(64) / error(1024)).log2() / 4.0;
    assert!((slope - 1.0).abs() < 0.15, "{slope}");
}

/// The law has no preferred direction: a rotated strain under a rotated initial stress gives the
/// rotated stress.
#[test]
fn the_law_is_isotropic() {
    let mut random = Random(5);
    let law = ElastoPlastic::new(rock(10.0, Some(0.5e6)));
    for _ in 0..300 {
        let strain = random.six().map(|x| 2.0e-3 * x);
        let initial = Stress(random.six().map(|x| 1.0e6 * x));
        let turn = random.rotation();
        let half = Stress(core::array::from_fn(|i| {
            if i < 3 { strain[i] } else { 0.5 * strain[i] }
        }));
        let turned = turn * half.matrix() * turn.transpose();
        let turned_strain = Strain::from_gradient(&turned).0;
        let turned_initial = Stress::from_matrix(&(turn * initial.matrix() * turn.transpose()));
        let direct = follow(&law, &[strain], initial).0.matrix();
        let rotated = follow(&law, &[turned_strain], turned_initial).0.matrix();
        let error = (rotated - turn * direct * turn.transpose()).norm();
        assert!(error < 1e-10 * direct.norm().max(1.05e6), "{error:e}");
    }
}

/// Strains up to the range of numbers give a finite, admissible stress, and those beyond, or NaN,
/// one that is not finite: never a wrong number.
#[test]
fn extreme_strains_are_admissible_or_not_finite() {
    let mut random = Random(6);
    for (dilation, tension) in [(42.0, None), (0.0, Some(0.5e6))] {
        let law = ElastoPlastic::new(rock(dilation, tension));
        for exponent in [-300, -200, -20, -3, 0, 5, 50, 150, 200, 290] {
            for _ in 0..50 {
                let strain = random.six().map(|x| x * 10.0_f64.powi(exponent));
                let (stress, history) = follow(&law, &[strain], Stress::default());
                let s = powerhouse_material_damage::PrincipalAxes::of(&stress).values;
                let size = s[0].abs().max(s[2].abs()).max(1.05e6);
                assert!(size.is_finite() && history.iter().all(|x| x.is_finite()));
                assert!(
                    law.surface().excess(&s) < 1e-11 * size,
                    "1e{exponent} {s:?}"
                );
            }
        }
        for broken in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1e300] {
            for component in 0..6 {
                let mut strain = [1.0e-4; 6];
                strain[component] = broken;
                let stress = follow(&law, &[strain], Stress::default()).0;
                let finite = stress.0.iter().all(|x| x.is_finite());
                assert!(!finite, "{broken} {stress:?}");
            }
        }
    }
}

/// Invalid parameters are refused by name.
#[test]
fn wrong_parameters_are_refused() {
    let good = presets::PAPER_ROCK;
    for (wrong, name) in [
        (
            MohrCoulombParameters {
                friction: 90.0,
                ..good
            },
            "friction",
        ),
        (
            MohrCoulombParameters {
                cohesion: -1.0,
                ..good
            },
            "cohesion",
        ),
        (
            MohrCoulombParameters {
                cohesion: f64::NAN,
                ..good
            },
            "cohesion",
        ),
        (
            MohrCoulombParameters {
                tension_strength: Some(-1.0),
                ..good
            },
            "tension_strength",
        ),
    ] {
        match MohrCoulomb::new(wrong) {
            Err(MaterialError::Parameter(error)) => assert_eq!(error.name, name),
            other => panic!("{other:?}"),
        }
    }
    let wrong = MohrCoulombParameters {
        dilation: 43.0,
        ..good
    };
    let expected = MaterialError::Dilation {
        dilation: 43.0,
        friction: 42.0,
    };
    assert_eq!(MohrCoulomb::new(wrong), Err(expected));
}
