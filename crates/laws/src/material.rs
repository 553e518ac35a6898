//! Materials: constitutive laws of any type.

use std::sync::Arc;

use powerhouse_elements::{AnyLaw, Drainage, PoreWater};
use powerhouse_material_damage::{
    ElasticInSeries, FlatDamping, LinearElastic, ReferenceFrequency, RelaxationSpectrum,
    growth_of_flow,
};
use powerhouse_model::{
    BlockLaw, ConstitutiveLaw, ElasticMedium, HistoryVariable, ModelError, ParameterError,
    PointAdapter, PointLaw,
};

use crate::Damping;

/// Material: a constitutive law of any type, with warnings about its parameters and, if its law permits it,
/// its form with flat damping.
///
/// ```
/// use powerhouse_laws::Material;
/// use powerhouse_material_damage::{LinearElastic, media};
/// let rock = Material::from(LinearElastic::new(media::ROCK));
/// assert_eq!(rock.medium(), media::ROCK);
/// ```
#[derive(Clone)]
pub struct Material {
    law: AnyLaw,
    /// Whether the law is linear elastic, of material with water in its pores that of the skeleton.
    is_linear: bool,
    warnings: Arc<[String]>,
    default_damping: Damping,
    /// None if damping in series with the law is not possible.
    damped: Option<Arc<Damped>>,
    /// None of a law whose flow is not known.
    growth: Option<Arc<dyn Fn() -> Option<f64> + Send + Sync>>,
}

/// Function that makes the material with damping in series.
type Damped = dyn Fn(RelaxationSpectrum, ReferenceFrequency) -> Result<Material, ParameterError>
    + Send
    + Sync;

