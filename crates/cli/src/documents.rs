//! Commands and parts of scenes in the documentation are those of the program.

use std::fs;
use std::path::{Path, PathBuf};

use clap::Parser;
use clap::error::ErrorKind;
use powerhouse::{PointPath, Scene};
use powerhouse_test_support::{EVERYTHING, TestFolder};
use toml::{Table, Value};

use crate::Arguments;

/// Words before the arguments of the command.
const STARTS: [&[&str]; 4] = [
    &["powerhouse"],
    &["target/release/powerhouse"],
    &["cargo", "run", "--release", "--"],
    &["cargo", "run", "--release", "-p", "powerhouse-cli", "--"],
];

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The README and the pages of `docs/`.
fn pages() -> Vec<(String, String)> {
    let mut paths = vec![workspace().join("README.md")];
    let entries = fs::read_dir(workspace().join("docs")).unwrap();
    paths.extend(entries.map(|entry| entry.unwrap().path()));
    paths.retain(|path| path.extension().is_some_and(|end| end == "md"));
    let named = |path: PathBuf| {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        (name, fs::read_to_string(path).unwrap())
    };
    paths.into_iter().map(named).collect()
}

/// Blocks of a language in a page, each with the number of its first line.
fn blocks<'p>(page: &'p str, language: &str) -> Vec<(usize, &'p str)> {
    let opening = format!("\n```{language}\n");
    let mut blocks = Vec::new();
    for (start, _) in page.match_indices(&opening) {
        let content = &page[start + opening.len()..];
        let end = content.find("\n```").unwrap();
        let line = page[..start + opening.len()].lines().count() + 1;
        blocks.push((line, &content[..=end]));
    }
    blocks
}

/// Commands of the program in a block of a shell: their words.
fn commands(block: &str) -> Vec<Vec<String>> {
    let mut commands = Vec::new();
    for line in block.replace("\\\n", " ").lines() {
        let mut words = shlex::split(line).unwrap_or_default();
        // Behind `mpirun -n 4` or `srun --mpi=pmix` there is a command of its own.
        if let Some("mpirun" | "srun") = words.first().map(String::as_str) {
            let own = words.iter().position(|word| word.ends_with("powerhouse"));
            words.drain(..own.unwrap_or(0));
        }
        let start = STARTS.iter().find(|start| {
            words.len() >= start.len() && start.iter().zip(&words).all(|(a, b)| a == b)
        });
        let Some(start) = start else { continue };
        words.drain(..start.len());
        // What follows is for the shell.
        let end = words
            .iter()
            .position(|word| ["|", ">", "&", "&&", ";"].contains(&&**word));
        words.truncate(end.unwrap_or(words.len()));
        commands.push(words);
    }
    commands
}

/// Every command of the pages is one of the program, with options that it has and values that they take; files of `data/`
/// that it names are there.
#[test]
fn commands_of_the_pages_are_those_of_the_program() {
    let (mut faults, mut count) = (Vec::new(), 0);
    for (page, text) in pages() {
        for (line, block) in blocks(&text, "sh") {
            for words in commands(block) {
                count += 1;
                let told = format!("{page}, block at line {line}: {}", words.join(" "));
                let parsed = Arguments::try_parse_from(
                    ["powerhouse"]
                        .into_iter()
                        .chain(words.iter().map(String::as_str)),
                );
                match parsed {
                    Err(error)
                        if !matches!(
                            error.kind(),
                            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
                        ) =>
                    {
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

/// Every part of a scene in the pages has keys and values that a scene may have; paths of material tests, too.
#[test]
fn parts_of_scenes_in_the_pages_have_known_keys() {
    let folder = TestFolder::new("cli-documents");
    let (mut faults, mut count) = (Vec::new(), 0);
    for (page, text) in pages() {
        for (line, block) in blocks(&text, "toml") {
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
                Scene::check_keys(&file, &[], &powerhouse_wang_2019::registry())?;
                Ok(())
            };
            if let Err(error) = check() {
                faults.push(format!("{page}, line {line}: {error}"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(count > 15, "{count} parts");
}
