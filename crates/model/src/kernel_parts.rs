//! What element kernels may have in addition: modes, hourglass forces and history variables of their elements.

use crate::{ElasticMedium, ElementKernel, Geometry, Hourglass, Lane, OwnStep, Strain, Stress};

/// Modes of an element kernel: a fixed linear map of nodal values, in which its arithmetic is short.
pub trait ModalKernel<const N: usize, const P: usize> {
    /// Modal values from nodal values, `T u`.
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; N]) -> [[L; 3]; N];
    /// Nodal forces from modal forces, `T^T F`.
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; N]) -> [[L; 3]; N];
    /// Modal forces (N) of a linear elastic medium with Lame's constants `[lambda, shear]` (Pa), where they are
    /// known without strains and stresses at the points; none, the default, otherwise. A kernel has them for all elements
    /// or for none, and only if it has no hourglass forces. They are not finite where a modal displacement is not.
    #[inline(always)]
    fn elastic_forces<L: Lane>(
        &self,
        _geometry: Geometry<L>,
        _moduli: [L; 2],
        _modes: &[[L; 3]; N],
    ) -> Option<[[L; 3]; N]> {
        None
    }
}

/// Hourglass forces of an element kernel, which resist deformation that its integration points do not see.
pub trait HourglassKernel<const N: usize, const P: usize> {
    /// Hourglass moduli (Pa), to which hourglass forces are proportional, of an undamaged medium, as many as the kernel
    /// needs and zeros.
    fn hourglass_moduli(&self, medium: &ElasticMedium) -> [f64; 3];
    /// Hourglass energy (J), stored by the hourglass forces of [`forces`](ElementKernel::forces).
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; N],
    ) -> L;
    /// Whether hourglass forces are those of the material in bending: their energy then counts as
    /// [`bending`](crate::BlockEnergy::bending), of which no share is too large. False by default: they are a resistance that
    /// should store little.
    fn hourglass_is_bending(&self) -> bool {
        false
    }
    /// Least share of the hourglass moduli, whatever damage leaves: a mode without stiffness would grow until its
    /// neighbours stop it. A hundredth by default.
    #[inline(always)]
    fn least_hourglass_share(&self) -> f64 {
        0.01
    }
    /// Stress (Pa) on the faces at the natural coordinates r = 1, s = 1 and t = 1 less the stress at the points, from
    /// hourglass forces that are those of the material; on the opposite faces it has the other sign. None, the default,
    /// where the stress is the same all over the element, or varies from point to point.
    fn surface_stresses(
        &self,
        _geometry: Geometry<f64>,
        _hourglass: &Hourglass<f64>,
        _modes: &[[f64; 3]; N],
    ) -> Option<[Stress; 3]> {
        None
    }
}

/// History variables of the elements of a kernel as a whole, beside those of the law at their points.
///
/// They are zero at the start, are committed with those of the law, and exist with laws that are not linear alone.
pub trait HistoryKernel<const N: usize, const P: usize> {
    /// Number of history variables of an element.
    fn own_history(&self) -> usize;
    /// Writes the own history of the elements after a step.
    fn own_history_after<L: Lane>(
        &self,
        geometry: Geometry<L>,
        step: &OwnStep<L, N, P>,
        new: &mut [L],
    );
    /// Turns the own history that a step has left into that with which the next one begins; the same by default.
    #[inline(always)]
    fn own_at_start<L: Lane>(&self, _history: &mut [L]) {}
    /// Corrects the own history towards static equilibrium within the elements, from stresses at the points, and returns
    /// whether any lane changed; `before` keeps what iterations need, pairs of equal numbers at first. False, without a
    /// change, by default.
    #[inline(always)]
    fn relax_own<L: Lane>(
        &self,
        _geometry: Geometry<L>,
        _stresses: &[Stress<L>; P],
        _history: &mut [L],
        _before: &mut [[L; 2]],
    ) -> bool {
        false
    }
    /// Number of the first numbers of the own history, three at most, in which the strains that they add are linear, and
    /// which equilibrium within the element determines; none by default.
    fn own_strains(&self) -> usize {
        0
    }
    /// Adds to the strains at the points what the own history of the elements adds; nothing by default.
    #[inline(always)]
    fn add_own_strains<L: Lane>(
        &self,
        _geometry: Geometry<L>,
        _history: &[L],
        _strains: &mut [Strain<L>; P],
    ) {
    }
}

/// Modes, hourglass forces and history variables that a kernel does not have: there is no value of this type.
#[derive(Clone, Copy, Debug)]
pub enum Absent {}

impl<const N: usize, const P: usize> ModalKernel<N, P> for Absent {
    fn modes<L: Lane>(&self, _nodal: &[[L; 3]; N]) -> [[L; 3]; N] {
        match *self {}
    }
    fn nodal_forces<L: Lane>(&self, _modal: &[[L; 3]; N]) -> [[L; 3]; N] {
        match *self {}
    }
}

impl<const N: usize, const P: usize> HourglassKernel<N, P> for Absent {
    fn hourglass_moduli(&self, _medium: &ElasticMedium) -> [f64; 3] {
        match *self {}
    }
    fn hourglass_energy<L: Lane>(
        &self,
        _geometry: Geometry<L>,
        _hourglass: &Hourglass<L>,
        _modes: &[[L; 3]; N],
    ) -> L {
        match *self {}
    }
}

