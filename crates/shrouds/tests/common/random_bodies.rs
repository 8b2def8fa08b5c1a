//! Smooth bodies of random kind, size and spacing.
#![allow(dead_code, unreachable_pub)]

use crate::bodies::{Random, Shape};

/// A name of its kind, the body and a spacing.
pub type Sample = (&'static str, Shape, [f64; 3]);

/// Spacings from 1 to 3 in each direction.
fn spacing(random: &mut Random) -> [f64; 3] {
    match random.between(0.0, 3.0) as usize {
        0 => [1.0; 3],
        1 => [1.0, 1.0, random.between(1.0, 3.0)],
        _ => std::array::from_fn(|_| random.between(1.0, 3.0)),
    }
}

/// A number, all its logarithms equally likely.
fn scaled(random: &mut Random, low: f64, high: f64) -> f64 {
    random.between(low.ln(), high.ln()).exp()
}

fn waves(random: &mut Random, degrees: &[usize], height: f64) -> Vec<([f64; 3], usize, f64)> {
    let wave = |&degree: &usize| {
        (random.direction(), degree, random.between(-height, height) / degree as f64)
    };
    degrees.iter().map(wave).collect()
}

/// What the errors are fitted to: capsules, rounded boxes, and balls with short waves.
pub fn calibration(random: &mut Random) -> Sample {
    let spacing = spacing(random);
    let voxel = spacing.iter().product::<f64>().cbrt();
    let size = voxel * scaled(random, 4.0, 25.0);
    let (name, shape) = match random.between(0.0, 3.0) as usize {
        0 => {
            let sides = [size * random.between(0.5, 3.0), 0.0, 0.0];
            ("capsule", Shape::Rounded { sides, radius: 0.8 * size })
        }
        1 => {
            let sides = std::array::from_fn(|_| size * random.between(0.2, 1.0));
            ("rounded box", Shape::Rounded { sides, radius: 0.8 * size })
        }
        _ => {
            let waves = waves(random, &[5, 5, 6], 0.2);
            ("short waves", Shape::Wavy { radius: size, waves })
        }
    };
    (name, shape, spacing)
}

/// What they are judged on: other bodies, of 5 to `largest` voxels.
pub fn judged(random: &mut Random, largest: f64) -> Sample {
    let spacing = spacing(random);
    let voxel = spacing.iter().product::<f64>().cbrt();
    let size = voxel * scaled(random, 5.0, largest);
    let (name, shape) = match random.between(0.0, 5.0) as usize {
        0 => ("ball", Shape::ball(size)),
        1 => {
            let axes = std::array::from_fn(|_| size * random.between(0.6, 1.4));
            ("ellipsoid", Shape::Ellipsoid(axes))
        }
        2 => {
            let tube = size * random.between(0.3, 0.6);
            ("torus", Shape::Torus { ring: size, tube })
        }
        3 => {
            let axes = std::array::from_fn(|_| size * random.between(0.7, 1.2));
            ("superellipsoid", Shape::Superellipsoid { axes, power: random.between(2.2, 4.0) })
        }
        _ => {
            let waves = waves(random, &[2, 3, 3, 4], 0.4);
            ("smooth random", Shape::Wavy { radius: size, waves })
        }
    };
    (name, shape, spacing)
}
