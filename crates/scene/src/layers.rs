//! Layered ground: its waves, and the check of the body along the absorbing faces against its layers.

use powerhouse_model::{ElasticMedium, Facet, IncidentField, Vec3};
use powerhouse_wavefield::{LayerDamping, LayerMechanism};
use thiserror::Error;

use crate::surroundings::SIDE_TOLERANCE;
use crate::{Error, Scene};
use powerhouse_laws::Damping;

/// Why a body does not fit the layers of its free field.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LayerError {
    /// Element at an absorbing face whose medium is not that of the layer in which it lies.
    #[error(
        "face '{face}', {depth:.4} m deep: the part '{set}' has {found}, the layer of the ground there {expected}; give the layer the material of the part or move its `bottom`, or, where a structure runs through the face, name its part in `through` of the boundary, or leave the face out and put rollers there"
    )]
    OtherMedium {
        /// Absorbing face.
        face: String,
        /// Depth of the element's centroid below the free surface (m).
        depth: f64,
        /// Element set of the part.
        set: String,
        /// Medium of the part, in words.
        found: String,
        /// Medium of the layer, in words.
        expected: String,
    },
    /// Interface of layers between the nodes of a facet of an absorbing face.
    #[error(
        "face '{face}': the interface of layers at z = {interface} m ({depth:.4} m deep) passes between the nodes of element {element}, from z = {low} to {high} m; an interface must lie on planes of the mesh"
    )]
    OffPlane {
        /// Absorbing face.
        face: String,
        /// Height z of the interface (m).
        interface: f64,
        /// Its depth below the free surface (m).
        depth: f64,
        /// Number of the element in the mesh file.
        element: u64,
        /// Lowest z of the facet (m).
        low: f64,
        /// Highest z of the facet (m).
        high: f64,
    },
    /// Interface in a scene file that lies farther from any plane of the mesh than a thousandth of its layer.
    #[error(
        "the interface at z = {interface} m lies {off:.4e} m from the next nodes of the absorbing faces or, where it crosses none, of the mesh, at z = {nearest} m, more than a thousandth of the layer's {thickness:.4} m; give it the height of a plane of the mesh, or mesh the layer"
    )]
    NoPlane {
        /// Height z of the interface (m).
        interface: f64,
        /// Height z of the nearest node (m).
        nearest: f64,
        /// Distance from it (m).
        off: f64,
        /// Thickness of the thinner of both layers (m).
        thickness: f64,
    },
}

/// Medium in words.
fn medium_in_words(medium: &ElasticMedium) -> String {
    format!(
        "{} kg/m3, S {:.5} m/s, P {:.5} m/s",
        medium.density,
        medium.s_speed(),
        medium.p_speed()
    )
}

/// Damping of a layer that is that of a part; none for damping that layers cannot have.
pub fn damping_of_layer(damping: &Damping) -> Option<LayerDamping> {
    match damping {
        Damping::None => Some(LayerDamping::None),
        Damping::Flat {
            spectrum,
            reference,
        } => {
            let mechanisms = spectrum.mechanisms().iter();
            let mechanisms = mechanisms.map(|mechanism| LayerMechanism {
                frequency: mechanism.frequency,
                weight: mechanism.weight,
            });
            Some(LayerDamping::Flat {
                mechanisms: mechanisms.collect(),
                velocity: reference.velocity(spectrum).ok()?,
            })
        }
        _ => None,
    }
}

impl Scene {
    /// Rejects elements along the absorbing faces of another medium than that of their layer, and interfaces off the
    /// planes of the mesh.
    pub(super) fn check_layers(
        &self,
        field: &dyn IncidentField,
        faces: &[(&str, &[Facet])],
    ) -> Result<(), Error> {
        let interfaces = field.interfaces();
        if interfaces.is_empty() {
            return Ok(());
        }
        let (low, high) = self.mesh.bounding_box();
        let rounding = SIDE_TOLERANCE * (high - low).norm();
        let surface = self.layered_waves().first();
        let surface = surface.map_or(high.z, |wave| wave.parameters().ground.surface());
        let owner = self.part_of_elements()?;
        for (face, facets) in faces {
            for facet in *facets {
                if owner[facet.element as usize].is_some_and(|part| self.runs_through(part)) {
                    continue;
                }
                let nodes = self.mesh.facet_nodes(*facet);
                let heights = nodes
                    .iter()
                    .map(|&node| self.mesh.positions()[node as usize].z);
                let [low, high] = heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], z| {
                    [a.min(z), b.max(z)]
                });
                let passes = |z: &&f64| **z > low + rounding && **z < high - rounding;
                if let Some(interface) = interfaces.iter().find(passes) {
                    return Err(LayerError::OffPlane {
                        face: (*face).into(),
                        interface: *interface,
                        depth: surface - interface,
                        element: self.mesh.element_tags()[facet.element as usize],
                        low,
                        high,
                    }
                    .into());
                }
                let Some(part) = owner[facet.element as usize] else {
                    continue;
                };
                let centroid = self.mesh.centroid(facet.element);
                let medium = self.parts[part].material.medium();
                let expected = field.medium_at(&centroid);
                if !is_like(&medium, &expected) {
                    return Err(LayerError::OtherMedium {
                        face: (*face).into(),
                        depth: surface - centroid.z,
                        set: self.parts[part].set.clone(),
                        found: medium_in_words(&medium),
                        expected: medium_in_words(&expected),
                    }
                    .into());
                }
            }
        }
        Ok(())
    }

    /// Whether a layer of the ground in which the waves travel is damped.
    pub fn has_damped_layers(&self) -> bool {
        let grounds = self
            .layered_waves()
            .iter()
            .map(|wave| &wave.parameters().ground);
        let mut layers = grounds.flat_map(|ground| ground.layers());
        layers.any(|layer| layer.damping != LayerDamping::None)
    }

    /// Whether the layers in which the elements of a part touch the absorbing faces have the damping of the part.
    pub fn is_damped_like_field(
        &self,
        part: usize,
        faces: &[(&str, &[Facet])],
    ) -> Result<bool, Error> {
        let (Some(wave), Some(damping)) = (
            self.layered_waves().first(),
            damping_of_layer(&self.parts[part].damping),
        ) else {
            return Ok(false);
        };
        let ground = &wave.parameters().ground;
        let owner = self.part_of_elements()?;
        let of_layer = |point: Vec3| {
            let mut layers = ground.layers().iter();
            let layer = layers.find(|layer| layer.bottom < point.z);
            layer.map_or(LayerDamping::None, |layer| layer.damping.clone())
        };
        let facets = faces.iter().flat_map(|(_, facets)| facets.iter());
        let mut own = facets.filter(|facet| owner[facet.element as usize] == Some(part));
        Ok(own.all(|facet| of_layer(self.mesh.centroid(facet.element)) == damping))
    }
}

/// Whether density and wave speeds of two media agree to 1e-6.
pub(super) fn is_like(a: &ElasticMedium, b: &ElasticMedium) -> bool {
    let of = |m: &ElasticMedium| [m.density, m.p_speed(), m.s_speed()];
    let mut pairs = of(a).into_iter().zip(of(b));
    pairs.all(|(a, b)| (a - b).abs() <= 1e-6 * b)
}
