//! What the user states, in the words of the problem: beams and rigid bodies with their supports,
//! joints, constraints, loads and gravity, gathered in a [`Scene`]; and what the solvers see, the
//! assembled [`System`]. Only what the scene asks for is carried on: no mass matrix without density,
//! no gravity or load vector without gravity or loads, no multipliers without nonlinear
//! constraints, no unsymmetric matrices without follower loads.

mod beam;
mod chain;
mod joint;
mod load;
mod rigid;
mod spinning;
mod system;
mod tie;

pub use beam::Beam;
pub use joint::{Joint, Motion};
pub use load::{Moment, MomentLaw};
pub use rigid::RigidBody;
pub use spinning::Spinning;
pub use system::{Drift, Energies, Momenta, System};
pub use tie::{Connector, Constraint};

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::element::{Element, NodalVector};
use crate::error::{Error, Result, finite};
use crate::formulation::Formulation;
use crate::scalar::Real;
use crate::section::Section;
use crate::solver::Condition;
use chain::Body;
use joint::{Course, Weld};
use load::{Action, Amplitude, NodalLoad};
use tie::{Connecting, Holding};

/// A beam placed in a scene: the handle by which its nodes are named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Placed {
    scene: u64,
    body: usize,
    nodes: usize,
}

impl Placed {
    /// The first node.
    pub fn start(self) -> Node {
        self.node(0)
    }

    /// The last node.
    pub fn end(self) -> Node {
        self.node(self.nodes - 1)
    }

    /// Node `index`, counted from 0 at the start; refused by whatever it is passed to when the
    /// beam has no such node.
    pub fn node(self, index: usize) -> Node {
        Node {
            scene: self.scene,
            body: self.body,
            index,
        }
    }

    /// Number of nodes of the beam.
    pub fn nodes(self) -> usize {
        self.nodes
    }
}

/// A node of a placed beam.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Node {
    scene: u64,
    body: usize,
    index: usize,
}

/// A problem under construction, in `D` dimensions with numbers `R`.
///
/// ```
/// use ancf::prelude::*;
///
/// let steel = SaintVenantKirchhoff::isotropic(2.0e11, 0.3)?;
/// let mut scene = Scene::<f64, 3>::new();
/// let beam = scene.add(
///     Beam::new(FullyParameterised, Disk::new(0.01)?, Continuum::selective_reduced(steel))
///         .straight([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], 16),
/// )?;
/// scene.clamp(beam.start())?;
/// scene.force(beam.end(), [0.0, -1.0, 0.0])?;
/// let system = scene.assemble()?;
/// let mut state = system.rest();
/// Statics::default().solve(&system, &mut state)?;
/// let tip = system.displacement(&state, beam.end())?;
/// let slender = -1.0 / (3.0 * 2.0e11 * std::f64::consts::PI * 0.01_f64.powi(4) / 4.0);
/// assert!((tip[1] / slender - 1.0).abs() < 2e-3);
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug)]
pub struct Scene<R: Real, const D: usize> {
    /// Tells the nodes of this scene from those of any other.
    id: u64,
    bodies: Vec<Body<R, D>>,
    conditions: Vec<Condition<R>>,
    courses: Vec<Course<R>>,
    loads: Vec<NodalLoad<R, D>>,
    connectors: Vec<Box<dyn Connecting<R>>>,
    constraints: Vec<Box<dyn Holding<R>>>,
    /// Point masses by the index of the nodal vector.
    masses: Vec<(usize, R)>,
    gravity: Option<[R; D]>,
    permanent: Permanent,
    size: usize,
}

/// Which loads stay when a load factor scales the others.
#[derive(Debug, Clone, Copy, Default)]
struct Permanent {
    /// The first of the nodal loads.
    loads: usize,
    weight: bool,
}

impl<R: Real, const D: usize> Default for Scene<R, D> {
    fn default() -> Self {
        Self::new()
    }
}

impl<R: Real, const D: usize> Scene<R, D> {
    /// An empty scene.
    pub fn new() -> Self {
        static NEXT: AtomicU64 = AtomicU64::new(0);
        Self {
            id: NEXT.fetch_add(1, Ordering::Relaxed),
            bodies: Vec::new(),
            conditions: Vec::new(),
            courses: Vec::new(),
            loads: Vec::new(),
            connectors: Vec::new(),
            constraints: Vec::new(),
            masses: Vec::new(),
            gravity: None,
            permanent: Permanent::default(),
            size: 0,
        }
    }

