//! How names, numbers and functions are written in each notation.

use crate::expr::Unary;

/// How formulas are written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Notation {
    Unicode,
    Latex,
}

/// The text of a name: Greek letters, and digits at its end as an index.
pub(crate) fn print_name(name: &str, notation: Notation) -> String {
    symbol(name, false, notation)
}

/// Numbers that are better known as fractions.
pub(super) const FRACTIONS: [(f64, &str, &str); 3] =
    [(0.5, "½", "\\frac{1}{2}"), (0.25, "¼", "\\frac{1}{4}"), (0.75, "¾", "\\frac{3}{4}")];

/// Whether a function is written by its name, which can carry an exponent.
pub(super) fn has_name(operator: Unary) -> bool {
    !matches!(operator, Unary::Neg | Unary::Sqrt | Unary::Abs | Unary::Exp)
}

/// Unicode and LaTeX.
pub(super) fn function_names(operator: Unary) -> (&'static str, &'static str) {
    match operator {
        Unary::Neg => ("−", "-"),
        Unary::Sqrt => ("√", "\\sqrt"),
        Unary::Sin => ("sin", "\\sin"),
        Unary::Cos => ("cos", "\\cos"),
        Unary::Tan => ("tan", "\\tan"),
        Unary::Exp => ("exp", "\\exp"),
        Unary::Ln => ("ln", "\\ln"),
        Unary::Asin => ("arcsin", "\\arcsin"),
        Unary::Acos => ("arccos", "\\arccos"),
        Unary::Atan => ("arctan", "\\arctan"),
        Unary::Sinh => ("sinh", "\\sinh"),
        Unary::Cosh => ("cosh", "\\cosh"),
        Unary::Tanh => ("tanh", "\\tanh"),
        Unary::Abs => ("abs", "\\operatorname{abs}"),
        Unary::Signum => ("sgn", "\\operatorname{sgn}"),
    }
}

/// Name, character, LaTeX.
const GREEK: [(&str, char, &str); 34] = [
    ("alpha", 'α', "\\alpha"),
    ("beta", 'β', "\\beta"),
    ("gamma", 'γ', "\\gamma"),
    ("delta", 'δ', "\\delta"),
    ("epsilon", 'ε', "\\varepsilon"),
    ("zeta", 'ζ', "\\zeta"),
    ("eta", 'η', "\\eta"),
    ("theta", 'θ', "\\theta"),
    ("iota", 'ι', "\\iota"),
    ("kappa", 'κ', "\\kappa"),
    ("lambda", 'λ', "\\lambda"),
    ("mu", 'μ', "\\mu"),
    ("nu", 'ν', "\\nu"),
    ("xi", 'ξ', "\\xi"),
    ("pi", 'π', "\\pi"),
    ("rho", 'ρ', "\\rho"),
    ("sigma", 'σ', "\\sigma"),
    ("tau", 'τ', "\\tau"),
    ("upsilon", 'υ', "\\upsilon"),
    ("phi", 'φ', "\\varphi"),
    ("chi", 'χ', "\\chi"),
    ("psi", 'ψ', "\\psi"),
    ("omega", 'ω', "\\omega"),
    ("PI", 'π', "\\pi"),
    ("Gamma", 'Γ', "\\Gamma"),
    ("Delta", 'Δ', "\\Delta"),
    ("Theta", 'Θ', "\\Theta"),
    ("Lambda", 'Λ', "\\Lambda"),
    ("Xi", 'Ξ', "\\Xi"),
    ("Sigma", 'Σ', "\\Sigma"),
    ("Phi", 'Φ', "\\Phi"),
    ("Psi", 'Ψ', "\\Psi"),
    ("Omega", 'Ω', "\\Omega"),
    ("Pi", 'Π', "\\Pi"),
];

