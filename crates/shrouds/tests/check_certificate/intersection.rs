use proptest::prelude::*;
use shrouds::TriMesh;
use shrouds::check::{CheckSettings, Found, check};

use crate::shapes::{octahedron, random_volume, together, torus};

fn intersections(mesh: &TriMesh) -> Found<[u32; 2]> {
    let volume = random_volume([2, 2, 2], 0, 0.5);
    let report = check(mesh, &volume, &CheckSettings::default()).expect("a sound mesh");
    report.self_intersections.expect("looked for by default")
}

fn mesh(vertices: &[[i64; 3]], triangles: &[[u32; 3]]) -> TriMesh {
    TriMesh {
        vertices: vertices.iter().map(|p| p.map(|x| x as f64)).collect(),
        triangles: triangles.to_vec(),
        normals: vec![],
    }
}

#[test]
fn pairs_made_by_hand() {
    let pairs = |vertices: &[[i64; 3]], triangles: &[[u32; 3]]| {
        intersections(&mesh(vertices, triangles)).count
    };
    let base = [[0, 0, 0], [4, 0, 0], [0, 4, 0]];
    let with = |more: &[[i64; 3]]| [&base[..], more].concat();
    let apart = [[0, 1, 2], [3, 4, 5]];
    assert_eq!(pairs(&with(&[[1, 1, -1], [1, 1, 1], [9, 9, 1]]), &apart), 1, "pierced");
    assert_eq!(pairs(&with(&[[1, 1, 0], [1, 2, 3], [2, 1, 3]]), &apart), 1, "touched by a corner");
    assert_eq!(pairs(&with(&[[4, 4, -1], [4, 4, 1], [9, 9, 1]]), &apart), 0, "passed by");
    assert_eq!(pairs(&with(&[[1, 1, 0], [2, 1, 0], [1, 2, 0]]), &apart), 1, "inside, flat");
    assert_eq!(pairs(&with(&[[3, 3, 0], [4, 3, 0], [3, 4, 0]]), &apart), 0, "beside, flat");
    assert_eq!(pairs(&with(&[[4, 0, 0], [0, 4, 0], [4, 4, 0]]), &apart), 1, "edge on edge");
    let edge = [[0, 1, 2], [1, 0, 3]];
    assert_eq!(pairs(&with(&[[1, -1, 0]]), &edge), 0, "unfolded");
    assert_eq!(pairs(&with(&[[1, 1, 1]]), &edge), 0, "hinged");
    assert_eq!(pairs(&with(&[[1, 1, 0]]), &edge), 1, "folded");
    let corner = [[0, 1, 2], [0, 3, 4]];
    assert_eq!(pairs(&with(&[[-1, 0, 0], [0, -1, 0]]), &corner), 0, "opposite corners, flat");
    assert_eq!(pairs(&with(&[[1, 1, 0], [-1, 1, 0]]), &corner), 1, "overlapping corners, flat");
    assert_eq!(pairs(&with(&[[8, 8, 1], [8, 8, -1]]), &corner), 1, "through the far edge");
    assert_eq!(pairs(&with(&[[-1, -1, 1], [-1, -1, -1]]), &corner), 0, "away from each other");
    assert_eq!(pairs(&with(&[[8, 0, 0], [8, 0, 1]]), &corner), 1, "along an edge");
    assert_eq!(pairs(&base, &[[0, 1, 2], [2, 1, 0]]), 1, "twice the same");
}

#[test]
fn good_meshes_have_none() {
    assert_eq!(intersections(&torus(60, 40, 3.0, 1.0)).count, 0);
    let grid =
        (0..1000).map(|n| octahedron([n % 10, n / 10 % 10, n / 100].map(f64::from), [0.49; 6]));
    assert_eq!(intersections(&together(grid)).count, 0);
}

#[test]
fn linked_and_overlapping_parts_are_told_apart() {
    let ring = torus(50, 20, 3.0, 0.5);
    let moved = |by: f64| {
        let mut other = ring.clone();
        other.vertices.iter_mut().for_each(|p| *p = [p[0] + by, -p[2], p[1]]);
        intersections(&together([ring.clone(), other])).count
    };
    assert_eq!(moved(3.0), 0, "linked");
    assert!(moved(0.5) > 0, "running into each other");
}

