//! What ties nodes beyond linear conditions: energies between nodes, and nonlinear constraints.
//! Users write one function of nodal vectors; forces, tangents, rates and convective terms follow
//! by dual numbers. A constraint is an element, too: its energy `s (lambda . g + g . g / 2)` has
//! Lagrange multipliers `lambda` among its coordinates and is stationary where `g` vanishes. The
//! second term (the augmented Lagrangian of Hestenes and Powell 1969) vanishes with `g`, so it
//! changes no solution; it makes elimination without pivoting as safe as in a definite matrix.

use std::fmt::Debug;
use std::ops::Range;

use super::{Node, Scene};
use crate::element::NodalVector;
use crate::error::Result;
use crate::formulation::{ElementKernel, Tangent, varied};
use crate::scalar::{Algebra, Real};
use crate::solver::Matrix;

/// `M` conditions `g(t, x) = 0` on `V` nodal vectors `x` in their current values, positions (m) or
/// slopes, to be placed by [`Scene::bind`](super::Scene::bind).
///
/// ```
/// use ancf::prelude::*;
///
/// /// Two points at a fixed distance: a rod without mass.
/// #[derive(Debug)]
/// struct Rod {
///     length: f64,
/// }
///
/// impl<const D: usize> Constraint<f64, D, 2, 1> for Rod {
///     fn residual<T: Algebra<f64>>(&self, _time: T, [a, b]: &[[T; D]; 2]) -> [T; 1] {
///         let mut square = T::zero();
///         for c in 0..D {
///             square += (b[c] - a[c]) * (b[c] - a[c]);
///         }
///         [square.sqrt() - T::lit(self.length)]
///     }
/// }
/// ```
///
/// State conditions so that their derivatives do not vanish where they hold: a length, not the
/// square of its error.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no constraint of {M} conditions on {V} nodal vectors in {D} dimensions"
)]
pub trait Constraint<R: Real, const D: usize, const V: usize, const M: usize>:
    Debug + Send + Sync + 'static
{
    /// Whether the conditions change with time: they then do work, which the energy balance counts.
    fn moves(&self) -> bool {
        false
    }

    /// The conditions that must vanish.
    fn residual<T: Algebra<R>>(&self, time: T, x: &[[T; D]; V]) -> [T; M];
}

/// An energy of `V` nodal vectors in their current values: a spring between nodes or anything else
/// without mass, to be placed by [`Scene::connect`](super::Scene::connect).
///
/// ```
/// use ancf::prelude::*;
///
/// /// A spring that is slack at zero length.
/// #[derive(Debug)]
/// struct Rubber {
///     stiffness: f64,
/// }
///
/// impl<const D: usize> Connector<f64, D, 2> for Rubber {
///     fn energy<T: Algebra<f64>>(&self, [a, b]: &[[T; D]; 2]) -> T {
///         let mut square = T::zero();
///         for c in 0..D {
///             square += (b[c] - a[c]) * (b[c] - a[c]);
///         }
///         square.times(0.5 * self.stiffness)
///     }
/// }
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is no connector of {V} nodal vectors in {D} dimensions"
)]
pub trait Connector<R: Real, const D: usize, const V: usize>:
    Debug + Send + Sync + 'static
{
    /// The energy (J).
    fn energy<T: Algebra<R>>(&self, x: &[[T; D]; V]) -> T;
}

