//! Parallel planes through a mesh.

use std::ops::Range;

use crate::grid::Grid;
use crate::mesh::TriMesh;
use crate::vector::{Vector, dot, length, scale};

/// Vertices within this many lattice steps of a plane across the axis of a lattice lie in it: where
/// they stand follows from their world positions by an affine map, which rounds.
const ROUNDING: f64 = 1e-9;

/// Planes across one axis, of the world or of a lattice.
///
/// A point in a plane counts as above it, so what a plane cuts is the body just below it. Planes
/// across an axis of the world are exact: the coordinate itself is compared.
#[derive(Debug, Clone, PartialEq)]
pub struct Planes {
    /// The height of a world point p is row·(p, 1).
    row: [f64; 4],
    /// The axis of the world whose coordinate is the height, if one is.
    coordinate: Option<usize>,
    /// Ascending.
    positions: Vec<f64>,
}

impl Planes {
    /// The planes on which coordinate `axis` (0, 1, 2 for x, y, z) has one of these values, in world
    /// units. They come in ascending order, each once; what is not finite is left out.
    ///
    /// # Panics
    /// When the axis is above 2.
    pub fn across(axis: usize, positions: Vec<f64>) -> Self {
        let mut row = [0.0; 4];
        row[axis] = 1.0;
        Self { row, coordinate: Some(axis), positions: sorted(positions) }
    }

    /// As [`Planes::across`], for an axis of a lattice and indices, which need not be whole.
    ///
    /// # Panics
    /// When the axis is above 2.
    pub fn across_lattice(grid: &Grid, axis: usize, positions: Vec<f64>) -> Self {
        Self { row: grid.inverse_affine()[axis], coordinate: None, positions: sorted(positions) }
    }

    /// Where the planes are, ascending.
    pub fn positions(&self) -> &[f64] {
        &self.positions
    }

    /// Planes across the same axis elsewhere.
    #[must_use]
    pub fn at(self, positions: Vec<f64>) -> Self {
        Self { positions: sorted(positions), ..self }
    }

    /// Between which positions a mesh lies; nothing if it has no vertices.
    pub fn range(&self, mesh: &TriMesh) -> Option<[f64; 2]> {
        let mut heights = mesh.vertices.iter().map(|&p| self.height(p));
        let first = heights.next()?;
        Some(heights.fold([first; 2], |[low, high], height| [low.min(height), high.max(height)]))
    }

    /// Unit normal in world coordinates, towards larger positions.
    pub fn normal(&self) -> [f64; 3] {
        let [x, y, z, _] = self.row;
        scale([x, y, z], length([x, y, z]).recip())
    }

    /// On which height a world point lies; in a plane it has exactly its position.
    pub(super) fn height(&self, p: Vector) -> f64 {
        if let Some(axis) = self.coordinate {
            return p[axis];
        }
        let [x, y, z, shift] = self.row;
        let height = dot([x, y, z], p) + shift;
        let next = self.positions.partition_point(|&position| position < height - ROUNDING);
        match self.positions.get(next) {
            Some(&position) if position <= height + ROUNDING => position,
            _ => height,
        }
    }

    /// The planes that have some points below and others not, by the lowest and highest of these.
    pub(super) fn between(&self, low: f64, high: f64) -> Range<usize> {
        let first = self.positions.partition_point(|&position| position <= low);
        first..first + self.positions[first..].partition_point(|&position| position <= high)
    }

    /// Where a segment meets plane `level`, which has its first end below it and its last not, or the
    /// other way round.
    pub(super) fn meet(&self, level: usize, ends: [Vector; 2], heights: [f64; 2]) -> Vector {
        let position = self.positions[level];
        let t = (position - heights[0]) / (heights[1] - heights[0]);
        let mut point = std::array::from_fn(|k| (1.0 - t) * ends[0][k] + t * ends[1][k]);
        if let Some(axis) = self.coordinate {
            point[axis] = position;
        }
        point
    }
}

fn sorted(mut positions: Vec<f64>) -> Vec<f64> {
    positions.retain(|position| position.is_finite());
    // The two zeros are one place.
    positions.iter_mut().for_each(|position| *position += 0.0);
    positions.sort_by(f64::total_cmp);
    positions.dedup();
    positions
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_are_sorted_and_finite() {
        let planes = Planes::across(1, vec![2.0, -0.0, f64::NAN, 0.0, -1.0, 2.0, f64::INFINITY]);
        assert_eq!(planes.positions(), [-1.0, 0.0, 2.0]);
        assert_eq!(planes.normal(), [0.0, 1.0, 0.0]);
        assert_eq!(planes.between(-1.0, 2.0), 1..3);
        assert_eq!(planes.between(-1.5, -0.5), 0..1);
        assert!(planes.between(0.5, 1.5).is_empty());
    }

    #[test]
    fn points_of_a_lattice_plane_lie_in_it() {
        let affine = [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];
        let grid = Grid::with_affine([9; 3], affine).unwrap();
        for axis in 0..3 {
            let planes = Planes::across_lattice(&grid, axis, (0..9).map(f64::from).collect());
            for n in 0..9 {
                let mut index = [0.3, 7.7, 4.1];
                index[axis] = f64::from(n);
                assert_eq!(planes.height(grid.point(index)), f64::from(n));
                index[axis] += 1e-6;
                assert!(planes.height(grid.point(index)) > f64::from(n));
            }
        }
    }
}
