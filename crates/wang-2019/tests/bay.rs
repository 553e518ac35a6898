//! The mesh of a machine bay: numbers of elements, quality, positions, sets.

use std::collections::HashSet;
use std::path::PathBuf;

use powerhouse::engine::PeriodicPairs;
use powerhouse::io::{read_gmsh, write_gmsh};
use powerhouse::model::Vec3;
use powerhouse_test_support::TestFolder;
use powerhouse_wang_2019::BayError;
use powerhouse_wang_2019::bay::{
    BAY_BOLT_ROWS, BAY_BOLTS, Bay, BayDimensions, BayMesh, BayPart, BaySize, RockEnds,
};

fn mesh(size: BaySize) -> BayMesh {
    Bay::of_size(size).mesh().unwrap()
}

/// A folder that goes with the test.
struct Folder(TestFolder);

impl Folder {
    fn new(name: &str) -> Self {
        Self(TestFolder::new(name))
    }
    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }
}

/// The paper size has the counts of Wang, Chen & Xiao (2019), section 4.2, within 5 %: all cells of
/// the file, and nodes with those that the joint doubles; no edge is longer than their 5 m, no
/// scaled Jacobian below 0.4.
#[test]
fn the_paper_size_has_the_counts_of_the_paper() {
    let report = mesh(BaySize::Paper).report;
    let close = |found: usize, paper: f64| (found as f64 / paper - 1.0).abs() < 0.05;
    assert!(close(report.elements(), 134_232.0), "{report}");
    assert!(close(report.concrete(), 7_378.0), "{report}");
    assert!(
        close(report.nodes + report.doubled_nodes, 142_745.0),
        "{report}"
    );
    assert!(report.edges[1] <= 5.0, "{report}");
    assert!(report.scaled_jacobian[0] >= 0.4, "{report}");
}

/// The coarse and medium meshes have about 16,000 and 50,000 elements of good quality.
#[test]
fn the_smaller_meshes_have_the_documented_sizes() {
    for (size, elements) in [(BaySize::Coarse, 16_000.0), (BaySize::Medium, 50_000.0)] {
        let report = mesh(size).report;
        assert!((report.elements() as f64 / elements - 1.0).abs() < 0.05);
        assert!(report.scaled_jacobian[0] >= 0.4, "{report}");
    }
}

/// Every element belongs to one part; structure, lining and interior contain the right parts, and the excavation stages
/// contain each cell of the caverns once and no rock.
#[test]
fn parts_and_stages_cover_each_cell_once() {
    let bay = mesh(BaySize::Coarse);
    let set = |name: &str| bay.mesh.element_set(name).unwrap();
    let mut owners = vec![0; bay.mesh.element_count()];
    for part in BayPart::ALL {
        for &element in set(part.name()) {
            owners[element as usize] += 1;
        }
    }
    assert!(owners.iter().all(|&owners| owners == 1));
    let mut dug = vec![0; bay.mesh.element_count()];
    for stage in ["main_1", "main_2", "main_3", "main_4", "main_5"] {
        set(stage).iter().for_each(|&e| dug[e as usize] += 1);
    }
    for stage in ["transformer_1", "transformer_2", "transformer_3"] {
        set(stage).iter().for_each(|&e| dug[e as usize] += 1);
    }
    let rock: HashSet<u32> = set("rock").iter().copied().collect();
    for (element, times) in dug.into_iter().enumerate() {
        assert_eq!(times, i32::from(!rock.contains(&(element as u32))));
    }
    assert_eq!(
        set("structure").len(),
        set("lining").len() + set("interior").len()
    );
    assert_eq!(set("structure").len(), bay.report.concrete());
}

