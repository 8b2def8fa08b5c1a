//! The picture of a step: the region above the sea floor, and who moves where.

use shrouds::TriMesh;
use shrouds::containment::{Sea, Step, Track};
use shrouds_view::{Colours, LineSet, Picture, Scene};

use super::Told;
use crate::failure::Failure;
use crate::picture::View;

/// Quads of the sea floor along its longer side.
const FLOOR: usize = 160;
/// Colours of the deepest and of the shallowest floor.
const DEEP: [f64; 3] = [34.0, 58.0, 92.0];
const SHALLOW: [f64; 3] = [150.0, 186.0, 196.0];
const SURFACE: [u8; 3] = [120, 160, 200];
const WAY: [u8; 3] = [30, 30, 34];
const ARRAY: [u8; 3] = [210, 30, 40];
const TRUTH: [u8; 3] = [20, 140, 60];

/// What is the same in every picture of a scene.
pub(crate) struct Painter {
    view: View,
    region: [u8; 3],
    floor: TriMesh,
    floor_colours: Vec<[u8; 3]>,
    lines: Vec<LineSet>,
    truth: Option<Track>,
    /// Length of marks, in metres.
    mark: f64,
}

impl Painter {
    pub(crate) fn new(told: &Told, view: View, region: [u8; 3]) -> Self {
        let sea = told.scene.sea();
        let (floor, floor_colours) = floor(sea);
        let (lines, truth, mark) = (ways(told), told.truth.clone(), mark(sea));
        Self { view, region, floor, floor_colours, lines, truth, mark }
    }

    /// The region's surface, the floor, the ways, and where array and target are.
    pub(crate) fn draw(&self, step: &Step, region: &TriMesh) -> Result<Picture, Failure> {
        let mut mesh = self.floor.clone();
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend_from_slice(&region.vertices);
        mesh.triangles.extend(region.triangles.iter().map(|t| t.map(|vertex| first + vertex)));
        mesh.normals.extend_from_slice(&region.normals);
        let mut colours = self.floor_colours.clone();
        colours.resize(mesh.vertices.len(), self.region);
        let marks = marks(step, self.truth.as_ref(), self.mark);
        let scene = Scene::new(&mesh).colours(Colours::PerVertex(&colours));
        let scene = self.lines.iter().chain(&marks).fold(scene, Scene::lines);
        self.view.draw_scene(&scene)
    }
}

/// All lines of a step: the edge of the sea, the ways, and marks where array and target are.
pub(crate) fn lines(told: &Told, step: &Step) -> Vec<LineSet> {
    let mut lines = ways(told);
    lines.extend(marks(step, told.truth.as_ref(), mark(told.scene.sea())));
    lines
}

/// Length of marks, in metres.
fn mark(sea: &Sea) -> f64 {
    let [low, high] = corners(sea);
    0.02 * (high[0] - low[0]).hypot(high[1] - low[1])
}

/// What is the same in every step.
fn ways(told: &Told) -> Vec<LineSet> {
    let edge = outline(told.scene.sea());
    let mut lines = vec![wide(edge, SURFACE, 1.5), wide(way(told.scene.track()), WAY, 2.5)];
    lines.extend(told.truth.as_ref().map(|track| wide(way(track), TRUTH, 2.5)));
    lines
}

/// Where array and target are.
fn marks(step: &Step, truth: Option<&Track>, mark: f64) -> Vec<LineSet> {
    let [x, y] = step.array.position;
    let array = [x, y, -step.array.depth];
    let [east, north] = step.array.axis.map(|part| 5.0 * mark * part);
    let mut marks = vec![wide(cross(array, mark), ARRAY, 3.0)];
    marks[0].segments.push([[x - east, y - north, array[2]], [x + east, y + north, array[2]]]);
    if let Some(place) = truth.and_then(|truth| truth.at(step.time)) {
        let [x, y] = place.position;
        marks.push(wide(cross([x, y, -place.depth], mark), TRUTH, 3.0));
    }
    marks
}

fn wide(segments: Vec<[[f64; 3]; 2]>, colour: [u8; 3], width: f32) -> LineSet {
    LineSet { segments, colour, width }
}

/// Smallest and largest x, y, z of the lattice.
fn corners(sea: &Sea) -> [[f64; 3]; 2] {
    let last = sea.grid().dims().map(|n| (n - 1) as f64);
    [[0.0; 3], last].map(|index| sea.grid().point(index))
}

/// The sea floor, seen from above, with a colour for each vertex.
fn floor(sea: &Sea) -> (TriMesh, Vec<[u8; 3]>) {
    let [low, high] = corners(sea);
    let longest = (high[0] - low[0]).max(high[1] - low[1]);
    let counts = [0, 1].map(|d| {
        (FLOOR as f64 * (high[d] - low[d]) / longest).ceil().clamp(1.0, FLOOR as f64) as usize
    });
    let across = counts[0] + 1;
    let place = |n: usize| {
        let shares = [n % across, n / across];
        [0, 1].map(|d| low[d] + shares[d] as f64 / counts[d] as f64 * (high[d] - low[d]))
    };
    let places = (0..across * (counts[1] + 1)).map(place);
    let vertices: Vec<[f64; 3]> = places.map(|[x, y]| [x, y, -sea.floor().depth([x, y])]).collect();
    let corner = |i: usize, j: usize| (j * across + i) as u32;
    let quads = (0..counts[1]).flat_map(|j| (0..counts[0]).map(move |i| (i, j)));
    let triangles = quads.flat_map(|(i, j)| {
        let [a, b, c, d] = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    let heights = || vertices.iter().map(|vertex| vertex[2]);
    let (least, most) =
        (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    // A level floor has the middle colour; all of them have some hundred metres from end to end.
    let range = (most - least).max(400.0);
    let middle = (most + least) / 2.0;
    let colour = |height: f64| {
        let share = 0.5 + (height - middle) / range;
        [0, 1, 2].map(|c| (DEEP[c] + share * (SHALLOW[c] - DEEP[c])) as u8)
    };
    let colours = heights().map(colour).collect();
    let triangles = triangles.collect();
    let normals = vec![[0.0, 0.0, 1.0]; vertices.len()];
    (TriMesh { vertices, triangles, normals }, colours)
}

/// The border of the surface, and the corners of the sea down to the floor.
fn outline(sea: &Sea) -> Vec<[[f64; 3]; 2]> {
    let [low, high] = corners(sea);
    let ring = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
    (0..4)
        .flat_map(|n| {
            let [[x, y], [u, v]] = [ring[n], ring[(n + 1) % 4]];
            [[[x, y, 0.0], [u, v, 0.0]], [[x, y, 0.0], [x, y, -sea.floor().depth([x, y])]]]
        })
        .collect()
}

fn way(track: &Track) -> Vec<[[f64; 3]; 2]> {
    let points = track.waypoints().windows(2);
    points
        .map(|pair| [0, 1].map(|n| [pair[n].position[0], pair[n].position[1], -pair[n].depth]))
        .collect()
}

/// Three strokes through a point.
fn cross(at: [f64; 3], size: f64) -> Vec<[[f64; 3]; 2]> {
    (0..3)
        .map(|d| {
            [-0.5, 0.5].map(|side| {
                let mut end = at;
                end[d] += side * size;
                end
            })
        })
        .collect()
}
