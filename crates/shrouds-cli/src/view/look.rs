//! What can be laid over a surface: colours, contours, lattice points, slices.

use clap::ValueEnum;
use serde_json::{Value, json};
use shrouds::Occupancy;
use shrouds::measure::contours;
use shrouds::surface;
use shrouds::volume::{Border, FaceRule};
use shrouds_view::server::Frame;

use super::request::{Slot, ViewNumber};
use super::surface::Surface;
use super::volumes::{Data, colour};
use super::worker::{Ended, Worker};
use crate::args::{Field, PlaneAxis};
use crate::colouring::{Numbers, Unit};
use crate::failure::Failure;
use crate::lines;

/// The name of the colours that the command line does not have.
const DISPLACEMENT: &str = "displacement";
/// Colours that describe a scale; between them it is nearly linear.
const STOPS: usize = 33;
/// Farthest that lattice points are shown from the surface, in voxels.
const FARTHEST: u8 = 4;
/// With more values than this an image is shown in greys.
const FEW: usize = 64;

/// The numbers that can be shown as colours, with what they are.
pub(super) fn fields() -> Value {
    let known = Field::value_variants().iter().filter_map(ValueEnum::to_possible_value);
    let mut fields: Vec<Value> = known
        .map(|value| {
            let help = value.get_help().map(ToString::to_string);
            json!({ "name": value.get_name(), "help": help })
        })
        .collect();
    let help = "Distance from the middle of the grid edge, positive outwards";
    fields.push(json!({ "name": DISPLACEMENT, "help": help }));
    fields.into()
}

impl Worker {
    pub(super) fn colours(
        &self,
        id: u64,
        view: ViewNumber,
        field: &str,
        range: Option<[f64; 2]>,
    ) -> Result<(), Ended> {
        let numbers = numbers(self.surface(view)?, field)?;
        let scale = numbers.scale(range)?;
        let [low, high] = scale.range();
        let stop = |n: usize| {
            let value = low + n as f64 / (STOPS - 1) as f64 * (high - low);
            json!([value, scale.colour(value).map(|part| format!("{part:02x}")).concat()])
        };
        let legend: Vec<Value> = (0..STOPS).map(stop).collect();
        let unit = numbers.unit();
        self.answer(id, &json!({ "low": low, "high": high, "unit": unit, "legend": legend }))?;
        let values = numbers.values().iter().map(|&value| value as f32);
        self.show(Frame::scalars([view.number(), id as u32], values))
    }

    pub(super) fn contours(
        &self,
        id: u64,
        view: ViewNumber,
        axis: PlaneAxis,
        every: f64,
    ) -> Result<(), Ended> {
        if !(every.is_finite() && every > 0.0) {
            return Err(Failure::Call("contours need a distance above 0".into()).into());
        }
        let surface = self.surface(view)?;
        let mesh = &surface.now().mesh;
        let planes = lines::across(axis, Some(&surface.source.lattice))?;
        let planes = lines::every(planes, mesh, every, 0.0)?;
        let found = contours(mesh, &planes)?;
        let line = |contour: &shrouds::measure::Contour| {
            let closing = contour.points.first().filter(|_| contour.closed);
            let points = contour.points.iter().chain(closing);
            points.map(|&point| surface.places.point(point)).collect::<Vec<_>>()
        };
        let lines: Vec<Vec<[f32; 3]>> = found.iter().map(line).collect();
        let length: f64 = found.iter().map(|contour| contour.length).sum();
        let count = planes.positions().len();
        self.answer(id, &json!({ "planes": count, "contours": found.len(), "length": length }))?;
        self.show(Frame::lines([view.number(), id as u32], &lines))
    }

    pub(super) fn points(&self, id: u64, slot: Slot, near: u8) -> Result<(), Ended> {
        if !(1..=FARTHEST).contains(&near) {
            return Err(Failure::Call(format!(
                "lattice points are shown 1 to {FARTHEST} voxels from the surface"
            ))
            .into());
        }
        let volume = &self.data(slot)?.source.occupancy;
        let points = near_surface(volume, near)?;
        self.answer(id, &json!({ "points": points.len() }))?;
        self.show(Frame::points([0, id as u32], &points))
    }

    pub(super) fn slice(
        &self,
        id: u64,
        slot: Slot,
        axis: PlaneAxis,
        index: usize,
    ) -> Result<(), Ended> {
        let data = self.data(slot)?;
        let slice = Slice::new(&data.source.occupancy, axis.index(), index)?;
        let (pixels, shows) = slice.pixels(data);
        self.answer(
            id,
            &json!({ "width": slice.size[0], "height": slice.size[1], "shows": shows }),
        )?;
        self.show(Frame::image([0, id as u32], slice.size, slice.corners(), &pixels))
    }

    pub(super) fn show(&self, frame: Frame) -> Result<(), Ended> {
        self.page.frame(frame).map_err(|_| Ended::Closed)
    }
}