/// Volumes are those of the drawings: octagonal rings have 2 sqrt 2 (R^2 - r^2) a height, floors
/// their width less the ring, and under an arch of n chords a share of the segment that falls as
/// 1/n^2 is missing.
#[test]
fn volumes_are_those_of_the_drawings() {
    let octagon = |radius: f64| 2.0 * 2.0_f64.sqrt() * radius * radius;
    let (clear, length) = (21.0 - 2.0 * 0.8, 13.7);
    for size in BaySize::ALL {
        let report = mesh(size).report;
        let volume = |part: BayPart| report.volumes[&part];
        let ring = (octagon(5.0) - octagon(4.5)) * 5.5;
        assert!((volume(BayPart::Windshield) - ring).abs() < 1e-9 * ring);
        let pier = (octagon(5.0) - octagon(2.8)) * 4.5;
        assert!((volume(BayPart::Pier) - pier).abs() < 1e-9 * pier);
        let floor = (clear * length - octagon(5.0)) * 0.8;
        assert!((volume(BayPart::FloorGenerator) - floor).abs() < 1e-9 * floor);
        let mass = (clear * length - octagon(2.8)) * (188.4 - 181.6);
        assert!((volume(BayPart::Mass) - mass).abs() < 1e-9 * mass);
        for (found, round) in report
            .excavations()
            .into_iter()
            .zip(report.round_excavations)
        {
            assert!(found < round && found > 0.997 * round, "{found} {round}");
        }
    }
    // Halving the chords of the transformer's arch leaves a quarter of what is missing.
    let missing = |size| {
        let report = mesh(size).report;
        report.round_excavations[1] - report.excavations()[1]
    };
    let ratio = missing(BaySize::Coarse) / missing(BaySize::Paper);
    assert!((3.5..=4.5).contains(&ratio), "{ratio}");
}

/// The faces of the bay are translations of each other node by node, and the bay is symmetric about
/// its middle.
#[test]
fn both_faces_of_the_bay_have_one_grid() {
    let bay = mesh(BaySize::Coarse);
    let nodes = |face: &str| bay.mesh.nodes_of_facets(bay.mesh.facet_set(face).unwrap());
    let (front, back) = (nodes("front"), nodes("back"));
    let pairs = PeriodicPairs::by_translation(&bay.mesh, &front, &back, 1e-9).unwrap();
    assert_eq!(pairs.pairs.len(), 46 * 45);
    let rock = bay.mesh.facet_set("front_rock").unwrap().len();
    let caverns = bay.report.elements() - bay.report.elements_of("rock");
    assert_eq!(rock, 45 * 44 - caverns / 8);
    let on_front = |element: &&u32| {
        let nodes = bay.mesh.nodes_of(**element).iter();
        nodes
            .filter(|&&node| bay.mesh.positions()[node as usize].y == 0.0)
            .count()
            == 4
    };
    let structure = bay.mesh.element_set("structure").unwrap();
    let ends = bay.mesh.facet_set("front_structure").unwrap().iter();
    let ends: Vec<u32> = ends.map(|facet| facet.element).collect();
    let expected: Vec<u32> = structure.iter().filter(on_front).copied().collect();
    assert!(!ends.is_empty());
    assert_eq!(ends, expected);
    let place = |p: &Vec3| [p.x, p.y, p.z].map(|x| (x * 1e6).round() as i64);
    let all: HashSet<[i64; 3]> = bay.mesh.positions().iter().map(place).collect();
    for position in bay.mesh.positions() {
        let mirrored = Vec3::new(position.x, 13.7 - position.y, position.z);
        assert!(all.contains(&place(&mirrored)), "{position}");
    }
}

/// The monitoring points lie on the inner face of the concrete at mid-bay, at most half a row from their intended
/// positions.
#[test]
fn monitoring_points_lie_on_the_inner_face() {
    for size in BaySize::ALL {
        let bay = mesh(size);
        let of = |name: &str| bay.report.points.iter().find(|p| p.name == name).unwrap();
        let concrete = bay
            .mesh
            .nodes_of_elements(bay.mesh.element_set("structure").unwrap());
        let rock = bay
            .mesh
            .nodes_of_elements(bay.mesh.element_set("rock").unwrap());
        for (name, x, z) in [
            ("A", 0.0, -151.0),
            ("B", -9.7, -162.93),
            ("C", 9.7, -162.93),
            ("D", 54.05, -151.0),
            ("E", 46.3, -165.19),
            ("F", 61.8, -165.19),
            ("O1", 0.0, -188.4),
            ("O2", 54.05, -176.1),
        ] {
            let point = of(name);
            let away = point.position - Vec3::new(x, 6.85, z);
            assert!(away.xy().norm() < 1e-9, "{name}: {away}");
            assert!(away.z.abs() < 1.7, "{name}: {away}");
            let node = bay.mesh.node_set(&format!("point_{name}")).unwrap()[0];
            assert!(concrete.binary_search(&node).is_ok());
            assert!(rock.binary_search(&node).is_err());
        }
    }
}

