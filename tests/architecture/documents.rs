//! What the README and the pages say is there.

use std::fs;
use std::path::{Path, PathBuf};

use powerhouse::FileScene;

use super::manifests::workspace;
use super::sources::files_below;

/// The longest README: what a reader takes in at once.
const MOST_LINES: usize = 250;

/// The README, the changelog, and the pages in `docs/` and `data/`.
fn pages() -> Vec<(PathBuf, String)> {
    let root = workspace();
    let mut paths = vec![root.join("README.md"), root.join("CHANGELOG.md")];
    for folder in ["docs", "data"] {
        paths.extend(files_below(&root.join(folder)));
    }
    let is_page = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "md");
    let read = |path: PathBuf| (path.clone(), fs::read_to_string(path).unwrap());
    paths.into_iter().filter(is_page).map(read).collect()
}

/// The targets of links `[text](target)` in a page, those to other sites left out.
fn links(page: &str) -> Vec<&str> {
    let targets = page.split("](").skip(1);
    targets
        .filter_map(|rest| rest.split_once(')'))
        .map(|(target, _)| target)
        .filter(|target| !target.contains("://"))
        .collect()
}

/// The anchors that the headings of a page have: lower case, spaces as `-`, without punctuation.
fn anchors(page: &str) -> Vec<String> {
    let headings = page.lines().filter(|line| line.starts_with('#'));
    headings
        .map(|heading| {
            let title = heading.trim_start_matches('#').trim().to_lowercase();
            let kept = title
                .chars()
                .filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            kept.map(|c| if c == ' ' { '-' } else { c }).collect()
        })
        .collect()
}

/// Every relative link of the README and of the pages leads to a file that exists, and to a heading of it.
#[test]
fn links_lead_somewhere() {
    let mut dead = Vec::new();
    for (path, text) in pages() {
        for link in links(&text) {
            let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                file => path.parent().unwrap().join(file),
            };
            let found = target.exists()
                && (anchor.is_empty()
                    || anchors(&fs::read_to_string(&target).unwrap()).contains(&anchor.to_owned()));
            if !found {
                dead.push(format!("{}: {link}", path.display()));
            }
        }
    }
    assert!(dead.is_empty(), "{}", dead.join("\n"));
}

/// Every fault in `docs/robustness.md` names a test that exists.
#[test]
fn faults_are_tested() {
    let page = fs::read_to_string(workspace().join("docs/robustness.md")).unwrap();
    let table = page.split("| fault |").nth(1).unwrap();
    let rows = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'));
    let mut count = 0;
    for row in rows {
        let proof = row.trim_end_matches('|').rsplit('|').next().unwrap();
        for test in proof.split(';') {
            let names: Vec<&str> = test.split('`').skip(1).step_by(2).collect();
            let [file, name] = names[..] else {
                panic!("{row} names no test");
            };
            let text = fs::read_to_string(workspace().join(file));
            let text = text.unwrap_or_else(|error| panic!("{file}: {error}"));
            assert!(
                text.contains(&format!("fn {name}()")),
                "{file} has no {name}"
            );
            count += 1;
        }
    }
    assert!(count > 20, "{count}");
}

/// Every page in `docs/` is in its table of contents.
#[test]
fn pages_are_listed() {
    let docs = workspace().join("docs");
    let contents = fs::read_to_string(docs.join("README.md")).unwrap();
    let listed = links(&contents);
    for (path, _) in pages() {
        if path.parent() == Some(&docs) && !path.ends_with("README.md") {
            let name = path.file_name().unwrap().to_string_lossy();
            assert!(
                listed.contains(&&*name),
                "docs/README.md does not list {name}"
            );
        }
    }
}

/// The README is short, its scene is the one in `data/scenes/`, and that scene can be run.
#[test]
fn the_scene_of_the_readme_can_be_run() {
    let readme = fs::read_to_string(workspace().join("README.md")).unwrap();
    let lines = readme.lines().count();
    assert!(lines <= MOST_LINES, "README.md has {lines} lines");

    let path: &Path = &workspace().join("data/scenes/tunnel.toml");
    let scene = fs::read_to_string(path).unwrap();
    let shown = readme.split("```toml\n").nth(1).unwrap();
    let (shown, _) = shown.split_once("```").unwrap();
    assert_eq!(
        shown,
        scene,
        "README.md shows another scene than {}",
        path.display()
    );
    FileScene::from_file(path).unwrap().prepare().unwrap();
}
