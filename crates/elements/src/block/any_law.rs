//! Constitutive laws of any type behind one type.

use std::sync::Arc;

use powerhouse_model::{
    BlockLaw, ConstitutiveLaw, ElasticMedium, HistoryVariable, LawEnergy, LawInput, ModelError,
    PointLaw, Stress,
};

use super::at_once::{AtOnce, Undamaged};
use super::law::{BatchLaws, ErasedLaw};
use super::pore_water::{Drainage, PoreWater, Saturated};

/// Constitutive law of any type with its type erased, which every element kernel evaluates in lanes.
///
/// Kernels and laws are compiled apart: a law once, when an `AnyLaw` is made of it, and a kernel once for
/// all laws. Copies share the law.
///
/// It is also a [`PointLaw`], the law at one integration point in double precision:
/// ```
/// use powerhouse_elements::{AnyLaw, Hex8Full, solid};
/// use powerhouse_model::BlockOptions;
/// use powerhouse_model::{LawInput, PointLaw, Strain};
/// # use powerhouse_model::*;
/// # #[derive(Clone)]
/// # struct Linear(ElasticMedium);
/// # impl ConstitutiveLaw for Linear {
/// #     const LINEAR: bool = true;
/// #     fn name(&self) -> &str { "linear" }
/// #     fn medium(&self) -> ElasticMedium { self.0 }
/// #     fn history(&self) -> &'static [HistoryVariable] { &[] }
/// #     fn stress_change<L: Lane>(&self, input: &LawInput<L>, _new_history: &mut [L]) -> Stress<L> {
/// #         let one = input.strain.0[0].constant(1.0);
/// #         Stress::elastic(one.constant(self.0.lambda()), one.constant(self.0.shear()), &input.strain)
/// #     }
/// # }
/// let law = AnyLaw::new(Linear(ElasticMedium::new(2.5, 0.25, 1.0)?));
/// let strain = Strain([1.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
/// assert_eq!(law.stress_change(&LawInput::new(strain, &[]), &mut []).0[0], 3.0);
/// // Any kernel takes it, such as one of one's own.
/// let rock = solid("rock", Hex8Full, law, BlockOptions::default());
/// # Ok::<(), ParameterError>(())
/// ```
#[derive(Clone)]
pub struct AnyLaw {
    law: Arc<dyn ErasedLaw>,
    /// None for linear laws, which their medium defines.
    in_lanes: Option<Arc<dyn BatchLaws>>,
    water: Option<WaterOfLaw>,
}

/// Water in the pores of a material with the law of its skeleton.
#[derive(Clone)]
struct WaterOfLaw {
    water: PoreWater,
    skeleton: Arc<dyn BatchLaws>,
    drainage: Drainage,
    /// Pressures (Pa) of elements of the mesh in static states, in place of those of the water by height; none where it is these.
    pressures: Option<Arc<[Option<f64>]>>,
}

