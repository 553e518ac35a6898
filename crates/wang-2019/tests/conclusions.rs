//! The conclusions of the paper and the sensitivity of results, for artificial outcomes.

use powerhouse_report::{ReportCase, ReportItem, ReportSection, ReportTable, sensitivity};
use powerhouse_study::sweep::{
    CaseInput, CaseOutcome, CaseWave, Coverage, JointAndLining, JointCase, PartDamage, Peak,
};
use powerhouse_wang_2019::{Comparison, Conclusion, Verdict, conclusions};

fn peak(name: &str, value: f64) -> Peak {
    Peak {
        name: name.into(),
        value,
        time: 1.0,
    }
}

/// A part of 10 m3 of which half as much as its mean damage is damaged, mostly by tension.
fn part(name: &str, mean: f64) -> PartDamage {
    PartDamage {
        name: name.into(),
        volume: 10.0,
        mean,
        greatest: 2.0 * mean,
        damaged: 0.5 * mean,
        tension: 0.3 * mean,
        compression: 0.1 * mean,
        both: 0.1 * mean,
        severe: 0.2 * mean,
        severe_tension: 0.8,
    }
}

fn joint(name: &str, broken: f64) -> JointCase {
    JointCase {
        name: name.into(),
        area: 100.0,
        slipped: 0.0,
        opened: 0.0,
        broken,
        slip: 0.0,
        opening: 0.0,
    }
}

/// A case of one wave in which everything is as large as a number from 0 to 1: stresses of two points (MPa),
/// relative displacements (cm), damage, failure of the joint.
fn case(kind: &str, angle: f64, size: f64) -> CaseOutcome {
    CaseOutcome {
        coverage: None,
        name: format!("{kind}-{angle}"),
        input: CaseInput {
            waves: vec![CaseWave {
                kind: kind.into(),
                incidence: angle,
                azimuth: 0.0,
                motion: "el-centro".into(),
                factor: 1.0,
            }],
            varies: None,
            continuous: false,
        },
        steps: 10,
        step: 1e-4,
        end: 1e-3,
        wall_time: 1.0,
        energy_residual: 0.0,
        stresses: ["A-concrete", "B-concrete"]
            .map(|name| peak(name, 1e6 * size))
            .to_vec(),
        displacements: vec![peak("A", 0.1 * size)],
        relative: vec![peak("A-O1", 0.02 * size), peak("B-O1", 0.01 * size)],
        ground: vec![peak("A-O1", 0.006), peak("B-O1", 0.002)],
        damage: Vec::new(),
        parts: vec![
            part("structure", size),
            part("lining", size),
            part("arch_main", 0.5 * size),
            part("wall_main", 0.4 * size),
        ],
        joints: vec![joint("rock-lining", size)],
        joint_parts: vec![
            joint("joint-arch-main", size),
            joint("joint-wall-main", 0.5 * size),
        ],
        sections: Vec::new(),
        joint_and_lining: Some(JointAndLining {
            failed: size,
            elements: 20,
            damage_at_failed: Some(size),
            damage_at_held: Some(0.5 * size),
            correlation: Some(0.7),
        }),
        bolts: Vec::new(),
        bolts_at_rest: Vec::new(),
    }
}

/// The same without joints.
fn continuous(mut case: CaseOutcome) -> CaseOutcome {
    case.name += "-continuous";
    case.input.continuous = true;
    (case.joints, case.joint_parts) = (Vec::new(), Vec::new());
    case.joint_and_lining = None;
    case
}

/// Cases as in the paper.
fn as_in_the_paper() -> Vec<CaseOutcome> {
    let sv = [(0.0, 0.1), (15.0, 0.2), (25.0, 0.4), (30.0, 0.6)];
    let p = [(0.0, 0.2), (30.0, 0.6), (60.0, 0.4), (90.0, 0.1)];
    let mut cases: Vec<CaseOutcome> = (sv.iter())
        .map(|(angle, size)| case("sv", *angle, *size))
        .collect();
    cases.extend(p.iter().map(|(angle, size)| case("p", *angle, *size)));
    cases.push(continuous(case("sv", 30.0, 0.5)));
    cases.push(continuous(case("p", 30.0, 0.5)));
    cases
}

fn of<'c>(found: &'c [Conclusion], key: &str) -> &'c Conclusion {
    found.iter().find(|claim| claim.key == key).unwrap()
}

