//! One step along a planar curve, in a byte.

use crate::network::Link;

/// A side of a grid edge within a lattice plane, along the other axis of that plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Low,
    High,
}

/// A place of a curve: how its grid edge lies in the plane, and how the curve goes on to the next.
///
/// The plane normal to axis `p` has the first axis `p + 1` and the second axis `p + 2` (modulo 3).
/// Bit 0: the grid edge runs along the second axis. Bits 1–2 and 3–4: 1 + the difference, along the
/// first and second axis, of the lattice points where the next place's grid edge and this one
/// start, or would if it were there. Bit 5: there is a next place. Bits 6–7: the normal.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Step(u8);

const LINKED: u8 = 1 << 5;

impl Step {
    /// The step from a grid edge that runs along the second axis of its plane, or not, to one that
    /// starts `shift` away.
    pub(crate) fn new(normal: usize, runs_second: bool, shift: [i32; 2]) -> Self {
        let [u, v] = shift.map(|s| (s + 1) as u8);
        Self(u8::from(runs_second) | u << 1 | v << 3 | LINKED | (normal as u8) << 6)
    }

    /// A place that nothing follows.
    pub(super) fn last(normal: usize, runs_second: bool) -> Self {
        Self(Self::new(normal, runs_second, [1; 2]).0 & !LINKED)
    }

    /// A place that nothing follows or precedes. What would be there lies straight across.
    pub(super) fn alone(normal: usize, runs_second: bool) -> Self {
        let across = [i32::from(runs_second), i32::from(!runs_second)];
        Self(Self::new(normal, runs_second, across).0 & !LINKED)
    }

    /// The same place with nothing after it.
    pub(super) fn unlinked(self) -> Self {
        if self.is_linked() { Self::last(self.normal(), self.runs_second()) } else { self }
    }

    /// All that there can be, by their indices.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        (0..=u8::MAX).map(Self)
    }

    #[inline(always)]
    pub(crate) fn index(self) -> usize {
        usize::from(self.0)
    }

    /// The axis normal to the plane; 3 for no step at all.
    #[inline(always)]
    pub(crate) fn normal(self) -> usize {
        usize::from(self.0 >> 6)
    }

    /// Whether the grid edge runs along the second axis of the plane.
    #[inline(always)]
    pub(crate) fn runs_second(self) -> bool {
        self.0 & 1 == 1
    }

    #[inline(always)]
    pub(crate) fn is_linked(self) -> bool {
        self.0 & LINKED != 0
    }

    /// The axis that the grid edge runs along.
    pub(crate) fn axis(self) -> usize {
        (self.normal() + 1 + usize::from(self.runs_second())) % 3
    }

    /// Which of its vertex' curves this place lies on, 0 or 1.
    #[inline(always)]
    pub(crate) fn curve(self) -> usize {
        usize::from(!self.runs_second())
    }

    /// From where this grid edge starts to where the next one does, along both axes of the plane.
    #[inline(always)]
    pub(crate) fn shift(self) -> [i32; 2] {
        [self.0 >> 1 & 3, self.0 >> 3 & 3].map(|bits| i32::from(bits) - 1)
    }

    /// On which side of the grid edge the next place lies, and how its grid edge lies to this one.
    pub(super) fn look(self, next_runs_second: bool) -> Option<(Side, Link)> {
        self.is_linked().then(|| seen(self.runs_second(), next_runs_second, self.shift()))
    }

    /// The same as seen from the next place.
    pub(super) fn look_back(self, next_runs_second: bool) -> Option<(Side, Link)> {
        let back = self.shift().map(|s| -s);
        self.is_linked().then(|| seen(next_runs_second, self.runs_second(), back))
    }
}

/// Where a grid edge lies, seen from another one whose start is `shift` before its own.
fn seen(from_runs_second: bool, to_runs_second: bool, shift: [i32; 2]) -> (Side, Link) {
    let d = usize::from(from_runs_second);
    let (along, across) = (shift[d], shift[1 - d]);
    if from_runs_second == to_runs_second {
        (if across > 0 { Side::High } else { Side::Low }, Link::Parallel)
    } else {
        // The other one starts at our line or ends there.
        let side = if across == 0 { Side::High } else { Side::Low };
        (side, if along == 0 { Link::AcrossLow } else { Link::AcrossHigh })
    }
}
