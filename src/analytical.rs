//! Exact solutions that elements are measured against, in tests and in papers. They live in the
//! library, generic over the number type, because a result is only worth its reference: here is
//! which model each belongs to, how it was derived and how far it was checked.

use num_dual::Dual;

use crate::error::{Error, Result, finite, positive};
use crate::scalar::{Algebra, Field, Real};

/// Young's modulus and the moments of a section about its bending axis, `y` being the distance
/// from it: what pure bending of a section-linear beam depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BendingSection<R> {
    /// Young's modulus in Pa.
    pub modulus: R,
    /// Area in m^2.
    pub area: R,
    /// Integral of `y^2` over the area, in m^4.
    pub second: R,
    /// Integral of `y^4` over the area, in m^6.
    pub fourth: R,
}

impl<R: Real> BendingSection<R> {
    /// Disk of `radius` in m: `A = pi R^2`, `I = pi R^4/4`, `I4 = pi R^6/8`.
    #[must_use]
    pub fn disk(modulus: R, radius: R) -> Self {
        let square = radius * radius;
        let area = R::pi() * square;
        Self {
            modulus,
            area,
            second: R::lit(0.25) * area * square,
            fourth: R::lit(0.125) * area * square * square,
        }
    }

    /// Rectangle of `height` along the bending direction and `width` across it, both in m:
    /// `A = b h`, `I = b h^3/12`, `I4 = b h^5/80`.
    #[must_use]
    pub fn rectangle(modulus: R, width: R, height: R) -> Self {
        let (area, square) = (width * height, height * height);
        Self {
            modulus,
            area,
            second: area * square / R::lit(12.0),
            fourth: area * square * square / R::lit(80.0),
        }
    }
}

/// How a moment `M` is applied to the end of a beam whose section deforms. With `t` the unit
/// vector along the axis, `r_x` and `r_y` the slopes along the axis and across it, `a = |r_y|`
/// and `lambda = |r_x|`, the definitions are the same for a rigid section only.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum EndMoment {
    /// Conjugate to the rotation of `r_y`: does the work `M dtheta`. Force `M t/a` on `r_y`.
    Conjugate,
    /// Force of magnitude `M` on `r_y`, normal to `r_y`: does the work `M a dtheta`.
    NormalToSlope,
    /// Force of magnitude `M` on `r_y`, against `r_x/|r_x|`. In pure bending, where `r_x` stays
    /// normal to `r_y`, the same as [`NormalToSlope`](Self::NormalToSlope).
    AlongAxis,
    /// Linear distribution of the second Piola-Kirchhoff traction, force `-M r_x` on `r_y`: does
    /// the work `M a lambda dtheta`.
    SecondPiola,
}

/// A uniformly bent beam, see [`pure_bending`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RollUp<R> {
    /// Derivative of the section's rotation with respect to reference arc length, in 1/m.
    pub curvature: R,
    /// Stretch of the axis.
    pub axial_stretch: R,
    /// Stretch of the section along the bending direction.
    pub section_stretch: R,
}

impl<R: Real> RollUp<R> {
    /// Distance in m between the ends of a beam of reference length `length` in m. Its axis is
    /// an arc of length `lambda L` and geometric curvature `kappa/lambda`.
    #[must_use]
    pub fn gap(&self, length: R) -> R {
        let half = R::lit(0.5) * self.curvature * length;
        // The limit of a straight beam, where the chord formula is 0/0.
        if half.value() == 0.0 {
            return self.axial_stretch * length;
        }
        let chord = self.axial_stretch * length * half.sin() / half;
        if chord < R::zero() { -chord } else { chord }
    }
}

