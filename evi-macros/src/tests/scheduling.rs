//! Programs, run statement by statement as the emitted code would be, against the graph.

use std::collections::HashMap;

use super::random_expressions::{large_system, random_system};
use super::systems::SMALL_SYSTEMS;
use super::workbench::{Compiled, Point, compiled};
use crate::expr::evaluate::evaluate;
use crate::expr::{ExprId, Graph, Node, Symbol};
use crate::schedule::{Operations, Program, Programs, Statement};

/// Statements that may stand in one scope.
const LARGEST_SCOPE: usize = 200;

/// Runs a program: names live in their scope, and only what is shared outlives it.
struct Machine<'a> {
    graph: &'a Graph,
    program: &'a Program,
    /// The values that the function is given.
    input: &'a dyn Fn(ExprId) -> Option<f64>,
    scope: usize,
    names: HashMap<usize, f64>,
    shared: Vec<Option<f64>>,
}

impl Machine<'_> {
    fn run(mut self) -> Vec<f64> {
        for (scope, statements) in self.program.scopes.iter().enumerate() {
            self.scope = scope;
            self.names.clear();
            for &statement in &self.program.statements[statements.clone()] {
                self.execute(statement);
            }
        }
        // Outputs stand behind the only scope, or outside of all of them.
        if !self.program.is_single_scope() {
            self.scope = self.program.scopes.len();
            self.names.clear();
        }
        self.program.outputs.iter().map(|&output| self.operand(output)).collect()
    }

    fn execute(&mut self, statement: Statement) {
        let values: Vec<(ExprId, f64)> = statement.values().map(|id| (id, self.expression(id))).collect();
        for (id, value) in values {
            let place = self.program.place(id).expect("a statement names its values");
            assert_eq!(place.scope, self.scope, "a value is named in its own scope");
            assert!(self.names.insert(place.name, value).is_none(), "a name is given once");
            if let Some(index) = place.shared {
                assert!(self.shared[index].replace(value).is_none(), "a value is shared once");
            }
        }
    }

    fn operand(&self, id: ExprId) -> f64 {
        if let Some(value) = (self.input)(id) {
            return value;
        }
        match self.program.place(id) {
            Some(place) if place.scope == self.scope => self.names[&place.name],
            Some(place) => {
                let index = place.shared.expect("a value that is read in another scope is shared");
                self.shared[index].expect("a value is computed before it is read")
            }
            None => self.expression(id),
        }
    }

    /// The value of a node from its operands' values, by the interpreter.
    fn expression(&self, id: ExprId) -> f64 {
        let mut scratch = Graph::default();
        let mut values = Vec::new();
        let mut operand = |id| {
            values.push(self.operand(id));
            scratch.symbol(Symbol::Coordinate(values.len() - 1))
        };
        let root = match self.graph.node(id) {
            Node::Number(number) => return number.value(),
            Node::Symbol(_) => return (self.input)(id).expect("a symbol is given"),
            Node::Unary(operator, x) => {
                let x = operand(x);
                scratch.unary(operator, x)
            }
            Node::Power(base, exponent) => {
                let base = operand(base);
                scratch.power(base, exponent)
            }
            Node::Binary(operator, a, b) => {
                let (a, b) = (operand(a), operand(b));
                scratch.binary(operator, a, b)
            }
        };
        let value = |symbol| match symbol {
            Symbol::Coordinate(index) => values[index],
            _ => unreachable!("operands are numbered"),
        };
        evaluate(&scratch, &[root], value)[0]
    }
}

fn run(graph: &Graph, program: &Program, input: &dyn Fn(ExprId) -> Option<f64>) -> Vec<f64> {
    let shared = vec![None; program.n_shared];
    Machine { graph, program, input, scope: 0, names: HashMap::new(), shared }.run()
}

