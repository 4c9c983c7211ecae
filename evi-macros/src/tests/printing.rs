//! Formulas as text and LaTeX.

use proc_macro2::TokenStream;

use crate::diagnostics::Diagnostics;
use crate::model::written;
use crate::syntax;

/// The potential in both notations, in the coordinates `x`, `theta`, `x1`.
fn printed(potential: &str) -> [String; 2] {
    let input = format!(
        "#[evi(coordinates(x, theta, x1), kinetic = der(x) + der(theta) + der(x1),
         potential = {potential})]
         struct S {{ m: f64, l: f64, k0: f64, omega_max: f64 }}"
    );
    let tokens: TokenStream = input.parse().expect("tokens");
    let mut diagnostics = Diagnostics::default();
    let Ok(declaration) = syntax::parse(tokens, &mut diagnostics) else {
        panic!("{potential} is no item");
    };
    let equations = written(&declaration);
    let equation = equations.iter().find(|equation| equation.left.unicode == "V");
    let formula = &equation.unwrap_or_else(|| panic!("{potential} has mistakes")).right;
    [formula.unicode.clone(), formula.latex.clone()]
}

#[track_caller]
fn check(potential: &str, unicode: &str, latex: &str) {
    assert_eq!(printed(potential), [unicode, latex], "{potential}");
}

#[test]
fn names_have_greek_letters_indices_and_dots() {
    check("theta + x1 + k0 + m", "θ + x₁ + k₀ + m", "\\theta + x_1 + k_0 + m");
    check(
        "omega_max * der(theta) * der(x1)",
        "ω_max θ̇ ẋ₁",
        "\\omega_{\\mathrm{max}} \\dot{\\theta} \\dot{x}_1",
    );
    check("t * core::f64::consts::PI * BIG", "t π BIG", "t \\pi \\mathrm{BIG}");
}

#[test]
fn numbers_are_short() {
    check("0.5 * x", "½ x", "\\frac{1}{2} x");
    check("0.1 + 2.0 * x", "0.1 + 2 x", "0.1 + 2 x");
    check("1.5e-9 * x", "(1.5 · 10⁻⁹) x", "(1.5 \\cdot 10^{-9}) x");
    check("x * 2.0 * 3.0", "x · 2 · 3", "x \\cdot 2 \\cdot 3");
}

#[test]
fn parentheses_stand_where_they_are_needed() {
    check("(x + m) * l", "(x + m) l", "(x + m) l");
    check("x + (m + l)", "x + m + l", "x + m + l");
    check("x - (m + l)", "x − (m + l)", "x - (m + l)");
    check("x - (m - l)", "x − (m − l)", "x - (m - l)");
    check("-(m - l) * x", "−(m − l) x", "-(m - l) x");
    check("x * -m - -l", "−x m + l", "-x m + l");
    check("(-x).powi(2)", "(−x)²", "(-x)^2");
    check("(x * m).powi(3) + (x.powi(2)).powi(2)", "(x m)³ + (x²)²", "(x m)^3 + (x^2)^2");
}

#[test]
fn fractions_are_flat_in_text_and_built_up_in_latex() {
    check("m / x", "m/x", "\\frac{m}{x}");
    check("m / (x * l)", "m/(x l)", "\\frac{m}{x l}");
    check("m / x / l", "m/(x l)", "\\frac{m}{x l}");
    check("m / (x / l)", "m l/x", "\\frac{m l}{x}");
    check("0.5 * m * l / x", "½ m l/x", "\\frac{1}{2} \\frac{m l}{x}");
    check("1.0 / x.powi(2)", "1/x²", "\\frac{1}{x^2}");
    check("-(x + m) / (x - m)", "−(x + m)/(x − m)", "-\\frac{x + m}{x - m}");
    check("(m / x).powi(2)", "(m/x)²", "\\left(\\frac{m}{x}\\right)^2");
}

#[test]
fn functions_need_no_parentheses_around_a_name() {
    check("theta.cos()", "cos θ", "\\cos \\theta");
    check("theta.cos() * m", "m cos θ", "m \\cos \\theta");
    check("theta.cos() * x1.sin()", "cos θ sin x₁", "\\cos \\theta \\sin x_1");
    check("(2.0 * theta).sin() * m", "sin(2 θ) m", "\\sin(2 \\theta) m");
    check("theta.sin().powi(2)", "sin² θ", "\\sin^2 \\theta");
    check("theta.tan().powi(-1)", "(tan θ)⁻¹", "(\\tan \\theta)^{-1}");
    check("x.sqrt() * (x + m).sqrt()", "√x √(x + m)", "\\sqrt{x} \\sqrt{x + m}");
    check("x.sqrt().powi(2)", "(√x)²", "\\sqrt{x}^2");
    check("(-m * x).exp()", "exp(−m x)", "e^{-m x}");
    check("(x - l).abs()", "|x − l|", "\\left|x - l\\right|");
    check("x.powf(m + 1.0)", "x^(m + 1)", "x^{m + 1}");
    check("x.atan2(m - l)", "atan2(x, m − l)", "\\operatorname{atan2}(x, m - l)");
}

