//! Annuli in water of constant speed over a level floor: formulas.

use crate::containment::contact::Heard;
use crate::containment::stretches::{Column, Stretches};
use crate::vector::subtract;

/// Adds the depths of a column that are heard so, over a floor at the depth `floor`.
///
/// Sound from a point at the distance ρ, of which p lies along the axis, arrives at the angle θ to it with
/// cos θ = p / ρ. A column has one p and one horizontal distance r, so that a bearing gives bounds of ρ, and
/// these give bounds of ρ² − r², the squared vertical distance: to the point itself, or to its mirror image
/// below the floor. Where a column is as wide as its cells, all numbers are ranges.
pub(super) fn hear(heard: &Heard, floor: f64, column: &Column, found: &mut Stretches) {
    let (along, squares) = (along(heard, column), column.squares(heard.array.position));
    let mut vertical = [0.0, f64::INFINITY];
    let [low, high] = heard.cosines;
    limit(along, squares, high, &mut vertical);
    limit([-along[1], -along[0]], squares, -low, &mut vertical);
    if vertical[0] > vertical[1] {
        return;
    }
    let [near, far] = vertical.map(f64::sqrt);
    let depth = heard.array.depth;
    if heard.path.has_direct() {
        found.add([depth - far, depth - near]);
        found.add([depth + near, depth + far]);
    }
    if heard.path.has_bounce() {
        let image = 2.0 * floor - depth;
        found.add([image - far, image - near]);
    }
}

/// The range of the distance along the axis from the array to a column.
fn along(heard: &Heard, column: &Column) -> [f64; 2] {
    let [low, high] = column.area.map(|corner| subtract(corner, heard.array.position));
    let [x, y] = [0, 1].map(|d| {
        let ends = [low[d], high[d]].map(|end| end * heard.array.axis[d]);
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    });
    [x[0] + y[0], x[1] + y[1]]
}

/// Narrows the squared vertical distance to where p ≤ c ρ.
fn limit(along: [f64; 2], squares: [f64; 2], cosine: f64, vertical: &mut [f64; 2]) {
    let bound = |p: f64| (p / cosine).powi(2);
    if cosine >= 0.0 && along[0] > 0.0 {
        vertical[0] = vertical[0].max(bound(along[0]) - squares[1]);
    } else if cosine < 0.0 && along[0] >= 0.0 {
        vertical[1] = f64::NEG_INFINITY;
    } else if cosine < 0.0 {
        vertical[1] = vertical[1].min(bound(along[0]) - squares[0]);
    }
}
