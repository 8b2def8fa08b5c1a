//! The topology of the separating surface, from the bits alone.
//!
//! Inside points hang together along grid edges, and under [`FaceRule::Join`] also across a lattice
//! face whose other two corners are outside. Outside points do the same under
//! [`FaceRule::Separate`]. Nothing hangs together across the body diagonal of a cell.
//!
//! Each component of the surface is the border between one inside and one outside component, and
//! these form a tree, so with a closed border
//!
//! > surface components = inside components + outside components − 1.
//!
//! The Euler characteristic of the inside region R adds up over the open cells of the lattice. A
//! point counts 1 when inside; an edge −1 when both ends are; a face 1 when all corners are and −1
//! when it is ambiguous and joined; a cell the number of outside components among its corners less
//! one, because every loop of the surface on its boundary is filled by a disc. All other cells
//! count 0: R leaves out one arc of an edge or face for each piece it has there. Then
//!
//! > χ(surface) = 2 χ(R) − χ(R ∩ border of the box),
//!
//! the last term only with an open border, where R ends at the outermost lattice planes.

use crate::check::voxel_rows::Rows;
use crate::parallel;
use crate::volume::Occupancy;
use crate::volume::{Border, FaceRule};

/// What the topology of the separating surface of a volume must be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct VoxelTopology {
    /// Components of the inside points.
    pub inside_components: u64,
    /// Components of the outside points; with a closed border, of these and the surroundings.
    pub outside_components: u64,
    /// Components of the surface; unknown with an open border.
    pub surface_components: Option<u64>,
    /// Euler characteristic of the surface, all components together.
    pub euler: i64,
}

/// Counts components and Euler characteristic of the surface that separates the inside lattice
/// points from the outside ones, without making it.
///
/// ```
/// use shrouds::{Grid, Occupancy, check::voxel_topology, volume::{Border, FaceRule}};
///
/// let grid = Grid::new([2, 2, 1], [1.0; 3])?;
/// let diagonal = Occupancy::from_fn(grid, |[i, j, _]| i == j);
/// let apart = voxel_topology(&diagonal, Border::Closed, FaceRule::Separate);
/// assert_eq!((apart.surface_components, apart.euler), (Some(2), 4));
/// let joined = voxel_topology(&diagonal, Border::Closed, FaceRule::Join);
/// assert_eq!((joined.surface_components, joined.euler), (Some(1), 2));
/// # Ok::<(), shrouds::Error>(())
/// ```
pub fn voxel_topology(volume: &Occupancy, border: Border, faces: FaceRule) -> VoxelTopology {
    let rows = Rows::new(volume, border);
    let [outside_components, inside_components] = super::voxel_components::count(&rows, faces);
    let surfaces = match inside_components {
        0 => 0,
        _ => inside_components + outside_components - 1,
    };
    let border_euler = match border {
        Border::Closed => 0,
        Border::Open => euler_of_border(&rows, faces),
    };
    VoxelTopology {
        inside_components,
        outside_components,
        surface_components: (border == Border::Closed).then_some(surfaces),
        euler: 2 * euler_of_region(&rows, faces) - border_euler,
    }
}

/// χ(R).
fn euler_of_region(rows: &Rows, faces: FaceRule) -> i64 {
    let table = cell_table(faces);
    let [nx, ny, nz] = rows.dims();
    let slices = parallel::blocks(nz, 1, |slices| {
        let mut buffers = [0; 4].map(|_| rows.buffer());
        let mut sum = 0;
        for k in slices {
            let [here, next, above, next_above] = &mut buffers;
            rows.read(0, k, next);
            rows.read(0, k + 1, next_above);
            for j in 0..ny {
                std::mem::swap(here, next);
                std::mem::swap(above, next_above);
                rows.read(j + 1, k, next);
                rows.read(j + 1, k + 1, next_above);
                let cells = if j + 1 < ny && k + 1 < nz { nx - 1 } else { 0 };
                for w in 0..nx.div_ceil(64) {
                    let four = [&*here, &*next, &*above, &*next_above]
                        .map(|row| [row[w], row[w] >> 1 | row[w + 1] << 63]);
                    sum += word_euler(&four, low_bits(cells.saturating_sub(64 * w)), faces, &table);
                }
            }
        }
        sum
    });
    slices.into_iter().sum()
}

