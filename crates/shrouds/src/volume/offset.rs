//! Growing and shrinking by a distance.

use crate::error::Error;
use crate::parallel;
use crate::volume::pack::pack_row;
use crate::volume::reach::Ball;
use crate::volume::{Border, Occupancy};

/// Slices that are swept at a time, at least.
const SLICES: usize = 16;
/// Lattice columns that a thread takes at a time.
const BLOCK: usize = 1 << 15;

impl Occupancy {
    /// Grows the volume by `distance` in world units, or shrinks it where `distance` is negative.
    ///
    /// Growing adds every lattice point that lies within the distance of an inside one, and shrinking
    /// removes every one that lies within it of an outside one. Distances are exact Euclidean ones between
    /// lattice points, whatever the spacing; a distance counts as reached when its square exceeds that of
    /// `distance` by no more than a millionth part, so that spacings that a file has rounded to 32 bits
    /// meet their multiples.
    ///
    /// With [`Border::Closed`] the points beyond the lattice are outside and a shrinking volume recedes
    /// from the border; with [`Border::Open`] they are unknown and it does not. The lattice stays, so
    /// what grows ends at its border: [`Occupancy::padded_for`] makes room before.
    ///
    /// Costs some nanoseconds a lattice point for any distance. Beside bits it needs 4 bytes for each
    /// point of as many slices as two distances take, or of 16 slices and one distance.
    ///
    /// The distances are found one axis after another, as by Felzenszwalb and Huttenlocher, *Distance
    /// Transforms of Sampled Functions* (2012).
    ///
    /// # Errors
    /// [`Error::Sheared`] unless the axes are at right angles, [`Error::Setting`] when the distance is not
    /// finite, [`Error::Dimensions`] when the lattice has no room for a layer of outside points.
    pub fn offset(&self, distance: f64, border: Border) -> Result<Self, Error> {
        self.grid().check_right_angles()?;
        check_finite(distance)?;
        if distance > 0.0 {
            return Ok(grown(self, distance));
        }
        let margin = usize::from(border == Border::Closed);
        let outside = grown(&self.padded(margin)?.complement(), -distance);
        let outside = outside.window([margin as isize; 3], Self::empty(self.grid().clone()));
        Ok(self.zip_words(&outside, |inside, outside| inside & !outside))
    }

    /// The same volume with as many layers of outside points as it takes to grow by `distance`, none
    /// where there is room enough.
    ///
    /// # Errors
    /// [`Error::Setting`] when the distance is not finite, otherwise as for [`Occupancy::padded_by`].
    pub fn padded_for(&self, distance: f64) -> Result<Self, Error> {
        check_finite(distance)?;
        let Some(inside) = self.bounding_box() else { return Ok(self.clone()) };
        let steps = Ball::new(self.grid(), distance.max(0.0)).steps();
        self.padded_by(std::array::from_fn(|d| {
            let room = [inside[d].start, self.grid().dims()[d] - inside[d].end];
            room.map(|room| steps[d].saturating_sub(room))
        }))
    }
}

fn check_finite(distance: f64) -> Result<(), Error> {
    if distance.is_finite() {
        return Ok(());
    }
    Err(Error::Setting {
        name: "the distance",
        value: distance.to_string(),
        range: "a finite number",
    })
}

/// The volume and all lattice points within `distance` of it.
///
/// Every slice says of each of its lattice columns how many slices up and down its inside points reach.
/// Two sweeps hand that on from slice to slice, less by one each time, and where anything arrives is
/// inside. The sweeps go through some slices at a time, with those above them that can reach them.
fn grown(volume: &Occupancy, distance: f64) -> Occupancy {
    let grid = volume.grid();
    let [nx, ny, nz] = grid.dims();
    let ball = Ball::new(grid, distance).within(grid.dims());
    let above = ball.steps()[2];
    let own = above.max(SLICES).min(nz);
    let area = nx * ny;
    let mut reach: Vec<u32> = Vec::with_capacity(area * (own + above).min(nz));
    let mut arrived = vec![0; area];
    let mut result = Occupancy::empty(grid.clone());
    for first in (0..nz).step_by(own) {
        let (end, known) = (nz.min(first + own), first + reach.len() / area);
        let top = nz.min(end + above);
        reach.resize(area * (top - first), 0);
        let ends = (known..top).map(|k| (k + 1 - known) * area);
        parallel::pieces(&mut reach[(known - first) * area..], ends, |n, slice| {
            ball.reach_of_slice(volume, known + n, slice);
        });
        // What the upper slices have handed on already does no harm when they do so again.
        for at in (1..top - first).rev().map(|k| k * area) {
            let (lower, upper) = reach.split_at_mut(at);
            hand_on(&upper[..area], &mut lower[at - area..]);
        }
        for slice in reach[..area * (end - first)].chunks_exact_mut(area) {
            hand_on(&arrived, slice);
            arrived.copy_from_slice(slice);
        }
        result.fill_slices(first..end, |j, k, words| {
            let row = ((k - first) * ny + j) * nx;
            pack_row(&reach[row..row + nx], words, |reach, flags| {
                for (flag, &reach) in flags.iter_mut().zip(reach) {
                    *flag = reach > 0;
                }
            });
        });
        reach.drain(..area * (end - first));
    }
    result
}

/// Raises what a slice has to what its neighbour `from` has, less by one.
fn hand_on(from: &[u32], to: &mut [u32]) {
    let ends = (0..to.len().div_ceil(BLOCK)).map(|n| to.len().min((n + 1) * BLOCK));
    parallel::pieces(to, ends.collect::<Vec<_>>(), |n, to| {
        for (to, from) in to.iter_mut().zip(&from[n * BLOCK..]) {
            *to = (*to).max(from.saturating_sub(1));
        }
    });
}
