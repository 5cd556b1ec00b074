//! A slender beam of unit length and bending stiffness, bent like a true cantilever (to 0.46 rad
//! under a unit load, which is what errors are related to), and its elastic force in three forms.

use ancf::prelude::*;
use ancf::quadrature::gauss_legendre;
use ancf::verify::{Staged, Textbook};

/// How strains are formed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Form {
    /// From total coordinates.
    Textbook,
    /// From displacements, as the library does.
    Displacements,
    /// From displacements in the co-moving frame.
    CoMoving,
}

/// Where the bent beam is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Pose {
    /// Clamped at the origin, along the x axis there.
    Clamped,
    /// The same turned by 2 rad about the axis (1, 2, 2).
    Turned,
    /// The same ten lengths away.
    Away,
}

/// The elastic force of the beam; the parameter is the radius over the length. What is stored are
/// the coordinates, total ones for the textbook's form.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Force {
    /// How strains are formed.
    pub form: Form,
    /// Where the beam is.
    pub pose: Pose,
    /// Slope angle at the tip (rad).
    pub bend: f64,
}

/// Elements of an eighth of the length, a number that every type holds exactly.
const ELEMENTS: usize = 8;

/// A vector turned by `angle` about (1, 2, 2).
pub fn turned<R: Real>(v: [R; 3], angle: f64) -> [R; 3] {
    let a = [1.0, 2.0, 2.0].map(|c| R::lit(c) / R::lit(3.0));
    let (sin, cos) = (Field::sin(R::lit(angle)), Field::cos(R::lit(angle)));
    let along = (0..3).map(|c| a[c] * v[c]).sum::<R>() * (R::one() - cos);
    std::array::from_fn(|c| {
        let (d, e) = ((c + 1) % 3, (c + 2) % 3);
        cos * v[c] + sin * (a[d] * v[e] - a[e] * v[d]) + along * a[c]
    })
}

impl Pose {
    fn angle(self) -> f64 {
        if self == Self::Turned { 2.0 } else { 0.0 }
    }

    /// Nodal vectors of a beam whose axis has the slope angle `bend s (2 - s)`.
    fn coordinates<R: Real>(self, bend: f64) -> Result<Vec<R>> {
        let direction = |s: R| {
            let angle = R::lit(bend) * s * (R::lit(2.0) - s);
            (Field::sin(angle), Field::cos(angle))
        };
        let (h, zero, one) = (R::lit(1.0 / ELEMENTS as f64), R::zero(), R::one());
        let away = if self == Self::Away {
            [6.0, 7.0, 4.0]
        } else {
            [0.0; 3]
        };
        let (mut e, mut r) = (Vec::new(), [zero; 3]);
        for node in 0..=ELEMENTS {
            let s = h * R::lit(node as f64);
            let (sin, cos) = direction(s);
            let vectors = [r, [cos, sin, zero], [-sin, cos, zero], [zero, zero, one]];
            for (i, v) in vectors.into_iter().enumerate() {
                let shift = if i == 0 { away } else { [0.0; 3] };
                let v = turned(v, self.angle());
                e.extend((0..3).map(|c| v[c] + R::lit(shift[c])));
            }
            for ([x], w) in gauss_legendre::<R>(12)?.iter() {
                let (sin, cos) = direction(s + x * h);
                r = [r[0] + cos * w * h, r[1] + sin * w * h, zero];
            }
        }
        Ok(e)
    }
}

/// The beam, the same in every type: radius and modulus are rounded to single precision.
pub fn system<R: Real, F>(
    radius: f64,
    form: impl Fn(SaintVenantKirchhoff<R, 3>) -> F,
) -> Result<System<R, 3>>
where
    F: Formulation<R, FullyParameterised, 3, 8> + 'static,
{
    let young = (4.0 / std::f64::consts::PI / radius.powi(4)) as f32;
    let material = SaintVenantKirchhoff::isotropic(R::lit(young.into()), R::zero())?;
    let disk = Disk::new(R::lit((radius as f32).into()))?;
    let end = [R::one(), R::zero(), R::zero()];
    let mut scene = Scene::new();
    let beam = Beam::new(FullyParameterised, disk, form(material));
    scene.add(beam.straight([R::zero(); 3], end, ELEMENTS))?;
    scene.assemble()
}

impl Staged for Force {
    const STAGES: &'static [&'static str] = &["force", "transverse part"];

    fn given<X: Real>(&self, radius: f64) -> Result<Vec<X>> {
        let e = self.pose.coordinates(self.bend)?;
        if self.form == Form::Textbook {
            return Ok(e);
        }
        let system = system::<X, _>(radius, Continuum::full)?;
        let u = e.iter().zip(system.reference()).map(|(e, e0)| *e - *e0);
        Ok(u.collect())
    }

    fn stage<R: Real>(&self, k: usize, radius: f64, x: &[R]) -> Result<Vec<R>> {
        if k == 1 {
            let across = turned([R::zero(), R::one(), R::zero()], self.pose.angle());
            let along = |q: &[R]| (0..3).map(|c| q[c] * across[c]).sum();
            return Ok(x.chunks(12).map(along).collect());
        }
        let system = match self.form {
            Form::Textbook => system(radius, Textbook)?,
            Form::Displacements => system(radius, Continuum::full)?,
            Form::CoMoving => system(radius, |m| CoMoving(Continuum::full(m)))?,
        };
        let mut q = vec![R::zero(); x.len()];
        system.add_internal(x, &mut q);
        Ok(q)
    }

    fn size(&self, _: f64) -> Option<f64> {
        Some(1.0)
    }
}
