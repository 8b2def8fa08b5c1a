//! Phantoms whose surface is known: how far from it a mesh lies.

use shrouds::TriMesh;
use shrouds::volume::phantom::{Rotation, rotation};
use shrouds_report::vector::{Vector, cross, dot, length, sub, unit};

/// A body whose surface is known, in world units.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Body {
    Ball {
        centre: Vector,
        radius: f64,
    },
    /// The first torus has its axis along z, the second along y.
    Tori {
        centres: [Vector; 2],
        ring: f64,
        tube: f64,
    },
    Ellipsoid {
        centre: Vector,
        half_axes: Vector,
        turn: Rotation,
    },
    Cuboid {
        centre: Vector,
        half_sides: Vector,
        turn: Rotation,
    },
    /// Known but near its crease with the ball of this radius that cuts it.
    Gyroid {
        centre: Vector,
        radius: f64,
        frequency: f64,
    },
}

/// Root mean squares over the area of a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Errors {
    /// Distance from the true surface, in world units.
    pub(crate) distance: f64,
    /// Angle between the normals of the triangles and those of the true surface, in degrees.
    pub(crate) normal: f64,
}

impl Body {
    /// The body that `shrouds::volume::phantom::named` samples under this name; a test holds the two
    /// together. None where no formula gives distances.
    pub(crate) fn of_phantom(name: &str, size: usize) -> Option<Self> {
        let n = size as f64;
        let centre = [0.137, 0.071, -0.093].map(|offset| (n - 1.0) / 2.0 + offset);
        let turn = rotation([1.0, 2.0, 3.0], 0.7).ok()?;
        Some(match name {
            "ball" => Self::Ball { centre, radius: 0.4 * n },
            "tori" => {
                let (ring, [x, y, z]) = (0.23 * n, centre);
                let first = x - ring / 2.0;
                let centres = [[first, y, z], [first + ring, y, z]];
                Self::Tori { centres, ring, tube: 0.078 * n }
            }
            "ellipsoid" => {
                Self::Ellipsoid { centre, half_axes: [0.44 * n, 0.28 * n, 0.18 * n], turn }
            }
            "box" => Self::Cuboid { centre, half_sides: [0.31 * n, 0.21 * n, 0.14 * n], turn },
            // In finer waves the feet of points are not found safely.
            "gyroid" if size >= 64 => Self::Gyroid {
                centre,
                radius: 0.46 * n,
                frequency: 16.0 * std::f64::consts::PI / n,
            },
            _ => return None,
        })
    }

    /// Signed distance of a point from the surface, negative inside, and the direction of the outer
    /// normal where the surface is nearest; none where that is not known.
    pub(crate) fn distance_and_normal(&self, p: Vector) -> Option<(f64, Vector)> {
        Some(match *self {
            Self::Ball { centre, radius } => {
                let away = sub(p, centre);
                (length(away) - radius, unit(away))
            }
            Self::Tori { centres, ring, tube } => {
                let [one, two] =
                    [(0, 2), (1, 1)].map(|(n, axis)| torus(sub(p, centres[n]), axis, ring, tube));
                if one.0 <= two.0 { one } else { two }
            }
            Self::Ellipsoid { centre, half_axes, turn } => {
                let (distance, normal) = ellipsoid(undo(&turn, sub(p, centre)), half_axes);
                (distance, redo(&turn, normal))
            }
            Self::Cuboid { centre, half_sides, turn } => {
                let (distance, normal) = cuboid(undo(&turn, sub(p, centre)), half_sides);
                (distance, redo(&turn, normal))
            }
            Self::Gyroid { centre, radius, frequency } => {
                let away = sub(p, centre);
                // The same strip is left out by tests/python/accuracy.py.
                return if length(away) < radius - 3.0 { gyroid(away, frequency) } else { None };
            }
        })
    }

