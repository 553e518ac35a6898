//! Constitutive laws of rock and concrete; each runs without a mesh.
