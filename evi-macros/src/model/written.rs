//! The equations as the user wrote them, as text.
//!
//! In: a declaration without mistakes. Out: every energy, force, frequency and observed quantity, the shared subexpressions
//! that they use, and every constraint, in two notations. A graph of its own keeps the user's order of terms and factors.

use std::collections::HashMap;

use super::{Model, resolve};
use crate::diagnostics::Diagnostics;
use crate::expr::{
    Binary, ExprId, Graph, Names, Node, Notation, Symbol, print, print_definition, print_name,
};
use crate::syntax::Declaration;

/// `left = right`, with the name of a constraint.
pub(crate) struct WrittenEquation {
    pub(crate) name: String,
    pub(crate) left: Formula,
    pub(crate) right: Formula,
}

/// An expression in two notations.
pub(crate) struct Formula {
    pub(crate) unicode: String,
    pub(crate) latex: String,
}

impl Formula {
    fn new(text: impl Fn(Notation) -> String) -> Self {
        Self { unicode: text(Notation::Unicode), latex: text(Notation::Latex) }
    }
}

/// The equations in reading order: `L`, what it is made of, forces, frequencies, observed quantities, and the constraints by
/// name.
pub(crate) fn written(declaration: &Declaration) -> Vec<WrittenEquation> {
    let mut graph = Graph::as_written();
    let Some(model) = resolve(declaration, &mut graph, &mut Diagnostics::default()) else {
        return Vec::new();
    };
    let shared = shared_names(&graph, &model);
    let symbol = |symbol| match symbol {
        Symbol::Parameter(field) => declaration.fields[field].name.to_string(),
        Symbol::NamedConstant(index) => model.named_constants[index].to_string().replace(' ', ""),
        Symbol::Coordinate(index) | Symbol::Velocity(index) => model.coordinates[index].to_string(),
        Symbol::Time => "t".to_owned(),
        Symbol::Input(index) => model.inputs[index].to_string(),
    };
    let names = Names { symbol: &symbol, shared: &shared };
    let expression = |root| Formula::new(|notation| print(&graph, root, &names, notation));
    let definition = |name: &str, right| {
        let left = Formula::new(|notation| print_name(name, notation));
        WrittenEquation { name: String::new(), left, right }
    };

    let mut equations = Vec::new();
    if model.energies.len() > 1 {
        let difference = |notation| if notation == Notation::Unicode { "T − V" } else { "T - V" }.to_owned();
        equations.push(definition("L", Formula::new(difference)));
    }
    for energy in &model.energies {
        let letter = match energy.keyword.to_string().as_str() {
            "kinetic" => "T",
            "potential" => "V",
            _ => "L",
        };
        equations.push(definition(letter, expression(energy.root)));
    }
    if let Some((_, dissipation)) = model.forces.dissipation {
        equations.push(definition("D", expression(dissipation)));
    }
    let belonging_to = |letter: (&str, &str), coordinate: usize, root| {
        let name = model.coordinates[coordinate].to_string();
        let left = Formula {
            unicode: format!("{}_{}", letter.0, print_name(&name, Notation::Unicode)),
            latex: format!("{}_{{{}}}", letter.1, print_name(&name, Notation::Latex)),
        };
        WrittenEquation { name: String::new(), left, right: expression(root) }
    };
    for (coordinate, _, root) in &model.forces.generalized {
        equations.push(belonging_to(("f", "f"), *coordinate, *root));
    }
    for (coordinate, root) in &model.frequencies {
        equations.push(belonging_to(("ω", "\\omega"), *coordinate, *root));
    }
    for (name, root) in &model.observables {
        equations.push(definition(&name.to_string(), expression(*root)));
    }
    for definition_of in &model.source.lets {
        if shared.get(&definition_of.root).is_some_and(|name| definition_of.name == name) {
            let root = definition_of.root;
            let right = Formula::new(|notation| print_definition(&graph, root, &names, notation));
            equations.push(definition(&definition_of.name.to_string(), right));
        }
    }
    for (name, residual) in &model.constraints {
        let Node::Binary(Binary::Sub, left, right) = graph.node(*residual) else {
            unreachable!("the residual of a constraint is LHS − RHS");
        };
        let name = name.to_string();
        equations.push(WrittenEquation { name, left: expression(left), right: expression(right) });
    }
    equations
}

/// The shared subexpressions that the equations use; what is only another name for a symbol or number is not
/// one.
fn shared_names(graph: &Graph, model: &Model) -> HashMap<ExprId, String> {
    let energies = model.energies.iter().map(|energy| energy.root);
    let roots: Vec<ExprId> = energies
        .chain(model.constraints.iter().map(|(_, root)| *root))
        .chain(model.forces.dissipation.iter().map(|(_, root)| *root))
        .chain(model.forces.generalized.iter().map(|(_, _, root)| *root))
        .chain(model.frequencies.iter().map(|(_, root)| *root))
        .chain(model.observables.iter().map(|(_, root)| *root))
        .collect();
    let used = graph.reachable(&roots, |_| false);
    let mut shared = HashMap::new();
    for definition in &model.source.lets {
        let is_expression = !matches!(graph.node(definition.root), Node::Number(_) | Node::Symbol(_));
        if is_expression && used.binary_search(&definition.root).is_ok() {
            shared.entry(definition.root).or_insert_with(|| definition.name.to_string());
        }
    }
    shared
}
