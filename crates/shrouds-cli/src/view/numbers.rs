//! A surface in numbers: measures, the report and the call that makes the same.

use serde_json::json;
use shrouds::Shroud;
use shrouds_codec::{Settings, geometry, pack_with_planes};
use shrouds_report::looks::roughness;

use super::request::ViewNumber;
use super::surface::Surface;
use super::typed::{self, Typed};
use super::volumes::Name;
use super::worker::{Ended, Shown, Worker};
use crate::failure::Failure;
use crate::report::{Report, peak_memory};
use crate::work;

impl Worker {
    pub(super) fn numbers(&self, id: u64, view: ViewNumber) -> Result<(), Ended> {
        self.page.progress("measuring", None);
        if let Shown::Several(several) = self.shown(view)? {
            return self.answer(id, &several.numbers()?);
        }
        let surface = self.surface(view)?;
        let shroud = surface.now();
        let report = judged(surface, &shroud)?;
        let Report { topology, geometry, checks, times, .. } = &report;
        let is_manifold =
            [checks.non_manifold_edges, checks.non_manifold_vertices, checks.inconsistent_edges]
                .iter()
                .all(|count| *count == 0);
        self.answer(
            id,
            &json!({
                "vertices": topology.vertices,
                "triangles": topology.triangles,
                "components": topology.components,
                "euler": topology.euler,
                "volume": geometry.volume,
                "voxel_volume": geometry.voxel_volume,
                "true_volume": geometry.true_volume,
                "area": geometry.area,
                "true_area": geometry.true_area,
                "wrong_side": checks.wrong_side,
                "manifold": is_manifold,
                "ok": checks.ok,
                "problems": checks.problems,
                "roughness": roughness(&shroud.mesh),
                "times": times,
            }),
        )
    }

    pub(super) fn report(&self, id: u64, view: ViewNumber) -> Result<(), Ended> {
        if let Shown::Several(several) = self.shown(view)? {
            return self.answer(id, &json!({ "report": several.report()? }));
        }
        let surface = self.surface(view)?;
        let mut report = judged(surface, &*surface.result()?)?;
        let times = &mut report.times;
        times.total = times.read + times.surface + times.optimize + times.mesh + times.check;
        report.memory = peak_memory();
        self.answer(id, &json!({ "report": report }))
    }

    pub(super) fn command(&self, id: u64, view: ViewNumber) -> Result<(), Ended> {
        let (name, reading, typed) = match self.shown(view)? {
            Shown::Body(surface) => (&surface.name, &surface.words, &surface.typed),
            Shown::Several(several) => (&several.name, &several.words, &several.typed),
        };
        let note = matches!(name, Name::Made(_))
            .then_some("export the volume first, as volume.nii.gz: it was made or changed here");
        let command = command_line(name, reading, typed);
        self.answer(id, &json!({ "command": command, "note": note }))
    }
}

/// The call that makes the same, with the options that select the volume. Of the labels of a demo it takes two.
fn command_line(name: &Name, reading: &[String], typed: &Typed) -> String {
    let settings = typed.words.iter().map(String::as_str);
    let mesh = |path: &str| {
        let reading = reading.iter().map(String::as_str);
        let words = ["shrouds", "mesh", path].into_iter().chain(reading).chain(settings.clone());
        typed::quoted(words.chain(["-o", "mesh.ply"]))
    };
    match name {
        Name::Demo(name, size) => {
            let size = format!("--size={size}");
            let demo = ["shrouds", "demo", name, &size];
            if typed.materials || !reading.is_empty() {
                return format!("{} && {}", typed::quoted(demo), mesh("shrouds-demo/volume.npy"));
            }
            typed::quoted(demo.into_iter().chain(settings))
        }
        Name::File(path) => mesh(path),
        Name::Made(_) => mesh("volume.nii.gz"),
    }
}

fn judged(surface: &Surface, shroud: &Shroud) -> Result<Report, Failure> {
    work::judge(&shroud.mesh, &surface.source, &surface.job, &shroud.report, shroud.times)
}

/// How the volume of a surface is packed.
pub(super) fn packing(surface: &Surface) -> Settings {
    let settings = &surface.job.settings;
    let frame = &surface.source.frame;
    Settings {
        faces: settings.faces,
        border: settings.border,
        space: frame.name.clone(),
        unit: frame.unit.clone(),
        ..Settings::default()
    }
}

/// The volume and so many bits for the place of every vertex as `shrouds pack` puts them into a file.
pub(super) fn packed(surface: &Surface, shroud: &Shroud, bits: u8) -> Result<Vec<u8>, Failure> {
    let planes = geometry::encode(&shroud.surface, &shroud.delta, bits.into())?;
    let mut bytes = Vec::new();
    pack_with_planes(&surface.source.occupancy, &packing(surface), &planes, &mut bytes)?;
    Ok(bytes)
}
