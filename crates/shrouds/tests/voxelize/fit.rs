//! Lattices for meshes.

use shrouds::voxelize::{Fit, Rule, grid_for};
use shrouds::{Error, Grid, TriMesh, voxelize};

use crate::shapes::{cuboid, mesh};

#[test]
fn the_longest_side_has_the_size_and_voxels_cover_the_box() {
    let body = cuboid([3.0, -2.0, 10.0], [13.0, 2.0, 13.1]);
    for margin in 0..3 {
        let grid = grid_for(&body, Fit::Size(20 + 2 * margin), margin).unwrap();
        assert_eq!(grid.dims(), [20, 8, 7].map(|n| n + 2 * margin));
        assert!(grid.spacing().iter().all(|step| (step - 0.5).abs() < 1e-12));
        // The middle of the lattice is that of the box.
        let last = grid.point(grid.dims().map(|n| (n - 1) as f64));
        for (d, middle) in [8.0, 0.0, 11.55].into_iter().enumerate() {
            assert!((0.5 * (grid.point([0.0; 3])[d] + last[d]) - middle).abs() < 1e-12);
        }
        let volume = voxelize(&body, &grid, Rule::NonZero).unwrap().volume;
        assert_eq!(volume.count(), 20 * 8 * 6 + if grid.dims()[2] % 2 == 1 { 160 } else { 0 });
    }
}

#[test]
fn a_spacing_is_kept() {
    let body = cuboid([0.0; 3], [1.0, 2.0, 0.0]);
    let grid = grid_for(&body, Fit::Spacing([0.1, 0.3, 7.0]), 1).unwrap();
    assert_eq!((grid.dims(), grid.spacing()), ([12, 9, 3], [0.1, 0.3, 7.0]));
    let flat = mesh(vec![[5.0; 3]; 3], vec![[0, 1, 2]]);
    let grid = grid_for(&flat, Fit::Spacing([1.0; 3]), 2).unwrap();
    assert_eq!((grid.dims(), grid.point([2.0; 3])), ([5; 3], [5.0; 3]));
}

#[test]
fn vertices_without_triangles_do_not_count() {
    let mut body = cuboid([0.0; 3], [1.0; 3]);
    body.vertices.push([1e30, f64::NAN, 0.0]);
    assert_eq!(grid_for(&body, Fit::Size(10), 0).unwrap().dims(), [10; 3]);
}

#[test]
fn what_fits_nothing_is_refused() {
    let refused =
        |mesh: &TriMesh, fit, margin| -> Error { grid_for(mesh, fit, margin).unwrap_err() };
    let body = cuboid([0.0; 3], [1.0; 3]);
    let empty = mesh(vec![[0.0; 3]], vec![]);
    assert!(matches!(refused(&empty, Fit::Size(9), 1), Error::NoExtent(_)));
    assert!(matches!(refused(&empty, Fit::Spacing([1.0; 3]), 1), Error::NoExtent(_)));
    let point = mesh(vec![[1.0; 3]; 3], vec![[0, 1, 2]]);
    assert!(matches!(refused(&point, Fit::Size(9), 1), Error::NoExtent(_)));
    for (size, margin) in [(0, 0), (2, 1), (9, 5), (9, usize::MAX)] {
        assert!(matches!(refused(&body, Fit::Size(size), margin), Error::Setting { .. }));
    }
    for step in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let fit = Fit::Spacing([1.0, step, 1.0]);
        assert!(matches!(refused(&body, fit, 1), Error::Setting { .. }));
    }
    for step in [1e-7, 1e-300] {
        let fit = Fit::Spacing([1.0, step, 1.0]);
        assert!(matches!(refused(&body, fit, 1), Error::Dimensions { .. }));
    }
    let fits = [Fit::Size(Grid::MAX_DIM + 1), Fit::Size(usize::MAX)];
    for fit in fits {
        assert!(matches!(refused(&body, fit, 1), Error::Dimensions { .. }));
    }
    assert!(matches!(refused(&body, Fit::Spacing([1.0; 3]), usize::MAX), Error::Dimensions { .. }));
    let dangling = mesh(vec![[0.0; 3]; 2], vec![[0, 1, 2]]);
    assert!(matches!(refused(&dangling, Fit::Size(9), 1), Error::Mesh(_)));
    let infinite = cuboid([0.0; 3], [1.0, f64::INFINITY, 1.0]);
    assert!(matches!(refused(&infinite, Fit::Size(9), 1), Error::Mesh(_)));
    let vast = cuboid([-1e308; 3], [1e308; 3]);
    assert!(grid_for(&vast, Fit::Size(9), 1).is_err());
}
