//! Which triangles fit a polygon best.
//!
//! A triangle is the better the less its normal is turned from the mean normal of its corners: it
//! costs |N| |d| − N · d, where N is its normal with twice its area as length and d the sum of the
//! corners' normals; that is close to its area times the squared angle. Polygons with the same number
//! of corners wait for each other, so that their arithmetic goes side by side.

/// Polygons that are cut side by side.
const LANES: usize = 8;

/// One number for each polygon.
type Lanes = [f32; LANES];

/// Polygons of 4, 5 or 6 corners on their way to triangles.
#[derive(Default)]
pub(crate) struct Fit {
    quadrangles: Batch<4>,
    pentagons: Batch<5>,
    hexagons: Batch<6>,
}

/// One polygon.
pub(crate) trait Polygon {
    /// Its corners as vertices.
    fn vertices(&self) -> &[u32];
    /// The place of corner `n` relative to one of them in any unit near their distances, and the unit
    /// normal it should have, seen from where the polygon turns counter-clockwise.
    fn corner(&self, n: usize) -> ([f32; 3], [f32; 3]);
}

impl Fit {
    /// Cuts a polygon of 4 to 6 corners, any diagonals of which may be used. Its triangles go to
    /// `triangles` from `at` on, at the latest with [`Fit::finish`].
    #[inline]
    pub(crate) fn push(&mut self, polygon: &impl Polygon, at: usize, triangles: &mut [[u32; 3]]) {
        match polygon.vertices().len() {
            4 => {
                if self.quadrangles.push(polygon, at) {
                    self.quadrangles.cut(quadrangle, triangles);
                }
            }
            5 => {
                if self.pentagons.push(polygon, at) {
                    self.pentagons.cut(pentagon, triangles);
                }
            }
            _ => {
                if self.hexagons.push(polygon, at) {
                    self.hexagons.cut(hexagon, triangles);
                }
            }
        }
    }

    /// Cuts all that wait.
    pub(crate) fn finish(&mut self, triangles: &mut [[u32; 3]]) {
        self.quadrangles.cut(quadrangle, triangles);
        self.pentagons.cut(pentagon, triangles);
        self.hexagons.cut(hexagon, triangles);
    }
}

/// Waiting polygons of `COUNT` corners.
struct Batch<const COUNT: usize> {
    /// Places and normals by corner and component.
    place: [[Lanes; 3]; COUNT],
    normal: [[Lanes; 3]; COUNT],
    vertices: [[u32; COUNT]; LANES],
    /// Where the triangles go.
    at: [usize; LANES],
    waiting: usize,
}

impl<const COUNT: usize> Default for Batch<COUNT> {
    fn default() -> Self {
        let zero = [[[0.0; LANES]; 3]; COUNT];
        let vertices = [[0; COUNT]; LANES];
        Self { place: zero, normal: zero, vertices, at: [0; LANES], waiting: 0 }
    }
}

impl<const COUNT: usize> Batch<COUNT> {
    /// Returns whether the batch is full.
    #[inline(always)]
    fn push(&mut self, polygon: &impl Polygon, at: usize) -> bool {
        let lane = self.waiting % LANES;
        self.at[lane] = at;
        self.vertices[lane].copy_from_slice(&polygon.vertices()[..COUNT]);
        for n in 0..COUNT {
            let (place, normal) = polygon.corner(n);
            for k in 0..3 {
                self.place[n][k][lane] = place[k];
                self.normal[n][k][lane] = normal[k];
            }
        }
        self.waiting = lane + 1;
        self.waiting == LANES
    }

    /// Cuts the polygons as `best` says.
    #[inline(always)]
    fn cut<const TRIANGLES: usize>(
        &mut self,
        best: impl Fn(&Self) -> [[[u8; 3]; TRIANGLES]; LANES],
        triangles: &mut [[u32; 3]],
    ) {
        let best = best(self);
        let waiting = self.at.iter().zip(&self.vertices).zip(best).take(self.waiting);
        for ((&at, vertices), best) in waiting {
            for (slot, corners) in triangles[at..at + TRIANGLES].iter_mut().zip(best) {
                *slot = corners.map(|corner| vertices[usize::from(corner)]);
            }
        }
        self.waiting = 0;
    }

