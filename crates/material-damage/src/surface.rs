//! Yield surfaces, and the return of a trial stress to them.

use powerhouse_model::{ElasticDomain, ElasticMedium, Lane, ParameterError, Stress, each};

use crate::principal::is_extreme;
use crate::{MaterialError, PrincipalAxes};

/// Ratio of trial to returned stress above which the stress is not corrected by the loss but
/// replaced by the returned one: the correction would carry the rounding error of the trial.
const FAR: f64 = 64.0;

/// Yield state of a point in the last step; its number is the history variable `yield_state`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum YieldState {
    /// Elastic: 0.
    Elastic,
    /// Yielding in shear: 1.
    Shear,
    /// Yielding in tension: 2.
    Tension,
    /// Yielding in shear and in tension: 3.
    Both,
}

impl YieldState {
    /// Number of the state as stored in the history.
    pub const fn number(self) -> f64 {
        match self {
            Self::Elastic => 0.0,
            Self::Shear => 1.0,
            Self::Tension => 2.0,
            Self::Both => 3.0,
        }
    }
}

/// Return of a trial stress to the yield surface, in principal stresses.
#[derive(Clone, Copy, Debug)]
pub struct PrincipalReturn<L> {
    /// Principal stresses on the surface (Pa), in falling order.
    pub stress: [L; 3],
    /// Trial less returned principal stresses (Pa), computed from the excess and not as their
    /// difference: small beside a large stress it keeps its digits, and single precision does not
    /// drift.
    pub loss: [L; 3],
    /// Number of the [`YieldState`].
    pub state: L,
}

/// Return of a trial stress to the yield surface, in the axes of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct StressReturn<L: Lane> {
    /// Lanes of which the trial is outside the surface; in others the remaining fields have no meaning.
    pub outside: L::Mask,
    /// Trial less returned stress (Pa), computed from the excess, as in [`PrincipalReturn`].
    pub loss: Stress<L>,
    /// Returned stress (Pa) and the lanes in which it must be used: so far outside that the difference of
    /// trial and loss would be of the rounding error of the trial.
    pub far: Option<(L::Mask, Stress<L>)>,
    /// Number of the [`YieldState`].
    pub state: L,
}

/// Isotropic, perfectly plastic yield surface with its flow rule, in principal stresses.
///
/// Implemented by [`MohrCoulomb`](crate::MohrCoulomb), [`DruckerPrager`](crate::DruckerPrager),
/// [`TwoSurface`](crate::TwoSurface) and [`HoekBrown`](crate::HoekBrown), among others;
/// [`ElastoPlastic`](crate::ElastoPlastic), [`SofteningPlasticity`](crate::SofteningPlasticity) and
/// [`PlasticDamage`](crate::PlasticDamage) are laws of a surface.
///
/// The methods are called at every integration point and step, from several threads at once: their values depend on
/// their arguments alone.
pub trait YieldSurface: Clone + core::fmt::Debug + Send + Sync + 'static {
    /// Name of the elastic-plastic law of this surface.
    fn name(&self) -> &str;
    /// Elastic medium in which stresses return to the surface.
    fn medium(&self) -> ElasticMedium;
    /// The same surface with all elastic moduli multiplied by a factor, its strengths unchanged.
    #[must_use]
    fn with_stiffness(&self, factor: f64) -> Self;
    /// Upper bound of [`excess`](Self::excess) from invariants alone (Pa): where it is not
    /// positive the stress is elastic, and no principal values are needed.
    fn bound<L: Lane>(&self, stress: &Stress<L>) -> L;
    /// Domain in which [`bound`](Self::bound) is not positive, as an intersection of cones;
    /// `None` if unknown.
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        None
    }
    /// Yield function of principal stresses in falling order (Pa), positive outside.
    fn excess<L: Lane>(&self, principal: &[L; 3]) -> L;
    /// Return of a trial outside, given by its principal stresses in falling order (Pa).
    fn return_principal<L: Lane>(&self, trial: &[L; 3]) -> PrincipalReturn<L>;
    /// Return of a stress in the axes of the mesh (Pa), some lanes of which may be outside; `None` if by
    /// the [`bound`](Self::bound) no lane is. By default the stress is transformed to principal axes and
    /// back; a surface of invariants does not need them.
    #[inline(always)]
    fn return_stress<L: Lane>(&self, trial: &Stress<L>) -> Option<StressReturn<L>> {
        Some(PrincipalFlow::of(self, trial)?.in_mesh_axes())
    }
    /// Uniaxial tensile stress at which the surface yields (Pa), whatever strength is listed.
    fn uniaxial_tension(&self) -> f64;
    /// Uniaxial compressive stress at which the surface yields (Pa), positive.
    fn uniaxial_compression(&self) -> f64;
    /// Principal plastic strains in uniaxial tension along the first axis, scaled to one along that
    /// axis.
    fn flow_in_uniaxial_tension(&self) -> [f64; 3];
    /// Principal plastic strains in uniaxial compression along the third axis, scaled to minus one along
    /// that axis.
    fn flow_in_uniaxial_compression(&self) -> [f64; 3];
}

