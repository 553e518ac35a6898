//! Forces of a circular lining in a shear of the ground: the published formulas for thin rings, and the exact solution of two
//! elastic bodies, a thick ring in an unbounded ground.

use nalgebra::{SMatrix, SVector};
use powerhouse_model::ElasticMedium;

/// A lining in ground, in plane strain.
#[derive(Clone, Copy)]
pub(super) struct Ring {
    /// Radius of its middle (m), and its thickness (m).
    pub(super) radius: f64,
    pub(super) thickness: f64,
    pub(super) lining: ElasticMedium,
    pub(super) ground: ElasticMedium,
}

/// Greatest thrust (N/m) and bending moment (N m/m), which vary as `cos 2 theta`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Forces {
    pub(super) thrust: f64,
    pub(super) moment: f64,
}

impl Ring {
    /// Bending stiffness of the ring as a plate, `E I / (1 - nu^2)` (N m).
    fn bending(&self) -> f64 {
        let Self {
            lining, thickness, ..
        } = self;
        lining.young * thickness.powi(3) / 12.0 / (1.0 - lining.poisson.powi(2))
    }
    /// Flexibility ratio F of Wang (1993), `E_m (1 - nu_l^2) R^3 / (6 E_l I (1 + nu_m))`.
    pub(super) fn flexibility(&self) -> f64 {
        let Self { ground, radius, .. } = self;
        ground.young * radius.powi(3) / (6.0 * self.bending() * (1.0 + ground.poisson))
    }
    /// The same ring in ground of a flexibility ratio.
    pub(super) fn with_flexibility(mut self, flexibility: f64) -> Self {
        self.ground.young *= flexibility / self.flexibility();
        self
    }
    /// Wang (1993): a lining that slips on the ground under the shear stress `tau` (Pa), `tau = G gamma`.
    pub(super) fn wang_full_slip(&self, tau: f64) -> Forces {
        let nu = self.ground.poisson;
        let k1 = 12.0 * (1.0 - nu) / (2.0 * self.flexibility() + 5.0 - 6.0 * nu);
        // E_m gamma / (6 (1 + nu_m)) is tau / 3.
        let thrust = k1 * tau * self.radius / 3.0;
        Forces {
            thrust,
            moment: thrust * self.radius,
        }
    }
    /// Wang (1993): the thrust (N/m) of a lining that is bonded to the ground.
    pub(super) fn wang_bonded_thrust(&self, tau: f64) -> f64 {
        let Self {
            lining,
            ground,
            radius,
            thickness,
        } = self;
        let (f, nu) = (self.flexibility(), ground.poisson);
        let c = ground.young * (1.0 - lining.poisson.powi(2)) * radius
            / (lining.young * thickness * (1.0 + nu) * (1.0 - 2.0 * nu));
        let over = f * (1.0 - 2.0 * nu) * (1.0 - c) - 0.5 * (1.0 - 2.0 * nu).powi(2) + 2.0;
        let under = f * (3.0 - 2.0 * nu + (1.0 - 2.0 * nu) * c)
            + c * (2.5 - 8.0 * nu + 6.0 * nu * nu)
            + 6.0
            - 8.0 * nu;
        (1.0 + over / under) * tau * radius
    }
    /// Penzien (2000) with `alpha = (12 or 24) E_l I c / (d^3 G_m (1 - nu_l^2))`.
    fn penzien(&self, tau: f64, thrusts: f64, c: f64) -> Forces {
        let (d, modulus) = (2.0 * self.radius, self.ground.shear());
        let alpha = thrusts * self.bending() * c / (d.powi(3) * modulus);
        let distortion =
            4.0 * (1.0 - self.ground.poisson) / (alpha + 1.0) * 0.5 * d * tau / modulus;
        Forces {
            thrust: thrusts * self.bending() * distortion / d.powi(3),
            moment: 6.0 * self.bending() * distortion / d.powi(2),
        }
    }
    /// Penzien (2000): a lining that slips on the ground.
    pub(super) fn penzien_full_slip(&self, tau: f64) -> Forces {
        self.penzien(tau, 12.0, 5.0 - 6.0 * self.ground.poisson)
    }
    /// Penzien (2000): a lining that is bonded to the ground.
    pub(super) fn penzien_bonded(&self, tau: f64) -> Forces {
        self.penzien(tau, 24.0, 3.0 - 4.0 * self.ground.poisson)
    }
    /// The exact solution for a ring of this thickness, by Airy's functions `(A r^2 + B r^-2 + C r^4 + D) cos 2 theta` in
    /// both bodies.
    pub(super) fn exact(&self, tau: f64, slips: bool) -> Forces {
        let (inner, outer) = (
            self.radius - 0.5 * self.thickness,
            self.radius + 0.5 * self.thickness,
        );
        // Unknown: B and D of the ground, A to D of the ring; A of the ground is that of the far stress, its C is zero.
        let far = -0.5 * tau;
        let mut matrix = SMatrix::<f64, 6, 6>::zeros();
        let mut right = SVector::<f64, 6>::zeros();
        let mut equation = 0;
        let mut add = |ground: [f64; 4], ring: [f64; 4]| {
            let row = [ground[1], ground[3], ring[0], ring[1], ring[2], ring[3]];
            // The equations have the sizes of stresses and of strains.
            let size = row.iter().fold(0.0_f64, |size, term| size.max(term.abs()));
            for (column, term) in row.iter().enumerate() {
                matrix[(equation, column)] = term / size;
            }
            right[equation] = -far * ground[0] / size;
            equation += 1;
        };
        let none = [0.0; 4];
        let [radial, _, along] = stresses(inner);
        add(none, radial);
        add(none, along);
        let [radial, _, along] = stresses(outer);
        let [out, round] = displacements(outer, self.lining);
        let [out_ground, round_ground] = displacements(outer, self.ground);
        let less = |terms: [f64; 4]| terms.map(|term| -term);
        add(radial, less(radial));
        add(out_ground, less(out));
        if slips {
            add(none, along);
            add(along, none);
        } else {
            add(along, less(along));
            add(round_ground, less(round));
        }
        let solution = matrix.lu().solve(&right).expect("independent equations");
        // Hoop stresses A 2 + B 6 r^-4 + C 12 r^2, over the thickness and with their lever.
        let steps = 2000;
        let width = self.thickness / steps as f64;
        let mut forces = Forces {
            thrust: 0.0,
            moment: 0.0,
        };
        for step in 0..steps {
            let r = inner + (step as f64 + 0.5) * width;
            let [_, hoop, _] = stresses(r);
            let stress: f64 = (0..4).map(|i| hoop[i] * solution[2 + i]).sum();
            forces.thrust += stress * width;
            forces.moment += stress * (r - self.radius) * width;
        }
        Forces {
            thrust: forces.thrust.abs(),
            moment: forces.moment.abs(),
        }
    }
}

