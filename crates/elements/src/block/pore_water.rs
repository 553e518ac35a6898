//! Water in the pores of a material: effective stress, and the stiffness of water that cannot flow out.

use std::sync::Arc;

#[cfg(feature = "programs")]
use powerhouse_model::RemainingStiffness;
use powerhouse_model::{
    EXCESS_PORE_PRESSURE, ElasticDomain, ElasticMedium, ElementKernel, Geometry, HistoryVariable,
    Lane, LawEnergy, LawInput, ModelError, PORE_PRESSURE, PORE_PRESSURE_RATIO, ParameterError,
    Strain, Stress,
};
#[cfg(feature = "programs")]
use powerhouse_program::Traced;

use super::Block;
use super::history::History;
use super::law::{BatchLaw, BatchLaws, Energies, ErasedLaw, Evaluation, HistoryAccess, differ};
use super::memory::{as_lanes, as_lanes_mut};
use super::operations::{Material, Moduli};
use super::survey::complementary_density;
use super::transfer::NodeScalar;
use super::water_pressure::WaterPressure;
use crate::lanes::{BatchLane, BatchOperation, BatchScalar, Lanes};

/// Water that fills the pores of a material.
///
/// The law of the material sees the effective stress `sigma' = sigma + p I` (tension positive), where `p` is the pressure of
/// the water. In static states the water is drained, unless they are [undrained](Drainage): `p` is a pressure by
/// height. In dynamic steps it cannot flow: with the change of volume strain `e` since the last drained state it grows by `-K e`,
/// where `K` is the bulk modulus of water over the porosity, grains being incompressible.
///
/// ```
/// use powerhouse_elements::{PoreWater, WaterPressure};
/// let water = PoreWater::new(2.2e9, 0.4)?.with_pressure(WaterPressure::hydrostatic(-3.0, 9810.0)?);
/// assert_eq!(water.stiffness(), 5.5e9);
/// assert_eq!((water.pressure(-5.0), water.pressure(1.0)), (19_620.0, 0.0));
/// # Ok::<(), powerhouse_model::ParameterError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PoreWater {
    stiffness: f64,
    at_rest: Option<WaterPressure>,
}

impl PoreWater {
    /// Water with a bulk modulus (Pa) in a material with a porosity, above 0 and at most 1; without a pressure at the start.
    ///
    /// # Errors
    /// A parameter outside its range.
    pub fn new(bulk_modulus: f64, porosity: f64) -> Result<Self, ParameterError> {
        ParameterError::check("bulk_modulus", bulk_modulus, f64::MIN_POSITIVE, f64::MAX)?;
        ParameterError::check("porosity", porosity, f64::MIN_POSITIVE, 1.0)?;
        let stiffness = bulk_modulus / porosity;
        ParameterError::check("bulk_modulus", stiffness, f64::MIN_POSITIVE, f64::MAX)?;
        Ok(Self {
            stiffness,
            at_rest: None,
        })
    }
    /// The same water with a pressure in static states.
    #[must_use]
    pub fn with_pressure(self, pressure: WaterPressure) -> Self {
        Self {
            at_rest: Some(pressure),
            ..self
        }
    }
    /// The same water without pressure in static states.
    #[must_use]
    pub fn without_pressure(self) -> Self {
        Self {
            at_rest: None,
            ..self
        }
    }
    /// Pressure per volume strain of water that cannot flow (Pa).
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }
    /// The pressure in static states by height, if there is one.
    pub fn at_rest(&self) -> Option<&WaterPressure> {
        self.at_rest.as_ref()
    }
    /// Pressure (Pa) at a height z (m) in static states.
    pub fn pressure(&self, height: f64) -> f64 {
        (self.at_rest.as_ref()).map_or(0.0, |at_rest| at_rest.pressure(height))
    }
    /// Increase of the pressure per height z (Pa/m) at a height (m) in static states.
    pub fn slope(&self, height: f64) -> f64 {
        (self.at_rest.as_ref()).map_or(0.0, |at_rest| at_rest.slope(height))
    }
    /// The medium of a skeleton with water that cannot flow. Its density is that of the skeleton's medium: grains and water
    /// together.
    pub fn undrained(&self, skeleton: &ElasticMedium) -> ElasticMedium {
        undrained(skeleton, self.stiffness)
    }
}

