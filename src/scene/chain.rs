//! A body of the system: a chain of elements of one family behind one dynamic call per evaluation, so
//! that the loop over elements is monomorphic in kernel and number type. Elements that kernels do not
//! differ by share that loop: what a chain knows of its element is how nodes are numbered, and a dynamic
//! call for what is asked between evaluations.

mod shares;
mod works;

use std::fmt::Debug;
use std::ops::Range;

use crate::element::{Element, NodalVector};
use crate::error::Result;
use crate::formulation::{ElementKernel, Inertia, Reference};
use crate::scalar::{Lanes, Real};
use crate::solver::{BandMatrix, Matrix, Part, Ready};
use crate::tensor::sum;
use shares::{Numbers, Task};
use works::{Acceleration, Force, Secant, SecantStiffness, Stiffness};

/// Elements in a row that share their end nodes. Coordinates are contiguous: element `n` reads one
/// slice of the system's vector.
#[derive(Debug)]
pub(super) struct Chain<R, Kn, const D: usize, const S: usize> {
    element: Box<dyn Shaped<R, D, S>>,
    /// Vectors of every node, and nodes of an element.
    vectors: &'static [NodalVector],
    nodes: usize,
    /// One kernel for all elements of a straight beam, one for each of a curved one.
    kernels: Vec<Kn>,
    /// As many.
    links: Vec<Link<R, D, S>>,
    /// Position of the first node of each element.
    starts: Vec<[R; D]>,
    offset: usize,
}

/// The shape functions of an element in the numbers of the model.
trait Shaped<R, const D: usize, const S: usize>: Debug + Send + Sync {
    fn shape(&self, length: R, x: [R; D]) -> [R; S];
}

impl<R: Real, E: Element<D, S>, const D: usize, const S: usize> Shaped<R, D, S> for E {
    fn shape(&self, length: R, x: [R; D]) -> [R; S] {
        Element::shape(self, length, x)
    }
}

/// What else one element of a chain is made of.
#[derive(Debug)]
pub(super) struct Link<R, const D: usize, const S: usize> {
    inertia: Option<Inertia<R, S>>,
    /// Its mass matrix row by row, less what is nothing: sections about their centroid couple positions
    /// with no slope across.
    masses: Vec<Coupling<R>>,
    reference: Reference<R, D, S>,
}

/// An entry of the mass matrix over nodal vectors.
#[derive(Debug)]
struct Coupling<R> {
    row: usize,
    column: usize,
    mass: R,
}

impl<R: Real, const D: usize, const S: usize> Link<R, D, S> {
    pub(super) fn new(inertia: Option<Inertia<R, S>>, reference: Reference<R, D, S>) -> Self {
        let all = (0..S).flat_map(|row| (0..S).map(move |column| (row, column)));
        let entries = inertia.iter().flat_map(|inertia| {
            all.clone().map(|(row, column)| Coupling {
                row,
                column,
                mass: inertia.mass[row][column],
            })
        });
        Self {
            masses: entries.filter(|entry| !entry.mass.is_nothing()).collect(),
            inertia,
            reference,
        }
    }
}

/// What belongs to an element, where one may stand for all.
#[inline(always)]
fn of<T>(all: &[T], element: usize) -> &T {
    &all[element.min(all.len() - 1)]
}

/// The first coordinate of a part, or of all.
fn first_of(part: Option<&Part>) -> usize {
    part.map_or(0, |part| part.coordinates.start)
}

