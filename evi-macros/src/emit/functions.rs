//! The functions of `MechanicalSystem`, each with its program as the body.

use proc_macro2::TokenStream;
use quote::quote;

use super::kernel::Writer;
use crate::expr::{ExprId, Graph};
use crate::model::Model;
use crate::schedule::{ConstantSlots, Program};

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

impl<'a> Kernels<'a> {
    pub(super) const fn new(graph: &'a Graph, model: &'a Model, slots: &'a ConstantSlots) -> Self {
        Self { graph, model, slots }
    }

    pub(super) fn constants(&self, program: &Program) -> TokenStream {
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

    pub(super) fn lagrangian(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(true).body(program);
        self.function("lagrangian", quote!(#[inline]), true, quote!(T), quote!(#statements #(#outputs)*))
    }

    pub(super) fn lagrangian_gradient(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(true).body(program);
        let gradient = self.gradient(&outputs);
        let returned = quote!(::evi_core::__private::LagrangianGradient<Self, T>);
        let (inlining, body) = compiled(program, quote!(#statements #gradient));
        self.function("lagrangian_gradient", inlining, true, returned, body)
    }

    pub(super) fn lagrangian_derivatives(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(true).body(program);
        let (gradient, entries) = outputs.split_at(2 * self.model.coordinates.len());
        let gradient = self.gradient(gradient);
        let returned = quote!((::evi_core::__private::LagrangianGradient<Self, T>, Self::PerHessianEntry<T>));
        let (inlining, body) = compiled(program, quote!(#statements (#gradient, [#(#entries),*])));
        self.function("lagrangian_derivatives", inlining, true, returned, body)
    }

    pub(super) fn constraints(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(false).body(program);
        let returned = quote!(Self::PerConstraint<T>);
        let (inlining, body) = compiled(program, quote!(#statements [#(#outputs),*]));
        self.function("constraints", inlining, false, returned, body)
    }

    pub(super) fn constraint_slopes(&self, program: &Program) -> TokenStream {
        let (statements, outputs) = self.writer(false).body(program);
        let (residuals, entries) = outputs.split_at(self.model.constraints.len());
        let returned = quote!((Self::PerConstraint<T>, Self::PerJacobianEntry<T>));
        let (inlining, body) = compiled(program, quote!(#statements ([#(#residuals),*], [#(#entries),*])));
        self.function("constraint_slopes", inlining, false, returned, body)
    }

    pub(super) fn constraint_curvature(&self, program: &Program) -> TokenStream {
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
        let n_coordinates = self.model.coordinates.len();
        let velocities = has_velocities.then(|| (quote!(, v: &[T; #n_coordinates]), quote!(, v)));
        let (declared, passed) = velocities.unwrap_or_default();
        let (q, q_passed) = self.positions();
        self.writer_of((quote!(t: T, #q #declared), quote!(t, #q_passed #passed)))
    }

    /// Positions as declared, and as passed on.
    pub(super) fn positions(&self) -> (TokenStream, TokenStream) {
        let n_coordinates = self.model.coordinates.len();
        (quote!(q: &[T; #n_coordinates]), quote!(q))
    }

    /// Writes programs over the constants `c` and inputs, as they are declared and as they are passed on.
    pub(super) fn writer_of(&self, (declared, passed): (TokenStream, TokenStream)) -> Writer<'_> {
        let n_constants = self.slots.len();
        Writer {
            graph: self.graph,
            named_constants: &self.model.named_constants,
            parameters: &self.model.parameters,
            slots: self.slots,
            inputs: quote!(c: &[T; #n_constants], #declared),
            arguments: quote!(c, #passed),
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
