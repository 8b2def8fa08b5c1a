//! Which winding numbers are inside.

/// Which points are inside, by how often the mesh winds around them, counter-clockwise seen from
/// outside. A mesh that is inside out as a whole is turned first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Hash)]
pub enum Rule {
    /// Those the mesh winds around at all: the union of overlapping shells, whichever way each faces.
    /// Shells that face inwards, within others, are cavities.
    #[default]
    NonZero,
    /// Those with a winding number above zero: shells that face inwards outside of others are empty.
    Positive,
    /// Those with an odd winding number: every shell within another is a cavity, whichever way it
    /// faces, and overlaps are empty.
    Odd,
}

/// Points whose winding number is this close to where the rule changes are doubtful.
const DOUBT: f64 = 0.1;

/// A rule for one mesh.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sides {
    pub(super) rule: Rule,
    pub(super) inside_out: bool,
}

impl Sides {
    /// Whether points with this winding number are inside.
    #[inline]
    pub(super) fn inside(self, winding: i64) -> bool {
        match self.rule {
            Rule::NonZero => winding != 0,
            Rule::Positive => (winding > 0) != self.inside_out && winding != 0,
            Rule::Odd => winding & 1 == 1,
        }
    }

    /// The same for a generalized winding number, and whether that is doubtful.
    pub(super) fn decide(self, winding: f64) -> (bool, bool) {
        let at = |winding: f64| self.inside(winding.round() as i64);
        (at(winding), at(winding - DOUBT) != at(winding + DOUBT))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_differ_where_shells_overlap_or_face_inwards() {
        let inside = |rule, inside_out| {
            [-2, -1, 0, 1, 2].map(|winding| Sides { rule, inside_out }.inside(winding))
        };
        assert_eq!(inside(Rule::NonZero, false), [true, true, false, true, true]);
        assert_eq!(inside(Rule::Positive, false), [false, false, false, true, true]);
        assert_eq!(inside(Rule::Positive, true), [true, true, false, false, false]);
        assert_eq!(inside(Rule::Odd, false), [false, true, false, true, false]);
    }

    #[test]
    fn doubt_begins_near_a_half() {
        let decide = |rule, winding| Sides { rule, inside_out: false }.decide(winding);
        assert_eq!(decide(Rule::NonZero, 0.39), (false, false));
        assert_eq!(decide(Rule::NonZero, 0.41), (false, true));
        assert_eq!(decide(Rule::NonZero, 0.59), (true, true));
        assert_eq!(decide(Rule::NonZero, 0.61), (true, false));
        assert_eq!(decide(Rule::NonZero, -0.55), (true, true));
        // Both one and two are inside; only one of them is odd.
        assert_eq!(decide(Rule::NonZero, 1.5), (true, false));
        assert_eq!(decide(Rule::Odd, 1.45), (true, true));
        assert_eq!(decide(Rule::Positive, -0.5), (false, false));
    }
}
