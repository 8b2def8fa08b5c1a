//! What is true of all polygons of an image.

use robust::{Coord, orient2d};
use shrouds::Occupancy;
use shrouds::polygon::{Polygon, Separation};
use shrouds::volume::{Border, FaceRule};

/// Pairs of successive points of a polygon.
pub(crate) fn segments(polygon: &Polygon) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let count = polygon.index.len();
    let segments = if polygon.closed { count } else { count - 1 };
    (0..segments).map(move |n| [polygon.index[n], polygon.index[(n + 1) % count]])
}

/// How many lattice points are on the wrong side: a straight way from the first point of a row meets
/// the polygons once for every change of side. Exact.
pub(crate) fn wrong_side(image: &Occupancy, polygons: &[Polygon], border: Border) -> usize {
    let [nx, ny, _] = image.grid().dims();
    let coord = |x: f64, y: f64| Coord { x, y };
    let mut wrong = 0;
    for j in 0..ny {
        let y = j as f64;
        // Of the two ends at a height one counts: the lower one, where nothing lies above.
        let above = |p: [f64; 2]| if j + 1 == ny { p[1] >= y } else { p[1] > y };
        let crossed: Vec<[[f64; 2]; 2]> =
            polygons.iter().flat_map(segments).filter(|[a, b]| above(*a) != above(*b)).collect();
        let to_the_left = |x: f64| {
            let is_left = |[a, b]: &&[[f64; 2]; 2]| {
                let (low, high) = if above(*a) { (*b, *a) } else { (*a, *b) };
                let turn = orient2d(coord(low[0], low[1]), coord(high[0], high[1]), coord(x, y));
                assert!(turn != 0.0, "a polygon passes through ({x}, {y})");
                turn < 0.0
            };
            crossed.iter().filter(is_left).count()
        };
        let first = match border {
            Border::Closed => false,
            Border::Open => image.get([0, j, 0]) ^ (to_the_left(0.0) % 2 == 1),
        };
        wrong += (0..nx)
            .filter(|&i| image.get([i, j, 0]) != (first ^ (to_the_left(i as f64) % 2 == 1)))
            .count();
    }
    wrong
}

/// Components of the points on one side, with a frame of outside ones; by steps along x and y, and
/// along the diagonals too where `diagonals`.
pub(crate) fn components(image: &Occupancy, inside: bool, diagonals: bool) -> usize {
    let [nx, ny, _] = image.grid().dims();
    let get = |i: usize, j: usize| {
        (1..=nx).contains(&i) && (1..=ny).contains(&j) && image.get([i - 1, j - 1, 0])
    };
    let (wide, high) = (nx + 2, ny + 2);
    let mut seen = vec![false; wide * high];
    let mut count = 0;
    for start in 0..wide * high {
        if seen[start] || get(start % wide, start / wide) != inside {
            continue;
        }
        count += 1;
        seen[start] = true;
        let mut stack = vec![start];
        while let Some(here) = stack.pop() {
            let (i, j) = (here % wide, here / wide);
            for (x, y) in (i.saturating_sub(1)..wide.min(i + 2))
                .flat_map(|x| (j.saturating_sub(1)..high.min(j + 2)).map(move |y| (x, y)))
            {
                let is_near = diagonals || x == i || y == j;
                if is_near && get(x, y) == inside && !seen[y * wide + x] {
                    seen[y * wide + x] = true;
                    stack.push(y * wide + x);
                }
            }
        }
    }
    count
}

/// Holds what is true of all polygons of an image.
pub(crate) fn hold(image: &Occupancy, found: &Separation, rule: FaceRule, border: Border) {
    let polygons = &found.polygons;
    assert_eq!(wrong_side(image, polygons, border), 0);
    let count: usize = polygons.iter().map(|polygon| polygon.vertices.len()).sum();
    assert_eq!(count, found.surface.vertex_count(), "every vertex on one polygon");
    for polygon in polygons {
        assert!(polygon.delta.iter().all(|delta| (0.00199..=0.99801).contains(delta)));
        for (&v, (&[i, j], &delta)) in
            polygon.vertices.iter().zip(polygon.index.iter().zip(&polygon.delta))
        {
            assert_eq!(delta, found.delta[v as usize]);
            let at = |p: [f64; 2]| image.grid().point([p[0], p[1], 0.0]);
            let n = polygon.vertices.iter().position(|&u| u == v).unwrap();
            assert_eq!(polygon.points[n], at([i, j]));
        }
        assert!(segments(polygon).all(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1]) < 1.5));
    }
    if border == Border::Closed {
        // One polygon around every component of the inside, and one in every hole of it.
        let [around, holes] = [true, false].map(|inside| {
            components(image, inside, inside == (rule == FaceRule::Join)) - usize::from(!inside)
        });
        assert!(polygons.iter().all(|polygon| polygon.closed && polygon.area != 0.0));
        assert_eq!(polygons.iter().filter(|polygon| polygon.area > 0.0).count(), around);
        assert_eq!(polygons.iter().filter(|polygon| polygon.area < 0.0).count(), holes);
    }
}
