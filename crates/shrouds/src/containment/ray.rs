//! One ray of sound in a vertical plane.

use crate::containment::contact::Path;
use crate::containment::sound::{Layer, SoundSpeed};

/// A ray passes no more layers than this in a step: one that stays where two of them meet would for ever.
const MOST_LAYERS: usize = 64;
/// Sine of the steepest angle that a ray can have after a bounce; a ray that is thrown back ends.
const STEEPEST: f64 = 0.999_999;

/// The end of a ray: where it is, and its angle below the horizon.
#[derive(Debug, Clone, Copy)]
struct Ray<'a> {
    layers: &'a [Layer],
    layer: usize,
    depth: f64,
    sine: f64,
    cosine: f64,
    /// Snell's invariant, cosine over speed.
    snell: f64,
}

/// A vertical plane from the array outwards: the floor in it, step by step.
#[derive(Debug)]
pub(super) struct Section {
    /// Length of a step along the horizon.
    pub(super) step: f64,
    /// Depths at the ends of the steps, from the array on.
    floor: Vec<f64>,
    /// Growth of the depth along the plane there: its mean over two steps.
    slope: Vec<f64>,
}

impl Section {
    /// A plane with the floor `depth`, a function of the distance from the array.
    pub(super) fn new(step: f64, steps: usize, depth: impl Fn(f64) -> f64) -> Self {
        let floor: Vec<f64> = (0..steps + 3).map(|n| depth((n as f64 - 1.0) * step)).collect();
        let slope = floor.windows(3).map(|three| (three[2] - three[0]) / (2.0 * step)).collect();
        Self { step, floor: floor[1..=steps + 1].to_vec(), slope }
    }

    /// Widens `reach`, one range of depths for each step, by what a ray passes that leaves the array at `depth`
    /// with this sine of the angle below the horizon, on the legs that count for `path`. The ray ends at the
    /// surface, and at the floor where it may not or has bounced.
    pub(super) fn trace<'r>(
        &self,
        sound: &SoundSpeed,
        depth: f64,
        sine: f64,
        path: Path,
        reach: impl Iterator<Item = &'r mut [f64; 2]>,
    ) {
        let mut ray = Ray::new(sound, depth, sine);
        let mut bounced = false;
        for (n, reach) in reach.enumerate() {
            let (from, start) = (ray.depth, ray.sine);
            let mut seen = ray.advance(self.step);
            if let Some((share, hit)) = self.hit(n, from, ray.depth) {
                if counts(path, bounced) {
                    widen(reach, [from.min(hit), from.max(hit)]);
                }
                let sine = start + share * (ray.sine - start);
                let Some(up) = self.reflected(n, share, sine) else { return };
                if bounced || !path.has_bounce() {
                    return;
                }
                bounced = true;
                ray = Ray::new(sound, hit, up);
                seen = ray.advance((1.0 - share) * self.step);
            }
            let (bottom, surfaced) = (self.floor[n + 1], seen[0] <= 0.0);
            if counts(path, bounced) {
                widen(reach, [seen[0].max(0.0), seen[1].min(bottom.max(seen[0]))]);
            }
            if surfaced || ray.depth > bottom {
                return;
            }
        }
    }

    /// Where in step `n` a ray meets the floor that comes from the depth `from` and would get to `to`: which
    /// share of the step is done, and the depth.
    fn hit(&self, n: usize, from: f64, to: f64) -> Option<(f64, f64)> {
        let [start, end] = [self.floor[n], self.floor[n + 1]];
        if to < end {
            return None;
        }
        let above = (start - from).max(0.0);
        let share = if above > 0.0 { above / (above + to - end) } else { 0.0 };
        Some((share, start + share * (end - start)))
    }

    /// The sine below the horizon after a reflection; none for a ray that is thrown back.
    fn reflected(&self, n: usize, share: f64, sine: f64) -> Option<f64> {
        let slope = self.slope[n] + share * (self.slope[n + 1] - self.slope[n]);
        let angle = 2.0 * slope.atan() - sine.clamp(-1.0, 1.0).asin();
        let forward = angle.cos() > 0.0 && angle.sin().abs() < STEEPEST;
        forward.then(|| angle.sin())
    }
}

/// Whether a leg counts.
fn counts(path: Path, bounced: bool) -> bool {
    if bounced { path.has_bounce() } else { path.has_direct() }
}

fn widen(range: &mut [f64; 2], by: [f64; 2]) {
    *range = [range[0].min(by[0]), range[1].max(by[1])];
}

impl<'a> Ray<'a> {
    fn new(sound: &'a SoundSpeed, depth: f64, sine: f64) -> Self {
        let layers = sound.layers();
        let layer = sound.index(depth);
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        let snell = cosine / layers[layer].speed_at(depth);
        Self { layers, layer, depth, sine, cosine, snell }
    }

