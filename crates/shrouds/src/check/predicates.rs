//! Exact signs: which side of a line or plane a point lies on, and what follows from it.
//!
//! The signs come from adaptive expansion arithmetic, so they are those of the real numbers that the
//! floats stand for, as long as no coordinate exceeds [`COORDINATE_LIMIT`].

use robust::{Coord, Coord3D};

/// Point in space.
pub(super) type Point = [f64; 3];
/// Three corners, counter-clockwise seen from the side the normal points to.
pub(super) type Corners = [Point; 3];

/// Largest magnitude of a coordinate whose products of three cannot overflow.
pub(super) const COORDINATE_LIMIT: f64 = 1e90;

fn sign(x: f64) -> i8 {
    i8::from(x > 0.0) - i8::from(x < 0.0)
}

/// `+1` when `c` lies left of the line from `a` to `b`, `-1` right of it, `0` on it.
pub(super) fn side_of_line(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> i8 {
    let point = |[x, y]: [f64; 2]| Coord { x, y };
    sign(robust::orient2d(point(a), point(b), point(c)))
}

/// [`side_of_line`] of the point `(c[0] + shift[0]·ε, c[1] + shift[1]·ε²)` for an infinitely small
/// positive ε; `0` only when `a` equals `b`.
pub(super) fn side_of_line_shifted(a: [f64; 2], b: [f64; 2], c: [f64; 2], shift: [f64; 2]) -> i8 {
    match side_of_line(a, b, c) {
        0 if a[1] != b[1] => sign((a[1] - b[1]) * shift[0]),
        0 => sign((b[0] - a[0]) * shift[1]),
        side => side,
    }
}

/// `+1` when `point` lies on the side of the triangle's plane its normal points to, `-1` on the
/// other side, `0` on the plane.
#[inline]
pub(super) fn side_of_plane(triangle: &Corners, point: Point) -> i8 {
    let [a, b, c] = *triangle;
    // Flat parts of a surface mostly lie in a plane across an axis; arithmetic takes longest there.
    if (0..3).any(|d| a[d] == b[d] && b[d] == c[d] && c[d] == point[d]) {
        return 0;
    }
    -sign(robust::orient3d(coordinates(a), coordinates(b), coordinates(c), coordinates(point)))
}

fn coordinates([x, y, z]: Point) -> Coord3D<f64> {
    Coord3D { x, y, z }
}

fn difference(a: Point, b: Point) -> Point {
    std::array::from_fn(|d| a[d] - b[d])
}

fn cross(u: Point, v: Point) -> Point {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

pub(super) fn dot(u: Point, v: Point) -> f64 {
    u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
}

/// Twice the area times the unit normal.
pub(super) fn area_vector([a, b, c]: &Corners) -> Point {
    cross(difference(*b, *a), difference(*c, *a))
}

/// Whether the triangle has an area for sure, by the squared length of its [`area_vector`].
#[inline]
pub(super) fn is_surely_proper([a, b, c]: &Corners, squared: f64) -> bool {
    let (u, v) = (difference(*b, *a), difference(*c, *a));
    // The rounding error of the vector is a few ulp of |u||v|: beyond that it is not zero.
    squared > 1e-28 * dot(u, u) * dot(v, v)
}

/// Whether the triangle has no area, exactly.
pub(super) fn is_degenerate(triangle: &Corners) -> bool {
    let normal = area_vector(triangle);
    !is_surely_proper(triangle, dot(normal, normal)) && projection(triangle).is_none()
}

/// Two axes along which the triangle keeps an area when the third coordinate is dropped.
fn projection([a, b, c]: &Corners) -> Option<[usize; 2]> {
    [[0, 1], [1, 2], [2, 0]].into_iter().find(|&axes| {
        let [a, b, c] = [a, b, c].map(|p| axes.map(|d| p[d]));
        side_of_line(a, b, c) != 0
    })
}

/// Whether `point` lies in the plane of a triangle with area, on the same side as corner `n` of the
/// line through the other two.
pub(super) fn folded(triangle: &Corners, n: usize, point: Point) -> bool {
    if side_of_plane(triangle, point) != 0 {
        return false;
    }
    let Some(axes) = projection(triangle) else { return false };
    let [apex, a, b, point] = [triangle[n], triangle[(n + 1) % 3], triangle[(n + 2) % 3], point]
        .map(|p| axes.map(|d| p[d]));
    side_of_line(a, b, apex) == side_of_line(a, b, point)
}

/// Whether a segment and a triangle, both with their ends and edges, share a point. The triangle
/// must not be degenerate; `sides` are those of the ends of the segment.
pub(super) fn segment_meets_triangle(
    [p, q]: [Point; 2],
    sides: [i8; 2],
    triangle: &Corners,
) -> bool {
    if sides[0] == sides[1] {
        return sides[0] == 0 && coplanar_segment_meets([p, q], triangle);
    }
    // The line through p and q pierces the plane once: on the same side of all three edges?
    let [a, b, c] = *triangle;
    let turns = [(a, b), (b, c), (c, a)].map(|(from, to)| side_of_plane(&[p, q, from], to));
    turns.iter().all(|&s| s >= 0) || turns.iter().all(|&s| s <= 0)
}

/// Whether two triangles of one plane share a point, with their edges; neither may be degenerate.
pub(super) fn coplanar_triangles_meet(a: &Corners, b: &Corners) -> bool {
    let Some(axes) = projection(a) else { return false };
    let [a, b] = [a, b].map(|triangle| triangle.map(|p| axes.map(|d| p[d])));
    !has_separating_edge(a, b) && !has_separating_edge(b, a)
}

/// Whether a line through an edge of `a` has all of `b` strictly on the side away from `a`.
fn has_separating_edge(a: [[f64; 2]; 3], b: [[f64; 2]; 3]) -> bool {
    (0..3).any(|n| {
        let (from, to) = (a[n], a[(n + 1) % 3]);
        let own = side_of_line(from, to, a[(n + 2) % 3]);
        b.iter().all(|&point| side_of_line(from, to, point) == -own)
    })
}

/// Whether two triangles of one plane that share a corner, `[corner, other, other]` each, share
/// more. They do not exactly when the line through the corner and another one keeps them apart.
pub(super) fn coplanar_corners_meet(a: [Point; 3], b: [Point; 3]) -> bool {
    let Some(axes) = projection(&a) else { return false };
    let [a, b] = [a, b].map(|triangle| triangle.map(|p| axes.map(|d| p[d])));
    let apart = |[corner, to, third]: [[f64; 2]; 3], others: [[f64; 2]; 3]| {
        let own = side_of_line(corner, to, third);
        let axis = usize::from(corner[0] == to[0]);
        others[1..].iter().all(|&other| match side_of_line(corner, to, other) {
            // On the line, but on the other side of the corner.
            0 => (to[axis] > corner[axis]) != (other[axis] > corner[axis]),
            side => side == -own,
        })
    };
    let turned = |[corner, to, third]: [[f64; 2]; 3]| [corner, third, to];
    !(apart(a, b) || apart(turned(a), b) || apart(b, a) || apart(turned(b), a))
}

fn coplanar_segment_meets(segment: [Point; 2], triangle: &Corners) -> bool {
    let Some(axes) = projection(triangle) else { return false };
    let flat = |point: Point| axes.map(|d| point[d]);
    let [p, q] = segment.map(flat);
    let corners = triangle.map(flat);
    let edges = [0, 1, 2].map(|n| (corners[n], corners[(n + 1) % 3]));
    let contains = |point| {
        let sides = edges.map(|(a, b)| side_of_line(a, b, point));
        sides.iter().all(|&s| s >= 0) || sides.iter().all(|&s| s <= 0)
    };
    contains(p) || contains(q) || edges.iter().any(|&(a, b)| segments_cross(p, q, a, b))
}

/// Whether two segments of a plane cross, given that neither end of the first lies in the triangle
/// the second is an edge of: an end of either on the other then shows as a sign of 0 and counts.
fn segments_cross(p: [f64; 2], q: [f64; 2], a: [f64; 2], b: [f64; 2]) -> bool {
    let (sa, sb) = (side_of_line(p, q, a), side_of_line(p, q, b));
    let (sp, sq) = (side_of_line(a, b, p), side_of_line(a, b, q));
    if sa == 0 && sb == 0 {
        // All on one line: the ends of [p, q] are outside, so they cross when p and q lie apart.
        let axis = usize::from(p[0] == q[0]);
        let (low, high) = (p[axis].min(q[axis]), p[axis].max(q[axis]));
        return low <= a[axis] && a[axis] <= high;
    }
    sa * sb <= 0 && sp * sq <= 0
}

/// Squared distance of a point from a triangle with area.
pub(super) fn distance_squared(point: Point, triangle: &Corners) -> f64 {
    let [a, b, c] = *triangle;
    let normal = area_vector(triangle);
    let offset = difference(point, a);
    let above = |from: Point, to: Point| {
        dot(cross(normal, difference(to, from)), difference(point, from)) >= 0.0
    };
    if above(a, b) && above(b, c) && above(c, a) {
        return dot(offset, normal).powi(2) / dot(normal, normal);
    }
    let to_segment = |from: Point, to: Point| {
        let (along, offset) = (difference(to, from), difference(point, from));
        let t = (dot(along, offset) / dot(along, along)).clamp(0.0, 1.0);
        let rest: Point = std::array::from_fn(|d| offset[d] - t * along[d]);
        dot(rest, rest)
    };
    to_segment(a, b).min(to_segment(b, c)).min(to_segment(c, a))
}