    /// How far a mesh is from the surface, where that is known; none if that is nowhere.
    pub(crate) fn errors(&self, mesh: &TriMesh) -> Option<Errors> {
        let at = |p| self.distance_and_normal(p);
        let vertices: Vec<Option<f64>> =
            mesh.vertices.iter().map(|&p| at(p).map(|(distance, _)| distance)).collect();
        let [mut area, mut squared_distance, mut squared_angle] = [0.0; 3];
        for &triangle in &mesh.triangles {
            let corners = mesh.corners(triangle);
            let middle = std::array::from_fn(|k| corners.iter().map(|p| p[k]).sum::<f64>() / 3.0);
            let [a, b, c] = triangle.map(|v| vertices[v as usize]);
            let (Some(a), Some(b), Some(c), Some((of_middle, normal))) = (a, b, c, at(middle))
            else {
                continue;
            };
            let direction = cross(sub(corners[1], corners[0]), sub(corners[2], corners[0]));
            let weight = length(direction) / 2.0;
            // Exact where the distance varies linearly over the triangle.
            let squares = (a * a + b * b + c * c) / 12.0 + 0.75 * of_middle * of_middle;
            let angle = length(cross(direction, normal)).atan2(dot(direction, normal));
            area += weight;
            squared_distance += weight * squares;
            squared_angle += weight * angle * angle;
        }
        (area > 0.0).then(|| Errors {
            distance: (squared_distance / area).sqrt(),
            normal: (squared_angle / area).sqrt().to_degrees(),
        })
    }
}

fn torus(away: Vector, axis: usize, ring: f64, tube: f64) -> (f64, Vector) {
    let mut in_plane = away;
    in_plane[axis] = 0.0;
    let radial = unit(in_plane);
    let from_circle = std::array::from_fn(|k| away[k] - ring * radial[k]);
    (length(from_circle) - tube, unit(from_circle))
}

/// In the ellipsoid's own axes: the foot of `p` is `e² p / (t + e²)` for the largest t that puts it on
/// the surface (D. Eberly, Distance from a point to an ellipsoid, 2013), found by bisection.
fn ellipsoid(p: Vector, e: Vector) -> (f64, Vector) {
    // Off the planes of symmetry, where the foot of a point near the middle is not unique.
    let q: Vector = std::array::from_fn(|k| p[k].abs().max(1e-9 * e[k]));
    let reach = |t: f64| (0..3).map(|k| (e[k] * q[k] / (t + e[k] * e[k])).powi(2)).sum::<f64>();
    let mut low = (0..3).map(|k| e[k] * (q[k] - e[k])).fold(f64::NEG_INFINITY, f64::max);
    let mut high = low.abs() + length(std::array::from_fn(|k| e[k] * q[k]));
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        *if reach(middle) > 1.0 { &mut low } else { &mut high } = middle;
    }
    let foot: Vector =
        std::array::from_fn(|k| (e[k] * e[k] * q[k] / (high + e[k] * e[k])).copysign(p[k]));
    let side = if reach(0.0) < 1.0 { -1.0 } else { 1.0 };
    (side * length(sub(p, foot)), unit(std::array::from_fn(|k| foot[k] / (e[k] * e[k]))))
}

/// In the box's own axes.
fn cuboid(p: Vector, half: Vector) -> (f64, Vector) {
    let beyond: Vector = std::array::from_fn(|k| p[k].abs() - half[k]);
    let nearest = if beyond[0] >= beyond[1] && beyond[0] >= beyond[2] {
        0
    } else if beyond[1] >= beyond[2] {
        1
    } else {
        2
    };
    if beyond[nearest] <= 0.0 {
        let mut normal = [0.0; 3];
        normal[nearest] = 1f64.copysign(p[nearest]);
        return (beyond[nearest], normal);
    }
    let away: Vector = std::array::from_fn(|k| beyond[k].max(0.0).copysign(p[k]));
    (length(away), unit(away))
}

/// Distance and normal at the foot of a point on the gyroid. Newton steps lead onto the level set,
/// steps within it to where its gradient looks at the point; none if they do not, as half-way between
/// two sheets.
fn gyroid(p: Vector, frequency: f64) -> Option<(f64, Vector)> {
    let level = |q: Vector| {
        let [(a, u), (b, v), (c, w)] = q.map(|x| (x * frequency).sin_cos());
        let gradient = [u * v - c * a, v * w - a * b, w * u - b * c];
        (a * v + b * w + c * u, gradient.map(|x| x * frequency))
    };
    let mut foot = p;
    for _ in 0..4 {
        let (value, gradient) = level(foot);
        let squared = dot(gradient, gradient);
        foot = std::array::from_fn(|k| foot[k] - value / squared * gradient[k]);
        let away = sub(p, foot);
        let along = dot(away, gradient) / squared;
        foot = std::array::from_fn(|k| foot[k] + away[k] - along * gradient[k]);
    }
    let (value, gradient) = level(foot);
    let squared = dot(gradient, gradient);
    foot = std::array::from_fn(|k| foot[k] - value / squared * gradient[k]);
    // Inside the level is positive.
    let normal = unit(gradient).map(|x| -x);
    let (away, distance) = (sub(p, foot), dot(sub(p, foot), normal));
    (length(away) - distance.abs() < 0.01 / frequency).then_some((distance, normal))
}

