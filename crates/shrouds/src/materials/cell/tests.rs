//! All patterns of labels, up to renaming.

use std::collections::{BTreeMap, BTreeSet};

use super::*;
use crate::materials::span::order;
use crate::random::uniform;

/// All patterns in which the labels appear in the order 1, 2, …: one for each way to share out eight
/// corners.
fn patterns() -> Vec<[u32; 8]> {
    let mut found = vec![([0; 8], 0)];
    for corner in 0..8 {
        found = found
            .into_iter()
            .flat_map(|(labels, most)| {
                (1..=most + 1).map(move |label| {
                    let mut labels: [u32; 8] = labels;
                    labels[corner] = label;
                    (labels, most.max(label))
                })
            })
            .collect();
    }
    found.into_iter().map(|(labels, _)| labels).collect()
}

/// The same pattern with its labels in several orders, which settle the faces with two diagonals.
fn in_many_orders(labels: [u32; 8]) -> Vec<([u32; 8], FaceRule)> {
    let most = labels.iter().copied().max().unwrap();
    let mut orders: Vec<Vec<u32>> = vec![Vec::new()];
    for label in 1..=most {
        let insert = |order: Vec<u32>| {
            let places = if most > 4 { vec![0, order.len()] } else { (0..=order.len()).collect() };
            places
                .into_iter()
                .map(move |place| {
                    let mut order = order.clone();
                    order.insert(place, label);
                    order
                })
                .collect::<Vec<_>>()
        };
        orders = orders.into_iter().flat_map(insert).collect();
    }
    let name = |order: &Vec<u32>| {
        labels.map(|label| order.iter().position(|&l| l == label).unwrap() as u32 + 1)
    };
    let rules = [FaceRule::Separate, FaceRule::Join];
    orders.iter().flat_map(|order| rules.map(|rule| (name(order), rule))).collect()
}

/// The triangles around a label, as it sees them from outside.
fn around(filling: &Filling, label: u32) -> Vec<[Node; 3]> {
    let own = |t: &Triangle| match t.pair {
        [first, _] if first == label => Some(t.nodes),
        [_, second] if second == label => Some([t.nodes[0], t.nodes[2], t.nodes[1]]),
        _ => None,
    };
    filling.triangles.iter().filter_map(own).collect()
}

/// Directed edges of triangles without a partner; every edge has at most one triangle on each side.
fn open_edges(triangles: &[[Node; 3]]) -> BTreeSet<[Node; 2]> {
    let mut open = BTreeSet::new();
    for [a, b, c] in triangles {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            if !open.remove(&[to, from]) {
                assert!(open.insert([from, to]), "edge {from}–{to} is there twice");
            }
        }
    }
    open
}

#[test]
fn there_are_4140_patterns() {
    assert_eq!(patterns().len(), 4140);
}

#[test]
fn every_label_is_bounded_by_manifolds_that_end_in_the_segments_of_the_faces() {
    for (labels, rule) in patterns().into_iter().flat_map(in_many_orders) {
        let filling = Filling::new(labels, rule);
        let segments = graph(labels, rule);
        for label in BTreeSet::from(labels) {
            let triangles = around(&filling, label);
            let mut expected = BTreeSet::new();
            for Edge { ends: [a, b], right, left } in &segments {
                // With the label on the right a triangle has the segment in its own direction.
                if *right == label {
                    expected.insert([*a, *b]);
                } else if *left == label {
                    expected.insert([*b, *a]);
                }
            }
            assert_eq!(open_edges(&triangles), expected, "{labels:?} {rule:?} {label}");
            assert_fans(&triangles, &format!("{labels:?} {rule:?} {label}"));
        }
        for line in &filling.lines {
            let pairs =
                filling.triangles.iter().filter(|t| line.iter().all(|n| t.nodes.contains(n)));
            assert!(pairs.count() > 2, "{labels:?} {line:?}");
        }
    }
}

/// Around every node the triangles make one fan: closed at a cell point, open elsewhere.
fn assert_fans(triangles: &[[Node; 3]], what: &str) {
    let mut links: BTreeMap<Node, Vec<[Node; 2]>> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for (node, link) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            links.entry(node).or_default().push(link);
        }
    }
    for (node, mut links) in links {
        let is_end = |links: &[[Node; 2]], n: usize| links.iter().all(|l| l[1] != links[n][0]);
        let start = (0..links.len()).find(|&n| is_end(&links, n));
        assert_eq!(start.is_none(), node >= FIRST_INNER, "{what} node {node}");
        let [_, mut at] = links.swap_remove(start.unwrap_or(0));
        while let Some(next) = links.iter().position(|l| l[0] == at) {
            at = links.swap_remove(next)[1];
        }
        assert!(links.is_empty(), "{what} node {node}: more than one fan");
    }
}

