//! The commands of the documentation: all of them are run, page by page and in the order of the page, or listed in
//! `sizes.rs` with the reason why they are not.

mod pages;
mod sizes;

use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

use pages::{Block, Line, Page, pages, words, workspace};
use powerhouse_test_support::TestFolder;
use sizes::{MESHED, MESHING, MODERATE, SHORT_TUTORIAL, SMALL, Size, TUTORIAL, shrink};

/// The page whose parts of scenes are put together to one scene, in a folder that it makes.
const TUTORIAL_PAGE: &str = "docs/tunnel.md";
/// That scene.
const TUTORIAL_SCENE: &str = "mine/scene.toml";

/// What is done with a command.
enum Plan {
    /// It is run with these words after `powerhouse`, and may have one of these exit status.
    Run(Vec<String>, Vec<i32>),
    /// It is not run, for a reason that is listed.
    Leave,
    /// Neither is said.
    Unknown,
}

/// Sets an option: in place of the value that it has, or at the end.
fn set_option(arguments: &mut Vec<String>, option: &str, value: &str) {
    let place = arguments.iter().position(|word| word == option);
    if let Some(given) = place.and_then(|place| arguments.get_mut(place + 1)) {
        *given = value.to_owned();
    } else {
        arguments.extend([option.to_owned(), value.to_owned()]);
    }
}

/// Whether a word is one of the page for a file or folder of the reader, such as SCENE.
fn is_of_the_reader(word: &str) -> bool {
    word.len() > 1 && word.chars().all(|c| c.is_ascii_uppercase())
}

/// What is done with a command at a size.
fn plan(line: &Line, size: &Size) -> Plan {
    if size.left().any(|left| words(left.command) == line.words) {
        return Plan::Leave;
    }
    let mut instead = size.instead.iter();
    if let Some(found) = instead.find(|instead| words(instead.command) == line.words) {
        return Plan::Run(words(found.run)[1..].to_vec(), vec![found.status]);
    }
    if !line.is_own() || line.words.iter().any(|word| is_of_the_reader(word)) {
        return Plan::Unknown;
    }
    // A folder in the home of the reader is one in the folder of the test.
    let arguments = line.words[1..].iter();
    let mut arguments: Vec<String> = arguments
        .map(|word| word.replacen("~/", "home/", 1))
        .collect();
    let mut status = vec![0];
    let keys_alone = arguments.iter().any(|word| word == "--keys");
    for short in size.short {
        if !keys_alone && arguments.first().is_some_and(|word| word == short.command) {
            set_option(&mut arguments, short.option, short.value);
            status = short.status.to_vec();
        }
    }
    Plan::Run(arguments, status)
}

/// Runs a command in a folder; a fault if it ends otherwise than it should.
fn run(folder: &Path, arguments: &[String], status: &[i32]) -> Result<(), String> {
    let start = Instant::now();
    let done = Command::new(env!("CARGO_BIN_EXE_powerhouse"))
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let shown = arguments.join(" ");
    println!("{:6.1} s  {shown}", start.elapsed().as_secs_f64());
    if done
        .status
        .code()
        .is_some_and(|code| status.contains(&code))
    {
        return Ok(());
    }
    let printed = [&done.stdout, &done.stderr].map(|bytes| {
        let text = String::from_utf8_lossy(bytes);
        let skipped = text.lines().count().saturating_sub(12);
        text.lines().skip(skipped).collect::<Vec<_>>().join("\n")
    });
    Err(format!(
        "powerhouse {shown}\n{}, not the status {status:?}\n{}",
        done.status,
        printed.join("\n")
    ))
}

/// Runs a command of a page in a folder, and returns its fault.
fn follow(folder: &Path, line: &Line, size: &Size) -> Option<String> {
    let shown = line.shown();
    match plan(line, size) {
        Plan::Run(arguments, status) => {
            let fault = run(folder, &arguments, &status).err()?;
            Some(format!("{shown}\n{fault}\n"))
        }
        Plan::Leave => None,
        Plan::Unknown => Some(format!("{shown}\nis neither run nor listed\n")),
    }
}

/// A folder with a copy of `data/`, as the top of the project has it.
fn top(name: &str) -> TestFolder {
    let folder = TestFolder::new(name);
    copy(&workspace().join("data"), &folder.join("data"));
    folder
}