impl<R: Real, const D: usize> Scene<R, D> {
    /// A nonlinear constraint on nodal vectors, enforced by Lagrange multipliers. What is linear is
    /// better said by [`constrain`](Self::constrain) and [`join`](Self::join), which eliminate it.
    ///
    /// ```
    /// # use ancf::prelude::*;
    /// /// A point that slides on the parabola y = x^2.
    /// #[derive(Debug)]
    /// struct Parabola;
    ///
    /// impl Constraint<f64, 2, 1, 1> for Parabola {
    ///     fn residual<T: Algebra<f64>>(&self, _time: T, [[x, y]]: &[[T; 2]; 1]) -> [T; 1] {
    ///         [*y - *x * *x]
    ///     }
    /// }
    ///
    /// # let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
    /// let mut scene = Scene::<f64, 2>::new();
    /// let beam = Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber));
    /// let beam = scene.add(beam.straight([0.0; 2], [1.0, 1.0], 4))?;
    /// scene.clamp(beam.start())?;
    /// scene.bind([(beam.end(), NodalVector::Position)], Parabola)?;
    /// scene.force(beam.end(), [0.05, 0.0])?;
    /// let system = scene.assemble()?;
    /// let mut state = system.rest();
    /// Statics::default().solve(&system, &mut state)?;
    /// let [x, y] = system.position(&state, beam.end())?;
    /// assert!(x > 1.0 && (y - x * x).abs() < 1e-12);
    /// # Ok::<(), ancf::Error>(())
    /// ```
    ///
    /// # Errors
    /// When there is no such node or nodal vector. Conditions that contradict others or have no
    /// derivative are found when the system is assembled or solved; those that say the same as
    /// others are left out.
    pub fn bind<C, const V: usize, const M: usize>(
        &mut self,
        vectors: [(Node, NodalVector); V],
        constraint: C,
    ) -> Result<()>
    where
        C: Constraint<R, D, V, M>,
    {
        let places = self.places(vectors)?;
        self.constraints.push(Box::new(Hold {
            places,
            constraint,
            first: 0,
            scale: [R::one(); M],
        }));
        Ok(())
    }

    /// An energy between nodal vectors, such as that of a spring.
    ///
    /// # Errors
    /// When there is no such node or nodal vector.
    pub fn connect<C, const V: usize>(
        &mut self,
        vectors: [(Node, NodalVector); V],
        connector: C,
    ) -> Result<()>
    where
        C: Connector<R, D, V>,
    {
        let places = self.places(vectors)?;
        self.connectors.push(Box::new(Link { places, connector }));
        Ok(())
    }

    fn places<const V: usize>(&self, vectors: [(Node, NodalVector); V]) -> Result<Places<R, D, V>> {
        let mut places = Places {
            starts: [0; V],
            reference: [[R::zero(); D]; V],
        };
        for (i, (node, vector)) in vectors.into_iter().enumerate() {
            places.starts[i] = self.coordinates(node, vector)?;
            let (body, _) = self.locate(node)?;
            places.reference[i] = body.elastic().vector(node.index, vector);
        }
        Ok(places)
    }
}

/// Nodal vectors of the system, by the index of the first component and the reference value.
#[derive(Debug, Clone, Copy)]
struct Places<R, const D: usize, const V: usize> {
    starts: [usize; V],
    reference: [[R; D]; V],
}

impl<R: Real, const D: usize, const V: usize> Places<R, D, V> {
    fn gather(&self, x: &[R]) -> [[R; D]; V] {
        self.starts
            .map(|start| std::array::from_fn(|c| x[start + c]))
    }

    fn current<T: Algebra<R>>(&self, u: &[[T; D]; V]) -> [[T; D]; V] {
        std::array::from_fn(|i| std::array::from_fn(|c| T::lift(self.reference[i][c]) + u[i][c]))
    }

    fn scatter(&self, force: &[[R; D]; V], q: &mut [R]) {
        for (start, force) in self.starts.iter().zip(force) {
            for c in 0..D {
                q[start + c] += force[c];
            }
        }
    }

    fn ranges(&self) -> impl Iterator<Item = Range<usize>> {
        self.starts.into_iter().map(|start| start..start + D)
    }
}

/// What the system asks of a connector.
pub(super) trait Connecting<R: Real>: Debug + Send + Sync {
    fn energy(&self, u: &[R]) -> R;
    fn force(&self, u: &[R], q: &mut [R]);
    fn tangent(&self, u: &[R], k: &mut Matrix<R>) -> Result<()>;
    fn secant(&self, from: &[R], to: &[R], q: &mut [R]);
    fn secant_tangent(&self, from: &[R], to: &[R], k: &mut Matrix<R>) -> Result<()>;
    fn couple(&self, tell: &mut dyn FnMut(&[Range<usize>]));
}

