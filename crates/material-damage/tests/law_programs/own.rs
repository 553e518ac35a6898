//! Programs of a user's own laws.

use powerhouse_material_damage::{LinearElastic, media};
use powerhouse_model::{
    ConstitutiveLaw, ElasticMedium, HistoryVariable, Lane, LawInput, PointAdapter, PointLaw,
    ProgramError, Repeated, Stress,
};
use powerhouse_program::law_program;

use super::laws::check;

/// Soil whose stiffness falls with the largest strain `g` so far by the root `x` of `x^3 + x g / 1e-3 = 1`.
#[derive(Clone)]
struct Degrading;

struct Root<L>(L);

impl<L: Lane> Repeated<L, 2> for Root<L> {
    fn open(&self, [_, error]: &[L; 2]) -> L::Mask {
        error.constant(1e-6).less(*error)
    }
    fn next(&self, [root, error]: [L; 2]) -> [L; 2] {
        let number = |value: f64| root.constant(value);
        let open = self.open(&[root, error]);
        let square = root * root;
        let value = root.mul_add(square + self.0, number(-1.0));
        let next = root - value / number(3.0).mul_add(square, self.0);
        [
            next.select(open, root),
            (next - root).abs().select(open, error),
        ]
    }
}

impl ConstitutiveLaw for Degrading {
    fn name(&self) -> &str {
        "degrading"
    }
    fn medium(&self) -> ElasticMedium {
        media::ROCK
    }
    fn history(&self) -> &'static [HistoryVariable] {
        const { &[HistoryVariable::amount("largest_strain", "1")] }
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, new: &mut [L]) -> Stress<L> {
        let first = input.strain.0[0];
        let one = first.constant(1.0);
        let elastic = LinearElastic::new(media::ROCK).stress_change(input, &mut []);
        let mut largest = input.history[0];
        for strain in &input.strain.0 {
            largest = largest.max(strain.abs());
        }
        new[0] = largest;
        let beyond = one.constant(1e-5).less(largest);
        if !first.any(beyond) {
            return elastic;
        }
        let [root, _] = L::repeat(20, [one, one], &Root(largest * one.constant(1e3)));
        elastic * root.select(beyond, one)
    }
}

/// A law of a user, written in lanes with a branch and a loop, has a program with its bits.
#[test]
fn a_law_of_a_user_has_a_program() {
    check(Degrading);
}

struct NoTension;

impl PointLaw for NoTension {
    fn name(&self) -> &str {
        "no-tension"
    }
    fn medium(&self) -> ElasticMedium {
        media::ROCK
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &[]
    }
    fn stress_change(&self, _input: &LawInput<f64>, _new: &mut [f64]) -> Stress {
        panic!("no point is evaluated")
    }
}

/// A law that leaves its lanes, or reads where it is.
#[derive(Clone)]
struct Leaving {
    reads_location: bool,
}

impl ConstitutiveLaw for Leaving {
    fn name(&self) -> &str {
        "leaving"
    }
    fn medium(&self) -> ElasticMedium {
        media::ROCK
    }
    fn history(&self) -> &'static [HistoryVariable] {
        &[]
    }
    fn uses_location(&self) -> bool {
        self.reads_location
    }
    fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new: &mut [L]) -> Stress<L> {
        let first = input.strain.0[0];
        Stress([L::build(first.token(), |lane| first.extract(lane)); 6])
    }
}

/// Laws without a program are refused by name: one that is evaluated point by point, one that reads single lanes, and one that depends on the
/// location.
#[test]
fn laws_without_a_program_are_refused_by_name() {
    let refused = law_program::<f64, _>(&PointAdapter::new(NoTension), 1).unwrap_err();
    let law = "no-tension".to_owned();
    assert_eq!(refused, ProgramError::OnePoint { law });
    assert!(refused.to_string().contains("'no-tension'"), "{refused}");
    let leaving = |reads_location| law_program::<f32, _>(&Leaving { reads_location }, 1);
    let name = "leaving".to_owned();
    assert_eq!(
        leaving(false),
        Err(ProgramError::SingleLanes { name: name.clone() })
    );
    assert_eq!(leaving(true), Err(ProgramError::Location { law: name }));
}
