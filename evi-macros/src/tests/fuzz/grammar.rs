//! Structs that are nearly right: the items of the grammar in any number, with expressions, names and numbers of every kind.

use super::super::random_choices::Choices;

/// Forms of expressions: `U` stands for an expression, `V` for a name or a number, `N` for a number, `P` for an exponent, `F` for a
/// function.
const FORMS: &[&str] = &[
    "V",
    "V * U",
    "U + U",
    "U - U",
    "U * U",
    "U / U",
    "(U)",
    "-U",
    "(U).powi(P)",
    "(U).F()",
    "(U).powf(U)",
    "(U).atan2(U)",
    "N * V + N",
    "{ let k = U; k * U }",
    "{ let k = U; let k = U; U }",
    "std::f64::consts::TAU",
    "std::f64::consts::PI",
    "der(V)",
    "MAX * U",
    "U == U",
    "U^P",
    "U = U",
    "V(U)",
    "U.V",
    "U as f64",
    "{ U; U }",
    "if U { U } else { U }",
    "[U, U]",
    "|V| U",
];
/// Those that an equation may have.
const LEGAL_FORMS: usize = 17;

const FUNCTIONS: &[&str] = &[
    "sin", "sqrt", "cos", "tan", "exp", "ln", "asin", "acos", "atan", "sinh", "cosh", "tanh", "abs", "sine",
    "signum", "norm",
];
const NUMBERS: &[&str] = &[
    "1.0",
    "0.0",
    "2",
    "0.5",
    "1e200",
    "1e-200",
    "1e308",
    "5e-324",
    "1e-999",
    "9007199254740993",
    "1_000.5",
    "3f64",
    "1e999",
    "2f32",
    "0x1F",
    "1u8",
    "99999999999999999999999999999999999999999999999999",
    "'c'",
    "\"text\"",
    "b\"bytes\"",
    "true",
];
/// Those that are a number for an equation.
const LEGAL_NUMBERS: usize = 12;
const EXPONENTS: &[&str] = &[
    "2",
    "0",
    "1",
    "3",
    "-1",
    "-2",
    "7",
    "64",
    "-16",
    "-(-3)",
    "2147483647",
    "-2147483647",
    "-2147483646",
    "-2147483648",
    "99999999999",
    "-99999999999",
    "2.0",
    "x",
    "0x10",
    "2i32",
    "2u64",
    "(1 + 1)",
];
/// Those that `.powi` takes.
const LEGAL_EXPONENTS: usize = 13;
/// Names that mean something else, or nothing.
const ODD_NAMES: &[&str] = &[
    "z", "u", "x", "a", "s0", "t", "r#fn", "r#x", "fn", "self", "Self", "_", "der", "let", "X", "q", "v",
    "c", "h", "__T", "Scalar", "f64", "Fuzzed", "core", "ẍ", "k", "unsafe", "crate", "'a",
];
const COORDINATES: [&str; 3] = ["x", "y", "θ"];

/// The source of a struct `Fuzzed`.
pub(super) fn structure(choices: &mut Choices) -> String {
    let is_legal = !choices.once_in(4);
    let n_coordinates = 1 + choices.below(COORDINATES.len());
    let mut grammar = Grammar { choices, is_legal, n_coordinates, n_lets: 0, items: Vec::new() };
    grammar.coordinates();
    for _ in 0..grammar.choices.below(4) {
        grammar.item();
    }
    grammar.lagrangian();
    for _ in 0..grammar.choices.below(4) {
        grammar.item();
    }
    let extra = if grammar.choices.once_in(8) { grammar.field() } else { String::new() };
    format!("#[evi({})] struct Fuzzed {{ a: f64, b: f64, {extra} }}", grammar.items.join(", "))
}

struct Grammar<'c> {
    choices: &'c mut Choices,
    /// Whether only what is right by itself is written; together it may still be wrong.
    is_legal: bool,
    n_coordinates: usize,
    /// The shared expressions `s0`, `s1`, .. so far.
    n_lets: usize,
    items: Vec<String>,
}

/// The variables of an expression.
#[derive(Clone, Copy, PartialEq)]
enum Of {
    Parameters,
    Positions,
    Velocities,
}