/// The joint is all that rock and structure share: by part as large as the drawings say, arcs as
/// their chords.
#[test]
fn the_joint_is_the_whole_of_the_lining() {
    let bay = mesh(BaySize::Paper);
    let area = |set: &str| -> f64 {
        let facets = bay.mesh.facet_set(set).unwrap().iter();
        facets
            .map(|&facet| bay.mesh.facet_geometry(facet).area())
            .sum()
    };
    assert!((area("joint_base_main") - 19.4 * 13.7).abs() < 1e-6);
    assert!((area("joint_floor_transformer") - 15.5 * 13.7).abs() < 1e-6);
    let parts = [
        "arch_main",
        "wall_main",
        "base_main",
        "arch_transformer",
        "wall_transformer",
    ];
    let parts = parts.into_iter().chain(["floor_transformer"]);
    let sum: f64 = parts.map(|part| area(&format!("joint_{part}"))).sum();
    assert!((sum - bay.report.joint_area).abs() < 1e-6);
    // Arc of the main arch: 2 R asin(b / 2R) with R = 13.125 m.
    let arc = 2.0 * 13.125 * (10.5_f64 / 13.125).asin() * 13.7;
    let chords = area("roof_main");
    assert!(chords < arc && chords > 0.995 * arc, "{chords} {arc}");
    assert!((area("walls_main") - 2.0 * (39.4 - 5.25) * 13.7).abs() < 1e-6);
    for bolts in BAY_BOLTS {
        assert!(bay.mesh.facet_set(bolts.facets).is_ok());
    }
    assert_eq!(BAY_BOLT_ROWS, 9);
}

/// A parameter outside its range is an error with its name, value and range; so are a main powerhouse too low for its
/// floors, an unknown key with its line, and a missing file.
#[test]
fn invalid_bays_are_errors_by_name() {
    let folder = Folder::new("bay-refused");
    let refused = |text: &str| Bay::from_file(folder.file("bay.toml", text)).unwrap_err();
    for (name, least, most) in BayDimensions::ranges() {
        for value in [least - 0.5, most + 0.5] {
            let error = refused(&format!("[dimensions]\n{name} = {value:?}\n"));
            let BayError::Parameter(found) = &error else {
                panic!("{error}");
            };
            assert_eq!((found.name, found.value), (name, value));
        }
    }
    let low = refused("[dimensions]\nmain_height = 36.0\ntransformer_height = 29.0\n");
    assert!(low.to_string().contains("main_height = 36"), "{low}");
    let unknown = refused("size = \"paper\"\n[dimensions]\ncovr = 150\n");
    assert!(unknown.to_string().contains("line 3"), "{unknown}");
    assert!(unknown.to_string().contains("covr"), "{unknown}");
    let ends = refused("[ends]\nrock = 5\ncells = 3\n");
    assert!(ends.to_string().contains("rock = 5"), "{ends}");
    let lost = Bay::from_file(folder.0.join("lost.toml")).unwrap_err();
    assert!(matches!(lost, BayError::Read { .. }), "{lost}");
}

/// A file sets the size, the dimensions and the rock beyond the ends of a bay.
#[test]
fn a_file_describes_a_bay() {
    let folder = Folder::new("bay-file");
    let text = "size = \"medium\"\n[dimensions]\ncover = 200\n[ends]\nrock = 60\ncells = 7\n";
    let bay = Bay::from_file(folder.file("bay.toml", text)).unwrap();
    assert_eq!(bay.cells, BaySize::Medium.cells());
    assert_eq!(bay.dimensions.cover, 200.0);
    assert_eq!(bay.dimensions.length, BayDimensions::default().length);
    assert_eq!(
        bay.ends,
        Some(RockEnds {
            rock: 60.0,
            cells: 7
        })
    );
    let least = bay
        .mesh()
        .unwrap()
        .report
        .points
        .iter()
        .map(|p| p.position.z)
        .fold(0.0, f64::min);
    assert!(least < -200.0);
}

