//! HTML page of a report.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::{ReportCase, ReportTable};
use powerhouse_study::StudyError;
use powerhouse_study::sweep::CaseOutcome;

/// Self-contained page.
pub(super) struct Page {
    title: String,
    sections: Vec<String>,
    body: String,
}

const STYLE: &str = "\
:root{color-scheme:light dark;--ink:#1b1f24;--paper:#fff;--line:#d5d9de;--soft:#f4f6f8;--link:#0b5cad}
@media (prefers-color-scheme:dark){:root{--ink:#e4e7ea;--paper:#15181c;--line:#3a4048;--soft:#1f242a;--link:#7db8f5}}
*{box-sizing:border-box}
body{margin:0 auto;max-width:72rem;padding:2rem 1.5rem 4rem;background:var(--paper);color:var(--ink);\
font:16px/1.5 system-ui,sans-serif}
h1{font-size:1.7rem;line-height:1.2;margin:0 0 .5rem}
h2{font-size:1.25rem;margin:2.5rem 0 .6rem;border-bottom:1px solid var(--line);padding-bottom:.2rem}
nav{display:flex;flex-wrap:wrap}nav a{color:var(--link);margin-right:1rem}
.wide{overflow-x:auto}
table{border-collapse:collapse;font-size:.85rem;margin:.6rem 0;font-variant-numeric:tabular-nums}
th,td{border-bottom:1px solid var(--line);padding:.25rem .6rem;text-align:right;vertical-align:top}td{white-space:nowrap}
th{background:var(--soft);text-align:right}
td:first-child,th:first-child{text-align:left;white-space:nowrap}
th.text{text-align:left}td.text{text-align:left;white-space:normal}td.wide-text{min-width:14rem}
figure{margin:1rem 0;break-inside:avoid}
figure img{max-width:100%;height:auto}
figcaption{font-size:.85rem;opacity:.8}
.warning{border-left:.3rem solid #d9822b;background:var(--soft);padding:.4rem .7rem;margin:.5rem 0}
.pair{display:grid;grid-template-columns:repeat(auto-fill,minmax(20rem,1fr));gap:.5rem 1rem}
.pair img{background:#fff}
summary{cursor:pointer;padding:.2rem 0}
pre{font-size:.78rem;background:var(--soft);padding:1rem;overflow-x:auto}
@page{size:A4;margin:15mm}
@media print{html{font-size:10pt}body{max-width:none;padding:0;font-size:10pt}nav{display:none}\
h2{margin:1.2rem 0 .4rem;break-after:avoid}th,td{padding:.12rem .4rem}th,td,td:first-child{white-space:normal}.pair{grid-template-columns:1fr 1fr}tr{break-inside:avoid}\
figure{margin:.4rem 0}pre{white-space:pre-wrap}}
";

impl Page {
    pub(super) fn new(title: &str) -> Self {
        Self {
            title: title.into(),
            sections: Vec::new(),
            body: String::new(),
        }
    }

    pub(super) fn section(&mut self, name: &str) {
        self.sections.push(name.into());
        let number = self.sections.len();
        let _ = writeln!(self.body, "<h2 id=\"s{number}\">{}</h2>", escaped(name));
    }

    pub(super) fn paragraph(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p>{}</p>", escaped(text));
    }

    /// Adds a highlighted box for each warning.
    pub(super) fn warnings(&mut self, texts: &[String]) {
        for text in texts {
            let _ = writeln!(
                self.body,
                "<p class=\"warning\">Warning: {}</p>",
                escaped(text)
            );
        }
    }

    pub(super) fn table(&mut self, table: &ReportTable) {
        self.body += "<div class=\"wide\"><table><thead><tr>";
        for (index, cell) in table.header.iter().enumerate() {
            // A header is aligned as the first cell of its column that is not empty.
            let mut below = table.rows.iter().filter_map(|row| row.get(index));
            let first = below.find(|cell| !cell.is_empty());
            let is_text = first.is_some_and(|cell| !class(cell).is_empty());
            let class = if is_text { " class=\"text\"" } else { "" };
            let _ = write!(self.body, "<th{class}>{}</th>", escaped(cell));
        }
        self.body += "</tr></thead><tbody>\n";
        for row in &table.rows {
            self.body += "<tr>";
            for cell in row {
                let class = class(cell);
                let _ = write!(self.body, "<td{class}>{}</td>", escaped(cell));
            }
            self.body += "</tr>\n";
        }
        self.body += "</tbody></table></div>\n";
    }

    /// Adds a table that is collapsed under its name.
    pub(super) fn folded(&mut self, name: &str, table: &ReportTable) {
        let _ = writeln!(self.body, "<details><summary>{}</summary>", escaped(name));
        self.table(table);
        self.body += "</details>\n";
    }

    /// Adds a plot or a picture as embedded data.
    pub(super) fn figure(&mut self, file: &Path, caption: &str) -> Result<(), StudyError> {
        let image = image(file, caption)?;
        let _ = writeln!(
            self.body,
            "<figure>{image}<figcaption>{}</figcaption></figure>",
            escaped(caption)
        );
        Ok(())
    }

    /// Adds plots with their captions.
    pub(super) fn figures(&mut self, plots: Vec<(PathBuf, String)>) -> Result<(), StudyError> {
        for (file, caption) in plots {
            self.figure(&file, &caption)?;
        }
        Ok(())
    }

    /// Adds plots with their captions side by side.
    pub(super) fn pairs(&mut self, plots: Vec<(PathBuf, String)>) -> Result<(), StudyError> {
        self.body += "<div class=\"pair\">\n";
        self.figures(plots)?;
        self.body += "</div>\n";
        Ok(())
    }

    /// Adds those pictures of the cases with given names that exist.
    pub(super) fn pictures(
        &mut self,
        cases: &[ReportCase],
        names: impl Fn(&CaseOutcome) -> Vec<String>,
    ) -> Result<(), StudyError> {
        self.body += "<div class=\"pair\">\n";
        for case in cases {
            for name in names(&case.outcome) {
                let file = case.folder.join("pictures").join(&name);
                if file.exists() {
                    let what = name.trim_end_matches(".png").replace('-', " ");
                    self.figure(&file, &format!("{}: {what}", case.outcome.name))?;
                }
            }
        }
        self.body += "</div>\n";
        Ok(())
    }

    /// Adds the text of a file, collapsed under its name.
    pub(super) fn file(&mut self, file: &Path) -> Result<(), StudyError> {
        if file.exists() {
            let text = String::from_utf8_lossy(&read(file)?).into_owned();
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let _ = writeln!(
                self.body,
                "<details><summary>{}</summary><pre>{}</pre></details>",
                escaped(&name),
                escaped(&text)
            );
        }
        Ok(())
    }

    /// The page as HTML.
    pub(super) fn html(&self) -> String {
        let mut contents = String::new();
        for (number, name) in self.sections.iter().enumerate() {
            let _ = write!(
                contents,
                "<a href=\"#s{}\">{}</a>",
                number + 1,
                escaped(name)
            );
        }
        let title = escaped(&self.title);
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
             <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\
             <title>{title}</title>\n<style>\n{STYLE}</style></head>\n<body>\n<h1>{title}</h1>\n\
             <nav>{contents}</nav>\n{}</body></html>\n",
            self.body
        )
    }
}

/// The style of a cell: words and checksums left-aligned, sentences in wide columns, numbers right-aligned.
fn class(cell: &str) -> &'static str {
    let is_checksum = cell.len() == 16 && cell.bytes().all(|digit| digit.is_ascii_hexdigit());
    let is_number = cell.starts_with(|first: char| first.is_ascii_digit() || first == '-');
    match cell.len() {
        25.. => " class=\"text wide-text\"",
        _ if is_checksum => " class=\"text\"",
        _ if is_number || cell.is_empty() => "",
        _ => " class=\"text\"",
    }
}

/// An image element with embedded data.
fn image(file: &Path, caption: &str) -> Result<String, StudyError> {
    let kind = match file.extension().and_then(|extension| extension.to_str()) {
        Some("svg") => "svg+xml",
        _ => "png",
    };
    let data = base64(&read(file)?);
    let caption = escaped(caption);
    Ok(format!(
        "<img alt=\"{caption}\" src=\"data:image/{kind};base64,{data}\">"
    ))
}

fn read(file: &Path) -> Result<Vec<u8>, StudyError> {
    std::fs::read(file).map_err(|source| StudyError::Read {
        file: file.into(),
        source,
    })
}

/// Base 64 with padding (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for chunk in bytes.chunks(3) {
        let byte = |index: usize| u32::from(chunk.get(index).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for letter in 0..4 {
            let digit = (bits >> (18 - 6 * letter)) & 63;
            let known = letter <= chunk.len();
            text.push(if known {
                LETTERS[digit as usize] as char
            } else {
                '='
            });
        }
    }
    text
}

/// Text with all markup characters escaped.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            other => out.push(other),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10.
    #[test]
    fn base64_is_that_of_the_standard() {
        for (bytes, text) in [
            ("", ""),
            ("f", "Zg=="),
            ("fo", "Zm8="),
            ("foo", "Zm9v"),
            ("foob", "Zm9vYg=="),
            ("fooba", "Zm9vYmE="),
            ("foobar", "Zm9vYmFy"),
        ] {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
    }

    /// All cells of a column of checksums are aligned equally, whichever digit they begin with.
    #[test]
    fn checksums_are_no_numbers() {
        assert_eq!(class("4fcb8c2c015f79b9"), class("c6cdd4256ba2a830"));
        assert_eq!(class("-1.5 %"), "");
        assert_ne!(class("sv-30"), "");
    }

    /// Text of a scene never becomes markup.
    #[test]
    fn text_stays_text() {
        assert_eq!(escaped("<a b=\"c\">&"), "&lt;a b=&quot;c&quot;&gt;&amp;");
    }
}
