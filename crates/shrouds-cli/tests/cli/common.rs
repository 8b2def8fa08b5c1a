//! A folder to work in, the program, and files made byte by byte.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use flate2::{Compression, write::GzEncoder};
use serde_json::Value;
use shrouds::volume::phantom::named;
use shrouds::{Grid, Occupancy, TriMesh};
use shrouds_io::{read_mesh, write_npy};
use tempfile::TempDir;

/// A folder that goes away, in which the program runs.
pub(crate) struct Folder(TempDir);

/// How a call ended.
pub(crate) struct Done {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Folder {
    pub(crate) fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    /// A folder with `volume.npy`, the linked tori on 24³ points.
    pub(crate) fn with_tori() -> Self {
        let folder = Self::new();
        folder.volume("volume.npy", &named("tori", 24).unwrap().volume);
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn file(&self, name: &str, bytes: &[u8]) {
        std::fs::write(self.path(name), bytes).unwrap();
    }

    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    pub(crate) fn volume(&self, name: &str, volume: &Occupancy) {
        write_npy(self.path(name), volume).unwrap();
    }

    pub(crate) fn mesh(&self, name: &str) -> TriMesh {
        read_mesh(self.path(name)).unwrap()
    }

    pub(crate) fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&self.bytes(name)).unwrap()
    }

    /// Everything in the folder, hidden files too, in order.
    pub(crate) fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// Runs the program in the folder with words separated by spaces.
    pub(crate) fn run(&self, words: &str) -> Done {
        let output = command(self.0.path(), words).output().unwrap();
        Done::new(output)
    }

    /// Runs the program, which must succeed, and returns its standard output.
    pub(crate) fn succeed(&self, words: &str) -> String {
        let done = self.run(words);
        assert_eq!(done.code, 0, "shrouds {words}: {}", done.err);
        done.out
    }

    /// Runs the program, which must fail with this code and one line that contains all these parts,
    /// and leave the folder as it was.
    pub(crate) fn refuse(&self, words: &str, code: i32, parts: &[&str]) {
        let before = self.names();
        let done = self.run(words);
        assert_eq!(done.code, code, "shrouds {words}: {}", done.err);
        assert!(done.err.starts_with("error: "), "shrouds {words}: {}", done.err);
        assert_eq!(done.err.lines().count(), 1, "shrouds {words}: {}", done.err);
        for part in parts {
            assert!(done.err.contains(part), "shrouds {words}: no '{part}' in {}", done.err);
        }
        assert_eq!(done.out, "", "shrouds {words}");
        assert_eq!(self.names(), before, "shrouds {words}");
    }
}

impl Done {
    fn new(output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let done = Self {
            code: output.status.code().unwrap(),
            out: text(output.stdout),
            err: text(output.stderr),
        };
        for word in ["panicked", "backtrace", "RUST_BACKTRACE", "thread '"] {
            assert!(!done.err.contains(word), "{}", done.err);
        }
        done
    }
}

pub(crate) fn command(folder: &Path, words: &str) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_shrouds"));
    command.args(words.split_whitespace()).current_dir(folder).env("RUST_BACKTRACE", "1");
    command
}

/// A volume on unit spacing.
pub(crate) fn volume(dims: [usize; 3], inside: impl Fn([usize; 3]) -> bool + Sync) -> Occupancy {
    Occupancy::from_fn(Grid::new(dims, [1.0; 3]).unwrap(), inside)
}

/// The label of a lattice point of a cube with `size` points along an edge: a ball with this square of its radius, cut
/// into three labels by two slanted planes.
pub(crate) fn cut_ball(size: usize, square: f64, n: usize) -> u8 {
    let centre = size as f64 / 2.0 - 0.4;
    let [x, y, z] = [n % size, n / size % size, n / size / size].map(|x| x as f64 - centre);
    match () {
        () if x * x + y * y + z * z > square => 0,
        () if x + 0.3 * y - 0.2 * z < 0.4 => 4,
        () if y - 0.4 * z < 0.7 => 1,
        () => 9,
    }
}

/// A NumPy file of this type and shape.
pub(crate) fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.bytes());
    file.extend(data);
    file
}

/// A NIfTI-1 file of bytes with these dimensions and this index-to-world map.
pub(crate) fn nifti(dims: &[i16], affine: [[f32; 4]; 3], data: &[u8]) -> Vec<u8> {
    let mut header = vec![0; 352];
    let mut put = |at: usize, bytes: &[u8]| header[at..at + bytes.len()].copy_from_slice(bytes);
    put(0, &348i32.to_le_bytes());
    put(40, &(dims.len() as i16).to_le_bytes());
    for (n, length) in dims.iter().enumerate() {
        put(42 + 2 * n, &length.to_le_bytes());
    }
    put(70, &2i16.to_le_bytes());
    put(72, &8i16.to_le_bytes());
    for n in 0..8 {
        put(76 + 4 * n, &1f32.to_le_bytes());
    }
    put(108, &352f32.to_le_bytes());
    put(123, &[2]);
    put(254, &1i16.to_le_bytes());
    for (n, x) in affine.as_flattened().iter().enumerate() {
        put(280 + 4 * n, &x.to_le_bytes());
    }
    put(344, b"n+1\0");
    [&header, data].concat()
}

pub(crate) fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
    encoder.write_all(bytes).unwrap();
    encoder.finish().unwrap()
}