/// The section of a report has every claim, and the values of the paper beside those of the sweep; a sweep without the
/// point A has no such section.
#[test]
fn the_section_of_a_report_compares_with_the_paper() {
    let outcomes = as_in_the_paper();
    let items = |outcomes: &[CaseOutcome]| {
        let cases: Vec<ReportCase> = outcomes
            .iter()
            .cloned()
            .map(ReportCase::of_outcome)
            .collect();
        Comparison.items(&cases)
    };
    let found = items(&outcomes);
    let tables: Vec<&ReportTable> = (found.iter())
        .filter_map(|item| match item {
            ReportItem::Table(table) => Some(table),
            _ => None,
        })
        .collect();
    let [claims, values] = tables[..] else {
        panic!("{found:?}");
    };
    assert_eq!(claims.rows.len(), conclusions(&outcomes).len());
    assert!(
        claims
            .rows
            .iter()
            .all(|row| row.len() == claims.header.len())
    );
    // 0.1 m times the size of the case SV 30.
    let moved = values.rows.iter().find(|row| row[0].contains("A, SV 30"));
    assert_eq!(moved.unwrap()[1..3], ["74", "60.0"]);
    let mut others = outcomes;
    for outcome in &mut others {
        outcome.stresses.clear();
        outcome.displacements[0].name = "crown".into();
    }
    assert!(items(&others).is_empty() && items(&[]).is_empty());
}

/// Outcomes as in the paper confirm all of its conclusions, and not the contradicting claims of its abstract; each has
/// its values.
#[test]
fn outcomes_as_in_the_paper_confirm_it() {
    let found = conclusions(&as_in_the_paper());
    for claim in &found {
        let expected = match claim.number {
            0 => Verdict::NotConfirmed,
            _ => Verdict::Confirmed,
        };
        assert_eq!(claim.verdict, expected, "{claim}");
        assert!(!claim.figures.is_empty(), "{claim}");
    }
    let numbers: Vec<u8> = found.iter().map(|claim| claim.number).collect();
    for number in 0..=5 {
        assert!(numbers.contains(&number), "{number}");
    }
    let line = of(&found, "sv_stress_rises").to_string();
    assert_eq!(
        line,
        "conclusion.1.sv_stress_rises = confirmed (0: 0.100, 15: 0.200, 25: 0.400, 30: 0.600 MPa, mean of 2 \
         points; the same trend at 2 of them)"
    );
    let moved = &of(&found, "p_oblique_displaces_more").figures;
    assert_eq!(
        moved,
        "0: 3.00, 30: 9.00, 90: 1.50 mm, mean of 2 points; the same trend at 2 of them; free field 0: \
         4.00, 30: 4.00, 90: 4.00"
    );
    let abstract_line = of(&found, "p_interaction_spares_damage").to_string();
    assert!(
        abstract_line.starts_with("abstract.p_interaction_spares_damage = not confirmed (mean")
    );
}

