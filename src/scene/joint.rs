//! Joints between nodes, supports and driven coordinates, all of them linear in nodal coordinates
//! and hence eliminated: what absolute nodal coordinates make easy. A slope is a direction of the
//! section that deforms with it, so a joint that shares slopes carries moments without any
//! rotation parameter.

use std::fmt;
use std::sync::Arc;

use crate::element::NodalVector;
use crate::error::{Error, Result, finite};
use crate::scalar::{Algebra, Real};
use crate::solver::Rate;
use crate::tensor::dot;

/// How two nodes at one place hold each other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Joint<R, const D: usize> {
    /// One position: a ball joint in space, a hinge in the plane.
    Spherical,
    /// One position and one direction, which may stretch: a hinge about the axis given in global
    /// components in the reference state. In the plane use [`Spherical`](Self::Spherical).
    Hinge([R; D]),
    /// One position and one deformation gradient: the nodes are welded at whatever angle they
    /// meet, sections and all. Where they meet at an angle, the moment of the one acts on the
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
            Self::Rigid => {
                let unit = |k| std::array::from_fn(|j| if j == k { R::one() } else { R::zero() });
                let pair = |k: usize| [parts(&other[k], one), unit(k)];
                Ok((0..D).map(pair).collect())
            }
        }
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
