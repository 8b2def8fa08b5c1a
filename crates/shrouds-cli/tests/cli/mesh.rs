//! `shrouds mesh`: the files it writes and what they say.

use serde_json::Value;
use shrouds::volume::phantom::named;
use shrouds::{Grid, Occupancy};

use crate::common::{Folder, nifti, npy, volume};

const OBJECTS: [&str; 9] =
    ["input", "settings", "topology", "solver", "geometry", "checks", "times", "memory", "version"];

#[test]
fn mesh_picture_and_report() {
    let folder = Folder::with_tori();
    let done = folder.run("mesh volume.npy -o out.ply --picture out.png --report out.json");
    assert_eq!((done.code, done.out.as_str()), (0, ""), "{}", done.err);
    assert!(done.err.starts_with("out.ply: ") && done.err.lines().count() == 1, "{}", done.err);
    assert_eq!(folder.names(), ["out.json", "out.ply", "out.png", "volume.npy"]);
    assert_eq!(&folder.bytes("out.png")[..8], b"\x89PNG\r\n\x1a\n");

    let (mesh, report) = (folder.mesh("out.ply"), folder.json("out.json"));
    let keys: Vec<&String> = report.as_object().unwrap().keys().collect();
    let mut wanted = OBJECTS;
    wanted.sort_unstable();
    assert_eq!(keys, wanted);
    assert_eq!(report["input"]["dims"], serde_json::json!([24, 24, 24]));
    assert_eq!(report["input"]["inside"], 799);
    assert_eq!(report["topology"]["vertices"], mesh.vertices.len());
    assert_eq!(report["topology"]["triangles"], mesh.triangles.len());
    assert_eq!(report["topology"]["euler"], serde_json::json!([0, 0]));
    assert_eq!(report["solver"]["status"], "preset done");
    let energy = |end: &str| report["solver"]["energy"][end].as_f64().unwrap();
    assert!(energy("last") < energy("first"));
    let close = |key: &str, value: f64| {
        let told = report["geometry"][key].as_f64().unwrap();
        assert!((told / value - 1.0).abs() < 1e-5, "{key}: {told}, {value}");
    };
    close("volume", mesh.volume());
    close("area", mesh.area());
    close("voxel_volume", 799.0);
    clean(&report["checks"]);
    let stages = ["read", "surface", "optimize", "mesh", "check", "write", "total"];
    assert!(stages.iter().all(|stage| report["times"][stage].as_f64().unwrap() >= 0.0));
    let memory = &report["memory"];
    assert!(memory.as_u64().is_some_and(|bytes| bytes > 1 << 20) || !cfg!(target_os = "linux"));
}

fn clean(checks: &Value) {
    assert_eq!(checks["ok"], true, "{checks}");
    for key in [
        "wrong_side",
        "odd_winding",
        "touching",
        "non_manifold_edges",
        "non_manifold_vertices",
        "boundary_edges",
        "degenerate_triangles",
    ] {
        assert_eq!(checks[key], 0, "{key}");
    }
    for key in ["components", "euler"] {
        assert_eq!(checks[key]["found"], checks[key]["expected"], "{key}");
    }
}

#[test]
fn json_is_all_there_is_on_standard_output() {
    let folder = Folder::with_tori();
    let report: Value =
        serde_json::from_str(&folder.succeed("mesh volume.npy -o out.ply --json")).unwrap();
    assert!(OBJECTS.iter().all(|key| report.get(key).is_some()));
    let done = folder.run("mesh volume.npy -o out.ply --quiet");
    assert_eq!((done.code, done.out.as_str(), done.err.as_str()), (0, "", ""));
}

