//! First pass: nodes, elements, and where the lines of each set are.

use std::collections::HashSet;

use powerhouse_model::{MeshError, Vec3};

use super::blocks::{Counts, Name, RawElement, RawMesh, RawPart, SetBlock, SetKind, Source};
use super::error::{InpFault, Located, snippet};
use super::include::INCLUDE;
use super::keyword::{Keyword, Parameters};
use super::line::{Line, Lines};
use super::parts::Parts;
use super::placed;
use super::shape::{Shape, TypeOfName};
use crate::MeshOptions;

const NODE: &str = "*NODE";
const ELEMENT: &str = "*ELEMENT";
const NODE_SET: &str = "*NSET";
const ELEMENT_SET: &str = "*ELSET";
const SURFACE: &str = "*SURFACE";

const ONE_BY_ONE: &str = "write the nodes and elements one by one";
/// Keywords that describe the mesh and are not read, with what to do instead.
const REFUSED: [(&str, &str); 11] = [
    (
        INCLUDE,
        "put the content of the other file in the place of this line",
    ),
    ("*NGEN", ONE_BY_ONE),
    ("*NFILL", ONE_BY_ONE),
    ("*NCOPY", ONE_BY_ONE),
    ("*NMAP", ONE_BY_ONE),
    ("*ELGEN", ONE_BY_ONE),
    ("*ELCOPY", ONE_BY_ONE),
    ("*SYMMETRIC MODEL GENERATION", ONE_BY_ONE),
    ("*IMPORT", ONE_BY_ONE),
    (
        "*SYSTEM",
        "write the coordinates of all nodes in the global system",
    ),
    ("*PARAMETER", "write values in the place of parameters"),
];

struct Reader<'a> {
    lines: Lines<'a>,
    options: MeshOptions<'a>,
    parts: Parts,
    /// Content of the file itself, then of each part and instance.
    contents: Vec<RawPart>,
    /// Nodes of the assembly itself, and elements of it that are left out.
    points: HashSet<u64>,
    outside: HashSet<u64>,
    counts: Counts,
}

/// Reads nodes, elements and the places of sets.
pub(super) fn read(bytes: &[u8], options: MeshOptions<'_>) -> Result<RawMesh, Located> {
    let mut reader = Reader {
        lines: Lines::new(bytes, 0),
        options,
        parts: Parts::default(),
        contents: vec![RawPart::default()],
        points: HashSet::new(),
        outside: HashSet::new(),
        counts: Counts::default(),
    };
    let mut is_empty = true;
    while let Some(line) = reader.lines.next() {
        is_empty = false;
        if !line.is_keyword() {
            let (found, known) = (snippet(line.text), crate::known_format(bytes));
            return Err(Located::new(
                "",
                line.offset,
                InpFault::NotInp { found, known },
            ));
        }
        let keyword = Keyword::read(line, &mut reader.lines);
        reader.take(&keyword)?;
    }
    if is_empty {
        return Err(Located::new("", 0, InpFault::Empty));
    }
    reader.parts.finish()?;
    let mut raw = placed::all(&reader.parts, reader.contents)?;
    (raw.points, raw.counts) = (reader.points, reader.counts);
    raw.outside = reader.outside;
    let elements = &raw.elements.elements;
    if elements.is_empty() {
        return Err(Located::new("", bytes.len(), InpFault::NoElements));
    }
    let facets = elements
        .iter()
        .filter(|element| element.shape.is_facet())
        .count();
    if facets == elements.len() {
        return Err(Located::new(
            "",
            elements[0].offset,
            InpFault::NoSolids { facets },
        ));
    }
    Ok(raw)
}

