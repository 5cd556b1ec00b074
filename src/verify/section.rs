//! Checks of a section. Two descriptions of it are independent: the rule it integrates by and the
//! outline it is drawn by; moments of the one by its weights and of the other by Green's theorem
//! must agree.

use super::material::least;
use super::{Limit, Report};
use crate::element::most;
use crate::error::{Error, Result};
use crate::quadrature::{Cubature, gauss_legendre, project};
use crate::scalar::Real;
use crate::section::Section;

/// Points of the coarsest outline of the extrapolation, and how often it is doubled.
const COARSE: usize = 64;
const DOUBLINGS: usize = 5;
/// How many degrees a rule that counts as finer has more.
const FINER: usize = 6;

/// Checks a section with its rules of every degree up to `degree`, in space and in the plane:
/// weights, points inside the outline, the degree actually reached against the moments of the
/// outline, against a finer rule and of the projection, and the section's properties. Errors of
/// moments are relative to area times the extents of the section.
///
/// A section without an outline is compared with its finer rule, and its properties with its rule.
///
/// # Errors
/// Those of the section's rules and properties; a degree the section has no rule for is a row
/// that informs.
pub fn section<R: Real, X: Section<R> + ?Sized>(section: &X, degree: usize) -> Result<Report> {
    let mut report = Report::new(format!("{section:?}"));
    let outline = Outline::of(section, degree.max(2))?;
    let mut rules = 0;
    for degree in 1..=degree {
        let case = format!("degree {degree}");
        let Ok(rule) = section.rule(degree) else {
            report.push("section without a rule", case, 1.0, Limit::None);
            continue;
        };
        rules += 1;
        let area = rule.integrate(|_| R::one()).value();
        let lightest = rule
            .weights()
            .iter()
            .fold(f64::INFINITY, |m, w| least(m, w.value()));
        report.push(
            "smallest weight over the area",
            &case,
            lightest / area,
            Limit::Above(0.0),
        );
        let claimed = Limit::AtLeast(degree as f64);
        report.push(
            "degree the rule claims",
            &case,
            rule.degree() as f64,
            claimed,
        );
        let size = outline.as_ref().map_or_else(|| extent(&rule), |o| o.size);
        if let Some(outline) = &outline {
            let points = rule.points().iter().map(|x| x.map(R::value));
            let outside = points.filter(|x| !outline.contains(*x)).count();
            report.push(
                "points outside the outline",
                &case,
                outside as f64,
                Limit::AtMost(0.0),
            );
            let error = worst(degree, |a, b| {
                let scale = outline.area * size[0].powi(a) * size[1].powi(b);
                (moment(&rule, a, b) - outline.moment(a, b)) / scale
            });
            let limit = Limit::AtMost(outline.limit::<R>());
            report.push("moments against the outline", &case, error, limit);
        }
        if let Ok(fine) = section.rule(degree + FINER) {
            let error = worst(degree, |a, b| {
                let scale = area * size[0].powi(a) * size[1].powi(b);
                (moment(&rule, a, b) - moment(&fine, a, b)) / scale
            });
            report.push(
                "moments against a finer rule",
                &case,
                error,
                Limit::AtMost(1e3 * R::EPSILON),
            );
        }
        match section.planar_rule(degree) {
            Ok(plane) => {
                let lightest = plane
                    .weights()
                    .iter()
                    .fold(f64::INFINITY, |m, w| least(m, w.value()));
                let case = format!("plane, degree {degree}");
                report.push(
                    "smallest weight over the area",
                    &case,
                    lightest / area,
                    Limit::Above(0.0),
                );
                let projected = section
                    .rule(degree | 1)
                    .and_then(|rule| project(&rule, degree));
                let error = worst(degree, |a, b| {
                    if b > 0 {
                        return 0.0;
                    }
                    let power = |x: [R; 1]| R::lit(x[0].value().powi(a));
                    let reduced = plane.integrate(power).value();
                    let whole = match &projected {
                        Ok(projected) => projected.integrate(power).value(),
                        Err(_) => moment(&rule, a, 0),
                    };
                    (reduced - whole) / (area * size[0].powi(a))
                });
                let limit = Limit::AtMost(1e3 * R::EPSILON);
                report.push("planar rule against the projection", case, error, limit);
            }
            Err(_) => report.push("section without a planar rule", &case, 1.0, Limit::None),
        }
    }
    report.push("degrees with a rule", "", rules as f64, Limit::AtLeast(1.0));
    // Without an outline by the section's own rule, where it has one of the second degree.
    let rule = section.rule(2);
    let (size, limit, against) = match (&outline, &rule) {
        (Some(outline), _) => (
            outline.size,
            Limit::AtMost(outline.limit::<R>()),
            "properties against the outline",
        ),
        (None, Ok(rule)) => (
            extent(rule),
            Limit::AtMost(1e3 * R::EPSILON),
            "properties against the rule",
        ),
        (None, Err(_)) => return Ok(report),
    };
    let of = |a, b| match (&outline, &rule) {
        (Some(outline), _) => outline.moment(a, b),
        (None, Ok(rule)) => moment(rule, a, b),
        (None, Err(_)) => f64::NAN,
    };
    let p = section.properties()?;
    let area = of(0, 0);
    let [y, z] = [(1, 0), (0, 1)].map(|(a, b)| of(a, b) / area);
    let about = |a, b, m: f64| of(a, b) - area * m;
    let [h, w] = size;
    for (case, given, truth, scale) in [
        ("area", p.area, area, area),
        ("centroid y", p.centroid[0], y, h),
        ("centroid z", p.centroid[1], z, w),
        ("iyy", p.iyy, about(0, 2, z * z), area * w * w),
        ("izz", p.izz, about(2, 0, y * y), area * h * h),
        ("iyz", p.iyz, about(1, 1, y * z), area * h * w),
    ] {
        let error = (given.value() - truth).abs() / scale;
        report.push(against, case, error, limit);
    }
    Ok(report)
}

