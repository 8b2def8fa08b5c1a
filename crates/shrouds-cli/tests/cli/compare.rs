//! `shrouds compare`: its table, its JSON, its contact sheet.

use serde_json::Value;
use shrouds::energy::{Parameter, catalogue};

use crate::common::{Folder, volume};

fn compare(folder: &Folder, words: &str) -> Value {
    serde_json::from_str(&folder.succeed(&format!("compare {words} --json"))).unwrap()
}

fn rows(comparison: &Value) -> &[Value] {
    comparison["energies"].as_array().unwrap()
}

/// Every measure with every choice of its arguments that has a name.
fn every_energy() -> Vec<String> {
    let mut all = Vec::new();
    for entry in catalogue() {
        let name = entry.name;
        match entry.arguments {
            "" => all.push(name.to_owned()),
            "[parameter]" => all.extend(Parameter::ALL.map(|p| format!("{name}({p})"))),
            "[nu[, parameter]]" => {
                all.extend(Parameter::ALL.map(|p| format!("{name}(0.5,{p})")));
            }
            choice if choice.contains('|') => {
                let names = choice.trim_matches(['[', ']']).split('|');
                all.extend(names.map(|choice| format!("{name}({choice})")));
            }
            other => panic!("say here what {name} may have for {other}"),
        }
    }
    all
}

#[test]
fn a_table_has_a_line_for_every_energy() {
    let folder = Folder::with_tori();
    let list = "bending; linear ;curvature(chord);bending;2*bending+variation".replace(' ', "");
    let done = folder.run(&format!("compare volume.npy --energies {list}"));
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    let lines: Vec<&str> = done.out.lines().collect();
    assert_eq!(lines[0], "volume.npy: 799 voxels inside, of 24 × 24 × 24; preset exact");
    let end = lines.iter().skip(2).position(|line| line.is_empty()).unwrap() + 2;
    let names: Vec<&str> =
        lines[4..end].iter().map(|line| line.split("  ").next().unwrap()).collect();
    assert_eq!(
        names,
        ["bending", "linear(uniform) *", "curvature(chord) *", "2*bending+variation"]
    );
    let widths: Vec<usize> = lines[3..end].iter().map(|line| line.chars().count()).collect();
    assert!(widths.iter().all(|width| *width == widths[0]), "{}", done.out);
    assert!(lines[4..end].iter().all(|line| line.contains(" converged ")), "{}", done.out);
    assert!(done.out.contains("* may destroy") && !done.out.contains("distance"), "{}", done.out);
    assert_eq!(folder.succeed("compare volume.npy --energy bending --quiet"), "");
}

#[test]
fn the_numbers_are_those_of_mesh() {
    let folder = Folder::with_tori();
    let comparison =
        compare(&folder, "volume.npy --energies bending;curvature --parameter uniform");
    assert_eq!(comparison["input"]["inside"], 799);
    assert_eq!(comparison["settings"]["preset"], "exact");
    assert_eq!(comparison["settings"].get("energy"), None);
    for (row, energy) in rows(&comparison).iter().zip(["bending", "curvature(uniform)"]) {
        assert_eq!(row["energy"], energy);
        let call =
            format!("mesh volume.npy -o out.ply --preset exact --energy {energy} --json --quiet");
        let report: Value = serde_json::from_str(&folder.succeed(&call)).unwrap();
        assert_eq!(row["status"], report["solver"]["status"]);
        assert_eq!(row["iterations"], report["solver"]["iterations"]);
        assert_eq!(row["value"], report["solver"]["energy"]);
        assert_eq!(row["at_bound"], report["solver"]["at_bound"]);
        assert_eq!(row["area"], report["geometry"]["area"]);
        let volume = report["geometry"]["volume"].as_f64().unwrap();
        assert_eq!(row["volume"], volume);
        let error = row["volume_error"].as_f64().unwrap();
        assert!((error - 100.0 * (volume / 799.0 - 1.0)).abs() < 1e-9);
        assert!(row["distance"].is_null() && row["multistart"].is_null());
    }
    let [safe, other] = [0, 1].map(|n| &rows(&comparison)[n]);
    assert_eq!(
        (&safe["keeps_thin_parts"], &other["keeps_thin_parts"]),
        (&true.into(), &false.into())
    );
}