#[test]
fn settings_reach_the_library() {
    let folder = Folder::with_tori();
    let mut seen = Vec::new();
    for options in [
        "",
        "--energy curvature(chord)",
        "--energy curvature(centripetal)",
        "--energy linear(uniform)",
        "--energy linear(uniform) --solver sweeps --tolerance 1e-3",
        "--energy bending+0.3*variation",
        "--preset fast",
        "--preset exact",
        "--volume keep",
        "--start random:5 --max-iterations 0",
        "--start midpoint --max-iterations 0",
        "--faces join",
        "--surface dual",
        "--triangles fixed",
        "--frame index --spacing 1,1,2",
    ] {
        let text = folder.succeed(&format!("mesh volume.npy -o out.ply --json --quiet {options}"));
        let report: Value = serde_json::from_str(&text).unwrap();
        clean(&report["checks"]);
        let words: Vec<&str> = options.split_whitespace().collect();
        for pair in words.chunks(2).filter(|pair| pair[0] != "--spacing") {
            let told = &report["settings"][pair[0].trim_start_matches("--").replace('-', "_")];
            let number = pair[1].parse::<f64>();
            let same = number.map_or_else(|_| told == pair[1], |x| told.as_f64() == Some(x));
            assert!(same, "{pair:?}: {told}");
        }
        // The tori have no ambiguous face, so that `join` changes nothing.
        if options != "--faces join" {
            seen.push(folder.bytes("out.ply"));
        }
    }
    let different = seen.len();
    seen.sort();
    seen.dedup();
    assert_eq!(seen.len(), different);
}

#[test]
fn any_number_of_threads_gives_the_same_bytes() {
    let folder = Folder::new();
    folder.volume("volume.npy", &named("gyroid", 20).unwrap().volume);
    for options in ["", "--preset exact", "--surface dual --start random:3"] {
        let bytes = [1, 2, 5].map(|threads| {
            let call = format!("mesh volume.npy -o out.ply --quiet --threads {threads} {options}");
            folder.succeed(&call);
            folder.bytes("out.ply")
        });
        assert!(bytes[0] == bytes[1] && bytes[0] == bytes[2], "{options}");
    }
}

#[test]
fn formats_agree() {
    let folder = Folder::with_tori();
    for name in ["a.ply", "a.stl", "a.OBJ"] {
        folder.succeed(&format!("mesh volume.npy -o {name} --quiet"));
    }
    let [ply, stl, obj] = ["a.ply", "a.stl", "a.OBJ"].map(|name| folder.mesh(name));
    assert_eq!((&ply.triangles, ply.vertices.len()), (&obj.triangles, obj.vertices.len()));
    assert_eq!(
        (ply.triangles.len(), ply.vertices.len()),
        (stl.triangles.len(), stl.vertices.len())
    );
    for (n, &triangle) in ply.triangles.iter().enumerate() {
        let expected = ply.corners(triangle);
        for other in [stl.corners(stl.triangles[n]), obj.corners(obj.triangles[n])] {
            let pairs = expected.as_flattened().iter().zip(other.as_flattened());
            assert!(pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-5));
        }
    }
}

#[test]
fn not_to_converge_is_a_failure_only_under_strict() {
    let folder = Folder::with_tori();
    let done = folder.run("mesh volume.npy -o a.ply --preset exact --max-iterations 1");
    assert_eq!(done.code, 0);
    assert!(done.err.contains("warning: the optimisation did not converge"), "{}", done.err);
    let done = folder.run("mesh volume.npy -o b.ply --report b.json --max-iterations 1 --strict");
    assert_eq!(done.code, 3);
    assert!(done.err.contains("error: the optimisation did not converge"), "{}", done.err);
    assert!(done.err.contains("iteration limit after 1 iteration,"), "{}", done.err);
    assert_eq!(folder.bytes("a.ply"), folder.bytes("b.ply"));
    assert_eq!(folder.json("b.json")["solver"]["status"], "iteration limit");
    folder.succeed("mesh volume.npy -o a.ply --report a.json --strict");
    let report = folder.json("a.json");
    assert_eq!(report["solver"]["status"], "converged");
    assert_eq!(report["settings"]["preset"], "exact");
}

