//! What stands where the mesh ends: viscous and viscous-spring boundaries with free-field input.
