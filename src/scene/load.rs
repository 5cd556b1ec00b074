//! Nodal loads: dead forces and moments. A moment acts on slope vectors, and there are several
//! ways to say how; they differ at large strain, so each is named.

use std::fmt::{self, Debug};
use std::ops::Range;
use std::sync::Arc;

use num_dual::Dual;

use crate::error::{Error, Result, finite};
use crate::scalar::{Algebra, Field, Real};
use crate::solver::Matrix;
use crate::tensor::{cross, dot, sum};

pub(super) type Amplitude<R> = Arc<dyn Fn(R) -> R + Send + Sync>;

/// How a moment acts on the slopes `r_x`, `r_y`, `r_z` of a node: the generalised forces `Q` it
/// does work with. They agree at small strain; they differ in what they do when slopes stretch and
/// shear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MomentLaw {
    /// Work-conjugate to the rotation of slope `p` about the moment's axis `n`:
    /// `Q_p = m x p / |n x p|^2`, which has the potential `-|m|` times the angle turned. On a
    /// cross slope (axis 1 or 2) the default way to bend. On `r_x` (axis 0) the couple travels as
    /// shear through the last element, as torsion on one cross slope alone it shears the section:
    /// there the answer depends on the mesh; twist by [`MeanRotation`](Self::MeanRotation).
    SlopeRotation(usize),
    /// Couple of two forces of fixed size that turn with slope `p`: `Q_p = m x p / |p|`.
    FollowerCouple(usize),
    /// Linear normal traction along the unit tangent `t = r_x / |r_x|`:
    /// `Q_{r_y} = -M_z t`, `Q_{r_z} = M_y t`, moment components about the material axes.
    TangentTraction,
    /// Linear second Piola-Kirchhoff traction: as [`TangentTraction`](Self::TangentTraction) with
    /// `r_x` itself in place of the unit tangent.
    PiolaTraction,
    /// Work-conjugate to the mean rotation of the triad: `Q_p = m x p / (2 |p|^2)` on every slope.
    MeanRotation,
    /// Work-conjugate to the rotation of the polar decomposition of the gradient:
    /// `Q_k = w x d_k` with `(tr V I - V) w = m`, `d_k` the rotated axes and `V` the left stretch.
    PolarRotation,
    /// Work-conjugate to the rotation of the section: bending turns its normal `n` along
    /// `r_y x r_z`, torsion both cross slopes about it,
    /// `Q_y = r_z x v + t n x r_y / |r_y|^2`, `Q_z = v x r_y + t n x r_z / |r_z|^2` with
    /// `v = m x n / |r_y x r_z|` and `t = m.n / 2`. A moment of any direction that keeps it while
    /// the section turns, for every element with cross slopes.
    SectionRotation,
}

impl MomentLaw {
    /// Material axes of the slopes the law reads or acts on, in `dimension` dimensions.
    pub(super) fn slopes(self, dimension: usize) -> Range<usize> {
        match self {
            Self::SlopeRotation(axis) | Self::FollowerCouple(axis) => axis..axis + 1,
            Self::SectionRotation => 1..dimension,
            _ => 0..dimension,
        }
    }

    /// Whether the law has a potential for every motion in `dimension` dimensions, so that its
    /// tangent is symmetric.
    fn conservative(self, dimension: usize) -> bool {
        match self {
            Self::SlopeRotation(_) => true,
            Self::MeanRotation | Self::PolarRotation | Self::SectionRotation => dimension == 2,
            _ => false,
        }
    }

    /// Generalised forces on the slopes `p`, embedded in space.
    fn forces<R: Real, T: Algebra<R>>(
        self,
        moment: &[R; 3],
        frame: &[[R; 3]; 3],
        p: &[[T; 3]; 3],
    ) -> [[T; 3]; 3] {
        let m = moment.map(T::lift);
        let square = |v: &[T; 3]| dot(v, v);
        let scaled = |v: [T; 3], k: T| v.map(|c| c * k);
        let mut q = [[T::zero(); 3]; 3];
        match self {
            Self::SlopeRotation(axis) => {
                let size = moment.iter().fold(R::zero(), |s, c| s + *c * *c);
                // Without a moment there is no axis to turn about.
                if !size.is_zero() {
                    let arm = cross(&m, &p[axis]);
                    q[axis] = scaled(arm, square(&arm).recip().times(size));
                }
            }
            Self::FollowerCouple(axis) => {
                q[axis] = scaled(cross(&m, &p[axis]), square(&p[axis]).sqrt().recip());
            }
            Self::TangentTraction | Self::PiolaTraction => {
                let size = match self {
                    Self::TangentTraction => square(&p[0]).sqrt().recip(),
                    _ => T::one(),
                };
                let about = |a: usize| (0..3).map(|c| moment[c] * frame[a][c]).sum::<R>();
                q[1] = scaled(p[0], -size.times(about(2)));
                q[2] = scaled(p[0], size.times(about(1)));
            }
            Self::MeanRotation => {
                let half = T::lit(0.5);
                for a in 0..3 {
                    q[a] = scaled(cross(&m, &p[a]), half * square(&p[a]).recip());
                }
            }
            Self::PolarRotation => {
                let d = polar_rotation(p);
                // V = F R^T in components: sum over columns.
                let v: [[T; 3]; 3] = std::array::from_fn(|i| {
                    std::array::from_fn(|j| {
                        p[0][i] * d[0][j] + p[1][i] * d[1][j] + p[2][i] * d[2][j]
                    })
                });
                let trace = v[0][0] + v[1][1] + v[2][2];
                let a: [[T; 3]; 3] = std::array::from_fn(|i| {
                    std::array::from_fn(|j| if i == j { trace - v[i][j] } else { -v[i][j] })
                });
                let w = solve(&a, &m);
                for k in 0..3 {
                    q[k] = cross(&w, &d[k]);
                }
            }
            Self::SectionRotation => {
                let area = cross(&p[1], &p[2]);
                let per_area = square(&area).sqrt().recip();
                let n = scaled(area, per_area);
                let v = scaled(cross(&m, &n), per_area);
                let half = T::lit(0.5) * dot(&m, &n);
                for (a, bent) in [(1, cross(&p[2], &v)), (2, cross(&v, &p[1]))] {
                    let twisted = scaled(cross(&n, &p[a]), half * square(&p[a]).recip());
                    q[a] = sum(&bent, &twisted);
                }
            }
        }
        q
    }
}