    /// Places a beam and returns the handle that names its nodes.
    ///
    /// # Errors
    /// For geometry that is not finite, of zero length or without elements, and whatever the
    /// formulation refuses (too few integration points above all).
    pub fn add<E, F, X, const S: usize>(&mut self, beam: Beam<R, E, F, X, D>) -> Result<Placed>
    where
        E: Element<D, S>,
        F: Formulation<R, E, D, S>,
        X: Section<R>,
    {
        const {
            assert!(
                S == E::NODES * E::VECTORS.len(),
                "the number S of an element's shape functions is NODES times the VECTORS of a node"
            )
        }
        let body = beam.place(self.size)?;
        self.size = body.range().end;
        let nodes = body.nodes();
        self.bodies.push(body);
        Ok(Placed {
            scene: self.id,
            body: self.bodies.len() - 1,
            nodes,
        })
    }

    /// Fixes every coordinate of a node, slopes included, as the paper does. The section cannot
    /// contract and the axis cannot stretch there, which a short element feels under axial load;
    /// [`fix`](Self::fix) holds less.
    ///
    /// # Errors
    /// When the beam has no such node.
    pub fn clamp(&mut self, node: Node) -> Result<()> {
        let (body, first) = self.locate(node)?;
        let count = body.vectors().len() * D;
        let fixed = (first..first + count).map(Condition::fixed);
        self.conditions.extend(fixed);
        Ok(())
    }

    /// Fixes the position of a node and leaves its slopes free: a spherical joint to the ground.
    ///
    /// # Errors
    /// When the beam has no such node.
    pub fn pin(&mut self, node: Node) -> Result<()> {
        self.fix(node, NodalVector::Position, [true; D])
    }

    /// Fixes chosen components of one nodal vector.
    ///
    /// # Errors
    /// When the beam has no such node or its element no such nodal vector.
    pub fn fix(&mut self, node: Node, vector: NodalVector, components: [bool; D]) -> Result<()> {
        let first = self.coordinates(node, vector)?;
        let chosen = components.iter().enumerate().filter(|(_, fixed)| **fixed);
        let fixed = chosen.map(|(c, _)| Condition::fixed(first + c));
        self.conditions.extend(fixed);
        Ok(())
    }

    /// Makes chosen components of one nodal vector move as a function of time. Statics goes to
    /// where the motion is at the state's time.
    ///
    /// # Errors
    /// When the beam has no such node or its element no such nodal vector. A value of the motion
    /// that is not finite stops the solver with the time at which it occurred.
    pub fn drive(
        &mut self,
        node: Node,
        vector: NodalVector,
        components: [bool; D],
        motion: impl Motion<R, D>,
    ) -> Result<()> {
        let first = self.coordinates(node, vector)?;
        let (body, _) = self.locate(node)?;
        let reference = body.elastic().vector(node.index, vector);
        let motion = Arc::new(motion);
        for c in (0..D).filter(|c| components[*c]) {
            let driven = Condition::driven(first + c, self.courses.len());
            self.conditions.push(driven);
            let course = Course::new(motion.clone(), c, reference[c]);
            self.courses.push(course);
        }
        Ok(())
    }

