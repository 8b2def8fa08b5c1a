//! From positions to mesh files.

use std::path::Path;

use crate::atomic::write_atomically;
use crate::chunks::ChunkRun;
use crate::chunks::artefact::Artefact;
use crate::error::Error;
use crate::mesh::{MeshOptions, ply, write_mesh};

/// A piece of the file that [`ChunkRun::join`] writes, and a mark that a part is there.
const PIECE: &str = "piece";
const PART: &str = "part";

impl ChunkRun {
    /// Prepares the vertices and triangles of a chunk for the one PLY file that [`join`](Self::join)
    /// writes, unless that was done.
    ///
    /// # Errors
    /// As for [`mesh`](Self::mesh); [`Error::Unwritable`] when the surface has more vertices or
    /// triangles than 32 bits count.
    pub fn write_piece(&self, chunk: [usize; 3], options: &MeshOptions) -> Result<(), Error> {
        let path = self.file(PIECE, chunk);
        if Artefact::summary(&path)?.is_some() {
            return Ok(());
        }
        let totals = self.last_totals()?;
        if totals.vertices.max(totals.triangles) > u32::MAX.into() {
            let problem = format!(
                "{} vertices and {} triangles are more than 32 bits count; write parts to a folder",
                totals.vertices, totals.triangles
            );
            return Err(Error::Unwritable { path: self.folder.clone(), problem });
        }
        let (made, first) = self.mesh(chunk)?;
        let vertices = ply::vertex_bytes(&made.mesh, made.delta.len(), options);
        let number = |v| made.number(v, first) as u32;
        let faces = ply::face_bytes(made.mesh.triangles.iter().map(|t| t.map(number)));
        let counts = [made.delta.len() as u64, made.mesh.triangles.len() as u64, 0];
        Artefact::new(counts).push(vertices.into_iter()).push(faces.into_iter()).write(&path)
    }

    /// Writes all pieces to one PLY file, which appears whole or not at all. `options` are those of the
    /// pieces.
    ///
    /// # Errors
    /// Those of reading and writing files.
    pub fn join(&self, path: impl AsRef<Path>, options: &MeshOptions) -> Result<(), Error> {
        let totals = self.last_totals()?;
        let header = ply::header_of_parts([totals.vertices, totals.triangles], options);
        let mut failed = None;
        let written = write_atomically(path, |writer| {
            writer.write_all(header.as_bytes())?;
            for array in [0, 1] {
                for chunk in self.layout.chunks() {
                    match self.piece(chunk, array) {
                        Ok(bytes) => writer.write_all(&bytes)?,
                        Err(error) => {
                            failed = Some(error);
                            return Err(std::io::Error::other("a piece cannot be read"));
                        }
                    }
                }
            }
            Ok(())
        });
        failed.map_or(written, Err)
    }

    /// The bytes of the vertices or of the triangles of a piece.
    fn piece(&self, chunk: [usize; 3], array: usize) -> Result<Vec<u8>, Error> {
        let mut artefact = Artefact::read(&self.file(PIECE, chunk))?;
        let mut bytes = artefact.next()?;
        for _ in 0..array {
            bytes = artefact.next()?;
        }
        Ok(bytes)
    }

    /// Writes the mesh of a chunk to the file `X-Y-Z.ply` in a folder, unless that was done: its
    /// triangles with all their vertices, those that belong to other chunks too. A chunk without
    /// triangles has no file. Returns whether it has one.
    ///
    /// # Errors
    /// As for [`mesh`](Self::mesh).
    pub fn write_part(
        &self,
        chunk: [usize; 3],
        folder: &Path,
        options: &MeshOptions,
    ) -> Result<bool, Error> {
        let [i, j, k] = chunk;
        let (path, mark) = (folder.join(format!("{i}-{j}-{k}.ply")), self.file(PART, chunk));
        if let Some([_, triangles, _]) = Artefact::summary(&mark)?
            && (triangles == 0 || path.is_file())
        {
            return Ok(triangles > 0);
        }
        let (made, _) = self.mesh(chunk)?;
        let triangles = made.mesh.triangles.len() as u64;
        if triangles > 0 {
            write_mesh(&path, &made.mesh, options)?;
        }
        Artefact::new([made.delta.len() as u64, triangles, 0]).write(&mark)?;
        Ok(triangles > 0)
    }
}
