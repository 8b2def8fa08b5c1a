//! The parts of a mesh that hang together.

use shrouds::TriMesh;

/// The parts of a mesh whose triangles hang together by vertices, in the order of their first triangles.
///
/// # Panics
/// When a triangle names a vertex that does not exist.
pub fn parts(mesh: &TriMesh) -> Vec<TriMesh> {
    let mut first: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    for &[a, b, c] in &mesh.triangles {
        for other in [b, c] {
            let (x, y) = (find(&mut first, a), find(&mut first, other));
            first[x.max(y) as usize] = x.min(y);
        }
    }
    let mut parts: Vec<TriMesh> = Vec::new();
    // The part of a set, and the place of a vertex in its part.
    let (mut part_of, mut place) = (vec![None; first.len()], vec![None; first.len()]);
    for &triangle in &mesh.triangles {
        let set = find(&mut first, triangle[0]) as usize;
        let number = *part_of[set].get_or_insert_with(|| {
            parts.push(TriMesh::default());
            parts.len() - 1
        });
        let part = &mut parts[number];
        let corners = triangle.map(|v| {
            let v = v as usize;
            *place[v].get_or_insert_with(|| {
                part.vertices.push(mesh.vertices[v]);
                part.normals.extend(mesh.normals.get(v));
                part.vertices.len() as u32 - 1
            })
        });
        part.triangles.push(corners);
    }
    parts
}

/// The first of the set of a vertex; shortens the way for the next time.
fn find(first: &mut [u32], mut v: u32) -> u32 {
    while first[v as usize] != v {
        first[v as usize] = first[first[v as usize] as usize];
        v = first[v as usize];
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_whole_and_apart() {
        let vertices = (0..7).map(|n| [f64::from(n), 0.0, 0.0]).collect();
        let normals = (0..7).map(|n| [n as f32, 0.0, 0.0]).collect();
        let triangles = vec![[6, 5, 4], [0, 1, 2], [2, 1, 3], [4, 5, 6]];
        let found = parts(&TriMesh { vertices, triangles, normals });
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].triangles, [[0, 1, 2], [2, 1, 0]]);
        assert_eq!(found[0].vertices, [[6.0, 0.0, 0.0], [5.0, 0.0, 0.0], [4.0, 0.0, 0.0]]);
        assert_eq!(found[1].triangles, [[0, 1, 2], [2, 1, 3]]);
        assert_eq!(found[1].normals[3], [3.0, 0.0, 0.0]);
        assert!(parts(&TriMesh::default()).is_empty());
    }
}