impl Material {
    /// A material with a law of any type, without flat damping.
    ///
    /// For the laws of the software use `Material::from(law)`: such a program compiles faster, and flat damping
    /// is possible.
    pub fn new(law: impl ConstitutiveLaw) -> Self {
        Self::of(AnyLaw::new(law))
    }
    fn of(law: AnyLaw) -> Self {
        Self {
            is_linear: law.is_linear(),
            law,
            warnings: Arc::new([]),
            default_damping: Damping::None,
            damped: None,
            growth: None,
        }
    }
    /// A material with a law of which the elastic part is known, so that flat damping in series with it is
    /// possible ([`Damping::Flat`]).
    pub fn in_series<M: ElasticInSeries>(law: M) -> Self {
        let (undamped, flowing) = (law.clone(), law.clone());
        let damped = move |spectrum, reference| {
            let damped = FlatDamping::new(undamped.clone(), spectrum, reference)?;
            Ok(Self::new(damped))
        };
        // A law is compiled once, in its form with damping, which also serves without damping; linear laws are
        // faster in their own form.
        let bare = if const { M::LINEAR } {
            Self::new(law)
        } else {
            Self::new(FlatDamping::none(law))
        };
        Self {
            damped: Some(Arc::new(damped)),
            growth: Some(Arc::new(move || growth_of_flow(&flowing))),
            ..bare
        }
    }
    /// The same material with warnings about its parameters, such as
    /// [`MohrCoulomb::findings`](powerhouse_material_damage::MohrCoulomb::findings), which checks and runs
    /// report.
    #[must_use]
    pub fn with_warnings(mut self, warnings: impl IntoIterator<Item: ToString>) -> Self {
        self.warnings = warnings
            .into_iter()
            .map(|warning| warning.to_string())
            .collect();
        self
    }
    /// Warnings about the parameters of the material.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
    /// The same material with a default damping: parts of scene files that have this material, and no damping of
    /// their own, are damped so where waves are incident. `Part::new` damps nothing by itself.
    #[must_use]
    pub fn with_default_damping(mut self, damping: impl Into<Damping>) -> Self {
        self.default_damping = damping.into();
        self
    }
    /// Damping of parts of scene files with this material that name none; of most materials none.
    pub fn default_damping(&self) -> &Damping {
        &self.default_damping
    }
    /// Rate at which short waves grow while the material flows, per wave number (m/s), [`growth_of_flow`] of its law: above zero
    /// where the flow is far from associated. None of laws that do not flow, and of [`new`](Self::new).
    pub fn growth_of_flow(&self) -> Option<f64> {
        self.growth.as_ref().and_then(|growth| growth())
    }
    /// Checks a width of an element (m) by the law, [`ConstitutiveLaw::accept_size`].
    ///
    /// # Errors
    /// The reason of a refusal, with the permitted widths.
    pub fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        self.law.accept_size(size)
    }
    /// The constitutive law, for blocks of elements that are built without a scene.
    pub fn law(&self) -> &AnyLaw {
        &self.law
    }
    /// Names, units and kinds of the history variables of the law; empty for a law without any.
    pub fn history(&self) -> &[HistoryVariable] {
        self.law.history()
    }
    /// A material with a law for one integration point: simpler to write, slower to run.
    pub fn from_point_law(law: impl PointLaw + 'static) -> Self {
        Self::new(PointAdapter::new(law))
    }
    /// A material with a law for all integration points of an element block at once: for laws of which every call is
    /// costly, as those of other languages.
    pub fn from_block_law(law: impl BlockLaw + 'static) -> Self {
        Self::of(AnyLaw::of_blocks(law))
    }
    /// Name of the law, such as `mohr-coulomb`.
    pub fn name(&self) -> &str {
        self.law.name()
    }
    /// The same material with water in its pores, which is drained in static states and cannot flow in dynamic steps; its law
    /// sees effective stress. Flat damping is that of the skeleton.
    #[must_use]
    pub fn with_pore_water(&self, water: PoreWater) -> Self {
        self.with_law(move |law| law.with_pore_water(water.clone()))
    }
    /// The same material whose water in pores, if there is any, is drained or undrained in static states; drained at first.
    #[must_use]
    pub fn with_drainage(&self, drainage: Drainage) -> Self {
        self.with_law(move |law| law.with_drainage(drainage))
    }
    /// The same material with pressures (Pa) of the water in its pores, if there is any, in static states by element of the
    /// mesh; elements without one keep that of their height.
    #[must_use]
    pub fn with_pore_pressures(&self, pressures: Arc<[Option<f64>]>) -> Self {
        self.with_law(move |law| law.with_pore_pressures(pressures.clone()))
    }
    /// The material with another form of its law, with and without damping.
    fn with_law(&self, form: impl Fn(&AnyLaw) -> AnyLaw + Clone + Send + Sync + 'static) -> Self {
        let of_damped = form.clone();
        let damped = self.damped.clone().map(|damped| -> Arc<Damped> {
            Arc::new(move |spectrum, reference| {
                Ok(damped(spectrum, reference)?.with_law(of_damped.clone()))
            })
        });
        Self {
            law: form(&self.law),
            damped,
            ..self.clone()
        }
    }
    /// The water in the pores of the material, if there is any.
    pub fn pore_water(&self) -> Option<&PoreWater> {
        self.law.pore_water()
    }
    /// The elastic medium of the undamaged material, with water in its pores that cannot flow.
    pub fn medium(&self) -> ElasticMedium {
        self.law.medium()
    }
    /// Elastic material of the undamaged medium, with the water in its pores.
    pub fn elastic(&self) -> Self {
        let elastic = Self::new(LinearElastic::new(self.law.skeleton()));
        match self.pore_water() {
            Some(water) => elastic.with_pore_water(water.clone()),
            None => elastic,
        }
    }
    /// Whether the material is linear elastic; it may have water in its pores.
    pub fn is_linear(&self) -> bool {
        self.is_linear
    }
    /// The same material with damping by a relaxation spectrum in series, for [`Damping::Flat`], with the moduli of the
    /// material at a reference frequency; none if damping in series with the law is not possible.
    ///
    /// # Errors
    /// A reference frequency that is not positive.
    pub fn damped(
        &self,
        spectrum: &RelaxationSpectrum,
        reference: ReferenceFrequency,
    ) -> Result<Option<Self>, ParameterError> {
        let damped = self.damped.as_ref();
        damped
            .map(|damped| damped(spectrum.clone(), reference))
            .transpose()
    }
}

impl core::fmt::Debug for Material {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "Material({})", self.name())
    }
}
