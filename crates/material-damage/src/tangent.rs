//! Consistent tangents of isotropic laws.

use powerhouse_model::{ElasticMedium, LawInput, Mat3, Strain, Stress};

use crate::PrincipalAxes;
use crate::dual::Dual;
use crate::surface::YieldSurface;

/// Relative difference below which principal trial stresses count as equal.
const EQUAL: f64 = 1.0e-9;

/// Tangent `d stress / d strain` (Pa) of a stress that is an isotropic function of the trial stress of an
/// elastic strain: its principal values `s_i` are given functions of the principal trial stresses.
///
/// With principal trial stresses `t_i` along `n_i` and the derivatives `P_ij = ds_i / dt_j`, a change
/// `T` of the trial stress, in the axes `n`, changes the stress by
///
/// `S_ii = sum P_ij T_jj`, `S_ij = (s_i - s_j) / (t_i - t_j) T_ij`
///
/// and by `(P_ii - P_ij) T_ij` where two are equal. Source: Simo & Hughes, *Computational
/// Inelasticity* (1998), ch. 8; de Souza Neto, Peric & Owen, *Computational Methods for Plasticity*
/// (2008), app. A.
pub(crate) fn of_isotropic(
    medium: &ElasticMedium,
    input: &LawInput<f64>,
    elastic: &Strain,
    principal: impl Fn(&[Dual; 3]) -> [Dual; 3],
) -> [[f64; 6]; 6] {
    let hooke = |strain: &Strain| Stress::elastic(medium.lambda(), medium.shear(), strain);
    let trial = input.initial + hooke(elastic);
    let axes = PrincipalAxes::of(&trial);
    let t = axes.values;
    let returned = principal(&core::array::from_fn(|i| Dual::variable(t[i], i)));
    let size = t.iter().fold(0.0_f64, |most, s| most.max(s.abs()));
    let turned = |i: usize, j: usize| {
        let apart = t[i] - t[j];
        if apart.abs() > EQUAL * size {
            (returned[i].value - returned[j].value) / apart
        } else {
            returned[i].slope[i] - returned[i].slope[j]
        }
    };
    // The columns are the axes.
    let turn = Mat3::from_fn(|row, column| axes.directions[column][row]);
    let mut tangent = [[0.0; 6]; 6];
    for column in 0..6 {
        let mut unit = Strain::default();
        unit.0[column] = 1.0;
        let change = turn.transpose() * hooke(&unit).matrix() * turn;
        let answer = Mat3::from_fn(|i, j| {
            if i == j {
                (0..3).map(|k| returned[i].slope[k] * change[(k, k)]).sum()
            } else {
                turned(i, j) * change[(i, j)]
            }
        });
        let stress = Stress::from_matrix(&(turn * answer * turn.transpose()));
        for row in 0..6 {
            tangent[row][column] = stress.0[row];
        }
    }
    tangent
}

/// Tangent of the return to a surface at the elastic strain of an input.
pub(crate) fn of_flow<S: YieldSurface>(
    surface: &S,
    input: &LawInput<f64>,
    elastic: &Strain,
) -> [[f64; 6]; 6] {
    of_isotropic(&surface.medium(), input, elastic, |trial| {
        let yields = surface.excess(&trial.map(|s| s.value)) > 0.0;
        if yields {
            surface.return_principal(trial).stress
        } else {
            *trial
        }
    })
}

/// Zero `x` of `f(x, t) = 0` with its derivatives `-(df/dt) / (df/dx)`, given by its value and
/// by `f` with constant and with variable `t`.
pub(crate) fn implicit(
    zero: f64,
    fixed: impl Fn(Dual) -> Dual,
    variable: impl Fn(Dual) -> Dual,
) -> Dual {
    let along = fixed(Dual::variable(zero, 0)).slope[0];
    let across = variable(Dual::fixed(zero)).slope;
    Dual {
        value: zero,
        slope: across.map(|slope| -slope / along),
    }
}
