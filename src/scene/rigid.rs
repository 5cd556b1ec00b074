//! Rigid bodies and point masses in natural coordinates: position and slopes, as in a node of a
//! beam, so that joints to beams, loads and motions take them as they are. The mass matrix is
//! constant, and rigidity is a nonlinear constraint like any other (Garcia de Jalon and Bayo 1994).
//! What fixes a body's slopes besides (a hinge or weld of two bodies, a clamp, a closed loop) says
//! again that they keep their length: such conditions are found when the system is assembled, and
//! not solved for.

use std::ops::Range;

use super::chain::{Body, Elastic};
use super::tie::Constraint;
use super::{Node, Placed, Scene};
use crate::element::NodalVector;
use crate::error::{Error, Result, finite, positive};
use crate::scalar::{Algebra, Real};
use crate::solver::{BandMatrix, Matrix, Part, Ready};
use crate::tensor::dot;

const VECTORS: [NodalVector; 4] = [
    NodalVector::Position,
    NodalVector::Slope(0),
    NodalVector::Slope(1),
    NodalVector::Slope(2),
];

/// A rigid body before it is placed in a [`Scene`](super::Scene) by
/// [`add_body`](super::Scene::add_body): one node with a position and `D` orthonormal slopes, the
/// body's axes.
///
/// ```
/// use ancf::prelude::*;
///
/// // A ball of 2 kg and 0.1 m at the end of a rubber rod.
/// let rubber = SaintVenantKirchhoff::isotropic(2.0e7, 0.0)?;
/// let mut scene = Scene::<f64, 3>::new();
/// let rod = Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::full(rubber))
///     .straight([0.0; 3], [1.0, 0.0, 0.0], 4)
///     .density(1000.0);
/// let rod = scene.add(rod)?;
/// let inertia = 0.4 * 2.0 * 0.1 * 0.1;
/// let ball = RigidBody::new(2.0, [[inertia, 0.0, 0.0], [0.0, inertia, 0.0], [0.0, 0.0, inertia]])
///     .at([1.0, 0.0, 0.0])
///     .centre([0.1, 0.0, 0.0]);
/// let ball = scene.add_body(ball)?;
/// scene.join(rod.end(), ball.start(), Joint::Rigid)?;
/// # scene.pin(rod.start())?;
/// # scene.assemble()?;
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct RigidBody<R, const D: usize> {
    mass: R,
    inertia: [[R; 3]; 3],
    centre: [R; D],
    position: [R; D],
    frame: [[R; D]; D],
}

impl<R: Real, const D: usize> RigidBody<R, D> {
    /// A body of a mass (kg) and an inertia tensor (kg m^2) about its centre of mass in its own
    /// axes; in the plane only the last entry, about the normal, counts. Its node lies at the
    /// origin and its axes are the global ones unless told otherwise.
    pub fn new(mass: R, inertia: [[R; 3]; 3]) -> Self {
        let unit = |a: usize, c: usize| if a == c { R::one() } else { R::zero() };
        Self {
            mass,
            inertia,
            centre: [R::zero(); D],
            position: [R::zero(); D],
            frame: std::array::from_fn(|a| std::array::from_fn(|c| unit(a, c))),
        }
    }

    /// The node's position (m).
    pub fn at(mut self, position: [R; D]) -> Self {
        self.position = position;
        self
    }

    /// The centre of mass (m) relative to the node, in the body's axes.
    pub fn centre(mut self, centre: [R; D]) -> Self {
        self.centre = centre;
        self
    }

    /// The body's axes in global components: orthonormal and right-handed.
    pub fn turned(mut self, frame: [[R; D]; D]) -> Self {
        self.frame = frame;
        self
    }

