//! From where the scene is seen.

use crate::error::{Error, require};
use crate::vector::{Vector, is_finite};

/// An axis of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Axis {
    /// Along x.
    X,
    /// Along y.
    Y,
    /// Along z.
    #[default]
    Z,
}

/// How depth acts on size.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Projection {
    /// Parallel rays: equal lengths look equal everywhere.
    #[default]
    Orthographic,
    /// Rays through one eye, as far away as makes the scene's bounding sphere fill `angle`.
    Perspective {
        /// Field of view in degrees, 1 to 120.
        angle: f64,
    },
}

/// Directions from which one usually looks; named for z upwards and the viewer of the front at −y.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum View {
    /// From −y, with x to the right.
    Front,
    /// From +y.
    Back,
    /// From −x.
    Left,
    /// From +x.
    Right,
    /// From +z, with x to the right and y upwards.
    Top,
    /// From −z, with x to the right.
    Bottom,
    /// From (1, −1, 1): the three axes look equally long.
    Isometric,
}

/// A viewer. The scene always fits the picture: only the direction needs choosing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Direction of the viewer around the up axis, in degrees: 0 on the next axis after it (+x for
    /// z upwards), 90 on the one after that (+y).
    pub azimuth: f64,
    /// Height of the viewer above the plane across the up axis, −90 to 90 degrees.
    pub elevation: f64,
    /// The axis that points upwards.
    pub up: Axis,
    /// Parallel or through one eye.
    pub projection: Projection,
    /// Magnification about the middle of the picture; 1 fits the frame.
    pub zoom: f64,
    /// Smallest and largest corner of a box, in world coordinates, that fits the picture instead of
    /// the scene itself: give it to see several scenes at the same scale.
    pub frame: Option<[[f64; 3]; 2]>,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            azimuth: -60.0,
            elevation: 30.0,
            up: Axis::Z,
            projection: Projection::Orthographic,
            zoom: 1.0,
            frame: None,
        }
    }
}

impl Camera {
    /// The same camera looking from a usual direction.
    #[must_use]
    pub fn view(mut self, view: View) -> Self {
        (self.azimuth, self.elevation) = match view {
            View::Front => (-90.0, 0.0),
            View::Back => (90.0, 0.0),
            View::Left => (180.0, 0.0),
            View::Right => (0.0, 0.0),
            View::Top => (-90.0, 90.0),
            View::Bottom => (-90.0, -90.0),
            View::Isometric => (-45.0, 0.5f64.sqrt().atan().to_degrees()),
        };
        self
    }

    pub(crate) fn check(&self) -> Result<(), Error> {
        require(self.azimuth.is_finite(), "the azimuth", self.azimuth, "a number of degrees")?;
        let range = "between -90 and 90 degrees";
        require(self.elevation.abs() <= 90.0, "the elevation", self.elevation, range)?;
        let zooms = self.zoom > 0.0 && self.zoom.is_finite();
        require(zooms, "the zoom", self.zoom, "positive and finite")?;
        if let Projection::Perspective { angle } = self.projection {
            let range = "between 1 and 120 degrees";
            require((1.0..=120.0).contains(&angle), "the field of view", angle, range)?;
        }
        if let Some([low, high]) = self.frame {
            let ordered = is_finite(low) && is_finite(high) && (0..3).all(|i| low[i] <= high[i]);
            let range = "finite, its first corner nowhere above its second";
            require(ordered, "the camera's frame", [low, high], range)?;
        }
        Ok(())
    }

    /// Unit vectors to the right, upwards and towards the viewer.
    pub(crate) fn basis(&self) -> [Vector; 3] {
        let ((sin_a, cos_a), (sin_e, cos_e)) = (sin_cos(self.azimuth), sin_cos(self.elevation));
        let right = [-sin_a, cos_a, 0.0];
        let up = [-sin_e * cos_a, -sin_e * sin_a, cos_e];
        let back = [cos_e * cos_a, cos_e * sin_a, sin_e];
        // Which world axis comes first when the last one is to be the up axis.
        let shift = match self.up {
            Axis::Z => 0,
            Axis::X => 2,
            Axis::Y => 1,
        };
        [right, up, back].map(|v| std::array::from_fn(|i| v[(i + shift) % 3]))
    }
}

/// Sine and cosine of an angle in degrees, rounded so that right angles are exact and mathematics
/// libraries that differ in the last bit agree.
fn sin_cos(degrees: f64) -> (f64, f64) {
    let round = |x: f64| (x * 2f64.powi(40)).round() / 2f64.powi(40);
    let (sin, cos) = degrees.to_radians().sin_cos();
    (round(sin), round(cos))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::{cross, length, sub};

    const ALL: [View; 7] = [
        View::Front,
        View::Back,
        View::Left,
        View::Right,
        View::Top,
        View::Bottom,
        View::Isometric,
    ];

    #[test]
    fn every_view_is_a_right_handed_frame_with_up_upwards() {
        for up in [Axis::X, Axis::Y, Axis::Z] {
            for view in ALL {
                let camera = Camera { up, ..Camera::default() }.view(view);
                let [right, above, back] = camera.basis();
                assert!(length(sub(cross(right, above), back)) < 1e-11);
                assert!((length(back) - 1.0).abs() < 1e-11);
                assert_eq!(right[up as usize], 0.0);
                assert!(above[up as usize] >= 0.0);
            }
        }
    }

    #[test]
    fn views_look_from_where_they_say() {
        let basis = |view| Camera::default().view(view).basis();
        assert_eq!(basis(View::Top), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert_eq!(basis(View::Front), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]);
        assert_eq!(basis(View::Right)[2], [1.0, 0.0, 0.0]);
        let [right, up, _] = basis(View::Isometric);
        let lengths = [0, 1, 2].map(|axis: usize| right[axis].hypot(up[axis]));
        assert!(lengths.iter().all(|l| (l - lengths[0]).abs() < 1e-11));
        let sideways = Camera { up: Axis::Y, azimuth: 0.0, elevation: 0.0, ..Camera::default() };
        assert_eq!(sideways.basis(), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    }
}