/// The medium of a skeleton with water of a pressure per volume strain (Pa) that cannot flow.
fn undrained(skeleton: &ElasticMedium, stiffness: f64) -> ElasticMedium {
    let (shear, bulk) = (skeleton.shear(), skeleton.bulk() + stiffness);
    let poisson = (3.0 * bulk - 2.0 * shear) / (2.0 * (3.0 * bulk + shear));
    ElasticMedium {
        young: 2.0 * shear * (1.0 + poisson),
        poisson,
        density: skeleton.density,
    }
}

/// Whether the water in pores flows in static states.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drainage {
    /// It flows, and what its pressure had risen by is gone.
    #[default]
    Drained,
    /// It cannot flow, as in dynamic steps.
    Undrained,
}

/// History variables of the water, after those of the skeleton: volume strain and vertical effective stress at the last drained
/// state, and the pressure beyond that of drained states, the only one that undrained states change.
pub(super) const VARIABLES: [HistoryVariable; 3] = [
    HistoryVariable::component("volume_strain_at_rest", "1"),
    HistoryVariable::component("vertical_stress_at_rest", "Pa"),
    EXCESS_PORE_PRESSURE,
];
/// Places of the last two of them.
const VERTICAL: usize = 1;
const EXCESS: usize = 2;
/// Component of stress along z.
const ZZ: usize = 2;

/// Volume strain (1).
#[inline(always)]
fn volume<L: Lane>(strain: &[L; 6]) -> L {
    strain[0] + strain[1] + strain[2]
}

/// Pressure (Pa) beyond that of drained states: from the volume strain of the last of them, the strain, and the pressure per
/// volume strain.
#[inline(always)]
fn rise<L: Lane>(at_rest: L, strain: &[L; 6], stiffness: L) -> L {
    (at_rest - volume(strain)) * stiffness
}

/// Law of a skeleton with water in its pores; stresses are total ones, initial stresses effective ones.
pub(super) struct Saturated<I: ?Sized> {
    skeleton: Arc<I>,
    /// Pressure of the water per volume strain (Pa).
    stiffness: f64,
    is_drained: bool,
    history: Arc<[HistoryVariable]>,
}

impl<I: ?Sized + ErasedLaw> Saturated<I> {
    /// The law of a skeleton with a pressure of the water per volume strain (Pa), drained or not.
    pub(super) fn new(skeleton: Arc<I>, stiffness: f64, is_drained: bool) -> Self {
        let history = skeleton.history().iter().chain(&VARIABLES);
        let history = history.copied().collect();
        Self {
            skeleton,
            stiffness,
            is_drained,
            history,
        }
    }
    /// Growth of the pressure since the last drained state, at a strain and with the history of a point.
    fn excess(&self, strain: &Strain, history: &[f64]) -> f64 {
        let at_rest = history[self.skeleton.history().len()];
        if self.is_drained {
            0.0
        } else {
            rise(at_rest, &strain.0, self.stiffness)
        }
    }
    /// The input of the skeleton.
    fn of_skeleton<'a>(&self, input: &LawInput<'a, f64>) -> LawInput<'a, f64> {
        let own = self.skeleton.history().len();
        input.with_history(&input.history[..own])
    }
}

