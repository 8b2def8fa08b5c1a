//! `shrouds demo figureN`: the figures of the paper.

use serde_json::Value;

use crate::common::Folder;

fn figure(folder: &Folder, words: &str) -> Value {
    let report: Value = serde_json::from_str(&folder.succeed(words)).unwrap();
    report[0].clone()
}

fn number(cell: &Value) -> f64 {
    cell.as_str().unwrap().parse().unwrap()
}

#[test]
fn the_energies_of_figure_3_fall_and_its_errors_too() {
    let folder = Folder::new();
    let figure = figure(&folder, "demo figure3 -o a --json");
    let rows = figure["rows"].as_array().unwrap();
    let column = |n: usize| rows[..3].iter().map(|row| number(&row[n])).collect::<Vec<_>>();
    assert!(column(1).is_sorted_by(|a, b| a > b), "{rows:?}");
    assert!(column(4).is_sorted_by(|a, b| a > b), "{rows:?}");
    // What `exact` is for: less than half of the errors of the paper's energy.
    assert!(number(&rows[3][3]) < 0.6 * number(&rows[2][3]));
    assert!(number(&rows[3][4]) < 0.5 * number(&rows[2][4]));
    let verdicts: Vec<_> =
        figure["claims"].as_array().unwrap().iter().map(|c| &c["verdict"]).collect();
    assert_eq!(verdicts, ["holds", "does not hold"]);
}

#[test]
fn figures_are_the_same_bytes_on_any_number_of_threads() {
    let folder = Folder::new();
    for name in ["figure1", "figure3", "figure7"] {
        folder.succeed(&format!("demo {name} -o one --threads 1 --quiet"));
        folder.succeed(&format!("demo {name} -o two --threads 2 --quiet"));
        let [one, two] = ["one", "two"].map(|to| folder.bytes(&format!("{to}/{name}.png")));
        assert!(one == two, "{name}");
    }
}

#[test]
fn without_data_a_phantom_stands_in_and_is_named() {
    let folder = Folder::new();
    for name in ["figure2", "figure4", "figure6"] {
        let figure = figure(&folder, &format!("demo {name} --data nowhere -o out --json"));
        assert!(figure["data"].as_str().unwrap().contains("a phantom"), "{figure}");
        assert!(folder.bytes(&format!("out/{name}.png")).starts_with(b"\x89PNG"));
    }
}

#[test]
fn the_limit_does_not_depend_on_the_start() {
    let folder = Folder::new();
    let figure = figure(&folder, "demo figure4 --data nowhere -o out --json");
    assert_eq!(figure["claims"][0]["verdict"], "holds", "{figure}");
}

#[test]
fn thin_tubes_stay_in_one_part() {
    let folder = Folder::new();
    let figure = figure(&folder, "demo figure7 -o out --json");
    assert_eq!(figure["rows"][0][2], "1", "{figure}");
}

#[test]
fn no_intersection_makes_the_region_of_figure_11_larger() {
    let folder = Folder::new();
    let figure = figure(&folder, "demo figure11 -o out --json");
    assert_eq!(figure["claims"][0]["verdict"], "holds", "{figure}");
    assert_eq!(figure["rows"].as_array().unwrap().len(), 9);
}
