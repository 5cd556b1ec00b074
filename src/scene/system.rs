//! The assembled system: coordinates, constant mass, loads and the bodies' elastic forces, as the
//! solvers see them through [`Structure`].

mod equations;
mod loose;
mod saddle;

pub use saddle::Drift;

use std::fmt;
use std::ops::Range;

use super::chain::Body;
use super::joint::Course;
use super::load::NodalLoad;
use super::tie::{Connecting, Holding};
use super::{Node, Permanent, Scene, coordinates, locate};
use crate::element::NodalVector;
use crate::error::{Error, Result, finite};
use crate::scalar::Real;
use crate::solver::band::{BandMatrix, Profile};
use crate::solver::{Condition, Rate, State, Structure, Unknowns, Workspace, held};
use crate::tensor::{add_scaled, cross, sum};

/// Energy balance of a state (J).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies<R> {
    /// Kinetic energy (eq. 7 of Orzechowski 2012).
    pub kinetic: R,
    /// Strain energy (eq. 10).
    pub elastic: R,
    /// Potential of gravity, zero in the reference state.
    pub gravity: R,
    /// Work of nodal loads and of motions given in time.
    pub work: R,
}

impl<R: Real> Energies<R> {
    /// Kinetic plus elastic plus gravity: constant without nodal loads and given motions.
    pub fn total(&self) -> R {
        self.kinetic + self.elastic + self.gravity
    }

    /// [`total`](Self::total) minus the work of loads and given motions: constant along a motion, up to the error
    /// of the time integration (statics books no work).
    pub fn balance(&self) -> R {
        self.total() - self.work
    }
}

/// Momenta of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Momenta<R, const D: usize> {
    /// Linear momentum (kg m/s).
    pub linear: [R; D],
    /// Angular momentum about the origin (kg m^2/s); in the plane only the third component.
    pub angular: [R; 3],
}

/// An assembled scene.
#[derive(Debug)]
pub struct System<R: Real, const D: usize> {
    scene: u64,
    bodies: Vec<Body<R, D>>,
    loads: Vec<NodalLoad<R, D>>,
    permanent: Permanent,
    connectors: Vec<Box<dyn Connecting<R>>>,
    constraints: Vec<Box<dyn Holding<R>>>,
    /// Factor by which the mass is scaled beside the constraints.
    mass_factor: R,
    unknowns: Unknowns<R>,
    courses: Vec<Course<R>>,
    reference: Vec<R>,
    measure: Vec<R>,
    /// Mass over nodal vectors (the same for every component).
    mass: Option<BandMatrix<R>>,
    /// Point masses by the index of the nodal vector.
    masses: Vec<(usize, R)>,
    /// Constant generalised force of gravity.
    weight: Option<Vec<R>>,
}

