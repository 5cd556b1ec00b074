//! Everything that can go wrong, as one typed enum. Each message names the offending value and
//! says what to do about it; nothing in the library panics on bad input.

use thiserror::Error;

/// Result of every fallible call of the library.
pub type Result<T> = std::result::Result<T, Error>;

/// A refused input or a failed solution. Numbers are reported in double precision whatever the
/// number type of the model. `Debug` prints the message, too, so that a `main` that returns a
/// [`Result`] shows it.
#[derive(Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum Error {
    /// A quantity that must be finite and positive is not.
    #[error("{what} is {value}, but must be a finite number above zero")]
    NotPositive {
        /// Name of the quantity with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A quantity that must be finite is NaN or infinite.
    #[error("{what} is {value}, but must be finite: check the input it was computed from")]
    NotFinite {
        /// Name of the quantity with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
    },
    /// A quantity lies outside its admissible range.
    #[error("{what} is {value}, but must lie in {range}: {remedy}")]
    OutOfRange {
        /// Name of the quantity with its unit.
        what: &'static str,
        /// The value given.
        value: f64,
        /// The admissible range.
        range: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// A count that must be at least some number is smaller.
    #[error("{what} is {value}, but at least {least} is needed: {remedy}")]
    TooFew {
        /// Name of the count.
        what: &'static str,
        /// The value given.
        value: usize,
        /// The smallest admissible value.
        least: usize,
        /// What to do.
        remedy: &'static str,
    },
    /// A sampling of the strain energy leaves deformations that cost no energy.
    #[error(
        "the integration rule leaves {modes} zero-energy modes beyond the rigid ones (rank {rank} of {target}): {sufficient}"
    )]
    ZeroEnergyModes {
        /// Number of spurious modes.
        modes: usize,
        /// Rank of the element stiffness.
        rank: usize,
        /// Rank without spurious modes.
        target: usize,
        /// Which orders suffice.
        sufficient: String,
    },
    /// A scene without a beam.
    #[error("the scene has no beam: add at least one before assembling")]
    EmptyScene,
    /// A node that does not exist.
    #[error(
        "beam {body} has {nodes} nodes, there is no node {node}: use Placed::start, end, or an index below the number of nodes"
    )]
    NoSuchNode {
        /// Index of the beam.
        body: usize,
        /// Index of the node.
        node: usize,
        /// Number of nodes of that beam.
        nodes: usize,
    },
    /// A coordinate that does not exist.
    #[error(
        "there is no coordinate {index}: the structure has {size}, counted from 0; ask System::coordinate for the index of a nodal vector"
    )]
    NoSuchCoordinate {
        /// The index given.
        index: usize,
        /// Number of coordinates.
        size: usize,
    },
    /// A load's course in time gave a value that is not finite.
    #[error(
        "the amplitude of a load is {value} at t = {time} s, but must be finite: check the function given; the state before this time is kept"
    )]
    LoadNotFinite {
        /// Time (s).
        time: f64,
        /// The value.
        value: f64,
    },
    /// Newton's method found no equilibrium.
    #[error(
        "Newton's method failed ({reason}) after {iterations} iterations at a relative residual of {residual:.1e}: take smaller steps, renew the tangent more often or allow more iterations"
    )]
    Unconverged {
        /// What happened.
        reason: &'static str,
        /// Corrections made.
        iterations: usize,
        /// Last residual over the force scale.
        residual: f64,
    },
    /// A step along a path of equilibria came to one that does not follow the last.
    #[error(
        "the step left the path of equilibria ({reason}): take shorter steps (Path::first, Path::longest, Path::shortest) or, onto a branch, another amplitude"
    )]
    OffPath {
        /// How that is seen.
        reason: &'static str,
    },
    /// No static equilibrium under the full load.
    #[error(
        "statics stopped at {reached:.4} of the load: beyond may lie a limit point or buckling, or the load is too large (check its unit); the state of the last equilibrium is kept. The last step tried, {step:.1e} of the load, failed because {cause}"
    )]
    StaticsFailed {
        /// Share of the load reached.
        reached: f64,
        /// Smallest step tried.
        step: f64,
        /// Why the last step failed.
        cause: Box<Error>,
    },
    /// Path following stopped.
    #[error(
        "the path of equilibria stopped at the load factor {factor}: the last equilibrium is kept; under Control::Load it ends at a limit point, under Control::Coordinate where that turns, which Control::Sphere passes. Steps down to {step:.1e} failed because {cause}"
    )]
    PathStopped {
        /// Load factor of the last equilibrium.
        factor: f64,
        /// Smallest step tried.
        step: f64,
        /// Why it failed.
        cause: Box<Error>,
    },
    /// A path did not come to its target.
    #[error(
        "the path has not come to its target after {points} points, at the load factor {factor}: check that it leads there, or allow longer steps or more points (Path::points)"
    )]
    TargetMissed {
        /// Points found.
        points: usize,
        /// Load factor of the last one.
        factor: f64,
    },
    /// An equilibrium is stable in other directions than the one before it.
    #[error(
        "the equilibrium found is unstable in {now} directions, the one before in {before}: between lies a limit or bifurcation point, or this is another branch; follow it with Continuation"
    )]
    StabilityChanged {
        /// Negative eigenvalues of the tangent before the step; under follower loads 0 for an even and
        /// 1 for an odd number.
        before: usize,
        /// Negative eigenvalues after it.
        now: usize,
    },
    /// A beam has been turned inside out: its slopes span a volume of the wrong sign.
    #[error(
        "node {node} of beam {body} is turned inside out (volume ratio {ratio:.1e}): the equations have such solutions, but no beam has; the load may be too large (check its unit), or the step too long"
    )]
    Inverted {
        /// Index of the beam.
        body: usize,
        /// Index of the node.
        node: usize,
        /// Volume spanned by the slopes over that of the reference state.
        ratio: f64,
    },
    /// The tangent is singular to the digits of its numbers: the structure is a mechanism, or so
    /// slender, uneven or light that its softest stiffness or its inertia is lost beside the largest.
    #[error(
        "nothing holds {coordinate} (pivot {pivot:.1e}) beyond the rounding of the numbers: either the structure can move without deforming, then add supports (Scene::clamp, pin, fix) or solve its dynamics; or it is so slender, uneven or light that its softest part is lost beside its stiffest, then take a number type of more digits or fewer elements"
    )]
    Mechanism {
        /// The first coordinate found to be free, in words.
        coordinate: String,
        /// The vanishing pivot.
        pivot: f64,
    },
    /// The tangent is singular to the digits of its numbers though supports and joints hold the
    /// structure: its softest stiffness is lost beside the largest, or the state is critical.
    #[error(
        "supports and joints hold every rigid motion, but the stiffness of {coordinate} (pivot {pivot:.1e}) is lost in the rounding of the numbers: the structure is so slender, uneven or light that its softest part drowns beside its stiffest, then take a number type of more digits, stockier or fewer elements; or the load is just critical, then follow the path with Continuation"
    )]
    StiffnessLost {
        /// The first coordinate whose stiffness is lost, in words.
        coordinate: String,
        /// The vanishing pivot.
        pivot: f64,
    },
    /// An equilibrium of which rounding leaves no digit.
    #[error(
        "rounding leaves no digit of the displacements (one more correction would change them by {share:.1e} of themselves): the stiffness spans more orders of magnitude than the number type has digits; take one of more digits, or fewer or stockier elements"
    )]
    NoDigits {
        /// Change by one more correction over the displacements.
        share: f64,
    },
    /// A constraint that has nothing left to hold and yet does not follow from the others.
    #[error(
        "{constraint} holds nothing that is left to hold (pivot {pivot:.1e}): other constraints, joints or supports contradict it, the mechanism is at a dead point, or its derivatives vanish; drop one of them, start away from the dead point, or state it by a function whose derivatives do not vanish"
    )]
    Redundant {
        /// The constraint, in words.
        constraint: String,
        /// The vanishing pivot, or what the others leave of the constraint.
        pivot: f64,
    },
    /// Conditions on coordinates that exclude each other.
    #[error(
        "the coordinates {coordinates:?} are bound to motions that exclude each other: drive, fix or join each of them once"
    )]
    Contradiction {
        /// The coordinates of the condition that found no freedom left.
        coordinates: Vec<usize>,
    },
    /// A node of another scene.
    #[error("a node of another scene was given: use the handle that this scene's add returned")]
    ForeignNode,
    /// A time step failed.
    #[error(
        "the step of {step:.3e} s from t = {time} s failed ({cause}): the state at its start is kept; go on with smaller or adaptive steps"
    )]
    StepFailed {
        /// Time of the last good state (s).
        time: f64,
        /// Step tried (s).
        step: f64,
        /// Why it failed.
        cause: Box<Error>,
    },
    /// Error control asks for a step below the limit.
    #[error(
        "error control asks for a step of {step:e} s, below the limit of {shortest:e} s: loosen the tolerance or lower the limit"
    )]
    StepTooShort {
        /// Step asked for (s).
        step: f64,
        /// Shortest step allowed (s).
        shortest: f64,
    },
    /// The local error of a step is larger than allowed.
    #[error(
        "the local error of the step is {error:.2e} of the motion, above the tolerance of {tolerance:.2e}: a shorter step is tried"
    )]
    Inaccurate {
        /// Local error over the size of the motion.
        error: f64,
        /// The error allowed.
        tolerance: f64,
    },
    /// A checkpoint does not belong to the run that is to be resumed.
    #[error(
        "the checkpoint is of another {what}: {given}, not {needed}; resume with what it was taken from, or start a new run from Checkpoint::state"
    )]
    ForeignCheckpoint {
        /// What differs.
        what: &'static str,
        /// As the checkpoint has it.
        given: String,
        /// As the run has it.
        needed: String,
    },
    /// A step of an explicit method lies beyond its limit of stability.
    #[error(
        "the time step of {step:e} s lies beyond the stability limit of {limit:e} s: take Stepping::Stable, or an implicit method"
    )]
    Unstable {
        /// Step asked for (s).
        step: f64,
        /// Longest stable step (s).
        limit: f64,
    },
    /// Something the library cannot do for this input.
    #[error("{what}: {remedy}")]
    Unsupported {
        /// What was asked.
        what: String,
        /// What to do instead.
        remedy: &'static str,
    },
    /// Two edges of an outline meet where they must not.
    #[error(
        "edge {} of loop {} meets edge {} of loop {} near ({:e}, {:e}) m (loop 0 is the outer one, edges count from zero): edges may meet only at the common end of two successive ones, so leave material or space between any others",
        edges[0], loops[0], edges[1], loops[1], place[0], place[1]
    )]
    EdgesMeet {
        /// The loops they belong to: 0 for the outer one, then the holes as given.
        loops: [usize; 2],
        /// Their positions in these loops, from zero.
        edges: [usize; 2],
        /// Where they meet, `(y, z)` (m).
        place: [f64; 2],
    },
    /// A hole of an outline is not in the material.
    #[error(
        "hole {hole} of the outline {fault}: every hole must lie within the outer loop and apart from the other holes"
    )]
    HoleMisplaced {
        /// Which hole, counted from 1 as given.
        hole: usize,
        /// Where it lies.
        fault: &'static str,
    },
    /// No cubature with positive weights and points in the material was found.
    #[error("no positive rule of degree {degree} was found for the outline ({cause}): {remedy}")]
    NoRule {
        /// The degree asked for.
        degree: usize,
        /// What failed.
        cause: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// A linear system has no unique solution.
    #[error(
        "the matrix is singular at unknown {unknown} (pivot {pivot:e}): check that the supports \
         prevent every rigid motion and that no two constraints say the same"
    )]
    Singular {
        /// Index of the first unknown that the equations do not determine.
        unknown: usize,
        /// The vanishing pivot.
        pivot: f64,
    },
    /// An entry of a matrix lies outside the envelope it was allocated for.
    #[error(
        "entry ({row}, {column}) lies outside the profile of the matrix: build the Profile with \
         a range that couples the two"
    )]
    OutsideProfile {
        /// Row of the entry, from zero.
        row: usize,
        /// Column of the entry, from zero.
        column: usize,
    },
    /// A range of unknowns is empty or goes beyond the last one.
    #[error(
        "the range of unknowns {start}..{end} is empty or exceeds the {size} unknowns: give \
         start < end <= {size}"
    )]
    BadRange {
        /// First unknown.
        start: usize,
        /// One past the last unknown.
        end: usize,
        /// Number of unknowns.
        size: usize,
    },
    /// A check of [`verify`](crate::verify) found what theory forbids.
    #[error(
        "{subject} fails its checks: {rows}; print the report before asking for its result to see all rows"
    )]
    CheckFailed {
        /// What was examined.
        subject: String,
        /// The failed rows, each with its value and limit.
        rows: String,
    },
    /// An array or matrix has the wrong size.
    #[error("{what} is {given}, but must be {needed}: it must match the model it is used with")]
    Length {
        /// Which size.
        what: &'static str,
        /// The size given.
        given: usize,
        /// The size needed.
        needed: usize,
    },
}

impl std::fmt::Debug for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        std::fmt::Display::fmt(self, f)
    }
}

impl Error {
    /// `Ok` if a size is the one needed, a typed error that names both otherwise.
    #[inline]
    pub(crate) fn check_length(what: &'static str, given: usize, needed: usize) -> Result<()> {
        if given == needed {
            return Ok(());
        }
        Err(Self::Length {
            what,
            given,
            needed,
        })
    }
}

/// `value` if it is finite and above zero, a typed error that names it otherwise.
pub(crate) fn positive<R: crate::scalar::Real>(what: &'static str, value: R) -> Result<R> {
    if value.finite() && value > R::zero() {
        Ok(value)
    } else {
        let value = value.value();
        Err(Error::NotPositive { what, value })
    }
}

/// `value` if it is finite, a typed error that names it otherwise.
pub(crate) fn finite<R: crate::scalar::Real>(what: &'static str, value: R) -> Result<R> {
    if value.finite() {
        Ok(value)
    } else {
        let value = value.value();
        Err(Error::NotFinite { what, value })
    }
}
