//! Malformed files: each fault names its line and what is permitted.

use powerhouse_io::inp::InpFault;
use powerhouse_io::parse_inp;

use super::sample::{HOUSE, edit, fault};

/// Passage of the house, what is there instead, start of the line of the fault, and passages of its message.
type Case<'a> = (&'a str, &'a str, &'a str, &'a [&'a str]);

fn check(cases: &[Case<'_>]) {
    for (from, to, at, passages) in cases {
        let text = edit(HOUSE, from, to);
        let (place, fault) = fault(&text);
        let message = fault.to_string();
        for passage in *passages {
            assert!(message.contains(passage), "{to}: {message}");
        }
        let line = text.lines().nth(place.line - 1).unwrap();
        assert!(
            line.trim_start().starts_with(at),
            "{to}: '{line}', {message}"
        );
        let whole = parse_inp(text.as_bytes()).unwrap_err().to_string();
        assert!(
            whole.starts_with(&format!("line {}", place.line)),
            "{whole}"
        );
    }
}

/// Nodes.
#[test]
fn faults_of_nodes() {
    check(&[
        (
            "9, 0.5, 0., 1.5",
            "9, 0.5, x, 1.5",
            "9,",
            &["a coordinate", "'x'"],
        ),
        ("9, 0.5, 0., 1.5", "9,", "9,", &["with coordinates"]),
        ("9, 0.5, 0., 1.5", "9, , ,", "9,", &["with coordinates"]),
        (
            "9, 0.5, 0., 1.5",
            "9, 0.5, 0., 1.5, 3",
            "9,",
            &["'3'", "third coordinate"],
        ),
        ("9, 0.5, 0., 1.5", "9 0.5 0. 1.5", "9 ", &["a node number"]),
        (
            "9, 0.5, 0., 1.5",
            "9, 0.5, inf, 1.5",
            "9,",
            &["a coordinate", "'inf'"],
        ),
        (
            "9, 0.5, 0., 1.5",
            "9, 0.5, 1e999, 1.5",
            "9,",
            &["node 9", "y = inf", "not finite"],
        ),
        ("9, 0.5, 0., 1.5", "0, 0.5, 0., 1.5", "0,", &["1 or more"]),
        (
            "9, 0.5, 0., 1.5",
            "-9, 0.5, 0., 1.5",
            "-9,",
            &["a node number", "'-9'"],
        ),
        (
            "9, 0.5, 0., 1.5",
            "8, 0.5, 0., 1.5",
            "8, 0.5",
            &["node 8 is defined twice"],
        ),
        (
            "*NODE, NSET=every",
            "*NODE, SYSTEM=C",
            "*NODE",
            &["SYSTEM", "NSET may be given"],
        ),
        (
            "*NODE, NSET=every",
            "*NODE, NSET",
            "*NODE",
            &["NSET= with a value"],
        ),
        (
            "*NODE, NSET=every",
            "*NODE, NSET=a, NSET=b",
            "*NODE",
            &["NSET occurs twice"],
        ),
    ]);
}

/// Elements.
#[test]
fn faults_of_elements() {
    let brick = "1, 1, 2, 3, 4, 5, 6, 7, 8";
    let types = &["C3D8R, C3D8I, C3D6", "not read"][..];
    check(&[
        (
            brick,
            "1, 1, 2, 3, 4, 5, 6, 7",
            "1, 1",
            &["has 7 nodes", "C3D8R has 8"],
        ),
        (
            brick,
            "1, 1, 2, 3,\n4, 5, 6",
            "4, 5, 6",
            &["element 1 has 6 nodes"],
        ),
        (
            brick,
            "1, 1, 2, 3, 4, 5, 6, 7, 8, 9",
            "1, 1",
            &["'9'", "the last node"],
        ),
        (
            brick,
            "1, 1, 2, 3, 4, 5, 6, 7, 99",
            "1, 1",
            &["node 99, which does not exist"],
        ),
        (
            brick,
            "1, 1, 2, 3, 4, 5, 6, 7, 7",
            "1, 1",
            &["node 7 twice"],
        ),
        (
            brick,
            "1, 1, 2, 3, 4, 5, 6, 7, 8.0",
            "1, 1",
            &["a node number", "'8.0'"],
        ),
        (
            brick,
            "2, 1, 2, 3, 4, 5, 6, 7, 8",
            "2, 5",
            &["element 2 is defined twice"],
        ),
        (
            brick,
            "1, 1, 2, 3, 4, 5, 6, 7, 0",
            "1, 1",
            &["a node number is 1 or more"],
        ),
        ("TYPE=C3D8R", "TYPE=S8R", "*ELEMENT", types),
        ("TYPE=C3D8R", "TYPE=B31", "*ELEMENT", types),
        (
            "TYPE=C3D8R",
            "TYPE=XYZ",
            "*ELEMENT",
            &["XYZ", "leave others out"],
        ),
        (
            "TYPE=C3D8R",
            "TYPE=C3D20R",
            "*ELEMENT",
            &["second order", "`order = 1`"],
        ),
        ("TYPE=C3D8R, ", "", "*ELEMENT", &["TYPE= with a value"]),
        (
            "TYPE=C3D8R, ",
            "TYPE=C3D8R, OFFSET=2, ",
            "*ELEMENT",
            &["OFFSET", "TYPE, ELSET"],
        ),
        (
            "2, 5, 9, 6, 8, 10, 7\n",
            "2, 5, 9, 6, 8, 10, 7\n3, 5, 9, 6, 8, 10, 7\n",
            "3, 5",
            &["elements 2 and 3 have the same nodes"],
        ),
    ]);
    let none = &HOUSE[..HOUSE.find("*ELEMENT").unwrap()];
    assert_eq!(fault(none).1, InpFault::NoElements);
}

/// Sets and surfaces.
#[test]
fn faults_of_sets() {
    check(&[
        (
            "*NSET, NSET=ground, GENERATE\n1, 4",
            "*NSET, NSET=a\nb",
            "b",
            &["node set 'b'", "every"],
        ),
        ("1, 4\n", "1, 5, 3\n", "1, 5", &["from 1 to 5 by 3"]),
        ("1, 4\n", "4, 1\n", "4, 1", &["from 4 to 1"]),
        ("1, 4\n", "1, 4, 0\n", "1, 4, 0", &["1 or more"]),
        (
            "1, 4\n",
            "1, 40\n",
            "1, 40",
            &["'ground'", "node 11, which does not exist"],
        ),
        (
            "1, 4\n",
            "1, 18446744073709551615\n",
            "1, 1844",
            &["node 11"],
        ),
        (
            "1, 4\n",
            "1, 18446744073709551616\n",
            "1, 1844",
            &["first number"],
        ),
        (
            "1, 4\n",
            "1\n",
            "1",
            &["first number, the last number", "1 fields"],
        ),
        ("1, 4\n", "1, 4, 1, 1\n", "1, 4, 1, 1", &["4 fields"]),
        ("1, 4\n", "every\n", "every", &["first number"]),
        (
            "walls, roof",
            "walls, cellar",
            "walls, cellar",
            &["'cellar'", "walls, roof"],
        ),
        (
            "walls, roof",
            "walls, 22",
            "walls, 22",
            &["'house'", "element 22"],
        ),
        (
            "*ELSET, ELSET=house",
            "*ELSET",
            "*ELSET",
            &["ELSET= with a value"],
        ),
        (
            "*ELSET, ELSET=house",
            "*ELSET, ELSET=house, BY=x",
            "*ELSET",
            &["BY", "GENERATE"],
        ),
        (
            "*NSET, NSET=ground",
            "*NSET, NSET=ground, ELSET=roof",
            "*NSET",
            &["ELSET", "NSET, GENERATE"],
        ),
        ("walls, S1", "walls, S7", "walls, S7", &["S1 to S6", "'S7'"]),
        ("walls, S1", "walls, SPOS", "walls, SPOS", &["S1 to S6"]),
        ("walls, S1", "walls", "walls", &["S1 to S6"]),
        ("walls, S1", "walls, S1, 3", "walls, S1, 3", &["S1 to S6"]),
        (
            "2, S2",
            "2, S6",
            "2, S6",
            &["element 2 of type C3D6 has no face 6", "S1 to S5"],
        ),
        (
            "walls, S1",
            "cellar, S1",
            "cellar, S1",
            &["'cellar'", "walls, roof, house"],
        ),
        (
            "NAME=gables",
            "NAME=gables, COMBINE=UNION",
            "*SURFACE",
            &["COMBINE", "NAME, TYPE"],
        ),
        (
            "*SURFACE, NAME=gables",
            "*SURFACE",
            "*SURFACE",
            &["NAME= with a value"],
        ),
        (
            "ELSET=house",
            "ELSET=\"walls\"",
            "*ELSET",
            &["two element sets 'walls'", "quotation marks"],
        ),
    ]);
    let (place, message) = fault(&edit(HOUSE, "*NODE, NSET=every", "*NSET, NSET=a\nb\n*NODE"));
    assert_eq!(place.line, 5);
    assert!(
        message.to_string().contains("none is defined before it"),
        "{message}"
    );
}

/// Keywords that describe the mesh otherwise, and files that are none.
#[test]
fn what_is_not_read_is_named() {
    for (line, passage) in [
        ("*INCLUDE, INPUT=rest.inp", "in the place of this line"),
        ("*NGEN", "one by one"),
        ("*NFill, nset=a", "one by one"),
        ("*NCOPY", "one by one"),
        ("*NMAP", "one by one"),
        ("*ELGEN", "one by one"),
        ("*ELCOPY", "one by one"),
        ("*IMPORT", "one by one"),
        ("*SYSTEM", "global system"),
        ("*PARAMETER", "in the place of parameters"),
    ] {
        check(&[(
            "*NSET",
            &format!("{line}\n*NSET"),
            line,
            &["is not read", passage],
        )]);
    }
    let place_and_message = |text: &str| {
        let (place, fault) = fault(text);
        (place.line, fault.to_string())
    };
    for (text, wanted, passage) in [
        ("", 1, "empty"),
        ("\n** nothing\n", 1, "empty"),
        ("1, 2, 3\n*NODE\n", 1, "starts with a keyword line"),
        ("\n$MeshFormat\n2.2 0 8\n", 2, "'$MeshFormat'"),
        ("\u{0}\u{1}\u{2}", 1, "starts with a keyword line"),
        ("*HEADING\nnothing\n", 3, "no elements"),
    ] {
        let (line, message) = place_and_message(text);
        assert_eq!(line, wanted, "{message}");
        assert!(message.contains(passage), "{message}");
    }
    let mut many = String::from("*NODE");
    (0..40).for_each(|i| many += &format!(", A{i}=1"));
    check(&[("*NODE, NSET=every", &many, "*NODE", &["32 parameters"])]);
}

/// Sets of sets have a largest size, which is found before memory is taken for them.
#[test]
fn the_size_of_sets_is_limited() {
    let mut text = HOUSE.to_owned();
    for _ in 0..64 {
        text += "*ELSET, ELSET=house\nhouse, house, house\n";
    }
    let (place, fault) = fault(&text);
    assert_eq!(place.keyword, "*ELSET");
    assert!(matches!(fault, InpFault::TooManyMembers { .. }), "{fault}");
}