/// Each claim depends on its own values and on no others.
#[test]
fn a_claim_depends_on_its_values() {
    let falls = |change: &dyn Fn(&mut Vec<CaseOutcome>)| -> Vec<&'static str> {
        let mut cases = as_in_the_paper();
        change(&mut cases);
        let found = conclusions(&cases);
        let is_other =
            |claim: &&Conclusion| (claim.verdict == Verdict::Confirmed) == (claim.number == 0);
        found
            .iter()
            .filter(is_other)
            .map(|claim| claim.key)
            .collect()
    };
    assert!(falls(&|_| {}).is_empty());
    // SV at 15 degrees above that at 25: no more rise, but 30 degrees stay the greatest.
    let stress = |cases: &mut Vec<CaseOutcome>, place: usize, value: f64| {
        cases[place]
            .stresses
            .iter_mut()
            .for_each(|peak| peak.value = value);
    };
    assert_eq!(falls(&|cases| stress(cases, 1, 0.5e6)), ["sv_stress_rises"]);
    // The mean rises, at none of the points: A falls from 15 to 25 degrees, B before and after.
    let apart = |cases: &mut Vec<CaseOutcome>| {
        let values = [[1.0, 1.0], [3.0, 0.5], [2.0, 2.5], [4.0, 2.0]];
        for (case, values) in cases.iter_mut().zip(values) {
            for (peak, value) in case.stresses.iter_mut().zip(values) {
                peak.value = 1e6 * value;
            }
        }
    };
    assert_eq!(falls(&apart), ["sv_stress_rises"]);
    // P at 90 degrees above that at 60: no fall beyond 30 degrees.
    let wanted = ["p_stress_is_greatest_at_30"];
    assert_eq!(falls(&|cases| stress(cases, 7, 0.5e6)), wanted);
    let relative = |cases: &mut Vec<CaseOutcome>, place: usize| {
        cases[place]
            .relative
            .iter_mut()
            .for_each(|peak| peak.value = 1.0);
    };
    assert_eq!(
        falls(&|cases| relative(cases, 0)),
        ["sv_displacement_is_greatest_at_30"]
    );
    // At 60 degrees it is neither vertical nor horizontal.
    assert_eq!(
        falls(&|cases| relative(cases, 6)),
        ["p_displacement_is_greatest_at_30"]
    );
    assert_eq!(
        falls(&|cases| relative(cases, 7)),
        [
            "p_displacement_is_greatest_at_30",
            "p_oblique_displaces_more"
        ]
    );
    // Walls above arches.
    let walls = |cases: &mut Vec<CaseOutcome>| cases[3].parts[3].mean = 1.0;
    assert_eq!(falls(&walls), ["sv_arches_and_floors_suffer_most"]);
    let arches = |cases: &mut Vec<CaseOutcome>| cases[0].parts[2].mean = 1.0;
    assert_eq!(
        falls(&arches),
        ["sv_oblique_damages_arches_and_floors_more"]
    );
    // More damage without interaction: the abstract is right.
    let spared = |cases: &mut Vec<CaseOutcome>| cases[8].parts[0] = part("structure", 0.9);
    let mut wanted = ["sv_interaction_adds_damage", "sv_interaction_spares_damage"];
    let mut found = falls(&spared);
    found.sort_unstable();
    wanted.sort_unstable();
    assert_eq!(found, wanted);
    // Much more damage with it than without is not a little more, nor what the abstract says.
    let much = |cases: &mut Vec<CaseOutcome>| cases[8].parts[0] = part("structure", 0.3);
    assert_eq!(falls(&much), ["sv_interaction_adds_damage"]);
    // Cases of other records do not count, at any position.
    let others = |cases: &mut Vec<CaseOutcome>| {
        let mut other = case("sv", 30.0, 0.05);
        other.input.waves[0].motion = "kobe".into();
        cases.insert(1, other);
        let mut twice = case("p", 30.0, 0.05);
        twice.input.waves[0].factor = 2.0;
        cases.insert(1, twice);
    };
    assert!(falls(&others).is_empty(), "{:?}", falls(&others));
    // A little more is not much more.
    let alike = |cases: &mut Vec<CaseOutcome>| cases[8].parts[0] = part("structure", 0.65);
    assert_eq!(falls(&alike), ["sv_interaction_adds_damage"]);
    // More damage on less volume confirms neither.
    let mixed = |cases: &mut Vec<CaseOutcome>| cases[8].parts[0].damaged = 0.9;
    assert_eq!(falls(&mixed), ["sv_interaction_adds_damage"]);
    let shear = |cases: &mut Vec<CaseOutcome>| cases[5].parts[0].severe_tension = 0.2;
    assert_eq!(falls(&shear), ["p_tension_dominates"]);
    let apart = |cases: &mut Vec<CaseOutcome>| {
        let found = cases[3].joint_and_lining.as_mut().unwrap();
        found.damage_at_held = Some(0.9);
    };
    assert_eq!(falls(&apart), ["sv_joint_fails_where_lining_is_damaged"]);
    // More damage where it failed, but no more than by chance.
    let scattered = |cases: &mut Vec<CaseOutcome>| {
        let found = cases[3].joint_and_lining.as_mut().unwrap();
        found.correlation = Some(0.4);
    };
    assert_eq!(
        falls(&scattered),
        ["sv_joint_fails_where_lining_is_damaged"]
    );
    let elsewhere = |cases: &mut Vec<CaseOutcome>| cases[5].joint_parts[1].broken = 0.9;
    assert_eq!(falls(&elsewhere), ["p_joint_fails_at_arches"]);
    // The joint fails the less the more the lining is damaged.
    let contrary = |cases: &mut Vec<CaseOutcome>| {
        for case in cases {
            if let Some(found) = &mut case.joint_and_lining {
                found.failed = 1.0 - found.failed;
            }
        }
    };
    assert_eq!(falls(&contrary), ["damage_goes_with_joint_failure"]);
}

