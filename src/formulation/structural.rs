//! Structural mechanics: the strain energy of a geometrically exact beam (Reissner, Simo) on the
//! slopes of an ANCF element, after Nachbagauer, Gruber and Gerstmayr (2013). Stiffness is given
//! by constants, as most benchmarks of beams are.

use super::change::{Change, changes, values};
use super::sampled::{SampledKernel, section_samples};
use super::{Formulation, Reference, SectionLaw, SectionStiffness, varied};
use crate::element::Element;
use crate::error::{Error, Result, positive};
use crate::material::SaintVenantKirchhoff;
use crate::quadrature::{Cubature, gauss_legendre};
use crate::scalar::{Algebra, Field, Real, Scalar};
use crate::section::Section;
use crate::tensor::{add_scaled, array, cross, dot, scaled, sum, times};

/// Stiffness of a beam about its section axes `y` and `z`. In the plane only `axial`, `shear[0]`
/// and `bending[1]` matter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BeamStiffness<R> {
    /// `EA` (N).
    pub axial: R,
    /// `GA_y` and `GA_z` (N), shear correction included.
    pub shear: [R; 2],
    /// `GJ` (N m^2).
    pub torsion: R,
    /// `EI_y` and `EI_z` (N m^2), `I_y` the integral of `z^2`.
    pub bending: [R; 2],
}

/// Where the stiffness comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Source<R> {
    Moduli { young: R, shear: R },
    Constants(BeamStiffness<R>),
}

/// The structural mechanics formulation for elements with cross slopes that are linear across the
/// section, the [`Quadratic`](crate::element::Quadratic) one above all.
///
/// Strains and curvatures are sampled at Gauss points along the axis, by default as many as the
/// axis has degrees; the section's own deformation, which the formulation resists only to keep
/// the slopes unit and normal, at the nodes, where it can vanish exactly.
///
/// ```
/// use ancf::prelude::*;
///
/// let steel = SaintVenantKirchhoff::<f64, 3>::isotropic(2.07e11, 0.3)?;
/// let from_section = StructuralMechanics::new(&steel).with_shear_factors([5.0 / 6.0; 2]);
/// let given = StructuralMechanics::with_stiffness(BeamStiffness {
///     axial: 1e6,
///     shear: [1e6, 1e6],
///     torsion: 1e3,
///     bending: [1e3, 1e3],
/// })?;
/// // With a density of 1 kg/m^3, Moments are rho A, rho I_y and rho I_z.
/// let leg = Beam::new(Quadratic, Moments::new(1.0, 10.0, 10.0)?, given)
///     .straight([0.0; 3], [10.0, 0.0, 0.0], 4)
///     .density(1.0);
/// Scene::<f64, 3>::new().add(leg)?;
/// # let _ = from_section;
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StructuralMechanics<R> {
    source: Source<R>,
    factors: [R; 2],
    torsion: Option<R>,
    axial: Option<usize>,
}

impl<R: Real> StructuralMechanics<R> {
    /// Stiffness from the moduli of the material and the beam's section: `EA`, `GA` without
    /// correction, `EI`, and `GJ = G (I_y + I_z)`, which is exact for circular sections only.
    pub fn new<const D: usize>(material: &SaintVenantKirchhoff<R, D>) -> Self {
        let (young, shear) = (material.young(), material.shear());
        Self::from(Source::Moduli { young, shear })
    }

    /// Given stiffness; the beam's section is then needed for the mass only.
    ///
    /// # Errors
    /// [`Error::NotPositive`] for a stiffness that is not.
    pub fn with_stiffness(stiffness: BeamStiffness<R>) -> Result<Self> {
        Ok(Self::from(Source::Constants(checked(stiffness)?)))
    }

    fn from(source: Source<R>) -> Self {
        Self {
            source,
            factors: [R::one(); 2],
            torsion: None,
            axial: None,
        }
    }

