//! Expressions as people write them: `½ m₁ ẋ₁²`, `\frac{1}{2} m_1 \dot{x}_1^2`.
//!
//! In: a node and the names of its symbols. Out: its text in one of two notations, a pure function of the
//! graph. Only what does not change the meaning is tidied: nested sums and products become flat, the signs of
//! factors move in front, functions without parentheses move to the end of their product. A long expression
//! is abbreviated by `…`.

mod arrays;
mod names;

use std::cell::Cell;
use std::collections::HashMap;

pub(crate) use names::{Notation, print_name};

use names::{FRACTIONS, function_names, has_name, superscript, symbol};

use super::{Binary, ExprId, Graph, Node, Symbol, Unary};

/// Nodes that are printed of one expression, about ten lines of text: what is beyond them is an ellipsis.
const LONGEST_EXPRESSION: usize = 400;
/// Levels of parentheses and functions that are printed: nobody reads deeper, and every level is a recursion.
const DEEPEST_EXPRESSION: usize = 30;

/// What symbols and shared expressions are called.
pub(crate) struct Names<'a> {
    /// The name of a symbol in the source; that of its coordinate for a velocity.
    pub(crate) symbol: &'a dyn Fn(Symbol) -> String,
    /// Nodes that are written as a name.
    pub(crate) shared: &'a HashMap<ExprId, String>,
}

/// The text of `root`.
pub(crate) fn print(graph: &Graph, root: ExprId, names: &Names<'_>, notation: Notation) -> String {
    Printer::new(graph, root, names, notation, None).sum(root).text
}

/// The text of what a shared expression stands for: its own name is not used.
pub(crate) fn print_definition(graph: &Graph, root: ExprId, names: &Names<'_>, notation: Notation) -> String {
    Printer::new(graph, root, names, notation, Some(root)).sum(root).text
}

/// How tightly an expression holds together.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Level {
    Sum,
    Product,
    /// A function before an argument without parentheses: `sin θ`.
    Function,
    Power,
    Atom,
}

struct Text {
    text: String,
    level: Level,
}

impl Text {
    fn atom(text: impl Into<String>) -> Self {
        Self { text: text.into(), level: Level::Atom }
    }
}

struct Printer<'a> {
    graph: &'a Graph,
    names: &'a Names<'a>,
    notation: Notation,
    /// The shared expression that is being defined.
    defined: Option<ExprId>,
    /// Nodes below each node, counted as often as they are printed.
    sizes: HashMap<ExprId, usize>,
    remaining: Cell<usize>,
    /// Levels above what is being printed.
    depth: Cell<usize>,
}

/// The factors of a product, without its sign.
#[derive(Default)]
struct Factors {
    is_negative: bool,
    above: Vec<ExprId>,
    below: Vec<ExprId>,
}

impl<'a> Printer<'a> {
    fn new(
        graph: &'a Graph,
        root: ExprId,
        names: &'a Names<'a>,
        notation: Notation,
        defined: Option<ExprId>,
    ) -> Self {
        let is_leaf = |id| names.shared.contains_key(&id) && defined != Some(id);
        let sizes = tree_sizes(graph, root, is_leaf);
        Self {
            graph,
            names,
            notation,
            defined,
            sizes,
            remaining: Cell::new(LONGEST_EXPRESSION),
            depth: Cell::new(0),
        }
    }

    fn is_latex(&self) -> bool {
        self.notation == Notation::Latex
    }

    /// Whether the node is printed as its own name, whatever is below it.
    fn shared(&self, id: ExprId) -> Option<&String> {
        self.names.shared.get(&id).filter(|_| self.defined != Some(id))
    }

    /// What the node is, unless it goes by a name.
    fn node(&self, id: ExprId) -> Option<Node> {
        self.shared(id).is_none().then(|| self.graph.node(id))
    }

    fn expression(&self, id: ExprId) -> Text {
        match self.shared(id) {
            Some(name) => {
                self.count_one();
                Text::atom(symbol(name, false, self.notation))
            }
            None if self.depth.get() == DEEPEST_EXPRESSION => Text::atom(self.ellipsis()),
            None if self.sizes[&id] > self.remaining.get() => {
                self.remaining.set(0);
                Text::atom(self.ellipsis())
            }
            None => {
                self.depth.set(self.depth.get() + 1);
                let text = self.nested(id);
                self.depth.set(self.depth.get() - 1);
                text
            }
        }
    }

