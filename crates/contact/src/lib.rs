//! Pairs of nodes across a joint.