/// The numbers of a name at the vertices that the page draws.
fn numbers(surface: &Surface, field: &str) -> Result<Numbers, Failure> {
    let shroud = surface.now();
    let unit = Unit::of_volume(&surface.source.frame, &surface.source.lattice);
    let is_dual = surface.is_dual();
    let known = Field::from_str(field, false);
    match known {
        Ok(Field::Delta) if !is_dual => Ok(Numbers::deltas(&shroud.delta)),
        Ok(field) if !is_dual => Ok(Numbers::of_primal(field, &shroud, &unit)),
        Ok(field) if field != Field::Delta => Numbers::of_mesh(field, &shroud.mesh, &unit),
        Err(_) if field != DISPLACEMENT => {
            Err(Failure::Call(format!("there are no colours '{field}'; see what hello lists")))
        }
        Err(_) if !is_dual => {
            let spacing = surface.source.lattice.spacing();
            let crossings = shroud.surface.crossings().zip(&shroud.delta);
            let moves = crossings.map(|(crossing, delta)| (0.5 - delta) * spacing[crossing.axis()]);
            Ok(Numbers::displacements(moves.collect(), &unit))
        }
        _ => Err(Failure::Call(
            "the vertices of a dual mesh do not lie on grid edges: choose a curvature".into(),
        )),
    }
}

/// The lattice points of a volume that are so near to its surface, by steps along the axes.
fn near_surface(volume: &Occupancy, near: u8) -> Result<Vec<([f32; 3], bool)>, Failure> {
    let mut near_points = Marked::on(volume);
    let surface = surface::Surface::extract(volume, FaceRule::default(), Border::Closed)?;
    for crossing in surface.crossings() {
        for end in [crossing.inside(), crossing.outside()] {
            // The surface counts from a layer before the first; what lies there is none of ours.
            near_points.mark(end.map(|index| index.wrapping_sub(1)));
        }
    }
    let mut done = 0;
    for _ in 1..near {
        let rim = done..near_points.points.len();
        done = rim.end;
        for n in rim {
            near_points.mark_neighbours(near_points.points[n]);
        }
    }
    let spacing = volume.grid().spacing();
    let place = |point: [usize; 3]| std::array::from_fn(|d| (point[d] as f64 * spacing[d]) as f32);
    Ok(near_points.points.iter().map(|&point| (place(point), volume.get(point))).collect())
}

/// Lattice points, each once, in the order in which they were found.
struct Marked {
    points: Vec<[usize; 3]>,
    known: Occupancy,
}

impl Marked {
    /// None of a volume's points so far.
    fn on(volume: &Occupancy) -> Self {
        Self { points: Vec::new(), known: Occupancy::empty(volume.grid().clone()) }
    }

    /// Takes a point, unless it is outside the lattice.
    fn mark(&mut self, point: [usize; 3]) {
        let dims = self.known.grid().dims();
        if (0..3).all(|d| point[d] < dims[d]) && !self.known.get(point) {
            self.known.set(point, true);
            self.points.push(point);
        }
    }

    fn mark_neighbours(&mut self, point: [usize; 3]) {
        for axis in 0..3 {
            for step in [1, usize::MAX] {
                let mut next = point;
                next[axis] = next[axis].wrapping_add(step);
                self.mark(next);
            }
        }
    }
}

/// A lattice plane of a volume as an image.
struct Slice<'a> {
    volume: &'a Occupancy,
    index: usize,
    /// The axes along its rows and columns.
    across: [usize; 2],
    size: [usize; 2],
}

impl<'a> Slice<'a> {
    fn new(volume: &'a Occupancy, axis: usize, index: usize) -> Result<Self, Failure> {
        let dims = volume.grid().dims();
        if index >= dims[axis] {
            let last = dims[axis] - 1;
            return Err(Failure::Call(format!("there is no slice {index}; give 0 to {last}")));
        }
        let across = [[1, 2], [0, 2], [0, 1]][axis];
        Ok(Self { volume, index, across, size: across.map(|d| dims[d]) })
    }

    fn point(&self, u: usize, v: usize) -> [usize; 3] {
        let mut point = [self.index; 3];
        (point[self.across[0]], point[self.across[1]]) = (u, v);
        point
    }

    fn corners(&self) -> [[f32; 3]; 3] {
        let spacing = self.volume.grid().spacing();
        let [width, height] = self.size;
        [[0, 0], [width - 1, 0], [0, height - 1]].map(|[u, v]| {
            let point = self.point(u, v);
            std::array::from_fn(|d| (point[d] as f64 * spacing[d]) as f32)
        })
    }

    /// All pixels, and whether they show labels, greys or what is inside.
    fn pixels(&self, data: &Data) -> (Vec<[u8; 4]>, &'static str) {
        let [width, height] = self.size;
        let points = (0..height).flat_map(|v| (0..width).map(move |u| (u, v)));
        let points = points.map(|(u, v)| self.point(u, v));
        let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
        let Some(values) = &data.values else {
            let side = |point| opaque(if self.volume.get(point) { [222; 3] } else { [24; 3] });
            return (points.map(side).collect(), "inside");
        };
        let [nx, ny, _] = self.volume.grid().dims();
        let places = points.map(|[i, j, k]| i + nx * (j + ny * k));
        let numbers = values.volume.values.at(places).into_iter();
        if values.labels.as_ref().is_some_and(|labels| labels.len() <= FEW) {
            return (numbers.map(|value| opaque(colour(value as i128))).collect(), "labels");
        }
        let (low, high) = values.range.unwrap_or((0.0, 1.0));
        let grey = |value: f64| (255.0 * (value - low) / (high - low)) as u8;
        (numbers.map(|value| opaque([grey(value); 3])).collect(), "grey")
    }
}