impl Reader<'_> {
    /// Reads one keyword with its data.
    fn take(&mut self, keyword: &Keyword<'_>) -> Result<(), Located> {
        let is_flat = !self.contents[0].is_empty();
        if self.parts.take(keyword, &mut self.lines, is_flat)? {
            self.contents.resize_with(
                self.parts.content().max(self.contents.len() - 1) + 1,
                RawPart::default,
            );
            return self.nothing_follows();
        }
        match keyword.name.as_str() {
            NODE => self.nodes(keyword),
            ELEMENT => self.elements(keyword),
            NODE_SET => self.set(keyword, SetKind::Nodes, NODE_SET),
            ELEMENT_SET => self.set(keyword, SetKind::Elements, ELEMENT_SET),
            SURFACE => self.surface(keyword),
            name => {
                if let Some((_, way)) = REFUSED.iter().find(|refused| refused.0 == name) {
                    let (keyword_name, way) = (name.into(), *way);
                    return Err(keyword.fault(InpFault::Keyword {
                        keyword: keyword_name,
                        way,
                    }));
                }
                self.skip(name.into());
                Ok(())
            }
        }
    }

    fn skip(&mut self, name: String) {
        while self.lines.data().is_some() {}
        self.counts.skipped.insert(name);
    }

    /// Refuses data after a keyword that has none.
    fn nothing_follows(&mut self) -> Result<(), Located> {
        match self.lines.data() {
            None => Ok(()),
            Some(line) => {
                let (what, found) = ("a keyword line without data", snippet(line.text));
                let fault = InpFault::Surplus { what, found };
                Err(Located::new("", line.offset, fault))
            }
        }
    }

    /// Content to which what is read belongs.
    fn content(&mut self) -> &mut RawPart {
        let index = self.parts.content();
        &mut self.contents[index]
    }

    /// Refuses elements of the assembly itself.
    fn not_of_the_assembly(&self, keyword: &Keyword<'_>) -> Result<(), Located> {
        if !self.parts.in_assembly() {
            return Ok(());
        }
        let fault = InpFault::Misplaced {
            keyword: keyword.name.clone(),
            place: "in a part or an instance, not in the assembly: put these elements into a part",
        };
        Err(keyword.fault(fault))
    }

    fn nodes(&mut self, keyword: &Keyword<'_>) -> Result<(), Located> {
        let parameters = keyword.only(&["NSET"])?;
        let set = parameters.name_if_any("NSET")?;
        if self.parts.in_assembly() {
            // Reference points are nodes of no element.
            while let Some(line) = self.lines.data() {
                let (tag, ..) = node(&line)?;
                self.points.insert(tag);
            }
            return Ok(());
        }
        let content = self.parts.content();
        let nodes = &mut self.contents[content].nodes;
        let first = nodes.tags.len() as u32;
        while let Some(line) = self.lines.data() {
            let (tag, position, is_whole) = node(&line)?;
            self.counts.omitted += usize::from(!is_whole);
            let index = nodes.tags.len() as u32;
            if nodes.index.insert(tag, index).is_some() {
                let fault = MeshError::DuplicateNode { node: tag };
                return Err(Located::new(NODE, line.offset, fault));
            }
            nodes.tags.push(tag);
            nodes.positions.push(position);
        }
        let source = Source::Defined(first..nodes.tags.len() as u32);
        self.defined(SetKind::Nodes, set, source, NODE, keyword.offset);
        Ok(())
    }

    fn elements(&mut self, keyword: &Keyword<'_>) -> Result<(), Located> {
        let parameters = keyword.only(&["TYPE", "ELSET"])?;
        let name = parameters.required("TYPE")?;
        let (shape, is_coupled) = match Shape::of_name(name) {
            TypeOfName::Read(shape, is_coupled) => (shape, is_coupled),
            TypeOfName::LeftOut => return self.left_out(name),
            TypeOfName::Unknown => {
                return Err(keyword.fault(InpFault::ElementType { name: name.into() }));
            }
        };
        self.not_of_the_assembly(keyword)?;
        if shape.kind(false) != shape.element && !self.options.first_order {
            let name = shape.name;
            return Err(keyword.fault(InpFault::SecondOrder { name }));
        }
        let set = parameters.name_if_any("ELSET")?;
        let content = self.parts.content();
        let elements = &mut self.contents[content].elements;
        let first = elements.elements.len() as u32;
        while let Some(line) = self.lines.data() {
            let start = elements.nodes.len();
            let tag = element(&line, &mut self.lines, shape, &mut elements.nodes)?;
            let index = elements.elements.len() as u32;
            if elements.index.insert(tag, index).is_some() {
                let fault = MeshError::DuplicateElement { element: tag };
                return Err(Located::new(ELEMENT, line.offset, fault));
            }
            elements.elements.push(RawElement {
                tag,
                shape,
                first: start,
                offset: line.offset,
            });
        }
        let end = elements.elements.len() as u32;
        if is_coupled {
            self.counts.coupled += (end - first) as usize;
        }
        let source = Source::Defined(first..end);
        self.defined(SetKind::Elements, set, source, ELEMENT, keyword.offset);
        Ok(())
    }

    /// Counts elements that are left out, such as springs; sets may name them.
    fn left_out(&mut self, name: &str) -> Result<(), Located> {
        let mut count = 0;
        while let Some(line) = self.lines.data() {
            if let Some(field) = line.fields().next() {
                let number = field.number(ELEMENT, "an element number")?;
                let is_assembly = self.parts.in_assembly();
                if is_assembly {
                    self.outside.insert(number)
                } else {
                    self.content().elements.outside.insert(number)
                };
            }
            count += 1;
        }
        *self.counts.left_out.entry(name.to_uppercase()).or_default() += count;
        Ok(())
    }

    /// The set of nodes or elements in whose definition it is named.
    fn defined(
        &mut self,
        kind: SetKind,
        name: Option<Name>,
        source: Source,
        keyword: &'static str,
        offset: usize,
    ) {
        let set = name.map(|name| SetBlock {
            kind,
            name,
            source,
            scope: None,
            instance: None,
            in_assembly: false,
            internal: false,
            keyword,
            offset,
        });
        self.content().sets.extend(set);
    }

    fn set(
        &mut self,
        keyword: &Keyword<'_>,
        kind: SetKind,
        name: &'static str,
    ) -> Result<(), Located> {
        let own = if kind == SetKind::Nodes {
            "NSET"
        } else {
            "ELSET"
        };
        let permitted = [own, "GENERATE", "INSTANCE", "INTERNAL", "UNSORTED"];
        let parameters = keyword.only(&permitted)?;
        let set = parameters.name(own)?;
        let generate = parameters.has("GENERATE");
        self.lines_of_set(keyword, &parameters, (kind, name), set, generate)
    }

    fn surface(&mut self, keyword: &Keyword<'_>) -> Result<(), Located> {
        let parameters = keyword.parameters()?;
        let by_elements = |kind: &str| kind.eq_ignore_ascii_case("ELEMENT");
        if let Some(other) = parameters.value("TYPE").filter(|kind| !by_elements(kind)) {
            self.skip(format!("{SURFACE}, TYPE={}", other.to_uppercase()));
            return Ok(());
        }
        let parameters = keyword.only(&["NAME", "TYPE", "INTERNAL"])?;
        let set = parameters.name("NAME")?;
        self.lines_of_set(keyword, &parameters, (SetKind::Faces, SURFACE), set, false)
    }

    /// Keeps where the lines of a set are.
    fn lines_of_set(
        &mut self,
        keyword: &Keyword<'_>,
        parameters: &Parameters,
        (kind, name): (SetKind, &'static str),
        set: Name,
        generate: bool,
    ) -> Result<(), Located> {
        let instance = match parameters.name_if_any("INSTANCE")? {
            None => None,
            Some(name) => match self.parts.instance(&name) {
                Some(index) => Some(index),
                None => {
                    let (what, name) = ("instance", name.text);
                    return Err(keyword.fault(InpFault::NoSuchPart { what, name }));
                }
            },
        };
        let at = self.lines.offset();
        while self.lines.data().is_some() {}
        let block = SetBlock {
            kind,
            name: set,
            source: Source::Lines { at, generate },
            scope: None,
            instance,
            in_assembly: self.parts.in_assembly(),
            internal: parameters.has("INTERNAL"),
            keyword: name,
            offset: keyword.offset,
        };
        self.content().sets.push(block);
        Ok(())
    }
}