    /// Multiplies `GA_y` and `GA_z` by shear correction factors.
    #[must_use]
    pub fn with_shear_factors(self, factors: [R; 2]) -> Self {
        Self { factors, ..self }
    }

    /// Replaces `GJ` (N m^2).
    #[must_use]
    pub fn with_torsion(self, torsion: R) -> Self {
        let torsion = Some(torsion);
        Self { torsion, ..self }
    }

    /// Samples the strains at this number of Gauss points along an element.
    #[must_use]
    pub fn axial(self, points: usize) -> Self {
        let axial = Some(points);
        Self { axial, ..self }
    }

    /// The stiffness on this section.
    fn stiffness(&self, section: &dyn Section<R>) -> Result<BeamStiffness<R>> {
        let mut stiffness = match self.source {
            Source::Constants(stiffness) => stiffness,
            Source::Moduli { young, shear } => {
                let p = section.properties()?;
                let polar = p.iyy + p.izz;
                let small = R::lit(1e4 * R::EPSILON);
                let [y, z] = p.centroid;
                if p.iyz.abs() > polar * small || p.area * (y * y + z * z) > polar * small * small {
                    return Err(Error::Unsupported {
                        what: format!(
                            "a section with Iyz = {} m^4 and centroid ({}, {}) m",
                            p.iyz.value(),
                            y.value(),
                            z.value()
                        ),
                        remedy: "structural mechanics needs the principal axes and the centroid: turn and shift the section, or use a continuum",
                    });
                }
                BeamStiffness {
                    axial: young * p.area,
                    shear: [shear * p.area; 2],
                    torsion: shear * polar,
                    bending: [young * p.iyy, young * p.izz],
                }
            }
        };
        for (shear, factor) in stiffness.shear.iter_mut().zip(self.factors) {
            *shear *= positive("shear correction factor", factor)?;
        }
        stiffness.torsion = self.torsion.unwrap_or(stiffness.torsion);
        checked(stiffness)
    }
}

fn checked<R: Real>(stiffness: BeamStiffness<R>) -> Result<BeamStiffness<R>> {
    positive("axial stiffness EA [N]", stiffness.axial)?;
    positive("shear stiffness GA_y [N]", stiffness.shear[0])?;
    positive("shear stiffness GA_z [N]", stiffness.shear[1])?;
    positive("torsional stiffness GJ [N m^2]", stiffness.torsion)?;
    positive("bending stiffness EI_y [N m^2]", stiffness.bending[0])?;
    positive("bending stiffness EI_z [N m^2]", stiffness.bending[1])?;
    Ok(stiffness)
}

/// Trapezoidal and Simpson's rule on [0, 1]: points at the nodes. Beyond three nodes, where such
/// rules turn bad, Gauss points of the same number.
fn at_nodes<R: Real>(nodes: usize) -> Result<Cubature<R, 1>> {
    let line = |weights: &[f64], degree| {
        let last = R::lit((weights.len() - 1) as f64);
        let point = |i| [R::lit(i as f64) / last];
        let total = R::lit(weights.iter().sum());
        let weight = |w: &f64| R::lit(*w) / total;
        Cubature::new(
            (0..weights.len()).map(point).collect(),
            weights.iter().map(weight).collect(),
            degree,
        )
    };
    match nodes {
        2 => line(&[1.0, 1.0], 1),
        3 => line(&[1.0, 4.0, 1.0], 3),
        _ => gauss_legendre(nodes),
    }
}

/// Kernel of a [`StructuralMechanics`] beam; `K = 2 D - 1`.
pub type StructuralKernel<R, const D: usize, const S: usize, const K: usize> =
    SampledKernel<R, StructuralSection<R>, D, S, K>;

