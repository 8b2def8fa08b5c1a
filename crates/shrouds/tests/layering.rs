//! The arrows between the modules are those of the flow, and no others.
//!
//! Every path that begins at the crate root is held against the table below. Paths that reach the
//! root through `super` are refused: they would hide an arrow.

use std::fs;
use std::path::{Path, PathBuf};

/// Each module with what it may use. A path allows everything below it.
const ARROWS: &[(&str, &[&str])] = &[
    ("error", &[]),
    ("choice", &["error"]),
    ("gather", &[]),
    ("parallel", &[]),
    ("random", &[]),
    ("vector", &[]),
    ("tree", &["vector"]),
    ("grid", &["error", "vector"]),
    ("volume", &["grid", "choice", "error", "parallel", "random"]),
    ("surface", &["grid", "volume", "error", "parallel"]),
    ("network", &["surface", "volume", "error", "gather", "parallel"]),
    ("energy", &["error"]),
    (
        "optimize",
        &[
            "surface", "network", "energy", "volume", "grid", "choice", "error", "parallel",
            "vector", "random",
        ],
    ),
    ("mesh", &["grid", "surface", "network", "choice", "error", "parallel", "vector"]),
    (
        "measure",
        &[
            "grid",
            "volume::Border",
            "surface",
            "network",
            "mesh",
            "error",
            "parallel",
            "tree",
            "vector",
        ],
    ),
    (
        "polygon",
        &["grid", "volume", "surface", "network", "optimize", "settings", "error", "vector"],
    ),
    ("live", &["grid", "volume", "surface", "network", "optimize", "mesh", "settings", "error"]),
    ("containment", &["grid", "volume", "error", "parallel", "random", "vector"]),
    // The judge shares nothing with what it judges.
    ("check", &["grid", "volume", "mesh", "error", "parallel"]),
    // The back arrow; it asks the judge what a mesh is and where lines cross it.
    (
        "voxelize",
        &[
            "grid", "volume", "surface", "mesh", "check", "error", "parallel", "random", "tree",
            "vector",
        ],
    ),
    // The story once more, for volumes that no memory holds.
    ("chunks", &["grid", "volume", "surface", "optimize", "mesh", "error"]),
    ("settings", &["volume", "energy", "optimize", "mesh", "choice", "error"]),
    // The flow again, with labels in place of bits.
    (
        "materials",
        &[
            "grid", "volume", "surface", "network", "energy", "optimize", "mesh", "pipeline",
            "error", "parallel", "random", "vector", "settings",
        ],
    ),
    // Of two bodies that touch: shrouds of their own, measured.
    (
        "contact",
        &["grid", "volume", "optimize", "mesh", "measure", "pipeline", "settings", "error"],
    ),
];

/// The module that tells the whole story may use everything.
const STORY: &str = "pipeline";

#[test]
fn every_use_is_an_arrow_of_the_flow() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&source, &mut files);
    assert!(files.len() > ARROWS.len(), "{} files found in {source:?}", files.len());
    let mut wrong = Vec::new();
    for file in files {
        let path = file.strip_prefix(&source).unwrap();
        let text = fs::read_to_string(&file).unwrap();
        wrong.extend(violations(path, &text).iter().map(|w| format!("{}: {w}", path.display())));
    }
    assert!(wrong.is_empty(), "arrows that are not drawn:\n{}", wrong.join("\n"));
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable entry").path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// What the file at `path` (relative to the source folder) uses and must not.
fn violations(path: &Path, text: &str) -> Vec<String> {
    let parts: Vec<&str> = path.iter().map(|p| p.to_str().expect("a plain file name")).collect();
    let module = parts[0].trim_end_matches(".rs");
    if module == "lib" || module == STORY {
        return Vec::new();
    }
    let Some((_, allowed)) = ARROWS.iter().find(|(name, _)| *name == module) else {
        return vec![format!("the module {module} is not in the table of this test")];
    };
    let code = shipped_code(text);
    // `mod.rs` is the folder's own module; any other file lies one level below its folder.
    let depth = parts.len() - usize::from(parts.last() == Some(&"mod.rs"));
    let mut wrong = Vec::new();
    if code.contains(&"super::".repeat(depth)) || code.contains("{super::") {
        wrong.push("reaches the crate root through super: begin the path with crate".into());
    }
    for used in paths_from_root(&code) {
        let fits = |known: &str| used == known || used.starts_with(&format!("{known}::"));
        if !fits(module) && !allowed.iter().any(|known| fits(known)) {
            wrong.push(format!("{module} may not use crate::{used}"));
        }
    }
    wrong
}

