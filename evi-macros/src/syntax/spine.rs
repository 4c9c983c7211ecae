//! Walking an expression along its left operands without recursion.
//!
//! `a + b + c + d` nests to the left as deep as it is long, and so do products and chains of methods. What is as long as
//! the user likes is walked in a loop; what stands in parentheses is bounded by [`super::nesting`].

use proc_macro2::{Span, TokenStream};
use quote::ToTokens;
use syn::Expr;
use syn::spanned::Spanned;

/// What stands on the left of an expression's last operation: the deep side of sums, products and chains.
pub(super) fn left_operand(expression: &Expr) -> Option<&Expr> {
    Some(match expression {
        Expr::Binary(binary) => &binary.left,
        Expr::MethodCall(call) => &call.receiver,
        Expr::Unary(unary) => &unary.expr,
        Expr::Paren(parentheses) => &parentheses.expr,
        Expr::Group(group) => &group.expr,
        Expr::Index(index) => &index.expr,
        Expr::Cast(cast) => &cast.expr,
        // `self.x` is one mistake as a whole.
        Expr::Field(field) if !is_self(&field.base) => &field.base,
        _ => return None,
    })
}

fn is_self(expression: &Expr) -> bool {
    matches!(expression, Expr::Path(path) if path.path.is_ident("self"))
}

/// The span of the first token.
pub(super) fn first_span(expression: &Expr) -> Span {
    let mut first = expression;
    loop {
        first = match first {
            Expr::Unary(unary) => return unary.op.span(),
            Expr::Paren(parentheses) => return parentheses.paren_token.span.open(),
            other => match left_operand(other) {
                Some(left) => left,
                None => return first_token(other.to_token_stream()),
            },
        }
    }
}

fn first_token(tokens: TokenStream) -> Span {
    tokens.into_iter().next().expect("syntax has tokens").span()
}

/// The span of the last token.
pub(super) fn last_span(expression: &Expr) -> Span {
    expression.to_token_stream().into_iter().last().expect("syntax has tokens").span()
}

/// An expression that is taken apart without recursion when it is dropped.
pub(super) struct Tree {
    root: Expr,
}

impl Tree {
    pub(super) fn new(root: Expr) -> Self {
        Self { root }
    }

    pub(super) fn root(&self) -> &Expr {
        &self.root
    }
}

impl Drop for Tree {
    fn drop(&mut self) {
        let mut pending = vec![std::mem::replace(&mut self.root, Expr::Verbatim(TokenStream::new()))];
        while let Some(expression) = pending.pop() {
            match expression {
                Expr::Binary(binary) => pending.extend([*binary.left, *binary.right]),
                Expr::MethodCall(call) => {
                    pending.push(*call.receiver);
                    pending.extend(call.args);
                }
                Expr::Call(call) => {
                    pending.push(*call.func);
                    pending.extend(call.args);
                }
                Expr::Unary(unary) => pending.push(*unary.expr),
                Expr::Paren(parentheses) => pending.push(*parentheses.expr),
                Expr::Group(group) => pending.push(*group.expr),
                Expr::Index(index) => pending.extend([*index.expr, *index.index]),
                Expr::Array(array) => pending.extend(array.elems),
                Expr::Closure(closure) => pending.push(*closure.body),
                Expr::Range(range) => {
                    pending.extend([range.start, range.end].into_iter().flatten().map(|end| *end))
                }
                Expr::Cast(cast) => pending.push(*cast.expr),
                Expr::Field(field) => pending.push(*field.base),
                Expr::Block(block) => pending.extend(block.block.stmts.into_iter().filter_map(value)),
                // What has no place in an equation, and leaves.
                _ => {}
            }
        }
    }
}

/// The expression that a statement holds.
fn value(statement: syn::Stmt) -> Option<Expr> {
    match statement {
        syn::Stmt::Local(local) => local.init.map(|init| *init.expr),
        syn::Stmt::Expr(expression, _) => Some(expression),
        syn::Stmt::Item(_) | syn::Stmt::Macro(_) => None,
    }
}
