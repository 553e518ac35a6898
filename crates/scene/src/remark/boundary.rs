//! Remarks about absorbing faces and the parts beside them.

use powerhouse_model::Vec3;

remark! {
    /// Warning: a side of the mesh other than its top is neither absorbing nor supported, and reflects waves.
    pub struct OpenSide {
        /// Side of the bounding box: `left`, `right` (x), `front`, `back` (y) or `bottom`.
        pub side: &'static str,
        /// Area of its free facets (m2).
        pub area: f64,
    }
    Warning(Run),
    "{area:.4} m2 on the {side} of the mesh are neither absorbing nor supported: waves are reflected there"
}

remark! {
    /// Fact: the scatterer (centre of the structure), from which boundary springs take their distance, has its default
    /// position.
    pub struct Scatterer {
        /// Position of the scatterer (m).
        pub position: Vec3,
    }
    Fact(Run),
    "the distance of boundary springs is measured from ({:.3}, {:.3}, {:.3}) m, the centre of the parts that touch no absorbing face",
    position.x,
    position.y,
    position.z
}

remark! {
    /// Scatterer above the body.
    pub struct ScattererAbove {
        /// Height z of the scatterer (m).
        pub height: f64,
        /// Greatest height z of the body (m).
        pub top: f64,
    }
    Warning(Run),
    "`scatterer` is at z = {height} m, above the body, which ends at {top} m: the springs of the boundary take their distance from the centre of the structure"
}

remark! {
    /// Springs for spherical spreading of scattered waves on a model that stands for a long body.
    pub struct SphericalSpreading {
        /// What makes the model one of a long body.
        pub ends: &'static str,
    }
    Warning(Run),
    "the springs of the boundary are those of spherical spreading, but the model is {ends}, from which scattered waves spread as cylinders: give `spreading = \"cylindrical\"`"
}

remark! {
    /// Fact: a part of a structure runs through absorbing faces, where it takes the field of the ground.
    pub struct Through {
        /// Element set of the part.
        pub set: String,
        /// The faces.
        pub faces: Vec<String>,
        /// Area of the part over that of these faces (1).
        pub share: f64,
        /// Impedance of S waves of the part over that of the ground there (1), the one farthest from one.
        pub contrast: f64,
        /// Greatest extent of the part on a face (m).
        pub width: f64,
    }
    Fact(Run),
    "part '{set}' runs through the absorbing faces {} ({:.2} % of their area): it absorbs there with its own impedance, {contrast:.2} times that of the ground, and takes motion and stress of the ground without it; results within {:.3} m of these faces, twice its extent there, are those of this end (stresses of a lined tunnel differed from those of a longer one by up to 26 % at half an extent, 13 % at one, 8 % at two)",
    faces.join(", "),
    100.0 * share,
    2.0 * width
}

remark! {
    /// Warning: a damped part without a rim touches an absorbing face, although the free field is elastic.
    pub struct DampedRim {
        /// Element set of the part.
        pub set: String,
    }
    Warning(Run),
    "part '{set}' touches an absorbing face with another damping than the free field has there, so waves are partly reflected: give the part the damping of the layers that it lies in, or, where the field is elastic, a rim"
}

remark! {
    /// Warning: a part with a nonlinear law and no rim touches an absorbing face, although the free field is elastic.
    pub struct NonlinearRim {
        /// Element set of the part.
        pub set: String,
        /// Name of the law.
        pub law: String,
    }
    Warning(Run),
    "part '{set}' with the law '{law}' touches an absorbing face: the free field is elastic, so yielding there reflects the waves; give the part a rim"
}

remark! {
    /// Fact: elements of a part along the absorbing faces are elastic and undamped (rim).
    pub struct Rim {
        /// Element set of the part.
        pub set: String,
        /// Width of the rim (m); 0 for the elements that touch the faces.
        pub width: f64,
        /// Number of elements of the rim.
        pub elements: usize,
        /// Number of elements of the part.
        pub of: usize,
    }
    Fact(Run),
    "rim of part '{set}': {elements} of its {of} elements {}; they are elastic and undamped",
    match *width {
        0.0 => "touch the absorbing faces".to_owned(),
        width => format!("touch the absorbing faces or are within {width} m of them"),
    }
}

remark! {
    /// Warning: a rim covers the whole part, so that its law or damping acts nowhere.
    pub struct WholeRim {
        /// Element set of the part.
        pub set: String,
    }
    Warning(Run),
    "the rim of part '{set}' covers the whole part: all of it is elastic and undamped"
}