/// Number and position of a node, and whether it has all coordinates; omitted ones are zero.
fn node(line: &Line<'_>) -> Result<(u64, Vec3, bool), Located> {
    let mut fields = line.fields();
    let missing = |what| {
        let found = snippet(line.text);
        Located::new(NODE, line.offset, InpFault::Expected { what, found })
    };
    let what = "a node number";
    let tag = fields
        .next()
        .ok_or_else(|| missing(what))?
        .number(NODE, what)?;
    let mut position = Vec3::zeros();
    let mut given = 0;
    for (axis, value) in ['x', 'y', 'z'].into_iter().zip(position.iter_mut()) {
        let Some(field) = fields.next().filter(|field| !field.text.is_empty()) else {
            continue;
        };
        *value = field.real(NODE, "a coordinate")?;
        if !value.is_finite() {
            let (node, value) = (tag, *value);
            let fault = MeshError::CoordinateNotFinite { node, axis, value };
            return Err(Located::new(NODE, field.offset, fault));
        }
        given += 1;
    }
    if given == 0 {
        return Err(missing("a node number with coordinates"));
    }
    match fields.next() {
        None => Ok((tag, position, given == 3)),
        Some(field) => {
            let (what, found) = ("the third coordinate", snippet(field.text));
            let fault = InpFault::Surplus { what, found };
            Err(Located::new(NODE, field.offset, fault))
        }
    }
}

/// Number of an element, whose nodes are appended; they go on in the next line where they are too few, with a comma
/// at the end of the line or without one.
fn element<'a>(
    line: &Line<'a>,
    lines: &mut Lines<'a>,
    shape: &Shape,
    nodes: &mut Vec<u64>,
) -> Result<u64, Located> {
    let mut line = *line;
    let mut fields = line.fields();
    let first = nodes.len();
    let mut tag = None;
    loop {
        let Some(field) = fields.next() else {
            let found = nodes.len() - first;
            let next = if found < shape.nodes {
                lines.data()
            } else {
                None
            };
            match (next, tag) {
                (Some(next), _) => {
                    line = next;
                    fields = line.fields();
                    continue;
                }
                (None, Some(tag)) if found == shape.nodes => return Ok(tag),
                (None, tag) => {
                    let fault = InpFault::NodeCount {
                        element: tag.unwrap_or_default(),
                        name: shape.name,
                        found,
                        expected: shape.nodes,
                    };
                    return Err(Located::new(ELEMENT, line.offset, fault));
                }
            }
        };
        match tag {
            None => tag = Some(field.number(ELEMENT, "an element number")?),
            Some(_) if nodes.len() - first == shape.nodes => {
                let (what, found) = ("the last node of the element", snippet(field.text));
                let fault = InpFault::Surplus { what, found };
                return Err(Located::new(ELEMENT, field.offset, fault));
            }
            Some(_) => nodes.push(field.number(ELEMENT, "a node number")?),
        }
    }
}
