//! Warnings of sections through bricks that are too coarse for bending moments.

use powerhouse::engine::SolidKernel;
use powerhouse::engine::observe::CrossSection;
use powerhouse::material::{LinearElastic, presets};
use powerhouse::model::{ElasticMedium, Mesh, Vec3};
use powerhouse::{BendingError, Material, OutputPlan, Part, Remark, Scene, remark};

const THICKNESS: f64 = 0.5;

fn concrete() -> ElasticMedium {
    ElasticMedium::new(30.0e9, 0.2, 2500.0).unwrap()
}

/// What the section in the middle of an elastic plate of bricks is warned of: bricks of a length, in layers across the
/// thickness, the plate turned about y by an angle (rad).
fn warned(kernel: SolidKernel, length: f64, layers: usize, angle: f64) -> Option<BendingError> {
    let elastic = Material::new(LinearElastic::new(concrete()));
    let plate = Plate {
        length,
        layers,
        angle,
    };
    let remarks = remarks(kernel, elastic, plate);
    remarks.into_iter().find_map(|remark| match remark {
        Remark::Bending(error) => Some(error),
        _ => None,
    })
}

/// Bricks of a length in layers across the thickness of a plate that is turned about y by an angle (rad).
struct Plate {
    length: f64,
    layers: usize,
    angle: f64,
}

/// Remarks about a plate of a material.
fn remarks(kernel: SolidKernel, material: Material, plate: Plate) -> Vec<Remark> {
    let Plate {
        length,
        layers,
        angle,
    } = plate;
    let size = Vec3::new(9.0 * length, 2.0, THICKNESS);
    let plate = Mesh::box_of_hexes(Vec3::zeros(), size, [9, 2, layers], "lining").unwrap();
    let (sin, cos) = angle.sin_cos();
    let turned = |p: Vec3| Vec3::new(cos * p.x - sin * p.z, p.y, sin * p.x + cos * p.z);
    let mesh = plate.map_positions(turned).unwrap();
    let cut = CrossSection {
        name: "crown".into(),
        point: turned(Vec3::new(4.5 * length, 1.0, 0.5 * THICKNESS)),
        normal: turned(Vec3::x()),
        along: Vec3::y(),
        within: None,
    };
    let mut part = Part::new("lining", material);
    part.kernel = Some(kernel.into());
    let scene = Scene::new("plate", mesh)
        .part(part)
        .with_duration(0.001)
        .with_output(OutputPlan::default().cut("lining", cut));
    let simulation = scene.prepare().unwrap();
    simulation.remarks().to_vec()
}

/// Few bricks of one point with elastic bending across a section that may crack are warned of; more of them, those of eight
/// points, and elastic ones are not.
#[test]
fn few_bricks_that_form_no_hinge_are_warned_of() {
    let cracks = || Material::from(presets::eurocode_concrete(30.0).unwrap());
    let elastic = || Material::new(LinearElastic::new(concrete()));
    let hinge = |kernel, material, layers| {
        let plate = Plate {
            length: THICKNESS,
            layers,
            angle: 0.3,
        };
        let remarks = remarks(kernel, material, plate);
        remarks.into_iter().find_map(|remark| match &remark {
            Remark::Hinge(remark::Hinge { layers, .. }) => {
                Some((*layers, remark.is_warning(), remark.to_string()))
            }
            _ => None,
        })
    };
    for layers in [1, 3] {
        let (found, is_warning, text) = hinge(SolidKernel::Hex8Natural, cracks(), layers).unwrap();
        assert_eq!((found, is_warning), (layers, true));
        assert!(
            text.contains("section 'crown' cuts 'lining'") && text.contains("hex8-eas"),
            "{text}"
        );
    }
    assert_eq!(hinge(SolidKernel::Hex8Natural, cracks(), 4), None);
    assert_eq!(hinge(SolidKernel::Hex8Eas, cracks(), 1), None);
    assert_eq!(hinge(SolidKernel::Hex8Natural, elastic(), 1), None);
}

/// Fully integrated bricks have `1 + G / (lambda + 2 G) (L/t)^2` times the bending stiffness, however many there are
/// across; long ones are warned of, short ones are not.
#[test]
fn long_bricks_of_full_integration_are_warned_of() {
    let medium = concrete();
    for (ratio, layers, angle) in [(2.6, 1, 0.0), (1.0, 1, 0.7), (1.0, 3, -1.2), (2.0, 2, 2.0)] {
        let exact = 1.0 + medium.shear() / medium.constrained() * ratio * ratio;
        let found = warned(SolidKernel::Hex8Full, ratio * THICKNESS, layers, angle).unwrap();
        assert_eq!(found.layers, layers);
        assert!((found.factor / exact - 1.0).abs() < 1e-9, "{found:?}");
        let text = found.to_string();
        assert!(
            text.contains("too stiff in bending") && text.contains("0.225 m long"),
            "{text}"
        );
    }
    assert_eq!(warned(SolidKernel::Hex8Full, 0.4 * THICKNESS, 1, 0.3), None);
    assert_eq!(
        warned(SolidKernel::Hex8BBar, 0.45 * THICKNESS, 2, 0.0),
        None
    );
    assert!(warned(SolidKernel::Hex8BBar, THICKNESS, 2, 0.0).is_some());
    assert!(warned(SolidKernel::Hex8BBar, 0.3 * THICKNESS, 1, 0.0).is_some());
}

/// Bricks of one integration point have `1 - 1/n^2` of the bending stiffness with `n` across, and that of their hourglass
/// resistance, a twentieth of `(lambda + 2 G) sum 1/h_i^2`, which grows with the square of their length: they are warned
/// of where few are across, and where they are long.
#[test]
fn few_or_long_bricks_of_one_point_are_warned_of() {
    let kernel = || SolidKernel::Hex8OnePoint(Default::default());
    for (ratio, layers) in [(2.6, 1), (0.5, 1), (0.6, 2), (2.0, 4), (1.2, 6)] {
        let found = warned(kernel(), ratio * THICKNESS, layers, 0.4).unwrap();
        let height = THICKNESS / layers as f64;
        let sides = [ratio * THICKNESS, 1.0, height];
        let squares: f64 = sides.iter().map(|side| (height / side).powi(2)).sum();
        let hourglass = 0.15 * ratio * ratio * squares;
        let exact = 1.0 - 1.0 / (layers * layers) as f64 + hourglass;
        assert!(
            (found.factor / exact - 1.0).abs() < 1e-9,
            "{found:?} {exact}"
        );
        let verb = if exact > 1.0 { "too stiff" } else { "too soft" };
        assert!(found.to_string().contains(verb), "{found}");
    }
    for (ratio, layers) in [(0.3, 4), (0.7, 4), (0.7, 8)] {
        assert_eq!(warned(kernel(), ratio * THICKNESS, layers, 0.0), None);
    }
}
