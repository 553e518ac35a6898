//! Assignment of the grid cells to rock, voids and parts of the structure.

use super::plan::{Column, Layer, Plan, Ring, Row};

/// Part of a machine bay: rock, void or a concrete member; each element belongs to exactly one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum BayPart {
    /// Rock that is never excavated.
    Rock,
    /// Excavated space of the main powerhouse without structure.
    VoidMain,
    /// Excavated space of the transformer cavern without structure.
    VoidTransformer,
    /// Lining of the roof arch of the main powerhouse.
    ArchMain,
    /// Lining of the walls of the main powerhouse, down to its bottom.
    WallMain,
    /// Base slab of the main powerhouse.
    BaseMain,
    /// Mass concrete of the main powerhouse between base slab and turbine floor, around the pit.
    Mass,
    /// Turbine pier, an octagonal ring.
    Pier,
    /// Generator windshield, an octagonal ring above the pier.
    Windshield,
    /// Generator floor of the main powerhouse.
    FloorGenerator,
    /// Busbar floor of the main powerhouse.
    FloorBusbar,
    /// Turbine floor of the main powerhouse.
    FloorTurbine,
    /// Lining of the roof arch of the transformer cavern.
    ArchTransformer,
    /// Lining of the walls of the transformer cavern, down to its bottom.
    WallTransformer,
    /// Floor of the transformer cavern.
    FloorTransformer,
}

impl BayPart {
    /// All parts.
    pub const ALL: [Self; 15] = [
        Self::Rock,
        Self::VoidMain,
        Self::VoidTransformer,
        Self::ArchMain,
        Self::WallMain,
        Self::BaseMain,
        Self::Mass,
        Self::Pier,
        Self::Windshield,
        Self::FloorGenerator,
        Self::FloorBusbar,
        Self::FloorTurbine,
        Self::ArchTransformer,
        Self::WallTransformer,
        Self::FloorTransformer,
    ];

    /// Name of the element set of the part.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rock => "rock",
            Self::VoidMain => "void_main",
            Self::VoidTransformer => "void_transformer",
            Self::ArchMain => "arch_main",
            Self::WallMain => "wall_main",
            Self::BaseMain => "base_main",
            Self::Mass => "mass",
            Self::Pier => "pier",
            Self::Windshield => "windshield",
            Self::FloorGenerator => "floor_generator",
            Self::FloorBusbar => "floor_busbar",
            Self::FloorTurbine => "floor_turbine",
            Self::ArchTransformer => "arch_transformer",
            Self::WallTransformer => "wall_transformer",
            Self::FloorTransformer => "floor_transformer",
        }
    }

    /// Whether the part is of concrete.
    pub fn is_concrete(self) -> bool {
        !matches!(self, Self::Rock | Self::VoidMain | Self::VoidTransformer)
    }

    /// Whether the part is a lining in contact with rock: arch, wall or bottom.
    pub fn is_lining(self) -> bool {
        matches!(
            self,
            Self::ArchMain
                | Self::WallMain
                | Self::BaseMain
                | Self::ArchTransformer
                | Self::WallTransformer
                | Self::FloorTransformer
        )
    }

    /// Whether the part lies within the transformer cavern.
    pub(super) fn is_in_transformer(self) -> bool {
        matches!(
            self,
            Self::VoidTransformer
                | Self::ArchTransformer
                | Self::WallTransformer
                | Self::FloorTransformer
        )
    }

    /// The part of a cell.
    pub(super) fn of(plan: &Plan, [i, j, k]: [usize; 3]) -> Self {
        let (column, row) = (plan.columns[i], plan.rows[k]);
        let Layer::Bay(along) = plan.layers[j] else {
            return Self::Rock;
        };
        match (column, row) {
            (_, Row::Above | Row::Below) | (Column::Rock, _) => Self::Rock,
            (Column::MainWall | Column::MainHall(_), Row::Arch) => Self::ArchMain,
            (Column::MainWall, _) => Self::WallMain,
            (Column::MainHall(across), _) => Self::of_hall(across.max(along), row),
            (Column::TransformerWall | Column::TransformerHall, row) => {
                Self::of_transformer(column, row)
            }
        }
    }

    fn of_hall(ring: Ring, row: Row) -> Self {
        match (row, ring) {
            (Row::GeneratorFloor, Ring::Beyond) => Self::FloorGenerator,
            (Row::GeneratorFloor | Row::GeneratorStorey, Ring::Windshield) => Self::Windshield,
            (Row::BusbarFloor, Ring::Beyond) => Self::FloorBusbar,
            (Row::BusbarFloor | Row::TurbineStorey, Ring::Pier | Ring::Windshield) => Self::Pier,
            (Row::TurbineFloor, Ring::Pier | Ring::Windshield | Ring::Beyond) => Self::FloorTurbine,
            (Row::Mass, Ring::Pier | Ring::Windshield | Ring::Beyond) => Self::Mass,
            (Row::Base, _) => Self::BaseMain,
            _ => Self::VoidMain,
        }
    }

    fn of_transformer(column: Column, row: Row) -> Self {
        match (row, column) {
            (Row::Arch, _) => Self::ArchTransformer,
            (Row::Base | Row::Mass | Row::TurbineFloor | Row::TurbineStorey, _) => Self::Rock,
            (_, Column::TransformerWall) => Self::WallTransformer,
            (Row::BusbarFloor, _) => Self::FloorTransformer,
            _ => Self::VoidTransformer,
        }
    }
}
