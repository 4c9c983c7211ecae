//! The generic copy of equations with vectors: the graph as the items built it, neither simplified nor differentiated, as programs.

use proc_macro2::TokenStream;
use quote::quote;

use super::kernel::Writer;
use super::subject::Subject;
use crate::expr::{ExprId, Graph, Node, Symbol};
use crate::model::Model;
use crate::schedule::{ConstantSlots, Program};

/// The implementation of `GenericSystem`.
pub(super) fn generic_system(subject: &Subject, model: &Model, graph: &Graph) -> TokenStream {
    let struct_name = &subject.name;
    let (n_coordinates, n_constraints) = (model.coordinates.len(), model.constraints.len());
    let copy = Copy { subject, model, graph };
    let lagrangian = copy.outputs(&[model.lagrangian], |outputs| quote!(#(#outputs)*));
    let residuals: Vec<ExprId> = model.constraints.iter().map(|constraint| constraint.root).collect();
    let constraints = copy.outputs(&residuals, |outputs| {
        let rows = 0..outputs.len();
        quote!(#(__residuals[#rows] = #outputs;)*)
    });
    let n_inputs = (!model.inputs.is_empty()).then(|| {
        let n_inputs = model.inputs.len();
        quote! {
            fn n_inputs(&self) -> usize {
                #n_inputs
            }
        }
    });
    let dissipation = model.forces.dissipation.as_ref().map(|(_, root)| {
        let body = copy.outputs(&[*root], |outputs| quote!(#(#outputs)*));
        quote! {
            const HAS_DISSIPATION: bool = true;

            fn dissipation<T: ::evi_core::__private::Scalar>(&self, t: T, q: &[T], v: &[T]) -> T {
                #body
            }
        }
    });
    let generalized = (!model.forces.generalized.is_empty()).then(|| {
        let places: Vec<usize> = model.forces.generalized.iter().map(|(coordinate, _)| *coordinate).collect();
        let roots: Vec<ExprId> = model.forces.generalized.iter().map(|(_, force)| force.root).collect();
        let body =
            copy.outputs(&roots, |outputs| quote!(#(__forces[#places] = __forces[#places] + #outputs;)*));
        quote! {
            const HAS_FORCES: bool = true;

            fn add_forces<T: ::evi_core::__private::Scalar>(
                &self,
                t: T,
                q: &[T],
                v: &[T],
                u: &[T],
                __forces: &mut [T],
            ) {
                #body
            }
        }
    });
    quote! {
        #[automatically_derived]
        #[allow(unused, trivial_numeric_casts, clippy::all)]
        impl ::evi_core::__private::GenericSystem for #struct_name {
            fn n_coordinates(&self) -> usize {
                #n_coordinates
            }

            fn n_constraints(&self) -> usize {
                #n_constraints
            }

            fn lagrangian<T: ::evi_core::__private::Scalar>(&self, t: T, q: &[T], v: &[T]) -> T {
                #lagrangian
            }

            fn constraints<T: ::evi_core::__private::Scalar>(&self, t: T, q: &[T], __residuals: &mut [T]) {
                let v = q;
                #constraints
            }

            #n_inputs
            #dissipation
            #generalized
        }
    }
}

struct Copy<'a> {
    subject: &'a Subject,
    model: &'a Model,
    graph: &'a Graph,
}

impl Copy<'_> {
    /// The statements of a program for `roots`, and what becomes of its outputs.
    fn outputs(&self, roots: &[ExprId], written: impl Fn(&[TokenStream]) -> TokenStream) -> TokenStream {
        let is_input = |id| match self.graph.node(id) {
            Node::Symbol(Symbol::NamedConstant(_)) => false,
            Node::Symbol(_) | Node::Number(_) => true,
            Node::Unary(..) | Node::Binary(..) | Node::Power(..) => false,
        };
        let program = Program::new(self.graph, roots.to_vec(), is_input);
        let n_parameters = self.model.parameters.len();
        let has_inputs = self.graph.symbols(roots).iter().any(|symbol| matches!(symbol, Symbol::Input(_)));
        let (declared, passed) = if has_inputs {
            (quote!(, u: &[T]), quote!(, u))
        } else {
            (TokenStream::new(), TokenStream::new())
        };
        let nothing_given = ConstantSlots::default();
        let writer = Writer {
            graph: self.graph,
            named_constants: &self.model.named_constants,
            parameters: &self.model.parameters,
            slots: &nothing_given,
            inputs: quote!(p: &[T; #n_parameters], t: T, q: &[T], v: &[T] #declared),
            arguments: quote!(p, t, q, v #passed),
        };
        let (statements, outputs) = writer.body(&program);
        let values = self.subject.values.iter().map(|value| quote!(T::from_f64(#value)));
        let outputs = written(&outputs);
        quote! {
            let p: &[T; #n_parameters] = &[#(#values),*];
            #statements
            #outputs
        }
    }
}