impl<I: ?Sized + ErasedLaw> ErasedLaw for Saturated<I> {
    fn name(&self) -> &str {
        self.skeleton.name()
    }
    fn medium(&self) -> ElasticMedium {
        let skeleton = self.skeleton.medium();
        if self.is_drained {
            skeleton
        } else {
            undrained(&skeleton, self.stiffness)
        }
    }
    fn is_linear(&self) -> bool {
        false
    }
    fn history(&self) -> &[HistoryVariable] {
        &self.history
    }
    fn uses_location(&self) -> bool {
        self.skeleton.uses_location()
    }
    #[cfg(feature = "programs")]
    fn is_in_lanes(&self) -> bool {
        false
    }
    fn takes_blocks(&self) -> bool {
        self.skeleton.takes_blocks()
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        self.skeleton.accept_size(size)
    }
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress {
        let excess = self.excess(&input.strain, input.history);
        let (of_skeleton, of_water) = new_history.split_at_mut(self.skeleton.history().len());
        let mut stress = (self.skeleton).stress_change(&self.of_skeleton(input), of_skeleton);
        let vertical = input.initial.0[ZZ] + stress.0[ZZ];
        for normal in &mut stress.0[..3] {
            *normal -= excess;
        }
        let old = &input.history[of_skeleton.len()..];
        of_water.copy_from_slice(&if self.is_drained {
            [volume(&input.strain.0), vertical, excess]
        } else {
            [old[0], old[VERTICAL], excess]
        });
        stress
    }
    fn energy(&self, input: &LawInput<f64>, new_history: &[f64]) -> Option<LawEnergy<f64>> {
        let of_skeleton = &new_history[..self.skeleton.history().len()];
        let energy = self
            .skeleton
            .energy(&self.of_skeleton(input), of_skeleton)?;
        let excess = self.excess(&input.strain, input.history);
        let stored = energy.stored + 0.5 * excess * excess / self.stiffness;
        let energy = LawEnergy::stored(stored)
            .with_plastic(energy.plastic)
            .with_damage(energy.damage)
            .with_recovered(energy.recovered);
        Some(energy)
    }
    fn hourglass_share(&self, input: &LawInput<f64>, new_history: &[f64], change: &Stress) -> f64 {
        let excess = self.excess(&input.strain, input.history);
        let mut change = *change;
        for normal in &mut change.0[..3] {
            *normal += excess;
        }
        let of_skeleton = &new_history[..self.skeleton.history().len()];
        (self.skeleton).hourglass_share(&self.of_skeleton(input), of_skeleton, &change)
    }
    fn tangent(&self, input: &LawInput<f64>) -> Option<[[f64; 6]; 6]> {
        let mut tangent = self.skeleton.tangent(&self.of_skeleton(input))?;
        if !self.is_drained {
            for row in &mut tangent[..3] {
                for stiffness in &mut row[..3] {
                    *stiffness += self.stiffness;
                }
            }
        }
        Some(tangent)
    }
    fn relaxes(&self) -> bool {
        self.skeleton.relaxes()
    }
    fn only_stores(&self) -> bool {
        self.skeleton.only_stores()
    }
    /// That of the skeleton, of effective stresses, while water cannot flow; drained states store the volume strain.
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        if self.is_drained {
            None
        } else {
            self.skeleton.elastic_domain()
        }
    }
}

impl<I: ?Sized + BatchLaw<S>, S: BatchScalar> BatchLaw<S> for Saturated<I> {
    fn evaluate(&self, lanes: Lanes, evaluation: Evaluation<S>) -> Energies {
        let Evaluation {
            first,
            points,
            strains,
            initial,
            extents,
            locations,
            history,
            stresses,
            mut energies,
            remaining,
        } = evaluation;
        let found = self.skeleton.evaluate(
            lanes,
            Evaluation {
                first,
                points,
                strains,
                initial,
                extents,
                locations,
                history: &mut *history,
                stresses: &mut *stresses,
                energies: energies.as_deref_mut(),
                remaining,
            },
        );
        let medium = self.skeleton.medium();
        lanes.dispatch(AddWater {
            first,
            points,
            stiffness: self.stiffness,
            is_drained: self.is_drained,
            initial,
            missing: (found == Energies::None).then_some([medium.bulk(), medium.shear()]),
            strains,
            history,
            stresses,
            energies,
        });
        match found {
            Energies::None => Energies::Stored,
            found => found,
        }
    }
    fn for_step(&self, length: f64) -> Arc<dyn BatchLaw<S>> {
        let skeleton = self.skeleton.for_step(length);
        let is_drained = self.is_drained && length <= 0.0;
        Arc::new(Saturated::new(skeleton, self.stiffness, is_drained))
    }
    /// Leaves its lanes, for which the recording is refused.
    #[cfg(feature = "programs")]
    fn record(
        &self,
        input: &LawInput<Traced<S>>,
        new_history: &mut [Traced<S>],
    ) -> (Stress<Traced<S>>, RemainingStiffness<Traced<S>>) {
        self.skeleton.record(input, new_history)
    }
}

