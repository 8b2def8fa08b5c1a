//! The same volume with fewer and fewer points, for what is looked at from afar.

use crate::chunks::Layout;
use crate::error::Error;
use crate::volume::Occupancy;

impl Layout {
    /// Half as many points along each axis ([`Grid::halved`](crate::Grid::halved)), in chunks of as many
    /// voxels, each of which holds what up to eight chunks of this layout hold.
    ///
    /// # Errors
    /// [`Error::NoCells`] when an open border leaves no cell.
    pub fn halved(&self) -> Result<Self, Error> {
        Self::new(self.grid().halved()?, self.border(), self.edge())
    }

    /// How many layouts there are, this one and those halved from it, until one chunk holds all or an open
    /// border leaves no cell.
    pub fn levels(&self) -> usize {
        let mut levels = 1;
        let mut layout = self.clone();
        while layout.counts() != [1; 3] {
            match layout.halved() {
                Ok(halved) => layout = halved,
                Err(_) => break,
            }
            levels += 1;
        }
        levels
    }

    /// The voxels of a chunk of [`halved`](Self::halved), where `voxels` gives those of a chunk of this
    /// layout ([`Occupancy::halved`]).
    ///
    /// # Errors
    /// Those of `voxels`.
    pub fn halved_voxels<E: From<Error>>(
        &self,
        chunk: [usize; 3],
        mut voxels: impl FnMut([usize; 3]) -> Result<Occupancy, E>,
    ) -> Result<Occupancy, E> {
        let halved = self.halved()?;
        let mut whole = Occupancy::empty(halved.grid().crop(halved.voxels(chunk))?);
        for corner in 0..8 {
            let step = [corner & 1, corner >> 1 & 1, corner >> 2];
            let part: [usize; 3] = std::array::from_fn(|d| 2 * chunk[d] + step[d]);
            if (0..3).all(|d| part[d] < self.counts()[d]) {
                let place = step.map(|step| (step * self.edge() / 2) as isize);
                whole.paste(place, &voxels(part)?.halved()?);
            }
        }
        Ok(whole)
    }
}
