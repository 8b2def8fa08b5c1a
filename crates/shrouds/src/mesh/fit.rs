//! Which triangles fit a patch best.
//!
//! A triangle is the better the less its normal is turned from the mean normal of its corners: it
//! costs |N| |d| − N · d, where N is its normal with twice its area as length and d the sum of the
//! corners' normals; that is close to its area times the squared angle. The corners of a patch are
//! kept once round and on, so that all triangles of one form lie in lanes side by side, one for each
//! corner they start at.

/// The most corners a patch has that can be fitted.
const MOST: usize = 6;
/// Corners once round and as far as a lane may reach.
const AROUND: usize = 12;

/// The corners of a patch.
#[derive(Default)]
pub(super) struct Corners {
    count: usize,
    /// Positions relative to the first corner, by component.
    position: [[f32; AROUND]; 3],
    /// Unit normals, by component.
    normal: [[f32; AROUND]; 3],
}

impl Corners {
    /// Takes the corners of a patch of 4 to 6: their positions, in any unit near their distances,
    /// relative to one of them, and the unit normals they should have, seen from where the patch
    /// turns counter-clockwise.
    #[inline]
    pub(super) fn read(&mut self, corners: impl ExactSizeIterator<Item = ([f32; 3], [f32; 3])>) {
        self.count = corners.len().min(MOST);
        for (n, (position, normal)) in corners.enumerate().take(MOST) {
            for k in 0..3 {
                self.position[k][n] = position[k];
                self.normal[k][n] = normal[k];
            }
        }
        for k in 0..3 {
            for n in self.count..self.count + 4 {
                self.position[k][n] = self.position[k][n - self.count];
                self.normal[k][n] = self.normal[k][n - self.count];
            }
        }
    }

    /// Calls `f` with the triangles, as corner numbers.
    #[inline]
    pub(super) fn triangulate(&self, mut f: impl FnMut(usize, usize, usize)) {
        match self.count {
            4 => self.cut_quadrangle(&mut f),
            5 => self.cut_pentagon(&mut f),
            _ => self.cut_hexagon(&mut f),
        }
    }

    #[inline]
    fn cut_quadrangle(&self, f: &mut impl FnMut(usize, usize, usize)) {
        let ear = self.costs::<4>(1, 2);
        if ear[1] + ear[3] <= ear[0] + ear[2] {
            f(0, 1, 3);
            f(1, 2, 3);
        } else {
            f(0, 1, 2);
            f(0, 2, 3);
        }
    }

    /// All its triangulations are fans around a corner.
    #[inline]
    fn cut_pentagon(&self, f: &mut impl FnMut(usize, usize, usize)) {
        let (ear, middle) = (self.costs::<8>(1, 2), self.costs::<8>(2, 3));
        let fan = |n: usize| ear[n] + middle[n] + ear[(n + 3) % 5];
        let n = least([fan(0), fan(1), fan(2), fan(3), fan(4)]);
        let at = |step: usize| (n + step) % 5;
        f(n, at(1), at(2));
        f(n, at(2), at(3));
        f(n, at(3), at(4));
    }

    /// It is cut by a long diagonal into two quadrangles, or has an inner triangle with an ear on
    /// each side.
    #[inline]
    fn cut_hexagon(&self, f: &mut impl FnMut(usize, usize, usize)) {
        let (ear, inner) = (self.costs::<8>(1, 2), self.costs::<4>(2, 4));
        let (far, near) = (self.costs::<8>(2, 3), self.costs::<8>(1, 3));
        // The quadrangle that starts at a corner, cut at its first corner or at its second.
        let cuts: [[f32; 2]; 6] =
            std::array::from_fn(|n| [ear[n] + far[n], ear[(n + 1) % 6] + near[n]]);
        let half = |n: usize| cuts[n][0].min(cuts[n][1]);
        let ears = |n: usize| inner[n] + ear[n] + ear[n + 2] + ear[n + 4];
        let long = [half(0) + half(3), half(1) + half(4), half(2) + half(5)];
        let best = least([long[0], long[1], long[2], ears(0), ears(1)]);
        let mut triangle = |a: usize, b: usize, c: usize| f(a % 6, b % 6, c % 6);
        if best < 3 {
            for n in [best, best + 3] {
                if cuts[n][0] <= cuts[n][1] {
                    triangle(n, n + 1, n + 2);
                    triangle(n, n + 2, n + 3);
                } else {
                    triangle(n, n + 1, n + 3);
                    triangle(n + 1, n + 2, n + 3);
                }
            }
        } else {
            let n = best - 3;
            triangle(n, n + 2, n + 4);
            [n, n + 2, n + 4].iter().for_each(|&n| triangle(n, n + 1, n + 2));
        }
    }

    /// What the triangles cost that join each corner with those `second` and `third` places on.
    #[inline]
    fn costs<const COUNT: usize>(&self, second: usize, third: usize) -> [f32; COUNT] {
        let [a, b, c] = [0, second, third].map(|from| self.run::<COUNT>(&self.position, from));
        let [d, e, f] = [0, second, third].map(|from| self.run::<COUNT>(&self.normal, from));
        std::array::from_fn(|n| {
            let corner = |of: &[[f32; COUNT]; 3]| [of[0][n], of[1][n], of[2][n]];
            let direction = std::array::from_fn(|k| d[k][n] + e[k][n] + f[k][n]);
            misfit([corner(&a), corner(&b), corner(&c)], direction)
        })
    }

    #[inline]
    fn run<const COUNT: usize>(
        &self,
        values: &[[f32; AROUND]; 3],
        from: usize,
    ) -> [[f32; COUNT]; 3] {
        std::array::from_fn(|k| std::array::from_fn(|n| values[k][from + n]))
    }
}

/// The place of the smallest, the first of equals.
fn least<const COUNT: usize>(values: [f32; COUNT]) -> usize {
    (1..COUNT).fold(0, |best, n| if values[n] < values[best] { n } else { best })
}

/// How badly a triangle fits a direction: about its area times the squared angle between the two,
/// times the length of the direction.
#[inline]
pub(super) fn misfit([a, b, c]: [[f32; 3]; 3], direction: [f32; 3]) -> f32 {
    let difference = |p: [f32; 3]| -> [f32; 3] { std::array::from_fn(|k| p[k] - a[k]) };
    let (u, v) = (difference(b), difference(c));
    let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    (dot(normal, normal) * dot(direction, direction)).sqrt() - dot(normal, direction)
}
