//! NRRD out: one file, gzip.

use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use shrouds::Grid;

use crate::atomic::write_atomically;
use crate::error::Error;
use crate::volume::write::{Data, Element};
use crate::volume::{Frame, affine_of, diagonal, nrrd_space};

pub(super) fn write(path: &Path, data: &Data, frame: &Frame) -> Result<(), Error> {
    write_atomically(path, |writer| {
        writer.write_all(header(data.grid, data.element, frame).as_bytes())?;
        // Bits barely compress further at a higher level.
        let mut encoder = GzEncoder::new(writer, Compression::fast());
        (data.write)(&mut encoder)?;
        encoder.finish().map(|_| ())
    })
}

fn header(grid: &Grid, element: Element, frame: &Frame) -> String {
    let [nx, ny, nz] = grid.dims();
    let start = format!("NRRD0005\ntype: {}\ndimension: 3\n", element.nrrd);
    let endian = if element.width > 1 { "endian: little\n" } else { "" };
    let mut header = format!("{start}sizes: {nx} {ny} {nz}\nencoding: gzip\n{endian}");
    let unit = Some(&frame.unit).filter(|unit| {
        *unit != "unknown" && !unit.chars().any(|c| c == '"' || c == '\\' || c.is_control())
    });
    let units = unit.map(|unit| format!("\"{unit}\" \"{unit}\" \"{unit}\"\n")).unwrap_or_default();
    let affine = grid.affine();
    if frame.name == "index" && affine == affine_of(diagonal(grid.spacing()), [0.0; 3]) {
        let [x, y, z] = grid.spacing();
        header.push_str(&format!("spacings: {x} {y} {z}\n"));
        if !units.is_empty() {
            header.push_str(&format!("units: {units}"));
        }
    } else {
        header.push_str(&match nrrd_space::full_name(&frame.name) {
            Some(name) => format!("space: {name}\n"),
            None => "space dimension: 3\n".into(),
        });
        let column = |c: usize| affine.map(|row| row[c]);
        let vector = |[x, y, z]: [f64; 3]| format!("({x},{y},{z})");
        let [a, b, c, origin] = [0, 1, 2, 3].map(|c| vector(column(c)));
        header.push_str(&format!("space directions: {a} {b} {c}\nspace origin: {origin}\n"));
        if !units.is_empty() {
            header.push_str(&format!("space units: {units}"));
        }
    }
    header.push('\n');
    header
}
