//! Straight-line code for the values of some roots.

use std::collections::{HashMap, HashSet};
use std::ops::Range;

use crate::expr::{Cost, ExprId, Graph, Node, Unary};

/// Statements per scope: rustc's time and memory in debug builds grow faster than linearly with the `let`s of one.
const SCOPE_LENGTH: usize = 200;
/// Operations of an expression that is written in place: beyond it, a line is hard to read and slow to type-check.
const LARGEST_INLINE_EXPRESSION: usize = 12;

/// Straight-line code.
pub(crate) struct Program {
    /// The values asked for.
    pub(crate) outputs: Vec<ExprId>,
    /// Named intermediate values, in the order of computation.
    pub(crate) statements: Vec<Statement>,
    /// Runs of statements that share a scope; they cover all statements.
    pub(crate) scopes: Vec<Range<usize>>,
    /// Number of values that leave their scope.
    pub(crate) n_shared: usize,
    /// What it costs to run.
    pub(crate) operations: Operations,
    places: HashMap<ExprId, Place>,
}

/// One named value, or two from one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Statement {
    Value(ExprId),
    SineCosine { sine: ExprId, cosine: ExprId },
}

/// Where a named value is found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    /// Number of its name.
    pub(crate) name: usize,
    /// Index of its scope.
    pub(crate) scope: usize,
    /// Index among the values that leave their scope, if it does.
    pub(crate) shared: Option<usize>,
}

/// Operations by kind.
#[derive(Clone, Copy, Default, PartialEq, Eq, Debug)]
pub(crate) struct Operations {
    pub(crate) additions: usize,
    pub(crate) multiplications: usize,
    pub(crate) divisions: usize,
    pub(crate) functions: usize,
}

impl Program {
    /// The program that computes `outputs`; nodes at which `is_input` holds are given.
    pub(crate) fn new(graph: &Graph, outputs: Vec<ExprId>, is_input: impl Fn(ExprId) -> bool) -> Self {
        let computed: Vec<ExprId> =
            graph.reachable(&outputs, &is_input).into_iter().filter(|&id| !is_input(id)).collect();
        let named = named_nodes(graph, &outputs, &computed);
        let statements = pair_sines_with_cosines(graph, &computed, &named);
        let scopes: Vec<Range<usize>> = (0..statements.len())
            .step_by(SCOPE_LENGTH)
            .map(|start| start..statements.len().min(start + SCOPE_LENGTH))
            .collect();
        let mut program = Self {
            operations: Operations::of(graph, &computed),
            places: places(&statements),
            outputs,
            statements,
            scopes,
            n_shared: 0,
        };
        if program.scopes.len() > 1 {
            program.share_values_between_scopes(graph, &computed);
        }
        program.verify(graph);
        program
    }

    /// Where a node's value is found, if it has a name.
    pub(crate) fn place(&self, id: ExprId) -> Option<Place> {
        self.places.get(&id).copied()
    }

    /// Statements of the emitted body: named values, and values that are handed on between scopes.
    pub(crate) fn n_statements(&self) -> usize {
        self.statements.len() + self.n_shared
    }

    /// Named values that are not outputs.
    pub(crate) fn n_temporaries(&self) -> usize {
        let outputs: HashSet<ExprId> = self.outputs.iter().copied().collect();
        let names = self.statements.iter().flat_map(|statement| statement.values());
        names.filter(|id| !outputs.contains(id)).count()
    }

    /// Whether the program is a single scope, without values that leave it.
    pub(crate) fn is_single_scope(&self) -> bool {
        self.scopes.len() <= 1
    }

    /// Marks the named values that another scope reads, outputs among them.
    fn share_values_between_scopes(&mut self, graph: &Graph, computed: &[ExprId]) {
        let mut reader_scope: HashMap<ExprId, usize> = HashMap::new();
        let mut leaves_scope: Vec<ExprId> = Vec::new();
        // An inlined node is computed in the scope of the named node above it: visit users before operands.
        for &id in computed.iter().rev() {
            let scope = match self.places.get(&id) {
                Some(place) => place.scope,
                None => reader_scope[&id],
            };
            for operand in graph.operands(id) {
                reader_scope.insert(operand, scope);
                if self.places.get(&operand).is_some_and(|place| place.scope != scope) {
                    leaves_scope.push(operand);
                }
            }
        }
        leaves_scope.extend(self.outputs.iter().filter(|id| self.places.contains_key(id)));
        leaves_scope.sort_unstable();
        leaves_scope.dedup();
        self.n_shared = leaves_scope.len();
        for (index, id) in leaves_scope.into_iter().enumerate() {
            self.places.get_mut(&id).expect("only named values leave a scope").shared = Some(index);
        }
    }

