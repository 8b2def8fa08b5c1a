//! Points that follow each other on a curve, a junction among them.

use crate::energy::{LANES, Lanes, Stencil};
use crate::materials::network::{Curves, End};
use crate::optimize::Real;

/// Three or four successive points at an end of a curve; of three the last stands twice.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// The place of the second point, a crossing.
    pub(super) place: u32,
    /// The axis normal to the plane.
    pub(super) normal: u8,
    /// The unknowns of all points, of junctions the first ones.
    pub(super) unknowns: [u32; 4],
    kinds: [Kind; 4],
    /// Where their grid edges start, and the faces of junctions, in lattice steps from the first.
    starts: [[i8; 2]; 4],
}

/// How a point moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Along the first or second axis of its plane.
    Along(u8),
    /// Everywhere in its face.
    Junction,
}

impl Window {
    /// The windows of `size` points with junctions at the ends of all curves, by place.
    pub(super) fn all(curves: &Curves, size: usize) -> Vec<Self> {
        let mut windows = Vec::new();
        for ends in &curves.ends {
            let points = (ends[1].place - ends[0].place) as usize + 3;
            if points >= size {
                windows.push(Self::new(curves, ends, 0, size));
            }
            if points > size {
                windows.push(Self::new(curves, ends, points - size, size));
            }
        }
        windows
    }

    /// From point `first` of a curve on, whose first and last points are junctions.
    fn new(curves: &Curves, [start, end]: &[End; 2], first: usize, size: usize) -> Self {
        let last = (end.place - start.place) as usize + 2;
        let place = |point: usize| start.place as usize + point - 1;
        let steps = curves.network.steps();
        let own = place(first + 1);
        let mut window = Self {
            place: own as u32,
            normal: steps[own].normal() as u8,
            unknowns: [0; 4],
            kinds: [Kind::Junction; 4],
            starts: [[0; 2]; 4],
        };
        let mut at = [0; 2];
        for n in 0..4 {
            let point = first + n.min(size - 1);
            if n > 0 && n < size {
                let shift = match point {
                    1 => start.shift.map(|shift| -shift),
                    _ if point == last => end.shift,
                    _ => steps[place(point - 1)].shift(),
                };
                at = [0, 1].map(|axis| at[axis] + shift[axis] as i8);
            }
            window.starts[n] = at;
            let junction = [(0, start), (last, end)].into_iter().find(|(end, _)| *end == point);
            (window.unknowns[n], window.kinds[n]) = match junction {
                Some((_, end)) => (curves.unknown(end.junction) as u32, Kind::Junction),
                None => {
                    let along = u8::from(steps[place(point)].runs_second());
                    (curves.network.vertices()[place(point)], Kind::Along(along))
                }
            };
        }
        window
    }

    pub(super) fn is_junction(&self, point: usize) -> bool {
        self.kinds[point] == Kind::Junction
    }

    /// Where a point lies.
    #[inline(always)]
    pub(super) fn point<R: Real>(&self, point: usize, spacing: &[R; 3], x: &[R]) -> [R; 2] {
        let lengths = plane(spacing, self.normal);
        let unknown = self.unknowns[point] as usize;
        let [a, b] = self.starts[point];
        let (mut u, mut v) = (R::from_i32(a.into()), R::from_i32(b.into()));
        match self.kinds[point] {
            Kind::Along(0) => u = u + x[unknown],
            Kind::Along(_) => v = v + x[unknown],
            Kind::Junction => (u, v) = (u + x[unknown], v + x[unknown + 1]),
        }
        [u * lengths[0], v * lengths[1]]
    }

    /// How a point moves with its first unknown, or a junction with its second.
    #[inline(always)]
    fn moves<R: Real>(&self, point: usize, spacing: &[R; 3], by_second: bool) -> [R; 2] {
        let ([u, v], zero) = (plane(spacing, self.normal), R::default());
        match self.kinds[point] {
            Kind::Junction if by_second => [zero, v],
            _ if by_second => [zero; 2],
            Kind::Along(0) | Kind::Junction => [u, zero],
            Kind::Along(_) => [zero, v],
        }
    }

    /// The points as they move with their first unknowns.
    pub(super) fn stencil<R: Real>(&self, spacing: &[R; 3], x: &[R]) -> Stencil {
        let point = |n| self.point(n, spacing, x).map(R::to_f64);
        let moves = |n| self.moves(n, spacing, false).map(R::to_f64);
        Stencil { points: [0, 1, 2, 3].map(point), moves: [0, 1, 2, 3].map(moves) }
    }

    /// The stencils of some windows side by side.
    pub(super) fn stencils<R: Real>(
        windows: &[Self],
        spacing: &[R; 3],
        x: &[R],
        by_second: bool,
    ) -> Stencil<Lanes<R>> {
        let zeros = [[[R::default(); LANES]; 2]; 4];
        let mut stencils = Stencil { points: zeros, moves: zeros };
        for (lane, window) in windows.iter().enumerate() {
            for point in 0..4 {
                let place = window.point(point, spacing, x);
                let moves = window.moves(point, spacing, by_second);
                for axis in 0..2 {
                    stencils.points[point][axis][lane] = place[axis];
                    stencils.moves[point][axis][lane] = moves[axis];
                }
            }
        }
        stencils
    }

    /// The chords before and after the second point.
    pub(super) fn chords<R: Real>(&self, spacing: &[R; 3], x: &[R]) -> [[R; 2]; 2] {
        let [a, b, c] = [0, 1, 2].map(|point| self.point(point, spacing, x));
        [[b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]]
    }

    /// The slope of the curve over the grid edge of the second point: that of the circle through three
    /// points.
    pub(super) fn slope<R: Real>(&self, spacing: &[R; 3], x: &[R]) -> R {
        let [a, b] = self.chords(spacing, x);
        let (wb, wa) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
        let tangent = [wa * a[0] + wb * b[0], wa * a[1] + wb * b[1]];
        let own = usize::from(self.kinds[1] == Kind::Along(1));
        tangent[own] / tangent[1 - own]
    }
}

#[inline]
fn plane<R: Real>(spacing: &[R; 3], normal: u8) -> [R; 2] {
    let normal = usize::from(normal);
    [spacing[(normal + 1) % 3], spacing[(normal + 2) % 3]]
}
