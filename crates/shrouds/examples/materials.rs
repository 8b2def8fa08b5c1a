//! Interfaces of several labels against their formulas: `cargo run --release --example materials`, with
//! the lattice points along an axis (64 and 128 without).
//!
//! Every body is given by one function for each label; a point has the label whose function is least.
//! The interface of two labels is where theirs are equal, and a junction line where three are. All
//! distances are in voxels, weighted by area or length; angles in degrees.

use shrouds::Grid;
use shrouds::materials::{Labels, MaterialMesh, Settings, shrouds};
use shrouds::optimize::Preset;

type Point = [f64; 3];

/// The parts of interfaces that are told apart: spherical and flat, away from junction lines and nearer to
/// one than this many voxels.
const PARTS: [&str; 4] = ["round, away", "round, near", "flat, away", "flat, near"];
const NEAR: f64 = 3.0;

/// `square·|p − centre|² + slope·p + offset`.
#[derive(Clone, Copy)]
struct Function {
    square: f64,
    centre: Point,
    slope: Point,
    offset: f64,
}

impl Function {
    const ZERO: Self = Self { square: 0.0, centre: [0.0; 3], slope: [0.0; 3], offset: 0.0 };

    fn ball(centre: Point, radius: f64) -> Self {
        Self { square: 1.0, centre, slope: [0.0; 3], offset: -radius * radius }
    }

    fn value(&self, p: Point) -> f64 {
        let from = subtract(p, self.centre);
        self.square * dot(from, from) + dot(self.slope, p) + self.offset
    }

    fn gradient(&self, p: Point) -> Point {
        let from = subtract(p, self.centre);
        [0, 1, 2].map(|a| 2.0 * self.square * from[a] + self.slope[a])
    }
}

/// A body with the functions of its labels; the first is that of label `first`.
struct Body {
    name: &'static str,
    functions: Vec<Function>,
    first: i64,
}

fn main() {
    println!(
        "{:<10} {:>5} {:>8} | {:>8} {:>8} | {:>8}",
        "body", "size", "preset", "distance", "normal", "junction"
    );
    let sizes: Vec<usize> = std::env::args().skip(1).filter_map(|size| size.parse().ok()).collect();
    for size in if sizes.is_empty() { vec![64, 128] } else { sizes } {
        for body in bodies(size) {
            let grid = Grid::new([size; 3], [1.0; 3]).expect("a small grid");
            let labels = Labels::new(&grid, &body.labels(size)).expect("a label everywhere");
            for (name, preset) in
                [("fast", Preset::Fast), ("default", Preset::Default), ("exact", Preset::Exact)]
            {
                let settings = Settings { preset, ..Settings::default() };
                let found = shrouds(labels.clone(), &settings).expect("good settings");
                let [[distance, normal], parts @ ..] = body.interface_errors(&found.mesh, size);
                let junction = body.junction_error(&found.mesh, size);
                println!(
                    "{:<10} {size:>5} {name:>8} | {distance:>8.4} {normal:>8.3} | {junction:>8.4} {:>4} steps {:.2} s",
                    body.name,
                    found.report.steps(),
                    found.times.optimize,
                );
                for (part, [distance, normal]) in PARTS.into_iter().zip(parts) {
                    if distance.is_finite() {
                        println!("{part:>25} | {distance:>8.4} {normal:>8.3} |");
                    }
                }
            }
        }
    }
}

