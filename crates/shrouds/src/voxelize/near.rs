//! The lattice points near holes, where caps say too little.

use std::ops::Range;

use crate::check::Found;
use crate::mesh::TriMesh;
use crate::parallel;
use crate::tree::Tree;
use crate::volume::Occupancy;
use crate::voxelize::rule::Sides;
use crate::voxelize::solid_angle::View;
use crate::voxelize::winding::Lines;

/// Slices per block of parallel work.
const SLICES: usize = 8;
/// Below this, what caps add changes no rounded winding number and raises no doubt.
const HARMLESS: f64 = 0.39;

/// Decides all points near the caps, which are some triangles of `body`, by the generalized winding
/// number; returns the doubtful ones.
pub(super) fn decide(
    body: &TriMesh,
    caps: Range<usize>,
    lines: &Lines,
    sides: Sides,
    volume: &mut Occupancy,
) -> Found<[usize; 3]> {
    let caps = Tree::new(body.triangles[caps].iter().map(|&t| body.corners(t)).collect());
    let [nx, ny, nz] = volume.grid().dims();
    let found = parallel::blocks(nz, SLICES, |slices| {
        let (mut changed, mut doubtful) = (Vec::new(), Found::default());
        let mut visit = |point, solid_angle| {
            let (inside, doubt) = sides.decide(lines.winding(point) as f64 - solid_angle);
            if inside != volume.get(point) {
                changed.push(point);
            }
            if doubt {
                doubtful.push(point);
            }
        };
        let bounds = [[0, 0, slices.start], [nx, ny, slices.end]];
        let view = View::new(position(bounds[0]), position(bounds[1]));
        Search { caps: &caps, near: caps.root(), visit: &mut visit }.visit_near(bounds, &view, 0);
        (changed, doubtful)
    });
    let (changed, doubtful): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    for point in changed.into_iter().flatten() {
        volume.set(point, !volume.get(point));
    }
    Found::gather(doubtful)
}

/// The way down to the points where caps may do harm.
struct Search<'a, F> {
    caps: &'a Tree,
    /// The parts of the caps that are near to the box at hand, after those near to the larger boxes
    /// around it.
    near: Vec<usize>,
    /// Takes a point and the solid angle of all caps seen from there.
    visit: &'a mut F,
}

impl<F: FnMut([usize; 3], f64)> Search<'_, F> {
    /// Visits what there is in a box, from its first point to those before its end. `around` is the view
    /// from a box around it, which leaves out the parts `near[from..]`.
    fn visit_near(&mut self, bounds @ [low, end]: [[usize; 3]; 2], around: &View, from: usize) {
        let mut view = around.within(position(low), position(end.map(|n| n - 1)));
        let own = self.near.len();
        let bound = self.caps.look(&mut view, &mut self.near, from);
        let size = |d: usize| end[d] - low[d];
        let axis = [1, 2].into_iter().fold(0, |a, d| if size(d) > size(a) { d } else { a });
        if bound >= HARMLESS && size(axis) == 1 {
            (self.visit)(low, self.caps.solid_angle(&view, &self.near[own..]));
        } else if bound >= HARMLESS {
            let middle = low[axis] + size(axis) / 2;
            let [mut below, mut above] = [bounds; 2];
            below[1][axis] = middle;
            above[0][axis] = middle;
            self.visit_near(below, &view, own);
            self.visit_near(above, &view, own);
        }
        self.near.truncate(own);
    }
}

fn position(point: [usize; 3]) -> [f64; 3] {
    point.map(|n| n as f64)
}