impl<R: Real, const D: usize> System<R, D> {
    pub(super) fn new(scene: Scene<R, D>) -> Result<Self> {
        let Scene {
            id,
            bodies,
            conditions,
            courses,
            loads,
            connectors,
            mut constraints,
            masses,
            gravity,
            permanent,
            size,
        } = scene;
        if bodies.is_empty() {
            return Err(Error::EmptyScene);
        }
        let mut all = size;
        for constraint in &mut constraints {
            constraint.number(all);
            all += constraint.count();
        }
        let mut reference = vec![R::zero(); all];
        let mut measure = vec![R::one(); all];
        // Rigid bodies are measured by the beams they are joined to.
        let lengths = bodies.iter().map(Body::length);
        let longest = lengths.fold(R::zero(), R::larger);
        let longest = if longest.is_zero() { R::one() } else { longest };
        for body in &bodies {
            body.elastic().reference(&mut reference);
            let per_node = body.vectors().len();
            for (i, unit) in measure[body.range()].iter_mut().enumerate() {
                if body.vectors()[(i / D) % per_node] == NodalVector::Position {
                    let length = body.length();
                    *unit = if length.is_zero() { longest } else { length };
                }
            }
        }
        let couple = |tell: &mut dyn FnMut(&[Range<usize>])| {
            bodies.iter().for_each(|body| body.elastic().couple(tell));
            connectors.iter().for_each(|link| link.couple(tell));
            constraints.iter().for_each(|hold| hold.couple(tell));
        };
        let number =
            |conditions: Vec<_>| Unknowns::with_multipliers(all, size..all, conditions, couple);
        let mut unknowns = number(conditions.clone())?;
        let redundant = saddle::redundant(&unknowns, &courses, &measure, &constraints)?;
        if !redundant.is_empty() {
            let idle = redundant.iter().map(|(i, _)| Condition::fixed(*i));
            unknowns = number(conditions.into_iter().chain(idle).collect())?;
        }
        let massive = bodies.iter().filter(|b| b.has_mass()).count();
        if massive > 0 && massive < bodies.len() {
            return Err(Error::Unsupported {
                what: "a scene in which some beams have a density and others have none".into(),
                remedy: "give every beam a density, or none for statics without gravity",
            });
        }
        let mut mass = None;
        let mut weight = None;
        if massive > 0 {
            let mut coupled = Vec::new();
            for body in &bodies {
                body.elastic().couple(&mut |ranges| {
                    coupled.extend(ranges.iter().map(|r| r.start / D..r.end / D));
                });
            }
            let scalar = Profile::from_ranges(size / D, coupled)?;
            let mut matrix = BandMatrix::symmetric(&scalar);
            let mut first = vec![R::zero(); size / D];
            for body in &bodies {
                body.elastic().inertia(&mut matrix, &mut first)?;
            }
            for (vector, m) in &masses {
                matrix.add(*vector, *vector, *m)?;
                first[*vector] += *m;
            }
            mass = Some(matrix);
            if let Some(g) = gravity {
                weight = Some({
                    let weight = first.iter().flat_map(|m| g.map(|g| *m * g));
                    weight.chain(vec![R::zero(); all - size]).collect()
                });
            }
        } else if gravity.is_some() || !masses.is_empty() {
            return Err(Error::Unsupported {
                what: "gravity or point masses on beams without density".into(),
                remedy: "give the beams a density with Beam::density",
            });
        }
        let mut system = Self {
            scene: id,
            bodies,
            loads,
            permanent,
            connectors,
            constraints,
            mass_factor: R::one(),
            unknowns,
            courses,
            reference,
            measure,
            mass,
            masses,
            weight,
        };
        system.scale_constraints()?;
        system.confirm(&redundant)?;
        Ok(system)
    }

    /// The forces that supports, joints, motions and nonlinear constraints exert on every
    /// coordinate in a state (N on positions, N m on slopes): what internal forces and inertia
    /// need beyond the loads. On a coordinate that only a support holds it is the reaction; where
    /// nothing holds it is what the solver left. Allocates.
    ///
    /// # Errors
    /// When the state is of another system's size or not finite, or a load is not finite.
    pub fn reactions(&self, state: &State<R>) -> Result<Vec<R>> {
        let size = self.reference.len();
        state.check(size)?;
        let mut forces = vec![R::zero(); size];
        Workspace::add_reactions(self, state, &mut forces)?;
        Ok(forces)
    }

    /// The reference state at rest at time zero.
    pub fn rest(&self) -> State<R> {
        let zeros = || vec![R::zero(); self.reference.len()];
        State {
            time: R::zero(),
            displacement: zeros(),
            velocity: zeros(),
            acceleration: zeros(),
            work: R::zero(),
        }
    }

    /// Reference coordinates `e0` (positions in metres, slopes dimensionless), node by node.
    pub fn reference(&self) -> &[R] {
        &self.reference
    }

    /// Displacement of a node's position (m).
    ///
    /// # Errors
    /// When there is no such node.
    pub fn displacement(&self, state: &State<R>, node: Node) -> Result<[R; D]> {
        let at = coordinates(self.scene, &self.bodies, node, NodalVector::Position)?;
        self.check_size(state)?;
        Ok(std::array::from_fn(|c| state.displacement[at + c]))
    }

