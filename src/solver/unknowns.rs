//! What a structure is solved for. Supports, joints that share coordinates, linear constraints and
//! motions given in time all say the same: some coordinates follow linearly from others. Those are
//! eliminated before anything is solved, `x = T q + C f(t)`, so that no multiplier is carried for
//! them and a definite stiffness stays definite.

mod stretches;

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use super::band::Profile;
use super::order::number;
use crate::error::{Error, Result, finite};
use crate::scalar::Real;
pub(super) use stretches::Stretches;

/// A linear condition on coordinates: `sum_i a_i x_i + sum_k b_k f_k = 0` at every time.
#[derive(Debug, Clone)]
pub struct Condition<R> {
    /// Coordinates and their coefficients `a_i`.
    pub terms: Vec<(usize, R)>,
    /// Motions known in time and their coefficients `b_k`.
    pub known: Vec<(usize, R)>,
}

impl<R: Real> Condition<R> {
    /// Coordinate `i` does not move.
    pub fn fixed(i: usize) -> Self {
        Self {
            terms: vec![(i, R::one())],
            known: Vec::new(),
        }
    }

    /// Coordinates `i` and `j` move together.
    pub fn shared(i: usize, j: usize) -> Self {
        Self {
            terms: vec![(i, R::one()), (j, -R::one())],
            known: Vec::new(),
        }
    }

    /// Coordinate `i` follows motion `k`.
    pub fn driven(i: usize, k: usize) -> Self {
        Self {
            terms: vec![(i, R::one())],
            known: vec![(k, -R::one())],
        }
    }
}

/// A coordinate that follows from others and from known motions.
#[derive(Debug, Clone)]
struct Follower<R> {
    coordinate: usize,
    /// Coordinates that are unknowns.
    terms: Vec<(usize, R)>,
    known: Vec<(usize, R)>,
}

impl<R: Real> Follower<R> {
    fn sum(&self, x: &[R]) -> R {
        self.terms.iter().map(|(i, a)| *a * x[*i]).sum()
    }
}

/// Where a coordinate is found.
#[derive(Debug, Clone, Copy)]
enum Place {
    Unknown(usize),
    Follower(usize),
}

/// The coordinates `x` of a structure in terms of its unknowns `q`, which are coordinates
/// themselves: those that no condition makes follow. Cloning is cheap: the tables are shared.
#[derive(Debug, Clone)]
pub struct Unknowns<R> {
    tables: Arc<Tables<R>>,
}

#[derive(Debug)]
struct Tables<R> {
    places: Vec<Place>,
    free: Vec<usize>,
    /// How many unknowns in a row each coordinate starts; zero for followers.
    runs: Vec<usize>,
    followers: Vec<Follower<R>>,
    /// Whether unknowns are numbered as their coordinates are, and no coordinate follows others.
    ordered: bool,
    profile: Profile,
}

impl<R: Real> Unknowns<R> {
    /// Every coordinate an unknown, coupled as the profile says.
    pub fn all(profile: Profile) -> Self {
        let size = profile.size();
        let tables = Tables {
            places: (0..size).map(Place::Unknown).collect(),
            free: (0..size).collect(),
            runs: (1..=size).rev().collect(),
            followers: Vec::new(),
            ordered: true,
            profile,
        };
        Self {
            tables: Arc::new(tables),
        }
    }

    /// `size` coordinates under conditions. `couple` is called with a function to be told every
    /// set of coordinates (given by ranges) that an element couples with each other.
    ///
    /// A condition that follows from the others is dropped. Of two coordinates that a joint shares,
    /// the one with the higher index follows.
    ///
    /// # Errors
    /// [`Error::NoSuchCoordinate`], a coefficient that is not finite,
    /// [`Error::Contradiction`] for two motions of one coordinate, [`Error::TooFew`] when nothing
    /// is left to solve for.
    pub fn new(
        size: usize,
        conditions: impl IntoIterator<Item = Condition<R>>,
        couple: impl Fn(&mut dyn FnMut(&[Range<usize>])),
    ) -> Result<Self> {
        Self::with_multipliers(size, 0..0, conditions, couple)
    }

