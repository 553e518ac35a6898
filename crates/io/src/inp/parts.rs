//! Parts, instances and the assembly, of which a file has one each at most.

use super::blocks::Name;
use super::error::{InpFault, Located, snippet};
use super::keyword::Keyword;
use super::line::Lines;

const PART: &str = "*PART";
const ASSEMBLY: &str = "*ASSEMBLY";
const INSTANCE: &str = "*INSTANCE";

/// Part, instance and assembly of the file, and those in which the reading is.
#[derive(Debug, Default)]
pub(super) struct Parts {
    part: Option<Name>,
    has_assembly: bool,
    pub(super) instance: Option<Name>,
    /// Those that have no end yet, with the offsets of their keyword lines (bytes).
    open: Vec<(&'static str, usize)>,
}

impl Parts {
    /// Whether what is read belongs to the assembly, not to the part, its instance, or a flat input.
    pub(super) fn in_assembly(&self) -> bool {
        match self.innermost() {
            Some(PART | INSTANCE) => false,
            Some(_) => true,
            None => self.part.is_some() || self.has_assembly,
        }
    }

    fn innermost(&self) -> Option<&'static str> {
        self.open.last().map(|open| open.0)
    }

    /// Begins or ends one, if the keyword is about that; `is_flat` says whether the file has nodes, elements or sets so far.
    pub(super) fn take(
        &mut self,
        keyword: &Keyword<'_>,
        lines: &mut Lines<'_>,
        is_flat: bool,
    ) -> Result<bool, Located> {
        match keyword.name.as_str() {
            PART => self.begin_part(keyword, is_flat)?,
            ASSEMBLY => {
                keyword.only(&["NAME"])?;
                self.begin(ASSEMBLY, self.has_assembly, None, keyword)?;
                self.has_assembly = true;
            }
            INSTANCE => self.begin_instance(keyword, lines)?,
            "*END PART" => self.end(PART, "after *PART", keyword)?,
            "*END ASSEMBLY" => self.end(ASSEMBLY, "after *ASSEMBLY", keyword)?,
            "*END INSTANCE" => self.end(INSTANCE, "after *INSTANCE", keyword)?,
            _ => return Ok(false),
        }
        Ok(true)
    }

    fn begin_part(&mut self, keyword: &Keyword<'_>, is_flat: bool) -> Result<(), Located> {
        let name = keyword.only(&["NAME"])?.name("NAME")?;
        self.begin(PART, self.part.is_some(), None, keyword)?;
        if is_flat || self.has_assembly {
            let place = "before all nodes, elements, sets and the assembly";
            let keyword_name = keyword.name.clone();
            return Err(keyword.fault(InpFault::Misplaced {
                keyword: keyword_name,
                place,
            }));
        }
        self.part = Some(name);
        Ok(())
    }

    fn begin_instance(
        &mut self,
        keyword: &Keyword<'_>,
        lines: &mut Lines<'_>,
    ) -> Result<(), Located> {
        let parameters = keyword.only(&["NAME", "PART"])?;
        let (name, part) = (parameters.name("NAME")?, parameters.name("PART")?);
        self.begin(INSTANCE, self.instance.is_some(), Some(ASSEMBLY), keyword)?;
        if self.part.as_ref().is_none_or(|own| own.key != part.key) {
            let (what, name) = ("part", part.text);
            return Err(keyword.fault(InpFault::NoSuchPart { what, name }));
        }
        self.instance = Some(name);
        while let Some(line) = lines.data() {
            for field in line.fields() {
                if field.real(INSTANCE, "a distance")? != 0.0 {
                    let found = snippet(line.text);
                    let fault = InpFault::Moved { found };
                    return Err(Located::new(INSTANCE, line.offset, fault));
                }
            }
        }
        Ok(())
    }

    fn begin(
        &mut self,
        name: &'static str,
        is_second: bool,
        within: Option<&'static str>,
        keyword: &Keyword<'_>,
    ) -> Result<(), Located> {
        if is_second {
            return Err(keyword.fault(InpFault::Second { keyword: name }));
        }
        if self.innermost() != within {
            let place = match within {
                None => "outside of parts, instances and assemblies",
                Some(_) => "directly in *ASSEMBLY",
            };
            let keyword_name = keyword.name.clone();
            return Err(keyword.fault(InpFault::Misplaced {
                keyword: keyword_name,
                place,
            }));
        }
        self.open.push((name, keyword.offset));
        Ok(())
    }

    fn end(
        &mut self,
        name: &'static str,
        place: &'static str,
        keyword: &Keyword<'_>,
    ) -> Result<(), Located> {
        if self.innermost() != Some(name) {
            let keyword_name = keyword.name.clone();
            return Err(keyword.fault(InpFault::Misplaced {
                keyword: keyword_name,
                place,
            }));
        }
        self.open.pop();
        Ok(())
    }

    /// The name of the instance, after the last line of the file.
    pub(super) fn finish(self) -> Result<Option<Name>, Located> {
        match self.open.last() {
            None => Ok(self.instance),
            Some(&(keyword, offset)) => Err(Located::new(
                keyword,
                offset,
                InpFault::NotEnded { keyword },
            )),
        }
    }
}
