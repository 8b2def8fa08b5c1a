//! Residuals that depend on a few unknowns each, wherever these are: what the bands along curves do not
//! hold.

use crate::optimize::{Model, Real};

/// The most unknowns of a residual.
pub(super) const UNKNOWNS: usize = 6;

/// `N` residuals with the root of twice their weight, so that the energy is half the sum of their squares,
/// and their derivatives by the same unknowns. An unknown that is not needed has derivatives 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row<const N: usize> {
    pub(super) unknowns: [u32; UNKNOWNS],
    pub(super) residual: [f32; N],
    pub(super) slopes: [[f32; UNKNOWNS]; N],
}

/// Adds what the rows have of gradient and diagonal.
pub(super) fn add_slopes<R: Real, const N: usize>(rows: &[Row<N>], model: &mut Model<R>) {
    for row in rows {
        for (i, &unknown) in row.unknowns.iter().enumerate() {
            let (mut slope, mut square) = (0.0, 0.0);
            for (residual, slopes) in row.residual.iter().zip(&row.slopes) {
                slope += residual * slopes[i];
                square += slopes[i] * slopes[i];
            }
            model.add_slopes(unknown as usize, slope, square);
        }
    }
}

/// Adds the product of the rows' matrix without its diagonal with a direction. Returns the product of
/// both.
pub(super) fn add_image<const N: usize>(
    rows: &[Row<N>],
    direction: &[f32],
    image: &mut [f32],
) -> f64 {
    let mut product = 0.0;
    for row in rows {
        let along = row.unknowns.map(|unknown| direction[unknown as usize]);
        let mut added = [0.0; UNKNOWNS];
        for slopes in &row.slopes {
            let mut parts = [0.0; UNKNOWNS];
            for i in 0..UNKNOWNS {
                parts[i] = slopes[i] * along[i];
            }
            let gained: f32 = parts.iter().sum();
            for i in 0..UNKNOWNS {
                added[i] += slopes[i] * (gained - parts[i]);
            }
        }
        let mut sum = 0.0;
        for i in 0..UNKNOWNS {
            image[row.unknowns[i] as usize] += added[i];
            sum += added[i] * along[i];
        }
        product += f64::from(sum);
    }
    product
}
