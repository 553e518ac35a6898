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

/// What is not one part with one instance at its own place is a fault at its line.
#[test]
fn other_assemblies_are_refused() {
    let instance = "*Instance, name=House-1, part=Part-1\n*End Instance\n";
    let cases: [(&str, &str, &str, &str); 14] = [
        (
            "*End Part",
            "*End Part\n*Part, name=B\n*End Part",
            "*Part, name=B",
            "a second *PART",
        ),
        (
            instance,
            &format!("{instance}{}", instance.replace("House-1", "b")),
            "*Instance, name=b",
            "a second *INSTANCE",
        ),
        (
            "*End Instance",
            "10., 0., 0.\n*End Instance",
            "10., 0., 0.",
            "flat input",
        ),
        (
            "*End Instance",
            "0,0,0\n0,0,0, 0,0,1, 90\n*End Instance",
            "0,0,0, 0,0,1",
            "moved",
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
            "*Node\n1, 0,0,0\n*End Assembly",
            "*Node\n",
            "reference points",
        ),
        (
            "*End Assembly",
            "*Element, type=C3D8\n*End Assembly",
            "*Element, type=C3D8\n",
            "not in the assembly",
        ),
        (
            "*End Assembly",
            "*Elset, elset=roof, instance=House-1\n2\n*End Assembly",
            "*Elset, elset=roof",
            "rename one",
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
