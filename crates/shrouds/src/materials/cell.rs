//! How the labels share out a cell with three or more of them.
//!
//! The segments on the six faces make a graph on the cell's surface. Where a part of it has no
//! junctions it is a loop, cut into triangles as in a binary volume. A part with junctions is joined
//! to one cell point, the *hub*: every segment with the hub makes a triangle, and the segments' ends
//! at junctions make the lines along which three or more labels meet. Seen from the hub the graph has
//! no crossings, so nor have the triangles, wherever in its faces the junctions lie.
//!
//! A label that lies around the hub in two regions would touch itself there. Then the smaller region
//! is *drawn off*: its segments are joined to a cell point of their own nearer to its corners, and
//! the regions around it reach up to the line between the two points.

use crate::materials::face::{JUNCTION, segments};
use crate::surface::cell::{edge_between, face_corners, loop_shape};
use crate::vector::{Vector, add, cross, dot, length, scale, subtract};
use crate::volume::FaceRule;

/// A point of a cell: 0 to 11 the crossing on that edge, 12 to 17 the junction on face `2·axis + side`,
/// from 18 on the cell points.
pub(super) type Node = u8;

pub(super) const FIRST_JUNCTION: Node = 12;
pub(super) const FIRST_INNER: Node = 18;

/// How far on the way from the hub out of the cell the cell point of a region that is drawn off lies.
const DRAWN: f64 = 0.3;
/// The most directions that are tried for it, and the sine of the angle over all sides that is enough.
const VIEWS: usize = 200;
const WELL_SEEN: f64 = 0.05;

/// A triangle between two labels, counter-clockwise seen from the second.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Triangle {
    pub(super) nodes: [Node; 3],
    pub(super) pair: [u32; 2],
}

/// Where a cell point is to be.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Inner {
    /// The junctions, a bit for each face: the mean of these is the hub.
    junctions: u8,
    /// The corners of the region that was drawn off, a bit for each; none for the hub itself.
    corners: u8,
    /// The nodes around that region, clockwise seen from outside the cell.
    border: Vec<Node>,
}

impl Inner {
    fn hub(junctions: u8) -> Self {
        Self { junctions, corners: 0, border: Vec::new() }
    }

    /// The faces of the two junctions if it joins just these.
    pub(super) fn line(&self) -> Option<[usize; 2]> {
        let ends = [self.junctions.trailing_zeros(), 7 - self.junctions.leading_zeros()];
        (self.corners == 0 && self.junctions.count_ones() == 2).then_some(ends.map(|n| n as usize))
    }

    /// Where it lies in the cell, whose other nodes are at these places.
    ///
    /// A region that is drawn off has its cell point on the way from the hub to where its whole border
    /// can be seen from in one turn: then no triangle crosses another.
    pub(super) fn place(&self, node: impl Fn(Node) -> Vector) -> Vector {
        let junctions = (0..6).filter(|face| self.junctions >> face & 1 == 1);
        let hub = mean(junctions.map(|face| node(FIRST_JUNCTION + face)));
        if self.border.is_empty() {
            return hub;
        }
        let border: Vec<Vector> = self.border.iter().map(|&n| subtract(node(n), hub)).collect();
        let next = border.iter().cycle().skip(1);
        let sides: Vec<Vector> =
            border.iter().zip(next).map(|(&a, &b)| unit(cross(b, a))).collect();
        let corner = |c: usize| subtract([c & 1, c >> 1 & 1, c >> 2 & 1].map(|x| x as f64), hub);
        let corners = (0..8).filter(|c| self.corners >> c & 1 == 1).map(corner);
        let towards = view(&sides, unit(mean(corners)));
        // Where the way leaves the cell.
        let leaves = (0..3).map(|a| match towards[a] {
            step if step > 0.0 => (1.0 - hub[a]) / step,
            step => -hub[a] / step.min(-f64::MIN_POSITIVE),
        });
        add(hub, scale(towards, DRAWN * leaves.fold(f64::INFINITY, f64::min)))
    }
}

/// A direction that turns the same way around all these, if there is one: it starts with a guess and
/// goes on towards the side that is seen worst.
fn view(sides: &[Vector], guess: Vector) -> Vector {
    let worst = |towards: Vector| {
        let seen = sides.iter().map(|&side| (dot(towards, side), side));
        seen.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or_default()
    };
    let (mut towards, mut best) = (guess, (worst(guess).0, guess));
    for _ in 0..VIEWS {
        let (seen, side) = worst(towards);
        if seen > best.0 {
            best = (seen, towards);
        }
        if best.0 > WELL_SEEN {
            break;
        }
        towards = unit(add(towards, scale(side, 0.2)));
    }
    best.1
}

