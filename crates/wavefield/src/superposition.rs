//! Superposition of several fields.

use powerhouse_model::{ElasticMedium, FieldMotion, FieldSampler, IncidentField, ModelError, Vec3};

use crate::WaveError;

/// Sum of several fields in one medium, such as a horizontal and a vertical record, each with
/// its angle and arrival.
pub struct Superposition {
    fields: Vec<Box<dyn IncidentField>>,
    name: String,
}

impl Superposition {
    /// Sum of the given fields.
    ///
    /// # Errors
    /// If there are none, or their media differ.
    pub fn new(fields: Vec<Box<dyn IncidentField>>) -> Result<Self, WaveError> {
        let first = fields.first().ok_or(WaveError::NoFields)?;
        let differs = |field: &dyn IncidentField| {
            let media = |of: &dyn IncidentField| -> Vec<ElasticMedium> {
                let below = |height: &f64| of.medium_at(&Vec3::new(0.0, 0.0, *height));
                let uppermost = of.medium_at(&Vec3::new(0.0, 0.0, f64::MAX));
                let layers = of.interfaces().iter().map(below);
                layers.chain([uppermost, of.medium()]).collect()
            };
            field.interfaces() != first.interfaces() || media(field) != media(&**first)
        };
        if let Some(index) = fields.iter().position(|field| differs(&**field)) {
            return Err(WaveError::MediaDiffer { index });
        }
        let names: Vec<&str> = fields.iter().map(|field| field.name()).collect();
        Ok(Self {
            name: names.join(" + "),
            fields,
        })
    }
}

impl IncidentField for Superposition {
    fn name(&self) -> &str {
        &self.name
    }

    fn medium(&self) -> ElasticMedium {
        self.fields[0].medium()
    }

    fn interfaces(&self) -> &[f64] {
        self.fields[0].interfaces()
    }

    fn medium_at(&self, point: &Vec3) -> ElasticMedium {
        self.fields[0].medium_at(point)
    }

    fn carries_stress(&self) -> bool {
        self.fields.iter().all(|field| field.carries_stress())
    }

    /// Those of the first field that has stations: a point without one is refused by that field.
    fn stations(&self) -> Option<&[Vec3]> {
        self.fields.iter().find_map(|field| field.stations())
    }

    fn check_layer(&self, nodes: &[Vec3], inner: &[bool]) -> Result<(), ModelError> {
        let mut fields = self.fields.iter();
        fields.try_for_each(|field| field.check_layer(nodes, inner))
    }

    /// Sum of the incident parts, if every field has one.
    fn incident_part(&self) -> Option<Box<dyn IncidentField>> {
        let parts = self.fields.iter().map(|field| field.incident_part());
        let sum = Self {
            fields: parts.collect::<Option<Vec<_>>>()?,
            name: format!("incident part of {}", self.name),
        };
        Some(Box::new(sum))
    }

    fn prepare(&self, points: &[Vec3]) -> Result<Box<dyn FieldSampler>, ModelError> {
        let samplers = self.fields.iter().map(|field| field.prepare(points));
        Ok(Box::new(SumSampler {
            samplers: samplers.collect::<Result<_, _>>()?,
            points: points.len(),
        }))
    }

    fn prepare_in(
        &self,
        points: &[Vec3],
        media: &[ElasticMedium],
    ) -> Result<Box<dyn FieldSampler>, ModelError> {
        let samplers = self.fields.iter();
        let samplers = samplers.map(|field| field.prepare_in(points, media));
        Ok(Box::new(SumSampler {
            samplers: samplers.collect::<Result<_, _>>()?,
            points: points.len(),
        }))
    }
}

struct SumSampler {
    samplers: Vec<Box<dyn FieldSampler>>,
    points: usize,
}

impl FieldSampler for SumSampler {
    fn len(&self) -> usize {
        self.points
    }

    fn add_motion(&self, time: f64, motion: &mut [FieldMotion]) {
        for sampler in &self.samplers {
            sampler.add_motion(time, motion);
        }
    }
}