#[test]
fn volumes_are_kept_and_told() {
    let folder = Folder::with_tori();
    let done = folder.run("mesh volume.npy -o a.ply --report a.json --volume keep");
    assert_eq!(done.code, 0, "{}", done.err);
    assert!(done.err.contains("; volume of 2 components kept to "), "{}", done.err);
    let report = folder.json("a.json");
    clean(&report["checks"]);
    let volumes = report["solver"]["volumes"].as_array().unwrap();
    assert_eq!(volumes.len(), 2);
    for volume in volumes {
        assert!(volume["relative_error"].as_f64().unwrap() <= 1e-9, "{volume}");
        assert_eq!(volume["held"], false);
    }
    let [found, counted] = ["volume", "voxel_volume"].map(|key| report["geometry"][key].as_f64());
    assert!((found.unwrap() / counted.unwrap() - 1.0).abs() < 1e-9, "{report}");
    folder.succeed("mesh volume.npy -o a.ply --report a.json --quiet");
    assert!(folder.json("a.json")["solver"].get("volumes").is_none());
    for option in ["--solver sweeps", "--border open", "--surface dual"] {
        let call = format!("mesh volume.npy -o b.ply --volume keep {option}");
        folder.refuse(&call, 2, &["--volume keep needs"]);
    }
}

#[test]
fn presets_tell_how_far_they_went() {
    let folder = Folder::with_tori();
    let remaining = [("fast", 1), ("default", 3)].map(|(preset, steps)| {
        let call = format!("mesh volume.npy -o a.ply --report a.json --preset {preset}");
        let done = folder.run(&call);
        let report = folder.json("a.json");
        assert_eq!(report["settings"]["preset"], preset);
        assert!(report["settings"]["tolerance"].is_null(), "{report}");
        assert_eq!(report["solver"]["status"], "preset done");
        assert_eq!(report["solver"]["iterations"], steps);
        let rms = report["solver"]["projected_step"]["rms"].as_f64().unwrap();
        let told =
            format!("before convergence: each vertex alone would still move {rms:.1e} voxels");
        assert_eq!((done.code, done.err.lines().count()), (0, 1), "{}", done.err);
        assert!(done.err.contains(&told), "no '{told}' in {}", done.err);
        assert!(done.err.contains(&format!("--preset {preset} stopped after {steps} ")));
        rms
    });
    let done = folder.run("mesh volume.npy -o a.ply --report a.json --preset exact");
    assert!(!done.err.contains("convergence") && !done.err.contains("warning"), "{}", done.err);
    let report = folder.json("a.json");
    assert_eq!(report["solver"]["status"], "converged");
    assert_eq!(report["settings"]["tolerance"], 5e-4);
    let rms = report["solver"]["projected_step"]["rms"].as_f64().unwrap();
    assert!(
        rms <= 5e-4 && rms < remaining[1] && remaining[1] < remaining[0],
        "{remaining:?}, {rms}"
    );
    // A stop rule asks for the preset that has one, sweeps have no preset.
    let told = |options: &str| {
        folder.succeed(&format!("mesh volume.npy -o a.ply --report a.json --quiet {options}"));
        let report = folder.json("a.json");
        (report["settings"]["preset"].clone(), report["solver"]["status"].clone())
    };
    assert_eq!(told(""), ("default".into(), "preset done".into()));
    assert_eq!(told("--tolerance 1e-2"), ("exact".into(), "converged".into()));
    assert_eq!(told("--solver sweeps --tolerance 1e-3"), (Value::Null, "converged".into()));
}

#[test]
fn labels_and_thresholds_select() {
    let folder = Folder::new();
    let mut values = [0u8; 125];
    values[62..64].copy_from_slice(&[3, 7]);
    folder.file("labels.npy", &npy("|u1", "(5, 5, 5)", &values));
    let triangles = |options: &str| {
        folder.succeed(&format!("mesh labels.npy -o out.ply --quiet {options}"));
        folder.mesh("out.ply").triangles.len()
    };
    let (one, two) = (8, 16);
    assert_eq!(triangles(""), two);
    assert_eq!(triangles("--label 3"), one);
    assert_eq!(triangles("--label 3 --label 7"), two);
    assert_eq!(triangles("--threshold 3"), one);
    // All 125: 150 vertices on a sphere, so twice 148 triangles.
    assert_eq!(triangles("--threshold -0.5"), 296);
}

