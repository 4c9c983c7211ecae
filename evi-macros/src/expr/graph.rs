//! A hash-consed expression graph: equal expressions are one node.
//!
//! Invariants: operands stand before the nodes that use them, so that ascending ids are a topological order;
//! commutative operands are ordered, except in a graph as written; numbers are finite.

use std::collections::HashMap;

use super::composite::Composite;
use super::operator::{Binary, Unary};

/// Index of a node.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
pub(crate) struct ExprId(u32);

/// An expression whose operands are nodes.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) enum Node {
    Number(Number),
    Symbol(Symbol),
    Unary(Unary, ExprId),
    Binary(Binary, ExprId, ExprId),
    /// Integer power.
    Power(ExprId, i32),
}

/// A finite number, equal to another when their bits are.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub(crate) struct Number(u64);

impl Number {
    pub(crate) fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// What an expression is made of besides numbers.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Debug)]
pub(crate) enum Symbol {
    /// Parameter, by its index in the model's table: a field of the struct, an element of a field, an index as a number.
    Parameter(usize),
    /// Named constant that rustc resolves, by its index in the model.
    NamedConstant(usize),
    /// Coordinate, by its index.
    Coordinate(usize),
    /// Time derivative of a coordinate, by its index.
    Velocity(usize),
    /// Time.
    Time,
    /// Input that the caller sets at every step, by its index.
    Input(usize),
    /// Expression of arrays that is no node, by its index in the graph's table.
    Composite(usize),
    /// The distance along which a central force acts, where it stands for the coordinates that it is made of.
    Distance,
}

/// The kinds of variables below a node.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct Dependence {
    pub(crate) on_q: bool,
    pub(crate) on_v: bool,
    pub(crate) on_t: bool,
    pub(crate) on_inputs: bool,
}

impl Dependence {
    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            on_q: self.on_q || other.on_q,
            on_v: self.on_v || other.on_v,
            on_t: self.on_t || other.on_t,
            on_inputs: self.on_inputs || other.on_inputs,
        }
    }

    /// Whether only numbers and parameters stand below.
    pub(crate) fn is_constant(self) -> bool {
        self == Self::default()
    }
}

/// The graph; it only grows.
#[derive(Default)]
pub(crate) struct Graph {
    nodes: Vec<Node>,
    dependences: Vec<Dependence>,
    // Looked up, never iterated: its order must not reach the output.
    ids: HashMap<Node, ExprId>,
    keeps_operand_order: bool,
    composites: Vec<(Composite, Dependence)>,
}

impl Graph {
    /// A graph whose commutative operands stay in the order of the source: for expressions that are printed.
    pub(crate) fn as_written() -> Self {
        Self { keeps_operand_order: true, ..Self::default() }
    }

    /// Whether it is a graph of expressions to be printed.
    pub(crate) fn is_as_written(&self) -> bool {
        self.keeps_operand_order
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.nodes.len()
    }

    pub(crate) fn node(&self, id: ExprId) -> Node {
        self.nodes[id.0 as usize]
    }

    pub(crate) fn dependence(&self, id: ExprId) -> Dependence {
        self.dependences[id.0 as usize]
    }

    /// Whether a node depends on numbers and parameters alone.
    pub(crate) fn is_constant(&self, id: ExprId) -> bool {
        self.dependence(id).is_constant()
    }

    /// The value of a node that is a number.
    pub(crate) fn as_number(&self, id: ExprId) -> Option<f64> {
        match self.node(id) {
            Node::Number(number) => Some(number.value()),
            _ => None,
        }
    }

    /// The number node; −0 becomes 0, which it equals.
    ///
    /// Panics for a value that is not finite: callers fold numbers only where the result is.
    pub(crate) fn number(&mut self, value: f64) -> ExprId {
        assert!(value.is_finite(), "numbers in the graph are finite");
        self.insert(Node::Number(Number((value + 0.0).to_bits())))
    }

    pub(crate) fn symbol(&mut self, symbol: Symbol) -> ExprId {
        self.insert(Node::Symbol(symbol))
    }

    /// The symbol of an expression of arrays, which depends on what its operands do and on `own`.
    pub(crate) fn composite(&mut self, composite: Composite, own: Dependence) -> ExprId {
        let operands = composite.operands().into_iter();
        let dependence = operands.fold(own, |union, operand| union.union(self.dependence(operand)));
        // Sums stay apart, each at its place in the source.
        let is_sum = matches!(composite, Composite::Sum { .. });
        let known = self.composites.iter().position(|(known, _)| !is_sum && *known == composite);
        let index = known.unwrap_or_else(|| {
            self.composites.push((composite, dependence));
            self.composites.len() - 1
        });
        self.symbol(Symbol::Composite(index))
    }

    /// The expression of arrays that a symbol stands for.
    pub(crate) fn composite_at(&self, index: usize) -> &Composite {
        &self.composites[index].0
    }

    pub(crate) fn unary(&mut self, operator: Unary, operand: ExprId) -> ExprId {
        self.insert(Node::Unary(operator, operand))
    }

    pub(crate) fn binary(&mut self, operator: Binary, first: ExprId, second: ExprId) -> ExprId {
        let swap = operator.is_commutative() && second < first && !self.keeps_operand_order;
        let (first, second) = if swap { (second, first) } else { (first, second) };
        self.insert(Node::Binary(operator, first, second))
    }

    pub(crate) fn power(&mut self, base: ExprId, exponent: i32) -> ExprId {
        self.insert(Node::Power(base, exponent))
    }

