//! VTK image data out: one piece, an array of the points, appended in blocks compressed by zlib.

use std::io::{self, Write};
use std::path::Path;

use flate2::Compression;
use flate2::write::ZlibEncoder;
use shrouds::{Grid, Occupancy};

use crate::atomic::write_atomically;
use crate::error::Error;
use crate::volume::nifti_write::directions;
use crate::volume::write::write_bytes;

/// Bytes of an unpacked block.
const BLOCK: usize = 1 << 20;

pub(super) fn write(path: &Path, volume: &Occupancy) -> Result<(), Error> {
    let header = header(path, volume.grid())?;
    write_atomically(path, |writer| {
        writer.write_all(header.as_bytes())?;
        let mut blocks = Blocks::default();
        write_bytes(volume, &mut blocks)?;
        blocks.finish(writer)?;
        writer.write_all(b"\n  </AppendedData>\n</VTKFile>\n")
    })
}

fn header(path: &Path, grid: &Grid) -> Result<String, Error> {
    let affine = grid.affine();
    let Some([x, y, z]) = directions(&affine) else {
        let problem = "its axes are not at right angles, which VTK images do not hold: write .nrrd \
            or .nii instead";
        return Err(Error::UnwritableVolume { path: path.into(), problem: problem.into() });
    };
    let list = |numbers: &[f64]| {
        numbers.iter().map(|number| number.to_string()).collect::<Vec<_>>().join(" ")
    };
    let rows: Vec<f64> = (0..3).flat_map(|r| [x[r], y[r], z[r]]).collect();
    let [nx, ny, nz] = grid.dims().map(|n| n - 1);
    let extent = format!("0 {nx} 0 {ny} 0 {nz}");
    let (origin, spacing) = (list(&affine.map(|row| row[3])), list(&grid.spacing()));
    Ok(format!(
        r#"<?xml version="1.0"?>
<VTKFile type="ImageData" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">
  <ImageData WholeExtent="{extent}" Origin="{origin}" Spacing="{spacing}" Direction="{directions}">
    <Piece Extent="{extent}">
      <PointData Scalars="inside">
        <DataArray type="UInt8" Name="inside" format="appended" RangeMin="0" RangeMax="1" offset="0"/>
      </PointData>
      <CellData>
      </CellData>
    </Piece>
  </ImageData>
  <AppendedData encoding="raw">
   _"#,
        directions = list(&rows)
    ))
}

/// Packs what is written to it; the lengths of all blocks come before the first.
#[derive(Default)]
struct Blocks {
    block: Vec<u8>,
    packed: Vec<u8>,
    lengths: Vec<u64>,
}

impl Blocks {
    fn pack(&mut self) -> io::Result<()> {
        let start = self.packed.len();
        // Bits barely compress further at a higher level.
        let mut encoder = ZlibEncoder::new(&mut self.packed, Compression::fast());
        encoder.write_all(&self.block)?;
        encoder.finish()?;
        self.lengths.push((self.packed.len() - start) as u64);
        self.block.clear();
        Ok(())
    }

    fn finish(mut self, writer: &mut dyn Write) -> io::Result<()> {
        let last = self.block.len() as u64;
        if last > 0 {
            self.pack()?;
        }
        let numbers = [self.lengths.len() as u64, BLOCK as u64, last];
        for number in numbers.iter().chain(&self.lengths) {
            writer.write_all(&number.to_le_bytes())?;
        }
        writer.write_all(&self.packed)
    }
}

impl Write for Blocks {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = bytes.len().min(BLOCK - self.block.len());
        self.block.extend(&bytes[..count]);
        if self.block.len() == BLOCK {
            self.pack()?;
        }
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