fn kernels(programs: &Programs) -> [(&'static str, &Program); 6] {
    [
        ("lagrangian", &programs.lagrangian),
        ("lagrangian_gradient", &programs.lagrangian_gradient),
        ("lagrangian_derivatives", &programs.lagrangian_derivatives),
        ("constraints", &programs.constraints),
        ("constraint_slopes", &programs.constraint_slopes),
        ("constraint_curvature", &programs.constraint_curvature),
    ]
}

/// Runs every program of a system and compares with the graph; bit for bit, since the operations are the same
/// ones.
#[track_caller]
fn check(source: &str) -> Compiled {
    let compiled = compiled(source);
    let Compiled { graph, programs, .. } = &compiled;
    let point = Point::new(11);
    let symbol = |id: ExprId| match graph.node(id) {
        Node::Symbol(symbol) => Some(symbol),
        _ => None,
    };
    let parameter = |id: ExprId| {
        assert!(graph.is_constant(id), "the constants depend on parameters alone");
        symbol(id).map(|symbol| point.value(symbol)).or_else(|| graph.as_number(id))
    };
    let constants = run(graph, &programs.constants, &parameter);
    compare("constants", graph, &programs.constants, &constants, &point);
    assert_eq!(constants.len(), programs.slots.len());
    // What a kernel is given: the constants, positions, velocities and time; no parameter by itself.
    let given = |id: ExprId| match (programs.slots.get(id), symbol(id)) {
        (Some(slot), _) => Some(constants[slot]),
        (None, Some(Symbol::Parameter(field))) => panic!("field {field} is read beside the constants"),
        (None, Some(symbol)) => Some(point.value(symbol)),
        (None, None) => graph.as_number(id),
    };
    for (name, program) in kernels(programs) {
        compare(name, graph, program, &run(graph, program, &given), &point);
    }
    for (name, program) in kernels(programs).into_iter().chain([("constants", &programs.constants)]) {
        check_scopes(name, program);
    }
    compiled
}

#[track_caller]
fn compare(name: &str, graph: &Graph, program: &Program, values: &[f64], point: &Point) {
    for (&output, value) in program.outputs.iter().zip(values) {
        let reference = point.evaluate(graph, output);
        assert!(reference.is_finite(), "{name}: the reference is {reference}");
        assert_eq!(value.to_bits(), reference.to_bits(), "{name}: {value:e} instead of {reference:e}");
    }
    assert_eq!(values.len(), program.outputs.len(), "{name}");
}

#[track_caller]
fn check_scopes(name: &str, program: &Program) {
    let mut covered = 0;
    for scope in &program.scopes {
        assert_eq!(scope.start, covered, "{name}: scopes cover the statements in order");
        assert!(scope.len() <= LARGEST_SCOPE, "{name}: a scope has {} statements", scope.len());
        covered = scope.end;
    }
    assert_eq!(covered, program.statements.len(), "{name}");
}

#[test]
fn small_systems() {
    for source in SMALL_SYSTEMS {
        check(source);
    }
}

#[test]
fn random_systems() {
    for seed in 0..60 {
        check(&random_system("Random", seed));
    }
}

#[test]
fn system_of_many_scopes() {
    let Compiled { programs, .. } = check(&large_system("Large", 800));
    let n_statements = programs.lagrangian_derivatives.statements.len();
    assert!(n_statements > 5000, "{n_statements} statements are not many");
    assert!(programs.constants.scopes.len() > 1, "the constants fill several scopes, too");
}

/// The scope's bound itself: with 200 statements one scope, with one more two.
#[test]
fn scopes_split_at_their_bound() {
    /// A system whose constants are `n` square roots and `m`; each is an output and gets a name.
    fn n_scopes(n: usize) -> (usize, usize) {
        let roots: Vec<String> = (0..n).map(|k| format!("(m + {k}.5).sqrt() * x.powi({})", k + 17)).collect();
        let source = format!(
            "#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = {})]
            struct Roots {{ m: f64 }}",
            roots.join(" + ")
        );
        let compiled = compiled(&source);
        (compiled.programs.constants.statements.len(), compiled.programs.constants.scopes.len())
    }
    let (n_statements, n) = n_scopes(10);
    assert_eq!(n, 1);
    let n_per_root = (n_scopes(11).0 - n_statements) as f64;
    let n_fitting = 10 + ((LARGEST_SCOPE - n_statements) as f64 / n_per_root) as usize;
    assert_eq!(n_scopes(n_fitting).1, 1);
    assert_eq!(n_scopes(n_fitting + 1).1, 2);
}

#[test]
fn sine_and_cosine_of_one_angle_are_one_statement() {
    let Compiled { programs, .. } = compiled(
        "#[evi(coordinates(x), kinetic = 0.5 * der(x).powi(2), potential = (2.0 * x).sin() * a)]
        struct S { a: f64 }",
    );
    let pairs = |program: &Program| {
        program
            .statements
            .iter()
            .filter(|statement| matches!(statement, Statement::SineCosine { .. }))
            .count()
    };
    assert_eq!(pairs(&programs.lagrangian), 0, "there is no cosine");
    assert_eq!(pairs(&programs.lagrangian_derivatives), 1);
}

#[test]
fn operations_are_counted_by_kind() {
    let Compiled { programs, .. } = compiled(
        "#[evi(
            coordinates(x),
            lagrangian = der(x) * der(x) + x.sin() / (x + a) - x.atan2(x + 1.0) + x.abs() + x.powi(17),
        )]
        struct Counted { a: f64 }",
    );
    let expected = Operations { additions: 6, multiplications: 1, divisions: 1, functions: 3 };
    assert_eq!(programs.lagrangian.operations, expected);
}