    /// The same where some coordinates are Lagrange multipliers: those are numbered after all
    /// unknowns that they couple with.
    ///
    /// # Errors
    /// Those of [`new`](Self::new).
    pub fn with_multipliers(
        size: usize,
        multipliers: Range<usize>,
        conditions: impl IntoIterator<Item = Condition<R>>,
        couple: impl Fn(&mut dyn FnMut(&[Range<usize>])),
    ) -> Result<Self> {
        // What elimination leaves of equal terms is rounding.
        let noise = |largest: R| largest * R::lit(64.0 * R::EPSILON);
        let (followers, _) = eliminate(size, conditions, noise)?;
        let mut places = vec![Place::Unknown(0); size];
        for (k, follower) in followers.iter().enumerate() {
            places[follower.coordinate] = Place::Follower(k);
        }
        let mut free = Vec::with_capacity(size - followers.len());
        for (i, place) in places.iter_mut().enumerate() {
            if let Place::Unknown(q) = place {
                *q = free.len();
                free.push(i);
            }
        }
        if free.is_empty() {
            return Err(Error::TooFew {
                what: "number of coordinates that can move",
                value: 0,
                least: 1,
                remedy: "release a support",
            });
        }
        let mut cliques = Vec::new();
        couple(&mut |ranges| {
            let mut clique = Vec::new();
            for i in ranges.iter().cloned().flatten() {
                match &places[i] {
                    Place::Unknown(q) => clique.push(*q),
                    Place::Follower(k) => {
                        for (j, _) in &followers[*k].terms {
                            if let Place::Unknown(q) = places[*j] {
                                clique.push(q);
                            }
                        }
                    }
                }
            }
            if !clique.is_empty() {
                cliques.push(clique);
            }
        });
        let multiplier = |q: usize| multipliers.contains(&free[q]);
        let (order, profile) = number(free.len(), &cliques, multiplier)?;
        let free: Vec<usize> = order.into_iter().map(|q| free[q]).collect();
        for (q, i) in free.iter().enumerate() {
            places[*i] = Place::Unknown(q);
        }
        let tables = Tables {
            runs: runs(size, &free),
            ordered: free.is_sorted() && followers.iter().all(|f| f.terms.is_empty()),
            places,
            free,
            followers,
            profile,
        };
        Ok(Self {
            tables: Arc::new(tables),
        })
    }

    /// Unknowns of `copies` equal structures, numbered coordinate by coordinate: copy `c` of
    /// coordinate `i` is `i * copies + c`. Motions given in time are those of every copy.
    ///
    /// # Errors
    /// [`Error::TooFew`] without copies.
    pub fn repeated(&self, copies: usize) -> Result<Self> {
        let Tables {
            places,
            free,
            runs: _,
            followers,
            ordered,
            profile,
        } = &*self.tables;
        let spread = |count: usize| (0..count).flat_map(|i| (0..copies).map(move |c| (i, c)));
        let place = |(i, c): (usize, usize)| match places[i] {
            Place::Unknown(q) => Place::Unknown(q * copies + c),
            Place::Follower(k) => Place::Follower(k * copies + c),
        };
        let follower = |(k, c): (usize, usize)| {
            let follower: &Follower<R> = &followers[k];
            let term = |(i, a): &(usize, R)| (i * copies + c, *a);
            Follower {
                coordinate: follower.coordinate * copies + c,
                terms: follower.terms.iter().map(term).collect(),
                known: follower.known.clone(),
            }
        };
        let range = |(q, reach): (usize, &usize)| q * copies..(reach + 1) * copies;
        let ranges = profile.reach().iter().enumerate().map(range);
        let coordinate = |(q, c): (usize, usize)| free[q] * copies + c;
        let spread_free: Vec<usize> = spread(free.len()).map(coordinate).collect();
        let tables = Tables {
            places: spread(places.len()).map(place).collect(),
            runs: runs(places.len() * copies, &spread_free),
            free: spread_free,
            followers: spread(followers.len()).map(follower).collect(),
            ordered: *ordered,
            profile: Profile::from_ranges(free.len() * copies, ranges)?,
        };
        Ok(Self {
            tables: Arc::new(tables),
        })
    }

    /// Number of coordinates.
    pub fn coordinates(&self) -> usize {
        self.tables.places.len()
    }

