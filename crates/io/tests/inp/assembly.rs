//! Models of several parts and instances, as Abaqus/CAE writes them, and files within files.

use powerhouse_io::inp::InpFault;
use powerhouse_io::{InpError, InpMesh, parse_inp, read_inp};
use powerhouse_model::{Mesh, Vec3};

use super::sample::{HOUSE, fault, house_of_parts, read};

/// A brick of 2 x 1 x 1 m in two halves.
const SLAB: &str = "*Node
1, 0., 0., 0.
2, 1., 0., 0.
3, 2., 0., 0.
4, 0., 1., 0.
5, 1., 1., 0.
6, 2., 1., 0.
7, 0., 0., 1.
8, 1., 0., 1.
9, 2., 0., 1.
10, 0., 1., 1.
11, 1., 1., 1.
12, 2., 1., 1.
*Element, type=C3D8R
1, 1, 2, 5, 4, 7, 8, 11, 10
2, 2, 3, 6, 5, 8, 9, 12, 11
*Nset, nset=Set-1, generate
1, 3
*Elset, elset=Set-1
2,
*Elset, elset=Left
1,
*Surface, name=Top
1, S2
";

/// A tetrahedron of 1/6 m3.
const TETRAHEDRON: &str = "*Node
1, 0., 0., 0.
2, 1., 0., 0.
3, 0., 1., 0.
44, 0., 0., 1.
*Element, type=C3D4, elset=Set-1
7, 1, 2, 3, 44
";

fn model(instances: &str, rest: &str) -> String {
    format!(
        "*Heading\n** PARTS\n*Part, name=Slab\n{SLAB}*End Part\n*Part, name=Peak\n{TETRAHEDRON}*End Part\n\
         *Assembly, name=Assembly\n{instances}{rest}*End Assembly\n*Material, name=Rock\n*Elastic\n1e9, 0.2\n"
    )
}

fn instance(name: &str, part: &str, lines: &str) -> String {
    format!("*Instance, name={name}, part={part}\n{lines}*End Instance\n**\n")
}

/// Positions of the nodes of an instance by number, less what its numbers were raised by.
fn positions(inp: &InpMesh, name: &str) -> Vec<(u64, Vec3)> {
    let of_name = |(own, shift): &(String, u64)| (own == name).then_some(*shift);
    let shift = inp.report.instances.iter().find_map(of_name).unwrap();
    let next = inp
        .report
        .instances
        .iter()
        .map(|own| own.1)
        .filter(|own| *own > shift)
        .min();
    let tags = inp.mesh.node_tags().iter().zip(inp.mesh.positions());
    let own = tags.filter(|(tag, _)| **tag > shift && next.is_none_or(|next| **tag < next));
    own.map(|(tag, position)| (tag - shift, *position))
        .collect()
}

/// Positions of the nodes of a part by number.
fn of_part(text: &str) -> Vec<(u64, Vec3)> {
    let nodes = text
        .lines()
        .skip(1)
        .take_while(|line| !line.starts_with('*'));
    let node = |line: &str| {
        let numbers: Vec<f64> = line
            .split(',')
            .map(|word| word.trim().parse().unwrap())
            .collect();
        (
            numbers[0] as u64,
            Vec3::new(numbers[1], numbers[2], numbers[3]),
        )
    };
    nodes.map(node).collect()
}

fn near(found: &[(u64, Vec3)], expected: impl Iterator<Item = (u64, Vec3)>) {
    let expected: Vec<(u64, Vec3)> = expected.collect();
    assert_eq!(found.len(), expected.len());
    for ((tag, found), (number, expected)) in found.iter().zip(expected) {
        assert_eq!(*tag, number);
        assert!(
            (found - expected).norm() < 1e-12,
            "{tag}: {found} {expected}"
        );
    }
}

