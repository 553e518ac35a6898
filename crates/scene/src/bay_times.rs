//! Times of the results of a bay of an endless row.

use powerhouse_model::DelayedPairs;
use powerhouse_observe::Place;

use crate::output::RelativeRequest;
use crate::remark::{self, Kind, described};
use crate::{Remark, Scene, Topic};

/// The times of the results of a bay of an endless row.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BayTimes {
    /// y (m) at which the time of the results is that of the waves.
    pub middle: f64,
    /// Slowness of the waves along y (s/m).
    pub slowness: f64,
    /// Length of the bay (m).
    pub length: f64,
}

described!(BayTimes, |_| Kind::Fact(Topic::Run));

impl core::fmt::Display for BayTimes {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self {
            middle,
            slowness,
            length,
        } = self;
        let [first, then] = if *slowness < 0.0 {
            ["earlier", "later"]
        } else {
            ["later", "earlier"]
        };
        write!(
            f,
            "a bay of {length} m of an endless row, in which waves travel along y with {slowness:.4e} s/m: the times of all results are those at y = {middle} m, and what happens at a larger y of the bay happens there {first} by {:.3} ms per metre, at a smaller one {then}; the next bay moves {:.3} ms {first}",
            1e3 * slowness.abs(),
            1e3 * (slowness * length).abs()
        )
    }
}

impl Scene {
    /// What is to be known of the times of a bay; none of any other body.
    pub(crate) fn bay_times(&self) -> Option<BayTimes> {
        let slowness = self.slowness_along_y();
        let (low, high) = self.mesh.bounding_box();
        (self.is_bay() && slowness != 0.0).then(|| BayTimes {
            middle: 0.5 * (low.y + high.y),
            slowness,
            length: high.y - low.y,
        })
    }

    /// Warnings about relative displacements of two places at different y of a bay, whose motions are those of different times.
    pub(crate) fn relative_in_bay(&self) -> Vec<Remark> {
        let Some(times) = self.bay_times() else {
            return Vec::new();
        };
        let apart = |request: &RelativeRequest| {
            let [at, from] = [&request.at, &request.from].map(|place| self.y_of(place));
            let apart = at? - from?;
            (apart.abs() > DelayedPairs::AT_END * times.length).then(|| {
                Remark::from(remark::RelativeInBay {
                    name: request.name.clone(),
                    apart,
                    delay: times.slowness * apart,
                })
            })
        };
        self.output.relative.iter().filter_map(apart).collect()
    }

    /// Coordinate y (m) of a place, of a set the mean of its nodes; none of a place that is not in the mesh.
    fn y_of(&self, place: &Place) -> Option<f64> {
        let points = place.points(&self.mesh);
        let sum: f64 = points.iter().map(|point| point.y).sum();
        (!points.is_empty()).then(|| sum / points.len() as f64)
    }
}
