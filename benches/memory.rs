//! Memory per element, counted by the allocator: `cargo bench --bench memory`. The system holds
//! kernels, mass and sparsity, the run its states, tangent, factors and whatever the scheme keeps.

use std::alloc::System as SystemAllocator;

use ancf::prelude::*;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};

#[global_allocator]
static COUNTED: &StatsAlloc<SystemAllocator> = &INSTRUMENTED_SYSTEM;

/// What something keeps (bytes per element) after it is made.
fn kept<T>(elements: usize, make: impl FnOnce() -> Result<T>) -> Result<(f64, T)> {
    let region = Region::new(COUNTED);
    let made = make()?;
    let change = region.change();
    // What grows or shrinks is in both: its bytes reallocated are not to be counted again.
    let bytes = change.bytes_allocated as isize - change.bytes_deallocated as isize;
    Ok((bytes as f64 / elements as f64, made))
}

fn row<R, E, F, const D: usize, const S: usize>(name: &str, element: E, law: F) -> Result<()>
where
    R: Real,
    E: Element<D, S>,
    F: Formulation<R, E, D, S>,
{
    let elements = 4096;
    let unit = |c: usize| {
        if c == 0 {
            R::lit(elements as f64)
        } else {
            R::zero()
        }
    };
    let (system, built) = kept(elements, || {
        let mut scene = Scene::<R, D>::new();
        let beam = Beam::new(element, Disk::new(R::lit(0.1))?, law);
        let beam = beam.straight([R::zero(); D], std::array::from_fn(unit), elements);
        let beam = scene.add(beam.density(R::lit(7200.0)))?;
        scene.pin(beam.start())?;
        scene.assemble()
    })?;
    let newmark = Newmark::trapezoidal();
    let (run, _run) = kept(elements, || {
        Integration::start(&built, built.rest(), &newmark)
    })?;
    println!(
        "| {name}, {} bytes a number | {system:.0} | {run:.0} |",
        size_of::<R>()
    );
    Ok(())
}

fn dimension<R: Real>() -> Result<()> {
    let solid = SaintVenantKirchhoff::<R, 3>::isotropic(R::lit(2e7), R::lit(0.3))?;
    let flat = SaintVenantKirchhoff::<R, 2>::isotropic(R::lit(2e7), R::lit(0.3))?;
    let continuum = Continuum::selective_reduced(solid);
    row::<R, _, _, 3, 8>("space, fully parameterised", FullyParameterised, continuum)?;
    row::<R, _, _, 3, 9>(
        "space, quadratic rod",
        Quadratic,
        StructuralMechanics::new(&solid),
    )?;
    row::<R, _, _, 3, 4>("space, cable", Cable, EulerBernoulli::new(&solid))?;
    let continuum = Continuum::selective_reduced(flat);
    row::<R, _, _, 2, 6>("plane, fully parameterised", FullyParameterised, continuum)?;
    row::<R, _, _, 2, 6>(
        "plane, quadratic rod",
        Quadratic,
        StructuralMechanics::new(&flat),
    )?;
    row::<R, _, _, 2, 4>("plane, cable", Cable, EulerBernoulli::new(&flat))
}

fn main() -> Result<()> {
    println!("| bytes per element | system | trapezoidal run |");
    println!("|---|---|---|");
    dimension::<f64>()?;
    dimension::<f32>()
}
