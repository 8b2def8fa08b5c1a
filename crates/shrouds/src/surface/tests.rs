//! The walks against naive loops over all lattice points, edges, faces and cells.

use std::collections::HashMap;

use super::*;

const CONVENTIONS: [(FaceRule, Border); 4] = [
    (FaceRule::Separate, Border::Closed),
    (FaceRule::Join, Border::Closed),
    (FaceRule::Separate, Border::Open),
    (FaceRule::Join, Border::Open),
];

/// Noise of many sizes and densities: rows end before, at and after word boundaries.
fn volumes() -> impl Iterator<Item = Occupancy> {
    (1..=70).chain([127, 128, 129, 191, 193]).enumerate().map(|(n, nx)| {
        let dims = [nx, 1 + n % 4, 1 + n / 4 % 5];
        let threshold = [1 << 29, 1 << 31, 7 << 29][n % 3];
        let mut state = nx as u64;
        let bits: Vec<bool> = (0..dims.iter().product())
            .map(|_| {
                state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(1);
                state >> 32 < threshold
            })
            .collect();
        let grid = Grid::new(dims, [1.0; 3]).unwrap();
        Occupancy::from_slice(grid, &bits, |inside| inside).unwrap()
    })
}

fn surfaces() -> impl Iterator<Item = Surface> {
    volumes().flat_map(|volume| {
        CONVENTIONS.map(|(rule, border)| (volume.clone(), rule, border)).into_iter().filter_map(
            |(volume, rule, border)| match Surface::extract(&volume, rule, border) {
                Ok(surface) => Some(surface),
                Err(error) => {
                    let flat = volume.grid().dims().contains(&1);
                    assert!(border == Border::Open && flat, "{error}");
                    None
                }
            },
        )
    })
}

/// All grid edges with ends on different sides, by z, then y, then axis, then x.
fn naive_crossings(surface: &Surface) -> Vec<Crossing> {
    let [nx, ny, nz] = surface.grid().dims();
    let mut crossings = Vec::new();
    for k in 0..nz {
        for j in 0..ny {
            for axis in 0..3 {
                for low in (0..nx).map(|i| [i, j, k]) {
                    let mut high = low;
                    high[axis] += 1;
                    if high[axis] == surface.grid().dims()[axis] {
                        continue;
                    }
                    let [a, b] = [low, high].map(|point| surface.volume.get(point));
                    if a != b {
                        crossings.push(Crossing::new(low, axis, a));
                    }
                }
            }
        }
    }
    crossings
}

/// Numbers of the crossings by the low end and the axis of their grid edge.
fn numbers(crossings: &[Crossing]) -> HashMap<([usize; 3], usize), u32> {
    crossings.iter().enumerate().map(|(v, c)| ((c.low(), c.axis()), v as u32)).collect()
}

fn offset(point: [usize; 3], axis: usize, by: usize) -> [usize; 3] {
    let mut point = point;
    point[axis] += by;
    point
}

#[test]
fn crossings_are_those_of_a_naive_scan() {
    for surface in surfaces() {
        let expected = naive_crossings(&surface);
        assert_eq!(surface.vertex_count(), expected.len());
        assert_eq!(surface.crossings().collect::<Vec<_>>(), expected);
        let mut next = 0;
        for k in 0..surface.slice_count() {
            let range = surface.slice_vertices(k);
            assert_eq!(range.start, next, "slices follow each other");
            next = range.end;
            let slice = &expected[range.start as usize..range.end as usize];
            assert_eq!(surface.slice_crossings(k).len(), slice.len());
            assert_eq!(surface.slice_crossings(k).collect::<Vec<_>>(), slice);
            assert!(slice.iter().all(|crossing| crossing.low()[2] == k));
        }
        assert_eq!(next as usize, expected.len());
        for (v, crossing) in expected.iter().enumerate() {
            assert_eq!(surface.crossing(v as u32), *crossing);
        }
    }
}