    /// Number of unknowns.
    pub fn count(&self) -> usize {
        self.tables.free.len()
    }

    /// The coordinate that each unknown is.
    pub fn free(&self) -> &[usize] {
        &self.tables.free
    }

    /// Which unknowns couple.
    pub fn profile(&self) -> &Profile {
        &self.tables.profile
    }

    /// The unknowns among coordinates.
    pub(super) fn gather(&self, coordinates: &[R], unknowns: &mut [R]) {
        let all = 0..self.count();
        self.each_run(all, |q, i| unknowns[q].copy_from_slice(&coordinates[i]));
    }

    /// The coordinates that the unknowns make.
    pub(super) fn spread(&self, unknowns: &[R], coordinates: &mut [R]) {
        let all = 0..self.count();
        self.each_run(all, |q, i| coordinates[i].copy_from_slice(&unknowns[q]));
        self.follow(coordinates);
    }

    /// [`spread`](Self::spread) for some of the coordinates, which are [`in_order`](Self::in_order), from
    /// their unknowns on.
    pub(super) fn spread_within(
        &self,
        within: Range<usize>,
        unknowns: &[R],
        coordinates: &mut [R],
    ) {
        let (first, end) = (self.before(within.start), self.before(within.end));
        self.each_run(first..end, |q, i| {
            coordinates[i].copy_from_slice(&unknowns[q.start - first..q.end - first]);
        });
        for follower in self.followers_within(within) {
            coordinates[follower.coordinate] = R::zero();
        }
    }

    /// How many of the unknowns come before a coordinate where all are [`in_order`](Self::in_order).
    pub(super) fn before(&self, coordinate: usize) -> usize {
        self.tables.free.partition_point(|i| *i < coordinate)
    }

    /// Calls `each` with some of the unknowns in a row and with the coordinates that they are.
    fn each_run(&self, some: Range<usize>, mut each: impl FnMut(Range<usize>, Range<usize>)) {
        let mut q = some.start;
        while q < some.end {
            let i = self.tables.free[q];
            let count = self.in_a_row(i).min(some.end - q);
            each(q..q + count, i..i + count);
            q += count;
        }
    }

    /// Generalised forces of the coordinates turned into those of the unknowns, `T^T Q`, in place:
    /// those of a follower go to what it follows and leave zero behind.
    pub fn reduce(&self, force: &mut [R]) {
        self.reduce_within(0..self.coordinates(), 0, force);
    }

    /// [`reduce`](Self::reduce) for the followers among some coordinates, of forces that start at the
    /// coordinate `first`.
    pub(super) fn reduce_within(&self, coordinates: Range<usize>, first: usize, force: &mut [R]) {
        for follower in self.followers_within(coordinates) {
            let q = force[follower.coordinate - first];
            force[follower.coordinate - first] = R::zero();
            for (i, a) in &follower.terms {
                force[*i - first] += *a * q;
            }
        }
    }

    fn followers_within(&self, coordinates: Range<usize>) -> &[Follower<R>] {
        let followers = &self.tables.followers;
        let before = |end: usize| followers.partition_point(|f| f.coordinate < end);
        &followers[before(coordinates.start)..before(coordinates.end)]
    }

    /// Makes changes of the followers those that the changes of the unknowns bring, in place.
    pub fn follow(&self, change: &mut [R]) {
        for follower in &self.tables.followers {
            change[follower.coordinate] = follower.sum(change);
        }
    }

    /// Makes the followers obey the conditions with the motions `known`, in place.
    ///
    /// # Errors
    /// Those of `known`.
    pub fn impose(&self, x: &mut [R], known: impl Fn(usize) -> Result<R>) -> Result<()> {
        for follower in &self.tables.followers {
            let mut sum = follower.sum(x);
            for (k, b) in &follower.known {
                sum += *b * known(*k)?;
            }
            x[follower.coordinate] = sum;
        }
        Ok(())
    }

