//! Expressions as long as the user likes on a small stack, and a limit to how deep they nest.

use proc_macro2::{TokenStream, TokenTree};

use crate::pipeline::expand;

/// Three quarters of the smallest stack that a derive runs on, rust-analyzer's. `syn` is not optimised here, as it is not for
/// derives. The deepest nesting needs up to 1.4 MB, everything else less than 0.5 MB.
const STACK: usize = 1536 * 1024;
/// Levels of nesting that an equation may have: those that are accepted, less those of `#[evi( =`.
const DEEPEST: usize = 61;

/// The expansion, on a thread of its own.
fn expanded(items: &str) -> String {
    expanded_struct(format!("#[evi(coordinates(x, y), {items})] struct Long {{ a: f64 }}"))
}

fn expanded_struct(source: String) -> String {
    let expansion = move || expand(source.parse().expect("tokens")).to_string();
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(expansion).expect("a thread starts");
    thread.join().expect("the expansion does not panic")
}

#[track_caller]
fn accepted(items: &str) {
    let expansion = expanded(items);
    assert!(!expansion.contains("compile_error"), "{:?}", messages(&expansion));
}

#[track_caller]
fn refused(items: &str, message: &str) {
    let messages = messages(&expanded(items));
    assert!(messages.len() == 1 && messages[0].starts_with(message), "{messages:?}");
}

/// The texts of the errors in an expansion.
fn messages(expansion: &str) -> Vec<String> {
    let behind = expansion.split("compile_error !").skip(1);
    behind.map(|text| text.split('"').nth(1).expect("an error has a text").to_owned()).collect()
}

const KINETIC: &str = "kinetic = 0.5 * a * (der(x) * der(x) + der(y) * der(y))";

fn sum(terms: usize) -> String {
    (0..terms).map(|k| format!("{k}.5 * x * y")).collect::<Vec<_>>().join(" - ")
}

#[test]
fn a_sum_of_ten_thousand_terms_is_lowered_differentiated_and_emitted() {
    accepted(&format!("{KINETIC}, potential = {}", sum(10_000)));
}

#[test]
fn sums_in_parentheses_blocks_lets_arguments_and_constraints_may_be_as_long() {
    let sum = sum(2_000);
    accepted(&format!(
        "let shared = ({sum}).sin(), {KINETIC}, potential = shared + a * ({sum}) + {{ let s = {sum}; s * x }},
         constraint(long: (2.0 + x * x).powf({sum}) == {sum})"
    ));
}

#[test]
fn products_and_chains_may_be_as_long() {
    let (product, chain) = (vec!["x * a / y"; 500].join(" * "), ".sin()".repeat(500));
    accepted(&format!("{KINETIC}, potential = {product} + (x * y){chain}"));
}

#[test]
fn mistakes_at_the_end_of_long_expressions_are_messages() {
    let sum = sum(5_000);
    refused(&format!("{KINETIC}, potential = {sum} +"), "unexpected end of input");
    refused(&format!("{KINETIC}, potential = {sum} + z"), "unknown name `z`");
    let quotients = vec!["1"; 3_000].join(" / ");
    assert_eq!(messages(&expanded(&format!("{KINETIC}, potential = {quotients}"))).len(), 2_999);
}

#[test]
fn nesting_has_a_limit_with_a_message() {
    let too_deep = "nested too deeply: at most 64 levels";
    for (open, close) in [("(", ")"), ("{", "}"), ("x.powf(", ")"), ("(x + ", ")"), ("-", ""), ("-(", ")")] {
        let levels_of_one = open.matches(['(', '{', '-']).count();
        let nested = |levels: usize| {
            let times = levels / levels_of_one;
            format!("{KINETIC}, potential = {}x{}", open.repeat(times), close.repeat(times))
        };
        accepted(&nested(DEEPEST));
        refused(&nested(DEEPEST + 2), too_deep);
        refused(&nested(5_000), too_deep);
    }
}

/// What has no place in an equation nests without parentheses, and in types, which take more stack.
#[test]
fn nesting_of_what_has_no_place_in_an_equation_is_limited_too() {
    let forms = [
        ("", "x = ", ""),
        ("", "x += ", ""),
        ("", "return ", ""),
        ("", "return -", ""),
        ("", "|x| ", ""),
        ("f(", "|x, y| ", ""),
        ("", "#[a] |x| ", ""),
        ("", "move |x| ", ""),
        ("", "&", ""),
        ("", "&mut ", ""),
        ("", "x ", ""),
        ("", "x ? ", ""),
        ("", "x as A<", ">"),
        ("", "x::<", ">"),
        ("", "x::<A, ", ">"),
        ("", "'a: loop {", "}"),
        ("", "async {", "}"),
        ("", "if ", "{}"),
        ("", "{ type A = Vec<", ">; }"),
        ("x as ", "[", "]"),
        ("x as ", "fn(", ")"),
        ("x as ", "fn() -> ", ""),
        ("x as ", "*const ", ""),
        ("x as ", "A<", ">"),
        ("x as ", "A<B, ", ">"),
        ("|x: ", "(", ")"),
        ("{ let x: ", "(", ")"),
    ];
    for (before, open, close) in forms {
        let nested =
            |levels| expanded(&format!("{KINETIC}, potential = {}", surrounded(before, open, close, levels)));
        // As deep as it goes on this stack, and beyond.
        (1..DEEPEST).for_each(|levels| drop(nested(levels)));
        let messages = messages(&nested(5_000));
        assert!(
            messages.iter().any(|message| message.starts_with("nested too deeply")),
            "{open}: {messages:?}"
        );
    }
}

