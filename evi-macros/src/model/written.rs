//! The equations as the user wrote them, as text.
//!
//! In: a declaration without mistakes. Out: every energy, force, frequency and observed quantity, the shared subexpressions
//! that they use, and every constraint, in two notations. A graph of its own keeps the user's order of terms and factors.

use std::collections::HashMap;

use super::{Model, Named, coordinate_entries, resolve};
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
        // Elements of arrays are no symbols here.
        Symbol::Parameter(field) => declaration.fields[field].name.to_string(),
        Symbol::NamedConstant(index) => model.named_constants[index].to_string().replace(' ', ""),
        Symbol::Coordinate(entry) | Symbol::Velocity(entry) => {
            coordinate_entries(declaration)[entry].name.to_string()
        }
        Symbol::Time => "t".to_owned(),
        Symbol::Input(index) => model.inputs[index].to_string(),
        Symbol::Composite(_) => unreachable!("an expression of arrays is printed by what it is made of"),
        Symbol::Distance => unreachable!("no equation is written in distances"),
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
    let belonging_to = |letter: (&str, &str), named: &Named| {
        let left = Formula {
            unicode: format!("{}_{}", letter.0, print_name(&named.name, Notation::Unicode)),
            latex: format!("{}_{{{}}}", letter.1, print_name(&named.name, Notation::Latex)),
        };
        WrittenEquation { name: String::new(), left, right: expression(named.root) }
    };
    for (_, force) in &model.forces.generalized {
        equations.push(belonging_to(("f", "f"), force));
    }
    for (_, frequency) in &model.frequencies {
        equations.push(belonging_to(("ω", "\\omega"), frequency));
    }
    for observed in &model.observables {
        equations.push(definition(&observed.name, expression(observed.root)));
    }
    for definition_of in &model.lets {
        let Some(root) = definition_of.root else { continue };
        if shared.get(&root).is_some_and(|name| definition_of.name == name) {
            let right = Formula::new(|notation| print_definition(&graph, root, &names, notation));
            equations.push(definition(&definition_of.name.to_string(), right));
        }
    }
    for constraint in &model.constraints {
        let Node::Binary(Binary::Sub, left, right) = graph.node(constraint.root) else {
            unreachable!("the residual of a constraint is LHS − RHS");
        };
        let name = constraint.name.clone();
        equations.push(WrittenEquation { name, left: expression(left), right: expression(right) });
    }
    equations
}

/// The shared subexpressions that the equations use; what is only another name for a symbol or number is not
/// one.
fn shared_names(graph: &Graph, model: &Model) -> HashMap<ExprId, String> {
    let energies = model.energies.iter().map(|energy| energy.root);
    let roots: Vec<ExprId> = energies
        .chain(model.constraints.iter().map(|constraint| constraint.root))
        .chain(model.forces.dissipation.iter().map(|(_, root)| *root))
        .chain(model.forces.generalized.iter().map(|(_, force)| force.root))
        .chain(model.frequencies.iter().map(|(_, frequency)| frequency.root))
        .chain(model.observables.iter().map(|observed| observed.root))
        .collect();
    let used = graph.reachable_in_loops(&roots);
    let mut shared = HashMap::new();
    for definition in &model.lets {
        let Some(root) = definition.root else { continue };
        let is_expression = match graph.node(root) {
            Node::Symbol(Symbol::Composite(_)) => !graph.is_element(root),
            Node::Number(_) | Node::Symbol(_) => false,
            Node::Unary(..) | Node::Binary(..) | Node::Power(..) => true,
        };
        if is_expression && used.contains(&root) {
            shared.entry(root).or_insert_with(|| definition.name.to_string());
        }
    }
    shared
}
