//! Parts of a body: element sets with their materials and element kernels.

use std::sync::Arc;

use powerhouse_elements::{AnyLaw, SolidKernel, solid};
use powerhouse_laws::{Damping, Material};
use powerhouse_model::{BlockFactory, BlockOptions, ElementKernel, ElementKind, KernelArithmetic};

use crate::Error;

/// Element kernel of a part: one of the software, or a user's own.
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
    /// A kernel of one's own; it evaluates every material in lanes, as the kernels of the software do.
    pub fn own<const N: usize, const P: usize>(kernel: impl ElementKernel<N, P>) -> Self {
        Self(AnyKernel::Own(Arc::new(Own::<_, N, P>(kernel))))
    }
    /// Name of the kernel.
    pub fn name(&self) -> &str {
        match &self.0 {
            AnyKernel::Solid(kernel) => kernel.name(),
            AnyKernel::Own(kernel) => kernel.name(),
        }
    }
    /// Kind of elements that the kernel computes.
    pub fn kind(&self) -> ElementKind {
        match &self.0 {
            AnyKernel::Solid(kernel) => kernel.kind(),
            AnyKernel::Own(kernel) => kernel.kind(),
        }
    }
    /// Number of integration points of an element.
    pub fn points(&self) -> usize {
        match &self.0 {
            AnyKernel::Solid(kernel) => kernel.points(),
            AnyKernel::Own(kernel) => kernel.points(),
        }
    }
    /// Number of history variables of an element as a whole, with laws that have a history.
    pub(crate) fn own_history(&self) -> usize {
        match &self.0 {
            AnyKernel::Solid(kernel) => kernel.own_history(),
            AnyKernel::Own(kernel) => kernel.own_history(),
        }
    }
    /// Whether straight elements in one layer have the bending stiffness of a plate.
    pub(crate) fn bends_as_its_material(&self) -> bool {
        matches!(&self.0, AnyKernel::Solid(kernel) if kernel.bends_as_its_material())
    }
    /// Factory that builds the element block of a set: the elements of the set, computed together by this kernel with
    /// the law of a material. A scene builds each of its parts by one; a program that builds a
    /// model without a scene gives it to the [`ModelSpec`](powerhouse_model::ModelSpec). `set` is the name of the element set in the mesh,
    /// `options` have number format, lanes and Rayleigh damping. Whether the elements are of the kind of the kernel
    /// is checked when the block is built.
    pub fn factory(
        &self,
        set: &str,
        material: &Material,
        options: BlockOptions,
    ) -> Box<dyn BlockFactory> {
        match &self.0 {
            AnyKernel::Solid(kernel) => kernel.factory(set, material.law().clone(), options),
            AnyKernel::Own(kernel) => kernel.factory(set, material.law().clone(), options),
        }
    }
}

impl core::fmt::Debug for Kernel {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "Kernel({})", self.name())
    }
}

/// A user's kernel with its type erased.
trait OwnKernel: Send + Sync {
    fn name(&self) -> &str;
    fn kind(&self) -> ElementKind;
    fn points(&self) -> usize;
    fn own_history(&self) -> usize;
    fn factory(&self, set: &str, law: AnyLaw, options: BlockOptions) -> Box<dyn BlockFactory>;
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
    fn own_history(&self) -> usize {
        self.0.own_history()
    }
    fn factory(&self, set: &str, law: AnyLaw, options: BlockOptions) -> Box<dyn BlockFactory> {
        solid(set, self.0.clone(), law, options)
    }
}

/// Part of a body: an element set with its material, element kernel and damping.
#[derive(Clone, Debug)]
pub struct Part {
    /// Name of the element set in the mesh.
    pub set: String,
    /// Material of the elements: constitutive law with its parameters.
    pub material: Material,
    /// Kernel of the elements of its kind; others, and all if it is none, have the default kernel of their
    /// kind.
    pub kernel: Option<Kernel>,
    /// Damping in the dynamic run; of flat damping the static stiffness holds in construction stages.
    pub damping: Damping,
    /// Damping ratio (share of critical damping) at the highest natural frequency of the part's elements, by a viscosity
    /// proportional to stiffness beside the [damping](Self::damping): the ratio is proportional to frequency, with next to nothing at
    /// those of earthquakes. It damps what cracks, joints and yielding excite on single elements. Zero: none.
    pub high: f64,
    /// Material in construction stages that name none for the part; that of the run if it is none. The run begins with the mean
    /// stress of each element in its own material, at rest.
    pub static_material: Option<Material>,
    /// Width (m) of the elastic buffer zone along absorbing faces, where the part is linear elastic and undamped
    /// as the free field behind them: elements that touch the faces, and those with a node closer than this.
    /// None: no such zone.
    pub rim: Option<f64>,
}

impl Part {
    /// An undamped part of an element set and a material, with the default kernels.
    pub fn new(set: impl Into<String>, material: Material) -> Self {
        Self {
            set: set.into(),
            material,
            kernel: None,
            damping: Damping::None,
            high: 0.0,
            static_material: None,
            rim: None,
        }
    }
    /// The same with a kernel for the elements of its kind; others keep the default kernel of theirs.
    #[must_use]
    pub fn with_kernel(mut self, kernel: impl Into<Kernel>) -> Self {
        self.kernel = Some(kernel.into());
        self
    }
    /// The same with this damping in the dynamic run, in place of another one.
    #[must_use]
    pub fn with_damping(mut self, damping: impl Into<Damping>) -> Self {
        self.damping = damping.into();
        self
    }
    /// The same with this damping ratio at the [highest natural frequency](Self::high) of its elements, 0 to 1.
    #[must_use]
    pub fn with_high_damping(mut self, ratio: f64) -> Self {
        self.high = ratio;
        self
    }
    /// The same with another material in construction stages, as long as these name none for the part: ground whose
    /// moduli depend on the strain of the motion rests with those of small strain.
    #[must_use]
    pub fn with_static_material(mut self, material: Material) -> Self {
        self.static_material = Some(material);
        self
    }
    /// Sets the width of the elastic rim (m): elements within it of an absorbing face are elastic and undamped; 0 for
    /// the elements that touch such a face alone.
    #[must_use]
    pub fn with_rim(mut self, width: f64) -> Self {
        self.rim = Some(width);
        self
    }
    /// Material in the dynamic run: with flat damping in series, if the part has it, else its own.
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
    /// The part's own kernel, if it computes none of some kinds of elements.
    pub fn unused_kernel(&self, mut kinds: impl Iterator<Item = ElementKind>) -> Option<&Kernel> {
        let kernel = self.kernel.as_ref()?;
        (!kinds.any(|kind| kind == kernel.kind())).then_some(kernel)
    }
    /// The kernel for a kind of elements.
    pub fn kernel_for(&self, kind: ElementKind) -> Option<Kernel> {
        match &self.kernel {
            Some(kernel) if kernel.kind() == kind => Some(kernel.clone()),
            _ => SolidKernel::default_for(kind).map(Kernel::from),
        }
    }
}
