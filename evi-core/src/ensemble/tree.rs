//! The order in which parts are put together: fixed by the places of chunks, not by when they are finished.

use super::gather::Part;

/// A binary tree over `leaves` chunks, of which the parts that are complete are kept.
///
/// A node is the left half absorbing the right one as soon as both are there; a node without a right half is its left half. Sums are the
/// same to the last bit in whichever order the leaves arrive.
pub(super) struct Tree<P> {
    /// Number of nodes of every level, the leaves first.
    sizes: Vec<usize>,
    /// Level, place and part of the nodes that wait for their other half.
    waiting: Vec<(usize, usize, P)>,
}

impl<P: Part> Tree<P> {
    pub(super) fn new(leaves: usize) -> Self {
        let mut sizes = vec![leaves];
        while let Some(&size) = sizes.last()
            && size > 1
        {
            sizes.push(size.div_ceil(2));
        }
        Self { sizes, waiting: Vec::new() }
    }

    /// Puts in a leaf.
    pub(super) fn put(&mut self, leaf: usize, part: P) {
        let (mut place, mut part) = (leaf, part);
        for level in 0..self.sizes.len() - 1 {
            let other = place ^ 1;
            if other < self.sizes[level] {
                let Some(found) = self.waiting.iter().position(|(at, who, _)| *at == level && *who == other)
                else {
                    return self.waiting.push((level, place, part));
                };
                let (_, _, sibling) = self.waiting.swap_remove(found);
                part = if other < place { joined(sibling, part) } else { joined(part, sibling) };
            }
            place /= 2;
        }
        self.waiting.push((self.sizes.len() - 1, 0, part));
    }

    /// Everything that is there, from left to right; of a complete tree, its root.
    pub(super) fn total(mut self) -> Option<P> {
        self.waiting.sort_by_key(|(level, place, _)| place << level);
        self.waiting.into_iter().map(|(_, _, part)| part).reduce(joined)
    }
}

fn joined<P: Part>(mut first: P, later: P) -> P {
    first.absorb(later);
    first
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memory::{Memory, Recall, Record};

    /// Writes down how it was put together.
    struct Shape(String);

    impl Memory for Shape {
        fn record(&self, _words: &mut Record<'_>) {}
        fn recall(&mut self, _words: &mut Recall<'_>) {}
    }

    impl Part for Shape {
        fn absorb(&mut self, later: Self) {
            self.0 = format!("({} {})", self.0, later.0);
        }
    }

    #[track_caller]
    fn check(leaves: usize, order: &[usize], expected: &str) {
        let mut tree = Tree::new(leaves);
        for &leaf in order {
            tree.put(leaf, Shape(leaf.to_string()));
        }
        assert_eq!(tree.total().map_or(String::new(), |shape| shape.0), expected);
    }

    #[test]
    fn the_shape_does_not_depend_on_the_order_of_arrival() {
        let shape = "(((0 1) (2 3)) (4 5))";
        check(6, &[0, 1, 2, 3, 4, 5], shape);
        check(6, &[5, 3, 1, 0, 2, 4], shape);
        check(5, &[4, 3, 2, 1, 0], "(((0 1) (2 3)) 4)");
        check(1, &[0], "0");
        check(0, &[], "");
    }

    #[test]
    fn what_is_there_of_an_incomplete_tree_is_put_together_from_left_to_right() {
        check(8, &[6, 1, 0, 7, 3], "(((0 1) 3) (6 7))");
    }
}
