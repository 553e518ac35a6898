//! Places of stations, by which points find theirs.

use powerhouse_model::Vec3;

use super::StationError;

/// Positions of stations, in the order of x too.
#[derive(Debug)]
pub(super) struct Places {
    positions: Vec<Vec3>,
    /// Indices of the stations in rising order of x.
    rising: Vec<u32>,
    tolerance: f64,
}

impl Places {
    /// # Errors
    /// A position that is not finite; two stations within twice the tolerance of each other.
    pub(super) fn new(positions: Vec<Vec3>, tolerance: f64) -> Result<Self, StationError> {
        let is_infinite = |position: &Vec3| position.iter().any(|x| !x.is_finite());
        if let Some(station) = positions.iter().position(is_infinite) {
            return Err(StationError::NotFinite { station, sample: 0 });
        }
        let mut rising: Vec<u32> = (0..positions.len() as u32).collect();
        let at = |index: &u32| &positions[*index as usize];
        rising.sort_by(|a, b| {
            at(a)
                .x
                .total_cmp(&at(b).x)
                .then(at(a).y.total_cmp(&at(b).y))
        });
        let places = Self {
            positions,
            rising,
            tolerance,
        };
        for (first, position) in places.positions.iter().enumerate() {
            let mut near = places.near(position, 2.0 * tolerance);
            if let Some((second, distance)) = near.find(|near| near.0 as usize > first) {
                return Err(StationError::Twice {
                    first,
                    second: second as usize,
                    position: (*position).into(),
                    distance,
                    tolerance,
                });
            }
        }
        Ok(places)
    }

    pub(super) fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Stations within a distance of a point, with their distances.
    fn near(&self, point: &Vec3, within: f64) -> impl Iterator<Item = (u32, f64)> {
        let x = |index: &u32| self.positions[*index as usize].x;
        let first = self
            .rising
            .partition_point(|index| x(index) < point.x - within);
        let last = self
            .rising
            .partition_point(|index| x(index) <= point.x + within);
        let slab = self.rising.get(first..last).unwrap_or_default();
        slab.iter().filter_map(move |&station| {
            let distance = (self.positions[station as usize] - point).norm();
            (distance <= within).then_some((station, distance))
        })
    }

    /// Station of each of some points.
    ///
    /// # Errors
    /// Points without a station within the tolerance.
    pub(super) fn of_points(&self, points: &[Vec3]) -> Result<Vec<u32>, StationError> {
        let mut found = Vec::with_capacity(points.len());
        let (mut missing, mut count) = (None, 0);
        for point in points {
            let near = self.near(point, self.tolerance);
            let nearest = near.min_by(|a, b| a.1.total_cmp(&b.1));
            match nearest {
                Some((station, _)) => found.push(station),
                None => {
                    missing.get_or_insert(*point);
                    count += 1;
                }
            }
        }
        let Some(node) = missing else {
            return Ok(found);
        };
        let distance = |position: &&Vec3| (**position - node).norm();
        let nearest = self.positions.iter();
        let nearest = nearest.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        let nearest = nearest.copied().unwrap_or(node);
        Err(StationError::NoStation {
            count,
            of: points.len(),
            node: node.into(),
            nearest: nearest.into(),
            distance: (nearest - node).norm(),
            tolerance: self.tolerance,
            lengths: Box::new([edges(&self.positions), edges(points)]),
        })
    }
}

/// Edges of the bounding box of some points (m).
fn edges(points: &[Vec3]) -> [f64; 3] {
    let low = points
        .iter()
        .fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
    let high = points
        .iter()
        .fold(Vec3::repeat(f64::NEG_INFINITY), |high, p| high.sup(p));
    (high - low).into()
}
