use std::collections::{BTreeMap, BTreeSet};

use proptest::prelude::*;
use shrouds::check::{Component, structure};
use shrouds::{Error, TriMesh};

use crate::shapes::{octahedron, together, torus};

#[test]
fn an_octahedron_is_a_sphere() {
    let found = structure(&octahedron([7.0, 0.0, -1.0], [1.0; 6])).unwrap();
    assert_eq!((found.vertices, found.edges, found.triangles), (6, 12, 8));
    assert_eq!(found.components, [Component { first_triangle: 0, triangles: 8, euler: 2 }]);
    assert!(found.is_closed() && found.non_manifold_vertices.is_empty());
    assert!((found.volume - 4.0 / 3.0).abs() < 1e-12);
    assert!((found.area - 4.0 * 3f64.sqrt()).abs() < 1e-12);
}

#[test]
fn a_torus_has_its_formulas() {
    let found = structure(&torus(400, 200, 3.0, 1.0)).unwrap();
    assert_eq!((found.euler(), found.components.len()), (0, 1));
    assert!(found.is_closed());
    let pi = std::f64::consts::PI;
    assert!((found.volume / (6.0 * pi * pi) - 1.0).abs() < 1e-3);
    assert!((found.area / (12.0 * pi * pi) - 1.0).abs() < 1e-3);
}

#[test]
fn volume_does_not_drown_in_a_far_origin() {
    let found = structure(&octahedron([1e9, -1e9, 1e9], [0.5; 6])).unwrap();
    assert!((found.volume - 1.0 / 6.0).abs() < 1e-12, "{}", found.volume);
}

#[test]
fn broken_meshes_are_named() {
    let whole = octahedron([0.0; 3], [1.0; 6]);
    let mut open = whole.clone();
    let gone = open.triangles.remove(3);
    let found = structure(&open).unwrap();
    assert_eq!((found.boundary_edges.count, found.euler()), (3, 1));
    assert!(found.boundary_edges.first.iter().flatten().all(|v| gone.contains(v)));

    let mut flipped = whole.clone();
    flipped.triangles[0].swap(0, 1);
    let found = structure(&flipped).unwrap();
    assert_eq!((found.inconsistent_edges.count, found.boundary_edges.count), (3, 0));

    let mut doubled = whole.clone();
    doubled.triangles.push(doubled.triangles[5]);
    let found = structure(&doubled).unwrap();
    assert_eq!((found.non_manifold_edges.count, found.non_manifold_vertices.count), (3, 0));

    let mut flat = whole.clone();
    flat.triangles.push([0, 0, 3]);
    flat.vertices.push([0.5, 0.5, 0.0]); // in the middle between vertices 1 and 3
    flat.triangles.push([1, 6, 3]);
    let found = structure(&flat).unwrap();
    assert_eq!(found.degenerate_triangles.first, [8, 9]);
    assert_eq!(found.sliver_triangles.count, 0);

    let mut thin = whole.clone();
    thin.vertices.push([0.5, 0.5, 1e-12]);
    thin.triangles.push([1, 6, 3]);
    let found = structure(&thin).unwrap();
    assert_eq!((found.degenerate_triangles.count, found.sliver_triangles.first), (0, vec![8]));

    let mut turned = whole;
    turned.triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
    assert!(structure(&turned).unwrap().volume < -1.3);
}

#[test]
fn a_bow_tie_is_one_vertex_with_two_fans() {
    let mut tie = together([octahedron([0.0; 3], [1.0; 6]), octahedron([2.0, 0.0, 0.0], [1.0; 6])]);
    // Vertex 6 is the low x end of the second, at the place of vertex 1.
    tie.triangles.iter_mut().flatten().filter(|v| **v == 6).for_each(|v| *v = 1);
    let found = structure(&tie).unwrap();
    assert_eq!(found.non_manifold_vertices.first, [1]);
    assert!(found.is_closed());
    assert_eq!((found.vertices, found.unused_vertices), (11, 1));
    assert_eq!(found.components.iter().map(|c| c.euler).collect::<Vec<_>>(), [2, 2]);
}

