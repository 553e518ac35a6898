//! What an element set is made of: a material and an element kernel.

use std::sync::Arc;

use powerhouse_explicit_core::{BlockFactory, BlockOptions, SolidKernel, solid};
use powerhouse_material_damage::{
    ElasticInSeries, FlatDamping, LinearElastic, ReferenceFrequency, RelaxationSpectrum,
};
use powerhouse_model::{
    ConstitutiveLaw, ElasticMedium, ElementKernel, ElementKind, HistoryVariable, LawEnergy,
    LawInput, ModelError, ParameterError, PointAdapter, PointLaw, Stress, point_energy,
    point_stress_change,
};

use crate::{Damping, Error};

/// A constitutive law of any type, so that a model can be composed at run time.
///
/// ```
/// use powerhouse::Material;
/// use powerhouse::material::{LinearElastic, media};
/// let rock = Material::from(LinearElastic::new(media::ROCK));
/// assert_eq!(rock.medium(), media::ROCK);
/// ```
#[derive(Clone)]
pub struct Material {
    law: Arc<dyn ErasedMaterial>,
    warnings: Arc<[String]>,
    /// None if damping cannot stand in series with the law.
    damped: Option<Arc<Damped>>,
}

/// The same material with damping in series.
type Damped = dyn Fn(RelaxationSpectrum, ReferenceFrequency) -> Result<Material, ParameterError>
    + Send
    + Sync;

impl Material {
    /// A material that follows a law of any type. The laws of the software are materials already,
    /// `Material::from(law)`: such a program is compiled sooner, and flat damping can stand in series
    /// with them.
    pub fn new(law: impl ConstitutiveLaw) -> Self {
        Self {
            law: Arc::new(law),
            warnings: Arc::new([]),
            damped: None,
        }
    }
    /// A material that follows a law of which the elastic part is known, so that damping can stand
    /// in series with it ([`Damping::Flat`]).
    pub fn in_series<M: ElasticInSeries>(law: M) -> Self {
        let undamped = law.clone();
        let damped = move |spectrum, reference| {
            let damped = FlatDamping::new(undamped.clone(), spectrum, reference)?;
            Ok(Self::new(damped))
        };
        // Laws are large; those that are compiled for damping serve without it too. What is linear
        // without damping is better off as it is.
        let bare = if const { M::LINEAR } {
            Self::new(law)
        } else {
            Self::new(FlatDamping::none(law))
        };
        Self {
            damped: Some(Arc::new(damped)),
            ..bare
        }
    }
    /// The same with what a user should know of its parameters, such as
    /// [`MohrCoulomb::findings`](powerhouse_material_damage::MohrCoulomb::findings): checks and
    /// runs warn of it.
    #[must_use]
    pub fn with_warnings(mut self, warnings: impl IntoIterator<Item: ToString>) -> Self {
        self.warnings = warnings
            .into_iter()
            .map(|warning| warning.to_string())
            .collect();
        self
    }
    /// What a user should know of its parameters.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
    /// Accepts or refuses elements of a width (m).
    ///
    /// # Errors
    /// Why, with the widths that are permitted.
    pub fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        self.law.accept_size(size)
    }
    /// The history variables of the law.
    pub fn history(&self) -> &[HistoryVariable] {
        self.law.history()
    }
    /// A material that follows a law for one point: simpler to write, slower to run.
    pub fn from_point_law(law: impl PointLaw + 'static) -> Self {
        Self::new(PointAdapter::new(law))
    }
    /// The law's name.
    pub fn name(&self) -> &str {
        self.law.name()
    }
    /// The elastic medium of the undamaged material.
    pub fn medium(&self) -> ElasticMedium {
        self.law.medium()
    }
    /// The undamaged material as it is where nothing yields.
    pub(crate) fn elastic(&self) -> Self {
        Self::new(LinearElastic::new(self.medium()))
    }
    /// Whether stress is linear in strain, without history.
    pub fn is_linear(&self) -> bool {
        self.law.is_linear()
    }
    /// The same with damping in series, as [`Damping::Flat`] has it; none if damping cannot stand in
    /// series with the law.
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

