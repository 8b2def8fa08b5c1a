//! Whether a closed manifold with its vertices on grid edges separates the lattice points: the short
//! way to the separation of a surface whose vertices lie where the volume changes sides.
//!
//! Let every vertex lie on a grid edge of its own, and every triangle have its corners on one cell. A
//! grid edge is an edge of the cube, so that a triangle meets it in the corner it has there, if any,
//! and nowhere else: the mesh crosses the lattice lines at its vertices only. How often it crosses
//! there is how often the fan of the vertex turns around the grid edge, that is how often the fan
//! passes a half-plane bounded by the edge. Where both agree with the bits of the volume along all
//! lines of one direction, from the outside on, every lattice point has the winding number it should.
//!
//! A corner in units of the index is off its grid edge by rounding, at most [`NEAR`], and at least
//! [`FAR`] from lattice points. In the octant of a cell around a lattice point the sum of the
//! coordinates is at least `FAR` at each corner of a triangle, so the triangle stays `FAR / √3` away
//! from the point; that is more than `NEAR` and [`TOUCH`](super::crossing::TOUCH) together, so that
//! rounding changes no winding number and no point is touched.
//!
//! What does not look like this is left to `separation`.

use std::ops::Range;

use crate::check::windows::Windows;
use crate::parallel;
use crate::volume::Occupancy;

/// How far from its grid edge a vertex may lie.
const NEAR: f64 = 1e-6;
/// How far from the ends of its grid edge it must lie.
const FAR: f64 = 2e-4;
/// Windows that share their memory.
const GROUP: usize = 4;

/// Whether the closed manifold is seen at once to separate the points of a volume with a closed
/// border; `false` says nothing.
pub(super) fn separates(windows: &Windows, volume: &Occupancy) -> bool {
    let lattice = Lattice::new(volume);
    let groups = parallel::blocks(windows.count(), GROUP, |group| {
        let mut scratch = Scratch::default();
        group.map(|window| lattice.crossings(windows, window, &mut scratch)).sum::<Option<u64>>()
    });
    let crossings: Option<u64> = groups.into_iter().sum();
    crossings == Some(lattice.switches())
}

/// Where a vertex lies: twice its index along x, y, z, odd along its grid edge, and that axis.
type Place = [i32; 4];

#[derive(Default)]
struct Scratch {
    places: Vec<Place>,
    turns: Vec<i8>,
}

struct Lattice<'a> {
    volume: &'a Occupancy,
    inverse: [[f64; 4]; 3],
    /// The turn of a fan, counter-clockwise in index space, where the volume is left along x.
    leaving: i8,
}

impl<'a> Lattice<'a> {
    fn new(volume: &'a Occupancy) -> Self {
        let grid = volume.grid();
        let leaving = if grid.is_mirrored() { -1 } else { 1 };
        Self { volume, inverse: grid.inverse_affine(), leaving }
    }

    /// How often the volume changes sides along x.
    fn switches(&self) -> u64 {
        let [_, ny, nz] = self.volume.grid().dims();
        let slices = parallel::blocks(nz, 1, |slices| {
            let mut count = 0;
            for (j, k) in slices.flat_map(|k| (0..ny).map(move |j| (j, k))) {
                let mut before = 0;
                for &bits in self.volume.row(j, k) {
                    count += u64::from((bits ^ (bits << 1 | before)).count_ones());
                    before = bits >> 63;
                }
                count += before;
            }
            count
        });
        slices.into_iter().sum()
    }

    /// The number of vertices of a window that lie on grid edges along x; nothing when one of its
    /// vertices or their triangles does not look as it should.
    fn crossings(&self, windows: &Windows, window: usize, scratch: &mut Scratch) -> Option<u64> {
        let own = windows.vertices(window);
        let around = windows.surroundings(window);
        // One more, to compare the first with.
        let around = around.start.min(own.start.saturating_sub(1))..around.end;
        let vertices = &windows.mesh().vertices[around.clone()];
        scratch.places.clear();
        let mut fine = true;
        scratch.places.extend(vertices.iter().map(|&vertex| {
            let (place, found) = self.place(vertex);
            fine &= found;
            place
        }));
        let pairs = scratch.places.windows(2);
        fine &= pairs.fold(true, |fine, pair| fine & (key(pair[0]) < key(pair[1])));
        if !fine || !scratch.turn(windows, window, &around, &own) {
            return None;
        }
        let places = &scratch.places[own.start - around.start..];
        let mut count = 0;
        for (place, &turn) in places.iter().zip(&scratch.turns) {
            if place[3] == 0 {
                fine &= turn != 0 && turn == self.leaving * self.step(place);
                count += 1;
            }
        }
        fine.then_some(count)
    }

