//! Capacity of reinforced concrete sections.

use powerhouse_model::ParameterError;
use powerhouse_observe::{SectionCapacity, SectionReinforcement};

const PLAIN: SectionReinforcement = SectionReinforcement {
    concrete_strength: 20.0e6,
    bars: [0.0; 2],
    cover: 0.05,
    yield_stress: 435.0e6,
};

fn reinforced(bars: [f64; 2]) -> SectionReinforcement {
    SectionReinforcement { bars, ..PLAIN }
}

/// Plain concrete bears the moment of the block: `M = N (h - N / f) / 2`, for every normal force up to that of the whole
/// section, and no tension.
#[test]
fn plain_concrete_bears_the_moment_of_its_block() {
    for thickness in [0.3, 1.2] {
        let section = SectionCapacity::new(thickness, PLAIN).unwrap();
        let most = PLAIN.concrete_strength * thickness;
        for share in [0.01, 0.2, 0.5, 0.79, 0.95, 0.999] {
            let force = share * most;
            let exact = 0.5 * force * (thickness - force / PLAIN.concrete_strength);
            let [least, greatest] = section.moments(-force).unwrap();
            assert!(
                (greatest - exact).abs() < 1e-9 * most * thickness,
                "{share}: {greatest:e} {exact:e}"
            );
            assert_eq!(least, -greatest);
            assert!((section.utilisation(-force, 0.5 * exact) - 0.5).abs() < 1e-6);
        }
        assert_eq!(section.moments(1.0), None);
        assert_eq!(section.moments(-1.000_001 * most), None);
        assert_eq!(section.utilisation(1.0, 0.0), f64::INFINITY);
    }
}

/// Pure tension is that of all bars, pure compression that of the concrete and of bars at 1.75 per mille, and without normal
/// force the moment is that of bars that yield against the block.
#[test]
fn special_points_are_those_of_statics() {
    let (h, area) = (0.5, 1.5e-3);
    let section = SectionCapacity::new(h, reinforced([area; 2])).unwrap();
    let [least, greatest] = section.axial_range();
    assert!((greatest - 2.0 * area * 435.0e6).abs() < 1e-9 * greatest);
    let pressed = 20.0e6 * h + 2.0 * area * 350.0e6;
    assert!(
        (least + pressed).abs() < 1e-6 * pressed,
        "{least:e} {pressed:e}"
    );
    // Strains turn about the middle until the bars at the compressed face yield: without change of the normal force.
    let turned = area * (435.0e6 - (2.0 * 350.0e6 - 435.0e6)) * (0.5 * h - 0.05);
    for (force, moment) in [(least, turned), (greatest, 0.0)] {
        let [low, high] = section.moments(force).unwrap();
        let error = (high - moment).abs().max((low + moment).abs());
        assert!(error < 1e-5 * pressed * h, "{low:e} {high:e}");
    }
    assert!((section.utilisation(2.0 * greatest, 0.0) - 2.0).abs() < 1e-12);
    assert!((section.utilisation(1.5 * least, 1.0) - 1.5).abs() < 1e-12);
    // Bars at the tension face alone: As fy (d - As fy / 2 f).
    let single = SectionCapacity::new(h, reinforced([0.0, area])).unwrap();
    let pull = area * 435.0e6;
    let exact = pull * (h - 0.05 - 0.5 * pull / 20.0e6);
    let [low, high] = single.moments(0.0).unwrap();
    assert!((high - exact).abs() < 1e-8 * exact, "{high:e} {exact:e}");
    // Turned round, these bars are at the compressed face, and the concrete alone bears no moment without force but what
    // bars hold off by their own.
    assert!(low.abs() < 0.1 * exact, "{low:e}");
}

/// With the neutral axis at a depth where the far bars just yield and the near ones too, all forces are closed forms.
#[test]
fn the_balanced_point_is_the_closed_form() {
    let (h, area, cover) = (0.6, 2.0e-3, 0.06);
    let section = SectionCapacity::new(
        h,
        SectionReinforcement {
            cover,
            ..reinforced([area; 2])
        },
    )
    .unwrap();
    let d = h - cover;
    let depth = d * 3.5e-3 / (3.5e-3 + 435.0e6 / 2.0e11);
    let near = 3.5e-3 * (depth - cover) / depth;
    assert!(near > 435.0e6 / 2.0e11);
    let force = 20.0e6 * 0.8 * depth;
    let exact = force * (0.5 * h - 0.4 * depth) + 2.0 * area * 435.0e6 * (0.5 * h - cover);
    let [_, greatest] = section.moments(-force).unwrap();
    assert!(
        (greatest - exact).abs() < 1e-9 * exact,
        "{greatest:e} {exact:e}"
    );
}

/// The interaction diagram is closed, convex to its rounding, and mirrored where the faces change places.
#[test]
fn diagrams_are_convex_and_mirrored() {
    let bars = [0.8e-3, 2.5e-3];
    let section = SectionCapacity::new(0.4, reinforced(bars)).unwrap();
    let turned = SectionCapacity::new(0.4, reinforced([bars[1], bars[0]])).unwrap();
    let line = section.interaction(60);
    assert_eq!(line.len(), 121);
    assert_eq!(line.first(), line.last());
    for [axial, moment] in &line {
        let [least, greatest] = turned.moments(*axial).unwrap();
        let nearest = (moment + least).abs().min((moment + greatest).abs());
        assert!(
            nearest < 1e-6 * 1e6,
            "{axial:e} {moment:e} {least:e} {greatest:e}"
        );
    }
    let scale = 8.0e6 * 1.0e6;
    for corner in line.windows(3) {
        let [a, b, c] = [corner[0], corner[1], corner[2]];
        let turn = (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
        assert!(turn < 1e-4 * scale, "{turn:e}");
    }
}

/// Parameters outside their ranges are refused by name.
#[test]
fn bad_reinforcement_is_refused() {
    let refused = |thickness: f64, reinforcement| {
        let error: ParameterError = SectionCapacity::new(thickness, reinforcement).unwrap_err();
        error.to_string()
    };
    assert!(refused(0.0, PLAIN).contains("thickness"));
    assert!(refused(f64::NAN, PLAIN).contains("thickness"));
    for (name, bad) in [
        (
            "cover",
            SectionReinforcement {
                cover: 0.3,
                ..PLAIN
            },
        ),
        (
            "bars",
            SectionReinforcement {
                bars: [-1e-3, 0.0],
                ..PLAIN
            },
        ),
        (
            "bars",
            SectionReinforcement {
                bars: [0.0, 0.6],
                ..PLAIN
            },
        ),
        (
            "yield_stress",
            SectionReinforcement {
                yield_stress: -1.0,
                ..PLAIN
            },
        ),
        (
            "concrete_strength",
            SectionReinforcement {
                concrete_strength: 0.0,
                ..PLAIN
            },
        ),
    ] {
        assert!(refused(0.5, bad).contains(name), "{name}");
    }
}
