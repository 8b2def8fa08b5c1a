//! A shroud that follows its volume: after a local change only what the change reaches is found and solved
//! again.
//!
//! ```
//! use shrouds::{LiveShroud, Settings, volume::phantom};
//!
//! let mut volume = phantom::sphere(48)?;
//! let mut live = LiveShroud::new(&volume, &Settings::default())?;
//! volume.set([24, 24, 24], false);
//! let change = live.update(&volume, [20..30, 20..30, 20..30])?;
//! let vertices: usize = live.surface().vertex_count();
//! assert_eq!(live.delta().len(), vertices);
//! for cells in change.cells {
//!     let mesh = live.mesh(cells)?;
//!     println!("{} triangles to draw anew", mesh.triangles.len());
//! }
//! # Ok::<(), shrouds::Error>(())
//! ```

mod mesh;
mod reach;

use std::ops::{ControlFlow, Range};

use crate::error::Error;
use crate::mesh::{MeshKind, Triangles};
use crate::optimize::{
    Local, MeanEnergy, Progress, Settings, Solver, Start, VolumeRule, flatness, optimize,
    update_flatness,
};
use crate::settings;
use crate::surface::Surface;
use crate::volume::{Flips, Occupancy};
use reach::Reach;

/// A box of lattice points or of cells, by their indices along x, y, z.
pub type Ranges = [Range<usize>; 3];

/// The optimal separating surface of a volume that is edited.
///
/// Kept are the surface, its δ and a number for each vertex; meshes are made on demand, by boxes of cells.
#[derive(Clone)]
pub struct LiveShroud {
    surface: Surface,
    settings: Settings,
    triangles: Triangles,
    delta: Vec<f64>,
    flatness: Vec<f32>,
    /// What the barrier that all vertices share follows, their mean energy, as it was when all were solved.
    mean_energy: MeanEnergy,
}

/// What an update changed. Indices are those of [`Surface::grid`], where a closed border makes lattice point
/// `[0, 0, 0]` of the volume `[1, 1, 1]`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Change {
    /// The lattice points that changed their side lie in this box; none did if it is empty.
    pub points: Ranges,
    /// Outside these boxes of cells every triangle, place and normal is what it was.
    pub cells: Vec<Ranges>,
    /// The vertices from the first to the last that went or came: these numbers before gave way to those
    /// now. All others kept their order.
    pub renumbered: [Range<usize>; 2],
    /// How far the vertices moved, in grid edge lengths, that lie next to those that stayed: what the change does
    /// beyond is about as large and dies away.
    pub rim: f64,
    /// Whether all vertices were solved anew.
    pub is_whole: bool,
}

impl LiveShroud {
    /// The shroud of a volume.
    ///
    /// # Errors
    /// Those of [`shroud`](crate::shroud); [`Error::Setting`] for a dual mesh, sweeps, intervals, kept volumes,
    /// creases, rough places and given δ, all of which need the surface as a whole.
    pub fn new(volume: &Occupancy, settings: &settings::Settings) -> Result<Self, Error> {
        let surface = Surface::extract(volume, settings.faces, settings.border)?;
        let mut live = Self::unsolved(surface, settings)?;
        live.refresh()?;
        Ok(live)
    }

    fn unsolved(surface: Surface, settings: &settings::Settings) -> Result<Self, Error> {
        check(settings)?;
        Ok(Self {
            settings: settings.optimize.clone(),
            triangles: settings.triangles,
            delta: Vec::new(),
            flatness: flatness(&surface),
            mean_energy: MeanEnergy::OfAll(0.0),
            surface,
        })
    }

    /// The shroud of a volume whose surface and δ are known already, such as those of
    /// [`shroud`](crate::shroud) with the same settings: nothing is solved.
    ///
    /// # Errors
    /// Those of [`LiveShroud::new`]; [`Error::Setting`] when there is not one δ between 0 and 1 for each vertex.
    pub fn resume(
        surface: Surface,
        delta: Vec<f64>,
        settings: &settings::Settings,
    ) -> Result<Self, Error> {
        if delta.len() != surface.vertex_count() {
            let (value, range) = (format!("{} numbers", delta.len()), "one for each vertex");
            return Err(Error::Setting { name: "delta", value, range });
        }
        if let Some(delta) = delta.iter().find(|delta| !(0.0..=1.0).contains(*delta)) {
            let (value, range) = (delta.to_string(), "between 0 and 1");
            return Err(Error::Setting { name: "delta", value, range });
        }
        let mut live = Self::unsolved(surface, settings)?;
        live.delta = delta;
        live.mean_energy = live.local().find_mean_energy(&live.delta);
        Ok(live)
    }

    /// Crossings and patches.
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// δ of every vertex of the surface, in `[margin, 1 − margin]`; 1 is the inside end.
    pub fn delta(&self) -> &[f64] {
        &self.delta
    }

