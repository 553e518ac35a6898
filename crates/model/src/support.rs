//! Supports (fixed and roller) and prescribed motion.

use crate::{EngineError, TimeFunction, Vec3};

/// Directions in which a support fixes its nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Fixity {
    All,
    Direction(Vec3),
}

/// A support: nodes whose displacement is fixed in all directions or along one.
///
/// The displacement keeps the value that it has at the start of the run. Several supports on a node combine:
/// two rollers with different normals leave it one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    nodes: Vec<u32>,
    fixity: Fixity,
}

impl Support {
    /// A support of nodes (mesh indices) that are fixed in all directions.
    pub fn fixed(nodes: Vec<u32>) -> Self {
        Self {
            nodes,
            fixity: Fixity::All,
        }
    }
    /// A roller support: nodes (mesh indices) fixed along `normal`, which may be oblique and of any
    /// length, and free across it.
    pub fn roller(nodes: Vec<u32>, normal: Vec3) -> Self {
        Self {
            nodes,
            fixity: Fixity::Direction(normal),
        }
    }
    /// The same support of other nodes (mesh indices).
    #[must_use]
    pub fn on(&self, nodes: Vec<u32>) -> Self {
        Self {
            nodes,
            fixity: self.fixity,
        }
    }
    /// The supported nodes (mesh indices).
    pub fn nodes(&self) -> &[u32] {
        &self.nodes
    }
    /// The direction along which the nodes are fixed, of any length; none if they are fixed in all directions.
    pub fn held_direction(&self) -> Option<Vec3> {
        match self.fixity {
            Fixity::All => None,
            Fixity::Direction(normal) => Some(normal),
        }
    }
    /// Unit vectors of the fixed directions.
    ///
    /// # Errors
    /// [`EngineError::NoDirection`] for a roller along a vector without length.
    pub fn directions(&self) -> Result<Vec<Vec3>, EngineError> {
        match self.fixity {
            Fixity::All => Ok(vec![Vec3::x(), Vec3::y(), Vec3::z()]),
            Fixity::Direction(normal) => {
                Ok(vec![EngineError::check_direction("a roller", normal)?])
            }
        }
    }
}

/// Prescribed motion: nodes whose displacement along one direction is a function of time.
pub struct Prescribed {
    /// Mesh indices of the nodes.
    pub nodes: Vec<u32>,
    /// Direction of the prescribed displacement; of any length but zero.
    pub direction: Vec3,
    /// Displacement along the direction (m) as a function of time (s). It should start from the
    /// initial displacement of the nodes: a jump acts as an impact.
    pub displacement: Box<dyn TimeFunction>,
}

impl core::fmt::Debug for Prescribed {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Prescribed")
            .field("nodes", &self.nodes.len())
            .field("direction", &self.direction)
            .finish_non_exhaustive()
    }
}