#[test]
fn two_labels_have_the_loops_of_a_binary_volume() {
    use crate::surface::cell::table;
    for (rule, pattern) in [FaceRule::Separate, FaceRule::Join]
        .into_iter()
        .flat_map(|rule| (1..255u8).map(move |pattern| (rule, pattern)))
    {
        let labels = std::array::from_fn(|c| 2 - u32::from(pattern >> c & 1));
        let mut found: Vec<[Node; 3]> =
            Filling::new(labels, rule).triangles.iter().map(|t| t.nodes).collect();
        let loops = table(rule).loops(pattern).iter();
        let mut expected: Vec<[Node; 3]> = loops
            .flat_map(|l| l.fixed().iter().map(|t| t.map(|n| l.edges()[usize::from(n)])))
            .collect();
        found.sort_unstable();
        expected.sort_unstable();
        assert_eq!(found, expected, "{pattern:08b}");
    }
}

/// Labels of two cells side by side along an axis, at most eight different ones, none of them 0: the
/// corners of the low cell and of the high one, which share a face.
fn neighbours(sample: u64) -> (usize, [[u32; 8]; 2], FaceRule) {
    let number = |n: u64, below: f64| (uniform(sample, n) * below) as u32;
    let (axis, count) = (number(0, 3.0) as usize, f64::from(2 + number(1, 7.0)));
    let rule = if number(2, 2.0) == 0 { FaceRule::Separate } else { FaceRule::Join };
    let layers = [0, 1, 2].map(|n| [0, 1, 2, 3].map(|c| 1 + number(3 + 4 * n + c, count)));
    let cell = |low: usize| {
        std::array::from_fn(|corner: usize| {
            let [side, u, v] = [0, 1, 2].map(|step| corner >> ((axis + step) % 3) & 1);
            layers[low + side][u + 2 * v]
        })
    };
    (axis, [cell(0), cell(1)], rule)
}

/// The node of the high cell that a node of the low one is, if it lies on their common face.
fn beyond(axis: usize, node: Node) -> Option<Node> {
    let along = usize::from(node / 4);
    match node {
        FIRST_INNER.. => None,
        FIRST_JUNCTION.. => (usize::from(node - FIRST_JUNCTION) == 2 * axis + 1).then(|| node - 1),
        _ if along == axis => None,
        // The first bit of an edge is for the axis after its own.
        _ => {
            let bit = if (along + 1) % 3 == axis { 1 } else { 2 };
            (node & bit != 0).then(|| node - bit)
        }
    }
}

/// Checks samples of two cells that share a face: on it both leave the same segments, and around every
/// label the triangles of both are closed across it, each edge once in either direction.
fn judge_neighbours(samples: std::ops::Range<u64>) {
    const HIGH: Node = 32;
    for sample in samples {
        let (axis, cells, rule) = neighbours(sample);
        let fillings = cells.map(|labels| Filling::new(order(labels).0.map(u32::from), rule));
        let ranks = cells.map(|labels| order(labels).1);
        // For every label and node where the directed edges of its triangles lead.
        let mut leads = [[0u64; 64]; 9];
        let mut shared = 0u64;
        for node in 0..FIRST_INNER {
            shared |= u64::from(beyond(axis, node).is_some()) << node;
        }
        let back = |node: Node| (0..FIRST_INNER).find(|&low| beyond(axis, low) == Some(node));
        let names: Vec<Node> = (0..HIGH).map(|n| back(n).unwrap_or(HIGH + n)).collect();
        for (high, (filling, ranks)) in fillings.iter().zip(&ranks).enumerate() {
            for &Triangle { nodes, pair } in &filling.triangles {
                let nodes = nodes.map(|n| if high == 1 { names[usize::from(n)] } else { n });
                for (label, [a, b, c]) in
                    [(pair[0], nodes), (pair[1], [nodes[0], nodes[2], nodes[1]])]
                {
                    let leads = &mut leads[ranks[label as usize] as usize];
                    for [from, to] in [[a, b], [b, c], [c, a]] {
                        let to = 1u64 << to;
                        assert_eq!(leads[usize::from(from)] & to, 0, "{cells:?} {rule:?}: twice");
                        leads[usize::from(from)] |= to;
                    }
                }
            }
        }
        for (label, leads) in leads.iter().enumerate() {
            for (from, &to) in leads.iter().enumerate() {
                // Edges at cell points and on the common face have a triangle on either side.
                let inner = 0x3FFF << FIRST_INNER | 0x3FFF << (HIGH + FIRST_INNER);
                let is_inner = inner >> from & 1 == 1;
                let is_shared = shared >> from & 1 == 1;
                let closed = to
                    & if is_inner { u64::MAX } else { inner | if is_shared { shared } else { 0 } };
                for node in (0..64).filter(|node| closed >> node & 1 == 1) {
                    let is_answered = leads[node] >> from & 1 == 1;
                    assert!(
                        is_answered,
                        "{cells:?} {rule:?}: label {label} is open at {from}–{node}"
                    );
                }
            }
        }
    }
}

#[test]
fn neighbours_agree_on_their_face_and_every_label_is_closed_across_it() {
    crate::parallel::blocks(50, 1, |block| {
        judge_neighbours(1000 * block.start as u64..1000 * block.end as u64);
    });
}

/// The same with a million; the number stands in docs/materials.md.
#[test]
#[ignore = "half a minute"]
fn a_million_neighbours_agree() {
    crate::parallel::blocks(1000, 1, |block| {
        judge_neighbours(1000 * block.start as u64..1000 * block.end as u64);
    });
}