/// A claim is open as long as a case is missing, which it names; varied cases, or those with another azimuth, do not
/// replace it.
#[test]
fn missing_cases_are_named() {
    let mut cases = as_in_the_paper();
    cases[1].input.varies = Some("mesh".into());
    cases[7].input.waves[0].azimuth = 90.0;
    // Without joints, but of another mesh too.
    for case in cases
        .iter_mut()
        .filter(|case| case.name == "sv-30-continuous")
    {
        case.input.varies = Some("mesh".into());
    }
    let found = conclusions(&cases);
    let missing = |key: &str| match &of(&found, key).verdict {
        Verdict::Missing(cases) => cases.clone(),
        other => panic!("{key}: {other}"),
    };
    assert_eq!(missing("sv_stress_rises"), ["SV 15"]);
    assert_eq!(missing("p_damage_is_worst_at_30"), ["P 90"]);
    assert_eq!(
        missing("sv_interaction_adds_damage"),
        ["SV 30 without joints"]
    );
    assert_eq!(missing("damage_goes_with_joint_failure"), ["SV 15", "P 90"]);
    assert_eq!(
        of(&found, "sv_tension_dominates").verdict,
        Verdict::Confirmed
    );
    let line = of(&found, "sv_stress_rises").to_string();
    assert_eq!(line, "conclusion.1.sv_stress_rises = open, missing SV 15");
}

/// A varied case is compared with the first unvaried case of the same waves, value by value; one of other waves is left
/// out.
#[test]
fn variations_are_compared_with_their_base() {
    let vary = |mut case: CaseOutcome, name: &str, what: &str| {
        (case.name, case.input.varies) = (name.into(), Some(what.into()));
        case
    };
    let mut cases = as_in_the_paper();
    cases.push(vary(case("sv", 30.0, 0.9), "sv-30-smooth", "friction"));
    cases.push(vary(case("sv", 34.0, 0.9), "sv-34-smooth", "friction"));
    cases.push(vary(
        continuous(case("p", 30.0, 0.3)),
        "p-30-whole",
        "joint",
    ));
    // Of another record: beside the plain case of that record where there is one.
    let of_kobe = |mut case: CaseOutcome, name: &str| {
        (case.name, case.input.waves[0].motion) = (name.into(), "kobe".into());
        case
    };
    let other = vary(case("sv", 15.0, 0.4), "sv-15-kobe", "record");
    cases.push(of_kobe(other, "sv-15-kobe"));
    cases.push(of_kobe(case("p", 60.0, 0.4), "p-60-kobe"));
    let other = vary(case("p", 60.0, 0.4), "p-60-kobe-smooth", "friction");
    cases.push(of_kobe(other, "p-60-kobe-smooth"));
    let found = sensitivity(&cases);
    let printed: Vec<(&str, &str, &str)> = (found.iter())
        .map(|found| (&*found.case, &*found.varies, &*found.base))
        .collect();
    assert_eq!(
        printed,
        [
            ("sv-30-smooth", "friction", "sv-30"),
            ("p-30-whole", "joint", "p-30"),
            ("sv-15-kobe", "record", "sv-15"),
            ("p-60-kobe-smooth", "friction", "p-60-kobe")
        ]
    );
    let figures: Vec<String> = found[0].figures.iter().map(ToString::to_string).collect();
    assert_eq!(
        figures,
        [
            "relative displacement B-O1 (mm) 9.00 (+50.0 %)",
            "principal stress A-concrete (MPa) 0.900 (+50.0 %)",
            "mean damage of the lining 0.900 (+50.0 %)",
            "failed share of the joint (%) 90.0 (+50.0 %)",
        ]
    );
    // Without a joint there is nothing that could fail.
    assert_eq!(found[1].figures.len(), 3);
    assert!((found[1].figures[0].change().unwrap() + 0.5).abs() < 1e-12);
}

/// Claims with cases that end before the strong motion of their record are not judged, and each states what was
/// shortened. Claims with cases that cover it are judged.
#[test]
fn cases_without_the_strong_motion_are_not_judged() {
    let covered = |intensity: f64| {
        let mut cases = as_in_the_paper();
        // One that is short is enough: claims compare cases.
        cases[2].coverage = Some(Coverage {
            record: "horizontal".into(),
            end: 1.5,
            length: 20.0,
            intensity,
            significant: 6.0,
        });
        conclusions(&cases)
    };
    for claim in covered(0.12) {
        let printed = claim.to_string();
        assert!(matches!(claim.verdict, Verdict::NotJudged(_)), "{printed}");
        assert!(
            printed.contains("not judged (shortened to 1.500 of 20.000 s of record 'horizontal'"),
            "{printed}"
        );
    }
    let judged = |claim: &Conclusion| !matches!(claim.verdict, Verdict::NotJudged(_));
    assert!(covered(0.951).iter().all(judged));
}
