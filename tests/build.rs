//! Writes the systems that `kernels/` checks: one per operator of the grammar, 200 random ones, a large
//! one; and those that `fuzz/` steps.
//!
//! Out: `kernel_scenes.rs` in `OUT_DIR`, with every struct and the function `scenes` that lists them; `random_scenes.rs` with structs and the
//! function `case` that steps one of them.

use std::fmt::Write;
use std::path::Path;

#[path = "random_expressions/mod.rs"]
mod random_expressions;

/// Number of random systems; their seeds begin at 0.
const N_RANDOM: u64 = 200;
/// Number of random systems that are stepped: every one is compiled with every kind of scheme.
const N_STEPPED: u64 = 8;
/// Terms of the large system's Lagrangian: enough for several thousand statements.
const N_LARGE_TERMS: usize = 150;

/// Argument of an operator's function: in (−0.9, 0.9) for the test's points, coupled in all variables.
const ARGUMENT: &str = "0.2 * x * y + 0.1 * a * der(x) * y + 0.1 * b * der(y) * t";

/// An operator of the grammar, applied to `u`, the argument above, and to `w`, another one between 0.2 and
/// 2.5.
const OPERATORS: &[(&str, &str)] = &[
    ("Add", "u + w"),
    ("Sub", "u - w"),
    ("Mul", "u * w"),
    ("Div", "u / w"),
    ("DivByParameter", "u / a - w / 3"),
    ("Neg", "-u * -w"),
    ("PowiZero", "u.powi(0) * w"),
    ("PowiOne", "u.powi(1)"),
    ("PowiTwo", "u.powi(2)"),
    ("PowiThree", "u.powi(3)"),
    ("PowiSixteen", "u.powi(16)"),
    ("PowiSeventeen", "w.powi(17)"),
    ("PowiMinusOne", "w.powi(-1)"),
    ("PowiMinusThree", "w.powi((-3))"),
    ("PowiMinusTwenty", "(1.0 + w).powi(-20)"),
    ("PowfHalf", "w.powf(0.5)"),
    ("PowfInteger", "w.powf(3.0)"),
    ("PowfNumber", "w.powf(1.7)"),
    ("PowfParameter", "w.powf(a)"),
    ("PowfVariable", "w.powf(u)"),
    ("PowfOfParameter", "b.powf(u)"),
    ("Sqrt", "w.sqrt()"),
    ("Sin", "u.sin()"),
    ("Cos", "u.cos()"),
    ("SinCos", "u.sin() * u.cos()"),
    ("Tan", "u.tan()"),
    ("Exp", "u.exp()"),
    ("Ln", "w.ln()"),
    ("Asin", "u.asin()"),
    ("Acos", "u.acos()"),
    ("Atan", "u.atan()"),
    ("Atan2Right", "u.atan2(w)"),
    ("Atan2Above", "w.atan2(u)"),
    ("Atan2Left", "w.atan2(u - 3.0)"),
    ("Atan2Below", "(u - 3.0).atan2(w - 4.0)"),
    ("Sinh", "u.sinh()"),
    ("Cosh", "u.cosh()"),
    ("Tanh", "u.tanh()"),
    ("AbsOfPositive", "w.abs() * u"),
    ("AbsOfNegative", "(u - 3.0).abs() * u"),
    ("Block", "{ let s = u * w; let w = s.sin(); w * s } + { let s = w; s * u }"),
    ("BlockFirst", "{ let s = u; s * s } * w"),
    ("Constants", "PI * u + std::f64::consts::E * w + core::f64::consts::LN_2 * RATIO * u * w"),
    ("ParametersOnly", "(a * b).sin() * u + (a / b).sqrt() * w + a.powf(b)"),
];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=random_expressions");
    let operators: Vec<(String, String)> =
        OPERATORS.iter().map(|&(name, value)| (name.to_owned(), operator_system(name, value))).collect();
    let random: Vec<(String, String)> = (0..N_RANDOM)
        .map(|seed| (format!("Random{seed}"), seed))
        .map(|(name, seed)| (name.clone(), random_expressions::random_system(&name, seed)))
        .collect();
    let large = [("Large".to_owned(), random_expressions::large_system("Large", N_LARGE_TERMS))];
    let mut text = String::new();
    write_systems(&mut text, "operator", "dyn OtherScalars", &operators);
    write_systems(&mut text, "random", "dyn System", &random);
    write_systems(&mut text, "large", "dyn OverDoubles", &large);
    let directory = std::env::var("OUT_DIR").expect("cargo sets OUT_DIR");
    let write = |name: &str, text: String| {
        std::fs::write(Path::new(&directory).join(name), text).expect("OUT_DIR can be written");
    };
    write("kernel_scenes.rs", text);
    write("random_scenes.rs", stepped_systems());
}

/// The systems that are stepped, and a function that steps one of them from a random start.
fn stepped_systems() -> String {
    let mut text = String::new();
    let mut arms = String::new();
    for seed in 0..N_STEPPED {
        let name = format!("Stepped{seed}");
        let system = random_expressions::stepped_system(&name, seed);
        writeln!(text, "/// Written by build.rs.\n{system}\n").expect("a string takes all text");
        writeln!(
            arms,
            "        {seed} => {{
            let start = (t, Array::from_fn(|_| number(choices)), Array::from_fn(|_| number(choices)));
            steps_of(&{name} {{ a: parameter(choices), b: parameter(choices) }}, start, choices)
        }}"
        )
        .expect("a string takes all text");
    }
    write!(
        text,
        "pub(super) fn case(choices: &mut Choices) -> Result<Outcome, String> {{
    let t = if choices.once_in(8) {{ number(choices) }} else {{ 0.0 }};
    match choices.below({N_STEPPED}) {{
{arms}        other => unreachable!(\"{{other}}\"),
    }}
}}\n"
    )
    .expect("a string takes all text");
    text
}

/// The structs, and a function that lists their scenes.
fn write_systems(text: &mut String, kind: &str, pointee: &str, systems: &[(String, String)]) {
    let mut list = String::new();
    for (name, system) in systems {
        writeln!(text, "/// Written by build.rs.\n{system}\n").expect("a string takes all text");
        writeln!(list, "        Scene {{ name: \"{name}\", system: Box::new({name} {{ a: A, b: B }}) }},")
            .expect("a string takes all text");
    }
    let n_systems = systems.len();
    write!(
        text,
        "pub(super) fn {kind}_scenes() -> [Scene<{pointee}>; {n_systems}] {{\n    [\n{list}    ]\n}}\n"
    )
    .expect("a string takes all text");
}

/// A struct whose Lagrangian, constraint, dissipation, force and observed quantity contain the operator.
fn operator_system(name: &str, value: &str) -> String {
    let positions = ARGUMENT.replace("der(x)", "x").replace("der(y)", "t");
    format!(
        "#[derive(MechanicalSystem, Debug)]
        #[evi(
            coordinates(x, y),
            let u = {ARGUMENT},
            let w = 1.3 + u * (x + y).cos(),
            let all = {value} + 0.5 * a * der(x).powi(2) + 0.5 * b * der(y).powi(2),
            lagrangian = all,
            input(drive, brake),
            let power = drive * u - brake,
            dissipation = {value} * u + 0.25 * b * der(x).powi(4),
            force(y: drive * ({value}) - brake * der(x) * power),
            observe(first: brake * all),
            observe(second: drive * all),
            constraint(operator: {{
                let u = {positions};
                let w = 1.3 + u * (x + y).cos();
                ({value})
            }} == a * x),
        )]
        pub struct {name} {{ pub a: f64, pub b: f64 }}"
    )
}