#[test]
fn patches_are_those_of_a_naive_scan() {
    for surface in surfaces() {
        let numbers = numbers(&surface.crossings().collect::<Vec<_>>());
        let table = cell::table(surface.face_rule);
        let [nx, ny, nz] = surface.grid().dims();
        assert_eq!(surface.layer_count(), nz - 1);
        let mut next = 0;
        let mut triangles = Vec::new();
        for layer in 0..nz - 1 {
            let mut expected = Vec::new();
            for low in (0..ny - 1).flat_map(|j| (0..nx - 1).map(move |i| [i, j, layer])) {
                let corner = |c: usize| (0..3).fold(low, |p, axis| offset(p, axis, c >> axis & 1));
                let corners =
                    (0..8).fold(0, |all, c| all | u8::from(surface.volume.get(corner(c))) << c);
                for shape in table.loops(corners) {
                    let vertex = |edge: &u8| {
                        let (axis, a, b) = (usize::from(edge / 4), edge & 1, edge >> 1 & 1);
                        let p = offset(low, (axis + 1) % 3, usize::from(a));
                        numbers[&(offset(p, (axis + 2) % 3, usize::from(b)), axis)]
                    };
                    let patch: Vec<u32> = shape.edges().iter().map(vertex).collect();
                    triangles.extend(shape.fixed_triangles(&patch));
                    expected.push((patch, std::ptr::from_ref(shape)));
                }
            }
            let mut found = Vec::new();
            surface.for_each_patch(layer, |patch, shape| {
                found.push((patch.to_vec(), std::ptr::from_ref(shape)));
            });
            assert_eq!(found, expected, "layer {layer} of {:?}", surface.grid().dims());
            let range = surface.layer_patches(layer);
            assert_eq!((range.start, range.len()), (next, found.len()));
            next = range.end;
        }
        assert_eq!(next as usize, surface.patch_count());
        assert_eq!(surface.fixed_triangles(), triangles);
    }
}

/// All segments of the lattice faces normal to `normal` that begin in slice `k`, face by face.
fn naive_segments(
    surface: &Surface,
    numbers: &HashMap<([usize; 3], usize), u32>,
    normal: usize,
    k: usize,
) -> Vec<(u32, u32)> {
    let dims = surface.grid().dims();
    let (u, v) = ((normal + 1) % 3, (normal + 2) % 3);
    let mut found = Vec::new();
    for low in (0..dims[1]).flat_map(|j| (0..dims[0]).map(move |i| [i, j, k])) {
        if low[u] + 1 == dims[u] || low[v] + 1 == dims[v] {
            continue;
        }
        let corners =
            [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(a, b)| offset(offset(low, u, a), v, b));
        let edges = [(low, u), (corners[1], v), (corners[3], u), (low, v)];
        let inside = corners.map(|point| surface.volume.get(point));
        for ends in face_rule::segments(inside, surface.face_rule) {
            let [from, to] = ends.map(|edge| numbers[&edges[edge]]);
            found.push((from, to));
        }
    }
    found
}

#[test]
fn segments_are_those_of_a_naive_scan() {
    for surface in surfaces() {
        let numbers = numbers(&surface.crossings().collect::<Vec<_>>());
        for (normal, k) in (0..3).flat_map(|n| (0..surface.slice_count()).map(move |k| (n, k))) {
            let mut found: Vec<(u32, u32)> = Vec::new();
            surface.for_each_segment(normal, k, |segment| found.push(segment.vertices.into()));
            let expected = naive_segments(&surface, &numbers, normal, k);
            assert_eq!(found, expected, "normal {normal}, slice {k}, {:?}", surface.grid().dims());
        }
    }
}

#[test]
fn segments_close_into_curves_and_are_the_sides_of_the_patches() {
    for surface in surfaces().filter(|surface| surface.border() == Border::Closed) {
        let axes: Vec<usize> = surface.crossings().map(Crossing::axis).collect();
        let mut all = Vec::new();
        for normal in 0..3 {
            let (mut out, mut back) = (vec![0; axes.len()], vec![0; axes.len()]);
            for k in 0..surface.slice_count() {
                surface.for_each_segment(normal, k, |segment| {
                    let [from, to] = segment.vertices;
                    out[from as usize] += 1;
                    back[to as usize] += 1;
                    // Each of the two cells at the face has it as a side, in opposite directions.
                    all.extend([(from, to), (to, from)]);
                });
            }
            let expected: Vec<i32> = axes.iter().map(|&axis| (axis != normal).into()).collect();
            assert_eq!((&out, &back), (&expected, &expected));
        }
        let mut sides = Vec::new();
        for layer in 0..surface.layer_count() {
            surface.for_each_patch(layer, |patch, _| {
                let next = patch.iter().cycle().skip(1);
                sides.extend(patch.iter().copied().zip(next.copied()));
            });
        }
        all.sort_unstable();
        sides.sort_unstable();
        assert_eq!(all, sides);
    }
}

#[test]
fn the_surface_is_the_same_on_any_number_of_threads() {
    let [one, three] = [1, 3].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| surfaces().map(|s| (s.fixed_triangles(), s)).collect::<Vec<_>>())
    });
    assert!(one == three);
}