    /// What a triangle costs in each polygon.
    #[inline(always)]
    fn cost(&self, a: usize, b: usize, c: usize) -> Lanes {
        let ([p, q, r], [d, e, f]) =
            ([a, b, c].map(|n| &self.place[n]), [a, b, c].map(|n| &self.normal[n]));
        let mut cost = [0.0; LANES];
        for n in 0..LANES {
            cost[n] = misfit(
                [q[0][n] - p[0][n], q[1][n] - p[1][n], q[2][n] - p[2][n]],
                [r[0][n] - p[0][n], r[1][n] - p[1][n], r[2][n] - p[2][n]],
                [
                    d[0][n] + e[0][n] + f[0][n],
                    d[1][n] + e[1][n] + f[1][n],
                    d[2][n] + e[2][n] + f[2][n],
                ],
            );
        }
        cost
    }
}

#[inline(never)]
fn quadrangle(batch: &Batch<4>) -> [[[u8; 3]; 2]; LANES] {
    let low = sum([batch.cost(0, 1, 2), batch.cost(0, 2, 3)]);
    let high = sum([batch.cost(0, 1, 3), batch.cost(1, 2, 3)]);
    std::array::from_fn(|lane| {
        if high[lane] <= low[lane] { [[0, 1, 3], [1, 2, 3]] } else { [[0, 1, 2], [0, 2, 3]] }
    })
}

/// All triangulations of a pentagon are fans around a corner.
#[inline(never)]
fn pentagon(batch: &Batch<5>) -> [[[u8; 3]; 3]; LANES] {
    let ears = [0, 1, 2, 3, 4].map(|n| batch.cost(n, (n + 1) % 5, (n + 2) % 5));
    let fan = |n: usize| sum([ears[n], batch.cost(n, (n + 2) % 5, (n + 3) % 5), ears[(n + 3) % 5]]);
    let best = least([fan(0), fan(1), fan(2), fan(3), fan(4)]);
    best.map(|n| {
        let at = |step: u8| (n + step) % 5;
        [[n, at(1), at(2)], [n, at(2), at(3)], [n, at(3), at(4)]]
    })
}

/// A hexagon is cut by a long diagonal into two quadrangles, or has an inner triangle with an ear on
/// each side.
#[inline(never)]
fn hexagon(batch: &Batch<6>) -> [[[u8; 3]; 4]; LANES] {
    let corners = [0, 1, 2, 3, 4, 5];
    let ears = corners.map(|n| batch.cost(n, (n + 1) % 6, (n + 2) % 6));
    // The quadrangle that starts at a corner, cut at its first corner and at its second.
    let halves = corners.map(|n| {
        let [b, c, d] = [(n + 1) % 6, (n + 2) % 6, (n + 3) % 6];
        [sum([ears[n], batch.cost(n, c, d)]), sum([batch.cost(n, b, d), ears[b]])]
    });
    let half = |n: usize| -> Lanes {
        std::array::from_fn(|lane| halves[n][0][lane].min(halves[n][1][lane]))
    };
    let inner = |n: usize| sum([batch.cost(n, n + 2, n + 4), ears[n], ears[n + 2], ears[n + 4]]);
    let long = |n: usize| sum([half(n), half(n + 3)]);
    let best = least([long(0), long(1), long(2), inner(0), inner(1)]);
    std::array::from_fn(|lane| {
        let at = |n: u8| n % 6;
        let cut = |n: u8| {
            let [first, second] = halves[usize::from(n)].map(|cost| cost[lane]);
            if first <= second {
                [[n, at(n + 1), at(n + 2)], [n, at(n + 2), at(n + 3)]]
            } else {
                [[n, at(n + 1), at(n + 3)], [at(n + 1), at(n + 2), at(n + 3)]]
            }
        };
        match best[lane] {
            n @ 0..3 => {
                let ([a, b], [c, d]) = (cut(n), cut(n + 3));
                [a, b, c, d]
            }
            n => {
                let n = n - 3;
                let ear = |n: u8| [n, at(n + 1), at(n + 2)];
                [[n, n + 2, n + 4], ear(n), ear(n + 2), ear(n + 4)]
            }
        }
    })
}

#[inline(always)]
fn sum<const COUNT: usize>(terms: [Lanes; COUNT]) -> Lanes {
    let mut sum = [0.0; LANES];
    for term in terms {
        for n in 0..LANES {
            sum[n] += term[n];
        }
    }
    sum
}

