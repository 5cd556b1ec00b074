//! Joints between nodes, supports and driven coordinates, nearly all of them linear in nodal
//! coordinates and hence eliminated: what absolute nodal coordinates make easy. A slope is a direction of the
//! section that deforms with it, so a joint that shares slopes carries moments without any
//! rotation parameter.

use std::fmt;
use std::sync::Arc;

use super::tie::Constraint;
use super::{Node, Scene};
use crate::element::NodalVector;
use crate::error::{Error, Result, finite};
use crate::scalar::{Algebra, Real, Scalar};
use crate::solver::Rate;
use crate::tensor::{add_scaled, cross, dot};

/// How two nodes at one place hold each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint<R, const D: usize> {
    /// One position: a ball joint in space, a hinge in the plane.
    Spherical,
    /// One position and one direction, which may stretch: a hinge about the axis given in global
    /// components in the reference state. In the plane use [`Spherical`](Self::Spherical).
    Hinge([R; D]),
    /// One position and one rotation: the nodes are welded at whatever angle they meet, whatever
    /// slopes they have. Slopes that both can express are shared, sections and all; of nodes that
    /// lack slopes the rest of the rotation is held by nonlinear constraints. Between fully
    /// parameterised beams that is one deformation gradient, linear and eliminated; where they meet at an angle, the moment of the one acts on the
    /// axial slope of the other and shears the node's elements by `M / (G A l)`: right for slender
    /// beams, an elbow too soft by a few `E I / (G A l L)` for stout ones.
    Rigid,
}

impl<R: Real, const D: usize> Joint<R, D> {
    /// The combinations of slopes that the two nodes share, each as coefficients of the slopes of
    /// the one and of the other, whose material frames in the reference state are given.
    pub(super) fn shared(
        &self,
        one: &[[R; D]; D],
        other: &[[R; D]; D],
    ) -> Result<Vec<[[R; D]; 2]>> {
        let parts = |v: &[R; D], frame: &[[R; D]; D]| frame.map(|axis| dot(&axis, v));
        match self {
            Self::Spherical => Ok(Vec::new()),
            Self::Hinge(axis) => {
                for component in axis {
                    finite("component of a hinge's axis", *component)?;
                }
                let size = dot(axis, axis).sqrt();
                crate::error::positive("length of a hinge's axis", size)?;
                let axis = axis.map(|c| c / size);
                Ok(vec![[parts(&axis, one), parts(&axis, other)]])
            }
            Self::Rigid => Ok(Vec::new()),
        }
    }
}

/// What welds two nodes at one place.
#[derive(Debug)]
pub(super) struct Weld<R, const D: usize> {
    /// Combinations of slopes that the nodes share.
    pub(super) shared: Vec<[[R; D]; 2]>,
    /// Cosine and sine of the angle in the plane from the only slope of the one node to that of
    /// the other, where both are cross slopes: they turn and stretch together.
    pub(super) turned: Option<[R; 2]>,
    /// Directions, in the material axes of each node, that stay at right angles.
    pub(super) square: Vec<[[R; 3]; 2]>,
    /// Cosine of the angle that the only slopes of the two keep.
    pub(super) angle: Option<R>,
}

impl<R: Real, const D: usize> Weld<R, D> {
    /// Nothing but shared combinations of slopes.
    pub(super) fn of(shared: Vec<[[R; D]; 2]>) -> Self {
        Self {
            shared,
            turned: None,
            square: Vec::new(),
            angle: None,
        }
    }