#[test]
fn shared_expressions_go_by_their_name() {
    check("{ let r = x + m; r * r }", "(x + m) (x + m)", "(x + m) (x + m)");
}

#[test]
fn a_long_expression_is_abbreviated() {
    let terms: Vec<String> = (0..300).map(|k| format!("{k}.5 * x")).collect();
    let [unicode, _] = printed(&terms.join(" + "));
    assert!(unicode.starts_with("½ x + 1.5 x + 2.5 x") && unicode.ends_with(" + …"), "{unicode}");
    // Sums that double twenty times have a million terms, each of which is a name in the graph.
    let doubled = (0..20).map(|k| format!("let r{} = r{k} + r{k} * x;", k + 1));
    let [unicode, latex] = printed(&format!("{{ let r0 = x; {} r20 }}", doubled.collect::<String>()));
    assert!(unicode.chars().count() < 4_000 && latex.len() < 4_000, "{unicode}");
}

/// The equations `left = right` of a scene in both notations, those of constraints with their names.
fn equations(source: &str) -> Vec<[String; 2]> {
    let mut diagnostics = Diagnostics::default();
    let Ok(declaration) = syntax::parse(source.parse().expect("tokens"), &mut diagnostics) else {
        panic!("{source} is no item");
    };
    let equation = |equation: crate::model::WrittenEquation| {
        let name = if equation.name.is_empty() { String::new() } else { format!("{}: ", equation.name) };
        let (left, right) = (equation.left, equation.right);
        [format!("{name}{} = {}", left.unicode, right.unicode), format!("{} = {}", left.latex, right.latex)]
    };
    written(&declaration).into_iter().map(equation).collect()
}

#[test]
fn sums_vectors_and_indices_are_printed_as_written() {
    let found = equations(
        "#[evi(coordinates(p: [3, 2], r: [3], x),
              let gap = p[2] - [x, 1.0],
              kinetic = sum(0..3, |k| 0.5 * m[k] * der(p[k]).norm_squared()) + der(r).dot(r.cross(b)) * x,
              potential = g * sum(0..3, |i| m[i] * p[i][1] * (i + 1)) + gap.norm(),
              constraint(link[i in 1..3]: (p[i] - p[i - 1]).norm_squared() == l.powi(2)),
              constraint(weld: r == b),
              force(p[i in 0..3][0]: sum(0..i, |j| p[j][0] - x)),
              observe(tip: p[2]))]
         struct S { m: [f64; 3], b: Vector3<f64>, g: f64, l: f64 }",
    );
    let expected = [
        ["L = T − V", "L = T - V"],
        [
            "T = Σ_{k=0}^{2} ½ mₖ |ṗₖ|² + (ṙ · (r × b)) x",
            "T = \\sum_{k=0}^{2} \\frac{1}{2} m_{k} \\left|\\dot{p}_{k}\\right|^2 + (\\dot{r} \\cdot (r \\times b)) x",
        ],
        [
            "V = g Σ_{i=0}^{2} mᵢ p[i, 1] (i + 1) + |gap|",
            "V = g \\sum_{i=0}^{2} m_{i} p_{i,1} (i + 1) + \\left|\\mathrm{gap}\\right|",
        ],
        ["f_p[i, 0] = Σ_{j=0}^{i−1} (p[j, 0] − x)", "f_{p_{i,0}} = \\sum_{j=0}^{i-1} (p_{j,0} - x)"],
        ["tip = p₂", "\\mathrm{tip} = p_{2}"],
        ["gap = p₂ − (x, 1)", "\\mathrm{gap} = p_{2} - (x, 1)"],
        ["link[i in 1..3]: |pᵢ − pᵢ₋₁|² = l²", "\\left|p_{i} - p_{i-1}\\right|^2 = l^2"],
        ["weld: r = b", "r = b"],
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_rigid_body_is_printed_as_its_energy() {
    let found = equations(
        "#[evi(rigid_body(b, mass = m, center = [0.0, 0.0, l], inertia = [j, j, k]), potential = m * g * b.point([0.0, 0.0, l])[2])]
         struct S { m: f64, l: f64, j: f64, k: f64, g: f64 }",
    );
    let printed = |index: usize| found[index][0].as_str();
    assert_eq!(
        printed(1),
        "T = ½ m |ḃ₀ + l ḃ₃|² + ¼ (j + k − j) |ḃ₁|² + ¼ (k + j − j) |ḃ₂|² + ¼ (j + j − k) |ḃ₃|²"
    );
    assert_eq!(printed(2), "V = m g (b₀ + 0 b₁ + 0 b₂ + l b₃)[2]");
    assert_eq!((printed(3), printed(6)), ("b_unit1: |b₁|² = 1", "b_right12: b₁ · b₂ = 0"));
}
