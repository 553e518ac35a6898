use powerhouse_elements::{BoltEnd, BoltLine, BoltParameters, BoltSet, Grout};
use powerhouse_model::{Mesh, Vec3};

/// Axial stiffness of the bar (N).
const AXIAL: f64 = 2.0e3;

/// Number of segments, and error of the greatest force by them, of a bolt along a rod of bricks of 1 m, with the given `alpha l`.
fn error(
    bricks: usize,
    share: f64,
    longest_segment: f64,
    [head, toe]: [BoltEnd; 2],
) -> (usize, f64) {
    let length = bricks as f64;
    let (high, counts) = (Vec3::new(1.0, 1.0, length), [1, 1, bricks]);
    let mesh = Mesh::box_of_hexes(Vec3::zeros(), high, counts, "rock").unwrap();
    let parameters = BoltParameters {
        young: 2.0e11,
        area: AXIAL / 2.0e11,
        grout: Some(Grout {
            stiffness: AXIAL * (share / length).powi(2),
            strength: f64::INFINITY,
            head,
            toe,
        }),
        longest_segment,
        ..BoltParameters::steel(0.025).unwrap()
    };
    let line = BoltLine {
        head: Vec3::new(0.45, 0.55, length),
        toe: Vec3::new(0.45, 0.55, 0.0),
    };
    let rock = mesh.element_set("rock").unwrap();
    let bolts = BoltSet::new("bolt", &mesh, rock, &[line], parameters).unwrap();
    (bolts.segments(0).len(), bolts.segment_error())
}

/// Bolts in grout have so many segments by default that their greatest force in stretched ground errs by less than 3 %, in one
/// brick and in several, with grout that holds little and much, between free and anchored ends.
#[test]
fn bolts_in_grout_have_enough_segments() {
    use BoltEnd::{Anchored, Free};
    for bricks in [1, 3, 7] {
        for share in [0.1, 1.0, 2.0, 3.1, 4.0, 4.7, 12.0, 30.0] {
            for ends in [
                [Free, Free],
                [Anchored, Free],
                [Free, Anchored],
                [Anchored, Anchored],
            ] {
                let (count, error) = error(bricks, share, f64::INFINITY, ends);
                assert!(
                    count >= 4 && count as f64 >= share - 1e-9,
                    "{bricks} {share}: {count}"
                );
                assert!(error < 0.03, "{bricks} {share} {ends:?}: {error}");
            }
        }
    }
}

/// One segment between free ends has `1 / (1 + 4 / (alpha l)^2)` of the force of a tied bar, in place of `1 - 1 / cosh(alpha l / 2)`.
#[test]
fn the_error_of_one_segment_is_known() {
    for share in [0.3, 1.0, 4.0, 9.0_f64] {
        let (count, error) = error(1, share, 9.0, [BoltEnd::Free; 2]);
        let one = 1.0 / (1.0 + 4.0 / (share * share));
        let right = 1.0 - 1.0 / (0.5 * share).cosh();
        assert_eq!(count, 1);
        assert!(
            (error - (one / right - 1.0).abs()).abs() < 1e-9,
            "{share}: {error}"
        );
    }
    // A length that divides the element up to rounding gives that many segments.
    for count in 1..12 {
        let longest = 1.0 / f64::from(count);
        assert_eq!(error(1, 1.0, longest, [BoltEnd::Free; 2]).0, count as usize);
    }
}
