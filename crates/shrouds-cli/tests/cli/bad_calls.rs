//! Calls that cannot be meant: found out before any work, exit code 2 (1 where a file is in the way).

use crate::common::Folder;

#[test]
fn extensions_nobody_knows() {
    let folder = Folder::with_tori();
    folder.refuse("mesh volume.npy -o out.xyz", 2, &["out.xyz", ".ply, .stl and .obj"]);
    folder.refuse("mesh volume.npy -o out", 2, &["out", ".ply, .stl and .obj"]);
    folder.refuse("mesh volume.jpg -o out.ply", 2, &["volume.jpg", ".npy, .npz"]);
    folder.refuse("info volume.jpg", 2, &["volume.jpg", ".nrrd", ".obj"]);
    folder.refuse("mesh volume.npy -o out.ply --picture p.jpg", 2, &["p.jpg", ".png"]);
    folder.refuse("render volume.npy -o out.jpg", 2, &["out.jpg", ".png"]);
    folder.refuse("check volume.npy --volume volume.npy", 2, &["volume.npy", ".ply"]);
    folder.refuse("check out.ply --volume volume.jpg", 2, &["volume.jpg", ".npy"]);
}

#[test]
fn outputs_that_cannot_be_written_are_found_before_the_input_is_read() {
    let folder = Folder::new();
    folder.file("wall", b"");
    let parts = ["no/out.ply", "folder does not exist", "create the folder"];
    folder.refuse("mesh missing.npy -o no/out.ply", 1, &parts);
    for option in ["--picture no/p.png", "--report no/r.json"] {
        folder.refuse(&format!("mesh missing.npy -o out.ply {option}"), 1, &["no/"]);
    }
    folder.refuse("render missing.npy -o wall/out.png", 1, &["wall/out.png"]);
    folder.refuse("demo --output wall", 1, &["wall", "--output"]);
    std::fs::create_dir(folder.path("folder.ply")).unwrap();
    folder.refuse("mesh missing.npy -o folder.ply", 1, &["folder.ply", "it is a folder"]);
}

#[cfg(target_os = "linux")]
#[test]
fn folders_that_take_no_files() {
    // Even the superuser cannot make a file here.
    let folder = Folder::with_tori();
    folder.refuse("mesh volume.npy -o /proc/out.ply", 1, &["/proc/out.ply", "cannot write it"]);
    folder.refuse("mesh volume.npy -o /dev/null", 2, &["/dev/null"]);
}

#[test]
fn two_files_of_one_name() {
    let folder = Folder::with_tori();
    let parts = ["another file of this call"];
    folder.refuse("mesh volume.npy -o a.ply --report ./a.ply", 2, &parts);
    folder.refuse("mesh volume.npy -o a.ply --report volume.npy", 2, &parts);
    assert_eq!(folder.names(), ["volume.npy"]);
}

#[test]
fn settings_that_do_not_go_together() {
    let folder = Folder::with_tori();
    for name in ["uniform", "chord", "centripetal"] {
        let parts = ["--parameter", "--energy bending", "curvature or linear"];
        folder.refuse(&format!("mesh volume.npy -o a.ply --parameter {name}"), 2, &parts);
        let call = format!("render volume.npy -o a.png --energy bending --parameter {name}");
        folder.refuse(&call, 2, &parts);
    }
    for preset in ["fast", "default"] {
        for option in ["--strict", "--tolerance 1e-3"] {
            let call = format!("mesh volume.npy -o a.ply {option} --preset {preset}");
            folder.refuse(&call, 2, &[option.split(' ').next().unwrap(), "use --preset exact"]);
        }
    }
    let parts = ["--preset", "--solver sweeps", "leave it out"];
    folder.refuse("mesh volume.npy -o a.ply --solver sweeps --preset exact", 2, &parts);
    let parts = ["--surface dual", "--border closed"];
    folder.refuse("mesh volume.npy -o a.ply --surface dual --border open", 2, &parts);
    folder.refuse("render volume.npy -o a.png --network --surface dual", 2, &["--network"]);
    folder.refuse("demo --network --surface dual", 2, &["--network"]);
    folder.refuse("demo nothing", 2, &["\"nothing\"", "tori", "gyroid"]);
    folder.succeed("mesh volume.npy -o a.ply --quiet");
    folder.refuse("render a.ply -o a.png --network", 2, &["--network needs a volume"]);
}

#[test]
fn values_out_of_range() {
    let folder = Folder::with_tori();
    for option in [
        "--tolerance 0",
        "--tolerance nan",
        "--max-iterations -1",
        "--start random",
        "--spacing 1,2",
        "--spacing 1,0,1",
        "--threads 0",
        "--energy warp",
        "--energy 0.3bending",
        "--energy bending+",
        "--energy linear(warp)",
        "--parameter warp",
        "--preset best",
        "--label x",
        "--label 1 --threshold 0.5",
        "--threshold nan",
        "--frobnicate",
    ] {
        let done = folder.run(&format!("mesh volume.npy -o a.ply {option}"));
        let named = option.split(' ').next().unwrap();
        assert!(done.code == 2 && done.err.contains(named), "{option}: {}", done.err);
    }
    for option in ["--width 0", "--elevation 91", "--zoom 0", "--colour red", "--perspective=0"] {
        let done = folder.run(&format!("render volume.npy -o a.png {option}"));
        let named = option.split([' ', '=']).next().unwrap();
        assert!(done.code == 2 && done.err.contains(named), "{option}: {}", done.err);
    }
    assert_eq!(folder.run("").code, 2);
    assert_eq!(folder.run("paint").code, 2);
    assert_eq!(folder.names(), ["volume.npy"]);
}

#[test]
fn comparisons_that_cannot_be_meant() {
    let folder = Folder::with_tori();
    let all: Vec<&str> = shrouds::energy::catalogue().iter().map(|entry| entry.name).collect();
    let done = folder.run("mesh volume.npy -o a.ply --energy warp");
    assert!(done.code == 2 && all.iter().all(|name| done.err.contains(name)), "{}", done.err);
    let parts = [&["--energies", "warp"], &all[..]].concat();
    folder.refuse("compare volume.npy --energies bending;warp", 2, &parts);
    for list in [";", ";;"] {
        folder.refuse(
            &format!("compare volume.npy --energies {list}"),
            2,
            &["--energies", "leave it out"],
        );
    }
    let parts = ["no/sheet.png", "folder does not exist"];
    folder.refuse("compare missing.npy --picture no/sheet.png", 1, &parts);
    folder.refuse("compare volume.npy --picture sheet.jpg", 2, &["sheet.jpg", ".png"]);
    folder.refuse("compare volume.jpg", 2, &["volume.jpg", ".npy"]);
    folder.refuse("compare volume.ply", 2, &["volume.ply", ".npy"]);
    folder.refuse("compare demo:nothing", 2, &["nothing", "tori"]);
    folder.refuse("compare volume.npy --size 8", 2, &["--size"]);
    for option in ["--label 1", "--threshold 0", "--spacing 1,1,2"] {
        folder.refuse(&format!("compare demo:tori {option}"), 2, &["--label, --threshold"]);
    }
    folder.refuse("compare volume.npy --preset fast --tolerance 1e-3", 2, &["use --preset exact"]);
    for option in ["--multistart -1", "--multistart 1001", "--energies"] {
        let done = folder.run(&format!("compare volume.npy {option}"));
        assert!(done.code == 2 && done.err.contains("--"), "{option}: {}", done.err);
    }
    assert_eq!(folder.names(), ["volume.npy"]);
}