/// The text without comments and spaces around `::` and braces, up to the first test module.
fn shipped_code(text: &str) -> String {
    let opens_module =
        |at: usize| text[at..].split(['{', ';']).next().is_some_and(|head| head.contains("mod "));
    let mut marks = text.match_indices("#[cfg(test)]").map(|(at, _)| at);
    let shipped = &text[..marks.find(|&at| opens_module(at)).unwrap_or(text.len())];
    let lines = shipped.lines().map(|line| line.split("//").next().unwrap_or_default());
    let mut code = lines.collect::<Vec<_>>().join(" ");
    for sign in ["::", "{", "}", ","] {
        let words: Vec<&str> = code.split(sign).map(str::trim).collect();
        code = words.join(sign);
    }
    code
}

/// All paths that begin with `crate::`, without it, brace groups opened.
fn paths_from_root(code: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (at, root) in code.match_indices("crate::") {
        let is_word = |c: char| c.is_alphanumeric() || c == '_';
        if !code[..at].ends_with(is_word) {
            read_path(&code[at + root.len()..], "", &mut found);
        }
    }
    // A whole crate under another name would hide every arrow.
    if code.contains("use crate as ") {
        found.push("(renamed)".into());
    }
    found
}

/// Reads one path at the start of `text`, adds its leaves to `found` and returns what follows.
fn read_path<'a>(text: &'a str, prefix: &str, found: &mut Vec<String>) -> &'a str {
    if let Some(mut rest) = text.strip_prefix('{') {
        while !rest.is_empty() && !rest.starts_with('}') {
            rest = read_path(rest, prefix, found);
            // An item may be followed by `as Name`.
            rest = rest.trim_start_matches(|c| c != ',' && c != '}');
            rest = rest.strip_prefix(',').unwrap_or(rest);
        }
        return rest.strip_prefix('}').unwrap_or(rest);
    }
    let end = text.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    let path = match (prefix, word) {
        ("", _) => word.to_owned(),
        (_, "self") => prefix.to_owned(),
        _ => format!("{prefix}::{word}"),
    };
    match rest.strip_prefix("::") {
        // Generic arguments and globs end a path.
        Some(after) if after.starts_with(|c: char| c == '{' || c == '_' || c.is_alphabetic()) => {
            read_path(after, &path, found)
        }
        _ => {
            found.push(path);
            rest
        }
    }
}

#[test]
fn paths_are_read_in_every_form() {
    let code = shipped_code(
        "use crate::grid::Grid; // crate::mesh\n\
         use crate :: {error::Error, volume::{self, Select as S}};\n\
         fn f() -> crate::surface::Surface { crate::network::trace::<u8>(&crate::energy::X) }\n\
         pub(crate) fn g() {} use crate::optimize::*; $crate::check; mycrate::other;\n\
         #[cfg(test)] mod tests { use crate::pipeline; }",
    );
    let expected = [
        "grid::Grid",
        "error::Error",
        "volume",
        "volume::Select",
        "surface::Surface",
        "network::trace",
        "energy::X",
        "optimize",
        "check",
    ];
    assert_eq!(paths_from_root(&code), expected);
}

#[test]
fn arrows_that_are_not_drawn_are_found() {
    let found = |path: &str, text: &str| violations(Path::new(path), text).len();
    assert_eq!(found("grid.rs", "use crate::error::Error;"), 0);
    assert_eq!(found("grid.rs", "use crate::volume::Occupancy;"), 1);
    assert_eq!(found("grid.rs", "use crate::Error;"), 1, "the module's own path, not the root's");
    assert_eq!(found("grid.rs", "use crate::{error::Error, mesh::TriMesh};"), 1);
    assert_eq!(found("grid.rs", "use crate::*;"), 1);
    assert_eq!(found("grid.rs", "use crate as root;"), 1);
    assert_eq!(found("check/sides.rs", "use crate::volume::{Border, FaceRule};"), 0);
    assert_eq!(found("check/sides.rs", "use crate::surface::Surface;"), 1);
    assert_eq!(found("check/sides.rs", "use crate::surface;"), 1);
    assert_eq!(found("mesh/place.rs", "use super::normals::x; use crate::mesh::y;"), 0);
    assert_eq!(found("mesh/place.rs", "use super::super::grid::Grid;"), 1);
    assert_eq!(found("mesh/mod.rs", "use super::grid::Grid;"), 1);
    assert_eq!(found("mesh/a/mod.rs", "use super::place;"), 0);
    assert_eq!(found("mesh/a/mod.rs", "use super::super::grid;"), 1);
    assert_eq!(found("mesh/a/b.rs", "use super :: super::place;"), 0);
    assert_eq!(found("mesh/a/b.rs", "use super::{super::super::grid};"), 1);
    let test_only =
        "#[cfg(test)] use crate::mesh::A; use crate::mesh::B; #[cfg(test)] mod tests {}";
    assert_eq!(found("grid.rs", test_only), 2, "only a test module ends what is read");
    assert_eq!(found("grid.rs", "use crate::{self as root};"), 1);
    assert_eq!(found("extra/mod.rs", ""), 1, "a new module must be drawn first");
    assert_eq!(found("pipeline.rs", "use crate::mesh::TriMesh;"), 0);
}
