//! Second pass: members of sets and surfaces.

use std::collections::{HashMap, HashSet};

use powerhouse_model::Facet;

use super::blocks::{Name, RawMesh, SetBlock, SetKind, Source};
use super::error::{InpFault, Located, snippet};
use super::line::{Field, Lines};

/// Members of all sets, at least.
const LEAST_ROOM: usize = 1 << 20;
/// Members of all sets per node and element.
const ROOM_PER_ITEM: usize = 32;
/// Names of sets in a message, at most.
const NAMED: usize = 20;

/// Set or surface with its members, each of which may occur several times.
#[derive(Debug)]
pub(super) struct Set<T> {
    /// Name as it is first written.
    pub(super) name: String,
    pub(super) members: Vec<T>,
    /// Whether all passages that add to it call it internal.
    pub(super) internal: bool,
    in_assembly: bool,
}

/// Sets of one kind, in the order of the file.
#[derive(Debug)]
pub(super) struct Sets<T> {
    pub(super) list: Vec<Set<T>>,
    index: HashMap<String, usize>,
    names: HashSet<String>,
}

impl<T: Copy> Sets<T> {
    fn new() -> Self {
        Self {
            list: Vec::new(),
            index: HashMap::new(),
            names: HashSet::new(),
        }
    }
    fn get(&self, name: &Name) -> Option<&Set<T>> {
        self.index.get(&name.key).map(|&index| &self.list[index])
    }
    /// Adds members to the set of a block, which is made if there is none.
    fn add(
        &mut self,
        block: &SetBlock,
        what: &'static str,
        members: Vec<T>,
    ) -> Result<(), Located> {
        let next = self.list.len();
        let index = *self.index.entry(block.name.key.clone()).or_insert(next);
        let fault = |fault: InpFault| Located::new(block.keyword, block.offset, fault);
        match self.list.get_mut(index) {
            None if !self.names.insert(block.name.text.clone()) => {
                let name = block.name.text.clone();
                return Err(fault(InpFault::AlikeNames { what, name }));
            }
            None => self.list.push(Set {
                name: block.name.text.clone(),
                members,
                internal: block.internal,
                in_assembly: block.in_assembly,
            }),
            Some(set) if set.in_assembly != block.in_assembly => {
                let name = block.name.text.clone();
                return Err(fault(InpFault::SameName { what, name }));
            }
            Some(set) => {
                set.members.extend(members);
                set.internal &= block.internal;
            }
        }
        Ok(())
    }
}

/// Sets and surfaces of a file; nodes and elements by their index in the file.
#[derive(Debug)]
pub(super) struct AllSets {
    pub(super) nodes: Sets<u32>,
    pub(super) elements: Sets<u32>,
    pub(super) faces: Sets<Facet>,
}

/// Reads the members of all sets.
pub(super) fn read(bytes: &[u8], raw: &RawMesh) -> Result<AllSets, Located> {
    let items = raw.nodes.tags.len() + raw.elements.elements.len();
    let most = LEAST_ROOM.max(ROOM_PER_ITEM * items);
    let mut reader = Reader {
        raw,
        most,
        room: most,
        sets: AllSets {
            nodes: Sets::new(),
            elements: Sets::new(),
            faces: Sets::new(),
        },
    };
    // Sets that are named where nodes and elements are defined are known everywhere.
    for defined in [true, false] {
        for block in &raw.sets {
            if matches!(block.source, Source::Defined(_)) == defined {
                reader.take(bytes, block)?;
            }
        }
    }
    Ok(reader.sets)
}

struct Reader<'a> {
    raw: &'a RawMesh,
    most: usize,
    /// Members that may still be added.
    room: usize,
    sets: AllSets,
}

/// Member of a set in the file.
enum Member {
    Number(u64),
    Name(Name),
}

