//! Rolled and welded profiles as outlines: I, C, L and T profiles and boxes, with sharp corners
//! and the centroid at the origin. Height runs along y, width along z; in the sketches y points
//! up and z to the right. Bending about the z axis is about the strong axis of an upright
//! profile.

use super::{Loop, Outline};
use crate::error::{Error, Result, positive};
use crate::scalar::Real;

/// An I profile: two flanges joined by a web in the middle.
///
/// ```text
///   ----- width -----
///   +---------------+ --
///   +-----+   +-----+ -- flange
///         |   |
///         |   |  <- web     height
///         |   |
///   +-----+   +-----+
///   +---------------+ --
/// ```
///
/// All in metres; `flange` and `web` are thicknesses.
///
/// # Errors
/// [`Error::NotPositive`] for a dimension that is not finite and above zero,
/// [`Error::OutOfRange`] for walls that do not fit: `2 flange < height` and `web < width`.
///
/// ```
/// use ancf::section::{Section, i_profile};
/// let beam = i_profile(0.2, 0.1, 0.0085, 0.0056)?;
/// let web = 0.2_f64 - 2.0 * 0.0085;
/// let exact = (0.1 * 0.2_f64.powi(3) - (0.1 - 0.0056) * web.powi(3)) / 12.0;
/// assert!((beam.properties()?.izz / exact - 1.0).abs() < 1e-14);
/// # Ok::<(), ancf::Error>(())
/// ```
pub fn i_profile<R: Real>(height: R, width: R, flange: R, web: R) -> Result<Outline<R>> {
    let [height, width] = frame(height, width)?;
    let flange = wall("thickness of the flanges [m]", flange, height * R::lit(0.5))?;
    let web = wall("thickness of the web [m]", web, width)?;
    let half = R::lit(0.5);
    let (y, z, w) = (height * half, width * half, web * half);
    let f = y - flange;
    outline(&[
        [-y, -z],
        [-f, -z],
        [-f, -w],
        [f, -w],
        [f, -z],
        [y, -z],
        [y, z],
        [f, z],
        [f, w],
        [-f, w],
        [-f, z],
        [-y, z],
    ])
}

/// A C profile (channel): two flanges on the right of a web.
///
/// ```text
///   ---- width ----
///   +-------------+ --
///   |   +---------+ -- flange
///   |   |
///   |   |  <- web     height
///   |   |
///   |   +---------+
///   +-------------+ --
/// ```
///
/// All in metres; `flange` and `web` are thicknesses.
///
/// # Errors
/// [`Error::NotPositive`] for a dimension that is not finite and above zero,
/// [`Error::OutOfRange`] for walls that do not fit: `2 flange < height` and `web < width`.
pub fn c_profile<R: Real>(height: R, width: R, flange: R, web: R) -> Result<Outline<R>> {
    let [height, width] = frame(height, width)?;
    let flange = wall("thickness of the flanges [m]", flange, height * R::lit(0.5))?;
    let web = wall("thickness of the web [m]", web, width)?;
    let (top, zero) = (height - flange, R::zero());
    outline(&[
        [zero, zero],
        [height, zero],
        [height, width],
        [top, width],
        [top, web],
        [flange, web],
        [flange, width],
        [zero, width],
    ])
}

/// An L profile (angle): an upright leg and a leg to the right of the same thickness.
///
/// ```text
///   +---+ --
///   |   |
///   |   |  <- wall    height
///   |   +---------+
///   +-------------+ --
///   ---- width ----
/// ```
///
/// All in metres. Its principal axes are not the coordinate axes.
///
/// # Errors
/// [`Error::NotPositive`] for a dimension that is not finite and above zero,
/// [`Error::OutOfRange`] for a wall that does not fit: `wall < height` and `wall < width`.
pub fn l_profile<R: Real>(height: R, width: R, wall: R) -> Result<Outline<R>> {
    let [height, width] = frame(height, width)?;
    let t = self::wall("thickness of the wall [m]", wall, height.smaller(width))?;
    let zero = R::zero();
    outline(&[
        [zero, zero],
        [height, zero],
        [height, t],
        [t, t],
        [t, width],
        [zero, width],
    ])
}

/// A T profile: a flange on top of a web.
///
/// ```text
///   ----- width -----
///   +---------------+ --
///   +-----+   +-----+ -- flange
///         |   |
///         |   |  <- web     height
///         +---+ --
/// ```
///
/// All in metres; `flange` and `web` are thicknesses.
///
/// # Errors
/// [`Error::NotPositive`] for a dimension that is not finite and above zero,
/// [`Error::OutOfRange`] for walls that do not fit: `flange < height` and `web < width`.
pub fn t_profile<R: Real>(height: R, width: R, flange: R, web: R) -> Result<Outline<R>> {
    let [height, width] = frame(height, width)?;
    let flange = wall("thickness of the flange [m]", flange, height)?;
    let web = wall("thickness of the web [m]", web, width)?;
    let half = R::lit(0.5);
    let (z, w, zero) = (width * half, web * half, R::zero());
    let f = height - flange;
    outline(&[
        [zero, -w],
        [f, -w],
        [f, -z],
        [height, -z],
        [height, z],
        [f, z],
        [f, w],
        [zero, w],
    ])
}

/// A box (rectangular tube) with the same wall all round.
///
/// ```text
///   ---- width ----
///   +-------------+ --
///   | +---------+ |
///   | |         | |  <- wall   height
///   | +---------+ |
///   +-------------+ --
/// ```
///
/// All in metres.
///
/// # Errors
/// [`Error::NotPositive`] for a dimension that is not finite and above zero,
/// [`Error::OutOfRange`] for a wall that does not fit: `2 wall < height` and `2 wall < width`.
pub fn box_profile<R: Real>(height: R, width: R, wall: R) -> Result<Outline<R>> {
    let [height, width] = frame(height, width)?;
    let half = R::lit(0.5);
    let narrow = height.smaller(width) * half;
    let t = self::wall("thickness of the wall [m]", wall, narrow)?;
    let ring = |y: R, z: R| Loop::polygon([[-y, -z], [y, -z], [y, z], [-y, z]]);
    let (y, z) = (height * half, width * half);
    Outline::new(ring(y, z))?.with_hole(ring(y - t, z - t))
}

fn frame<R: Real>(height: R, width: R) -> Result<[R; 2]> {
    Ok([
        positive("height of the profile [m]", height)?,
        positive("width of the profile [m]", width)?,
    ])
}

/// The thickness `t` of a wall if there is `room` for more than it.
fn wall<R: Real>(what: &'static str, t: R, room: R) -> Result<R> {
    if positive(what, t)? < room {
        return Ok(t);
    }
    Err(Error::OutOfRange {
        what,
        value: t.value(),
        range: "the room that the other dimensions leave for it",
        remedy: "give height and width first, and thinner walls",
    })
}

fn outline<R: Real>(corners: &[[R; 2]]) -> Result<Outline<R>> {
    Outline::new(Loop::polygon(corners.iter().copied()))?.centred()
}
