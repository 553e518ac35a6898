//! The thin facade: re-exports, and the Scene that composes a model from names.
