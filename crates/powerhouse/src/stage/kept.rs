//! File of a body in static equilibrium, to the last bit.
//!
//! Numbers are written as their bytes, the lowest first, in the order of the fields; a list begins with its
//! length. A file that is cut short or damaged is detected by its checksum.

use std::path::Path;

use powerhouse_io::write_whole;
use powerhouse_model::{
    Bond, Cast, ContactState, HistoryField, HourglassShare, JointHistory, JointRecord, JointState,
    StageReport, State, StaticReport, Stress, Vec3,
};

use super::EquilibratedBody;
use crate::Error;

/// Head of a file; the number is the version of the format, which changes with the fields.
const HEAD: &[u8] = b"powerhouse body at rest 4\n";

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
    /// A file that cannot be read, [`Error::UnreadableBody`] for one that holds no whole body.
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
        whole().ok_or_else(|| Error::UnreadableBody { path: file.into() })
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

/// Value that can be written to the file and read from it.
trait Kept: Sized {
    fn put(&self, out: &mut Vec<u8>);
    /// Takes the value off the front; none if the front holds no such value.
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

/// Unit variants by their index in a list.
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

/// Structures field by field; one that is missing in the list does not compile.
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

/// Structures that other crates may extend, field by field. That no field is missing in a list is
/// tested.
macro_rules! kept_open_fields {
    ($name:ident { $($field:ident),+ $(,)? }) => {
        impl Kept for $name {
            fn put(&self, out: &mut Vec<u8>) {
                $(self.$field.put(out);)+
            }
            fn get(from: &mut &[u8]) -> Option<Self> {
                let mut kept = Self::default();
                $(kept.$field = Kept::get(from)?;)+
                Some(kept)
            }
        }
    };
}

kept_open_fields!(JointState {
    contact,
    bond,
    slip
});
kept_open_fields!(JointRecord {
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
    dilation,
});
kept_open_fields!(JointHistory {
    name,
    nodes,
    records,
    variables,
    history,
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
    carried_forces,
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
