//! The implementation of `MechanicalSystem`.

use proc_macro2::TokenStream;
use quote::quote;

use super::elimination::elimination_type;
use super::forces;
use super::generic::generic_system;
use super::kernel::Writer;
use super::report::{report, source};
use super::storage::{Sizes, associated_types, dense_solvers};
use super::subject::Subject;
use super::{generic_graph, indices, patterns};
use crate::expr::{Dependence, ExprId, Graph};
use crate::model::{Model, WrittenEquation};
use crate::schedule::{ConstantSlots, Operations, Program, Programs};
use crate::structure::{
    Block, ConstraintStructure, Elimination, Entry, EntryValue, MassShape, Potential, Structure,
};
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
    let kernels = Kernels { graph, model, slots: &programs.slots };
    let frequencies = forces::frequencies(struct_name, &kernels, programs);
    let optional = [
        programs.forces.as_ref().map(|forces| kernels.forces(forces)),
        programs.observables.as_ref().map(|observables| kernels.observables(observables)),
    ];
    let kernels = [
        kernels.constants(&programs.constants),
        kernels.lagrangian(&programs.lagrangian),
        kernels.lagrangian_gradient(&programs.lagrangian_gradient),
        kernels.lagrangian_derivatives(&programs.lagrangian_derivatives),
        kernels.constraints(&programs.constraints),
        kernels.constraint_derivatives(&programs.constraint_derivatives),
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

/// The structure and the operation counts.
fn structure(programs: &Programs) -> TokenStream {
    let known = &programs.structure;
    let (qq, vq) = (entries(&known.hessian_qq), entries(&known.hessian_vq));
    let (vv, vt) = (entries(&known.hessian_vv), entries(&known.hessian_vt));
    let (jacobian_q, jacobian_t) = (entries(&known.jacobian_q), entries(&known.jacobian_t));
    let classification = &known.classification;
    let (block_qq, block_vq) = (block(classification.qq), block(classification.vq));
    let (block_vv, block_vt) = (block(classification.vv), block(classification.vt));
    let (mass_shape, potential) =
        (mass_shape(classification.mass_shape), potential(classification.potential));
    let momentum_vanishes_at_rest = classification.momentum_vanishes_at_rest;
    let each_constraint = classification.each_constraint.iter().map(constraint_structure);
    let constraint_graph =
        classification.constraint_graph.iter().map(|(first, second)| quote!((#first, #second)));
    let (mass, lagrangian) = (dependence(known.mass), dependence(known.lagrangian));
    let constraint_dependence = dependence(known.constraints);
    let forces = forces::structure(programs);
    let constants = operations(programs.constants.operations);
    let lagrangian_operations = operations(programs.lagrangian.operations);
    let lagrangian_gradient = operations(programs.lagrangian_gradient.operations);
    let lagrangian_derivatives = operations(programs.lagrangian_derivatives.operations);
    let constraints = operations(programs.constraints.operations);
    let constraint_derivatives = operations(programs.constraint_derivatives.operations);
    let constraint_curvature = operations(programs.constraint_curvature.operations);
    quote! {
        const STRUCTURE: ::evi_core::__private::Structure = ::evi_core::__private::Structure {
            hessian: ::evi_core::__private::HessianPattern { qq: #qq, vq: #vq, vv: #vv, vt: #vt },
            jacobian: ::evi_core::__private::JacobianPattern { q: #jacobian_q, t: #jacobian_t },
            blocks: ::evi_core::__private::HessianBlocks {
                qq: #block_qq,
                vq: #block_vq,
                vv: #block_vv,
                vt: #block_vt,
            },
            mass: #mass,
            mass_shape: #mass_shape,
            potential: #potential,
            momentum_vanishes_at_rest: #momentum_vanishes_at_rest,
            lagrangian: #lagrangian,
            constraints: #constraint_dependence,
            each_constraint: &[#(#each_constraint),*],
            constraint_graph: &[#(#constraint_graph),*],
            forces: #forces,
            operations: ::evi_core::__private::KernelOperations {
                constants: #constants,
                lagrangian: #lagrangian_operations,
                lagrangian_gradient: #lagrangian_gradient,
                lagrangian_derivatives: #lagrangian_derivatives,
                constraints: #constraints,
                constraint_derivatives: #constraint_derivatives,
                constraint_curvature: #constraint_curvature,
            },
        };
    }
}

pub(super) fn entries(entries: &[Entry]) -> TokenStream {
    let entries = entries.iter().map(|&Entry { row, col, value }| {
        let value = match value {
            EntryValue::Constant(slot) => quote!(Constant(#slot)),
            EntryValue::Varying(index) => quote!(Varying(#index)),
        };
        quote!(::evi_core::__private::Entry { row: #row, col: #col, value: ::evi_core::__private::EntryValue::#value })
    });
    quote!(&[#(#entries),*])
}

pub(super) fn dependence(Dependence { on_q, on_v, on_t, .. }: Dependence) -> TokenStream {
    quote!(::evi_core::__private::Dependence { on_q: #on_q, on_v: #on_v, on_t: #on_t })
}

fn block(block: Block) -> TokenStream {
    let block = match block {
        Block::Zero => quote!(Zero),
        Block::Constant => quote!(Constant),
        Block::Varying(on) => {
            let on = dependence(on);
            quote!(Varying(#on))
        }
    };
    quote!(::evi_core::__private::Block::#block)
}

fn mass_shape(shape: MassShape) -> TokenStream {
    let shape = match shape {
        MassShape::Diagonal => quote!(Diagonal),
        MassShape::BlockDiagonal(blocks) => quote!(BlockDiagonal(#blocks)),
        MassShape::Full => quote!(Full),
    };
    quote!(::evi_core::__private::MassShape::#shape)
}

fn potential(potential: Potential) -> TokenStream {
    let potential = match potential {
        Potential::Zero => quote!(Zero),
        Potential::Affine => quote!(Affine),
        Potential::Quadratic => quote!(Quadratic),
        Potential::General => quote!(General),
        Potential::Inseparable => quote!(Inseparable),
    };
    quote!(::evi_core::__private::Potential::#potential)
}

fn constraint_structure(constraint: &ConstraintStructure) -> TokenStream {
    let ConstraintStructure { on_t, is_quadratic, .. } = *constraint;
    let gradient = block(constraint.gradient);
    let repeats = match constraint.repeats {
        Some(earlier) => quote!(::core::option::Option::Some(#earlier)),
        None => quote!(::core::option::Option::None),
    };
    quote!(::evi_core::__private::ConstraintStructure {
        gradient: #gradient,
        on_t: #on_t,
        is_quadratic: #is_quadratic,
        repeats: #repeats,
    })
}

pub(super) fn operations(operations: Operations) -> TokenStream {
    let Operations { additions, multiplications, divisions, functions } = operations;
    quote!(::evi_core::__private::Operations {
        additions: #additions,
        multiplications: #multiplications,
        divisions: #divisions,
        functions: #functions,
    })
}

/// The functions of the trait.
pub(super) struct Kernels<'a> {
    graph: &'a Graph,
    pub(super) model: &'a Model,
    slots: &'a ConstantSlots,
}

/// How a kernel asks to be inlined, and its body. A small one is inlined always, since code over vector lanes gets the instructions of the function
/// that it is inlined into, and counts eight times where the compiler decides; a large one over lanes is compiled in functions of its own.
pub(super) fn compiled(program: &Program, body: TokenStream) -> (TokenStream, TokenStream) {
    /// What the compiler inlines of code over `f64` by itself.
    const MOST_OPERATIONS: usize = 120;
    if program.operations.total() <= MOST_OPERATIONS {
        (quote!(#[inline(always)]), body)
    } else {
        (quote!(#[inline]), quote!(T::compiled_apart(#[inline(always)] || { #body })))
    }
}

impl Kernels<'_> {
    fn constants(&self, program: &Program) -> TokenStream {
        let n_parameters = self.model.parameters.len();
        let nothing_given = ConstantSlots::default();
        let writer = Writer {
            slots: &nothing_given,
            inputs: quote!(p: &[T; #n_parameters]),
            arguments: quote!(p),
            ..self.writer(false)
        };
        let (statements, outputs) = writer.body(program);
        quote! {
            #[inline]
            fn constants<T: ::evi_core::__private::Scalar>(p: &Self::PerParameter<T>) -> Self::PerConstant<T> {
                #statements
                [#(#outputs),*]
            }
        }
    }

    fn lagrangian(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(true).body(program);
        self.function("lagrangian", quote!(#[inline]), true, quote!(T), quote!(#statements #(#outputs)*))
    }

    fn lagrangian_gradient(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(true).body(program);
        let gradient = self.gradient(&outputs);
        let returned = quote!(::evi_core::__private::LagrangianGradient<Self, T>);
        let (inlining, body) = compiled(program, quote!(#statements #gradient));
        self.function("lagrangian_gradient", inlining, true, returned, body)
    }

    fn lagrangian_derivatives(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(true).body(program);
        let (gradient, entries) = outputs.split_at(2 * self.model.coordinates.len());
        let gradient = self.gradient(gradient);
        let returned = quote!((::evi_core::__private::LagrangianGradient<Self, T>, Self::PerHessianEntry<T>));
        let (inlining, body) = compiled(program, quote!(#statements (#gradient, [#(#entries),*])));
        self.function("lagrangian_derivatives", inlining, true, returned, body)
    }

    fn constraints(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(false).body(program);
        let returned = quote!(Self::PerConstraint<T>);
        let (inlining, body) = compiled(program, quote!(#statements [#(#outputs),*]));
        self.function("constraints", inlining, false, returned, body)
    }

    fn constraint_derivatives(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(false).body(program);
        let (residuals, entries) = outputs.split_at(self.model.constraints.len());
        let returned = quote!((Self::PerConstraint<T>, Self::PerJacobianEntry<T>));
        let (inlining, body) = compiled(program, quote!(#statements ([#(#residuals),*], [#(#entries),*])));
        self.function("constraint_derivatives", inlining, false, returned, body)
    }

    fn constraint_curvature(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(true).body(program);
        let returned = quote!(Self::PerConstraint<T>);
        self.function(
            "constraint_curvature",
            quote!(#[inline]),
            true,
            returned,
            quote!(#statements [#(#outputs),*]),
        )
    }

    /// A kernel of the constants `c`, the time `t`, positions `q` and, if it has them, velocities `v`.
    fn function(
        &self,
        name: &str,
        inlining: TokenStream,
        has_velocities: bool,
        returned: TokenStream,
        body: TokenStream,
    ) -> TokenStream {
        let name = quote::format_ident!("{name}");
        let velocities = has_velocities.then(|| quote!(v: &Self::PerCoordinate<T>));
        quote! {
            #inlining
            fn #name<T: ::evi_core::__private::Scalar>(
                c: &Self::PerConstant<T>,
                t: T,
                q: &Self::PerCoordinate<T>,
                #velocities
            ) -> #returned {
                #body
            }
        }
    }

    fn writer(&self, has_velocities: bool) -> Writer<'_> {
        let (n_constants, n_coordinates) = (self.slots.len(), self.model.coordinates.len());
        let velocities = has_velocities.then(|| (quote!(, v: &[T; #n_coordinates]), quote!(, v)));
        let (declared, passed) = velocities.unwrap_or_default();
        Writer {
            graph: self.graph,
            named_constants: &self.model.named_constants,
            parameters: &self.model.parameters,
            slots: self.slots,
            inputs: quote!(c: &[T; #n_constants], t: T, q: &[T; #n_coordinates] #declared),
            arguments: quote!(c, t, q #passed),
        }
    }

    /// A kernel that takes the inputs `u`, too.
    pub(super) fn function_with_inputs(
        &self,
        name: &str,
        inlining: TokenStream,
        returned: TokenStream,
        body: TokenStream,
    ) -> TokenStream {
        let name = quote::format_ident!("{name}");
        quote! {
            #inlining
            fn #name<T: ::evi_core::__private::Scalar>(
                c: &Self::PerConstant<T>,
                t: T,
                q: &Self::PerCoordinate<T>,
                v: &Self::PerCoordinate<T>,
                u: &Self::PerInput<T>,
            ) -> #returned {
                #body
            }
        }
    }

    pub(super) fn writer_with_inputs(&self) -> Writer<'_> {
        let n_inputs = self.model.inputs.len();
        let Writer { inputs, arguments, .. } = self.writer(true);
        Writer {
            inputs: quote!(#inputs, u: &[T; #n_inputs]),
            arguments: quote!(#arguments, u),
            ..self.writer(true)
        }
    }

    /// A value that the constants `c` hold, or a number.
    pub(super) fn constant(&self, id: ExprId) -> TokenStream {
        self.writer(true).input(id).expect("a constant is a number or has a slot")
    }

    fn gradient(&self, outputs: &[TokenStream]) -> TokenStream {
        let (force, momentum) = outputs.split_at(self.model.coordinates.len());
        quote! {
            ::evi_core::__private::LagrangianGradient { force: [#(#force),*], momentum: [#(#momentum),*] }
        }
    }
}