/// Radial and hoop stress over `cos 2 theta` and shear stress over `sin 2 theta` of the four functions.
fn stresses(r: f64) -> [[f64; 4]; 3] {
    let (r2, r4) = (r * r, r.powi(4));
    [
        [-2.0, -6.0 / r4, 0.0, -4.0 / r2],
        [2.0, 6.0 / r4, 12.0 * r2, 0.0],
        [2.0, -6.0 / r4, 6.0 * r2, -2.0 / r2],
    ]
}

/// Radial displacement over `cos 2 theta` and that around over `sin 2 theta`, in plane strain.
fn displacements(r: f64, medium: ElasticMedium) -> [[f64; 4]; 2] {
    let (nu, twice) = (medium.poisson, 2.0 * medium.shear());
    let r3 = r.powi(3);
    [
        [-2.0 * r, 2.0 / r3, -4.0 * nu * r3, 4.0 * (1.0 - nu) / r],
        [
            2.0 * r,
            2.0 / r3,
            (6.0 - 4.0 * nu) * r3,
            -(2.0 - 4.0 * nu) / r,
        ],
    ]
    .map(|terms| terms.map(|term| term / twice))
}

/// The exact solution tends to Wang's as the ring becomes thin: the difference falls with the thickness, at one flexibility ratio.
#[test]
fn a_thin_ring_is_wangs() {
    let medium = |young, poisson| ElasticMedium::new(young, poisson, 2000.0).unwrap();
    let error = |thickness: f64| {
        let ring = Ring {
            radius: 5.0,
            thickness,
            lining: medium(30e9, 0.2),
            ground: medium(1e7, 0.3),
        };
        let ring = ring.with_flexibility(5.0);
        let (slip, bonded) = (ring.exact(1e4, true), ring.exact(1e4, false));
        [
            slip.moment / ring.wang_full_slip(1e4).moment,
            slip.thrust / ring.wang_full_slip(1e4).thrust,
            bonded.thrust / ring.wang_bonded_thrust(1e4),
        ]
        .map(|ratio| (ratio - 1.0).abs())
    };
    let (thick, thin) = (error(0.2), error(0.05));
    for (thick, thin) in thick.into_iter().zip(thin) {
        assert!(thin < 0.02 && thin < 0.4 * thick, "{thick} {thin}");
    }
}
