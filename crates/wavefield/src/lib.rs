//! The motion of the site without the structure: time histories and plane waves in a half-space or full space.