/// Instances are at their places node for node: not moved, translated, translated and then turned about a line;
/// volumes remain, and numbers are those of the part plus a power of ten per instance.
#[test]
fn instances_are_moved_and_turned() {
    // A third of a turn about the diagonal exchanges the axes; a quarter about a vertical line through (1, 2).
    let diagonal = "1, 2, 3\n0, 0, 0, 5, 5, 5, 120\n";
    let quarter = "0., 0., 0.\n1, 2, 9, 1, 2, 11, 90.\n";
    let instances = instance("Slab-1", "Slab", "")
        + &instance("Slab-2", "SLAB", "-7.5, 0.25, 1D1\n")
        + &instance("Slab-3", "Slab", diagonal)
        + &instance("Peak-1", "Peak", quarter);
    let inp = read(&model(&instances, ""));
    let names: Vec<&str> = inp
        .report
        .instances
        .iter()
        .map(|own| own.0.as_str())
        .collect();
    assert_eq!(names, ["Slab-1", "Slab-2", "Slab-3", "Peak-1"]);
    assert_eq!(
        inp.report
            .instances
            .iter()
            .map(|own| own.1)
            .collect::<Vec<_>>(),
        [0, 100, 200, 300]
    );
    let slab = of_part(SLAB);
    near(&positions(&inp, "Slab-1"), slab.iter().copied());
    let by = Vec3::new(-7.5, 0.25, 10.0);
    near(
        &positions(&inp, "Slab-2"),
        slab.iter().map(|(tag, p)| (*tag, p + by)),
    );
    let turned = |p: &Vec3| Vec3::new(p.z + 3.0, p.x + 1.0, p.y + 2.0);
    near(
        &positions(&inp, "Slab-3"),
        slab.iter().map(|(tag, p)| (*tag, turned(p))),
    );
    let turned = |p: &Vec3| Vec3::new(1.0 - (p.y - 2.0), 2.0 + (p.x - 1.0), p.z);
    near(
        &positions(&inp, "Peak-1"),
        of_part(TETRAHEDRON)
            .iter()
            .map(|(tag, p)| (*tag, turned(p))),
    );
    for (set, volume) in [
        ("Slab-1", 2.0),
        ("Slab-2", 2.0),
        ("Slab-3", 2.0),
        ("Peak-1", 1.0 / 6.0),
        ("Slab-3.Left", 1.0),
    ] {
        let elements = inp.mesh.element_set(set).unwrap();
        assert!(
            (inp.mesh.volume_of(elements) - volume).abs() < 1e-12,
            "{set}"
        );
    }
    assert_eq!(inp.mesh.element_tags(), [1, 2, 101, 102, 201, 202, 307]);
    assert_eq!(
        (inp.report.ungrouped_elements, inp.report.dropped_nodes),
        (0, 0)
    );
}

/// Sets of one name in parts, instances and assembly have the name of the instance before them; others keep their
/// name. Sets and surfaces of the assembly name numbers and sets of instances in either way.
#[test]
fn equal_names_are_kept_apart() {
    let instances = instance("Slab-1", "Slab", "") + &instance("Peak-1", "Peak", "5., 0., 0.\n");
    let rest = "*Nset, nset=Set-1, instance=Peak-1\n44,\n*Nset, nset=Set-1, instance=Slab-1, generate\n1, 3\n\
        *Elset, elset=all-of-it\nSlab-1.1, Slab-1.Set-1, Peak-1.SET-1\n\
        *Elset, elset=_Base_S1, internal, instance=Slab-1\n1, 2\n\
        *Surface, type=ELEMENT, name=Base\n_Base_S1, S1\nPeak-1.Set-1, S1\n\
        *Surface, type=ELEMENT, name=top\nSlab-1.2, S2\n";
    let mesh = read(&model(&instances, rest)).mesh;
    let tags = |set: &str| -> Vec<u64> {
        let elements = mesh.element_set(set).unwrap().iter();
        elements.map(|&e| mesh.element_tags()[e as usize]).collect()
    };
    assert_eq!(tags("Slab-1.Set-1"), [2]);
    assert_eq!(tags("Peak-1.Set-1"), [107]);
    assert_eq!(
        (tags("Left"), tags("all-of-it")),
        (vec![1], vec![1, 2, 107])
    );
    let nodes: Vec<u64> = mesh
        .node_set("Set-1")
        .unwrap()
        .iter()
        .map(|&n| mesh.node_tags()[n as usize])
        .collect();
    assert_eq!(nodes, [1, 2, 3, 144]);
    assert_eq!(mesh.node_set("Slab-1.Set-1").unwrap().len(), 3);
    assert_eq!(mesh.facet_set("Base").unwrap().len(), 3);
    // Names that differ in capitals alone are the same.
    assert_eq!(mesh.facet_set("top").unwrap().len(), 1);
    assert_eq!(mesh.facet_set("Slab-1.Top").unwrap().len(), 1);
    assert!(mesh.facet_set("Top").is_err() && mesh.element_set("Set-1").is_err());
    // A single instance keeps its numbers, and its names where the assembly has none of them.
    let one = read(&model(
        &instance("Slab-1", "Slab", ""),
        "*Nset, nset=Set-1, instance=Slab-1\n12,\n",
    ))
    .mesh;
    assert_eq!(one.element_set("Set-1").unwrap(), [1]);
    assert_eq!(one.node_set("Set-1").unwrap(), [11]);
    assert_eq!(one.node_set("Slab-1.Set-1").unwrap(), [0, 1, 2]);
    assert!(one.element_set("Slab-1").is_err());
}