#[test]
fn phantoms_are_held_against_the_truth() {
    let folder = Folder::new();
    // As tests/python/accuracy.py measures them, within what the energies promise.
    for (phantom, distance, normal) in
        [("ball", 0.03, 2.0), ("tori", 0.15, 9.0), ("ellipsoid", 0.12, 4.0), ("box", 0.3, 25.0)]
    {
        let comparison = compare(&folder, &format!("demo:{phantom} --size 24 --energies bending"));
        let row = &rows(&comparison)[0];
        let told = |key: &str| row[key].as_f64().unwrap();
        assert!((0.001..distance).contains(&told("distance")), "{phantom}: {row}");
        assert!((0.1..normal).contains(&told("normal")), "{phantom}: {row}");
        assert!(comparison["true_volume"].as_f64().unwrap() > 0.0);
    }
    let text = folder.succeed("compare demo:ball --size 12 --energies bending");
    assert!(text.contains("distance") && text.contains("normals"), "{text}");
    let comparison = compare(&folder, "demo:letters:B --size 16 --energies bending");
    assert!(rows(&comparison)[0]["distance"].is_null());
    assert!(folder.names().is_empty());
}

#[test]
fn the_usual_list_has_every_safe_energy_and_those_of_the_paper() {
    let folder = Folder::new();
    let comparison = compare(&folder, "demo:point --size 5");
    let names: Vec<&str> =
        rows(&comparison).iter().map(|row| row["energy"].as_str().unwrap()).collect();
    for entry in catalogue().iter().filter(|entry| entry.keeps_thin_parts) {
        assert!(names.iter().any(|name| name.starts_with(entry.name)), "{}", entry.name);
    }
    for parameter in Parameter::ALL {
        for name in ["curvature", "linear"] {
            assert!(names.contains(&format!("{name}({parameter})").as_str()), "{names:?}");
        }
    }
    assert_eq!(rows(&comparison)[0]["of_preset"], true);
}

#[test]
fn every_energy_leaves_every_voxel_on_its_side() {
    let folder = Folder::new();
    let list = every_energy().join(";");
    for input in
        ["noise --size 7", "rod --size 7", "plate --size 5", "point --size 4", "tori --size 13"]
    {
        for options in [
            "--preset exact",
            "--preset default --start random:4",
            "--border open",
            "--preset fast --border open",
            "--solver sweeps --max-iterations 3 --start midpoint --surface dual",
            "--faces join --max-iterations 0",
        ] {
            let comparison = compare(&folder, &format!("demo:{input} {options} --energies {list}"));
            assert_eq!(rows(&comparison).len(), every_energy().len());
            for row in rows(&comparison) {
                let told = format!("{input} {options}: {row}");
                assert_ne!(row["status"], "failed", "{told}");
                assert_eq!(row["wrong_side"], 0, "{told}");
                assert_eq!(row["problems"], serde_json::json!([]), "{told}");
                let open = options.contains("open");
                // serde_json writes what is no number as null.
                for key in ["seconds", "area", "roughness", "largest_move", "at_bound"] {
                    assert!(row[key].is_f64(), "{key} of {told}");
                }
                for pair in
                    ["/value/first", "/value/last", "/projected_step/rms", "/projected_step/max"]
                {
                    assert!(row.pointer(pair).unwrap().is_f64(), "{pair} of {told}");
                }
                for key in ["volume", "volume_error"] {
                    assert!(row[key].is_f64() || open, "{key} of {told}");
                }
                assert!(row["largest_move"].as_f64().unwrap() <= 0.498 + 1e-6, "{told}");
            }
        }
    }
}

