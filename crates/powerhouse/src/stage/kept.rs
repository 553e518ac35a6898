//! A body at rest as a file, to the last bit.
//!
//! Numbers stand as their bytes, the lowest first, in the order of the fields; a list begins with its
//! length. A file that is cut short or damaged is told by its checksum.

use std::path::Path;

use powerhouse_explicit_core::{HourglassShare, StageReport, StaticReport};
use powerhouse_io::write_whole;
use powerhouse_model::{
    Bond, Cast, ContactState, HistoryField, JointHistory, JointRecord, JointState, State, Stress,
    Vec3,
};

use super::EquilibratedBody;
use crate::Error;

/// What a file begins with; the number goes up with every change of what follows.
const HEAD: &[u8] = b"powerhouse body at rest 3\n";

impl EquilibratedBody {
    /// Writes the body as a file, whole or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, file: &Path) -> Result<(), Error> {
        let mut bytes = HEAD.to_vec();
        self.put(&mut bytes);
        let sum = checksum(&bytes);
        sum.put(&mut bytes);
        Ok(write_whole(file, &bytes)?)
    }

    /// Reads a body that was [written](Self::write): the same to the last bit.
    ///
    /// # Errors
    /// A file that cannot be read, [`Error::NotABody`] for one that holds no whole body.
    pub fn read(file: &Path) -> Result<Self, Error> {
        let bytes = std::fs::read(file).map_err(|source| Error::Read {
            path: file.into(),
            source,
        })?;
        let whole = || {
            let end = bytes.len().checked_sub(size_of::<u64>())?;
            let (content, mut sum) = bytes.split_at(end);
            let mut rest = content.strip_prefix(HEAD)?;
            if u64::get(&mut sum)? != checksum(content) {
                return None;
            }
            let body = Self::get(&mut rest)?;
            rest.is_empty().then_some(body)
        };
        whole().ok_or_else(|| Error::NotABody { path: file.into() })
    }
}