/// Exact limit, without a mesh, of a section-linear St Venant-Kirchhoff beam with zero Poisson
/// ratio under a `moment` (in N m) that bends it uniformly.
///
/// With `r_x = (lambda - a kappa y) t` and `|r_y| = a` the strains are
/// `E_xx = (|r_x|^2 - 1)/2` and `E_yy = (a^2 - 1)/2`, and the energy per reference length
///
/// ```text
/// W = E/8 [(lambda^2 - 1)^2 A + 4 lambda^2 a^2 kappa^2 I + a^4 kappa^4 I4
///          + 2 (lambda^2 - 1) a^2 kappa^2 I + (a^2 - 1)^2 A].
/// ```
///
/// Both stretches relax, which gives them in closed form in the curvature (with
/// `k^2 = kappa^2 I/A`, `b = A I4/I^2`): `a^2 = (1 - 2 k^2)/(1 + (b - 9) k^4)`,
/// `lambda^2 = 1 - 3 a^2 k^2`. The curvature then follows from `dW/dkappa = M` by Newton's
/// method. St Venant-Kirchhoff material softens in bending: for a disk
/// `kappa = M/(E I) (1 + 5.5 (M R/(2 E I))^2)` to first order, so a moment `2 pi E I/L` bends the
/// beam further than to a full circle.
///
/// # Errors
/// [`Error::NotPositive`] or [`Error::NotFinite`] for such input, [`Error::OutOfRange`] for a
/// moment beyond the largest that the softening section can carry.
pub fn pure_bending<R: Real>(
    section: &BendingSection<R>,
    moment: R,
    kind: EndMoment,
) -> Result<RollUp<R>> {
    let modulus = positive("Young's modulus in Pa", section.modulus)?;
    let area = positive("area of the section in m^2", section.area)?;
    let second = positive("second moment of the section in m^4", section.second)?;
    let fourth = positive("fourth moment of the section in m^6", section.fourth)?;
    let gyration = (second / area).sqrt();
    let load = finite("bending moment in N m", moment)? * gyration / (modulus * second);
    let shape = Dual::from_re(fourth * area / (second * second));

    let residual = |k: Dual<R>| {
        let (axial, across) = squared_stretches(k, shape);
        let lit = |x| Dual::from_re(R::lit(x));
        let resultant =
            lit(0.5) * across * k * (lit(3.0) * axial - lit(1.0) + shape * across * k * k);
        let arm = match kind {
            EndMoment::Conjugate => lit(1.0),
            EndMoment::NormalToSlope | EndMoment::AlongAxis => across.sqrt(),
            EndMoment::SecondPiola => (across * axial).sqrt(),
        };
        resultant - arm * Dual::from_re(load)
    };
    let k = newton(load, residual).ok_or(Error::OutOfRange {
        what: "bending moment times radius of gyration over E I",
        value: load.value(),
        range: "the range that the softening section can carry",
        remedy: "reduce the moment or the thickness of the section",
    })?;
    let (axial, across) = squared_stretches(Dual::from_re(k), shape);
    Ok(RollUp {
        curvature: k / gyration,
        axial_stretch: axial.re.sqrt(),
        section_stretch: across.re.sqrt(),
    })
}

/// `lambda^2` and `a^2` of the relaxed section at the curvature `k` times radius of gyration.
fn squared_stretches<R: Real>(k: Dual<R>, shape: Dual<R>) -> (Dual<R>, Dual<R>) {
    let lit = |x| Dual::from_re(R::lit(x));
    let square = k * k;
    let across = (lit(1.0) - lit(2.0) * square) / (lit(1.0) + (shape - lit(9.0)) * square * square);
    (lit(1.0) - lit(3.0) * across * square, across)
}

/// Root of `residual` near `start`; `None` if the slope turns negative or nothing converges.
fn newton<R: Real>(start: R, residual: impl Fn(Dual<R>) -> Dual<R>) -> Option<R> {
    const ITERATIONS: usize = 60;
    let mut x = start;
    // Steps after the real part has converged: derivatives follow one step behind it, and
    // second derivatives one more.
    let mut polish = 3;
    for _ in 0..ITERATIONS {
        let f = residual(Dual::new(x, R::one()));
        if !(f.re.finite() && f.eps.finite() && f.eps > R::zero()) {
            return None;
        }
        let step = f.re / f.eps;
        x -= step;
        if step.value().abs() <= 64.0 * R::EPSILON * x.value().abs() {
            polish -= 1;
            if polish == 0 {
                return Some(x);
            }
        }
    }
    None
}

/// Tip deflection in m of a cantilever under a transverse tip load in N, after Euler and
/// Bernoulli: `F L^3/(3 E I)`, with `length` in m and `bending_stiffness = E I` in N m^2.
///
/// # Errors
/// [`Error::NotPositive`] for a stiffness that is not.
pub fn cantilever_small_deflection<R: Real>(load: R, length: R, bending_stiffness: R) -> Result<R> {
    let stiffness = positive("bending stiffness in N m^2", bending_stiffness)?;
    Ok(load * length * length * length / (R::lit(3.0) * stiffness))
}

/// What shear adds to [`cantilever_small_deflection`] after Timoshenko, in m: `F L/(k G A)`,
/// with `shear_stiffness = k G A` in N.
///
/// # Errors
/// [`Error::NotPositive`] for a stiffness that is not.
pub fn cantilever_shear_deflection<R: Real>(load: R, length: R, shear_stiffness: R) -> Result<R> {
    Ok(load * length / positive("shear stiffness in N", shear_stiffness)?)
}