/// Columns of the rotation closest to the gradient with columns `p`, by Higham's iteration
/// `X <- (X + X^-T) / 2`.
fn polar_rotation<T: Field>(p: &[[T; 3]; 3]) -> [[T; 3]; 3] {
    let half = T::lit(0.5);
    let mut x = *p;
    // Quadratic convergence: ten rounds reach rounding from any stretch between 1/10 and 10,
    // derivatives included.
    for _ in 0..10 {
        let cofactor = [
            cross(&x[1], &x[2]),
            cross(&x[2], &x[0]),
            cross(&x[0], &x[1]),
        ];
        let inverse = dot(&x[0], &cofactor[0]).recip();
        for k in 0..3 {
            for c in 0..3 {
                x[k][c] = half * (x[k][c] + cofactor[k][c] * inverse);
            }
        }
    }
    x
}

/// Solves a symmetric 3 x 3 system by cofactors.
fn solve<T: Field>(a: &[[T; 3]; 3], b: &[T; 3]) -> [T; 3] {
    let cofactor = [
        cross(&a[1], &a[2]),
        cross(&a[2], &a[0]),
        cross(&a[0], &a[1]),
    ];
    let inverse = dot(&a[0], &cofactor[0]).recip();
    std::array::from_fn(|c| {
        let sum = cofactor[0][c] * b[0] + cofactor[1][c] * b[1] + cofactor[2][c] * b[2];
        sum * inverse
    })
}

/// A moment vector (N m) in global components and the law by which it acts. In the plane only the
/// third component, normal to the plane, can act.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment<R> {
    /// The moment vector (N m).
    pub vector: [R; 3],
    /// How it acts on the slopes.
    pub law: MomentLaw,
}

impl<R: Real> Moment<R> {
    /// A moment `m` (N m) about the global `z` axis, work-conjugate to the rotation of the cross
    /// slope `r_y`.
    pub fn about_z(m: R) -> Self {
        Self::new([R::zero(), R::zero(), m], MomentLaw::SlopeRotation(1))
    }

    /// A moment `m` (N m) about the global `y` axis, work-conjugate to the rotation of the cross
    /// slope `r_z`.
    pub fn about_y(m: R) -> Self {
        Self::new([R::zero(), m, R::zero()], MomentLaw::SlopeRotation(2))
    }

    /// A moment `m` (N m) about the global `x` axis, work-conjugate to the mean rotation of the
    /// triad: the way to twist a beam along `x`, whose cross slopes turn together.
    pub fn about_x(m: R) -> Self {
        Self::new([m, R::zero(), R::zero()], MomentLaw::MeanRotation)
    }

    /// Any moment vector (N m) with its law.
    pub fn new(vector: [R; 3], law: MomentLaw) -> Self {
        Self { vector, law }
    }

    pub(super) fn check<const D: usize>(&self, frame: &[[R; D]; D]) -> Result<()> {
        for component in self.vector {
            finite("component of a moment [N m]", component)?;
        }
        let off_plane = self.vector[0].abs() + self.vector[1].abs();
        if D == 2 && !off_plane.is_zero() {
            return Err(Error::Unsupported {
                what: format!(
                    "a moment with in-plane components ({}, {}) in a planar scene",
                    self.vector[0].value(),
                    self.vector[1].value()
                ),
                remedy: "give the third component only, or use a spatial scene",
            });
        }
        if let MomentLaw::SlopeRotation(axis) | MomentLaw::FollowerCouple(axis) = self.law
            && axis >= D
        {
            return Err(Error::Unsupported {
                what: format!("a moment on slope {axis} in {D} dimensions"),
                remedy: "slopes are numbered 0 (axis) to D - 1",
            });
        }
        let along = match self.law {
            MomentLaw::SlopeRotation(axis) | MomentLaw::FollowerCouple(axis) => axis,
            MomentLaw::TangentTraction | MomentLaw::PiolaTraction => 0,
            MomentLaw::MeanRotation | MomentLaw::PolarRotation | MomentLaw::SectionRotation => {
                return Ok(());
            }
        };
        let lost: R = (0..D).map(|c| self.vector[c] * frame[along][c]).sum();
        let size = self.vector.iter().fold(R::zero(), |s, c| s + c.abs());
        if lost.abs() > size * R::lit(1e3 * R::EPSILON) {
            return Err(Error::Unsupported {
                what: format!(
                    "a moment with the component {} along material axis {along}, which {:?} cannot carry",
                    lost.value(),
                    self.law
                ),
                remedy: "split the moment, choose another slope, or use MomentLaw::MeanRotation",
            });
        }
        Ok(())
    }
}

