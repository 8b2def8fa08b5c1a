//! Step by step: grow, cut, intersect.

use std::time::Instant;

use crate::containment::annulus;
use crate::containment::cells::with_neighbours;
use crate::containment::scene::Scene;
use crate::containment::track::Array;
use crate::error::Error;
use crate::volume::{Border, Occupancy, Operation};

/// Which lattice points belong to a region.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Membership {
    /// Those at which the target can be.
    #[default]
    Centre,
    /// Those in whose cells it can be, boxes as large as the spacing: the one-sided mode. Then every place at
    /// which the target can be lies in a cell of the region, and a shroud of [`Step::enclosing`] contains it.
    Cell,
}

/// What is known after a contact.
#[derive(Debug, Clone)]
pub struct Step {
    /// Index of the contact.
    pub contact: usize,
    /// Its time, in seconds.
    pub time: f64,
    /// The array at that time.
    pub array: Array,
    /// Lattice points that the region had before the contact, grown since the one before and cut by surface and
    /// floor.
    pub grown: u64,
    /// Where the target can be.
    pub region: Occupancy,
    /// Seconds it took to grow the region and to intersect it.
    pub seconds: [f64; 2],
}

/// A region in numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Lattice points.
    pub points: u64,
    /// Their number times the volume of a cell, in cubic metres.
    pub volume: f64,
    /// Smallest x, y, z of its lattice points.
    pub low: [f64; 3],
    /// Largest x, y, z of its lattice points.
    pub high: [f64; 3],
    /// Their mean.
    pub centroid: [f64; 3],
}

/// The steps of a scene, one for each contact, until a region is empty.
#[derive(Debug)]
pub struct Steps<'a> {
    scene: &'a Scene,
    membership: Membership,
    water: Occupancy,
    region: Occupancy,
    next: usize,
}

impl<'a> Steps<'a> {
    pub(super) fn new(scene: &'a Scene, membership: Membership) -> Self {
        let water = scene.sea().water(membership);
        Self { scene, membership, region: water.clone(), water, next: 0 }
    }

    fn step(&mut self, array: Array) -> Result<Step, Error> {
        let contact = self.scene.contacts()[self.next];
        let start = Instant::now();
        if let Some(before) = self.next.checked_sub(1) {
            let elapsed = contact.time - self.scene.contacts()[before].time;
            self.grow(elapsed * self.scene.target_speed())?;
        }
        let middle = Instant::now();
        let grown = self.region.count();
        let heard = contact.heard(array);
        self.region = annulus::intersect(&self.region, self.scene.sea(), &heard, self.membership)?;
        let seconds = [(middle - start).as_secs_f64(), middle.elapsed().as_secs_f64()];
        let region = self.region.clone();
        Ok(Step { contact: self.next, time: contact.time, array, grown, region, seconds })
    }

    /// Grows the region by a distance as far as there is water.
    fn grow(&mut self, distance: f64) -> Result<(), Error> {
        let Some(inside) = self.region.bounding_box() else { return Ok(()) };
        if distance <= 0.0 {
            return Ok(());
        }
        let (dims, spacing) = (self.region.grid().dims(), self.region.grid().spacing());
        // Casts saturate.
        let ranges: [_; 3] = std::array::from_fn(|d| {
            let reach = ((distance / spacing[d]) as usize).saturating_add(2);
            inside[d].start.saturating_sub(reach)..inside[d].end.saturating_add(reach).min(dims[d])
        });
        let mut part = self.region.crop(ranges.clone())?;
        if self.membership == Membership::Cell {
            part = with_neighbours(&part);
        }
        let grown = part.offset(distance, Border::Closed)?;
        let margins = std::array::from_fn(|d| [ranges[d].start, dims[d] - ranges[d].end]);
        let grown = grown.padded_by(margins)?.with_grid(self.water.grid().clone())?;
        self.region = self.water.combine(Operation::Intersect, &grown)?;
        Ok(())
    }
}

impl Iterator for Steps<'_> {
    type Item = Result<Step, Error>;

    /// The next step. After one whose region is empty, and after an error, there are no more.
    fn next(&mut self) -> Option<Self::Item> {
        let count = self.scene.contacts().len();
        if self.next >= count {
            return None;
        }
        let step = self.scene.array(self.next).map(|array| self.step(array))?;
        let goes_on = step.as_ref().is_ok_and(|step| !step.is_empty());
        self.next = if goes_on { self.next + 1 } else { count };
        Some(step)
    }
}

