//! How deep the tokens of a struct may nest.
//!
//! In: the tokens of a struct. Out: the same tokens, or, where something nests deeper than the stages recurse safely, a
//! mistake at its token and a number in its place.

use proc_macro2::{Delimiter, Group, Literal, Punct, Spacing, Span, TokenStream, TokenTree};

use crate::diagnostics::Diagnostics;

/// Levels of parentheses, brackets, braces and signs in an equation, the attribute's own among them. So many need at most 1.4 MB of
/// stack when `syn` is compiled without optimisation, as it is for derives; rust-analyzer gives them 2 MB, rustc 8 MB.
pub(super) const DEEPEST_NESTING: usize = 64;
/// Levels that are spent where types and statements begin, of which one takes twice as much stack: by the first of their words in an
/// equation, and by everything outside of `#[evi(..)]`.
const SPENT_BY_TYPES: usize = DEEPEST_NESTING / 2;

/// The words of Rust that may stand in front of an expression, a type or a pattern. `let` has its place in an equation.
const FOREIGN_WORDS: [&str; 25] = [
    "as", "async", "await", "break", "const", "dyn", "else", "enum", "fn", "for", "if", "impl", "in", "loop",
    "match", "move", "mut", "ref", "return", "static", "struct", "type", "unsafe", "while", "yield",
];

/// The tokens without what nests too deep, which is reported.
pub(super) fn bounded(tokens: TokenStream, diagnostics: &mut Diagnostics) -> TokenStream {
    let mut kept = TokenStream::new();
    let mut between_attributes = Vec::new();
    let outside = Room { levels: DEEPEST_NESTING - SPENT_BY_TYPES, is_foreign: true };
    for token in tokens {
        match &token {
            TokenTree::Group(group) if is_attribute(&between_attributes, group) => {
                kept.extend(outside.fitted(between_attributes.drain(..).collect(), diagnostics));
                kept.extend(Room::WHOLE.fitted(token.into(), diagnostics));
            }
            _ => between_attributes.push(token),
        }
    }
    kept.extend(outside.fitted(between_attributes.into_iter().collect(), diagnostics));
    kept
}

fn is_attribute(before: &[TokenTree], group: &Group) -> bool {
    let is_behind_pound = matches!(before.last(), Some(TokenTree::Punct(punct)) if punct.as_char() == '#');
    is_behind_pound && group.delimiter() == Delimiter::Bracket
}

/// What is left to nest in.
#[derive(Clone, Copy)]
struct Room {
    levels: usize,
    /// Whether types and statements have begun further outside, and have spent their levels.
    is_foreign: bool,
}

impl Room {
    const WHOLE: Self = Self { levels: DEEPEST_NESTING, is_foreign: false };

    fn fitted(self, tokens: TokenStream, diagnostics: &mut Diagnostics) -> TokenStream {
        if self.fits(&tokens) { tokens } else { self.pruned(tokens, diagnostics) }
    }

    fn fits(self, tokens: &TokenStream) -> bool {
        let mut levels = Levels::new(self);
        tokens.clone().into_iter().all(|token| {
            let open = levels.take(&token);
            match token {
                TokenTree::Group(group) => {
                    open < self.levels && self.inside(open, &levels).fits(&group.stream())
                }
                _ => open <= self.levels,
            }
        })
    }

    /// What is left in a group that stands behind `open` levels.
    fn inside(self, open: usize, levels: &Levels) -> Self {
        Self { levels: self.levels - open - 1, is_foreign: levels.is_foreign }
    }

    fn pruned(self, tokens: TokenStream, diagnostics: &mut Diagnostics) -> TokenStream {
        let mut levels = Levels::new(self);
        let mut kept = TokenStream::new();
        let mut is_reported = false;
        for token in tokens {
            let open = levels.take(&token);
            let is_too_deep = open + usize::from(matches!(token, TokenTree::Group(_))) > self.levels;
            if is_too_deep && !is_reported {
                let message = format!(
                    "nested too deeply: at most {DEEPEST_NESTING} levels of parentheses and signs; give what is inside a `let`"
                );
                diagnostics.report(opening_span(&token), message);
            }
            is_reported = is_too_deep;
            match token {
                TokenTree::Group(group) => {
                    let inside = if is_too_deep {
                        TokenTree::from(Literal::f64_unsuffixed(0.0)).into()
                    } else {
                        self.inside(open, &levels).pruned(group.stream(), diagnostics)
                    };
                    let mut shallow = Group::new(group.delimiter(), inside);
                    shallow.set_span(group.span());
                    kept.extend([TokenTree::Group(shallow)]);
                }
                // What is left out is behind a mistake that has been reported.
                token if !is_too_deep => kept.extend([token]),
                _ => {}
            }
        }
        kept
    }
}