/// What the system asks of a body. Everything is added to what is given.
pub(super) trait Elastic<R: Real, const D: usize>: Debug + Send + Sync {
    fn energy(&self, u: &[R]) -> R;
    /// Internal forces of a part, on its coordinates, or of all.
    fn force(&self, part: Option<&Part>, u: &[R], q: &mut [R]);
    /// Shows the parts that forces are evaluated in; the body is the only one.
    fn parts(&self, each: &mut dyn FnMut(&Part));
    /// Tangent and, with a density, this share of the mass matrix; who is `ready` for it may be told on
    /// the way which of the first unknowns are complete.
    fn tangent(
        &self,
        u: &[R],
        mass: Option<R>,
        k: &mut Matrix<R>,
        ready: Option<Ready<'_, R>>,
    ) -> Result<()>;
    /// Whether the secant force is made of strains.
    fn has_strain(&self) -> bool;
    fn secant(&self, viscosity: R, from: &[R], to: &[R], q: &mut [R]);
    fn secant_tangent(&self, viscosity: R, from: &[R], to: &[R], k: &mut Matrix<R>) -> Result<()>;
    /// Adds `factor` times the mass matrix of a part, or of all, times accelerations of its coordinates;
    /// nothing without a density.
    fn add_mass_times(&self, part: Option<&Part>, factor: R, a: &[R], out: &mut [R]);
    /// Mass matrix over nodal vectors and first moments; nothing without a density.
    fn inertia(&self, mass: &mut BandMatrix<R>, first: &mut [R]) -> Result<()>;
    fn reference(&self, e: &mut [R]);
    /// A nodal vector in the reference state; zero if the node has no such vector.
    fn vector(&self, node: usize, vector: NodalVector) -> [R; D];
    /// Tells the coordinates that each element couples, as ranges.
    fn couple(&self, tell: &mut dyn FnMut(&[Range<usize>]));
    /// Shape functions at axial position `s` in [0, 1] of the body and cross position `y` (m)
    /// (entry 0 unused), with the index of the coordinates' first component.
    fn shape(&self, s: R, y: &[R; D]) -> (usize, Vec<R>);
}

/// A body with what the scene must know of it.
#[derive(Debug)]
pub(super) struct Body<R, const D: usize> {
    elastic: Box<dyn Elastic<R, D>>,
    vectors: &'static [NodalVector],
    nodes: usize,
    range: Range<usize>,
    /// One frame for all nodes of a straight beam, one for each of a curved one.
    frames: Vec<[[R; D]; D]>,
    length: R,
    has_mass: bool,
    description: String,
    /// Places of the slopes among a node's vectors, if it has them all.
    slopes: Option<[usize; D]>,
}

impl<R: Real, const D: usize> Body<R, D> {
    pub(super) fn new<Kn, const S: usize>(
        chain: Chain<R, Kn, D, S>,
        frames: Vec<[[R; D]; D]>,
        length: R,
        description: String,
    ) -> Self
    where
        Kn: ElementKernel<R, D, S>,
    {
        let nodes = (chain.nodes - 1) * chain.starts.len() + 1;
        let vectors = chain.vectors;
        let count = nodes * vectors.len() * D;
        let place = |a| vectors.iter().position(|v| *v == NodalVector::Slope(a));
        let mut slopes = Some([0; D]);
        for a in 0..D {
            slopes = slopes.zip(place(a)).map(|(mut all, at)| {
                all[a] = at;
                all
            });
        }
        Self {
            slopes,
            description,
            vectors,
            nodes,
            range: chain.offset..chain.offset + count,
            frames,
            length,
            has_mass: chain.links.iter().all(|link| link.inertia.is_some()),
            elastic: Box::new(chain),
        }
    }

    /// A body of one node that is no beam. It has no length of its own.
    pub(super) fn of_node(
        elastic: Box<dyn Elastic<R, D>>,
        vectors: &'static [NodalVector],
        range: Range<usize>,
        frame: [[R; D]; D],
        description: String,
    ) -> Self {
        Self {
            elastic,
            vectors,
            nodes: 1,
            range,
            frames: vec![frame],
            length: R::zero(),
            has_mass: true,
            description,
            slopes: Some(std::array::from_fn(|a| a + 1)),
        }
    }

