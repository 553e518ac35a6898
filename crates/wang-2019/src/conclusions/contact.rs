//! Conclusions 4 and 5: effect of the interaction of rock and structure, and of the joint between them.

use super::claims::part;
use super::series::{P, SV, WORST, case, case_label, verdict};
use super::{Conclusion, Verdict};
use powerhouse_study::sweep::{CaseOutcome, JointAndLining};
use powerhouse_study::text::rounded;

/// Keys and sentences of the claims on a kind of wave.
struct ClaimTexts {
    kind: &'static str,
    adds: (&'static str, &'static str),
    spares: (&'static str, &'static str),
    tension: (&'static str, &'static str),
    together: (&'static str, &'static str),
    arches: (&'static str, &'static str),
}

const CLAIMS: [ClaimTexts; 2] = [
    ClaimTexts {
        kind: "sv",
        adds: (
            "sv_interaction_adds_damage",
            "SV at 30 degrees: damaged zone and damage are slightly larger with interaction of rock and \
             structure",
        ),
        spares: (
            "sv_interaction_spares_damage",
            "SV at 30 degrees, the abstract: they are much larger without interaction",
        ),
        tension: (
            "sv_tension_dominates",
            "SV at 30 degrees: where damage is severe, it is of tension",
        ),
        together: (
            "sv_joint_fails_where_lining_is_damaged",
            "SV at 30 degrees: the joint slides and opens where the structure is damaged",
        ),
        arches: (
            "sv_joint_fails_at_arches",
            "SV at 30 degrees: the joint fails mainly at the arches",
        ),
    },
    ClaimTexts {
        kind: "p",
        adds: (
            "p_interaction_adds_damage",
            "P at 30 degrees: damaged zone and damage are slightly larger with interaction of rock and \
             structure",
        ),
        spares: (
            "p_interaction_spares_damage",
            "P at 30 degrees, the abstract: they are much larger without interaction",
        ),
        tension: (
            "p_tension_dominates",
            "P at 30 degrees: where damage is severe, it is of tension",
        ),
        together: (
            "p_joint_fails_where_lining_is_damaged",
            "P at 30 degrees: the joint slides and opens where the structure is damaged",
        ),
        arches: (
            "p_joint_fails_at_arches",
            "P at 30 degrees: the joint fails mainly at the arches",
        ),
    },
];

fn conclusion(
    number: u8,
    (key, claim): (&'static str, &'static str),
    found: Result<(String, bool), Vec<String>>,
) -> Conclusion {
    let (figures, verdict) = match found {
        Ok((figures, holds)) => (figures, verdict(holds)),
        Err(missing) => (String::new(), Verdict::Missing(missing)),
    };
    Conclusion {
        number,
        key,
        claim,
        figures,
        verdict,
    }
}

/// Least ratio that counts as much larger.
const MUCH: f64 = 1.25;

/// Claims on the damage with and without interaction, and on its cause.
pub(super) fn of_interaction(outcomes: &[CaseOutcome]) -> Vec<Conclusion> {
    let mut found = Vec::new();
    for texts in CLAIMS {
        let wave = (texts.kind, WORST);
        let structure = |continuous| {
            let part = case(outcomes, wave, continuous).and_then(|case| part(case, "structure"));
            part.ok_or_else(|| case_label(wave, continuous))
        };
        let pair = match (structure(false), structure(true)) {
            (Ok(with), Ok(without)) => Ok([with, without]),
            (with, without) => Err([with.err(), without.err()].into_iter().flatten().collect()),
        };
        let pair: Result<_, Vec<String>> = pair;
        let compared = |more: usize, (least, most): (f64, Option<f64>)| {
            let [with, without] = pair.clone()?;
            let (first, second) = ([with, without][more], [with, without][1 - more]);
            let figures = format!(
                "mean damage {} with, {} without; {} % of the volume damaged with, {} % without",
                rounded(with.mean),
                rounded(without.mean),
                rounded(100.0 * with.damaged),
                rounded(100.0 * without.damaged)
            );
            let is_more = least * second.mean < first.mean;
            let is_at_most = most.is_none_or(|most| first.mean <= most * second.mean);
            let holds = is_more && is_at_most && first.damaged > second.damaged;
            Ok((figures, holds))
        };
        found.push(conclusion(4, texts.adds, compared(0, (1.0, Some(MUCH)))));
        found.push(conclusion(0, texts.spares, compared(1, (MUCH, None))));
        let tension = structure(false).map_err(|missing| vec![missing]);
        let tension = tension.map(|part| {
            let figures = format!(
                "tensile damage exceeds compressive damage on {} % of the {} % of the volume with more than half \
                 of the greatest damage",
                rounded(100.0 * part.severe_tension),
                rounded(100.0 * part.severe)
            );
            (figures, part.severe_tension > 0.5)
        });
        found.push(conclusion(4, texts.tension, tension));
    }
    found
}