/// A law with its type erased.
trait ErasedMaterial: Send + Sync {
    fn name(&self) -> &str;
    fn medium(&self) -> ElasticMedium;
    fn is_linear(&self) -> bool;
    fn history(&self) -> &[HistoryVariable];
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress;
    fn energy(&self, input: &LawInput<f64>, new_history: &[f64]) -> Option<LawEnergy<f64>>;
    fn accept_size(&self, size: f64) -> Result<(), ModelError>;
    /// Blocks by a kernel that this law was compiled with.
    fn blocks(
        &self,
        kernel: SolidKernel,
        set: &str,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory>;
}

impl<T: ConstitutiveLaw> ErasedMaterial for T {
    fn name(&self) -> &str {
        ConstitutiveLaw::name(self)
    }
    fn medium(&self) -> ElasticMedium {
        ConstitutiveLaw::medium(self)
    }
    fn is_linear(&self) -> bool {
        ConstitutiveLaw::is_linear(self)
    }
    fn history(&self) -> &[HistoryVariable] {
        ConstitutiveLaw::history(self)
    }
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress {
        point_stress_change(self, input, new_history)
    }
    fn energy(&self, input: &LawInput<f64>, new_history: &[f64]) -> Option<LawEnergy<f64>> {
        point_energy(self, input, new_history)
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        ConstitutiveLaw::accept_size(self, size)
    }
    fn blocks(
        &self,
        kernel: SolidKernel,
        set: &str,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory> {
        kernel.factory(set, self.clone(), options)
    }
}

/// Any law as a law for one point: for kernels that it was not compiled with, and for drivers.
pub(crate) struct OneByOne(pub(crate) Material);

impl PointLaw for OneByOne {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn medium(&self) -> ElasticMedium {
        self.0.medium()
    }
    fn history(&self) -> &[HistoryVariable] {
        self.0.law.history()
    }
    fn stress_change(&self, input: &LawInput<f64>, new_history: &mut [f64]) -> Stress {
        self.0.law.stress_change(input, new_history)
    }
    fn energy(&self, input: &LawInput<f64>, new_history: &[f64]) -> Option<LawEnergy<f64>> {
        self.0.law.energy(input, new_history)
    }
    fn accept_size(&self, size: f64) -> Result<(), ModelError> {
        self.0.law.accept_size(size)
    }
}

/// An element kernel: one that comes with the software, or a user's own.
#[derive(Clone)]
pub struct Kernel(AnyKernel);

#[derive(Clone)]
enum AnyKernel {
    Solid(SolidKernel),
    Own(Arc<dyn OwnKernel>),
}

impl From<SolidKernel> for Kernel {
    fn from(kernel: SolidKernel) -> Self {
        Self(AnyKernel::Solid(kernel))
    }
}

impl Kernel {
    /// A kernel of one's own. It runs every material one point at a time, slower than a kernel
    /// that comes with the software.
    pub fn own<const N: usize, const P: usize>(kernel: impl ElementKernel<N, P>) -> Self {
        Self(AnyKernel::Own(Arc::new(Own::<_, N, P>(kernel))))
    }
    /// The kernel's name.
    pub fn name(&self) -> &str {
        match &self.0 {
            AnyKernel::Solid(kernel) => kernel.name(),
            AnyKernel::Own(kernel) => kernel.name(),
        }
    }
    /// The kind of element that it takes.
    pub fn kind(&self) -> ElementKind {
        match &self.0 {
            AnyKernel::Solid(kernel) => kernel.kind(),
            AnyKernel::Own(kernel) => kernel.kind(),
        }
    }
    /// How many integration points an element has.
    pub fn points(&self) -> usize {
        match &self.0 {
            AnyKernel::Solid(kernel) => kernel.points(),
            AnyKernel::Own(kernel) => kernel.points(),
        }
    }
    /// A factory of blocks of a material for an element set: scenes make theirs of it, models that
    /// are built without a scene may.
    pub fn factory(
        &self,
        set: &str,
        material: &Material,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory> {
        match &self.0 {
            AnyKernel::Solid(kernel) => material.law.blocks(*kernel, set, options),
            AnyKernel::Own(kernel) => kernel.blocks(set, material, options),
        }
    }
}

impl core::fmt::Debug for Kernel {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "Kernel({})", self.name())
    }
}

trait OwnKernel: Send + Sync {
    fn name(&self) -> &str;
    fn kind(&self) -> ElementKind;
    fn points(&self) -> usize;
    fn blocks(
        &self,
        set: &str,
        material: &Material,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory>;
}

struct Own<K, const N: usize, const P: usize>(K);

impl<K: ElementKernel<N, P>, const N: usize, const P: usize> OwnKernel for Own<K, N, P> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn kind(&self) -> ElementKind {
        self.0.kind()
    }
    fn points(&self) -> usize {
        P
    }
    fn blocks(
        &self,
        set: &str,
        material: &Material,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory> {
        let law = PointAdapter::new(OneByOne(material.clone()));
        solid(set, self.0.clone(), law, options)
    }
}

/// An element set and what it is made of.
#[derive(Clone, Debug)]
pub struct Part {
    /// The element set of the mesh.
    pub set: String,
    /// The material.
    pub material: Material,
    /// The kernel of the elements of its kind; others, and all without one, take the default of
    /// their kind.
    pub kernel: Option<Kernel>,
    /// Damping.
    pub damping: Damping,
    /// How far from the absorbing faces (m) the part is elastic and undamped, as the free field
    /// behind them is: elements that touch them, and those of which a node is closer. None: nowhere.
    pub rim: Option<f64>,
}

impl Part {
    /// An undamped part with the default kernels.
    pub fn new(set: impl Into<String>, material: Material) -> Self {
        Self {
            set: set.into(),
            material,
            kernel: None,
            damping: Damping::None,
            rim: None,
        }
    }
    /// The same with a kernel.
    #[must_use]
    pub fn with_kernel(mut self, kernel: impl Into<Kernel>) -> Self {
        self.kernel = Some(kernel.into());
        self
    }
    /// The same with damping.
    #[must_use]
    pub fn with_damping(mut self, damping: impl Into<Damping>) -> Self {
        self.damping = damping.into();
        self
    }
    /// The same with a rim (m), elastic and undamped, along the absorbing faces; 0 for the elements
    /// that touch them alone.
    #[must_use]
    pub fn with_rim(mut self, width: f64) -> Self {
        self.rim = Some(width);
        self
    }
    /// The material as it moves: damped, if damping stands in series with its law.
    ///
    /// # Errors
    /// [`Error::NotInSeries`]; a reference frequency out of range.
    pub fn moving_material(&self) -> Result<Material, Error> {
        let Damping::Flat {
            spectrum,
            reference,
        } = &self.damping
        else {
            return Ok(self.material.clone());
        };
        let damped =
            self.material
                .damped(spectrum, *reference)?
                .ok_or_else(|| Error::NotInSeries {
                    set: self.set.clone(),
                    law: self.material.name().into(),
                })?;
        Ok(damped)
    }
    /// The part's own kernel, if it is for none of the kinds.
    pub(crate) fn idle_kernel(
        &self,
        mut kinds: impl Iterator<Item = ElementKind>,
    ) -> Option<&Kernel> {
        let kernel = self.kernel.as_ref()?;
        (!kinds.any(|kind| kind == kernel.kind())).then_some(kernel)
    }
    /// The kernel for a kind of element.
    pub(crate) fn kernel_for(&self, kind: ElementKind) -> Option<Kernel> {
        match &self.kernel {
            Some(kernel) if kernel.kind() == kind => Some(kernel.clone()),
            _ => SolidKernel::default_for(kind).map(Kernel::from),
        }
    }
}