impl Reader<'_> {
    fn take(&mut self, bytes: &[u8], block: &SetBlock) -> Result<(), Located> {
        match (&block.source, block.kind) {
            (Source::Defined(range), kind) => {
                let members: Vec<u32> = range.clone().collect();
                self.spend(block, block.offset, members.len())?;
                self.add(kind, block, members)
            }
            (&Source::Lines { at, .. }, SetKind::Faces) => {
                let mut facets = Vec::new();
                let mut lines = Lines::new(bytes, at);
                while let Some(line) = lines.data() {
                    let mut fields = line.fields();
                    let first = fields.next();
                    let (Some(member), face, None) = (first, fields.next(), fields.next()) else {
                        return Err(no_face(block, line.offset, line.text));
                    };
                    let face = face.ok_or_else(|| no_face(block, line.offset, line.text))?;
                    self.faces(block, &member, &face, &mut facets)?;
                }
                self.sets.faces.add(block, "surface", facets)
            }
            (&Source::Lines { at, generate }, kind) => {
                let mut members = Vec::new();
                let mut lines = Lines::new(bytes, at);
                while let Some(line) = lines.data() {
                    let fields: Vec<Field<'_>> = line.fields().collect();
                    if generate {
                        self.generated(block, &fields, line.offset, &mut members)?;
                    } else {
                        let written = fields.iter().filter(|field| !field.text.is_empty());
                        for field in written {
                            self.member(block, field, &mut members)?;
                        }
                    }
                }
                self.add(kind, block, members)
            }
        }
    }

    fn add(&mut self, kind: SetKind, block: &SetBlock, members: Vec<u32>) -> Result<(), Located> {
        match kind {
            SetKind::Nodes => self.sets.nodes.add(block, "node set", members),
            _ => self.sets.elements.add(block, "element set", members),
        }
    }

    /// Refuses more members than there is room for.
    fn spend(&mut self, block: &SetBlock, offset: usize, members: usize) -> Result<(), Located> {
        let most = self.most;
        let fault = || Located::new(block.keyword, offset, InpFault::TooManyMembers { most });
        self.room = self.room.checked_sub(members).ok_or_else(fault)?;
        Ok(())
    }

    /// Index of a number; a surface and an element set have elements.
    fn index(&self, block: &SetBlock, number: u64, offset: usize) -> Result<u32, Located> {
        let (what, index) = match block.kind {
            SetKind::Nodes => ("node", &self.raw.nodes.index),
            _ => ("element", &self.raw.elements.index),
        };
        index.get(&number).copied().ok_or_else(|| {
            let set = block.name.text.clone();
            let fault = InpFault::NoSuchMember { set, what, number };
            Located::new(block.keyword, offset, fault)
        })
    }

    /// Number or name in a field, without the instance before it.
    fn named(&self, block: &SetBlock, field: &Field<'_>) -> Result<Member, Located> {
        let what = match block.kind {
            SetKind::Nodes => "a node number or the name of a node set",
            _ => "an element number or the name of an element set",
        };
        let word = field.word(block.keyword, what)?;
        let instance = self.raw.instance.as_ref().filter(|_| block.in_assembly);
        let inner = instance.and_then(|instance| {
            let (before, inner) = word.split_at_checked(instance.text.len())?;
            let inner = inner.strip_prefix('.')?;
            (Name::new(before).key == instance.key).then_some(inner)
        });
        let mut rest = *field;
        if let Some(inner) = inner {
            rest.offset += word.len() - inner.len();
            rest.text = &field.text[word.len() - inner.len()..];
        }
        if !rest.is_numeric() {
            return Ok(Member::Name(Name::new(inner.unwrap_or(word))));
        }
        let number = rest.number(block.keyword, what)?;
        match block.of_instance || inner.is_some() {
            true => Ok(Member::Number(number)),
            false => {
                let fault = InpFault::NoInstance { number };
                Err(Located::new(block.keyword, field.offset, fault))
            }
        }
    }

    /// Members of a set that is defined before.
    fn set<'s>(
        &'s self,
        block: &SetBlock,
        name: &Name,
        offset: usize,
    ) -> Result<&'s [u32], Located> {
        let (what, sets) = match block.kind {
            SetKind::Nodes => ("node", &self.sets.nodes),
            _ => ("element", &self.sets.elements),
        };
        match sets.get(name) {
            Some(set) => Ok(&set.members),
            None => {
                let names = sets.list.iter().map(|set| set.name.clone());
                let fault = InpFault::NoSuchSet {
                    what,
                    name: name.text.clone(),
                    available: names.take(NAMED).collect(),
                };
                Err(Located::new(block.keyword, offset, fault))
            }
        }
    }

    /// Adds a node, an element or the members of a set.
    fn member(
        &mut self,
        block: &SetBlock,
        field: &Field<'_>,
        members: &mut Vec<u32>,
    ) -> Result<(), Located> {
        match self.named(block, field)? {
            Member::Number(number) => {
                self.spend(block, field.offset, 1)?;
                members.push(self.index(block, number, field.offset)?);
            }
            Member::Name(name) => {
                let count = self.set(block, &name, field.offset)?.len();
                self.spend(block, field.offset, count)?;
                members.extend_from_slice(self.set(block, &name, field.offset)?);
            }
        }
        Ok(())
    }

    /// Adds the numbers from a first to a last one.
    fn generated(
        &mut self,
        block: &SetBlock,
        fields: &[Field<'_>],
        offset: usize,
        members: &mut Vec<u32>,
    ) -> Result<(), Located> {
        let what = "the first number, the last number and the increment";
        if !(2..=3).contains(&fields.len()) {
            let found = format!("{} fields", fields.len());
            let fault = InpFault::Expected { what, found };
            return Err(Located::new(block.keyword, offset, fault));
        }
        let mut values = [1; 3];
        for (value, field) in values.iter_mut().zip(fields) {
            *value = field.number(block.keyword, what)?;
        }
        if !block.of_instance {
            let fault = InpFault::NoInstance { number: values[0] };
            return Err(Located::new(block.keyword, offset, fault));
        }
        let [first, last, increment] = values;
        if last < first || (last - first) % increment != 0 {
            let fault = InpFault::Generated {
                first,
                last,
                increment,
            };
            return Err(Located::new(block.keyword, offset, fault));
        }
        // The first number that does not exist ends this.
        for i in 0..=(last - first) / increment {
            self.spend(block, offset, 1)?;
            members.push(self.index(block, first + i * increment, offset)?);
        }
        Ok(())
    }

    /// Adds a face of an element, or of those of a set.
    fn faces(
        &mut self,
        block: &SetBlock,
        member: &Field<'_>,
        face: &Field<'_>,
        facets: &mut Vec<Facet>,
    ) -> Result<(), Located> {
        let number = match face.text {
            [b'S' | b's', digit @ b'1'..=b'6'] => digit - b'0',
            _ => return Err(no_face(block, face.offset, face.text)),
        };
        let one;
        let elements = match self.named(block, member)? {
            Member::Number(number) => {
                one = [self.index(block, number, member.offset)?];
                &one[..]
            }
            Member::Name(name) => self.set(block, &name, member.offset)?,
        };
        for &element in elements {
            let raw = &self.raw.elements.elements[element as usize];
            let sides = raw.shape.corners.sides().len();
            if usize::from(number) > sides {
                let fault = InpFault::NoSuchFace {
                    element: raw.tag,
                    name: raw.shape.name,
                    face: number,
                    sides,
                };
                return Err(Located::new(block.keyword, face.offset, fault));
            }
        }
        let count = elements.len();
        // Faces of the format have the order of the sides of the kinds.
        let side = number - 1;
        let all = elements.iter().map(|&element| Facet { element, side });
        let added: Vec<Facet> = match count <= self.room {
            true => all.collect(),
            false => Vec::new(),
        };
        self.spend(block, member.offset, count)?;
        facets.extend(added);
        Ok(())
    }
}

/// Fault of a line of a surface without a face that is read.
fn no_face(block: &SetBlock, offset: usize, text: &[u8]) -> Located {
    let what = "an element or an element set with a face from S1 to S6";
    let found = snippet(text);
    Located::new(block.keyword, offset, InpFault::Expected { what, found })
}