    pub(super) fn place(self, offset: usize) -> Result<Body<R, D>> {
        let mass = positive("mass of a rigid body [kg]", self.mass)?;
        for number in self.centre.iter().chain(&self.position) {
            finite("coordinate of a rigid body [m]", *number)?;
        }
        for number in self.inertia.as_flattened() {
            finite("inertia of a rigid body [kg m^2]", *number)?;
        }
        super::beam::checked(R::zero(), (self.position, self.frame))?;
        let inertia = &self.inertia;
        let half = R::lit(0.5);
        // Second moments of mass, which natural coordinates take, from moments of inertia.
        let second: [[R; D]; D] = std::array::from_fn(|a| {
            std::array::from_fn(|b| match (D, a == b) {
                (2, true) => half * inertia[2][2],
                (2, false) => R::zero(),
                (_, true) => half * (inertia[0][0] + inertia[1][1] + inertia[2][2]) - inertia[a][a],
                _ => -inertia[a][b],
            })
        });
        for a in 0..D {
            for b in 0..a {
                let gap = (second[a][b] - second[b][a]).abs();
                let product = second[a][a] * second[b][b] - second[a][b] * second[b][a];
                let size = (second[a][a] + second[b][b]).abs();
                let small = R::lit(64.0 * R::EPSILON);
                if gap > size * small || product < -size * size * small {
                    return Err(refused(inertia));
                }
            }
            if second[a][a] < R::zero() {
                return Err(refused(inertia));
            }
        }
        if D == 3 {
            let minor =
                |a: usize, b: usize| second[1][a] * second[2][b] - second[1][b] * second[2][a];
            let volume = second[0][0] * minor(1, 2) - second[0][1] * minor(0, 2)
                + second[0][2] * minor(0, 1);
            let size: R = (0..D).map(|a| second[a][a]).sum();
            if volume < -size * size * size * R::lit(64.0 * R::EPSILON) {
                return Err(refused(inertia));
            }
        }
        let mut moments = vec![vec![R::zero(); D + 1]; D + 1];
        moments[0][0] = mass;
        for a in 0..D {
            moments[0][a + 1] = mass * self.centre[a];
            moments[a + 1][0] = moments[0][a + 1];
            for b in 0..D {
                moments[a + 1][b + 1] = second[a][b] + mass * self.centre[a] * self.centre[b];
            }
        }
        let description = format!("a rigid body of {:.4e} kg", mass.largest());
        let frame = self.frame;
        let rigid = Rigid {
            vectors: std::iter::once(self.position).chain(frame).collect(),
            moments,
            offset,
        };
        let count = D + 1;
        Ok(Body::of_node(
            Box::new(rigid),
            &VECTORS[..count],
            offset..offset + count * D,
            frame,
            description,
        ))
    }
}

fn refused<R: Real>(inertia: &[[R; 3]; 3]) -> Error {
    Error::Unsupported {
        what: format!(
            "a rigid body with the inertia {:?} kg m^2, which no distribution of mass has",
            inertia.map(|row| row.map(R::value))
        ),
        remedy: "give a symmetric tensor about the centre of mass, whose principal moments are none larger than the sum of the other two",
    }
}

impl<R: Real, const D: usize> Scene<R, D> {
    /// Places a rigid body and returns the handle that names its only node. Its axes are held
    /// orthonormal by nonlinear constraints.
    ///
    /// # Errors
    /// For a mass that is not positive, an inertia that no body has, a frame that is not
    /// orthonormal, and numbers that are not finite.
    pub fn add_body(&mut self, body: RigidBody<R, D>) -> Result<Placed> {
        let body = body.place(self.size)?;
        self.size = body.range().end;
        self.bodies.push(body);
        let placed = Placed {
            scene: self.id,
            body: self.bodies.len() - 1,
            nodes: 1,
        };
        let axis = |a| (placed.start(), NodalVector::Slope(a));
        match D {
            2 => self.bind::<_, 2, 3>(std::array::from_fn(axis), Orthonormal)?,
            _ => self.bind::<_, 3, 6>(std::array::from_fn(axis), Orthonormal)?,
        }
        Ok(placed)
    }

    /// A point mass (kg) on a node.
    ///
    /// # Errors
    /// When there is no such node or the mass is not positive.
    pub fn mass(&mut self, node: Node, mass: R) -> Result<()> {
        let mass = positive("point mass [kg]", mass)?;
        let at = self.coordinates(node, NodalVector::Position)?;
        self.masses.push((at / D, mass));
        Ok(())
    }
}

