//! Parts of structures that run through absorbing faces.

use powerhouse_model::{ElasticMedium, Facet, FieldSampler, IncidentField, ModelError, Vec3};
use thiserror::Error;

use crate::layers::is_like;
use crate::{Error, Remark, Scene, remark};

/// Why a part cannot run through absorbing faces.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ThroughError {
    /// There is no such part.
    #[error("'{set}' is to run through the absorbing faces, but no part has this element set")]
    NoPart {
        /// Element set.
        set: String,
    },
    /// The part touches no absorbing face.
    #[error("part '{set}' is to run through the absorbing faces, but no element of it touches one")]
    Inside {
        /// Element set of the part.
        set: String,
    },
    /// No ground is left at the faces.
    #[error(
        "all parts at the absorbing faces are to run through them: the ground is what is there without the structure, and has parts of its own"
    )]
    NoGround,
}

/// Name and facets of an absorbing face.
type Face<'f> = (&'f str, Vec<Facet>);

/// Free field whose stress at the facets of a structure is that in the ground at their place, where the field is not defined in the
/// medium of the structure.
pub(super) struct FieldInGround<'a>(pub(super) &'a dyn IncidentField);

/// Distance from an interface (m), over the height, within which a point lies on it: rounding of mesh files.
const NEAR_INTERFACE: f64 = 1e-6;

impl FieldInGround<'_> {
    /// Medium of the ground at a point: the given one, if the ground has it on either side of the point, else that below.
    fn of_ground(&self, point: &Vec3, medium: &ElasticMedium) -> ElasticMedium {
        let near = Vec3::z() * (NEAR_INTERFACE * point.z.abs().max(1.0));
        let sides = [point + near, point - near].map(|point| self.0.medium_at(&point));
        if sides.iter().any(|side| is_like(medium, side)) {
            *medium
        } else {
            sides[1]
        }
    }
}

impl IncidentField for FieldInGround<'_> {
    fn name(&self) -> &str {
        self.0.name()
    }
    fn medium(&self) -> ElasticMedium {
        self.0.medium()
    }
    fn interfaces(&self) -> &[f64] {
        self.0.interfaces()
    }
    fn medium_at(&self, point: &Vec3) -> ElasticMedium {
        self.0.medium_at(point)
    }
    fn carries_stress(&self) -> bool {
        self.0.carries_stress()
    }
    fn stations(&self) -> Option<&[Vec3]> {
        self.0.stations()
    }
    fn check_layer(&self, nodes: &[Vec3], inner: &[bool]) -> Result<(), ModelError> {
        self.0.check_layer(nodes, inner)
    }
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        self.0.incident_part()
    }
    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        self.0.prepare(points)
    }
    fn prepare_in(
        &self,
        points: &[Vec3],
        media: &[ElasticMedium],
    ) -> Result<Box<dyn FieldSampler>, ModelError> {
        let of_points = points.iter().zip(media);
        let media = of_points.map(|(point, medium)| self.of_ground(point, medium));
        self.0.prepare_in(points, &media.collect::<Vec<_>>())
    }
}

impl Scene {
    /// Rejects names that are no part of a structure at the absorbing faces.
    pub fn check_through(&self) -> Result<(), Error> {
        let Some(boundary) = &self.boundary else {
            return Ok(());
        };
        let at_faces = self.parts_at_faces()?;
        for set in &boundary.through {
            let set = set.clone();
            match self.parts.iter().position(|part| part.set == set) {
                None => return Err(ThroughError::NoPart { set }.into()),
                Some(part) if !at_faces.contains(&part) => {
                    return Err(ThroughError::Inside { set }.into());
                }
                Some(_) => {}
            }
        }
        if !at_faces.is_empty() && at_faces.iter().all(|&part| self.runs_through(part)) {
            Err(ThroughError::NoGround.into())
        } else {
            Ok(())
        }
    }

    /// Facets of the absorbing faces without those of structures that run through them; none if there are no such structures.
    pub(super) fn without_structures<'f>(
        &self,
        faces: &[(&'f str, &[Facet])],
    ) -> Result<Option<Vec<Face<'f>>>, Error> {
        let boundary = self.boundary.as_ref();
        if boundary.is_none_or(|boundary| boundary.through.is_empty()) {
            return Ok(None);
        }
        let owner = self.part_of_elements()?;
        let is_ground = |facet: &&Facet| {
            let part = owner[facet.element as usize];
            part.is_none_or(|part| !self.runs_through(part))
        };
        let faces = faces.iter();
        let faces = faces.map(|(face, facets)| (*face, facets.iter().filter(is_ground)));
        Ok(Some(
            faces
                .map(|(face, facets)| (face, facets.copied().collect()))
                .collect(),
        ))
    }

    /// Remarks about the parts that run through absorbing faces, in the ground of a field.
    pub(super) fn structures_through(
        &self,
        faces: &[(&str, &[Facet])],
        field: Option<&dyn IncidentField>,
    ) -> Result<Vec<Remark>, Error> {
        let mut remarks = Vec::new();
        let owner = self.part_of_elements()?;
        let through = self.parts_at_faces()?.into_iter();
        for index in through.filter(|&index| self.runs_through(index)) {
            let medium = self.parts[index].material.medium();
            let impedance = |medium: &ElasticMedium| medium.density * medium.s_speed();
            let (mut own, mut all, mut touched) = (0.0, 0.0, Vec::new());
            let (mut width, mut contrast) = (0.0_f64, 1.0_f64);
            for (face, facets) in faces {
                let is_own = |facet: &&Facet| owner[facet.element as usize] == Some(index);
                let through: Vec<Facet> = facets.iter().filter(is_own).copied().collect();
                if through.is_empty() {
                    continue;
                }
                touched.push((*face).to_owned());
                width = width.max(self.extent_of(&self.mesh.nodes_of_facets(&through)));
                all += facets
                    .iter()
                    .map(|f| self.mesh.facet_geometry(*f).area())
                    .sum::<f64>();
                for facet in through {
                    let geometry = self.mesh.facet_geometry(facet);
                    own += geometry.area();
                    let ground = field.map(|field| field.medium_at(&geometry.centroid));
                    let ratio = ground.map_or(1.0, |g| impedance(&medium) / impedance(&g));
                    if ratio.ln().abs() > contrast.ln().abs() {
                        contrast = ratio;
                    }
                }
            }
            remarks.push(Remark::from(remark::Through {
                set: self.parts[index].set.clone(),
                faces: touched,
                share: own / all,
                contrast,
                width,
            }));
        }
        Ok(remarks)
    }

    /// Greatest extent (m) of some nodes along an axis.
    fn extent_of(&self, nodes: &[u32]) -> f64 {
        let positions = nodes
            .iter()
            .map(|&node| self.mesh.positions()[node as usize]);
        let infinite = Vec3::repeat(f64::INFINITY);
        let (low, high) = positions.fold((infinite, -infinite), |(low, high), x| {
            (low.inf(&x), high.sup(&x))
        });
        (high - low).max()
    }
}