/// Names with points and quotation marks are those of instances where an instance has them.
#[test]
fn names_of_instances_may_have_points() {
    let instances = instance("a", "Slab", "")
        + &instance("a.b", "Peak", "9,,\n")
        + &instance("\"a c\"", "Slab", "0,9\n");
    let rest = "*Elset, elset=x\na.1, a.b.7, \"a c\".2\n";
    let mesh = read(&model(&instances, rest)).mesh;
    let tags: Vec<u64> = mesh
        .element_set("x")
        .unwrap()
        .iter()
        .map(|&e| mesh.element_tags()[e as usize])
        .collect();
    assert_eq!(tags, [1, 107, 202]);
}

/// Reference points of the assembly are nodes of no element; numbers of one instance are never those of another.
#[test]
fn numbers_stay_in_their_instance() {
    let instances = instance("Slab-1", "Slab", "") + &instance("Slab-2", "Slab", "0, 0, 5\n");
    let points = "*Node\n1, 0.5, 0.5, 9.\n*Nset, nset=RP-1, internal\n1,\n";
    let inp = read(&model(&instances, points));
    assert_eq!(inp.mesh.node_count(), 24);
    assert_eq!(inp.report.empty_sets, ["RP-1"]);
    for (rest, passage) in [
        (
            "*Elset, elset=x, instance=Slab-1\n101,\n",
            "element 101, which does not exist",
        ),
        (
            "*Elset, elset=x\nSlab-1.101,\n",
            "element 101, which does not exist",
        ),
        (
            "*Nset, nset=x\n5,\n",
            "number 5 in the assembly belongs to no instance",
        ),
        ("*Elset, elset=x\nLeft\n", "no element set 'Left'"),
        (
            "*Elset, elset=x, instance=Slab-3\n1,\n",
            "no instance 'Slab-3'",
        ),
        (
            "*Node\n1, 0, 0, 0\n*Element, type=C3D4\n1, 1, 2, 3, 4\n",
            "not in the assembly",
        ),
    ] {
        let message = fault(&model(&instances, rest)).1.to_string();
        assert!(message.contains(passage), "{rest}: {message}");
    }
    let dangling = model(&instances, "").replace(
        "2, 2, 3, 6, 5, 8, 9, 12, 11",
        "2, 2, 3, 6, 5, 8, 9, 12, 103",
    );
    assert!(
        fault(&dangling)
            .1
            .to_string()
            .contains("node 103, which does not exist")
    );
    let huge = model(&instances, "").replace("12, 2., 1., 1.", "18446744073709551615, 2., 1., 1.");
    assert!(matches!(fault(&huge).1, InpFault::Numbers { .. }));
    let none = model("", "");
    assert!(matches!(fault(&none).1, InpFault::NoInstances { parts: 2 }));
}