    /// The weld of nodes with these material frames in the reference state and with slopes along
    /// these axes. What both nodes can express by their slopes they share; what is left of the
    /// rotation is held by conditions of right angles.
    pub(super) fn new(frames: [&[[R; D]; D]; 2], axes: [&[usize]; 2]) -> Self {
        let [one, other] = frames;
        let parts = |v: &[R; D], frame: &[[R; D]; D]| frame.map(|axis| dot(&axis, v));
        let share = |v: &[R; D]| [parts(v, one), parts(v, other)];
        let mut weld = Self::of(Vec::new());
        let small = R::lit(16.0 * R::EPSILON.sqrt());
        let has = |node: usize, v: &[R; D]| {
            let part = |a: &usize| dot(&frames[node][*a], v);
            (0..D).all(|a| axes[node].contains(&a) || part(&a).abs() <= small)
        };
        // Where one node has all slopes those of the other are shared as they are.
        let asked = match [0, 1].map(|node| axes[node].len() == D) {
            [true, _] => 1..2,
            [false, true] => 0..1,
            _ => 0..2,
        };
        for node in asked {
            for a in axes[node] {
                let v = &frames[node][*a];
                let new = |shared: &[[R; D]; 2]| {
                    let both = share(v);
                    let along = dot(&shared[0], &both[0]);
                    along.abs() <= small
                };
                if has(1 - node, v) && weld.shared.iter().all(new) {
                    weld.shared.push(share(v));
                }
            }
        }
        // A node whose slopes are all shared is held.
        if axes.iter().any(|axes| weld.shared.len() == axes.len()) {
            return weld;
        }
        let space = |v: &[R; D]| std::array::from_fn(|c| if c < D { v[c] } else { R::zero() });
        let embedded = |v: &[R; 3], frame: &[[R; D]; D]| {
            let mut parts = frame.map(|axis| dot(&space(&axis), v)).to_vec();
            parts.resize(3, v[2]);
            [parts[0], parts[1], parts[2]]
        };
        let normal = [R::zero(), R::zero(), R::one()];
        let direction = |v: [R; 3]| {
            let length = dot(&v, &v).sqrt();
            v.map(|c| c / length)
        };
        let mut hold = |p: [R; 3], q: [R; 3]| {
            weld.square.push([embedded(&p, one), embedded(&q, other)]);
        };
        match (D, axes[0].len(), axes[1].len()) {
            (2, ..) if axes == [&[1][..], &[1]] => {
                let (a, b) = (space(&one[1]), space(&other[1]));
                weld.turned = Some([dot(&a, &b), cross(&a, &b)[2]]);
            }
            (2, ..) => {
                let slope = space(&other[axes[1][0]]);
                hold(cross(&normal, &slope), slope);
            }
            (_, 2, 2) => {
                // Both planes of slopes contain the line that their normals are normal to.
                let missing = |node: usize| (0..3).find(|a| !axes[node].contains(a)).unwrap_or(0);
                let [n, m] = [0, 1].map(|node| space(&frames[node][missing(node)]));
                let line = direction(cross(&n, &m));
                if weld.shared.is_empty() {
                    let own: [R; D] = std::array::from_fn(|c| line[c]);
                    weld.shared.push(share(&own));
                }
                let slope = cross(&m, &line);
                let p = cross(&line, &slope);
                weld.square
                    .push([embedded(&p, one), embedded(&slope, other)]);
            }
            (_, 1, 1) => {
                let cosine = dot(&one[axes[0][0]], &other[axes[1][0]]);
                weld.angle = Some(cosine);
            }
            (_, plane, _) => {
                // The only slope of one node stays normal to two directions of the other.
                let (with_plane, with_line) = if plane == 2 { (0, 1) } else { (1, 0) };
                let slope = space(&frames[with_line][axes[with_line][0]]);
                let helper = space(&frames[with_plane][axes[with_plane][0]]);
                let first = cross(&slope, &helper);
                let first = match dot(&first, &first) > R::lit(0.1) {
                    true => direction(first),
                    false => {
                        let other = space(&frames[with_plane][axes[with_plane][1]]);
                        direction(cross(&slope, &other))
                    }
                };
                for p in [first, cross(&slope, &first)] {
                    match with_plane {
                        0 => hold(p, slope),
                        _ => hold(slope, p),
                    }
                }
            }
        }
        weld
    }
}

impl<R: Real, const D: usize> Scene<R, D> {
    /// The part of a weld that is not linear.
    pub(super) fn weld(
        &mut self,
        nodes: [Node; 2],
        axes: [Vec<usize>; 2],
        weld: &Weld<R, D>,
    ) -> Result<()> {
        let slopes = |n: usize| {
            axes[n]
                .iter()
                .map(move |a| (nodes[n], NodalVector::Slope(*a)))
        };
        let vectors: Vec<(Node, NodalVector)> = slopes(0).chain(slopes(1)).collect();
        if let (Some(cosine), [one, other]) = (weld.angle, &vectors[..]) {
            return self.bind([*one, *other], Angle { cosine });
        }
        match (&weld.square[..], &vectors[..]) {
            ([pair], [a, b]) => {
                let pairs = [*pair];
                self.bind([*a, *b], Square { axes, pairs })
            }
            ([pair], [a, b, c, d]) => {
                let pairs = [*pair];
                self.bind([*a, *b, *c, *d], Square { axes, pairs })
            }
            ([first, second], [a, b, c]) => {
                let pairs = [*first, *second];
                self.bind([*a, *b, *c], Square { axes, pairs })
            }
            _ => Ok(()),
        }
    }
}

/// Directions of two nodes that stay at right angles. Each direction is a combination of a node's
/// material axes, of which the node's slopes are some and one may follow from the others.
#[derive(Debug)]
struct Square<R, const M: usize> {
    /// Axes of the slopes given, first those of the one node and then those of the other.
    axes: [Vec<usize>; 2],
    /// Components of the directions in the material axes of the nodes.
    pairs: [[[R; 3]; 2]; M],
}

