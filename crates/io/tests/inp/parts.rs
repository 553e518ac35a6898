//! Parts, instances and assemblies.

use powerhouse_io::inp::InpFault;

use super::sample::{HOUSE, edit, fault, house_of_parts, read};

/// A part with an instance is the mesh of the flat input; sets of the assembly name the instance.
#[test]
fn one_part_with_one_instance_is_read() {
    let (flat, parts) = (read(HOUSE).mesh, read(&house_of_parts()).mesh);
    assert_eq!(parts.positions(), flat.positions());
    assert_eq!(parts.node_sets(), flat.node_sets());
    assert_eq!(parts.facet_sets(), flat.facet_sets());
    assert_eq!(
        parts.element_set("house").unwrap(),
        flat.element_set("house").unwrap()
    );
    assert_eq!(parts.element_set("_floor_S1").unwrap(), [0]);
    let zero = edit(
        &house_of_parts(),
        "*End Instance",
        "0., 0., 0.\n*End Instance",
    );
    assert_eq!(read(&zero).mesh, parts);
    // The nodes and elements may be in the instance.
    let text = house_of_parts();
    let start = text.find("*NODE").unwrap();
    let end = text.find("*End Part").unwrap();
    let moved = format!("{}{}", &text[..start], &text[end..]);
    let moved = edit(
        &moved,
        "*End Instance",
        &format!("{}*End Instance", &text[start..end]),
    );
    assert_eq!(read(&moved).mesh, parts);
}

/// A node of the assembly that has the number of a node of the only part, which has no instance, is in the sets of the
/// assembly alone.
#[test]
fn points_of_an_assembly_take_nothing_from_the_sets_of_a_part() {
    let mesh = &HOUSE[HOUSE.find("*NODE").unwrap()..HOUSE.find("*SURFACE").unwrap()];
    let text = |points: &str| {
        format!(
            "*Part, name=Part-1\n{mesh}*End Part\n*Assembly, name=Assembly\n{points}*Nset, nset=handles\n1, 3, 10\n\
             *End Assembly\n"
        )
    };
    let sets = |text: &str| {
        let mesh = read(text).mesh;
        ["ground", "handles"].map(|name| mesh.node_set(name).map_or(0, <[u32]>::len))
    };
    assert_eq!(sets(&text("")), [4, 3]);
    assert_eq!(sets(&text("*Node\n1, 5., 5., 5.\n3, 6., 5., 5.\n")), [4, 1]);
}

/// Parts, instances and assemblies that contradict each other are faults at their lines.
#[test]
fn other_assemblies_are_refused() {
    let instance = "*Instance, name=House-1, part=Part-1\n*End Instance\n";
    let cases: [(&str, &str, &str, &str); 11] = [
        (
            "*End Part",
            "*End Part\n*Part, name=PART-1\n*End Part",
            "*Part, name=PART-1",
            "two parts 'PART-1'",
        ),
        (
            instance,
            &format!("{instance}{instance}"),
            "*Instance, name=House-1",
            "two instances 'House-1'",
        ),
        (
            "*End Instance",
            "0,0,0\n0,0,0, 0,0,0, 90\n*End Instance",
            "0,0,0, 0,0,0",
            "two points of an axis",
        ),
        (
            "part=Part-1",
            "part=Part-2",
            "*Instance",
            "no part 'Part-2'",
        ),
        (
            "instance=House-1",
            "instance=House-2",
            "*Elset, elset=_floor",
            "no instance 'House-2'",
        ),
        (", instance=House-1", "", "1,\n*Surface", "instance.number"),
        (
            "*End Assembly",
            "*Element, type=C3D8\n*End Assembly",
            "*Element, type=C3D8\n",
            "not in the assembly",
        ),
        ("*End Assembly\n", "", "*Assembly", "no end *END ASSEMBLY"),
        ("*End Part\n", "", "*Assembly", "outside of parts"),
        ("*Part, name=Part-1\n", "", "*End Part", "only after *PART"),
        (
            "*End Part",
            "*End Part\n1, 2",
            "1, 2\n*Assembly",
            "nothing is permitted",
        ),
    ];
    for (from, to, at, passage) in cases {
        let text = edit(&house_of_parts(), from, to);
        let (place, fault) = fault(&text);
        let message = fault.to_string();
        assert!(message.contains(passage), "{to}: {message}");
        let line = 1 + text[..text.rfind(at).unwrap()].matches('\n').count();
        assert_eq!(place.line, line, "{to}: {message}");
    }
    let late = HOUSE.to_owned() + "*PART, NAME=a\n*END PART\n";
    assert!(matches!(fault(&late).1, InpFault::Misplaced { .. }));
}
