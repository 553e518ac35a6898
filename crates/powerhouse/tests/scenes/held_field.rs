//! Warnings about rollers, slices and periodic ends that the free field does not agree with.

use std::sync::Arc;

use powerhouse::boundary::ViscousSpring;
use powerhouse::engine::{PeriodicPairs, Support};
use powerhouse::material::LinearElastic;
use powerhouse::model::{Mesh, Vec3};
use powerhouse::wavefield::{
    Angle, PlaneWave, PlaneWaveParameters, SmoothPulse, WaveKind, first_hit_corner,
};
use powerhouse::{Boundary, Material, Part, Remark, Scene, remark};

use super::support::*;

/// Ends of a body along a tunnel.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ends {
    Rollers,
    Periodic,
}

/// Body of ground between two ends, the axis from the one to the other turned from y by an angle (degrees).
#[derive(Clone, Copy, Debug)]
struct Ground {
    length: f64,
    layers: usize,
    turn: f64,
    ends: Ends,
}

impl Ground {
    fn axis(&self) -> Vec3 {
        let (sin, cos) = self.turn.to_radians().sin_cos();
        Vec3::new(-sin, cos, 0.0)
    }

    /// The body under waves of a kind, an angle of incidence, and an azimuth (degrees) that is measured from the
    /// direction across the axis.
    fn scene(&self, waves: &[(WaveKind, f64, f64)]) -> Scene {
        let (low, high) = (
            Vec3::new(0.0, 0.0, -240.0),
            Vec3::new(300.0, self.length, 0.0),
        );
        let mesh = Mesh::box_of_hexes(low, high, [6, self.layers, 5], "rock").unwrap();
        let axis = self.axis();
        let across = Vec3::new(axis.y, -axis.x, 0.0);
        let mesh = mesh
            .map_positions(|p| p.x * across + p.y * axis + p.z * Vec3::z())
            .unwrap();
        let (low, high) = mesh.bounding_box();
        let wave = |&(kind, incidence, azimuth): &(WaveKind, f64, f64)| {
            let mut parameters = PlaneWaveParameters::vertical(kind, ROCK, 0.0);
            parameters.incidence = Angle::from_degrees(incidence);
            parameters.azimuth = Angle::from_degrees(azimuth + self.turn);
            parameters.reference = first_hit_corner(&low, &high, &parameters.direction());
            let pulse = Arc::new(SmoothPulse::new(0.01, 0.4).unwrap());
            PlaneWave::new(parameters, pulse).unwrap()
        };
        let nodes = |face: &str| mesh.nodes_of_facets(mesh.facet_set(face).unwrap());
        let (front, back) = (nodes("front"), nodes("back"));
        let pairs = PeriodicPairs::by_translation(&mesh, &front, &back, 1e-6).unwrap();
        let scene = Scene::new("ground", mesh)
            .part(Part::new("rock", Material::from(LinearElastic::new(ROCK))))
            .with_plane_waves(waves.iter().map(wave).collect())
            .unwrap()
            .with_boundary(Boundary::new(
                ViscousSpring::default(),
                ["left", "right", "bottom"],
            ))
            .with_duration(1.2);
        match self.ends {
            Ends::Rollers => [front, back].into_iter().fold(scene, |scene, end| {
                scene.support(Support::roller(end, 2.0 * axis))
            }),
            Ends::Periodic => scene.with_periodic_pairs(pairs),
        }
    }

    fn warnings(&self, waves: &[(WaveKind, f64, f64)]) -> Vec<Remark> {
        self.warnings_of(self.scene(waves))
    }

    fn warnings_of(&self, scene: Scene) -> Vec<Remark> {
        let simulation = scene.prepare().unwrap();
        let remarks = simulation.remarks().iter();
        let warnings = remarks.filter(|remark| remark.is_warning());
        warnings.cloned().collect()
    }
}

/// Bodies of several lengths, one of them a slice, along several axes.
fn bodies(ends: Ends) -> impl Iterator<Item = Ground> {
    let shapes = [(5.0, 1), (50.0, 1), (180.0, 3), (400.0, 6)];
    shapes.into_iter().flat_map(move |(length, layers)| {
        [0.0, 37.0, -110.0].map(move |turn| Ground {
            length,
            layers,
            turn,
            ends,
        })
    })
}

/// Waves that travel across the axis agree with rollers at the ends, but for SH waves, which move the ground along it;
/// they all agree with periodic ends. So do vertical waves.
#[test]
fn waves_across_the_axis_agree_with_the_ends() {
    use WaveKind::{P, SH, SV};
    for ends in [Ends::Rollers, Ends::Periodic] {
        for body in bodies(ends) {
            for (kind, azimuth) in [(P, 0.0), (P, 180.0), (SV, 0.0), (SV, 180.0)] {
                let found = body.warnings(&[(kind, 25.0, azimuth)]);
                assert_eq!(found, [], "{body:?} {kind} {azimuth}");
            }
            for (kind, azimuth) in [(P, 55.0), (SV, 0.0), (SH, 90.0)] {
                let found = body.warnings(&[(kind, 0.0, azimuth)]);
                assert_eq!(found, [], "{body:?} vertical {kind}");
            }
            let along = body.warnings(&[(SH, 25.0, 0.0)]);
            match ends {
                Ends::Periodic => assert_eq!(along, [], "{body:?}"),
                Ends::Rollers => assert!(
                    matches!(along[..], [Remark::RestrainedField(remark::RestrainedField { share, .. })] if share > 0.9),
                    "{body:?} {along:?}"
                ),
            }
        }
    }
}

