//! Fibres that a scene asks for, and those that were chosen.

use core::fmt;
use std::collections::BTreeMap;

use powerhouse_model::{Fibre, Mesh, MeshError, ParameterError};

use crate::fibre_price::FibreShift;
use crate::fibres::MOST_NODES;
use crate::remark::{Kind, described, quoted};
use crate::{Error, Topic};

/// Share of the requested gain of the step below which it falls short.
const ENOUGH: f64 = 0.5;

/// Fibres that a scene asks for: added inertia of the motion across thin parts, for a longer step.
#[derive(Clone, Debug, PartialEq)]
pub struct FibreOptions {
    /// Requested stable step over that without fibres (1), above 1 and at most 10.
    pub factor: f64,
    /// Element sets with fibres; none for all parts, where fibres are thinner than a fifth of the shortest wavelength
    /// that the mesh of the part resolves.
    pub sets: Option<Vec<String>>,
    /// Largest permitted decrease of a frequency as high as that of the input (1), as estimated before the run.
    pub most_shift: f64,
}

impl FibreOptions {
    /// Fibres for a requested factor on the step (1), in all thin parts, that lower no frequency of the input by more
    /// than 1 %.
    pub fn new(factor: f64) -> Self {
        Self {
            factor,
            sets: None,
            most_shift: 0.01,
        }
    }
    /// The same in some element sets alone.
    #[must_use]
    pub fn in_sets(mut self, sets: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.sets = Some(sets.into_iter().map(Into::into).collect());
        self
    }
}

/// The fibres that were chosen for a scene, with the step that they permit.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct FibreChoice {
    /// Requested factor on the stable step (1).
    pub factor: f64,
    /// The fibres.
    pub fibres: Vec<Fibre>,
    /// Stable step without and with them (s).
    pub step_without: f64,
    /// The same with them (s).
    pub step: f64,
    /// Number of fibres by their number of nodes.
    pub sizes: BTreeMap<usize, usize>,
    /// Element sets with fibres.
    pub sets: Vec<String>,
    /// Joints with nodes in fibres.
    pub joints: Vec<String>,
    /// Number of short edges that are in no fibre because it would have nodes of joints that are solved apart, or too many
    /// nodes.
    pub cut_edges: usize,
    /// Number of fibres that were left out because they are longer than a fifth of the shortest wavelength.
    pub thick: usize,
    /// Number of elements that limit the requested step and have no fibre: of another kind, without short edges, or of
    /// other sets.
    pub without: usize,
    /// By how much they lower frequencies of the structure; none where there is no structure apart from the ground.
    pub shift: Option<FibreShift>,
}

impl FibreChoice {
    /// Stable step with fibres over that without (1).
    pub fn gain(&self) -> f64 {
        self.step / self.step_without
    }
    /// Largest added inertia over mass of a fibre (1); zero without fibres.
    pub fn most_added(&self) -> f64 {
        let added = self.fibres.iter().map(|fibre| fibre.added);
        added.fold(0.0, f64::max)
    }
    /// Whether the step is much shorter than requested.
    pub fn falls_short(&self) -> bool {
        self.gain() - 1.0 < ENOUGH * (self.factor - 1.0)
    }
    /// Number of fibres and their numbers of nodes as text: `384 of 5 nodes, 12 of 9`.
    pub fn sizes_text(&self) -> String {
        let sizes = self.sizes.iter().rev().enumerate();
        let texts = sizes.map(|(index, (nodes, count))| match index {
            0 => format!("{count} of {nodes} nodes"),
            _ => format!("{count} of {nodes}"),
        });
        texts.collect::<Vec<String>>().join(", ")
    }
}

described!(Box<FibreChoice>, |choice| Kind::warning_if(
    choice.falls_short(),
    Topic::Run
));

impl fmt::Display for FibreChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (gain, step) = (self.gain(), self.step);
        if self.fibres.is_empty() {
            write!(
                f,
                "fibres: there is none for a step {} times as long",
                self.factor
            )?;
        } else {
            write!(
                f,
                "fibres make the stable step {gain:.2} times as long ({step:.3e} s; requested {}): {} in {}, in which the motion of nodes relative to each other is up to {:.1} times as heavy; accelerations, shear forces and floor spectra there feel it first",
                self.factor,
                self.sizes_text(),
                quoted(&self.sets),
                1.0 + self.most_added(),
            )?;
        }
        if let (Some(shift), false) = (self.shift, self.fibres.is_empty()) {
            write!(f, "; {shift}")?;
        }
        if self.without > 0 {
            write!(
                f,
                "; {} elements that limit that step have none (other sets, other kinds than bricks and wedges, or no short edges)",
                self.without
            )?;
        }
        if self.thick > 0 {
            write!(
                f,
                "; {} are longer than a fifth of the shortest wavelength that the mesh resolves and were left out",
                self.thick
            )?;
        }
        if self.cut_edges > 0 {
            write!(
                f,
                "; {} short edges were left out, which would join nodes of joints that share none, or more than {MOST_NODES} nodes",
                self.cut_edges
            )?;
        }
        if !self.joints.is_empty() {
            write!(
                f,
                "; they end at {}, where impacts and spalling are those of the heavier fibres",
                quoted(&self.joints)
            )?;
        }
        Ok(())
    }
}

impl FibreChoice {
    /// Refuses fibres that lower a frequency of the input by more than permitted.
    ///
    /// # Errors
    /// [`Error::FibreShift`].
    pub(crate) fn check(&self, options: &FibreOptions) -> Result<(), Error> {
        let of_input = self.shift.and_then(|shift| shift.of_input);
        let shift = of_input.map_or(0.0, |input| input.shift);
        if shift <= options.most_shift {
            Ok(())
        } else {
            Err(Error::FibreShift {
                factor: self.factor,
                shift,
                limit: options.most_shift,
            })
        }
    }
}

impl FibreOptions {
    /// Largest requested factor on the step.
    pub const MOST: f64 = 10.0;

    /// Checks the factor and the names of the sets.
    ///
    /// # Errors
    /// [`ParameterError`] for `fibres` or `fibre_shift`; a set that the mesh does not have.
    pub fn check(&self, mesh: &Mesh) -> Result<(), Error> {
        ParameterError::check("fibres", self.factor, 1.0, Self::MOST)?;
        ParameterError::check("fibre_shift", self.most_shift, f64::MIN_POSITIVE, 1.0)?;
        for set in self.sets.iter().flatten() {
            mesh.element_set(set)
                .map_err(|error: MeshError| Error::from(error))?;
        }
        Ok(())
    }
}
