//! Parts and media of elements and of absorbing faces.

use powerhouse_model::{ElasticMedium, Facet, Mesh, MeshError, Vec3};

use crate::{Error, Scene};

impl Scene {
    /// Index of the part of each element; bars may belong to none and are then left
    /// out of the model.
    ///
    /// # Errors
    /// Set that does not exist; solid without part, or element of several parts.
    pub fn part_of_elements(&self) -> Result<Vec<Option<usize>>, Error> {
        let mut owner = vec![None; self.mesh.element_count()];
        let counted = |element: u32, count: usize| {
            let parts = self.parts.iter().map(|part| part.set.as_str());
            Error::PartCount {
                element: self.mesh.element_tags()[element as usize],
                count,
                sets: sets_with(&self.mesh, element, parts, count),
            }
        };
        for (index, part) in self.parts.iter().enumerate() {
            for &element in self.mesh.element_set(&part.set)? {
                if owner[element as usize].replace(index).is_some() {
                    return Err(counted(element, 2));
                }
            }
        }
        let mut elements = 0..owner.len() as u32;
        let forgotten = |&e: &u32| owner[e as usize].is_none() && self.mesh.kind(e).is_solid();
        match elements.find(forgotten) {
            Some(element) => Err(counted(element, 0)),
            None => Ok(owner),
        }
    }

    /// Elastic media of the elements.
    ///
    /// # Errors
    /// As [`part_of_elements`](Self::part_of_elements).
    pub(super) fn medium_of_elements(&self) -> Result<impl Fn(u32) -> ElasticMedium, Error> {
        let owner = self.part_of_elements()?;
        Ok(move |element: u32| {
            let part = owner[element as usize];
            let part = part.expect("facets belong to solids, and every solid to a part");
            self.parts[part].material.medium()
        })
    }

    /// Names and facets of the absorbing faces.
    ///
    /// # Errors
    /// A set that does not exist.
    pub fn absorbing_facets(&self) -> Result<Vec<(&str, &[Facet])>, MeshError> {
        let faces = self.boundary.iter().flat_map(|boundary| &boundary.faces);
        faces
            .map(|face| Ok((face.as_str(), self.mesh.facet_set(face)?)))
            .collect()
    }

    /// Indices of the parts of the ground along the absorbing faces, in the order of the parts: without those of a structure that
    /// runs [through](crate::Boundary::through) them.
    ///
    /// # Errors
    /// As [`part_of_elements`](Self::part_of_elements) and [`absorbing_facets`](Self::absorbing_facets).
    pub fn parts_behind_boundary(&self) -> Result<Vec<usize>, Error> {
        let mut behind = self.parts_at_faces()?;
        behind.retain(|&part| !self.runs_through(part));
        Ok(behind)
    }

    /// Whether a part (index) belongs to a structure that may run through absorbing faces.
    pub(super) fn runs_through(&self, part: usize) -> bool {
        let boundary = self.boundary.as_ref();
        boundary.is_some_and(|boundary| boundary.through.contains(&self.parts[part].set))
    }

    /// Indices of all parts along the absorbing faces, in the order of the parts.
    pub fn parts_at_faces(&self) -> Result<Vec<usize>, Error> {
        let owner = self.part_of_elements()?;
        let facets = self.absorbing_facets()?;
        let behind = facets.iter().flat_map(|(_, facets)| facets.iter());
        let mut behind: Vec<usize> = behind
            .filter_map(|facet| owner[facet.element as usize])
            .collect();
        behind.sort_unstable();
        behind.dedup();
        Ok(behind)
    }

    /// Different media behind the absorbing faces; a free field needs a single one.
    ///
    /// # Errors
    /// As [`parts_behind_boundary`](Self::parts_behind_boundary).
    pub fn media_behind_boundary(&self) -> Result<Vec<ElasticMedium>, Error> {
        let mut media: Vec<ElasticMedium> = Vec::new();
        for part in self.parts_behind_boundary()? {
            let medium = self.parts[part].material.medium();
            if !media.contains(&medium) {
                media.push(medium);
            }
        }
        Ok(media)
    }

    /// Text that names the parts behind the absorbing faces with the faces before each, medium by medium: as in
    /// `'rock' (left, right), 'soil' (left)`.
    ///
    /// # Errors
    /// As [`parts_behind_boundary`](Self::parts_behind_boundary).
    pub fn media_at_faces(&self) -> Result<String, Error> {
        let owner = self.part_of_elements()?;
        let faces = self.absorbing_facets()?;
        let mut told = Vec::new();
        for medium in self.media_behind_boundary()? {
            let is_of = |part: &usize| self.parts[*part].material.medium() == medium;
            let behind = self.parts_behind_boundary()?.into_iter().filter(is_of);
            let behind: Vec<usize> = behind.collect();
            let names = behind
                .iter()
                .map(|&part| format!("'{}'", self.parts[part].set));
            let borders = |facets: &[Facet]| {
                let mut parts = facets.iter().map(|facet| owner[facet.element as usize]);
                parts.any(|part| part.is_some_and(|part| behind.contains(&part)))
            };
            let before = faces.iter().filter(|(_, facets)| borders(facets));
            let before: Vec<&str> = before.map(|(face, _)| *face).collect();
            let names: Vec<String> = names.collect();
            told.push(format!("{} ({})", names.join(" and "), before.join(", ")));
        }
        Ok(told.join(", "))
    }

    /// Centre of the scatterer (m), from which springs take their distance: as given, or the middle of the box around the parts that
    /// touch no absorbing face, or around the mesh if all do.
    ///
    /// # Errors
    /// As [`parts_behind_boundary`](Self::parts_behind_boundary).
    pub fn scatterer(&self) -> Result<Vec3, Error> {
        if let Some(centre) = self
            .boundary
            .as_ref()
            .and_then(|boundary| boundary.scatterer)
        {
            return Ok(centre);
        }
        let [low, high] = match self.structure()? {
            Some(structure) => structure,
            None => self.mesh.bounding_box().into(),
        };
        Ok((low + high) / 2.0)
    }

    /// Box (lower and upper corner, m) of the parts that touch no absorbing face; none if all do.
    pub(crate) fn structure(&self) -> Result<Option<[Vec3; 2]>, Error> {
        let behind = self.parts_behind_boundary()?;
        let inner = self
            .parts
            .iter()
            .enumerate()
            .filter(|(i, _)| !behind.contains(i));
        let mut elements = Vec::new();
        for (_, part) in inner {
            elements.extend_from_slice(self.mesh.element_set(&part.set)?);
        }
        let nodes = self.mesh.nodes_of_elements(&elements);
        let positions = nodes
            .iter()
            .map(|&node| self.mesh.positions()[node as usize]);
        let infinite = Vec3::repeat(f64::INFINITY);
        let [low, high] = positions.fold([infinite, -infinite], |[low, high], x| {
            [low.inf(&x), high.sup(&x)]
        });
        Ok((!nodes.is_empty()).then_some([low, high]))
    }
}

/// Element sets with an element: those of parts if it belongs to several of them, otherwise all of the mesh.
pub fn sets_with<'s>(
    mesh: &Mesh,
    element: u32,
    parts: impl Iterator<Item = &'s str>,
    count: usize,
) -> Vec<String> {
    let has = |set: &str| {
        let elements = mesh.element_set(set);
        elements.is_ok_and(|elements| elements.contains(&element))
    };
    match count {
        0 => {
            let sets = mesh.element_sets().keys().cloned();
            sets.filter(|set| has(set)).collect()
        }
        _ => parts.filter(|set| has(set)).map(str::to_owned).collect(),
    }
}
