//! Errors of invalid headers, sections and names.

use powerhouse_io::gmsh::GmshFault;
use powerhouse_io::{GmshError, read_gmsh};

use super::sample::{FORMATS, Format, Sample, edit, fault};

/// Faults of the header, which determines the format.
#[test]
fn faults_of_the_head() {
    for (empty, wanted) in [
        (&b""[..], GmshFault::Empty),
        (b" \r\n\t \n", GmshFault::Empty),
    ] {
        assert_eq!(fault(empty).1, wanted);
    }
    for other in [
        "hello\n",
        "$Nodes\n0\n$EndNodes\n",
        "solid cube\n",
        "\0\0\0\0",
        "$",
        "$$\n",
    ] {
        assert!(
            matches!(fault(other.as_bytes()).1, GmshFault::NotGmsh { .. }),
            "{other}"
        );
    }
    for version in [
        "1.0", "1.9", "2.3", "3.0", "4.0", "4", "4.2", "x", "41", "nan",
    ] {
        let head = format!("$MeshFormat\n{version} 0 8\n$EndMeshFormat\n");
        let wanted = GmshFault::Version {
            version: version.into(),
        };
        assert_eq!(fault(head.as_bytes()).1, wanted);
    }
    let one = fault(b"$NOD\n0\n$ENDNOD\n").1;
    assert_eq!(
        one,
        GmshFault::Version {
            version: "1".into()
        }
    );
    for (version, sizes, permitted) in [
        ("4.1", [5, 9, 16, 0, 3], "4 or 8"),
        ("2.2", [4, 5, 9, 16, 0], "8"),
    ] {
        for (file_type, size) in [0, 1].into_iter().flat_map(|t| sizes.map(|size| (t, size))) {
            let head =
                format!("$MeshFormat\n{version} {file_type} {size}\n\x01\0\0\0\n$EndMeshFormat\n");
            let wanted = GmshFault::DataSize {
                found: size,
                permitted,
            };
            assert_eq!(fault(head.as_bytes()).1, wanted);
        }
    }
    for (line, found) in [("4.1 2 8", 2), ("2.2 -1 8", -1)] {
        let head = format!("$MeshFormat\n{line}\n$EndMeshFormat\n");
        assert_eq!(fault(head.as_bytes()).1, GmshFault::FileType { found });
    }
    for line in [
        "4.1 0",
        "4.1",
        "",
        "4.1 0 8 9",
        "4.1 0 x",
        "4.1 y 8",
        "4.1 0 -8",
        "4.1 0 99999999999999999999",
    ] {
        let head = format!("$MeshFormat\n{line}\n$EndMeshFormat\n");
        assert!(
            matches!(fault(head.as_bytes()).1, GmshFault::Expected { .. }),
            "{line}"
        );
    }
}

/// A wrong byte order is found at the mark or at the first count.
#[test]
fn wrong_byte_order() {
    for format in FORMATS.into_iter().filter(|format| !format.is_text()) {
        let mut file = Sample::tower().file(format);
        let mark = 12 + 8;
        file[mark..mark + 4].reverse();
        let (place, found) = fault(&file);
        assert!(!place.section.is_empty(), "{format:?}: {found}");
        file[mark..mark + 4].copy_from_slice(&[0, 1, 0, 0]);
        assert_eq!(fault(&file).1, GmshFault::ByteOrder { found: 256 });
        // Text that is declared as binary.
        file[mark..mark + 4].copy_from_slice(b"$End");
        assert!(matches!(fault(&file).1, GmshFault::ByteOrder { .. }));
    }
    for format in [Format::Text2, Format::Text4] {
        let (place, _) = edit(format, " 0 8", " 1 8");
        assert_eq!(place.section, "$MeshFormat");
    }
}

