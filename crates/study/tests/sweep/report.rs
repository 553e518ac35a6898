//! Outcomes of cases and their report.

use super::*;

/// The relative displacements of the free field are those of a body that is ground everywhere.
#[test]
fn the_free_field_is_that_of_homogeneous_ground() {
    let folder = Folder::new("ground");
    let place = |text: &str| SCENE.find(text).unwrap();
    let relative = place("[[output.relative]]");
    let continuous = place("[[case]]\nname = \"continuous\"");
    let longer =
        ground(&SCENE[relative..continuous]).replace("duration = 0.05\n", "duration = 0.15\n");
    std::fs::write(folder.scene(), longer).unwrap();
    let cases = folder.sweep().run(None, &mut NoProgress).unwrap();
    assert_eq!(cases.len(), 2);
    for case in &cases {
        let (moved, ground) = (&case.relative[0], &case.ground[0]);
        assert_eq!(moved.name, ground.name);
        assert!(
            (moved.value / ground.value - 1.0).abs() < 0.02 && ground.value > 1e-4,
            "{}: {moved:?} {ground:?}",
            case.name
        );
        assert!((moved.time - ground.time).abs() <= 0.0051);
    }
}

/// A report is one self-contained page with every case, its plots and scene, forces of sections and bolts, floor spectra,
/// and damage; that of a single run has its peaks; a folder without results is an error.
#[test]
fn a_report_is_self_contained() {
    let folder = Folder::new("report");
    let concrete = "[[material]]\nname = \"concrete\"\nlaw = \"plastic-damage\"\n\
                    preset = \"paper-c25\"\n[[part]]\nset = \"structure\"\nmaterial = \"concrete\"";
    let of_rock = "[[part]]\nset = \"structure\"\nmaterial = \"rock\"";
    let stronger = "[[case]]\nname = \"stronger\"\nvaries = \"pulse\"\n\
                    boundary = { amplitude_ratio = 0.5 }\n";
    let text = SCENE.replace(of_rock, concrete) + stronger;
    std::fs::write(folder.scene(), text).unwrap();
    let sweep = folder.sweep().with_duration(0.03).unwrap();
    sweep.run(None, &mut NoProgress).unwrap();
    let page = |path: &Path| std::fs::read_to_string(write_report(path).unwrap()).unwrap();
    let sweep = page(&folder.0.join("out"));
    for wanted in [
        "steep",
        "slanted",
        "continuous",
        "A-O1",
        "Before the earthquake",
        "on a mesh of 128 elements and ",
        "<td class=\"text\">steep and 2 more</td>",
        "[[case]]",
        "Section forces",
        "<td class=\"text\">waist</td>",
        "Floor response spectra",
        "<td class=\"text\">O1 z</td>",
        "pins",
        "seam-side",
        "steep: structure damage type",
        "steep: joint seam over the run",
        "Sensitivity to single parameters",
        "checksum of scene and files",
        // Joint and concrete have history variables.
        "it is unknown whether these motions depend sensitively on the input",
        "steep (sensitivity to the input unknown: not for design)",
    ] {
        assert!(sweep.contains(wanted), "{wanted}");
    }
    let head = std::fs::read_to_string(folder.0.join("out/report/floor-spectra-steep.csv"));
    assert!(
        head.unwrap()
            .starts_with("# warning: sensitivity to the input unknown")
    );
    let spectra = read_table(&folder.0.join("out/report/floor-spectra-steep.csv")).unwrap();
    assert!(spectra.iter().any(|column| column.name == "O1 z 5 %"));
    let outcomes = read_outcomes(folder.0.join("out")).unwrap();
    assert_eq!(outcomes.len(), 4);
    let steep = &outcomes[0];
    assert_eq!(steep.input.wave(), Some(("p", 0.0)));
    assert_eq!((steep.bolts.len(), steep.bolts_at_rest.len()), (1, 1));
    assert!(steep.bolts[0].value >= steep.bolts_at_rest[0].value);
    let structure = steep.parts.iter().find(|part| part.name == "structure");
    assert!((structure.unwrap().volume - 216.0).abs() < 1e-9);
    assert_eq!(
        (steep.joint_parts.len(), outcomes[2].joint_parts.len()),
        (1, 0)
    );
    assert!(steep.joint_and_lining.is_some() && outcomes[2].joint_and_lining.is_none());
    let varied = sensitivity(&outcomes);
    assert_eq!((&*varied[0].case, &*varied[0].base), ("stronger", "steep"));
    let run = page(&folder.0.join("out/steep"));
    assert!(run.contains("A-O1.ux"));
    for text in [&sweep, &run] {
        assert!(text.contains("src=\"data:image/svg+xml;base64,"));
        assert!(!text.contains("http") && !text.contains("src=\"/") && !text.contains("<script"));
        assert!(text.ends_with("</body></html>\n"));
    }
    let none = write_report(folder.0.join("nothing")).unwrap_err();
    assert!(
        none.to_string().contains("neither a sweep nor a run"),
        "{none}"
    );
}

