//! Reading and writing of files.

#[cfg(feature = "records")]
mod agencies;
#[cfg(all(feature = "pictures", feature = "plots"))]
mod drawings;
#[cfg(feature = "gmsh")]
mod gmsh;
#[cfg(feature = "h5drm")]
mod h5drm;
#[cfg(all(feature = "gmsh", feature = "inp"))]
mod inp;
#[cfg(feature = "packed")]
mod packed;
#[cfg(feature = "records")]
mod records;
#[cfg(feature = "records")]
mod records_layouts;
#[cfg(feature = "records")]
mod records_text;
mod stations;
#[cfg(feature = "vtkhdf")]
mod vtkhdf;
#[cfg(feature = "vtu")]
mod vtu;
#[cfg(feature = "vtu")]
mod vtu_read;