#[test]
fn other_starts_are_counted_and_compared() {
    let folder = Folder::with_tori();
    let options = "--energies linear;bending --multistart 2 --tolerance 1e-7";
    let comparison = compare(&folder, &format!("volume.npy {options}"));
    for (row, energy) in rows(&comparison).iter().zip(["linear", "bending"]) {
        let starts = row["multistart"]["starts"].as_array().unwrap();
        assert_eq!(starts.len(), 2);
        let mut last = vec![row["value"]["last"].as_f64().unwrap()];
        for (start, seed) in starts.iter().zip([1, 2]) {
            assert_eq!(start["seed"], seed);
            let call = format!(
                "mesh volume.npy -o out.ply --json --quiet --tolerance 1e-7 --energy {energy} --start random:{seed}"
            );
            let report: Value = serde_json::from_str(&folder.succeed(&call)).unwrap();
            assert_eq!(start["value"], report["solver"]["energy"]);
            last.push(start["value"]["last"].as_f64().unwrap());
            assert!(start["difference"]["rms"].as_f64() <= start["difference"]["max"].as_f64());
        }
        let low = last.iter().copied().fold(f64::INFINITY, f64::min);
        let high = last.iter().copied().fold(0.0, f64::max);
        let spread = row["multistart"]["spread"].as_f64().unwrap();
        assert!((spread - (high - low) / low).abs() < 1e-12);
    }
    // The linear energy is convex: all starts end at one place.
    let linear = &rows(&comparison)[0]["multistart"]["difference"];
    assert!(linear["max"].as_f64().unwrap() < 1e-4, "{linear}");
    // Where nothing moves, the starts stay as far apart as they are.
    let still = compare(&folder, "volume.npy --energies linear --multistart 1 --max-iterations 0");
    let gap = rows(&still)[0]["multistart"]["difference"]["rms"].as_f64().unwrap();
    assert!((0.2..0.5).contains(&gap), "{gap}");
    let text = folder.succeed("compare volume.npy --energies bending --multistart 1");
    assert!(text.contains("starts") && text.contains("largest"), "{text}");
}

#[test]
fn an_energy_that_does_not_converge_is_a_row() {
    let folder = Folder::with_tori();
    let call =
        "compare volume.npy --energies bending;linear --max-iterations 2 --picture sheet.png";
    let done = folder.run(call);
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    assert!(done.out.contains("iteration limit"), "{}", done.out);
    assert!(folder.path("sheet.png").exists());
    // Where no energy has a surface, the reason is told.
    folder.volume("full.npy", &volume([4, 3, 5], |_| true));
    let done = folder.run("compare full.npy --border open --energies bending;linear");
    assert!(done.code == 1 && done.out.contains("failed"), "{}", done.out);
    assert!(
        done.err.contains("no energy gave a surface") && done.err.contains("--border closed"),
        "{}",
        done.err
    );
}

#[test]
fn the_contact_sheet_has_a_cell_for_every_energy() {
    let folder = Folder::with_tori();
    let sheet = |list: &str, options: &str| {
        folder.succeed(&format!(
            "compare volume.npy --energies {list} --picture s.png --quiet {options}"
        ));
        folder.bytes("s.png")
    };
    let size = |picture: &[u8]| {
        [16, 20].map(|at| u32::from_be_bytes(picture[at..at + 4].try_into().unwrap()))
    };
    let [one, three, four] =
        ["bending", "bending;linear;variation", "bending;linear;variation;curvature"]
            .map(|list| sheet(list, ""));
    let [width, height] = size(&one);
    assert!(width > 400 && height > 400);
    assert_eq!(size(&three), size(&four));
    assert_eq!(size(&four).map(|side| side / 2), [width - 6, height - 6]);
    assert!(three != four && one != sheet("linear", ""));
    assert_eq!(one, sheet("bending", "--threads 1"));
    assert_eq!(one, sheet("bending", "--threads 3"));
}