    pub(crate) fn add(&mut self, first: ExprId, second: ExprId) -> ExprId {
        self.binary(Binary::Add, first, second)
    }

    pub(crate) fn sub(&mut self, first: ExprId, second: ExprId) -> ExprId {
        self.binary(Binary::Sub, first, second)
    }

    pub(crate) fn mul(&mut self, first: ExprId, second: ExprId) -> ExprId {
        self.binary(Binary::Mul, first, second)
    }

    pub(crate) fn div(&mut self, first: ExprId, second: ExprId) -> ExprId {
        self.binary(Binary::Div, first, second)
    }

    pub(crate) fn neg(&mut self, operand: ExprId) -> ExprId {
        self.unary(Unary::Neg, operand)
    }

    /// `1 / operand`.
    pub(crate) fn reciprocal(&mut self, operand: ExprId) -> ExprId {
        let one = self.number(1.0);
        self.div(one, operand)
    }

    /// The operands of a node.
    pub(crate) fn operands(&self, id: ExprId) -> impl Iterator<Item = ExprId> + use<> {
        let (first, second) = match self.node(id) {
            Node::Number(_) | Node::Symbol(_) => (None, None),
            Node::Unary(_, operand) | Node::Power(operand, _) => (Some(operand), None),
            Node::Binary(_, first, second) => (Some(first), Some(second)),
        };
        first.into_iter().chain(second)
    }

    /// The nodes below and including `roots`, operands first. Nodes at which `is_leaf` holds are included, what is
    /// below them is not.
    pub(crate) fn reachable(&self, roots: &[ExprId], is_leaf: impl Fn(ExprId) -> bool) -> Vec<ExprId> {
        let mut seen = std::collections::HashSet::new();
        let mut pending: Vec<ExprId> = roots.to_vec();
        while let Some(id) = pending.pop() {
            if seen.insert(id) && !is_leaf(id) {
                pending.extend(self.operands(id));
            }
        }
        let mut ids: Vec<ExprId> = seen.into_iter().collect();
        ids.sort_unstable();
        ids
    }

    /// The symbols below `roots`, in order.
    pub(crate) fn symbols(&self, roots: &[ExprId]) -> std::collections::BTreeSet<Symbol> {
        let symbol = |id| match self.node(id) {
            Node::Symbol(symbol) => Some(symbol),
            _ => None,
        };
        self.reachable(roots, |_| false).into_iter().filter_map(symbol).collect()
    }

    /// The nodes below and including `roots`, and those that expressions of arrays are made of.
    pub(crate) fn reachable_in_loops(&self, roots: &[ExprId]) -> std::collections::BTreeSet<ExprId> {
        let mut seen = std::collections::BTreeSet::new();
        let mut pending: Vec<ExprId> = roots.to_vec();
        while let Some(id) = pending.pop() {
            if seen.insert(id) {
                pending.extend(self.operands(id));
                if let Node::Symbol(Symbol::Composite(index)) = self.node(id) {
                    pending.extend(self.composites[index].0.operands());
                }
            }
        }
        seen
    }

    /// The symbols below `roots` and in the bodies of sums, in order.
    pub(crate) fn symbols_in_loops(&self, roots: &[ExprId]) -> std::collections::BTreeSet<Symbol> {
        let symbol = |id| match self.node(id) {
            Node::Symbol(symbol) => Some(symbol),
            _ => None,
        };
        self.reachable_in_loops(roots).into_iter().filter_map(symbol).collect()
    }

    /// Whether a node is an array or an element of one.
    pub(crate) fn is_element(&self, id: ExprId) -> bool {
        matches!(self.node(id), Node::Symbol(Symbol::Composite(index))
            if matches!(self.composites[index].0, Composite::Element { .. } | Composite::Index(_)))
    }

    /// Checks the invariants in debug builds.
    pub(crate) fn verify(&self) {
        if cfg!(debug_assertions) {
            for index in 0..self.nodes.len() {
                let id = ExprId(index as u32);
                assert!(self.operands(id).all(|operand| operand < id), "operands stand before their users");
                assert_eq!(self.ids.get(&self.node(id)), Some(&id), "equal expressions are one node");
            }
        }
    }

    fn insert(&mut self, node: Node) -> ExprId {
        if let Some(&id) = self.ids.get(&node) {
            return id;
        }
        let id = ExprId(u32::try_from(self.nodes.len()).expect("a graph has fewer than 2³² nodes"));
        let dependence = match node {
            Node::Symbol(Symbol::Coordinate(_) | Symbol::Distance) => {
                Dependence { on_q: true, ..Dependence::default() }
            }
            Node::Symbol(Symbol::Velocity(_)) => Dependence { on_v: true, ..Dependence::default() },
            Node::Symbol(Symbol::Time) => Dependence { on_t: true, ..Dependence::default() },
            Node::Symbol(Symbol::Input(_)) => Dependence { on_inputs: true, ..Dependence::default() },
            Node::Symbol(Symbol::Composite(index)) => self.composites[index].1,
            Node::Number(_) | Node::Symbol(_) => Dependence::default(),
            Node::Unary(_, operand) | Node::Power(operand, _) => self.dependence(operand),
            Node::Binary(_, first, second) => self.dependence(first).union(self.dependence(second)),
        };
        self.nodes.push(node);
        self.dependences.push(dependence);
        self.ids.insert(node, id);
        id
    }
}
