//! Result files of construction stages.

use std::path::{Path, PathBuf};

use powerhouse_io::{FieldPrecision, IoError, VtuField, VtuNumbers, VtuWriter, write_table};
use powerhouse_model::{
    EFFECTIVE_STRESS, HistoryVariable, Mesh, PORE_PRESSURE, State, Stress, effective_stress,
};

use crate::joints::{JointFacets, scalars};
use crate::vtu::{numbers, unit};
use powerhouse_contact::JointSurface;
use powerhouse_scene::{BoltForces, CompletedStage, Error, StageSink, file_name};

/// Writer of stage results: `NUMBER-NAME.vtu` with displacement, total stress, history variables of laws, pressure of water in pores
/// and effective stress, and active elements, a file for the facets of each joint, and a table for each bolt group.
pub(crate) struct StageFiles {
    folder: PathBuf,
    writer: VtuWriter,
    joints: Vec<(String, JointSurface)>,
}

impl StageFiles {
    pub(crate) fn new(
        folder: PathBuf,
        mesh: &Mesh,
        joints: &[(String, JointSurface)],
    ) -> Result<Self, IoError> {
        let writer = VtuWriter::new(mesh, FieldPrecision::Single);
        Ok(Self {
            joints: joints.to_vec(),
            writer: writer.map_err(|source| IoError::File {
                file: folder.clone(),
                source,
            })?,
            folder,
        })
    }

    fn write(&mut self, stage: &CompletedStage) -> Result<(), IoError> {
        let mut present = vec![true; stage.mesh.element_count()];
        for &element in &stage.state.absent {
            present[element as usize] = false;
        }
        self.writer.set_present(stage.mesh, &present);
        let name = format!("{}-{}", stage.index + 1, file_name(&stage.report.name));
        let file = |end: &str| self.folder.join(format!("{name}{end}"));
        self.body(&file(".vtu"), stage)?;
        for (joint, surface) in &self.joints {
            let of_name = stage.state.joints.iter().find(|state| state.name == *joint);
            let end = file(&format!("-{}.vtu", file_name(joint)));
            let facets = JointFacets::new(&end, stage.mesh, surface, Some(&present))?;
            if let (Some(state), Some(facets)) = (of_name, facets) {
                let fields = facets.fields_of_stage(&surface.pairs, state);
                let time = (stage.index + 1) as f64;
                facets.writer.write(&end, time, &scalars(&fields), &[])?;
            }
        }
        for bolts in &stage.bolts {
            if let Some(forces) = BoltForces::of(bolts, stage.mesh, stage.state) {
                let end = format!("-{}.csv", file_name(bolts.name()));
                write_table(&file(&end), &forces.columns())?;
            }
        }
        Ok(())
    }

    /// Writes the fields of the body; the number of the stage is written as the time.
    fn body(&self, file: &Path, stage: &CompletedStage) -> Result<(), IoError> {
        let count = stage.mesh.element_count();
        let displacement = stage
            .state
            .displacement
            .iter()
            .flat_map(|u| [u.x, u.y, u.z]);
        let displacement: Vec<f64> = displacement.collect();
        let stress: Vec<f64> = stage.stress.iter().flat_map(|stress| stress.0).collect();
        let state_variables: Vec<(&HistoryVariable, Vec<f64>)> = (stage.variables.iter())
            .map(|variable| (variable, element_values(stage.state, variable, count)))
            .collect();
        let field = |(name, unit), components, numbers, values| VtuField {
            name,
            components,
            numbers,
            unit,
            values,
        };
        let nodal = [field(
            ("displacement", "m"),
            3,
            VtuNumbers::Real,
            &displacement,
        )];
        let mut elemental = vec![field(("stress", "Pa"), 6, VtuNumbers::Real, &stress)];
        for (variable, values) in &state_variables {
            let name = (variable.name, unit(variable.unit));
            elemental.push(field(name, 1, numbers(variable), values));
        }
        let effective: Vec<Vec<f64>> = match stage.pore_pressure {
            [] => Vec::new(),
            pressures => {
                let wet = stage.stress.iter().zip(pressures);
                let all: Vec<Stress> = wet
                    .map(|(total, pressure)| effective_stress(*total, *pressure))
                    .collect();
                let component = |i: usize| all.iter().map(|stress| stress.0[i]).collect();
                (0..EFFECTIVE_STRESS.len()).map(component).collect()
            }
        };
        let water = (!effective.is_empty()).then_some((&PORE_PRESSURE, stage.pore_pressure));
        let effective = effective.iter().map(Vec::as_slice);
        for (variable, values) in water
            .into_iter()
            .chain(EFFECTIVE_STRESS.iter().zip(effective))
        {
            let name = (variable.name, unit(variable.unit));
            elemental.push(field(name, 1, numbers(variable), values));
        }
        let number = (stage.index + 1) as f64;
        self.writer.write(file, number, &nodal, &elemental)
    }
}

/// Element values of a history variable, zero where the law does not have it.
fn element_values(state: &State, variable: &HistoryVariable, count: usize) -> Vec<f64> {
    let mut all = vec![0.0; count];
    for field in state
        .history
        .iter()
        .filter(|field| field.name == variable.name)
    {
        let values = field.values.chunks_exact(field.points.max(1));
        for (&element, values) in field.elements.iter().zip(values) {
            all[element as usize] = variable.of_element(values.iter().copied());
        }
    }
    all
}

/// Receiver of the stages of a run that has none.
pub(crate) struct NoStages;

impl StageSink for NoStages {
    fn completed(&mut self, _stage: &CompletedStage) -> Result<(), Error> {
        Ok(())
    }
}

impl StageSink for StageFiles {
    fn completed(&mut self, stage: &CompletedStage) -> Result<(), Error> {
        Ok(self.write(stage)?)
    }
}
