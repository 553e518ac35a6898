//! Commands and parts of scenes in the documentation are those of the program.

#[path = "../tests/book/pages.rs"]
mod pages;

use std::fs;

use clap::Parser;
use clap::error::ErrorKind;
use powerhouse::{Error, FileScene, PointPath, Problem};
use powerhouse_test_support::{EVERYTHING, TestFolder};
use toml::{Table, Value};

use crate::Arguments;
use pages::{Block, Line, pages, workspace};

/// The words of a command of the program; behind `mpirun -n 4` or `srun --mpi=pmix` there is one of its own.
fn own(line: &Line) -> Option<Vec<String>> {
    let start = match line.words.first().map(String::as_str) {
        Some("mpirun" | "srun") => line
            .words
            .iter()
            .position(|word| word.ends_with("powerhouse")),
        _ => line.is_own().then_some(0),
    };
    let words = line.words[start?..].iter().skip(1).cloned();
    Some(["powerhouse".to_owned()].into_iter().chain(words).collect())
}

/// Every command of the pages is one of the program, with options that it has and values that they take; files of `data/`
/// that it names are there.
#[test]
fn commands_of_the_pages_are_those_of_the_program() {
    let (mut faults, mut count) = (Vec::new(), 0);
    for page in pages() {
        for line in page.lines() {
            let Some(words) = own(line) else { continue };
            count += 1;
            let told = line.shown();
            let shows = [ErrorKind::DisplayHelp, ErrorKind::DisplayVersion];
            match Arguments::try_parse_from(&words) {
                Err(error) if !shows.contains(&error.kind()) => {
                    faults.push(format!("{told}: {error}"));
                }
                _ => {}
            }
            let files = words.iter().filter(|word| word.starts_with("data/"));
            for file in files.filter(|file| !workspace().join(file).exists()) {
                faults.push(format!("{told}: there is no {file}"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(count > 30, "{count} commands");
}

/// Puts the keys of a part of a scene into a scene: tables into tables, everything else in place of what was there.
fn merge(scene: &mut Table, part: &Table) {
    for (key, value) in part {
        match (scene.get_mut(key), value) {
            (Some(Value::Table(known)), Value::Table(own)) => merge(known, own),
            _ => drop(scene.insert(key.clone(), value.clone())),
        }
    }
}

/// Whether a part of a scene names a material or a record that it does not have.
fn names_another_part(problem: &Problem) -> bool {
    matches!(
        problem,
        Problem::NoSuchName {
            what: "material" | "record",
            ..
        }
    )
}

/// Every part of a scene in the pages has keys and values that a scene may have; paths of material tests, too.
#[test]
fn parts_of_scenes_in_the_pages_have_known_keys() {
    let folder = TestFolder::new("cli-documents");
    let (mut faults, mut count) = (Vec::new(), 0);
    for page in pages() {
        for block in &page.blocks {
            let Block::Toml(block) = block else {
                continue;
            };
            count += 1;
            let check = || -> Result<(), Box<dyn std::error::Error>> {
                let part: Table = block.parse()?;
                let file = folder.join("part.toml");
                if part.contains_key("leg") {
                    fs::write(&file, block)?;
                    PointPath::from_file(&file)?;
                    return Ok(());
                }
                let mut scene: Table = EVERYTHING.parse()?;
                merge(&mut scene, &part);
                fs::write(&file, toml::to_string(&scene)?)?;
                match FileScene::check_keys(&file, &[], &powerhouse_wang_2019::registry()) {
                    // A part may name what other parts of a scene have.
                    Err(Error::Scene(fault)) if names_another_part(fault.problem()) => Ok(()),
                    checked => Ok(checked.map(drop)?),
                }
            };
            if let Err(error) = check() {
                let first = block.lines().next().unwrap_or_default();
                faults.push(format!("{}, block '{first}': {error}", page.name));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(count > 15, "{count} parts");
}
