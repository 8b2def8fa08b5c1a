//! `shrouds contain`: scenes in, regions out; what is wrong with a scene is told with its line.

use shrouds::volume::Operation;
use shrouds::{Occupancy, Select};
use shrouds_io::{VolumeOptions, read_occupancy};

use crate::common::Folder;

const SCENE: &str = r#"[sea]
from = [-1000, -900]
to = [1000, 900]
depth = 1210
spacing = [100, 90, 110]

[floor.flat]
depth = 1150

[target]
speed = 3

[[platform]]
time = 0
position = [-700, 35]
depth = 105

[[platform]]
time = 600
position = [700, 100]
depth = 105

[[contact]]
time = 0
bearing = 62
half_width = 9

[[contact]]
time = 60
bearing = 70
half_width = 12
path = "bounce"
range = [0, 1500]

[[contact]]
time = 90
bearing = 71
half_width = 9
path = "either"

[[truth]]
time = 0
position = [0, 800]
depth = 700
"#;

fn read(folder: &Folder, name: &str) -> Occupancy {
    let options = VolumeOptions::default();
    read_occupancy(folder.path(name), &options, &Select::NonZero).unwrap().occupancy
}

fn with_scene(text: &str) -> Folder {
    let folder = Folder::new();
    folder.file("scene.toml", text.as_bytes());
    folder
}

#[test]
fn a_scene_becomes_regions_shrouds_and_pictures() {
    let folder = with_scene(SCENE);
    let words = "contain scene.toml -o out --json --preset fast --width 200 --height 150";
    let told: serde_json::Value = serde_json::from_str(&folder.succeed(words)).unwrap();
    assert_eq!(told, folder.json("out/report.json"));
    assert_eq!(told["dims"], serde_json::json!([21, 21, 12]));
    assert_eq!(told["emptied_by"], serde_json::Value::Null);
    let steps = told["steps"].as_array().unwrap();
    assert_eq!(steps.len(), 3);
    for (n, step) in steps.iter().enumerate() {
        let name = |extension: &str| format!("out/region-00{}.{extension}", n + 1);
        let region = read(&folder, &name("nii.gz"));
        assert_eq!(step["voxels"], region.count());
        assert!(step["voxels"].as_u64() <= step["grown"].as_u64());
        assert_eq!(step["shroud"]["vertices"], folder.mesh(&name("ply")).vertices.len());
        assert!(folder.bytes(&name("png")).starts_with(b"\x89PNG"));
        assert!(step["times"]["shroud"].as_f64() > Some(0.0));
        // The lattice reaches from just below the floor up to the surface.
        let grid = region.grid();
        let [bottom, top] = [0.0, 11.0].map(|k| grid.point([0.0, 0.0, k]));
        let near = |a: f64, b: f64| (a - b).abs() < 1e-3;
        assert!(near(bottom[2], -1210.0) && near(top[2], 0.0) && near(top[0], -1000.0));
    }
    assert_eq!(steps[1]["path"], "bounce");
    assert_eq!(steps[0]["truth"]["position"], serde_json::json!([0.0, 800.0, -700.0]));
}

#[test]
fn a_one_sided_mesh_is_certified_around_more_than_the_region() {
    let folder = with_scene(SCENE);
    folder.succeed("contain scene.toml -o centre --every 3 --preset fast --format npy");
    folder.succeed("contain scene.toml -o cells --every 3 --preset fast --format nrrd --one-sided");
    assert_eq!(
        std::fs::read_dir(folder.path("cells")).unwrap().count(),
        4,
        "every third contact alone, and the report"
    );
    let [centre, cells] =
        ["centre", "cells"].map(|name| folder.json(&format!("{name}/report.json")));
    for n in 0..3 {
        assert!(centre["steps"][n]["voxels"].as_u64() < cells["steps"][n]["voxels"].as_u64());
        assert!(cells["steps"][n]["files"].is_null() == (n < 2));
    }
    let step = &cells["steps"][2];
    let voxels = step["region"]["volume"].as_f64().unwrap();
    assert!(step["shroud"]["volume"].as_f64().unwrap() > voxels, "cells as a whole are inside");
    folder.succeed("voxelize cells/region-003.ply --like cells/region-003.nrrd -o within.nrrd");
    let (region, within) = (read(&folder, "cells/region-003.nrrd"), read(&folder, "within.nrrd"));
    let outside = region.combine(Operation::Subtract, &within).unwrap().count();
    assert!(outside == 0 && within.count() > region.count());
}