    /// Position of a node (m).
    ///
    /// # Errors
    /// When there is no such node.
    pub fn position(&self, state: &State<R>, node: Node) -> Result<[R; D]> {
        self.vector(state, node, NodalVector::Position)
    }

    /// Current value of a nodal vector: position (m) or slope.
    ///
    /// # Errors
    /// When there is no such node or its element no such vector.
    pub fn vector(&self, state: &State<R>, node: Node, vector: NodalVector) -> Result<[R; D]> {
        let at = coordinates(self.scene, &self.bodies, node, vector)?;
        self.check_size(state)?;
        Ok(std::array::from_fn(|c| {
            self.reference[at + c] + state.displacement[at + c]
        }))
    }

    /// Index of the first component of a nodal vector in the vectors of a [`State`].
    ///
    /// # Errors
    /// When there is no such node or its element no such vector.
    pub fn coordinate(&self, node: Node, vector: NodalVector) -> Result<usize> {
        coordinates(self.scene, &self.bodies, node, vector)
    }

    /// Current position (m) of the material point at fraction `s` in [0, 1] of the axis of the
    /// beam that `node` belongs to and at the cross position `y` (m) (entry 0 is not used).
    ///
    /// # Errors
    /// When there is no such beam or `s` is not finite.
    pub fn point(&self, state: &State<R>, node: Node, s: R, y: [R; D]) -> Result<[R; D]> {
        let (body, _) = locate(self.scene, &self.bodies, node)?;
        finite("axial position along a beam", s)?;
        self.check_size(state)?;
        let (start, shape) = body.elastic().shape(s, &y);
        let mut r = [R::zero(); D];
        for (i, s) in shape.into_iter().enumerate() {
            let at = start + i * D;
            let e = std::array::from_fn(|c| self.reference[at + c] + state.displacement[at + c]);
            add_scaled(&mut r, s, &e);
        }
        Ok(r)
    }

    /// Sets the velocity field of a rigid motion: `v` (m/s) of the origin and the angular velocity
    /// `omega` (rad/s) (in the plane only its third component acts).
    ///
    /// # Errors
    /// When the state is of another system's size or a component is not finite.
    pub fn set_rigid_velocity(&self, state: &mut State<R>, v: [R; D], omega: [R; 3]) -> Result<()> {
        self.check_size(state)?;
        for component in v.iter().chain(&omega) {
            finite("component of a rigid velocity", *component)?;
        }
        for body in &self.bodies {
            let per_node = body.vectors().len();
            for (i, start) in body.range().step_by(D).enumerate() {
                let e: [R; 3] = std::array::from_fn(|c| match c < D {
                    true => self.reference[start + c] + state.displacement[start + c],
                    false => R::zero(),
                });
                let turned = cross(&omega, &e);
                let position = body.vectors()[i % per_node] == NodalVector::Position;
                for c in 0..D {
                    let drift = if position { v[c] } else { R::zero() };
                    state.velocity[start + c] = drift + turned[c];
                }
            }
        }
        self.impose(state.time, Rate::Velocity, &mut state.velocity)
    }

    fn check_size(&self, state: &State<R>) -> Result<()> {
        let size = self.reference.len();
        Error::check_length(
            "length of the displacements of a state",
            state.displacement.len(),
            size,
        )?;
        Error::check_length(
            "length of the velocities of a state",
            state.velocity.len(),
            size,
        )
    }

    /// Energy balance of a state; terms the scene does not have are zero. Allocates with a mass
    /// matrix.
    ///
    /// # Errors
    /// When the state is of another system's size or not finite.
    pub fn energies(&self, state: &State<R>) -> Result<Energies<R>> {
        state.check(self.reference.len())?;
        let u = &state.displacement;
        let mut kinetic = R::zero();
        if self.mass.is_some() {
            let mut momentum = vec![R::zero(); u.len()];
            self.add_mass_times(R::one(), &state.velocity, &mut momentum);
            let twice: R = momentum
                .iter()
                .zip(&state.velocity)
                .map(|(p, v)| *p * *v)
                .sum();
            kinetic = twice * R::lit(0.5);
        }
        let fall = |w: &Vec<R>| -w.iter().zip(u).map(|(w, u)| *w * *u).sum::<R>();
        Ok(Energies {
            kinetic,
            elastic: self.elastic(u),
            gravity: self.weight.as_ref().map_or(R::zero(), fall),
            work: state.work,
        })
    }

