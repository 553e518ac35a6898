//! Conversion of the software's laws into materials.

use powerhouse_material_damage::{
    DruckerPrager, ElastoPlastic, HoekBrown, LeeFenves, LinearElastic, Mazars, MohrCoulomb,
    PlasticDamage, SofteningPlasticity, TwoSurface,
};

use crate::Material;

/// Implements the conversion of laws into materials. A law is compiled for every lane type, which takes long: done here
/// once, not in every program that uses it.
macro_rules! known {
    ($($law:ty),+ $(,)?) => {
        $(
            impl From<$law> for Material {
                #[inline(never)]
                fn from(law: $law) -> Self {
                    Self::in_series(law)
                }
            }
        )+
    };
}

known![
    LinearElastic,
    ElastoPlastic<MohrCoulomb>,
    ElastoPlastic<DruckerPrager>,
    ElastoPlastic<TwoSurface>,
    ElastoPlastic<HoekBrown>,
    SofteningPlasticity<MohrCoulomb>,
    PlasticDamage<MohrCoulomb>,
    PlasticDamage<DruckerPrager>,
    PlasticDamage<TwoSurface>,
    LeeFenves,
    Mazars,
];