    /// The place of a vertex, and whether it lies on a grid edge within the volume or one step out.
    #[inline]
    fn place(&self, vertex: [f64; 3]) -> (Place, bool) {
        let [x, y, z] = vertex;
        let dims = self.volume.grid().dims();
        let (mut place, mut fine) = ([0; 4], true);
        let mut between = 0;
        for d in 0..3 {
            let row = self.inverse[d];
            let index = row[0] * x + row[1] * y + row[2] * z + row[3];
            let low = (index + NEAR).floor();
            let rest = index - low;
            let is_between = rest > NEAR;
            fine &= !is_between || (FAR..=1.0 - FAR).contains(&rest);
            fine &= low >= -1.0 && low <= dims[d] as f64;
            place[d] = 2 * low as i32 + i32::from(is_between);
            place[3] |= if is_between { d as i32 } else { 0 };
            between += i32::from(is_between);
        }
        (place, fine && between == 1)
    }

    /// 1 where the volume is left along this grid edge, which runs along x, -1 where it is entered.
    fn step(&self, &[x, y, z, _]: &Place) -> i8 {
        let [nx, ny, nz] = self.volume.grid().dims();
        let (low, j, k) = (x >> 1, y as usize / 2, z as usize / 2);
        if y < 0 || z < 0 || j >= ny || k >= nz {
            return 0;
        }
        let row = self.volume.row(j, k);
        let inside = |i: i32| {
            i >= 0 && (i as usize) < nx && row[i as usize / 64] >> (i as usize % 64) & 1 == 1
        };
        i8::from(inside(low)) - i8::from(inside(low + 1))
    }
}

impl Scratch {
    /// Counts how often the fans of the window's own vertices turn around a grid edge along x. Returns
    /// whether each of its triangles lies on one cell.
    fn turn(
        &mut self,
        windows: &Windows,
        window: usize,
        around: &Range<usize>,
        own: &Range<usize>,
    ) -> bool {
        self.turns.clear();
        self.turns.resize(own.len(), 0);
        let places = self.places.as_slice();
        let (first, offset) = (around.start as u32, own.start - around.start);
        let mut apart = 0;
        for corners in windows.triangles(window).flatten() {
            let numbers = corners.map(|v| v.wrapping_sub(first) as usize);
            let [a, b, c] = numbers.map(|n| places[n]);
            for d in 0..3 {
                let low = a[d].min(b[d]).min(c[d]);
                let high = a[d].max(b[d]).max(c[d]);
                apart |= i32::from((low & !1) + 2 < high);
            }
            let passed = turns(a, b, c);
            if passed != [0; 4] {
                for (n, passed) in numbers.into_iter().zip(passed) {
                    if let Some(turn) = self.turns.get_mut(n.wrapping_sub(offset)) {
                        *turn += passed as i8;
                    }
                }
            }
        }
        apart == 0
    }
}

/// How often a triangle of a fan around each of its corners, if that is on a grid edge along x, passes
/// the half-plane at the low z of the cell, towards its high y. The last number means nothing.
#[inline]
fn turns(a: Place, b: Place, c: Place) -> [i32; 4] {
    let (y, z) = ([a[1], b[1], c[1], a[1]], [a[2], b[2], c[2], a[2]]);
    let axis = [a[3], b[3], c[3], 1];
    let next = |v: [i32; 4]| [v[1], v[2], v[0], v[1]];
    let (from_y, from_z) = (next(y), next(z));
    let (to_y, to_z) = (next(from_y), next(from_z));
    let mut turns = [0; 4];
    for n in 0..4 {
        let up = (from_z[n] == z[n]) & (from_y[n] > y[n]) & (to_z[n] > z[n]);
        let down = (to_z[n] == z[n]) & (to_y[n] > y[n]) & (from_z[n] > z[n]);
        turns[n] = (i32::from(up) - i32::from(down)) * i32::from(axis[n] == 0);
    }
    turns
}

/// Grows in the order of the grid edges by z, y, axis and x, for indices from -1 to 2²⁰.
fn key([x, y, z, axis]: Place) -> i64 {
    let field = |doubled: i32| i64::from((doubled >> 1) + 1);
    field(z) << 44 | field(y) << 23 | i64::from(axis) << 21 | field(x)
}