impl Grammar<'_> {
    fn coordinates(&mut self) {
        let names = COORDINATES[..self.n_coordinates].join(", ");
        let item = match self.choices.below(if self.is_legal { 1 } else { 8 }) {
            5 => "coordinates()".to_owned(),
            6 => format!("coordinates({}, {})", self.name(Of::Positions), self.name(Of::Positions)),
            7 => {
                format!("coordinates({}: {}, y)", self.name(Of::Positions), self.expression(Of::Positions, 1))
            }
            _ => format!("coordinates({names})"),
        };
        self.items.push(item);
    }

    /// An energy in which every coordinate moves.
    fn lagrangian(&mut self) {
        let squares = COORDINATES[..self.n_coordinates].iter().map(|name| format!("a * der({name}).powi(2)"));
        let inertia = squares.collect::<Vec<_>>().join(" + ");
        let item = match self.choices.below(if self.is_legal { 2 } else { 4 }) {
            0 => format!("lagrangian = {inertia} + {}", self.energy(Of::Velocities)),
            1 => {
                let more = self.expression(Of::Velocities, 2);
                format!("kinetic = {inertia} + {more}, potential = {}", self.energy(Of::Positions))
            }
            2 => format!("kinetic = {}", self.expression(Of::Velocities, 2)),
            _ => format!("lagrangian = {inertia}, potential = {}", self.expression(Of::Positions, 2)),
        };
        self.items.push(item);
    }

    fn energy(&mut self, of: Of) -> String {
        let depth = 1 + self.choices.below(3);
        self.expression(of, depth)
    }

    fn item(&mut self) {
        let fresh = self.items.len();
        let coordinate = COORDINATES[self.choices.below(self.n_coordinates)];
        let item = match self.choices.below(if self.is_legal { 7 } else { 13 }) {
            0 => {
                let value = self.expression(Of::Positions, 2);
                self.n_lets += 1;
                format!("let s{} = {value}", self.n_lets - 1)
            }
            1 => {
                // Something moves with the coordinates, unless it cancels.
                let (left, right) = (self.expression(Of::Positions, 2), self.expression(Of::Positions, 2));
                format!("constraint(c{fresh}: x + {left} == {right})")
            }
            2 => format!("observe(o{fresh}: {})", self.expression(Of::Velocities, 2)),
            3 => format!("force({coordinate}: {})", self.expression(Of::Velocities, 2)),
            4 => format!(
                "dissipation = der(x).powi({}) * {}",
                self.exponent(),
                self.expression(Of::Velocities, 1)
            ),
            5 => format!("frequency({coordinate}: {})", self.expression(Of::Parameters, 1)),
            6 => format!(
                "input(u{fresh}), observe(i{fresh}: u{fresh} * {})",
                self.expression(Of::Positions, 1)
            ),
            7 => format!("constraint({}: x == x)", self.name(Of::Positions)),
            8 => format!("let {} = {}", self.name(Of::Positions), self.expression(Of::Velocities, 1)),
            9 => format!("observe({}: x, {}: y)", self.name(Of::Positions), self.name(Of::Positions)),
            10 => format!("{} = {}", self.name(Of::Positions), self.expression(Of::Velocities, 1)),
            11 => format!("{}({})", self.name(Of::Positions), self.expression(Of::Velocities, 1)),
            _ => String::new(),
        };
        self.items.push(item);
    }

    fn field(&mut self) -> String {
        let ty = self.choices.pick(&["f64", "f32", "Vec<f64>", "[f64; 3]", "core::primitive::f64"]);
        let name = self.choices.pick(&["z", "w", "c", "h", "q", "r#fn", "ẍ", "__T", "t", "der", "x", "u"]);
        format!("{name}: {ty}")
    }

    fn expression(&mut self, of: Of, depth: usize) -> String {
        let forms = match (depth, self.is_legal) {
            (0, _) => &FORMS[..1],
            (_, true) => &FORMS[..LEGAL_FORMS],
            (_, false) => FORMS,
        };
        let form = self.choices.pick(forms);
        // Those of constants hold no placeholders.
        if form.contains("::") {
            return form.to_owned();
        }
        let mut text = String::new();
        for character in form.chars() {
            match character {
                'U' => text.push_str(&self.expression(of, depth - 1)),
                'V' => text.push_str(&self.leaf(of)),
                'N' => text.push_str(self.number()),
                'P' => text.push_str(self.exponent()),
                'F' => text.push_str(self.function()),
                other => text.push(other),
            }
        }
        text
    }

    fn leaf(&mut self, of: Of) -> String {
        match self.choices.below(8) {
            0..=4 => self.name(of),
            5 if of == Of::Velocities => {
                format!("der({})", COORDINATES[self.choices.below(self.n_coordinates)])
            }
            _ => self.number().to_owned(),
        }
    }

    fn name(&mut self, of: Of) -> String {
        if self.choices.once_in(if self.is_legal { 500 } else { 20 }) {
            return self.choices.pick(ODD_NAMES).to_owned();
        }
        let n_positions = if of == Of::Parameters { 0 } else { self.n_coordinates + self.n_lets + 1 };
        match self.choices.below(n_positions + 2) {
            index if index < self.n_coordinates.min(n_positions) => COORDINATES[index].to_owned(),
            index if index + 1 < n_positions => format!("s{}", index - self.n_coordinates),
            index if index < n_positions => "t".to_owned(),
            index => ["a", "b"][index - n_positions].to_owned(),
        }
    }

    fn number(&mut self) -> &'static str {
        self.choices.pick(if self.is_legal { &NUMBERS[..LEGAL_NUMBERS] } else { NUMBERS })
    }

    fn exponent(&mut self) -> &'static str {
        self.choices.pick(if self.is_legal { &EXPONENTS[..LEGAL_EXPONENTS] } else { EXPONENTS })
    }

    fn function(&mut self) -> &'static str {
        let legal = FUNCTIONS.len() - 3;
        self.choices.pick(if self.is_legal { &FUNCTIONS[..legal] } else { FUNCTIONS })
    }
}
