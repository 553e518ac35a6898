//! Lines of a file and the fields between their commas.

use super::error::{InpFault, Located, snippet};

/// Line that is neither empty nor a comment, without blanks at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    pub(super) text: &'a [u8],
    /// Offset of its first byte that is not blank (bytes).
    pub(super) offset: usize,
}

/// Lines from an offset to an end, without comments.
#[derive(Clone, Debug)]
pub(super) struct Lines<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(bytes: &'a [u8], at: usize) -> Self {
        Self { bytes, at }
    }
    /// Offset of the next line (bytes).
    pub(super) fn offset(&self) -> usize {
        self.at
    }
    /// Next line of data; none before a keyword line and at the end.
    pub(super) fn data(&mut self) -> Option<Line<'a>> {
        let before = self.at;
        let line = self.next()?;
        if line.is_keyword() {
            self.at = before;
            return None;
        }
        Some(line)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;
    fn next(&mut self) -> Option<Line<'a>> {
        while self.at < self.bytes.len() {
            let rest = &self.bytes[self.at..];
            let end = rest.iter().position(|byte| *byte == b'\n');
            let length = end.unwrap_or(rest.len());
            let whole = &rest[..length];
            let blanks = length - whole.trim_ascii_start().len();
            let line = Line {
                text: whole.trim_ascii(),
                offset: self.at + blanks,
            };
            self.at += end.map_or(length, |end| end + 1);
            if !line.text.is_empty() && !line.text.starts_with(b"**") {
                return Some(line);
            }
        }
        None
    }
}

impl<'a> Line<'a> {
    pub(super) fn is_keyword(&self) -> bool {
        self.text.starts_with(b"*")
    }
    /// Whether a comma ends the line, so that the next one may continue it.
    pub(super) fn is_continued(&self) -> bool {
        self.text.ends_with(b",")
    }
    /// Fields between commas, except those in quotation marks; nothing after a comma at the end.
    pub(super) fn fields(&self) -> Fields<'a> {
        Fields { line: *self, at: 0 }
    }
}

/// Fields of a line, without blanks at their ends.
pub(super) struct Fields<'a> {
    line: Line<'a>,
    at: usize,
}

/// Text between two commas.
#[derive(Clone, Copy, Debug)]
pub(super) struct Field<'a> {
    pub(super) text: &'a [u8],
    pub(super) offset: usize,
}

impl<'a> Iterator for Fields<'a> {
    type Item = Field<'a>;
    fn next(&mut self) -> Option<Field<'a>> {
        let rest = self
            .line
            .text
            .get(self.at..)
            .filter(|rest| !rest.is_empty())?;
        let mut quoted = false;
        let end = rest.iter().position(|byte| {
            quoted ^= *byte == b'"';
            *byte == b',' && !quoted
        });
        let whole = &rest[..end.unwrap_or(rest.len())];
        let blanks = whole.len() - whole.trim_ascii_start().len();
        let field = Field {
            text: whole.trim_ascii(),
            offset: self.line.offset + self.at + blanks,
        };
        self.at += whole.len() + 1;
        Some(field)
    }
}

impl Field<'_> {
    fn expected(&self, keyword: &str, what: &'static str) -> Located {
        let found = snippet(self.text);
        Located::new(keyword, self.offset, InpFault::Expected { what, found })
    }
    /// Text as UTF-8.
    pub(super) fn word(&self, keyword: &str, what: &'static str) -> Result<&str, Located> {
        match std::str::from_utf8(self.text) {
            Ok(word) if !word.is_empty() => Ok(word),
            _ => Err(self.expected(keyword, what)),
        }
    }
    /// Whole number above zero.
    pub(super) fn number(&self, keyword: &str, what: &'static str) -> Result<u64, Located> {
        let word = self.word(keyword, what)?;
        match word.parse() {
            Ok(0) => Err(Located::new(keyword, self.offset, InpFault::Zero { what })),
            Ok(number) => Ok(number),
            Err(_) => Err(self.expected(keyword, what)),
        }
    }
    /// Real number, whose exponent may begin with `E` or `D`.
    pub(super) fn real(&self, keyword: &str, what: &'static str) -> Result<f64, Located> {
        let word = self.word(keyword, what)?;
        // Words such as `inf` have a `d` or an `e` without being numbers of the format.
        let is_number = word
            .bytes()
            .all(|byte| b"0123456789+-.eEdD".contains(&byte));
        let number = is_number.then(|| word.replace(['d', 'D'], "e").parse().ok());
        number.flatten().ok_or_else(|| self.expected(keyword, what))
    }
    /// Whether the field is a number or what is meant as one, not a name.
    pub(super) fn is_numeric(&self) -> bool {
        let first = self.text.first();
        first.is_some_and(|byte| byte.is_ascii_digit() || b"+-".contains(byte))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fields(text: &str) -> Vec<String> {
        let line = Lines::new(text.as_bytes(), 0).next().unwrap();
        let text = |field: Field<'_>| String::from_utf8(field.text.to_vec()).unwrap();
        line.fields().map(text).collect()
    }

    /// Comments and empty lines are left out, data end before a keyword, and offsets are those of the first letters.
    #[test]
    fn lines_are_those_of_content() {
        let text = "** first\n\n  1, 2,\r\n\t** second\n3\n*NODE\n4";
        let mut lines = Lines::new(text.as_bytes(), 0);
        let line = lines.data().unwrap();
        assert_eq!((line.text, line.offset), (&b"1, 2,"[..], 12));
        assert!(line.is_continued());
        assert_eq!(lines.data().unwrap().text, b"3");
        assert!(lines.data().is_none());
        assert_eq!(lines.next().unwrap().text, b"*NODE");
        assert_eq!(lines.data().unwrap().text, b"4");
        assert!(lines.next().is_none());
    }

    /// A comma at the end begins no field, one in quotation marks separates none, an empty field is one.
    #[test]
    fn fields_are_between_commas() {
        assert_eq!(fields(" 1 ,2, 3 ,"), ["1", "2", "3"]);
        assert_eq!(fields("\"a, b\" , S1"), ["\"a, b\"", "S1"]);
        assert_eq!(fields("1,,2"), ["1", "", "2"]);
        assert_eq!(fields("1, \"a, b"), ["1", "\"a, b"]);
    }

    /// Real numbers have exponents of both kinds and may lack digits on a side of the point.
    #[test]
    fn numbers_of_the_format_are_read() {
        for (text, value) in [
            ("1.E3", 1e3),
            ("1D3", 1e3),
            ("1.d-3", 1e-3),
            ("-.5", -0.5),
            ("+2.", 2.0),
            ("7", 7.0),
        ] {
            let field = Field {
                text: text.as_bytes(),
                offset: 0,
            };
            assert_eq!(
                field.real("*NODE", "a coordinate").unwrap(),
                value,
                "{text}"
            );
        }
        for text in ["", "inf", "nan", "1.0.0", "1e", "ed", "0x1", "1 2"] {
            let field = Field {
                text: text.as_bytes(),
                offset: 0,
            };
            assert!(field.real("*NODE", "a coordinate").is_err(), "{text}");
        }
    }
}
