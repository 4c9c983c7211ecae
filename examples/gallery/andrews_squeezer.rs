//! Andrews' squeezing mechanism: seven plane bodies with seven angles in three loops, driven by a constant torque against a spring.
//! The mass matrix depends on the configuration, and six loop constraints leave one degree of freedom. The torque has the potential
//! `−mom β`, so that the energy is conserved. Hairer & Wanner, Solving ODEs II, sec. VII.7; Test Set for IVP Solvers, problem `andrews`,
//! whose published digits are good to 1e-9.

use evi_core::prelude::*;

use crate::{Reference, ReferenceOrigin, Scene, Start};

/// Andrews' squeezer; SI units, angles in radians.
#[derive(MechanicalSystem, Clone, Copy, Debug)]
#[evi(
    coordinates(beta, theta, gamma, phi, delta, omega, epsilon),
    let m11 = m1 * ra.powi(2) + m2 * (rr.powi(2) - 2.0 * da * rr * theta.cos() + da.powi(2)) + i1 + i2,
    let m21 = m2 * (da.powi(2) - da * rr * theta.cos()) + i2,
    let m22 = m2 * da.powi(2) + i2,
    let m33 = m3 * (sa.powi(2) + sb.powi(2)) + i3,
    let m44 = m4 * (e - ea).powi(2) + i4,
    let m54 = m4 * ((e - ea).powi(2) + zt * (e - ea) * phi.sin()) + i4,
    let m55 = m4 * (zt.powi(2) + 2.0 * zt * (e - ea) * phi.sin() + (e - ea).powi(2))
            + m5 * (ta.powi(2) + tb.powi(2)) + i4 + i5,
    let m66 = m6 * (zf - fa).powi(2) + i6,
    let m76 = m6 * ((zf - fa).powi(2) - u * (zf - fa) * omega.sin()) + i6,
    let m77 = m6 * ((zf - fa).powi(2) - 2.0 * u * (zf - fa) * omega.sin() + u.powi(2))
            + m7 * (ua.powi(2) + ub.powi(2)) + i6 + i7,
    let xd = sd * gamma.cos() + sc * gamma.sin() + xb,
    let yd = sd * gamma.sin() - sc * gamma.cos() + yb,
    let stretch = ((xd - xc).powi(2) + (yd - yc).powi(2)).sqrt() - l0,
    kinetic = 0.5 * (m11 * der(beta).powi(2) + 2.0 * m21 * der(beta) * der(theta) + m22 * der(theta).powi(2)
            + m33 * der(gamma).powi(2)
            + m44 * der(phi).powi(2) + 2.0 * m54 * der(phi) * der(delta) + m55 * der(delta).powi(2)
            + m66 * der(omega).powi(2) + 2.0 * m76 * der(omega) * der(epsilon) + m77 * der(epsilon).powi(2)),
    potential = 0.5 * c0 * stretch.powi(2) - mom * beta,
    let crank_x = rr * beta.cos() - d * (beta + theta).cos(),
    let crank_y = rr * beta.sin() - d * (beta + theta).sin(),
    constraint(first_x: crank_x - ss * gamma.sin() == xb),
    constraint(first_y: crank_y + ss * gamma.cos() == yb),
    constraint(second_x: crank_x - e * (phi + delta).sin() - zt * delta.cos() == xa),
    constraint(second_y: crank_y + e * (phi + delta).cos() - zt * delta.sin() == ya),
    constraint(third_x: crank_x - zf * (omega + epsilon).cos() - u * epsilon.sin() == xa),
    constraint(third_y: crank_y - zf * (omega + epsilon).sin() + u * epsilon.cos() == ya),
)]
pub struct AndrewsSqueezer {
    /// Mass of body 1.
    pub m1: f64,
    /// Mass of body 2.
    pub m2: f64,
    /// Mass of body 3.
    pub m3: f64,
    /// Mass of body 4.
    pub m4: f64,
    /// Mass of body 5.
    pub m5: f64,
    /// Mass of body 6.
    pub m6: f64,
    /// Mass of body 7.
    pub m7: f64,
    /// Horizontal place of the joint of the second and third loop.
    pub xa: f64,
    /// Its height.
    pub ya: f64,
    /// Horizontal place of the joint of the first loop.
    pub xb: f64,
    /// Its height.
    pub yb: f64,
    /// Horizontal place of the foot of the spring.
    pub xc: f64,
    /// Its height.
    pub yc: f64,
    /// Stiffness of the spring.
    pub c0: f64,
    /// Moment of inertia of body 1.
    pub i1: f64,
    /// Moment of inertia of body 2.
    pub i2: f64,
    /// Moment of inertia of body 3.
    pub i3: f64,
    /// Moment of inertia of body 4.
    pub i4: f64,
    /// Moment of inertia of body 5.
    pub i5: f64,
    /// Moment of inertia of body 6.
    pub i6: f64,
    /// Moment of inertia of body 7.
    pub i7: f64,
    /// Length of the rod at the crank.
    pub d: f64,
    /// Distance of its centre of mass.
    pub da: f64,
    /// Length of the fourth body.
    pub e: f64,
    /// Distance of its centre of mass.
    pub ea: f64,
    /// Length of the crank.
    pub rr: f64,
    /// Distance of its centre of mass.
    pub ra: f64,
    /// Rest length of the spring.
    pub l0: f64,
    /// Length of the third body.
    pub ss: f64,
    /// Distance of its centre of mass along it.
    pub sa: f64,
    /// Distance of its centre of mass across it.
    pub sb: f64,
    /// Place of the spring on it, along.
    pub sc: f64,
    /// Place of the spring on it, across.
    pub sd: f64,
    /// Distance of the fifth body's centre of mass along it.
    pub ta: f64,
    /// The same across it.
    pub tb: f64,
    /// Length of the seventh body.
    pub u: f64,
    /// Distance of its centre of mass along it.
    pub ua: f64,
    /// The same across it.
    pub ub: f64,
    /// Length of the sixth body.
    pub zf: f64,
    /// Length of the fifth body.
    pub zt: f64,
    /// Distance of the sixth body's centre of mass.
    pub fa: f64,
    /// Driving torque.
    pub mom: f64,
}