/// Medium with all elastic moduli multiplied by a factor.
pub(crate) fn stiffened(medium: &ElasticMedium, factor: f64) -> ElasticMedium {
    ElasticMedium {
        young: factor * medium.young,
        ..*medium
    }
}

/// Checks a medium, the angles of friction and dilation (degrees), the second not above the first, and
/// a cohesion (Pa).
pub(crate) fn check_frictional(
    medium: &ElasticMedium,
    friction: f64,
    dilation: f64,
    cohesion: f64,
) -> Result<(), MaterialError> {
    medium.checked()?;
    ParameterError::check("friction", friction, 0.0, 75.0)?;
    ParameterError::check("dilation", dilation, 0.0, 75.0)?;
    ParameterError::check("cohesion", cohesion, 0.0, 1.0e12)?;
    if dilation > friction {
        return Err(MaterialError::Dilation { dilation, friction });
    }
    Ok(())
}

/// Principal axes of a trial stress and the lanes in which it is outside a surface; `None` if by the
/// bound no lane is.
#[inline(always)]
pub(crate) fn trial_outside<L: Lane, S: YieldSurface>(
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
    // The bound decides first, in every lane, as it would for a lane on its own.
    let excess = surface.excess(&axes.values).select(may_yield, zero);
    Some((axes, zero.less(excess)))
}

/// Return of a trial stress in principal axes.
struct PrincipalFlow<L: Lane> {
    /// Lanes outside the surface.
    yielded: L::Mask,
    axes: PrincipalAxes<L>,
    returned: PrincipalReturn<L>,
}

impl<L: Lane> PrincipalFlow<L> {
    /// Return of a trial stress; `None` if by the bound no lane is outside.
    #[inline(always)]
    fn of<S: YieldSurface>(surface: &S, trial: &Stress<L>) -> Option<Self> {
        let (axes, yielded) = trial_outside(surface, trial)?;
        Some(Self {
            yielded,
            returned: surface.return_principal(&axes.values),
            axes,
        })
    }

    #[inline(always)]
    fn in_mesh_axes(&self) -> StressReturn<L> {
        let Self {
            yielded,
            axes,
            returned,
        } = self;
        let [on_surface, trial] = [size(&returned.stress), size(&axes.values)];
        StressReturn {
            outside: *yielded,
            loss: Stress(axes.tensor(&returned.loss)),
            far: match far_lanes(on_surface, trial) {
                Some(far) => Some((far, Stress(axes.tensor(&returned.stress)))),
                None => None,
            },
            state: returned.state,
        }
    }
}

/// Largest magnitude of the principal stresses (Pa).
#[inline(always)]
fn size<L: Lane>(values: &[L; 3]) -> L {
    values[0].abs().max(values[2].abs())
}

/// Lanes in which the trial stress is so large beside the returned one that the trial less its loss
/// would be of the rounding error of the trial; `None` if there are none.
#[inline(always)]
pub(crate) fn far_lanes<L: Lane>(returned: L, trial: L) -> Option<L::Mask> {
    let far = (returned * returned.constant(FAR)).less(trial);
    trial.any(far).then_some(far)
}

/// Strains of a lost stress (Pa), `C^-1 (trial - returned)`: principal ones, or in any axes with
/// tensorial shears.
#[inline(always)]
pub(crate) fn strains_of_loss<L: Lane, const C: usize>(
    medium: &ElasticMedium,
    loss: &[L; C],
) -> [L; C] {
    let number = |value: f64| loss[0].constant(value);
    let share = number(medium.poisson / (1.0 + medium.poisson));
    let compliance = number(0.5 / medium.shear());
    let common = share * (loss[0] + loss[1] + loss[2]);
    let mut strains = *loss;
    for i in 0..C {
        let deviating = if i < 3 { loss[i] - common } else { loss[i] };
        strains[i] = compliance * deviating;
    }
    strains
}

/// Plastic flow of one step, in the axes of the mesh.
pub(crate) struct Flow<L: Lane> {
    returned: StressReturn<L>,
    /// Increments of plastic strain, engineering shears; zero in lanes without flow.
    pub(crate) plastic: [L; 6],
    /// Number of the [`YieldState`].
    pub(crate) state: L,
}

impl<L: Lane> Flow<L> {
    /// Flow of a trial stress back to the surface; `None` if no lane is outside.
    #[inline(always)]
    pub(crate) fn of_trial<S: YieldSurface>(surface: &S, trial: &Stress<L>) -> Option<Self> {
        Some(Self::of(&surface.medium(), surface.return_stress(trial)?))
    }

