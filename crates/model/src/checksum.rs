//! Checksum of bytes and numbers.

use core::fmt;

use crate::Mesh;

/// Checksum FNV-1a of 64 bits (Fowler, Noll & Vo), the same on every machine and in every version. It detects damage and
/// edited files, not forged ones.
///
/// ```
/// use powerhouse_model::Checksum;
/// let mut sum = Checksum::default();
/// sum.add_bytes(b"a");
/// assert_eq!(sum.to_string(), "af63dc4c8601ec8c");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Checksum(u64);

impl Default for Checksum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Checksum {
    /// The checksum of some bytes.
    pub fn of(bytes: &[u8]) -> Self {
        let mut sum = Self::default();
        sum.add_bytes(bytes);
        sum
    }
    /// Adds bytes. Their number is not added: bytes that follow one another count as one text.
    pub fn add_bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
    /// Adds a number, the lowest byte first.
    pub fn add_number(&mut self, number: u64) {
        self.add_bytes(&number.to_le_bytes());
    }
    /// Adds bytes with their number before them, so that none can move to what is added next unnoticed.
    pub fn add_whole(&mut self, bytes: &[u8]) {
        self.add_number(bytes.len() as u64);
        self.add_bytes(bytes);
    }
    /// Adds nodes, elements, their numbers and the named sets of a mesh.
    pub fn add_mesh(&mut self, mesh: &Mesh) {
        for position in mesh.positions() {
            let bits = position.map(f64::to_bits);
            bits.iter()
                .for_each(|bits| self.add_whole(&bits.to_le_bytes()));
        }
        for tags in [mesh.node_tags(), mesh.element_tags()] {
            self.add_number(8 * tags.len() as u64);
            tags.iter().for_each(|&tag| self.add_number(tag));
        }
        let mut add = |numbers: &[u32]| {
            self.add_number(4 * numbers.len() as u64);
            let bytes = numbers.iter().map(|number| number.to_le_bytes());
            bytes.for_each(|bytes| self.add_bytes(&bytes));
        };
        (0..mesh.element_count() as u32).for_each(|element| add(mesh.nodes_of(element)));
        for sets in [mesh.element_sets(), mesh.node_sets()] {
            sets.values().for_each(|numbers| add(numbers));
        }
        for facets in mesh.facet_sets().values() {
            let facets = facets.iter();
            let sides: Vec<u32> = facets
                .flat_map(|facet| [facet.element, u32::from(facet.side)])
                .collect();
            add(&sides);
        }
        let sets = [
            mesh.element_sets().keys().collect::<Vec<_>>(),
            mesh.node_sets().keys().collect(),
            mesh.facet_sets().keys().collect(),
        ];
        self.add_whole(format!("{sets:?}").as_bytes());
    }
    /// The checksum as a number.
    pub fn value(self) -> u64 {
        self.0
    }
}

impl fmt::Display for Checksum {
    /// Sixteen hexadecimal digits.
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        write!(formatter, "{:016x}", self.0)
    }
}
