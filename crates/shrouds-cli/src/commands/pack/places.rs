//! The places of vertices in bit planes, and how far those that come back are from them.

use std::ops::ControlFlow;

use serde::Serialize;
use shrouds::mesh::{network_normals, place_vertices};
use shrouds::network::Network;
use shrouds::optimize::{self, Preset, optimize};
use shrouds::surface::Surface;
use shrouds_codec::{Planes, geometry};

use crate::failure::Failure;
use crate::progress::Progress;
use crate::report::RmsMax;

/// A surface with the places of its vertices.
pub(super) struct Given {
    pub(super) surface: Surface,
    /// δ of every vertex.
    pub(super) delta: Vec<f64>,
}

/// How far the unpacked surface is from the one that was packed.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Distances {
    /// Along the grid edges, in edge lengths.
    pub(super) edge: RmsMax,
    /// Along the normals of the one that was packed, in the unit of the file.
    pub(super) normal: RmsMax,
}

impl Given {
    pub(super) fn encode(&self, bits: u8) -> Result<Planes, Failure> {
        Ok(geometry::encode(&self.surface, &self.delta, bits.into())?)
    }

    /// Decodes bit planes and measures the surface that `shrouds unpack` makes of them.
    pub(super) fn distances(
        &self,
        planes: &Planes,
        progress: &Progress,
    ) -> Result<Distances, Failure> {
        let payloads: Vec<(&[u8], u32)> =
            planes.payloads.iter().map(|(payload, sum)| (&payload[..], *sum)).collect();
        let places = geometry::decode(&self.surface, &planes.settings, &payloads);
        let settings = optimize::Settings {
            preset: Preset::Exact,
            intervals: Some(places.intervals().collect()),
            ..optimize::Settings::default()
        };
        let found = optimize(&self.surface, &settings, &mut |now| {
            progress.optimize(now);
            ControlFlow::Continue(())
        })?;
        Ok(self.distances_to(&found.delta))
    }

    fn distances_to(&self, delta: &[f64]) -> Distances {
        let (surface, affine) = (&self.surface, self.surface.grid().affine());
        let vertices = place_vertices(surface, &self.delta);
        let normals = network_normals(surface, &Network::trace(surface), &vertices);
        let (mut edge, mut normal) = (Sum::default(), Sum::default());
        let places = surface.crossings().zip(&normals).zip(&self.delta).zip(delta);
        for (((crossing, n), packed), found) in places {
            let along = affine.map(|row| row[crossing.axis()]);
            let slant: f64 = along.iter().zip(n).map(|(x, &n)| x * f64::from(n)).sum();
            edge.add(found - packed);
            normal.add((found - packed) * slant);
        }
        Distances { edge: edge.of(delta.len()), normal: normal.of(delta.len()) }
    }
}

#[derive(Default)]
struct Sum {
    squares: f64,
    max: f64,
}

impl Sum {
    fn add(&mut self, x: f64) {
        self.squares += x * x;
        self.max = self.max.max(x.abs());
    }

    fn of(&self, count: usize) -> RmsMax {
        RmsMax { rms: (self.squares / count.max(1) as f64).sqrt(), max: self.max }
    }
}
