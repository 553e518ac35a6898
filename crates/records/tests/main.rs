//! Reading of accelerograms.

mod agencies;
mod formats;
mod layouts;
mod text;
