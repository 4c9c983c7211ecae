//! A program as the body of a function.

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::{format_ident, quote};

use crate::expr::{Binary, ExprId, Graph, Node, Symbol, Unary};
use crate::model::Parameter;
use crate::schedule::{ConstantSlots, Place, Program, Statement};

/// Scopes per function: a scope has at most 200 `let`s and hands on at most 400 values (a sine with its cosine names
/// two), so that functions stay below 5,000 statements.
const SCOPES_PER_FUNCTION: usize = 8;

/// Writes programs over the inputs that are in scope where they are emitted.
pub(super) struct Writer<'a> {
    pub(super) graph: &'a Graph,
    pub(super) named_constants: &'a [TokenStream],
    /// The parameters, in the order of the input `p`.
    pub(super) parameters: &'a [Parameter],
    /// The nodes that the input `c` holds; empty for the program that computes them.
    pub(super) slots: &'a ConstantSlots,
    /// The inputs as declared in a function's head: `c: &[T; 3], t: T, ..`.
    pub(super) inputs: TokenStream,
    /// The inputs as passed on: `c, t, ..`.
    pub(super) arguments: TokenStream,
}

impl Writer<'_> {
    /// Statements, and the expressions of the outputs behind them.
    pub(super) fn body(&self, program: &Program) -> (TokenStream, Vec<TokenStream>) {
        let statements = if program.is_single_scope() {
            program.statements.iter().map(|&statement| self.statement(program, statement, 0)).collect()
        } else {
            self.scopes(program)
        };
        let outside = program.scopes.len();
        let scope = if program.is_single_scope() { 0 } else { outside };
        let outputs = program.outputs.iter().map(|&output| self.operand(program, output, scope)).collect();
        (statements, outputs)
    }

    /// Functions over runs of scopes, which hand values on in the array `shared`.
    fn scopes(&self, program: &Program) -> TokenStream {
        let n_shared = program.n_shared;
        let (inputs, arguments) = (&self.inputs, &self.arguments);
        let mut functions = TokenStream::new();
        let mut calls = TokenStream::new();
        let scope_indices: Vec<usize> = (0..program.scopes.len()).collect();
        for (part, scopes) in scope_indices.chunks(SCOPES_PER_FUNCTION).enumerate() {
            let name = format_ident!("part_{part}");
            let blocks = scopes.iter().map(|&scope| self.scope(program, scope));
            functions.extend(quote! {
                fn #name<T: ::evi_core::__private::Scalar>(#inputs, shared: &mut [T; #n_shared]) {
                    #(#blocks)*
                }
            });
            calls.extend(quote!(#name(#arguments, &mut shared);));
        }
        quote! {
            #functions
            let mut shared = [T::from_f64(0.0); #n_shared];
            #calls
        }
    }

    fn scope(&self, program: &Program, scope: usize) -> TokenStream {
        let statements = &program.statements[program.scopes[scope].clone()];
        let lines = statements.iter().map(|&statement| self.statement(program, statement, scope));
        let handed_on = statements.iter().flat_map(|statement| statement.values()).filter_map(|id| {
            let place = program.place(id)?;
            let (index, name) = (place.shared?, local(place));
            Some(quote!(shared[#index] = #name;))
        });
        quote!({ #(#lines)* #(#handed_on)* })
    }

    fn statement(&self, program: &Program, statement: Statement, scope: usize) -> TokenStream {
        let name = |id| local(program.place(id).expect("a statement names its values"));
        match statement {
            Statement::Value(id) => {
                let (name, value) = (name(id), self.expression(program, id, scope));
                quote!(let #name = #value;)
            }
            Statement::SineCosine { sine, cosine } => {
                let Node::Unary(_, angle) = self.graph.node(sine) else {
                    unreachable!("a sine is a unary operator");
                };
                let (sine, cosine, angle) = (name(sine), name(cosine), self.operand(program, angle, scope));
                quote!(let (#sine, #cosine) = #angle.sin_cos();)
            }
        }
    }

    /// A node as an operand: an input, a name, or its expression in parentheses.
    fn operand(&self, program: &Program, id: ExprId, scope: usize) -> TokenStream {
        if let Some(input) = self.input(id) {
            return input;
        }
        match program.place(id) {
            Some(place) if place.scope == scope => {
                let name = local(place);
                quote!(#name)
            }
            Some(place) => {
                let index = place.shared.expect("a value that is read in another scope is shared");
                quote!(shared[#index])
            }
            None => {
                let expression = self.expression(program, id, scope);
                quote!((#expression))
            }
        }
    }

    fn expression(&self, program: &Program, id: ExprId, scope: usize) -> TokenStream {
        let operand = |id| self.operand(program, id, scope);
        match self.graph.node(id) {
            Node::Number(_) | Node::Symbol(_) => self.input(id).expect("numbers and symbols are inputs"),
            Node::Unary(Unary::Neg, x) => {
                let x = operand(x);
                quote!(-#x)
            }
            Node::Unary(function, x) => {
                let (x, method) = (operand(x), identifier(function.method()));
                quote!(#x.#method())
            }
            Node::Power(base, exponent) => {
                let (base, exponent) = (operand(base), Literal::i32_unsuffixed(exponent));
                quote!(#base.powi(#exponent))
            }
            Node::Binary(operator, a, b) => {
                let (a, b) = (operand(a), operand(b));
                match operator {
                    Binary::Add => quote!(#a + #b),
                    Binary::Sub => quote!(#a - #b),
                    Binary::Mul => quote!(#a * #b),
                    Binary::Div => quote!(#a / #b),
                    Binary::Powf => quote!(#a.powf(#b)),
                    Binary::Atan2 => quote!(#a.atan2(#b)),
                }
            }
        }
    }

    /// A node that the function is given.
    pub(super) fn input(&self, id: ExprId) -> Option<TokenStream> {
        if let Some(slot) = self.slots.get(id) {
            return Some(quote!(c[#slot]));
        }
        match self.graph.node(id) {
            Node::Number(number) => Some(self::number(number.value())),
            Node::Symbol(Symbol::Coordinate(index)) => Some(quote!(q[#index])),
            Node::Symbol(Symbol::Velocity(index)) => Some(quote!(v[#index])),
            Node::Symbol(Symbol::Time) => Some(quote!(t)),
            Node::Symbol(Symbol::Input(index)) => Some(quote!(u[#index])),
            Node::Symbol(Symbol::Distance) => Some(quote!(r)),
            Node::Symbol(Symbol::Parameter(symbol)) => {
                let index = self.parameters.iter().position(|parameter| parameter.symbol == symbol);
                let index = index.expect("a parameter in the graph is a parameter of the model");
                Some(quote!(p[#index]))
            }
            Node::Symbol(Symbol::NamedConstant(index)) => {
                let path = &self.named_constants[index];
                Some(quote!(T::from_f64(#path as f64)))
            }
            Node::Symbol(Symbol::Composite(_)) => unreachable!("loops and vectors are no part of a program"),
            Node::Unary(..) | Node::Binary(..) | Node::Power(..) => None,
        }
    }
}

/// `T::from_f64(value)`.
fn number(value: f64) -> TokenStream {
    let magnitude = Literal::f64_unsuffixed(value.abs());
    if value < 0.0 { quote!(T::from_f64(-#magnitude)) } else { quote!(T::from_f64(#magnitude)) }
}

fn local(place: Place) -> Ident {
    format_ident!("x{}", place.name)
}

fn identifier(name: &str) -> Ident {
    Ident::new(name, Span::call_site())
}
