//! Segments into samples: strokes with round ends, as wide on the screen wherever they are.

use crate::lens::{Lens, Placed};
use crate::raster::{Band, steps};
use crate::shade::Sample;

/// Draw a segment, `width` samples wide, a little nearer than it is.
///
/// A stroke is flat: where the surface is tilted, half of it would sink in. It is lifted by half its
/// width and half a sample, enough for slopes up to 45 degrees; on steeper ones it gets thinner. More
/// would show lines that are just beyond the horizon.
pub(crate) fn stroke(band: &mut Band, lens: &Lens, ends: [Placed; 2], width: f64, colour: Sample) {
    let radius = width / 2.0;
    let [a, b] = ends;
    let low = [a.x.min(b.x) - radius, a.y.min(b.y) - radius];
    let high = [a.x.max(b.x) + radius, a.y.max(b.y) + radius];
    let Some([_, rows]) = band.clip(low.map(steps), high.map(steps)) else { return };
    let lifted = ends.map(|end| lens.nearer(&end, radius + 0.5));
    let along = [b.x - a.x, b.y - a.y];
    let square = along[0] * along[0] + along[1] * along[1];
    for row in rows {
        let y = row as f64 + 0.5 - a.y;
        let (mut left, mut right) = (low[0], high[0]);
        if along[1].abs() > 1e-9 {
            // Where this row leaves the strip of this width around the whole line.
            let middle = a.x + along[0] / along[1] * y;
            let half = radius * square.sqrt() / along[1].abs();
            left = (middle - half).clamp(low[0], high[0]);
            right = (middle + half).clamp(low[0], high[0]);
        }
        let [left, right, centre] = [left, right, row as f64 + 0.5].map(steps);
        let Some([columns, _]) = band.clip([left, centre], [right, centre]) else { continue };
        let first = columns.start as f64 + 0.5 - a.x;
        let run = band.run(row, &columns);
        for (i, (nearest, sample)) in run.nearness.iter_mut().zip(run.colours).enumerate() {
            let x = first + i as f64;
            let t = if square > 0.0 { (x * along[0] + y * along[1]) / square } else { 0.0 };
            let t = t.clamp(0.0, 1.0);
            let away = [x - t * along[0], y - t * along[1]];
            let nearness = (lifted[0] + t * (lifted[1] - lifted[0])) as f32;
            if away[0] * away[0] + away[1] * away[1] <= radius * radius && nearness >= *nearest {
                *nearest = nearness;
                *sample = colour;
            }
        }
    }
}
