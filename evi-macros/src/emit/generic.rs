//! The user's expressions once more, in the user's order and with the user's spans, generic over the scalar.
//!
//! Only numbers, constants, `der(..)` and the spelling of names are rewritten; long sums are in pieces. Nothing of the graph is used: this copy is
//! the oracle that the kernels are tested against.

use proc_macro2::{Group, Ident, Literal, Span, TokenStream, TokenTree};
use quote::{ToTokens, format_ident, quote, quote_spanned};

use super::pieces::in_pieces;
use crate::expr::Dependence;
use crate::model::{LagrangianSource, Model, Parameter, ParameterSource, Source, coordinate_entries};
use crate::syntax::{Declaration, Expression};

/// The implementation of `GenericSystem`.
pub(super) fn generic_system(declaration: &Declaration, model: &Model, source: &Source) -> TokenStream {
    let struct_name = &declaration.name;
    let (n_coordinates, n_constraints) = (model.coordinates.len(), model.constraints.len());
    let field = |parameter: &Parameter| match parameter.source {
        ParameterSource::Field { field, .. } => &declaration.fields[field].name,
        ParameterSource::Index(_) => unreachable!("where there are no vectors there are no indices"),
    };
    let fields = || model.parameters.iter().map(field);
    let coordinates: Vec<&Ident> = coordinate_entries(declaration).iter().map(|entry| &entry.name).collect();
    let shared = model.lets.iter().map(|shared| &shared.name);
    let inputs = &model.inputs;
    let rewriter = Rewriter {
        constants: model.named_constants.iter().map(TokenStream::to_string).collect(),
        names: fields()
            .chain(coordinates.iter().copied())
            .chain(inputs)
            .chain(shared)
            .map(Ident::to_string)
            .collect(),
    };
    let parameters: TokenStream = fields()
        .map(|field| (local_name(field), field))
        .map(|(name, field)| quote!(let #name = T::from_f64(self.#field);))
        .collect();
    let positions: TokenStream = coordinates
        .iter()
        .enumerate()
        .map(|(i, name)| (i, local_name(name)))
        .map(|(i, name)| quote!(let #name = __q[#i];))
        .collect();
    let velocities: TokenStream = coordinates
        .iter()
        .enumerate()
        .map(|(i, name)| (i, velocity_name(name)))
        .map(|(i, name)| quote!(let #name = __v[#i];))
        .collect();
    let lets = |is_usable: fn(Dependence) -> bool| -> TokenStream {
        let usable = model.lets.iter().filter(|shared| is_usable(shared.on));
        usable
            .map(|shared| (local_name(&shared.name), rewriter.expression(&shared.value)))
            .map(|(name, value)| quote!(let #name = #value;))
            .collect()
    };
    let motion_lets = lets(|on| !on.on_inputs);
    let position_lets = lets(|on| !on.on_inputs && !on.on_v);
    let all_lets = lets(|_| true);
    let forces = forces(
        model,
        source,
        &rewriter,
        &quote!(#parameters #positions #velocities #motion_lets),
        &quote!(#parameters #positions #velocities),
        &all_lets,
    );
    let lagrangian = match &source.lagrangian {
        LagrangianSource::Whole(lagrangian) => {
            let lagrangian = rewriter.expression(lagrangian);
            // In parentheses: where a statement may stand, `{ .. } + x` would end behind the block.
            quote!((#lagrangian))
        }
        LagrangianSource::Difference { kinetic, potential } => {
            let (kinetic, potential) = (rewriter.expression(kinetic), rewriter.expression(potential));
            quote!((#kinetic) - (#potential))
        }
    };
    let residuals = source.constraints.iter().enumerate().map(|(c, (left, right))| {
        let (left, right) = (rewriter.expression(left), rewriter.expression(right));
        quote!(__residuals[#c] = (#left) - (#right);)
    });
    quote! {
        #[automatically_derived]
        #[allow(unused, non_snake_case, trivial_numeric_casts, clippy::all)]
        impl ::evi_core::__private::GenericSystem for #struct_name {
            fn n_coordinates(&self) -> usize {
                #n_coordinates
            }

            fn n_constraints(&self) -> usize {
                #n_constraints
            }

            fn lagrangian<T: ::evi_core::__private::Scalar>(&self, t: T, __q: &[T], __v: &[T]) -> T {
                #parameters #positions #velocities #motion_lets
                #lagrangian
            }

            fn constraints<T: ::evi_core::__private::Scalar>(&self, t: T, __q: &[T], __residuals: &mut [T]) {
                #parameters #positions #position_lets
                #(#residuals)*
            }

            #forces
        }
    }
}

/// The methods for forces that are no derivatives of `L`, where the scene has some.
fn forces(
    model: &Model,
    source: &Source,
    rewriter: &Rewriter,
    motion: &TokenStream,
    variables: &TokenStream,
    lets: &TokenStream,
) -> TokenStream {
    let n_inputs = model.inputs.len();
    let count = (n_inputs > 0).then(|| {
        quote! {
            fn n_inputs(&self) -> usize {
                #n_inputs
            }
        }
    });
    let dissipation = source.dissipation.as_ref().map(|dissipation| {
        let dissipation = rewriter.expression(dissipation);
        quote! {
            const HAS_DISSIPATION: bool = true;

            fn dissipation<T: ::evi_core::__private::Scalar>(&self, t: T, __q: &[T], __v: &[T]) -> T {
                #motion
                (#dissipation)
            }
        }
    });
    let inputs: TokenStream = model
        .inputs
        .iter()
        .enumerate()
        .map(|(i, name)| (i, local_name(name)))
        .map(|(i, name)| quote!(let #name = __u[#i];))
        .collect();
    let summands = source.forces.iter().map(|(coordinate, force)| {
        let force = rewriter.expression(force);
        quote!(__forces[#coordinate] = __forces[#coordinate] + (#force);)
    });
    let generalized = (!source.forces.is_empty()).then(|| {
        quote! {
            const HAS_FORCES: bool = true;

            fn add_forces<T: ::evi_core::__private::Scalar>(
                &self,
                t: T,
                __q: &[T],
                __v: &[T],
                __u: &[T],
                __forces: &mut [T],
            ) {
                #variables #inputs #lets
                #(#summands)*
            }
        }
    });
    quote!(#count #dissipation #generalized)
}

/// The variable for a name of the user. Not the name itself: a binding cannot have the name of a constant in scope, and
/// parts of a struct that a macro wrote would not see each other's.
fn local_name(name: &Ident) -> Ident {
    format_ident!("__name_{}", name, span = name.span().resolved_at(Span::call_site()))
}

fn velocity_name(coordinate: &Ident) -> Ident {
    format_ident!("__der_{}", coordinate, span = coordinate.span().resolved_at(Span::call_site()))
}

/// Rewrites the tokens of an expression for the scalar `T`.
struct Rewriter {
    /// Constants that rustc resolves, as written.
    constants: Vec<String>,
    /// Parameters, coordinates and shared expressions.
    names: Vec<String>,
}

impl Rewriter {
    /// The expression with numbers and constants as `T::from_f64(..)`, and `der(x)` as the name of x's velocity.
    fn expression(&self, expression: &Expression) -> TokenStream {
        self.tokens(expression.tokens.clone())
    }

    fn tokens(&self, tokens: TokenStream) -> TokenStream {
        let tokens: Vec<TokenTree> = tokens.into_iter().collect();
        let mut rewritten: Vec<TokenTree> = Vec::new();
        let mut rest = tokens.as_slice();
        while let Some(token) = rest.first() {
            let path_length = path_length(rest);
            let path: TokenStream = rest[..path_length].iter().cloned().collect();
            let consumed = match rest {
                [TokenTree::Ident(powi), TokenTree::Group(exponent), ..] if powi == "powi" => {
                    rewritten.extend(quote!(#powi #exponent));
                    2
                }
                [TokenTree::Ident(der), TokenTree::Group(coordinate), ..] if der == "der" => {
                    rewritten.extend(
                        innermost_name(coordinate).map(|name| velocity_name(&name)).to_token_stream(),
                    );
                    2
                }
                _ if self.constants.contains(&path.to_string()) => {
                    rewritten.extend(quote_spanned!(token.span()=> T::from_f64(#path as f64)));
                    path_length
                }
                [TokenTree::Literal(number), ..] => {
                    let value = real_number(number);
                    rewritten.extend(quote_spanned!(number.span()=> T::from_f64(#value)));
                    1
                }
                // Behind a dot stands the name of a function.
                [TokenTree::Punct(dot), TokenTree::Ident(method), ..]
                    if dot.as_char() == '.' && method != "powi" =>
                {
                    rewritten.extend(rest[..2].iter().cloned());
                    2
                }
                [TokenTree::Ident(name), ..] if self.names.contains(&name.to_string()) => {
                    rewritten.extend(local_name(name).to_token_stream());
                    1
                }
                [TokenTree::Group(group), ..] => {
                    let mut inner = Group::new(group.delimiter(), self.tokens(group.stream()));
                    inner.set_span(group.span());
                    rewritten.extend([TokenTree::Group(inner)]);
                    1
                }
                _ => {
                    rewritten.extend([token.clone()]);
                    1
                }
            };
            rest = &rest[consumed..];
        }
        in_pieces(&rewritten)
    }
}

/// A number as a literal of type f64: `2` as `2.0`.
fn real_number(number: &Literal) -> Literal {
    let digits = number.to_string().replace('_', "");
    match digits.trim_end_matches("f64").parse::<f64>() {
        Ok(value) => Literal::f64_suffixed(value),
        // Hexadecimal and the like.
        Err(_) => number.clone(),
    }
}

/// Number of tokens of the path `a::b::c` at the beginning of the tokens; 0 if there is none.
fn path_length(tokens: &[TokenTree]) -> usize {
    let is_colons = |at: usize| {
        matches!(tokens.get(at..at + 2), Some([TokenTree::Punct(a), TokenTree::Punct(b)])
            if a.as_char() == ':' && b.as_char() == ':')
    };
    let mut length = if is_colons(0) { 2 } else { 0 };
    while matches!(tokens.get(length), Some(TokenTree::Ident(_))) {
        length += 1;
        if !is_colons(length) {
            return length;
        }
        length += 2;
    }
    0
}

/// The coordinate in the parentheses of `der(x)` or `der((x))`.
fn innermost_name(group: &Group) -> Option<Ident> {
    match group.stream().into_iter().next()? {
        TokenTree::Ident(name) => Some(name),
        TokenTree::Group(inner) => innermost_name(&inner),
        TokenTree::Punct(_) | TokenTree::Literal(_) => None,
    }
}
