//! Files from and for the page, in a folder that goes away with the server.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path as FilePath, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::body::{Body, Bytes};
use axum::extract::{Path, Request, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_LENGTH, CONTENT_TYPE};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use futures_util::{StreamExt, stream};
use tempfile::TempDir;

use super::{Shared, guard};
use crate::error::Error;

/// Bytes of all uploads together that are kept.
const MOST_BYTES: u64 = 4 << 30;
/// Uploads that are kept.
const MOST_UPLOADS: usize = 64;
/// Longest name of a file, in bytes.
const LONGEST_NAME: usize = 200;
/// A file goes out in pieces of so many bytes.
const PIECE: usize = 1 << 18;

/// The folder, and what in it is whose.
#[derive(Clone)]
pub struct Files(Arc<Inner>);

struct Inner {
    folder: TempDir,
    kept: Mutex<Kept>,
}

#[derive(Default)]
struct Kept {
    /// Uploads that nobody has taken yet, by their number in the address.
    uploads: BTreeMap<String, Upload>,
    downloads: BTreeMap<String, Download>,
    /// Bytes of all uploads, those that were taken or are still coming included.
    bytes: u64,
}

/// A file for the page, removed when it is dropped.
struct Download {
    name: String,
    place: Place,
}

/// A folder of a single file, removed when it is dropped.
struct Place(PathBuf);

