//! Meshes of valid files.

use powerhouse_io::{GmshMesh, parse_gmsh};
use powerhouse_model::Vec3;

use super::sample::{FORMATS, Format, Random, Sample};

fn read(bytes: &[u8]) -> GmshMesh {
    parse_gmsh(bytes).unwrap_or_else(|error| panic!("{error}"))
}

fn edited(format: Format, edit: impl Fn(&str) -> String) -> GmshMesh {
    let text = String::from_utf8(Sample::tower().file(format)).unwrap();
    let changed = edit(&text);
    assert_ne!(text, changed);
    read(changed.as_bytes())
}

/// Every format of the same content gives the same mesh: the one that was written.
#[test]
fn all_formats_give_the_same_mesh() {
    let sample = Sample::tower();
    let mesh = sample.mesh();
    for format in FORMATS {
        let gmsh = read(&sample.file(format));
        assert_eq!(gmsh.mesh, mesh, "{format:?}");
        assert_eq!(gmsh.report.nodes, 17, "{format:?}");
        assert_eq!(gmsh.report.dropped_nodes, 1, "{format:?}");
    }
    assert_eq!(mesh.element_set("rock mass").unwrap(), [1, 2]);
    assert_eq!(mesh.element_set("tête").unwrap(), [2, 3, 4]);
    assert_eq!(mesh.element_set("bolt").unwrap(), [0]);
    assert_eq!(mesh.facet_set("base").unwrap().len(), 1);
    // An interior side has two facets.
    assert_eq!(mesh.facet_set("physical_2_5").unwrap().len(), 2);
    assert_eq!(mesh.node_set("tip").unwrap().len(), 1);
}

/// An element of two groups is one element of both sets, though version 2.2 writes it twice.
#[test]
fn an_element_of_two_groups_counts_once() {
    for format in FORMATS {
        let gmsh = read(&Sample::tower().file(format));
        let two = matches!(format, Format::Text2 | Format::Binary2(_));
        assert_eq!(gmsh.mesh.element_count(), 5);
        assert_eq!(gmsh.report.merged_elements, usize::from(two), "{format:?}");
        assert_eq!(gmsh.report.elements, 8 + usize::from(two));
        let groups: Vec<_> = gmsh
            .report
            .groups
            .iter()
            .map(|g| (g.dimension, g.elements))
            .collect();
        assert_eq!(groups, [(0, 1), (1, 1), (2, 1), (2, 1), (3, 2), (3, 3)]);
    }
}

/// Dense node numbers out of order are preserved: each keeps its position.
#[test]
fn dense_node_numbers_out_of_order_keep_their_positions() {
    let mut sample = Sample::tower();
    let mut tags: Vec<u64> = (1..=sample.nodes.len() as u64).collect();
    Random(7).shuffle(&mut tags);
    let old: Vec<u64> = sample.nodes.iter().map(|node| node.0).collect();
    let new = |tag: u64| tags[old.iter().position(|other| *other == tag).unwrap()];
    sample
        .nodes
        .iter_mut()
        .for_each(|node| node.0 = new(node.0));
    for element in &mut sample.elements {
        element.nodes.iter_mut().for_each(|node| *node = new(*node));
    }
    let tower = Sample::tower().mesh();
    for format in FORMATS {
        let mesh = read(&sample.file(format)).mesh;
        assert_eq!(mesh.positions(), tower.positions(), "{format:?}");
        for element in 0..tower.element_count() as u32 {
            assert_eq!(
                mesh.nodes_of(element),
                tower.nodes_of(element),
                "{format:?}"
            );
        }
    }
}

/// Numbers near the largest that a format permits are read unchanged.
#[test]
fn huge_numbers_are_kept() {
    for format in FORMATS {
        let shift = match format {
            Format::Text2 | Format::Text4 => u64::MAX - 1000,
            Format::Binary4(_, 8) => u64::MAX - 1000,
            Format::Binary4(..) => u64::from(u32::MAX) - 1000,
            Format::Binary2(_) => i32::MAX as u64 - 1000,
        };
        let mut sample = Sample::tower();
        sample.nodes.iter_mut().for_each(|node| node.0 += shift);
        for element in &mut sample.elements {
            element.tag += shift;
            element.nodes.iter_mut().for_each(|node| *node += shift);
        }
        assert_eq!(read(&sample.file(format)).mesh, sample.mesh(), "{format:?}");
    }
}

/// Nodes that no element uses are dropped, wherever they are in the file, without a shift of others.
#[test]
fn unused_nodes_vanish_without_a_shift() {
    let tower = Sample::tower();
    let mut sample = tower.clone();
    for (place, tag) in [(0, 900), (6, 901), (12, 3), (20, 1_000_000)] {
        sample.nodes.insert(place, (tag, [place as f64, -1.0, 7.0]));
    }
    for format in FORMATS {
        let gmsh = read(&sample.file(format));
        assert_eq!(gmsh.mesh, tower.mesh(), "{format:?}");
        assert_eq!(gmsh.report.dropped_nodes, 5);
    }
}

