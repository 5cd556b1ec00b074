//! St Venant-Kirchhoff: linear elasticity between Green-Lagrange strain and second
//! Piola-Kirchhoff stress (eq. 11 of Orzechowski 2012).

use super::{Blocks, Material, Moduli, PoissonSplit, Tensor};
use crate::error::{Error, Result, finite, positive};
use crate::scalar::{Algebra, Real};
use crate::tensor::{add_scaled, between, times};

/// Linear elastic material with orthotropic moduli: a matrix of normal moduli and one shear
/// modulus per pair of axes. Isotropic by [`isotropic`](Self::isotropic).
///
/// ```
/// use ancf::material::SaintVenantKirchhoff;
///
/// let steel = SaintVenantKirchhoff::<f64, 3>::isotropic(2.1e11, 0.3)?;
/// assert!(SaintVenantKirchhoff::<f64, 3>::isotropic(2.1e11, 0.5).is_err());
/// # Ok::<(), ancf::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SaintVenantKirchhoff<R, const D: usize> {
    young: R,
    moduli: Moduli<R, D>,
}

/// Rounding units of one that `1 - 2 nu` must have for the shear modulus to keep two digits beside
/// the bulk modulus.
const HIDDEN: f64 = 100.0;

impl<R: Real, const D: usize> SaintVenantKirchhoff<R, D> {
    /// Isotropic material with Young's modulus `young` (Pa) and Poisson ratio `poisson`.
    ///
    /// In space the law is three-dimensional. In the plane (`D = 2`) it is plane stress, the
    /// right limit of a beam whose width may contract freely.
    ///
    /// # Errors
    /// [`Error::NotPositive`] for the modulus, [`Error::OutOfRange`] for a Poisson ratio outside
    /// the open interval (-1, 1/2), where the law has no positive energy, and in space for one so
    /// near 1/2 that the number type loses the shear modulus beside the bulk modulus.
    pub fn isotropic(young: R, poisson: R) -> Result<Self> {
        let young = positive("Young's modulus [Pa]", young)?;
        let half = R::lit(0.5);
        if !(poisson.finite() && poisson > -R::one() && poisson < half) {
            return Err(Error::OutOfRange {
                what: "Poisson ratio",
                value: poisson.value(),
                range: "the open interval (-1, 0.5)",
                remedy: "take a value below 0.5 (0.4999 for nearly incompressible material)",
            });
        }
        // The bulk modulus exceeds the shear modulus as 1 / (1 - 2 nu).
        let left = 1.0 - 2.0 * poisson.value();
        if D > 2 && left < HIDDEN * R::EPSILON {
            return Err(Error::OutOfRange {
                what: "Poisson ratio",
                value: poisson.value(),
                range: "what the number type can tell from 0.5 to two digits",
                remedy: "the shear modulus would be lost in rounding of the bulk modulus: take a smaller ratio, or a number type of more digits",
            });
        }
        let (one, two) = (R::one(), R::lit(2.0));
        let shear = young / (two * (one + poisson));
        let (diagonal, coupling) = if D == 2 {
            let plane = young / (one - poisson * poisson);
            (plane, plane * poisson)
        } else {
            let lame = young * poisson / ((one + poisson) * (one - two * poisson));
            (lame + two * shear, lame)
        };
        finite("largest modulus of the material [Pa]", diagonal)?;
        positive("shear modulus of the material [Pa]", shear)?;
        Ok(Self {
            young,
            moduli: Moduli {
                normal: std::array::from_fn(|a| {
                    std::array::from_fn(|b| if a == b { diagonal } else { coupling })
                }),
                shear: [[shear; D]; D],
            },
        })
    }

    /// Young's modulus (Pa) the material was made with.
    pub fn young(&self) -> R {
        self.young
    }

    /// Shear modulus (Pa) `E / (2 (1 + nu))` of the material.
    pub fn shear(&self) -> R {
        self.moduli.shear[0][D - 1]
    }
}

impl<R: Real, const D: usize> PoissonSplit for SaintVenantKirchhoff<R, D> {
    fn uncoupled(&self) -> Self {
        let mut part = *self;
        part.moduli.normal = std::array::from_fn(|a| {
            std::array::from_fn(|b| if a == b { self.young } else { R::zero() })
        });
        part
    }

    fn coupled(&self) -> Self {
        let mut part = *self;
        for a in 0..D {
            part.moduli.normal[a][a] -= self.young;
        }
        part.moduli.shear = [[R::zero(); D]; D];
        part
    }
}

impl<R: Real, const D: usize> Material<R, D> for SaintVenantKirchhoff<R, D> {
    const LANES: bool = true;
    const CONSTANT: bool = true;

    #[inline(always)]
    fn energy<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> T {
        let stress = self.stress(strain);
        let mut twice = T::zero();
        for a in 0..D {
            for b in 0..D {
                twice += stress[a][b] * strain[a][b];
            }
        }
        twice.times(R::lit(0.5))
    }

    #[inline(always)]
    fn stress<T: Algebra<R>>(&self, strain: &Tensor<T, D>) -> Tensor<T, D> {
        self.moduli.stress(strain)
    }

    #[inline(always)]
    fn secant<T: Algebra<R>>(&self, from: &Tensor<T, D>, to: &Tensor<T, D>) -> Tensor<T, D> {
        self.stress(&between(from, to, R::lit(0.5)))
    }

    #[inline(always)]
    fn secant_elasticity<T: Algebra<R>>(
        &self,
        from: &Tensor<T, D>,
        _to: &Tensor<T, D>,
    ) -> Blocks<T, D> {
        let half = |row: [T; D]| times(R::lit(0.5), &row);
        self.elasticity(from).map(|a| a.map(|e| e.map(half)))
    }

    #[inline(always)]
    fn elasticity<T: Algebra<R>>(&self, _strain: &Tensor<T, D>) -> Blocks<T, D> {
        let mut c = [[[[T::zero(); D]; D]; D]; D];
        for a in 0..D {
            for b in 0..D {
                c[a][a][b][b] = T::lift(self.moduli.normal[a][b]);
                if a != b {
                    c[a][b][a][b] = T::lift(self.moduli.shear[a][b]);
                    c[a][b][b][a] = T::lift(self.moduli.shear[a][b]);
                }
            }
        }
        c
    }

    #[inline]
    fn constant_elasticity(&self) -> Option<Moduli<R, D>> {
        Some(self.moduli)
    }

    #[inline(always)]
    fn stiffness<T: Algebra<R>>(&self, _strain: &Tensor<T, D>, c: &Tensor<T, D>) -> Blocks<T, D> {
        let mut blocks = [[[[T::zero(); D]; D]; D]; D];
        for a in 0..D {
            for b in a..D {
                for i in 0..D {
                    let row = &mut blocks[a][b][i];
                    add_scaled(row, c[a][i].times(self.moduli.normal[a][b]), &c[b]);
                    if a == b {
                        for e in (0..D).filter(|&e| e != a) {
                            add_scaled(row, c[e][i].times(self.moduli.shear[a][e]), &c[e]);
                        }
                    } else {
                        add_scaled(row, c[b][i].times(self.moduli.shear[a][b]), &c[a]);
                    }
                }
            }
        }
        blocks
    }
}
