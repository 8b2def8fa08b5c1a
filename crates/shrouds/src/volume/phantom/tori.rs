//! Two linked tori, as in the figures of the paper.

use super::{check_shape, cube, generic_centre, position, subtract};
use crate::error::Error;
use crate::grid::Grid;
use crate::volume::Occupancy;

/// The lattice points of two tori (world units): the first with its axis along z, the second along y.
///
/// `ring_radius` runs from the axis to the middle of the tube, `tube_radius` is that of the tube.
///
/// # Errors
/// [`Error::Setting`] when a centre is not finite or a radius not positive and finite.
pub fn tori(
    grid: &Grid,
    centres: [[f64; 3]; 2],
    ring_radius: f64,
    tube_radius: f64,
) -> Result<Occupancy, Error> {
    for centre in centres {
        check_shape(centre, "ring and tube radius", &[ring_radius, tube_radius])?;
    }
    // Distance to the middle circle of the torus with coordinate `height` along its axis.
    let to_circle = |u: f64, v: f64, height: f64| {
        let across = (u * u + v * v).sqrt() - ring_radius;
        (across * across + height * height).sqrt()
    };
    Ok(Occupancy::from_fn(grid.clone(), |index| {
        let p = position(grid, index);
        let [a, b] = centres.map(|centre| subtract(p, centre));
        to_circle(a[0], a[1], a[2]).min(to_circle(b[0], b[2], b[1])) - tube_radius <= 0.0
    }))
}

/// Two linked tori on a cube of `n`³ lattice points with spacing 1.
///
/// Ring radius 0.23 `n`, tube radius 0.078 `n`; each passes through the middle of the other's hole.
///
/// # Errors
/// [`Error::Setting`] when `n` is 0 or above 2048.
pub fn linked_tori(n: usize) -> Result<Occupancy, Error> {
    linked_tori_with_spacing(n, [1.0; 3])
}

/// The bodies of [`linked_tori`], sampled with a spacing of at least 1 along x, y, z: ⌈`n` / spacing⌉
/// lattice points along each axis.
///
/// # Errors
/// [`Error::Setting`] when `n` is 0 or above 2048, or a spacing below 1 or not finite.
pub fn linked_tori_with_spacing(n: usize, spacing: [f64; 3]) -> Result<Occupancy, Error> {
    let (ring_radius, tube_radius) = radii(n);
    let [x, y, z] = generic_centre(n);
    let first = x - ring_radius / 2.0;
    let centres = [[first, y, z], [first + ring_radius, y, z]];
    tori(&cube(n, spacing)?, centres, ring_radius, tube_radius)
}

/// Ring and tube radius of [`linked_tori`].
pub(super) fn radii(n: usize) -> (f64, f64) {
    (0.23 * n as f64, 0.078 * n as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::phantom::test_support::part_sizes;
    use std::f64::consts::PI;

    /// Largest error of the volume of one digitised torus, its axis along a lattice axis.
    ///
    /// Its sections across the axis have the area 4πR √(r² − z²). Summing them instead of integrating
    /// errs by up to |ζ(−½)| = 0.208 times 4πR √(2r) h^1.5 at either end, h being the spacing along
    /// the axis; on top comes the scatter of the other boundary voxels, as in `solids`.
    fn tolerance(ring: f64, tube: f64, spacing: [f64; 3]) -> f64 {
        let h = spacing.into_iter().fold(0.0, f64::max);
        let ends = 2.0 * 0.208 * 4.0 * PI * ring * (2.0 * tube).sqrt() * h.powf(1.5);
        let area = 4.0 * PI * PI * ring * tube;
        ends + 4.0 * (area * spacing.iter().product::<f64>() / 12.0).sqrt()
    }

    #[test]
    fn two_parts_of_the_same_volume() {
        for (n, spacing) in [(24, [1.0; 3]), (96, [1.0; 3]), (96, [1.0, 1.0, 3.0])] {
            let volume = linked_tori_with_spacing(n, spacing).unwrap();
            let sizes = part_sizes(&volume, true);
            assert_eq!(sizes.len(), 2, "the rings touch nowhere and are whole");
            let (ring, tube) = radii(n);
            let true_volume = 2.0 * PI * PI * ring * tube * tube;
            for size in sizes {
                let error = size as f64 * spacing.iter().product::<f64>() - true_volume;
                assert!(error.abs() < tolerance(ring, tube, spacing), "{n} {spacing:?} {error}");
            }
            assert_eq!(part_sizes(&volume, false).len(), 1, "no hollow");
        }
    }

    #[test]
    fn each_ring_passes_through_the_other() {
        let n = 48;
        let volume = linked_tori(n).unwrap();
        // Along the line of the centres: tube, hole with the other tube in it, and the mirror of it.
        let [_, y, z] = generic_centre(n).map(|c| c.round() as usize);
        let row: Vec<bool> = (0..n).map(|i| volume.get([i, y, z])).collect();
        let runs = row.windows(2).filter(|w| !w[0] && w[1]).count();
        assert_eq!(runs, 4, "first ring, second ring, first ring, second ring");
    }
}
