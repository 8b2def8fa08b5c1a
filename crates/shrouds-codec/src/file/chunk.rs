//! A piece of a file that can be checked by itself.

use std::io::{self, Read, Write};

use crate::error::Error;
use crate::file::number;

/// What a chunk holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The bits of some layers.
    Topology,
    /// One more bit of the place of every vertex.
    Plane,
    /// The labels of some layers.
    Labels,
}

const KINDS: [(Kind, u8); 3] = [(Kind::Topology, 1), (Kind::Plane, 2), (Kind::Labels, 3)];

/// A chunk, whose own check sum is right.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chunk {
    /// What it holds.
    pub kind: Kind,
    /// The slab, from 0, or the plane, from 1.
    pub number: u64,
    /// The coded bytes.
    pub payload: Vec<u8>,
    /// CRC-32 of what they stand for.
    pub decoded_sum: u32,
}

impl Chunk {
    pub(crate) fn write(&self, out: &mut impl Write) -> Result<u64, Error> {
        let mut bytes = self.start(self.payload.len() as u64);
        bytes.extend(&self.payload);
        bytes.extend(self.decoded_sum.to_le_bytes());
        let sum = crc32fast::hash(&bytes);
        bytes.extend(sum.to_le_bytes());
        out.write_all(&bytes)?;
        Ok(bytes.len() as u64)
    }

    fn start(&self, length: u64) -> Vec<u8> {
        let kind = KINDS.iter().find(|(kind, _)| *kind == self.kind).map_or(0, |&(_, byte)| byte);
        let mut bytes = vec![kind];
        number::write(&mut bytes, self.number);
        number::write(&mut bytes, length);
        bytes
    }

    /// Reads the next chunk, if there is one; what is wrong with it otherwise.
    pub(crate) fn read(input: &mut impl Read) -> Result<Option<Self>, Damage> {
        let mut first = Vec::new();
        input.by_ref().take(1).read_to_end(&mut first)?;
        let Some(first) = first.first() else { return Ok(None) };
        let Some(&(kind, _)) = KINDS.iter().find(|(_, byte)| byte == first) else {
            return Err(Damage::Sum);
        };
        let number = number::read(input)?;
        let length = number::read(input)?;
        let mut payload = Vec::new();
        // Grows with the bytes that are there, whatever the length says.
        input.by_ref().take(length).read_to_end(&mut payload)?;
        if (payload.len() as u64) < length {
            return Err(Damage::End);
        }
        let mut sums = [[0; 4]; 2];
        for sum in &mut sums {
            input.read_exact(sum)?;
        }
        let [decoded_sum, sum] = sums.map(u32::from_le_bytes);
        let chunk = Self { kind, number, payload, decoded_sum };
        let mut hasher = crc32fast::Hasher::new();
        hasher.update(&chunk.start(length));
        hasher.update(&chunk.payload);
        hasher.update(&sums[0]);
        if hasher.finalize() != sum { Err(Damage::Sum) } else { Ok(Some(chunk)) }
    }
}

/// Why there is no chunk.
#[derive(Debug)]
pub(crate) enum Damage {
    /// The file ends within it.
    End,
    /// A check sum is wrong, or what it should be about makes no sense.
    Sum,
    /// The system refused.
    Io(io::Error),
}

impl From<io::Error> for Damage {
    fn from(error: io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::UnexpectedEof => Self::End,
            io::ErrorKind::InvalidData => Self::Sum,
            _ => Self::Io(error),
        }
    }
}
