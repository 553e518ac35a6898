//! Dimensions of a machine bay and of the rock around it.

use powerhouse::model::ParameterError;
use serde::Deserialize;

use crate::BayError;

/// Dimensions (m) of a machine bay and of the rock around it.
///
/// z = 0 is the free surface, x = 0 the axis of the machines, the transformer cavern lies on the side
/// of positive x, y runs along the halls. Widths and heights are those of the excavation. The crowns
/// of both caverns are at one height, and so are the busbar floor and the floor of the transformer
/// cavern.
///
/// The defaults are those of Wang, Chen & Xiao (2019), section 4, where the paper gives them (bay,
/// widths, heights, cover, thickness of arches and walls, the range of the floors), and assumptions
/// where it does not.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct BayDimensions {
    /// Length of the bay along the halls (m), 11.5 to 20.
    pub length: f64,
    /// Width of the excavation of the main powerhouse (m), 18 to 26.
    pub main_width: f64,
    /// Height of the excavation of the main powerhouse (m), 36 to 46.
    pub main_height: f64,
    /// Width of the excavation of the transformer cavern (m), 14 to 20.
    pub transformer_width: f64,
    /// Height of the excavation of the transformer cavern (m), 24 to 29.
    pub transformer_height: f64,
    /// Ratio of rise to span of the roof arches (1), 1/5 to 1/3.
    pub rise: f64,
    /// Thickness of the rock above the crowns (m), 60 to 300.
    pub cover: f64,
    /// Width of the rock pillar between the caverns (m), 20 to 50.
    pub pillar: f64,
    /// Width of the rock beside the outermost walls (m), 50 to 150.
    pub side: f64,
    /// Thickness of the rock below the main powerhouse (m), 50 to 150.
    pub below: f64,
    /// Thickness of the lining of the arches (m), 0.6 to 1.2.
    pub arch_lining: f64,
    /// Thickness of the lining of the walls (m), 0.6 to 1.2.
    pub wall_lining: f64,
    /// Thickness of the generator floor (m), 0.5 to 1.
    pub generator_floor: f64,
    /// Thickness of the busbar floor and of the floor of the transformer cavern (m), 0.5 to 1.
    pub busbar_floor: f64,
    /// Thickness of the turbine floor (m), 0.5 to 1.
    pub turbine_floor: f64,
    /// Thickness of the base slab (m), 0.5 to 1.5.
    pub base_slab: f64,
    /// Height from the top of the busbar floor to the top of the generator floor (m), 4 to 7.
    pub generator_storey: f64,
    /// Height from the top of the turbine floor to the top of the busbar floor (m), 3.5 to 6.
    pub turbine_storey: f64,
    /// Radius of the octagonal pit within the pier, to its corners (m), 2 to 3.4.
    pub pit_radius: f64,
    /// Outer radius of the octagonal pier and windshield, to their corners (m), 4.2 to 5.2.
    pub ring_radius: f64,
    /// Thickness of the windshield (m), 0.4 to 0.6.
    pub windshield: f64,
}

impl Default for BayDimensions {
    fn default() -> Self {
        Self {
            length: 13.7,
            main_width: 21.0,
            main_height: 39.4,
            transformer_width: 17.1,
            transformer_height: 26.9,
            rise: 0.25,
            cover: 150.0,
            pillar: 35.0,
            side: 80.0,
            below: 80.0,
            arch_lining: 1.0,
            wall_lining: 0.8,
            generator_floor: 0.8,
            busbar_floor: 0.8,
            turbine_floor: 1.0,
            base_slab: 1.0,
            generator_storey: 5.5,
            turbine_storey: 4.5,
            pit_radius: 2.8,
            ring_radius: 5.0,
            windshield: 0.5,
        }
    }
}

/// Names and permitted ranges, in the order of [`BayDimensions::values`].
const RANGES: [(&str, f64, f64); 21] = [
    ("length", 11.5, 20.0),
    ("main_width", 18.0, 26.0),
    ("main_height", 36.0, 46.0),
    ("transformer_width", 14.0, 20.0),
    ("transformer_height", 24.0, 29.0),
    ("rise", 0.2, 1.0 / 3.0),
    ("cover", 60.0, 300.0),
    ("pillar", 20.0, 50.0),
    ("side", 50.0, 150.0),
    ("below", 50.0, 150.0),
    ("arch_lining", 0.6, 1.2),
    ("wall_lining", 0.6, 1.2),
    ("generator_floor", 0.5, 1.0),
    ("busbar_floor", 0.5, 1.0),
    ("turbine_floor", 0.5, 1.0),
    ("base_slab", 0.5, 1.5),
    ("generator_storey", 4.0, 7.0),
    ("turbine_storey", 3.5, 6.0),
    ("pit_radius", 2.0, 3.4),
    ("ring_radius", 4.2, 5.2),
    ("windshield", 0.4, 0.6),
];

