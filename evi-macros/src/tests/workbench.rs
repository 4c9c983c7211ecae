//! What the tests of several stages need: text to graph, text to programs, points to evaluate at, and
//! closeness.

use num_dual::DualNum;

use super::random_expressions::Generator;
use super::random_expressions::splitmix::SplitMix;
use crate::diagnostics::Diagnostics;
use crate::expr::evaluate::evaluate;
use crate::expr::{Binary, ExprId, Graph, Node, Symbol};
use crate::mechanics::{self, Equations};
use crate::model::{self, Model};
use crate::schedule::{self, Programs};
use crate::{structure, syntax};

/// The symbols of [`expression`] that derivatives are taken by.
pub(super) const VARIABLES: [Symbol; 5] =
    [Symbol::Coordinate(0), Symbol::Coordinate(1), Symbol::Velocity(0), Symbol::Velocity(1), Symbol::Time];

/// The node of an expression in coordinates `x`, `y`, velocities, `t`, parameters `a`, `b` and constants.
#[track_caller]
pub(super) fn expression(graph: &mut Graph, text: &str) -> ExprId {
    // A difference keeps its operands in order, and this one gives both coordinates inertia.
    let source = format!(
        "#[evi(coordinates(x, y), lagrangian = ({text}) - der(x) * der(y))] struct Bench {{ a: f64, b: f64 }}"
    );
    let lagrangian = resolved(&source, graph).lagrangian;
    match graph.node(lagrangian) {
        Node::Binary(Binary::Sub, expression, _) => expression,
        other => panic!("expected the difference that was written, not {other:?}"),
    }
}

/// 200 random expressions over all of [`VARIABLES`], each in a graph of its own.
pub(super) fn random_expressions() -> impl Iterator<Item = (u64, Graph, ExprId)> {
    (0..200).map(|seed| {
        let text = Generator::new(seed).expression(&["x", "y", "der(x)", "der(y)", "t"], 3);
        let mut graph = Graph::default();
        let root = expression(&mut graph, &text);
        (seed, graph, root)
    })
}

/// Everything that the compiler knows about a struct.
pub(super) struct Compiled {
    pub(super) graph: Graph,
    pub(super) equations: Equations,
    pub(super) programs: Programs,
}

/// Runs the stages of `pipeline::expand` up to emission.
#[track_caller]
pub(super) fn compiled(source: &str) -> Compiled {
    let mut graph = Graph::default();
    let model = resolved(source, &mut graph);
    let mut equations = mechanics::differentiate_equations(&mut graph, &model);
    mechanics::find_central_force(&mut graph, &mut equations);
    let structure = structure::analyze(&graph, &equations);
    let programs = schedule::schedule(&graph, &equations, structure);
    graph.verify();
    Compiled { graph, equations, programs }
}

#[track_caller]
pub(super) fn resolved(source: &str, graph: &mut Graph) -> Model {
    let mut diagnostics = Diagnostics::default();
    let tokens = source.parse().expect("a test's struct is made of Rust tokens");
    let Ok(declaration) = syntax::parse(tokens, &mut diagnostics) else {
        panic!("a test's struct is a struct: {source}");
    };
    let model = model::resolve(&declaration, graph, &mut diagnostics);
    let mistakes: Vec<&str> = diagnostics.mistakes().iter().map(|mistake| mistake.message.as_str()).collect();
    assert!(mistakes.is_empty(), "{mistakes:?} in {source}");
    model.expect("a struct without mistakes has a model")
}

/// Values of symbols, all different, so that a swap shows.
pub(super) struct Point {
    values: [f64; 5],
    parameters: Vec<f64>,
}

impl Point {
    /// The point of a seed: within the domain of the random expressions.
    pub(super) fn new(seed: u64) -> Self {
        let mut random = SplitMix::new(seed ^ 0xbeef);
        Self {
            values: std::array::from_fn(|_| random.between(-1.5, 1.5)),
            parameters: (0..8).map(|_| random.between(0.4, 2.0)).collect(),
        }
    }

    /// The value of a symbol; coordinates beyond the second have values of their own.
    pub(super) fn value(&self, symbol: Symbol) -> f64 {
        let spread = |index: usize, first: usize| self.values[first + index % 2] + 0.17 * (index / 2) as f64;
        match symbol {
            Symbol::Parameter(index) => self.parameters[index],
            // The tests name no constant but π.
            Symbol::NamedConstant(_) => std::f64::consts::PI,
            Symbol::Coordinate(index) => spread(index, 0),
            Symbol::Velocity(index) => spread(index, 2),
            Symbol::Time => self.values[4],
            Symbol::Input(index) => -0.6 + 0.31 * index as f64,
            Symbol::Composite(_) => panic!("a loop has no value"),
            Symbol::Distance => 1.3,
        }
    }

    /// The value of a node.
    pub(super) fn evaluate(&self, graph: &Graph, root: ExprId) -> f64 {
        evaluate(graph, &[root], |symbol| self.value(symbol))[0]
    }

    /// The value of a node over dual numbers: `seed` says which part a symbol has besides its value.
    pub(super) fn evaluate_dual<D: DualNum<Primitive = f64> + Copy>(
        &self,
        graph: &Graph,
        root: ExprId,
        seed: impl Fn(Symbol, f64) -> D,
    ) -> D {
        evaluate(graph, &[root], |symbol| seed(symbol, self.value(symbol)))[0]
    }

    /// The largest value of all nodes below a root: what its terms' rounding is relative to.
    pub(super) fn largest_term(&self, graph: &Graph, root: ExprId) -> f64 {
        let nodes = graph.reachable(&[root], |_| false);
        let values: Vec<f64> = evaluate(graph, &nodes, |symbol| self.value(symbol));
        values.into_iter().fold(0.0, |largest, value| largest.max(value.abs()))
    }
}

/// Round-off of two evaluations of one expression in different orders, in units of the largest term's. Few of
/// the roundings are as large as that term's, and they have random signs: the largest sum seen is 1.6.
const ROUNDINGS: f64 = 16.0;

/// Whether two values of one quantity, whose largest term is `scale`, agree up to round-off.
pub(super) fn agree(value: f64, reference: f64, scale: f64) -> bool {
    // Infinite terms would make every comparison true.
    scale.is_finite() && (value - reference).abs() <= ROUNDINGS * f64::EPSILON * scale.max(1.0)
}
