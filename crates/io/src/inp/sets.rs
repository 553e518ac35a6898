//! Second pass: members of sets and surfaces.

use std::collections::{HashMap, HashSet};

use powerhouse_model::Facet;

use super::blocks::{Name, Placed, RawMesh, SetBlock, SetKind, Source};
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
    /// The instance to which it belongs, by index; none of a set of the assembly or a flat input.
    scope: Option<u32>,
}

/// Instance, if any, and name of a set as it is compared.
type Key = (Option<u32>, String);

/// Sets of one kind, in the order of the file.
#[derive(Debug)]
pub(super) struct Sets<T> {
    pub(super) list: Vec<Set<T>>,
    index: HashMap<Key, usize>,
    names: HashSet<Key>,
}

impl<T: Copy> Sets<T> {
    fn new() -> Self {
        Self {
            list: Vec::new(),
            index: HashMap::new(),
            names: HashSet::new(),
        }
    }
    /// The set of an instance, or of the assembly or a flat input.
    fn get(&self, scope: Option<u32>, name: &Name) -> Option<&Set<T>> {
        let index = self.index.get(&(scope, name.key.clone()));
        index.map(|&index| &self.list[index])
    }
    /// Puts the name of the instance before names that several of the instances and the assembly have.
    fn tell_apart(&mut self, instances: &[Placed]) {
        let mut scopes: HashMap<&str, (Option<u32>, bool)> = HashMap::new();
        for set in &self.list {
            let entry = scopes.entry(&set.name).or_insert((set.scope, false));
            entry.1 |= entry.0 != set.scope;
        }
        let of_several = |name: &String| scopes.get(name.as_str()).is_some_and(|found| found.1);
        let mut own: Vec<bool> = self.list.iter().map(|set| of_several(&set.name)).collect();
        // Names that differ in capitals alone are the same.
        let mut first_of: HashMap<&str, usize> = HashMap::new();
        for ((scope, key), &at) in &self.index {
            let first = *first_of.entry(key).or_insert(at);
            if self.list[first].scope != *scope {
                (own[first], own[at]) = (true, true);
            }
        }
        for (set, own) in self.list.iter_mut().zip(own) {
            if let (true, Some(scope)) = (own, set.scope) {
                set.name = format!("{}.{}", instances[scope as usize].name.text, set.name);
            }
        }
    }
    /// Adds members to the set of a block, which is made if there is none.
    fn add(
        &mut self,
        block: &SetBlock,
        what: &'static str,
        members: Vec<T>,
    ) -> Result<(), Located> {
        let next = self.list.len();
        let key = (block.scope, block.name.key.clone());
        let index = *self.index.entry(key).or_insert(next);
        let fault = |fault: InpFault| Located::new(block.keyword, block.offset, fault);
        match self.list.get_mut(index) {
            None if !self.names.insert((block.scope, block.name.text.clone())) => {
                let name = block.name.text.clone();
                return Err(fault(InpFault::AlikeNames { what, name }));
            }
            None => self.list.push(Set {
                name: block.name.text.clone(),
                members,
                internal: block.internal,
                scope: block.scope,
            }),
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
    let mut sets = reader.sets;
    sets.nodes.tell_apart(&raw.instances);
    sets.elements.tell_apart(&raw.instances);
    sets.faces.tell_apart(&raw.instances);
    Ok(sets)
}

struct Reader<'a> {
    raw: &'a RawMesh,
    most: usize,
    /// Members that may still be added.
    room: usize,
    sets: AllSets,
}

/// Member of a set in the file, and the instance that is written before it, by index.
enum Member {
    Number(Option<u32>, u64),
    Name(Option<u32>, Name),
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

    /// Index of a number of an instance; none of what is left out. A surface and an element set have elements.
    fn index(
        &self,
        block: &SetBlock,
        (instance, number): (Option<u32>, u64),
        offset: usize,
    ) -> Result<Option<u32>, Located> {
        let raw = self.raw;
        let fault = |fault| Err(Located::new(block.keyword, offset, fault));
        let is_node = block.kind == SetKind::Nodes;
        let (what, index, outside) = if is_node {
            ("node", &raw.nodes.index, &raw.points)
        } else {
            ("element", &raw.elements.index, &raw.outside)
        };
        let instance = instance.or(block.scope).or(block.instance);
        let placed = instance.map(|index| &raw.instances[index as usize]);
        let found = match placed {
            // Numbers of the assembly itself are those of its own nodes and elements.
            None if block.in_assembly && outside.contains(&number) => return Ok(None),
            None if !raw.instances.is_empty() => return fault(InpFault::NoInstance { number }),
            None => Some(number),
            Some(_) if number >= raw.numbers => None,
            Some(placed) => Some(number + placed.shift),
        };
        if let Some(index) = found.and_then(|number| index.get(&number)) {
            return Ok(Some(*index));
        }
        if !is_node && found.is_some_and(|number| raw.elements.outside.contains(&number)) {
            return Ok(None);
        }
        let set = block.name.text.clone();
        fault(InpFault::NoSuchMember { set, what, number })
    }