/// Without physical groups the solids make the set `all`; what bounds them is dropped.
#[test]
fn solids_without_groups_are_all() {
    let mut sample = Sample::tower();
    sample.elements.iter_mut().for_each(|e| e.groups.clear());
    for format in FORMATS {
        let gmsh = read(&sample.file(format));
        assert_eq!(gmsh.mesh.element_count(), 4, "{format:?}");
        assert_eq!(gmsh.mesh.element_set("all").unwrap(), [0, 1, 2, 3]);
        assert_eq!(gmsh.mesh.element_sets().len(), 1);
        assert!(gmsh.mesh.facet_sets().is_empty() && gmsh.mesh.node_sets().is_empty());
        assert_eq!(gmsh.report.dropped_elements, 4);
        assert_eq!(gmsh.report.ungrouped_elements, 4);
    }
}

/// A mesh of lines alone is a mesh of bars.
#[test]
fn lines_alone_are_bars() {
    let mut sample = Sample::tower();
    sample.elements.retain(|e| e.dimension <= 1);
    sample.elements.iter_mut().for_each(|e| e.groups.clear());
    for format in FORMATS {
        let mesh = read(&sample.file(format)).mesh;
        assert_eq!(mesh.element_set("all").unwrap(), [0], "{format:?}");
        assert_eq!(mesh.node_tags(), [214, 300]);
    }
}

/// Solids of no group, where others have one, are kept in a set of their own.
#[test]
fn solids_beside_the_groups_are_not_lost() {
    let mut sample = Sample::tower();
    let last = sample.elements.last_mut().unwrap();
    last.groups.clear();
    last.entity = 4;
    for format in FORMATS {
        let gmsh = read(&sample.file(format));
        assert_eq!(
            gmsh.mesh.element_set("ungrouped").unwrap(),
            [4],
            "{format:?}"
        );
        assert_eq!(gmsh.report.ungrouped_elements, 1);
    }
}

/// A group without elements is reported and makes no set; an empty name counts as none.
#[test]
fn empty_groups_and_empty_names() {
    let mut sample = Sample::tower();
    sample.names.push((3, 77, "void".into()));
    sample.names[0].2.clear();
    for format in FORMATS {
        let gmsh = read(&sample.file(format));
        let void = gmsh.report.groups.iter().find(|group| group.name == "void");
        assert_eq!(void.map(|group| group.elements), Some(0), "{format:?}");
        assert!(gmsh.mesh.element_set("void").is_err());
        assert_eq!(gmsh.mesh.element_set("physical_3_1").unwrap(), [1, 2]);
    }
}

/// Two groups of the same name make one set.
#[test]
fn groups_of_one_name_make_one_set() {
    let mut sample = Sample::tower();
    sample.names[1].2 = "rock mass".into();
    for format in FORMATS {
        let mesh = read(&sample.file(format)).mesh;
        assert_eq!(
            mesh.element_set("rock mass").unwrap(),
            [1, 2, 3, 4],
            "{format:?}"
        );
    }
}

/// Names keep blanks, quotes and letters of any script.
#[test]
fn names_keep_every_letter() {
    for name in [
        "a b  c",
        "5\" pipe \"x\"",
        "岩盤",
        "Überzug é",
        " ",
        "$EndNodes",
        "#1;=\t",
    ] {
        let mut sample = Sample::tower();
        sample.names[0].2 = name.into();
        for format in FORMATS {
            let mesh = read(&sample.file(format)).mesh;
            assert_eq!(mesh.element_set(name).unwrap(), [1, 2], "{format:?}");
        }
    }
}

/// The sign of a group's number is an orientation and makes no other group.
#[test]
fn a_negative_group_is_the_same_group() {
    let mut sample = Sample::tower();
    sample.elements[2].groups = vec![-1];
    for format in FORMATS {
        assert_eq!(
            read(&sample.file(format)).mesh,
            Sample::tower().mesh(),
            "{format:?}"
        );
    }
}

/// Line ends of other systems, tabs, further blanks and empty lines mean nothing.
#[test]
fn blanks_mean_nothing() {
    let mesh = Sample::tower().mesh();
    for format in [Format::Text2, Format::Text4] {
        assert_eq!(edited(format, |t| t.replace('\n', "\r\n")).mesh, mesh);
        // In quotes a blank is part of the name.
        let names_apart = |t: &str, from: char, to: &str| {
            let lines = t.lines().map(|line| match line.split_once('"') {
                Some((before, name)) => format!("{}\"{name}\n", before.replace(from, to)),
                None => line.replace(from, to) + "\n",
            });
            lines.collect::<String>()
        };
        assert_eq!(edited(format, |t| names_apart(t, ' ', "\t")).mesh, mesh);
        assert_eq!(edited(format, |t| names_apart(t, ' ', "   ")).mesh, mesh);
        assert_eq!(edited(format, |t| t.replace('\n', "\n\n \t\n")).mesh, mesh);
        assert_eq!(edited(format, |t| t.trim_end().into()).mesh, mesh);
        assert_eq!(edited(format, |t| format!("\n  {t}")).mesh, mesh);
        assert_eq!(edited(format, |t| t.replace("\n$", "\n  $")).mesh, mesh);
    }
}

