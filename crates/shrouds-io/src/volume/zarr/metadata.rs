//! The metadata of an array, versions 2 and 3: its shape, and how its chunks are stored.

use std::path::PathBuf;

use serde_json::Value;

use crate::error::Error;
use crate::volume::decode::{Element, Endian};
use crate::volume::zarr::codec::Packing;
use crate::volume::zarr::element::{data_type, fill_bytes, numpy_type};
use crate::volume::zarr::node::Node;

/// Most voxels of a chunk.
const MAX_VOXELS: usize = 1 << 40;
/// Most axes.
const MAX_RANK: usize = 16;

/// An array: its shape, and how its chunks are stored.
#[derive(Debug)]
pub(super) struct Array {
    pub(super) folder: PathBuf,
    pub(super) file: PathBuf,
    pub(super) shape: Vec<usize>,
    pub(super) names: Vec<String>,
    /// Shape of what a file holds.
    pub(super) stored: Vec<usize>,
    pub(super) keys: Keys,
    pub(super) element: Element,
    /// One element as stored.
    pub(super) fill: Vec<u8>,
    pub(super) chunk: Chunk,
    /// Where the chunks of a file are listed, if it holds several.
    pub(super) index: Option<Index>,
}

/// Names of the files of chunks.
#[derive(Debug)]
pub(super) struct Keys {
    prefix: &'static str,
    separator: char,
}

/// What is compressed together.
#[derive(Debug)]
pub(super) struct Chunk {
    pub(super) shape: Vec<usize>,
    /// Axes from the slowest to the fastest.
    pub(super) order: Vec<usize>,
    pub(super) endian: Endian,
    pub(super) packing: Vec<Packing>,
}

/// The list of the chunks of a file.
#[derive(Debug)]
pub(super) struct Index {
    pub(super) at_start: bool,
    pub(super) endian: Endian,
    pub(super) checksum: bool,
}

impl Array {
    /// The array that a node is, if it is one.
    pub(super) fn of(node: &Node) -> Result<Option<Self>, Error> {
        let Some(metadata) = &node.array else { return Ok(None) };
        let parser = Parser { node, metadata };
        if metadata["zarr_format"] == 2 { parser.second() } else { parser.third() }.map(Some)
    }
}

impl Keys {
    /// The file of a chunk within the folder of the array.
    pub(super) fn file(&self, numbers: &[usize]) -> String {
        let mut name = self.prefix.to_owned();
        for number in numbers {
            if !name.is_empty() {
                name.push(self.separator);
            }
            name.push_str(&number.to_string());
        }
        name
    }
}

struct Parser<'a> {
    node: &'a Node,
    metadata: &'a Value,
}