fn moment<R: Real>(rule: &Cubature<R, 2>, a: i32, b: i32) -> f64 {
    // In double precision: the rounding of the powers is not the rule's.
    let terms = rule
        .iter()
        .map(|([y, z], w)| w.value() * y.value().powi(a) * z.value().powi(b));
    terms.sum()
}

/// Largest modulus of `error(a, b)` over the monomials `y^a z^b` up to a degree.
fn worst(degree: usize, error: impl Fn(i32, i32) -> f64) -> f64 {
    let degree = degree as i32;
    let all = (0..=degree).flat_map(|a| (0..=degree - a).map(move |b| (a, b)));
    all.fold(0.0, |top, (a, b)| most(top, error(a, b).abs()))
}

fn extent<R: Real>(rule: &Cubature<R, 2>) -> [f64; 2] {
    let reach = |c: usize| {
        rule.points()
            .iter()
            .fold(0.0_f64, |m, x| m.max(x[c].value().abs()))
    };
    [0, 1].map(|c| if reach(c) > 0.0 { reach(c) } else { 1.0 })
}

/// Moments of the region a section's outline encloses, extrapolated over refined outlines.
struct Outline {
    /// Moments `[a][b]` of `y^a z^b`.
    moments: Vec<Vec<f64>>,
    /// What extrapolation leaves, relative like the errors it limits.
    uncertainty: f64,
    finest: Vec<Vec<[f64; 2]>>,
    area: f64,
    size: [f64; 2],
}