impl AnyLaw {
    /// Erases the type of a law; every kernel still evaluates it in SIMD lanes.
    pub fn new<M: ConstitutiveLaw>(law: M) -> Self {
        if const { M::LINEAR } {
            return Self {
                law: Arc::new(law),
                in_lanes: None,
                water: None,
            };
        }
        let law = Arc::new(law);
        Self {
            law: law.clone(),
            in_lanes: Some(law),
            water: None,
        }
    }
    /// A law that is evaluated for all integration points of an element block at once; slower than one in lanes.
    pub fn of_blocks(law: impl BlockLaw + 'static) -> Self {
        let law = Arc::new(AtOnce::new(law));
        Self {
            law: law.clone(),
            in_lanes: Some(law),
            water: None,
        }
    }
    /// The law with water in the pores of the material, which then sees effective stress; see [`PoreWater`]. Its
    /// [medium](PointLaw::medium) is undrained, and at a point it is that of dynamic steps.
    #[must_use]
    pub fn with_pore_water(&self, water: PoreWater) -> Self {
        let skeleton: Arc<dyn BatchLaws> = match &self.in_lanes {
            Some(law) => law.clone(),
            None => Arc::new(Undamaged(self.law.medium())),
        };
        Self::saturated(WaterOfLaw {
            water,
            skeleton,
            drainage: Drainage::Drained,
            pressures: None,
        })
    }
    fn saturated(water: WaterOfLaw) -> Self {
        let stiffness = water.water.stiffness();
        let of = |is_drained| Saturated::new(water.skeleton.clone(), stiffness, is_drained);
        Self {
            law: Arc::new(of(false)),
            in_lanes: Some(Arc::new(of(water.drainage == Drainage::Drained))),
            water: Some(water),
        }
    }
    /// The law whose water is drained or undrained in static states; without water in the pores the same law.
    #[must_use]
    pub fn with_drainage(&self, drainage: Drainage) -> Self {
        match self.water.clone() {
            Some(water) => Self::saturated(WaterOfLaw { drainage, ..water }),
            None => self.clone(),
        }
    }
    /// The law with pressures (Pa) of the water in static states by element of the mesh; elements without one keep that of their
    /// height. Without water in the pores the same law.
    #[must_use]
    pub fn with_pore_pressures(&self, pressures: Arc<[Option<f64>]>) -> Self {
        let pressures = Some(pressures);
        match self.water.clone() {
            Some(water) => Self::saturated(WaterOfLaw { pressures, ..water }),
            None => self.clone(),
        }
    }
    /// The water in the pores of the material, if there is any.
    pub fn pore_water(&self) -> Option<&PoreWater> {
        self.water.as_ref().map(|water| &water.water)
    }
    /// Whether the water, if there is any, flows in static states.
    pub(super) fn drainage(&self) -> Drainage {
        (self.water.as_ref()).map_or(Drainage::Drained, |water| water.drainage)
    }
    /// Pressure (Pa) of the water in static states in an element of the mesh with its centre at a height z (m); zero without
    /// water.
    pub fn pore_pressure(&self, element: u32, height: f64) -> f64 {
        let Some(water) = &self.water else {
            return 0.0;
        };
        let own = water.pressures.as_ref();
        let own = own.and_then(|own| own.get(element as usize).copied().flatten());
        own.unwrap_or_else(|| water.water.pressure(height))
    }
    /// The elastic medium of the undamaged material without the stiffness of water in its pores.
    pub fn skeleton(&self) -> ElasticMedium {
        match &self.water {
            Some(water) => water.skeleton.medium(),
            None => self.law.medium(),
        }
    }
    /// Whether the law is linear elastic, without history variables.
    pub fn is_linear(&self) -> bool {
        self.law.is_linear()
    }
    /// Whether the law is that of a linear skeleton with water in its pores.
    pub(super) fn is_linear_ground(&self) -> bool {
        let skeleton = self.water.as_ref().map(|water| &water.skeleton);
        skeleton.is_some_and(|skeleton| skeleton.is_linear())
    }
    /// The law for batches of elements; none for linear laws, which their medium defines.
    pub(super) fn in_lanes(&self) -> Option<&Arc<dyn BatchLaws>> {
        self.in_lanes.as_ref()
    }
}

impl<M: ConstitutiveLaw> From<M> for AnyLaw {
    fn from(law: M) -> Self {
        Self::new(law)
    }
}

impl core::fmt::Debug for AnyLaw {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "AnyLaw({})", self.name())
    }
}

impl PointLaw for AnyLaw {
    fn name(&self) -> &str {
        self.law.name()
    }
    fn medium(&self) -> ElasticMedium {
        self.law.medium()
    }
    fn history(&self) -> &[HistoryVariable] {
        self.law.history()
    }
    fn uses_location(&self) -> bool {
        self.law.uses_location()
    }
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress {
        self.law.stress_change(input, new_history)
    }
    fn energy(&self, input: &LawInput<f64>, new_history: &[f64]) -> Option<LawEnergy<f64>> {
        self.law.energy(input, new_history)
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        self.law.accept_size(size)
    }
}