macro_rules! dimension {
    ($d:literal, $k:literal) => {
        impl<R: Real, E: Element<$d, S>, const S: usize> Formulation<R, E, $d, S>
            for StructuralMechanics<R>
        {
            type Kernel = StructuralKernel<R, $d, S, $k>;

            fn kernel(
                &self,
                element: &E,
                reference: &Reference<R, $d, S>,
                section: &dyn Section<R>,
            ) -> Result<Self::Kernel> {
                let stiffness = self.stiffness(section)?;
                let samples = section_samples(element, reference.length)?;
                let along = gauss_legendre(self.axial.unwrap_or(E::AXIAL_DEGREE))?;
                let rod = StructuralSection::Rod(stiffness);
                let shape = StructuralSection::Shape(stiffness.axial);
                Ok(SampledKernel::new()
                    .with_part(element, reference, rod, samples, &along)
                    .with_part(element, reference, shape, samples, &at_nodes(E::NODES)?))
            }

            fn resampled(&self, axial: usize, _section_degree: usize) -> Option<Self> {
                Some(self.axial(axial))
            }
        }
    };
}
dimension!(2, 3);
dimension!(3, 5);

/// Energy per unit length of a structural mechanics beam as a function of `r'`, the cross slopes
/// and their derivatives, one part at a time because the two are sampled in different places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StructuralSection<R> {
    /// `1/2 (EA G_1^2 + GA_y G_2^2 + GA_z G_3^2 + GJ k_1^2 + EI_y k_2^2 + EI_z k_3^2)` with the
    /// strains `G` and curvatures `k` in the section frame, less those of the reference.
    Rod(BeamStiffness<R>),
    /// `1/2 EA (E_yy^2 + E_zz^2 + 2 E_yz^2)` with the Green-Lagrange strains of the section and
    /// `EA` (N): the same for every direction in the section.
    Shape(R),
}

impl<R: Real, const D: usize, const K: usize> SectionLaw<R, D, K> for StructuralSection<R> {
    const LANES: bool = true;

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> T {
        let length0 = unit(reference);
        let half = R::lit(0.5);
        let mut twice = T::zero();
        match self {
            Self::Rod(k) => {
                let strains = Rod::of(&changes(reference, h), Change::rsqrt).strains();
                for (m, stiffness) in k.of_strains::<D>() {
                    let strain = strains[m].change;
                    twice = twice.plus_times(stiffness, strain * strain);
                }
                // Strains are per reference length: two divisions, and one factor to integrate.
                twice.times(half / length0)
            }
            Self::Shape(axial) => {
                for (a, b) in pairs::<D>() {
                    let strain = shape_strain(reference, h, a, b);
                    let count = if a == b { 1.0 } else { 2.0 };
                    twice = twice.plus_times(R::lit(count), strain * strain);
                }
                twice.times(half * *axial * length0)
            }
        }
    }

    #[inline(always)]
    fn resultants<T: Algebra<R>>(&self, reference: &[[R; D]; K], h: &[[T; D]; K]) -> [[T; D]; K] {
        let length0 = unit(reference);
        match self {
            Self::Rod(k) => {
                let rod = Rod::of(&changes(reference, h), Change::rsqrt);
                rod.now().resultants(&rod.forces::<R, D>(k, length0))
            }
            Self::Shape(axial) => {
                let g = current(reference, h);
                let mut n = [[T::zero(); D]; K];
                for (a, b) in pairs::<D>() {
                    let stress = shape_strain(reference, h, a, b).times(*axial * length0);
                    add_scaled(&mut n[a], stress, &g[b]);
                    if a != b {
                        add_scaled(&mut n[b], stress, &g[a]);
                    }
                }
                n
            }
        }
    }

