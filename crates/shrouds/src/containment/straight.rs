//! Annuli in water of constant speed over a level floor: formulas.

use crate::containment::contact::Heard;
use crate::containment::stretches::{Column, Stretches};
use crate::vector::{dot, subtract};

/// The least squared cosine of a cone that is told from a plane.
const PLANE: f64 = 1e-24;

/// Adds the depths of a column that are heard so, over a floor at the depth `floor`.
///
/// Sound from a point at the distance ρ, of which p lies along the axis, arrives at the angle θ to it with
/// cos θ = p / ρ. A column has one p and one horizontal distance r, so that a bearing gives a bound of ρ, and
/// this one of ρ² − r², the squared vertical distance: to the point itself, or to its mirror image
/// below the floor. Where a column is as wide as its cells, all numbers are ranges.
pub(super) fn hear(heard: &Heard, floor: f64, column: &Column, found: &mut Stretches) {
    let [along, against] = [1.0, -1.0].map(|side| offsets(heard, column, side));
    let [low, high] = heard.cosines;
    let mut vertical = [0.0, f64::INFINITY];
    limit(heard, column, along, high, &mut vertical);
    limit(heard, column, against, -low, &mut vertical);
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

/// The least distance from the array to a column along the axis, or against it where `side` is −1.
fn offsets(heard: &Heard, column: &Column, side: f64) -> f64 {
    let corners = column.area.map(|corner| subtract(corner, heard.array.position));
    (0..2)
        .map(|d| {
            let ends = corners.map(|corner| side * corner[d] * heard.array.axis[d]);
            ends[0].min(ends[1])
        })
        .sum()
}

/// Narrows the squared vertical distance to where p ≤ c ρ, for a p of at least `least`.
fn limit(heard: &Heard, column: &Column, least: f64, cosine: f64, vertical: &mut [f64; 2]) {
    if cosine >= 0.0 && least > 0.0 {
        vertical[0] = vertical[0].max(cone(heard, column, cosine)[0]);
    } else if cosine < 0.0 && least >= 0.0 {
        vertical[1] = f64::NEG_INFINITY;
    } else if cosine < 0.0 {
        vertical[1] = vertical[1].min(cone(heard, column, cosine)[1]);
    }
}

/// The range in a column of p² / c² − r², the squared vertical distance to the cone.
///
/// The function is a saddle about the array, so that in a rectangle it is least and largest on the border: in
/// corners, or where it turns along an edge.
fn cone(heard: &Heard, column: &Column, cosine: f64) -> [f64; 2] {
    let axis = heard.array.axis;
    let square = (cosine * cosine).max(PLANE);
    let [low, high] = column.area.map(|corner| subtract(corner, heard.array.position));
    let corners = [low, [high[0], low[1]], [low[0], high[1]], high];
    let turns = [(0, low), (0, high), (1, low), (1, high)].map(|(d, mut place)| {
        let turn = axis[d] * axis[1 - d] * place[1 - d] / (square - axis[d] * axis[d]);
        // Not a number where it turns nowhere; comparisons leave that out.
        place[d] = turn.clamp(low[d], high[d]);
        place
    });
    let values = corners.into_iter().chain(turns);
    let values = values.map(|place| dot(place, axis).powi(2) / square - dot(place, place));
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], value| [a.min(value), b.max(value)])
}
