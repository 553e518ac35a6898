//! Constitutive laws of rock and concrete.
//!
//! Every law is a pure map from old history and strain to new history and stress change, an
//! implementation of [`ConstitutiveLaw`](powerhouse_model::ConstitutiveLaw): it runs without a mesh and
//! for any lane.
//!
//! | law | parameters | history | limits | ns |
//! |---|---|---|---|---|
//! | [`LinearElastic`] | elastic medium | none | no strength | 12 |
//! | [`ElastoPlastic`] of [`MohrCoulomb`] | friction, dilation, cohesion, cut-off | 8: plastic strain, equivalent plastic strain, yield state | perfectly plastic | 40, 270 |
//! | [`ElastoPlastic`] of [`DruckerPrager`] | the same without cut-off, [`ConeFit`] | the same 8 | perfectly plastic; a cone fits one stress path of rock only | 31, 63 |
//! | [`ElastoPlastic`] of [`TwoSurface`] | friction, dilation, cohesion, both uniaxial strengths | the same 8 | perfectly plastic; `f_c / f_t` above `N` | 49, 250 |
//! | [`ElastoPlastic`] of [`HoekBrown`] | strength and constant of intact rock, geological strength index, disturbance, share of dilation | the same 8 | perfectly plastic; isotropic rock mass | 48, 3700 |
//! | [`SofteningPlasticity`] of any surface | surface, [`StrengthFall`], residual strength | 11: also plastic shortening, strength lost, band width | elements up to [`largest_size`](SofteningPlasticity::largest_size); tensile opening alone does not soften | 40, 750 |
//! | [`PlasticDamage`] of any surface (Eq. 25 of the paper) | surface, [`Softening`] in tension and compression, stiffness recovery | 15: also two equivalent plastic strains, `d_t`, `d_c`, `D`, damage type, two band widths | elements up to [`largest_size`](PlasticDamage::largest_size); one scalar `D` for all directions | 40, 440 |
//! | [`LeeFenves`] ("concrete damaged plasticity") | strengths, biaxial and meridian ratios, dilation, energies, shares of damage, stiffness recovery | the same 15 | elements up to [`largest_size`](LeeFenves::largest_size); crushing is objective without hardening before the peak | 51, 1500 |
//! | [`Mazars`] | threshold, softening in tension and compression | 5: equivalent strain, `d_t`, `d_c`, `D`, band width | no plastic strain; by fracture energy only within [`permitted_sizes`](Mazars::permitted_sizes) | 40, 440 |
//! | [`FlatDamping`] of any of them | [`RelaxationSpectrum`], [`ReferenceFrequency`] | 6 more per mechanism | damping within a band of frequencies; waves become dispersive, the stable step 10 % shorter at 5 % | more by a few per mechanism |
//!
//! The last column is the cost of a point in double precision, one after the other, in nanoseconds on
//! one core of a loaded machine (`cargo bench -p powerhouse-material-damage`), elastic and during
//! plastic flow ([`SofteningPlasticity`] and [`PlasticDamage`] on [`MohrCoulomb`]). Packs of points share the cost, except that one
//! yielding point makes its pack evaluate the return. All laws have consistent tangents for statics.
//!
//! [`presets`] hold published materials, [`MohrCoulomb::findings`] lists inconsistencies of their
//! parameters, and [`PointDriver`] evaluates a law at one point along paths of strain and stress.
//!
//! # Example
//! ```
//! use powerhouse_material_damage::{LinearElastic, media};
//! use powerhouse_model::{ConstitutiveLaw, LawInput, Strain};
//!
//! let rock = LinearElastic::new(media::ROCK);
//! let squeezed = Strain([0.0, 0.0, -1.0e-4, 0.0, 0.0, 0.0]);
//! let stress = rock.stress_change(&LawInput::new(squeezed, &[]), &mut []);
//! assert!((stress.0[2] + 1.0e-4 * media::ROCK.constrained()).abs() < 1e-3);
//! ```
//!
//! # Why so
//! *Laws return the change of stress* against the initial stress, never the sum: ten megapascals
//! of overburden would cancel the digits of a small wave in single precision.
//! *Moduli are computed once*, when the law is made: a law is called for every element and step,
//! and two divisions per call would cost more than Hooke's law itself.
//! *Points that certainly stay elastic are identified by invariants* before any principal values are
//! computed: most points of most steps do, and the bound costs little more than Hooke's law.
//! *Surfaces return the loss of stress beside the stress*, computed from the excess: as a
//! difference of large stresses it would be rounded at every step, and single precision would
//! drift by hundreds of pascals in a long run.
//! *Returns without a closed form are solved for one unknown within a bracket* ([`LeeFenves`],
//! [`HoekBrown`], [`SofteningPlasticity`]): the deviator, or the flow on a face, keeps its direction, so
//! all else is a function of the amount of flow. The solution does not diverge from any starting point.
//! With derivatives ([`LeeFenves`]) two evaluations suffice for most steps, without them five.
//! *Principal axes come from the most isolated principal value*, a root of a cubic that is never double,
//! and one half angle in the plane across its direction: sweeps of rotations took three quarters of a
//! yielding step.
//! *One rule selects among faces, edges and corners*: of the candidates the one that violates the
//! conditions least is taken, so that no order of cases matters. A candidate without violation is the
//! solution, so that rarer candidates are computed only while some point of a pack has none.

mod acoustic;
mod consistency;
mod crack_band;
mod crack_closure;
mod driver;
mod drucker_prager;
mod dual;
mod elasto_plastic;
mod energy;
mod error;
mod exponential;
mod flat_damping;
mod history;
mod hoek_brown;
mod lee_fenves;
mod linear_elastic;
mod mazars;
pub mod media;
mod mohr_coulomb;
mod planes;
mod plastic_damage;
pub mod presets;
mod principal;
mod remaining;
mod root;
mod softening;
mod softening_plasticity;
mod strain_curves;
mod surface;
mod tangent;
mod two_surface;
mod uniaxial;

pub use acoustic::growth_of_flow;
pub use consistency::Finding;
pub use driver::{Control, PointDriver, PointState};
pub use drucker_prager::{ConeFit, DruckerPrager, DruckerPragerParameters};
pub use elasto_plastic::ElastoPlastic;
pub use error::{MaterialError, SofteningOf};
pub use flat_damping::{
    DampingBand, ElasticInSeries, FlatDamping, MOST_MECHANISMS, Mechanism, ReferenceFrequency,
    RelaxationSpectrum,
};
pub use hoek_brown::{HoekBrown, HoekBrownParameters};
pub use lee_fenves::{LeeFenves, LeeFenvesParameters};
pub use linear_elastic::LinearElastic;
pub use mazars::{Mazars, MazarsParameters, MazarsTension};
pub use mohr_coulomb::{MohrCoulomb, MohrCoulombParameters};
pub use plastic_damage::{PlasticDamage, PlasticDamageParameters};
pub use principal::PrincipalAxes;
pub use softening::Softening;
pub use softening_plasticity::{SofteningPlasticity, SofteningPlasticityParameters, StrengthFall};
pub use strain_curves::{DarendeliSoil, StrainCurves};
pub use surface::{PrincipalReturn, StressReturn, YieldState, YieldSurface};
pub use two_surface::{TwoSurface, TwoSurfaceParameters};
