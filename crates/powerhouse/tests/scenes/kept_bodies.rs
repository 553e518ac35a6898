//! Files of bodies in static equilibrium.

use core::fmt::Debug;
use std::collections::BTreeMap;

use powerhouse::EquilibratedBody;
use powerhouse::engine::{HourglassShare, StageReport, StaticReport};
use powerhouse::model::{
    Bond, Cast, ContactState, HistoryField, JointHistory, JointRecord, JointState, State, Stress,
    Vec3,
};

use super::support::Folder;

/// Fields of a structure by name, as they are printed.
fn fields(value: &impl Debug) -> BTreeMap<String, String> {
    let printed = format!("{value:#?}");
    let mut fields: Vec<(String, String)> = Vec::new();
    for line in printed.lines() {
        match line
            .strip_prefix("    ")
            .and_then(|line| line.split_once(": "))
        {
            Some((name, value)) if !name.starts_with(' ') => {
                fields.push((name.into(), value.into()));
            }
            _ => fields
                .iter_mut()
                .for_each(|(_, value)| value.push_str(line)),
        }
    }
    fields.into_iter().collect()
}

/// Asserts that no field has its default value, so that a field that is not written is missed when it is read.
fn assert_no_default<T: Debug + Default>(value: &T) {
    let default = fields(&T::default());
    let value = fields(value);
    assert!(!value.is_empty() && value.len() == default.len());
    for (name, value) in &value {
        let number = |text: &str| text.trim_end_matches(',').to_owned();
        let same = default.get(name).map(|text| number(text)) == Some(number(value));
        assert!(!same, "{name} has its default value, {value}");
    }
}

/// A body comes back from its file with every field of its state, its joints and the reports of its stages.
#[test]
fn every_field_comes_back() {
    let state = JointState::new(ContactState::Slide, Bond::Broken).with_slip(0.125);
    assert_no_default(&state);
    let mut record = JointRecord::new(state)
        .with_traction(Vec3::new(-1.0, 2.0, 3.0))
        .with_anchor([0.5, -0.25]);
    record.opening = -1e-3;
    record.peak_opening = 2e-3;
    record.first_slip = Some(1.5);
    record.first_crack = Some(2.5);
    record.friction = 10.0;
    record.bond_energy = 20.0;
    record.reference = Some([-4.0, 0.5, 0.0]);
    record.impact = 30.0;
    record.closed_at = Some([1.0, 2.0, 3.0]);
    record.dilation = 0.25;
    assert_no_default(&record);
    let joint = JointHistory::new("seam", vec![[3, 7]], vec![record])
        .with_history(vec!["theta".into(), "wear".into()], vec![0.5, -1.5]);
    assert_no_default(&joint);
    let field = HistoryField::new("damage", vec![4], 2, vec![0.1, 0.2]);
    assert_no_default(&field);
    let cast = Cast {
        elements: vec![1],
        displacement: vec![Vec3::new(0.0, 0.0, -0.5)],
    };
    let mut state = State::default();
    state.time = 0.75;
    state.step = 12;
    state.displacement = vec![Vec3::new(1.0, 2.0, 3.0)];
    state.velocity = vec![Vec3::new(4.0, 5.0, 6.0)];
    state.stage_start = vec![Vec3::new(7.0, 8.0, 9.0)];
    state.initial_stress = vec![Stress([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])];
    state.absent = vec![2];
    state.casts = vec![cast];
    state.carried_forces = vec![Vec3::new(-1.0, -2.0, -3.0)];
    state.history = vec![field];
    state.joints = vec![joint];
    assert_no_default(&state);
    let solution = StaticReport {
        increments: 1,
        corrections: 2,
        products: 3,
        factorisations: 4,
        factor_entries: 5,
        steps: 6,
        residual: 7.0,
        load: 8.0,
        unbalanced: 9.0,
    };
    let stage = StageReport {
        name: "dig".into(),
        excavated: 10,
        cast: 11,
        solution,
        largest_displacement: (0.5, 12),
        hourglass: vec![HourglassShare {
            set: "rock".into(),
            hourglass: 1.0,
            internal: 2.0,
        }],
    };
    let body = EquilibratedBody::new(state, vec![stage]);
    let folder = Folder::new("kept-body");
    let file = folder.join("kept.body");
    body.write(&file).unwrap();
    assert_eq!(EquilibratedBody::read(&file).unwrap(), body);
}