    /// What the change of the strains gives, and what that of their gradients gives: those of a rod by
    /// dual numbers along the cross slopes, for strains are linear in everything else.
    #[inline(always)]
    fn stiffness<T: Algebra<R>>(
        &self,
        reference: &[[R; D]; K],
        h: &[[T; D]; K],
        k: &mut SectionStiffness<T, D, K>,
    ) -> [[T; D]; K] {
        let length0 = unit(reference);
        *k = [[[[T::zero(); D]; D]; K]; K];
        match self {
            Self::Rod(stiffness) => {
                let rod = Rod::of(&changes(reference, h), Change::rsqrt);
                let forces = rod.forces::<R, D>(stiffness, length0);
                let rod = rod.now();
                for (m, stiffness) in stiffness.of_strains::<D>() {
                    let along = array(|n| if n == m { T::one() } else { T::zero() });
                    let gradient: [[T; D]; K] = rod.resultants(&along);
                    for a in 0..K {
                        let force = times(stiffness / length0, &gradient[a]);
                        for b in a..K {
                            for c in 0..D {
                                add_scaled(&mut k[a][b][c], force[c], &gradient[b]);
                            }
                        }
                    }
                }
                let g = current(reference, h);
                let fixed = array(|m| forces[m].constant::<D>());
                for b in 1..D {
                    let rod = Rod::of(&varied(&g, b), rsqrt);
                    let dual: [[T::Dual<D>; D]; K] = rod.resultants(&fixed);
                    for (a, c) in (0..K).flat_map(|a| (0..D).map(move |c| (a, c))) {
                        for d in 0..D {
                            let derivative = T::derivative::<D>(&dual[a][c], d);
                            match a {
                                a if a <= b => k[a][b][c][d] += derivative,
                                a if a >= D => k[b][a][d][c] += derivative,
                                _ => {}
                            }
                        }
                    }
                }
                rod.resultants(&forces)
            }
            Self::Shape(axial) => {
                let g = current(reference, h);
                let stiffness = *axial * length0;
                let mut n = [[T::zero(); D]; K];
                for (a, b) in pairs::<D>() {
                    let stress = shape_strain(reference, h, a, b).times(stiffness);
                    add_scaled(&mut n[a], stress, &g[b]);
                    let share = if a == b {
                        stiffness
                    } else {
                        R::lit(0.5) * stiffness
                    };
                    let (left, right) = (times(share, &g[a]), times(share, &g[b]));
                    for c in 0..D {
                        k[a][b][c][c] += stress;
                        add_scaled(&mut k[a][b][c], right[c], &g[a]);
                        if a != b {
                            add_scaled(&mut k[a][a][c], right[c], &g[b]);
                            add_scaled(&mut k[b][b][c], left[c], &g[a]);
                        }
                    }
                    if a != b {
                        add_scaled(&mut n[b], stress, &g[a]);
                    }
                }
                n
            }
        }
    }
}

impl<R: Copy> BeamStiffness<R> {
    /// With the numbers of the strains that there are in `D` dimensions.
    #[inline(always)]
    fn of_strains<const D: usize>(&self) -> impl Iterator<Item = (usize, R)> {
        let ([sy, sz], [by, bz]) = (self.shear, self.bending);
        let all = [self.axial, sy, sz, self.torsion, by, bz];
        let strains = all.into_iter().enumerate();
        strains.filter(|(m, _)| D == 3 || [0, 1, 5].contains(m))
    }
}

/// Reference length per unit of the coordinate X: 1 up to rounding on a straight axis.
#[inline(always)]
fn unit<R: Real, const D: usize, const K: usize>(reference: &[[R; D]; K]) -> R {
    dot(&reference[0], &reference[0]).sqrt()
}

/// The sampled vectors as they are now.
#[inline(always)]
fn current<R: Real, T: Algebra<R>, const D: usize, const K: usize>(
    reference: &[[R; D]; K],
    h: &[[T; D]; K],
) -> [[T; D]; K] {
    array(|k| array(|c| T::lift(reference[k][c]) + h[k][c]))
}

/// Pairs of cross axes.
#[inline(always)]
fn pairs<const D: usize>() -> impl Iterator<Item = (usize, usize)> {
    (1..D).flat_map(|a| (a..D).map(move |b| (a, b)))
}

