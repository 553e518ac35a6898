//! The tables of `docs/validated.md`, which these tests compute.

use std::fmt::Write;
use std::sync::Mutex;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/validated.md");
/// Set to `write`, it makes the tests write their tables in place of comparing them.
const VARIABLE: &str = "POWERHOUSE_VALIDATED";
/// The end of the list of what did not agree, and the reason of a new line of it.
const LIST_END: &str = "<!-- end of the list -->";
const UNKNOWN: &str = "reason not known yet";
/// Tests run at once, and each writes its tables into the same file.
static WRITING: Mutex<()> = Mutex::new(());

/// A figure of a problem beside the published one.
pub(super) struct Row {
    what: String,
    published: f64,
    computed: f64,
    limit: f64,
    /// What the difference is measured by: the published figure, or a given scale.
    scale: f64,
}

impl Row {
    /// A figure whose difference is relative to the published one; the limit is a share of it.
    pub(super) fn new(what: impl Into<String>, published: f64, computed: f64, limit: f64) -> Self {
        Self::over(what, published, computed, published.abs(), limit)
    }
    /// A figure whose difference is relative to a scale.
    pub(super) fn over(
        what: impl Into<String>,
        published: f64,
        computed: f64,
        scale: f64,
        limit: f64,
    ) -> Self {
        let what = what.into();
        Self {
            what,
            published,
            computed,
            limit,
            scale,
        }
    }
    fn difference(&self) -> f64 {
        (self.computed - self.published) / self.scale
    }
    fn misses(&self) -> bool {
        let size = self.difference().abs();
        size.is_nan() || size > self.limit
    }
    /// Names and figures as cells of a table.
    fn cells(&self) -> String {
        // To hundredths, without the sign of what rounds to zero.
        let percent = (1e4 * self.difference()).round() / 100.0 + 0.0;
        let [published, computed] = [self.published, self.computed].map(digits);
        format!(
            "| {} | {published} | {computed} | {percent:+.2} % |",
            self.what
        )
    }
}

/// A number to four digits.
fn digits(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 {
        return "0".into();
    }
    if (1e-3..1e5).contains(&size) {
        let decimals = (3 - size.log10().floor() as i32).max(0) as usize;
        return format!("{value:.decimals$}");
    }
    format!("{value:.3e}")
}

/// Compares the table of a problem with that of the page, and those of its rows that miss their limit with the page's list of
/// what did not agree.
///
/// # Panics
/// If the page has other figures, or other rows miss their limit than the list says.
pub(super) fn compare(problem: &str, rows: &[Row]) {
    let mut table = String::from(
        "| what | published | computed | difference | limit |\n|---|---|---|---|---|\n",
    );
    for row in rows {
        let limit = (1e4 * row.limit).round() / 100.0;
        let missed = if row.misses() { ", **missed**" } else { "" };
        writeln!(table, "{} {limit} %{missed} |", row.cells()).unwrap();
    }
    let _one = WRITING
        .lock()
        .unwrap_or_else(|poisoned| poisoned.into_inner());
    let page = std::fs::read_to_string(FILE).expect("the page");
    let block = format!("<!-- figures of {problem} -->\n");
    let start = page.find(&block).expect("the table of the problem") + block.len();
    let end = start + page[start..].find("<!-- end -->").expect("its end");
    // The list of what did not agree: a line for each missed row, whose reason is written by hand.
    let heading = format!("| {problem}: ");
    let listed: String = page
        .lines()
        .filter(|line| line.starts_with(&heading))
        .map(|line| format!("{line}\n"))
        .collect();
    let missed = rows.iter().filter(|row| row.misses());
    let expected: String = missed
        .map(|row| {
            let cells = row.cells().replacen("| ", &heading, 1);
            let name = format!("{heading}{} | ", row.what);
            let old = listed.lines().find(|line| line.starts_with(&name));
            let reason = old.and_then(|line| line.trim_end_matches(" |").splitn(5, " | ").nth(4));
            format!("{cells} {} |\n", reason.unwrap_or(UNKNOWN))
        })
        .collect();
    if std::env::var(VARIABLE).is_ok_and(|mode| mode == "write") {
        let mut fresh = format!("{}{table}{}", &page[..start], &page[end..]);
        for line in listed.lines() {
            fresh = fresh.replacen(&format!("{line}\n"), "", 1);
        }
        fresh = fresh.replacen(LIST_END, &format!("{expected}{LIST_END}"), 1);
        std::fs::write(FILE, fresh).expect("the page is written");
        return;
    }
    let again = format!("{VARIABLE}=write writes it anew");
    assert_eq!(
        &page[start..end],
        table,
        "{problem} in docs/validated.md: {again}"
    );
    assert_eq!(
        listed, expected,
        "what did not agree of {problem} in docs/validated.md: {again}"
    );
    assert!(!listed.contains(UNKNOWN), "a reason is missing: {listed}");
}
