//! Surfaces made chunk by chunk against those made whole.

#![allow(clippy::unwrap_used)]

use std::collections::BTreeMap;

use shrouds::chunks::{Chunk, ChunkMesh, Layout, Passes, Relaxed};
use shrouds::energy::{Energy, Variation};
use shrouds::mesh::Triangles;
use shrouds::optimize::{self, Preset};
use shrouds::volume::{Border, phantom};
use shrouds::{Error, Grid, Occupancy, Settings, TriMesh, shroud};

type Index = [usize; 3];

/// A surface from its chunks, and the δ of its vertices.
struct Joined {
    mesh: TriMesh,
    delta: Vec<f64>,
    /// Of the chunks, in their order.
    parts: Vec<ChunkMesh>,
}

fn in_chunks(volume: &Occupancy, settings: &Settings, edge: usize) -> Joined {
    let layout = Layout::new(volume.grid().clone(), settings.border, edge).unwrap();
    let passes = Passes::new(&settings.optimize).unwrap();
    let voxels = |chunk| volume.crop(layout.voxels(chunk));
    let chunk = |index| Chunk::new(&layout, index, settings.faces, voxels).unwrap();
    let rows: BTreeMap<Index, Vec<u32>> = layout.chunks().map(|c| (c, chunk(c).rows())).collect();
    let shared_rows: BTreeMap<Index, Vec<u32>> =
        layout.chunks().map(|c| (c, chunk(c).shared_rows())).collect();
    let positions = |chunk: &Chunk, c: Index, found: &BTreeMap<Index, Relaxed>| {
        let mut shares = vec![0; chunk.known_count()];
        for other in layout.beside(c) {
            let (rows, found) = (&shared_rows[&other], &found[&other].shares);
            chunk.add(other, rows, found, &mut shares).unwrap();
        }
        chunk.positions(&passes, &shares)
    };
    let count = |c: Index| rows[&c].last().copied().unwrap_or(0);
    let vertices: u64 = layout.chunks().map(|c| u64::from(count(c))).sum();
    let mut found: BTreeMap<Index, Relaxed> = BTreeMap::new();
    for n in 0..passes.count() {
        let sums: Vec<u64> = found.values().map(|relaxed| relaxed.energy).collect();
        let mean = passes.mean_energy(n, &sums, vertices);
        let relax = |c| {
            let chunk = chunk(c);
            let mut x = chunk.start(&passes).unwrap();
            if n > 0 {
                x = positions(&chunk, c, &found);
            }
            (c, chunk.relax(&passes, n, mean, &x))
        };
        found = layout.chunks().map(relax).collect();
    }
    let mut first = 0u64;
    let mut numbers: BTreeMap<Index, Vec<u64>> = BTreeMap::new();
    for c in layout.chunks() {
        numbers.insert(c, (first..first + u64::from(count(c))).collect());
        first += u64::from(count(c));
    }
    let mut joined = Joined { mesh: TriMesh::default(), delta: Vec::new(), parts: Vec::new() };
    for c in layout.chunks() {
        let chunk = chunk(c);
        let x = positions(&chunk, c, &found);
        let mut slopes = vec![[f32::NAN; 2]; x.len()];
        let mut known = vec![u64::MAX; x.len()];
        for other in layout.above(c) {
            let rows = &rows[&other];
            chunk.take(other, rows, &found[&other].slopes, &mut slopes).unwrap();
            chunk.take(other, rows, &numbers[&other], &mut known).unwrap();
        }
        let part = chunk.mesh(&x, &slopes, &known, settings.triangles);
        assert_eq!(part.mesh.triangles.len(), chunk.triangle_count());
        let first = joined.delta.len() as u64;
        let own = part.delta.len();
        joined.mesh.vertices.extend(&part.mesh.vertices[..own]);
        joined.mesh.normals.extend(&part.mesh.normals[..own]);
        joined.delta.extend(&part.delta);
        let number = |v| part.number(v, first) as u32;
        joined.mesh.triangles.extend(part.mesh.triangles.iter().map(|t| t.map(number)));
        joined.parts.push(part);
    }
    joined
}

/// The bits of a position, a normal and a δ.
type Vertex = ([u64; 3], [u32; 3], u64);

/// The vertices sorted, and the triangles with their first vertex first, sorted.
fn canonical(mesh: &TriMesh, delta: &[f64]) -> (Vec<Vertex>, Vec<[usize; 3]>) {
    let vertex = |v: usize| {
        let (position, normal) = (mesh.vertices[v], mesh.normals[v]);
        (position.map(f64::to_bits), normal.map(f32::to_bits), delta[v].to_bits())
    };
    let mut order: Vec<usize> = (0..delta.len()).collect();
    order.sort_by_key(|&v| vertex(v));
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(n, &v)| place[v] = n);
    let turned = |t: &[u32; 3]| {
        let mut t = t.map(|v| place[v as usize]);
        let least = (0..3).min_by_key(|&n| t[n]).unwrap();
        t.rotate_left(least);
        t
    };
    let mut triangles: Vec<[usize; 3]> = mesh.triangles.iter().map(turned).collect();
    triangles.sort_unstable();
    (order.into_iter().map(vertex).collect(), triangles)
}

/// Whether the chunks make the surface that is made whole, to the last bit.
fn assert_equal(volume: &Occupancy, settings: &Settings, edge: usize) {
    let whole = shroud(volume, settings).unwrap();
    assert!(whole.delta.len() > 75_000, "{} vertices are one tile", whole.delta.len());
    let joined = in_chunks(volume, settings, edge);
    assert_eq!(joined.delta.len(), whole.delta.len());
    let whole = canonical(&whole.mesh, &whole.delta);
    let joined = canonical(&joined.mesh, &joined.delta);
    assert!(joined.0 == whole.0, "vertices differ");
    assert!(joined.1 == whole.1, "triangles differ");
}

