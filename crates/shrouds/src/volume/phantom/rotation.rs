//! Rotations of shapes.

use super::length;
use crate::error::Error;

/// A rotation as a matrix: column `a` is the world direction of the shape's own axis `a`.
pub type Rotation = [[f64; 3]; 3];

/// No rotation: the shape's axes are those of the world.
pub const IDENTITY: Rotation = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Rotation by `angle` radians about `axis`, counter-clockwise seen from the axis' tip.
///
/// # Errors
/// [`Error::Setting`] when the axis has no direction or a number is not finite.
pub fn rotation(axis: [f64; 3], angle: f64) -> Result<Rotation, Error> {
    let norm = length(axis);
    if !(norm.is_finite() && norm > 0.0 && angle.is_finite()) {
        return Err(Error::Setting {
            name: "rotation",
            value: format!("{angle} about {axis:?}"),
            range: "a finite angle about an axis that is not zero",
        });
    }
    let u = axis.map(|x| x / norm);
    let (sin, cos) = angle.sin_cos();
    // Rodrigues' formula: cos·I + sin·[u]× + (1 − cos)·u·uᵀ.
    let cross = [[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]];
    Ok(std::array::from_fn(|r| {
        std::array::from_fn(|c| {
            cos * IDENTITY[r][c] + sin * cross[r][c] + (1.0 - cos) * u[r] * u[c]
        })
    }))
}

/// Refuses a matrix whose columns are not orthonormal.
pub(super) fn check(turn: &Rotation) -> Result<(), Error> {
    let dot = |a: usize, b: usize| (0..3).map(|r| turn[r][a] * turn[r][b]).sum::<f64>();
    let orthonormal = (0..3).all(|a| (0..3).all(|b| (dot(a, b) - IDENTITY[a][b]).abs() < 1e-9));
    if orthonormal {
        return Ok(());
    }
    let value = format!("{turn:?}");
    Err(Error::Setting { name: "rotation", value, range: "a matrix with orthonormal columns" })
}

/// World vector to the shape's own axes.
pub(super) fn undo(turn: &Rotation, v: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|a| turn[0][a] * v[0] + turn[1][a] * v[1] + turn[2][a] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn a_third_of_a_turn_about_the_diagonal_permutes_the_axes() {
        let turn = rotation([2.0; 3], 2.0 * PI / 3.0).unwrap();
        check(&turn).unwrap();
        for (r, row) in turn.iter().enumerate() {
            for (c, x) in row.iter().enumerate() {
                let expected = if r == (c + 1) % 3 { 1.0 } else { 0.0 };
                assert!((x - expected).abs() < 1e-15, "x goes to y, y to z, z to x");
            }
        }
        let back = undo(&turn, [0.0, 1.0, 0.0]);
        assert!((back[0] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn what_is_no_rotation_is_refused() {
        assert!(rotation([0.0; 3], 1.0).is_err());
        assert!(rotation([1.0, 0.0, 0.0], f64::NAN).is_err());
        assert!(check(&[[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]).is_err());
        assert!(check(&[[f64::NAN; 3]; 3]).is_err());
    }
}