/// Green-Lagrange strain of the section.
#[inline(always)]
fn shape_strain<R: Real, T: Algebra<R>, const D: usize, const K: usize>(
    reference: &[[R; D]; K],
    h: &[[T; D]; K],
    a: usize,
    b: usize,
) -> T {
    let half = R::lit(0.5);
    let mut twice = T::zero();
    for (k, l) in [(a, b), (b, a)] {
        for c in 0..D {
            let middle = T::lift(reference[k][c]).plus_times(half, h[k][c]);
            twice = twice.plus_product(middle, h[l][c]);
        }
    }
    twice.times(half)
}

/// A rod in space: the sampled vectors and the section frame `e_3 = r_z / |r_z|`, `e_1` along
/// `r_y x r_z`, `e_2 = e_3 x e_1`. A planar one has `r_z` along the normal.
struct Rod<N> {
    tangent: [N; 3],
    y: [N; 3],
    z: [N; 3],
    y_turn: [N; 3],
    z_turn: [N; 3],
    frame: [[N; 3]; 3],
    /// `(r_y x r_z)'`.
    turn: [N; 3],
    per_z: N,
    per_normal: N,
}

impl<N: Scalar> Rod<N> {
    /// The rod with these sampled vectors, and a function for one over the square root.
    #[inline(always)]
    fn of<const D: usize, const K: usize>(g: &[[N; D]; K], rsqrt: impl Fn(N) -> N) -> Self {
        let (zero, one) = (N::zero(), N::one());
        let (tangent, y) = (in_space(g, 0), in_space(g, 1));
        let (z, y_turn, z_turn) = match D {
            2 => ([zero, zero, one], in_space(g, 2), [zero; 3]),
            _ => (in_space(g, 2), in_space(g, 3), in_space(g, 4)),
        };
        let normal = cross(&y, &z);
        let turn = sum(&cross(&y_turn, &z), &cross(&y, &z_turn));
        let (per_z, per_normal) = (rsqrt(dot(&z, &z)), rsqrt(dot(&normal, &normal)));
        let e3 = scaled(per_z, &z);
        let e1 = scaled(per_normal, &normal);
        Self {
            tangent,
            y,
            z,
            y_turn,
            z_turn,
            frame: [e1, cross(&e3, &e1), e3],
            turn,
            per_z,
            per_normal,
        }
    }

    /// `e_i . r'` and the components of the curvature per unit of the coordinate along the axis.
    ///
    /// For an orthonormal frame `1/2 sum e_i x e_i'` has the components `-e_2.e_3'`, `e_1.e_3'` and
    /// `e_2.e_1'`, in which the projections of `r_z'` and `(r_y x r_z)'` that make `e_3'` and `e_1'`
    /// drop out.
    #[inline(always)]
    fn strains(&self) -> [N; 6] {
        let [e1, e2, e3] = &self.frame;
        [
            dot(e1, &self.tangent),
            dot(e2, &self.tangent),
            dot(e3, &self.tangent),
            -dot(e2, &self.z_turn) * self.per_z,
            dot(e1, &self.z_turn) * self.per_z,
            dot(e2, &self.turn) * self.per_normal,
        ]
    }

