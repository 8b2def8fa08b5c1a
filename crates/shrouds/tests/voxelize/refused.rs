//! What is no mesh, or no lattice that fits into memory.

use shrouds::voxelize::{Method, Rule};
use shrouds::{Error, Grid, TriMesh, voxelize};

use crate::shapes::{cubic, cuboid, mesh};

#[test]
fn damaged_meshes_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, 1e200] {
        let body = cuboid([0.0; 3], [1.0, bad, 1.0]);
        assert!(matches!(voxelize(&body, &cubic(3), Rule::NonZero), Err(Error::Mesh(_))));
    }
    let dangling = mesh(vec![[0.0; 3]; 2], vec![[0, 1, 2]]);
    assert!(matches!(voxelize(&dangling, &cubic(3), Rule::NonZero), Err(Error::Mesh(_))));
    // Fine in the world, too far away in steps of the grid.
    let grid = Grid::new([3; 3], [1e-80; 3]).unwrap();
    let far = cuboid([0.0; 3], [1e30; 3]);
    assert!(matches!(voxelize(&far, &grid, Rule::NonZero), Err(Error::Mesh(_))));
}

#[test]
fn lattices_beyond_memory_are_refused_before_they_are_made() {
    let grid = Grid::new([Grid::MAX_DIM; 3], [1.0; 3]).unwrap();
    let refused = voxelize(&cuboid([0.0; 3], [1.0; 3]), &grid, Rule::NonZero).unwrap_err();
    assert!(matches!(refused, Error::Memory { .. }) && refused.to_string().contains("bytes"));
}

#[test]
fn nothing_is_empty() {
    let none = voxelize(&TriMesh::default(), &cubic(5), Rule::NonZero).unwrap();
    assert_eq!((none.volume.count(), none.report.method), (0, Method::Exact));
    assert!(none.report.is_closed() && none.report.notes().is_empty());
    let edge = mesh(vec![[0.0; 3], [4.0; 3]], vec![[0, 1, 0], [1, 1, 1]]);
    assert_eq!(voxelize(&edge, &cubic(5), Rule::NonZero).unwrap().volume.count(), 0);
    // A triangle by itself winds around nothing more than half.
    let flat = mesh(vec![[0.0; 3], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], vec![[0, 1, 2]]);
    let found = voxelize(&flat, &cubic(5), Rule::NonZero).unwrap();
    assert_eq!(found.report.boundary_edges.count, 3);
}
