//! Bodies whose area, volume and areas by the sign of the Gaussian curvature are known.
#![allow(dead_code, unreachable_pub, clippy::unwrap_used)]

use std::f64::consts::{PI, TAU};

use shrouds::volume::phantom;
use shrouds::{Grid, Occupancy};

/// Longitudes and latitudes of the quadrature over directions.
const LONGITUDES: usize = 240;
const LATITUDES: usize = 160;

/// A body around the origin, in world units.
#[derive(Debug, Clone)]
pub enum Shape {
    /// By its half axes.
    Ellipsoid([f64; 3]),
    /// Around the z axis, by the radii of ring and tube.
    Torus { ring: f64, tube: f64 },
    /// |x/a|ᵖ + |y/b|ᵖ + |z/c|ᵖ ≤ 1.
    Superellipsoid { axes: [f64; 3], power: f64 },
    /// A ball whose radius has waves: for each a pole, the degree of its Legendre polynomial and its
    /// height over the radius.
    Wavy { radius: f64, waves: Vec<([f64; 3], usize, f64)> },
    /// All points at most `radius` from a box with these sides: a capsule where two are 0.
    Rounded { sides: [f64; 3], radius: f64 },
}

/// What is known of a shape.
#[derive(Debug, Clone, Copy)]
pub struct Truth {
    pub area: f64,
    pub volume: f64,
    /// Areas of positive and of negative Gaussian curvature, where they are known.
    pub signs: Option<[f64; 2]>,
}

/// A shape at a place, turned.
#[derive(Debug, Clone)]
pub struct Body {
    pub shape: Shape,
    pub turn: [[f64; 3]; 3],
    pub centre: [f64; 3],
}

