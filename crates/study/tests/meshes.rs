//! Meshes of ground around round openings.

use core::f64::consts::PI;

use powerhouse::model::{Facet, Mesh};
use powerhouse_study::{OpeningSlice, ShellOctant};

fn volume(mesh: &Mesh) -> f64 {
    // By the divergence theorem: the outer normal against the position, over the whole surface.
    let flux = |facet: &Facet| {
        let geometry = mesh.facet_geometry(*facet);
        let places = geometry.nodes.iter().map(|n| mesh.positions()[*n as usize]);
        let middle = places.sum::<powerhouse::model::Vec3>() / geometry.nodes.len() as f64;
        geometry.normal().dot(&middle) * geometry.area()
    };
    mesh.boundary_facets().iter().map(flux).sum::<f64>() / 3.0
}

fn area(mesh: &Mesh, set: &str) -> f64 {
    let facets = mesh.facet_set(set).unwrap();
    facets.iter().map(|f| mesh.facet_geometry(*f).area()).sum()
}

const SHALLOW: OpeningSlice = OpeningSlice {
    radius: 2.0,
    depth: 3.0,
    half_width: 20.0,
    height: 15.0,
    fine: 0.25,
    coarse: [1.5, 1.0],
    growth: 1.1,
};

/// Meshes of shallow and deep openings are valid: every surface facet belongs to one set, the volume is that of the box
/// less the polygon in the circle, and elements have the given lengths.
#[test]
fn slices_fill_the_ground_around_their_opening() {
    for (depth, height) in [
        (2.2, 12.0),
        (3.0, 15.0),
        (5.0, 15.0),
        (5.001, 15.0),
        (9.3, 22.0),
    ] {
        let slice = OpeningSlice {
            depth,
            height,
            ..SHALLOW
        };
        let mesh = slice.mesh().unwrap();
        let quality = mesh.check_connected().unwrap();
        assert!(quality.least_scaled_jacobian > 0.6, "{depth} {quality:?}");

        let chords = mesh.facet_set("opening").unwrap().len() as f64;
        let polygon = 0.5 * chords * 4.0 * (2.0 * PI / chords).sin();
        let expected = (40.0 * height - polygon) * slice.fine;
        assert!((volume(&mesh) / expected - 1.0).abs() < 1e-12, "{depth}");

        let names = ["left", "right", "front", "back", "bottom", "top", "opening"];
        let named = names.map(|name| mesh.facet_set(name).unwrap().len());
        assert_eq!(named.iter().sum::<usize>(), mesh.boundary_facets().len());
        let sides = [
            ("left", height),
            ("right", height),
            ("top", 40.0),
            ("bottom", 40.0),
        ];
        for (side, length) in sides {
            let side = area(&mesh, side) / (length * slice.fine);
            assert!((side - 1.0).abs() < 1e-12, "{depth} {side}");
        }

        let on_surface = mesh.facet_set("top").unwrap().iter();
        let mut longest = 0.0_f64;
        for facet in on_surface {
            let length = mesh.facet_geometry(*facet).area() / slice.fine;
            longest = longest.max(length);
        }
        // Lengths are fitted to the box, by half a brick at most.
        assert!(
            longest < 1.05 * slice.coarse[0] && longest > 1.2,
            "{depth} {longest}"
        );
    }
}

/// Invalid dimensions are errors with the name of the field.
#[test]
fn invalid_slices_are_errors() {
    let wrong = [
        (
            OpeningSlice {
                depth: 2.0,
                ..SHALLOW
            },
            "depth",
        ),
        (
            OpeningSlice {
                half_width: 3.5,
                ..SHALLOW
            },
            "half_width",
        ),
        (
            OpeningSlice {
                height: 6.0,
                ..SHALLOW
            },
            "height",
        ),
        (
            OpeningSlice {
                fine: 1.5,
                ..SHALLOW
            },
            "fine",
        ),
        (
            OpeningSlice {
                coarse: [1.0, 0.1],
                ..SHALLOW
            },
            "coarse",
        ),
        (
            OpeningSlice {
                growth: f64::NAN,
                ..SHALLOW
            },
            "growth",
        ),
    ];
    for (slice, name) in wrong {
        let refused = slice.mesh().err().unwrap().to_string();
        assert!(refused.starts_with(name), "{refused}");
    }
    let thin = ShellOctant {
        inner: 2.0,
        outer: 2.0,
        around: 2,
        rings: 2,
    };
    assert!(thin.mesh().err().unwrap().to_string().starts_with("outer"));
    let empty = ShellOctant {
        inner: 2.0,
        outer: 4.0,
        around: 0,
        rings: 2,
    };
    assert!(
        empty
            .mesh()
            .err()
            .unwrap()
            .to_string()
            .starts_with("around")
    );
}

/// An eighth of a shell has the volume of an eighth of a shell, to second order in its bricks, and
/// the areas of its cuts and its wall.
#[test]
fn an_octant_fills_its_shell() {
    let of = |around: usize| {
        let octant = ShellOctant {
            inner: 10.0,
            outer: 30.0,
            around,
            rings: around,
        };
        octant.mesh().unwrap()
    };
    let errors = [6, 12].map(|around| {
        let mesh = of(around);
        assert!(mesh.check_connected().unwrap().least_scaled_jacobian > 0.8);
        let names = ["left", "front", "bottom", "wall", "outside"];
        let named = names.map(|name| mesh.facet_set(name).unwrap().len());
        assert_eq!(named.iter().sum::<usize>(), mesh.boundary_facets().len());
        let exact = |name: &str| match name {
            "wall" => 0.5 * PI * 100.0,
            "outside" => 0.5 * PI * 900.0,
            _ => 0.25 * PI * 800.0,
        };
        let areas = names.map(|name| (area(&mesh, name) / exact(name) - 1.0).abs());
        let volume = volume(&mesh) / (PI / 6.0 * 26_000.0) - 1.0;
        areas.into_iter().fold(volume.abs(), f64::max)
    });
    let slope = (errors[0] / errors[1]).log2();
    assert!(
        errors[1] < 0.01 && (slope - 2.0).abs() < 0.1,
        "{errors:?} {slope}"
    );
}
