//! NIfTI-1 out: one file, plain or gzip.

use std::io::Write;
use std::path::Path;

use flate2::Compression;
use flate2::write::GzEncoder;
use shrouds::Grid;

use crate::atomic::write_atomically;
use crate::error::Error;
use crate::volume::write::{Data, Element};
use crate::volume::{Frame, affine_of, diagonal};

/// Bytes of the header and the four that say that it has no extensions.
const DATA: usize = 352;
/// Cosine between axes from which on no qform can hold them.
const SHEAR: f64 = 1e-4;

pub(super) fn write(path: &Path, data: &Data, frame: &Frame, gzip: bool) -> Result<(), Error> {
    let header = header(path, data.grid, data.element, frame)?;
    write_atomically(path, |writer| {
        if !gzip {
            writer.write_all(&header)?;
            return (data.write)(writer);
        }
        // Bits barely compress further at a higher level.
        let mut encoder = GzEncoder::new(writer, Compression::fast());
        encoder.write_all(&header)?;
        (data.write)(&mut encoder)?;
        encoder.finish().map(|_| ())
    })
}

fn header(path: &Path, grid: &Grid, element: Element, frame: &Frame) -> Result<[u8; DATA], Error> {
    let mut dims = [0i16; 3];
    for (short, length) in dims.iter_mut().zip(grid.dims()) {
        *short = i16::try_from(length).map_err(|_| {
            let problem = format!(
                "NIfTI-1 holds at most {} points along an axis, not {length}: write .nrrd instead",
                i16::MAX
            );
            Error::UnwritableVolume { path: path.into(), problem }
        })?;
    }
    let (affine, unit) = placement(grid, frame);
    let at_zero =
        frame.name == "index" && affine == affine_of(diagonal(spacing(&affine)), [0.0; 3]);
    // 1 is the world of the scanner, 2 one that is aligned to something else; without either there
    // are the spacings only.
    let code: i16 = match frame.name.as_str() {
        "RAS" | "LPS" | "LAS" => 1,
        _ if at_zero => 0,
        _ => 2,
    };
    let mut header = [0; DATA];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    let dim = [3, dims[0], dims[1], dims[2], 1, 1, 1, 1];
    put(40, &dim.map(i16::to_le_bytes).concat());
    // Data type and its bits.
    put(70, &[element.nifti, 8 * element.width as i16].map(i16::to_le_bytes).concat());
    put(108, &floats(&[DATA as f64, 1.0, 0.0]));
    put(123, &[unit]);
    let turn = turn(&affine).filter(|_| code > 0);
    let (sign, quaternion) = turn.unwrap_or((1.0, [0.0; 3]));
    let [x, y, z] = spacing(&affine);
    put(76, &floats(&[sign, x, y, z, 1.0, 1.0, 1.0, 1.0]));
    put(252, &if turn.is_some() { code } else { 0 }.to_le_bytes());
    put(254, &code.to_le_bytes());
    if turn.is_some() {
        put(256, &floats(&quaternion));
        put(268, &floats(&affine.map(|row| row[3])));
    }
    if code > 0 {
        put(280, &floats(affine.as_flattened()));
    }
    put(344, b"n+1\0");
    Ok(header)
}

/// The affine in the RAS world of NIfTI, in one of its units, and the code of that.
fn placement(grid: &Grid, frame: &Frame) -> ([[f64; 4]; 3], u8) {
    let (factor, unit) = match frame.unit.as_str() {
        "m" => (1.0, 1),
        "mm" => (1.0, 2),
        "um" => (1.0, 3),
        "cm" => (10.0, 2),
        "nm" => (1e-3, 3),
        _ => (1.0, 0),
    };
    let signs = match frame.name.as_str() {
        "LPS" => [-1.0, -1.0, 1.0],
        "LAS" => [-1.0, 1.0, 1.0],
        _ => [1.0; 3],
    };
    let affine = grid.affine();
    let scaled = |r: usize| affine[r].map(|x| if x == 0.0 { 0.0 } else { x * signs[r] * factor });
    (std::array::from_fn(scaled), unit)
}

fn column(affine: &[[f64; 4]; 3], axis: usize) -> [f64; 3] {
    affine.map(|row| row[axis])
}

fn dot(u: [f64; 3], v: [f64; 3]) -> f64 {
    (0..3).map(|k| u[k] * v[k]).sum()
}

fn spacing(affine: &[[f64; 4]; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| dot(column(affine, axis), column(affine, axis)).sqrt())
}

/// The directions of the axes as columns of length 1, if they are at right angles.
pub(super) fn directions(affine: &[[f64; 4]; 3]) -> Option<[[f64; 3]; 3]> {
    let spacing = spacing(affine);
    let columns: [[f64; 3]; 3] =
        std::array::from_fn(|axis| column(affine, axis).map(|x| x / spacing[axis]));
    let [x, y, z] = columns;
    let most = dot(x, y).abs().max(dot(y, z).abs()).max(dot(z, x).abs());
    (most < SHEAR).then_some(columns)
}

/// Sign of the third axis and vector part of the unit quaternion, if the axes are at right angles.
fn turn(affine: &[[f64; 4]; 3]) -> Option<(f64, [f64; 3])> {
    let [x, y, mut z] = directions(affine)?;
    let determinant =
        dot(z, [x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]]);
    let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
    z = z.map(|value| value * sign);
    // Four times the squares of a, b, c, d; the largest is divided by.
    let squares = [
        1.0 + x[0] + y[1] + z[2],
        1.0 + x[0] - y[1] - z[2],
        1.0 - x[0] + y[1] - z[2],
        1.0 - x[0] - y[1] + z[2],
    ];
    let largest = (0..4).fold(0, |best, n| if squares[n] > squares[best] { n } else { best });
    let half = squares[largest].sqrt() / 2.0;
    let over = |sum: f64| sum / (4.0 * half);
    let [a, b, c, d] = match largest {
        0 => [half, over(y[2] - z[1]), over(z[0] - x[2]), over(x[1] - y[0])],
        1 => [over(y[2] - z[1]), half, over(x[1] + y[0]), over(z[0] + x[2])],
        2 => [over(z[0] - x[2]), over(x[1] + y[0]), half, over(y[2] + z[1])],
        _ => [over(x[1] - y[0]), over(z[0] + x[2]), over(y[2] + z[1]), half],
    };
    Some((sign, if a < 0.0 { [-b, -c, -d] } else { [b, c, d] }))
}

fn floats(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| (*value as f32).to_le_bytes()).collect()
}
