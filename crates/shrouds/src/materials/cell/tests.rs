//! All patterns of labels, up to renaming.

use std::collections::{BTreeMap, BTreeSet};

use super::*;

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