#[test]
fn damage_is_an_error() {
    let mut mesh = octahedron([0.0; 3], [1.0; 6]);
    mesh.triangles[2] = [0, 1, 6];
    assert!(matches!(structure(&mesh), Err(Error::Mesh(text)) if text.contains("triangle 2")));
    for x in [f64::NAN, f64::INFINITY, 1e200] {
        let mut mesh = octahedron([0.0; 3], [1.0; 6]);
        mesh.vertices[4][1] = x;
        assert!(matches!(structure(&mesh), Err(Error::Mesh(text)) if text.contains("vertex 4")));
    }
    assert_eq!(structure(&TriMesh::default()).unwrap(), Default::default());
}

/// Sets of numbers that hang together by pairs.
fn classes(
    members: &BTreeSet<usize>,
    linked: impl Fn(usize, usize) -> bool,
) -> Vec<BTreeSet<usize>> {
    let mut rest = members.clone();
    let mut classes = Vec::new();
    while let Some(first) = rest.pop_first() {
        let mut class = BTreeSet::from([first]);
        let mut queue = vec![first];
        while let Some(a) = queue.pop() {
            let near: Vec<usize> = rest.iter().copied().filter(|&b| linked(a, b)).collect();
            for b in near {
                rest.remove(&b);
                class.insert(b);
                queue.push(b);
            }
        }
        classes.push(class);
    }
    classes
}

proptest! {
    #[test]
    fn random_soups_agree_with_sets(
        triangles in prop::collection::vec([0u32..9, 0u32..9, 0u32..9], 0..24),
    ) {
        let vertices = (0..9).map(|n| [f64::from(n), f64::from(n * n), f64::from(n * n * n)]);
        let mesh = TriMesh { vertices: vertices.collect(), triangles, normals: vec![] };
        let proper: BTreeSet<usize> = (0..mesh.triangles.len())
            .filter(|&t| BTreeSet::from(mesh.triangles[t]).len() == 3)
            .collect();
        let mut edges: BTreeMap<[u32; 2], Vec<(usize, bool)>> = BTreeMap::new();
        for &t in &proper {
            let [a, b, c] = mesh.triangles[t];
            for (a, b) in [(a, b), (b, c), (c, a)] {
                edges.entry([a.min(b), a.max(b)]).or_default().push((t, a < b));
            }
        }
        let shared = |a: usize, b: usize| {
            edges.iter().filter(move |(_, list)| {
                [a, b].iter().all(|t| list.iter().any(|entry| entry.0 == *t))
            })
        };
        let found = structure(&mesh).unwrap();
        prop_assert_eq!(found.edges as usize, edges.len());
        let pick = |test: fn(&[(usize, bool)]) -> bool| -> Vec<[u32; 2]> {
            edges.iter().filter(|(_, list)| test(list)).map(|(edge, _)| *edge).collect()
        };
        for (finding, expected) in [
            (&found.boundary_edges, pick(|list| list.len() == 1)),
            (&found.non_manifold_edges, pick(|list| list.len() > 2)),
            (&found.inconsistent_edges, pick(|list| list.len() == 2 && list[0].1 == list[1].1)),
        ] {
            prop_assert_eq!(finding.count as usize, expected.len());
            prop_assert_eq!(&finding.first, &expected[..expected.len().min(8)]);
        }
        let mut pinched = Vec::new();
        let mut used = 0;
        let parts = classes(&proper, |a, b| shared(a, b).next().is_some());
        let mut euler: Vec<i64> = parts.iter().map(|part| part.len() as i64).collect();
        for (edge, list) in &edges {
            prop_assert!(edge[0] < edge[1]);
            euler[parts.iter().position(|part| part.contains(&list[0].0)).unwrap()] -= 1;
        }
        for v in 0..9 {
            let around = proper.iter().copied().filter(|&t| mesh.triangles[t].contains(&v)).collect();
            let fans = classes(&around, |a, b| shared(a, b).any(|(edge, _)| edge.contains(&v)));
            used += u64::from(!fans.is_empty());
            if fans.len() > 1 {
                pinched.push(v);
            }
            for fan in fans {
                euler[parts.iter().position(|part| part.is_superset(&fan)).unwrap()] += 1;
            }
        }
        prop_assert_eq!(found.vertices, used);
        prop_assert_eq!(found.unused_vertices, 9 - used);
        prop_assert_eq!(found.non_manifold_vertices.first, &pinched[..pinched.len().min(8)]);
        let expected: Vec<Component> = parts.iter().zip(euler).map(|(part, euler)| Component {
            first_triangle: *part.first().unwrap() as u32,
            triangles: part.len() as u64,
            euler,
        }).collect();
        prop_assert_eq!(found.components, expected);
    }
}
