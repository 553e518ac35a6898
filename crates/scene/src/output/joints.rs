//! Histories, outcomes and facets of joints.

use powerhouse_model::Mesh;
use powerhouse_observe::{JointHistories, JointQuantities, JointTable, JointWatch};

use super::{
    JointRequest, OutputItem, OutputPrice, OutputScale, OutputSite, Recorder, TableForm,
    TablePeaks, TablePlots, model,
};
use crate::Error;
use crate::joint::NamedSurface;

/// Joints and the requested zones of them.
#[derive(Debug)]
pub(super) struct Joints;

/// Name of the table.
pub(super) const JOINTS: &str = "joints";
/// Columns of a joint, and at most of a part of one.
const OF_EVERY_JOINT: usize = 8;
const OF_A_ZONE: usize = 11;
/// Numbers of fields at a corner of the facets at the end.
const FIELDS: f64 = 18.0;

impl OutputItem for Joints {
    fn record(&self, site: &OutputSite, into: &mut Recorder) -> Result<(), Error> {
        let mut watches: Vec<JointWatch> = site.joints.iter().map(whole).collect();
        for request in &site.plan.joints {
            watches.push(request.watch(site.mesh, site.joints)?);
        }
        if watches.is_empty() {
            return Ok(());
        }
        let joints = JointHistories::new(site.cadence(), watches).map_err(model)?;
        let plots = TablePlots::of_names("joint-");
        let form = TableForm::new(JOINTS, plots, TablePeaks::NotZero);
        let (recording, surfaces) = (joints.recording(), site.joints.to_vec());
        into.table(form, joints.recording(), |tables| &tables.history);
        into.observe(joints);
        into.end(move |results| {
            let tables = recording.copy();
            // Joints with common nodes are adjacent in the model, whatever their order in the scene.
            let surface = |joint: &JointTable| {
                let found = surfaces.iter().find(|(name, _)| *name == joint.name);
                found.map(|(_, surface)| surface.clone())
            };
            results.joint_surfaces = tables.joints.iter().filter_map(surface).collect();
            (results.joint_outcomes, results.joints) = (tables.outcomes, tables.joints);
        });
        Ok(())
    }
    fn price(&self, scale: &OutputScale) -> OutputPrice {
        let columns = OF_EVERY_JOINT * scale.joints + OF_A_ZONE * scale.plan.joints.len();
        let mut price = scale.table(columns as f64, scale.plan.every);
        price.files += scale.bytes_of_facets(FIELDS);
        price
    }
}

/// Request for every joint as a whole.
fn whole((name, surface): &NamedSurface) -> JointWatch {
    JointWatch {
        name: name.clone(),
        joint: name.clone(),
        pairs: (0..surface.pairs.len()).collect(),
        quantities: JointQuantities {
            opening: false,
            traction: false,
            ..JointQuantities::ALL
        },
    }
}

impl JointRequest {
    /// The pairs that are requested.
    fn watch(&self, mesh: &Mesh, surfaces: &[NamedSurface]) -> Result<JointWatch, Error> {
        let of_name = surfaces.iter().find(|(name, _)| *name == self.joint);
        let Some((joint, surface)) = of_name else {
            return Err(Error::NoSuchJoint {
                name: self.joint.clone(),
            });
        };
        Ok(JointWatch {
            name: self.name.clone(),
            joint: joint.clone(),
            pairs: self.zone.pairs(mesh, (joint, surface))?,
            quantities: self.quantities,
        })
    }
}
