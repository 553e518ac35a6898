//! First pass: nodes, elements, and where the lines of each set are.

use powerhouse_model::{MeshError, Vec3};

use super::blocks::{Name, RawElement, RawMesh, SetBlock, SetKind, Source};
use super::error::{InpFault, Located, snippet};
use super::keyword::{Keyword, Parameters};
use super::line::{Line, Lines};
use super::parts::Parts;
use super::shape::Shape;
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
        "*INCLUDE",
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
    raw: RawMesh,
}

/// Reads nodes, elements and the places of sets.
pub(super) fn read(bytes: &[u8], options: MeshOptions<'_>) -> Result<RawMesh, Located> {
    let mut reader = Reader {
        lines: Lines::new(bytes, 0),
        options,
        parts: Parts::default(),
        raw: RawMesh::default(),
    };
    let mut is_empty = true;
    while let Some(line) = reader.lines.next() {
        is_empty = false;
        if !line.is_keyword() {
            let found = snippet(line.text);
            return Err(Located::new("", line.offset, InpFault::NotInp { found }));
        }
        let keyword = Keyword::read(line, &mut reader.lines);
        reader.take(&keyword)?;
    }
    if is_empty {
        return Err(Located::new("", 0, InpFault::Empty));
    }
    if reader.raw.elements.elements.is_empty() {
        return Err(Located::new("", bytes.len(), InpFault::NoElements));
    }
    reader.raw.instance = reader.parts.finish()?;
    Ok(reader.raw)
}

impl Reader<'_> {
    /// Reads one keyword with its data.
    fn take(&mut self, keyword: &Keyword<'_>) -> Result<(), Located> {
        let raw = &self.raw;
        let is_flat =
            !(raw.nodes.tags.is_empty() && raw.elements.elements.is_empty() && raw.sets.is_empty());
        if self.parts.take(keyword, &mut self.lines, is_flat)? {
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
        self.raw.skipped.insert(name);
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

    /// Refuses nodes and elements of the assembly itself, such as reference points.
    fn not_of_the_assembly(&self, keyword: &Keyword<'_>) -> Result<(), Located> {
        if !self.parts.in_assembly() {
            return Ok(());
        }
        let fault = InpFault::Misplaced {
            keyword: keyword.name.clone(),
            place: "in the part or its instance, not in the assembly: leave reference points out, or write the model as a flat input",
        };
        Err(keyword.fault(fault))
    }

    fn nodes(&mut self, keyword: &Keyword<'_>) -> Result<(), Located> {
        self.not_of_the_assembly(keyword)?;
        let parameters = keyword.only(&["NSET"])?;
        let set = parameters.name_if_any("NSET")?;
        let nodes = &mut self.raw.nodes;
        let first = nodes.tags.len() as u32;
        while let Some(line) = self.lines.data() {
            let (tag, position) = node(&line)?;
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
        self.not_of_the_assembly(keyword)?;
        let parameters = keyword.only(&["TYPE", "ELSET"])?;
        let name = parameters.required("TYPE")?;
        let shape = Shape::of_name(name)
            .ok_or_else(|| keyword.fault(InpFault::ElementType { name: name.into() }))?;
        if shape.element.is_none() && !self.options.first_order {
            let name = shape.name;
            return Err(keyword.fault(InpFault::SecondOrder { name }));
        }
        let set = parameters.name_if_any("ELSET")?;
        let elements = &mut self.raw.elements;
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
        let source = Source::Defined(first..elements.elements.len() as u32);
        self.defined(SetKind::Elements, set, source, ELEMENT, keyword.offset);
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
        self.raw.sets.extend(name.map(|name| SetBlock {
            kind,
            name,
            source,
            in_assembly: false,
            of_instance: true,
            internal: false,
            keyword,
            offset,
        }));
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
        let in_assembly = self.parts.in_assembly();
        let instance = parameters.name_if_any("INSTANCE")?;
        if let Some(instance) = &instance {
            let own = self.parts.instance.as_ref();
            if own.is_none_or(|own| own.key != instance.key) {
                let (what, name) = ("instance", instance.text.clone());
                return Err(keyword.fault(InpFault::NoSuchPart { what, name }));
            }
        }
        let at = self.lines.offset();
        while self.lines.data().is_some() {}
        self.raw.sets.push(SetBlock {
            kind,
            name: set,
            source: Source::Lines { at, generate },
            in_assembly,
            of_instance: !in_assembly || instance.is_some(),
            internal: parameters.has("INTERNAL"),
            keyword: name,
            offset: keyword.offset,
        });
        Ok(())
    }
}

/// Number and position of a node.
fn node(line: &Line<'_>) -> Result<(u64, Vec3), Located> {
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
    let what = "a node number with three coordinates";
    for (axis, value) in ['x', 'y', 'z'].into_iter().zip(position.iter_mut()) {
        let field = fields.next().ok_or_else(|| missing(what))?;
        *value = field.real(NODE, "a coordinate")?;
        if !value.is_finite() {
            let (node, value) = (tag, *value);
            let fault = MeshError::CoordinateNotFinite { node, axis, value };
            return Err(Located::new(NODE, field.offset, fault));
        }
    }
    match fields.next() {
        None => Ok((tag, position)),
        Some(field) => {
            let (what, found) = ("the third coordinate", snippet(field.text));
            let fault = InpFault::Surplus { what, found };
            Err(Located::new(NODE, field.offset, fault))
        }
    }
}

/// Number of an element, whose nodes are appended; lines that end with a comma go on in the next one.
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
            let next = match line.is_continued() && found < shape.nodes {
                true => lines.data(),
                false => None,
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