    /// The unknowns that coordinate `i` is made of, with their coefficients.
    pub(super) fn combination(&self, i: usize) -> Combination<'_, R> {
        match self.tables.places[i] {
            Place::Unknown(q) => Combination::Unknown(q),
            Place::Follower(k) => Combination::Sum(&self.tables.followers[k].terms),
        }
    }

    /// The unknown that coordinate `i` is.
    #[inline]
    pub(super) fn unknown(&self, i: usize) -> Option<usize> {
        match self.tables.places[i] {
            Place::Unknown(q) => Some(q),
            Place::Follower(_) => None,
        }
    }

    /// The unknowns in a row, at most `n`, that the coordinates from `offset` on begin with.
    #[inline]
    pub(super) fn stretch(&self, offset: usize, n: usize) -> Option<Range<usize>> {
        match self.tables.places[offset] {
            Place::Unknown(first) => Some(first..first + n.min(self.tables.runs[offset])),
            Place::Follower(_) => None,
        }
    }

    /// Whether unknowns are numbered as their coordinates are, and no coordinate follows others.
    pub(super) fn in_order(&self) -> bool {
        self.tables.ordered
    }

    /// How many coordinates from this one on are unknowns in a row.
    pub(super) fn in_a_row(&self, coordinate: usize) -> usize {
        self.tables.runs[coordinate]
    }

    /// The first unknown of `n` coordinates from `offset` on, if they are unknowns in a row.
    #[inline]
    pub(super) fn run(&self, offset: usize, n: usize) -> Option<usize> {
        match (self.tables.runs[offset], self.tables.places[offset]) {
            (run, Place::Unknown(first)) if run >= n => Some(first),
            _ => None,
        }
    }
}

/// How many unknowns in a row each of `size` coordinates starts, `free` being the unknowns.
fn runs(size: usize, free: &[usize]) -> Vec<usize> {
    let mut runs = vec![0; size];
    for (q, &i) in free.iter().enumerate().rev() {
        let goes_on = free.get(q + 1) == Some(&(i + 1));
        runs[i] = if goes_on { runs[i + 1] + 1 } else { 1 };
    }
    runs
}

/// What a coordinate is in terms of unknowns.
pub(super) enum Combination<'a, R> {
    /// An unknown itself.
    Unknown(usize),
    /// A sum over other coordinates, all of them unknowns.
    Sum(&'a [(usize, R)]),
}

/// Rows under elimination: one column per coordinate, then one per known motion.
type Row<R> = BTreeMap<usize, R>;

/// Which of some conditions on `size` coordinates follow from those before them, by their order;
/// coefficients up to `noise` count as none.
pub(crate) fn dependent<R: Real>(
    size: usize,
    conditions: impl IntoIterator<Item = Condition<R>>,
    noise: R,
) -> Result<Vec<usize>> {
    let (_, dropped) = eliminate(size, conditions, |_| noise)?;
    Ok(dropped)
}

/// Solves the conditions for as many coordinates as they bind, by Gauss-Jordan elimination with
/// the largest coefficient as the pivot, and tells those that bind nothing. `noise` is the size up
/// to which a coefficient of a row with the largest one given is taken for rounding.
fn eliminate<R: Real>(
    size: usize,
    conditions: impl IntoIterator<Item = Condition<R>>,
    noise: impl Fn(R) -> R,
) -> Result<(Vec<Follower<R>>, Vec<usize>)> {
    let mut dropped = Vec::new();
    // Solved rows by the coordinate they give, and where each coordinate or motion is used.
    let mut solved: BTreeMap<usize, Row<R>> = BTreeMap::new();
    let mut users: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (n, condition) in conditions.into_iter().enumerate() {
        let mut row = Row::new();
        let mut largest = R::zero();
        for (i, a) in &condition.terms {
            if *i >= size {
                return Err(Error::NoSuchCoordinate { index: *i, size });
            }
            let a = finite("coefficient of a linear constraint", *a)?;
            largest = largest.larger(a.abs());
            match solved.get(i) {
                Some(given) => add(&mut row, a, given),
                None => *row.entry(*i).or_insert(R::zero()) += a,
            }
        }
        for (k, b) in &condition.known {
            let b = finite("coefficient of a linear constraint", *b)?;
            *row.entry(size + *k).or_insert(R::zero()) += b;
        }
        let noise = noise(largest);
        let counts = |a: &R| a.abs() > noise;
        // A coefficient that vanishes may have a derivative that does not.
        row.retain(|_, a| R::ORDER > 0 || counts(a));
        let bound = row.iter().filter(|(i, a)| **i < size && counts(a));
        let pivot = bound.max_by(|(i, a), (j, b)| {
            let order = a.abs().partial_cmp(&b.abs());
            order.unwrap_or(std::cmp::Ordering::Equal).then(i.cmp(j))
        });
        let Some((&pivot, &coefficient)) = pivot else {
            if !row.values().any(counts) {
                dropped.push(n);
                continue;
            }
            return Err(Error::Contradiction {
                coordinates: condition.terms.iter().map(|(i, _)| *i).collect(),
            });
        };
        row.remove(&pivot);
        for a in row.values_mut() {
            *a = -*a / coefficient;
        }
        for user in users.remove(&pivot).unwrap_or_default() {
            if let Some(other) = solved.get_mut(&user)
                && let Some(a) = other.remove(&pivot)
            {
                add(other, a, &row);
                for i in row.keys() {
                    users.entry(*i).or_default().push(user);
                }
            }
        }
        for i in row.keys() {
            users.entry(*i).or_default().push(pivot);
        }
        solved.insert(pivot, row);
    }
    let follower = |(coordinate, row): (usize, Row<R>)| {
        let mut follower = Follower {
            coordinate,
            terms: Vec::new(),
            known: Vec::new(),
        };
        for (i, a) in row {
            match i.checked_sub(size) {
                None => follower.terms.push((i, a)),
                Some(k) => follower.known.push((k, a)),
            }
        }
        follower
    };
    Ok((solved.into_iter().map(follower).collect(), dropped))
}