/// The place of the smallest in each lane, the first of equals.
#[inline(always)]
fn least<const COUNT: usize>(values: [Lanes; COUNT]) -> [u8; LANES] {
    let (mut best, mut least) = ([0; LANES], values[0]);
    for (place, value) in values.iter().enumerate().skip(1) {
        for n in 0..LANES {
            best[n] = if value[n] < least[n] { place as u8 } else { best[n] };
            least[n] = if value[n] < least[n] { value[n] } else { least[n] };
        }
    }
    best
}

/// How badly a triangle, given by two of its sides, fits a direction: about its area times the squared
/// angle between the two, times the length of the direction.
#[inline(always)]
pub(super) fn misfit(u: [f32; 3], v: [f32; 3], direction: [f32; 3]) -> f32 {
    let [x, y, z] = direction;
    let nx = u[1] * v[2] - u[2] * v[1];
    let ny = u[2] * v[0] - u[0] * v[2];
    let nz = u[0] * v[1] - u[1] * v[0];
    let normal_squared = nx * nx + ny * ny + nz * nz;
    let squared = x * x + y * y + z * z;
    (normal_squared * squared).sqrt() - (nx * x + ny * y + nz * z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::uniform;
    use crate::surface::triangulation::cheapest;

    struct Sample {
        vertices: Vec<u32>,
        corners: Vec<([f32; 3], [f32; 3])>,
    }

    impl Polygon for Sample {
        fn vertices(&self) -> &[u32] {
            &self.vertices
        }

        fn corner(&self, n: usize) -> ([f32; 3], [f32; 3]) {
            self.corners[n]
        }
    }

    impl Sample {
        /// A polygon around the z axis, with its corners numbered from 10 on.
        fn random(count: usize, seed: u64) -> Self {
            let number = |index: usize| uniform(seed, index as u64) as f32 - 0.5;
            let corner = |n: usize| {
                let angle = std::f32::consts::TAU * (n as f32 + 0.5 * number(7 * n)) / count as f32;
                let place = [angle.cos(), angle.sin(), number(7 * n + 1)];
                (place, [number(7 * n + 2), number(7 * n + 3), 1.0])
            };
            let vertices = (10..).take(count).collect();
            Self { vertices, corners: (0..count).map(corner).collect() }
        }

        fn cost(&self, [i, k, j]: [usize; 3]) -> f32 {
            let [(a, d), (b, e), (c, f)] = [i, k, j].map(|n| self.corners[n]);
            let side = |p: [f32; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
            misfit(side(b), side(c), [0, 1, 2].map(|x| d[x] + e[x] + f[x]))
        }
    }

    #[test]
    fn polygons_get_the_triangles_that_cost_least() {
        let (mut fit, mut triangles, mut samples) = (Fit::default(), Vec::new(), Vec::new());
        for seed in 0..1000 {
            let sample = Sample::random(4 + seed as usize % 3, seed);
            let at = triangles.len();
            triangles.resize(at + sample.vertices.len() - 2, [0; 3]);
            fit.push(&sample, at, &mut triangles);
            samples.push((at, sample));
        }
        fit.finish(&mut triangles);
        for (at, sample) in samples {
            let count = sample.vertices.len();
            let found = &triangles[at..at + count - 2];
            let found = found.iter().map(|t| t.map(|v| v as usize - 10));
            let mut best = Vec::new();
            cheapest(count, |_, _| true, |i, k, j| sample.cost([i, k, j]), &mut best);
            let best: f32 = best.iter().map(|t| sample.cost(t.map(usize::from))).sum();
            let cost: f32 = found.clone().map(|triangle| sample.cost(triangle)).sum();
            assert!((cost - best).abs() < 1e-5, "{cost} {best}");
            // Every side of the polygon once, every diagonal once in each direction.
            let edges = found.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]]);
            let mut edges: Vec<[usize; 2]> = edges.collect();
            edges.sort_unstable();
            for n in 0..edges.len() {
                let [a, b] = edges[n];
                assert!(n == 0 || edges[n - 1] != [a, b]);
                assert_eq!(edges.contains(&[b, a]), b != (a + 1) % count, "{edges:?}");
            }
        }
    }
}
