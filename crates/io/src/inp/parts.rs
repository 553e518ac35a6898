//! Parts, instances and the assembly.

use powerhouse_model::Vec3;

use super::blocks::Name;
use super::error::{InpFault, Located, snippet};
use super::keyword::Keyword;
use super::line::Lines;

const PART: &str = "*PART";
const ASSEMBLY: &str = "*ASSEMBLY";
const INSTANCE: &str = "*INSTANCE";

/// Motion of an instance: a translation, then a rotation about a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Placing {
    /// Translation (m).
    translation: Vec3,
    /// A point of the axis (m), its direction of length one, and the angle (radians), right-handed.
    rotation: Option<(Vec3, Vec3, f64)>,
}

impl Placing {
    /// Position of a node of the part in the assembly; Rodrigues' formula.
    pub(super) fn of(&self, position: Vec3) -> Vec3 {
        let moved = position + self.translation;
        let Some((point, axis, angle)) = self.rotation else {
            return moved;
        };
        let arm = moved - point;
        let (sine, cosine) = angle.sin_cos();
        point + arm * cosine + axis.cross(&arm) * sine + axis * (axis.dot(&arm) * (1.0 - cosine))
    }
    fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// Instance of a part.
#[derive(Debug)]
pub(super) struct Instance {
    pub(super) name: Name,
    /// Index of the content of its part, and of its own content.
    pub(super) part: usize,
    pub(super) own: usize,
    /// Where it is, if not at the place of the part.
    pub(super) placing: Option<Placing>,
    pub(super) offset: usize,
}

/// Parts, instances and assembly of the file, and those in which the reading is. The content of the file itself has
/// the index 0.
#[derive(Debug, Default)]
pub(super) struct Parts {
    /// Names of the parts with the index of their content.
    parts: Vec<(Name, usize)>,
    has_assembly: bool,
    pub(super) instances: Vec<Instance>,
    /// Number of contents other than that of the file itself.
    contents: usize,
    /// Those that have no end yet, with the offsets of their keyword lines (bytes).
    open: Vec<(&'static str, usize)>,
}

impl Parts {
    /// Whether what is read belongs to the assembly, not to a part, an instance, or a flat input.
    pub(super) fn in_assembly(&self) -> bool {
        match self.innermost() {
            Some(PART | INSTANCE) => false,
            Some(_) => true,
            None => !self.parts.is_empty() || self.has_assembly,
        }
    }

    /// Index of the content to which what is read belongs.
    pub(super) fn content(&self) -> usize {
        match self.innermost() {
            Some(PART | INSTANCE) => self.contents,
            _ => 0,
        }
    }

    /// Names of the parts.
    pub(super) fn names(&self) -> impl Iterator<Item = &(Name, usize)> {
        self.parts.iter()
    }

    /// Index of an instance.
    pub(super) fn instance(&self, name: &Name) -> Option<u32> {
        let found = self
            .instances
            .iter()
            .position(|own| own.name.key == name.key);
        found.map(|index| index as u32)
    }

    fn innermost(&self) -> Option<&'static str> {
        self.open.last().map(|open| open.0)
    }

    /// Begins or ends one, if the keyword is about that; `is_flat` says whether the file has nodes, elements or sets
    /// so far that belong to none.
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
                if self.has_assembly {
                    return Err(keyword.fault(InpFault::Second { keyword: ASSEMBLY }));
                }
                self.begin(ASSEMBLY, None, keyword)?;
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
        self.begin(PART, None, keyword)?;
        if is_flat || self.has_assembly {
            let place = "before all nodes, elements, sets and the assembly";
            let keyword_name = keyword.name.clone();
            return Err(keyword.fault(InpFault::Misplaced {
                keyword: keyword_name,
                place,
            }));
        }
        if self.parts.iter().any(|(own, _)| own.key == name.key) {
            let (what, name) = ("part", name.text);
            return Err(keyword.fault(InpFault::SameName { what, name }));
        }
        self.contents += 1;
        self.parts.push((name, self.contents));
        Ok(())
    }

    fn begin_instance(
        &mut self,
        keyword: &Keyword<'_>,
        lines: &mut Lines<'_>,
    ) -> Result<(), Located> {
        let parameters = keyword.only(&["NAME", "PART"])?;
        let (name, part) = (parameters.name("NAME")?, parameters.name("PART")?);
        self.begin(INSTANCE, Some(ASSEMBLY), keyword)?;
        let own = self.parts.iter().find(|(own, _)| own.key == part.key);
        let Some(&(_, part)) = own else {
            let (what, name) = ("part", part.text);
            return Err(keyword.fault(InpFault::NoSuchPart { what, name }));
        };
        if self.instance(&name).is_some() {
            let (what, name) = ("instance", name.text);
            return Err(keyword.fault(InpFault::SameName { what, name }));
        }
        let placing = placing(lines)?;
        self.contents += 1;
        self.instances.push(Instance {
            name,
            part,
            own: self.contents,
            placing: (!placing.is_none()).then_some(placing),
            offset: keyword.offset,
        });
        Ok(())
    }

    fn begin(
        &mut self,
        name: &'static str,
        within: Option<&'static str>,
        keyword: &Keyword<'_>,
    ) -> Result<(), Located> {
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

    /// Checks that all have an end, after the last line of the file.
    pub(super) fn finish(&self) -> Result<(), Located> {
        match self.open.last() {
            None => Ok(()),
            Some(&(keyword, offset)) => Err(Located::new(
                keyword,
                offset,
                InpFault::NotEnded { keyword },
            )),
        }
    }
}

/// Reads the lines of an instance: a translation, then two points of the axis and the angle (degrees) of a rotation.
fn placing(lines: &mut Lines<'_>) -> Result<Placing, Located> {
    let mut placing = Placing::default();
    let mut count = 0;
    while let Some(line) = lines.data() {
        let mut values = [0.0; 7];
        let mut given = 0;
        let surplus = |offset, what, text: &[u8]| {
            let found = snippet(text);
            Located::new(INSTANCE, offset, InpFault::Surplus { what, found })
        };
        for field in line.fields() {
            let most = if count == 0 { 3 } else { 7 };
            if given == most || count > 1 {
                let what = "the translation and the rotation of the instance";
                return Err(surplus(field.offset, what, field.text));
            }
            if !field.text.is_empty() {
                values[given] = field.real(INSTANCE, "a distance or an angle")?;
            }
            if !values[given].is_finite() {
                let (what, found) = ("a finite number", snippet(field.text));
                return Err(Located::new(
                    INSTANCE,
                    field.offset,
                    InpFault::Expected { what, found },
                ));
            }
            given += 1;
        }
        if count == 0 {
            placing.translation = Vec3::new(values[0], values[1], values[2]);
        } else {
            let [a, b] = [0, 3].map(|i| Vec3::new(values[i], values[i + 1], values[i + 2]));
            let length = (b - a).norm();
            if given < 7 || length == 0.0 {
                let what = "two points of an axis and an angle in degrees";
                let found = snippet(line.text);
                return Err(Located::new(
                    INSTANCE,
                    line.offset,
                    InpFault::Expected { what, found },
                ));
            }
            let angle = values[6].to_radians();
            placing.rotation = (angle != 0.0).then_some((a, (b - a) / length, angle));
        }
        count += 1;
    }
    Ok(placing)
}
