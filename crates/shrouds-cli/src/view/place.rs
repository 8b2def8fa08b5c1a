//! From the world to the coordinates of the page: index times spacing.

use shrouds::Grid;

/// The way from the world to lattice coordinates.
pub(super) struct Places {
    inverse: [[f64; 4]; 3],
    affine: [[f64; 4]; 3],
    spacing: [f64; 3],
    is_mirrored: bool,
}

impl Places {
    pub(super) fn of(grid: &Grid) -> Self {
        let (inverse, affine) = (grid.inverse_affine(), grid.affine());
        Self { inverse, affine, spacing: grid.spacing(), is_mirrored: grid.is_mirrored() }
    }

    pub(super) fn point(&self, world: [f64; 3]) -> [f32; 3] {
        std::array::from_fn(|d| {
            let [x, y, z, shift] = self.inverse[d];
            ((x * world[0] + y * world[1] + z * world[2] + shift) * self.spacing[d]) as f32
        })
    }

    /// A unit normal; normals are covectors and go by the transpose of the way back.
    pub(super) fn normal(&self, world: [f32; 3]) -> [f32; 3] {
        let n = world.map(f64::from);
        let turned: [f64; 3] = std::array::from_fn(|d| {
            (0..3).map(|k| self.affine[k][d] * n[k]).sum::<f64>() / self.spacing[d]
        });
        let length = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
        turned.map(|x| if length > 0.0 { (x / length) as f32 } else { 0.0 })
    }

    /// Triangles that face outside in the world do so here.
    pub(super) fn triangles(&self, world: &[[u32; 3]]) -> Vec<[u32; 3]> {
        let turn = |&[a, b, c]: &[u32; 3]| if self.is_mirrored { [a, c, b] } else { [a, b, c] };
        world.iter().map(turn).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_sees_a_lattice_of_its_own() {
        let affine = [[0.0, -2.0, 0.0, 5.0], [1.5, 0.0, 0.0, -7.0], [0.0, 0.0, -0.5, 3.0]];
        let grid = Grid::with_affine([4; 3], affine).unwrap();
        let places = Places::of(&grid);
        assert_eq!(places.point(grid.point([1.0, 2.0, 3.0])), [1.5, 4.0, 1.5]);
        // Along y of the lattice, which is −x of the world.
        assert_eq!(places.normal([-1.0, 0.0, 0.0]), [0.0, 1.0, 0.0]);
        assert!(grid.is_mirrored());
        assert_eq!(places.triangles(&[[0, 1, 2]]), [[0, 2, 1]]);
    }
}