impl<const N: usize, const P: usize> HistoryKernel<N, P> for Absent {
    fn own_history(&self) -> usize {
        match *self {}
    }
    fn own_history_after<L: Lane>(
        &self,
        _geometry: Geometry<L>,
        _step: &OwnStep<L, N, P>,
        _new: &mut [L],
    ) {
        match *self {}
    }
}

/// Arithmetic of any element kernel, also of one without modes, hourglass forces or history variables.
///
/// All calls are static, so that what a kernel does not have leaves no instruction behind.
pub trait KernelArithmetic<const N: usize, const P: usize>: ElementKernel<N, P> {
    /// Modal values from nodal values; nodal values without modes.
    #[inline(always)]
    fn modes<L: Lane>(&self, nodal: &[[L; 3]; N]) -> [[L; 3]; N] {
        match self.modal() {
            Some(modal) => modal.modes(nodal),
            None => *nodal,
        }
    }
    /// Nodal forces from modal forces.
    #[inline(always)]
    fn nodal_forces<L: Lane>(&self, modal: &[[L; 3]; N]) -> [[L; 3]; N] {
        match self.modal() {
            Some(own) => own.nodal_forces(modal),
            None => *modal,
        }
    }
    /// Modal forces (N) of a linear elastic medium, see [`ModalKernel::elastic_forces`].
    #[inline(always)]
    fn elastic_forces<L: Lane>(
        &self,
        geometry: Geometry<L>,
        moduli: [L; 2],
        modes: &[[L; 3]; N],
    ) -> Option<[[L; 3]; N]> {
        self.modal()?.elastic_forces(geometry, moduli, modes)
    }
    /// Hourglass moduli (Pa) of an undamaged medium; none without hourglass forces.
    fn hourglass_moduli(&self, medium: &ElasticMedium) -> Option<[f64; 3]> {
        self.hourglass()
            .map(|hourglass| hourglass.hourglass_moduli(medium))
    }
    /// Hourglass energy (J); none without hourglass forces.
    #[inline(always)]
    fn hourglass_energy<L: Lane>(
        &self,
        geometry: Geometry<L>,
        hourglass: &Hourglass<L>,
        modes: &[[L; 3]; N],
    ) -> Option<L> {
        let own = self.hourglass()?;
        Some(own.hourglass_energy(geometry, hourglass, modes))
    }
    /// Whether hourglass forces are those of the material in bending.
    #[inline(always)]
    fn hourglass_is_bending(&self) -> bool {
        match self.hourglass() {
            Some(hourglass) => hourglass.hourglass_is_bending(),
            None => false,
        }
    }
    /// Least share of the hourglass moduli, whatever damage leaves; one without hourglass forces.
    #[inline(always)]
    fn least_hourglass_share(&self) -> f64 {
        match self.hourglass() {
            Some(hourglass) => hourglass.least_hourglass_share(),
            None => 1.0,
        }
    }
    /// Stress (Pa) on three faces less that at the points, see [`HourglassKernel::surface_stresses`].
    fn surface_stresses(
        &self,
        geometry: Geometry<f64>,
        hourglass: &Hourglass<f64>,
        modes: &[[f64; 3]; N],
    ) -> Option<[Stress; 3]> {
        (self.hourglass()?).surface_stresses(geometry, hourglass, modes)
    }
    /// Number of history variables of an element as a whole.
    #[inline(always)]
    fn own_history(&self) -> usize {
        match self.history() {
            Some(history) => history.own_history(),
            None => 0,
        }
    }
    /// Writes the own history of the elements after a step.
    #[inline(always)]
    fn own_history_after<L: Lane>(
        &self,
        geometry: Geometry<L>,
        step: &OwnStep<L, N, P>,
        new: &mut [L],
    ) {
        if let Some(history) = self.history() {
            history.own_history_after(geometry, step, new);
        }
    }
    /// Turns the own history that a step has left into that with which the next one begins.
    #[inline(always)]
    fn own_at_start<L: Lane>(&self, history: &mut [L]) {
        if let Some(own) = self.history() {
            own.own_at_start(history);
        }
    }
    /// Corrects the own history towards static equilibrium within the elements; returns whether any lane changed.
    #[inline(always)]
    fn relax_own<L: Lane>(
        &self,
        geometry: Geometry<L>,
        stresses: &[Stress<L>; P],
        history: &mut [L],
        before: &mut [[L; 2]],
    ) -> bool {
        match self.history() {
            Some(own) => own.relax_own(geometry, stresses, history, before),
            None => false,
        }
    }
    /// Number of the first numbers of the own history in which the strains that they add are linear.
    #[inline(always)]
    fn own_strains(&self) -> usize {
        match self.history() {
            Some(history) => history.own_strains(),
            None => 0,
        }
    }
    /// Adds to the strains at the points what the own history of the elements adds.
    #[inline(always)]
    fn add_own_strains<L: Lane>(
        &self,
        geometry: Geometry<L>,
        history: &[L],
        strains: &mut [Strain<L>; P],
    ) {
        if let Some(own) = self.history() {
            own.add_own_strains(geometry, history, strains);
        }
    }
}

impl<K: ElementKernel<N, P>, const N: usize, const P: usize> KernelArithmetic<N, P> for K {}