/// A gyroid in a box that no axis of which is a multiple of a chunk, sheared and mirrored in the world.
fn gyroid_in_a_box() -> Occupancy {
    let volume = phantom::gyroid(150).unwrap();
    let volume = volume.crop([3..140, 0..150, 10..139]).unwrap();
    let affine = [[-0.7, 0.1, 0.0, 3.3], [0.0, 0.9, 0.2, -17.0], [0.1, 0.0, 1.3, 1e3]];
    let grid = Grid::with_affine(volume.grid().dims(), affine).unwrap();
    volume.with_grid(grid).unwrap()
}

#[test]
fn chunks_make_the_same_surface_as_the_whole() {
    let volume = gyroid_in_a_box();
    for border in [Border::Closed, Border::Open] {
        for edge in [128, 256] {
            assert_equal(&volume, &Settings { border, ..Settings::default() }, edge);
        }
    }
}

#[test]
fn so_they_do_for_other_settings() {
    let volume = gyroid_in_a_box();
    let fast = optimize::Settings { preset: Preset::Fast, ..Default::default() };
    assert_equal(&volume, &Settings { optimize: fast, ..Settings::default() }, 128);
    let energy: Option<Energy> = Some(Variation.into());
    let optimize = optimize::Settings { energy, ..Default::default() };
    let triangles = Triangles::Fixed;
    assert_equal(&volume, &Settings { optimize, triangles, ..Settings::default() }, 128);
}

/// Faces along the grid whose terraces reach through many chunks.
#[test]
fn flat_faces_are_known_across_chunks() {
    let grid = Grid::new([200, 190, 150], [1.0; 3]).unwrap();
    let volume = Occupancy::from_fn(grid, |[i, j, k]| {
        let stair = 20 + (i / 67) * 9 + (j / 81) * 3;
        k > 2 && k < 100 + stair && i > 0 && j > 4 && (i + 2 * j) % 150 > 1
    });
    assert_equal(&volume, &Settings::default(), 128);
}

#[test]
fn nothing_in_a_chunk_is_nothing() {
    let grid = Grid::new([258, 128, 129], [1.0; 3]).unwrap();
    let mut volume = Occupancy::empty(grid);
    assert_eq!(in_chunks(&volume, &Settings::default(), 128).mesh, TriMesh::default());
    volume.set([257, 127, 128], true);
    let joined = in_chunks(&volume, &Settings::default(), 128);
    assert_eq!((joined.delta.len(), joined.mesh.triangles.len()), (6, 8));
    assert_eq!(joined.parts.len(), 6);
}

#[test]
fn what_looks_at_the_whole_surface_is_refused() {
    let grid = Grid::new([100; 3], [1.0; 3]).unwrap();
    for edge in [0, 64, 100, 2048] {
        let made = Layout::new(grid.clone(), Border::Closed, edge);
        assert!(matches!(made, Err(Error::Setting { name: "chunk", .. })));
    }
    let refused = |settings: &optimize::Settings| Passes::new(settings).is_err();
    let settings = optimize::Settings::default;
    assert!(!refused(&settings()));
    assert!(refused(&optimize::Settings { preset: Preset::Exact, ..settings() }));
    assert!(refused(&optimize::Settings { volume: optimize::VolumeRule::Keep, ..settings() }));
    assert!(refused(&optimize::Settings { crease: Some(Default::default()), ..settings() }));
    assert!(refused(&optimize::Settings { start: optimize::Start::Random(1), ..settings() }));
    assert!(refused(&optimize::Settings { solver: optimize::Solver::Sweeps, ..settings() }));
}

#[test]
fn values_of_other_voxels_are_refused() {
    let volume = gyroid_in_a_box();
    let layout = Layout::new(volume.grid().clone(), Border::Closed, 128).unwrap();
    let voxels = |chunk| volume.crop(layout.voxels(chunk));
    let chunk = Chunk::new(&layout, [0; 3], Default::default(), voxels).unwrap();
    let (rows, mut known) = (chunk.rows(), vec![0.0f32; chunk.known_count()]);
    let values = vec![0.0; *rows.last().unwrap() as usize];
    assert_eq!(chunk.take([0; 3], &rows, &values, &mut known), Ok(()));
    let short = chunk.take([0; 3], &rows, &values[1..], &mut known);
    assert_eq!(short, Err(Error::Chunk { chunk: [0; 3] }));
    let rows = &rows[..rows.len() / 2];
    assert!(chunk.take([0; 3], rows, &values, &mut known).is_err());
    let wrong = |_| volume.crop([0..10, 0..10, 0..10]);
    assert!(matches!(
        Chunk::new(&layout, [0; 3], Default::default(), wrong).err(),
        Some(Error::Length { .. })
    ));
}

#[test]
fn halved_chunks_are_the_halved_volume() {
    let grid = Grid::new([300, 140, 129], [1.0, 2.0, 3.0]).unwrap();
    let volume = Occupancy::from_fn(grid.clone(), |[i, j, k]| (i * j + k * k) % 7 < 3);
    let layout = Layout::new(grid, Border::Closed, 128).unwrap();
    assert_eq!((layout.counts(), layout.levels()), ([3, 2, 2], 3));
    let (halved, whole) = (layout.halved().unwrap(), volume.halved().unwrap());
    assert_eq!((halved.counts(), halved.grid()), ([2, 1, 1], whole.grid()));
    for chunk in halved.chunks() {
        let voxels = |part| volume.crop(layout.voxels(part));
        let part = layout.halved_voxels(chunk, voxels).unwrap();
        assert_eq!(part, whole.crop(halved.voxels(chunk)).unwrap());
    }
}