impl Parser<'_> {
    fn damaged(&self, problem: impl Into<String>) -> Error {
        Error::header(&self.node.file, problem)
    }

    fn unsupported(&self, what: impl Into<String>) -> Error {
        let advice = "write it again with zarr-python's defaults";
        Error::unsupported(&self.node.file, what, advice)
    }

    fn second(&self) -> Result<Array, Error> {
        let metadata = self.metadata;
        let shape = self.numbers(&metadata["shape"], "shape", None)?;
        let stored = self.numbers(&metadata["chunks"], "chunks", Some(shape.len()))?;
        self.check_size(&stored)?;
        let name = metadata["dtype"].as_str().unwrap_or("of records");
        let endian = if name.starts_with('>') { Endian::Big } else { Endian::Little };
        let element =
            numpy_type(name).ok_or_else(|| self.unsupported(format!("the data type {name}")))?;
        let order: Vec<usize> = match metadata["order"].as_str() {
            Some("C") => (0..shape.len()).collect(),
            Some("F") => (0..shape.len()).rev().collect(),
            _ => return Err(self.damaged("the order is neither C nor F")),
        };
        if metadata["filters"].as_array().is_some_and(|filters| !filters.is_empty()) {
            return Err(self.unsupported(format!("the filters {}", metadata["filters"])));
        }
        let packing = match &metadata["compressor"] {
            Value::Null => Vec::new(),
            compressor => vec![self.packing(&compressor["id"])?],
        };
        let separator = match metadata["dimension_separator"].as_str() {
            Some("/") => '/',
            _ => '.',
        };
        Ok(Array {
            names: self.dimension_names(&self.node.attributes["_ARRAY_DIMENSIONS"]),
            keys: Keys { prefix: "", separator },
            fill: self.fill(element, endian)?,
            chunk: Chunk { shape: stored.clone(), order, endian, packing },
            index: None,
            ..self.array(shape, stored, element)
        })
    }

    fn third(&self) -> Result<Array, Error> {
        let metadata = self.metadata;
        let shape = self.numbers(&metadata["shape"], "shape", None)?;
        let grid = &metadata["chunk_grid"];
        if grid["name"] != "regular" {
            return Err(self.unsupported(format!("the chunk grid {}", grid["name"])));
        }
        let stored = &grid["configuration"]["chunk_shape"];
        let stored = self.numbers(stored, "chunk shape", Some(shape.len()))?;
        if metadata["storage_transformers"].as_array().is_some_and(|list| !list.is_empty()) {
            return Err(self.unsupported("what storage transformers wrote"));
        }
        let name = metadata["data_type"].as_str().unwrap_or("of records");
        let element =
            data_type(name).ok_or_else(|| self.unsupported(format!("the data type {name}")))?;
        let codecs = self.list(&metadata["codecs"])?;
        let shard = codecs.first().filter(|codec| codec["name"] == "sharding_indexed");
        let (chunk, index) = match shard.map(|shard| &shard["configuration"]) {
            Some(_) if codecs.len() > 1 => {
                return Err(self.unsupported("chunks that are packed after sharding"));
            }
            Some(shard) => {
                let inner =
                    self.numbers(&shard["chunk_shape"], "chunk shape", Some(shape.len()))?;
                if stored.iter().zip(&inner).any(|(stored, inner)| !stored.is_multiple_of(*inner)) {
                    return Err(self.damaged("the chunks do not divide the shard"));
                }
                let chunk = self.chunk(inner, self.list(&shard["codecs"])?)?;
                (chunk, Some(self.index(shard)?))
            }
            None => (self.chunk(stored.clone(), codecs)?, None),
        };
        Ok(Array {
            names: self.dimension_names(&metadata["dimension_names"]),
            keys: self.keys()?,
            fill: self.fill(element, chunk.endian)?,
            chunk,
            index,
            ..self.array(shape, stored, element)
        })
    }

    fn array(&self, shape: Vec<usize>, stored: Vec<usize>, element: Element) -> Array {
        let chunk = Chunk { shape: vec![], order: vec![], endian: Endian::Little, packing: vec![] };
        Array {
            folder: self.node.folder.clone(),
            file: self.node.file.clone(),
            shape,
            stored,
            element,
            names: Vec::new(),
            keys: Keys { prefix: "", separator: '.' },
            fill: Vec::new(),
            chunk,
            index: None,
        }
    }

    fn keys(&self) -> Result<Keys, Error> {
        let encoding = &self.metadata["chunk_key_encoding"];
        let separator = encoding["configuration"]["separator"].as_str();
        match (encoding["name"].as_str(), separator) {
            (Some("default"), None | Some("/")) => Ok(Keys { prefix: "c", separator: '/' }),
            (Some("default"), Some(".")) => Ok(Keys { prefix: "c", separator: '.' }),
            (Some("v2"), None | Some(".")) => Ok(Keys { prefix: "", separator: '.' }),
            (Some("v2"), Some("/")) => Ok(Keys { prefix: "", separator: '/' }),
            _ => Err(self.unsupported(format!("the chunk key encoding {encoding}"))),
        }
    }

    fn chunk(&self, shape: Vec<usize>, codecs: &[Value]) -> Result<Chunk, Error> {
        self.check_size(&shape)?;
        let mut order: Vec<usize> = (0..shape.len()).collect();
        let mut endian = None;
        let mut packing = Vec::new();
        for codec in codecs {
            match codec["name"].as_str() {
                Some("transpose") if endian.is_none() => {
                    let axes = self.permutation(&codec["configuration"]["order"], shape.len())?;
                    order = axes.iter().map(|axis| order[*axis]).collect();
                }
                Some("bytes") if endian.is_none() => endian = Some(endian_of(codec)),
                _ if endian.is_none() => {
                    return Err(self.unsupported(format!("the codec {}", codec["name"])));
                }
                _ => packing.push(self.packing(&codec["name"])?),
            }
        }
        let endian = endian.ok_or_else(|| self.damaged("no codec makes bytes of elements"))?;
        Ok(Chunk { shape, order, endian, packing })
    }

    /// That the places of voxels in a chunk are numbers; how large it may be depends on its file.
    fn check_size(&self, chunk: &[usize]) -> Result<(), Error> {
        let voxels = chunk.iter().try_fold(1usize, |all, n| all.checked_mul(*n));
        if voxels.is_some_and(|voxels| voxels <= MAX_VOXELS) {
            return Ok(());
        }
        let advice = "write the array again in chunks of at most a gigabyte";
        Err(Error::unsupported(&self.node.file, format!("chunks of shape {chunk:?}"), advice))
    }

    fn index(&self, shard: &Value) -> Result<Index, Error> {
        let names: Vec<&str> = self
            .list(&shard["index_codecs"])?
            .iter()
            .map(|codec| codec["name"].as_str().unwrap_or_default())
            .collect();
        let checksum = match names[..] {
            ["bytes"] => false,
            ["bytes", "crc32c"] => true,
            _ => return Err(self.unsupported(format!("a shard index of codecs {names:?}"))),
        };
        let endian = endian_of(&shard["index_codecs"][0]);
        Ok(Index { at_start: shard["index_location"] == "start", endian, checksum })
    }

    fn permutation(&self, order: &Value, rank: usize) -> Result<Vec<usize>, Error> {
        let axes: Vec<usize> = match order.as_str() {
            Some("C") => (0..rank).collect(),
            Some("F") => (0..rank).rev().collect(),
            _ => {
                self.list(order)?.iter().filter_map(|n| usize::try_from(n.as_u64()?).ok()).collect()
            }
        };
        let mut sorted = axes.clone();
        sorted.sort_unstable();
        if sorted.into_iter().eq(0..rank) {
            return Ok(axes);
        }
        Err(self.damaged("the order of the axes is no permutation"))
    }

    fn packing(&self, name: &Value) -> Result<Packing, Error> {
        let name = name.as_str().unwrap_or("without a name");
        let advice = "write it again with blosc, zstd, gzip or no compression";
        Packing::named(name)
            .ok_or_else(|| Error::unsupported(&self.node.file, format!("the codec {name}"), advice))
    }

    fn list<'v>(&self, value: &'v Value) -> Result<&'v [Value], Error> {
        let list = value.as_array().ok_or_else(|| self.damaged("a list is missing"))?;
        if list.len() > MAX_RANK {
            return Err(self.damaged(format!("a list has more than {MAX_RANK} entries")));
        }
        Ok(list)
    }

    fn numbers(&self, value: &Value, name: &str, rank: Option<usize>) -> Result<Vec<usize>, Error> {
        let damaged = || self.damaged(format!("the {name} is not a list of positive numbers"));
        let list = value.as_array().ok_or_else(damaged)?;
        let number = |n: &Value| usize::try_from(n.as_u64()?).ok().filter(|n| *n > 0);
        let numbers: Option<Vec<usize>> = list.iter().take(MAX_RANK + 1).map(number).collect();
        let numbers = numbers.ok_or_else(damaged)?;
        if numbers.len() > MAX_RANK || rank.is_some_and(|rank| rank != numbers.len()) {
            return Err(self.damaged(format!("the {name} has {} axes", list.len())));
        }
        Ok(numbers)
    }

    fn dimension_names(&self, value: &Value) -> Vec<String> {
        let names = value.as_array().map_or(&[][..], Vec::as_slice);
        names.iter().map(|name| name.as_str().unwrap_or_default().to_owned()).collect()
    }

    /// The value of voxels that are not stored.
    fn fill(&self, element: Element, endian: Endian) -> Result<Vec<u8>, Error> {
        let value = &self.metadata["fill_value"];
        let problem = || self.damaged(format!("the fill value {value} is none of the data type"));
        let mut bytes = fill_bytes(element, value).ok_or_else(problem)?;
        if endian == Endian::Big {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

fn endian_of(codec: &Value) -> Endian {
    if codec["configuration"]["endian"] == "big" { Endian::Big } else { Endian::Little }
}