/// World vector to a body's own axes.
fn undo(turn: &Rotation, v: Vector) -> Vector {
    std::array::from_fn(|a| turn[0][a] * v[0] + turn[1][a] * v[1] + turn[2][a] * v[2])
}

/// Back to the world.
fn redo(turn: &Rotation, v: Vector) -> Vector {
    turn.map(|row| dot(row, v))
}

#[cfg(test)]
mod tests {
    use shrouds::volume::phantom::{NAMES, named};
    use shrouds::{Settings, shroud};

    use super::*;

    /// Every lattice point of a phantom.
    fn points(size: usize) -> impl Iterator<Item = [usize; 3]> {
        (0..size.pow(3)).map(move |n| [n % size, n / size % size, n / size / size])
    }

    #[test]
    fn a_body_is_that_of_its_phantom() {
        let mut known = Vec::new();
        for name in NAMES {
            for size in [9, 24, 64] {
                let Some(body) = Body::of_phantom(name, size) else { continue };
                known.push(name);
                let volume = named(name, size).unwrap().volume;
                for index in points(size) {
                    let at = body.distance_and_normal(index.map(|i| i as f64));
                    let Some((distance, _)) = at else { continue };
                    // Half-way between two sheets a foot may be that on the wrong one.
                    if name != "gyroid" || distance.abs() < 1.0 {
                        assert_eq!(distance <= 0.0, volume.get(index), "{name} {size} {index:?}");
                    }
                }
            }
        }
        known.dedup();
        assert_eq!(known, ["tori", "ball", "ellipsoid", "box", "gyroid"]);
    }

    #[test]
    fn the_surface_lies_where_distance_and_normal_say() {
        for name in ["tori", "ball", "ellipsoid", "box", "gyroid"] {
            let size = 64;
            let body = Body::of_phantom(name, size).unwrap();
            let mut seen = 0;
            for index in points(size).step_by(29) {
                let p = index.map(|i| i as f64 + 0.3);
                let Some((distance, normal)) = body.distance_and_normal(p) else { continue };
                assert!((length(normal) - 1.0).abs() < 1e-12);
                if distance.abs() > 0.6 {
                    continue;
                }
                let step = |t: f64| std::array::from_fn(|k| p[k] + t * normal[k]);
                let Some((rest, _)) = body.distance_and_normal(step(-distance)) else { continue };
                let slack = if name == "gyroid" { 0.02 } else { 1e-6 };
                assert!(rest.abs() < slack, "{name} {p:?}: {distance} {rest}");
                seen += 1;
            }
            assert!(seen > 50, "{name}: {seen}");
        }
    }

    #[test]
    fn an_offset_ball_is_off_by_its_offset() {
        let volume = named("ball", 32).unwrap().volume;
        let mut mesh = shroud(&volume, &Settings::default()).unwrap().mesh;
        let body = Body::of_phantom("ball", 32).unwrap();
        let Body::Ball { centre, radius } = body else { unreachable!() };
        let errors = body.errors(&mesh).unwrap();
        assert!(errors.distance < 0.05 && errors.normal < 3.0, "{errors:?}");
        for vertex in &mut mesh.vertices {
            let out = unit(sub(*vertex, centre));
            *vertex = std::array::from_fn(|k| centre[k] + (radius + 0.4) * out[k]);
        }
        let errors = body.errors(&mesh).unwrap();
        // Flat triangles lie a little within the sphere.
        assert!((errors.distance - 0.4).abs() < 0.03, "{errors:?}");
        mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
        assert!(body.errors(&mesh).unwrap().normal > 175.0);
        assert_eq!(body.errors(&TriMesh::default()), None);
    }
}