#[test]
fn the_contact_that_empties_a_region_is_named() {
    let folder = with_scene(&SCENE.replace("bearing = 71", "bearing = 170"));
    let done = folder.run("contain scene.toml -o out --preset fast --json");
    assert_eq!(done.code, 1, "{}", done.err);
    assert!(done.err.contains("contact 3 at 90 s (either at 170 ± 9 degrees)"), "{}", done.err);
    let told: serde_json::Value = serde_json::from_str(&done.out).unwrap();
    assert_eq!(told["emptied_by"], 3);
    assert_eq!(told["steps"][2]["region"], serde_json::Value::Null);
    assert!(folder.path("out/region-002.ply").exists());
    assert!(!folder.path("out/region-003.ply").exists());
}

#[test]
fn floors_and_profiles_of_every_kind_are_read() {
    let floors = [
        "[floor.slope]\ndepth = 900\nslope = [0.1, 0]",
        "[floor.ridge]\ndepth = 1100\nheight = 300\nwidth = 400\nthrough = [0, 0]\ncourse = 30",
        "[floor.fractal]\ndepth = 1000\nrelief = 100\nlongest = 900\nshortest = 200\nseed = 1",
        "[floor.grid]\nfrom = [-1000, 0]\nspacing = [1000, 90]\nrows = [[900, 1000, 950]]",
    ];
    for floor in floors {
        let text = SCENE.replace("[floor.flat]\ndepth = 1150", floor);
        let text = text.replace(
            "[target]",
            "[sound]\nprofile = [[0, 1520], [500, 1490], [1500, 1500]]\n\n[target]",
        );
        let folder = with_scene(&text);
        let told = folder.succeed("contain scene.toml --every 9 --preset fast --json");
        let told: serde_json::Value = serde_json::from_str(&told).unwrap();
        assert!(told["steps"][2]["voxels"].as_u64() > Some(0), "{floor}");
    }
}

#[test]
fn what_is_wrong_with_a_scene_is_told_with_its_line() {
    for (from, to, parts) in [
        ("half_width = 12", "width = 12", &["line 31", "`width`", "half_width"][..]),
        ("bearing = 62", "bearing = \"N\"", &["line 25, key bearing", "expected f64"]),
        ("bearing = 62", "bearing = 262", &["line 23", "contact 1", "between 0 and 180"]),
        ("time = 60\n", "time = 6000\n", &["line 28", "contact 2", "6000 s"]),
        ("time = 600", "time = -5", &["line 18", "waypoint 2", "ascend"]),
        ("spacing = [100, 90, 110]", "spacing = 0", &["line 1:", "spacing"]),
        ("spacing = [100, 90, 110]", "spacing = 1e-5", &["line 1:", "1048574"]),
        ("depth = 1150", "depth = nan", &["line 7", "not finite"]),
        ("depth = 1150", "depth = 90", &["contact 1", "105", "sea floor 90"]),
        ("speed = 3", "speed = -3", &["line 10", "speed is -3"]),
        ("[floor.flat]", "[floor.round]", &["line 7", "round"]),
        ("[target]", "[target", &["line 10"]),
        ("path = \"bounce\"", "path = \"echo\"", &["key path", "echo"]),
    ] {
        let text = SCENE.replacen(from, to, 1);
        assert_ne!(text, SCENE, "{from}");
        let mut all = vec!["scene.toml: "];
        all.extend(parts);
        with_scene(&text).refuse("contain scene.toml -o out", 1, &all);
    }
    Folder::new().refuse("contain none.toml", 1, &["none.toml", "cannot read"]);
}
