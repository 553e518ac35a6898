//! Items of output: each has its observers, its tables with their files and plots, and its price.

use core::fmt;
use core::ops::AddAssign;
use std::sync::Arc;

use powerhouse_elements::BoltSet;
use powerhouse_io::TableColumn;
use powerhouse_model::{Cadence, HistoryKind, Mesh, Observer};
use powerhouse_observe::{HistoryTable, Motion, Recording, SectionGeometry};

use super::{OutputPlan, Results, StateVariables, TableForm, TablePlot};
use crate::joint::NamedSurface;
use crate::{Error, LawMemory, Part, Remark, Scene};

/// Item of output, such as the energy balance or a table of a program's own: what observes it, the tables that it leaves, and
/// its price. It holds what is requested of it.
///
/// A run has the items that come with the software and those of its [plan](OutputPlan::item). Their tables grow in the results
/// folder while the run goes on, are among the [results](Results::table), and are written with their plots.
///
/// ```
/// use powerhouse_model::{Cadence, ModelError};
/// use powerhouse_observe::EnergyHistory;
/// use powerhouse_scene::{
///     Error, OutputItem, OutputPlan, OutputPrice, OutputScale, OutputSite, Recorder, TableForm, TablePeaks,
///     TablePlots,
/// };
/// use std::sync::Arc;
/// /// The energy balance at long intervals (s).
/// #[derive(Debug)]
/// struct Coarse(f64);
/// impl OutputItem for Coarse {
///     fn record(&self, _site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
///         let energies = EnergyHistory::new(Cadence::Seconds(self.0)).map_err(ModelError::from)?;
///         let form = TableForm::new("coarse", TablePlots::One, TablePeaks::None);
///         into.table(form, energies.recording(), |table| table);
///         into.observe(energies);
///         Ok(())
///     }
///     fn price(&self, scale: &OutputScale) -> OutputPrice {
///         scale.table(19.0, self.0)
///     }
/// }
/// let plan = OutputPlan::default().item(Arc::new(Coarse(0.5)));
/// assert_eq!(plan.items.len(), 1);
/// ```
pub trait OutputItem: fmt::Debug + Send + Sync {
    /// Adds its observers and tables in a run; none where it is not requested.
    ///
    /// # Errors
    /// A place or set that the body does not have, a parameter out of range.
    fn record(&self, site: &OutputSite, into: &mut Recorder) -> Result<(), Error>;
    /// Memory and files of a run; zero where it is not requested.
    fn price(&self, scale: &OutputScale) -> OutputPrice;
}

/// The same item.
impl PartialEq for dyn OutputItem {
    fn eq(&self, other: &Self) -> bool {
        core::ptr::addr_eq(self, other)
    }
}

/// The body and its requests as an item of output sees them before a run.
#[non_exhaustive]
pub struct OutputSite<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// All requests.
    pub plan: &'a OutputPlan,
    /// Which elements of the mesh are active; none if all are.
    pub present: Option<&'a [bool]>,
    /// Highest frequency (Hz) of band-limited accelerations, if there are any.
    pub(crate) band: Option<f64>,
    pub(crate) state_variables: &'a StateVariables,
    pub(crate) parts: &'a [Part],
    pub(crate) joints: &'a [NamedSurface],
    pub(crate) bolts: &'a [&'a BoltSet],
    /// Pairs of nodes at opposite ends of a body that repeats beyond them.
    pub(crate) pairs: &'a [(u32, u32)],
}

impl OutputSite<'_> {
    /// Steps at which histories are sampled.
    pub fn cadence(&self) -> Cadence {
        Cadence::Seconds(self.plan.every)
    }
}

/// Reader of a table while a run goes on.
pub(super) type ReadTable = Box<dyn Fn(&mut dyn FnMut(&HistoryTable)) + Send + Sync>;
/// What is done with the results at the end of a run.
pub(super) type End = Box<dyn FnOnce(&mut Results) + Send + Sync>;
/// Columns of a list, and its plot.
pub type ListContent = (Vec<TableColumn>, Option<TablePlot>);

/// Maker of the content of a list from the results; none without content.
type MakeList = Box<dyn FnOnce(&Results) -> Option<ListContent> + Send + Sync>;

/// List that is made at the end of a run.
pub(super) struct ListMaker {
    pub(super) name: String,
    pub(super) plot: Option<String>,
    pub(super) make: MakeList,
}

/// Observers of items of output, and what they leave.
#[derive(Default)]
pub struct Recorder {
    /// Remarks about the requests.
    pub remarks: Vec<Remark>,
    pub(super) observers: Vec<Box<dyn Observer>>,
    pub(super) tables: Vec<(TableForm, ReadTable)>,
    pub(super) lists: Vec<ListMaker>,
    pub(super) ends: Vec<End>,
    pub(super) geometry: Vec<SectionGeometry>,
}

