//! Numbers and powers as they are written in Rust, and advice where they are written as elsewhere.

/// The value of an integer literal, or of one with a sign.
pub(super) fn integer_literal(expression: &syn::Expr) -> Option<i32> {
    match expression {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Int(integer), .. })
            if matches!(integer.suffix(), "" | "i32") =>
        {
            integer.base10_parse().ok()
        }
        syn::Expr::Unary(syn::ExprUnary { op: syn::UnOp::Neg(_), expr, .. }) => {
            integer_literal(expr).map(|magnitude| -magnitude)
        }
        syn::Expr::Paren(inner) => integer_literal(&inner.expr),
        _ => None,
    }
}

/// Whether this is an integer literal, of whatever size.
pub(super) fn is_integer_literal(expression: &syn::Expr) -> bool {
    match expression {
        syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Int(integer), .. }) => {
            matches!(integer.suffix(), "" | "i32")
        }
        syn::Expr::Unary(syn::ExprUnary { op: syn::UnOp::Neg(_), expr, .. }) => is_integer_literal(expr),
        syn::Expr::Paren(inner) => is_integer_literal(&inner.expr),
        _ => false,
    }
}

/// What to write for a power, from the operand behind its sign. `^` binds loosely in Rust: of `x^2 + y` the
/// operand is `2 + y`, and the exponent its first number.
pub(super) fn power_message(sign: &str, operand: &syn::Expr) -> String {
    let mut exponent = operand;
    while let syn::Expr::Binary(binary) = exponent {
        exponent = &binary.left;
    }
    let power = match (integer_literal(exponent), exponent) {
        (Some(exponent), _) => format!(".powi({exponent})"),
        (None, syn::Expr::Lit(syn::ExprLit { lit: syn::Lit::Float(number), .. })) => {
            let digits = number.base10_digits();
            // `x^2.0` means the integer power, too.
            digits.strip_suffix(".0").map_or(format!(".powf({digits})"), |whole| format!(".powi({whole})"))
        }
        _ => ".powf(..)".to_owned(),
    };
    format!("`{sign}` is not a power in Rust, write `{power}`")
}

/// Whether Rust would compute an expression in integers.
pub(super) fn is_integer(expression: &syn::Expr) -> bool {
    let mut left = expression;
    loop {
        left = match left {
            syn::Expr::Lit(literal) => {
                return matches!(&literal.lit, syn::Lit::Int(integer) if integer.suffix() != "f64");
            }
            syn::Expr::Paren(inner) => &inner.expr,
            syn::Expr::Unary(unary) => &unary.expr,
            syn::Expr::Binary(binary) if is_integer(&binary.right) => &binary.left,
            _ => return false,
        }
    }
}

/// What to write for a quotient of integers.
pub(super) fn integer_division_message(dividend: &syn::Expr, divisor: &syn::Expr) -> String {
    match (integer_literal(dividend), integer_literal(divisor)) {
        (Some(a), Some(b)) if b != 0 => {
            format!("`{a}/{b}` is {} in Rust, write `{a}.0/{b}.0`", a / b)
        }
        _ => "a quotient of integers is an integer in Rust, write `1.0/2.0`".to_owned(),
    }
}
