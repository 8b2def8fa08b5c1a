//! What is known of a single vertex.

use serde_json::{Value, json};
use shrouds::Shroud;
use shrouds::energy::Point2;
use shrouds::measure::curvatures;
use shrouds::mesh::{network_normals, place_vertices};
use shrouds::network::Network;
use shrouds::volume::Border;

use super::request::ViewNumber;
use super::surface::Surface;
use super::worker::{Ended, Worker};
use crate::failure::Failure;

impl Worker {
    pub(super) fn pick(&self, id: u64, view: ViewNumber, vertex: u32) -> Result<(), Ended> {
        let about = about_vertex(self.surface(view)?, vertex)?;
        self.answer(id, &about)
    }
}

/// All that is known of a vertex.
fn about_vertex(surface: &Surface, vertex: u32) -> Result<Value, Failure> {
    let shroud = surface.now();
    let count = shroud.surface.vertex_count();
    if vertex as usize >= count {
        return Err(Failure::Call(format!("there is no vertex {vertex} of {count}")));
    }
    let v = vertex as usize;
    let network = &surface.network;
    let crossing = shroud.surface.crossing(vertex);
    let delta = shroud.delta[v];
    // The surface counts from a layer before the first where the border is closed.
    let margin = if shroud.surface.border() == Border::Closed { 1 } else { 0 };
    let index = |point: [usize; 3]| point.map(|x| x as i64 - margin);
    let spacing = surface.source.lattice.spacing();
    let place = crossing.position(delta);
    let position: [f64; 3] = std::array::from_fn(|d| (place[d] - margin as f64) * spacing[d]);
    let neighbours = [0, 1, 2, 3].map(|slot| network.neighbour(vertex, slot).map(|(u, _)| u));
    let vertices = place_vertices(&shroud.surface, &shroud.delta);
    let normals = network_normals(&shroud.surface, network, &vertices);
    let curvature = curvatures(network, &vertices, &normals)[v];
    let rho = [0, 1].map(|curve| rho(surface, &shroud, vertex, curve));
    Ok(json!({
        "vertex": vertex,
        "edge": {
            "axis": crossing.axis(),
            "inside": index(crossing.inside()),
            "outside": index(crossing.outside()),
        },
        "delta": delta,
        "position": position,
        "world": vertices[v],
        "normal": surface.places.normal(normals[v]),
        "neighbours": neighbours,
        "rho": rho,
        "curvature": {
            "maximum": curvature.principal[0],
            "minimum": curvature.principal[1],
            "mean": curvature.mean(),
            "gaussian": curvature.gaussian(),
        },
    }))
}

/// ρ of the energy at a vertex on one of its two curves, without the weights that depend on the slope of
/// the surface; nothing where an open curve ends.
fn rho(surface: &Surface, shroud: &Shroud, vertex: u32, curve: usize) -> Option<f64> {
    let network = &surface.network;
    let (normal, _) = network.curve_axes(vertex, curve);
    let [p, q] = [[1, 2], [0, 2], [0, 1]][normal];
    let grid = shroud.surface.grid();
    let (spacing, unit) = (grid.spacing(), grid.min_spacing());
    let place = |v: u32| -> Point2 {
        let index = shroud.surface.crossing(v).position(shroud.delta[v as usize]);
        [p, q].map(|axis| index[axis] * spacing[axis] / unit)
    };
    let before = neighbour(network, vertex, 2 * curve)?.0;
    let (next, slot) = neighbour(network, vertex, 2 * curve + 1)?;
    let points = [before, vertex, next, neighbour(network, next, slot)?.0].map(place);
    let energy = surface.job.settings.optimize.energy();
    Some(energy.parts().iter().map(|part| part.weight * part.measure.rho(&points)).sum())
}

/// The neighbour in a slot, and the slot in which the curve goes on from there.
fn neighbour(network: &Network, vertex: u32, slot: usize) -> Option<(u32, usize)> {
    let (next, link) = network.neighbour(vertex, slot)?;
    Some((next, link.back_slot(slot) ^ 1))
}
