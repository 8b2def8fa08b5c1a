//! Which colour each triangle and line has where.

use crate::error::Error;
use crate::lens::{Lens, Placed};
use crate::line::stroke;
use crate::raster::Band;
use crate::scene::{Colours, Scene, finite};
use crate::shade::{Gamma, Sample, Shading, Style, lit};
use crate::vector::{Vector, add, blend, cross, dot, length, scaled, sub};

/// All it takes to fill a band.
pub(crate) struct Painter<'a> {
    scene: &'a Scene<'a>,
    style: &'a Style,
    lens: &'a Lens,
    gamma: &'a Gamma,
    /// Vertex normals in view coordinates; empty for flat shading.
    normals: Vec<Vector>,
}

impl<'a> Painter<'a> {
    pub(crate) fn new(
        scene: &'a Scene<'a>,
        style: &'a Style,
        lens: &'a Lens,
        gamma: &'a Gamma,
    ) -> Result<Self, Error> {
        let normals = match style.shading {
            Shading::Flat => Vec::new(),
            Shading::Smooth => vertex_normals(scene, lens)?,
        };
        Ok(Self { scene, style, lens, gamma, normals })
    }

    /// Fill a band with what it shows of the scene.
    pub(crate) fn paint(&self, band: &mut Band) {
        for (index, &triangle) in self.scene.mesh.triangles.iter().enumerate() {
            let corners = self.scene.corners(triangle).map(|p| self.lens.place(p));
            band.triangle(&corners, || self.shade(index, &corners));
        }
        for set in &self.scene.lines {
            let colour = self.gamma.sample(set.colour);
            let width = f64::from(set.width) * f64::from(self.style.samples);
            for &segment in &set.segments {
                let ends = segment.map(|p| self.lens.place(p));
                stroke(band, self.lens, ends, width, colour);
            }
        }
    }

    /// The colour of a triangle from the weights of its corners; none if it has no area.
    fn shade(&self, index: usize, corners: &[Placed; 3]) -> Option<impl Fn([i64; 3]) -> Sample> {
        let [a, b, c] = corners.each_ref().map(|corner| corner.view);
        let normal = cross(sub(b, a), sub(c, a));
        let longest =
            [sub(b, a), sub(c, b), sub(a, c)].map(|e| dot(e, e)).into_iter().fold(0.0, f64::max);
        // Below this the normal is rounding noise.
        if length(normal) <= 1e-12 * longest {
            return None;
        }
        let front = dot(normal, self.lens.to_eye(a)) > 0.0;
        let side = if front { 1.0 } else { -1.0 };
        let triangle = self.scene.mesh.triangles[index].map(|vertex| vertex as usize);
        let colours = match self.scene.colours {
            _ if !front => [self.style.back; 3],
            Colours::One(colour) => [colour; 3],
            Colours::PerTriangle(colours) => [colours[index]; 3],
            Colours::PerVertex(colours) => triangle.map(|vertex| colours[vertex]),
        };
        let lights = colours.map(|colour| self.gamma.light(colour));
        let flat = self.style.brightness(scaled(normal, side));
        let normals = match self.style.shading {
            Shading::Flat => None,
            Shading::Smooth => Some(triangle.map(|vertex| scaled(self.normals[vertex], side))),
        };
        let same = colours[0] == colours[1] && colours[1] == colours[2] && normals.is_none();
        let all = lit(lights[0], flat);
        let near = self.lens.weights(corners);
        Some(move |weights: [i64; 3]| {
            if same {
                return all;
            }
            let weights: Vector = std::array::from_fn(|i| weights[i] as f64 * near[i]);
            let weights = scaled(weights, 1.0 / (weights[0] + weights[1] + weights[2]));
            let brightness =
                normals.map_or(flat, |normals| self.style.brightness(blend(&normals, weights)));
            lit(blend(&lights, weights), brightness)
        })
    }
}