impl BatchLaws for Saturated<dyn BatchLaws> {}

/// Addition of the water to the evaluation of a skeleton, in the lanes of the processor.
struct AddWater<'a, 'm, S> {
    first: usize,
    points: usize,
    stiffness: f64,
    is_drained: bool,
    /// Six initial effective stresses (Pa) of each batch, or none.
    initial: Option<&'a [S]>,
    /// Bulk and shear modulus (Pa) of a skeleton without energies, of which the stored one is computed.
    missing: Option<[f64; 2]>,
    strains: &'a [S],
    history: &'a mut HistoryAccess<'m, S>,
    stresses: &'a mut [S],
    energies: Option<&'a mut [S]>,
}

impl<S: BatchScalar> BatchOperation<S> for AddWater<'_, '_, S> {
    type Output = ();
    #[inline(always)]
    fn run<L: BatchLane<Scalar = S>>(self, token: L::Token) {
        let zero = L::splat(token, 0.0);
        let stiffness = zero.constant(self.stiffness);
        let (strains, _) = as_lanes::<L>(token, self.strains).as_chunks::<6>();
        let (stresses, _) = as_lanes_mut::<L>(token, self.stresses).as_chunks_mut::<6>();
        #[expect(clippy::manual_map, reason = "a closure may be compiled on its own")]
        let mut energies = match self.energies {
            Some(energies) => Some(as_lanes_mut::<L>(token, energies).as_chunks_mut::<4>().0),
            None => None,
        };
        for (b, strains) in strains.chunks_exact(self.points).enumerate() {
            let batch = self.first + b;
            for (p, strain) in strains.iter().enumerate() {
                let old = committed(self.history.get(), zero, batch, p);
                let index = b * self.points + p;
                let mut new = old;
                if self.is_drained {
                    let mut vertical = stresses[index][ZZ];
                    if let Some(initial) = self.initial {
                        let of_batch = &initial[(6 * b + ZZ) * L::WIDTH..];
                        vertical = vertical + L::load(token, of_batch);
                    }
                    new = [volume(strain), vertical, zero];
                } else {
                    new[EXCESS] = rise(old[0], strain, stiffness);
                }
                let excess = new[EXCESS];
                if let Some(energies) = energies.as_deref_mut() {
                    if let Some(moduli) = self.missing {
                        let stored = complementary_density(moduli, &stresses[index]);
                        energies[index] = [stored, zero, zero, zero];
                    }
                    let half = zero.constant(0.5 / self.stiffness);
                    energies[index][0] = (excess * excess).mul_add(half, energies[index][0]);
                }
                for normal in &mut stresses[index][..3] {
                    *normal = *normal - excess;
                }
                if let HistoryAccess::Write(history) = &mut *self.history {
                    let first = if self.is_drained { 0 } else { EXCESS };
                    let (old, new) = (&old[first..], &new[first..]);
                    history.store_last(batch, p, new, differ(old, new));
                }
            }
        }
    }
}

/// Committed variables of the water at a point of a batch.
#[inline(always)]
fn committed<L: BatchLane>(
    history: &History<L::Scalar>,
    zero: L,
    batch: usize,
    point: usize,
) -> [L; VARIABLES.len()]
where
    L::Scalar: BatchScalar,
{
    let mut old = [zero; VARIABLES.len()];
    if let Some(numbers) = history.committed(batch) {
        let place = ((point + 1) * history.variables() - old.len()) * L::WIDTH;
        let numbers = &numbers[place..][..old.len() * L::WIDTH];
        old.copy_from_slice(as_lanes::<L>(zero.token(), numbers));
    }
    old
}

