//! An image and polygons on it, drawn from above.

use shrouds::polygon::Polygon;
use shrouds::{Occupancy, TriMesh};
use shrouds_view::{Cell, Colours, LineSet, Scene};

use super::panel::Look;
use crate::failure::Failure;

const INSIDE: [u8; 3] = [222, 184, 128];
const OUTSIDE: [u8; 3] = [214, 218, 224];
const MARKED: [u8; 3] = [220, 40, 40];
const THIN: [u8; 3] = [150, 150, 156];
const BOLD: [u8; 3] = [30, 60, 170];
/// Corners of a dot and its radius in lattice steps; that of the marked vertex is larger.
const CORNERS: u32 = 16;
const RADIUS: f64 = 0.16;
const LOOK: Look = Look::new(-90.0, 90.0, [420, 340]);

/// Dots for the points of the image, polygons as lines, and perhaps a mark on one vertex.
pub(super) fn plan(
    caption: [String; 2],
    image: &Occupancy,
    thin: &[Polygon],
    bold: &[Polygon],
    mark: Option<usize>,
) -> Result<Cell, Failure> {
    let [nx, ny, _] = image.grid().dims();
    let mut dots = Dots::default();
    for (i, j) in (0..ny).flat_map(|j| (0..nx).map(move |i| (i, j))) {
        let colour = if image.get([i, j, 0]) { INSIDE } else { OUTSIDE };
        dots.add([i as f64, j as f64], RADIUS, colour);
    }
    let marked = mark.and_then(|vertex| {
        bold.iter().find_map(|polygon| {
            let n = polygon.vertices.iter().position(|&v| v as usize == vertex)?;
            Some(polygon.index[n])
        })
    });
    if let Some(point) = marked {
        dots.add(point, 1.4 * RADIUS, MARKED);
    }
    let lines = [(thin, THIN, 1.5), (bold, BOLD, 3.0)].map(|(polygons, colour, width)| LineSet {
        width,
        ..LineSet::new(polygons.iter().flat_map(segments).collect(), colour)
    });
    let mut scene = Scene::new(&dots.mesh).colours(Colours::PerTriangle(&dots.colours));
    for set in &lines {
        scene = scene.lines(set);
    }
    LOOK.panel(caption, &scene, None)
}

fn segments(polygon: &Polygon) -> Vec<[[f64; 3]; 2]> {
    let points: Vec<[f64; 3]> = polygon.index.iter().map(|&[x, y]| [x, y, 0.0]).collect();
    let count = points.len();
    let segments = if polygon.closed { count } else { count.saturating_sub(1) };
    (0..segments).map(|n| [points[n], points[(n + 1) % count]]).collect()
}

/// Discs that face upwards.
#[derive(Default)]
struct Dots {
    mesh: TriMesh,
    colours: Vec<[u8; 3]>,
}

impl Dots {
    fn add(&mut self, [x, y]: [f64; 2], radius: f64, colour: [u8; 3]) {
        let middle = self.mesh.vertices.len() as u32;
        self.mesh.vertices.push([x, y, 0.0]);
        for n in 0..CORNERS {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(n) / f64::from(CORNERS)).sin_cos();
            self.mesh.vertices.push([x + radius * cos, y + radius * sin, 0.0]);
            let next = (n + 1) % CORNERS;
            self.mesh.triangles.push([middle, middle + 1 + n, middle + 1 + next]);
            self.colours.push(colour);
        }
    }
}
