//! Certificates: what was found out about a mesh and its volume, in a file from which anyone can find it
//! out again.
//!
//! `subject` names mesh, volume and settings and examines them; `digest` and `place` say which files
//! these are; `properties` has what was found with its evidence; `verify` holds a certificate against its
//! files. Nothing in a certificate depends on the time or the machine.

mod digest;
mod place;
mod properties;
mod subject;
mod verify;

use std::path::Path;

use serde::{Deserialize, Serialize};
use shrouds::check::TOUCH;
use shrouds::volume::{Border, FaceRule};

use crate::args::{FrameChoice, Reading};
use crate::console::Console;
use crate::failure::Failure;
use crate::output::write_json;
use crate::progress::Progress;

use digest::Digest;
use properties::Properties;
pub(crate) use subject::{Examined, Subject};
pub(crate) use verify::{Verdict, verify};

/// The first field of every certificate.
const FORMAT: &str = "shrouds certificate";
/// Raised when a field gets another meaning.
const SCHEMA: u32 = 1;

#[derive(Serialize)]
struct Certificate {
    format: &'static str,
    schema: u32,
    /// Of the program; not part of what is certified.
    version: &'static str,
    mesh: MeshPart,
    volume: VolumePart,
    settings: SettingsPart,
    properties: Properties,
    /// Whether every property holds that a separating surface must have.
    holds: bool,
}

#[derive(Serialize)]
struct VolumePart {
    #[serde(flatten)]
    digest: Digest,
    dims: [usize; 3],
    /// Index to world, as it was used.
    affine: [[f64; 4]; 3],
    reading: Reading,
    /// Which voxels are inside, in words.
    selection: String,
    /// Number of inside voxels.
    inside: u64,
}

#[derive(Serialize)]
struct MeshPart {
    #[serde(flatten)]
    digest: Digest,
    vertices: u64,
    triangles: u64,
}

/// What was expected of the mesh.
#[derive(Serialize, Deserialize, Clone, Copy)]
#[serde(deny_unknown_fields)]
struct SettingsPart {
    #[serde(with = "crate::by_name")]
    border: Border,
    #[serde(with = "crate::by_name")]
    faces: FaceRule,
    /// Coordinates of the mesh.
    frame: FrameChoice,
    all_axes: bool,
    /// A lattice point this close to the mesh, in units of the index, touches it.
    touch: f64,
}

impl Certificate {
    /// The certificate of a subject that was examined, with its files.
    fn new(
        subject: &Subject,
        examined: &Examined,
        [mesh, volume]: [Digest; 2],
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let Subject { border, faces, all_axes, selection, .. } = *subject;
        let grid = examined.volume.grid();
        Ok(Self {
            format: FORMAT,
            schema: SCHEMA,
            version: env!("CARGO_PKG_VERSION"),
            mesh: MeshPart {
                digest: mesh,
                vertices: examined.mesh.vertices.len() as u64,
                triangles: examined.mesh.triangles.len() as u64,
            },
            volume: VolumePart {
                digest: volume,
                dims: grid.dims(),
                affine: examined.affine,
                reading: Reading::of(selection),
                selection: examined.words.clone(),
                inside: examined.volume.count(),
            },
            settings: SettingsPart {
                border,
                faces,
                frame: selection.coordinates(),
                all_axes,
                touch: TOUCH,
            },
            properties: Properties::new(examined, progress)?,
            holds: examined.report.is_clean(),
        })
    }
}

/// Writes the certificate of a subject that was examined.
pub(crate) fn write(
    path: &Path,
    subject: &Subject,
    examined: &Examined,
    progress: &Progress,
) -> Result<(), Failure> {
    progress.stage("hashing");
    let digests = digests(subject, place::folder_of(path))?;
    write_json(path, &Certificate::new(subject, examined, digests, progress)?)
}

/// Which files these are, for a certificate in a folder.
fn digests(subject: &Subject, folder: &Path) -> Result<[Digest; 2], Failure> {
    let mesh = Digest::of_mesh(subject.mesh, folder)?;
    Ok([mesh, Digest::of_volume(subject.volume, subject.selection, folder)?])
}

/// Examines mesh and volume as they are in their files and writes the certificate.
pub(crate) fn certify(
    path: &Path,
    subject: &Subject,
    console: Console,
    progress: &Progress,
) -> Result<(), Failure> {
    let examined = subject.examine(console, progress)?;
    write(path, subject, &examined, progress)
}