    #[inline(always)]
    fn of(medium: &ElasticMedium, returned: StressReturn<L>) -> Self {
        let zero = returned.state.constant(0.0);
        let [xx, yy, zz, xy, yz, zx] = strains_of_loss(medium, &returned.loss.0);
        let mut plastic = [xx, yy, zz, xy + xy, yz + yz, zx + zx];
        for strain in &mut plastic {
            *strain = strain.select(returned.outside, zero);
        }
        Self {
            plastic,
            state: returned.state.select(returned.outside, zero),
            returned,
        }
    }

    /// Increment of equivalent plastic strain, `sqrt(2/3 e : e)`, scaled where squares of the strains would
    /// be outside the range of numbers.
    #[inline(always)]
    pub(crate) fn equivalent(&self) -> L {
        let number = |value: f64| self.state.constant(value);
        let found = norm(&self.plastic);
        let looked = found.select(self.returned.outside, number(1.0));
        let extreme = is_extreme(looked);
        if !found.any(extreme) {
            return found;
        }
        let mut largest = number(LEAST_STRAIN);
        for strain in &self.plastic {
            largest = largest.max(strain.abs());
        }
        let inverse = number(1.0) / largest;
        let scaled = largest * norm(&each(&self.plastic, |x| x * inverse));
        scaled.select(extreme, found)
    }

    /// Change of stress against the initial stress after the flow (Pa), from the elastic trial
    /// change.
    #[inline(always)]
    pub(crate) fn stress_change(&self, elastic: &Stress<L>, initial: &Stress<L>) -> Stress<L> {
        let mut change = *elastic - self.returned.loss;
        if let Some((far, stress)) = &self.returned.far {
            let replaced = *stress - *initial;
            for i in 0..6 {
                change.0[i] = replaced.0[i].select(*far, change.0[i]);
            }
        }
        for i in 0..6 {
            change.0[i] = change.0[i].select(self.returned.outside, elastic.0[i]);
        }
        change
    }
}

/// Strain below which the equivalent strain is zero; its inverse is a number in single precision
/// too.
const LEAST_STRAIN: f64 = 1.0e-36;

/// Equivalent strain `sqrt(2/3 e : e)` of strains with engineering shears.
#[inline(always)]
fn norm<L: Lane>(&[xx, yy, zz, xy, yz, zx]: &[L; 6]) -> L {
    let normal = xx.mul_add(xx, yy.mul_add(yy, zz * zz));
    let shear = xy.mul_add(xy, yz.mul_add(yz, zx * zx));
    let square = shear.mul_add(xx.constant(0.5), normal);
    (square * xx.constant(2.0 / 3.0)).sqrt()
}

/// Plastic flow of one step, with its principal values.
pub(crate) struct FlowInAxes<L: Lane> {
    /// Flow in the axes of the mesh.
    pub(crate) flow: Flow<L>,
    /// Lanes with plastic flow.
    pub(crate) yielded: L::Mask,
    /// Principal stresses after the return (Pa), those of the trial in lanes without flow.
    pub(crate) stress: [L; 3],
    /// Principal increments of plastic strain, zero in lanes without flow.
    pub(crate) plastic: [L; 3],
    /// Unit vectors of the principal directions.
    pub(crate) directions: [[L; 3]; 3],
}

impl<L: Lane> FlowInAxes<L> {
    /// Flow of a trial stress back to the surface, as [`Flow::of_trial`].
    #[inline(always)]
    pub(crate) fn of_trial<S: YieldSurface>(surface: &S, trial: &Stress<L>) -> Option<Self> {
        let flow = PrincipalFlow::of(surface, trial)?;
        Some(Self::of(&surface.medium(), &flow))
    }

    /// Flow of a trial stress with the given axes, in the lanes that yielded, to its returned
    /// stress.
    #[inline(always)]
    pub(crate) fn new(
        medium: &ElasticMedium,
        (axes, yielded): (PrincipalAxes<L>, L::Mask),
        returned: PrincipalReturn<L>,
    ) -> Self {
        let flow = PrincipalFlow {
            yielded,
            axes,
            returned,
        };
        Self::of(medium, &flow)
    }

    #[inline(always)]
    fn of(medium: &ElasticMedium, flow: &PrincipalFlow<L>) -> Self {
        let PrincipalFlow {
            yielded,
            axes,
            returned,
        } = flow;
        let zero = returned.state.constant(0.0);
        let plastic = strains_of_loss(medium, &returned.loss);
        Self {
            flow: Flow::of(medium, flow.in_mesh_axes()),
            yielded: *yielded,
            stress: pick(*yielded, &returned.stress, &axes.values),
            plastic: each(&plastic, |x| x.select(*yielded, zero)),
            directions: axes.directions,
        }
    }
}

/// Selection between two sets of three values, lane by lane.
#[inline(always)]
pub(crate) fn pick<L: Lane>(mask: L::Mask, this: &[L; 3], other: &[L; 3]) -> [L; 3] {
    [
        this[0].select(mask, other[0]),
        this[1].select(mask, other[1]),
        this[2].select(mask, other[2]),
    ]
}
