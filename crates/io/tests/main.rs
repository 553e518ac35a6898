//! Reading and writing of files.

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
mod stations;
#[cfg(feature = "vtkhdf")]
mod vtkhdf;
#[cfg(feature = "vtu")]
mod vtu;
#[cfg(feature = "vtu")]
mod vtu_read;
