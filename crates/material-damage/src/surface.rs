//! What a yield surface says, and how a trial stress flows back to it.

use powerhouse_model::{ElasticDomain, ElasticMedium, Lane, ParameterError, Stress, each};

use crate::principal::is_extreme;
use crate::{MaterialError, PrincipalAxes};

/// A trial stress further out than this many times the returned one is not corrected but
/// replaced: the correction would carry the rounding of the trial.
const FAR: f64 = 64.0;

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

/// Where a trial stress comes to lie, in the axes of the mesh.
#[derive(Clone, Copy, Debug)]
pub struct StressReturn<L: Lane> {
    /// Lanes of which the trial lies outside; the rest is meaningless in others.
    pub outside: L::Mask,
    /// Trial less returned stress (Pa), computed from the excess, as in [`PrincipalReturn`].
    pub loss: Stress<L>,
    /// The returned stress (Pa), and the lanes that are so far outside that the trial less the
    /// loss would be of its rounding.
    pub far: Option<(L::Mask, Stress<L>)>,
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
    /// Where the [`bound`](Self::bound) is not positive, in cones; none if they are not known.
    fn elastic_domain(&self) -> Option<ElasticDomain> {
        None
    }
    /// The yield function of principal stresses in falling order (Pa), positive outside.
    fn excess<L: Lane>(&self, principal: &[L; 3]) -> L;
    /// The stress on the surface that belongs to a trial stress outside.
    fn return_principal<L: Lane>(&self, trial: &[L; 3]) -> PrincipalReturn<L>;
    /// The same in the axes of the mesh, for trials some of which may lie outside; none if the
    /// [`bound`](Self::bound) tells that no lane does. By default it is brought to principal axes and
    /// back; a surface of invariants needs none.
    #[inline(always)]
    fn return_stress<L: Lane>(&self, trial: &Stress<L>) -> Option<StressReturn<L>> {
        Some(PrincipalFlow::of(self, trial)?.in_mesh_axes())
    }
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

/// The return of a trial stress in principal axes.
struct PrincipalFlow<L: Lane> {
    /// Which lanes lie outside.
    yielded: L::Mask,
    axes: PrincipalAxes<L>,
    returned: PrincipalReturn<L>,
}

impl<L: Lane> PrincipalFlow<L> {
    /// None if no lane may lie outside.
    #[inline(always)]
    fn of<S: YieldSurface>(surface: &S, trial: &Stress<L>) -> Option<Self> {
        let (axes, yielded) = beyond(surface, trial)?;
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

/// The largest principal stress in size (Pa).
#[inline(always)]
fn size<L: Lane>(values: &[L; 3]) -> L {
    values[0].abs().max(values[2].abs())
}

/// Lanes of which the trial stress is so large beside the returned one that the first less its loss
/// would be of its rounding; none if there are none.
#[inline(always)]
pub(crate) fn far_lanes<L: Lane>(returned: L, trial: L) -> Option<L::Mask> {
    let far = (returned * returned.constant(FAR)).less(trial);
    trial.any(far).then_some(far)
}

/// The strains of a stress that was lost (Pa), `C^-1 (trial - returned)`: principal ones, or in any
/// axes with shears half as large as engineering ones.
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
    /// Increments of plastic strain, engineering shears; zero where nothing flowed.
    pub(crate) plastic: [L; 6],
    /// The number of the [`YieldState`].
    pub(crate) state: L,
}

impl<L: Lane> Flow<L> {
    /// The flow that brings a trial stress back to the surface; none if no lane leaves it.
    #[inline(always)]
    pub(crate) fn back<S: YieldSurface>(surface: &S, trial: &Stress<L>) -> Option<Self> {
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

    /// The increment of equivalent plastic strain, `sqrt(2/3 e : e)`; strains may be so large or small
    /// that squares are not numbers.
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

    /// The change of stress against the initial stress after the flow (Pa), from the change that
    /// was elastic.
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

/// Below this size, of which the inverse is a number in single precision too, strains count as
/// nothing.
const LEAST_STRAIN: f64 = 1.0e-36;

/// `sqrt(2/3 e : e)` of strains with engineering shears.
#[inline(always)]
fn norm<L: Lane>(&[xx, yy, zz, xy, yz, zx]: &[L; 6]) -> L {
    let normal = xx.mul_add(xx, yy.mul_add(yy, zz * zz));
    let shear = xy.mul_add(xy, yz.mul_add(yz, zx * zx));
    let square = shear.mul_add(xx.constant(0.5), normal);
    (square * xx.constant(2.0 / 3.0)).sqrt()
}

/// Plastic flow of one step, with its principal values.
pub(crate) struct FlowInAxes<L: Lane> {
    /// The same in the axes of the mesh.
    pub(crate) flow: Flow<L>,
    /// Which lanes flowed.
    pub(crate) yielded: L::Mask,
    /// Principal stresses after the return (Pa), those of the trial where nothing flowed.
    pub(crate) stress: [L; 3],
    /// Principal increments of plastic strain, zero where nothing flowed.
    pub(crate) plastic: [L; 3],
    /// Unit vectors that belong to them.
    pub(crate) directions: [[L; 3]; 3],
}

impl<L: Lane> FlowInAxes<L> {
    /// As [`Flow::back`].
    #[inline(always)]
    pub(crate) fn back<S: YieldSurface>(surface: &S, trial: &Stress<L>) -> Option<Self> {
        let flow = PrincipalFlow::of(surface, trial)?;
        Some(Self::of(&surface.medium(), &flow))
    }

    /// The flow from a trial stress with some axes, in the lanes that yielded, to where it was
    /// returned.
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

/// One of two sets of three values, lane by lane.
#[inline(always)]
pub(crate) fn pick<L: Lane>(mask: L::Mask, this: &[L; 3], other: &[L; 3]) -> [L; 3] {
    [
        this[0].select(mask, other[0]),
        this[1].select(mask, other[1]),
        this[2].select(mask, other[2]),
    ]
}
