//! Numbering of unknowns. A chain numbered from end to end couples neighbours only; trees and
//! loops of beams do not number themselves. Here unknowns that couple alike (those of a node) are
//! gathered in groups, and the cheapest of three numberings is chosen before anything is stored:
//! the natural one, one of small bandwidth (Cuthill and McKee 1969, reversed), and one of little
//! fill (approximate minimum degree, Amestoy, Davis and Duff 1996) for a sparse factor.

use std::collections::BTreeSet;

use super::band::Profile;
use super::sparse::Pattern;
use crate::error::Result;

/// A numbering that is cheaper than the natural one by less than this factor is not worth it.
const WORTH_RENUMBERING: f64 = 1.5;
/// Multiplications within an envelope done in the time of one by sparse blocks, measured on stars and
/// grids of spatial beams (`benches/topology.rs`).
const ENVELOPE_SPEED: f64 = 4.0;

/// Groups of unknowns that couple alike, and which of them couple.
struct Graph {
    /// Unknowns of each group, a range in natural numbering.
    groups: Vec<std::ops::Range<usize>>,
    /// Neighbours among the groups that are no multipliers.
    neighbours: Vec<BTreeSet<usize>>,
    /// Groups of multipliers.
    multiplier: Vec<bool>,
}

/// The unknown in natural numbering that each unknown is, and which of them couple. `cliques` are
/// sets of unknowns coupled with each other; multipliers come after all they couple with, so that
/// elimination finds their pivots filled.
pub(super) fn number(
    count: usize,
    cliques: &[Vec<usize>],
    multiplier: impl Fn(usize) -> bool,
) -> Result<(Vec<usize>, Profile)> {
    let graph = Graph::new(count, cliques, multiplier);
    let natural: Vec<usize> = (0..graph.groups.len()).collect();
    let mut order = graph.unknowns(&graph.with_multipliers(&natural));
    let mut profile = envelope(&order, cliques)?;
    let narrow = graph.unknowns(&graph.with_multipliers(&graph.cuthill_mckee()));
    let narrow_profile = envelope(&narrow, cliques)?;
    if profile.cost() > WORTH_RENUMBERING * narrow_profile.cost() {
        (order, profile) = (narrow, narrow_profile);
    }
    if let Some(little_fill) = graph.minimum_degree() {
        let little_fill = graph.with_multipliers(&little_fill);
        let pattern = graph.pattern(&order, cliques, &little_fill);
        if profile.cost() > ENVELOPE_SPEED * pattern.cost() {
            profile = profile.with_pattern(pattern);
        }
    }
    Ok((order, profile))
}

/// Envelope of a numbering.
fn envelope(order: &[usize], cliques: &[Vec<usize>]) -> Result<Profile> {
    let place = inverse(order);
    let span = |clique: &Vec<usize>| {
        let first = clique.iter().map(|q| place[*q]).min()?;
        let last = clique.iter().map(|q| place[*q]).max()?;
        Some(first..last + 1)
    };
    Profile::from_ranges(order.len(), cliques.iter().filter_map(span))
}

fn inverse(order: &[usize]) -> Vec<usize> {
    let mut place = vec![0; order.len()];
    for (new, old) in order.iter().enumerate() {
        place[*old] = new;
    }
    place
}

impl Graph {
    fn new(count: usize, cliques: &[Vec<usize>], is_multiplier: impl Fn(usize) -> bool) -> Self {
        let mut member = vec![Vec::new(); count];
        for (k, clique) in cliques.iter().enumerate() {
            for q in clique {
                if member[*q].last() != Some(&k) {
                    member[*q].push(k);
                }
            }
        }
        let mut groups: Vec<std::ops::Range<usize>> = Vec::new();
        let mut multiplier = Vec::new();
        let mut group = Vec::with_capacity(count);
        for q in 0..count {
            let alike = q > 0
                && !member[q].is_empty()
                && member[q] == member[q - 1]
                && is_multiplier(q) == is_multiplier(q - 1);
            match groups.last_mut() {
                Some(last) if alike => last.end = q + 1,
                _ => {
                    groups.push(q..q + 1);
                    multiplier.push(is_multiplier(q));
                }
            }
            group.push(groups.len() - 1);
        }
        let mut neighbours = vec![BTreeSet::new(); groups.len()];
        for clique in cliques {
            let touched: BTreeSet<usize> = clique.iter().map(|q| group[*q]).collect();
            for a in &touched {
                let others = touched.iter().filter(|b| *b != a && !multiplier[**b]);
                neighbours[*a].extend(others);
            }
        }
        Self {
            groups,
            neighbours,
            multiplier,
        }
    }

