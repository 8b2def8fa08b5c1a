//! Random numbers, and scenes made of them.

use shrouds::Grid;
use shrouds::containment::{Floor, Sea, SoundSpeed, Terrain, Track, Waypoint};

/// Numbers that depend on the seed alone.
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x2545_f491_4f6c_dd1d) ^ 0x9e37_79b9_7f4a_7c15)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() >> 16) as usize % count
    }
}

/// Half the side of the sea, in metres.
pub(crate) const HALF: f64 = 3000.0;

/// A lattice of the sea down to 2400 m, its highest layer at the surface.
pub(crate) fn lattice(horizontal: [f64; 2], vertical: f64) -> Grid {
    let [nx, ny] = horizontal.map(|step| (2.0 * HALF / step) as usize + 1);
    let nz = (2400.0 / vertical) as usize + 1;
    let bottom = -((nz - 1) as f64) * vertical;
    let affine = [
        [horizontal[0], 0.0, 0.0, -HALF],
        [0.0, horizontal[1], 0.0, -HALF],
        [0.0, 0.0, vertical, bottom],
    ];
    Grid::with_affine([nx, ny, nz], affine).unwrap()
}

/// A sea with a floor and water of the given kinds, 0 to 3 and 0 to 2.
pub(crate) fn sea(random: &mut Random, floor: usize, water: usize) -> Sea {
    let depth = random.between(1500.0, 2000.0);
    let floor = match floor {
        0 => Floor::flat(depth),
        1 => Floor::Plane { depth, slope: [0, 1].map(|_| random.between(-0.07, 0.07)) },
        2 => Floor::Ridge {
            depth,
            height: random.between(-300.0, 600.0),
            width: random.between(500.0, 1500.0),
            through: [0, 1].map(|_| random.between(-1500.0, 1500.0)),
            course: random.between(0.0, 360.0),
        },
        _ => {
            let seed = random.below(1000) as u64;
            let terrain = Terrain { depth, relief: 300.0, longest: 4000.0, shortest: 1000.0, seed };
            terrain.floor([[-1.5 * HALF; 2], [1.5 * HALF; 2]]).unwrap()
        }
    };
    let sound = match water {
        0 => SoundSpeed::constant(1500.0),
        1 => SoundSpeed::profile(&[[0.0, 1530.0], [2500.0, 1480.0]]),
        _ => SoundSpeed::profile(&[
            [0.0, 1525.0],
            [250.0, 1495.0],
            [900.0, 1482.0],
            [3000.0, 1520.0],
        ]),
    };
    let horizontal = [0, 1].map(|_| random.between(110.0, 170.0));
    Sea::new(lattice(horizontal, random.between(70.0, 110.0)), floor, sound.unwrap()).unwrap()
}

/// An array on its way for half an hour.
pub(crate) fn track(random: &mut Random) -> Track {
    let mut position = [0, 1].map(|_| random.between(-1500.0, 1500.0));
    let waypoints = (0..4).map(|n| {
        let point = Waypoint {
            time: 600.0 * f64::from(n),
            position,
            depth: random.between(50.0, 500.0),
            course: None,
        };
        position = position.map(|x| x + random.between(-900.0, 900.0));
        point
    });
    Track::new(waypoints.collect()).unwrap()
}