/// Tip deflection of a slender cantilever of `elements` equal fully parameterised elements
/// (cubic axis, slopes across it linear) over `F L^3/(3 E I)`, for small loads and zero Poisson
/// ratio: `1 - 1/(4 n^2)`. The curvature of the slopes is constant in each element, so that the
/// linear moment is replaced by its mean there.
///
/// # Errors
/// [`Error::TooFew`] without elements.
pub fn fully_parameterised_tip_ratio<R: Real>(elements: usize) -> Result<R> {
    if elements == 0 {
        return Err(Error::TooFew {
            what: "number of elements",
            value: 0,
            least: 1,
            remedy: "a beam needs at least one element",
        });
    }
    let n = elements as f64;
    Ok(R::one() - R::lit(0.25) / (R::lit(n) * R::lit(n)))
}

/// Deflection to which Poisson locking takes section-linear elements of the full continuum, on
/// any mesh, over the true one: `(1 + nu)(1 - 2 nu)/(1 - nu)`. The section cannot contract on
/// one side and widen on the other, so it bends with the constrained modulus.
///
/// # Errors
/// [`Error::OutOfRange`] for a Poisson ratio outside `(-1, 1/2)`.
pub fn poisson_locked_ratio<R: Real>(poisson: R) -> Result<R> {
    let nu = checked_poisson(poisson)?;
    let one = R::one();
    Ok((one + nu) * (one - nu - nu) / (one - nu))
}

/// Circular frequency in rad/s of the uniform breathing of a disk of `radius` in m whose section
/// deforms linearly: `(2/R) sqrt(E/(rho (1 + nu)(1 - 2 nu)))`, with `modulus` in Pa and `density`
/// in kg/m^3. About the highest frequency of a fully parameterised beam, and the one that limits
/// explicit integration. Derived: equal strains `e` along both diameters and none along the axis
/// store `E e^2 A/((1 + nu)(1 - 2 nu))` and move with `rho I (de/dt)^2` per length.
///
/// # Errors
/// [`Error::NotPositive`] or [`Error::OutOfRange`] for inadmissible input.
pub fn thickness_frequency<R: Real>(modulus: R, poisson: R, density: R, radius: R) -> Result<R> {
    let modulus = positive("Young's modulus in Pa", modulus)?;
    let density = positive("density in kg/m^3", density)?;
    let radius = positive("radius in m", radius)?;
    let (nu, one) = (checked_poisson(poisson)?, R::one());
    let stiffness = modulus / (density * (one + nu) * (one - nu - nu));
    Ok(R::lit(2.0) * stiffness.sqrt() / radius)
}

fn checked_poisson<R: Real>(poisson: R) -> Result<R> {
    if poisson.finite() && poisson > R::lit(-1.0) && poisson < R::lit(0.5) {
        return Ok(poisson);
    }
    Err(Error::OutOfRange {
        what: "Poisson ratio",
        value: poisson.value(),
        range: "(-1, 1/2)",
        remedy: "an incompressible material needs another formulation",
    })
}

/// Tip of an inextensible cantilever without shear under a transverse dead load of any size:
/// Euler's elastica in elliptic integrals. Agrees with Mattiasson (1981), "Numerical results from
/// large deflection beam and frame problems analysed by means of elliptic integrals".
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Elastica<R> {
    /// Tip displacement along the load over the length.
    pub deflection: R,
    /// Tip displacement against the undeformed axis, towards the clamp, over the length.
    pub shortening: R,
    /// Rotation of the tip in radians.
    pub rotation: R,
}

