//! The map from world to screen.

use crate::camera::{Camera, Projection};
use crate::error::Error;
use crate::scene::Scene;
use crate::shade::Style;
use crate::vector::{Vector, dot, length, sub};

/// A point as it appears on the screen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Placed {
    /// Samples from the left edge of the picture.
    pub(crate) x: f64,
    /// Samples from the top edge of the picture.
    pub(crate) y: f64,
    /// Grows towards the viewer, and is linear across the screen on straight lines and planes.
    pub(crate) nearness: f64,
    /// In view coordinates: right, up, towards the viewer, in units of the scene's size.
    pub(crate) view: Vector,
}

/// The map from world to screen.
///
/// World coordinates are first brought to about [−1, 1] (any offset and unit of length works), then
/// turned, projected, scaled and shifted.
#[derive(Debug, Clone)]
pub(crate) struct Lens {
    centre: Vector,
    size: f64,
    basis: [Vector; 3],
    /// From the eye to the centre; none for parallel rays.
    distance: Option<f64>,
    scale: f64,
    shift: [f64; 2],
}

/// Largest distance of a sample from the picture's corner that fixed-point rasterising allows.
const LIMIT: f64 = (1 << 21) as f64;

impl Lens {
    /// The lens for a picture of this style; none if there is nothing to see.
    pub(crate) fn of(scene: &Scene, camera: &Camera, style: &Style) -> Result<Option<Self>, Error> {
        let side = |pixels: u32| f64::from(pixels) * f64::from(style.samples);
        Self::new(scene, camera, [side(style.width), side(style.height)], style.margin)
    }

    /// The lens that fits the scene (or the camera's frame) into `width × height` samples, less a
    /// margin on each side that is a fraction of the shorter one. None if there is nothing to see.
    pub(crate) fn new(
        scene: &Scene,
        camera: &Camera,
        size: [f64; 2],
        margin: f64,
    ) -> Result<Option<Self>, Error> {
        camera.check()?;
        let Some(whole) = bounds(scene.points()) else { return Ok(None) };
        let mut lens = Self::around(camera.frame.unwrap_or(whole), camera);
        lens.distance = lens.eye(scene, camera);
        lens.fit(scene, camera, size, margin);
        let inside = |p| {
            let placed = lens.place(p);
            placed.x.abs() < LIMIT && placed.y.abs() < LIMIT
        };
        if scene.points().all(inside) { Ok(Some(lens)) } else { Err(Error::TooClose) }
    }

    /// Looks at the middle of a box along parallel rays, neither scaled nor shifted.
    fn around([low, high]: [Vector; 2], camera: &Camera) -> Self {
        // Halves first: the sum or difference of two large numbers may not be one.
        let centre = std::array::from_fn(|i| low[i] / 2.0 + high[i] / 2.0);
        let size = (0..3).map(|i| high[i] / 2.0 - low[i] / 2.0).fold(0.0, f64::max);
        Self {
            centre,
            size: if size > 0.0 { size } else { 1.0 },
            basis: camera.basis(),
            distance: None,
            scale: 1.0,
            shift: [0.0; 2],
        }
    }

    /// Distance of the eye from the centre, if the camera has one. The eye is outside all that is
    /// drawn, so that nothing needs clipping.
    fn eye(&self, scene: &Scene, camera: &Camera) -> Option<f64> {
        let Projection::Perspective { angle } = camera.projection else { return None };
        let farthest = |so_far: f64, p| so_far.max(length(self.normalised(p)));
        let reach = scene.points().fold(0.0, farthest);
        let framed = camera.frame.map_or(reach, |frame| corners(frame).fold(0.0, farthest));
        let distance = (framed / (angle / 2.0).to_radians().sin()).max(reach * 1.1);
        Some(if distance > 0.0 { distance } else { 1.0 })
    }

    /// Scale and shift so that the projection of the scene or frame fits.
    fn fit(&mut self, scene: &Scene, camera: &Camera, [width, height]: [f64; 2], margin: f64) {
        let flat = |p| {
            let placed = self.place(p);
            [placed.x, placed.y, 0.0]
        };
        let projected = match camera.frame {
            Some(frame) => bounds(corners(frame).map(flat)),
            None => bounds(scene.points().map(flat)),
        };
        let [low, high] = projected.unwrap_or_default();
        let free = |side: f64| side - 2.0 * margin * width.min(height);
        let fit = (free(width) / (high[0] - low[0])).min(free(height) / (high[1] - low[1]));
        // Seen as a single point there is nothing to scale.
        self.scale = if fit.is_finite() { fit * camera.zoom } else { 1.0 };
        self.shift = [
            width / 2.0 - (low[0] + high[0]) / 2.0 * self.scale,
            height / 2.0 - (low[1] + high[1]) / 2.0 * self.scale,
        ];
    }