/// Sections that are missing, occur twice, do not end, or do not start.
#[test]
fn faults_of_sections() {
    for format in FORMATS {
        let file = Sample::tower().file(format);
        let at = |marker: &[u8]| {
            file.windows(marker.len())
                .position(|w| w == marker)
                .unwrap()
        };
        let (nodes, elements) = (at(b"$Nodes"), at(b"$Elements"));
        let without_nodes = [&file[..nodes], &file[elements..]].concat();
        assert_eq!(
            fault(&without_nodes).1,
            GmshFault::Missing { section: "$Nodes" }
        );
        let without_elements = &file[..elements];
        assert_eq!(
            fault(without_elements).1,
            GmshFault::Missing {
                section: "$Elements"
            }
        );
        let twice = [&file[..], &file[nodes..elements]].concat();
        assert_eq!(fault(&twice).1, GmshFault::Repeated { section: "$Nodes" });
        let twice = [&file[..], &file[..at(b"$PhysicalNames")]].concat();
        assert_eq!(
            fault(&twice).1,
            GmshFault::Repeated {
                section: "$MeshFormat"
            }
        );
        let stray = [&file[..], b"the end"].concat();
        assert_eq!(
            fault(&stray).1,
            GmshFault::Stray {
                found: "the end".into()
            }
        );
        let open = [&file[..], b"$NodeData\n1 2 3\n"].concat();
        let (place, fault) = fault(&open);
        assert_eq!(
            fault,
            GmshFault::NotEnded {
                section: "$NodeData".into()
            }
        );
        assert_eq!(place.offset, file.len());
    }
    for wrong in [
        "",
        "$EndNodesX\n",
        "EndNodes\n",
        "$Endnodes\n",
        "0 $EndNodes\n",
    ] {
        let (place, fault) = edit(Format::Text4, "$EndNodes\n", wrong);
        assert_eq!(place.section, "$Nodes", "{wrong}: {fault}");
    }
    let (place, fault) = edit(Format::Text4, "$EndNodes\n", "");
    assert_eq!(
        fault,
        GmshFault::NotEnded {
            section: "$Nodes".into()
        }
    );
    assert_eq!(place.section, "$Nodes");
}

/// Unsupported content has its own errors: parts of partitioned meshes, parametric nodes.
#[test]
fn partitions_and_parameters() {
    let mesh = String::from_utf8(Sample::tower().file(Format::Text4)).unwrap();
    let parts = mesh
        + "$PartitionedEntities\n2\n0\n0 0 0 1\n77 3 1 1 2 0 0 0 1 1 1 0 0\n$EndPartitionedEntities\n";
    let part_of = |found: &[i32], count| GmshFault::PartOfMesh {
        found: found.to_vec(),
        count,
    };
    assert_eq!(fault(parts.as_bytes()).1, part_of(&[], Some(2)));
    let (place, partitioned) = edit(Format::Text2, "34 4 2 2 3 50", "34 4 4 2 3 1 2 50");
    assert_eq!(partitioned, part_of(&[2], None));
    assert_eq!(place.section, "$Elements");
    assert_eq!(
        edit(Format::Text4, "3 1 0 5", "3 1 1 5").1,
        GmshFault::Parametric
    );
    assert_eq!(
        edit(Format::Text2, "$Nodes", "$ParametricNodes").1,
        GmshFault::Parametric
    );
}

/// Names of groups must agree with their count, be in quotes and be UTF-8.
#[test]
fn faults_of_names() {
    for format in [Format::Text2, Format::Text4] {
        for (from, to) in [
            ("\n5\n", "\n6\n"),
            ("\n5\n", "\n-5\n"),
            ("\n5\n", "\n1000000000000000000\n"),
            ("\n5\n", "\n"),
            ("\"base\"", "base"),
            ("\"base\"", "\"base"),
            ("2 1 \"base\"", "4 1 \"base\""),
            ("2 1 \"base\"", "2 \"base\""),
            ("2 1 \"base\"", "2 1 1 \"base\""),
        ] {
            let (place, fault) = edit(format, from, to);
            assert_eq!(place.section, "$PhysicalNames", "{to}: {fault}");
        }
        let (_, fault) = edit(format, "3 2 \"", "3 1 \"");
        assert_eq!(
            fault,
            GmshFault::RepeatedGroup {
                dimension: 3,
                group: 1
            }
        );
    }
    for format in FORMATS {
        let mut file = Sample::tower().file(format);
        let at = file
            .windows(4)
            .position(|window| window == b"base")
            .unwrap();
        file[at] = 0xe9;
        let (place, fault) = fault(&file);
        assert_eq!(place.section, "$PhysicalNames");
        assert!(matches!(fault, GmshFault::Expected { .. }));
    }
}

/// The message names file, line, section and number.
#[test]
fn the_message_states_the_position() {
    let mut sample = Sample::tower();
    sample.elements[4].nodes[3] = 999;
    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("dangling.msh");
    std::fs::write(&file, sample.file(Format::Text2)).unwrap();
    let message = read_gmsh(&file).unwrap_err().to_string();
    let wanted =
        "dangling.msh: line 38 in $Elements: element 25 uses node 999, which does not exist";
    assert!(message.ends_with(wanted), "{message}");
    let missing = read_gmsh(file.with_file_name("absent.msh")).unwrap_err();
    assert!(matches!(&missing, GmshError::File(_)));
    assert!(missing.to_string().contains("absent.msh"), "{missing}");
}
