//! Input conventions: each reproduces the motion that the record represents.

use crate::support::{SURFACE, motion, parameters};
use powerhouse_model::{IncidentField, Vec3};
use powerhouse_wavefield::{
    InputConvention, PlaneWave, Ricker, RickerQuantity, Signal, Site, SurfaceComponent, WaveError,
    WaveKind,
};
use std::sync::Arc;

fn ricker() -> Arc<dyn Signal> {
    Arc::new(Ricker::new(RickerQuantity::Displacement, 1e-3, 3.0, 0.8).unwrap())
}

fn wave(kind: WaveKind, degrees: f64, convention: InputConvention) -> Result<PlaneWave, WaveError> {
    let mut parameters = parameters(kind, 0.27, degrees, 0.0);
    parameters.convention = convention;
    PlaneWave::new(parameters, ricker())
}

/// Largest difference between a component of the motion at a point and the record, shifted by a
/// time, over the record's peak.
fn misfit(field: &dyn IncidentField, point: Vec3, component: usize, shift: f64) -> f64 {
    let times = (-20..60).map(|i| 0.04 * i as f64);
    let differences = times.map(|time| {
        let found = motion(field, point, time + shift).displacement[component];
        (found - ricker().motion(time).displacement).abs()
    });
    differences.fold(0.0, f64::max) / 1e-3
}

/// The point of the surface that the incident wave reaches at a time, above the reference point.
fn above_reference(field: &PlaneWave) -> (Vec3, f64) {
    let parameters = field.parameters();
    let point = Vec3::new(parameters.reference.x, parameters.reference.y, SURFACE);
    let speed = parameters.kind.speed(&parameters.medium);
    let rise = (SURFACE - parameters.reference.z) * parameters.incidence.radians().cos();
    (point, rise / speed)
}

/// An outcrop record is twice the incident wave, for every wave and angle.
#[test]
fn an_outcrop_is_twice_the_incident_wave() {
    for kind in [WaveKind::P, WaveKind::SV, WaveKind::SH] {
        for degrees in [0.0, 25.0, 60.0] {
            let outcrop = wave(kind, degrees, InputConvention::Outcrop).unwrap();
            let incident = wave(kind, degrees, InputConvention::Incident).unwrap();
            for time in [0.8, 0.9, 1.1] {
                let a = motion(&outcrop, Vec3::new(3.0, 4.0, -20.0), time);
                let b = motion(&incident, Vec3::new(3.0, 4.0, -20.0), time);
                let difference = a.displacement * 2.0 - b.displacement;
                assert!(difference.norm() < 1e-14 * b.displacement.norm().max(1e-6));
            }
        }
    }
}

/// The surface moves, in the component that the record represents, exactly as the record:
/// below the critical angle, and past it, where the incident wave is a phase-shifted record.
#[test]
fn a_surface_component_comes_back_at_the_surface() {
    use SurfaceComponent::{X, Y, Z};
    for (kind, degrees, component) in [
        (WaveKind::P, 20.0, Z),
        (WaveKind::P, 40.0, X),
        (WaveKind::SV, 0.0, X),
        (WaveKind::SV, 30.0, X),
        (WaveKind::SV, 30.0, Z),
        (WaveKind::SV, 38.0, X),
        (WaveKind::SV, 60.0, Z),
        (WaveKind::SH, 50.0, Y),
    ] {
        let convention = InputConvention::SurfaceComponent(component);
        let field = wave(kind, degrees, convention).unwrap();
        let (point, delay) = above_reference(&field);
        let found = misfit(&field, point, component as usize, delay);
        // Delays agree to rounding; tables past the critical angle to 1e-7.
        assert!(found < 1e-6, "{kind} {degrees} {component:?} {found:e}");
    }
}

/// A component with a small surface coefficient is refused, and the error states the coefficient.
#[test]
fn weak_components_are_refused() {
    use SurfaceComponent::{X, Y, Z};
    for (kind, degrees, component) in [
        (WaveKind::P, 2.0, X),
        (WaveKind::SV, 2.0, Z),
        (WaveKind::SV, 45.0, X),
        (WaveKind::SV, 20.0, Y),
        (WaveKind::SH, 20.0, X),
    ] {
        let refused = wave(kind, degrees, InputConvention::SurfaceComponent(component));
        match refused.unwrap_err() {
            WaveError::WeakComponent { coefficient, .. } => assert!(coefficient < 0.2),
            other => panic!("{other}"),
        }
    }
}

/// A record from a depth comes back at that depth, within the misfit that is reported; and the
/// misfit falls with the regularisation.
#[test]
fn a_record_from_a_depth_comes_back_there() {
    use SurfaceComponent::{X, Z};
    for (kind, degrees, component) in [
        (WaveKind::SV, 0.0, X),
        (WaveKind::SV, 20.0, X),
        (WaveKind::P, 30.0, Z),
        (WaveKind::SV, 60.0, Z),
    ] {
        let depth = 40.0;
        let mut before = f64::INFINITY;
        for regularisation in [0.2, 0.02] {
            let field = wave(
                kind,
                degrees,
                InputConvention::Within {
                    depth,
                    component,
                    regularisation: Some(regularisation),
                },
            )
            .unwrap();
            let report = field.conversion().within.unwrap();
            let (surface, delay) = above_reference(&field);
            let (cosine, speed) = (
                field.parameters().incidence.radians().cos(),
                kind.speed(&field.parameters().medium),
            );
            let point = surface - Vec3::z() * depth;
            let found = misfit(
                &field,
                point,
                component as usize,
                delay - depth * cosine / speed,
            );
            // The one is a largest difference, the other a root mean square; the pulse's own peak
            // is less than four times its own root mean square.
            assert!(
                found < 4.0 * report.misfit + 1e-3,
                "{kind} {degrees}: {found} {report:?}"
            );
            assert!(report.misfit < before);
            before = report.misfit;
        }
        assert!(before < 0.05, "{before}");
    }
}

/// A depth of zero and a regularisation of zero are refused by name; in a full space the convention is
/// refused, since it has no surface.
#[test]
fn impossible_conventions_are_refused() {
    let within = |depth, regularisation| {
        let convention = InputConvention::Within {
            depth,
            component: SurfaceComponent::X,
            regularisation: Some(regularisation),
        };
        wave(WaveKind::SV, 20.0, convention)
            .unwrap_err()
            .to_string()
    };
    assert!(within(0.0, 0.1).contains("depth"));
    assert!(within(10.0, 0.0).contains("regularisation"));
    let mut parameters = parameters(WaveKind::SV, 0.27, 20.0, 0.0);
    parameters.site = Site::FullSpace;
    for convention in [
        InputConvention::Outcrop,
        InputConvention::SurfaceComponent(SurfaceComponent::X),
    ] {
        parameters.convention = convention;
        let refused = PlaneWave::new(parameters, ricker());
        assert!(matches!(refused, Err(WaveError::NoSurface { .. })));
    }
}
