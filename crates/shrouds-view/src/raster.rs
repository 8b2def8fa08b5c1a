//! Triangles into samples: coverage in whole numbers, depth, and what is seen last.

use std::ops::Range;

use crate::lens::Placed;
use crate::shade::Sample;

/// Steps per sample of the grid that corners are rounded to, so that triangles that share an edge
/// neither overlap nor leave a gap.
const STEPS: i64 = 256;

/// Samples in steps, rounded; good for positions on the screen as [`Lens`](crate::lens::Lens)
/// allows them.
pub(crate) fn steps(samples: f64) -> i64 {
    // Made positive, numbers can be cut off: the rounding of the standard library is far slower.
    const OFFSET: i64 = 1 << 40;
    (samples * STEPS as f64 + OFFSET as f64 + 0.5) as i64 - OFFSET
}

/// The samples of some rows of the picture.
pub(crate) struct Band {
    width: usize,
    /// Rows of samples, counted from the top of the picture.
    rows: Range<usize>,
    nearness: Vec<f32>,
    colours: Vec<Sample>,
}

/// Neighbouring samples of one row.
pub(crate) struct Run<'a> {
    pub(crate) nearness: &'a mut [f32],
    pub(crate) colours: &'a mut [Sample],
}

impl Band {
    pub(crate) fn new(width: usize, rows: Range<usize>, background: Sample) -> Self {
        let count = width * rows.len();
        Self {
            width,
            rows,
            nearness: vec![f32::NEG_INFINITY; count],
            colours: vec![background; count],
        }
    }

    /// All samples, row by row.
    pub(crate) fn samples(&self) -> &[Sample] {
        &self.colours
    }

    /// The samples of this band whose centres lie between two corners of a box, ends included:
    /// columns and rows. The corners are in steps. None if there are none.
    pub(crate) fn clip(&self, low: [i64; 2], high: [i64; 2]) -> Option<[Range<usize>; 2]> {
        let range = |low: i64, high: i64, limits: Range<usize>| {
            let first = (low + STEPS / 2 - 1).div_euclid(STEPS).max(limits.start as i64);
            let end = (high + STEPS / 2).div_euclid(STEPS).min(limits.end as i64);
            (first < end).then_some(first as usize..end as usize)
        };
        let rows = range(low[1], high[1], self.rows.clone())?;
        Some([range(low[0], high[0], 0..self.width)?, rows])
    }

    /// The samples of some columns of a row.
    pub(crate) fn run(&mut self, row: usize, columns: &Range<usize>) -> Run<'_> {
        let start = (row - self.rows.start) * self.width;
        let place = start + columns.start..start + columns.end;
        Run { nearness: &mut self.nearness[place.clone()], colours: &mut self.colours[place] }
    }

    /// Whether all corners lie above or all below this band: with many bands, the usual case.
    fn misses(&self, corners: &[Placed; 3]) -> bool {
        let (top, bottom) = (self.rows.start as f64, self.rows.end as f64);
        corners.iter().all(|c| c.y < top) || corners.iter().all(|c| c.y > bottom)
    }

    /// Draw one triangle of either winding. `paint` is called once if any sample centre may be
    /// covered, and gives the colour from the weights of the corners (not negative, of positive sum).
    pub(crate) fn triangle<P: Fn([i64; 3]) -> Sample>(
        &mut self,
        corners: &[Placed; 3],
        paint: impl FnOnce() -> Option<P>,
    ) {
        if self.misses(corners) {
            return;
        }
        let Some(edges) = Edges::new(corners) else { return };
        let (low, high) = edges.bounds();
        let Some([columns, rows]) = self.clip(low, high) else { return };
        let Some(paint) = paint() else { return };
        let [near, ..] = corners.each_ref().map(|c| c.nearness);
        let rise = [corners[1].nearness - near, corners[2].nearness - near];
        let step = edges.across();
        let slope = (step[1] as f64 * rise[0] + step[2] as f64 * rise[1]) / edges.area;
        for row in rows {
            let mut e = edges.at(columns.start, row);
            let first = near + (e[1] as f64 * rise[0] + e[2] as f64 * rise[1]) / edges.area;
            let run = self.run(row, &columns);
            for (i, (nearest, colour)) in run.nearness.iter_mut().zip(run.colours).enumerate() {
                if (0..3).all(|k| e[k] >= edges.least[k]) {
                    let nearness = (first + slope * i as f64) as f32;
                    if nearness > *nearest {
                        *nearest = nearness;
                        *colour = paint(e);
                    }
                }
                e = [e[0] + step[0], e[1] + step[1], e[2] + step[2]];
            }
        }
    }
}

/// Edge functions of a triangle: edge `k` lies across from corner `k`, its function is zero on it
/// and positive inside.
struct Edges {
    corners: [[i64; 2]; 3],
    /// +1 or −1, whichever makes the inside positive.
    sign: i64,
    /// Sum of the three edge functions, the same everywhere.
    area: f64,
    /// Least value of each edge function that counts as inside: an edge shared by two triangles
    /// belongs to exactly one of them.
    least: [i64; 3],
}