/// An SH wave along the axis moves the ground across it: the rollers do not restrain it, but its shear traction on them,
/// `sin(incidence)` of the wave stress, is missing. The warning states it with the apparent speed.
#[test]
fn shear_along_the_axis_is_missing_on_rollers() {
    for body in bodies(Ends::Rollers) {
        for (incidence, azimuth) in [(5.0, 90.0), (25.0, -90.0), (60.0, 90.0)] {
            let found = body.warnings(&[(WaveKind::SH, incidence, azimuth)]);
            let [Remark::AsymmetricField(remark::AsymmetricField { share, speed, .. })] = found[..]
            else {
                panic!("{body:?} {incidence}: {found:?}")
            };
            let sine = f64::sin(incidence.to_radians());
            assert!(
                (share / sine - 1.0).abs() < 0.03,
                "{body:?} {incidence}: {share}"
            );
            let apparent = ROCK.s_speed() / sine;
            assert!((speed.unwrap() / apparent - 1.0).abs() < 1e-9, "{speed:?}");
        }
        // Half a degree is less than 1 %.
        let found = body.warnings(&[(WaveKind::SH, 0.5, 90.0)]);
        assert_eq!(found, [], "{body:?}");
        // One wave among several is enough.
        let found = body.warnings(&[(WaveKind::SV, 10.0, 0.0), (WaveKind::SH, 20.0, 90.0)]);
        assert!(
            matches!(found[..], [Remark::AsymmetricField(_)]),
            "{body:?} {found:?}"
        );
    }
}

/// Waves of all kinds that travel along the axis, or obliquely to it, move the two nodes of a periodic pair at different
/// times. In a slice the difference is small, but not the strain along the pair, which its nodes cannot have.
#[test]
fn waves_along_the_axis_part_periodic_pairs() {
    for body in bodies(Ends::Periodic) {
        for kind in [WaveKind::P, WaveKind::SV, WaveKind::SH] {
            for azimuth in [90.0, -90.0, 60.0, 8.0] {
                let found = body.warnings(&[(kind, 25.0, azimuth)]);
                let [
                    Remark::PeriodicField(remark::PeriodicField {
                        share,
                        strain,
                        distance,
                        speed,
                        ..
                    }),
                ] = found[..]
                else {
                    panic!("{body:?} {kind} {azimuth}: {found:?}")
                };
                let what = format!("{body:?} {kind} {azimuth}: {share} {strain}");
                assert!((distance / body.length - 1.0).abs() < 1e-9, "{what}");
                let slowness = f64::sin(25.0_f64.to_radians())
                    * f64::sin(f64::to_radians(azimuth)).abs()
                    / kind.speed(&ROCK);
                assert!((speed.unwrap() * slowness - 1.0).abs() < 1e-6, "{what}");
                // The strain of a plane wave along a direction is its slowness times the velocity.
                let strained = slowness * ROCK.s_speed();
                assert!(strain < 1.05 * strained, "{what}");
                if body.layers == 1 {
                    assert!(strain > 0.8 * strained, "{what}");
                }
                if body.length < 10.0 && azimuth < 10.0 && azimuth > 0.0 {
                    assert!(share < 0.01, "{what}");
                }
            }
        }
        let nearly = body.warnings(&[(WaveKind::SV, 25.0, 0.1)]);
        assert_eq!(nearly, [], "{body:?}");
    }
}

/// With a domain reduction region the ends see the free field only where the region reaches them.
#[test]
fn ends_beyond_a_region_see_no_free_field() {
    for ends in [Ends::Rollers, Ends::Periodic] {
        let body = Ground {
            length: 360.0,
            layers: 6,
            turn: 20.0,
            ends,
        };
        let found = |from: f64, to: f64| {
            let scene = body.scene(&[(WaveKind::SH, 25.0, 90.0)]);
            let mesh = scene.mesh().clone();
            let is_inside = |&e: &u32| {
                let centre = mesh.centroid(e);
                let across = centre.dot(&Vec3::z().cross(&body.axis())).abs();
                let along = centre.dot(&body.axis());
                (100.0..200.0).contains(&across) && centre.z > -150.0 && (from..to).contains(&along)
            };
            let region = (0..mesh.element_count() as u32).filter(is_inside).collect();
            let boundary = scene.boundary().unwrap().clone().with_region(region);
            body.warnings_of(scene.with_boundary(boundary))
        };
        assert_eq!(found(60.0, 300.0), [], "{ends:?}");
        let through = found(0.0, 360.0);
        let is_found = match ends {
            Ends::Rollers => matches!(through[..], [Remark::AsymmetricField(_)]),
            Ends::Periodic => matches!(through[..], [Remark::PeriodicField(_)]),
        };
        assert!(is_found, "{ends:?} {through:?}");
    }
}

/// The texts say what is wrong, how much, and what to do.
#[test]
fn texts_about_the_ends_have_numbers() {
    let body = Ground {
        length: 180.0,
        layers: 3,
        turn: 0.0,
        ends: Ends::Periodic,
    };
    let [found] = &body.warnings(&[(WaveKind::SV, 30.0, 90.0)])[..] else {
        panic!("one warning")
    };
    let speed = ROCK.s_speed() / 0.5;
    let text = found.to_string();
    for part in [
        "180.000 m apart",
        "% of its largest velocity",
        &format!("an apparent speed of {speed:.0} m/s"),
        "`azimuth`",
    ] {
        assert!(text.contains(part), "{text}");
    }
    let body = Ground {
        ends: Ends::Rollers,
        ..body
    };
    let [found] = &body.warnings(&[(WaveKind::SH, 30.0, 90.0)])[..] else {
        panic!("one warning")
    };
    let text = found.to_string();
    assert!(text.contains("% of the wave stress"), "{text}");
    assert!(text.contains("plane of symmetry"), "{text}");
}
