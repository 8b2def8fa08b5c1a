//! The bounds of volume and area hold every separating surface.

#![allow(clippy::unwrap_used)]

mod common;

use common::{CONVENTIONS, volumes};
use proptest::prelude::*;
use shrouds::measure::{Integrals, uncertainty};
use shrouds::mesh::{MeshKind, Triangles, place_vertices};
use shrouds::network::Network;
use shrouds::surface::Surface;
use shrouds::volume::{Border, FaceRule, phantom};
use shrouds::{Grid, Settings, TriMesh, shroud};

/// Bounds of volume and area, each low and high.
fn bounds(surface: &Surface) -> [[f64; 2]; 2] {
    let known = uncertainty(surface, &Integrals::default());
    [known.volume, known.area].map(|span| [span.low, span.high])
}

fn holds([low, high]: [f64; 2], value: f64) -> bool {
    let rounding = 1e-9 * (1.0 + high.abs());
    low - rounding <= value && value <= high + rounding
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_delta_lies_between_them(volume in volumes(), seeds in proptest::collection::vec(0.0..=1.0f64, 97)) {
        for (rule, border) in CONVENTIONS {
            let surface = Surface::extract(&volume, rule, border).unwrap();
            // Every other one at an end.
            let delta: Vec<f64> = (0..surface.vertex_count())
                .map(|v| if v % 2 == 0 { seeds[v % 97] } else { seeds[v % 97].round() })
                .collect();
            let vertices = place_vertices(&surface, &delta);
            let triangles = surface.fixed_triangles();
            let mesh = TriMesh { vertices, triangles, normals: vec![] };
            let [volumes, areas] = bounds(&surface);
            prop_assert!(holds(areas, mesh.area()), "{} in {areas:?}", mesh.area());
            if border == Border::Closed {
                prop_assert!(holds(volumes, mesh.volume()), "{} in {volumes:?}", mesh.volume());
            }
        }
    }

    #[test]
    fn shrouds_lie_between_them(volume in volumes()) {
        for (mesh, triangles) in
            [(MeshKind::Primal, Triangles::Fitted), (MeshKind::Dual, Triangles::Fitted)]
        {
            let shroud = shroud(&volume, &Settings { mesh, triangles, ..Default::default() }).unwrap();
            let [volumes, _] = bounds(&shroud.surface);
            prop_assert!(holds(volumes, shroud.mesh.volume()), "{mesh:?} {volumes:?}");
        }
    }
}

#[test]
fn bounds_of_volume_are_those_of_the_ends() {
    let volume = phantom::linked_tori(24).unwrap();
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    let network = Network::trace(&surface);
    let [low, high] = [1.0, 0.0].map(|delta| {
        let all = vec![delta; surface.vertex_count()];
        TriMesh::place(&surface, &network, &all, MeshKind::Primal, Triangles::Fixed).volume()
    });
    let [[found_low, found_high], _] = bounds(&surface);
    assert!((found_low / low - 1.0).abs() < 1e-9 && (found_high / high - 1.0).abs() < 1e-9);
    assert!(high > 1.5 * low && low > 0.0);
}

/// Looks for surfaces beyond the extreme ones, a vertex at a time: the volume is linear in each.
#[test]
fn no_walk_leaves_the_bounds_of_noise() {
    for seed in 0..20 {
        let volume = phantom::noise(&Grid::new([5; 3], [1.0; 3]).unwrap(), 0.5, seed).unwrap();
        let surface = Surface::extract(&volume, FaceRule::Join, Border::Closed).unwrap();
        let triangles = surface.fixed_triangles();
        let of = |delta: &[f64]| {
            let vertices = place_vertices(&surface, delta);
            TriMesh { vertices, triangles: triangles.clone(), normals: vec![] }.volume()
        };
        let [volumes, _] = bounds(&surface);
        for (start, sign) in [(1.0, 1.0), (0.0, -1.0)] {
            let mut delta = vec![start; surface.vertex_count()];
            let mut best = of(&delta);
            for v in 0..delta.len() {
                delta[v] = 1.0 - start;
                let moved = of(&delta);
                if sign * moved < sign * best { best = moved } else { delta[v] = start }
            }
            assert!(holds(volumes, best), "{best} in {volumes:?}");
        }
    }
}

#[test]
fn a_slab_has_the_area_of_its_faces_at_least() {
    let grid = Grid::new([30, 30, 6], [1.0; 3]).unwrap();
    let volume = phantom::block(&grid, [2, 2, 2], [26, 26, 2]).unwrap();
    let surface = Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap();
    let [_, [low, high]] = bounds(&surface);
    assert!(low >= 2.0 * 25.0 * 25.0 && high < 4.0 * 27.0 * 27.0, "{low} {high}");
}

#[test]
fn bounds_do_not_depend_on_how_the_lattice_lies_in_the_world() {
    let ball = |affine| {
        let grid = Grid::with_affine([14; 3], affine).unwrap();
        let plain = phantom::ball(&Grid::new([14; 3], [1.0; 3]).unwrap(), [6.3, 6.9, 6.6], 4.7);
        let plain = plain.unwrap();
        let volume = shrouds::Occupancy::from_fn(grid, |index| plain.get(index));
        bounds(&Surface::extract(&volume, FaceRule::Separate, Border::Closed).unwrap())
    };
    let plain = ball([[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]);
    for affine in [
        [[0.8, -0.6, 0.0, 1e4], [0.6, 0.8, 0.0, -1e4], [0.0, 0.0, 1.0, 5.0]],
        [[0.8, -0.6, 0.0, 0.0], [-0.6, -0.8, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]],
    ] {
        let turned = ball(affine);
        for (one, other) in plain.as_flattened().iter().zip(turned.as_flattened()) {
            assert!((one / other - 1.0).abs() < 1e-9, "{plain:?} {turned:?}");
        }
    }
}