    /// Goes on by `run` along the horizon, and tells the least and the greatest depth on the way.
    ///
    /// In a layer where the speed grows by g per metre the ray is an arc of a circle. By Snell's law its
    /// sine falls by snell · g · run; and the chord has the mean direction of its ends, so that the depth
    /// grows by run · (sum of sines) / (sum of cosines), for g = 0 too.
    fn advance(&mut self, mut run: f64) -> [f64; 2] {
        let mut seen = [self.depth; 2];
        for _ in 0..MOST_LAYERS {
            let layer = self.layers[self.layer];
            let bend = self.snell * layer.gradient;
            let sine = (self.sine - bend * run).clamp(-1.0, 1.0);
            let cosine = (1.0 - sine * sine).sqrt();
            let depth = self.depth + run * (self.sine + sine) / (self.cosine + cosine);
            let turns = self.sine * sine < 0.0;
            let turn = match turns {
                true => self.depth + self.sine * self.sine / ((1.0 + self.cosine) * bend),
                false => depth,
            };
            let within = |depth: f64| depth >= layer.top && depth <= layer.bottom;
            if within(turn) {
                seen = [seen[0].min(turn), seen[1].max(turn)];
            }
            if within(turn) && within(depth) {
                seen = [seen[0].min(depth), seen[1].max(depth)];
                (self.depth, self.sine, self.cosine) = (depth, sine, cosine);
                break;
            }
            // It leaves the layer before it turns, or afterwards.
            let (out, after) = if within(turn) { (depth, sine) } else { (turn, self.sine + sine) };
            run -= self.leave(out > layer.bottom, after.signum(), bend).min(run);
            seen = [seen[0].min(self.depth), seen[1].max(self.depth)];
        }
        seen
    }

    /// Goes to the bottom or the top of the layer, to arrive there with a sine of this sign, and enters the next
    /// one. Returns the way along the horizon.
    fn leave(&mut self, down: bool, sign: f64, bend: f64) -> f64 {
        let layer = self.layers[self.layer];
        let border = if down { layer.bottom } else { layer.top };
        let cosine = (self.snell * layer.speed_at(border)).min(1.0);
        let sine = (1.0 - cosine * cosine).sqrt().copysign(sign);
        let run = if self.sine * sine < 0.0 {
            (self.sine - sine) / bend
        } else {
            (border - self.depth) * (self.cosine + cosine) / (self.sine + sine)
        };
        (self.depth, self.sine, self.cosine) = (border, sine, cosine);
        self.layer = if down { self.layer + 1 } else { self.layer - 1 };
        // Not a number where the ray just touches the border that it starts from.
        run.max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Runge–Kutta steps of the ray equations: the angle below the horizon falls by cos ε · c'/c per metre of
    /// arc, so by c'/c per metre along the horizon.
    fn by_integration(sound: &SoundSpeed, depth: f64, sine: f64, run: f64) -> [f64; 2] {
        let steps = 40_000;
        let h = run / f64::from(steps);
        let rates = |[depth, angle]: [f64; 2]| {
            let slope = (sound.at(depth + 1e-4) - sound.at(depth - 1e-4)) / 2e-4;
            [angle.tan(), -slope / sound.at(depth)]
        };
        let mut state = [depth, sine.asin()];
        for _ in 0..steps {
            let after = |rate: [f64; 2], h: f64| [0, 1].map(|n| state[n] + h * rate[n]);
            let first = rates(state);
            let second = rates(after(first, h / 2.0));
            let third = rates(after(second, h / 2.0));
            let last = rates(after(third, h));
            for n in 0..2 {
                state[n] += h / 6.0 * (first[n] + 2.0 * second[n] + 2.0 * third[n] + last[n]);
            }
        }
        [state[0], state[1].sin()]
    }

    #[test]
    fn rays_bend_as_the_equations_of_motion_say() {
        let knots = [[0.0, 1520.0], [300.0, 1490.0], [1000.0, 1480.0], [5000.0, 1550.0]];
        let sound = SoundSpeed::profile(&knots).unwrap();
        for (depth, sine) in
            [(200.0, 0.05), (200.0, -0.08), (950.0, 0.1), (1000.0, 0.0), (1500.0, -0.12)]
        {
            let mut ray = Ray::new(&sound, depth, sine);
            let mut seen = [depth; 2];
            for _ in 0..80 {
                let step = ray.advance(100.0);
                assert!(step[0] <= ray.depth && step[1] >= ray.depth);
                seen = [seen[0].min(step[0]), seen[1].max(step[1])];
            }
            let [expected, angle] = by_integration(&sound, depth, sine, 8000.0);
            assert!((ray.depth - expected).abs() < 0.2, "{depth} {sine}: {} {expected}", ray.depth);
            assert!((ray.sine - angle).abs() < 1e-4);
            let mut whole = Ray::new(&sound, depth, sine);
            let at_once = whole.advance(8000.0);
            assert!((whole.depth - ray.depth).abs() < 1e-6, "in one step as in eighty");
            assert!((0..2).all(|n| (at_once[n] - seen[n]).abs() < 1e-6));
        }
    }

    #[test]
    fn a_ray_bounces_off_a_slope_as_off_a_mirror() {
        let sound = SoundSpeed::constant(1500.0).unwrap();
        let section = Section::new(10.0, 400, |r| 1000.0 + 0.1 * r);
        let mut reach = vec![[f64::INFINITY, f64::NEG_INFINITY]; 400];
        let angle = 0.7f64;
        section.trace(&sound, 100.0, angle.sin(), Path::Bounce, reach.iter_mut());
        // 900 + 0.1 r = r tan(angle), then up at angle − 2 atan(0.1).
        let at = 900.0 / (angle.tan() - 0.1);
        let up = (angle - 2.0 * 0.1f64.atan()).tan();
        for (n, range) in reach.iter().enumerate() {
            let [from, to] = [n, n + 1].map(|n| 10.0 * n as f64);
            let depth = |r: f64| 1000.0 + 0.1 * at - up * (r - at);
            let expected = [depth(to), depth(from.max(at))];
            if to > at && expected[1] > 0.0 {
                assert!((range[0] - expected[0].max(0.0)).abs() < 1e-6, "{n}: {range:?}");
                assert!((range[1] - expected[1]).abs() < 1e-6, "{n}: {range:?}");
            } else {
                assert!(range[0] > range[1], "{n}: {range:?}");
            }
        }
    }
}
