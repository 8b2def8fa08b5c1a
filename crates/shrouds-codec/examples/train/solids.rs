//! Random solids: lumps and sheets of random waves, smooth and sharp bodies put together, each with
//! or without noise, uneven slices and other spacings.

use std::f64::consts::TAU;

use shrouds::{Error, Grid, Occupancy};

/// Random numbers, the same for a seed (SplitMix64; Steele, Lea and Flood, 2014).
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d))
    }

    /// A number in [0, 1).
    pub(crate) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        (mixed(self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A number between two, whose logarithm is uniform.
    fn scale(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }

    fn chance(&mut self, share: f64) -> bool {
        self.next() < share
    }

    fn direction(&mut self) -> [f64; 3] {
        let z = self.within(-1.0, 1.0);
        let angle = TAU * self.next();
        let around = (1.0 - z * z).sqrt();
        [around * angle.cos(), around * angle.sin(), z]
    }

    /// Three axes at right angles.
    fn axes(&mut self) -> [[f64; 3]; 3] {
        let a = self.direction();
        let b = self.direction();
        let c = unit(cross(a, b));
        [a, cross(c, a), c]
    }
}

fn mixed(state: u64) -> u64 {
    let mut z = state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn unit(a: [f64; 3]) -> [f64; 3] {
    let length = dot(a, a).sqrt().max(1e-9);
    a.map(|x| x / length)
}

/// A function of the place that is positive inside; about a distance in voxels near the surface.
type Field = Box<dyn Fn([f64; 3]) -> f64 + Sync>;

/// A random solid on a random lattice.
pub(crate) fn random_solid(random: &mut Random) -> Result<Occupancy, Error> {
    let dims: [usize; 3] = std::array::from_fn(|_| random.within(40.0, 110.0) as usize);
    let size = dims.iter().product::<usize>() as f64;
    let size = size.cbrt();
    let centre = dims.map(|n| (n as f64 - 1.0) / 2.0 + random.within(-0.5, 0.5));
    let mut field: Field = match (random.next() * 5.0) as u32 {
        0 => lump(random, centre, size),
        1 => ground(random),
        2 => sheet(random),
        _ => bodies(random, centre, size),
    };
    if random.chance(0.5) {
        let amount = random.scale(0.15, 1.0);
        let detail = waves(random, 24, 2.5, 14.0, 0.5);
        field = Box::new(move |p| field(p) + amount * detail(p));
    }
    if random.chance(0.25) {
        field = uneven_slices(random, field);
    }
    let stretch: [f64; 3] =
        std::array::from_fn(|_| if random.chance(0.3) { random.within(0.5, 1.6) } else { 1.0 });
    let noise = if random.chance(0.3) { random.scale(0.05, 0.6) } else { 0.0 };
    let seed = (random.next() * 1e15) as u64;
    let grid = Grid::new(dims, [1.0; 3])?;
    Ok(Occupancy::from_fn(grid, move |index| {
        let place: [f64; 3] =
            std::array::from_fn(|c| (index[c] as f64 - centre[c]) * stretch[c] + centre[c]);
        let value = field(place);
        if noise == 0.0 || value.abs() > 4.0 * noise {
            return value > 0.0;
        }
        let number = index.iter().fold(seed, |state, &i| mixed(state ^ i as u64));
        value + noise * ((number >> 11) as f64 / (1u64 << 51) as f64 - 2.0) > 0.0
    }))
}

/// A sum of waves of random directions with wavelengths between two; `fall` tells how much less
/// short waves count. Its root mean square is 1.
fn waves(random: &mut Random, count: usize, shortest: f64, longest: f64, fall: f64) -> Field {
    let waves: Vec<([f64; 3], f64, f64)> = (0..count)
        .map(|_| {
            let length = random.scale(shortest, longest);
            let direction = random.direction().map(|x| x * TAU / length);
            (direction, TAU * random.next(), length.powf(fall))
        })
        .collect();
    let power: f64 = waves.iter().map(|(_, _, amount)| amount * amount / 2.0).sum();
    let norm = power.sqrt().recip();
    Box::new(move |p| {
        norm * waves
            .iter()
            .map(|(k, phase, amount)| amount * (dot(*k, p) + phase).sin())
            .sum::<f64>()
    })
}

/// A ball with a rough surface.
fn lump(random: &mut Random, centre: [f64; 3], size: f64) -> Field {
    let radius = size * random.within(0.2, 0.4);
    let amount = size * random.scale(0.02, 0.2);
    let (shortest, fall) = (random.scale(4.0, 15.0), random.within(0.6, 2.2));
    let rough = waves(random, 40, shortest, size, fall);
    Box::new(move |p| {
        let offset: [f64; 3] = std::array::from_fn(|c| p[c] - centre[c]);
        radius - dot(offset, offset).sqrt() + amount * rough(p)
    })
}

/// Waves cut off at a height, up to the border of the lattice.
fn ground(random: &mut Random) -> Field {
    let shortest = random.scale(5.0, 20.0);
    let (longest, fall) = (shortest * random.within(1.5, 5.0), random.within(0.3, 2.0));
    let field = waves(random, 40, shortest, longest, fall);
    let level = random.within(-0.8, 0.8);
    Box::new(move |p| shortest / 3.0 * (field(p) - level))
}

/// A layer of some thickness around where waves are 0.
fn sheet(random: &mut Random) -> Field {
    let shortest = random.scale(9.0, 25.0);
    let fall = random.within(0.5, 1.5);
    let field = waves(random, 24, shortest, 3.0 * shortest, fall);
    let thickness = random.within(0.7, 3.5);
    Box::new(move |p| thickness - (shortest / 3.0 * field(p)).abs())
}

/// Several bodies, joined, cut and blended.
fn bodies(random: &mut Random, centre: [f64; 3], size: f64) -> Field {
    let blend = if random.chance(0.5) { random.within(0.3, 8.0) } else { 0.0 };
    let first = size * random.within(0.15, 0.35);
    let mut whole = body(random, centre, first);
    for _ in 0..random.within(1.0, 9.0) as usize {
        let place = std::array::from_fn(|c| centre[c] + size * random.within(-0.35, 0.35));
        let size = size * random.scale(0.04, 0.25);
        let next = body(random, place, size);
        let cut = random.chance(0.35);
        whole = Box::new(move |p| {
            let (a, b) = (whole(p), next(p));
            if cut { -joined(-a, b, blend) } else { joined(a, b, blend) }
        });
    }
    whole
}

/// The larger of two, rounded off where they are alike.
fn joined(a: f64, b: f64, blend: f64) -> f64 {
    let overlap = (blend - (a - b).abs()).max(0.0);
    a.max(b) + if blend > 0.0 { overlap * overlap / (4.0 * blend) } else { 0.0 }
}

/// An ellipsoid, a box, a tube, a ring or a cone.
fn body(random: &mut Random, centre: [f64; 3], size: f64) -> Field {
    let axes = random.axes();
    let half: [f64; 3] = std::array::from_fn(|_| (size * random.within(0.3, 1.2)).max(0.8));
    let kind = (random.next() * 6.0) as u32;
    Box::new(move |p| {
        let offset = std::array::from_fn(|c| p[c] - centre[c]);
        let [x, y, z] = axes.map(|axis| dot(axis, offset));
        let around = x.hypot(y);
        match kind {
            0 | 1 => {
                let scaled = [x / half[0], y / half[1], z / half[2]];
                let slope = [scaled[0] / half[0], scaled[1] / half[1], scaled[2] / half[2]];
                let radius = dot(scaled, scaled).sqrt();
                radius * (1.0 - radius) / dot(slope, slope).sqrt().max(1e-6)
            }
            2 => (half[0] - x.abs()).min(half[1] - y.abs()).min(half[2] - z.abs()),
            3 => (half[0] - around).min(half[2] * 1.5 - z.abs()),
            4 => half[0] * 0.4 - (around - half[1]).hypot(z),
            _ => ((half[2] - z) * 0.5 - around * 0.8).min(z + half[2]),
        }
    })
}

/// The field shifted a little from slice to slice, as when slices are drawn by hand.
fn uneven_slices(random: &mut Random, field: Field) -> Field {
    let axis = (random.next() * 3.0) as usize;
    let amount = random.scale(0.2, 1.2);
    let length = random.within(6.0, 20.0);
    let seed = (random.next() * 1e15) as u64;
    Box::new(move |p| {
        let slice = p[axis].round() as i64 as u64;
        let number =
            |n: u64| (mixed(seed ^ mixed(slice ^ n << 40)) >> 11) as f64 / (1u64 << 53) as f64;
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let angle = TAU * number(1);
        let along = (angle.cos() * p[u] + angle.sin() * p[v]) / length;
        field(p) + amount * (TAU * (along + number(2))).sin()
    })
}
