//! Numbers to compare with, from outside this project.
//!
//! Certified reference solutions: Taylor series in 256-bit arithmetic, cross-checked in other coordinates, at
//! another precision and by an extrapolation code; 30 digits agree. Here they are rounded to `f64`.
//! Multipliers follow `d/dt ∂L/∂v − ∂L/∂q + Gᵀ λ = 0` with the constraints as the gallery writes them; SI
//! units.

/// A certified point of a motion.
#[derive(Clone, Copy, Debug)]
pub struct Certified {
    /// Time since the start.
    pub t: f64,
    /// Configuration.
    pub q: &'static [f64],
    /// Velocity.
    pub v: &'static [f64],
    /// Multipliers, none for a scene without constraints.
    pub multipliers: &'static [f64],
}

/// `DoublePendulum::UNIT` from `horizontal()`.
pub const DOUBLE_PENDULUM: [Certified; 3] = [
    Certified {
        t: 0.25,
        q: &[0.9552233137497529, -0.2958858240418779, 1.9551669795882956, -0.30650020812089374],
        v: &[-0.6840162904806932, -2.208244716581301, -0.6865840203899946, -2.4501414897973737],
        multipliers: &[7.650318688731275, 3.680319177286613],
    },
    Certified {
        t: 0.5,
        q: &[0.5400294089888501, -0.8416461473963707, 1.4734656700520146, -1.2003894351836406],
        v: &[-2.3478946116953674, -1.506490754391615, -3.4915907231011363, -4.482344124660482],
        multipliers: &[14.9109302467031, 8.55017464813925],
    },
    Certified {
        t: 1.0,
        q: &[-0.585168391998875, -0.8109118034690647, -1.4448188499434758, -1.3217944613814645],
        v: &[-3.1806228021604617, 2.2951940306368916, -3.846353609858095, 3.415403896525958],
        multipliers: &[20.818039436294907, 9.972929848254504],
    },
];

/// `DoublePendulum::UNIT` from `at_angles(0.1, 0.1)`.
pub const DOUBLE_PENDULUM_MILD: [Certified; 2] = [
    Certified {
        t: 1.0,
        q: &[-0.04980639778702785, -0.9987588911942062, -0.1565462220834718, -1.9930458768825257],
        v: &[-0.09948302932544134, 0.004961048532661344, -0.34975681354657717, 0.03182872369917941],
        multipliers: &[9.807414019824739, 4.9115502127937845],
    },
    Certified {
        t: 10.0,
        q: &[0.03625418294067982, -0.9993426010229444, 0.0780706350596701, -1.998467910647408],
        v: &[0.10640638784822784, 0.0038602143520728503, 0.4892489168442083, 0.01988334591390951],
        multipliers: &[9.887993183141516, 4.980626279786438],
    },
];

/// `SphericalPendulum::UNIT` from `one_radian()`.
pub const SPHERICAL_PENDULUM: [Certified; 2] = [
    Certified {
        t: 1.0,
        q: &[-0.7809207701382389, -0.2843489582698232, -0.5561550329697342],
        v: &[0.14176302815138192, -1.241425570255791, 0.4356561753237515],
        multipliers: &[3.603455689583189],
    },
    Certified {
        t: 10.0,
        q: &[-0.010769679157201456, 0.560901690603541, -0.8278123624885899],
        v: &[-1.768443913127701, -1.6566882725263228, -1.0995168960450608],
        multipliers: &[7.60089329345315],
    },
];

/// `StiffSpringPendulum::with_stiffness(1e2)` from `horizontal()`.
pub const STIFF_SPRING_PENDULUM_1E2: Certified = Certified {
    t: 1.0,
    q: &[-1.036262140512986, -0.4776800855320967],
    v: &[-0.7326045511549204, 2.6637542820328908],
    multipliers: &[],
};

/// `StiffSpringPendulum::with_stiffness(1e4)` from `horizontal()`.
pub const STIFF_SPRING_PENDULUM_1E4: Certified = Certified {
    t: 1.0,
    q: &[-0.9969486702681352, -0.0811454255935466],
    v: &[-0.10395435853697933, 1.3530201843563137],
    multipliers: &[],
};

/// `KapitzaPendulum::STANDARD` from `near_inverted()`.
pub const RHEONOMIC_PENDULUM: Certified = Certified {
    t: 1.0,
    q: &[-0.006748973597739527, 0.31534922097362666],
    v: &[0.006171865492860287, 2.964233753284131],
    multipliers: &[6.786211376207917],
};

/// `KapitzaPendulum::LONG` from `near_inverted()`.
pub const RHEONOMIC_PENDULUM_LONG: Certified = Certified {
    t: 1.0,
    q: &[0.4698360524659136, 0.8981788387240196],
    v: &[2.1555726086724096, 1.8168147957977885],
    multipliers: &[4.77893722665562],
};

/// `DrivenPendulum::STANDARD` from `horizontal()`.
pub const DRIVEN_PENDULUM: Certified = Certified {
    t: 1.0,
    q: &[-0.9616585838860878, -0.2742494631502571],
    v: &[-0.4570493297651815, 1.6026482100614385],
    multipliers: &[2.8339290986586283],
};

/// Its mechanical energy there, which was 0.
pub const DRIVEN_PENDULUM_ENERGY: f64 = -1.301699545978055;

/// `FermiPastaUlam::STANDARD` from `one_spring_excited()`.
pub const FERMI_PASTA_ULAM: [Certified; 3] = [
    Certified {
        t: 1.0,
        q: &[
            0.7477560991407888,
            0.5496121245547304,
            0.003971910807960369,
            0.0156485563448587,
            0.0009138440966828096,
            -6.52698695216286e-05,
        ],
        v: &[
            -1.0767844027571125,
            0.8006893987878847,
            0.028229458269830615,
            1.1820645462316859,
            -0.013043151661235064,
            -0.00037594526734922537,
        ],
        multipliers: &[],
    },
    Certified {
        t: 10.0,
        q: &[
            1.042057637102509,
            0.24363557036319108,
            -0.10636043796464913,
            -0.02755793120125174,
            -0.0005927177946675772,
            0.0003950540596100755,
        ],
        v: &[
            0.8973233890558256,
            -0.615417550566789,
            -0.1287070270742707,
            -0.11632415447804959,
            0.22468371856386707,
            0.002549069486236396,
        ],
        multipliers: &[],
    },
    Certified {
        t: 100.0,
        q: &[
            -0.7655725195988103,
            0.22667342120630338,
            -0.2509222609807883,
            0.0091662455476241,
            -0.005388020898242531,
            -0.018555447344714218,
        ],
        v: &[
            -0.44542845327857045,
            -1.0096039853167376,
            0.31434052431640336,
            0.03276291293334144,
            -0.8768822020905797,
            0.3020297674022471,
        ],
        multipliers: &[],
    },
];