#[test]
fn the_frame_of_the_file_or_the_index() {
    let folder = Folder::new();
    // One voxel at (1, 2, 1) in a mirrored, turned and shifted frame.
    let affine = [[0.0, -2.0, 0.0, 10.0], [-0.5, 0.0, 0.0, 20.0], [0.0, 0.0, -3.0, 30.0]];
    let mut data = [0; 60];
    data[(4 + 2) * 3 + 1] = 1;
    folder.file("voxel.nii", &nifti(&[3, 4, 5], affine, &data));
    let middle = |options: &str| {
        folder.succeed(&format!("mesh voxel.nii -o out.ply --preset exact --quiet {options}"));
        let mesh = folder.mesh("out.ply");
        assert!(mesh.volume() > 0.0, "{options}");
        let mean: [f64; 3] =
            std::array::from_fn(|k| mesh.vertices.iter().map(|v| v[k]).sum::<f64>() / 6.0);
        for (vertex, normal) in mesh.vertices.iter().zip(&mesh.normals) {
            let out: f64 = (0..3).map(|k| f64::from(normal[k]) * (vertex[k] - mean[k])).sum();
            assert!(out > 0.0, "{options}");
        }
        mean.map(|x| (x * 1e3).round() / 1e3)
    };
    assert_eq!(middle(""), [6.0, 19.5, 27.0]);
    assert_eq!(middle("--frame index"), [1.0, 2.0, 1.0]);
    assert_eq!(middle("--spacing 1,10,100"), [1.0, 20.0, 100.0]);
    let header = |name: &str| String::from_utf8_lossy(&folder.bytes(name)[..120]).into_owned();
    folder.succeed("mesh voxel.nii -o out.ply --quiet");
    assert!(header("out.ply").contains("SPACE=RAS UNIT=mm"), "{}", header("out.ply"));
    folder.succeed("mesh voxel.nii -o out.ply --quiet --frame index");
    assert!(header("out.ply").contains("SPACE=index"), "{}", header("out.ply"));
}

#[test]
fn far_from_the_origin_digits_are_kept() {
    let folder = Folder::new();
    let affine = [[0.25, 0.0, 0.0, 5e6], [0.0, 0.25, 0.0, -5e6], [0.0, 0.0, 0.25, 0.0]];
    let data: Vec<u8> = (0..512).map(|n| u8::from((9 * n + n / 8) % 5 < 2)).collect();
    folder.file("far.nii", &nifti(&[8, 8, 8], affine, &data));
    let done = folder.run("mesh far.nii -o far.ply");
    assert!(!done.err.contains("32 bits"), "{}", done.err);
    assert_eq!(folder.run("check far.ply --volume far.nii").code, 0);
    let done = folder.run("mesh far.nii -o far.stl");
    assert!(
        done.code == 0 && done.err.contains("warning: far.stl: STL has 32 bits"),
        "{}",
        done.err
    );
    folder.succeed("mesh far.nii -o near.stl --frame index --quiet");
    assert_eq!(folder.run("check near.stl --volume far.nii --frame index").code, 0);
}

#[test]
fn axes_of_an_array() {
    let folder = Folder::new();
    folder.volume("bar.npy", &volume([9, 3, 3], |[_, j, k]| (j, k) == (1, 1)));
    let longest = |options: &str| {
        folder.succeed(&format!("mesh bar.npy -o out.ply --quiet {options}"));
        let mesh = folder.mesh("out.ply");
        let reach = |k: usize| mesh.vertices.iter().map(|v| v[k]).fold(0.0, f64::max);
        (0..3).max_by(|&a, &b| reach(a).total_cmp(&reach(b))).unwrap()
    };
    assert_eq!((longest(""), longest("--axes zyx"), longest("--axes xyz")), (0, 0, 2));
}

#[test]
fn the_energy_in_force_is_told() {
    let folder = Folder::with_tori();
    let told = |options: &str| {
        let text = folder.succeed(&format!("mesh volume.npy -o out.ply --json --quiet {options}"));
        let report: Value = serde_json::from_str(&text).unwrap();
        report["settings"]["energy"].as_str().unwrap().to_owned()
    };
    for (options, energy) in [
        ("", "bending"),
        ("--energy curvature", "curvature(chord)"),
        ("--energy linear --parameter centripetal", "linear(centripetal)"),
        (
            "--energy bending+2*curvature+linear(chord) --parameter uniform",
            "bending+2*curvature(uniform)+linear(chord)",
        ),
    ] {
        assert_eq!(told(options), energy);
    }
}

