//! Time histories and the free field.

mod azimuth;
mod convention;
mod design_spectra;
mod half_space;
mod history;
mod layered;
mod layered_tables;
mod many_heights;
mod past_critical;
mod pulses;
mod reflection;
mod spectra;
mod split;
mod support;
mod within_layers;