/// A word with so many of its low bits set.
pub(super) fn low_bits(count: usize) -> u64 {
    if count >= 64 { u64::MAX } else { (1 << count) - 1 }
}

/// What 64 points of a row count, with the edges, faces and cells behind them. `rows` are those at
/// `(j, k)`, `(j + 1, k)`, `(j, k + 1)`, `(j + 1, k + 1)`, each at `i` and at `i + 1`; missing points
/// are outside, which makes no edge or face count. `cells` marks the cells that exist.
fn word_euler(rows: &[[u64; 2]; 4], cells: u64, faces: FaceRule, table: &[i64; 256]) -> i64 {
    let corners = rows.as_flattened();
    let any = corners.iter().fold(0, |any, bits| any | bits);
    if any == 0 {
        return 0;
    }
    let count = |bits: u64| i64::from(bits.count_ones());
    let [[a, ax], [b, bx], [c, cx], [d, _]] = *rows;
    let mut sum = count(a) - count(a & ax) - count(a & b) - count(a & c);
    for [p, q, r, s] in [[a, ax, b, bx], [a, ax, c, cx], [a, b, c, d]] {
        sum += count(p & q & r & s);
        if faces == FaceRule::Join {
            sum -= count((p ^ q) & (r ^ s) & (p ^ r));
        }
    }
    let all = corners.iter().fold(u64::MAX, |all, bits| all & bits);
    sum -= count(all & cells);
    let mut mixed = any & !all & cells;
    while mixed != 0 {
        let i = mixed.trailing_zeros();
        let inside = (0..8).fold(0, |inside, n| inside | (corners[n] >> i & 1) << n);
        sum += table[inside as usize];
        mixed &= mixed - 1;
    }
    sum
}

/// What a cell counts, by the bits of its corners: corner `x + 2y + 4z` is bit `x + 2y + 4z`.
fn cell_table(faces: FaceRule) -> [i64; 256] {
    std::array::from_fn(|inside| {
        // Across a face that is not ambiguous two outside corners hang together anyway.
        let reach = if faces == FaceRule::Separate { 2 } else { 1 };
        let mut rest = !inside as u8;
        let mut components = 0;
        while rest != 0 {
            let mut component = 1u8 << rest.trailing_zeros();
            loop {
                let near = |n: &u32| {
                    (0..8u32).any(|m| component >> m & 1 == 1 && (n ^ m).count_ones() <= reach)
                };
                let grown = (0..8).filter(near).fold(0, |bits, n| bits | 1 << n) & rest;
                if grown == component {
                    break;
                }
                component = grown;
            }
            rest &= !component;
            components += 1;
        }
        components - 1
    })
}

/// χ(R ∩ border of the box): its six sides, less its twelve edges, more its eight corners.
fn euler_of_border(rows: &Rows, faces: FaceRule) -> i64 {
    let mut sum = 0;
    for part in 1..27 {
        // Per axis: 0 runs along it, 1 is pinned to its first plane, 2 to its last.
        let pins = [part % 3, part / 3 % 3, part / 9];
        let free: Vec<usize> = (0..3).filter(|&d| pins[d] == 0).collect();
        let length = |n: usize| free.get(n).map_or(1, |&d| rows.dims()[d]);
        let inside = |u: usize, v: usize| {
            let mut index = [0, 1, 2].map(|d| if pins[d] == 2 { rows.dims()[d] - 1 } else { 0 });
            free.iter().zip([u, v]).for_each(|(&d, x)| index[d] = x);
            rows.get(index)
        };
        let part = euler_of_rectangle([length(0), length(1)], inside, faces);
        sum += if free.len() == 1 { -part } else { part };
    }
    sum
}

fn euler_of_rectangle(
    [nu, nv]: [usize; 2],
    inside: impl Fn(usize, usize) -> bool,
    faces: FaceRule,
) -> i64 {
    let at = |u: usize, v: usize| u < nu && v < nv && inside(u, v);
    let mut sum = 0;
    for v in 0..nv {
        for u in 0..nu {
            let [a, b, c, d] = [at(u, v), at(u + 1, v), at(u, v + 1), at(u + 1, v + 1)];
            let ambiguous = faces == FaceRule::Join && a != b && c != d && a != c;
            sum += i64::from(a) - i64::from(a && b) - i64::from(a && c);
            sum += i64::from(a && b && c && d) - i64::from(ambiguous);
        }
    }
    sum
}