/// A placed rigid body.
#[derive(Debug)]
struct Rigid<R, const D: usize> {
    /// Position and axes in the reference state.
    vectors: Vec<[R; D]>,
    /// Moments of mass of the products of `1` and the body's coordinates.
    moments: Vec<Vec<R>>,
    offset: usize,
}

impl<R: Real, const D: usize> Elastic<R, D> for Rigid<R, D> {
    fn energy(&self, _u: &[R]) -> R {
        R::zero()
    }

    fn force(&self, _part: Option<&Part>, _u: &[R], _q: &mut [R]) {}

    fn parts(&self, each: &mut dyn FnMut(&Part)) {
        each(&Part::whole(self.offset + self.vectors.len() * D));
    }

    fn tangent(
        &self,
        _u: &[R],
        mass: Option<R>,
        k: &mut Matrix<R>,
        _ready: Option<Ready<'_, R>>,
    ) -> Result<()> {
        let Some(share) = mass else { return Ok(()) };
        for (i, moments) in self.moments.iter().enumerate() {
            let start = self.offset + i * D;
            k.add_alike(start, start, D, share, &moments[i..])?;
        }
        Ok(())
    }

    fn has_strain(&self) -> bool {
        true
    }

    fn secant(&self, _viscosity: R, _from: &[R], _to: &[R], _q: &mut [R]) {}

    fn secant_tangent(
        &self,
        _viscosity: R,
        _from: &[R],
        _to: &[R],
        _k: &mut Matrix<R>,
    ) -> Result<()> {
        Ok(())
    }

    fn add_mass_times(&self, _part: Option<&Part>, factor: R, a: &[R], out: &mut [R]) {
        let range = self.offset..self.offset + self.vectors.len() * D;
        let rows = out[range.clone()].chunks_exact_mut(D).zip(&self.moments);
        for (out, moments) in rows {
            for (a, m) in a[range.clone()].chunks_exact(D).zip(moments) {
                for c in 0..D {
                    out[c] += factor * *m * a[c];
                }
            }
        }
    }

    fn inertia(&self, mass: &mut BandMatrix<R>, first: &mut [R]) -> Result<()> {
        let start = self.offset / D;
        mass.add_block(start, D + 1, &self.moments.concat())?;
        for (i, moment) in self.moments[0].iter().enumerate() {
            first[start + i] += *moment;
        }
        Ok(())
    }

    fn reference(&self, e: &mut [R]) {
        e[self.offset..self.offset + self.vectors.len() * D]
            .copy_from_slice(self.vectors.as_flattened());
    }

    fn vector(&self, _node: usize, vector: NodalVector) -> [R; D] {
        let place = VECTORS.iter().position(|v| *v == vector);
        let vector = place.and_then(|at| self.vectors.get(at));
        vector.copied().unwrap_or([R::zero(); D])
    }

    fn couple(&self, tell: &mut dyn FnMut(&[Range<usize>])) {
        tell(&[self.offset..self.offset + self.vectors.len() * D]);
    }

    fn shape(&self, _s: R, y: &[R; D]) -> (usize, Vec<R>) {
        let mut shape = vec![R::one()];
        shape.extend(y);
        // There is no axis to go along.
        shape[1] = R::zero();
        (self.offset, shape)
    }
}

/// `V` vectors of unit length at right angles: half of `e_a . e_b` minus the identity.
#[derive(Debug)]
struct Orthonormal;

impl<R: Real, const D: usize, const V: usize, const M: usize> Constraint<R, D, V, M>
    for Orthonormal
{
    fn residual<T: Algebra<R>>(&self, _time: T, x: &[[T; D]; V]) -> [T; M] {
        const { assert!(M == V * (V + 1) / 2, "one condition for each pair") };
        let mut g = [T::zero(); M];
        let mut m = 0;
        for a in 0..V {
            for b in a..V {
                g[m] = match a == b {
                    true => (dot(&x[a], &x[b]) - T::one()) * T::lit(0.5),
                    false => dot(&x[a], &x[b]),
                };
                m += 1;
            }
        }
        g
    }
}