    pub(super) fn elastic(&self) -> &dyn Elastic<R, D> {
        &*self.elastic
    }
    pub(super) fn vectors(&self) -> &'static [NodalVector] {
        self.vectors
    }
    pub(super) fn nodes(&self) -> usize {
        self.nodes
    }
    pub(super) fn range(&self) -> Range<usize> {
        self.range.clone()
    }
    /// Material frame of a node in the reference state.
    pub(super) fn frame(&self, node: usize) -> &[[R; D]; D] {
        &self.frames[node.min(self.frames.len() - 1)]
    }
    pub(super) fn length(&self) -> R {
        self.length
    }
    pub(super) fn has_mass(&self) -> bool {
        self.has_mass
    }
    pub(super) fn describe(&self) -> &str {
        &self.description
    }

    /// The first node whose slopes, all `D` of them, no longer span a volume of the sign they had,
    /// with that volume over the one in the reference state.
    pub(super) fn inverted(&self, reference: &[R], u: &[R]) -> Option<(usize, R)> {
        let slopes = self.slopes?;
        let stride = self.vectors.len() * D;
        for node in 0..self.nodes {
            let start = self.range.start + node * stride;
            let slope: [[R; D]; D] = std::array::from_fn(|a| {
                std::array::from_fn(|c| {
                    let i = start + slopes[a] * D + c;
                    reference[i] + u[i]
                })
            });
            let volume = match D {
                2 => slope[0][0] * slope[1][1] - slope[0][1] * slope[1][0],
                _ => (0..3)
                    .map(|c| {
                        let (a, b) = ((c + 1) % 3, (c + 2) % 3);
                        slope[0][c] * (slope[1][a] * slope[2][b] - slope[1][b] * slope[2][a])
                    })
                    .sum(),
            };
            if volume <= R::zero() {
                return Some((node, volume));
            }
        }
        None
    }
}

impl<R, Kn, const D: usize, const S: usize> Chain<R, Kn, D, S>
where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    /// Of elements that start at these positions, with one kernel and link for all or one for each, and
    /// coordinates from an offset on.
    pub(super) fn new<E: Element<D, S>>(
        element: E,
        parts: (Vec<Kn>, Vec<Link<R, D, S>>),
        starts: Vec<[R; D]>,
        offset: usize,
    ) -> Self {
        let (kernels, links) = parts;
        Self {
            element: Box::new(element),
            vectors: E::VECTORS,
            nodes: E::NODES,
            kernels,
            links,
            starts,
            offset,
        }
    }

    /// Coordinates from an element to the next.
    #[inline(always)]
    fn stride(&self) -> usize {
        (self.nodes - 1) * self.vectors.len() * D
    }

    #[inline(always)]
    fn link(&self, element: usize) -> &Link<R, D, S> {
        of(&self.links, element)
    }

    fn range(&self, element: usize) -> Range<usize> {
        let start = self.offset + element * self.stride();
        start..start + S * D
    }

    /// Nodal displacements of one element.
    #[inline(always)]
    fn gather(&self, element: usize, x: &[R]) -> [[R; D]; S] {
        let slice = &x[self.range(element)];
        std::array::from_fn(|i| std::array::from_fn(|c| slice[i * D + c]))
    }

    /// Calls `each` for groups of some elements that fill the lanes: with the elements, what links them
    /// and their nodal vectors in each of `sources`, which start at the coordinate `from`. The last group
    /// is filled up by its last element, so that all elements see the same arithmetic.
    #[inline(always)]
    fn groups<L: Lanes<R>, const N: usize>(
        &self,
        elements: Range<usize>,
        (sources, from): ([&[R]; N], usize),
        mut each: impl FnMut(Range<usize>, &Link<R, D, S>, &[[[L; D]; S]; N]),
    ) {
        let mut columns = [[[L::zero(); D]; S]; N];
        for first in elements.clone().step_by(L::WIDTH) {
            let last = elements.end.min(first + L::WIDTH) - 1;
            let start = |lane: usize| self.range(last.min(first + lane)).start - from;
            for (columns, source) in columns.iter_mut().zip(sources) {
                L::gather(source, start, columns.as_flattened_mut());
            }
            each(first..last + 1, self.link(first), &columns);
        }
    }

    /// Adds the forces of a group of elements.
    #[inline(always)]
    fn scatter<L: Lanes<R>>(
        &self,
        force: &[[L; D]; S],
        elements: Range<usize>,
        q: &mut Numbers<'_, R>,
    ) {
        let (start, first) = (self.starts_in(elements), q.first);
        let start = |lane| start(lane).map(|coordinate| coordinate - first);
        L::scatter(force.as_flattened(), q.numbers, start);
    }

    /// Has a task for a part, or for all, add to numbers of its coordinates.
    fn share_numbers<T>(&self, task: &T, part: Option<&Part>, numbers: &mut [R])
    where
        T: for<'o> Task<R, D, S, Out<'o> = Numbers<'o, R>>,
    {
        let elements = part.and_then(|part| part.elements.clone());
        let elements = elements.unwrap_or(0..self.starts.len());
        let first = first_of(part);
        let mut all = Numbers { first, numbers };
        // Nothing that adds to numbers can fail.
        let _ = self.share(task, elements, &mut all);
    }

    /// The first coordinate of each of a group's elements, by lanes.
    #[inline(always)]
    fn starts_in(&self, elements: Range<usize>) -> impl Fn(usize) -> Option<usize> {
        move |lane| (lane < elements.len()).then(|| self.range(elements.start + lane).start)
    }
}

