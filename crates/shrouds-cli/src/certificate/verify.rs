//! A certificate against its files: all is found out again and compared, field by field.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::digest::Digest;
use super::place::folder_of;
use super::{Certificate, FORMAT, SCHEMA, SettingsPart, Subject, digests};
use crate::args::Reading;
use crate::console::Console;
use crate::failure::Failure;
use crate::progress::Progress;

/// Which program wrote a certificate is not part of what is certified.
const VERSION: &str = "version";

/// What the files say of a certificate.
#[derive(Debug, Serialize)]
pub(crate) struct Verdict {
    /// Whether the files say the same, field by field.
    pub(crate) agrees: bool,
    /// Whether by the files the mesh is as it should be.
    pub(crate) holds: bool,
    pub(crate) fields: Vec<Field>,
}

/// A field of the certificate that is no object.
#[derive(Debug, PartialEq, Serialize)]
pub(crate) struct Field {
    /// With the names of the objects it is in, and points between them.
    pub(crate) name: String,
    pub(crate) agrees: bool,
    /// What the certificate says; null also where it says nothing.
    pub(crate) certificate: Value,
    /// What the files say; null also where they say nothing.
    pub(crate) files: Value,
}

/// What is taken from a certificate: where to look, and what to expect.
#[derive(Deserialize)]
struct Claim {
    mesh: ClaimedFile,
    volume: ClaimedVolume,
    settings: SettingsPart,
}

#[derive(Deserialize)]
struct ClaimedFile {
    file: String,
    sha256: String,
}

#[derive(Deserialize)]
struct ClaimedVolume {
    #[serde(flatten)]
    file: ClaimedFile,
    reading: Reading,
}

/// Holds a certificate against the files that it names.
pub(crate) fn verify(
    path: &Path,
    console: Console,
    progress: &Progress,
) -> Result<Verdict, Failure> {
    let (certificate, claim) = read(path)?;
    let [mesh, volume] = [&claim.mesh, &claim.volume.file].map(|claimed| claimed.path(path));
    let (mesh, volume) = (mesh?, volume?);
    let SettingsPart { border, faces, frame, all_axes, .. } = claim.settings;
    let selection = claim.volume.reading.arguments(frame).map_err(|problem| {
        not_a_certificate(path, &format!("it reads the volume as no call can: {problem}"))
    })?;
    let subject =
        Subject { mesh: &mesh, volume: &volume, selection: &selection, border, faces, all_axes };
    progress.stage("hashing");
    let digests = digests(&subject, folder_of(path))?;
    let examined =
        subject.examine(console, progress).map_err(|failure| claim.blame(&digests, failure))?;
    let found = Certificate::new(&subject, &examined, digests, progress)?;
    let holds = found.holds;
    let found = serde_json::to_value(found)
        .map_err(|cause| Failure::Undone(format!("the certificate cannot be made: {cause}")))?;
    let mut fields = Vec::new();
    compare("", Some(&certificate), Some(&found), &mut fields);
    let agrees = fields.iter().all(|field| field.agrees);
    Ok(Verdict { agrees, holds, fields })
}

fn read(path: &Path) -> Result<(Value, Claim), Failure> {
    let text = fs::read_to_string(path).map_err(|cause| {
        Failure::Undone(format!("{}: cannot read it ({cause}); check the path", path.display()))
    })?;
    let value: Value = serde_json::from_str(&text)
        .map_err(|cause| not_a_certificate(path, &format!("it is not JSON ({cause})")))?;
    if value["format"] != FORMAT {
        return Err(not_a_certificate(path, "another kind of JSON"));
    }
    if value["schema"] != SCHEMA {
        let problem = format!("schema {}, but this program knows {SCHEMA} only", value["schema"]);
        return Err(not_a_certificate(path, &problem));
    }
    let claim = Claim::deserialize(&value)
        .map_err(|cause| not_a_certificate(path, &format!("a field is damaged ({cause})")))?;
    Ok((value, claim))
}

fn not_a_certificate(path: &Path, problem: &str) -> Failure {
    let advice = "give a file that `shrouds check … --certificate` wrote";
    Failure::Undone(format!(
        "{}: no certificate that can be verified: {problem}; {advice}",
        path.display()
    ))
}

impl ClaimedFile {
    /// Where the file is, seen from here.
    fn path(&self, certificate: &Path) -> Result<PathBuf, Failure> {
        if Path::new(&self.file).has_root() {
            let problem = format!("the file {} is not named relative to it", self.file);
            return Err(not_a_certificate(certificate, &problem));
        }
        let folder = certificate.parent().unwrap_or(Path::new(""));
        Ok(if self.file == "." { folder_of(certificate).into() } else { folder.join(&self.file) })
    }
}

impl Claim {
    /// A failure to read the files, which is no wonder if they are not those that were certified.
    fn blame(&self, [mesh, volume]: &[Digest; 2], failure: Failure) -> Failure {
        let claimed = [(&self.mesh, mesh), (&self.volume.file, volume)];
        match claimed.into_iter().find(|(claimed, found)| claimed.sha256 != found.sha256) {
            Some((claimed, _)) => Failure::Undone(format!(
                "{} is not the file that was certified, its SHA-256 is another; and {}",
                claimed.file,
                failure.message()
            )),
            None => failure,
        }
    }
}

/// Compares what the certificate says under a name with what the files say.
fn compare(name: &str, certificate: Option<&Value>, files: Option<&Value>, found: &mut Vec<Field>) {
    if let (Some(Value::Object(a)), Some(Value::Object(b))) = (certificate, files) {
        let mut seen = BTreeSet::new();
        for key in b.keys().chain(a.keys()).filter(|key| *key != VERSION || !name.is_empty()) {
            if seen.insert(key) {
                let inner = if name.is_empty() { key.clone() } else { format!("{name}.{key}") };
                compare(&inner, a.get(key), b.get(key), found);
            }
        }
        return;
    }
    found.push(Field {
        name: name.into(),
        agrees: certificate == files,
        certificate: certificate.cloned().unwrap_or_default(),
        files: files.cloned().unwrap_or_default(),
    });
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn every_difference_is_a_field() {
        let certificate = json!({"version": "0", "a": {"b": 1.0, "c": [1, 2], "d": null}, "e": 3});
        let mut found = Vec::new();
        compare("", Some(&certificate), Some(&certificate), &mut found);
        assert!(found.iter().all(|field| field.agrees) && found.len() == 4, "{found:?}");
        let files = json!({"version": "1", "a": {"b": 1.5, "c": [1, 2], "f": 0}, "e": {"g": 3}});
        found.clear();
        compare("", Some(&certificate), Some(&files), &mut found);
        let differing: Vec<&str> =
            found.iter().filter(|field| !field.agrees).map(|field| &field.name[..]).collect();
        // A field that says null is not one that is missing.
        assert_eq!(differing, ["a.b", "a.f", "a.d", "e"]);
    }
}