    /// Joins two nodes that lie at one place in the reference state. The coordinates they share
    /// are eliminated: a joint costs nothing and holds to the last digit.
    ///
    /// # Errors
    /// When a beam has no such node, the nodes lie apart, a hinge's axis is zero, or an element
    /// lacks a slope that the joint shares.
    pub fn join(&mut self, one: Node, other: Node, joint: Joint<R, D>) -> Result<()> {
        let position = NodalVector::Position;
        let (first, second) = (
            self.coordinates(one, position)?,
            self.coordinates(other, position)?,
        );
        let ((a, start_a), (b, start_b)) = (self.locate(one)?, self.locate(other)?);
        let places = [
            a.elastic().vector(one.index, position),
            b.elastic().vector(other.index, position),
        ];
        let gap = (0..D).fold(R::zero(), |gap, c| {
            gap.larger((places[0][c] - places[1][c]).abs())
        });
        let size = a.length().larger(b.length());
        if gap > size * R::lit(16.0 * R::EPSILON.sqrt()) {
            return Err(Error::Unsupported {
                what: format!("a joint of nodes that lie {} m apart", gap.value()),
                remedy: "join nodes at one place; connect distant ones by a beam or a linear constraint",
            });
        }
        let mut conditions: Vec<_> = (0..D)
            .map(|c| Condition::shared(first + c, second + c))
            .collect();
        let small = R::lit(16.0 * R::EPSILON.sqrt());
        let frames = [a.frame(one.index), b.frame(other.index)];
        let axes: [Vec<usize>; 2] = [a, b].map(|body| {
            let places = joint::slopes::<D>(body.vectors());
            (0..D).filter(|axis| places[*axis].is_some()).collect()
        });
        let weld = match joint {
            Joint::Rigid => Weld::new(frames, [&axes[0], &axes[1]]),
            _ => Weld::of(joint.shared(frames[0], frames[1])?),
        };
        if let Some([cosine, sine]) = weld.turned {
            let slope = |body: &Body<R, D>| joint::slopes::<D>(body.vectors())[1].unwrap_or(0) * D;
            let (p, q) = (start_a + slope(a), start_b + slope(b));
            for (c, (along, across)) in [(cosine, -sine), (sine, cosine)].into_iter().enumerate() {
                conditions.push(Condition {
                    terms: vec![(q + c, R::one()), (p, -along), (p + 1, -across)],
                    known: Vec::new(),
                });
            }
        }
        for shares in &weld.shared {
            let mut terms = Vec::new();
            for (body, start, share, sign) in [
                (a, start_a, shares[0], R::one()),
                (b, start_b, shares[1], -R::one()),
            ] {
                let places = joint::slopes::<D>(body.vectors());
                // A share that vanishes may have a derivative that does not.
                let counts = |axis: &usize| {
                    share[*axis].abs() > small || (R::ORDER > 0 && places[*axis].is_some())
                };
                for axis in (0..D).filter(counts) {
                    let Some(place) = places[axis] else {
                        return Err(Error::Unsupported {
                            what: format!(
                                "{joint:?} at a node without slope {axis}, whose element only has {:?}",
                                body.vectors()
                            ),
                            remedy: "use a fully parameterised element, or turn the material frame so that the joint needs only slopes the node has",
                        });
                    };
                    terms.push((start + place * D, sign * share[axis]));
                }
            }
            conditions.extend((0..D).map(|c| Condition {
                terms: terms.iter().map(|(i, share)| (i + c, *share)).collect(),
                known: Vec::new(),
            }));
        }
        self.conditions.extend(conditions);
        self.weld([one, other], axes, &weld)
    }

    /// Any linear constraint, `sum a u = 0` over displacements `u` of components of nodal vectors
    /// (m for positions, dimensionless for slopes).
    ///
    /// # Errors
    /// When there is no such node, nodal vector or component.
    pub fn constrain(&mut self, terms: &[(Node, NodalVector, usize, R)]) -> Result<()> {
        let mut condition = Condition {
            terms: Vec::with_capacity(terms.len()),
            known: Vec::new(),
        };
        for (node, vector, component, factor) in terms {
            let first = self.coordinates(*node, *vector)?;
            if *component >= D {
                return Err(Error::NoSuchCoordinate {
                    index: *component,
                    size: D,
                });
            }
            condition.terms.push((first + component, *factor));
        }
        self.conditions.push(condition);
        Ok(())
    }

    /// Uniform gravity with acceleration `g` (m/s^2); acts on beams with a density.
    ///
    /// # Errors
    /// When a component is not finite.
    pub fn gravity(&mut self, g: [R; D]) -> Result<()> {
        for component in g {
            finite("acceleration of gravity [m/s^2]", component)?;
        }
        self.gravity = Some(g);
        self.permanent.weight = false;
        Ok(())
    }

    /// Makes the loads stated so far, gravity among them, permanent: along a path of equilibria
    /// ([`Continuation`](crate::solver::Continuation)) and in linear buckling they act in full, and
    /// the load factor is that of the loads stated after. Statics and dynamics bring all loads.
    ///
    /// ```
    /// use ancf::prelude::*;
    ///
    /// // How much can a column carry on its top besides its own weight?
    /// let mut scene = Scene::<f64, 2>::new();
    /// let column = EulerBernoulli::with_stiffness(1e6, 1.0)?;
    /// let column = Beam::new(Cable, Moments::new(1.0, 1.0, 1.0)?, column);
    /// let column = scene.add(column.straight([0.0; 2], [0.0, 1.0], 16).density(1.0))?;
    /// scene.clamp(column.start())?;
    /// scene.gravity([0.0, -4.0])?;
    /// scene.hold_loads();
    /// scene.force(column.end(), [0.0, -1.0])?;
    /// let system = scene.assemble()?;
    /// let path = Continuation::start(&system, system.rest(), 0.0, &Path::default())?;
    /// let buckling = Modes::lowest(1).buckling(&system, path.state(), 0.0)?;
    /// assert!((buckling[0].value - 1.24).abs() < 0.01);
    /// # Ok::<(), ancf::Error>(())
    /// ```
    pub fn hold_loads(&mut self) {
        self.permanent = Permanent {
            loads: self.loads.len(),
            weight: self.gravity.is_some(),
        };
    }

