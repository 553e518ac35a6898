//! Hexahedral mesh of one machine bay of an underground powerhouse with its transformer cavern.
//!
//! The powerhouse of Wang, Chen & Xiao (2019), section 4: a main powerhouse and a main transformer
//! cavern with linings, floors, windshield, turbine pier and mass concrete, in rock under a free
//! surface. The paper publishes neither its mesh nor all sizes; assumptions are the
//! defaults of [`BayDimensions`] and are documented there.
//!
//! ```
//! use powerhouse_wang_2019::bay::{Bay, BaySize};
//! let bay = Bay::of_size(BaySize::Coarse).mesh()?;
//! assert_eq!(bay.mesh.element_count(), 15_840);
//! assert_eq!(bay.mesh.element_set("windshield")?.len(), bay.report.elements_of("windshield"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Sets
//! | kind | sets |
//! |---|---|
//! | parts, each element in one | `rock`; `void_main`, `void_transformer`; `arch_`, `wall_`, `base_main`; `mass`, `pier`, `windshield`; `floor_generator`, `floor_busbar`, `floor_turbine`; `arch_`, `wall_`, `floor_transformer` |
//! | elements of several parts | `void` (excavated without structure); `structure` (all concrete), of it `lining` (what touches rock) and `interior`; stages of excavation `main_1` to `main_5`, `transformer_1` to `transformer_3`; `rim`, the rock at the faces through which waves come |
//! | faces of the block | `left`, `right` (least and greatest x), `front`, `back` (y), `bottom`, `top`; `front_rock`, `back_rock`, `front_structure`, `back_structure`: their parts in rock and in concrete |
//! | facets of rock towards the structure | `joint_` and the name of the part; `joint_ends` beyond the ends of a bay in a block of rock; for bolts `roof_` and `walls_main`, `roof_` and `walls_transformer` |
//! | nodes | `point_A` to `point_F`, `point_O1`, `point_O2`: the monitoring points of the paper on the inner face of the concrete at mid-bay |
//!
//! # Why so
//! *One structured grid, deformed.* Lines of cells run through the whole block; arches bend the rows, octagons the
//! columns and layers. No mesh generator is needed that may fail, the part of a cell follows from its number, and
//! both ends of the bay have the same grid. Columns stay upright at the arches: the scaled Jacobian there is the
//! cosine of the slope.
//!
//! *Spacings are smoothed away from the structure*, or its thin cells would extend to the ends of the block and
//! reduce the time step.
//!
//! *Concrete takes the cells of the excavated rock.* Excavated cells are in the mesh, since the construction stages
//! before the earthquake need them; numbers of elements are those of all cells of the file.

mod bolts;
mod cells;
mod dimensions;
mod file;
mod grid;
mod parts;
mod picture;
mod plan;
mod quality;
mod report;
mod sets;
mod spacing;

use powerhouse::model::{Mesh, ParameterError, Vec3};
use serde::Deserialize;

pub use bolts::{BAY_BOLT_ROWS, BAY_BOLTS, BayBolts};
pub use cells::{BayCells, BaySize};
pub use dimensions::BayDimensions;
pub use parts::BayPart;
pub use quality::scaled_jacobians;
pub use report::{BayReport, PointReport};
pub use sets::MonitoringPoint;

use crate::BayError;
use grid::Grid;
use plan::Plan;

/// Rock beyond both ends of a bay, for a single bay embedded in a block.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RockEnds {
    /// Length of the rock beyond each end (m), 20 to 150.
    pub rock: f64,
    /// Number of elements along that length, 1 to 1000; more are used where the longest spacing would be exceeded.
    pub cells: usize,
}

/// Dimensions and mesh density of a machine bay, from which its mesh is generated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bay {
    /// Dimensions of caverns, structure and rock (m).
    pub dimensions: BayDimensions,
    /// Numbers of elements and grid spacings.
    pub cells: BayCells,
    /// Rock beyond both ends; without it the bay is one period of an endless row of bays.
    pub ends: Option<RockEnds>,
}

/// Mesh of a machine bay with a report on it.
#[derive(Clone, Debug, PartialEq)]
pub struct BayMesh {
    /// Mesh with its named sets; rock and structure share their nodes.
    pub mesh: Mesh,
    /// Numbers of elements, mesh quality, volumes and monitoring points.
    pub report: BayReport,
}

impl Bay {
    /// The bay of Wang, Chen & Xiao (2019) with a predefined mesh density.
    pub fn of_size(size: BaySize) -> Self {
        Self {
            dimensions: BayDimensions::default(),
            cells: size.cells(),
            ends: None,
        }
    }

    /// Adds rock beyond both ends of the bay.
    #[must_use]
    pub fn in_block(mut self, ends: RockEnds) -> Self {
        self.ends = Some(ends);
        self
    }

    /// Checks that all dimensions, numbers of elements and spacings are within their ranges.
    ///
    /// # Errors
    /// [`BayError::Parameter`] with the name, the value and the permitted range; [`BayError::OddCells`].
    pub fn check(&self) -> Result<(), BayError> {
        self.dimensions.check()?;
        let cells = &self.cells;
        let counts = [
            cells.lining,
            cells.floor,
            cells.ring_to_wall,
            cells.ring_to_end,
        ];
        let counts = counts.into_iter().chain(cells.ring).chain(cells.storeys);
        let further = [
            cells.transformer / 2,
            cells.pillar,
            cells.side,
            cells.above,
            cells.below,
        ];
        for count in counts.chain(further) {
            ParameterError::check("cells", count as f64, 1.0, 1000.0)?;
        }
        if !cells.transformer.is_multiple_of(2) {
            return Err(BayError::OddCells {
                cells: cells.transformer,
            });
        }
        let lengths = [
            cells.longest,
            cells.first_beside,
            cells.first_above,
            cells.first_below,
        ];
        for length in lengths {
            ParameterError::check("spacing", length, 0.1, 100.0)?;
        }
        if let Some(ends) = &self.ends {
            ParameterError::check("rock", ends.rock, 20.0, 150.0)?;
            ParameterError::check("cells", ends.cells as f64, 1.0, 1000.0)?;
        }
        Ok(())
    }

    /// Generates the mesh.
    ///
    /// # Errors
    /// As [`check`](Self::check), and [`BayError::Mesh`] if an element is inverted.
    pub fn mesh(&self) -> Result<BayMesh, BayError> {
        self.check()?;
        let plan = Plan::of(self);
        let grid = Grid::new(self, &plan);
        let counts = plan.cells();
        let far = Vec3::from_fn(|axis, _| counts[axis] as f64);
        let lattice = Mesh::box_of_hexes(Vec3::zeros(), far, counts, BayPart::Rock.name())?;
        let mut mesh = lattice.map_positions(|line| {
            grid.node(
                line.x.round() as usize,
                line.y.round() as usize,
                line.z.round() as usize,
            )
        })?;
        let parts = sets::name_sets(&mut mesh, &plan, &self.dimensions, self.ends.is_some())?;
        let points = sets::name_points(&mut mesh, &plan, &self.dimensions)?;
        let report = BayReport::of(self, counts, &mesh, &parts, &points)?;
        Ok(BayMesh { mesh, report })
    }
}
