//! In which coordinates a mesh goes out, and with how many digits.

use shrouds::{Grid, TriMesh};
use shrouds_io::{Frame, MeshFormat, MeshOptions, Precision};

use crate::args::FrameChoice;

/// Largest relative error of rounding to 32 bits.
const SINGLE: f64 = 1.0 / (1 << 24) as f64;

/// The mesh in voxel indices, normals still pointing out.
pub(crate) fn to_index(mesh: &mut TriMesh, grid: &Grid) {
    let inverse = grid.inverse_affine();
    for vertex in &mut mesh.vertices {
        let p = *vertex;
        *vertex = inverse.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]);
    }
    // Normals are covectors: they go by the transpose of the map from index to world.
    let a = grid.affine();
    for normal in &mut mesh.normals {
        let n = normal.map(f64::from);
        let turned = [0, 1, 2].map(|c| a[0][c] * n[0] + a[1][c] * n[1] + a[2][c] * n[2]);
        let length = turned.iter().map(|x| x * x).sum::<f64>().sqrt();
        let factor = if length > 0.0 { length.recip() } else { 0.0 };
        *normal = turned.map(|x| (factor * x) as f32);
    }
    if grid.is_mirrored() {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
}

/// The frame that the file of the mesh names.
pub(crate) fn name(choice: FrameChoice, world: &Frame) -> Frame {
    match choice {
        FrameChoice::World => world.clone(),
        FrameChoice::Index => {
            Frame { name: "index".into(), unit: "voxel".into(), source: "options" }
        }
    }
}

/// The directions in the patient towards which x, y and z grow: one of R and L, A and P, S and I for
/// each axis, the nearest; nothing where the world is no patient.
pub(crate) fn orientation(grid: &Grid, frame: &Frame) -> Option<String> {
    let signs = match frame.name.as_str() {
        "RAS" => [1.0, 1.0, 1.0],
        "LPS" => [-1.0, -1.0, 1.0],
        "LAS" => [-1.0, 1.0, 1.0],
        _ => return None,
    };
    const LETTERS: [[char; 2]; 3] = [['R', 'L'], ['A', 'P'], ['S', 'I']];
    let (affine, spacing) = (grid.affine(), grid.spacing());
    let cosine = |row: usize, axis: usize| signs[row] * affine[row][axis] / spacing[axis];
    let mut pairs: Vec<(usize, usize)> = (0..9).map(|n| (n / 3, n % 3)).collect();
    pairs.sort_by(|&(a, b), &(c, d)| cosine(c, d).abs().total_cmp(&cosine(a, b).abs()));
    let mut letters = [' '; 3];
    let mut taken = [false; 3];
    for (row, axis) in pairs {
        if letters[axis] == ' ' && !taken[row] {
            letters[axis] = LETTERS[row][usize::from(cosine(row, axis) < 0.0)];
            taken[row] = true;
        }
    }
    Some(letters.iter().collect())
}

/// How to write meshes whose lattice has this smallest spacing, and a warning where the format has
/// too few digits.
pub(crate) fn mesh_options(
    meshes: &[&TriMesh],
    format: MeshFormat,
    frame: Frame,
    min_spacing: f64,
) -> (MeshOptions, Option<String>) {
    let coordinates = meshes.iter().flat_map(|mesh| mesh.vertices.iter().flatten());
    let largest = coordinates.fold(0.0, |max: f64, x| max.max(x.abs()));
    let precision = Precision::needed(largest, min_spacing);
    let coarse = precision == Precision::Double;
    let warning = (coarse && format == MeshFormat::Stl).then(|| {
        let error = largest * SINGLE;
        format!(
            "STL has 32 bits a coordinate, which moves vertices by up to {error:.1e} {} this far from \
             the origin: voxels may change sides; write .ply or .obj instead, or --frame index",
            if frame.unit == "unknown" { "units" } else { &frame.unit }
        )
    });
    (MeshOptions { precision, frame: Some(frame) }, warning)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn index_coordinates_keep_normals_outside() {
        let affine = [[0.0, -2.0, 0.3, 5.0], [1.5, 0.2, 0.0, -7.0], [0.1, 0.0, -0.5, 3.0]];
        for mirror in [1.0, -1.0] {
            let affine = affine.map(|[a, b, c, d]| [a * mirror, b, c, d]);
            let grid = Grid::with_affine([4; 3], affine).unwrap();
            let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
            let mut triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
            if grid.is_mirrored() {
                triangles.iter_mut().for_each(|t| t.swap(1, 2));
            }
            let vertices = corners.map(|c| grid.point(c)).to_vec();
            // The normal of the slanted side x + y + z = 1, in the world.
            let [p, q, r] = [1, 2, 3].map(|v: usize| vertices[v]);
            let [u, v]: [[f64; 3]; 2] = [q, r].map(|x| std::array::from_fn(|k| x[k] - p[k]));
            let sign = if grid.is_mirrored() { -1.0 } else { 1.0 };
            let normal = [
                sign * (u[1] * v[2] - u[2] * v[1]),
                sign * (u[2] * v[0] - u[0] * v[2]),
                sign * (u[0] * v[1] - u[1] * v[0]),
            ];
            let mut mesh =
                TriMesh { vertices, triangles, normals: vec![normal.map(|x| x as f32); 4] };
            assert!(mesh.volume() > 0.0);
            to_index(&mut mesh, &grid);
            for (vertex, corner) in mesh.vertices.iter().flatten().zip(corners.iter().flatten()) {
                assert!((vertex - corner).abs() < 1e-12);
            }
            assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-12);
            let third = 1.0 / 3f32.sqrt();
            assert!(mesh.normals[0].iter().all(|x| (x - third).abs() < 1e-6), "{mirror}");
        }
    }

    #[test]
    fn axes_are_named_after_the_nearest_direction() {
        let affine = [[-0.9, 0.2, 0.1, 12.0], [0.1, 0.3, -1.1, -40.0], [0.2, 2.5, 0.1, 7.5]];
        let grid = Grid::with_affine([4; 3], affine).unwrap();
        let code = |name: &str| {
            let frame = Frame { name: name.into(), unit: "mm".into(), source: "options" };
            orientation(&grid, &frame)
        };
        assert_eq!(code("RAS").as_deref(), Some("LSP"));
        assert_eq!(code("LPS").as_deref(), Some("RSA"));
        assert_eq!(code("index"), None);
    }

    #[test]
    fn digits_follow_the_distance_from_the_origin() {
        let at = |x: f64| TriMesh { vertices: vec![[0.0, -x, 0.0]], ..TriMesh::default() };
        let frame = Frame { name: "RAS".into(), unit: "mm".into(), source: "options" };
        let options = |x, format| mesh_options(&[&at(x)], format, frame.clone(), 1.0);
        let (near, warning) = options(1000.0, MeshFormat::Stl);
        assert_eq!((near.precision, warning), (Precision::Single, None));
        let (far, warning) = options(2000.0, MeshFormat::Ply);
        assert_eq!((far.precision, warning), (Precision::Double, None));
        assert!(options(2000.0, MeshFormat::Stl).1.is_some_and(|text| text.contains(" mm ")));
    }
}