impl Edges {
    /// None if the corners, rounded, lie on one line.
    fn new(corners: &[Placed; 3]) -> Option<Self> {
        let corners = corners.each_ref().map(|c| [steps(c.x), steps(c.y)]);
        let area = turn(corners[0], corners[1], corners[2]);
        if area == 0 {
            return None;
        }
        let mut edges =
            Self { corners, sign: area.signum(), area: area.abs() as f64, least: [0; 3] };
        edges.least = std::array::from_fn(|k| {
            let [from, to] = edges.ends(k);
            let direction = [0, 1].map(|i| edges.sign * (to[i] - from[i]));
            i64::from(direction[1] < 0 || direction[1] == 0 && direction[0] < 0)
        });
        Some(edges)
    }

    fn ends(&self, k: usize) -> [[i64; 2]; 2] {
        [self.corners[(k + 1) % 3], self.corners[(k + 2) % 3]]
    }

    /// Corners of the box around the triangle, in steps.
    fn bounds(&self) -> ([i64; 2], [i64; 2]) {
        let [a, b, c] = self.corners;
        ([0, 1].map(|i| a[i].min(b[i]).min(c[i])), [0, 1].map(|i| a[i].max(b[i]).max(c[i])))
    }

    /// The edge functions at the centre of a sample.
    fn at(&self, column: usize, row: usize) -> [i64; 3] {
        let centre = [column, row].map(|i| i as i64 * STEPS + STEPS / 2);
        std::array::from_fn(|k| {
            let [from, to] = self.ends(k);
            self.sign * turn(from, to, centre)
        })
    }

    /// Change of the edge functions from one sample to the next in the row.
    fn across(&self) -> [i64; 3] {
        std::array::from_fn(|k| {
            let [from, to] = self.ends(k);
            self.sign * STEPS * (from[1] - to[1])
        })
    }
}

/// Twice the signed area of a triangle.
fn turn(a: [i64; 2], b: [i64; 2], c: [i64; 2]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn placed(x: f64, y: f64, nearness: f64) -> Placed {
        Placed { x, y, nearness, view: [0.0; 3] }
    }

    /// Numbers between 0 and 1 that look random.
    fn noise(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / (1u64 << 24) as f64
        }
    }

    #[test]
    fn triangles_that_share_edges_cover_every_sample_once() {
        const SIDE: usize = 40;
        let mut noise = noise(7);
        // Corners on sample centres and on edges through them are the cases that go wrong.
        let grid: Vec<[f64; 2]> = (0..36)
            .map(|i| {
                let (x, y) = ((i % 6) as f64, (i / 6) as f64);
                let inner = |v: f64| if v == 0.0 || v == 5.0 { 0.0 } else { 1.0 };
                let round = |v: f64| if i % 2 == 0 { v.floor() + 0.5 } else { v };
                [
                    round(8.0 * x + inner(x) * 3.0 * noise()),
                    round(8.0 * y + inner(y) * 3.0 * noise()),
                ]
            })
            .collect();
        let mut covered = vec![0; SIDE * SIDE];
        for cell in (0..35).filter(|i| i % 6 < 5 && i / 6 < 5) {
            let [a, b, c, d] = [cell, cell + 1, cell + 7, cell + 6];
            for (turn, triangle) in [[a, b, c], [a, d, c]].into_iter().enumerate() {
                let mut corners = triangle.map(|i| placed(grid[i][0], grid[i][1], 0.0));
                corners.rotate_left((cell + turn) % 3);
                let mut band = Band::new(SIDE, 0..SIDE, [0; 3]);
                band.triangle(&corners, || Some(|_| [1; 3]));
                for (count, sample) in covered.iter_mut().zip(band.samples()) {
                    *count += i32::from(sample[0]);
                }
            }
        }
        // The border of the sheet may lie half a sample inside.
        let inner = covered.iter().enumerate().filter(|(i, _)| {
            (1..SIDE - 1).contains(&(i % SIDE)) && (1..SIDE - 1).contains(&(i / SIDE))
        });
        assert!(inner.clone().count() > 1000);
        assert!(inner.into_iter().all(|(_, &count)| count == 1), "{covered:?}");
    }

    #[test]
    fn depth_is_that_of_the_plane() {
        let depth = |x: f64, y: f64| 0.3 + 0.02 * x - 0.01 * y;
        let corner = |x: f64, y: f64| placed(x, y, depth(x, y));
        for corners in
            [[(2.0, 3.0), (29.0, 8.0), (11.0, 27.0)], [(2.0, 3.0), (11.0, 27.0), (29.0, 8.0)]]
        {
            let mut band = Band::new(32, 4..30, [0; 3]);
            band.triangle(&corners.map(|(x, y)| corner(x, y)), || Some(|_| [1; 3]));
            let mut count = 0;
            for (i, nearness) in band.nearness.iter().enumerate().filter(|(_, n)| n.is_finite()) {
                let (x, y) = ((i % 32) as f64 + 0.5, (i / 32 + 4) as f64 + 0.5);
                assert!((f64::from(*nearness) - depth(x, y)).abs() < 1e-6);
                count += 1;
            }
            // Area 301.5 by the shoelace formula, less 2.5 for the tip above row 4.
            assert!((290..308).contains(&count), "{count}");
        }
    }
}
