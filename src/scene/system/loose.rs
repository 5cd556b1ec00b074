//! Whether supports and joints leave a scene a motion that deforms nothing: what tells a mechanism
//! from a structure whose stiffness is lost in rounding. It is asked only where a tangent is
//! singular, and answered by geometry alone, which no slenderness robs of digits.

use super::System;
use crate::element::NodalVector;
use crate::scalar::Real;
use crate::solver::Structure;
use crate::tensor::cross;

/// Beams and bodies beyond which the question would cost more than the answer is worth.
const MOST: usize = 64;

impl<R: Real, const D: usize> System<R, D> {
    /// Whether the bodies can move as rigid ones from a state `u`; `None` where springs or nonlinear
    /// constraints hold them, too, or they are too many.
    pub(super) fn moves_rigidly(&self, u: &[R]) -> Option<bool> {
        let geometry = self.connectors.is_empty() && self.constraints.is_empty();
        if !geometry || self.bodies.len() > MOST {
            return None;
        }
        // Motions of the bodies, and what supports and joints refuse of them.
        let (mut motions, mut refused) = (Vec::new(), Vec::new());
        for body in 0..self.bodies.len() {
            for k in 0..D * (D + 1) / 2 {
                let mut motion = self.rigid(body, k, u);
                let mut allowed = motion.clone();
                self.unknowns.follow(&mut allowed);
                for ((x, y), unit) in motion.iter_mut().zip(&mut allowed).zip(self.measure()) {
                    (*x, *y) = (*x / *unit, (*x - *y) / *unit);
                }
                motions.push(motion);
                refused.push(allowed);
            }
        }
        Some(rank(refused) < rank(motions))
    }

    /// Changes of all coordinates by a rigid motion of one body: translations, then rotations about
    /// its first node.
    fn rigid(&self, body: usize, k: usize, u: &[R]) -> Vec<R> {
        let body = &self.bodies[body];
        let unit = |k: usize| std::array::from_fn(|c| if c == k { R::one() } else { R::zero() });
        let turn: [R; 3] = match k.checked_sub(D) {
            None => [R::zero(); 3],
            Some(_) if D == 2 => unit(2),
            Some(axis) => unit(axis),
        };
        let mut motion = vec![R::zero(); u.len()];
        let (first, per_node) = (body.range().start, body.vectors().len());
        for (i, start) in body.range().step_by(D).enumerate() {
            let position = body.vectors()[i % per_node] == NodalVector::Position;
            let arm = std::array::from_fn(|c| match (c < D, position) {
                (false, _) => R::zero(),
                (_, false) => self.reference[start + c] + u[start + c],
                (_, true) => {
                    let from_first = self.reference[start + c] - self.reference[first + c];
                    from_first + (u[start + c] - u[first + c])
                }
            });
            let turned = cross(&turn, &arm);
            for c in 0..D {
                let along = position && c == k;
                motion[start + c] = turned[c] + if along { R::one() } else { R::zero() };
            }
        }
        motion
    }
}

/// How many of the vectors are independent to half the digits of their numbers, by Gram and
/// Schmidt with the largest first.
fn rank<R: Real>(mut vectors: Vec<Vec<R>>) -> usize {
    let square = |v: &Vec<R>| v.iter().map(|x| *x * *x).sum::<R>();
    let mut least = R::zero();
    for rank in 0..vectors.len() {
        let rest = vectors.iter().enumerate().skip(rank);
        let sizes = rest.map(|(i, v)| (i, square(v)));
        let larger = |a: (usize, R), b: (usize, R)| if b.1 > a.1 { b } else { a };
        let (largest, size) = sizes.fold((rank, R::zero()), larger);
        if rank == 0 {
            least = size * R::lit(R::EPSILON);
        }
        if size <= least {
            return rank;
        }
        vectors.swap(rank, largest);
        let (known, rest) = vectors.split_at_mut(rank + 1);
        let known = &known[rank];
        for other in rest {
            let share = known.iter().zip(&*other).map(|(a, b)| *a * *b).sum::<R>() / size;
            for (x, a) in other.iter_mut().zip(known) {
                *x -= share * *a;
            }
        }
    }
    vectors.len()
}
