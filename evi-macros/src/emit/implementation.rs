//! The implementation of `MechanicalSystem`.

use proc_macro2::TokenStream;
use quote::quote;

use super::elimination::elimination_type;
use super::forces;
use super::functions::Kernels;
use super::generic::generic_system;
use super::report::{report, source};
use super::storage::{Sizes, associated_types, dense_solvers};
use super::structure::structure;
use super::subject::Subject;
use super::{generic_graph, indices, patterns};
use crate::expr::Graph;
use crate::model::{Model, WrittenEquation};
use crate::schedule::Programs;
use crate::structure::{Elimination, Structure};
use crate::syntax::Declaration;

/// Everything that the derive emits for a well-formed struct.
pub(crate) fn implementation(
    declaration: &Declaration,
    model: &Model,
    graph: &Graph,
    programs: &Programs,
    written: &[WrittenEquation],
) -> TokenStream {
    let subject = Subject::of_declaration(declaration, model);
    let generic_system = match &model.source {
        Some(source) => generic_system(declaration, model, source),
        None => generic_graph::generic_system(&subject, model, graph),
    };
    let bounds = indices::bounds(&model.bounds);
    let others = quote!(#generic_system #bounds);
    mechanical_system(&subject, model, graph, programs, written, Solvers::Own, &others)
}

/// Which linear solvers a scene has.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Solvers {
    /// Eliminations for its own patterns.
    Own,
    /// Dense ones, which are compiled only where they are used.
    Dense,
}

/// The implementation of `MechanicalSystem` for a struct, with what else belongs to it.
pub(super) fn mechanical_system(
    subject: &Subject,
    model: &Model,
    graph: &Graph,
    programs: &Programs,
    written: &[WrittenEquation],
    solvers: Solvers,
    others: &TokenStream,
) -> TokenStream {
    let struct_name = &subject.name;
    let names = names(subject, model);
    let structure = structure(programs);
    let sizes = Sizes {
        n_coordinates: model.coordinates.len(),
        n_constraints: model.constraints.len(),
        n_parameters: model.parameters.len(),
        n_constants: programs.slots.len(),
        n_hessian_entries: programs.structure.hessian_entries.len(),
        n_jacobian_entries: programs.structure.jacobian_entries.len(),
        n_inputs: model.inputs.len(),
        n_observables: model.observables.len(),
        n_force_entries: programs.structure.force_entries.len(),
    };
    let types = associated_types(&sizes);
    let (solver_types, solvers) = match solvers {
        Solvers::Own => own_solvers(&sizes, &programs.structure),
        Solvers::Dense => (TokenStream::new(), dense_solvers(sizes.n_coordinates, sizes.n_constraints)),
    };
    let parameters = &subject.values;
    let kernels = Kernels::new(graph, model, &programs.slots);
    let frequencies = forces::frequencies(struct_name, &kernels, programs);
    let optional = [
        programs.forces.as_ref().map(|forces| kernels.forces(forces)),
        programs.observables.as_ref().map(|observables| kernels.observables(observables)),
        programs.central_force.as_ref().map(|central| kernels.central_force(central)),
    ];
    let kernels = [
        kernels.constants(&programs.constants),
        kernels.lagrangian(&programs.lagrangian),
        kernels.lagrangian_gradient(&programs.lagrangian_gradient),
        kernels.lagrangian_derivatives(&programs.lagrangian_derivatives),
        kernels.constraints(&programs.constraints),
        kernels.constraint_slopes(&programs.constraint_slopes),
        kernels.constraint_curvature(&programs.constraint_curvature),
    ];
    let kernels: TokenStream = kernels.into_iter().chain(optional.into_iter().flatten()).collect();
    let loops = patterns::loops(&programs.structure);
    let system = |report: TokenStream| {
        quote! {
            const _: () = {
                #solver_types

                #[automatically_derived]
                #[allow(unused_variables, unused_parens, trivial_numeric_casts, clippy::all)]
                impl ::evi_core::__private::MechanicalSystem for #struct_name {
                    #names
                    #structure
                    #report
                    #types
                    #solvers

                    #[inline]
                    fn parameters(&self) -> Self::PerParameter<f64> {
                        [#(#parameters),*]
                    }

                    #kernels
                    #loops
                }

                #frequencies
                #others
            };
        }
    };
    let source = source(|| system(TokenStream::new()));
    let report = report(&struct_name.to_string(), written, programs);
    system(quote!(#report #source))
}

/// The scene's own eliminations, as types and as the associated types that name them.
fn own_solvers(sizes: &Sizes, structure: &Structure) -> (TokenStream, TokenStream) {
    let (n, m) = (sizes.n_coordinates, sizes.n_constraints);
    let (kkt_type, kkt) = solver("KktElimination", n + m, structure.kkt_elimination(n, m));
    let (mass_type, mass) = solver("MassElimination", n, structure.mass_elimination(n));
    let (gram_type, gram) = solver("GramElimination", m, structure.gram_elimination(m));
    let associated = quote! {
        type KktFactors = #kkt;
        type MassFactors = #mass;
        type GramFactors = #gram;
    };
    (quote!(#kkt_type #mass_type #gram_type), associated)
}

/// The type that solves systems of one pattern, and its definition if it is the scene's own.
fn solver(name: &str, dimension: usize, elimination: Option<Elimination>) -> (TokenStream, TokenStream) {
    /// Beyond so many multiplications straight-line code is larger than its gain; loops solve densely.
    const LARGEST_UNROLLED: usize = 1500;
    let name = quote::format_ident!("{name}");
    match (dimension, elimination) {
        (0..=2, _) => {
            let closed_form = quote::format_ident!("Inverse{dimension}");
            (TokenStream::new(), quote!(::evi_core::__private::#closed_form))
        }
        (_, Some(elimination)) if elimination.cost() <= LARGEST_UNROLLED => {
            let guarded = quote!(::evi_core::__private::Guarded<#name, #dimension>);
            (elimination_type(&name, &elimination), guarded)
        }
        _ => (TokenStream::new(), quote!(::evi_core::__private::DenseLu<#dimension>)),
    }
}

/// The names of coordinates, constraints and parameters.
fn names(subject: &Subject, model: &Model) -> TokenStream {
    let coordinates = &model.coordinates;
    let constraints = model.constraints.iter().map(|constraint| &constraint.name);
    let parameters = &subject.parameters;
    let optional = forces::names(model);
    quote! {
        const COORDINATES: &'static [&'static str] = &[#(#coordinates),*];
        const CONSTRAINTS: &'static [&'static str] = &[#(#constraints),*];
        const PARAMETERS: &'static [&'static str] = &[#(#parameters),*];
        #optional
    }
}
