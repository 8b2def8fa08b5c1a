//! Whether every lattice point lies on its own side of the mesh.
//!
//! The lines of the lattice are followed along an axis; each triangle a line passes through changes
//! the winding number of the lattice points behind it by one. Signs are exact, and every line is
//! shifted by an infinitely small step `(ε, ε²)`, so that a line through a vertex or along an edge
//! counts it once; this matters because the vertices of a separating surface lie *on*
//! lattice lines. The winding number must be 1 at inside points and 0 at outside points.
//!
//! A volume changes sides between two neighbouring lattice points exactly where the mesh must be
//! crossed, so it is enough to compare sorted changes: words without a change cost one comparison.
//! Lines that disagree are then walked point by point.
//!
//! With a closed border all is outside before the first point of a line. With an open one the
//! surface ends at the outermost lattice planes and the first point of each line is taken to be
//! right, so all three axes are needed to tie the lines together.

use crate::check::crossing::{Change, crossings, in_index_coordinates, step};
use crate::check::found::Found;
use crate::check::near::touching_points;
use crate::error::Error;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::volume::Border;
use crate::volume::Occupancy;

/// On which side of the mesh the lattice points lie.
///
/// Where several axes are followed, each count is the largest along any of them; on a closed mesh
/// they agree.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Separation {
    /// Whether the mesh is inside out: its winding numbers are −1 where they should be 1. All that
    /// follows is for the mesh turned over.
    pub inverted: bool,
    /// Lattice points that are inside but have a winding number below 1, or are outside and have
    /// one above 0.
    pub wrong_side: Found<WrongPoint>,
    /// Lattice points whose winding number is neither 0 nor 1.
    pub odd_winding: Found<WrongPoint>,
    /// Lattice points within 1e-4 of the mesh (in units of the index): they lie on neither side and
    /// are never counted above.
    pub touching: Found<[usize; 3]>,
    /// How many axes the lines of the lattice were followed along: 1 or 3.
    pub axes: usize,
}

/// A lattice point and its winding number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct WrongPoint {
    /// Position in the volume's array of lattice points, x fastest.
    pub position: usize,
    /// Index along x, y, z.
    pub index: [usize; 3],
    /// Whether the volume has it inside.
    pub inside: bool,
    /// How often the mesh winds around it.
    pub winding: i64,
}

/// Follows the lines of the lattice along the first `axes` axes.
pub(super) fn separation(
    mesh: &TriMesh,
    volume: &Occupancy,
    border: Border,
    axes: usize,
) -> Result<Separation, Error> {
    let dims = volume.grid().dims();
    let mesh = in_index_coordinates(mesh, volume.grid(), border)?;
    let touching = touching_points(&mesh, dims);
    let lines: Vec<_> = (0..axes).map(|axis| Lines::new(&mesh, volume, border, axis)).collect();
    let disagreeing = |orientation| -> Vec<Vec<u64>> {
        lines.iter().map(|lines| lines.disagreeing(orientation)).collect()
    };
    let count = |lines: &[Vec<u64>]| lines.iter().map(Vec::len).sum::<usize>();
    let upright = disagreeing(1);
    let mut report = Separation { axes, ..Separation::default() };
    for &position in &touching {
        report.touching.push(index_of(position as usize, dims));
    }
    if count(&upright) == 0 {
        return Ok(report);
    }
    let turned = disagreeing(-1);
    report.inverted = count(&turned) < count(&upright);
    let (orientation, disagreeing) = if report.inverted { (-1, turned) } else { (1, upright) };
    for (lines, disagreeing) in lines.iter().zip(&disagreeing) {
        let (wrong_side, odd_winding) = lines.walk(disagreeing, orientation, &touching);
        report.wrong_side = larger(report.wrong_side, wrong_side);
        report.odd_winding = larger(report.odd_winding, odd_winding);
    }
    Ok(report)
}

fn larger(a: Found<WrongPoint>, b: Found<WrongPoint>) -> Found<WrongPoint> {
    if b.count > a.count { b } else { a }
}

pub(super) fn index_of(position: usize, [nx, ny, _]: [usize; 3]) -> [usize; 3] {
    [position % nx, position / nx % ny, position / nx / ny]
}

/// The lines of the lattice along one axis and where the mesh crosses them.
struct Lines<'a> {
    volume: &'a Occupancy,
    border: Border,
    axis: usize,
    /// Sorted; each at the first lattice point behind its crossing.
    changes: Vec<Change>,
}

impl<'a> Lines<'a> {
    fn new(mesh: &TriMesh, volume: &'a Occupancy, border: Border, axis: usize) -> Self {
        let changes = crossings(mesh, axis, volume.grid().dims(), border);
        Self { volume, border, axis, changes }
    }

    /// The lines along which the mesh and the volume disagree, sorted.
    fn disagreeing(&self, orientation: i64) -> Vec<u64> {
        let [nx, ny, nz] = self.volume.grid().dims();
        let slice = (nx * ny) as u64;
        let blocks = parallel::blocks(nz, 1, |slices| {
            let mut lines = Vec::new();
            for k in slices {
                let from = self.changes.partition_point(|&c| c / 2 < k as u64 * slice);
                let mut changes = &self.changes[from..];
                for j in 0..ny {
                    let end = 2 * ((k * ny + j + 1) * nx) as u64;
                    let row = changes.iter().take_while(|&&change| change < end).count();
                    self.compare_row([j, k], &changes[..row], orientation, &mut lines);
                    changes = &changes[row..];
                }
            }
            lines
        });
        let mut lines = blocks.concat();
        lines.sort_unstable();
        lines.dedup();
        lines
    }