/// Water in the pores of batches within the elastic domain of their skeleton, which do not evaluate the law.
impl<K, S, const N: usize, const P: usize> Material<'_, K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: BatchScalar,
{
    /// The pressure beyond that at rest (Pa) at a point with a strain in a dynamic step; stores it where new histories are.
    #[inline(always)]
    pub(super) fn raise_pressure<L: BatchLane<Scalar = S>>(
        &mut self,
        batch: usize,
        point: usize,
        strain: &Strain<L>,
    ) -> L {
        let stiffness = self.moduli.water;
        match &mut self.history {
            HistoryAccess::Write(history) => raise(history, (batch, point), strain, stiffness),
            HistoryAccess::Read(history) => raised(history, (batch, point), strain, stiffness).0,
        }
    }
}

/// Pressure beyond that at rest (Pa) at a point of a batch with a strain, from the pressure of the water per volume strain (Pa), and
/// whether it changed.
#[inline(always)]
fn raised<L: BatchLane>(
    history: &History<L::Scalar>,
    (batch, point): (usize, usize),
    strain: &Strain<L>,
    stiffness: f64,
) -> (L, bool)
where
    L::Scalar: BatchScalar,
{
    let zero = strain.0[0].constant(0.0);
    let old = committed(history, zero, batch, point);
    let excess = rise(old[0], &strain.0, zero.constant(stiffness));
    (excess, differ(&old[EXCESS..], &[excess]))
}

/// The same pressure, which is stored.
#[inline(always)]
pub(super) fn raise<L: BatchLane>(
    history: &mut History<L::Scalar>,
    (batch, point): (usize, usize),
    strain: &Strain<L>,
    stiffness: f64,
) -> L
where
    L::Scalar: BatchScalar,
{
    let (excess, changed) = raised(history, (batch, point), strain, stiffness);
    history.store_last(batch, point, &[excess], changed);
    excess
}

/// Pressures of the water beyond those at rest (Pa) at the points of a batch with strains; none where there is no water.
#[inline(always)]
pub(super) fn pressures<L: BatchLane, const P: usize>(
    history: &History<L::Scalar>,
    moduli: Moduli,
    batch: usize,
    strains: &[Strain<L>; P],
) -> Option<[L; P]>
where
    L::Scalar: BatchScalar,
{
    if moduli.water == 0.0 {
        return None;
    }
    let zero = strains[0].0[0].constant(0.0);
    let stiffness = zero.constant(moduli.water);
    let mut pressures = [zero; P];
    for p in 0..P {
        let [at_rest, ..] = committed(history, zero, batch, p);
        pressures[p] = rise(at_rest, &strains[p].0, stiffness);
    }
    Some(pressures)
}

impl<K, S, const N: usize, const P: usize> Block<K, S, N, P>
where
    K: ElementKernel<N, P>,
    S: NodeScalar,
{
    /// Element value of a variable of the water after the last forces, the mean over the volume of the element, so that mean
    /// total stress plus pressure is mean effective stress; none if there is no water, and of other variables.
    pub(super) fn shown_of_water(&self, element: usize, variable: &str) -> Option<f64> {
        if self.moduli.water == 0.0 {
            return None;
        }
        let mean = |which: usize| {
            let weights = self.shares_of_points(element);
            let place = self.history.variables() - VARIABLES.len() + which;
            (self.history).weighted(&self.arrangement, element, place, &weights)
        };
        if variable == PORE_PRESSURE.name {
            let still = self.pore_pressures.get(element).copied();
            return Some(still.unwrap_or(0.0) + mean(EXCESS));
        }
        if variable == PORE_PRESSURE_RATIO.name {
            let compression = -mean(VERTICAL);
            return Some(if compression > 0.0 {
                mean(EXCESS) / compression
            } else {
                0.0
            });
        }
        let which = VARIABLES.iter().position(|own| own.name == variable)?;
        Some(mean(which))
    }

    /// Shares of the integration points in the volume of an element.
    fn shares_of_points(&self, element: usize) -> [f64; P] {
        if P == 1 {
            return [1.0; P];
        }
        let mut numbers = vec![0.0; self.kernel.geometry_len()];
        self.geometry_of(element, &mut numbers);
        let volumes = (self.kernel).volumes(Geometry::<f64>::new((), &numbers));
        let whole: f64 = volumes.iter().sum();
        volumes.map(|volume| volume / whole)
    }
}
