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
/// Vertices whose arithmetic goes side by side.
const LANES: usize = 8;

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
        let mut fine = self.find(vertices, &mut scratch.places);
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

    /// Finds the places of vertices; returns whether all lie on grid edges, within the volume or one
    /// step out.
    fn find(&self, vertices: &[[f64; 3]], places: &mut Vec<Place>) -> bool {
        let last = self.volume.grid().dims().map(|n| n as f64);
        let mut fine = true;
        for chunk in vertices.chunks(LANES) {
            let mut points = [[0.0; LANES]; 3];
            for (lane, vertex) in chunk.iter().enumerate() {
                (points[0][lane], points[1][lane], points[2][lane]) =
                    (vertex[0], vertex[1], vertex[2]);
            }
            let (mut doubled, mut axis) = ([[0; LANES]; 3], [0; LANES]);
            let (mut count, mut wrong) = ([0; LANES], [false; LANES]);
            for d in 0..3 {
                let row = self.inverse[d];
                for n in 0..LANES {
                    let index = row[0] * points[0][n]
                        + row[1] * points[1][n]
                        + row[2] * points[2][n]
                        + row[3];
                    let low = (index + NEAR).floor();
                    let rest = index - low;
                    let between = rest > NEAR;
                    wrong[n] |= between & !(FAR..=1.0 - FAR).contains(&rest);
                    wrong[n] |= !((low >= -1.0) & (low <= last[d]));
                    doubled[d][n] = 2 * whole(low) + i32::from(between);
                    axis[n] += d as i32 * i32::from(between);
                    count[n] += i32::from(between);
                }
            }
            for lane in 0..chunk.len() {
                fine &= !wrong[lane] & (count[lane] == 1);
                let [x, y, z] = doubled.each_ref().map(|doubled| doubled[lane]);
                places.push([x, y, z, axis[lane]]);
            }
        }
        fine
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
        let mut apart = [0; 4];
        for corners in windows.triangles(window).flatten() {
            let numbers = corners.map(|v| v.wrapping_sub(first) as usize);
            let [a, b, c] = numbers.map(|n| places[n]);
            let mut low = [0; 4];
            for d in 0..4 {
                low[d] = a[d].min(b[d]).min(c[d]) & !1;
                apart[d] |= low[d] + 2 - a[d].max(b[d]).max(c[d]);
            }
            // A corner on the cell's grid edge along x at its low y and z.
            let turns = |p: Place| (p[1] == low[1]) & (p[2] == low[2]) & (p[3] == 0);
            let on_edge = [turns(a), turns(b), turns(c)];
            if !(on_edge[0] | on_edge[1] | on_edge[2]) {
                continue;
            }
            let (v, from, to) = match on_edge {
                [true, _, _] => (numbers[0], b, c),
                [_, true, _] => (numbers[1], c, a),
                _ => (numbers[2], a, b),
            };
            if let Some(turn) = self.turns.get_mut(v.wrapping_sub(offset)) {
                // The half-plane at the low z of the cell, towards its high y.
                let at = |p: Place| (p[2] == low[2]) & (p[1] > low[1]);
                let above = |p: Place| p[2] > low[2];
                *turn += i8::from(at(from) & above(to)) - i8::from(at(to) & above(from));
            }
        }
        // Negative once a corner lay beyond the cell.
        apart[..3].iter().all(|&apart| apart >= 0)
    }
}

/// A whole number far below 2⁵¹, which so stands in the last bits of the sum; unlike a cast this is done
/// side by side.
#[inline(always)]
fn whole(x: f64) -> i32 {
    (x + 6_755_399_441_055_744.0).to_bits() as i32
}

/// Grows in the order of the grid edges by z, y, axis and x, for indices from -1 to 2²⁰.
fn key([x, y, z, axis]: Place) -> i64 {
    let field = |doubled: i32| i64::from((doubled >> 1) + 1);
    field(z) << 44 | field(y) << 23 | i64::from(axis) << 21 | field(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::fans::closed_parts;
    use crate::check::fans::tests::{OBLIQUE, damaged, mesh_of, noise, random};
    use crate::check::{CheckSettings, check, separation};
    use crate::grid::Grid;
    use crate::mesh::MeshKind;
    use crate::volume::{Border, FaceRule, phantom};

    #[test]
    fn vertices_on_grid_edges_go_the_short_way_in_any_frame() {
        for mirror in [1.0, -1.0] {
            let affine = OBLIQUE.map(|[a, b, c, d]| [mirror * a, b, c, d]);
            let grid = Grid::with_affine([20, 18, 150], affine).unwrap();
            for faces in [FaceRule::Separate, FaceRule::Join] {
                let volume = phantom::noise(&grid, 0.4, 5).unwrap();
                let mesh = mesh_of(&volume, faces, MeshKind::Primal);
                assert!(separates(&Windows::new(&mesh).unwrap(), &volume));
            }
        }
    }

    #[test]
    fn what_goes_the_short_way_separates_in_the_long_one_too() {
        let volume = noise([9, 8, 7], 0.4);
        let good = mesh_of(&volume, FaceRule::Separate, MeshKind::Primal);
        let mut below = random(4);
        let mut refused = 0;
        for round in 0..600 {
            let mut mesh = damaged(&good, &mut below);
            let mut volume = volume.clone();
            if round % 3 == 0 {
                // A good mesh of another volume.
                mesh = good.clone();
                let point = volume.grid().dims().map(&mut below);
                volume.set(point, !volume.get(point));
            } else if round % 100 == 1 {
                // Inside out.
                mesh = good.clone();
                mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
            }
            let Some(windows) = Windows::new(&mesh) else { continue };
            if closed_parts(&windows).is_none() {
                continue;
            }
            let long = separation::separation(&mesh, &volume, Border::Closed, 3).unwrap();
            let is_right = !long.inverted
                && long.wrong_side.is_empty()
                && long.odd_winding.is_empty()
                && long.touching.is_empty();
            assert!(!separates(&windows, &volume) || is_right, "round {round}: {long:?}");
            refused += usize::from(!is_right);
        }
        assert!(refused > 150, "{refused} of 600");
    }

    #[test]
    fn reports_are_the_same_either_way() {
        let volume = noise([12, 11, 10], 0.4);
        for kind in [MeshKind::Primal, MeshKind::Dual] {
            let mesh = mesh_of(&volume, FaceRule::Separate, kind);
            let settings = CheckSettings { self_intersections: false, ..CheckSettings::default() };
            let short = check(&mesh, &volume, &settings).unwrap();
            let all = CheckSettings { all_axes: true, ..settings };
            let mut long = check(&mesh, &volume, &all).unwrap();
            long.settings = settings;
            long.separation.axes = 1;
            assert_eq!(short, long);
        }
    }
}
