//! The page of the gallery.

use std::fmt::Write;

use super::{Figure, Table};

const HEAD: &str = "\
# The figures of the paper, made again

Written by `cargo xtask figures`, as are the pictures; one of them alone by `shrouds demo figure3`. The figures are those of *Shrouds: Optimal Separating Surfaces for
Enumerated Volumes* (Nielson, Graf, Holmes, Huang, Phielipp, 2003). Sweeps are the paper's method with its energy (7); *ours* is preset `exact` of this program.
";

/// All figures, each with what the paper shows, what ours is made of, numbers and claims.
pub(crate) fn page(figures: &[Figure]) -> String {
    figures.iter().fold(HEAD.to_owned(), |text, figure| text + &section(figure))
}

fn section(figure: &Figure) -> String {
    let Figure { name, title, paper, data, numbers, claims, .. } = figure;
    let number = name.trim_start_matches("figure");
    let mut text = format!(
        "\n## Figure {number}: {title}\n\n![{title}]({name}.png)\n\nThe paper: {paper}\n\nOurs: {data}.\n\n{}",
        markdown(numbers)
    );
    if !claims.is_empty() {
        let rows = claims.iter().map(|claim| {
            vec![claim.paper.to_owned(), claim.measured.clone(), claim.verdict.word().to_owned()]
        });
        let claims = Table { head: vec!["claim", "we measure", "verdict"], rows: rows.collect() };
        let _ = write!(text, "\n{}", markdown(&claims));
    }
    text
}

fn markdown(table: &Table) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = table.head.iter().map(|&word| word.to_owned()).collect();
    let rule: Vec<String> = head.iter().map(|_| "---".to_owned()).collect();
    let rows = table.rows.iter().map(|row| line(row));
    [line(&head), line(&rule)].into_iter().chain(rows).collect()
}

#[cfg(test)]
mod tests {
    use shrouds_view::Picture;

    use super::super::{Claim, Verdict};
    use super::*;

    #[test]
    fn a_section_has_the_picture_the_numbers_and_the_verdicts() {
        let figure = Figure {
            name: "figure3",
            title: "Tori",
            paper: "Two tori.",
            data: "a phantom".into(),
            picture: dot(),
            numbers: Table {
                head: vec!["", "energy"],
                rows: vec![vec!["limit".into(), "2".into()]],
            },
            claims: vec![Claim { paper: "fast", measured: "slow".into(), verdict: Verdict::No }],
        };
        let text = page(&[figure]);
        for part in [
            "## Figure 3: Tori\n",
            "![Tori](figure3.png)",
            "Ours: a phantom.",
            "|  | energy |\n| --- | --- |\n| limit | 2 |\n",
            "| fast | slow | does not hold |\n",
        ] {
            assert!(text.contains(part), "{part} is missing in {text}");
        }
    }

    fn dot() -> Picture {
        let mesh = shrouds::TriMesh {
            vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            triangles: vec![[0, 1, 2]],
            normals: vec![],
        };
        let style = shrouds_view::Style { width: 8, height: 8, ..Default::default() };
        let scene = shrouds_view::Scene::new(&mesh);
        Picture::draw(&scene, &shrouds_view::Camera::default(), &style).unwrap()
    }
}