impl Drop for Place {
    fn drop(&mut self) {
        // The folder around it goes in the end; until then it is only in the way.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A file from the page; it is removed when this is dropped.
pub struct Upload {
    path: PathBuf,
    bytes: u64,
    files: std::sync::Weak<Inner>,
    _place: Place,
}

impl Upload {
    /// Where it is.
    pub fn path(&self) -> &FilePath {
        &self.path
    }
}

impl Drop for Upload {
    fn drop(&mut self) {
        if let Some(inner) = self.files.upgrade() {
            inner.lock().bytes -= self.bytes;
        }
    }
}

impl Inner {
    fn lock(&self) -> MutexGuard<'_, Kept> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A new folder with a random name, and that name.
    fn place(&self) -> Result<(String, Place), Error> {
        let id = guard::random()?;
        let path = self.folder.path().join(&id);
        fs::create_dir(&path).map_err(no_room)?;
        Ok((id, Place(path)))
    }
}

fn no_room(cause: io::Error) -> Error {
    Error::Serve { what: "there is no room for files".into(), cause: cause.to_string() }
}

impl Files {
    pub(super) fn new() -> Result<Self, Error> {
        let folder = tempfile::Builder::new().prefix("shrouds-view-").tempdir().map_err(no_room)?;
        Ok(Self(Arc::new(Inner { folder, kept: Mutex::default() })))
    }

    /// Removes the folder, whoever still has a file in it.
    pub(super) fn remove(&self) {
        // What is left is empty or in use, and lies where the system cleans up.
        let _ = fs::remove_dir_all(self.0.folder.path());
    }

    /// The upload with this number, which is the caller's from now on.
    pub fn take(&self, id: &str) -> Option<Upload> {
        self.0.lock().uploads.remove(id)
    }

    /// Lets `write` make a file of this name and keeps it for the page until it was asked for again
    /// as [`forget`](Self::forget) says. Returns its number for the address `/download/NUMBER`.
    ///
    /// # Errors
    /// What `write` says; [`Error::Serve`] when there is no room.
    pub fn offer<E: From<Error>>(
        &self,
        name: &str,
        write: impl FnOnce(&FilePath) -> Result<(), E>,
    ) -> Result<String, E> {
        let (id, place) = self.0.place()?;
        write(&place.0.join(name))?;
        let download = Download { name: name.into(), place };
        self.0.lock().downloads.insert(id.clone(), download);
        Ok(id)
    }

    /// Removes a file that was offered.
    pub fn forget(&self, id: &str) {
        let gone = self.0.lock().downloads.remove(id);
        drop(gone);
    }
}

/// An upload on its way.
struct Coming {
    inner: Arc<Inner>,
    file: File,
    upload: Upload,
}

impl Coming {
    fn new(
        files: &Files,
        id_and_place: (String, Place),
        name: &str,
    ) -> Result<(String, Self), Error> {
        let (id, place) = id_and_place;
        let path = place.0.join(name);
        let file = File::create(&path).map_err(no_room)?;
        let files = Arc::downgrade(&files.0);
        let upload = Upload { path, bytes: 0, files: files.clone(), _place: place };
        let inner = files.upgrade().ok_or_else(|| no_room(io::ErrorKind::NotFound.into()))?;
        Ok((id, Self { inner, file, upload }))
    }

    /// Takes more bytes, or says why not.
    fn add(&mut self, bytes: &Bytes) -> Result<(), (StatusCode, String)> {
        let more = bytes.len() as u64;
        let mut state = self.inner.lock();
        if state.bytes + more > MOST_BYTES {
            return Err(too_large());
        }
        state.bytes += more;
        drop(state);
        self.upload.bytes += more;
        let no_room = |cause| (StatusCode::INSUFFICIENT_STORAGE, no_room(cause).to_string());
        self.file.write_all(bytes).map_err(no_room)
    }
}

fn too_large() -> (StatusCode, String) {
    let message = "uploads together may have 4 GiB; give the path of the file instead";
    (StatusCode::PAYLOAD_TOO_LARGE, message.into())
}

/// A name under which a file can be kept: no folder, not hidden.
fn checked_name(name: &str) -> Option<&str> {
    let is_plain = |c: char| !c.is_control() && !matches!(c, '/' | '\\' | ':' | '\0');
    let usable = !name.is_empty()
        && name.len() <= LONGEST_NAME
        && !name.starts_with('.')
        && name.chars().all(is_plain);
    usable.then_some(name)
}

/// Takes a file as it comes.
pub(super) async fn upload(State(shared): State<Shared>, request: Request) -> Response {
    match receive(&shared.files, request).await {
        Ok(id) => {
            let answer = format!("{{\"upload\": \"{id}\"}}");
            ([(CONTENT_TYPE, "application/json")], answer).into_response()
        }
        Err(refusal) => refusal.into_response(),
    }
}

async fn receive(files: &Files, request: Request) -> Result<String, (StatusCode, String)> {
    let name = guard::query(request.uri(), "name").unwrap_or_default();
    let name = checked_name(&name).ok_or_else(|| {
        (StatusCode::BAD_REQUEST, "give the name of the file, without folders, as ?name=".into())
    })?;
    if declared_length(request.headers()).is_some_and(|bytes| bytes > MOST_BYTES) {
        return Err(too_large());
    }
    if files.0.lock().uploads.len() >= MOST_UPLOADS {
        let message = "too many uploads were never opened; restart the program";
        return Err((StatusCode::TOO_MANY_REQUESTS, message.into()));
    }
    let failed = |error: Error| (StatusCode::INSUFFICIENT_STORAGE, error.to_string());
    let place = files.0.place().map_err(failed)?;
    let (id, mut coming) = Coming::new(files, place, name).map_err(failed)?;
    let mut body = request.into_body().into_data_stream();
    while let Some(bytes) = body.next().await {
        let broken = |_| (StatusCode::BAD_REQUEST, "the upload broke off".to_owned());
        coming.add(&bytes.map_err(broken)?)?;
    }
    let Coming { upload, inner, .. } = coming;
    inner.lock().uploads.insert(id.clone(), upload);
    Ok(id)
}

fn declared_length(headers: &HeaderMap) -> Option<u64> {
    headers.get(CONTENT_LENGTH)?.to_str().ok()?.parse().ok()
}

/// Gives a file that a session offers.
pub(super) async fn download(State(shared): State<Shared>, Path(id): Path<String>) -> Response {
    let gone = || (StatusCode::NOT_FOUND, "there is no such file any more").into_response();
    let found = {
        let state = shared.files.0.lock();
        state.downloads.get(&id).map(|file| (file.name.clone(), file.place.0.join(&file.name)))
    };
    let Some((name, path)) = found else { return gone() };
    let Ok(file) = File::open(path) else { return gone() };
    let length = file.metadata().map_or(0, |about| about.len());
    let headers = [
        (CONTENT_TYPE, "application/octet-stream".to_owned()),
        (CONTENT_LENGTH, length.to_string()),
        (CONTENT_DISPOSITION, format!("attachment; filename=\"{name}\"")),
    ];
    (headers, Body::from_stream(stream::iter(pieces(file)))).into_response()
}

/// A file piece by piece.
fn pieces(mut file: File) -> impl Iterator<Item = io::Result<Bytes>> {
    std::iter::from_fn(move || {
        let mut piece = Vec::new();
        match Read::by_ref(&mut file).take(PIECE as u64).read_to_end(&mut piece) {
            Ok(0) => None,
            Ok(_) => Some(Ok(piece.into())),
            Err(cause) => Some(Err(cause)),
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_stay_in_their_folder() {
        for name in ["brain.nii.gz", "ä b+c.npy", "a..b"] {
            assert_eq!(checked_name(name), Some(name));
        }
        let long = "a".repeat(201);
        for name in ["", ".", "..", "../x", "a/b", "a\\b", "c:x", "a\nb", ".hidden", &long] {
            assert_eq!(checked_name(name), None, "{name}");
        }
    }

    #[test]
    fn files_go_with_who_has_them() {
        let files = Files::new().unwrap();
        let count = || fs::read_dir(files.0.folder.path()).unwrap().count();
        let place = files.0.place().unwrap();
        let (_, mut coming) = Coming::new(&files, place, "x.npy").unwrap();
        coming.add(&Bytes::from_static(b"abc")).unwrap();
        assert_eq!((count(), files.0.lock().bytes), (1, 3));
        drop(coming);
        assert_eq!((count(), files.0.lock().bytes), (0, 0), "an upload that broke off");
        let write = |path: &FilePath| fs::write(path, "mesh").map_err(no_room);
        let id = files.offer("mesh.ply", write).unwrap();
        assert_eq!(count(), 1);
        files.forget(&id);
        assert_eq!(count(), 0);
        let folder = files.0.folder.path().to_owned();
        drop(files);
        assert!(!folder.exists());
    }
}
