//! `shrouds demo figure3` and `figures`: the figures of the paper, made again.

use std::path::PathBuf;

use serde::Serialize;
use shrouds_io::write_atomically;

use crate::args::DemoArgs;
use crate::console::{Console, print_json};
use crate::failure::Failure;
use crate::figures::{Data, FIGURES, Figure, page};
use crate::output::{check_targets, make_folder, write_picture};
use crate::progress::Progress;

/// The name that stands for all of them, with their page.
const ALL: &str = "figures";
const PAGE: &str = "README.md";

/// A figure in numbers.
#[derive(Serialize)]
struct Report {
    figure: &'static str,
    title: &'static str,
    picture: String,
    data: String,
    columns: Vec<&'static str>,
    rows: Vec<Vec<String>>,
    claims: Vec<ClaimReport>,
}

#[derive(Serialize)]
struct ClaimReport {
    claim: &'static str,
    measured: String,
    verdict: &'static str,
}

/// Whether a demo of this name is a figure of the paper.
pub(crate) fn is_figure(name: &str) -> bool {
    name == ALL || FIGURES.iter().any(|(figure, _)| *figure == name)
}

pub(crate) fn run(args: &DemoArgs, console: Console) -> Result<(), Failure> {
    let folder = &args.output;
    make_folder(folder)?;
    let all = args.name == ALL;
    let chosen: Vec<_> = FIGURES.iter().filter(|(name, _)| all || *name == args.name).collect();
    let picture = |name: &str| folder.join(name).with_extension("png");
    let mut targets: Vec<PathBuf> = chosen.iter().map(|(name, _)| picture(name)).collect();
    targets.extend(all.then(|| folder.join(PAGE)));
    check_targets(&targets.iter().map(PathBuf::as_path).collect::<Vec<_>>(), &[])?;

    let data = Data::in_folder(&args.data);
    let progress = Progress::new(console.quiet);
    let (mut figures, mut reports) = (Vec::new(), Vec::new());
    for (name, make) in chosen {
        progress.stage(name);
        let figure = make(&data)?;
        write_picture(&picture(name), &figure.picture)?;
        reports.push(Report::new(&figure, picture(name).display().to_string()));
        figures.push(figure);
    }
    if all {
        let text = page(&figures);
        write_atomically(folder.join(PAGE), |out| out.write_all(text.as_bytes()))?;
    }
    drop(progress);
    if args.json {
        return print_json(&reports);
    }
    reports.iter().try_for_each(|report| console.result(&report.in_words()))
}

impl Report {
    fn new(figure: &Figure, picture: String) -> Self {
        let claims = figure.claims.iter().map(|claim| ClaimReport {
            claim: claim.paper,
            measured: claim.measured.clone(),
            verdict: claim.verdict.word(),
        });
        Self {
            figure: figure.name,
            title: figure.title,
            picture,
            data: figure.data.clone(),
            columns: figure.numbers.head.clone(),
            rows: figure.numbers.rows.clone(),
            claims: claims.collect(),
        }
    }

    fn in_words(&self) -> String {
        let mut lines = vec![format!("{}: {}", self.picture, self.title)];
        lines.push(format!("  made of {}", self.data));
        for claim in &self.claims {
            let ClaimReport { claim, measured, verdict } = claim;
            lines.push(format!("  {claim}: {verdict}; {measured}"));
        }
        lines.join("\n")
    }
}
