//! The sea: a lattice, its floor, and how sound travels in it.

use crate::containment::floor::Floor;
use crate::containment::sound::SoundSpeed;
use crate::containment::step::Membership;
use crate::containment::stretches::{Columns, Stretches};
use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// The sea, and the lattice on which regions of it are volumes.
#[derive(Debug, Clone, PartialEq)]
pub struct Sea {
    grid: Grid,
    floor: Floor,
    sound: SoundSpeed,
}

impl Sea {
    /// A sea with this floor and speed of sound.
    ///
    /// # Errors
    /// [`Error::Scene`] when the lattice does not lie along the axes of the world, or the floor has numbers that
    /// are not finite; [`Error::Memory`] when the lattice is too large for memory.
    pub fn new(grid: Grid, floor: Floor, sound: SoundSpeed) -> Result<Self, Error> {
        let affine = grid.affine();
        if (0..9).any(|n| n / 3 != n % 3 && affine[n / 3][n % 3] != 0.0)
            || (0..3).any(|d| affine[d][d] <= 0.0)
        {
            let problem = "its axes must point along x, y and z of the world".into();
            return Err(Error::Scene { part: "the lattice of the sea".into(), problem });
        }
        floor.check()?;
        Occupancy::check_memory(&grid)?;
        Ok(Self { grid, floor, sound })
    }

    /// The lattice.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The sea floor.
    pub fn floor(&self) -> &Floor {
        &self.floor
    }

    /// The speed of sound.
    pub fn sound(&self) -> &SoundSpeed {
        &self.sound
    }

    /// The lattice points in water: at the surface, on the floor or between them; or with water in their cells.
    pub fn water(&self, membership: Membership) -> Occupancy {
        Columns::all(&self.grid, membership).volume(|column, found: &mut Stretches| {
            found.add([0.0, self.floor.depths(column.area)[1]]);
        })
    }

    /// Whether rays are straight and the floor is level, at this depth.
    pub(super) fn plain(&self) -> Option<f64> {
        self.floor.level().filter(|_| self.sound.is_constant())
    }

    /// Smallest and largest x and y of the lattice's cells.
    pub(super) fn area(&self) -> [[f64; 2]; 2] {
        Columns::all(&self.grid, Membership::Cell).area()
    }

    /// Whether a place lies in the lattice's rectangle, or no farther from it than it is wide.
    pub(super) fn is_near(&self, place: [f64; 2]) -> bool {
        let [low, high] = self.area();
        (0..2).all(|d| {
            let width = high[d] - low[d];
            (low[d] - width..=high[d] + width).contains(&place[d])
        })
    }

    /// The smaller distance between lattice points along x and y.
    pub(super) fn horizontal_spacing(&self) -> f64 {
        let [x, y, _] = self.grid.spacing();
        x.min(y)
    }
}