    /// Checks in debug builds that values are computed before they are used, and found where they are used.
    fn verify(&self, graph: &Graph) {
        if !cfg!(debug_assertions) {
            return;
        }
        for (index, scope) in self.scopes.iter().enumerate() {
            assert!(scope.len() <= SCOPE_LENGTH, "scopes are bounded");
            for statement in &self.statements[scope.clone()] {
                for id in statement.values() {
                    let place = self.place(id).expect("a statement names its values");
                    assert_eq!(place.scope, index, "a value is named in its own scope");
                    for operand in self.named_operands(graph, id) {
                        let operand = self.place(operand).expect("named");
                        assert!(operand.name < place.name, "operands are computed first");
                        assert!(operand.scope == index || operand.shared.is_some(), "operands are in reach");
                    }
                }
            }
        }
    }

    /// The named values that the expression of `id` reads.
    fn named_operands(&self, graph: &Graph, id: ExprId) -> Vec<ExprId> {
        let roots: Vec<ExprId> = graph.operands(id).collect();
        let is_named = |id| self.places.contains_key(&id);
        graph.reachable(&roots, is_named).into_iter().filter(|&id| is_named(id)).collect()
    }
}

impl Statement {
    /// The values that it names.
    pub(crate) fn values(self) -> impl Iterator<Item = ExprId> {
        let (first, second) = match self {
            Self::Value(id) => (id, None),
            Self::SineCosine { sine, cosine } => (sine, Some(cosine)),
        };
        std::iter::once(first).chain(second)
    }
}

impl Operations {
    /// What the expression of `root` costs.
    pub(crate) fn below(graph: &Graph, root: ExprId) -> Self {
        Self::of(graph, &graph.reachable(&[root], |_| false))
    }

    /// All operations together.
    pub(crate) fn total(self) -> usize {
        self.additions + self.multiplications + self.divisions + self.functions
    }

    fn of(graph: &Graph, computed: &[ExprId]) -> Self {
        let mut operations = Self::default();
        for &id in computed {
            let cost = match graph.node(id) {
                Node::Number(_) | Node::Symbol(_) => Cost::Free,
                Node::Unary(operator, _) => operator.cost(),
                Node::Binary(operator, ..) => operator.cost(),
                Node::Power(..) => Cost::Function,
            };
            match cost {
                Cost::Free => {}
                Cost::Addition => operations.additions += 1,
                Cost::Multiplication => operations.multiplications += 1,
                Cost::Division => operations.divisions += 1,
                Cost::Function => operations.functions += 1,
            }
        }
        operations
    }
}

/// The nodes that get a name: outputs, nodes with several users, and nodes whose expression would be too long.
fn named_nodes(graph: &Graph, outputs: &[ExprId], computed: &[ExprId]) -> Vec<ExprId> {
    let mut n_users: HashMap<ExprId, usize> = HashMap::new();
    for operand in computed.iter().flat_map(|&id| graph.operands(id)) {
        *n_users.entry(operand).or_default() += 1;
    }
    // Outputs are named, hence 2: in a program of several scopes they must be found from outside.
    for &output in outputs {
        *n_users.entry(output).or_default() += 2;
    }
    let mut inline_size: HashMap<ExprId, usize> = HashMap::new();
    let mut named = Vec::new();
    for &id in computed {
        let size = 1 + graph
            .operands(id)
            .map(|operand| inline_size.get(&operand).copied().unwrap_or(0))
            .sum::<usize>();
        let is_named = n_users[&id] > 1 || size > LARGEST_INLINE_EXPRESSION || is_trigonometric(graph, id);
        if is_named {
            named.push(id);
        }
        inline_size.insert(id, if is_named { 0 } else { size });
    }
    named
}

fn is_trigonometric(graph: &Graph, id: ExprId) -> bool {
    matches!(graph.node(id), Node::Unary(Unary::Sin | Unary::Cos, _))
}

/// The statements for the named nodes; sine and cosine of the same angle become one.
fn pair_sines_with_cosines(graph: &Graph, computed: &[ExprId], named: &[ExprId]) -> Vec<Statement> {
    let angles = |function: Unary| -> HashMap<ExprId, ExprId> {
        let angle = |&id: &ExprId| match graph.node(id) {
            Node::Unary(operator, angle) if operator == function => Some((angle, id)),
            _ => None,
        };
        computed.iter().filter_map(angle).collect()
    };
    let (sines, cosines) = (angles(Unary::Sin), angles(Unary::Cos));
    let statement = |&id: &ExprId| match graph.node(id) {
        Node::Unary(Unary::Sin | Unary::Cos, angle) => match (sines.get(&angle), cosines.get(&angle)) {
            // At the place of whichever comes first.
            (Some(&sine), Some(&cosine)) => {
                (id == sine.min(cosine)).then_some(Statement::SineCosine { sine, cosine })
            }
            _ => Some(Statement::Value(id)),
        },
        _ => Some(Statement::Value(id)),
    };
    named.iter().filter_map(statement).collect()
}

fn places(statements: &[Statement]) -> HashMap<ExprId, Place> {
    let mut places = HashMap::new();
    for (index, statement) in statements.iter().enumerate() {
        for id in statement.values() {
            let name = places.len();
            places.insert(id, Place { name, scope: index / SCOPE_LENGTH, shared: None });
        }
    }
    places
}
