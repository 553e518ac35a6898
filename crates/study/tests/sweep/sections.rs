//! Extremes of section forces by case.

use super::*;

/// The extremes of a section in a case's outcome, in the table of the sweep and in its report are those of the section's
/// own table, with their times.
#[test]
fn extremes_of_a_section_are_those_of_its_table() {
    let folder = Folder::new("sections");
    let two = ["steep", "slanted"].map(str::to_owned);
    let sweep = folder.sweep().only(&two).unwrap();
    let outcomes = sweep.run(None, &mut NoProgress).unwrap();
    let out = folder.0.join("out");
    let of_sweep = std::fs::read_to_string(out.join("sweep.csv")).unwrap();
    let mut lines = of_sweep.lines().map(|line| line.split(','));
    let header: Vec<&str> = lines.next().unwrap().collect();
    let rows: Vec<Vec<&str>> = lines.map(Iterator::collect).collect();
    let page = std::fs::read_to_string(write_report(&out).unwrap()).unwrap();
    for (outcome, row) in outcomes.iter().zip(&rows) {
        assert_eq!(row[0], outcome.name);
        let [waist] = outcome.sections.as_slice() else {
            panic!("{:?}", outcome.sections);
        };
        assert_eq!(waist.name, "waist");
        let table = read_table(&out.join(&outcome.name).join("sections.csv")).unwrap();
        for (name, what, found) in [
            ("axial_per_metre", "axial force waist [N/m]", &waist.axial),
            ("shear_per_metre", "shear force waist [N/m]", &waist.shear),
            ("moment_per_metre", "moment waist [N m/m]", &waist.moment),
        ] {
            let name = format!("waist.{name}");
            let force = table.iter().find(|column| column.name == name).unwrap();
            let least = force.values.iter().copied().fold(f64::INFINITY, f64::min);
            let most = force
                .values
                .iter()
                .copied()
                .fold(f64::NEG_INFINITY, f64::max);
            assert!(least < most, "{name}");
            assert_eq!([found[0].value, found[1].value], [least, most], "{name}");
            for peak in found {
                let at = table[0].values.iter().position(|&time| time == peak.time);
                assert_eq!(force.values[at.unwrap()], peak.value, "{name}");
            }
            for (extreme, value) in [("least", least), ("greatest", most)] {
                let wanted = format!("{extreme} {what}");
                let column = header.iter().position(|head| *head == wanted).unwrap();
                assert_eq!(row[column].parse::<f64>().unwrap(), value, "{wanted}");
            }
        }
        let cells = format!("waist</td><td class=\"text\">{}</td>", outcome.name);
        assert!(page.contains(&cells), "{cells}");
    }
    let [steep, slanted] = [&outcomes[0].sections[0], &outcomes[1].sections[0]];
    assert!(steep.axial[0].value != slanted.axial[0].value);
}
