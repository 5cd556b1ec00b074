//! The rectangle, the section that products of Gauss rules are made for.

use super::{MAX_OUTLINE, Section};
use crate::error::{Result, positive};
use crate::quadrature::{Cubature, gauss_legendre_on};
use crate::scalar::Real;

/// A rectangle centred at the origin with sides along the axes.
///
/// ```
/// use ancf::section::{Rectangle, Section};
/// let section = Rectangle::new(0.02_f64, 0.01)?;
/// assert!((section.properties()?.izz - 0.01 * 0.02_f64.powi(3) / 12.0).abs() < 1e-22);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle<R> {
    height_y: R,
    width_z: R,
}

impl<R: Real> Rectangle<R> {
    /// A rectangle that measures `height_y` along y and `width_z` along z (m).
    ///
    /// # Errors
    /// [`Error::NotPositive`](crate::Error::NotPositive) for a side that is not finite and
    /// above zero.
    pub fn new(height_y: R, width_z: R) -> Result<Self> {
        Ok(Self {
            height_y: positive("height of the rectangle [m]", height_y)?,
            width_z: positive("width of the rectangle [m]", width_z)?,
        })
    }

    /// Side along y (m).
    pub fn height_y(&self) -> R {
        self.height_y
    }

    /// Side along z (m).
    pub fn width_z(&self) -> R {
        self.width_z
    }
}

impl<R: Real> Section<R> for Rectangle<R> {
    /// Product of two Gauss-Legendre rules of `degree/2 + 1` nodes.
    fn rule(&self, degree: usize) -> Result<Cubature<R, 2>> {
        let n = degree / 2 + 1;
        let half = R::lit(0.5);
        let [y, z] = [self.height_y, self.width_z].map(|side| (half * side, side));
        let y = gauss_legendre_on(-y.0, y.0, n)?;
        let z = gauss_legendre_on(-z.0, z.0, n)?;
        let pairs = || y.iter().flat_map(|y| z.iter().map(move |z| (y, z)));
        Cubature::new(
            pairs().map(|(([y], _), ([z], _))| [y, z]).collect(),
            pairs().map(|((_, wy), (_, wz))| wy * wz).collect(),
            y.degree(),
        )
    }

    /// The corners and, on each side, an equal share of the points that are left.
    fn outline(&self, n: usize) -> Vec<Vec<[R; 2]>> {
        let n = n.clamp(4, MAX_OUTLINE);
        let (y, z) = (self.height_y * R::lit(0.5), self.width_z * R::lit(0.5));
        let corners = [[-y, -z], [y, -z], [y, z], [-y, z]];
        let mut points = Vec::with_capacity(n);
        for side in 0..4 {
            let (from, to) = (corners[side], corners[(side + 1) % 4]);
            let count = n / 4 + usize::from(side < n % 4);
            for k in 0..count {
                let part = R::lit(k as f64) / R::lit(count as f64);
                points.push([0, 1].map(|c| from[c] + (to[c] - from[c]) * part));
            }
        }
        vec![points]
    }

    /// Gauss-Legendre rule of the height, times the width.
    fn planar_rule(&self, degree: usize) -> Result<Cubature<R, 1>> {
        let half = R::lit(0.5) * self.height_y;
        let line = gauss_legendre_on(-half, half, degree / 2 + 1)?;
        let weights = line.weights().iter().map(|&w| w * self.width_z).collect();
        Cubature::new(line.points().to_vec(), weights, line.degree())
    }
}
