//! The names of spaces in NRRD files.

/// Spaces of three dimensions: in full, in short, and as their frame is called here.
const SPACES: [(&str, &str, &str); 6] = [
    ("left-posterior-superior", "lps", "LPS"),
    ("right-anterior-superior", "ras", "RAS"),
    ("left-anterior-superior", "las", "LAS"),
    ("scanner-xyz", "scanner-xyz", "scanner-xyz"),
    ("3D-right-handed", "3d-right-handed", "3D-right-handed"),
    ("3D-left-handed", "3d-left-handed", "3D-left-handed"),
];

/// The name in full of the space that a frame of this name lies in, if NRRD knows it.
pub(super) fn full_name(frame: &str) -> Option<&'static str> {
    SPACES.iter().find(|(_, _, name)| *name == frame).map(|(full, ..)| *full)
}

/// What the frame is called that lies in a space of this name; time is left out.
pub(super) fn frame_name(space: &str) -> String {
    let lower = space.to_lowercase();
    let name = lower.strip_suffix("-time").unwrap_or(match lower.as_str() {
        "last" | "rast" | "lpst" => &lower[..3],
        other => other,
    });
    let known =
        SPACES.iter().find(|(full, short, _)| full.to_lowercase() == name || *short == name);
    known.map_or(name, |(.., name)| name).to_string()
}