/// A section that a program adds is in the report where it has content, and in place of the general results if it says so.
struct Cases {
    title: &'static str,
    has_content: bool,
    replaces: bool,
}

impl ReportSection for Cases {
    fn title(&self) -> &str {
        self.title
    }
    fn items(&self, cases: &[ReportCase]) -> Vec<ReportItem> {
        if !self.has_content {
            return Vec::new();
        }
        let rows = cases
            .iter()
            .map(|case| vec![format!("<{}>", case.outcome.name)]);
        let table = ReportTable {
            header: vec!["own case".into()],
            rows: rows.collect(),
        };
        vec![
            ReportItem::Paragraph("A & B.".into()),
            ReportItem::Table(table),
        ]
    }
    fn replaces_results(&self) -> bool {
        self.replaces
    }
}

/// The report of a general sweep has its own points, with peaks, histories and pictures, and the sections that are added to
/// it. Elastic ground without joints is insensitive to the input.
#[test]
fn a_sweep_of_ones_own_has_its_own_report() {
    let folder = Folder::new("own-report");
    let place = |text: &str| SCENE.find(text).unwrap();
    let (joint, support) = (place("[[joint]]"), place("[[support]]"));
    let (stress, wave) = (place("[in_situ_stress]"), place("[[wave]]"));
    let (watched, relative) = (place("[[output.joint]]"), place("[[output.relative]]"));
    let own = [
        &SCENE[..joint],
        &SCENE[support..stress],
        &SCENE[wave..watched],
        "[output.envelope]\nquantities = [\"velocity\"]\nevery = 0.01\n",
        &SCENE[relative..place("[[case]]\nname = \"continuous\"")],
    ];
    let own = own.concat();
    let own = own
        .replace("\"A\"", "\"crown\"")
        .replace("\"O1\"", "\"lower-floor\"");
    std::fs::write(folder.scene(), own.replace("\"A-O1\"", "\"closure\"")).unwrap();
    let out = folder.0.join("out");
    folder
        .sweep()
        .with_duration(0.03)
        .unwrap()
        .run(None, &mut NoProgress)
        .unwrap();
    let page = std::fs::read_to_string(write_report(&out).unwrap()).unwrap();
    for wanted in [
        "<td class=\"text\">crown.uz</td>",
        "crown: ux, uz (m)",
        "lower-floor: ",
        "steep: largest velocity",
        "Greatest norm of the relative displacement (mm)",
        "<td class=\"text\">lower-floor z</td>",
    ] {
        assert!(page.contains(wanted), "{wanted}");
    }
    let section = |title, has_content, replaces| Cases {
        title,
        has_content,
        replaces,
    };
    let with = |sections: &[&dyn ReportSection]| {
        std::fs::read_to_string(write_report_with(&out, sections).unwrap()).unwrap()
    };
    let further = with(&[
        &section("Of mine", true, false),
        &section("Nothing", false, true),
    ]);
    for wanted in [
        "Of mine",
        "A &amp; B.",
        "&lt;steep&gt;",
        "crown: ux, uz (m)",
    ] {
        assert!(further.contains(wanted), "{wanted}");
    }
    assert!(!further.contains("Nothing"));
    assert!(!with(&[&section("Of mine", true, true)]).contains("crown: ux, uz (m)"));
    for unwanted in ["Of mine", "unknown whether", "Wang, Chen"] {
        assert!(!page.contains(unwanted), "{unwanted}");
    }
    assert!(out.join("report/history-crown-u-m.svg").exists());
}
