//! Slabs: some layers in, one payload out, and back.

use crate::coder::{Coder, Decoder, Encoder};
use crate::file::Profile;
use crate::topology::dense::Dense;
use crate::topology::fast::Fast;
use crate::topology::scan::Scan;

/// What has been learnt, and the last layers: carried from slab to slab, or made anew for each.
#[derive(Debug, Clone)]
pub(crate) struct State {
    scan: Scan,
    model: AnyModel,
}

#[derive(Debug, Clone)]
enum AnyModel {
    Fast(Fast),
    Dense(Box<Dense>),
}

impl State {
    /// At most so many layers are in memory for it, with all that is known of them.
    pub(crate) const LAYERS: u64 = 32;

    /// The state before the first layer of `nx` by `ny` voxels.
    pub(crate) fn new([nx, ny]: [usize; 2], profile: Profile) -> Self {
        let model = match profile {
            Profile::Fast => AnyModel::Fast(Fast::default()),
            Profile::Dense => AnyModel::Dense(Box::default()),
        };
        Self { scan: Scan::new([nx, ny]), model }
    }

    fn layer(&mut self, coder: &mut impl Coder, words: &mut [u64]) {
        match &mut self.model {
            AnyModel::Fast(model) => self.scan.layer(coder, model, words),
            AnyModel::Dense(model) => self.scan.layer(coder, &mut **model, words),
        }
    }
}

/// Codes the layers of a slab, one after another.
pub(crate) struct SlabEncoder {
    coder: Encoder,
    hasher: crc32fast::Hasher,
    /// The layer that is being coded.
    words: Vec<u64>,
}

impl SlabEncoder {
    pub(crate) fn new() -> Self {
        Self { coder: Encoder::new(), hasher: crc32fast::Hasher::new(), words: Vec::new() }
    }

    /// Codes a layer: its rows, each beginning a new word.
    pub(crate) fn layer(&mut self, state: &mut State, words: &[u64]) {
        hash(&mut self.hasher, words);
        self.words.clear();
        self.words.extend_from_slice(words);
        state.layer(&mut self.coder, &mut self.words);
    }

    /// The payload, and the check sum of the bits.
    pub(crate) fn finish(self) -> (Vec<u8>, u32) {
        (self.coder.finish(), self.hasher.finalize())
    }
}

/// The words of the layers of a slab, each of `words` words, and the check sum of the bits.
pub(crate) fn decode(state: &mut State, payload: &[u8], layers: &mut [u64], words: usize) -> u32 {
    let mut coder = Decoder::new(payload);
    let mut hasher = crc32fast::Hasher::new();
    for layer in layers.chunks_exact_mut(words) {
        state.layer(&mut coder, layer);
        hash(&mut hasher, layer);
    }
    hasher.finalize()
}

/// Whether a payload can hold so many words: to keep one as it is takes log2(65536 / 65535) bits at
/// least, so a payload of some bytes cannot ask for more memory than some megabytes for each.
pub(crate) fn is_possible(payload: usize, words: u64) -> bool {
    words >> 19 <= payload as u64 + 8
}

fn hash(hasher: &mut crc32fast::Hasher, words: &[u64]) {
    let mut bytes = [0; 4096];
    for words in words.chunks(512) {
        for (place, word) in bytes.chunks_exact_mut(8).zip(words) {
            place.copy_from_slice(&word.to_le_bytes());
        }
        hasher.update(&bytes[..8 * words.len()]);
    }
}