fn bodies(size: usize) -> Vec<Body> {
    let unit = size as f64 / 64.0;
    let middle = [31.3 * unit, 31.8 * unit, 31.1 * unit];
    let at = |offset: Point| [0, 1, 2].map(|a| middle[a] + unit * offset[a]);
    let radius = 16.0 * unit;
    let ball = |offset| Function::ball(at(offset), radius);
    // Towards three corners of a triangle of side 16, tilted.
    let (u, v) = (unit_vector([3.0, 1.0, 0.5]), unit_vector([-0.4, 1.1, 0.2]));
    let v = unit_vector([0, 1, 2].map(|a| v[a] - dot(u, v) * u[a]));
    let towards = |angle: f64, length: f64| {
        [0, 1, 2].map(|a| length * (angle.cos() * u[a] + angle.sin() * v[a]))
    };
    let third = std::f64::consts::TAU / 3.0;
    let corner = |n: f64| towards(n * third, 16.0 / 3f64.sqrt());
    let plane = |angle: f64| {
        let slope = towards(angle.to_radians(), 1.0);
        Function { slope, offset: -dot(slope, middle), ..Function::ZERO }
    };
    let site = |n: u64| {
        let number = |k: u64| {
            let x = (n * 3 + k + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            (x ^ (x >> 29)) % 1000
        };
        Function::ball([0, 1, 2].map(|k| size as f64 * number(k) as f64 / 1000.0), 0.0)
    };
    let body = |name, functions, first| Body { name, functions, first };
    vec![
        body("ball", vec![Function::ZERO, ball([0.0; 3])], 0),
        body("half", vec![Function::ZERO, plane(17.0)], 0),
        body("double", vec![Function::ZERO, ball(towards(0.0, 8.0)), ball(towards(0.0, -8.0))], 0),
        body(
            "triple",
            vec![Function::ZERO, ball(corner(0.0)), ball(corner(1.0)), ball(corner(2.0))],
            0,
        ),
        body("planes", [0.0, 120.0, 240.0].map(plane).to_vec(), 1),
        body("wedges", [0.0, 95.0, 215.0].map(plane).to_vec(), 1),
        body("voronoi", (0..12).map(site).collect(), 1),
    ]
}

impl Body {
    fn labels(&self, size: usize) -> Vec<i16> {
        let least = |p: Point| {
            let values = self.functions.iter().map(|f| f.value(p)).enumerate();
            values.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(n, _)| n as i64 + self.first)
                as i16
        };
        let point = |n: usize| [n % size, n / size % size, n / size / size].map(|x| x as f64);
        (0..size.pow(3)).map(|n| least(point(n))).collect()
    }

    /// Whether the border of the volume is far from a point.
    fn is_inner(&self, p: Point, size: usize) -> bool {
        p.iter().all(|&x| x > 5.0 && x < size as f64 - 6.0)
    }

    /// The root mean squares of the distances and angles of the triangles: of all, and of the parts as
    /// [`PARTS`] names them. NaN for a part that the body has not.
    fn interface_errors(&self, mesh: &MaterialMesh, size: usize) -> [[f64; 2]; 5] {
        let mut sums = [[0.0; 3]; 5];
        for (triangle, pair) in mesh.surface.triangles.iter().zip(&mesh.pairs) {
            let [a, b, c] = triangle.map(|v| mesh.surface.vertices[v as usize]);
            let centre = [0, 1, 2].map(|k| (a[k] + b[k] + c[k]) / 3.0);
            let pair = pair.map(|label| (label - self.first) as usize);
            let Some([f, g]) = self.pair(pair) else { continue };
            if !self.is_inner(centre, size) {
                continue;
            }
            let cross = cross(subtract(b, a), subtract(c, a));
            let area = 0.5 * length(cross);
            if area == 0.0 {
                continue;
            }
            let distance: f64 = [a, b, c].map(|p| distance(p, &f, &g).powi(2)).iter().sum();
            // Towards the second label its function falls below that of the first.
            let to = subtract(f.gradient(centre), g.gradient(centre));
            let cosine = dot(cross, to) / (length(cross) * length(to));
            let angle = cosine.clamp(-1.0, 1.0).acos().to_degrees();
            let is_flat = f.square == g.square;
            let is_near = self.functions.len() > 2 && self.junction_distance(centre) < NEAR;
            for part in [0, 1 + 2 * usize::from(is_flat) + usize::from(is_near)] {
                let [distances, angles, total] = &mut sums[part];
                *distances += area * distance / 3.0;
                *angles += area * angle * angle;
                *total += area;
            }
        }
        sums.map(|[distances, angles, total]| [distances, angles].map(|sum| (sum / total).sqrt()))
    }

    fn pair(&self, [a, b]: [usize; 2]) -> Option<[Function; 2]> {
        Some([*self.functions.get(a)?, *self.functions.get(b)?])
    }

    /// The root mean square of the distances of the junction lines.
    fn junction_error(&self, mesh: &MaterialMesh, size: usize) -> f64 {
        let (mut sum, mut total) = (0.0, 0.0);
        for line in &mesh.lines {
            let ends = line.map(|v| mesh.surface.vertices[v as usize]);
            if !ends.iter().all(|&p| self.is_inner(p, size)) {
                continue;
            }
            let length = length(subtract(ends[1], ends[0]));
            let squares: f64 = ends.map(|p| self.junction_distance(p).powi(2)).iter().sum();
            sum += 0.5 * length * squares;
            total += length;
        }
        (sum / total).sqrt()
    }

    /// The distance from a point to where the three functions that are least there are equal.
    fn junction_distance(&self, start: Point) -> f64 {
        let mut least: Vec<&Function> = self.functions.iter().collect();
        least.sort_by(|f, g| f.value(start).total_cmp(&g.value(start)));
        let [f, g, h] = [least[0], least[1], least[2]];
        let mut p = start;
        for _ in 0..4 {
            let values = [f.value(p) - g.value(p), f.value(p) - h.value(p)];
            let rows = [g, h].map(|other| subtract(f.gradient(p), other.gradient(p)));
            let [aa, ab, bb] =
                [dot(rows[0], rows[0]), dot(rows[0], rows[1]), dot(rows[1], rows[1])];
            let determinant = aa * bb - ab * ab;
            let s = (values[0] * bb - values[1] * ab) / determinant;
            let t = (values[1] * aa - values[0] * ab) / determinant;
            p = [0, 1, 2].map(|a| p[a] - s * rows[0][a] - t * rows[1][a]);
        }
        length(subtract(p, start))
    }
}

/// The distance from a point to where two functions are equal.
fn distance(start: Point, f: &Function, g: &Function) -> f64 {
    let mut p = start;
    for _ in 0..4 {
        let to = subtract(f.gradient(p), g.gradient(p));
        let step = (f.value(p) - g.value(p)) / dot(to, to);
        p = [0, 1, 2].map(|a| p[a] - step * to[a]);
    }
    length(subtract(p, start))
}

fn subtract(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| a[k] - b[k])
}

fn dot(a: Point, b: Point) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

fn unit_vector(a: Point) -> Point {
    a.map(|x| x / length(a))
}
