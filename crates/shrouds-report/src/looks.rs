//! What a mesh looks like in numbers.

use shrouds::TriMesh;

use crate::vector::{Vector, cross, dot, length, sub};

/// Root mean square of the angles between the normals of neighbouring triangles in degrees, weighted
/// with the lengths of their common edges: 0 where all is flat. Triangles without area do not count.
///
/// # Panics
/// When a triangle names a vertex that does not exist.
pub fn roughness(mesh: &TriMesh) -> f64 {
    let normals: Vec<Vector> = mesh.triangles.iter().map(|&t| normal(mesh.corners(t))).collect();
    let mut edges: Vec<([u32; 2], u32)> = Vec::with_capacity(3 * mesh.triangles.len());
    for (t, &[a, b, c]) in mesh.triangles.iter().enumerate() {
        edges.extend([[a, b], [b, c], [c, a]].map(|[u, v]| ([u.min(v), u.max(v)], t as u32)));
    }
    edges.sort_unstable();
    let [mut lengths, mut squares] = [0.0; 2];
    for pair in edges.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
        let [m, n] = [pair[0].1, pair[1].1].map(|t| normals[t as usize]);
        if length(m) == 0.0 || length(n) == 0.0 {
            continue;
        }
        let [from, to] = pair[0].0.map(|v| mesh.vertices[v as usize]);
        let weight = length(sub(to, from));
        let angle = length(cross(m, n)).atan2(dot(m, n));
        lengths += weight;
        squares += weight * angle * angle;
    }
    if lengths > 0.0 { (squares / lengths).sqrt().to_degrees() } else { 0.0 }
}

/// The mean length of the edges, as often as triangles have them; none if all are points.
///
/// # Panics
/// When a triangle names a vertex that does not exist.
pub fn mean_edge(mesh: &TriMesh) -> Option<f64> {
    let around = |[a, b, c]: [Vector; 3]| length(sub(b, a)) + length(sub(c, b)) + length(sub(a, c));
    let sum: f64 = mesh.triangles.iter().map(|&t| around(mesh.corners(t))).sum();
    let mean = sum / (3 * mesh.triangles.len()) as f64;
    (mean > 0.0 && mean.is_finite()).then_some(mean)
}

/// The largest distance of a vertex from the middle of its grid edge, in edge lengths.
pub fn largest_move(delta: &[f64]) -> f64 {
    delta.iter().map(|delta| (delta - 0.5).abs()).fold(0.0, f64::max)
}

/// Root mean square and largest difference between two states of the same vertices.
pub fn difference(one: &[f64], two: &[f64]) -> [f64; 2] {
    let gaps = || one.iter().zip(two).map(|(a, b)| (a - b).abs());
    let squares: f64 = gaps().map(|gap| gap * gap).sum();
    [(squares / one.len().max(1) as f64).sqrt(), gaps().fold(0.0, f64::max)]
}

/// Smallest and largest corner of a box around all points.
pub fn bounds(points: impl IntoIterator<Item = Vector>) -> Option<[Vector; 2]> {
    let wider = |[low, high]: [Vector; 2], p: Vector| {
        [
            std::array::from_fn(|k| f64::min(low[k], p[k])),
            std::array::from_fn(|k| f64::max(high[k], p[k])),
        ]
    };
    let mut points = points.into_iter();
    let first = points.next()?;
    Some(points.fold([first; 2], wider))
}

/// Twice the area long; of any length would do.
fn normal([a, b, c]: [Vector; 3]) -> Vector {
    cross(sub(b, a), sub(c, a))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cube(sides: Vector) -> TriMesh {
        let corner = |n: usize| [n & 1, n >> 1 & 1, n >> 2].map(|bit| bit as f64);
        let place = |n| std::array::from_fn(|k| corner(n)[k] * sides[k]);
        let faces: [[u32; 4]; 6] =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriMesh { vertices: (0..8).map(place).collect(), triangles, normals: vec![] }
    }

    #[test]
    fn a_box_is_as_rough_as_its_edges() {
        let sides = [1f64, 2.0, 5.0];
        let [a, b, c] = sides;
        // Edges of a right angle, and the diagonals of the faces, which are flat.
        let edges = 4.0 * (a + b + c);
        let diagonals = 2.0 * (a.hypot(b) + b.hypot(c) + c.hypot(a));
        let expected = 90.0 * (edges / (edges + diagonals)).sqrt();
        assert!((roughness(&cube(sides)) - expected).abs() < 1e-9);
        assert_eq!(roughness(&TriMesh::default()), 0.0);
        let edges = 4.0 * (a + b + c);
        assert!(
            (mean_edge(&cube(sides)).unwrap() - 2.0 * (edges + diagonals) / 36.0).abs() < 1e-12
        );
        assert_eq!(mean_edge(&TriMesh::default()), None);
        let mut flat = cube(sides);
        flat.vertices.iter_mut().for_each(|v| v[2] = 0.0);
        assert!(roughness(&flat).is_finite());
    }

    #[test]
    fn moves_and_differences_are_those_of_the_numbers() {
        assert_eq!(largest_move(&[0.5, 0.1, 0.7]), 0.4);
        assert_eq!(largest_move(&[]), 0.0);
        assert_eq!(
            difference(&[0.0, 1.0, 0.5, 0.5], &[0.5, 0.5, 0.5, 0.0]),
            [0.1875f64.sqrt(), 0.5]
        );
        assert_eq!(difference(&[], &[]), [0.0; 2]);
        assert_eq!(
            bounds([[1.0, 2.0, 3.0], [0.0, 5.0, 3.0]]),
            Some([[0.0, 2.0, 3.0], [1.0, 5.0, 3.0]])
        );
    }
}