fn unit(vector: Vector) -> Vector {
    scale(vector, 1.0 / length(vector).max(f64::MIN_POSITIVE))
}

fn mean(points: impl Iterator<Item = Vector>) -> Vector {
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for point in points {
        sum = add(sum, point);
        count += 1.0;
    }
    scale(sum, 1.0 / count)
}

/// The triangles and cell points of a cell.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Filling {
    pub(super) triangles: Vec<Triangle>,
    pub(super) inner: Vec<Inner>,
    /// Lines in which three or more labels meet.
    pub(super) lines: Vec<[Node; 2]>,
}

/// A piece of the graph, with the labels on both sides as seen from outside the cell.
#[derive(Debug, Clone, Copy)]
struct Edge {
    ends: [Node; 2],
    right: u32,
    left: u32,
}

impl Filling {
    /// Of a cell with these labels, none of them 0, at its corners.
    pub(super) fn new(labels: [u32; 8], rule: FaceRule) -> Self {
        let mut filling = Self::default();
        let mut rest = graph(labels, rule);
        while let Some(&Edge { ends: [first, _], .. }) = rest.first() {
            let part = take_part(&mut rest, first);
            if part.iter().any(|edge| edge.ends[1] >= FIRST_JUNCTION) {
                filling.join(part, &labels);
            } else {
                filling.cut_loop(&part);
            }
        }
        filling
    }

    fn push(&mut self, apex: Node, Edge { ends: [a, b], right, left }: Edge) {
        let triangle = if right < left {
            Triangle { nodes: [apex, a, b], pair: [right, left] }
        } else {
            Triangle { nodes: [apex, b, a], pair: [left, right] }
        };
        self.triangles.push(triangle);
    }

    /// Cuts a part without junctions into triangles.
    fn cut_loop(&mut self, part: &[Edge]) {
        let Edge { right, left, .. } = part[0];
        let start = part.iter().map(|edge| edge.ends[0]).min().unwrap_or_default();
        let mut corners = vec![start];
        let next = |node| part.iter().find(|edge| edge.ends[0] == node).map(|edge| edge.ends[1]);
        while let Some(node) = next(corners[corners.len() - 1]).filter(|&node| node != start) {
            corners.push(node);
        }
        let shape = loop_shape(corners.clone(), false);
        let triangles = shape.fixed().iter().map(|t| t.map(|n| corners[usize::from(n)]));
        self.triangles.extend(triangles.map(|nodes| Triangle { nodes, pair: [right, left] }));
    }

    /// Joins a part with junctions to cell points.
    fn join(&mut self, mut part: Vec<Edge>, labels: &[u32; 8]) {
        let faces = part.iter().map(|edge| edge.ends[1]).filter(|&end| end >= FIRST_JUNCTION);
        let junctions = faces.fold(0, |bits, end| bits | 1 << (end - FIRST_JUNCTION));
        let hub = FIRST_INNER + self.inner.len() as Node;
        self.inner.push(Inner::hub(junctions));
        while let Some((label, region)) = region_to_draw_off(&part) {
            let apex = FIRST_INNER + self.inner.len() as Node;
            let corners = corners_of(&region, label, labels);
            let border = region.iter().map(|edge| edge.ends[0]).collect();
            self.inner.push(Inner { junctions, corners, border });
            for &edge in &region {
                self.push(apex, edge);
            }
            part = collapsed(&part, &region, label, apex);
            self.line_up(&region, &part, apex);
        }
        for &edge in &part {
            self.push(hub, edge);
        }
        let ends = part.iter().flat_map(|edge| edge.ends);
        let mut branching: Vec<Node> = ends.filter(|&end| end >= FIRST_JUNCTION).collect();
        branching.sort_unstable();
        branching.dedup();
        let is_branching = |&node: &Node| degree(&part, node) > 2;
        self.lines.extend(branching.into_iter().filter(is_branching).map(|node| [node, hub]));
    }

    /// The junction lines from where others meet a region that was drawn off to its cell point.
    fn line_up(&mut self, region: &[Edge], rest: &[Edge], apex: Node) {
        let starts = region.iter().map(|edge| edge.ends[0]);
        let branching = starts.filter(|&node| degree(rest, node) > 0);
        self.lines.extend(branching.map(|node| [node, apex]));
    }
}

fn degree(edges: &[Edge], node: Node) -> usize {
    edges.iter().filter(|edge| edge.ends.contains(&node)).count()
}

