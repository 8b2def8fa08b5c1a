//! Noise that is the same on every machine: every lattice point decides for itself.

use crate::error::Error;
use crate::grid::Grid;
use crate::random::uniform;
use crate::volume::Occupancy;

/// A volume whose lattice points are inside with probability `density`, independently.
///
/// Point `n` (x fastest) takes the `n`-th number of the SplitMix64 sequence that starts at `seed`.
///
/// # Errors
/// [`Error::Setting`] when the density is not within 0 to 1.
pub fn noise(grid: &Grid, density: f64, seed: u64) -> Result<Occupancy, Error> {
    if !(0.0..=1.0).contains(&density) {
        let value = density.to_string();
        return Err(Error::Setting { name: "density", value, range: "between 0 and 1" });
    }
    let [nx, ny, _] = grid.dims();
    Ok(Occupancy::from_fn(grid.clone(), |[i, j, k]| {
        uniform(seed, ((k * ny + j) * nx + i) as u64) < density
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn density_and_seed_decide() {
        let grid = Grid::new([65, 40, 30], [1.0; 3]).unwrap();
        let points = grid.point_count() as f64;
        for density in [0.1, 0.5, 0.83] {
            let volume = noise(&grid, density, 7).unwrap();
            let spread = (points * density * (1.0 - density)).sqrt();
            assert!((volume.count() as f64 - points * density).abs() < 4.0 * spread);
            assert_eq!(volume, noise(&grid, density, 7).unwrap());
            assert_ne!(volume, noise(&grid, density, 8).unwrap());
        }
        assert_eq!(noise(&grid, 0.0, 1).unwrap().count(), 0);
        assert_eq!(noise(&grid, 1.0, 1).unwrap().count(), grid.point_count() as u64);
        for density in [-0.1, 1.1, f64::NAN] {
            assert!(noise(&grid, density, 1).is_err());
        }
    }
}
