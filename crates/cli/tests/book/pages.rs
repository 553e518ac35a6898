//! The README and the pages of `docs/`: the commands in their shell blocks, and their parts of scenes.

use std::fs;
use std::path::{Path, PathBuf};

/// Words that call the command of the project.
const STARTS: [&[&str]; 4] = [
    &["powerhouse"],
    &["target/release/powerhouse"],
    &["cargo", "run", "--release", "--"],
    &["cargo", "run", "--release", "-p", "powerhouse-cli", "--"],
];

/// A command in a shell block.
pub(crate) struct Line {
    /// Name of the page.
    pub(crate) page: String,
    /// Its words; those of the project begin with `powerhouse`, however the page calls it.
    pub(crate) words: Vec<String>,
}

impl Line {
    /// Whether it calls the command of the project, without `mpirun` or the like before it.
    pub(crate) fn is_own(&self) -> bool {
        self.words[0] == "powerhouse"
    }
    /// The page and the command, for messages.
    pub(crate) fn shown(&self) -> String {
        format!("{}: {}", self.page, self.words.join(" "))
    }
}

/// A block of a page.
pub(crate) enum Block {
    /// The commands of a shell block.
    Commands(Vec<Line>),
    /// A part of a scene, or another TOML file.
    Toml(String),
}

/// A page with its blocks, in their order.
pub(crate) struct Page {
    /// Name of its file.
    pub(crate) name: String,
    pub(crate) blocks: Vec<Block>,
}

impl Page {
    /// Its commands, in their order.
    pub(crate) fn lines(&self) -> impl Iterator<Item = &Line> {
        self.blocks
            .iter()
            .filter_map(|block| match block {
                Block::Commands(lines) => Some(lines),
                Block::Toml(_) => None,
            })
            .flatten()
    }
}

/// The top of the project.
pub(crate) fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The README, and then the pages of `docs/` by name.
pub(crate) fn pages() -> Vec<Page> {
    let entries = fs::read_dir(workspace().join("docs")).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|end| end == "md"));
    paths.sort();
    paths.insert(0, workspace().join("README.md"));
    let mut pages = Vec::new();
    for path in paths {
        let short = path.strip_prefix(workspace()).unwrap();
        let name = short.display().to_string();
        let blocks = blocks(&name, &fs::read_to_string(&path).unwrap());
        pages.push(Page { name, blocks });
    }
    pages
}

/// The blocks of shell commands and of TOML in the text of a page.
fn blocks(page: &str, text: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        let Some(language) = line.trim_start().strip_prefix("```") else {
            continue;
        };
        let content = lines.by_ref().take_while(|line| line.trim() != "```");
        let content = content.map(|line| format!("{line}\n")).collect::<String>();
        match language.trim() {
            "sh" => blocks.push(Block::Commands(commands(page, &content))),
            "toml" => blocks.push(Block::Toml(content)),
            _ => {}
        }
    }
    blocks
}

/// The commands of a shell block, without comments, assignments and the syntax of scripts.
fn commands(page: &str, block: &str) -> Vec<Line> {
    let mut commands = Vec::new();
    for line in block.replace("\\\n", " ").lines() {
        let words = words(line);
        let is_syntax = |word: &String| ["if", "else", "fi"].contains(&&**word);
        let no_command = |word: &String| is_syntax(word) || word.contains('=');
        if words.first().is_none_or(no_command) {
            continue;
        }
        commands.push(Line {
            page: page.to_owned(),
            words,
        });
    }
    commands
}

/// The words of a command, up to what connects it with another command or a file; those of the project begin with
/// `powerhouse`.
pub(crate) fn words(line: &str) -> Vec<String> {
    let split = shlex::split(line).unwrap_or_else(|| panic!("not the words of a command: {line}"));
    let own = STARTS
        .iter()
        .find(|start| split.len() >= start.len() && start.iter().zip(&split).all(|(a, b)| a == b));
    let Some(start) = own else { return split };
    let arguments = split.into_iter().skip(start.len());
    let arguments = arguments.take_while(|word| !["|", ">", "&", "&&", ";"].contains(&&**word));
    ["powerhouse".to_owned()]
        .into_iter()
        .chain(arguments)
        .collect()
}