/// Sections without a meaning are skipped and reported, in text and in binary files.
#[test]
fn other_sections_are_skipped() {
    let mesh = Sample::tower().mesh();
    let periodic = b"$Periodic\n1\n2 1 2\n\0\xff $Nodes\n$EndPeriodic\n";
    let comments = b"$Comments\nmade by hand $ 5\n$EndComments\n";
    for format in FORMATS {
        let file = Sample::tower().file(format);
        let marker = b"$PhysicalNames";
        let at = file
            .windows(marker.len())
            .position(|window| window == marker)
            .unwrap();
        let mut longer = file[..at].to_vec();
        longer.extend_from_slice(comments);
        longer.extend_from_slice(&file[at..]);
        longer.extend_from_slice(periodic);
        let gmsh = read(&longer);
        assert_eq!(gmsh.mesh, mesh, "{format:?}");
        assert_eq!(gmsh.report.skipped_sections, ["$Comments", "$Periodic"]);
    }
}

/// After the header, sections may be in any order.
#[test]
fn sections_may_be_in_any_order() {
    let mesh = Sample::tower().mesh();
    for format in [Format::Text2, Format::Text4] {
        let gmsh = edited(format, |text| {
            let (head, rest) = text.split_once("$EndMeshFormat\n").unwrap();
            let (body, elements) = rest.split_once("$Elements").unwrap();
            let (names, nodes) = body.split_once("$EndPhysicalNames\n").unwrap();
            format!("{head}$EndMeshFormat\n$Elements{elements}{nodes}{names}$EndPhysicalNames\n")
        });
        assert_eq!(gmsh.mesh, mesh, "{format:?}");
    }
}

/// Decimal digits are read to the nearest number, in both versions: 17 digits are exact.
#[test]
fn digits_are_read_exactly() {
    let mut random = Random(3);
    let mut sample = Sample::tower();
    for round in 0..200 {
        // Any size with valid shapes.
        let scale = 10_f64.powi(random.below(60) as i32 - 30) * (1.0 + random.unit());
        sample.nodes = Sample::tower().nodes;
        for (_, position) in &mut sample.nodes {
            *position = position.map(|x| scale * (x + 0.01 * random.unit()));
        }
        let wanted = sample.mesh();
        for format in [Format::Text2, Format::Text4] {
            let found = read(&sample.file(format)).mesh;
            let bits = |p: &Vec3| [p.x.to_bits(), p.y.to_bits(), p.z.to_bits()];
            for (found, wanted) in found.positions().iter().zip(wanted.positions()) {
                assert_eq!(bits(found), bits(wanted), "round {round}, {format:?}");
            }
        }
    }
}

/// However a number is written, both versions read it alike, or both refuse it.
#[test]
fn both_versions_read_numbers_alike() {
    let long = format!("3.{}25", "0".repeat(5_000));
    let longer = format!("{}.25", "0".repeat(5_000));
    let nines = format!("3.2{}", "9".repeat(2_000));
    let words = [
        "3.25",
        "+3.25",
        "3.25e0",
        "325e-2",
        "0.325E+1",
        "3.",
        ".5",
        "03.25",
        "3.3e00",
        "3",
        "1e",
        "1e+",
        "e5",
        "-",
        "+",
        ".",
        "+-3",
        "3..2",
        "3.2.1",
        "0x3",
        "3_0",
        "3f",
        "3d0",
        "1e999",
        "1e-999",
        "1e99999999999999999999",
        "-1e-99999999999999999999",
        "nan",
        "NaN",
        "inf",
        "-inf",
        "infinity",
        "Infinity",
        "nan(1)",
        "4.35",
        "3.4999999999999999",
        "2.2250738585072011e-308",
        "5e-324",
        "0.1e-400",
        "3.24999999999999988897769753748434595763683319091796875",
        &long,
        &longer,
        &nines,
    ];
    for word in words {
        let [two, four] = [Format::Text2, Format::Text4].map(|format| {
            let text = String::from_utf8(Sample::tower().file(format)).unwrap();
            assert!(text.contains("1.0 1.0 3.25"));
            let read = parse_gmsh(
                text.replacen("1.0 1.0 3.25", &format!("1.0 1.0 {word}"), 1)
                    .as_bytes(),
            );
            read.map(|gmsh| gmsh.mesh)
                .map_err(|error| error.to_string())
        });
        match (&two, &four) {
            (Ok(two), Ok(four)) => assert_eq!(two, four, "{word}"),
            (Err(_), Err(_)) => {}
            _ => panic!("{word}: {two:?}\n{four:?}"),
        }
    }
}
