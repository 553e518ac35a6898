//! Pairs whose sides slide on each other without friction: their nodes have the same displacement along the normal.

use std::collections::BTreeMap;

use nalgebra::DVector;
use powerhouse_model::{DisjointSets, Vec3};

use crate::node_group::NodeGroup;

/// Length of a unit vector below which what is left of it, after its parts along others are taken off, is rounding.
const DEPENDENT: f64 = 1.0e-8;

/// Displacements that pairs without friction admit, as a projection of reduced vectors.
#[derive(Debug, Default)]
pub(super) struct Sliding(Vec<Cluster>);

/// Lead nodes that pairs connect, with an orthonormal basis of what pairs and supports hold there, three components a node.
#[derive(Debug)]
struct Cluster {
    leads: Vec<u32>,
    held: Vec<DVector<f64>>,
}

impl Sliding {
    /// Of pairs of engine nodes with their normals, whose motion is that of their groups.
    pub(super) fn new(pairs: &[([u32; 2], Vec3)], groups: &[NodeGroup]) -> Self {
        let mut group_of = BTreeMap::new();
        for (index, group) in groups.iter().enumerate() {
            group_of.extend(group.members.iter().map(|&member| (member, index)));
        }
        let of_groups: Vec<([usize; 2], Vec3)> = (pairs.iter())
            .map(|(nodes, normal)| (nodes.map(|node| group_of[&node]), *normal))
            .filter(|([first, second], _)| first != second)
            .collect();
        let mut sets = DisjointSets::new(groups.len());
        for ([first, second], _) in &of_groups {
            sets.join(*first as u32, *second as u32);
        }
        let mut clusters = BTreeMap::<u32, Vec<([usize; 2], Vec3)>>::new();
        for (own, normal) in of_groups {
            let root = sets.root(own[0] as u32);
            clusters.entry(root).or_default().push((own, normal));
        }
        let cluster = |pairs: Vec<([usize; 2], Vec3)>| Cluster::new(&pairs, groups);
        Self(clusters.into_values().map(cluster).collect())
    }

    /// Takes off a reduced vector what is held.
    pub(super) fn project(&self, vector: &mut [Vec3]) {
        for cluster in &self.0 {
            let leads = cluster.leads.iter();
            let values = leads.flat_map(|&lead| <[f64; 3]>::from(vector[lead as usize]));
            let mut all = DVector::from_iterator(3 * cluster.leads.len(), values);
            without(&mut all, &cluster.held);
            for (place, &lead) in cluster.leads.iter().enumerate() {
                vector[lead as usize] = all.fixed_rows::<3>(3 * place).into_owned();
            }
        }
    }
}

impl Cluster {
    fn new(pairs: &[([usize; 2], Vec3)], groups: &[NodeGroup]) -> Self {
        let mut own: Vec<usize> = pairs.iter().flat_map(|(own, _)| *own).collect();
        own.sort_unstable();
        own.dedup();
        let place = |group: usize| 3 * own.partition_point(|&other| other < group);
        let mut held: Vec<DVector<f64>> = Vec::new();
        let mut hold = |mut row: DVector<f64>| {
            row.normalize_mut();
            without(&mut row, &held);
            if row.norm() > DEPENDENT {
                // What rounding leaves of the others is taken off once more.
                row.normalize_mut();
                without(&mut row, &held);
                held.push(row.normalize());
            }
        };
        for &group in &own {
            for direction in groups[group].condition.directions() {
                let mut row = DVector::zeros(3 * own.len());
                row.fixed_rows_mut::<3>(place(group)).copy_from(direction);
                hold(row);
            }
        }
        for ([first, second], normal) in pairs {
            let mut row = DVector::zeros(3 * own.len());
            row.fixed_rows_mut::<3>(place(*first)).copy_from(&-normal);
            row.fixed_rows_mut::<3>(place(*second)).copy_from(normal);
            hold(row);
        }
        Self {
            leads: own.iter().map(|&group| groups[group].members[0]).collect(),
            held,
        }
    }
}

/// Takes off a vector its parts along unit vectors that are orthogonal to each other.
fn without(vector: &mut DVector<f64>, units: &[DVector<f64>]) {
    for unit in units {
        let part = unit.dot(vector);
        vector.axpy(-part, unit, 1.0);
    }
}
