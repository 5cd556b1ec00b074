//! The assembled system: coordinates, constant mass, loads and the bodies' elastic forces, as the
//! solvers see them through [`Structure`].

use std::fmt;

use super::chain::Body;
use super::joint::Course;
use super::load::NodalLoad;
use super::{Node, Scene, coordinates, locate};
use crate::element::NodalVector;
use crate::error::{Error, Result, finite};
use crate::scalar::Real;
use crate::solver::band::{BandMatrix, Profile};
use crate::solver::{Matrix, Rate, State, Structure, Unknowns};
use crate::tensor::{add_scaled, cross};

/// Energy balance of a state (J).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Energies<R> {
    /// Kinetic energy (eq. 7 of Orzechowski 2012).
    pub kinetic: R,
    /// Strain energy (eq. 10).
    pub elastic: R,
    /// Potential of gravity, zero in the reference state.
    pub gravity: R,
    /// Work of nodal loads.
    pub work: R,
}

impl<R: Real> Energies<R> {
    /// Kinetic plus elastic plus gravity: constant without nodal loads.
    pub fn total(&self) -> R {
        self.kinetic + self.elastic + self.gravity
    }

    /// [`total`](Self::total) minus the work of loads: constant along a motion, up to the error
    /// of the time integration (statics books no work).
    pub fn balance(&self) -> R {
        self.total() - self.work
    }
}

/// An assembled scene.
#[derive(Debug)]
pub struct System<R: Real, const D: usize> {
    scene: u64,
    bodies: Vec<Body<R, D>>,
    loads: Vec<NodalLoad<R, D>>,
    unknowns: Unknowns<R>,
    courses: Vec<Course<R>>,
    reference: Vec<R>,
    measure: Vec<R>,
    /// Mass over nodal vectors (the same for every component).
    mass: Option<BandMatrix<R>>,
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
            gravity,
            size,
        } = scene;
        if bodies.is_empty() {
            return Err(Error::EmptyScene);
        }
        let unknowns = Unknowns::new(size, conditions, |tell| {
            bodies.iter().for_each(|body| body.elastic().couple(tell));
        })?;
        let mut reference = vec![R::zero(); size];
        let mut measure = vec![R::one(); size];
        for body in &bodies {
            body.elastic().reference(&mut reference);
            let per_node = body.vectors().len();
            for (i, unit) in measure[body.range()].iter_mut().enumerate() {
                if body.vectors()[(i / D) % per_node] == NodalVector::Position {
                    *unit = body.length();
                }
            }
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
            mass = Some(matrix);
            if let Some(g) = gravity {
                weight = Some(first.iter().flat_map(|m| g.map(|g| *m * g)).collect());
            }
        } else if gravity.is_some() {
            return Err(Error::Unsupported {
                what: "gravity on beams without density".into(),
                remedy: "give the beams a density with Beam::density",
            });
        }
        Ok(Self {
            scene: id,
            bodies,
            loads,
            unknowns,
            courses,
            reference,
            measure,
            mass,
            weight,
        })
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
            elastic: self.bodies.iter().map(|b| b.elastic().energy(u)).sum(),
            gravity: self.weight.as_ref().map_or(R::zero(), fall),
            work: state.work,
        })
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
            self.reference.len(),
            self.reference.len() - self.unknowns.count()
        )?;
        for body in &self.bodies {
            writeln!(f, "  {}", body.describe())?;
        }
        writeln!(f, "  mass matrix: {}", on(self.mass.is_some()))?;
        writeln!(f, "  gravity: {}", on(self.weight.is_some()))?;
        writeln!(f, "  nodal loads: {}", self.loads.len())?;
        write!(f, "  symmetric tangent: {}", on(self.symmetric()))
    }
}

impl<R: Real, const D: usize> Structure<R> for System<R, D> {
    fn unknowns(&self) -> &Unknowns<R> {
        &self.unknowns
    }

    fn symmetric(&self) -> bool {
        self.loads.iter().all(NodalLoad::symmetric)
    }

    fn impose(&self, time: R, rate: Rate, x: &mut [R]) -> Result<()> {
        self.unknowns.impose(x, |k| self.courses[k].at(time, rate))
    }

    fn measure(&self) -> &[R] {
        &self.measure
    }

    fn add_internal(&self, u: &[R], q: &mut [R]) {
        for body in &self.bodies {
            body.elastic().force(u, q);
        }
    }

    fn add_external(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        if let Some(weight) = &self.weight {
            for (q, w) in q.iter_mut().zip(weight) {
                *q += factor * *w;
            }
        }
        self.add_applied(time, factor, u, q)
    }

    fn has_applied(&self) -> bool {
        !self.loads.is_empty()
    }

    fn add_applied(&self, time: R, factor: R, u: &[R], q: &mut [R]) -> Result<()> {
        for load in &self.loads {
            let amplitude = factor * load.amplitude(time)?;
            load.add(amplitude, |i| self.reference[i] + u[i], q);
        }
        Ok(())
    }

    fn add_tangent(&self, time: R, factor: R, u: &[R], k: &mut Matrix<R>) -> Result<()> {
        for body in &self.bodies {
            body.elastic().tangent(u, k)?;
        }
        for load in &self.loads {
            let amplitude = factor * load.amplitude(time)?;
            load.subtract_tangent(amplitude, |i| self.reference[i] + u[i], k)?;
        }
        Ok(())
    }

    fn name(&self, i: usize) -> String {
        let inside = |(_, body): &(usize, &Body<R, D>)| body.range().contains(&i);
        let Some((index, body)) = self.bodies.iter().enumerate().find(inside) else {
            return format!("coordinate {i}");
        };
        let vector = (i - body.range().start) / D;
        let per_node = body.vectors().len();
        let what = match body.vectors()[vector % per_node] {
            NodalVector::Position => "the position".to_string(),
            NodalVector::Slope(a) => format!("slope {a}"),
        };
        let component = ["x", "y", "z"][(i % D).min(2)];
        format!(
            "{component} of {what} of node {} of beam {index}",
            vector / per_node
        )
    }

    /// The material triad of every fully parameterised node must keep its orientation.
    fn check(&self, u: &[R]) -> Result<()> {
        for (index, body) in self.bodies.iter().enumerate() {
            if let Some((node, ratio)) = body.inverted(&self.reference, u) {
                return Err(Error::Inverted {
                    body: index,
                    node,
                    ratio: ratio.value(),
                });
            }
        }
        Ok(())
    }

    fn has_mass(&self) -> bool {
        self.mass.is_some()
    }

    fn add_mass_times(&self, factor: R, a: &[R], out: &mut [R]) {
        let Some(mass) = &self.mass else { return };
        for i in 0..mass.size() {
            let (first, row) = mass.row(i);
            for (j, m) in (first..).zip(row) {
                let m = factor * *m;
                for c in 0..D {
                    out[i * D + c] += m * a[j * D + c];
                }
                if i != j {
                    for c in 0..D {
                        out[j * D + c] += m * a[i * D + c];
                    }
                }
            }
        }
    }

    fn add_mass(&self, factor: R, k: &mut Matrix<R>) -> Result<()> {
        let Some(mass) = &self.mass else {
            return Ok(());
        };
        for i in 0..mass.size() {
            let (first, row) = mass.row(i);
            for (j, m) in (first..).zip(row) {
                let m = factor * *m;
                for c in 0..D {
                    k.add(i * D + c, j * D + c, m)?;
                    if i != j {
                        k.add(j * D + c, i * D + c, m)?;
                    }
                }
            }
        }
        Ok(())
    }
}