impl AndrewsSqueezer {
    /// The parameters of the test set.
    pub const STANDARD: Self = Self {
        m1: 0.04325,
        m2: 0.00365,
        m3: 0.02373,
        m4: 0.00706,
        m5: 0.0705,
        m6: 0.00706,
        m7: 0.05498,
        xa: -0.06934,
        ya: -0.00227,
        xb: -0.03635,
        yb: 0.03273,
        xc: 0.014,
        yc: 0.072,
        c0: 4530.0,
        i1: 2.194e-6,
        i2: 4.41e-7,
        i3: 5.255e-6,
        i4: 5.667e-7,
        i5: 1.169e-5,
        i6: 5.667e-7,
        i7: 1.912e-5,
        d: 0.028,
        da: 0.0115,
        e: 0.02,
        ea: 0.01421,
        rr: 0.007,
        ra: 0.00092,
        l0: 0.07785,
        ss: 0.035,
        sa: 0.01874,
        sb: 0.01043,
        sc: 0.018,
        sd: 0.02,
        ta: 0.02308,
        tb: 0.00916,
        u: 0.04,
        ua: 0.01228,
        ub: 0.00449,
        zf: 0.02,
        zt: 0.04,
        fa: 0.01421,
        mom: 0.033,
    };

    /// At rest; `θ = 0`, the other angles follow from the loops (of the standard mechanism).
    pub const fn standard_start(&self) -> Start<7> {
        Start {
            q: [
                -0.061_713_890_014_276_45,
                0.0,
                0.455_279_819_163_070_4,
                0.222_668_390_165_885_88,
                0.487_364_979_543_842_56,
                -0.222_668_390_165_885_88,
                1.230_547_444_549_821_2,
            ],
            v: [0.0; 7],
        }
    }
}

impl Scene for AndrewsSqueezer {
    const NAME: &'static str = "andrews_squeezer";
    const SUMMARY: &'static str = "Seven plane bodies in three loops, driven by a torque against a spring.";
    const ORIGIN: &'static str = "Hairer & Wanner, Solving Ordinary Differential Equations II (1996), sec. VII.7; Test Set for IVP Solvers, andrews";
    const HORIZON: f64 = 0.03;
    const CONSERVES_ENERGY: bool = true;

    fn standard() -> Self {
        Self::STANDARD
    }

    fn standard_motion(&self) -> ([f64; 7], [f64; 7]) {
        let Start { q, v } = self.standard_start();
        (q, v)
    }

    fn reference() -> Reference<Self> {
        Reference {
            origin: ReferenceOrigin::Certified,
            q: [
                15.810771195153707,
                -15.756371058411839,
                0.0408222401196458,
                -0.5347301163420796,
                0.524409965879954,
                0.5347301163420796,
                1.048080741041938,
            ],
            v: [
                1139.9203022591062,
                -1424.3792951775401,
                11.032911910618594,
                19.29337410503204,
                0.5735699148295025,
                -19.29337410503204,
                0.3231791492491309,
            ],
        }
    }
}
