//! The nearest lattice point and the network of a mesh, against brute force and broken meshes.

use proptest::prelude::*;
use shrouds::check::{FourNetwork, four_network, nearest_point};
use shrouds::mesh::{MeshKind, Triangles};
use shrouds::volume::{Border, FaceRule};
use shrouds::{Grid, Occupancy, Settings, TriMesh, shroud};

use crate::shapes::{cubic, in_world, random_volume};

const OBLIQUE: [[f64; 4]; 3] =
    [[-0.9, 0.2, 0.1, 12.0], [0.1, 1.1, -0.3, -40.0], [0.2, 0.1, 2.5, 7.5]];

/// Distance of a point from a triangle: the nearest of very many points of it, and by how much the true
/// one can be smaller.
fn sampled_distance(p: [f64; 3], triangle: [[f64; 3]; 3]) -> (f64, f64) {
    const STEPS: u32 = 60;
    let length = |a: [f64; 3], b: [f64; 3]| {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    };
    let [a, b, c] = triangle;
    let mut least = f64::INFINITY;
    for s in 0..=STEPS {
        for t in 0..=STEPS - s {
            let [s, t] = [s, t].map(|n| f64::from(n) / f64::from(STEPS));
            let point = std::array::from_fn(|d| a[d] + s * (b[d] - a[d]) + t * (c[d] - a[d]));
            least = least.min(length(p, point));
        }
    }
    (least, (length(a, b) + length(a, c)) / f64::from(STEPS))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn the_nearest_point_is_that_of_brute_force(
        corners in prop::collection::vec(prop::array::uniform3([-1.0..6.0, -1.0..6.0, -1.0..6.0]), 1..4),
    ) {
        let grid = Grid::with_affine([5, 4, 6], OBLIQUE).unwrap();
        let mut mesh = TriMesh::default();
        for triangle in &corners {
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(*triangle);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        let found = nearest_point(&in_world(mesh.clone(), &grid), &grid, Border::Closed).unwrap();
        let (mut least, mut slack) = (f64::INFINITY, 0.0);
        for n in 0..5 * 4 * 6 {
            let point = [n % 5, n / 5 % 4, n / 20].map(f64::from);
            for &t in &mesh.triangles {
                let (distance, error) = sampled_distance(point, mesh.corners(t));
                if distance < least {
                    (least, slack) = (distance, error);
                }
            }
        }
        match found {
            Some(found) => {
                prop_assert!(found.distance <= least + 1e-9 && found.distance >= least - slack);
                let point = found.index.map(|x| x as f64);
                let away = |&t: &[u32; 3]| sampled_distance(point, mesh.corners(t)).0;
                let nearest = mesh.triangles.iter().map(away).fold(f64::INFINITY, f64::min);
                prop_assert!(nearest >= found.distance - 1e-9 && nearest <= found.distance + slack);
            }
            None => prop_assert!(least >= 0.5 - 1e-9),
        }
    }

    #[test]
    fn primal_meshes_carry_the_network(
        dims in prop::array::uniform3(2usize..7),
        seed: u64,
        density in 0.1..0.9,
        join: bool,
        open: bool,
        fitted: bool,
    ) {
        let bits = random_volume(dims, seed, density);
        let grid = Grid::with_affine(dims, OBLIQUE).unwrap();
        let volume = Occupancy::from_fn(grid, |index| bits.get(index));
        let border = if open { Border::Open } else { Border::Closed };
        let settings = Settings {
            faces: if join { FaceRule::Join } else { FaceRule::Separate },
            border,
            triangles: if fitted { Triangles::Fitted } else { Triangles::Fixed },
            ..Settings::default()
        };
        let mesh = shroud(&volume, &settings).unwrap().mesh;
        let found = four_network(&mesh, &volume, border).unwrap();
        let vertices = mesh.vertices.len() as u64;
        prop_assert_eq!(found, Some(FourNetwork { vertices, wrong_valence: Default::default() }));
    }
}

fn sphere() -> Occupancy {
    Occupancy::from_fn(cubic(12), |index| {
        index.iter().map(|&x| (x as f64 - 5.4).powi(2)).sum::<f64>() < 16.0
    })
}

#[test]
fn other_meshes_carry_no_network() {
    let volume = sphere();
    let network = |mesh: &TriMesh| four_network(mesh, &volume, Border::Closed).unwrap();
    let mesh = shroud(&volume, &Settings::default()).unwrap().mesh;
    assert!(network(&mesh).unwrap().wrong_valence.is_empty());
    let mut off = mesh.clone();
    off.vertices[7].iter_mut().for_each(|x| *x += 0.3);
    assert_eq!(network(&off), None);
    let mut twice = mesh.clone();
    twice.vertices.push(mesh.vertices[3]);
    assert_eq!(network(&twice), None);
    let mut fewer = mesh.clone();
    fewer.vertices.pop();
    let last = fewer.vertices.len() as u32;
    fewer.triangles.retain(|t| !t.contains(&last));
    assert_eq!(network(&fewer), None);
    let dual = Settings { mesh: MeshKind::Dual, ..Settings::default() };
    assert_eq!(network(&shroud(&volume, &dual).unwrap().mesh), None);
    assert_eq!(four_network(&mesh, &random_volume([12; 3], 3, 0.4), Border::Closed).unwrap(), None);
}

#[test]
fn a_torn_mesh_has_vertices_of_another_valence() {
    let volume = sphere();
    let mut mesh = shroud(&volume, &Settings::default()).unwrap().mesh;
    let torn = mesh.triangles.iter().filter(|t| t.contains(&0)).count();
    mesh.triangles.retain(|t| !t.contains(&0));
    let network = four_network(&mesh, &volume, Border::Closed).unwrap().unwrap();
    // The vertex itself and its four neighbours.
    assert!(torn >= 4);
    assert_eq!(network.wrong_valence.count, 5);
    assert_eq!(network.wrong_valence.first[0], 0);
}

#[test]
fn nothing_near_and_damage() {
    let grid = cubic(4);
    let far = TriMesh {
        vertices: vec![[9.0, 0.0, 0.0], [9.0, 1.0, 0.0], [9.0, 0.0, 1.0]],
        triangles: vec![[0, 1, 2]],
        normals: vec![],
    };
    assert_eq!(nearest_point(&far, &grid, Border::Closed).unwrap(), None);
    let dangling = TriMesh { triangles: vec![[0, 1, 9]], ..far };
    assert!(nearest_point(&dangling, &grid, Border::Closed).is_err());
    assert!(four_network(&dangling, &sphere(), Border::Closed).is_err());
}
