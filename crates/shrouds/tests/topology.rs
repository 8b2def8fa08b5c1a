//! Crossings, patches and the network on random volumes, every convention.

mod common;

use common::{CONVENTIONS, volumes};
use proptest::prelude::*;
use shrouds::Occupancy;
use shrouds::network::Network;
use shrouds::surface::Surface;
use shrouds::volume::Border;

/// Grid edges with ends on different sides, counted point by point.
fn count_crossings(volume: &Occupancy, border: Border) -> usize {
    let dims = volume.grid().dims().map(|n| n as isize);
    let inside = |p: [isize; 3]| -> Option<bool> {
        let within = (0..3).all(|d| (0..dims[d]).contains(&p[d]));
        match (within, border) {
            (true, _) => Some(volume.get(p.map(|x| x as usize))),
            (false, Border::Closed) => Some(false),
            (false, Border::Open) => None,
        }
    };
    let mut count = 0;
    for k in -1..=dims[2] {
        for j in -1..=dims[1] {
            for i in -1..=dims[0] {
                for axis in 0..3 {
                    let low = [i, j, k];
                    let mut high = low;
                    high[axis] += 1;
                    if let (Some(a), Some(b)) = (inside(low), inside(high)) {
                        count += usize::from(a != b);
                    }
                }
            }
        }
    }
    count
}

proptest! {
    #[test]
    fn every_crossing_carries_one_vertex_and_theorem_1_holds(volume in volumes()) {
        for (rule, border) in CONVENTIONS {
            let surface = Surface::extract(&volume, rule, border).unwrap();
            prop_assert_eq!(surface.vertex_count(), count_crossings(&volume, border));
            for crossing in surface.crossings() {
                let margin = usize::from(border == Border::Closed);
                let side = |p: [usize; 3]| {
                    let dims = volume.grid().dims();
                    let within = (0..3).all(|d| p[d] >= margin && p[d] - margin < dims[d]);
                    within && volume.get(p.map(|x| x - margin))
                };
                prop_assert!(side(crossing.inside()) && !side(crossing.outside()));
            }
            let network = Network::trace(&surface);
            let report = network.check(&surface);
            prop_assert!(report.holds(), "{:?} {:?}: {:?}", rule, border, report);
            if border == Border::Closed {
                prop_assert_eq!(report.valence_four, report.vertices);
            }
            // Equation 8: any two families of curves hold every vertex.
            let curves = network.curves().collect::<Vec<_>>();
            for skipped in 0..3 {
                let mut seen = vec![0; surface.vertex_count()];
                for curve in curves.iter().filter(|curve| curve.axis != skipped) {
                    curve.vertices.iter().for_each(|&v| seen[v as usize] += 1);
                }
                prop_assert!(seen.iter().all(|&n| n == 1 || n == 2));
            }
            prop_assert_eq!(
                curves.iter().map(|c| c.vertices.len()).sum::<usize>(),
                2 * surface.vertex_count()
            );
            prop_assert!(border == Border::Open || curves.iter().all(|c| c.closed));
        }
    }

    #[test]
    fn patches_close_into_an_oriented_manifold(volume in volumes()) {
        for (rule, border) in CONVENTIONS {
            let surface = Surface::extract(&volume, rule, border).unwrap();
            let mut edges: Vec<(u32, u32)> = surface
                .fixed_triangles()
                .iter()
                .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
                .collect();
            edges.sort_unstable();
            prop_assert!(edges.windows(2).all(|w| w[0] != w[1]), "an edge is used twice one way");
            if border == Border::Closed {
                prop_assert!(edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok()));
            }
        }
    }
}

#[test]
fn an_empty_volume_has_an_empty_surface_and_a_full_one_a_box() {
    let grid = shrouds::Grid::new([70, 3, 2], [1.0; 3]).unwrap();
    for (rule, border) in CONVENTIONS {
        let empty = Surface::extract(&Occupancy::empty(grid.clone()), rule, border).unwrap();
        assert_eq!((empty.vertex_count(), empty.patch_count()), (0, 0));
        let full = Occupancy::from_fn(grid.clone(), |_| true);
        let surface = Surface::extract(&full, rule, border).unwrap();
        let faces = 2 * (70 * 3 + 3 * 2 + 2 * 70);
        assert_eq!(surface.vertex_count(), if border == Border::Closed { faces } else { 0 });
    }
}