fn add<R: Real>(row: &mut Row<R>, factor: R, other: &Row<R>) {
    for (i, a) in other {
        *row.entry(*i).or_insert(R::zero()) += factor * *a;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(size: usize, conditions: Vec<Condition<f64>>) -> Result<Unknowns<f64>> {
        Unknowns::new(size, conditions, |tell| {
            (1..size).for_each(|i| tell(&[i - 1..i + 1]));
        })
    }

    /// Followers of followers end at unknowns, redundant conditions drop out, and motions arrive.
    #[test]
    fn conditions_are_solved_whatever_their_order() -> Result<()> {
        let mean = Condition {
            terms: vec![(1, 1.0), (0, -0.5), (2, -0.5)],
            known: vec![],
        };
        let given = [
            Condition::shared(2, 4),
            mean,
            Condition::driven(4, 0),
            Condition::shared(4, 2),
            Condition::fixed(5),
        ];
        for start in 0..given.len() {
            let mut conditions = given.to_vec();
            conditions.rotate_left(start);
            let unknowns = chain(6, conditions)?;
            assert_eq!(unknowns.count(), 2);
            let mut x = [7.0; 6];
            for i in unknowns.free() {
                x[*i] = 1.0 + *i as f64;
            }
            unknowns.impose(&mut x, |_| Ok(3.0))?;
            let expected = [x[2] - x[4], x[4] - 3.0, x[1] - 0.5 * (x[0] + x[2]), x[5]];
            assert!(expected.iter().all(|gap| gap.abs() < 1e-15), "{x:?}");
            // Work is the same by coordinates and by unknowns.
            let force = [1.0, -2.0, 3.0, 0.5, 0.25, 9.0];
            let mut moved = [0.0; 6];
            for i in unknowns.free() {
                moved[*i] = 0.3 + *i as f64;
            }
            unknowns.follow(&mut moved);
            let mut reduced = force;
            unknowns.reduce(&mut reduced);
            let work = |q: [f64; 6]| q.iter().zip(&moved).map(|(q, x)| q * x).sum::<f64>();
            assert!((work(force) - work(reduced)).abs() < 1e-14);
        }
        Ok(())
    }

    #[test]
    fn contradictions_and_strangers_are_refused() {
        let twice = vec![Condition::driven(0, 0), Condition::driven(0, 1)];
        let error = chain(2, twice).unwrap_err();
        assert!(matches!(error, Error::Contradiction { .. }), "{error}");
        assert!(chain(2, vec![Condition::fixed(2)]).is_err());
        let all = chain(2, vec![Condition::fixed(0), Condition::fixed(1)]);
        assert!(matches!(all, Err(Error::TooFew { .. })));
    }
}