#[test]
fn an_energy_that_may_destroy_is_warned_of() {
    let folder = Folder::with_tori();
    let warning = "warning: linear may destroy parts one voxel thin";
    for call in [
        "mesh volume.npy -o out.ply",
        "render volume.npy -o out.png",
        "demo point --size 8 --output demo",
    ] {
        let done = folder.run(&format!("{call} --energy bending+linear"));
        assert!(done.code == 0 && done.err.contains(warning), "{call}: {}", done.err);
        let done = folder.run(&format!("{call} --energy 2*bending"));
        assert!(done.code == 0 && !done.err.contains("warning"), "{call}: {}", done.err);
    }
}

#[test]
fn creases_on_request() {
    let folder = Folder::with_tori();
    let told = |options: &str| {
        let done = folder.run(&format!("mesh volume.npy -o out.ply --json {options}"));
        assert_eq!(done.code, 0, "{}", done.err);
        serde_json::from_str::<Value>(&done.out).unwrap()
    };
    let (plain, creased, wider) = (told(""), told("--crease"), told("--crease=12"));
    let angles = [&plain, &creased, &wider].map(|report| report["settings"]["crease"].clone());
    assert_eq!(angles, [Value::Null, 5.7.into(), 12.0.into()]);
    let volumes = [&plain, &creased, &wider].map(|report| report["geometry"]["volume"].clone());
    assert!(volumes[0] != volumes[1] && volumes[1] != volumes[2], "{volumes:?}");
    assert_eq!(creased["solver"]["status"], "preset done");
    clean(&creased["checks"]);

    for options in ["--crease=0", "--crease=90", "--crease=x", "--crease --preset exact"] {
        let done = folder.run(&format!("mesh volume.npy -o out.ply {options}"));
        assert_eq!(done.code, 2, "{options}: {}", done.err);
    }
    let done = folder.run("mesh volume.npy -o out.ply --crease --strict");
    assert!(done.code == 2 && done.err.contains("--crease"), "{}", done.err);
}

#[test]
fn where_a_mask_is_set_the_surface_need_not_be_smooth() {
    let folder = Folder::new();
    let grid = Grid::new([24, 20, 20], [1.0; 3]).unwrap();
    let cube = |index: [usize; 3]| index.iter().all(|i| (5..15).contains(i));
    folder.volume("cube.npy", &Occupancy::from_fn(grid.clone(), cube));
    folder.volume("mask.npy", &Occupancy::from_fn(grid, |[i, ..]| i < 10));
    folder.succeed("mesh cube.npy -o smooth.ply --quiet");
    let call = "mesh cube.npy -o rough.ply --rough mask.npy --json";
    let report: Value = serde_json::from_str(&folder.succeed(call)).unwrap();
    assert_eq!(report["settings"]["rough"], "mask.npy");
    let [smooth, rough] = ["smooth.ply", "rough.ply"].map(|name| folder.mesh(name));
    // Moved by the energy where it counts, and left where they were where it does not.
    let moved = |low: f64, high: f64| -> f64 {
        let pairs = smooth.vertices.iter().zip(&rough.vertices);
        pairs
            .filter(|(a, _)| (low..high).contains(&a[0]))
            .map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f64::max))
            .fold(0.0, f64::max)
    };
    assert!(
        moved(0.0, 9.0) > 0.05 && moved(12.0, 20.0) < 0.02,
        "{} {}",
        moved(0.0, 9.0),
        moved(12.0, 20.0)
    );
    folder.volume("small.npy", &Occupancy::empty(Grid::new([24, 20, 19], [1.0; 3]).unwrap()));
    let done = folder.run("mesh cube.npy -o rough.ply --rough small.npy");
    assert_eq!(done.code, 1);
    assert!(done.err.contains("small.npy") && done.err.contains("--rough"), "{}", done.err);
}
