//! Constitutive laws of rock and concrete.
//!
//! Every law is a pure map from old history and strain to new history and stress change, behind
//! the socket [`ConstitutiveLaw`](powerhouse_model::ConstitutiveLaw): it runs without a mesh and
//! for any lane.
//!
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
//! of overburden would eat the digits of a small wave in single precision.
//! *Moduli are computed once*, when the law is made: a law is called for every element and step,
//! and two divisions per call would cost more than Hooke's law itself.

mod driver;
mod drucker_prager;
mod elasto_plastic;
mod error;
mod exponential;
mod linear_elastic;
mod mazars;
pub mod media;
mod mohr_coulomb;
mod plastic_damage;
pub mod presets;
mod principal;
mod softening;
mod surface;

pub use driver::{Control, PointDriver, PointRecord};
pub use drucker_prager::{ConeFit, DruckerPrager, DruckerPragerParameters};
pub use elasto_plastic::ElastoPlastic;
pub use error::MaterialError;
pub use linear_elastic::LinearElastic;
pub use mazars::{Mazars, MazarsParameters, MazarsTension};
pub use mohr_coulomb::{MohrCoulomb, MohrCoulombParameters};
pub use plastic_damage::{Dissipation, PlasticDamage, PlasticDamageParameters};
pub use principal::PrincipalAxes;
pub use softening::Softening;
pub use surface::{PrincipalReturn, YieldState, YieldSurface};