/// FNV-1a over 64 bits (Fowler, Noll & Vo), eight bytes at a time.
fn checksum(bytes: &[u8]) -> u64 {
    let words = bytes.chunks(size_of::<u64>()).map(|chunk| {
        let mut word = [0; size_of::<u64>()];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    words.fold(0xcbf2_9ce4_8422_2325, |sum: u64, word| {
        (sum ^ word).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

/// What can stand in the file.
trait Kept: Sized {
    fn put(&self, out: &mut Vec<u8>);
    /// Takes it off the front; none if it does not stand there.
    fn get(from: &mut &[u8]) -> Option<Self>;
}

macro_rules! kept_number {
    ($($number:ty),+) => {
        $(
            impl Kept for $number {
                fn put(&self, out: &mut Vec<u8>) {
                    out.extend_from_slice(&self.to_le_bytes());
                }
                fn get(from: &mut &[u8]) -> Option<Self> {
                    let (bytes, rest) = from.split_first_chunk()?;
                    *from = rest;
                    Some(Self::from_le_bytes(*bytes))
                }
            }
        )+
    };
}
kept_number!(u8, u32, u64, f64);

impl Kept for usize {
    fn put(&self, out: &mut Vec<u8>) {
        (*self as u64).put(out);
    }
    fn get(from: &mut &[u8]) -> Option<Self> {
        u64::get(from)?.try_into().ok()
    }
}

impl<T: Kept> Kept for Vec<T> {
    fn put(&self, out: &mut Vec<u8>) {
        self.len().put(out);
        self.iter().for_each(|item| item.put(out));
    }
    fn get(from: &mut &[u8]) -> Option<Self> {
        let count = usize::get(from)?;
        (0..count).map(|_| T::get(from)).collect()
    }
}

impl Kept for String {
    fn put(&self, out: &mut Vec<u8>) {
        self.as_bytes().to_vec().put(out);
    }
    fn get(from: &mut &[u8]) -> Option<Self> {
        Self::from_utf8(Vec::get(from)?).ok()
    }
}

impl<T: Kept + Copy + Default, const N: usize> Kept for [T; N] {
    fn put(&self, out: &mut Vec<u8>) {
        self.iter().for_each(|item| item.put(out));
    }
    fn get(from: &mut &[u8]) -> Option<Self> {
        let mut items = [T::default(); N];
        for item in &mut items {
            *item = T::get(from)?;
        }
        Some(items)
    }
}

impl<A: Kept, B: Kept> Kept for (A, B) {
    fn put(&self, out: &mut Vec<u8>) {
        self.0.put(out);
        self.1.put(out);
    }
    fn get(from: &mut &[u8]) -> Option<Self> {
        Some((A::get(from)?, B::get(from)?))
    }
}

impl<T: Kept> Kept for Option<T> {
    fn put(&self, out: &mut Vec<u8>) {
        u8::from(self.is_some()).put(out);
        self.iter().for_each(|item| item.put(out));
    }
    fn get(from: &mut &[u8]) -> Option<Self> {
        match u8::get(from)? {
            0 => Some(None),
            1 => Some(Some(T::get(from)?)),
            _ => None,
        }
    }
}

impl Kept for Vec3 {
    fn put(&self, out: &mut Vec<u8>) {
        <[f64; 3]>::from(*self).put(out);
    }
    fn get(from: &mut &[u8]) -> Option<Self> {
        <[f64; 3]>::get(from).map(Self::from)
    }
}

impl Kept for Stress {
    fn put(&self, out: &mut Vec<u8>) {
        self.0.put(out);
    }
    fn get(from: &mut &[u8]) -> Option<Self> {
        Kept::get(from).map(Self)
    }
}

/// Unit variants by their place in a list.
macro_rules! kept_choice {
    ($name:ident { $($variant:ident),+ }) => {
        impl Kept for $name {
            fn put(&self, out: &mut Vec<u8>) {
                (*self as u8).put(out);
            }
            fn get(from: &mut &[u8]) -> Option<Self> {
                let found = u8::get(from)?;
                [$(Self::$variant),+].into_iter().find(|variant| *variant as u8 == found)
            }
        }
    };
}
kept_choice!(ContactState { Stick, Slide, Open });
kept_choice!(Bond {
    Never,
    Intact,
    Broken
});

/// Structures field by field; one that is forgotten does not compile.
macro_rules! kept_fields {
    ($name:ident { $($field:ident),+ $(,)? }) => {
        impl Kept for $name {
            fn put(&self, out: &mut Vec<u8>) {
                let Self { $($field),+ } = self;
                $($field.put(out);)+
            }
            fn get(from: &mut &[u8]) -> Option<Self> {
                $(let $field = Kept::get(from)?;)+
                Some(Self { $($field),+ })
            }
        }
    };
}
/// Structures that may get further fields; a test compares the lists with the fields that they have.
macro_rules! kept_open_fields {
    ($name:ident { $($field:ident),+ $(,)? }) => {
        impl Kept for $name {
            fn put(&self, out: &mut Vec<u8>) {
                $(self.$field.put(out);)+
            }
            fn get(from: &mut &[u8]) -> Option<Self> {
                let mut read = Self::default();
                $(read.$field = Kept::get(from)?;)+
                Some(read)
            }
        }
        #[cfg(test)]
        impl KeptFields for $name {
            const KEPT: &'static [&'static str] = &[$(stringify!($field)),+];
        }
    };
}
kept_fields!(JointState {
    contact,
    bond,
    slip
});
kept_fields!(JointRecord {
    state,
    traction,
    opening,
    peak_opening,
    anchor,
    first_slip,
    first_crack,
    friction,
    bond_energy,
    impact,
    closed_at,
});
kept_fields!(JointHistory {
    name,
    nodes,
    records
});
kept_open_fields!(HistoryField {
    name,
    elements,
    points,
    values
});
kept_fields!(Cast {
    elements,
    displacement
});
kept_open_fields!(State {
    time,
    step,
    displacement,
    velocity,
    stage_start,
    initial_stress,
    absent,
    casts,
    standing,
    history,
    joints,
});
kept_fields!(StaticReport {
    increments,
    corrections,
    products,
    factorisations,
    factor_entries,
    steps,
    residual,
    load,
    unbalanced,
});
kept_fields!(StageReport {
    name,
    excavated,
    cast,
    solution,
    largest_displacement,
    hourglass,
});
kept_fields!(HourglassShare {
    set,
    hourglass,
    internal,
});
kept_fields!(EquilibratedBody { state, stages });

/// The fields of a structure that a file holds.
#[cfg(test)]
trait KeptFields: Default + core::fmt::Debug {
    const KEPT: &'static [&'static str];
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file holds every field of a structure: no field that a structure gets later is forgotten.
    #[test]
    fn no_field_is_forgotten() {
        fn check<T: KeptFields>() {
            let shown = format!("{:#?}", T::default());
            let lines = shown.lines().filter_map(|line| line.strip_prefix("    "));
            let fields = lines.filter(|line| line.starts_with(|first: char| first.is_alphabetic()));
            let fields: Vec<&str> = fields.filter_map(|line| line.split(':').next()).collect();
            assert_eq!(fields, T::KEPT);
        }
        check::<State>();
        check::<HistoryField>();
    }
}
