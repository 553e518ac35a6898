//! What the items of output record in a run.

use std::collections::BTreeSet;
use std::time::Duration;

use powerhouse_model::{Observer, RunReport, Vec3};
use powerhouse_observe::{HistoryTable, SectionGeometry};

use super::item::{End, ListMaker, ReadTable};
use super::{
    BoltForces, NameError, OutputSite, Recorder, ResultList, ResultTable, Results, TableForm,
};
use crate::joint::NamedSurface;
use crate::{Error, Remark, Resolution};

/// What the items of an output plan record.
pub(crate) struct Recordings {
    tables: Vec<(TableForm, ReadTable)>,
    lists: Vec<ListMaker>,
    ends: Vec<End>,
    /// Geometry of the sections, in the order of their requests.
    pub(crate) section_geometry: Vec<SectionGeometry>,
    /// Surfaces of the joints, by name.
    pub(crate) joint_surfaces: Vec<NamedSurface>,
    /// Which elements are present; none if all are.
    pub(crate) present: Option<Vec<bool>>,
    /// Box of the parts that touch no absorbing face.
    pub(crate) structure: Option<[Vec3; 2]>,
    /// Frequencies that the parts resolve.
    pub(crate) resolution: Vec<Resolution>,
}

impl Recordings {
    /// Recordings and observers of a site; adds remarks about its requests.
    pub(crate) fn of(
        site: &OutputSite,
        remarks: &mut Vec<Remark>,
    ) -> Result<(Self, Vec<Box<dyn Observer>>), Error> {
        let mut all = Recorder::default();
        for item in site.plan.all_items() {
            item.record(site, &mut all)?;
        }
        let recordings = Self {
            tables: all.tables,
            lists: all.lists,
            ends: all.ends,
            section_geometry: all.geometry,
            joint_surfaces: site.joints.to_vec(),
            present: site.present.map(<[bool]>::to_vec),
            structure: None,
            resolution: Vec::new(),
        };
        let mut files = BTreeSet::new();
        for name in recordings.files() {
            if !files.insert(name.clone()) {
                return Err(NameError::Twice { name }.into());
            }
        }
        remarks.append(&mut all.remarks);
        Ok((recordings, all.observers))
    }

    /// The tables.
    pub(crate) fn forms(&self) -> impl Iterator<Item = &TableForm> {
        self.tables.iter().map(|(form, _)| form)
    }

    /// Reads each table as it is now.
    pub(crate) fn each_table(&self, mut reader: impl FnMut(&TableForm, &HistoryTable)) {
        for (form, read) in &self.tables {
            read(&mut |rows| reader(form, rows));
        }
    }

    /// Paths of the tables, lists and plots that a run may write.
    pub(crate) fn files(&self) -> Vec<String> {
        let mut files = Vec::new();
        self.each_table(|form, rows| {
            files.push(form.file());
            files.extend(form.plots(rows).into_iter().map(|plot| plot.file));
        });
        for list in &self.lists {
            files.push(format!("{}.csv", list.name));
            files.extend(list.plot.clone());
        }
        files
    }

    /// The results of a run that is over: its report, its wall time and that of a step, and the bolts with their forces at the end.
    pub(crate) fn finish(
        self,
        run: RunReport,
        [wall_time, step_time]: [Duration; 2],
        bolts: Vec<BoltForces>,
    ) -> Results {
        let mut tables = Vec::new();
        self.each_table(|form, rows| {
            let (form, rows) = (form.clone(), rows.clone());
            tables.push(ResultTable { form, rows });
        });
        let mut results = Results {
            run,
            wall_time,
            step_time,
            tables,
            lists: Vec::new(),
            section_geometry: self.section_geometry,
            section_capacities: Vec::new(),
            section_rings: Vec::new(),
            envelope: None,
            state: None,
            joint_outcomes: Vec::new(),
            joints: Vec::new(),
            joint_surfaces: Vec::new(),
            present: self.present,
            structure: self.structure,
            resolution: self.resolution,
            snapshots: 0,
            stages: Vec::new(),
            in_situ_stress: false,
            hand_over: None,
            bolts,
            advice: Vec::new(),
            fibres: None,
        };
        for end in self.ends {
            end(&mut results);
        }
        for ListMaker { name, plot, make } in self.lists {
            if let Some((columns, of_list)) = make(&results) {
                let plot = plot.zip(of_list);
                results.lists.push(ResultList {
                    name,
                    columns,
                    plot,
                });
            }
        }
        results
    }
}
