//! From which angle a target is heard, found in another way than the library does: small steps of the ray
//! equations, and a search for the rays that end at the target.

use shrouds::containment::{Array, Path, Sea};

/// Length of a step in metres, about.
const STEP: f64 = 25.0;

/// All angles between the axis of an array and the rays that arrive from a point `[x, y, z]` so, in degrees.
pub(crate) fn angles(sea: &Sea, array: &Array, point: [f64; 3], path: Path) -> Vec<f64> {
    let to = [point[0] - array.position[0], point[1] - array.position[1]];
    let distance = to[0].hypot(to[1]);
    let ahead = to.map(|x| x / distance);
    let plane = Plane { sea, array, ahead, distance };
    let cosine = ahead[0] * array.axis[0] + ahead[1] * array.axis[1];
    let count = 360;
    let launch = |n: f64| (n / f64::from(count) * 178.0 - 89.0).to_radians();
    let miss = |n: f64| plane.end(launch(n), path).map(|depth| depth + point[2]);
    let mut found = Vec::new();
    for n in 0..count {
        let [mut low, mut high] = [f64::from(n), f64::from(n + 1)];
        let (Some(first), Some(last)) = (miss(low), miss(high)) else { continue };
        if first * last > 0.0 {
            continue;
        }
        for _ in 0..40 {
            let middle = (low + high) / 2.0;
            match miss(middle) {
                Some(value) if value * first > 0.0 => low = middle,
                Some(_) => high = middle,
                None => break,
            }
        }
        // A jump of the depth is no ray to the target.
        if miss(low).is_some_and(|miss| miss.abs() < 0.5) {
            found.push((launch(low).cos() * cosine).acos().to_degrees());
        }
    }
    found
}

/// The vertical plane through array and target.
struct Plane<'a> {
    sea: &'a Sea,
    array: &'a Array,
    ahead: [f64; 2],
    distance: f64,
}

impl Plane<'_> {
    /// The depth at which a ray arrives that leaves the array at an angle below the horizon, if it
    /// arrives on this path.
    fn end(&self, angle: f64, path: Path) -> Option<f64> {
        let sound = self.sea.sound();
        let (mut depth, mut angle, mut at) = (self.array.depth, angle, 0.0);
        let mut bounced = false;
        let steps = (self.distance / STEP).ceil();
        let h = self.distance / steps;
        let rate = |depth: f64, angle: f64| {
            let slope = (sound.at(depth + 1e-3) - sound.at(depth - 1e-3)) / 2e-3;
            [angle.tan(), -slope / sound.at(depth)]
        };
        for _ in 0..steps as usize {
            let [fall, turn] = rate(depth, angle);
            let [fall, turn] = rate(depth + h / 2.0 * fall, angle + h / 2.0 * turn);
            let (next, floor) = (depth + h * fall, self.floor(at + h));
            if next >= floor {
                if bounced || path == Path::Direct {
                    return None;
                }
                bounced = true;
                let above = self.floor(at) - depth;
                let share = above / (above + next - floor);
                angle = 2.0 * self.slope(at + share * h).atan() - (angle + share * h * turn);
                if angle.abs() > 1.55 {
                    return None;
                }
                depth = self.floor(at + share * h) + (1.0 - share) * h * angle.tan();
            } else {
                (depth, angle) = (next, angle + h * turn);
            }
            at += h;
            if depth <= 0.0 || depth > self.floor(at) {
                return None;
            }
        }
        (bounced == (path == Path::Bounce)).then_some(depth)
    }

    /// The floor is straight between places one horizontal spacing apart, counted from the array.
    fn floor(&self, at: f64) -> f64 {
        self.straight(at, |n| self.sample(n))
    }

    fn slope(&self, at: f64) -> f64 {
        self.straight(at, |n| {
            (self.sample(n + 1.0) - self.sample(n - 1.0)) / (2.0 * self.spacing())
        })
    }

    fn straight(&self, at: f64, value: impl Fn(f64) -> f64) -> f64 {
        let n = (at / self.spacing()).floor();
        let share = at / self.spacing() - n;
        value(n) + share * (value(n + 1.0) - value(n))
    }

    fn sample(&self, n: f64) -> f64 {
        let r = n * self.spacing();
        self.sea.floor().depth([0, 1].map(|d| self.array.position[d] + r * self.ahead[d]))
    }

    fn spacing(&self) -> f64 {
        let [x, y, _] = self.sea.grid().spacing();
        x.min(y)
    }
}