/// The model of one part in one instance is that of the flat input, and of two instances one after the other; one part
/// without an instance is where it was drawn, with the sets of the assembly.
#[test]
fn one_instance_is_the_flat_input() {
    let flat = read(HOUSE).mesh;
    let text = house_of_parts();
    assert_eq!(read(&text).mesh.element_tags(), flat.element_tags());
    let second = "*End Instance\n*Instance, name=b, part=Part-1\n0, 0, 7\n*End Instance";
    let two = read(&text.replacen("*End Instance", second, 1)).mesh;
    assert_eq!(two.element_count(), 2 * flat.element_count());
    let volume =
        |mesh: &Mesh| mesh.volume_of(&(0..mesh.element_count() as u32).collect::<Vec<_>>());
    assert!((volume(&two) - 2.0 * volume(&flat)).abs() < 1e-12);
    let instance = "*Instance, name=House-1, part=Part-1\n*End Instance\n";
    assert!(text.contains(instance));
    let alone = text.replacen(instance, "", 1);
    let alone = alone
        .replace(", instance=House-1", "")
        .replace("House-1.", "");
    let alone = read(&alone).mesh;
    for name in ["floor", "gables"] {
        let [found, expected] = [&alone, &flat].map(|mesh| mesh.facet_set(name).unwrap());
        assert_eq!(found, expected, "{name}");
    }
}

/// Files that a file includes, within each other, are in its place; a fault in one has its file and line; a
/// file outside of the folder, one that is missing and one that includes itself are refused.
#[test]
fn files_are_included() {
    let folder = std::env::temp_dir().join(format!("powerhouse-include-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("parts/deep")).unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.join(name), text).unwrap();
    let (nodes, rest) = HOUSE.split_at(HOUSE.find("*ELEMENT").unwrap());
    let (elements, sets) = rest.split_at(rest.find("*NSET").unwrap());
    write(
        "house.inp",
        "\u{feff}** all\n*Include, input=parts/nodes.inp\n *INCLUDE,\nINPUT=\"parts\\deep\\sets.inp\"\n*MATERIAL, NAME=b\n",
    );
    write(
        "parts/nodes.inp",
        &format!("\u{feff}{nodes}*INCLUDE, INPUT=parts/deep/elements.inp\n"),
    );
    write("parts/deep/elements.inp", elements.trim_end());
    write("parts/deep/sets.inp", sets);
    let mesh = read_inp(folder.join("house.inp")).unwrap().mesh;
    assert_eq!(mesh, read(HOUSE).mesh);
    write(
        "parts/deep/elements.inp",
        &elements.replace("2, 5, 9", "2, 5, 99"),
    );
    match read_inp(folder.join("house.inp")).unwrap_err() {
        InpError::Content { file, place, .. } => {
            assert_eq!(file.unwrap(), folder.join("parts/deep/elements.inp"));
            assert_eq!(place.line, 4);
        }
        other => panic!("{other}"),
    }
    write("parts/deep/elements.inp", elements);
    write(
        "parts/deep/sets.inp",
        &sets.replace("walls, roof", "walls, cellar"),
    );
    let message = read_inp(folder.join("house.inp")).unwrap_err().to_string();
    assert!(message.contains("sets.inp: line 4"), "{message}");
    for (line, passage) in [
        (
            "*INCLUDE, INPUT=../house.inp",
            "line 2 in *INCLUDE: the file '../house.inp' is not in the folder",
        ),
        (
            "*INCLUDE, INPUT=/etc/hosts",
            "line 2 in *INCLUDE: the file '/etc/hosts' is not in the folder",
        ),
        ("*INCLUDE, INPUT=missing.inp", "missing.inp"),
        ("*INCLUDE, INPUT=self.inp", "includes itself"),
        ("*INCLUDE", "INPUT= with a value"),
        ("*INCLUDE, INPUT=house.inp, PASSWORD=x", "PASSWORD"),
    ] {
        write("self.inp", &format!("*HEADING\n{line}\n"));
        let message = read_inp(folder.join("self.inp")).unwrap_err().to_string();
        assert!(message.contains(passage), "{line}: {message}");
    }
    // A file in memory has no folder.
    assert!(
        parse_inp(b"*INCLUDE, INPUT=a.inp\n")
            .unwrap_err()
            .to_string()
            .contains("in the place")
    );
    std::fs::remove_dir_all(folder).unwrap();
}