/// A shape of any radius, with its name.
pub type Family = (&'static str, fn(f64) -> Shape);

/// The shapes that are measured at several radii.
pub const BODIES: [Family; 3] =
    [("ball", Shape::ball), ("ellipsoid", Shape::ellipsoid), ("torus", Shape::torus)];

impl Shape {
    pub fn ball(radius: f64) -> Self {
        Self::Ellipsoid([radius; 3])
    }

    /// A level that is 0 on the surface, negative inside, and grows outwards.
    pub fn level(&self, p: [f64; 3]) -> f64 {
        let norm = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
        match self {
            Self::Ellipsoid(axes) => norm(std::array::from_fn(|k| p[k] / axes[k])) - 1.0,
            Self::Torus { ring, tube } => (p[0].hypot(p[1]) - ring).hypot(p[2]) - tube,
            Self::Superellipsoid { axes, power } => {
                let sum: f64 = (0..3).map(|k| (p[k] / axes[k]).abs().powf(*power)).sum();
                sum.powf(power.recip()) - 1.0
            }
            Self::Wavy { radius, waves } => {
                let size = norm(p);
                let height = |(pole, degree, height): &([f64; 3], usize, f64)| {
                    let cosine = (0..3).map(|k| pole[k] * p[k]).sum::<f64>() / size.max(1e-300);
                    height * legendre(*degree, cosine)
                };
                size / radius - 1.0 - waves.iter().map(height).sum::<f64>()
            }
            Self::Rounded { sides, radius } => {
                let beyond: [f64; 3] = std::array::from_fn(|k| p[k].abs() - sides[k] / 2.0);
                let deepest = beyond.into_iter().fold(f64::MIN, f64::max);
                norm(beyond.map(|x| x.max(0.0))) + deepest.min(0.0) - radius
            }
        }
    }

    /// How far from the origin it reaches.
    pub fn reach(&self) -> f64 {
        let norm = |p: [f64; 3]| p.iter().map(|x| x * x).sum::<f64>().sqrt();
        let longest = |axes: &[f64; 3]| axes.iter().fold(0.0, |a: f64, b| a.max(*b));
        match self {
            Self::Ellipsoid(axes) => longest(axes),
            Self::Torus { ring, tube } => ring + tube,
            Self::Superellipsoid { axes, .. } => 3f64.sqrt() * longest(axes),
            Self::Wavy { radius, waves } => {
                radius * (1.0 + waves.iter().map(|(_, _, height)| height.abs()).sum::<f64>())
            }
            Self::Rounded { sides, radius } => radius + 0.5 * norm(*sides),
        }
    }

    /// An ellipsoid with half axes as 1.3 : 1 : 1/1.3 and the volume of this ball.
    pub fn ellipsoid(radius: f64) -> Self {
        Self::Ellipsoid([1.3 * radius, radius, radius / 1.3])
    }

    /// A torus whose tube is 0.4 of the ring.
    pub fn torus(radius: f64) -> Self {
        Self::Torus { ring: radius, tube: 0.4 * radius }
    }

    /// The true principal curvatures near a place of the surface, for balls and tori; largest first.
    pub fn principal(&self, p: [f64; 3]) -> Option<[f64; 2]> {
        match *self {
            Self::Ellipsoid([a, b, c]) if a == b && b == c => Some([1.0 / a; 2]),
            Self::Torus { ring, tube } => {
                let outwards = p[0].hypot(p[1]) - ring;
                let cosine = outwards / outwards.hypot(p[2]);
                Some([1.0 / tube, cosine / (ring + tube * cosine)])
            }
            _ => None,
        }
    }

    pub fn truth(&self) -> Truth {
        match self {
            Self::Torus { ring, tube } => Truth {
                area: TAU * TAU * ring * tube,
                volume: TAU * PI * ring * tube * tube,
                signs: Some([
                    TAU * tube * (PI * ring + 2.0 * tube),
                    TAU * tube * (PI * ring - 2.0 * tube),
                ]),
            },
            // Steiner's formula.
            Self::Rounded { sides: [a, b, c], radius: r } => {
                let (faces, edges) = (2.0 * (a * b + b * c + c * a), PI * (a + b + c));
                Truth {
                    area: faces + 2.0 * edges * r + 2.0 * TAU * r * r,
                    volume: a * b * c + faces * r + edges * r * r + 2.0 / 3.0 * TAU * r.powi(3),
                    signs: None,
                }
            }
            _ => self.star(),
        }
    }

    /// Integrals over the directions of a star-shaped body: ρ(u)²/(u·n) and ρ³/3, n the normal.
    fn star(&self) -> Truth {
        let (mut area, mut volume) = (0.0, 0.0);
        for (cosine, weight) in gauss_legendre(LATITUDES) {
            let sine = (1.0 - cosine * cosine).sqrt();
            for n in 0..LONGITUDES {
                let angle = TAU * (n as f64 + 0.5) / LONGITUDES as f64;
                let u = [sine * angle.cos(), sine * angle.sin(), cosine];
                let radius = self.radius(u);
                let slant = self.slant(u.map(|x| radius * x), u);
                let part = weight * TAU / LONGITUDES as f64;
                area += part * radius * radius / slant;
                volume += part * radius.powi(3) / 3.0;
            }
        }
        let signs = matches!(self, Self::Ellipsoid(_)).then_some([area, 0.0]);
        Truth { area, volume, signs }
    }

    /// How far the surface is from the origin in direction `u`.
    fn radius(&self, u: [f64; 3]) -> f64 {
        match self {
            Self::Wavy { radius, .. } => radius * (1.0 - (self.level(u) - (1.0 / radius - 1.0))),
            _ => 1.0 / (self.level(u) + 1.0),
        }
    }

    /// Cosine between a direction and the normal at a point, by central differences.
    fn slant(&self, p: [f64; 3], u: [f64; 3]) -> f64 {
        let step = 1e-5 * self.reach();
        let gradient: [f64; 3] = std::array::from_fn(|k| {
            let at = |sign: f64| {
                let mut p = p;
                p[k] += sign * step;
                self.level(p)
            };
            at(1.0) - at(-1.0)
        });
        let along = (0..3).map(|k| gradient[k] * u[k]).sum::<f64>();
        along / gradient.iter().map(|x| x * x).sum::<f64>().sqrt()
    }
}

impl Body {
    /// A level as of [`Shape::level`] at a place of the world.
    pub fn level(&self, place: [f64; 3]) -> f64 {
        self.shape.level(self.own(place))
    }

    /// A place of the world in the body's own coordinates.
    pub fn own(&self, place: [f64; 3]) -> [f64; 3] {
        let p: [f64; 3] = std::array::from_fn(|k| place[k] - self.centre[k]);
        std::array::from_fn(|r| (0..3).map(|k| self.turn[k][r] * p[k]).sum())
    }

    /// The body turned at random, its centre anywhere in a voxel, and its volume.
    pub fn random(shape: Shape, spacing: [f64; 3], random: &mut Random) -> (Self, Occupancy) {
        let turn = random.turn();
        let counts = spacing.map(|step| 2 * (shape.reach() / step).ceil() as usize + 6);
        let centre =
            std::array::from_fn(|k| spacing[k] * ((counts[k] / 2) as f64 - random.uniform()));
        let body = Self { shape, turn, centre };
        let volume = body.volume(&Grid::new(counts, spacing).unwrap());
        (body, volume)
    }

    pub fn volume(&self, grid: &Grid) -> Occupancy {
        Occupancy::from_fn(grid.clone(), |index| {
            self.level(grid.point(index.map(|x| x as f64))) <= 0.0
        })
    }
}

/// A legible stream of random numbers (SplitMix64).
#[derive(Debug, Clone)]
pub struct Random(pub u64);

impl Random {
    /// In [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// A unit vector, all directions equally likely.
    pub fn direction(&mut self) -> [f64; 3] {
        let (cosine, angle) = (self.between(-1.0, 1.0), self.between(0.0, TAU));
        let sine = (1.0 - cosine * cosine).sqrt();
        [sine * angle.cos(), sine * angle.sin(), cosine]
    }

    pub fn turn(&mut self) -> [[f64; 3]; 3] {
        phantom::rotation(self.direction(), self.between(0.0, PI)).unwrap()
    }
}

fn legendre(degree: usize, x: f64) -> f64 {
    let (mut before, mut last) = (1.0, x);
    for n in 1..degree {
        let n = n as f64;
        (before, last) = (last, ((2.0 * n + 1.0) * x * last - n * before) / (n + 1.0));
    }
    if degree == 0 { 1.0 } else { last }
}

/// Nodes and weights on [−1, 1], by Newton's steps on the Legendre polynomial.
fn gauss_legendre(count: usize) -> Vec<(f64, f64)> {
    let node = |n: usize| {
        let mut x = (PI * (n as f64 + 0.75) / (count as f64 + 0.5)).cos();
        let slope = |x: f64| {
            count as f64 * (x * legendre(count, x) - legendre(count - 1, x)) / (x * x - 1.0)
        };
        (0..20).for_each(|_| x -= legendre(count, x) / slope(x));
        (x, 2.0 / ((1.0 - x * x) * slope(x).powi(2)))
    };
    (0..count).map(node).collect()
}
