//! The coding predictor: where a vertex would lie by its neighbours. Frozen by the format version.
//!
//! Whole numbers only, in fixed order: places are distances from the low end of the grid edge in units
//! of 1/65536 of an edge. Lengths are those of the index, whatever the spacing: what is straight stays
//! straight, and it is only the weights of neighbours that would change.

use crate::geometry::stencil::{ONE, Stencil};

/// What neighbours predict, as distances from the low end that need not lie on the edge.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Predictions {
    /// By the fourth difference of five vertices, as if they lay evenly; both curves together.
    pub(super) even: i64,
    /// By the chord between the two neighbours, on each curve.
    pub(super) chord: [i64; 2],
    /// By the cubic through four neighbours, on each curve.
    pub(super) cubic: [i64; 2],
    /// By the line through the two neighbours on each side, on each curve.
    pub(super) line: [i64; 4],
}

/// Neighbours nearer to each other than this along a curve make no cubic.
const LEAST_GAP: i64 = ONE / 10;

/// The predictions for a vertex at `own`.
#[inline]
pub(super) fn predict(stencil: &Stencil, places: &[i32], own: i64) -> Predictions {
    let mut found = Predictions::default();
    let (mut first, mut second, mut firsts, mut seconds) = (0, 0, 0, 0);
    for (c, links) in stencil.iter().enumerate() {
        let [p, q] = [links[1], links[2]];
        found.line[2 * c] = own;
        found.line[2 * c + 1] = own;
        (found.chord[c], found.cubic[c]) = (own, own);
        if !(p.exists && q.exists) {
            continue;
        }
        let [p, q] = [p, q].map(|link| link.place(places));
        first += p.0 + q.0;
        firsts += 2;
        let width = q.1 - p.1;
        let chord =
            if width > 0 { (p.0 * q.1 - q.0 * p.1).div_euclid(width) } else { (p.0 + q.0) >> 1 };
        (found.chord[c], found.cubic[c]) = (chord, chord);
        if !(links[0].exists && links[3].exists) {
            continue;
        }
        let [o, r] = [links[0], links[3]].map(|link| link.place(places));
        second += o.0 + r.0;
        seconds += 2;
        found.line[2 * c] = extend(o, p);
        found.line[2 * c + 1] = extend(r, q);
        let apart = p.1 - o.1 > LEAST_GAP && r.1 - q.1 > LEAST_GAP && width > LEAST_GAP;
        if apart && p.1 <= 0 && q.1 >= 0 {
            found.cubic[c] = cubic([o, p, q, r]).clamp(chord - ONE / 2, chord + ONE / 2);
        }
    }
    found.even = match (firsts, seconds) {
        (4, 4) => (4 * first - second).div_euclid(12),
        (0, _) => own,
        _ => first.div_euclid(firsts),
    };
    found
}

/// Where the line from one point through another meets the grid edge, at most an edge further along.
#[inline]
fn extend(from: (i64, i64), through: (i64, i64)) -> i64 {
    let run = through.1 - from.1;
    if run.abs() < ONE / 8 {
        return 2 * through.0 - from.0;
    }
    let rise = ((through.0 - from.0) * -through.1).div_euclid(run);
    through.0 + rise.clamp(-ONE, ONE)
}

/// The value at 0 of the cubic through four points.
#[inline]
fn cubic(points: [(i64, i64); 4]) -> i64 {
    // Products of three lengths and a place fit into 64 bits with six bits less.
    let aside = points.map(|point| point.1 >> 6);
    let mut sum = 0;
    for (n, point) in points.iter().enumerate() {
        let (mut above, mut below) = (1i64, 1i64);
        for (m, &other) in aside.iter().enumerate() {
            if m != n {
                above *= -other;
                below *= aside[n] - other;
            }
        }
        sum += (above * point.0).div_euclid(below);
    }
    sum
}

/// What a sweep makes small.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Aim {
    /// The square of the curvature along the curves.
    Bending,
    /// The distances of vertices from the chords of their neighbours.
    Chords,
    /// The distances of vertices from the cubics through theirs.
    Cubics,
}

/// The box of a vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct Box {
    pub(super) low: i32,
    pub(super) high: i32,
}

/// One pass over all vertices in their order. `pull` draws them to the middle of their boxes, in units
/// of 1/256 of the weight of one curve.
pub(super) fn sweep(stencils: &[Stencil], places: &mut [i32], boxes: &[Box], aim: Aim, pull: i64) {
    for (v, stencil) in stencils.iter().enumerate() {
        let Box { low, high } = boxes[v];
        let middle = i64::from(low) + i64::from(high - low) / 2;
        let own = i64::from(places[v]);
        let place = match aim {
            Aim::Cubics => {
                let [a, b] = predict(stencil, places, own).cubic;
                (a * 256 + b * 256 + 2 * pull * middle).div_euclid(512 + 2 * pull)
            }
            _ => {
                let (mut sum, mut weight) = (0, 0);
                for links in stencil {
                    if links.iter().all(|link| link.exists) {
                        let places = links.map(|link| link.place(places));
                        let (s, w) = balance(places, own, aim);
                        (sum, weight) = (sum + s, weight + w);
                    }
                }
                let scale = if aim == Aim::Bending { 1 << 19 } else { 1 << 25 };
                let (sum, weight) = (sum + scale * pull * middle, weight + scale * pull);
                if weight == 0 { own } else { sum.div_euclid(weight) }
            }
        };
        places[v] = place.clamp(low.into(), high.into()) as i32;
    }
}

/// The weighted place that makes the three second differences around a vertex small, and the weight.
#[inline]
fn balance(points: [(i64, i64); 4], own: i64, aim: Aim) -> (i64, i64) {
    let [o, p, q, r] = points;
    let me = (own, 0);
    // Chords, in units of 1/256, and 65536 by them.
    let chords = [length(o, p), length(p, me), length(me, q), length(q, r)];
    let slopes = chords.map(|chord| i64::from(65536 / chord));
    let weight = |a: usize, b: usize| match aim {
        Aim::Bending => i64::from((1 << 20) / (chords[a] + chords[b])),
        _ => (1 << 33) / ((slopes[a] + slopes[b]) * (slopes[a] + slopes[b])),
    };
    let here = weight(1, 2) * (slopes[1] + slopes[2]);
    let mut sum = here * (p.0 * slopes[1] + q.0 * slopes[2]);
    let mut total = here * (slopes[1] + slopes[2]);
    for (near, far, a, b) in [(p, o, 1, 0), (q, r, 2, 3)] {
        let there = weight(a, b) * slopes[a];
        sum += there * (near.0 * slopes[a] + (near.0 - far.0) * slopes[b]);
        total += there * slopes[a];
    }
    (sum, total)
}

/// The length of a chord in units of 1/256, a little more where it is short.
#[inline]
fn length(a: (i64, i64), b: (i64, i64)) -> u32 {
    let (x, y) = ((a.0 - b.0) >> 8, (a.1 - b.1) >> 8);
    ((x * x + y * y) as u32 + 38 * 38).isqrt()
}
