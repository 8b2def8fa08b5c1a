//! The one place that settles a lattice face.

use crate::volume::FaceRule;

/// The segments of the surface on a face whose corners, in cyclic order, are `inside`.
///
/// Edge `q` runs from corner `q` to corner `q + 1` (modulo 4). Each segment goes from the edge where
/// the cycle enters the inside to the edge where it leaves it, so a cell that lists the corners
/// counter-clockwise seen from its own outside gets patches that turn counter-clockwise seen from
/// outside the volume.
pub(super) fn segments(inside: [bool; 4], rule: FaceRule) -> impl Iterator<Item = [usize; 2]> {
    let enters = move |q: usize| !inside[q % 4] && inside[(q + 1) % 4];
    let leaves = move |q: usize| inside[q % 4] && !inside[(q + 1) % 4];
    (0..4).filter(move |&q| enters(q)).map(move |enter| {
        // The segment cuts off the run of inside corners after `enter`, or the run of outside
        // corners before it. The two differ on an ambiguous face only.
        let leave = match rule {
            FaceRule::Separate => (enter + 1..enter + 4).find(|&q| leaves(q)),
            FaceRule::Join => (enter + 1..enter + 4).rfind(|&q| leaves(q)),
        };
        [enter, leave.unwrap_or(enter) % 4]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn segments_pair_all_crossed_edges_and_differ_only_on_ambiguous_faces() {
        for corners in 0..16u8 {
            let inside = std::array::from_fn(|q| corners >> q & 1 == 1);
            let [separate, join] = [FaceRule::Separate, FaceRule::Join]
                .map(|rule| segments(inside, rule).collect::<Vec<_>>());
            for list in [&separate, &join] {
                let mut ends: Vec<usize> = list.iter().flatten().copied().collect();
                ends.sort_unstable();
                let crossed: Vec<usize> =
                    (0..4).filter(|&q| inside[q] != inside[(q + 1) % 4]).collect();
                assert_eq!(ends, crossed, "corners {corners:04b}");
            }
            let ambiguous = corners == 0b0101 || corners == 0b1010;
            assert_eq!(separate != join, ambiguous, "corners {corners:04b}");
        }
        // Corners 0 and 2 inside: separated, each is cut off by the edges at it.
        let inside = [true, false, true, false];
        assert_eq!(segments(inside, FaceRule::Separate).collect::<Vec<_>>(), [[1, 2], [3, 0]]);
        assert_eq!(segments(inside, FaceRule::Join).collect::<Vec<_>>(), [[1, 0], [3, 2]]);
    }
}
