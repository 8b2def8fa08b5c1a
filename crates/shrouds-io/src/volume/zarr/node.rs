//! What a folder says of itself: `zarr.json` of version 3, `.zarray`, `.zgroup` and `.zattrs` of
//! version 2.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::Error;

/// Longest file of metadata that is read.
const MAX_LENGTH: u64 = 1 << 24;

/// A folder of a hierarchy.
#[derive(Debug)]
pub(super) struct Node {
    pub(super) folder: PathBuf,
    /// The file with its metadata.
    pub(super) file: PathBuf,
    pub(super) attributes: Value,
    /// The metadata, if it is an array.
    pub(super) array: Option<Value>,
}

impl Node {
    /// The node in a folder, if it is one.
    pub(super) fn read(folder: &Path) -> Result<Option<Self>, Error> {
        let file = folder.join("zarr.json");
        if let Some(mut metadata) = json(&file)? {
            let attributes = metadata["attributes"].take();
            let is_array = metadata["node_type"] == "array";
            let array = is_array.then_some(metadata);
            return Ok(Some(Self { folder: folder.into(), file, attributes, array }));
        }
        let attributes = json(&folder.join(".zattrs"))?;
        let file = folder.join(".zarray");
        if let Some(array) = json(&file)? {
            let attributes = attributes.unwrap_or_default();
            return Ok(Some(Self { folder: folder.into(), file, attributes, array: Some(array) }));
        }
        if attributes.is_none() && json(&folder.join(".zgroup"))?.is_none() {
            return Ok(None);
        }
        let attributes = attributes.unwrap_or_default();
        Ok(Some(Self {
            folder: folder.into(),
            file: folder.join(".zattrs"),
            attributes,
            array: None,
        }))
    }

    pub(super) fn is_array(&self) -> bool {
        self.array.is_some()
    }

    /// What OME says of the node, wherever the version puts it.
    pub(super) fn ome(&self) -> &Value {
        let ome = &self.attributes["ome"];
        if ome.is_object() { ome } else { &self.attributes }
    }
}

/// Reads a file of metadata, if there is one.
fn json(path: &Path) -> Result<Option<Value>, Error> {
    let file = match File::open(path) {
        Ok(file) => file,
        Err(cause) if cause.kind() == std::io::ErrorKind::NotFound => return Ok(None),
        Err(cause) => return Err(Error::open(path, cause)),
    };
    let mut text = Vec::new();
    let read = file.take(MAX_LENGTH + 1).read_to_end(&mut text);
    read.map_err(|cause| Error::open(path, cause))?;
    if text.len() as u64 > MAX_LENGTH {
        return Err(Error::header(path, format!("it is longer than {MAX_LENGTH} bytes")));
    }
    let value =
        serde_json::from_slice(&text).map_err(|error| Error::header(path, error.to_string()))?;
    Ok(Some(value))
}