#[test]
fn one_large_triangle_among_many_small_ones() {
    let mut soup: Vec<TriMesh> =
        (0..4096).map(|n| octahedron([n % 64, n / 64, 0].map(f64::from), [0.3; 6])).collect();
    let large = TriMesh {
        vertices: vec![[-9.0, 20.1, -50.0], [79.0, 20.1, -50.0], [30.0, 20.1, 900.0]],
        triangles: vec![[0, 1, 2]],
        normals: vec![],
    };
    soup.push(large);
    let found = intersections(&together(soup));
    // It cuts the four triangles on the +y half of row 20 of every octahedron it reaches.
    assert_eq!(found.count, 64 * 4);
    assert!(found.first.iter().all(|pair| pair[1] == 4096 * 8));
    assert_eq!(found.first[0][0] / 8, 20 * 64);
}

type V = [i128; 3];
fn sub(a: V, b: V) -> V {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
fn cross(u: V, v: V) -> V {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}
fn dot(u: V, v: V) -> i128 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}
fn normal(t: &[V; 3]) -> V {
    cross(sub(t[1], t[0]), sub(t[2], t[0]))
}

/// Separating axes in whole numbers; the second triangle may be a segment.
fn meet(a: &[V; 3], b: &[V; 3]) -> bool {
    let edges = |t: &[V; 3]| [sub(t[1], t[0]), sub(t[2], t[1]), sub(t[0], t[2])];
    let mut axes = vec![normal(a), normal(b)];
    for e in edges(a) {
        axes.extend(edges(b).map(|f| cross(e, f)));
    }
    for n in [normal(a), normal(b)] {
        axes.extend(edges(a).into_iter().chain(edges(b)).map(|e| cross(n, e)));
    }
    axes.iter().all(|&axis| {
        let [a, b] = [a, b].map(|t| t.map(|p| dot(p, axis)));
        a.iter().max() >= b.iter().min() && b.iter().max() >= a.iter().min()
    })
}

/// The oracle: like the definition, with the opposite edge against the whole cone at a shared corner.
fn meet_again(points: &[V], s: [u32; 3], t: [u32; 3]) -> bool {
    let at = |v: u32| points[v as usize];
    let shared: Vec<u32> = s.into_iter().filter(|v| t.contains(v)).collect();
    let rest =
        |own: [u32; 3]| own.into_iter().filter(|v| !shared.contains(v)).map(at).collect::<Vec<V>>();
    let (a, b) = (rest(s), rest(t));
    match shared.len() {
        0 => meet(&s.map(at), &t.map(at)),
        1 => {
            let o = at(shared[0]);
            let far = |p: V| sub(p, o).map(|x| x * 1_000_000);
            let cone = [[0; 3], far(b[0]), far(b[1])];
            let (p, q) = (sub(a[0], o), sub(a[1], o));
            meet(&cone, &[p, q, q])
        }
        2 => {
            let (o, e) = (at(shared[0]), sub(at(shared[1]), at(shared[0])));
            let (n, m) = (cross(e, sub(a[0], o)), cross(e, sub(b[0], o)));
            cross(n, m) == [0; 3] && dot(n, m) > 0
        }
        _ => true,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]
    #[test]
    fn random_soups_agree_with_separating_axes(
        mut points in prop::collection::vec([0i64..6, 0i64..6, 0i64..6], 6..60),
        flat: bool,
        picks in prop::collection::vec([0usize..1000, 0usize..1000, 0usize..1000], 2..40),
    ) {
        if flat {
            // Most triangles in one plane, which is across no axis.
            points.iter_mut().for_each(|p| p[2] = p[0] + p[1] + i64::from(p[2] == 0));
        }
        let exact: Vec<V> = points.iter().map(|p| p.map(i128::from)).collect();
        let triangles: Vec<[u32; 3]> =
            picks.iter().map(|pick| pick.map(|n| (n % points.len()) as u32)).collect();
        let proper = |t: &[u32; 3]| normal(&t.map(|v| exact[v as usize])) != [0; 3];
        let mut expected = Vec::new();
        for (m, s) in triangles.iter().enumerate().filter(|(_, s)| proper(s)) {
            for (n, t) in triangles.iter().enumerate().skip(m + 1).filter(|(_, t)| proper(t)) {
                if meet_again(&exact, *s, *t) {
                    expected.push([m as u32, n as u32]);
                }
            }
        }
        let found = intersections(&mesh(&points, &triangles));
        prop_assert_eq!(found.count as usize, expected.len());
        prop_assert_eq!(&found.first, &expected[..expected.len().min(8)]);
    }
}