    /// An order of groups with every group of multipliers right after the last that it couples
    /// with.
    fn with_multipliers(&self, order: &[usize]) -> Vec<usize> {
        let order = order.iter().filter(|g| !self.multiplier[**g]);
        let order: Vec<usize> = order.copied().collect();
        let mut place = vec![0; self.groups.len()];
        for (k, g) in order.iter().enumerate() {
            place[*g] = k;
        }
        let mut after = vec![Vec::new(); order.len() + 1];
        for g in (0..self.groups.len()).filter(|g| self.multiplier[*g]) {
            let last = self.neighbours[g].iter().map(|n| place[*n]).max();
            after[last.unwrap_or(order.len())].push(g);
        }
        let mut full = Vec::with_capacity(self.groups.len());
        for (k, g) in order.iter().enumerate() {
            full.push(*g);
            full.append(&mut after[k]);
        }
        full.append(&mut after[order.len()]);
        full
    }

    fn unknowns(&self, order: &[usize]) -> Vec<usize> {
        order.iter().flat_map(|g| self.groups[*g].clone()).collect()
    }

    /// Order of small bandwidth of the groups that are no multipliers.
    fn cuthill_mckee(&self) -> Vec<usize> {
        let mut seen = self.multiplier.clone();
        let mut order = Vec::with_capacity(self.groups.len());
        for start in 0..self.groups.len() {
            if seen[start] {
                continue;
            }
            // An end of the component: the far end of what is far from anywhere.
            let mut end = start;
            for _ in 0..3 {
                end = *self.sweep(end, &mut seen.clone()).last().unwrap_or(&end);
            }
            order.extend(self.sweep(end, &mut seen));
        }
        order.reverse();
        order
    }

    /// Breadth first from a group, neighbours of low degree first.
    fn sweep(&self, start: usize, seen: &mut [bool]) -> Vec<usize> {
        let mut order = vec![start];
        seen[start] = true;
        let mut next = 0;
        while next < order.len() {
            let near = self.neighbours[order[next]].iter().copied();
            let mut near: Vec<usize> = near.filter(|g| !seen[*g]).collect();
            near.sort_by_key(|g| self.neighbours[*g].len());
            for g in near {
                seen[g] = true;
                order.push(g);
            }
            next += 1;
        }
        order
    }

    /// Order of little fill of the groups that are no multipliers.
    fn minimum_degree(&self) -> Option<Vec<usize>> {
        let nodes: Vec<usize> = (0..self.groups.len())
            .filter(|g| !self.multiplier[*g])
            .collect();
        let mut place = vec![0; self.groups.len()];
        for (k, g) in nodes.iter().enumerate() {
            place[*g] = k;
        }
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for g in &nodes {
            // With the diagonal: the crate counts on at least one entry in a column.
            let mut column: Vec<isize> = self.neighbours[*g]
                .iter()
                .map(|n| place[*n] as isize)
                .collect();
            column.push(place[*g] as isize);
            column.sort_unstable();
            rows.append(&mut column);
            starts.push(rows.len() as isize);
        }
        let control = amd::Control::default();
        let (order, _, _) = amd::order(nodes.len() as isize, &starts, &rows, &control).ok()?;
        Some(order.into_iter().map(|k| nodes[k as usize]).collect())
    }

    /// Pattern of the factor when groups are eliminated in `elimination` order and unknowns are
    /// numbered by `order`.
    fn pattern(&self, order: &[usize], cliques: &[Vec<usize>], elimination: &[usize]) -> Pattern {
        let place = inverse(order);
        let position = inverse(elimination);
        let mut group = vec![0; order.len()];
        for (g, range) in self.groups.iter().enumerate() {
            group[range.clone()].fill(position[g]);
        }
        let ranges = elimination.iter().map(|g| {
            let first = place[self.groups[*g].start];
            first..first + self.groups[*g].len()
        });
        let cliques = cliques.iter().map(|clique| {
            let touched: BTreeSet<usize> = clique.iter().map(|q| group[*q]).collect();
            touched.into_iter().collect::<Vec<usize>>()
        });
        Pattern::new(ranges.collect(), cliques)
    }
}
