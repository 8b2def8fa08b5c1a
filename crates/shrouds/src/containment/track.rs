//! Where the array is, and which way it points.

use crate::error::Error;
use crate::vector::subtract;

/// A place on the way of the array.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// In seconds.
    pub time: f64,
    /// x and y in metres.
    pub position: [f64; 2],
    /// In metres below the surface.
    pub depth: f64,
    /// Where the array's axis points, in degrees from north over east; without it, along the way to the next
    /// waypoint, or at the last one from the one before.
    pub course: Option<f64>,
}

/// The way of the array: straight between waypoints, at constant speed. A single waypoint is an array at
/// rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Track {
    waypoints: Vec<Waypoint>,
}

/// The array at some time. Its axis is level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Array {
    /// x and y in metres.
    pub position: [f64; 2],
    /// In metres below the surface.
    pub depth: f64,
    /// Unit vector of the axis, along x and y.
    pub axis: [f64; 2],
}

impl Track {
    /// A way through waypoints.
    ///
    /// # Errors
    /// [`Error::Scene`] unless there are waypoints, their times ascend, their numbers are finite, and each has
    /// a course or another place before or after it.
    pub fn new(waypoints: Vec<Waypoint>) -> Result<Self, Error> {
        let wrong = |n: usize, problem: &str| {
            let part = format!("waypoint {} of the platform", n + 1);
            Error::Scene { part, problem: problem.into() }
        };
        if waypoints.is_empty() {
            return Err(wrong(0, "there is none: give a time, a position and a depth"));
        }
        let track = Self { waypoints };
        for (n, point) in track.waypoints.iter().enumerate() {
            let numbers = [point.time, point.position[0], point.position[1], point.depth];
            if !numbers.iter().chain(&point.course).all(|x| x.is_finite()) {
                return Err(wrong(n, "it has a number that is not finite"));
            }
            if n > 0 && point.time <= track.waypoints[n - 1].time {
                return Err(wrong(n, "it is not later than the one before: let times ascend"));
            }
            if track.axis(n).is_none() {
                return Err(wrong(n, "the array does not move here: give a course"));
            }
        }
        Ok(track)
    }

    /// The waypoints.
    pub fn waypoints(&self) -> &[Waypoint] {
        &self.waypoints
    }

    /// The array at a time, which lies between those of the first and the last waypoint; an array at rest is
    /// there at any time.
    pub fn at(&self, time: f64) -> Option<Array> {
        let points = &self.waypoints;
        let next = points.partition_point(|point| point.time <= time);
        let (from, to) = match (next, points.get(next)) {
            _ if points.len() == 1 => (0, points[0]),
            (0, _) => return None,
            (_, Some(&to)) => (next - 1, to),
            (_, None) if points[next - 1].time == time => (next - 1, points[next - 1]),
            (_, None) => return None,
        };
        let start = points[from];
        let duration = to.time - start.time;
        let share = if duration > 0.0 { (time - start.time) / duration } else { 0.0 };
        let between = |a: f64, b: f64| a + share * (b - a);
        Some(Array {
            position: [0, 1].map(|d| between(start.position[d], to.position[d])),
            depth: between(start.depth, to.depth),
            axis: self.axis(from)?,
        })
    }

    /// The axis from waypoint `n` on.
    fn axis(&self, n: usize) -> Option<[f64; 2]> {
        let points = &self.waypoints;
        if let Some(course) = points[n].course {
            let (sin, cos) = course.to_radians().sin_cos();
            return Some([sin, cos]);
        }
        let ahead = n.min(points.len().saturating_sub(2));
        let [x, y] = subtract(points.get(ahead + 1)?.position, points[ahead].position);
        let length = x.hypot(y);
        (length > 0.0).then(|| [x / length, y / length])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(time: f64, position: [f64; 2], course: Option<f64>) -> Waypoint {
        Waypoint { time, position, depth: 100.0 + time, course }
    }

    #[test]
    fn the_array_follows_its_way() {
        let points = vec![
            point(0.0, [0.0, 0.0], None),
            point(10.0, [40.0, 30.0], Some(90.0)),
            point(20.0, [40.0, 10.0], None),
        ];
        let track = Track::new(points).unwrap();
        let array = track.at(5.0).unwrap();
        assert_eq!((array.position, array.depth), ([20.0, 15.0], 105.0));
        assert!((array.axis[0] - 0.8).abs() < 1e-12 && (array.axis[1] - 0.6).abs() < 1e-12);
        let turned = track.at(15.0).unwrap().axis;
        assert!((turned[0] - 1.0).abs() < 1e-12 && turned[1].abs() < 1e-12);
        assert_eq!(track.at(20.0).unwrap().axis, [0.0, -1.0]);
        assert_eq!((track.at(-1.0), track.at(20.5)), (None, None));
        let still = Track::new(vec![point(3.0, [1.0, 2.0], Some(180.0))]).unwrap();
        assert_eq!(still.at(1e6).unwrap().position, [1.0, 2.0]);
    }

    #[test]
    fn ways_that_lead_nowhere_are_refused() {
        let at = |time| point(time, [time, 0.0], None);
        for (number, wrong) in [
            vec![],
            vec![at(0.0)],
            vec![at(0.0), at(0.0)],
            vec![at(0.0), point(1.0, [0.0; 2], None)],
            vec![at(f64::NAN), at(1.0)],
        ]
        .into_iter()
        .enumerate()
        {
            assert!(matches!(Track::new(wrong), Err(Error::Scene { .. })), "{number}");
        }
    }
}
