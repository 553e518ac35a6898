//! What ranks will compute and send.

/// Work and messages of one of several ranks that share a model, before it is built.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RankForecast {
    /// Number of elements.
    pub elements: usize,
    /// Number of nodes, those that it shares with other ranks included.
    pub nodes: usize,
    /// Number of nodes that it shares with other ranks.
    pub shared_nodes: usize,
    /// Number of messages that it sends in a step: one to each rank with which it shares nodes.
    pub messages: usize,
    /// Number of bytes that it sends in a step.
    pub bytes: usize,
    /// Its share of the estimated cost of the elements of all ranks (1).
    pub work: f64,
    /// The part of this share in blocks without shared nodes, which it computes while messages are on their way.
    pub inner_work: f64,
}

impl RankForecast {
    /// Forecast of a rank by the numbers of its elements, nodes and shared nodes.
    pub fn new(elements: usize, nodes: usize, shared_nodes: usize) -> Self {
        Self {
            elements,
            nodes,
            shared_nodes,
            ..Self::default()
        }
    }
    /// Sets its share of the cost of all ranks, and the part of it in blocks without shared nodes.
    #[must_use]
    pub fn with_work(self, work: f64, inner_work: f64) -> Self {
        Self {
            work,
            inner_work,
            ..self
        }
    }
    /// Sets the number of messages and bytes that it sends in a step.
    #[must_use]
    pub fn with_traffic(self, messages: usize, bytes: usize) -> Self {
        Self {
            messages,
            bytes,
            ..self
        }
    }
}
