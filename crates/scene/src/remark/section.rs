//! Remarks about sections.

use powerhouse_observe::SectionPiece;

use super::{Item, Kind};
use crate::Topic;

/// Number of pieces of a section that a warning describes one by one.
const SHOWN_PIECES: usize = 4;

remark! {
    /// Warning: section forces are computed from linear tetrahedra, which are too stiff in bending.
    pub struct TetrahedralSection {
        /// Name of the section.
        pub section: String,
        /// Element set that it cuts.
        pub set: String,
        /// Number of cut tetrahedra.
        pub elements: usize,
        /// Number of cut elements.
        pub of: usize,
    }
    Warning(Sections),
    "section '{section}' cuts {elements} linear tetrahedra of '{set}' ({of} elements in all): its forces are wrong, bending moments by a factor of several, since such elements are too stiff in bending; give them nodes on their edges (`order = 2` of [mesh]), or mesh '{set}' with hexahedra or wedges (finer linear tetrahedra come nearer slowly)"
}

/// Warning: a section cuts several pieces that do not touch, whose forces it adds up.
#[derive(Clone, Debug, PartialEq)]
pub struct DividedSection {
    /// Name of the section.
    pub section: String,
    /// Element set that it cuts.
    pub set: String,
    /// Cut elements, area, centroid and extents of each piece.
    pub pieces: Vec<SectionPiece>,
    /// Least and greatest `half_extent` (m) that keep the piece nearest to the section's point alone; none if no value
    /// does.
    pub half_extent: Option<[f64; 2]>,
}

impl Item for DividedSection {
    fn kind(&self) -> Kind {
        Kind::Warning(Topic::Sections)
    }
    fn text(&self) -> String {
        let (section, set, pieces) = (&self.section, &self.set, &self.pieces);
        let mut text = format!(
            "section '{section}' cuts {} pieces of '{set}' that do not touch: ",
            pieces.len()
        );
        for piece in pieces.iter().take(SHOWN_PIECES) {
            let (c, width, depth) = (piece.centroid, piece.width, piece.depth);
            text += &format!(
                "{} elements about ({:.3}, {:.3}, {:.3}) m, {width:.3} m along and {depth:.3} m across; ",
                piece.elements.len(),
                c.x,
                c.y,
                c.z
            );
        }
        if let more @ 1.. = pieces.len().saturating_sub(SHOWN_PIECES) {
            text += &format!("{more} more; ");
        }
        text += "its forces are the sums over all of them and its moments are about their common centroid, not those of one piece; ";
        let way = match self.half_extent {
            Some([least, most]) => format!(
                "`half_extent` from {least} to {most} m takes the piece nearest to `at` alone"
            ),
            None => "for one piece alone, give a point of it as `at`, and a `half_extent` that leaves out the others".into(),
        };
        text + &way
    }
}

remark! {
    /// Warning: a section fills less than half of its extents, as that of a closed lining: its forces are those of a frame.
    pub struct HollowSection {
        /// Name of the section.
        pub section: String,
        /// Element set that it cuts.
        pub set: String,
        /// Area over the product of width and depth (1), below 0.5.
        pub filled: f64,
        /// Extent (m) along the section's `along`.
        pub width: f64,
        /// Extent (m) across.
        pub depth: f64,
    }
    Warning(Sections),
    "section '{section}' of '{set}' fills {:.0} % of its {width:.3} m along and {depth:.3} m across: it cuts a frame or a ring, and its forces and moments are those of all of it; for one side give a point of it as `at`, and a `half_extent` that leaves out the others",
    100.0 * filled
}

remark! {
    /// Warning: a section cuts a face at which its elements end, whose support enters its forces.
    pub struct SectionThroughEnd {
        /// Name of the section.
        pub section: String,
        /// Element set that it cuts.
        pub set: String,
    }
    Warning(Sections),
    "section '{section}' cuts a face at which '{set}' ends, and what acts on that face enters its forces; turn its normal so that the plane is parallel to the face, or move it away from the end"
}

remark! {
    /// Warning: a section cuts a part that may crack or yield with few bricks across of a kernel with one integration point
    /// and elastic bending, which forms no plastic hinge.
    pub struct Hinge {
        /// Name of the section.
        pub section: String,
        /// Element set that it cuts.
        pub set: String,
        /// Kernel of the bricks.
        pub kernel: String,
        /// Number of bricks across.
        pub layers: usize,
    }
    Warning(Sections),
    "section '{section}' cuts '{set}', which may crack or yield, with {layers} bricks of '{kernel}' across: a point in the middle of each cracks or yields as a whole, while bending stays elastic, so that moments may exceed what the section bears; take kernel = \"hex8-eas\", or at least 4 bricks across"
}

/// Warning after the run: forces of a section were beyond what its reinforcement bears.
#[derive(Clone, Debug, PartialEq)]
pub struct BeyondCapacity {
    /// Name of the section.
    pub section: String,
    /// Greatest utilisation (1), above one; infinite where no moment is borne.
    pub utilisation: f64,
    /// First time beyond (s).
    pub from: f64,
    /// Time of the greatest utilisation (s).
    pub time: f64,
    /// Normal force at that time (N/m), tension positive.
    pub axial: f64,
    /// Moment at that time (N m/m).
    pub moment: f64,
    /// Least and greatest moment that the section bears with that force (N m/m); none if it does not bear the force.
    pub borne: Option<[f64; 2]>,
}

impl Item for BeyondCapacity {
    fn kind(&self) -> Kind {
        Kind::Warning(Topic::Sections)
    }
    fn text(&self) -> String {
        let (section, utilisation, time) = (&self.section, self.utilisation, self.time);
        let [axial, moment] = [self.axial, self.moment].map(|force| 1e-3 * force);
        let worst = match self.borne {
            Some([least, greatest]) => format!(
                "at {time:.3} s, with N = {axial:.4} kN/m, M = {moment:.4} kN m/m is {utilisation:.3} times what it bears ({:.4} to {:.4} kN m/m)",
                1e-3 * least,
                1e-3 * greatest
            ),
            None => format!(
                "at {time:.3} s it does not bear N = {axial:.4} kN/m with any moment (utilisation {utilisation:.3})"
            ),
        };
        format!(
            "section '{section}' is beyond what its reinforcement bears from {:.3} s on: {worst}; an elastic lining is then computed too stiff, and its forces are not those of the concrete",
            self.from
        )
    }
}

remark! {
    /// Warning: rays of a ring of sections meet no element.
    pub struct PartialRing {
        /// Name of the ring.
        pub ring: String,
        /// Number of rays that meet none, and of all.
        pub missed: [usize; 2],
        /// Angles of the first and last of them (degrees).
        pub angles: [f64; 2],
    }
    Warning(Sections),
    "ring '{ring}': {} of {} rays meet no element, between {} and {} degrees from upward: there are no sections",
    missed[0],
    missed[1],
    angles[0],
    angles[1]
}