impl Step {
    /// Whether there is no place left at which the target could be: the contact contradicts those before it.
    pub fn is_empty(&self) -> bool {
        self.region.bounding_box().is_none()
    }

    /// The volume whose separating surfaces contain the cells of the region's lattice points: the region with
    /// all neighbours of its points, on a lattice with one more layer all around.
    ///
    /// Whatever the places of its vertices on their grid edges, a separating surface passes only through boxes between
    /// eight lattice points of which some are inside and some outside. The eight such boxes around a point of the
    /// region have all their corners inside, so that the surface keeps out of them: the point's cell, and
    /// the boxes as a whole, twice as wide, are enclosed.
    ///
    /// # Errors
    /// [`Error::Dimensions`] or [`Error::Memory`] when the lattice cannot have one more layer.
    pub fn enclosing(&self) -> Result<Occupancy, Error> {
        Ok(with_neighbours(&self.region.padded(1)?))
    }
}

impl Extent {
    /// The numbers of a region; none where it is empty.
    pub fn of(region: &Occupancy) -> Option<Self> {
        let bounds = region.bounding_box()?;
        let grid = region.grid();
        let points = region.count();
        let [_, ys, zs] = bounds.clone();
        let mut sums = [0u64; 3];
        for (j, k) in zs.flat_map(|k| ys.clone().map(move |j| (j, k))) {
            let (mut count, mut sum) = (0, 0);
            for (word, bits) in region.row(j, k).iter().enumerate() {
                let ones = u64::from(bits.count_ones());
                (count, sum) = (count + ones, sum + 64 * word as u64 * ones + sum_of_places(*bits));
            }
            sums = [sums[0] + sum, sums[1] + j as u64 * count, sums[2] + k as u64 * count];
        }
        let corner = |end: fn(&std::ops::Range<usize>) -> usize| {
            grid.point(std::array::from_fn(|d| end(&bounds[d]) as f64))
        };
        Some(Self {
            points,
            volume: points as f64 * grid.voxel_volume(),
            low: corner(|range| range.start),
            high: corner(|range| range.end - 1),
            centroid: grid.point(sums.map(|sum| sum as f64 / points as f64)),
        })
    }
}

/// The sum of the places of the bits of a word, 0 to 63: place by place of their binary digits.
fn sum_of_places(bits: u64) -> u64 {
    const WITH_DIGIT: [u64; 6] = [
        0xaaaa_aaaa_aaaa_aaaa,
        0xcccc_cccc_cccc_cccc,
        0xf0f0_f0f0_f0f0_f0f0,
        0xff00_ff00_ff00_ff00,
        0xffff_0000_ffff_0000,
        0xffff_ffff_0000_0000,
    ];
    let digits = WITH_DIGIT.iter().enumerate();
    digits.map(|(digit, with)| u64::from((bits & with).count_ones()) << digit).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::volume::phantom::noise;

    #[test]
    fn numbers_of_a_region_are_those_of_its_points() {
        let affine = [[2.0, 0.0, 0.0, 5.0], [0.0, 3.0, 0.0, -7.0], [0.0, 0.0, 0.5, -40.0]];
        let grid = Grid::with_affine([131, 7, 5], affine).unwrap();
        let mut region = noise(&grid, 0.2, 3).unwrap();
        (0..131 * 5).for_each(|n| region.set([n % 131, 6, n / 131], false));
        let extent = Extent::of(&region).unwrap();
        let points: Vec<[f64; 3]> = (0..grid.point_count())
            .map(|n| [n % 131, n / 131 % 7, n / 917])
            .filter(|index| region.get(*index))
            .map(|index| grid.point(index.map(|n| n as f64)))
            .collect();
        assert_eq!(extent.points, points.len() as u64);
        assert!((extent.volume - 3.0 * points.len() as f64).abs() < 1e-6);
        for d in 0..3 {
            let of_axis = || points.iter().map(|point| point[d]);
            assert_eq!(extent.low[d], of_axis().fold(f64::INFINITY, f64::min));
            assert_eq!(extent.high[d], of_axis().fold(f64::NEG_INFINITY, f64::max));
            let mean = of_axis().sum::<f64>() / points.len() as f64;
            assert!((extent.centroid[d] - mean).abs() < 1e-9);
        }
        assert_eq!(Extent::of(&Occupancy::empty(grid)), None);
    }
}
