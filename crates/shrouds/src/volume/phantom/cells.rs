//! A ball cut into Voronoi cells: a volume of several labels.

use super::{check_shape, length, position, subtract};
use crate::error::Error;
use crate::grid::Grid;
use crate::random::uniform;

/// The sites lie in the inner part of the ball, so that most cells reach its surface and none is a sliver.
const SITES_WITHIN: f64 = 0.8;

/// A label for every lattice point, x fastest: 0 outside the ball (world units), and within it the number,
/// from 1 to `count`, of the nearest of as many sites, which the sequence that starts at `seed` places.
///
/// # Errors
/// [`Error::Setting`] when the centre is not finite, or the radius not positive and finite.
pub fn cells(
    grid: &Grid,
    centre: [f64; 3],
    radius: f64,
    count: u8,
    seed: u64,
) -> Result<Vec<u8>, Error> {
    check_shape(centre, "radius", &[radius])?;
    let sites = sites(SITES_WITHIN * radius, count, seed);
    let [nx, ny, _] = grid.dims();
    let label = |n: usize| {
        let from = subtract(position(grid, [n % nx, n / nx % ny, n / nx / ny]), centre);
        if length(from) > radius {
            return 0;
        }
        let distances =
            (1u8..).zip(&sites).map(|(label, site)| (label, length(subtract(from, *site))));
        distances.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(label, _)| label)
    };
    Ok((0..grid.point_count()).map(label).collect())
}

/// Points of a ball about the origin.
fn sites(radius: f64, count: u8, seed: u64) -> Vec<[f64; 3]> {
    let place = |n: u64| [0, 1, 2].map(|d| radius * (2.0 * uniform(seed, 3 * n + d) - 1.0));
    let inside = (0..).map(place).filter(|place| length(*place) <= radius);
    inside.take(count.into()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::volume::phantom::ball;

    #[test]
    fn the_cells_fill_the_ball_and_each_is_nearest_to_its_site() {
        let grid = Grid::new([30, 32, 34], [1.0; 3]).unwrap();
        let (centre, radius) = ([14.6, 15.3, 16.9], 12.5);
        let labels = cells(&grid, centre, radius, 7, 3).unwrap();
        let whole = ball(&grid, centre, radius).unwrap();
        for (n, &label) in labels.iter().enumerate() {
            let index = [n % 30, n / 30 % 32, n / 30 / 32];
            assert_eq!(label > 0, whole.get(index));
            if label > 0 {
                let from = subtract(index.map(|i| i as f64), centre);
                let to = |site: &[f64; 3]| length(subtract(from, *site));
                let sites = sites(SITES_WITHIN * radius, 7, 3);
                let own = to(&sites[usize::from(label) - 1]);
                assert!(sites.iter().all(|site| own <= to(site)));
            }
        }
        assert!((1..=7).all(|label| labels.contains(&label)));
        assert!(cells(&grid, centre, -1.0, 7, 3).is_err());
    }
}
