//! What a yield surface says, and how a trial stress flows back to it.

use powerhouse_model::{ElasticMedium, Lane, ParameterError, Stress, each};

use crate::{MaterialError, PrincipalAxes};

/// A trial stress further out than this many times the returned one is not corrected but
/// replaced: the correction would carry the rounding of the trial.
pub(crate) const FAR: f64 = 64.0;

/// How a point yields; the number stands in the history as `yield_state`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum YieldState {
    /// Elastic in the last step: 0.
    Elastic,
    /// In shear: 1.
    Shear,
    /// In tension: 2.
    Tension,
    /// In shear and in tension: 3.
    Both,
}

impl YieldState {
    /// The number in the history.
    pub const fn number(self) -> f64 {
        match self {
            Self::Elastic => 0.0,
            Self::Shear => 1.0,
            Self::Tension => 2.0,
            Self::Both => 3.0,
        }
    }
}

/// Where a trial stress comes to lie.
#[derive(Clone, Copy, Debug)]
pub struct PrincipalReturn<L> {
    /// Principal stresses on the surface (Pa), in falling order.
    pub stress: [L; 3],
    /// Trial less returned principal stresses (Pa), computed from the excess and not as their
    /// difference: small beside a large stress it keeps its digits, and single precision does not
    /// drift.
    pub loss: [L; 3],
    /// The number of the [`YieldState`].
    pub state: L,
}

/// An isotropic perfectly plastic yield surface with its flow rule, in principal stresses.
///
/// Implemented by [`MohrCoulomb`](crate::MohrCoulomb) and [`DruckerPrager`](crate::DruckerPrager);
/// [`ElastoPlastic`](crate::ElastoPlastic) and [`PlasticDamage`](crate::PlasticDamage) make laws
/// of it.
pub trait YieldSurface: Clone + core::fmt::Debug + Send + Sync + 'static {
    /// The name of the elastic-plastic law of this surface.
    fn name(&self) -> &str;
    /// The elastic medium.
    fn medium(&self) -> ElasticMedium;
    /// The same surface in a medium whose moduli are all larger by a factor.
    #[must_use]
    fn with_stiffness(&self, factor: f64) -> Self;
    /// An upper bound of [`excess`](Self::excess) from invariants alone (Pa): where it is not
    /// positive the stress is elastic, and no principal values are needed.
    fn bound<L: Lane>(&self, stress: &Stress<L>) -> L;
    /// The yield function of principal stresses in falling order (Pa), positive outside.
    fn excess<L: Lane>(&self, principal: &[L; 3]) -> L;
    /// The stress on the surface that belongs to a trial stress outside.
    fn return_principal<L: Lane>(&self, trial: &[L; 3]) -> PrincipalReturn<L>;
    /// The uniaxial tensile stress at yield (Pa): the surface in force, not what is listed.
    fn uniaxial_tension(&self) -> f64;
    /// The uniaxial compressive stress at yield (Pa), positive.
    fn uniaxial_compression(&self) -> f64;
    /// Principal plastic strains of uniaxial tension along the first axis, scaled to a first of
    /// one.
    fn flow_in_uniaxial_tension(&self) -> [f64; 3];
    /// Principal plastic strains of uniaxial compression along the third axis, scaled to a third
    /// of minus one.
    fn flow_in_uniaxial_compression(&self) -> [f64; 3];
}

/// A medium whose moduli are all larger by a factor.
pub(crate) fn stiffened(medium: &ElasticMedium, factor: f64) -> ElasticMedium {
    ElasticMedium {
        young: factor * medium.young,
        ..*medium
    }
}

/// Accepts a medium, angles of friction and dilation (degrees), the second not above the first, and
/// a cohesion (Pa).
pub(crate) fn check_frictional(
    medium: &ElasticMedium,
    friction: f64,
    dilation: f64,
    cohesion: f64,
) -> Result<(), MaterialError> {
    ElasticMedium::new(medium.young, medium.poisson, medium.density)?;
    ParameterError::check("friction", friction, 0.0, 75.0)?;
    ParameterError::check("dilation", dilation, 0.0, 75.0)?;
    ParameterError::check("cohesion", cohesion, 0.0, 1.0e12)?;
    if dilation > friction {
        return Err(MaterialError::Dilation { dilation, friction });
    }
    Ok(())
}

/// Mean stress and the square root of the second invariant of the deviator (Pa).
#[inline(always)]
pub(crate) fn mean_and_shear<L: Lane>(stress: &Stress<L>) -> (L, L) {
    let [xx, yy, zz, xy, yz, zx] = stress.0;
    let mean = (xx + yy + zz) * xx.constant(1.0 / 3.0);
    let (x, y, z) = (xx - mean, yy - mean, zz - mean);
    let normal = x.mul_add(x, y.mul_add(y, z * z)) * xx.constant(0.5);
    let shear = xy.mul_add(xy, yz.mul_add(yz, zx * zx));
    (mean, (normal + shear).sqrt())
}

