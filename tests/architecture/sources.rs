//! What sources look like.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::manifests::workspace;

/// The longest source file, about 600 lines; one concern seldom needs more.
const MOST_LINES: usize = 620;
/// The longest file of tests.
const MOST_LINES_OF_TESTS: usize = 800;

/// Files below a directory, without build output, run output and what is hidden.
pub(super) fn files_below(directory: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut open = vec![directory.to_path_buf()];
    while let Some(directory) = open.pop() {
        for entry in fs::read_dir(&directory).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            let results = name == "results" && !directory.ends_with("crates");
            let output = results || name.ends_with(".out") || ["target", "out"].contains(&&*name);
            let hidden = name.starts_with('.') && name != ".ci";
            if output || hidden {
                continue;
            }
            if path.is_dir() {
                open.push(path);
            } else {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// Path and text of every Rust file of the workspace.
pub(crate) fn rust_files() -> Vec<(PathBuf, String)> {
    files_below(&workspace())
        .into_iter()
        .filter(|path| path.extension().is_some_and(|extension| extension == "rs"))
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            (path, text)
        })
        .collect()
}

/// Whether a file holds nothing but tests.
fn is_test(path: &Path) -> bool {
    path.ends_with("tests.rs") || path.components().any(|part| part.as_os_str() == "tests")
}

/// Files hold one concern: none is longer than 600 lines, or 800 if it holds tests.
#[test]
fn files_are_short() {
    let long: Vec<String> = rust_files()
        .iter()
        .map(|(path, text)| {
            (
                path.strip_prefix(workspace()).unwrap(),
                text.lines().count(),
            )
        })
        .filter(|(path, lines)| {
            let most = if is_test(path) {
                MOST_LINES_OF_TESTS
            } else {
                MOST_LINES
            };
            *lines > most
        })
        .map(|(path, lines)| format!("{}: {lines}", path.display()))
        .collect();
    assert!(long.is_empty(), "{long:#?}");
}

/// Where the module of a file of tests is to be declared, and its name; none for other files and for the programs
/// themselves.
fn declaration(path: &Path) -> Option<(Vec<PathBuf>, String)> {
    let parts: Vec<&str> = path.iter().filter_map(|part| part.to_str()).collect();
    let top = match parts[..] {
        ["examples", "figures.rs" | "tests.rs"] => return None,
        ["examples", _] => {
            let programs = ["tests.rs", "figures.rs"].map(|name| path.with_file_name(name));
            let name = path.file_stem()?.to_str()?;
            return Some((programs.to_vec(), name.to_owned()));
        }
        ["crates", _, "tests", ..] => 3,
        ["tests", "src", ..] => return None,
        ["tests", ..] => 1,
        _ => return None,
    };
    let module = if path.ends_with("mod.rs") {
        path.parent()?
    } else {
        path
    };
    let folder = module.parent()?;
    let is_top = folder.iter().count() == top;
    if is_top && path.ends_with("main.rs") {
        return None;
    }
    let parent = folder.join(if is_top { "main.rs" } else { "mod.rs" });
    Some((vec![parent], module.file_stem()?.to_str()?.to_owned()))
}

/// No test is left out: each file of the tests of a package is a module of its one program of tests, and each example is one
/// of the program of their tests.
#[test]
fn every_file_of_tests_is_a_module() {
    let (mut count, mut left_out) = (0, Vec::new());
    for (path, _) in rust_files() {
        let relative = path.strip_prefix(workspace()).unwrap();
        let Some((parents, name)) = declaration(relative) else {
            continue;
        };
        let line = format!("mod {name};");
        let declares = |parent: PathBuf| {
            let text = fs::read_to_string(workspace().join(parent)).unwrap_or_default();
            text.lines()
                .any(|found| found.trim_start_matches("pub ") == line)
        };
        count += 1;
        if !parents.into_iter().any(declares) {
            left_out.push(relative.display().to_string());
        }
    }
    assert!(left_out.is_empty(), "{left_out:#?}");
    assert!(count > 200, "{count}");
}

/// Nothing built or downloaded is in the repository: none of its files has more than 2 MiB.
#[test]
fn files_are_small() {
    let listed = Command::new("git")
        .args(["ls-files", "-z"])
        .current_dir(workspace())
        .output();
    let Some(listed) = listed.ok().filter(|listed| listed.status.success()) else {
        // A copy without its repository.
        return;
    };
    let names = String::from_utf8(listed.stdout).unwrap();
    let names: Vec<&str> = names.split('\0').filter(|name| !name.is_empty()).collect();
    assert!(names.contains(&"Cargo.toml"), "{names:?}");
    let size = |name: &&str| fs::metadata(workspace().join(name)).map_or(0, |found| found.len());
    let large: Vec<&str> = names
        .into_iter()
        .filter(|name| size(name) > 2 << 20)
        .collect();
    assert!(large.is_empty(), "{large:#?}");
}

/// Every module is named for what it holds: there is none for the rest.
#[test]
fn there_is_no_drawer_for_the_rest() {
    for (path, _) in rust_files() {
        let is_drawer =
            |name: &str| ["common", "utils", "util", "helpers", "misc", "shared"].contains(&name);
        let stem = path.file_stem().unwrap().to_string_lossy();
        let relative = path.strip_prefix(workspace()).unwrap();
        let in_drawer = relative
            .components()
            .any(|part| is_drawer(&part.as_os_str().to_string_lossy()));
        assert!(!in_drawer && !is_drawer(&stem), "{}", path.display());
    }
}

/// At most one file of a crate has unsafe code.
#[test]
fn unsafe_code_is_in_one_file_of_a_crate() {
    let mut per_crate = std::collections::BTreeMap::<String, Vec<PathBuf>>::new();
    let lifts = ["allow(", "expect("].map(|word| [word, "unsafe_code)"].concat());
    for (path, text) in rust_files() {
        let relative = path.strip_prefix(workspace()).unwrap().to_path_buf();
        if lifts.iter().any(|lift| text.contains(lift)) {
            let package = relative.components().take(2);
            let package = package.map(|part| part.as_os_str().to_string_lossy());
            let package = package.collect::<Vec<_>>().join("/");
            per_crate.entry(package).or_default().push(relative);
        }
    }
    assert!(
        per_crate.values().all(|files| files.len() == 1),
        "{per_crate:#?}"
    );
}

/// The calendar, which a user or the network may set at any time, is read in one place, for the date at which a run began.
/// All else takes intervals, by a clock that does not jump.
#[test]
fn the_calendar_is_read_in_one_file() {
    let calendar = ["System", "Time"].concat();
    let readers: Vec<PathBuf> = rust_files()
        .into_iter()
        .filter(|(_, text)| text.contains(&calendar))
        .map(|(path, _)| path.strip_prefix(workspace()).unwrap().to_path_buf())
        .filter(|path| !is_test(path))
        .collect();
    assert_eq!(readers, [Path::new("crates/results/src/lock.rs")]);
}

/// Nothing is announced and not done: no trait and no function has a body that says so.
#[test]
fn nothing_is_left_undone() {
    let marks = [
        ["todo", "!("],
        ["unimplemented", "!("],
        ["not implemented", ""],
    ];
    for (path, text) in rust_files() {
        for mark in &marks {
            let mark = mark.concat();
            assert!(
                !text.contains(&mark) || path.ends_with("architecture/sources.rs"),
                "{} says '{mark}'",
                path.display()
            );
        }
    }
}

/// No file names a path on somebody's machine.
#[test]
fn no_file_names_a_machine() {
    let places = ["/home/", "/Users/", "/work/", "/tmp/", "/root/"];
    for path in files_below(&workspace()) {
        if path.ends_with("architecture/sources.rs") {
            continue;
        }
        // Binary files are not text that a person wrote.
        let Ok(text) = fs::read_to_string(&path) else {
            continue;
        };
        for (number, line) in text.lines().enumerate() {
            let address = line.contains("://");
            for place in places {
                assert!(
                    address || !line.contains(place),
                    "{}:{} names '{place}'",
                    path.display(),
                    number + 1
                );
            }
        }
    }
}

/// Nothing but the command's own writer writes to the standard streams: the macros of the standard library
/// panic where a reader has gone away, and a library has no say there at all. Tests and examples may.
#[test]
fn one_place_prints() {
    let macros =
        ["println", "print", "eprintln", "eprint", "dbg"].map(|name| [name, "!("].concat());
    let is_source = |path: &Path| {
        let parts: Vec<_> = path.strip_prefix(workspace()).unwrap().iter().collect();
        parts.len() > 2 && parts[0] == "crates" && parts[2] == "src"
    };
    let mut printing = Vec::new();
    for (path, text) in rust_files() {
        if !is_source(&path) || is_test(&path) {
            continue;
        }
        let (own, _) = text.split_once("#[cfg(test)]").unwrap_or((&text, ""));
        for (number, line) in own.lines().enumerate() {
            let code = line.split("//").next().unwrap_or("");
            let word = |name: &str| {
                let (before, _) = code.split_once(name)?;
                let last = before.chars().last();
                (!last.is_some_and(|c| c.is_alphanumeric() || c == '_')).then_some(())
            };
            if macros.iter().any(|name| word(name).is_some()) {
                printing.push(format!("{}:{}", path.display(), number + 1));
            }
        }
    }
    assert!(printing.is_empty(), "{printing:#?}");
}
