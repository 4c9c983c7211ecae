//! Random systems in the attribute grammar, as Rust source text.
//!
//! In: a seed. Out: text that is the same for the same seed, everywhere. Every operator of the grammar
//! occurs; arguments are guarded, so that expressions are defined and of moderate size wherever their
//! variables are below about 2.

pub(crate) mod splitmix;

use splitmix::SplitMix;

/// Forms of expressions. `U` stands for any expression, `B` for one in (−1.6, 1.6), `V` for a variable or a
/// number.
const FORMS: &[&str] = &[
    "U + U",
    "U - U",
    "U - U + V",
    "U * U",
    "V * U",
    "V * V / U.cosh()",
    "U / (1.5 + B * B)",
    "U / a",
    "-U",
    "V - -U",
    "B.powi(0)",
    "U.powi(1)",
    "V.powi(2)",
    "B.powi(3)",
    "B.powi(5)",
    "(2.0 + B).powi(-1)",
    "(2.0 + B).powi(-3)",
    "(0.5 * B).powi(18)",
    "(2.0 + B).powf(B)",
    "(2.0 + B).powf(a - b)",
    "(2.0 + B).powf(1.7)",
    "(2.0 + B).powf(0.5)",
    "(2.0 + B).powf(-2)",
    "(1.0 + U.powi(2)).sqrt()",
    "U.sin()",
    "U.cos()",
    "(0.6 * B).tan()",
    "B.exp()",
    "(2.0 + B).ln()",
    "(0.5 * U.sin()).asin()",
    "(0.5 * U.cos()).acos()",
    "U.atan()",
    "U.atan2(2.0 + B)",
    "(2.0 + B).atan2(U)",
    "B.sinh()",
    "B.cosh()",
    "U.tanh()",
    "U.abs()",
    "{ let s = U; SCOPE }",
];

/// What keeps an argument in (−1.6, 1.6).
const BOUNDED_FORMS: &[&str] = &["U.sin()", "U.cos()", "U.tanh()", "U.atan()", "(0.9 * U.sin())"];

/// Writes expressions from a stream of random numbers.
pub(crate) struct Generator {
    random: SplitMix,
}

impl Generator {
    pub(crate) fn new(seed: u64) -> Self {
        Self { random: SplitMix::new(seed) }
    }

    /// An expression of the variables and the parameters `a`, `b`, nested to `depth`.
    pub(crate) fn expression(&mut self, variables: &[&str], depth: u32) -> String {
        if depth == 0 { self.leaf(variables) } else { self.form(FORMS, variables, depth - 1) }
    }

    /// One of the forms, its placeholders filled with expressions nested to `depth`.
    fn form(&mut self, forms: &[&str], variables: &[&str], depth: u32) -> String {
        let form = forms[self.below(forms.len())];
        let mut text = String::new();
        let mut rest = form;
        while let Some(at) = rest.find(['U', 'B', 'V', 'S']) {
            text.push_str(&rest[..at]);
            let (filled, length) = match &rest[at..=at] {
                "U" => (self.expression(variables, depth), 1),
                "B" => (self.form(BOUNDED_FORMS, variables, depth.saturating_sub(1)), 1),
                "V" => (self.leaf(variables), 1),
                // The value of a block, which uses the name that the block has given, perhaps to hide an
                // outer one.
                _ => {
                    let with_local: Vec<&str> = variables.iter().chain(&["s"]).copied().collect();
                    (format!("s * {}", self.expression(&with_local, depth)), "SCOPE".len())
                }
            };
            text.push_str(&format!("({filled})"));
            rest = &rest[at + length..];
        }
        text + rest
    }

    /// A variable, more rarely a parameter or a number.
    fn leaf(&mut self, variables: &[&str]) -> String {
        match self.below(16) {
            0 => "a".to_owned(),
            1 => "b".to_owned(),
            2 => format!("{:.2}", self.random.between(0.3, 1.9)),
            3 => format!("{}", 1 + self.below(3)),
            _ => variables[self.below(variables.len())].to_owned(),
        }
    }

    fn below(&mut self, bound: usize) -> usize {
        self.random.between(0.0, bound as f64) as usize
    }
}

/// A struct `name` with a random Lagrangian and two random constraints in two coordinates.
pub(crate) fn random_system(name: &str, seed: u64) -> String {
    let mut generator = Generator::new(seed);
    let positions = ["x", "y", "t"];
    let shared = generator.expression(&positions, 2);
    let positions = ["x", "y", "t", "shared"];
    let variables = ["x", "y", "der(x)", "der(y)", "t", "shared"];
    let lagrangian = generator.expression(&variables, 3);
    let (first, second) = (generator.expression(&positions, 2), generator.expression(&positions, 2));
    format!(
        "#[derive(MechanicalSystem, Debug)]
        #[evi(
            coordinates(x, y),
            let shared = {shared},
            lagrangian = 0.5 * a * der(x).powi(2) + 0.5 * b * der(y).powi(2) + {lagrangian},
            constraint(first: {first} == x * y),
            constraint(second: x + b * y == {second}),
        )]
        pub struct {name} {{ pub a: f64, pub b: f64 }}"
    )
}

