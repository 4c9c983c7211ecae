//! What an implementation is written for: the user's struct, or an element of a scene of loops.

use proc_macro2::{Ident, TokenStream};
use quote::{format_ident, quote};

use super::indices;
use crate::model::Model;
use crate::syntax::Declaration;

/// A struct with its parameters, in the order of the model's.
pub(super) struct Subject {
    pub(super) name: Ident,
    /// Names of the parameters.
    pub(super) parameters: Vec<String>,
    /// Their values, from `self`.
    pub(super) values: Vec<TokenStream>,
}

impl Subject {
    /// The struct that the user wrote.
    pub(super) fn of_declaration(declaration: &Declaration, model: &Model) -> Self {
        let value = |parameter| indices::parameter(declaration, &quote!(self), parameter);
        Self {
            name: declaration.name.clone(),
            parameters: model.parameters.iter().map(|parameter| parameter.name(declaration)).collect(),
            values: model.parameters.iter().map(value).collect(),
        }
    }

    /// An element by its number, which holds its parameters in an array.
    pub(super) fn of_element(number: usize, declaration: &Declaration, model: &Model) -> Self {
        Self {
            name: element_name(number),
            parameters: model.parameters.iter().map(|parameter| parameter.name(declaration)).collect(),
            values: (0..model.parameters.len()).map(|index| quote!(self.p[#index])).collect(),
        }
    }
}

/// The name of an element.
pub(super) fn element_name(number: usize) -> Ident {
    format_ident!("Element{number}")
}
