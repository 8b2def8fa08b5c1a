//! The one place that settles a lattice face with any labels.

use crate::materials::labels::pair;
use crate::volume::FaceRule;

/// What a segment on a face ends at: the crossing on one of the face's four edges, or [`JUNCTION`].
pub(super) type End = usize;

/// The junction point of a face.
pub(super) const JUNCTION: End = 4;

/// A piece of the interfaces on a face, with the labels on both sides as seen where the corners go
/// counter-clockwise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Segment {
    pub(super) ends: [End; 2],
    pub(super) right: u32,
    pub(super) left: u32,
}

/// Whether the labels of a face, in cyclic order, meet in a junction point: three or four different
/// ones do, unless two corners of a diagonal share one.
#[inline]
pub(super) fn has_junction([a, b, c, d]: [u32; 4]) -> bool {
    let changes = [a != b, b != c, c != d, d != a].map(usize::from).iter().sum::<usize>();
    changes == 3 || changes == 4 && a != c && b != d
}

/// The segments on a face whose corners have these labels, in cyclic order. Edge `q` runs from corner
/// `q` to corner `q + 1` (modulo 4).
///
/// Each segment has the first label of its pair on the right, but for those at a junction, which run
/// from the crossings to it.
pub(super) fn segments(labels: [u32; 4], rule: FaceRule) -> impl Iterator<Item = Segment> {
    let mut found = [None; 4];
    let crossed = |q: usize| labels[q] != labels[(q + 1) % 4];
    if has_junction(labels) {
        for q in (0..4).filter(|&q| crossed(q)) {
            let (right, left) = (labels[(q + 1) % 4], labels[q]);
            found[q] = Some(Segment { ends: [q, JUNCTION], right, left });
        }
    } else {
        let joined = joined(labels, rule);
        for q in (0..4).filter(|&q| crossed(q) && crossed((q + 3) % 4)) {
            // The corner is a run of its own, between the edge before it and the one after.
            if joined != Some(labels[q]) {
                let segment = Segment::oriented((q + 3) % 4, q, labels[q], labels[(q + 1) % 4]);
                found[q] = Some(segment);
            }
        }
        if found.iter().all(Option::is_none) {
            // Two runs of two corners, or no crossing.
            if let Some(q) = (0..2).find(|&q| crossed(q)) {
                found[q] = Some(Segment::oriented(q, q + 2, labels[q + 1], labels[q]));
            }
        }
    }
    found.into_iter().flatten()
}

/// The label that joins its two corners across a face without a junction whose edges are all crossed.
///
/// If only one diagonal shares a label it is that one's. If both do, the face is that of a binary
/// volume, with the first label of the pair inside.
fn joined([a, b, c, d]: [u32; 4], rule: FaceRule) -> Option<u32> {
    if a == b || b == c || c == d || d == a {
        return None;
    }
    let [first, second] = pair(a, b);
    Some(match rule {
        _ if a != c => b,
        _ if b != d => a,
        FaceRule::Separate => second,
        FaceRule::Join => first,
    })
}

impl Segment {
    fn oriented(from: End, to: End, right: u32, left: u32) -> Self {
        if pair(right, left)[0] == right {
            Self { ends: [from, to], right, left }
        } else {
            Self { ends: [to, from], right: left, left: right }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RULES: [FaceRule; 2] = [FaceRule::Separate, FaceRule::Join];

    fn all_faces() -> impl Iterator<Item = [u32; 4]> {
        (0..256).map(|n: u32| [n & 3, n >> 2 & 3, n >> 4 & 3, n >> 6 & 3])
    }

    #[test]
    fn every_crossing_ends_one_segment_between_its_labels() {
        for (labels, rule) in all_faces().flat_map(|f| RULES.map(|rule| (f, rule))) {
            let found: Vec<Segment> = segments(labels, rule).collect();
            for q in 0..4 {
                let ending = found.iter().filter(|s| s.ends.contains(&q)).count();
                assert_eq!(ending, usize::from(labels[q] != labels[(q + 1) % 4]), "{labels:?}");
            }
            for Segment { ends: [from, to], right, left } in found {
                // Ahead of where it enters the face lies the right one, behind it the left one.
                assert_eq!([labels[from], labels[(from + 1) % 4]], [left, right], "{labels:?}");
                if to != JUNCTION {
                    assert_eq!([labels[to], labels[(to + 1) % 4]], [right, left], "{labels:?}");
                    assert_eq!(pair(right, left), [right, left]);
                }
            }
        }
    }

    #[test]
    fn both_cells_at_a_face_see_the_same_segments() {
        for (labels, rule) in all_faces().flat_map(|f| RULES.map(|rule| (f, rule))) {
            let [a, b, c, d] = labels;
            // From the other side corner 0 stays and edge q becomes edge 3 − q.
            let turned = |end: End| if end == JUNCTION { end } else { 3 - end };
            let mut here: Vec<_> = segments(labels, rule)
                .map(|s| {
                    let [from, to] = s.ends.map(turned);
                    if to == JUNCTION {
                        ([from, to], s.left, s.right)
                    } else {
                        ([to, from], s.right, s.left)
                    }
                })
                .collect();
            let mut there: Vec<_> =
                segments([a, d, c, b], rule).map(|s| (s.ends, s.right, s.left)).collect();
            here.sort_unstable();
            there.sort_unstable();
            assert_eq!(here, there, "{labels:?} {rule:?}");
        }
    }

    #[test]
    fn two_labels_are_cut_as_in_a_binary_volume_and_more_meet_in_junctions() {
        // The first label of the pair, 1, is the inside: separated its corners are cut off.
        let ends = |labels, rule| segments(labels, rule).map(|s| s.ends).collect::<Vec<_>>();
        assert_eq!(ends([1, 0, 1, 0], FaceRule::Separate), [[3, 0], [1, 2]]);
        assert_eq!(ends([1, 0, 1, 0], FaceRule::Join), [[1, 0], [3, 2]]);
        assert_eq!(ends([1, 2, 1, 2], FaceRule::Separate), [[3, 0], [1, 2]]);
        // A diagonal that shares a label is joined, whatever the rule.
        assert_eq!(ends([3, 1, 3, 2], FaceRule::Separate), [[0, 1], [2, 3]]);
        assert_eq!(ends([3, 1, 3, 0], FaceRule::Join), [[0, 1], [3, 2]]);
        let to = |q| [q, JUNCTION];
        assert_eq!(ends([1, 1, 2, 3], FaceRule::Separate), [to(1), to(2), to(3)]);
        assert_eq!(ends([1, 2, 3, 0], FaceRule::Separate), [to(0), to(1), to(2), to(3)]);
    }
}