impl<R: Real, const D: usize, const V: usize, const M: usize> Constraint<R, D, V, M>
    for Square<R, M>
{
    fn residual<T: Algebra<R>>(&self, _time: T, x: &[[T; D]; V]) -> [T; M] {
        let (one, other) = x.split_at(self.axes[0].len());
        let frames = [
            completed(&self.axes[0], one),
            completed(&self.axes[1], other),
        ];
        std::array::from_fn(|m| {
            let [p, q]: [[T; 3]; 2] = std::array::from_fn(|n| {
                let mut sum = [T::zero(); 3];
                for a in 0..3 {
                    add_scaled(&mut sum, T::lift(self.pairs[m][n][a]), &frames[n][a]);
                }
                sum
            });
            dot(&p, &q)
        })
    }
}

/// Material axes of a node in space from the slopes it has; the one that is missing is normal to
/// the others.
fn completed<T: Scalar, const D: usize>(axes: &[usize], slopes: &[[T; D]]) -> [[T; 3]; 3] {
    let mut frame = [[T::zero(); 3]; 3];
    let mut known = [false, false, D == 2];
    if known[2] {
        frame[2][2] = T::one();
    }
    for (a, slope) in axes.iter().zip(slopes) {
        known[*a] = true;
        frame[*a] = std::array::from_fn(|c| if c < D { slope[c] } else { T::zero() });
    }
    if known.iter().filter(|known| **known).count() == 2
        && let Some(k) = known.iter().position(|known| !known)
    {
        frame[k] = cross(&frame[(k + 1) % 3], &frame[(k + 2) % 3]);
    }
    frame
}

/// Two directions at a fixed angle, given by its cosine, whatever their lengths.
#[derive(Debug)]
struct Angle<R> {
    cosine: R,
}

impl<R: Real, const D: usize> Constraint<R, D, 2, 1> for Angle<R> {
    fn residual<T: Algebra<R>>(&self, _time: T, [a, b]: &[[T; D]; 2]) -> [T; 1] {
        let lengths = (dot(a, a) * dot(b, b)).sqrt();
        [dot(a, b) - lengths.times(self.cosine)]
    }
}

/// A nodal vector that moves as a given function of time. Its velocity and acceleration follow by
/// dual numbers.
///
/// ```
/// use ancf::scalar::Algebra;
/// use ancf::scene::Motion;
///
/// /// The axial slope of a shaft that spins up from rest.
/// struct SpinUp {
///     acceleration: f64,
/// }
///
/// impl Motion<f64, 2> for SpinUp {
///     fn at<T: Algebra<f64>>(&self, t: T) -> [T; 2] {
///         let angle = (t * t).times(0.5 * self.acceleration);
///         [angle.cos(), angle.sin()]
///     }
/// }
/// ```
pub trait Motion<R: Real, const D: usize>: Send + Sync + 'static {
    /// The nodal vector, position (m) or slope, at `time` (s).
    fn at<T: Algebra<R>>(&self, time: T) -> [T; D];
}

/// One component of a motion, as displacement from the reference or a rate of it.
#[derive(Clone)]
pub(super) struct Course<R>(Arc<dyn Fn(R, Rate) -> R + Send + Sync>);

impl<R> fmt::Debug for Course<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("motion in time")
    }
}

impl<R: Real> Course<R> {
    pub(super) fn new<M: Motion<R, D>, const D: usize>(
        motion: Arc<M>,
        component: usize,
        reference: R,
    ) -> Self {
        Self(Arc::new(move |time, rate| {
            let once = time.variable::<1>(0);
            match rate {
                Rate::Displacement => motion.at(time)[component] - reference,
                Rate::Velocity => R::derivative::<1>(&motion.at(once)[component], 0),
                Rate::Acceleration => {
                    let twice = motion.at(once.variable::<1>(0))[component];
                    let slope = <R::Dual<1> as Algebra<R>>::derivative::<1>(&twice, 0);
                    R::derivative::<1>(&slope, 0)
                }
            }
        }))
    }

    /// Value at a time, refused when it is not finite.
    pub(super) fn at(&self, time: R, rate: Rate) -> Result<R> {
        let value = (self.0)(time, rate);
        if value.finite() {
            return Ok(value);
        }
        Err(Error::LoadNotFinite {
            time: time.value(),
            value: value.value(),
        })
    }
}

/// The place of each slope among the vectors of a node, as far as it has them.
pub(super) fn slopes<const D: usize>(vectors: &[NodalVector]) -> [Option<usize>; D] {
    std::array::from_fn(|a| vectors.iter().position(|v| *v == NodalVector::Slope(a)))
}