    /// Compares the changes of one row of words with those of the volume.
    fn compare_row(
        &self,
        [j, k]: [usize; 2],
        mut changes: &[Change],
        orientation: i64,
        lines: &mut Vec<u64>,
    ) {
        let nx = self.volume.grid().dims()[0];
        let row = self.volume.row(j, k);
        let first = ((k * self.volume.grid().dims()[1] + j) * nx) as u64;
        for (w, &bits) in row.iter().enumerate() {
            let mut switched = self.switched(row, [w, j, k]);
            let end = first + (nx.min(64 * (w + 1))) as u64;
            while switched != 0 || changes.first().is_some_and(|&c| c / 2 < end) {
                let here = first + 64 * w as u64 + u64::from(switched.trailing_zeros());
                let next = changes.first().map_or(u64::MAX, |&c| c / 2);
                let at = if switched == 0 { next } else { here.min(next) };
                let same = changes.iter().take_while(|&&c| c / 2 == at).count();
                let found: i64 = changes[..same].iter().map(|&c| step(c)).sum();
                changes = &changes[same..];
                let i = (at - first) as usize;
                let expected = match switched >> (i % 64) & 1 {
                    0 => 0,
                    _ if bits >> (i % 64) & 1 == 1 => orientation,
                    _ => -orientation,
                };
                switched &= !(1 << (i % 64));
                if found != expected && !self.is_start([i, j, k]) {
                    lines.push(self.line_of([i, j, k]));
                }
            }
        }
    }

    /// Which points of word `w` of row `(j, k)` differ from the point before them on their line.
    fn switched(&self, row: &[u64], [w, j, k]: [usize; 3]) -> u64 {
        let [nx, _, _] = self.volume.grid().dims();
        let valid = if nx >= 64 * (w + 1) { u64::MAX } else { (1 << (nx % 64)) - 1 };
        let start = match self.border {
            Border::Closed => 0,
            Border::Open => row[w],
        };
        let before = match (self.axis, [w, j, k][self.axis]) {
            (0, 0) => row[0] << 1 | start & 1,
            (0, _) => row[w] << 1 | row[w - 1] >> 63,
            (_, 0) => start,
            (1, _) => self.volume.row(j - 1, k)[w],
            _ => self.volume.row(j, k - 1)[w],
        };
        (row[w] ^ before) & valid
    }

    /// Whether a change at this point only says where an open line begins.
    fn is_start(&self, index: [usize; 3]) -> bool {
        self.border == Border::Open && index[self.axis] == 0
    }

    fn line_of(&self, index: [usize; 3]) -> u64 {
        let [low, high] = cross_axes(self.axis);
        (index[high] * self.volume.grid().dims()[low] + index[low]) as u64
    }

    /// Walks these lines and counts the points on the wrong side and those with an odd winding
    /// number, leaving out the `touching` ones.
    fn walk(
        &self,
        lines: &[u64],
        orientation: i64,
        touching: &[u64],
    ) -> (Found<WrongPoint>, Found<WrongPoint>) {
        let dims = self.volume.grid().dims();
        // (place in `lines`, index along the axis, step), in this order.
        let mut changes: Vec<(usize, usize, i64)> = Vec::new();
        for &change in &self.changes {
            let index = index_of((change / 2) as usize, dims);
            if let Ok(line) = lines.binary_search(&self.line_of(index)) {
                changes.push((line, index[self.axis], orientation * step(change)));
            }
        }
        changes.sort_unstable();
        let (mut wrong_side, mut odd_winding) = (Found::default(), Found::default());
        let mut changes = changes.as_slice();
        for (place, &line) in lines.iter().enumerate() {
            let own = changes.partition_point(|change| change.0 <= place);
            self.walk_line(line, &changes[..own], |point| {
                if touching.binary_search(&(point.position as u64)).is_ok() {
                    return;
                }
                if (point.winding > 0) != point.inside {
                    wrong_side.push(point);
                }
                if point.winding != 0 && point.winding != 1 {
                    odd_winding.push(point);
                }
            });
            changes = &changes[own..];
        }
        (wrong_side, odd_winding)
    }

    fn walk_line(
        &self,
        line: u64,
        mut changes: &[(usize, usize, i64)],
        mut visit: impl FnMut(WrongPoint),
    ) {
        let dims = self.volume.grid().dims();
        let [low, high] = cross_axes(self.axis);
        let mut index = [0; 3];
        (index[low], index[high]) = (line as usize % dims[low], line as usize / dims[low]);
        let mut winding = 0;
        for along in 0..dims[self.axis] {
            index[self.axis] = along;
            let inside = self.volume.get(index);
            let here = changes.iter().take_while(|change| change.1 == along).count();
            winding += changes[..here].iter().map(|change| change.2).sum::<i64>();
            changes = &changes[here..];
            if self.is_start(index) {
                winding = i64::from(inside);
            }
            let position = (index[2] * dims[1] + index[1]) * dims[0] + index[0];
            visit(WrongPoint { position, index, inside, winding });
        }
    }
}

/// The two axes across `axis`, the smaller first.
fn cross_axes(axis: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][axis]
}
