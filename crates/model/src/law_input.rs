//! Input of constitutive laws.

use crate::{Extents, Lane, Strain, Stress};

/// Location of an integration point: its position in the reference configuration and the element to which
/// it belongs, one point per lane.
#[derive(Clone, Copy, Debug)]
pub struct PointLocation<'a, L> {
    position: [L; 3],
    elements: &'a [u64],
}

impl<'a, L: Lane> PointLocation<'a, L> {
    /// A location from a position (m) and the user's element number of each lane.
    ///
    /// # Panics
    /// If the number of elements is not that of the lanes, [`Lane::WIDTH`].
    #[inline(always)]
    pub fn new(position: [L; 3], elements: &'a [u64]) -> Self {
        assert!(elements.len() == L::WIDTH, "one element per lane");
        Self { position, elements }
    }
    /// The position (m) in the reference configuration, that of the mesh.
    #[inline(always)]
    pub fn position(&self) -> [L; 3] {
        self.position
    }
    /// The user's element number of each lane.
    #[inline(always)]
    pub fn elements(&self) -> &'a [u64] {
        self.elements
    }
    /// The location in one lane, below [`Lane::WIDTH`].
    pub(crate) fn of_lane(&self, lane: usize) -> PointLocation<'a, f64> {
        PointLocation {
            position: self.position.map(|x| x.extract(lane)),
            elements: &self.elements[lane..=lane],
        }
    }
}

/// Input of a constitutive law at one integration point per lane: strain, initial stress, committed history
/// variables, widths of the element, and the location for laws that use it.
///
/// Fields may be added.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct LawInput<'a, L: Lane> {
    /// Total strain since the reference configuration (1), engineering shears.
    pub strain: Strain<L>,
    /// Initial stress (Pa), the stress at zero strain.
    pub initial: Stress<L>,
    /// Committed history variables, in the order of [`ConstitutiveLaw::history`](crate::ConstitutiveLaw::history).
    pub history: &'a [L],
    /// Widths of the element in all directions (m): a crack band is as wide as its element along the
    /// normal of the crack, [`Extents::along`].
    pub extents: Extents<L>,
    location: Option<&'a PointLocation<'a, L>>,
}

impl<'a, L: Lane> LawInput<'a, L> {
    /// An input of a strain and committed history variables, without initial stress, in an element of 1 m,
    /// without a location.
    #[inline(always)]
    pub fn new(strain: Strain<L>, history: &'a [L]) -> Self {
        let token = strain.0[0].token();
        Self {
            strain,
            initial: Stress::zero(token),
            history,
            extents: Extents::uniform(L::splat(token, 1.0)),
            location: None,
        }
    }
    /// The same input with another total strain (1), engineering shears.
    #[inline(always)]
    #[must_use]
    pub fn with_strain(mut self, strain: Strain<L>) -> Self {
        self.strain = strain;
        self
    }
    /// Sets the history variables that the law reads, such as those of a law within a law.
    #[inline(always)]
    #[must_use]
    pub fn with_history(mut self, history: &'a [L]) -> Self {
        self.history = history;
        self
    }
    /// Sets the initial stress, which is there without strain (Pa, tension positive).
    #[inline(always)]
    #[must_use]
    pub fn with_initial(mut self, initial: Stress<L>) -> Self {
        self.initial = initial;
        self
    }
    /// Sets the width of the element (m), one in all directions.
    #[inline(always)]
    #[must_use]
    pub fn with_size(self, size: L) -> Self {
        self.with_extents(Extents::uniform(size))
    }
    /// The same input in an element of other widths by direction (m).
    #[inline(always)]
    #[must_use]
    pub fn with_extents(mut self, extents: Extents<L>) -> Self {
        self.extents = extents;
        self
    }
    /// Sets the location of the point: its position and the number of its element, for laws that vary in space.
    #[inline(always)]
    #[must_use]
    pub fn with_location(mut self, location: &'a PointLocation<'a, L>) -> Self {
        self.location = Some(location);
        self
    }
    /// Location of the integration point, if the caller gives it.
    ///
    /// Engines give it to laws whose [`uses_location`](crate::ConstitutiveLaw::uses_location) returns true. Without
    /// a mesh, as in the driver of a single point, it is the origin in an element 0.
    #[inline(always)]
    pub fn location(&self) -> Option<&'a PointLocation<'a, L>> {
        self.location
    }
    /// Position (m) of the integration point in the reference configuration, for properties that vary in
    /// space, such as a strength that grows with depth.
    ///
    /// In single precision it is rounded as every number of a lane is.
    ///
    /// # Panics
    /// If there is no [`location`](Self::location): the law must return true from
    /// [`uses_location`](crate::ConstitutiveLaw::uses_location).
    #[inline(always)]
    pub fn position(&self) -> [L; 3] {
        self.location.expect(NO_LOCATION).position
    }
    /// The user's element number of each lane, for properties that are given element by element, such as a
    /// random field.
    ///
    /// # Panics
    /// As [`position`](Self::position).
    #[inline(always)]
    pub fn elements(&self) -> &'a [u64] {
        self.location.expect(NO_LOCATION).elements
    }
}

/// Message of a law that reads a location of which it has not said that it uses it.
const NO_LOCATION: &str =
    "a law that reads positions or elements returns true from `uses_location`";
