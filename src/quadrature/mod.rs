//! Integration rules for the axis and the cross-section of a beam, because the accuracy of every
//! element matrix is that of its rule. Gauss rules of any order come from three-term
//! recurrences, the disk rules of Orzechowski 2012, eq. (19)-(21) and Table 1, from Gauss rules
//! in the squared radius, and rules for planar scenes from projecting a section on one axis. All
//! are computed in twice the working precision and rounded once, and carry derivatives when the
//! numbers do.

mod disk;
mod fit;
mod line;
mod project;
mod twofold;

pub use disk::{annulus, disk_of_radius, disk_order};
pub use line::{gauss_from_recurrence, gauss_legendre, gauss_legendre_on, gauss_radau};
pub use project::project;

pub(crate) use disk::{circle, wall};
pub(crate) use fit::{Shape, Weighted, chebyshev, fit, pairs};
pub(crate) use line::{Nodes, legendre_nodes};
pub(crate) use twofold::Twofold;

use crate::error::{Error, Result, finite, positive};
use crate::scalar::{Algebra, Real};

/// Highest order (nodes of a line rule, diameters of a disk rule) that is computed; it serves
/// polynomials to degree 511.
pub const MAX_ORDER: usize = 256;

/// `order` if there is at least one node and not too many, a typed error otherwise.
fn admissible(order: usize) -> Result<usize> {
    match order {
        0 => Err(Error::TooFew {
            what: "order of the rule",
            value: 0,
            least: 1,
            remedy: "a rule of order n is exact to degree 2 n - 1",
        }),
        1..=MAX_ORDER => Ok(order),
        _ => Err(Error::Unsupported {
            what: format!("a rule of order {order}, above {MAX_ORDER}"),
            remedy: "split the region and use a lower order on each part",
        }),
    }
}

/// An integration rule: the integral of `f` over a region of `C` coordinates is close to the
/// sum of `weights[i] * f(points[i])`, and equal to it for polynomials of total degree up to
/// `degree`. Coordinates and weights carry the units of the region (m and m^C for a physical
/// one, none for a unit one).
///
/// ```
/// let rule = ancf::quadrature::disk_order::<f64>(3)?;
/// let fourth_moment = rule.integrate(|[y, _]| y.powi(4));
/// assert!((fourth_moment - std::f64::consts::PI / 8.0).abs() < 1e-15);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Cubature<R, const C: usize> {
    points: Vec<[R; C]>,
    weights: Vec<R>,
    degree: usize,
}

impl<R: Real, const C: usize> Cubature<R, C> {
    /// A rule of your own: `points` and as many `weights` (any sign), exact for polynomials of
    /// total degree up to `degree`. That the rule has this degree is the caller's word.
    ///
    /// # Errors
    /// [`Error::TooFew`] without a point, [`Error::Unsupported`] when there are not as many
    /// weights as points, [`Error::NotFinite`] for a coordinate or weight that is not finite.
    ///
    /// ```
    /// use ancf::quadrature::Cubature;
    /// let simpson = Cubature::new(
    ///     vec![[0.0], [0.5], [1.0]],
    ///     vec![1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
    ///     3,
    /// )?;
    /// assert_eq!(simpson.integrate(|[x]| 4.0 * x * x * x), 1.0);
    /// assert!(Cubature::new(vec![[0.0, 0.0]], vec![f64::NAN], 1).is_err());
    /// # Ok::<(), ancf::Error>(())
    /// ```
    pub fn new(points: Vec<[R; C]>, weights: Vec<R>, degree: usize) -> Result<Self> {
        if points.is_empty() {
            return Err(Error::TooFew {
                what: "number of points of the rule",
                value: 0,
                least: 1,
                remedy: "give the points at which the integrand is sampled",
            });
        }
        if points.len() != weights.len() {
            return Err(Error::Unsupported {
                what: format!(
                    "a rule of {} points and {} weights",
                    points.len(),
                    weights.len()
                ),
                remedy: "give one weight for each point",
            });
        }
        for &x in points.iter().flatten() {
            finite("coordinate of an integration point", x)?;
        }
        for &w in &weights {
            finite("weight of an integration point", w)?;
        }
        Ok(Self {
            points,
            weights,
            degree,
        })
    }

    /// This rule, if it serves polynomials of the `asked` degree: what a section was asked for and what
    /// it returned.
    pub(crate) fn reaching(self, asked: usize) -> Result<Self> {
        if self.degree >= asked {
            return Ok(self);
        }
        Err(Error::Unsupported {
            what: format!(
                "a section rule exact to degree {} where degree {asked} was asked for",
                self.degree
            ),
            remedy: "let Section::rule and planar_rule return at least the degree asked for, or an error; verify::section checks it",
        })
    }

    /// The points, in the order of the weights.
    pub fn points(&self) -> &[[R; C]] {
        &self.points
    }

    /// The weights, in the order of the points; their sum is the measure of the region.
    pub fn weights(&self) -> &[R] {
        &self.weights
    }

    /// Largest total degree to which every polynomial is integrated exactly.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether there is no point; false for every rule that can be made.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Points with their weights.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = ([R; C], R)> {
        self.points
            .iter()
            .copied()
            .zip(self.weights.iter().copied())
    }

    /// The integral of `f` by this rule, in the number type that `f` returns: `R` itself, lanes
    /// or dual numbers over it.
    pub fn integrate<T: Algebra<R>>(&self, mut f: impl FnMut([R; C]) -> T) -> T {
        self.iter()
            .fold(T::zero(), |sum, (x, w)| sum + f(x).times(w))
    }

    /// The rule of the region enlarged about the origin by `factor` (dimensionless, or in metres
    /// for a unit region).
    ///
    /// # Errors
    /// [`Error::NotPositive`] for a factor that is not finite and above zero,
    /// [`Error::NotFinite`] when the result is too large for the number type.
    pub fn scaled(&self, factor: R) -> Result<Self> {
        let factor = positive("scale factor of the rule", factor)?;
        let measure = (0..C).fold(R::one(), |product, _| product * factor);
        Self::new(
            self.points.iter().map(|x| x.map(|x| x * factor)).collect(),
            self.weights.iter().map(|&w| w * measure).collect(),
            self.degree,
        )
    }
}

impl<R: Real> Cubature<R, 2> {
    /// The rule of the image of the region under `x -> matrix x + shift`, `matrix` given by
    /// rows: a rotated or sheared section, an ellipse from a disk. The degree is kept.
    ///
    /// # Errors
    /// [`Error::NotFinite`] for an entry that is not finite, [`Error::NotPositive`] when the
    /// determinant vanishes, so that the image has no area.
    pub fn affine(&self, matrix: [[R; 2]; 2], shift: [R; 2]) -> Result<Self> {
        let [[a, b], [c, d]] = matrix;
        for entry in [a, b, c, d] {
            finite("entry of the affine map", entry)?;
        }
        let what = "absolute determinant of the affine map";
        let measure = positive(what, (a * d - b * c).abs())?;
        let image = |&[y, z]: &[R; 2]| [a * y + b * z + shift[0], c * y + d * z + shift[1]];
        Self::new(
            self.points.iter().map(image).collect(),
            self.weights.iter().map(|&w| w * measure).collect(),
            self.degree,
        )
    }
}