/// The least height of the mass concrete between turbine floor and base slab (m).
const LEAST_MASS: f64 = 2.0;

impl BayDimensions {
    /// Number of dimensions.
    pub const COUNT: usize = RANGES.len();

    /// Name, least and greatest permitted value (m) of each dimension, in the order of the fields.
    pub fn ranges() -> [(&'static str, f64, f64); Self::COUNT] {
        RANGES
    }

    /// The values (m) of all dimensions, in the order of the fields.
    pub fn values(&self) -> [f64; Self::COUNT] {
        [
            self.length,
            self.main_width,
            self.main_height,
            self.transformer_width,
            self.transformer_height,
            self.rise,
            self.cover,
            self.pillar,
            self.side,
            self.below,
            self.arch_lining,
            self.wall_lining,
            self.generator_floor,
            self.busbar_floor,
            self.turbine_floor,
            self.base_slab,
            self.generator_storey,
            self.turbine_storey,
            self.pit_radius,
            self.ring_radius,
            self.windshield,
        ]
    }

    /// Creates the dimensions from their values (m), in the order of the fields, unchecked.
    pub fn of_values(values: [f64; Self::COUNT]) -> Self {
        let [
            length,
            main_width,
            main_height,
            transformer_width,
            transformer_height,
            rise,
            cover,
            pillar,
            side,
            below,
            arch_lining,
            wall_lining,
            generator_floor,
            busbar_floor,
            turbine_floor,
            base_slab,
            generator_storey,
            turbine_storey,
            pit_radius,
            ring_radius,
            windshield,
        ] = values;
        Self {
            length,
            main_width,
            main_height,
            transformer_width,
            transformer_height,
            rise,
            cover,
            pillar,
            side,
            below,
            arch_lining,
            wall_lining,
            generator_floor,
            busbar_floor,
            turbine_floor,
            base_slab,
            generator_storey,
            turbine_storey,
            pit_radius,
            ring_radius,
            windshield,
        }
    }

    /// Checks that each value is within its range and that the floors lie above each other.
    ///
    /// # Errors
    /// [`BayError::Parameter`] with the name, the value and the permitted range; also for a height of the main
    /// powerhouse that leaves less than 2 m of mass concrete.
    pub fn check(&self) -> Result<(), BayError> {
        for ((name, least, most), value) in RANGES.into_iter().zip(self.values()) {
            ParameterError::check(name, value, least, most)?;
        }
        let under_turbine = self.transformer_height - self.busbar_floor
            + self.turbine_storey
            + self.turbine_floor
            + self.base_slab;
        let least = under_turbine + LEAST_MASS;
        ParameterError::check("main_height", self.main_height, least, RANGES[2].2)?;
        Ok(())
    }

    /// Heights of the horizontal surfaces.
    pub(super) fn levels(&self) -> Levels {
        let crown = -self.cover;
        let floor = |top: f64, thickness: f64| [top, top - thickness];
        let transformer_bottom = crown - self.transformer_height;
        let busbar = transformer_bottom + self.busbar_floor;
        let main_bottom = crown - self.main_height;
        Levels {
            crown,
            generator: floor(busbar + self.generator_storey, self.generator_floor),
            busbar: [busbar, transformer_bottom],
            turbine: floor(busbar - self.turbine_storey, self.turbine_floor),
            base: [main_bottom + self.base_slab, main_bottom],
            model_bottom: main_bottom - self.below,
        }
    }

    /// The x coordinate of the axis of the transformer cavern (m).
    pub(super) fn transformer_axis(&self) -> f64 {
        0.5 * self.main_width + self.pillar + 0.5 * self.transformer_width
    }

    /// Volumes of the two excavations with circular arches (m3): main powerhouse, transformer cavern.
    pub(super) fn excavated_volumes(&self) -> [f64; 2] {
        [
            (self.main_width, self.main_height),
            (self.transformer_width, self.transformer_height),
        ]
        .map(|(width, height)| {
            let rise = self.rise * width;
            let radius = arch_radius(width, rise);
            let angle = (0.5 * width / radius).asin();
            let segment = radius * radius * angle - 0.5 * width * (radius - rise);
            self.length * (width * (height - rise) + segment)
        })
    }
}

/// Radius (m) of the circular arc with a given span and rise (m).
pub(super) fn arch_radius(span: f64, rise: f64) -> f64 {
    (0.25 * span * span + rise * rise) / (2.0 * rise)
}

/// Heights z (m) of the horizontal surfaces; of floors top and bottom.
#[derive(Clone, Copy, Debug)]
pub(super) struct Levels {
    pub(super) crown: f64,
    pub(super) generator: [f64; 2],
    pub(super) busbar: [f64; 2],
    pub(super) turbine: [f64; 2],
    pub(super) base: [f64; 2],
    pub(super) model_bottom: f64,
}