fn opening_span(token: &TokenTree) -> Span {
    match token {
        TokenTree::Group(group) => group.span_open(),
        other => other.span(),
    }
}

/// Levels that the tokens of one stream open in front of each other, without parentheses.
struct Levels {
    /// Signs and other operators in front of the operand to come: each nests what is behind it.
    prefixes: usize,
    /// What has no place in an equation, and may nest as it likes: `a = b = c`, `return return x`.
    others: usize,
    /// Those of `A<B<C>>` and `|a, b| |c, d| e`, which go on behind a comma.
    across_commas: usize,
    /// Whether the levels that types and statements spend are spent, and how many were spent here.
    is_foreign: bool,
    spent: usize,
    /// Whether a statement with `let` goes on here, in which `:` begins a type.
    is_let: bool,
    behind: Behind,
}

/// What stands before a token.
#[derive(Clone, Copy, PartialEq)]
enum Behind {
    Nothing,
    Name,
    Operand,
    Operator(char),
    /// The `#` of an attribute, and what stands before it.
    Pound,
}

/// What `<` opens takes as much stack as two groups.
const LEVELS_OF_GENERICS: usize = 2;

impl Levels {
    fn new(room: Room) -> Self {
        Self {
            prefixes: 0,
            others: 0,
            across_commas: 0,
            is_foreign: room.is_foreign,
            spent: 0,
            is_let: false,
            behind: Behind::Nothing,
        }
    }

    /// Takes up the next token; returns the levels that are open at it.
    fn take(&mut self, token: &TokenTree) -> usize {
        match token {
            TokenTree::Punct(punct) => self.punct(punct),
            TokenTree::Ident(word) if FOREIGN_WORDS.iter().any(|foreign| word == foreign) => {
                self.foreign();
                self.others += 1;
                self.behind = Behind::Operator(' ');
            }
            TokenTree::Ident(_) if self.behind == Behind::Name => self.others += 1,
            TokenTree::Ident(name) => {
                self.is_let |= name == "let";
                self.operand(Behind::Name);
            }
            TokenTree::Group(_) if self.behind == Behind::Operand => self.others += 1,
            TokenTree::Literal(_) | TokenTree::Group(_) => {}
        }
        let levels = self.prefixes + self.others + self.across_commas + self.spent;
        match token {
            // Attributes stand in front of what they belong to without nesting it.
            TokenTree::Group(_) if self.behind == Behind::Pound => self.behind = Behind::Operator(' '),
            TokenTree::Literal(_) | TokenTree::Group(_) => self.operand(Behind::Operand),
            _ => {}
        }
        levels
    }

    fn punct(&mut self, punct: &Punct) {
        let before = self.behind;
        let is_alone = punct.spacing() == Spacing::Alone;
        let punct = punct.as_char();
        self.behind = Behind::Operator(punct);
        let is_in_front = matches!(before, Behind::Operator(_) | Behind::Nothing);
        match punct {
            ';' => self.restart(),
            ',' if self.across_commas == 0 => self.restart(),
            '#' => self.behind = Behind::Pound,
            ':' if self.is_let && is_alone && before != Behind::Operator(':') => self.foreign(),
            // Paths are flat.
            ':' => {}
            '<' => {
                self.foreign();
                self.across_commas += LEVELS_OF_GENERICS;
            }
            // What an arrow points at is nested.
            '>' if matches!(before, Behind::Operator('-' | '=')) => self.others += 1,
            '>' => self.across_commas = self.across_commas.saturating_sub(LEVELS_OF_GENERICS),
            '|' => {
                self.foreign();
                self.across_commas += 1;
            }
            '=' => self.others += 1,
            _ if is_in_front => self.prefixes += 1,
            ',' | '+' | '-' | '*' | '/' | '.' => {}
            _ => self.others += 1,
        }
    }

    fn restart(&mut self) {
        (self.prefixes, self.others, self.across_commas) = (0, 0, 0);
        self.is_let = false;
        self.behind = Behind::Nothing;
    }

    fn foreign(&mut self) {
        if !self.is_foreign {
            (self.is_foreign, self.spent) = (true, SPENT_BY_TYPES);
        }
    }

    fn operand(&mut self, behind: Behind) {
        self.prefixes = 0;
        self.behind = behind;
    }
}