/// The segments on all faces of a cell.
fn graph(labels: [u32; 8], rule: FaceRule) -> Vec<Edge> {
    let mut edges = Vec::with_capacity(24);
    for face in 0..6 {
        let corners = face_corners(face / 2, face % 2);
        for segment in segments(corners.map(|c| labels[c]), rule) {
            let ends = segment.ends.map(|end| match end {
                JUNCTION => FIRST_JUNCTION + face as Node,
                edge => edge_between(corners[edge], corners[(edge + 1) % 4]) as Node,
            });
            edges.push(Edge { ends, right: segment.right, left: segment.left });
        }
    }
    edges
}

/// Takes all edges that hang together with a node.
fn take_part(edges: &mut Vec<Edge>, node: Node) -> Vec<Edge> {
    let (mut part, mut known) = (Vec::new(), 1u32 << node);
    loop {
        let before = part.len();
        edges.retain(|edge| {
            let is_part = edge.ends.iter().any(|end| known >> end & 1 == 1);
            if is_part {
                known |= edge.ends.iter().fold(0, |bits, end| bits | 1 << end);
                part.push(*edge);
            }
            !is_part
        });
        if part.len() == before {
            return part;
        }
    }
}

/// The closed border of every region of a label, as edges with the label on the right, each going on
/// from the one before.
fn regions(edges: &[Edge], label: u32) -> Vec<Vec<Edge>> {
    let turned = |edge: &Edge| match label {
        _ if edge.right == label => Some(*edge),
        _ if edge.left == label => {
            let [a, b] = edge.ends;
            Some(Edge { ends: [b, a], right: edge.left, left: edge.right })
        }
        _ => None,
    };
    let mut rest: Vec<Edge> = edges.iter().filter_map(turned).collect();
    let mut found = Vec::new();
    while let Some(first) = rest.pop() {
        let mut border = vec![first];
        // Around a node every label has one sector.
        while let Some(next) =
            rest.iter().position(|edge| edge.ends[0] == border[border.len() - 1].ends[1])
        {
            border.push(rest.swap_remove(next));
        }
        found.push(border);
    }
    found
}

/// A region, with its label, of a label that has several: the smallest one around which no label lies
/// twice.
fn region_to_draw_off(edges: &[Edge]) -> Option<(u32, Vec<Edge>)> {
    let mut labels: Vec<u32> = edges.iter().flat_map(|edge| [edge.right, edge.left]).collect();
    labels.sort_unstable();
    labels.dedup();
    let mut candidates: Vec<(u32, Vec<Edge>)> = Vec::new();
    for label in labels {
        let regions = regions(edges, label);
        if regions.len() > 1 {
            candidates.extend(regions.into_iter().map(|region| (label, region)));
        }
    }
    candidates.retain(|(_, region)| has_different_sides(edges, region));
    candidates.into_iter().min_by_key(|(_, region)| crossings(region).count())
}

fn crossings(region: &[Edge]) -> impl Iterator<Item = Node> {
    region.iter().map(|edge| edge.ends[0]).filter(|&node| node < FIRST_JUNCTION)
}

/// Whether the labels around a region, from one branching to the next, are all different.
fn has_different_sides(edges: &[Edge], region: &[Edge]) -> bool {
    let branching = region.iter().filter(|edge| degree(edges, edge.ends[0]) > 2);
    let mut sides: Vec<u32> = branching.map(|edge| edge.left).collect();
    sides.sort_unstable();
    sides.windows(2).all(|pair| pair[0] != pair[1])
}

/// The corners with this label at the crossings of a region.
fn corners_of(region: &[Edge], label: u32, labels: &[u32; 8]) -> u8 {
    let mut corners = 0;
    for node in crossings(region).map(usize::from) {
        let (axis, a, b) = (node / 4, node & 1, node >> 1 & 1);
        let low = a << ((axis + 1) % 3) | b << ((axis + 2) % 3);
        let of_label = [low, low | 1 << axis].into_iter().filter(|&c| labels[c] == label);
        corners |= of_label.fold(0, |bits, c| bits | 1 << c);
    }
    corners
}

/// The graph as seen from the hub with a region shrunk to its cell point.
fn collapsed(edges: &[Edge], region: &[Edge], label: u32, apex: Node) -> Vec<Edge> {
    let is_border = |edge: &Edge| {
        let [a, b] = edge.ends;
        let same = |other: &Edge| other.ends == [a, b] || other.ends == [b, a];
        (edge.right == label || edge.left == label) && region.iter().any(same)
    };
    let mut rest: Vec<Edge> = edges.iter().filter(|edge| !is_border(edge)).copied().collect();
    let before = region.iter().cycle().skip(region.len() - 1);
    for (before, after) in before.zip(region) {
        let node = after.ends[0];
        if degree(edges, node) > 2 {
            rest.push(Edge { ends: [node, apex], right: before.left, left: after.left });
        }
    }
    rest
}

#[cfg(test)]
mod tests;