/// Copies a folder with all that it holds.
fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        let target = to.join(entry.file_name());
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &target);
        } else {
            fs::copy(entry.path(), target).unwrap();
        }
    }
}

/// Follows all pages but the tutorial, in one folder: later pages find the results of earlier ones.
fn follow_all_pages(folder: &Path, size: &Size) {
    let mut faults = Vec::new();
    for page in pages().iter().filter(|page| page.name != TUTORIAL_PAGE) {
        // The path of a material test is beside the command that takes it.
        for block in &page.blocks {
            if let Block::Toml(text) = block
                && text.contains("[[leg]]")
            {
                fs::write(folder.join("PATH.toml"), text).unwrap();
            }
        }
        faults.extend(page.lines().filter_map(|line| follow(folder, line, size)));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Follows the tutorial from its first line to its last; its parts of scenes are put at the end of its scene, as it says.
fn follow_the_tutorial(folder: &Path, size: &Size) {
    let pages = pages();
    let page = pages.iter().find(|page| page.name == TUTORIAL_PAGE);
    let (mut faults, mut parts) = (Vec::new(), 0);
    for block in &page.unwrap().blocks {
        match block {
            Block::Toml(text) => {
                let scene = folder.join(TUTORIAL_SCENE);
                let before = fs::read_to_string(&scene).unwrap();
                fs::write(scene, format!("{before}\n{text}")).unwrap();
                parts += 1;
            }
            Block::Commands(lines) => {
                for line in lines {
                    if line.words == words(MESHING) {
                        let [from, to] = MESHED.map(|file| folder.join(file));
                        fs::copy(from, to).unwrap();
                    }
                    faults.extend(follow(folder, line, size));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(parts > 0);
    for file in ["mine/sweep/report.html", "mine/pulse/histories.csv"] {
        assert!(folder.join(file).is_file(), "{file}");
    }
}

/// Every command of the pages is run or is listed with a reason, and what is listed is in the pages: this fails if a
/// page has a new command that cannot be run as it is, or has lost one that is listed.
#[test]
fn every_command_is_run_or_listed() {
    let pages = pages();
    let mut faults = Vec::new();
    for (name, size) in [
        ("SMALL", &SMALL),
        ("MODERATE", &MODERATE),
        ("TUTORIAL", &TUTORIAL),
    ] {
        let of_tutorial = name == "TUTORIAL";
        let lines: Vec<&Line> = pages
            .iter()
            .filter(|page| (page.name == TUTORIAL_PAGE) == of_tutorial)
            .flat_map(Page::lines)
            .collect();
        let unknown = lines
            .iter()
            .filter(|line| matches!(plan(line, size), Plan::Unknown));
        faults.extend(unknown.map(|line| format!("{name} has no entry of {}", line.shown())));
        let left = size.left().map(|left| (left.command, left.why));
        let instead = size.instead.iter();
        let instead = instead.map(|instead| (instead.command, instead.why));
        for (command, why) in left.chain(instead) {
            if !lines.iter().any(|line| line.words == words(command)) {
                faults.push(format!("{name} lists what no page has: {command} ({why})"));
            }
        }
        let own = lines.iter().filter(|line| line.is_own()).count();
        assert!(own > 15, "{own} commands");
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The commands of the README and of the pages run, in the order of the pages, for moments and on coarse meshes.
#[test]
fn the_commands_of_the_pages_run() {
    let folder = top("book-pages");
    shrink(&folder.join("data"));
    follow_all_pages(&folder, &SMALL);
}

/// The tutorial leads from an empty folder to a report, with shorter runs than it prints.
#[test]
fn the_tutorial_leads_to_a_report() {
    follow_the_tutorial(&top("book-tutorial"), &SHORT_TUTORIAL);
}

/// The commands of the pages run on their own scenes, and the tutorial as it is printed:
/// `cargo test --release --test cli book -- --ignored --nocapture`.
#[test]
#[ignore = "takes a quarter of an hour"]
fn the_commands_of_the_pages_run_on_their_own_scenes() {
    follow_the_tutorial(&top("book-tutorial-whole"), &TUTORIAL);
    follow_all_pages(&top("book-pages-whole"), &MODERATE);
}