/// What a nodal load acts on.
#[derive(Clone)]
pub(super) enum Action<R, const D: usize> {
    /// A force on the position coordinates that start at `at`.
    Force { at: usize, force: [R; D] },
    /// A moment on slopes whose coordinates start at `slopes[axis]`.
    Moment {
        slopes: [usize; D],
        frame: [[R; D]; D],
        moment: Moment<R>,
    },
}

/// A load on a node, with its course in time.
#[derive(Clone)]
pub(super) struct NodalLoad<R, const D: usize> {
    pub(super) action: Action<R, D>,
    pub(super) amplitude: Option<Amplitude<R>>,
}

impl<R: Debug, const D: usize> Debug for NodalLoad<R, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let course = if self.amplitude.is_some() {
            "in time"
        } else {
            "constant"
        };
        match &self.action {
            Action::Force { at, force } => write!(f, "{course} force {force:?} at {at}"),
            Action::Moment { moment, .. } => write!(f, "{course} {moment:?}"),
        }
    }
}

impl<R: Real, const D: usize> NodalLoad<R, D> {
    pub(super) fn symmetric(&self) -> bool {
        match &self.action {
            Action::Force { .. } => true,
            Action::Moment { moment, .. } => moment.law.conservative(D),
        }
    }

    /// Amplitude at a time, refused when it is not finite.
    pub(super) fn amplitude(&self, time: R) -> Result<R> {
        match &self.amplitude {
            None => Ok(R::one()),
            Some(course) => {
                let value = course(time);
                if value.finite() {
                    return Ok(value);
                }
                Err(Error::LoadNotFinite {
                    time: time.value(),
                    value: value.value(),
                })
            }
        }
    }

    /// Adds the generalised forces at coordinates `e` (absolute).
    pub(super) fn add(&self, amplitude: R, e: impl Fn(usize) -> R, q: &mut [R]) {
        match &self.action {
            Action::Force { at, force } => {
                for c in 0..D {
                    q[at + c] += amplitude * force[c];
                }
            }
            Action::Moment {
                slopes,
                frame,
                moment,
            } => {
                let p = embed::<R, D>(|a, c| e(slopes[a] + c));
                let vector = moment.vector.map(|m| m * amplitude);
                let forces = moment.law.forces(&vector, &space(frame), &p);
                for a in moment.law.slopes(D) {
                    for c in 0..D {
                        q[slopes[a] + c] += forces[a][c];
                    }
                }
            }
        }
    }

    /// Whether [`subtract_tangent`](Self::subtract_tangent) does anything.
    pub(super) fn has_tangent(&self) -> bool {
        matches!(self.action, Action::Moment { .. })
    }

    /// Subtracts the derivative of the generalised forces from a tangent.
    pub(super) fn subtract_tangent(
        &self,
        amplitude: R,
        e: impl Fn(usize) -> R,
        k: &mut Matrix<R>,
    ) -> Result<()> {
        let Action::Moment {
            slopes,
            frame,
            moment,
        } = &self.action
        else {
            return Ok(());
        };
        let vector = moment.vector.map(|m| m * amplitude);
        let plain: [[R; 3]; 3] = embed::<R, D>(|a, c| e(slopes[a] + c));
        let frame = space(frame);
        for b in moment.law.slopes(D) {
            for d in 0..D {
                let mut p = plain.map(|column| column.map(Dual::from_re));
                p[b][d] = p[b][d].derivative();
                let forces = moment.law.forces(&vector, &frame, &p);
                for a in moment.law.slopes(D) {
                    for c in 0..D {
                        k.add(slopes[a] + c, slopes[b] + d, -forces[a][c].eps)?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Slopes embedded in space; the third direction of a planar scene is the normal.
fn embed<R: Real, const D: usize>(slope: impl Fn(usize, usize) -> R) -> [[R; 3]; 3] {
    std::array::from_fn(|a| {
        std::array::from_fn(|c| match (a < D, c < D) {
            (true, true) => slope(a, c),
            (false, false) => R::one(),
            _ => R::zero(),
        })
    })
}

fn space<R: Real, const D: usize>(frame: &[[R; D]; D]) -> [[R; 3]; 3] {
    embed::<R, D>(|a, c| frame[a][c])
}