/// A form around a name, behind its beginning, which is closed.
fn surrounded(before: &str, open: &str, close: &str, levels: usize) -> String {
    let end = match before {
        "f(" => ")",
        "|x: " => "| x",
        "{ let x: " => "= 1; x }",
        _ => "",
    };
    let separator = if before.is_empty() { "" } else { " " };
    format!("{before}{}x{}{separator}{end}", open.repeat(levels), close.repeat(levels))
}

#[test]
fn types_of_fields_nest_within_the_stack() {
    for (open, close) in [("[", "]"), ("(", ")"), ("Vec<", ">"), ("fn(", ")"), ("&", ""), ("fn() -> ", "")] {
        let structure = |levels: usize| {
            let (open, close) = (open.repeat(levels), close.repeat(levels));
            expanded_struct(format!(
                "#[evi(coordinates(x), lagrangian = der(x).powi(2))] struct S {{ a: {open}f64{close}, b: Vec<f64>, c: Vec<f64> }}"
            ))
        };
        (1..DEEPEST).for_each(|levels| drop(structure(levels)));
        assert!(!structure(10).contains("compile_error"), "{open}");
        assert!(messages(&structure(5_000))[0].starts_with("nested too deeply"), "{open}");
    }
}

#[test]
fn the_generic_copy_holds_no_long_expression() {
    let sum = vec!["x - y"; 500].join(" + ");
    let product = vec!["x"; 500].join(" * ");
    let source = format!(
        "#[evi(coordinates(x, y), {KINETIC}, potential = {sum} + -{product} + -x{})] struct Long {{ a: f64 }}",
        ".sin()".repeat(300)
    );
    let longest = longest_run(expand(source.parse().expect("tokens")));
    assert!((100..=105).contains(&longest), "{longest} operations");
}

/// The most operations between the `;`, `,` and braces of one delimiter.
fn longest_run(tokens: TokenStream) -> usize {
    let (mut longest, mut run) = (0, 0);
    for token in tokens {
        match token {
            TokenTree::Punct(punct) if ";,".contains(punct.as_char()) => run = 0,
            TokenTree::Punct(punct) if "+-*/.".contains(punct.as_char()) => run += 1,
            TokenTree::Group(group) => longest = longest.max(longest_run(group.stream())),
            _ => {}
        }
        longest = longest.max(run);
    }
    longest
}

#[test]
fn vectors_that_are_written_out_have_a_limit_with_a_message() {
    let field = |ty: &str| {
        let items = "coordinates(x), kinetic = der(x).powi(2), potential = x * big.dot(big)";
        messages(&expanded_struct(format!("#[evi({items})] struct Long {{ big: {ty} }}")))
    };
    for ty in
        ["[f64; 999999999999]", "[[f64; 9223372036854775807]; 9223372036854775807]", "SVector<f64, 10001>"]
    {
        let messages = field(ty);
        assert!(messages.len() == 1 && messages[0].starts_with("`big` has "), "{messages:?}");
    }
    assert_eq!(field("[f64; 10000]"), Vec::<String>::new());
    let repeated: String =
        (1..7).map(|k| format!("let v{k} = [{}], ", format!("v{}, ", k - 1).repeat(8))).collect();
    let potential = "potential = v4[0][0][0][0].norm()";
    refused(&format!("let v0 = [x, y], {repeated} {KINETIC}, {potential}"), "a vector of 65536 numbers");
    let nested: String = (1..20_000).map(|k| format!("let v{k} = [v{0}], ", k - 1)).collect();
    let potential = "potential = v7[0][0][0][0][0][0][0].norm()";
    refused(
        &format!("let v0 = [x, y], {nested} {KINETIC}, {potential}"),
        "vectors of vectors have at most 8 levels",
    );
    let sizes = "1, ".repeat(10_000);
    let items = format!("coordinates(p: [{sizes}]), lagrangian = sum(0..1, |i| der(p[i]).norm_squared())");
    let messages = messages(&expanded_struct(format!("#[evi({items})] struct Long;")));
    assert!(
        messages.iter().any(|message| message == "`p` has 10000 sizes, an array at most 8"),
        "{messages:?}"
    );
}