/// Plastic flow of one step.
pub(crate) struct Flow<L: Lane> {
    /// Which lanes flowed.
    pub(crate) yielded: L::Mask,
    /// Principal axes of trial stress, returned stress and plastic strain increment.
    pub(crate) axes: PrincipalAxes<L>,
    /// Principal stresses after the return (Pa).
    pub(crate) stress: [L; 3],
    /// Principal trial stresses less those after the return (Pa).
    loss: [L; 3],
    /// Principal increments of plastic strain, zero where nothing flowed.
    pub(crate) plastic: [L; 3],
    /// The number of the [`YieldState`].
    pub(crate) state: L,
}

impl<L: Lane> Flow<L> {
    /// The flow that brings a trial stress back to the surface; none if no lane leaves it.
    #[inline(always)]
    pub(crate) fn back<S: YieldSurface>(surface: &S, trial: &Stress<L>) -> Option<Self> {
        let (axes, yielded) = beyond(surface, trial)?;
        let returned = surface.return_principal(&axes.values);
        Some(Self::new(&surface.medium(), (axes, yielded), returned))
    }

    /// The flow from a trial stress with some axes, in the lanes that yielded, to where it was
    /// returned.
    #[inline(always)]
    pub(crate) fn new(
        medium: &ElasticMedium,
        (axes, yielded): (PrincipalAxes<L>, L::Mask),
        returned: PrincipalReturn<L>,
    ) -> Self {
        let zero = returned.state.constant(0.0);
        let loss = returned.loss;
        let plastic = each(&strains_of_loss(medium, &loss), |x| x.select(yielded, zero));
        Self {
            yielded,
            axes,
            stress: pick(yielded, &returned.stress, &axes.values),
            loss,
            plastic,
            state: returned.state.select(yielded, zero),
        }
    }

    /// The change of stress against the initial stress after the flow (Pa), from the change that
    /// was elastic.
    #[inline(always)]
    pub(crate) fn stress_change(&self, elastic: &Stress<L>, initial: &Stress<L>) -> Stress<L> {
        let corrected = *elastic - Stress(self.axes.tensor(&self.loss));
        let replaced = Stress(self.axes.tensor(&self.stress)) - *initial;
        let first = elastic.0[0];
        let size = |values: &[L; 3]| values[0].abs().max(values[2].abs());
        let far = (size(&self.stress) * first.constant(FAR)).less(size(&self.axes.values));
        let mut change = *elastic;
        for i in 0..6 {
            let moved = replaced.0[i].select(far, corrected.0[i]);
            change.0[i] = moved.select(self.yielded, elastic.0[i]);
        }
        change
    }

    /// Increments of plastic strain, engineering shears; zero where nothing flowed.
    #[inline(always)]
    pub(crate) fn plastic_strain(&self) -> [L; 6] {
        let [xx, yy, zz, xy, yz, zx] = self.axes.tensor(&self.plastic);
        let zero = xx.constant(0.0);
        let mut strains = [xx, yy, zz, xy + xy, yz + yz, zx + zx];
        for strain in &mut strains {
            *strain = strain.select(self.yielded, zero);
        }
        strains
    }
}

/// The principal axes of a trial stress and the lanes in which it lies outside a surface; none if no
/// lane may.
#[inline(always)]
pub(crate) fn beyond<L: Lane, S: YieldSurface>(
    surface: &S,
    trial: &Stress<L>,
) -> Option<(PrincipalAxes<L>, L::Mask)> {
    let bound = surface.bound(trial);
    let zero = bound.constant(0.0);
    let may_yield = zero.less(bound);
    if !bound.any(may_yield) {
        return None;
    }
    let axes = PrincipalAxes::of(trial);
    // The bound decides first, in every lane: a lane on its own would not come here.
    let excess = surface.excess(&axes.values).select(may_yield, zero);
    Some((axes, zero.less(excess)))
}

/// The principal strains of principal stresses (Pa), `C^-1 (trial - returned)`.
#[inline(always)]
pub(crate) fn strains_of_loss<L: Lane>(medium: &ElasticMedium, loss: &[L; 3]) -> [L; 3] {
    let number = |value: f64| loss[0].constant(value);
    let share = number(medium.poisson / (1.0 + medium.poisson));
    let compliance = number(0.5 / medium.shear());
    let common = share * (loss[0] + loss[1] + loss[2]);
    each(loss, |x| compliance * (x - common))
}

/// One of two sets of three values, lane by lane.
#[inline(always)]
pub(crate) fn pick<L: Lane>(mask: L::Mask, this: &[L; 3], other: &[L; 3]) -> [L; 3] {
    [
        this[0].select(mask, other[0]),
        this[1].select(mask, other[1]),
        this[2].select(mask, other[2]),
    ]
}
