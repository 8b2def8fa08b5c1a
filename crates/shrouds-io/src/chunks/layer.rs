//! From positions to the fragments of a Neuroglancer layer, with coarser surfaces for what is far.

use std::fs;
use std::path::Path;

use crate::atomic::write_atomically;
use crate::chunks::artefact::Artefact;
use crate::chunks::run::Found;
use crate::chunks::{COARSER, ChunkRun, IDENTITY};
use crate::error::Error;
use crate::precomputed::{Manifest, Node, VertexBits, fragments};

const FRAGMENTS: &str = "fragments";

/// Which chunk of which resolution has a fragment, and from which byte of its own on.
#[derive(Debug, Clone, Copy)]
struct Place {
    level: usize,
    chunk: [usize; 3],
    start: usize,
}

impl ChunkRun {
    /// The same work on a lattice of half as many points ([`Layout::halved`](shrouds::chunks::Layout::halved)), in a folder within that of this
    /// one. Its voxels come from [`take_finer`](Self::take_finer).
    ///
    /// # Errors
    /// As for [`open`](Self::open); [`Error::Chunks`] where there is no coarser lattice, see
    /// [`Layout::levels`](shrouds::chunks::Layout::levels).
    pub fn coarser(&self) -> Result<Self, Error> {
        let layout = self.layout.halved().map_err(|cause| self.failed(cause))?;
        let identity = fs::read_to_string(self.folder.join(IDENTITY))
            .map_err(|cause| self.refused("read which work it holds", cause))?;
        Self::open(self.folder.join(COARSER), &identity, layout, &self.settings)
    }

    /// Takes in the voxels of a chunk from those of the run that this one was made from by
    /// [`coarser`](Self::coarser), all of which must be there, unless that was done.
    ///
    /// # Errors
    /// Those of reading and writing files.
    pub fn take_finer(&self, finer: &Self, chunk: [usize; 3]) -> Result<(), Error> {
        if self.has_voxels(chunk)? {
            return Ok(());
        }
        let voxels = |other| finer.voxels(other).map_err(Found::File);
        let halved = finer.layout.halved_voxels(chunk, voxels).map_err(|found| self.of(found))?;
        self.put_voxels(chunk, &halved)
    }

    /// Prepares the mesh of a chunk for the file that [`join_levels`](Self::join_levels) writes, unless that
    /// was done with as many bits.
    ///
    /// # Errors
    /// As for [`mesh`](Self::mesh); [`Error::Unwritable`] when Draco cannot code it.
    pub fn write_fragments(&self, chunk: [usize; 3], bits: VertexBits) -> Result<(), Error> {
        let path = self.file(FRAGMENTS, chunk);
        if Artefact::summary(&path)?.is_some_and(|known| known[2] == u64::from(bits.count())) {
            return Ok(());
        }
        let (made, _) = self.mesh(chunk)?;
        let layout = self.layout();
        let found = fragments(&made.mesh, layout.grid(), layout.edge(), bits)
            .map_err(|problem| Error::Unwritable { path: path.clone(), problem })?;
        let triangles: usize = found.iter().map(|fragment| fragment.triangles).sum();
        let places: Vec<u32> = found.iter().flat_map(|fragment| fragment.place).collect();
        let sizes: Vec<u32> = found.iter().map(|fragment| fragment.bytes.len() as u32).collect();
        let bytes: Vec<u8> = found.into_iter().flat_map(|fragment| fragment.bytes).collect();
        Artefact::new([sizes.len() as u64, triangles as u64, u64::from(bits.count())])
            .push(places.into_iter())
            .push(sizes.into_iter())
            .push(bytes.into_iter())
            .write(&path)
    }

    /// Writes the fragments of this run and of the coarser ones made from it, one after another, to two files
    /// in a folder: `LABEL` with the meshes and then `LABEL.index`, with which they count as there. Returns how
    /// many resolutions have a mesh; with none there are no files.
    ///
    /// # Errors
    /// Those of reading and writing files.
    pub fn join_levels(
        &self,
        coarser: &[&Self],
        folder: &Path,
        label: &str,
    ) -> Result<usize, Error> {
        let runs: Vec<&Self> = std::iter::once(&self).chain(coarser).copied().collect();
        let mut levels = Vec::new();
        for (level, run) in runs.iter().enumerate() {
            let nodes = run.nodes(level)?;
            if nodes.is_empty() {
                break;
            }
            levels.push(nodes);
        }
        if levels.is_empty() {
            return Ok(0);
        }
        let manifest = Manifest::new(self.layout.edge(), levels);
        let places =
            manifest.levels.iter().flatten().filter_map(|node| Some((node.source?, node.size)));
        let mut failed = None;
        let written = write_atomically(folder.join(label), |writer| {
            for (place, size) in places {
                match runs[place.level].fragment(place, size as usize) {
                    Ok(bytes) => writer.write_all(&bytes)?,
                    Err(error) => {
                        failed = Some(error);
                        return Err(std::io::Error::other("a fragment cannot be read"));
                    }
                }
            }
            Ok(())
        });
        failed.map_or(written, Err)?;
        let bytes = manifest.bytes();
        write_atomically(folder.join(format!("{label}.index")), |writer| writer.write_all(&bytes))?;
        Ok(manifest.levels.len())
    }

    /// All fragments of this resolution.
    fn nodes(&self, level: usize) -> Result<Vec<Node<Place>>, Error> {
        let mut nodes = Vec::new();
        for chunk in self.layout.chunks() {
            let path = self.file(FRAGMENTS, chunk);
            let summary =
                Artefact::summary(&path)?.ok_or(Error::Artefact { path: path.clone() })?;
            if summary[0] == 0 {
                continue;
            }
            let mut artefact = Artefact::read(&path)?;
            let (places, sizes): (Vec<u32>, Vec<u32>) = (artefact.next()?, artefact.next()?);
            let mut start = 0;
            for (place, size) in places.as_chunks().0.iter().zip(sizes) {
                let source = Some(Place { level, chunk, start });
                nodes.push(Node { place: *place, size, source });
                start += size as usize;
            }
        }
        Ok(nodes)
    }

    fn fragment(&self, place: Place, size: usize) -> Result<Vec<u8>, Error> {
        let path = self.file(FRAGMENTS, place.chunk);
        let mut artefact = Artefact::read(&path)?;
        artefact.next::<4, u32>()?;
        artefact.next::<4, u32>()?;
        let bytes: Vec<u8> = artefact.next()?;
        let own = bytes.get(place.start..place.start + size);
        own.map(<[u8]>::to_vec).ok_or(Error::Artefact { path })
    }
}