/// In a block the structure is the same, rock lies beyond both ends, and the rim runs along them too.
#[test]
fn a_block_has_rock_beyond_both_ends() {
    let ends = RockEnds {
        rock: 60.0,
        cells: 7,
    };
    let bay = mesh(BaySize::Coarse);
    let block = Bay::of_size(BaySize::Coarse).in_block(ends).mesh().unwrap();
    assert_eq!(block.report.cells, [45, 22, 44]);
    assert_eq!(block.report.concrete(), bay.report.concrete());
    assert_eq!(block.report.points, bay.report.points);
    let (low, high) = block.mesh.bounding_box();
    assert_eq!((low.y, high.y), (-60.0, 73.7));
    let rim = |bay: &BayMesh| bay.mesh.element_set("rim").unwrap().len();
    let [nx, ny, nz] = block.report.cells;
    assert_eq!(rim(&block), nx * ny * nz - (nx - 2) * (ny - 2) * (nz - 1));
    assert_eq!(rim(&bay), 8 * (nx * nz - (nx - 2) * (nz - 1)));
    assert!(block.mesh.facet_set("joint_ends").is_ok());
    assert!(bay.mesh.facet_set("joint_ends").is_err());
    assert!(block.report.scaled_jacobian[0] >= 0.4);
}

/// Written for Gmsh and read again it is the same mesh, interior facets with both of their sides.
#[test]
fn gmsh_files_hold_the_bay() {
    let folder = Folder::new("bay-gmsh");
    let bay = mesh(BaySize::Coarse);
    let file = folder.0.join("bay.msh");
    write_gmsh(&file, &bay.mesh).unwrap();
    let read = read_gmsh(&file).unwrap().mesh;
    assert_eq!(read.positions(), bay.mesh.positions());
    assert_eq!(read.element_sets(), bay.mesh.element_sets());
    assert_eq!(read.node_sets(), bay.mesh.node_sets());
    for (name, facets) in bay.mesh.facet_sets() {
        let found = read.facet_set(name).unwrap();
        let of_end = name.starts_with("front_") || name.starts_with("back_");
        let inside = name.contains('_') && !of_end;
        assert_eq!(
            found.len(),
            facets.len() * (1 + usize::from(inside)),
            "{name}"
        );
        assert!(
            facets
                .iter()
                .all(|facet| found.binary_search(facet).is_ok())
        );
    }
}

/// Worst scaled Jacobian of bays with random dimensions within their ranges, and the number of valid bays.
fn worst_of_random_bays(count: usize, size: BaySize) -> (f64, usize) {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64;
    let mut uniform = || {
        // Marsaglia (2003), xorshift.
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let (mut worst, mut taken) = (f64::INFINITY, 0);
    while taken < count {
        let values = BayDimensions::ranges().map(|(_, low, high)| low + (high - low) * uniform());
        let dimensions = BayDimensions::of_values(values);
        if dimensions.check().is_err() {
            // A main powerhouse too low for its floors.
            continue;
        }
        let bay = Bay {
            dimensions,
            ..Bay::of_size(size)
        };
        let report = bay.mesh().unwrap().report;
        worst = worst.min(report.scaled_jacobian[0]);
        taken += 1;
    }
    (worst, taken)
}

/// Bays of any dimensions in their ranges have sound elements: scaled Jacobians of 0.2 at least.
#[test]
fn random_bays_are_sound() {
    let (worst, _) = worst_of_random_bays(40, BaySize::Coarse);
    assert!(worst >= 0.2, "{worst}");
}

/// The same for 1,000 of them, and 100 of the medium size: `cargo test --release --test wang-2019
/// bay -- --ignored --nocapture`.
#[test]
#[ignore = "a minute"]
fn a_thousand_random_bays_are_sound() {
    for (count, size) in [(1000, BaySize::Coarse), (100, BaySize::Medium)] {
        let (worst, taken) = worst_of_random_bays(count, size);
        println!(
            "{} bays of size {}: worst scaled Jacobian {worst:.4}",
            taken,
            size.name()
        );
        assert!(worst >= 0.2, "{worst}");
    }
}