impl Recorder {
    /// Adds an observer.
    pub fn observe(&mut self, observer: impl Observer + 'static) {
        self.observers.push(Box::new(observer));
    }
    /// Adds a table of time histories: that of a recording, whose columns may come with its first row.
    pub fn table<T: Send + 'static>(
        &mut self,
        form: TableForm,
        recording: Recording<T>,
        table: fn(&T) -> &HistoryTable,
    ) {
        let read =
            move |take: &mut dyn FnMut(&HistoryTable)| recording.read(|all| take(table(all)));
        self.tables.push((form, Box::new(read)));
    }
    /// Adds a list: a table that is made at the end of the run, of the path `name` without its ending, and the path of its plot,
    /// if it has one; without content there is none.
    pub fn list(
        &mut self,
        name: impl Into<String>,
        plot: Option<String>,
        make: impl FnOnce(&Results) -> Option<ListContent> + Send + Sync + 'static,
    ) {
        self.lists.push(ListMaker {
            name: name.into(),
            plot,
            make: Box::new(make),
        });
    }
    /// Adds what is done with the results at the end of the run, before lists are made.
    pub(super) fn end(&mut self, end: impl FnOnce(&mut Results) + Send + Sync + 'static) {
        self.ends.push(Box::new(end));
    }
}

/// Sizes of a scene and its run, on which the price of its output depends.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct OutputScale {
    /// The mesh.
    pub mesh: Arc<Mesh>,
    /// All requests.
    pub plan: OutputPlan,
    /// Duration of the run (s).
    pub duration: f64,
    /// Number of its steps.
    pub steps: u64,
    /// Number of joints.
    pub joints: usize,
    /// Number of corners of the facets of joints, each of which is a point in files.
    pub corners: usize,
    /// Number of bolt groups.
    pub bolts: usize,
    /// History variables of laws.
    pub laws: LawMemory,
}

impl OutputScale {
    /// Price of a table with a number of columns beside time, and rows at an interval (s); none without columns.
    pub fn table(&self, columns: f64, every: f64) -> OutputPrice {
        let columns = if columns > 0.0 { 1.0 + columns } else { 0.0 };
        OutputPrice::of_numbers(columns * self.rows(every))
    }
    /// Number of samples at an interval (s): at most one per step, with the first and the last.
    pub fn rows(&self, every: f64) -> f64 {
        ((self.duration / every).ceil() + 2.0).min(self.steps as f64)
    }
    /// Numbers of nodes and elements.
    pub fn counts(&self) -> [f64; 2] {
        [self.mesh.node_count(), self.mesh.element_count()].map(|count| count as f64)
    }
    /// Number of the shown history variables of a kind.
    pub(super) fn variables(&self, kind: HistoryKind) -> f64 {
        let of_kind = self.laws.variables.iter().filter(|v| v.kind == kind);
        of_kind.count() as f64
    }
    /// Bytes of a VTU file without fields: positions, numbers, connectivity and sets.
    pub(super) fn bytes_of_body(&self) -> f64 {
        let [nodes, elements] = self.counts();
        16.0 * nodes + elements * (20.0 + self.mesh.element_sets().len() as f64 / 8.0)
    }
    /// Bytes of the facets of joints in a VTU file with a number of fields: position and cell of each corner, and its numbers.
    pub(super) fn bytes_of_facets(&self, fields: f64) -> f64 {
        (40.0 + 4.0 * fields) * self.corners as f64
    }
    /// Memory and files of all items in a run with a number of steps.
    pub fn price(&self, steps: u64) -> OutputPrice {
        let scale = Self {
            steps,
            ..self.clone()
        };
        let mut sum = OutputPrice::default();
        for item in scale.plan.all_items() {
            sum += item.price(&scale);
        }
        sum
    }
}

/// Memory and size of the files of an output (bytes).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputPrice {
    /// Greatest memory, while it is written and drawn.
    pub memory: f64,
    /// Size of its files, an upper bound.
    pub files: f64,
}

impl OutputPrice {
    /// The price of numbers in tables, times included: 32 bytes of memory each, with the copies while they are written and drawn;
    /// 23 bytes in a CSV file and 16 of a point in a plot.
    pub fn of_numbers(numbers: f64) -> Self {
        Self {
            memory: 32.0 * numbers,
            files: (23.0 + 16.0) * numbers,
        }
    }
}

impl AddAssign for OutputPrice {
    fn add_assign(&mut self, other: Self) {
        self.memory += other.memory;
        self.files += other.files;
    }
}

/// Number of vectors of a motion.
pub(super) fn vectors(motion: Motion) -> f64 {
    let wanted = [motion.displacement, motion.velocity, motion.acceleration];
    wanted.iter().filter(|wanted| **wanted).count() as f64
}

impl Scene {
    /// Sizes of the scene on which the price of its output depends.
    ///
    /// # Errors
    /// Those of [`law_memory`](Self::law_memory).
    pub fn output_scale(&self) -> Result<OutputScale, Error> {
        let facets = self.joints().flat_map(|(_, surface, _)| &surface.facets);
        Ok(OutputScale {
            mesh: self.mesh.clone(),
            plan: self.output.clone(),
            duration: self.duration,
            steps: u64::MAX,
            joints: self.joints.len(),
            corners: facets.map(|facet| facet.nodes.len()).sum(),
            bolts: self.bolts.len(),
            laws: self.law_memory()?,
        })
    }
}
