//! An element of your own is its shape functions: four nodes with position and cross slopes, cubic
//! along the axis, checked and bent.
use ancf::element::NodalVector::{Position, Slope};
use ancf::{prelude::*, verify};

/// Lagrange interpolation of `r + y r_y + z r_z` from the nodes at 0, 1/3, 2/3 and 1.
#[derive(Debug, Clone, Copy)]
struct FourNode;

impl Element<3, 12> for FourNode {
    const NODES: usize = 4;
    const VECTORS: &'static [NodalVector] = &[Position, Slope(1), Slope(2)];
    const AXIAL_DEGREE: usize = 3;

    fn shape<T: Scalar>(&self, l: T, x: [T; 3]) -> [T; 12] {
        std::array::from_fn(|k| {
            let (node, vector) = (k / 3, k % 3);
            let factor = if vector == 0 { T::one() } else { l * x[vector] };
            (0..4)
                .filter(|other| *other != node)
                .fold(factor, |s, other| {
                    let gap = (node as f64 - other as f64).recip();
                    s * (x[0] * T::lit(3.0 * gap) - T::lit(other as f64 * gap))
                })
        })
    }
}

fn main() -> Result<()> {
    let (young, disk) = (2.0e11, Disk::new(0.01)?);
    let steel = SaintVenantKirchhoff::isotropic(young, 0.3)?;
    // Three axial points do not lock.
    let remedy = Continuum::selective_reduced(steel).axial(3);
    let report = verify::element(&FourNode, 0.1)
        .and(verify::formulation(&FourNode, &remedy, &disk, 0.1)?)
        .and(verify::sampling(&FourNode, &steel, &disk)?);
    println!("{}\n", report.into_result()?);
    for elements in [1, 2, 4, 8] {
        let mut scene = Scene::<f64, 3>::new();
        let beam = Beam::new(FourNode, disk, remedy.clone());
        let beam = scene.add(beam.straight([0.0; 3], [1.0, 0.0, 0.0], elements))?;
        scene.clamp(beam.start())?;
        scene.force(beam.end(), [0.0, 0.0, -1.0])?;
        let system = scene.assemble()?;
        let mut state = system.rest();
        Statics::default().solve(&system, &mut state)?;
        let z = system.displacement(&state, beam.end())?[2];
        let theory = -1.0 / (3.0 * young * disk.properties()?.iyy);
        println!(
            "{elements} elements: {:.6} of the slender beam's deflection",
            z / theory
        );
    }
    Ok(())
}