    /// `sum_m forces_m d strains_m` by the sampled vectors, the strains' way back from the last
    /// operation to the first.
    #[inline(always)]
    fn resultants<const D: usize, const K: usize>(&self, forces: &[N; 6]) -> [[N; D]; K] {
        let [e1, e2, e3] = &self.frame;
        let [axial, shear_y, shear_z, ..] = *forces;
        let [about_x, about_y] = [forces[3] * self.per_z, forces[4] * self.per_z];
        let about_z = forces[5] * self.per_normal;
        // By the frame, in which the second vector follows from the others.
        let mut by_e1 = scaled(axial, &self.tangent);
        add_scaled(&mut by_e1, about_y, &self.z_turn);
        let mut by_e2 = scaled(shear_y, &self.tangent);
        add_scaled(&mut by_e2, -about_x, &self.z_turn);
        add_scaled(&mut by_e2, about_z, &self.turn);
        let by_e1 = sum(&by_e1, &cross(&by_e2, e3));
        let by_e3 = sum(&scaled(shear_z, &self.tangent), &cross(e1, &by_e2));
        // By the vectors that are made unit ones, and by their lengths.
        let lengthened = about_z * dot(e2, &self.turn);
        let by_normal = across(&by_e1, e1, self.per_normal, lengthened);
        let lengthened = about_y * dot(e1, &self.z_turn) - about_x * dot(e2, &self.z_turn);
        let mut by_z = across(&by_e3, e3, self.per_z, lengthened);
        add_scaled(&mut by_z, about_z, &cross(e2, &self.y_turn));
        let by_z = sum(&by_z, &cross(&by_normal, &self.y));
        let mut by_y = cross(&self.z, &by_normal);
        add_scaled(&mut by_y, about_z, &cross(&self.z_turn, e2));
        let mut by_tangent = scaled(axial, e1);
        add_scaled(&mut by_tangent, shear_y, e2);
        add_scaled(&mut by_tangent, shear_z, e3);
        let by_y_turn = scaled(about_z, &cross(&self.z, e2));
        let mut by_z_turn = scaled(about_y, e1);
        add_scaled(&mut by_z_turn, -about_x, e2);
        add_scaled(&mut by_z_turn, about_z, &cross(e2, &self.y));
        let mut all = [[N::zero(); D]; K];
        for k in 0..K {
            let by = match (D, k) {
                (_, 0) => &by_tangent,
                (_, 1) => &by_y,
                (2, _) | (_, 3) => &by_y_turn,
                (_, 2) => &by_z,
                _ => &by_z_turn,
            };
            all[k].copy_from_slice(&by[..D]);
        }
        all
    }
}

/// One over the square root.
#[inline(always)]
fn rsqrt<N: Field>(x: N) -> N {
    x.sqrt().recip()
}

/// A sampled vector in space.
#[inline(always)]
fn in_space<N: Scalar, const D: usize, const K: usize>(g: &[[N; D]; K], k: usize) -> [N; 3] {
    let mut vector = [N::zero(); 3];
    vector[..D].copy_from_slice(&g[k]);
    vector
}

/// By a vector what is given by the unit vector `e` along it, and `more` by its length.
#[inline(always)]
fn across<N: Scalar>(by: &[N; 3], e: &[N; 3], per_length: N, more: N) -> [N; 3] {
    let mut all = scaled(per_length, by);
    add_scaled(&mut all, -(dot(e, by) + more) * per_length, e);
    all
}

impl<T: Field> Rod<Change<T>> {
    /// The rod as it is now.
    #[inline(always)]
    fn now(&self) -> Rod<T> {
        let [e1, e2, e3] = &self.frame;
        Rod {
            tangent: values(&self.tangent),
            y: values(&self.y),
            z: values(&self.z),
            y_turn: values(&self.y_turn),
            z_turn: values(&self.z_turn),
            frame: [values(e1), values(e2), values(e3)],
            turn: values(&self.turn),
            per_z: self.per_z.value,
            per_normal: self.per_normal.value,
        }
    }

    /// What is conjugate to the strains.
    #[inline(always)]
    fn forces<R: Real, const D: usize>(&self, stiffness: &BeamStiffness<R>, length0: R) -> [T; 6]
    where
        T: Algebra<R>,
    {
        let strains = self.strains();
        let mut forces = [T::zero(); 6];
        for (m, stiffness) in stiffness.of_strains::<D>() {
            forces[m] = strains[m].change.times(stiffness / length0);
        }
        forces
    }
}
