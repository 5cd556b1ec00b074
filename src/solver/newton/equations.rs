//! What one solve is of: the loads and inertia of a balance of forces, and what chooses the load
//! factor where that is an unknown.

/// The equations of one solve: statics at a load level, or a time step.
#[derive(Clone, Copy)]
pub(crate) struct Equations<'a, R> {
    /// Time at which loads are taken (s).
    pub(crate) time: R,
    /// Share of the external forces.
    pub(crate) factor: R,
    /// What acts in place of the rest, `1 - factor`.
    pub(crate) rest: Rest<'a, R>,
    /// Acceleration `predicted + rate * (u - guess)`; none in statics. Formed from corrections
    /// and not from displacements, it keeps its digits at any step size.
    pub(crate) inertia: Option<(R, &'a [R])>,
}

/// What acts in place of the external forces' share that does not.
#[derive(Clone, Copy)]
pub(crate) enum Rest<'a, R> {
    /// Nothing.
    Nothing,
    /// The same share of the permanent ones among them.
    Permanent,
    /// The same share of the internal forces of the state that a load step starts from.
    Start(&'a [R]),
}

/// What the load factor is chosen by when it is an unknown itself: changes of all coordinates.
pub(crate) struct Changes<'a, R> {
    /// Since the start of the solve.
    pub(crate) moved: &'a [R],
    /// By the correction at a fixed load factor.
    pub(crate) residual: &'a [R],
    /// By a unit of the load factor.
    pub(crate) load: &'a [R],
}

/// Chooses the next change of the load factor; none when there is none.
pub(crate) type Choice<'a, R> = dyn FnMut(&Changes<'_, R>) -> Option<R> + 'a;