    /// Number or name in a field, and the instance before it.
    fn named(&self, block: &SetBlock, field: &Field<'_>) -> Result<Member, Located> {
        let what = match block.kind {
            SetKind::Nodes => "a node number or the name of a node set",
            _ => "an element number or the name of an element set",
        };
        let word = field.word(block.keyword, what)?;
        let instances = self
            .raw
            .instances
            .iter()
            .zip(0..)
            .filter(|_| block.scope.is_none());
        let inner = instances.filter_map(|(instance, index)| {
            let quoted = format!("\"{}\"", instance.name.text);
            let (before, inner) = match word.strip_prefix(quoted.as_str()) {
                Some(inner) => (instance.name.text.as_str(), inner),
                None => word.split_at_checked(instance.name.text.len())?,
            };
            let inner = inner.strip_prefix('.')?;
            let is_own = Name::new(before).key == instance.name.key || before == instance.name.text;
            is_own.then_some((index, inner))
        });
        // The longest name before a point, as `a.b` of the instances `a` and `a.b`.
        let inner = inner.min_by_key(|(_, inner)| inner.len());
        let (instance, inner) = inner.unzip();
        let mut rest = *field;
        if let Some(inner) = inner {
            rest.offset += word.len() - inner.len();
            rest.text = &field.text[word.len() - inner.len()..];
        }
        if !rest.is_numeric() {
            return Ok(Member::Name(instance, Name::new(inner.unwrap_or(word))));
        }
        Ok(Member::Number(instance, rest.number(block.keyword, what)?))
    }

    /// Members of a set that is defined before.
    fn set<'s>(
        &'s self,
        block: &SetBlock,
        (instance, name): (Option<u32>, &Name),
        offset: usize,
    ) -> Result<&'s [u32], Located> {
        let (what, sets) = match block.kind {
            SetKind::Nodes => ("node", &self.sets.nodes),
            _ => ("element", &self.sets.elements),
        };
        // A set of the only instance may be named without it.
        let only = (self.raw.instances.len() == 1).then_some(0);
        let scopes = match instance {
            Some(_) => [instance, instance],
            None => [
                block.scope,
                block.instance.or(only.filter(|_| block.scope.is_none())),
            ],
        };
        let found = scopes.into_iter().find_map(|scope| sets.get(scope, name));
        match found {
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
            Member::Number(instance, number) => {
                self.spend(block, field.offset, 1)?;
                members.extend(self.index(block, (instance, number), field.offset)?);
            }
            Member::Name(instance, name) => {
                let name = (instance, &name);
                let count = self.set(block, name, field.offset)?.len();
                self.spend(block, field.offset, count)?;
                members.extend_from_slice(self.set(block, name, field.offset)?);
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
            members.extend(self.index(block, (None, first + i * increment), offset)?);
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
        // A side of a shell is that of the solid on which it lies.
        let of_shell = [&b"SPOS"[..], b"SNEG"]
            .iter()
            .any(|name| face.text.eq_ignore_ascii_case(name));
        let number = match face.text {
            _ if of_shell => 1,
            [b'S' | b's', digit @ b'1'..=b'6'] => digit - b'0',
            _ => return Err(no_face(block, face.offset, face.text)),
        };
        let one;
        let elements = match self.named(block, member)? {
            Member::Number(instance, number) => {
                one = self.index(block, (instance, number), member.offset)?;
                one.as_slice()
            }
            Member::Name(instance, name) => self.set(block, (instance, &name), member.offset)?,
        };
        for &element in elements {
            let raw = &self.raw.elements.elements[element as usize];
            let kind = self
                .raw
                .elements
                .collapsed
                .get(&element)
                .map(|collapsed| collapsed.1);
            let kind = kind.or(raw.shape.solid);
            if of_shell != kind.is_none() {
                return Err(no_face(block, face.offset, face.text));
            }
            let sides = kind.map_or(1, |kind| kind.sides().len());
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
        // Of a solid with repeated nodes a side may have vanished.
        let collapsed = &self.raw.elements.collapsed;
        let all = elements.iter().filter_map(|&element| {
            let side = match collapsed.get(&element) {
                Some((solid, kind, nodes)) => {
                    solid.side((*kind, &nodes[..kind.node_count()]), side.into())?
                }
                None => side,
            };
            Some(Facet { element, side })
        });
        let added: Vec<Facet> = if count <= self.room {
            all.collect()
        } else {
            Vec::new()
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
