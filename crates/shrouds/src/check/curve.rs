//! A space-filling curve: cells that follow each other are neighbours, so that stretches of it are
//! compact and so are the boxes around what lies along them.

/// Position along the Hilbert curve of a cell of the cube with 2ᵇⁱᵗˢ cells along each axis, by the
/// method of Skilling (Programming the Hilbert curve, 2004): turn each octant's frame back from
/// coarse to fine, then read the bits as a Gray code.
pub(super) fn position(mut cell: [u32; 3], bits: u32) -> u64 {
    for level in (1..bits).rev() {
        let finer = (1 << level) - 1;
        for d in 0..3 {
            if cell[d] >> level & 1 == 1 {
                cell[0] ^= finer;
            } else {
                let swapped = (cell[0] ^ cell[d]) & finer;
                cell[0] ^= swapped;
                cell[d] ^= swapped;
            }
        }
    }
    cell[1] ^= cell[0];
    cell[2] ^= cell[1];
    let carried = (1..bits)
        .filter(|level| cell[2] >> level & 1 == 1)
        .fold(0, |carried, level| carried ^ ((1 << level) - 1));
    (0..bits).rev().fold(0, |code, level| {
        (0..3).fold(code, |code, d| code << 1 | u64::from((cell[d] ^ carried) >> level & 1))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_every_cell_and_steps_to_neighbours() {
        for bits in 1..=4u32 {
            let n = 1u32 << bits;
            let mut visited: Vec<(u64, [u32; 3])> = (0..n * n * n)
                .map(|c| [c % n, c / n % n, c / n / n])
                .map(|cell| (position(cell, bits), cell))
                .collect();
            visited.sort_unstable();
            for (place, (code, _)) in visited.iter().enumerate() {
                assert_eq!(*code, place as u64);
            }
            for pair in visited.windows(2) {
                let steps: u32 = (0..3).map(|d| pair[0].1[d].abs_diff(pair[1].1[d])).sum();
                assert_eq!(steps, 1, "{pair:?}");
            }
        }
    }
}