/// The normals of the mesh, or where it has none the sums of the area-weighted triangle normals, in
/// view coordinates.
fn vertex_normals(scene: &Scene, lens: &Lens) -> Result<Vec<Vector>, Error> {
    let mesh = scene.mesh;
    if !mesh.normals.is_empty() {
        let (given, needed) = (mesh.normals.len(), mesh.vertices.len());
        if given != needed {
            return Err(Error::Length { what: "vertex normals", given, needed });
        }
        let normals: Vec<Vector> = mesh.normals.iter().map(|n| n.map(f64::from)).collect();
        finite("normal", &normals)?;
        return Ok(normals.into_iter().map(|normal| lens.turned(normal)).collect());
    }
    let mut sums = vec![[0.0; 3]; mesh.vertices.len()];
    for &triangle in &mesh.triangles {
        let [a, b, c] = scene.corners(triangle).map(|p| lens.place(p).view);
        let normal = cross(sub(b, a), sub(c, a));
        for vertex in triangle {
            sums[vertex as usize] = add(sums[vertex as usize], normal);
        }
    }
    Ok(sums)
}

#[cfg(test)]
mod tests {
    use shrouds::TriMesh;

    use super::*;
    use crate::camera::{Camera, Projection, View};
    use crate::scene::LineSet;

    #[test]
    fn bands_fit_together() {
        let mesh = TriMesh {
            vertices: vec![[0.0; 3], [5.0, 0.3, 0.0], [0.2, 4.0, 0.0], [0.1, 0.2, 3.0]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
            normals: vec![],
        };
        let lines = LineSet::new(vec![[[5.0, 0.3, 0.0], [0.1, 0.2, 3.0]]], [200, 0, 0]);
        let scene = Scene::new(&mesh).lines(&lines);
        let style = Style { shading: Shading::Smooth, ..Style::default() };
        let projection = Projection::Perspective { angle: 40.0 };
        let camera = Camera { projection, ..Camera::default() };
        let lens = Lens::new(&scene, &camera, [90.0, 70.0], 0.05).unwrap().unwrap();
        let gamma = Gamma::new();
        let painter = Painter::new(&scene, &style, &lens, &gamma).unwrap();
        let rows = |rows| {
            let mut band = Band::new(90, rows, [9; 3]);
            painter.paint(&mut band);
            band.samples().to_vec()
        };
        let whole = rows(0..70);
        assert!(whole.iter().any(|&sample| sample != [9; 3]));
        let parts: Vec<_> = (0..10).flat_map(|i| rows(7 * i..7 * i + 7)).collect();
        assert!(whole == parts);
    }

    #[test]
    fn perspective_blends_along_the_surface_and_not_the_screen() {
        let mesh = TriMesh {
            vertices: vec![[-1.0, -1.0, -3.0], [1.0, -1.0, 0.0], [0.0, 1.0, 3.0]],
            triangles: vec![[0, 1, 2]],
            normals: vec![],
        };
        let colours = [[255, 0, 0], [0, 255, 0], [0, 0, 255]];
        let scene = Scene::new(&mesh).colours(Colours::PerVertex(&colours));
        let style = Style { ambient: 1.0, ..Style::default() };
        let projection = Projection::Perspective { angle: 90.0 };
        let camera = Camera { projection, ..Camera::default().view(View::Top) };
        let lens = Lens::new(&scene, &camera, [400.0, 400.0], 0.05).unwrap().unwrap();
        let gamma = Gamma::new();
        let painter = Painter::new(&scene, &style, &lens, &gamma).unwrap();
        let mut band = Band::new(400, 0..400, [0; 3]);
        painter.paint(&mut band);
        for weights in [[1.0, 1.0, 1.0], [3.0, 1.0, 1.0], [1.0, 1.0, 4.0]] {
            let weights = scaled(weights, 1.0 / weights.iter().sum::<f64>());
            let corners = [0, 1, 2].map(|i| mesh.vertices[i]);
            let place = lens.place(blend(&corners, weights));
            let sample = band.samples()[place.y as usize * 400 + place.x as usize];
            for (part, weight) in sample.into_iter().zip(weights) {
                assert!(
                    (f64::from(part) / 65535.0 - weight).abs() < 0.02,
                    "{sample:?} {weights:?}"
                );
            }
        }
    }
}