    /// Follows `volume`, which differs from the one before within `region` only: its surface is the one that a fresh
    /// extraction would find, and what the change reaches is solved again, all else keeps its place.
    ///
    /// # Errors
    /// [`Error::DifferentLattices`] when the volume lies on another lattice; [`Error::NoSuchPoints`] when the
    /// region leaves it; [`Error::TooManyVertices`] beyond what can be indexed. Nothing is changed then.
    pub fn update(&mut self, volume: &Occupancy, region: Ranges) -> Result<Change, Error> {
        self.surface.check_volume(volume)?;
        volume.grid().crop(region.clone())?;
        let Some(flips) = self.surface.flips_to(volume, region) else {
            return Ok(Change::default());
        };
        match Reach::around(&self.surface, &flips.points) {
            Some(reach) => self.update_near(flips, &reach),
            None => self.update_all(flips),
        }
    }

    /// Solves all vertices anew, as a fresh shroud of the same volume would.
    ///
    /// Updates leave the barrier that all vertices share as strong as it was: it follows the mean energy, and to
    /// let every small change move all vertices would be no update. This does, after a stroke of a brush, say.
    ///
    /// # Errors
    /// Those of [`optimize()`].
    pub fn refresh(&mut self) -> Result<(), Error> {
        let go_on = &mut |_: Progress| ControlFlow::Continue(());
        self.delta = optimize(&self.surface, &self.settings, go_on)?.delta;
        self.mean_energy = self.local().find_mean_energy(&self.delta);
        Ok(())
    }

    /// Updates the vertices around a change.
    ///
    /// The box is solved as it was and as it is, by the same steps, and the vertices move by the difference: where
    /// steps leave a surface short of its minimum, they go on to do so as far as they did.
    fn update_near(&mut self, flips: Flips, reach: &Reach) -> Result<Change, Error> {
        let mut before = self.local().solve(reach.own.clone(), &self.delta)?;
        let renumbered = self.flip(&flips)?;
        let Self { surface, flatness, .. } = self;
        let flattened = update_flatness(surface, &flips.points, &reach.own, flatness);
        before.flip(&flips)?;
        let after = self.local().solve(reach.own.clone(), &self.delta)?;
        after.write(Some(&before), self.settings.margin, &mut self.delta);
        let mut cells = vec![reach.cells(&self.surface)];
        for changed in flattened {
            let reach = Reach::with_margin(&self.surface, &changed);
            let solved = self.local().solve(reach.own.clone(), &self.delta)?;
            solved.write(None, self.settings.margin, &mut self.delta);
            cells.push(reach.cells(&self.surface));
        }
        let rim = reach.rim(after.moves(&before));
        Ok(Change { points: flips.points, cells, renumbered, rim, is_whole: false })
    }

    /// Updates all vertices.
    fn update_all(&mut self, flips: Flips) -> Result<Change, Error> {
        let renumbered = self.flip(&flips)?;
        self.flatness = flatness(&self.surface);
        self.refresh()?;
        let cells = vec![self.cells().map(|count| 0..count)];
        Ok(Change { points: flips.points, cells, renumbered, rim: 0.0, is_whole: true })
    }

    /// Flips lattice points; the vertices that come have no δ yet. Returns how numbers changed.
    fn flip(&mut self, flips: &Flips) -> Result<[Range<usize>; 2], Error> {
        let renumbering = self.surface.flip(flips)?;
        renumbering.splice(&mut self.delta, 0.5);
        renumbering.splice(&mut self.flatness, 0.0);
        Ok(renumbering.hull())
    }

    fn local(&self) -> Local<'_> {
        let Self { surface, settings, flatness, mean_energy, .. } = self;
        Local { surface, settings, flatness, mean_energy }
    }

    /// Number of cells along each axis.
    fn cells(&self) -> [usize; 3] {
        self.surface.grid().dims().map(|points| points - 1)
    }
}

/// Refuses settings that need the surface as a whole.
fn check(settings: &settings::Settings) -> Result<(), Error> {
    let refuse =
        |name, value: &str, range| Err(Error::Setting { name, value: value.into(), range });
    let optimize = &settings.optimize;
    match () {
        () if settings.mesh == MeshKind::Dual => refuse("mesh", "dual", "primal for a live shroud"),
        () if optimize.solver == Solver::Sweeps => {
            refuse("solver", "sweeps", "newton for a live shroud")
        }
        () if optimize.volume == VolumeRule::Keep => {
            refuse("volume", "keep", "free for a live shroud")
        }
        () if optimize.intervals.is_some() => {
            refuse("intervals", "given", "none for a live shroud")
        }
        () if optimize.crease.is_some() => refuse("crease", "on", "off for a live shroud"),
        () if optimize.rough.is_some() => refuse("rough", "given", "none for a live shroud"),
        () if matches!(optimize.start, Start::Given(_)) => {
            refuse("start", "given", "a rule for a live shroud, whose vertices come and go")
        }
        () => Ok(()),
    }
}
