//! Rust expressions as values: names, numbers, operators, functions, blocks. What vectors are worth is `vectors`', sums are `sums`'.

use proc_macro2::{Ident, Span, TokenStream, TokenTree};
use quote::ToTokens;
use syn::spanned::Spanned;

use super::expression::{Lowering, Resolved, Resolver};
use super::integers::{
    integer_division_message, integer_literal, is_integer, is_integer_literal, power_message,
};
use super::spine::{first_span, last_span, left_operand};
use super::vectors::VECTOR_FUNCTIONS;
use crate::diagnostics::suggestion;
use crate::expr::{Binary, Unary, Value};

impl<R: Resolver> Lowering<'_, R> {
    /// Recurses into what parentheses hold, whose depth is bounded; not along sums, products and chains of methods.
    pub(super) fn value(&mut self, expression: &syn::Expr) -> Option<Value> {
        let mut spine = vec![expression];
        while let Some(left) = left_operand(spine[spine.len() - 1]) {
            spine.push(left);
        }
        let innermost = spine.pop().expect("the expression itself, if nothing else");
        let value = self.innermost(innermost);
        spine.into_iter().rev().fold(value, |value, outer| self.applied(outer, value))
    }

    /// The node of an expression without an operand on its left.
    fn innermost(&mut self, expression: &syn::Expr) -> Option<Value> {
        match expression {
            syn::Expr::Lit(literal) => self.literal(&literal.lit),
            syn::Expr::Path(path) if path.qself.is_none() => self.path(path),
            syn::Expr::Call(call) => self.call(call),
            syn::Expr::Block(block) if block.label.is_none() => self.block(&block.block),
            syn::Expr::Field(field) => {
                let member = field.member.to_token_stream();
                self.mistake_over(field, format!("a field is named directly, write `{member}`"))
            }
            syn::Expr::Array(array) => {
                // All of them, so that the mistakes of all are reported.
                let parts = array.elems.iter().map(|part| self.value(part)).collect();
                self.row(parts, array)
            }
            syn::Expr::If(choice) => self.mistake(
                choice.if_token.span,
                "an equation has no `if`: it is differentiated twice, and a smooth formula is needed",
            ),
            syn::Expr::Assign(assign) => {
                self.mistake(assign.eq_token.span, "`=` in an equation: shared expressions are written `let`")
            }
            other => self.mistake_over(
                other,
                "an equation is made of numbers, names, `der(..)`, `+ - * /`, methods such as `.sin()`, vectors \
                 `[a, b, c]`, `sum(0..N, |i| ..)`, and blocks with `let`",
            ),
        }
    }

    /// The node of an expression whose left operand has this value.
    fn applied(&mut self, expression: &syn::Expr, left: Option<Value>) -> Option<Value> {
        match expression {
            syn::Expr::Binary(binary) => self.binary(binary, left),
            syn::Expr::MethodCall(call) => self.method(call, left),
            syn::Expr::Unary(unary) => self.unary(unary, left),
            syn::Expr::Field(field) => self.field(field),
            syn::Expr::Index(index) => self.indexed(left, index),
            syn::Expr::Cast(cast) => {
                self.mistake(cast.as_token.span, "no cast is needed: every value is a real number")
            }
            // Parentheses.
            _ => left,
        }
    }

    pub(super) fn mistake<X>(&mut self, span: Span, message: impl Into<String>) -> Option<X> {
        self.diagnostics.report(span, message);
        None
    }

    pub(super) fn mistake_between<X>(
        &mut self,
        first: Span,
        last: Span,
        message: impl Into<String>,
    ) -> Option<X> {
        self.diagnostics.report_range(first, last, message);
        None
    }

    /// A mistake that the whole of `syntax` is.
    pub(super) fn mistake_over<X>(
        &mut self,
        syntax: &impl ToTokens,
        message: impl Into<String>,
    ) -> Option<X> {
        let tokens: Vec<TokenTree> = syntax.to_token_stream().into_iter().collect();
        let first = tokens.first().map_or_else(Span::call_site, TokenTree::span);
        let last = tokens.last().map_or(first, TokenTree::span);
        self.mistake_between(first, last, message)
    }

    fn field(&mut self, field: &syn::ExprField) -> Option<Value> {
        let member = field.member.to_token_stream().to_string();
        if is_function(&member) {
            return self
                .mistake(field.member.span(), format!("`.{member}` is a function, write `.{member}(..)`"));
        }
        self.mistake(field.member.span(), "a number has no fields")
    }

    fn literal(&mut self, literal: &syn::Lit) -> Option<Value> {
        let (digits, suffix) = match literal {
            syn::Lit::Float(float) => (float.base10_digits().to_owned(), float.suffix().to_owned()),
            syn::Lit::Int(integer) => (integer.base10_digits().to_owned(), integer.suffix().to_owned()),
            other => return self.mistake(other.span(), "expected a number"),
        };
        if !matches!(suffix.as_str(), "" | "f64") {
            return self
                .mistake(literal.span(), format!("every value is a real number: leave out `{suffix}`"));
        }
        match digits.parse::<f64>() {
            Ok(value) if value.is_finite() => Some(Value::Scalar(self.graph.number(value))),
            _ => self.mistake(literal.span(), "this number is too large for f64"),
        }
    }

    fn path(&mut self, path: &syn::ExprPath) -> Option<Value> {
        let Some(name) = path.path.get_ident() else {
            return Some(Value::Scalar(self.resolver.constant(self.graph, path.to_token_stream())));
        };
        match self.resolver.name(self.graph, name, self.diagnostics) {
            Resolved::Value(value) => Some(value),
            Resolved::Mistaken => None,
            Resolved::Unknown if is_screaming_case(name) => {
                Some(Value::Scalar(self.resolver.constant(self.graph, path.to_token_stream())))
            }
            Resolved::Unknown if name == "der" => self.mistake(name.span(), DER_TAKES_ONE),
            Resolved::Unknown => {
                self.resolver.report_unknown(name, self.diagnostics);
                None
            }
        }
    }

    fn unary(&mut self, unary: &syn::ExprUnary, operand: Option<Value>) -> Option<Value> {
        match unary.op {
            syn::UnOp::Neg(_) => match self.negative(operand?) {
                Ok(value) => Some(value),
                Err(message) => self.mistake_over(&unary.expr, message),
            },
            _ => self.mistake_over(&unary.op, "this operator has no meaning for real numbers"),
        }
    }

    fn binary(&mut self, binary: &syn::ExprBinary, first: Option<Value>) -> Option<Value> {
        // `x ** 2` parses as `x * (*2)`.
        if let (
            syn::BinOp::Mul(first),
            syn::Expr::Unary(syn::ExprUnary { op: syn::UnOp::Deref(second), expr, .. }),
        ) = (binary.op, &*binary.right)
        {
            self.value(expr);
            self.diagnostics.report_range(first.span, second.span, power_message("**", expr));
            return None;
        }
        // Whatever the first is, so that the mistakes of both are reported.
        let second = self.value(&binary.right);
        let operator = match binary.op {
            syn::BinOp::Add(_) => Binary::Add,
            syn::BinOp::Sub(_) => Binary::Sub,
            syn::BinOp::Mul(_) => Binary::Mul,
            syn::BinOp::Div(_) if is_integer(&binary.left) && is_integer(&binary.right) => {
                let message = integer_division_message(&binary.left, &binary.right);
                return self.mistake_between(first_span(&binary.left), last_span(&binary.right), message);
            }
            syn::BinOp::Div(_) => Binary::Div,
            syn::BinOp::BitXor(caret) => {
                return self.mistake(caret.span, power_message("^", &binary.right));
            }
            other => {
                return self
                    .mistake_over(&other, "this operator has no meaning in an equation: use `+ - * /`");
            }
        };
        match self.combined(operator, first?, second?) {
            Ok(value) => Some(value),
            Err(message) => self.mistake_over(&binary.op, message),
        }
    }

    fn method(&mut self, call: &syn::ExprMethodCall, receiver: Option<Value>) -> Option<Value> {
        let method = call.method.to_string();
        let arguments: Vec<&syn::Expr> = call.args.iter().collect();
        match (method.as_str(), arguments.as_slice()) {
            ("powi", [exponent]) => match integer_literal(exponent) {
                Some(exponent) => {
                    let base = self.number(receiver?, &call.receiver)?;
                    Some(Value::Scalar(self.graph.power(base, exponent)))
                }
                None if is_integer_literal(exponent) => self.mistake_over(
                    exponent,
                    "an exponent of `.powi` is between -2147483647 and 2147483647; for others write `.powf(..)`",
                ),
                None => self.mistake_over(
                    exponent,
                    "`.powi` takes an integer literal; for other exponents write `.powf(..)`",
                ),
            },
            ("powf", [exponent]) => self.function_of_two(Binary::Powf, call, receiver, exponent),
            ("atan2", [x]) => self.function_of_two(Binary::Atan2, call, receiver, x),
            ("powi" | "powf" | "atan2", _) => {
                self.mistake(call.method.span(), format!("`.{method}` takes one argument"))
            }
            (_, arguments) => match (Unary::from_method(&method), arguments) {
                (Some(function), []) => {
                    let operand = self.number(receiver?, &call.receiver)?;
                    Some(Value::Scalar(self.graph.unary(function, operand)))
                }
                (Some(_), [extra, ..]) => {
                    self.mistake_over(extra, format!("`.{method}()` takes no argument"))
                }
                (None, _) if VECTOR_FUNCTIONS.contains(&method.as_str()) => {
                    self.function_of_vectors(call, receiver, arguments)
                }
                (None, _) if method == "point" => self.point_of_body(call, receiver),
                (None, _) => {
                    let known: Vec<&str> = functions().collect();
                    let similar = suggestion(&method, functions());
                    let message =
                        format!("unknown function `{method}`{similar}\nfunctions: {}", known.join(", "));
                    self.mistake(call.method.span(), message)
                }
            },
        }
    }

    fn function_of_two(
        &mut self,
        operator: Binary,
        call: &syn::ExprMethodCall,
        receiver: Option<Value>,
        argument: &syn::Expr,
    ) -> Option<Value> {
        let second = self.value(argument);
        let first = self.number(receiver?, &call.receiver);
        let second = self.number(second?, argument);
        Some(Value::Scalar(self.graph.binary(operator, first?, second?)))
    }

    fn call(&mut self, call: &syn::ExprCall) -> Option<Value> {
        let function = match &*call.func {
            syn::Expr::Path(path) => path.path.segments.last().map(|segment| &segment.ident),
            _ => None,
        };
        let arguments: Vec<&syn::Expr> = call.args.iter().collect();
        match (function, arguments.as_slice()) {
            (Some(der), [argument]) if der == "der" => self.derivative(der.span(), argument),
            (Some(der), _) if der == "der" => self.mistake(der.span(), DER_TAKES_ONE),
            (Some(sum), arguments) if sum == "sum" => self.sum(sum, arguments),
            (Some(name), [receiver, others @ ..]) if name == "pow" || is_function(&name.to_string()) => {
                for argument in &arguments {
                    self.value(argument);
                }
                let receiver = match receiver {
                    syn::Expr::Path(_) | syn::Expr::Call(_) => receiver.to_token_stream().to_string(),
                    _ => "(..)".to_owned(),
                };
                let name = if name == "pow" { "powi".to_owned() } else { name.to_string() };
                let others = if others.is_empty() { "" } else { ".." };
                self.mistake_over(
                    &call.func,
                    format!("functions are methods in Rust, write `{receiver}.{name}({others})`"),
                )
            }
            _ => self.mistake_over(
                &call.func,
                "the only functions that can be called here are `der(coordinate)` and `sum(0..N, |i| ..)`",
            ),
        }
    }

    fn derivative(&mut self, der: Span, argument: &syn::Expr) -> Option<Value> {
        match argument {
            syn::Expr::Path(path) if path.path.get_ident().is_some() => {
                let name = path.path.get_ident().expect("checked by the guard");
                self.resolver.velocity(self.graph, der, name, self.diagnostics)
            }
            syn::Expr::Paren(inner) => self.derivative(der, &inner.expr),
            syn::Expr::Index(index) => {
                let array = self.derivative(der, &index.expr);
                self.indexed(array, index)
            }
            syn::Expr::MethodCall(call) if call.method == "point" => {
                let body = self.derivative(der, &call.receiver);
                self.point_of_body(call, body)
            }
            syn::Expr::Call(_) => {
                self.mistake(der, "a Lagrangian depends on positions and velocities: no second derivatives")
            }
            other => self
                .mistake_over(other, "`der` takes a coordinate by its name: `der(x)`, `der(r)`, `der(p[i])`"),
        }
    }

    fn block(&mut self, block: &syn::Block) -> Option<Value> {
        self.resolver.enter_block();
        let mut value = None;
        for (k, statement) in block.stmts.iter().enumerate() {
            match statement {
                syn::Stmt::Local(local) => self.local(local),
                syn::Stmt::Expr(last, None) if k + 1 == block.stmts.len() => value = self.value(last),
                other => {
                    self.mistake_over::<Value>(
                        other,
                        "a block holds `let name = expression;` and ends with an expression",
                    );
                }
            }
        }
        if !matches!(block.stmts.last(), Some(syn::Stmt::Expr(_, None))) {
            self.mistake::<Value>(
                block.brace_token.span.close(),
                "a block ends with an expression, its value",
            );
        }
        self.resolver.leave_block();
        value
    }

    fn local(&mut self, local: &syn::Local) {
        let name = match &local.pat {
            syn::Pat::Ident(name)
                if name.by_ref.is_none() && name.mutability.is_none() && name.subpat.is_none() =>
            {
                name.ident.clone()
            }
            other => {
                self.mistake_over::<Value>(other, "write `let name = expression;`");
                // What it binds is known, if not its value.
                for name in identifiers(other.to_token_stream()) {
                    self.resolver.define(&name, None, self.diagnostics);
                }
                return;
            }
        };
        let value = match &local.init {
            Some(init) if init.diverge.is_none() => self.value(&init.expr),
            _ => self.mistake(name.span(), "write `let name = expression;`"),
        };
        self.resolver.define(&name, value, self.diagnostics);
    }
}

/// For every wrong number of arguments, none included.
const DER_TAKES_ONE: &str = "`der` takes one coordinate: `der(x)`";

/// The functions of the attribute grammar.
fn functions() -> impl Iterator<Item = &'static str> {
    Unary::methods().chain(["powi", "powf", "atan2"]).chain(VECTOR_FUNCTIONS)
}

fn is_function(name: &str) -> bool {
    functions().any(|function| function == name)
}

fn identifiers(tokens: TokenStream) -> Vec<Ident> {
    let inside = |token| match token {
        TokenTree::Ident(name) => vec![name],
        TokenTree::Group(group) => identifiers(group.stream()),
        TokenTree::Punct(_) | TokenTree::Literal(_) => Vec::new(),
    };
    tokens.into_iter().flat_map(inside).collect()
}

/// Rust's convention for constants.
pub(super) fn is_screaming_case(name: &Ident) -> bool {
    let name = name.to_string();
    name.chars().any(char::is_alphabetic) && !name.chars().any(char::is_lowercase)
}