    /// A constant dead force (N) on a node.
    ///
    /// # Errors
    /// When the beam has no such node or a component is not finite.
    pub fn force(&mut self, node: Node, force: [R; D]) -> Result<()> {
        self.push_force(node, force, None)
    }

    /// A dead force `amplitude(t) * force` (N) on a node.
    ///
    /// # Errors
    /// When the beam has no such node or a component is not finite. A value of `amplitude` that is
    /// not finite stops the solver with the time at which it occurred.
    pub fn force_in_time(
        &mut self,
        node: Node,
        force: [R; D],
        amplitude: impl Fn(R) -> R + Send + Sync + 'static,
    ) -> Result<()> {
        self.push_force(node, force, Some(Arc::new(amplitude)))
    }

    fn push_force(
        &mut self,
        node: Node,
        force: [R; D],
        amplitude: Option<Amplitude<R>>,
    ) -> Result<()> {
        for component in force {
            finite("component of a nodal force [N]", component)?;
        }
        let at = self.coordinates(node, NodalVector::Position)?;
        self.loads.push(NodalLoad {
            action: Action::Force { at, force },
            amplitude,
        });
        Ok(())
    }

    /// A constant moment on a node, applied to its slopes by the law the [`Moment`] names.
    ///
    /// # Errors
    /// When the beam has no such node, its element lacks the slopes the law acts on, or a component
    /// is not finite or cannot act (in the plane of a planar scene, along the slope it acts on,
    /// torsion by a traction).
    pub fn moment(&mut self, node: Node, moment: Moment<R>) -> Result<()> {
        self.push_moment(node, moment, None)
    }

    /// A moment `amplitude(t) * moment` on a node.
    ///
    /// # Errors
    /// Those of [`moment`](Self::moment).
    pub fn moment_in_time(
        &mut self,
        node: Node,
        moment: Moment<R>,
        amplitude: impl Fn(R) -> R + Send + Sync + 'static,
    ) -> Result<()> {
        self.push_moment(node, moment, Some(Arc::new(amplitude)))
    }

    fn push_moment(
        &mut self,
        node: Node,
        moment: Moment<R>,
        amplitude: Option<Amplitude<R>>,
    ) -> Result<()> {
        let (body, _) = self.locate(node)?;
        let frame = *body.frame(node.index);
        moment.check(&frame)?;
        let mut slopes = [0; D];
        for axis in moment.law.slopes(D) {
            slopes[axis] = self.coordinates(node, NodalVector::Slope(axis))?;
        }
        self.loads.push(NodalLoad {
            action: Action::Moment {
                slopes,
                frame,
                moment,
            },
            amplitude,
        });
        Ok(())
    }

    /// Assembles the system the solvers work on.
    ///
    /// # Errors
    /// [`Error::EmptyScene`] without a beam, [`Error::Contradiction`] for supports, joints and
    /// motions that exclude each other.
    pub fn assemble(self) -> Result<System<R, D>> {
        System::new(self)
    }

    fn locate(&self, node: Node) -> Result<(&Body<R, D>, usize)> {
        locate(self.id, &self.bodies, node)
    }

    fn coordinates(&self, node: Node, vector: NodalVector) -> Result<usize> {
        coordinates(self.id, &self.bodies, node, vector)
    }
}

/// The body of a node and the index of the node's first coordinate.
fn locate<R: Real, const D: usize>(
    scene: u64,
    bodies: &[Body<R, D>],
    node: Node,
) -> Result<(&Body<R, D>, usize)> {
    if node.scene != scene {
        return Err(Error::ForeignNode);
    }
    let no_node = |nodes| Error::NoSuchNode {
        body: node.body,
        node: node.index,
        nodes,
    };
    let body = bodies.get(node.body).ok_or(no_node(0))?;
    if node.index >= body.nodes() {
        return Err(no_node(body.nodes()));
    }
    let first = body.range().start + node.index * body.vectors().len() * D;
    Ok((body, first))
}

/// Index of the first component of a nodal vector.
fn coordinates<R: Real, const D: usize>(
    scene: u64,
    bodies: &[Body<R, D>],
    node: Node,
    vector: NodalVector,
) -> Result<usize> {
    let (body, first) = locate(scene, bodies, node)?;
    match body.vectors().iter().position(|v| *v == vector) {
        Some(place) => Ok(first + place * D),
        None => Err(Error::Unsupported {
            what: format!(
                "{vector:?} of a node whose element only has {:?}",
                body.vectors()
            ),
            remedy: "choose a nodal vector the element has, or an element that has this one",
        }),
    }
}