impl Outline {
    fn of<R: Real, X: Section<R> + ?Sized>(section: &X, degree: usize) -> Result<Option<Self>> {
        let loops = |n: usize| -> Vec<Vec<[f64; 2]>> {
            let loops = section.outline(n);
            loops
                .into_iter()
                .map(|l| l.into_iter().map(|x| x.map(R::value)).collect())
                .collect()
        };
        if loops(COARSE).iter().all(Vec::is_empty) {
            return Ok(None);
        }
        let line = gauss_legendre::<f64>(degree / 2 + 2)?;
        let mut levels: Vec<Vec<Vec<f64>>> = (0..=DOUBLINGS)
            .map(|k| polygon_moments(&loops(COARSE << k), degree, &line))
            .collect();
        let finest = loops(COARSE << DOUBLINGS);
        let mut size = [0.0_f64; 2];
        for x in finest.iter().flatten() {
            size = [size[0].max(x[0].abs()), size[1].max(x[1].abs())];
        }
        // Moments of a polygon inscribed in a smooth curve err in even powers of 1/n.
        let mut before = levels[DOUBLINGS].clone();
        for order in 1..=DOUBLINGS {
            let factor = 4.0_f64.powi(order as i32);
            before.clone_from(&levels[DOUBLINGS]);
            for k in (order..=DOUBLINGS).rev() {
                for a in 0..=degree {
                    for b in 0..=degree - a {
                        let (fine, coarse) = (levels[k][a][b], levels[k - 1][a][b]);
                        levels[k][a][b] = fine + (fine - coarse) / (factor - 1.0);
                    }
                }
            }
        }
        // Outlines that deal their points unevenly err less smoothly than that: what was found a
        // level earlier tells.
        let earlier = levels.swap_remove(DOUBLINGS - 1);
        let moments = levels.swap_remove(DOUBLINGS - 1);
        let area = moments[0][0];
        if area.is_nan() || area <= 0.0 {
            return Err(Error::NotPositive {
                what: "area inside the outline of the section [m^2] (outer loops run counter-clockwise, holes clockwise)",
                value: area,
            });
        }
        let uncertainty = worst(degree, |a, b| {
            let at = |of: &[Vec<f64>]| of[a as usize][b as usize];
            let change = [&before, &earlier].map(|of| (at(&moments) - at(of)).abs());
            change[0].max(change[1]) / (area * size[0].powi(a) * size[1].powi(b))
        });
        Ok(Some(Self {
            moments,
            uncertainty,
            finest,
            area,
            size,
        }))
    }

    fn moment(&self, a: i32, b: i32) -> f64 {
        self.moments[a as usize][b as usize]
    }

    fn limit<R: Real>(&self) -> f64 {
        // An outline that does not converge is no measure of anything.
        1e3 * R::EPSILON + (10.0 * self.uncertainty).min(1e-5)
    }

    /// Whether the loops wind around a point.
    fn contains(&self, [y, z]: [f64; 2]) -> bool {
        let mut winding = 0;
        for points in &self.finest {
            for (p, q) in edges(points) {
                let left = (q[0] - p[0]) * (z - p[1]) - (y - p[0]) * (q[1] - p[1]);
                if p[1] <= z && q[1] > z && left > 0.0 {
                    winding += 1;
                } else if p[1] > z && q[1] <= z && left < 0.0 {
                    winding -= 1;
                }
            }
        }
        winding > 0
    }
}

fn edges(points: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    points
        .iter()
        .copied()
        .zip(points.iter().copied().cycle().skip(1))
}

/// Moments of polygons by Green's theorem: `int y^a z^b dA = 1/(a + 1) oint y^(a+1) z^b dz`.
fn polygon_moments(
    loops: &[Vec<[f64; 2]>],
    degree: usize,
    line: &Cubature<f64, 1>,
) -> Vec<Vec<f64>> {
    let mut moments = vec![vec![0.0; degree + 1]; degree + 1];
    for (p, q) in loops.iter().flat_map(|points| edges(points)) {
        for ([t], w) in line.iter() {
            let [y, z] = [0, 1].map(|c| p[c] + t * (q[c] - p[c]));
            let dz = w * (q[1] - p[1]);
            let mut y_power = y;
            for (a, row) in moments.iter_mut().enumerate() {
                let mut term = y_power * dz / (a + 1) as f64;
                for moment in &mut row[..=degree - a] {
                    *moment += term;
                    term *= z;
                }
                y_power *= y;
            }
        }
    }
    moments
}