/// A connector at its nodes: an element whose kernel is the energy given.
#[derive(Debug)]
struct Link<R, C, const D: usize, const V: usize> {
    places: Places<R, D, V>,
    connector: C,
}

impl<R, C, const D: usize, const V: usize> ElementKernel<R, D, V> for Link<R, C, D, V>
where
    R: Real,
    C: Connector<R, D, V>,
{
    fn energy<T: Algebra<R>>(&self, u: &[[T; D]; V]) -> T {
        self.connector.energy(&self.places.current(u))
    }
}

impl<R, C, const D: usize, const V: usize> Connecting<R> for Link<R, C, D, V>
where
    R: Real,
    C: Connector<R, D, V>,
{
    fn energy(&self, u: &[R]) -> R {
        ElementKernel::energy(self, &self.places.gather(u))
    }

    fn force(&self, u: &[R], q: &mut [R]) {
        let mut force = [[R::zero(); D]; V];
        ElementKernel::force(self, &self.places.gather(u), &mut force);
        self.places.scatter(&force, q);
    }

    fn tangent(&self, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        let mut force = [[R::zero(); D]; V];
        let mut tangent: Tangent<R, D, V> = [[[[R::zero(); D]; V]; D]; V];
        ElementKernel::tangent(self, &self.places.gather(u), &mut force, &mut tangent);
        add_tangent(&self.places.starts, &tangent, k)
    }

    fn secant(&self, from: &[R], to: &[R], q: &mut [R]) {
        let mut force = [[R::zero(); D]; V];
        let (from, to) = (self.places.gather(from), self.places.gather(to));
        ElementKernel::secant(self, R::zero(), &from, &to, &mut force);
        self.places.scatter(&force, q);
    }

    fn secant_tangent(&self, from: &[R], to: &[R], k: &mut Matrix<R>) -> Result<()> {
        let mut tangent: Tangent<R, D, V> = [[[[R::zero(); D]; V]; D]; V];
        let (from, to) = (self.places.gather(from), self.places.gather(to));
        ElementKernel::secant_tangent(self, R::zero(), &from, &to, &mut tangent);
        add_tangent(&self.places.starts, &tangent, k)
    }

    fn couple(&self, tell: &mut dyn FnMut(&[Range<usize>])) {
        tell(&self.places.ranges().collect::<Vec<_>>());
    }
}

fn add_tangent<R: Real, const D: usize, const V: usize>(
    starts: &[usize; V],
    tangent: &Tangent<R, D, V>,
    k: &mut Matrix<R>,
) -> Result<()> {
    for (i, rows) in starts.iter().zip(tangent) {
        for c in 0..D {
            for (j, row) in starts.iter().zip(&rows[c]) {
                for d in 0..D {
                    k.add(i + c, j + d, row[d])?;
                }
            }
        }
    }
    Ok(())
}

