//! Triangulating one patch: the cheapest legal choice of diagonals.

use std::ops::Add;

/// The most corners a patch or a dual polygon has.
pub(crate) const MAX_CORNERS: usize = 8;

/// The triangles of the polygon with `count` corners that cost least, each as corner numbers in
/// polygon order, appended to `out`.
///
/// Interval dynamic programming: the cheapest triangulation of corners `i..=j` uses the triangle
/// `(i, k, j)` that is cheapest together with both sides. `legal(i, j)` with `i < j` says whether
/// that diagonal may be used; polygon edges are always legal. Equal costs are settled by the smaller
/// `k`. Returns whether a legal triangulation exists.
pub(crate) fn cheapest<C: Copy + PartialOrd + Add<Output = C> + Default>(
    count: usize,
    legal: impl Fn(usize, usize) -> bool,
    cost: impl Fn(usize, usize, usize) -> C,
    out: &mut Vec<[u8; 3]>,
) -> bool {
    if count == 3 {
        out.push([0, 1, 2]);
        return true;
    }
    // best[i][j]: cost of corners i..=j and the apex k that attains it.
    let mut best: [[Option<(C, u8)>; MAX_CORNERS]; MAX_CORNERS] =
        [[None; MAX_CORNERS]; MAX_CORNERS];
    for i in 0..count - 1 {
        best[i][i + 1] = Some((C::default(), 0));
    }
    for width in 2..count {
        for i in 0..count - width {
            let j = i + width;
            if width < count - 1 && !legal(i, j) {
                continue;
            }
            for k in i + 1..j {
                let (Some((left, _)), Some((right, _))) = (best[i][k], best[k][j]) else {
                    continue;
                };
                let total = left + right + cost(i, k, j);
                if best[i][j].is_none_or(|(least, _)| total < least) {
                    best[i][j] = Some((total, k as u8));
                }
            }
        }
    }
    let mut open = vec![(0, count - 1)];
    while let Some((i, j)) = open.pop() {
        if j == i + 1 {
            continue;
        }
        let Some((_, k)) = best[i][j] else { return false };
        out.push([i as u8, k, j as u8]);
        open.extend([(i, usize::from(k)), (usize::from(k), j)]);
    }
    true
}
