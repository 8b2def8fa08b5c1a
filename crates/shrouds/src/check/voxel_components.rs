//! Components of the inside and the outside lattice points, joined run by run.

use crate::check::FaceRule;
use crate::check::voxel_rows::Rows;

/// Number of components of the outside points and of the inside ones.
pub(super) fn count(rows: &Rows, faces: FaceRule) -> [u64; 2] {
    let mut runs = Runs::new(rows);
    let [_, ny, nz] = rows.dims();
    let diagonal = faces == FaceRule::Join;
    let row = |j: usize, k: usize| k * ny + j;
    for k in 0..nz {
        for j in 0..ny {
            if j + 1 < ny {
                runs.join_side_by_side(row(j, k), row(j + 1, k), diagonal);
            }
            if k + 1 < nz {
                runs.join_side_by_side(row(j, k), row(j, k + 1), diagonal);
            }
            if j + 1 < ny && k + 1 < nz && rows.have_ambiguous_face(j, k) {
                runs.join_across(row(j, k), row(j + 1, k + 1), diagonal);
                runs.join_across(row(j + 1, k), row(j, k + 1), diagonal);
            }
        }
    }
    runs.components()
}

/// Stretches of equal bits along x, with a union-find over them.
struct Runs {
    /// First point of each run.
    starts: Vec<u32>,
    /// Runs of row `r`: `rows[r]..rows[r + 1]`.
    rows: Vec<usize>,
    /// Whether the first run of each row is inside; they alternate.
    inside: Vec<bool>,
    parents: Vec<usize>,
}

/// Two runs of neighbouring rows, one of each, that the walk along the rows has reached.
struct Step {
    runs: [usize; 2],
    inside: [bool; 2],
    /// Whether both end at the same place and both rows go on.
    end_together: bool,
}

impl Runs {
    fn new(rows: &Rows) -> Self {
        let [nx, ny, nz] = rows.dims();
        let mut runs =
            Self { starts: Vec::new(), rows: vec![0], inside: Vec::new(), parents: Vec::new() };
        let mut words = rows.buffer();
        for k in 0..nz {
            for j in 0..ny {
                rows.read(j, k, &mut words);
                runs.add_row(&words, nx);
            }
        }
        runs.parents = (0..runs.starts.len()).collect();
        if rows.are_closed() {
            // The ends of all rows lie in the outside layer and hang together.
            for row in 0..runs.inside.len() {
                let (first, last) = (runs.rows[row], runs.rows[row + 1] - 1);
                (runs.parents[first], runs.parents[last]) = (0, 0);
            }
        }
        runs
    }

    fn add_row(&mut self, words: &[u64], nx: usize) {
        self.inside.push(words[0] & 1 == 1);
        self.starts.push(0);
        let mut before = words[0] & 1;
        for (w, &bits) in words[..nx.div_ceil(64)].iter().enumerate() {
            let mut switched = bits ^ (bits << 1 | before);
            before = bits >> 63;
            while switched != 0 {
                let i = 64 * w + switched.trailing_zeros() as usize;
                if i < nx {
                    self.starts.push(i as u32);
                }
                switched &= switched - 1;
            }
        }
        self.rows.push(self.starts.len());
    }

    /// Rows that are neighbours along y or z: runs of the same side that overlap are joined, and
    /// those of the `diagonal` side also where one begins just where the other ends.
    fn join_side_by_side(&mut self, a: usize, b: usize, diagonal: bool) {
        self.walk(a, b, |runs, step| {
            let [a, b] = step.runs;
            if step.inside[0] == step.inside[1] {
                runs.join(a, b);
            } else if step.end_together && step.inside[0] == diagonal {
                runs.join(a, b + 1);
            } else if step.end_together {
                runs.join(a + 1, b);
            }
        });
    }

    /// Rows that are neighbours across a lattice face in y and z: overlapping runs of the `diagonal`
    /// side are joined. Where the face is not ambiguous they hang together anyway.
    fn join_across(&mut self, a: usize, b: usize, diagonal: bool) {
        self.walk(a, b, |runs, step| {
            if step.inside == [diagonal; 2] {
                runs.join(step.runs[0], step.runs[1]);
            }
        });
    }

    fn walk(&mut self, a: usize, b: usize, mut visit: impl FnMut(&mut Self, Step)) {
        let [mut run_a, mut run_b] = [self.rows[a], self.rows[b]];
        let [end_a, end_b] = [self.rows[a + 1], self.rows[b + 1]];
        if end_a - run_a == 1 && end_b - run_b == 1 && self.parents[run_a] == self.parents[run_b] {
            return;
        }
        let [mut inside_a, mut inside_b] = [self.inside[a], self.inside[b]];
        loop {
            let next_a = if run_a + 1 < end_a { self.starts[run_a + 1] } else { u32::MAX };
            let next_b = if run_b + 1 < end_b { self.starts[run_b + 1] } else { u32::MAX };
            let end_together = next_a == next_b && next_a != u32::MAX;
            let inside = [inside_a, inside_b];
            visit(self, Step { runs: [run_a, run_b], inside, end_together });
            if next_a == u32::MAX && next_b == u32::MAX {
                return;
            }
            if next_a <= next_b {
                run_a += 1;
                inside_a = !inside_a;
            }
            if next_b <= next_a {
                run_b += 1;
                inside_b = !inside_b;
            }
        }
    }

    fn find(&mut self, mut run: usize) -> usize {
        while self.parents[run] != run {
            self.parents[run] = self.parents[self.parents[run]];
            run = self.parents[run];
        }
        run
    }

    fn join(&mut self, a: usize, b: usize) {
        if self.parents[a] == self.parents[b] {
            return;
        }
        let (a, b) = (self.find(a), self.find(b));
        self.parents[a.max(b)] = a.min(b);
    }

    fn components(&self) -> [u64; 2] {
        let mut counts = [0; 2];
        for (row, &first_inside) in self.inside.iter().enumerate() {
            for (place, run) in (self.rows[row]..self.rows[row + 1]).enumerate() {
                if self.parents[run] == run {
                    counts[usize::from(first_inside ^ (place % 2 == 1))] += 1;
                }
            }
        }
        counts
    }
}
