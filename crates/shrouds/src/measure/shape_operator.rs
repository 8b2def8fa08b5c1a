//! Least squares for the shape operator of a surface at a vertex.

use crate::vector::{Vector, cross, dot, length, scale, subtract};

/// What is added to the equations, relative to them, so that those of too few neighbours have a
/// solution too: the smallest.
const RIDGE: f64 = 1e-12;

/// Two unit vectors normal to a unit vector and to each other, if it has a direction.
fn tangents(normal: Vector) -> Option<[Vector; 2]> {
    let size = length(normal);
    let smallest = (0..3).min_by(|a, b| normal[*a].abs().total_cmp(&normal[*b].abs()))?;
    let mut axis = [0.0; 3];
    axis[smallest] = 1.0;
    let first = cross(normal, axis);
    let first = scale(first, length(first).recip());
    let second = scale(cross(normal, first), size.recip());
    (size > 0.0 && size.is_finite()).then_some([first, second])
}

/// Least squares for the shape operator [[a, b], [b, c]] in a basis of the tangent plane: the normal
/// equations for (a, b, c).
pub(super) struct Fit {
    basis: [Vector; 2],
    rows: [Vector; 3],
    right: Vector,
}

impl Fit {
    /// No equations yet, at a vertex with this unit normal, if it has a direction.
    pub(super) fn new(normal: Vector) -> Option<Self> {
        tangents(normal).map(|basis| Self { basis, rows: [[0.0; 3]; 3], right: [0.0; 3] })
    }

    fn add(&mut self, factors: Vector, right: f64, weight: f64) {
        for (row, factor) in self.rows.iter_mut().zip(factors) {
            *row = std::array::from_fn(|k| row[k] + weight * factor * factors[k]);
        }
        self.right = std::array::from_fn(|k| self.right[k] + weight * factors[k] * right);
    }

    /// The curve through the vertex and two others, the chords to which are given.
    pub(super) fn add_curve(&mut self, chords: [Vector; 2], normal: Vector) {
        // Inversion turns the circle into a line along its tangent; the point of it that is nearest
        // to the vertex is half the curvature vector.
        let squares = chords.map(|chord| dot(chord, chord));
        let [p, q] = [0, 1].map(|n| scale(chords[n], squares[n].recip()));
        let line = subtract(q, p);
        let size = length(line);
        let curvature = scale(subtract(p, scale(line, dot(p, line) / (size * size))), 2.0);
        let [x, y] = self.basis.map(|axis| dot(axis, line) / size);
        let bend = -dot(curvature, normal);
        // Two vertices at one place have no circle.
        if size > 0.0 && size.is_finite() && bend.is_finite() {
            self.add([x * x, 2.0 * x * y, y * y], bend, 0.5 * (squares[0] + squares[1]));
        }
    }

    /// The turn of the normal on the way to another vertex.
    pub(super) fn add_normal(&mut self, way: Vector, turn: Vector) {
        let [x, y] = self.basis.map(|axis| dot(axis, way));
        let [u, w] = self.basis.map(|axis| dot(axis, turn));
        self.add([x, y, 0.0], u, 1.0);
        self.add([0.0, x, y], w, 1.0);
    }

    /// The eigenvalues of the shape operator, the larger one first.
    pub(super) fn principal(mut self) -> [f64; 2] {
        let trace = self.rows[0][0] + self.rows[1][1] + self.rows[2][2];
        (0..3).for_each(|k| self.rows[k][k] += RIDGE * trace);
        let [p, q, r] = self.rows;
        let determinant = dot(p, cross(q, r));
        let columns = [cross(q, r), cross(r, p), cross(p, q)];
        let [a, b, c] = [0, 1, 2]
            .map(|k| (0..3).map(|n| columns[n][k] * self.right[n]).sum::<f64>() / determinant);
        let (mean, radius) = (0.5 * (a + c), (0.5 * (a - c)).hypot(b));
        let principal = [mean + radius, mean - radius];
        if principal.iter().all(|x| x.is_finite()) { principal } else { [0.0; 2] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fit() -> Fit {
        let basis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        Fit { basis, rows: [[0.0; 3]; 3], right: [0.0; 3] }
    }

    const UP: Vector = [0.0, 0.0, 1.0];

    /// Points of a sphere of radius 2 that touches the plane z = 0 from below, seen from its pole.
    fn sphere(x: f64, y: f64) -> Vector {
        [x, y, (4.0 - x * x - y * y).sqrt() - 2.0]
    }

    #[test]
    fn oblique_sections_of_a_sphere_tell_its_curvature() {
        let mut fit = fit();
        // Planes at different angles to the normal, chords of different lengths.
        fit.add_curve([sphere(-0.5, 0.0), sphere(0.25, 0.0)], UP);
        let tilted = |t: f64| {
            // On the plane z = -y the sphere has a circle through its pole.
            let y = 0.5 * (2.0 - (4.0 - 2.0 * t * t).sqrt());
            [t, y, -y]
        };
        for t in [-0.5, 0.7] {
            let [x, y, z] = tilted(t);
            assert!((x * x + y * y + (z + 2.0).powi(2) - 4.0).abs() < 1e-12);
        }
        fit.add_curve([tilted(-0.5), tilted(0.7)], UP);
        fit.add_curve([sphere(0.0, -0.3), sphere(0.0, 0.3)], UP);
        fit.add_curve([sphere(-0.4, -0.4), sphere(0.3, 0.3)], UP);
        for curvature in fit.principal() {
            assert!((curvature - 0.5).abs() < 1e-9, "{curvature}");
        }
    }

    #[test]
    fn turns_of_the_normal_tell_principal_curvatures() {
        let mut fit = fit();
        let shape = [[0.3, -0.2], [-0.2, -0.1]];
        for way in [[1.0, 0.0], [0.5, 0.9], [-1.0, 0.3]] {
            let turn: [f64; 2] = shape.map(|row| row[0] * way[0] + row[1] * way[1]);
            fit.add_normal([way[0], way[1], 0.7], [turn[0], turn[1], -0.2]);
        }
        let [large, small] = fit.principal();
        assert!((large + small - 0.2).abs() < 1e-9 && (large * small + 0.07).abs() < 1e-9);
    }

    #[test]
    fn too_few_equations_leave_zero_and_no_nan() {
        assert_eq!(fit().principal(), [0.0; 2]);
        let mut one = fit();
        one.add_curve([sphere(-0.5, 0.0), sphere(0.5, 0.0)], UP);
        let [large, small] = one.principal();
        assert!((large - 0.5).abs() < 1e-6 && small.abs() < 1e-6);
        let mut none = fit();
        none.add_curve([[0.0; 3], sphere(0.5, 0.0)], UP);
        none.add_curve([sphere(0.5, 0.0); 2], UP);
        none.add_normal([0.0; 3], [1.0, 0.0, 0.0]);
        assert_eq!(none.principal(), [0.0; 2]);
        assert!(tangents([0.0; 3]).is_none() && tangents([f64::NAN; 3]).is_none());
    }
}
