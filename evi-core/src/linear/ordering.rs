//! In which order unknowns are eliminated.

/// For every unknown its place in an order in which unknowns that share an equation stand near each other, so that elimination stays within a
/// band: breadth first from an unknown at the rim, those with few neighbours first (Cuthill & McKee, Proc. 24th ACM Nat. Conf. (1969) 157; its rim as
/// George & Liu, ACM Trans. Math. Softw. 5 (1979) 284). Along a chain the band does not grow with its length.
pub(crate) fn band_places(
    n_unknowns: usize,
    coupled: impl IntoIterator<Item = (usize, usize)>,
) -> Vec<usize> {
    let mut neighbours = vec![Vec::new(); n_unknowns];
    for (a, b) in coupled {
        if a != b && !neighbours[a].contains(&b) {
            neighbours[a].push(b);
            neighbours[b].push(a);
        }
    }
    let mut order = Vec::with_capacity(n_unknowns);
    let mut is_placed = vec![false; n_unknowns];
    for first in 0..n_unknowns {
        if is_placed[first] {
            continue;
        }
        let mut rim = first;
        let mut levels = breadth_first(&neighbours, rim);
        loop {
            let (last, depth) = farthest(&levels, &neighbours);
            let from_last = breadth_first(&neighbours, last);
            if farthest(&from_last, &neighbours).1 <= depth {
                break;
            }
            (rim, levels) = (last, from_last);
        }
        for (unknown, _) in breadth_first(&neighbours, rim) {
            is_placed[unknown] = true;
            order.push(unknown);
        }
    }
    let mut places = vec![0; n_unknowns];
    for (place, unknown) in order.into_iter().enumerate() {
        places[unknown] = place;
    }
    places
}

/// What is connected with `start`, each with its distance.
fn breadth_first(neighbours: &[Vec<usize>], start: usize) -> Vec<(usize, usize)> {
    let mut is_reached = vec![false; neighbours.len()];
    is_reached[start] = true;
    let mut reached = vec![(start, 0)];
    let mut next = 0;
    while next < reached.len() {
        let (unknown, distance) = reached[next];
        next += 1;
        let mut fresh: Vec<usize> =
            neighbours[unknown].iter().copied().filter(|&neighbour| !is_reached[neighbour]).collect();
        fresh.sort_by_key(|&neighbour| (neighbours[neighbour].len(), neighbour));
        for neighbour in fresh {
            is_reached[neighbour] = true;
            reached.push((neighbour, distance + 1));
        }
    }
    reached
}

/// The unknown with fewest neighbours among those at the largest distance, and that distance.
fn farthest(levels: &[(usize, usize)], neighbours: &[Vec<usize>]) -> (usize, usize) {
    let depth = levels.last().map_or(0, |&(_, distance)| distance);
    let rim = levels.iter().filter(|&&(_, distance)| distance == depth);
    let unknown =
        rim.map(|&(unknown, _)| unknown).min_by_key(|&unknown| (neighbours[unknown].len(), unknown));
    (unknown.expect("levels hold their start"), depth)
}

#[cfg(test)]
mod tests {
    use super::band_places;

    /// Largest distance between the places of two that are coupled.
    fn band(n_unknowns: usize, coupled: &[(usize, usize)]) -> usize {
        let places = band_places(n_unknowns, coupled.iter().copied());
        let mut sorted = places.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..n_unknowns), "a permutation: {places:?}");
        coupled.iter().map(|&(a, b)| places[a].abs_diff(places[b])).max().unwrap_or(0)
    }

    #[test]
    fn the_band_of_a_chain_does_not_grow_with_it() {
        // Links with two coordinates and a rod each: rod i holds links i − 1 and i; numbered as unknowns are, rods last.
        for links in [3, 10, 40] {
            let rod = |i: usize| 2 * links + i;
            let coupled: Vec<(usize, usize)> = (0..links)
                .flat_map(|i| [(rod(i), 2 * i), (rod(i), 2 * i + 1)])
                .chain((1..links).flat_map(|i| [(rod(i), 2 * i - 2), (rod(i), 2 * i - 1)]))
                .collect();
            assert!(coupled.iter().any(|&(a, b)| a.abs_diff(b) >= 2 * links - 2), "vacuous");
            assert!(band(3 * links, &coupled) <= 3, "{links} links: {}", band(3 * links, &coupled));
        }
    }

    #[test]
    fn every_part_is_placed() {
        assert_eq!(band(5, &[(0, 4), (1, 3)]), 1);
        assert_eq!(band(3, &[]), 0);
        assert_eq!(band(4, &[(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]), 3);
    }
}
