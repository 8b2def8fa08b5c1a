//! The parameter of a whole polygon: a step from every vertex to the next.

use crate::energy::metric::ORDINARY;
use crate::energy::parameter::{bounded_turning, lengthening};
use crate::energy::spline::add;
use crate::energy::{Parameter, Point2, Scalar, Slope, chord, dot, length};

/// The steps of the parameter, one for each chord of the polygon.
pub(super) struct Knots {
    pub(super) steps: Vec<f64>,
    parameter: Parameter,
    is_closed: bool,
}

impl Knots {
    /// Those of at least two points.
    pub(super) fn new(points: &[Point2], is_closed: bool, parameter: Parameter) -> Self {
        let count = if is_closed { points.len() } else { points.len() - 1 };
        let mut knots = Self { steps: Vec::new(), parameter, is_closed };
        knots.steps = match parameter {
            Parameter::Affine => Moments::new(points).steps(points, count).0,
            _ => {
                let step =
                    |i| knots.step(knots.around(points.len(), i).map(|j| points[j]), i, count);
                (0..count).map(step).collect()
            }
        };
        knots
    }

    /// Vertex `i`, the one before it and the two after it; an end stands for what lies beyond.
    fn around(&self, n: usize, i: usize) -> [usize; 4] {
        if self.is_closed {
            return [i + n - 1, i, i + 1, i + 2].map(|j| j % n);
        }
        [i.saturating_sub(1), i, i + 1, (i + 2).min(n - 1)]
    }

    /// Step `i` of so many, from the second to the third of four successive vertices.
    fn step<S: Scalar>(&self, [a, b, c, d]: [Point2<S>; 4], i: usize, count: usize) -> S {
        let own = chord(b, c);
        let l = length(own);
        let gain = |angle: S, other: Point2<S>| l * lengthening(angle, l, length(other));
        match self.parameter {
            Parameter::Uniform | Parameter::Affine => S::constant(1.0),
            Parameter::Chord => l,
            Parameter::Centripetal => l.sqrt(),
            Parameter::Foley => {
                let mut step = l;
                if self.is_closed || i > 0 {
                    let before = chord(a, b);
                    step = step + gain(bounded_turning(before, own), before);
                }
                if self.is_closed || i + 1 < count {
                    let after = chord(c, d);
                    step = step + gain(bounded_turning(own, after), after);
                }
                step
            }
        }
    }

    /// Adds to a gradient with respect to the vertices what comes through the steps.
    pub(super) fn pull_back(&self, points: &[Point2], by_step: &[f64], gradient: &mut [Point2]) {
        match self.parameter {
            Parameter::Uniform => return,
            Parameter::Affine => return Moments::new(points).pull_back(points, by_step, gradient),
            Parameter::Chord | Parameter::Centripetal | Parameter::Foley => {}
        }
        for (i, by) in by_step.iter().enumerate() {
            let around = self.around(points.len(), i);
            // The slopes with respect to all first, and to all second coordinates.
            let slopes = [0, 1].map(|k| {
                let unknown = |n: usize| {
                    [0, 1].map(|c| {
                        let mut value = Slope::constant(points[around[n]][c]);
                        value.slope[n] = if c == k { 1.0 } else { 0.0 };
                        value
                    })
                };
                self.step([0, 1, 2, 3].map(unknown), i, by_step.len()).slope
            });
            for (n, v) in around.into_iter().enumerate() {
                add(&mut gradient[v], slopes.map(|slope| by * slope[n]));
            }
        }
    }
}

/// Mean and second moments of all vertices, for Nielson's metric as in
/// [`metric`](crate::energy::metric).
struct Moments {
    mean: Point2,
    xx: f64,
    xy: f64,
    yy: f64,
}

impl Moments {
    fn new(points: &[Point2]) -> Self {
        let n = points.len() as f64;
        let mean = [0, 1].map(|k| points.iter().map(|p| p[k]).sum::<f64>() / n);
        let zero = Self { mean, xx: 0.0, xy: 0.0, yy: 0.0 };
        points.iter().fold(zero, |sum, &p| {
            let [x, y] = chord(mean, p);
            Self { mean, xx: sum.xx + x * x, xy: sum.xy + x * y, yy: sum.yy + y * y }
        })
    }

    /// What the metric makes of a vector: half the gradient of its squared length.
    fn image(&self, [x, y]: Point2) -> Point2 {
        let ordinary = ORDINARY * (self.xx + self.yy);
        [(self.yy + ordinary) * x - self.xy * y, (self.xx + ordinary) * y - self.xy * x]
    }

    /// The steps, 1 in the mean, and the lengths they come from.
    fn steps(&self, points: &[Point2], count: usize) -> (Vec<f64>, Vec<f64>) {
        let long = |i: usize| {
            let v = chord(points[i], points[(i + 1) % points.len()]);
            (dot(v, self.image(v)).max(0.0) + 1e-24).sqrt()
        };
        let lengths: Vec<f64> = (0..count).map(long).collect();
        let mean = lengths.iter().sum::<f64>() / count as f64;
        (lengths.iter().map(|l| l / mean).collect(), lengths)
    }

    fn pull_back(&self, points: &[Point2], by_step: &[f64], gradient: &mut [Point2]) {
        let n = points.len();
        let (steps, lengths) = self.steps(points, by_step.len());
        let count = by_step.len() as f64;
        let mean = lengths.iter().sum::<f64>() / count;
        // All steps shrink where one length grows.
        let common = by_step.iter().zip(&steps).map(|(by, step)| by * step).sum::<f64>() / count;
        let (mut by_xx, mut by_xy, mut by_yy) = (0.0, 0.0, 0.0);
        for (i, (by, length)) in by_step.iter().zip(&lengths).enumerate() {
            let by_square = (by - common) / mean / (2.0 * length);
            let v = chord(points[i], points[(i + 1) % n]);
            let image = self.image(v);
            let by_chord = image.map(|x| 2.0 * by_square * x);
            add(&mut gradient[(i + 1) % n], by_chord);
            add(&mut gradient[i], by_chord.map(|x| -x));
            let ordinary = ORDINARY * dot(v, v);
            by_xx += by_square * (v[1] * v[1] + ordinary);
            by_yy += by_square * (v[0] * v[0] + ordinary);
            by_xy -= 2.0 * by_square * v[0] * v[1];
        }
        for (gradient, &p) in gradient.iter_mut().zip(points) {
            let [x, y] = chord(self.mean, p);
            gradient[0] += 2.0 * by_xx * x + by_xy * y;
            gradient[1] += 2.0 * by_yy * y + by_xy * x;
        }
    }
}
