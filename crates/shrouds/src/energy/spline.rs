//! The cubic spline through a whole polygon: the paper's alternative to the local quadratic.

use crate::energy::knots::Knots;
use crate::energy::{Parameter, Point2, chord, dot};

/// The energy of a spline, and how it changes with the vertices.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineEnergy {
    /// `∫ ẍ² + ÿ² dt` over the whole curve.
    pub value: f64,
    /// Its derivatives with respect to both coordinates of every vertex.
    pub gradient: Vec<Point2>,
}

/// The integral of the squared second derivative of the cubic spline through all vertices of a polygon:
/// periodic if it is closed, natural if it is open, which of all curves through the vertices has the
/// least. Fewer than three vertices have none.
///
/// Every step of the parameter from a vertex to the next is 1 with [`Parameter::Uniform`], the length of
/// the chord or its square root with [`Parameter::Chord`] and [`Parameter::Centripetal`], that length made
/// longer by the turning at both its ends with [`Parameter::Foley`], and with [`Parameter::Affine`] the
/// length in Nielson's metric of all vertices, 1 in the mean. With chord lengths it comes near ∫κ² ds.
///
/// Every second derivative depends on every vertex, so this is no [`CurveFormula`] and cannot be
/// optimised as one; it is there to judge curves. Time grows with the number of vertices: two solutions
/// with one tridiagonal matrix, which give the gradient as well, for the matrix is its own adjoint. A
/// vertex takes about as long as one local quadratic with its derivatives, three to five times as long
/// as one of several quadratics side by side.
///
/// [`CurveFormula`]: crate::energy::CurveFormula
pub fn spline_energy(points: &[Point2], is_closed: bool, parameter: Parameter) -> SplineEnergy {
    let n = points.len();
    let mut energy = SplineEnergy { value: 0.0, gradient: vec![[0.0; 2]; n] };
    if n < 3 {
        return energy;
    }
    let knots = Knots::new(points, is_closed, parameter);
    let chords: Vec<Point2> =
        (0..knots.steps.len()).map(|i| chord(points[i], points[(i + 1) % n])).collect();
    let seconds = second_derivatives(&knots.steps, &chords, is_closed);
    // With A·M = r for the second derivatives M the energy is rᵀ·A⁻¹·r/6 = Mᵀ·r/6, so it changes by
    // (2·Mᵀ·dr − Mᵀ·dA·M)/6.
    let mut by_step = vec![0.0; chords.len()];
    for (i, (&h, &own)) in knots.steps.iter().zip(&chords).enumerate() {
        let (a, b) = (seconds[i], seconds[(i + 1) % n]);
        let squares = dot(a, a) + dot(a, b) + dot(b, b);
        let drop = chord(b, a);
        energy.value += h * squares / 3.0;
        by_step[i] = -2.0 * dot(drop, own) / (h * h) - squares / 3.0;
        let by_chord = drop.map(|x| 2.0 * x / h);
        add(&mut energy.gradient[(i + 1) % n], by_chord);
        add(&mut energy.gradient[i], by_chord.map(|x| -x));
    }
    knots.pull_back(points, &by_step, &mut energy.gradient);
    energy
}

pub(super) fn add([x, y]: &mut Point2, more: Point2) {
    *x += more[0];
    *y += more[1];
}

/// The second derivatives of the spline at all vertices.
fn second_derivatives(steps: &[f64], chords: &[Point2], is_closed: bool) -> Vec<Point2> {
    let slope = |i: usize| chords[i].map(|x| x / steps[i]);
    let row = |before: usize, after: usize| {
        let right = chord(slope(before), slope(after)).map(|x| 6.0 * x);
        (2.0 * (steps[before] + steps[after]), right)
    };
    let last = steps.len() - 1;
    if is_closed {
        let rows = (0..=last).map(|i| row(if i == 0 { last } else { i - 1 }, i));
        let (diagonal, right): (Vec<_>, Vec<_>) = rows.unzip();
        return solve_cyclic(diagonal, &steps[..last], steps[last], right);
    }
    let (diagonal, right): (Vec<_>, Vec<_>) = (1..=last).map(|i| row(i - 1, i)).unzip();
    let mut inner = right;
    Tridiagonal::new(diagonal, &steps[1..last]).solve(&mut inner);
    let end = [[0.0; 2]];
    [&end[..], &inner, &end].concat()
}

/// A symmetric tridiagonal matrix with a dominant diagonal, as its factors.
struct Tridiagonal<'a> {
    pivots: Vec<f64>,
    beside: &'a [f64],
}

impl<'a> Tridiagonal<'a> {
    fn new(diagonal: Vec<f64>, beside: &'a [f64]) -> Self {
        let mut pivots = diagonal;
        for (i, c) in beside.iter().enumerate() {
            pivots[i + 1] -= c * c / pivots[i];
        }
        Self { pivots, beside }
    }

    /// Replaces a right side by the solution.
    fn solve(&self, right: &mut [Point2]) {
        for (i, c) in self.beside.iter().enumerate() {
            let factor = c / self.pivots[i];
            let before = right[i];
            add(&mut right[i + 1], before.map(|x| -factor * x));
        }
        for i in (0..right.len()).rev() {
            if let Some(c) = self.beside.get(i) {
                let after = right[i + 1];
                add(&mut right[i], after.map(|x| -c * x));
            }
            right[i] = right[i].map(|x| x / self.pivots[i]);
        }
    }
}

/// Solves with a tridiagonal matrix that has `corner` in its two far corners as well.
fn solve_cyclic(
    mut diagonal: Vec<f64>,
    beside: &[f64],
    corner: f64,
    mut right: Vec<Point2>,
) -> Vec<Point2> {
    // It is the matrix T with `corner` less at both ends of the diagonal, and corner·e·eᵀ where e is
    // 1 at both ends: Sherman and Morrison's formula.
    let last = diagonal.len() - 1;
    diagonal[0] -= corner;
    diagonal[last] -= corner;
    let matrix = Tridiagonal::new(diagonal, beside);
    let mut ends = vec![[0.0; 2]; last + 1];
    (ends[0][0], ends[last][0]) = (1.0, 1.0);
    matrix.solve(&mut ends);
    matrix.solve(&mut right);
    let denominator = 1.0 + corner * (ends[0][0] + ends[last][0]);
    let factors = [0, 1].map(|k| corner * (right[0][k] + right[last][k]) / denominator);
    for (x, [e, _]) in right.iter_mut().zip(ends) {
        *x = [0, 1].map(|k| x[k] - factors[k] * e);
    }
    right
}
