//! What observers read of the body.

/// Choice of nodes or elements (mesh indices).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Selection {
    /// All of them.
    #[default]
    All,
    /// Some of them, in any order.
    These(Vec<u32>),
}

impl Selection {
    /// None of them.
    pub const NONE: Self = Self::These(Vec::new());
}

/// Part of the body that an observer reads. An engine on several ranks gathers no more than that; what an observer reads
/// beyond it ends the run with an error.
///
/// By default an observer reads the motion of all nodes, the stresses of all elements if its [fields](crate::Observer::fields)
/// have stresses, and the state of joints and embedded elements, but no history variables and no element forces.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Reach {
    /// Nodes whose motion is read.
    pub nodes: Selection,
    /// Elements of which stresses, history variables and forces are read.
    pub elements: Selection,
    /// Names of the history variables of laws that are read.
    pub variables: Vec<String>,
    /// Whether element forces are read.
    pub element_forces: bool,
    /// Whether history variables of embedded elements are read.
    pub embedded: bool,
    /// Whether the state of joints is read.
    pub joints: bool,
}

impl Default for Reach {
    fn default() -> Self {
        Self {
            nodes: Selection::All,
            elements: Selection::All,
            variables: Vec::new(),
            element_forces: false,
            embedded: true,
            joints: true,
        }
    }
}

impl Reach {
    /// Nothing but energies.
    pub const NONE: Self = Self {
        nodes: Selection::NONE,
        elements: Selection::NONE,
        variables: Vec::new(),
        element_forces: false,
        embedded: false,
        joints: false,
    };
    /// Whether nothing but the motion of nodes is read, beside energies.
    pub fn is_motion_alone(&self) -> bool {
        let others = self.element_forces || self.embedded || self.joints;
        self.elements == Selection::NONE && self.variables.is_empty() && !others
    }
    /// The same with the motion of some nodes.
    #[must_use]
    pub fn with_nodes(self, nodes: Selection) -> Self {
        Self { nodes, ..self }
    }
    /// The same with stresses, history variables and forces of some elements.
    #[must_use]
    pub fn with_elements(self, elements: Selection) -> Self {
        Self { elements, ..self }
    }
    /// The same with history variables of laws, by name.
    #[must_use]
    pub fn with_variables<N: Into<String>>(self, names: impl IntoIterator<Item = N>) -> Self {
        let variables = names.into_iter().map(Into::into).collect();
        Self { variables, ..self }
    }
    /// The same with element forces.
    #[must_use]
    pub fn with_element_forces(self) -> Self {
        Self {
            element_forces: true,
            ..self
        }
    }
    /// The same with history variables of embedded elements.
    #[must_use]
    pub fn with_embedded(self) -> Self {
        Self {
            embedded: true,
            ..self
        }
    }
    /// The same with the state of joints.
    #[must_use]
    pub fn with_joints(self) -> Self {
        Self {
            joints: true,
            ..self
        }
    }
}