/// A struct `name` whose structure depends on the seed: two or three coordinates, a mass that is constant, coupled or varies, fewer constraints than
/// coordinates, time or none, and of every third seed forces, with an input, a dissipation and the time.
#[allow(dead_code, reason = "the tests of the compiler take no steps")]
pub(crate) fn stepped_system(name: &str, seed: u64) -> String {
    let mut generator = Generator::new(seed);
    let coordinates = ["x", "y", "z"];
    let n = 2 + generator.below(2);
    let with_time = |names: &[&'static str], has_time: bool| -> Vec<&'static str> {
        names.iter().chain(if has_time { &["t"][..] } else { &[] }).copied().collect()
    };
    let positions = with_time(&coordinates[..n], seed % 3 == 2);
    let masses = ["a", "b", "(a + b)"];
    let mut kinetic: Vec<String> =
        (0..n).map(|i| format!("0.5 * {} * der({}).powi(2)", masses[i], coordinates[i])).collect();
    match seed % 4 {
        1 => kinetic.push("0.3 * a * der(x) * der(y)".to_owned()),
        // At least half of the mass is left.
        2 => kinetic
            .push(format!("0.2 * a * ({}).sin() * der(x).powi(2)", generator.expression(&positions, 1))),
        3 => kinetic
            .push(format!("0.2 * b * ({}).cos() * der(x) * der(y)", generator.expression(&positions, 1))),
        _ => {}
    }
    let potential = generator.expression(&positions, 3);
    let constraints: String = (0..(seed as usize / 2) % n)
        .map(|c| {
            let side = generator.expression(&positions, 1);
            format!(
                "constraint(c{c}: {0} + 0.3 * {0}.powi(2) + 0.2 * ({side}).sin() == 0.1 * {1}),",
                coordinates[c],
                coordinates[n - 1]
            )
        })
        .collect();
    let forces = if seed % 3 == 1 {
        let velocities = ["der(x)", "der(y)"];
        let known: Vec<&str> = positions.iter().chain(&velocities).chain(&["t", "drive"]).copied().collect();
        format!(
            "dissipation = 0.5 * a * der(x).powi(2) * (1.0 + ({}).sin().powi(2)) + 0.1 * b * der(y).cosh(),
            input(drive),
            force(x: {}),
            force(y: drive * ({}).cos()),",
            generator.expression(&positions, 1),
            generator.expression(&known, 2),
            generator.expression(&positions, 1),
        )
    } else {
        String::new()
    };
    format!(
        "#[derive(MechanicalSystem, Clone, Debug)]
        #[evi(
            coordinates({names}),
            kinetic = {kinetic},
            potential = {potential},
            {constraints}
            {forces}
        )]
        pub struct {name} {{ pub a: f64, pub b: f64 }}",
        names = coordinates[..n].join(", "),
        kinetic = kinetic.join(" + "),
    )
}

/// A struct `name` in six coordinates whose kernels have thousands of statements: a Lagrangian of `n_terms`
/// products of sines and cosines, each with a factor of its own that depends on parameters, and a constraint
/// of as many.
pub(crate) fn large_system(name: &str, n_terms: usize) -> String {
    /// Terms per `let`: more than the generic copy holds in one piece.
    const TERMS_PER_SUM: usize = 120;
    let mut random = SplitMix::new(0);
    let mut number = move || format!("{:.3}", random.between(0.2, 1.5));
    let mut sums = |prefix: &str, last: &str| -> (String, String) {
        let mut lets = String::new();
        let names: Vec<String> =
            (0..n_terms.div_ceil(TERMS_PER_SUM)).map(|k| format!("{prefix}{k}")).collect();
        for (k, sum) in names.iter().enumerate() {
            let terms: Vec<String> = (k * TERMS_PER_SUM..n_terms.min((k + 1) * TERMS_PER_SUM))
                .map(|term| (1 + term % 6, 1 + (term / 6 + term + 1) % 6, 1 + (term / 36 + term + 2) % 6))
                .map(|(i, j, k)| {
                    let factor = format!("(a * {} + b).sqrt()", number());
                    let (sine, cosine) =
                        (format!("({} * x{i} + x{j})", number()), format!("({} * {last}{k})", number()));
                    format!("{factor} * {sine}.sin() * {cosine}.cos()")
                })
                .collect();
            lets.push_str(&format!("            let {sum} = {},\n", terms.join(" + ")));
        }
        (lets, names.join(" + "))
    };
    let (potential_lets, potential) = sums("potential", "x");
    let (residual_lets, residual) = sums("residual", "t + x");
    let kinetic: Vec<String> =
        (1..=6).map(|i| format!("0.5 * a * (1.0 + x{i} * x{i}) * der(x{i}).powi(2)")).collect();
    format!(
        "#[derive(MechanicalSystem, Debug)]
        #[evi(
            coordinates(x1, x2, x3, x4, x5, x6),\n{potential_lets}{residual_lets}
            kinetic = {kinetic},
            potential = {potential},
            constraint(sum: {residual} == b),
        )]
        pub struct {name} {{ pub a: f64, pub b: f64 }}",
        kinetic = kinetic.join(" + "),
    )
}
