//! Returns to surfaces of planes by trying every set of faces.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use powerhouse_model::ElasticMedium;

/// A face `normal . s <= offset` in unsorted principal stresses, and its flow.
pub(crate) struct Face {
    pub(crate) normal: Vector3<f64>,
    pub(crate) flow: Vector3<f64>,
    pub(crate) offset: f64,
}

/// `tan^2 (45 + x / 2)` of an angle in degrees.
pub(crate) fn passive_ratio(angle: f64) -> f64 {
    let half = std::f64::consts::FRAC_PI_4 + 0.5 * angle.to_radians();
    half.tan().powi(2)
}

/// The six faces `n s_i - s_j <= strength` with flow along `m s_i - s_j`.
pub(crate) fn shear_faces(n: f64, m: f64, strength: f64) -> Vec<Face> {
    let mut faces = Vec::new();
    for i in 0..3 {
        for j in (0..3).filter(|j| *j != i) {
            let along = |ratio: f64| {
                let mut vector = Vector3::zeros();
                (vector[i], vector[j]) = (ratio, -1.0);
                vector
            };
            faces.push(Face {
                normal: along(n),
                flow: along(m),
                offset: strength,
            });
        }
    }
    faces
}

/// The three faces `s_i <= tension`.
pub(crate) fn cut_off_faces(tension: f64) -> Vec<Face> {
    let faces = (0..3).map(|i| {
        let normal = Vector3::ith(i, 1.0);
        Face {
            normal,
            flow: normal,
            offset: tension,
        }
    });
    faces.collect()
}

/// The return by trying every set of at most three faces of the whole surface: the stress with
/// `D sum(g_i flow_i) = trial - stress` on the faces of the set that lies within all others, with
/// the closest in energy (associated) or with no negative `g_i` (in general).
pub(crate) fn search(
    faces: &[Face],
    medium: &ElasticMedium,
    cohesion: f64,
    associated: bool,
    trial: [f64; 3],
) -> Vector3<f64> {
    let trial = Vector3::from(trial);
    let (lambda, shear) = (medium.lambda(), medium.shear());
    let stiffness = Matrix3::from_element(lambda) + 2.0 * shear * Matrix3::identity();
    let compliance = stiffness.try_inverse().unwrap();
    let scale = trial.norm().max(cohesion);
    let excess = |stress: &Vector3<f64>| {
        let all = faces
            .iter()
            .map(|face| face.normal.dot(stress) - face.offset);
        all.fold(f64::NEG_INFINITY, f64::max)
    };
    if excess(&trial) <= 0.0 {
        return trial;
    }
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for i in 0..faces.len() {
        sets.push(vec![i]);
        for j in 0..i {
            sets.push(vec![i, j]);
            sets.extend((0..j).map(|k| vec![i, j, k]));
        }
    }
    let mut best = (f64::INFINITY, trial);
    for set in sets {
        let size = set.len();
        let matrix = DMatrix::from_fn(size, size, |a, b| {
            faces[set[a]].normal.dot(&(stiffness * faces[set[b]].flow)) / shear
        });
        let over = DVector::from_fn(size, |a, _| {
            faces[set[a]].normal.dot(&trial) - faces[set[a]].offset
        });
        let size_of_rows: f64 = matrix.row_iter().map(|row| row.norm()).product();
        let factors = matrix.full_piv_lu();
        if factors.determinant().abs() < 1e-9 * size_of_rows {
            continue;
        }
        let Some(flows) = factors.solve(&over) else {
            continue;
        };
        let flow: Vector3<f64> = (0..size).map(|a| flows[a] * faces[set[a]].flow).sum();
        let stress = trial - stiffness * flow / shear;
        let outside = excess(&stress).max(0.0) / scale;
        let merit = if associated {
            let loss = trial - stress;
            if outside < 1e-11 {
                loss.dot(&(compliance * loss)).sqrt() * shear.sqrt() / scale
            } else {
                1e9
            }
        } else {
            outside.max(flows.iter().fold(0.0, |most: f64, g| most.max(-g)) / scale)
        };
        if merit < best.0 {
            best = (merit, stress);
        }
    }
    best.1
}