    fn normalised(&self, point: Vector) -> Vector {
        sub(point, self.centre).map(|x| x / self.size)
    }

    /// Samples that a world unit of length across parallel rays is long.
    pub(crate) fn samples_per_unit(&self) -> f64 {
        self.scale / self.size
    }

    /// A world direction, seen by the viewer.
    #[inline]
    pub(crate) fn turned(&self, direction: Vector) -> Vector {
        self.basis.map(|axis| dot(axis, direction))
    }

    /// Where a point of the world appears.
    #[inline]
    pub(crate) fn place(&self, point: Vector) -> Placed {
        let view = self.turned(self.normalised(point));
        let (stretch, nearness) = match self.distance {
            None => (self.scale, view[2]),
            Some(distance) => {
                let nearness = distance / (distance - view[2]);
                (self.scale * nearness, nearness)
            }
        };
        Placed {
            x: self.shift[0] + view[0] * stretch,
            y: self.shift[1] - view[1] * stretch,
            nearness,
            view,
        }
    }

    /// The nearness of the same point moved towards the viewer by a length as long as so many
    /// samples, though not by more than a fiftieth of the scene.
    pub(crate) fn nearer(&self, placed: &Placed, samples: f64) -> f64 {
        let z = placed.view[2] + (samples / self.scale).min(0.02);
        match self.distance {
            None => z,
            Some(distance) => distance / (distance - z),
        }
    }

    /// Direction from a point in view coordinates to the eye; its length has no meaning.
    pub(crate) fn to_eye(&self, view: Vector) -> Vector {
        match self.distance {
            None => [0.0, 0.0, 1.0],
            Some(distance) => sub([0.0, 0.0, distance], view),
        }
    }

    /// What each corner of a triangle weighs when values are blended across it on the screen.
    pub(crate) fn weights(&self, corners: &[Placed; 3]) -> Vector {
        match self.distance {
            None => [1.0; 3],
            Some(_) => corners.each_ref().map(|corner| corner.nearness),
        }
    }
}

/// The smallest box around points.
fn bounds(points: impl Iterator<Item = Vector>) -> Option<[Vector; 2]> {
    points.fold(None, |so_far, p| {
        let [low, high] = so_far.unwrap_or([p, p]);
        Some([
            std::array::from_fn(|i| low[i].min(p[i])),
            std::array::from_fn(|i| high[i].max(p[i])),
        ])
    })
}

/// The eight corners of a box.
fn corners([low, high]: [Vector; 2]) -> impl Iterator<Item = Vector> {
    (0..8).map(move |c| [0, 1, 2].map(|i| if c >> i & 1 == 0 { low[i] } else { high[i] }))
}

#[cfg(test)]
mod tests {
    use shrouds::TriMesh;

    use super::*;
    use crate::vector::add;

    #[test]
    fn lines_stay_straight_and_nearness_linear() {
        let mesh = TriMesh {
            vertices: vec![[3.0, 1.0, 0.0], [0.0, 7.0, 1.0], [1.0, 0.0, 5.0]],
            triangles: vec![[0, 1, 2]],
            normals: vec![],
        };
        let scene = Scene::new(&mesh);
        for projection in [Projection::Orthographic, Projection::Perspective { angle: 70.0 }] {
            let camera = Camera { projection, ..Camera::default() };
            let lens = Lens::new(&scene, &camera, [300.0, 200.0], 0.1).unwrap().unwrap();
            let ends = [mesh.vertices[0], mesh.vertices[2]];
            let middle = lens.place(add(ends[0], ends[1]).map(|x| x / 2.0));
            let [a, b] = ends.map(|p| lens.place(p));
            let t = (middle.x - a.x) / (b.x - a.x);
            assert!((a.y + t * (b.y - a.y) - middle.y).abs() < 1e-9);
            let nearness = a.nearness + t * (b.nearness - a.nearness);
            assert!((nearness - middle.nearness).abs() < 1e-12);
            assert!(lens.nearer(&middle, 3.0) > middle.nearness);
        }
    }
}