    /// The text of a node that goes by no name, one level deeper.
    fn nested(&self, id: ExprId) -> Text {
        match self.graph.node(id) {
            Node::Number(number) => self.number(number.value()),
            Node::Symbol(Symbol::Composite(index)) => self.composite(self.graph.composite_at(index)),
            Node::Symbol(name) => self.symbol(name),
            Node::Binary(Binary::Add | Binary::Sub, ..) => self.sum(id),
            Node::Unary(Unary::Neg, _) | Node::Binary(Binary::Mul | Binary::Div, ..) => self.sum(id),
            Node::Unary(operator, x) => self.function(operator, x, None),
            Node::Power(base, exponent) => self.power(base, &exponent.to_string()),
            Node::Binary(Binary::Powf, a, b) => self.real_power(a, b),
            Node::Binary(Binary::Atan2, a, b) => {
                let (a, b) = (self.sum(a).text, self.sum(b).text);
                let name = if self.is_latex() { "\\operatorname{atan2}" } else { "atan2" };
                Text::atom(format!("{name}{}", self.parentheses(&format!("{a}, {b}"))))
            }
        }
    }

    fn ellipsis(&self) -> &'static str {
        if self.is_latex() { "\\dots" } else { "…" }
    }

    fn count_one(&self) {
        self.remaining.set(self.remaining.get().saturating_sub(1));
    }

    /// A sum with its terms side by side; a single term is a sum of one.
    fn sum(&self, id: ExprId) -> Text {
        let terms = self.terms(id);
        if let [(false, term)] = terms.as_slice() {
            return self.term(*term, false);
        }
        let mut text = String::new();
        for (position, &(is_negative, term)) in terms.iter().enumerate() {
            if self.remaining.get() == 0 {
                text += &format!(" + {}", self.ellipsis());
                break;
            }
            let factors = self.factors(term);
            let is_negative = is_negative != factors.is_negative;
            let minus = if self.is_latex() { "-" } else { "−" };
            match (position, is_negative) {
                (0, false) => {}
                (0, true) => text += minus,
                (_, false) => text += " + ",
                (_, true) => text += &format!(" {minus} "),
            }
            let printed = self.product(&factors);
            // A difference behind a minus, the only sum that stands among terms.
            text += &if printed.level == Level::Sum { self.parentheses(&printed.text) } else { printed.text };
        }
        Text { text, level: Level::Sum }
    }

    /// A term that is no sum, with its sign.
    fn term(&self, id: ExprId, is_negative: bool) -> Text {
        let factors = self.factors(id);
        let printed = self.product(&factors);
        if factors.is_negative == is_negative {
            return printed;
        }
        let minus = if self.is_latex() { "-" } else { "−" };
        Text { text: format!("{minus}{}", printed.text), level: Level::Sum }
    }

    /// The terms of nested sums, with the sign in front of each; `a − (b + c)` keeps its parentheses. No more
    /// than can be printed.
    fn terms(&self, id: ExprId) -> Vec<(bool, ExprId)> {
        let mut terms = Vec::new();
        let mut pending = vec![(false, id)];
        while let Some((is_negative, id)) = pending.pop() {
            match self.node(id) {
                Some(Node::Binary(Binary::Add, a, b)) if !is_negative => {
                    pending.extend([(false, b), (false, a)]);
                }
                Some(Node::Binary(Binary::Sub, a, b)) if !is_negative => {
                    pending.extend([(true, b), (false, a)]);
                }
                Some(Node::Unary(Unary::Neg, x)) => pending.push((!is_negative, x)),
                _ => terms.push((is_negative, id)),
            }
            if terms.len() > LONGEST_EXPRESSION {
                break;
            }
        }
        terms
    }

    /// The factors of nested products and quotients.
    fn factors(&self, id: ExprId) -> Factors {
        let mut factors = Factors::default();
        let mut pending = vec![(false, id)];
        while let Some((is_below, id)) = pending.pop() {
            match self.node(id) {
                Some(Node::Binary(Binary::Mul, a, b)) => pending.extend([(is_below, b), (is_below, a)]),
                Some(Node::Binary(Binary::Div, a, b)) => pending.extend([(!is_below, b), (is_below, a)]),
                Some(Node::Unary(Unary::Neg, x)) => {
                    factors.is_negative = !factors.is_negative;
                    pending.push((is_below, x));
                }
                _ if is_below => factors.below.push(id),
                _ => factors.above.push(id),
            }
            if factors.above.len() + factors.below.len() > LONGEST_EXPRESSION {
                break;
            }
        }
        factors
    }

    /// Factors side by side, as a fraction if some divide.
    fn product(&self, factors: &Factors) -> Text {
        match (factors.above.as_slice(), factors.below.as_slice()) {
            ([factor], []) if self.is_flat(*factor) => self.expression(*factor),
            ([factor], []) => self.sum(*factor),
            (above, []) => self.side_by_side(above),
            (above, below) => {
                let one = Text::atom("1");
                let below = self.side_by_side(below);
                if !self.is_latex() {
                    let above = if above.is_empty() { one } else { self.side_by_side(above) };
                    let above = self.at_least(Level::Product, above);
                    let text = format!("{above}/{}", self.at_least(Level::Power, below));
                    return Text { text, level: Level::Product };
                }
                // A number in front stays there.
                let (number, above) = match above {
                    [first, rest @ ..] if !rest.is_empty() && self.graph.as_number(*first).is_some() => {
                        (format!("{} ", self.expression(*first).text), rest)
                    }
                    all => (String::new(), all),
                };
                let above = if above.is_empty() { one } else { self.side_by_side(above) };
                let text = format!("{number}\\frac{{{}}}{{{}}}", above.text, below.text);
                Text { text, level: Level::Product }
            }
        }
    }

    /// Whether `expression` does not come back to sums or products.
    fn is_flat(&self, id: ExprId) -> bool {
        !matches!(self.node(id), Some(Node::Binary(Binary::Add | Binary::Sub, ..)))
    }

    fn side_by_side(&self, factors: &[ExprId]) -> Text {
        let is_alone = factors.len() == 1;
        let mut printed = Vec::new();
        for &factor in factors {
            printed.push(self.expression(factor));
            if self.remaining.get() == 0 {
                break;
            }
        }
        if is_alone {
            return printed.remove(0);
        }
        // `sin θ x` would be read as `sin (θ x)`.
        printed.sort_by_key(|factor| factor.level == Level::Function);
        let mut text = String::new();
        for factor in printed {
            let factor = self.at_least(Level::Function, factor);
            if !text.is_empty() {
                let begins_with_digit = factor.starts_with(|c: char| c.is_ascii_digit() || "½¼¾".contains(c));
                text += match (begins_with_digit, self.notation) {
                    (true, Notation::Unicode) => " · ",
                    (true, Notation::Latex) => " \\cdot ",
                    (false, _) => " ",
                };
            }
            text += &factor;
        }
        Text { text, level: Level::Product }
    }

    /// The text, in parentheses if it does not hold together well enough.
    fn at_least(&self, level: Level, printed: Text) -> String {
        if printed.level < level { self.parentheses(&printed.text) } else { printed.text }
    }

    fn parentheses(&self, text: &str) -> String {
        // Plain parentheses around what is no higher than a line.
        let is_high = ["\\frac", "\\sqrt"].iter().any(|high| text.contains(high));
        if self.is_latex() && is_high { format!("\\left({text}\\right)") } else { format!("({text})") }
    }

    fn power(&self, base: ExprId, exponent: &str) -> Text {
        let raised = match self.notation {
            Notation::Unicode => exponent.chars().map(superscript).collect(),
            Notation::Latex if exponent.chars().count() == 1 => format!("^{exponent}"),
            Notation::Latex => format!("^{{{exponent}}}"),
        };
        match self.node(base) {
            _ if exponent == "1" => self.expression(base),
            // The power of a function is written at its name; −1 would be read as the inverse function.
            Some(Node::Unary(operator, x)) if has_name(operator) && exponent != "-1" => {
                self.function(operator, x, Some(raised))
            }
            _ => {
                let base = self.expression(base);
                Text { text: self.at_least(Level::Atom, base) + &raised, level: Level::Power }
            }
        }
    }

    fn real_power(&self, base: ExprId, exponent: ExprId) -> Text {
        let base = self.expression(base);
        let base = self.at_least(Level::Atom, base);
        let exponent = self.sum(exponent);
        let text = match self.notation {
            Notation::Unicode => format!("{base}^{}", self.at_least(Level::Atom, exponent)),
            Notation::Latex => format!("{base}^{{{}}}", exponent.text),
        };
        Text { text, level: Level::Power }
    }

    fn function(&self, operator: Unary, x: ExprId, raised: Option<String>) -> Text {
        let argument = self.expression(x);
        match (operator, self.notation) {
            (Unary::Sqrt, Notation::Latex) => return Text::atom(format!("\\sqrt{{{}}}", argument.text)),
            (Unary::Sqrt, Notation::Unicode) => {
                let text = format!("√{}", self.at_least(Level::Atom, argument));
                return Text { text, level: Level::Power };
            }
            (Unary::Abs, Notation::Latex) => {
                return Text::atom(format!("\\left|{}\\right|", argument.text));
            }
            (Unary::Abs, Notation::Unicode) => return Text::atom(format!("|{}|", argument.text)),
            (Unary::Exp, Notation::Latex) => {
                return Text { text: format!("e^{{{}}}", argument.text), level: Level::Power };
            }
            _ => {}
        }
        let name = match self.notation {
            Notation::Unicode => function_names(operator).0,
            Notation::Latex => function_names(operator).1,
        };
        let (raised, level) = (raised.unwrap_or_default(), Level::Function);
        if argument.level == Level::Atom && operator != Unary::Exp {
            return Text { text: format!("{name}{raised} {}", argument.text), level };
        }
        // With its parentheses it ends where they do, and needs no place at the end.
        Text { text: format!("{name}{raised}{}", self.parentheses(&argument.text)), level: Level::Power }
    }

    fn number(&self, value: f64) -> Text {
        self.count_one();
        let fraction = FRACTIONS.iter().find(|(number, ..)| *number == value);
        match (fraction, self.notation) {
            (Some((_, text, _)), Notation::Unicode) => Text::atom(*text),
            (Some((.., text)), Notation::Latex) => Text { text: (*text).to_owned(), level: Level::Power },
            (None, _) if value == 0.0 || (1e-4..1e6).contains(&value.abs()) => {
                let level = if value < 0.0 { Level::Sum } else { Level::Atom };
                Text { text: value.to_string(), level }
            }
            (None, notation) => {
                let scientific = format!("{value:e}");
                let (digits, exponent) = scientific.split_once('e').expect("the format has an exponent");
                let text = match notation {
                    Notation::Unicode => {
                        format!("{digits} · 10{}", exponent.chars().map(superscript).collect::<String>())
                    }
                    Notation::Latex => format!("{digits} \\cdot 10^{{{exponent}}}"),
                };
                Text { text, level: Level::Product }
            }
        }
    }

    fn symbol(&self, name: Symbol) -> Text {
        self.count_one();
        let is_velocity = matches!(name, Symbol::Velocity(_));
        Text::atom(symbol(&(self.names.symbol)(name), is_velocity, self.notation))
    }
}

/// Nodes of the trees below `root`, as far as a `usize` counts.
fn tree_sizes(graph: &Graph, root: ExprId, is_leaf: impl Fn(ExprId) -> bool) -> HashMap<ExprId, usize> {
    let mut sizes: HashMap<ExprId, usize> = HashMap::new();
    // Operands stand before their users, and what expressions of arrays are made of before these.
    for id in graph.reachable_in_loops(&[root]) {
        if is_leaf(id) {
            sizes.insert(id, 1);
            continue;
        }
        let inside = match graph.node(id) {
            Node::Symbol(Symbol::Composite(index)) => graph.composite_at(index).operands(),
            _ => Vec::new(),
        };
        let below =
            graph.operands(id).chain(inside).map(|operand| sizes[&operand]).fold(0, usize::saturating_add);
        sizes.insert(id, below.saturating_add(1));
    }
    sizes
}