    /// Linear and angular momentum of a state; zero without a mass matrix. Allocates.
    ///
    /// # Errors
    /// When the state is of another system's size or not finite.
    pub fn momenta(&self, state: &State<R>) -> Result<Momenta<R, D>> {
        state.check(self.reference.len())?;
        let mut impulse = vec![R::zero(); self.reference.len()];
        self.add_mass_times(R::one(), &state.velocity, &mut impulse);
        let mut momenta = Momenta {
            linear: [R::zero(); D],
            angular: [R::zero(); 3],
        };
        let space = |v: [R; D]| std::array::from_fn(|c| if c < D { v[c] } else { R::zero() });
        for body in &self.bodies {
            let per_node = body.vectors().len();
            for (i, start) in body.range().step_by(D).enumerate() {
                let e = |c| self.reference[start + c] + state.displacement[start + c];
                let p: [R; D] = std::array::from_fn(|c| impulse[start + c]);
                if body.vectors()[i % per_node] == NodalVector::Position {
                    momenta.linear = sum(&momenta.linear, &p);
                }
                let turn = cross(&space(std::array::from_fn(e)), &space(p));
                momenta.angular = sum(&momenta.angular, &turn);
            }
        }
        Ok(momenta)
    }

    fn elastic(&self, u: &[R]) -> R {
        let bodies = self.bodies.iter().map(|body| body.elastic().energy(u));
        let connectors = self.connectors.iter().map(|link| link.energy(u));
        bodies.chain(connectors).sum()
    }

    /// Calls `give` for every entry of the mass matrix over nodal vectors.
    pub(super) fn each_mass(&self, mut give: impl FnMut(usize, usize, R)) {
        let Some(mass) = &self.mass else { return };
        for i in 0..mass.size() {
            let (first, row) = mass.row(i);
            for (j, m) in (first..).zip(row) {
                give(i, j, *m);
                if i != j {
                    give(j, i, *m);
                }
            }
        }
    }

    /// What is modelled, in words: unknowns, bodies, terms switched on.
    pub fn describe(&self) -> String {
        self.to_string()
    }
}

impl<R: Real, const D: usize> fmt::Display for System<R, D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let on = |there: bool| if there { "yes" } else { "no" };
        let plural = if self.bodies.len() == 1 {
            "beam"
        } else {
            "beams"
        };
        writeln!(
            f,
            "{} {plural} in {D} dimensions, {} coordinates, {} of them held by supports and joints",
            self.bodies.len(),
            self.multipliers().start,
            self.multipliers().start + held(self) - self.unknowns.count()
        )?;
        for body in &self.bodies {
            writeln!(f, "  {}", body.describe())?;
        }
        writeln!(f, "  mass matrix: {}", on(self.mass.is_some()))?;
        writeln!(f, "  gravity: {}", on(self.weight.is_some()))?;
        write!(f, "  nodal loads: {}", self.loads.len())?;
        match self.permanent {
            Permanent {
                loads: 0,
                weight: false,
            } => writeln!(f)?,
            Permanent {
                loads,
                weight: false,
            } => writeln!(f, ", permanent: {loads}")?,
            Permanent { loads, .. } => writeln!(f, ", permanent: gravity and {loads}")?,
        }
        if !self.connectors.is_empty() {
            writeln!(f, "  connectors: {}", self.connectors.len())?;
        }
        if !self.constraints.is_empty() {
            let all = self.multipliers().len();
            write!(f, "  nonlinear constraints: {all}")?;
            match all - held(self) {
                0 => writeln!(f)?,
                idle => writeln!(f, ", {idle} of them implied by the others")?,
            }
        }
        write!(f, "  symmetric tangent: {}", on(self.symmetric()))
    }
}