/// What the system asks of a constraint.
pub(super) trait Holding<R: Real>: Debug + Send + Sync {
    /// The constraint in words.
    fn describe(&self) -> String;
    /// Whether it changes with time.
    fn moves(&self) -> bool;
    /// Number of conditions.
    fn count(&self) -> usize;
    /// Coordinates of its multipliers, once their number is known.
    fn number(&mut self, first: usize);
    /// Scales its conditions by stiffnesses.
    fn scale(&mut self, scales: &[R]);
    /// Tells every derivative of a condition by a coordinate, scaled, or along `[u, v]` its rate.
    fn gradient(&self, time: R, motion: &[&[R]], tell: &mut dyn FnMut(usize, usize, R));
    fn force(&self, time: R, u: &[R], q: &mut [R]);
    fn tangent(&self, time: R, u: &[R], k: &mut Matrix<R>) -> Result<()>;
    /// Adds `factor` times the derivative of the forces of the multipliers alone by the coordinates
    /// held.
    fn curvature(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()>;
    /// The conditions on displacements, or their rates where those are given, too, with the
    /// multiplier and scale of each.
    fn violation(&self, time: R, motion: &[&[R]], tell: &mut dyn FnMut(usize, R, R));
    fn couple(&self, tell: &mut dyn FnMut(&[Range<usize>]));
}

/// A constraint at its nodes, with its multipliers.
#[derive(Debug)]
struct Hold<R, C, const D: usize, const V: usize, const M: usize> {
    places: Places<R, D, V>,
    constraint: C,
    /// Coordinate of the first multiplier.
    first: usize,
    scale: [R; M],
}

type Once<R> = <R as Algebra<R>>::Dual<1>;

impl<R, C, const D: usize, const V: usize, const M: usize> Hold<R, C, D, V, M>
where
    R: Real,
    C: Constraint<R, D, V, M>,
{
    /// Conditions and their derivatives by the nodal vectors.
    fn derivatives<T: Algebra<R>>(&self, time: T, x: &[[T; D]; V]) -> ([T; M], [[[T; D]; V]; M]) {
        let mut g = [T::zero(); M];
        let mut slopes = [[[T::zero(); D]; V]; M];
        for i in 0..V {
            let dual = self
                .constraint
                .residual(time.constant::<D>(), &varied(x, i));
            for m in 0..M {
                g[m] = T::real_part::<D>(&dual[m]);
                for c in 0..D {
                    slopes[m][i][c] = T::derivative::<D>(&dual[m], c);
                }
            }
        }
        (g, slopes)
    }

    fn at(&self, u: &[R]) -> [[R; D]; V] {
        self.places.current(&self.places.gather(u))
    }

    /// Forces per unit of derivative, `s (lambda + g)`.
    fn forces(&self, u: &[R], g: &[R; M]) -> [R; M] {
        std::array::from_fn(|m| self.scale[m] * (u[self.first + m] + g[m]))
    }

    /// Time and nodal vectors `x + tau v + tau^2 a / 2` on the way, as far as the motion is given.
    fn on_the_way<T: Algebra<R>>(&self, tau: T, time: R, motion: &[&[R]]) -> (T, [[T; D]; V]) {
        let mut u = [[T::zero(); D]; V];
        let mut weight = T::one();
        for (k, rate) in motion.iter().enumerate() {
            if k > 0 {
                weight = (weight * tau).times(R::lit(k as f64).recip());
            }
            let rate = self.places.gather(rate);
            for i in 0..V {
                for c in 0..D {
                    u[i][c] += weight.times(rate[i][c]);
                }
            }
        }
        (T::lift(time) + tau, self.places.current(&u))
    }

    /// Derivative by the nodal vectors of the conditions' forces at fixed `forces` per unit of
    /// derivative.
    fn bend(&self, time: R, x: &[[R; D]; V], forces: &[R; M]) -> Tangent<R, D, V> {
        let mut tangent: Tangent<R, D, V> = [[[[R::zero(); D]; V]; D]; V];
        for j in 0..V {
            let (_, dual) = self.derivatives(time.constant::<D>(), &varied(x, j));
            for m in 0..M {
                for i in 0..V {
                    for c in 0..D {
                        for d in 0..D {
                            let bend = R::derivative::<D>(&dual[m][i][c], d);
                            tangent[i][c][j][d] += forces[m] * bend;
                        }
                    }
                }
            }
        }
        tangent
    }

    /// Tells derivatives of the conditions by the coordinates, scaled.
    fn tell(&self, slopes: &[[[R; D]; V]; M], tell: &mut dyn FnMut(usize, usize, R)) {
        for m in 0..M {
            for (start, slope) in self.places.starts.iter().zip(&slopes[m]) {
                for c in 0..D {
                    tell(self.first + m, start + c, self.scale[m] * slope[c]);
                }
            }
        }
    }
}

impl<R, C, const D: usize, const V: usize, const M: usize> Holding<R> for Hold<R, C, D, V, M>
where
    R: Real,
    C: Constraint<R, D, V, M>,
{
    fn describe(&self) -> String {
        format!("the constraint {:?}", self.constraint)
    }

    fn moves(&self) -> bool {
        self.constraint.moves()
    }

    fn count(&self) -> usize {
        M
    }

    fn number(&mut self, first: usize) {
        self.first = first;
    }

    fn scale(&mut self, scales: &[R]) {
        for (scale, given) in self.scale.iter_mut().zip(scales) {
            *scale = *given;
        }
    }

    fn gradient(&self, time: R, motion: &[&[R]], tell: &mut dyn FnMut(usize, usize, R)) {
        if let [u] = motion {
            let (_, slopes) = self.derivatives(time, &self.at(u));
            return self.tell(&slopes, tell);
        }
        let once = R::zero().variable::<1>(0);
        let (time, x) = self.on_the_way(once, time, motion);
        let (_, slopes) = self.derivatives(time, &x);
        let rate = |slope: Once<R>| R::derivative::<1>(&slope, 0);
        self.tell(&slopes.map(|all| all.map(|slope| slope.map(rate))), tell);
    }

    fn force(&self, time: R, u: &[R], q: &mut [R]) {
        let (g, slopes) = self.derivatives(time, &self.at(u));
        let forces = self.forces(u, &g);
        for m in 0..M {
            q[self.first + m] += self.scale[m] * g[m];
            for (start, slope) in self.places.starts.iter().zip(&slopes[m]) {
                for c in 0..D {
                    q[start + c] += forces[m] * slope[c];
                }
            }
        }
    }

    fn tangent(&self, time: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        let x = self.at(u);
        let (g, slopes) = self.derivatives(time, &x);
        let mut tangent = self.bend(time, &x, &self.forces(u, &g));
        for m in 0..M {
            for i in 0..V {
                for c in 0..D {
                    let push = self.scale[m] * slopes[m][i][c];
                    for j in 0..V {
                        for d in 0..D {
                            tangent[i][c][j][d] += push * slopes[m][j][d];
                        }
                    }
                }
            }
        }
        add_tangent(&self.places.starts, &tangent, k)?;
        let mut result = Ok(());
        self.tell(&slopes, &mut |multiplier, i, slope| {
            for (i, j) in [(multiplier, i), (i, multiplier)] {
                if result.is_ok() {
                    result = k.add(i, j, slope);
                }
            }
        });
        result
    }

    fn curvature(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        let forces = self.forces(u, &[R::zero(); M]).map(|q| factor * q);
        let tangent = self.bend(time, &self.at(u), &forces);
        add_tangent(&self.places.starts, &tangent, k)
    }

    fn violation(&self, time: R, motion: &[&[R]], tell: &mut dyn FnMut(usize, R, R)) {
        let once = || R::zero().variable::<1>(0);
        let values: [R; M] = match motion {
            [u] => self.constraint.residual(time, &self.at(u)),
            [_, _] => {
                let (time, x) = self.on_the_way(once(), time, motion);
                let g = self.constraint.residual(time, &x);
                g.map(|g| R::derivative::<1>(&g, 0))
            }
            _ => {
                let (time, x) = self.on_the_way(once().variable::<1>(0), time, motion);
                let g = self.constraint.residual(time, &x);
                g.map(|g| R::derivative::<1>(&<Once<R> as Algebra<R>>::derivative::<1>(&g, 0), 0))
            }
        };
        for (m, value) in values.into_iter().enumerate() {
            tell(self.first + m, value, self.scale[m]);
        }
    }

    fn couple(&self, tell: &mut dyn FnMut(&[Range<usize>])) {
        let multipliers = self.first..self.first + M;
        let ranges = self.places.ranges().chain([multipliers]);
        tell(&ranges.collect::<Vec<_>>());
    }
}