/// Claims on the location of joint failure and its correlation with damage.
pub(super) fn of_joints(outcomes: &[CaseOutcome]) -> Vec<Conclusion> {
    let mut found = Vec::new();
    for texts in CLAIMS {
        let wave = (texts.kind, WORST);
        let with = case(outcomes, wave, false).ok_or_else(|| vec![case_label(wave, false)]);
        let together = with.clone().and_then(|case| {
            let found = case.joint_and_lining.as_ref();
            found
                .ok_or_else(|| vec![case_label(wave, false)])
                .map(beside)
        });
        found.push(conclusion(5, texts.together, together));
        found.push(conclusion(
            5,
            texts.arches,
            with.and_then(|case| at_arches(case, wave)),
        ));
    }
    found.push(conclusion(
        5,
        (
            "damage_goes_with_joint_failure",
            "a good state of the joint reduces damage: from case to case the lining is damaged more where \
             more of the joint failed",
        ),
        from_case_to_case(outcomes),
    ));
    found
}

/// Damage of the structure at failed and at intact parts of the joint. They are correlated if the correlation exceeds
/// `2 / sqrt(n)`, which chance exceeds in one of forty samples.
fn beside(found: &JointAndLining) -> (String, bool) {
    let of = |value: Option<f64>| value.map_or("none".into(), rounded);
    let figures = format!(
        "mean damage {} where the joint failed, {} where it is intact; correlation {} over {} elements; failed \
         on {} % of the area",
        of(found.damage_at_failed),
        of(found.damage_at_held),
        of(found.correlation),
        found.elements,
        rounded(100.0 * found.failed)
    );
    let pair = found.damage_at_failed.zip(found.damage_at_held);
    let beyond_chance = found.correlation > Some(2.0 / (found.elements as f64).sqrt());
    let holds = pair.is_some_and(|(failed, held)| failed > held) && beyond_chance;
    (figures, holds)
}

/// The failed share of the joint at the arches and elsewhere.
fn at_arches(case: &CaseOutcome, wave: (&str, f64)) -> Result<(String, bool), Vec<String>> {
    let share = |at_arch: bool| {
        let parts = case.joint_parts.iter();
        let parts = parts.filter(|part| part.name.contains("arch") == at_arch);
        let (failed, area) = parts.fold((0.0, 0.0), |(failed, area), part| {
            let share = part.broken.max(part.slipped).max(part.opened);
            (failed + share * part.area, area + part.area)
        });
        (area > 0.0).then(|| failed / area)
    };
    let Some((arches, rest)) = share(true).zip(share(false)) else {
        return Err(vec![case_label(wave, false)]);
    };
    let figures = format!(
        "failed on {} % of the area at arches, {} % elsewhere",
        rounded(100.0 * arches),
        rounded(100.0 * rest)
    );
    Ok((figures, arches > rest))
}

/// Rank correlation (Kendall's tau) of the damage of the lining and the failed share of the joint over the cases of
/// the paper.
fn from_case_to_case(outcomes: &[CaseOutcome]) -> Result<(String, bool), Vec<String>> {
    let waves = SV.map(|angle| ("sv", angle)).into_iter();
    let waves = waves.chain(P.map(|angle| ("p", angle)));
    let point = |wave: (&'static str, f64)| {
        let found = case(outcomes, wave, false).and_then(|case| {
            let failed = case.joint_and_lining.as_ref()?.failed;
            Some((failed, part(case, "lining")?.mean))
        });
        found.ok_or_else(|| case_label(wave, false))
    };
    let points: Vec<Result<(f64, f64), String>> = waves.map(point).collect();
    let missing: Vec<String> = points.iter().filter_map(|p| p.clone().err()).collect();
    if !missing.is_empty() {
        return Err(missing);
    }
    let points: Vec<(f64, f64)> = points.into_iter().flatten().collect();
    let (mut sum, mut pairs) = (0.0, 0.0);
    for (index, first) in points.iter().enumerate() {
        for second in &points[..index] {
            let product = (first.0 - second.0) * (first.1 - second.1);
            if product != 0.0 {
                sum += product.signum();
            }
            pairs += 1.0;
        }
    }
    let tau = sum / pairs;
    let figures = format!("Kendall's tau {} over {} cases", rounded(tau), points.len());
    Ok((figures, tau > 0.0))
}
