//! What the user states, in the words of the problem: beams with their supports, loads and
//! gravity, gathered in a [`Scene`]; and what the solvers see, the assembled [`System`]. Only what
//! the scene asks for is carried on: no mass matrix without density, no gravity or load vector
//! without gravity or loads, no unsymmetric matrices without follower loads.

mod beam;
mod chain;
mod load;
mod system;

pub use beam::Beam;
pub use load::{Moment, MomentLaw};
pub use system::{Energies, Momenta, System};

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::element::{Element, NodalVector};
use crate::error::{Error, Result, finite};
use crate::formulation::Formulation;
use crate::scalar::Real;
use crate::section::Section;
use chain::Body;
use load::{Action, Amplitude, NodalLoad};

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
    fixed: Vec<usize>,
    loads: Vec<NodalLoad<R, D>>,
    gravity: Option<[R; D]>,
    size: usize,
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
            fixed: Vec::new(),
            loads: Vec::new(),
            gravity: None,
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
        self.fixed.extend(first..first + count);
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
        self.fixed.extend(chosen.map(|(c, _)| first + c));
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
        Ok(())
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
    /// [`Error::EmptyScene`] without a beam.
    pub fn assemble(self) -> Result<System<R, D>> {
        System::new(self.id, self.bodies, self.fixed, self.loads, self.gravity)
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
