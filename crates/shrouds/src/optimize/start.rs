//! Where the vertices start.

use crate::error::Error;
use crate::optimize::blur::{Blur, Filter, HALF};
use crate::optimize::settings::Start;
use crate::parallel;
use crate::random::uniform;
use crate::surface::Surface;

/// Positions from the low end of every grid edge, within the bounds; `spacing` is in units of the
/// smallest one.
///
/// # Errors
/// [`Error::Setting`] when given δ are not one for each vertex, or not from 0 to 1.
pub(super) fn positions(
    surface: &Surface,
    start: &Start,
    spacing: [f64; 3],
    bounds: [f64; 2],
) -> Result<Vec<f32>, Error> {
    let [low, high] = bounds.map(|bound| bound as f32);
    let mut x = vec![0.5; surface.vertex_count()];
    match start {
        Start::Midpoint => {}
        Start::Blur => blur(surface, spacing, &mut x),
        Start::Inside => fill(surface, 1.0, &mut x),
        Start::Outside => fill(surface, 0.0, &mut x),
        Start::Random(seed) => parallel::fill(&mut x, |v| uniform(*seed, v as u64) as f32),
        Start::Given(delta) => place(surface, delta, &mut x)?,
    }
    x.iter_mut().for_each(|x| *x = x.clamp(low, high));
    Ok(x)
}

/// The same δ everywhere.
fn fill(surface: &Surface, delta: f64, x: &mut [f32]) {
    for (x, crossing) in x.iter_mut().zip(surface.crossings()) {
        *x = crossing.from_low(delta) as f32;
    }
}

/// Each vertex at its own δ.
fn place(surface: &Surface, delta: &[f64], x: &mut [f32]) -> Result<(), Error> {
    let refuse = |name, value, range| Err(Error::Setting { name, value, range });
    if delta.len() != x.len() {
        let value = format!("{} for {} vertices", delta.len(), x.len());
        return refuse("the number of given deltas", value, "one for each vertex");
    }
    if let Some(wrong) = delta.iter().find(|delta| !(0.0..=1.0).contains(*delta)) {
        return refuse("a given delta", wrong.to_string(), "between 0 and 1");
    }
    for ((x, crossing), &delta) in x.iter_mut().zip(surface.crossings()).zip(delta) {
        *x = crossing.from_low(delta) as f32;
    }
    Ok(())
}

/// Slices per piece of work; each needs some more on both sides.
const SLAB: usize = 32;

/// Where the occupancy, blurred by about a voxel along every axis, passes one half on the way from one
/// end of the grid edge to the other.
fn blur(surface: &Surface, spacing: [f64; 3], x: &mut [f32]) {
    let filter = Filter::new(spacing);
    let slices = surface.slice_count();
    let slabs = slices.div_ceil(SLAB);
    let ends = (1..=slabs).map(|n| surface.slice_vertices((n * SLAB).min(slices) - 1).end as usize);
    parallel::pieces(x, ends, |slab, x| {
        let mut blur = Blur::new(surface, &filter);
        let [mut here, mut above] = [blur.slice(), blur.slice()];
        let mut x = x.iter_mut();
        let first = slab * SLAB;
        blur.fill(first, &mut above);
        for k in first..slices.min(first + SLAB) {
            std::mem::swap(&mut here, &mut above);
            if k + 1 < slices {
                blur.fill(k + 1, &mut above);
            }
            for (crossing, x) in surface.slice_crossings(k).zip(x.by_ref()) {
                let [i, j, _] = crossing.low();
                let high = match crossing.axis() {
                    0 => blur.value(&here, i + 1, j),
                    1 => blur.value(&here, i, j + 1),
                    _ => blur.value(&above, i, j),
                };
                *x = passing(blur.value(&here, i, j) - HALF, high - HALF);
            }
        }
    });
}

/// Where a line from `low` to `high` passes 0, and not too near its ends. If it would pass far beyond
/// them a thin part has blurred away, and the middle is as good as any.
fn passing(low: i32, high: i32) -> f32 {
    const FAR: f32 = 0.5;
    let passing = low as f32 / (low - high) as f32;
    if (-FAR..=1.0 + FAR).contains(&passing) { passing.clamp(0.04, 0.96) } else { 0.5 }
}