impl<R: Real> Elastica<R> {
    /// Tip under the dimensionless load `P L^2/(E I)`, exact to a few rounding units of the
    /// length.
    ///
    /// With `s` the sine of the tip's rotation and `g = 1 - s`, integrating
    /// `theta'^2 = 2 P/(E I) (s - sin theta)` gives in Carlson's symmetric integrals
    /// `P L^2/(E I) = 2 s RF^2` with `RF(g, g (2 - g), 2 - g)`, the deflection
    /// `s - (1 + s) s g RD/(3 RF)` with `RD(g, 2 - g, g (2 - g))` and the shortening `1 - 1/RF`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a load that is negative or so large that `g` underflows.
    pub fn under_transverse_load(load: R) -> Result<Self> {
        let refused = Error::OutOfRange {
            what: "load P L^2/(E I)",
            value: load.value(),
            range: "0 to 1e5 (f64) or 1e3 (f32)",
            remedy: "mirror the result for a negative load; under a larger one the beam hangs \
                     straight down",
        };
        if !(load.finite() && load >= R::zero()) {
            return Err(refused);
        }
        // The unknown is -ln g: the load is smooth and convex in it, linear for small loads and
        // quadratic for large ones, where g itself falls below any rounding of s.
        let linear = R::lit(0.5) * load;
        let start = if load > R::lit(16.0) {
            R::lit(2.0) * load.sqrt()
        } else {
            linear
        };
        let residual = |q: Dual<R>| {
            let (s, g) = (-(-q).exp_m1(), (-q).exp());
            let rf = carlson_rf(complement(g), |d| d.re);
            Dual::from_re(R::lit(2.0)) * s * rf * rf - Dual::from_re(load)
        };
        let q = newton(start, residual).ok_or(refused)?;
        let (s, g) = (-(-q).exp_m1(), (-q).exp());
        let [x, y, z] = complement(g);
        let (rf, rd) = (carlson_rf([x, y, z], |x| x), carlson_rd([x, z, y]));
        let one = R::one();
        Ok(Self {
            deflection: s - (one + s) * s * g * rd / (R::lit(3.0) * rf),
            shortening: one - one / rf,
            // The arc sine of s, without its loss of digits near one.
            rotation: R::lit(2.0) * (s / (one + y.sqrt())).atan(),
        })
    }
}

/// `g, g (2 - g), 2 - g`.
fn complement<T: Field>(g: T) -> [T; 3] {
    let other = T::lit(2.0) - g;
    [g, g * other, other]
}

/// Spread of the arguments at which Carlson's series is summed: the first neglected term is of
/// its sixth power, and of its fifth in the derivatives.
fn spread<R: Real>() -> f64 {
    R::EPSILON.powf(0.2).min(1e-3)
}

/// `RF(x, y, z) = 1/2 int_0^inf dt/sqrt((t + x)(t + y)(t + z))` by duplication (Carlson 1995);
/// `value` tells the real part.
fn carlson_rf<R: Real, T: Algebra<R>>(mut x: [T; 3], value: impl Fn(T) -> R) -> T {
    let lit = T::lit;
    loop {
        let mean = (x[0] + x[1] + x[2]) / lit(3.0);
        let d = x.map(|x| T::one() - x / mean);
        if !(d.iter().any(|d| value(*d).value().abs() > spread::<R>())) {
            let e2 = d[0] * d[1] - d[2] * d[2];
            let e3 = d[0] * d[1] * d[2];
            let series = T::one() - e2 / lit(10.0) + e3 / lit(14.0) + e2 * e2 / lit(24.0)
                - lit(3.0) * e2 * e3 / lit(44.0);
            return series / mean.sqrt();
        }
        let lambda = duplication(x);
        x = x.map(|x| (x + lambda) * lit(0.25));
    }
}

/// `RD(x, y, z) = 3/2 int_0^inf dt/(sqrt((t + x)(t + y)) (t + z)^(3/2))`, likewise.
fn carlson_rd<R: Real>(mut x: [R; 3]) -> R {
    let (lit, ratio) = (R::lit, |a, b| R::lit(a) / R::lit(b));
    let (mut sum, mut weight) = (R::zero(), R::one());
    loop {
        let mean = (x[0] + x[1] + lit(3.0) * x[2]) / lit(5.0);
        let d = x.map(|x| R::one() - x / mean);
        if !(d.iter().any(|d| d.value().abs() > spread::<R>())) {
            let (p, z) = (d[0] * d[1], d[2]);
            let e2 = p - lit(6.0) * z * z;
            let e3 = (lit(3.0) * p - lit(8.0) * z * z) * z;
            let e4 = lit(3.0) * (p - z * z) * z * z;
            let e5 = p * z * z * z;
            let series =
                R::one() - ratio(3.0, 14.0) * e2 + e3 / lit(6.0) + ratio(9.0, 88.0) * e2 * e2
                    - ratio(3.0, 22.0) * e4
                    - ratio(9.0, 52.0) * e2 * e3
                    + ratio(3.0, 26.0) * e5;
            return lit(3.0) * sum + weight * series / (mean * mean.sqrt());
        }
        let lambda = duplication(x);
        sum += weight / (x[2].sqrt() * (x[2] + lambda));
        weight *= lit(0.25);
        x = x.map(|x| (x + lambda) * lit(0.25));
    }
}

fn duplication<T: Field>(x: [T; 3]) -> T {
    let [x, y, z] = x.map(|x| x.sqrt());
    x * y + y * z + z * x
}