impl<R, Kn, const D: usize, const S: usize> Elastic<R, D> for Chain<R, Kn, D, S>
where
    R: Real,
    Kn: ElementKernel<R, D, S>,
{
    fn energy(&self, u: &[R]) -> R {
        let energy = |n| of(&self.kernels, n).energy(&self.gather(n, u));
        (0..self.starts.len()).map(energy).sum()
    }

    fn force(&self, part: Option<&Part>, u: &[R], q: &mut [R]) {
        self.share_numbers(&Force { chain: self, u }, part, q);
    }

    fn parts(&self, each: &mut dyn FnMut(&Part)) {
        self.each_part(each);
    }

    fn tangent(
        &self,
        u: &[R],
        mass: Option<R>,
        k: &mut Matrix<R>,
        ready: Option<Ready<'_, R>>,
    ) -> Result<()> {
        let chain = self;
        self.share_matrix(&Stiffness { chain, u, mass }, k, ready)
    }

    fn has_strain(&self) -> bool {
        self.kernels.iter().all(ElementKernel::has_strain)
    }

    fn secant(&self, viscosity: R, from: &[R], to: &[R], q: &mut [R]) {
        let task = Secant {
            chain: self,
            viscosity,
            ends: [from, to],
        };
        self.share_numbers(&task, None, q);
    }

    fn secant_tangent(&self, viscosity: R, from: &[R], to: &[R], k: &mut Matrix<R>) -> Result<()> {
        let task = SecantStiffness {
            chain: self,
            viscosity,
            ends: [from, to],
        };
        self.share_matrix(&task, k, None)
    }

    fn add_mass_times(&self, part: Option<&Part>, factor: R, a: &[R], out: &mut [R]) {
        let task = Acceleration {
            chain: self,
            factor,
            a,
            from: first_of(part),
        };
        self.share_numbers(&task, part, out);
    }

    fn inertia(&self, mass: &mut BandMatrix<R>, first: &mut [R]) -> Result<()> {
        for n in 0..self.starts.len() {
            let Some(inertia) = &self.link(n).inertia else {
                continue;
            };
            let start = self.range(n).start / D;
            mass.add_block(start, S, inertia.mass.as_flattened())?;
            for i in 0..S {
                first[start + i] += inertia.first[i];
            }
        }
        Ok(())
    }

    fn reference(&self, e: &mut [R]) {
        for n in 0..self.starts.len() {
            let mut vectors = self.link(n).reference.vectors;
            for (i, vector) in vectors.iter_mut().enumerate() {
                if self.vectors[i % self.vectors.len()] == NodalVector::Position {
                    *vector = sum(vector, &self.starts[n]);
                }
            }
            e[self.range(n)].copy_from_slice(vectors.as_flattened());
        }
    }

    fn vector(&self, node: usize, vector: NodalVector) -> [R; D] {
        let element = (node / (self.nodes - 1)).min(self.starts.len() - 1);
        let local = node - element * (self.nodes - 1);
        let nodal = &self.link(element).reference.vectors;
        let place = self.vectors.iter().position(|v| *v == vector);
        let value = place.map_or([R::zero(); D], |at| nodal[local * self.vectors.len() + at]);
        match vector {
            NodalVector::Position => sum(&value, &self.starts[element]),
            NodalVector::Slope(_) => value,
        }
    }

    fn couple(&self, tell: &mut dyn FnMut(&[Range<usize>])) {
        (0..self.starts.len()).for_each(|n| tell(&[self.range(n)]));
    }

    fn shape(&self, s: R, y: &[R; D]) -> (usize, Vec<R>) {
        let along = s * R::lit(self.starts.len() as f64);
        let n = (along.value().max(0.0) as usize).min(self.starts.len() - 1);
        let length = self.link(n).reference.length;
        let mut x = y.map(|y| y / length);
        x[0] = along - R::lit(n as f64);
        let shape = self.element.shape(length, x);
        (self.range(n).start, shape.to_vec())
    }
}
