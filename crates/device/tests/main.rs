//! Steps on a device against those of the host.

mod steps;
