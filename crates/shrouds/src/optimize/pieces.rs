//! Passes over a piece of a surface that no memory holds whole.
//!
//! The tiles of the lattice are the same in the piece as in the whole, and each is worked on from what
//! was known before the pass: so a piece finds what the whole would, bit for bit.

use crate::energy::Energy;
use crate::error::Error;
use crate::optimize::conjugate::Effort;
use crate::optimize::mean::MeanEnergy;
use crate::optimize::plan::{self, Passes};
use crate::optimize::problem::Conditions;
use crate::optimize::progress::deltas;
use crate::optimize::relax::{EnergySum, GROUP, visit_all};
use crate::optimize::settings::{Preset, Settings, Solver, Start, VolumeRule};
use crate::optimize::thin::Voxels;
use crate::optimize::tile::{ABOVE, BELOW, HALO, Tiling};
use crate::optimize::{flat, shares, start};
use crate::surface::{Region, Surface};
use crate::volume::Occupancy;

/// Lattice points that must be known below and above those of a piece to work on it: what its tiles
/// know, and what the blur of the start looks at.
pub(crate) const KNOWN: [usize; 2] = [HALO + BELOW + 3, HALO + ABOVE + 3];
/// Lattice points beyond those that decide which faces are flat.
pub(crate) const FLAT_REACH: usize = flat::REACH + 2;

/// A pass: some steps on one energy.
pub(crate) struct FixedPass {
    energy: Energy,
    steps: &'static [Effort],
    /// Whether it is the first on its energy, which knows of no mean energy.
    pub(crate) is_first: bool,
}

/// The passes that settings ask for.
///
/// # Errors
/// [`Error::Setting`] where the work on a piece depends on more than what lies around it.
pub(crate) fn fixed_passes(settings: &Settings) -> Result<Vec<FixedPass>, Error> {
    settings.validate()?;
    let refuse =
        |name, value: &str, range| Err(Error::Setting { name, value: value.to_string(), range });
    let Settings { volume, crease, rough, intervals, max_iterations, .. } = settings;
    match () {
        () if settings.solver == Solver::Sweeps => {
            return refuse("solver", "sweeps", "newton for a volume in chunks");
        }
        () if settings.preset == Preset::Exact => {
            return refuse("preset", "exact", "fast or default for a volume in chunks");
        }
        () if *volume == VolumeRule::Keep => {
            return refuse("volume", "keep", "free for a volume in chunks");
        }
        () if matches!(settings.start, Start::Random(_) | Start::Given(_)) => {
            return refuse("start", "random or given", "blur or midpoint for a volume in chunks");
        }
        () if crease.is_some() || rough.is_some() || intervals.is_some() => {
            return refuse(
                "crease, rough or intervals",
                "given",
                "left out for a volume in chunks",
            );
        }
        () if max_iterations.is_some() => {
            return refuse("max_iterations", "given", "left out for a volume in chunks");
        }
        () => {}
    }
    let mut all = Vec::new();
    for stage in plan::stages(settings, &[]) {
        if let Passes::Fixed(passes) = stage.passes {
            all.extend(passes.iter().enumerate().map(|(n, steps)| FixedPass {
                energy: stage.energy.clone(),
                steps,
                is_first: n == 0,
            }));
        }
    }
    Ok(all)
}

/// A piece of a surface with what lies around it.
pub(crate) struct Piece<'a> {
    /// Some points of the lattice, [`KNOWN`] points more than the piece on all sides, as far as there
    /// are any.
    pub(crate) surface: &'a Surface,
    /// More of them, [`FLAT_REACH`] points on all sides, and where in them the surface begins.
    pub(crate) volume: &'a Occupancy,
    pub(crate) first: [usize; 3],
    pub(crate) tiling: Tiling,
    /// The points of the piece in the surface.
    pub(crate) own: Region,
}

/// What a pass finds for the vertices that are known; slopes of those of the piece, shares of all that its tiles move.
pub(crate) struct Found {
    /// The shares of the piece's tiles in the positions.
    pub(crate) shares: Vec<u32>,
    pub(crate) slopes: Vec<[f32; 2]>,
    /// Of the vertices of the piece.
    pub(crate) energy: EnergySum,
}

impl Piece<'_> {
    /// Where the vertices start, right for what the first pass looks at.
    ///
    /// # Errors
    /// [`Error::Setting`] for a start that is given.
    pub(crate) fn start(&self, settings: &Settings) -> Result<Vec<f32>, Error> {
        let energy = settings.energy();
        let Conditions { spacing, bounds, .. } =
            Conditions::new(self.surface, settings, &energy, &[]);
        start::positions(self.surface, &settings.start, spacing, bounds)
    }

    /// Makes a pass from positions `x`, with the mean energy of the whole surface after the one before.
    pub(crate) fn relax(
        &self,
        settings: &Settings,
        pass: &FixedPass,
        mean_energy: Option<f64>,
        x: &[f32],
    ) -> Found {
        let flatness = flat::flatness_within(self.volume, self.first, self.surface);
        let conditions = Conditions::new(self.surface, settings, &pass.energy, &flatness);
        let voxels = Some(Voxels { volume: self.volume, first: self.first });
        let mean_energy = mean_energy.map(MeanEnergy::OfAll);
        let mean_energy = mean_energy.as_ref();
        let conditions = Conditions { mean_energy, voxels, ..conditions };
        let (shares, slopes) = (vec![0; x.len()], vec![[0.0; 2]; x.len()]);
        let mut found = Found { shares, slopes, energy: EnergySum::default() };
        let tiles = self.tiling.tiles(self.surface, &self.own);
        for tiles in tiles.chunks(GROUP) {
            let visits = visit_all(self.surface, &conditions, tiles, &[pass.steps], 0.0, x);
            for (tile, visit) in visits {
                shares::add(&tile, &visit.x, &mut found.shares);
                tile.write(&visit.slopes, &mut found.slopes);
                found.energy.add(visit.energy_of_vertices);
            }
        }
        found
    }

    /// The δ of vertices that are known.
    pub(crate) fn deltas(&self, x: &[f32]) -> Vec<f64> {
        deltas(self.surface, x)
    }
}
