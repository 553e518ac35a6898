//! Keyword lines with their parameters.

use super::blocks::Name;
use super::error::{InpFault, Located, snippet};
use super::line::{Field, Line, Lines};

/// Parameters of a keyword line, at most.
const MOST: usize = 32;

/// Keyword line, with the lines that continue it.
#[derive(Clone, Debug)]
pub(super) struct Keyword<'a> {
    /// Name in capitals with its star and single blanks.
    pub(super) name: String,
    pub(super) offset: usize,
    lines: Vec<Line<'a>>,
}

/// Parameters of a keyword line.
#[derive(Debug)]
pub(super) struct Parameters {
    keyword: String,
    offset: usize,
    /// Name in capitals and value, as far as there is one.
    values: Vec<(String, Option<String>)>,
}

impl<'a> Keyword<'a> {
    /// The keyword of a line, after which the reading of lines goes on.
    pub(super) fn read(line: Line<'a>, lines: &mut Lines<'a>) -> Self {
        let mut own = vec![line];
        while own.last().is_some_and(Line::is_continued) {
            match lines.data() {
                Some(line) => own.push(line),
                None => break,
            }
        }
        let first = line.fields().next();
        let text = String::from_utf8_lossy(first.map_or(b"", |field| field.text)).to_uppercase();
        let words: Vec<&str> = text.trim_start_matches('*').split_whitespace().collect();
        Self {
            name: format!("*{}", words.join(" ")),
            offset: line.offset,
            lines: own,
        }
    }
    /// A fault at the keyword line.
    pub(super) fn fault(&self, fault: impl Into<InpFault>) -> Located {
        Located::new(&self.name, self.offset, fault)
    }
    /// Parameters of the line.
    pub(super) fn parameters(&self) -> Result<Parameters, Located> {
        let mut values: Vec<(String, Option<String>)> = Vec::new();
        let fields = self.lines.iter().flat_map(Line::fields).skip(1);
        for field in fields.filter(|field| !field.text.is_empty()) {
            if values.len() == MOST {
                let (what, found) = ("the last of 32 parameters", snippet(field.text));
                let fault = InpFault::Surplus { what, found };
                return Err(Located::new(&self.name, field.offset, fault));
            }
            let (name, value) = parameter(&self.name, &field)?;
            if values.iter().any(|(known, _)| *known == name) {
                let fault = InpFault::RepeatedParameter { parameter: name };
                return Err(Located::new(&self.name, field.offset, fault));
            }
            values.push((name, value));
        }
        Ok(Parameters {
            keyword: self.name.clone(),
            offset: self.offset,
            values,
        })
    }
    /// Parameters of the line, none of which is another one than these.
    pub(super) fn only(&self, permitted: &[&str]) -> Result<Parameters, Located> {
        let parameters = self.parameters()?;
        let known = |name: &str| permitted.contains(&name);
        match parameters.values.iter().find(|(name, _)| !known(name)) {
            None => Ok(parameters),
            Some((name, _)) => Err(self.fault(InpFault::Parameter {
                keyword: self.name.clone(),
                parameter: name.clone(),
                permitted: match permitted {
                    [] => "none".into(),
                    names => names.join(", "),
                },
            })),
        }
    }
}

/// Name in capitals and value of a parameter.
fn parameter(keyword: &str, field: &Field<'_>) -> Result<(String, Option<String>), Located> {
    let word = field.word(keyword, "a parameter")?;
    Ok(match word.split_once('=') {
        Some((name, value)) => (name.trim().to_uppercase(), Some(value.trim().into())),
        None => (word.to_uppercase(), None),
    })
}

impl Parameters {
    /// Whether a parameter is given, with or without a value.
    pub(super) fn has(&self, name: &str) -> bool {
        self.values.iter().any(|(own, _)| own == name)
    }
    /// Value of a parameter; none without one.
    pub(super) fn value(&self, name: &str) -> Option<&str> {
        let found = self.values.iter().find(|(own, _)| own == name)?;
        found.1.as_deref()
    }
    /// Value of a parameter that must be given.
    pub(super) fn required(&self, parameter: &'static str) -> Result<&str, Located> {
        let value = self.value(parameter).filter(|value| !value.is_empty());
        value.ok_or_else(|| {
            let keyword = self.keyword.clone();
            let fault = InpFault::MissingParameter { keyword, parameter };
            Located::new(&self.keyword, self.offset, fault)
        })
    }
    /// Value of a parameter as a name, which must be given.
    pub(super) fn name(&self, parameter: &'static str) -> Result<Name, Located> {
        Ok(Name::new(self.required(parameter)?))
    }
    /// Value of a parameter as a name; none if the parameter is not given, a fault if it has no value.
    pub(super) fn name_if_any(&self, parameter: &'static str) -> Result<Option<Name>, Located> {
        if self.has(parameter) {
            self.name(parameter).map(Some)
        } else {
            Ok(None)
        }
    }
}
