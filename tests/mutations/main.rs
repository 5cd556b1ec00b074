//! Claims about what the checks catch: a wrong element, formulation, section or material fails the
//! check that is meant for it, and every check of the kit has something that it alone is there to
//! catch.

mod elements;
mod laws;

use std::collections::BTreeSet;

use ancf::prelude::*;
use ancf::verify::Report;

fn rubber<const D: usize>() -> SaintVenantKirchhoff<f64, D> {
    SaintVenantKirchhoff::isotropic(2.0e7, 0.3).unwrap()
}

fn disk() -> Disk<f64> {
    Disk::new(0.04).unwrap()
}

/// Names of the checks that failed.
fn failures(report: &Report) -> BTreeSet<&'static str> {
    report.failed().map(|row| row.check).collect()
}

fn assert_fails(report: &Report, only: &[&'static str]) {
    assert_eq!(failures(report), only.iter().copied().collect(), "{report}");
    assert!(report.clone().into_result().is_err());
}

/// The right type passes every check, and each of them is failed by one of the wrong ones.
fn assert_each_check_catches(right: &Report, wrong: &[Report]) {
    assert!(right.passed(), "{right}");
    let demands = right.rows().iter().filter(|row| row.demands());
    let caught: BTreeSet<_> = wrong.iter().flat_map(failures).collect();
    for check in demands.map(|row| row.check).collect::<BTreeSet<_>>() {
        assert!(caught.contains(check), "nothing fails {check:?}");
    }
}