/// A name, with a dot above it for a velocity.
pub(super) fn symbol(name: &str, has_dot: bool, notation: Notation) -> String {
    // The last segment of a path; a raw identifier without its mark.
    let name = name.rsplit("::").next().unwrap_or(name).trim();
    let name = name.strip_prefix("r#").unwrap_or(name);
    let (name, place) = name.strip_suffix(']').and_then(|name| name.split_once('[')).unwrap_or((name, ""));
    let (base, index) = base_and_index(name);
    let greek = GREEK.iter().find(|(greek, ..)| *greek == base);
    let is_long = greek.is_none() && base.chars().count() > 1;
    match notation {
        Notation::Unicode => {
            let base = greek.map_or_else(|| base.to_owned(), |(_, letter, _)| letter.to_string());
            let base = if has_dot { with_dot(&base) } else { base };
            let is_number = index.chars().all(|c| c.is_ascii_digit());
            let index = if is_number { index.chars().map(subscript).collect() } else { format!("_{index}") };
            base + &index + &place_in_text(place, !index.is_empty())
        }
        Notation::Latex => {
            let base = match greek {
                Some((.., command)) => (*command).to_owned(),
                None if is_long => format!("\\mathrm{{{}}}", base.replace('_', "\\_")),
                None => base.to_owned(),
            };
            let base = if has_dot { format!("\\dot{{{base}}}") } else { base };
            let place = place.replace(" ", "").replace('−', "-");
            match index.chars().count() {
                _ if !place.is_empty() && index.is_empty() => format!("{base}_{{{place}}}"),
                _ if !place.is_empty() => {
                    format!("{base}_{{\\mathrm{{{}}},{place}}}", index.replace('_', "\\_"))
                }
                0 => base,
                1 => format!("{base}_{index}"),
                _ if index.chars().all(|c| c.is_ascii_digit()) => format!("{base}_{{{index}}}"),
                _ => format!("{base}_{{\\mathrm{{{}}}}}", index.replace('_', "\\_")),
            }
        }
    }
}

/// The place of an element: below the line where Unicode has all of its characters there, in brackets otherwise.
fn place_in_text(place: &str, has_index: bool) -> String {
    if place.is_empty() {
        return String::new();
    }
    let below: Option<String> = place.chars().filter(|c| *c != ' ').map(character_below).collect();
    match below {
        Some(below) if !has_index => below,
        _ => format!("[{place}]"),
    }
}

/// A character of an index below the line.
fn character_below(c: char) -> Option<char> {
    const LETTERS: [(char, char); 12] = [
        ('i', 'ᵢ'),
        ('j', 'ⱼ'),
        ('k', 'ₖ'),
        ('l', 'ₗ'),
        ('m', 'ₘ'),
        ('n', 'ₙ'),
        ('r', 'ᵣ'),
        ('s', 'ₛ'),
        ('u', 'ᵤ'),
        ('v', 'ᵥ'),
        ('+', '₊'),
        ('−', '₋'),
    ];
    match c {
        '0'..='9' => Some(subscript(c)),
        _ => LETTERS.iter().find(|(letter, _)| *letter == c).map(|(_, below)| *below),
    }
}

/// `x1` is `x` with the index `1`, `m_rod` is `m` with the index `rod`.
fn base_and_index(name: &str) -> (&str, &str) {
    match name.split_once('_') {
        Some((base, index)) if !base.is_empty() && !index.is_empty() => (base, index),
        Some(_) => (name, ""),
        None => {
            let base = name.trim_end_matches(|c: char| c.is_ascii_digit());
            if base.is_empty() { (name, "") } else { name.split_at(base.len()) }
        }
    }
}

/// Letters that Unicode has with a dot above, for fonts that do not put one there.
const DOTTED: [(char, char); 20] = [
    ('a', 'ȧ'),
    ('b', 'ḃ'),
    ('c', 'ċ'),
    ('d', 'ḋ'),
    ('e', 'ė'),
    ('f', 'ḟ'),
    ('g', 'ġ'),
    ('h', 'ḣ'),
    ('m', 'ṁ'),
    ('n', 'ṅ'),
    ('o', 'ȯ'),
    ('p', 'ṗ'),
    ('r', 'ṙ'),
    ('s', 'ṡ'),
    ('t', 'ṫ'),
    ('w', 'ẇ'),
    ('x', 'ẋ'),
    ('y', 'ẏ'),
    ('z', 'ż'),
    ('X', 'Ẋ'),
];

fn with_dot(base: &str) -> String {
    let mut letters = base.chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) => match DOTTED.iter().find(|(plain, _)| *plain == letter) {
            Some((_, dotted)) => dotted.to_string(),
            None => format!("{letter}\u{307}"),
        },
        // A dot above a word would belong to one of its letters.
        _ => format!("{base}˙"),
    }
}

pub(super) fn superscript(digit: char) -> char {
    match digit {
        '-' => '⁻',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        _ => char::from_u32('⁰' as u32 + digit.to_digit(10).unwrap_or(0)).expect("superscripts are in a row"),
    }
}

fn subscript(digit: char) -> char {
    char::from_u32('₀' as u32 + digit.to_digit(10).unwrap_or(0)).expect("subscripts are in a row")
}
