//! Images and the polygons on them as SVG: pictures of the method in two dimensions.

use std::fmt::Write;

use shrouds::Occupancy;
use shrouds::polygon::Polygon;

/// Units of the drawing per smaller spacing of the lattice.
const UNIT: f64 = 24.0;
/// What is seen beyond the outermost lattice points, in smaller spacings.
const MARGIN: f64 = 1.4;
/// Room for a title, and between panels.
const TITLE: f64 = 46.0;
/// Width and height of a panel on the page at most, and of a unit.
const PAGE: f64 = 1000.0;
/// With more lattice points than this along one axis they are too small to be seen each.
const MOST_DOTS: usize = 200;

/// One panel of a drawing: an image, and polygons in its index coordinates.
///
/// x runs to the right and y down, as images are shown. Inside points are dark dots, outside points
/// light ones; grid edges with a vertex are darker than the others. Images too large for that show
/// their pixels instead.
#[derive(Debug, Clone)]
pub struct Plan<'a> {
    image: &'a Occupancy,
    title: &'a str,
    thin: &'a [Polygon],
    bold: &'a [Polygon],
    marks: Vec<[f64; 2]>,
}

impl<'a> Plan<'a> {
    /// A panel that shows the slice `z = 0` of a volume, the only one of an image.
    pub fn new(image: &'a Occupancy) -> Self {
        Self { image, title: "", thin: &[], bold: &[], marks: Vec::new() }
    }

    /// The same panel with a line of text above.
    #[must_use]
    pub fn title(mut self, title: &'a str) -> Self {
        self.title = title;
        self
    }

    /// The same panel with thin dashed polygons.
    #[must_use]
    pub fn thin(mut self, polygons: &'a [Polygon]) -> Self {
        self.thin = polygons;
        self
    }

    /// The same panel with bold polygons that show their vertices.
    #[must_use]
    pub fn bold(mut self, polygons: &'a [Polygon]) -> Self {
        self.bold = polygons;
        self
    }

    /// The same panel with a ring around a point in index coordinates.
    #[must_use]
    pub fn mark(mut self, point: [f64; 2]) -> Self {
        self.marks.push(point);
        self
    }

    /// Panels side by side as an SVG file.
    pub fn svg(panels: &[Self]) -> String {
        let sizes: Vec<[f64; 2]> = panels.iter().map(Self::size).collect();
        let gaps = TITLE * (panels.len().max(1) - 1) as f64;
        let width = sizes.iter().map(|size| size[0]).sum::<f64>() + gaps;
        let height = sizes.iter().map(|size| size[1]).fold(0.0, f64::max);
        let most = PAGE * panels.len().max(1) as f64;
        let scale = (most / width).min(PAGE / height).min(1.0);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{}\" height=\"{}\" viewBox=\"0 0 {} {}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
            Number(scale * width),
            Number(scale * height),
            Number(width),
            Number(height)
        );
        let mut left = 0.0;
        for (panel, size) in panels.iter().zip(&sizes) {
            let _ = writeln!(svg, "<g transform=\"translate({} 0)\">", Number(left));
            panel.draw(&mut svg);
            svg.push_str("</g>\n");
            left += size[0] + TITLE;
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn counts(&self) -> [usize; 2] {
        let [nx, ny, _] = self.image.grid().dims();
        [nx, ny]
    }

    /// Units per lattice point along x and y.
    fn steps(&self) -> [f64; 2] {
        let [x, y, _] = self.image.grid().spacing();
        [x, y].map(|spacing| UNIT * spacing / x.min(y))
    }

    /// Height of the title.
    fn top(&self) -> f64 {
        if self.title.is_empty() { 0.0 } else { TITLE }
    }

    fn size(&self) -> [f64; 2] {
        let (counts, steps) = (self.counts(), self.steps());
        let [x, y] = [0, 1].map(|k| (counts[k] - 1) as f64 * steps[k] + 2.0 * MARGIN * UNIT);
        [x, y + self.top()]
    }

    /// Where a point in index coordinates lies on the panel.
    fn at(&self, [i, j]: [f64; 2]) -> Point {
        let [x, y] = self.steps();
        Point([MARGIN * UNIT + i * x, self.top() + MARGIN * UNIT + j * y])
    }

    fn draw(&self, svg: &mut String) {
        if !self.title.is_empty() {
            let (x, text) = (Number(MARGIN * UNIT), escaped(self.title));
            let _ = writeln!(
                svg,
                "<text x=\"{x}\" y=\"34\" font-family=\"sans-serif\" font-size=\"19\" fill=\"#1f2937\">{text}</text>"
            );
        }
        if self.counts().iter().all(|&count| count <= MOST_DOTS) {
            self.draw_lattice(svg);
        } else {
            self.draw_pixels(svg);
        }
        self.draw_polygons(svg);
    }

    /// Grid edges and lattice points.
    fn draw_lattice(&self, svg: &mut String) {
        let [nx, ny] = self.counts();
        let mut lines = String::new();
        let ends = |n: usize| [-1.0, n as f64];
        for i in 0..nx {
            let [low, high] = ends(ny).map(|j| self.at([i as f64, j]));
            let _ = write!(lines, "M{low}L{high}");
        }
        for j in 0..ny {
            let [low, high] = ends(nx).map(|i| self.at([i, j as f64]));
            let _ = write!(lines, "M{low}L{high}");
        }
        path(svg, &lines, "stroke=\"#e5e7eb\" stroke-width=\"1\"");
        let mut crossed = String::new();
        for p in self.bold.iter().chain(self.thin).flat_map(|polygon| &polygon.index) {
            let [low, high] = [p.map(f64::floor), p.map(f64::ceil)].map(|end| self.at(end));
            let _ = write!(crossed, "M{low}L{high}");
        }
        path(svg, &crossed, "stroke=\"#9ca3af\" stroke-width=\"1.4\"");
        for (inside, style) in [
            (false, "stroke=\"#cbd5e1\" stroke-width=\"5\" stroke-linecap=\"round\""),
            (true, "stroke=\"#0f172a\" stroke-width=\"8\" stroke-linecap=\"round\""),
        ] {
            let mut dots = String::new();
            for (j, i) in (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i))) {
                if self.image.get([i, j, 0]) == inside {
                    let _ = write!(dots, "M{}h0", self.at([i as f64, j as f64]));
                }
            }
            path(svg, &dots, style);
        }
    }

    /// The inside pixels, row by row.
    fn draw_pixels(&self, svg: &mut String) {
        let [nx, ny] = self.counts();
        let [_, height] = self.steps();
        let mut runs = String::new();
        for j in 0..ny {
            let mut i = 0;
            while i < nx {
                let start = i;
                while i < nx && self.image.get([i, j, 0]) {
                    i += 1;
                }
                if i > start {
                    let [low, high] = [start, i].map(|i| self.at([i as f64 - 0.5, j as f64]));
                    let _ = write!(runs, "M{low}L{high}");
                }
                i += 1;
            }
        }
        let style = format!("stroke=\"#cbd5e1\" stroke-width=\"{}\"", Number(height));
        path(svg, &runs, &style);
    }

    fn draw_polygons(&self, svg: &mut String) {
        let outline = |polygons: &[Polygon]| {
            let mut outline = String::new();
            for polygon in polygons {
                let mut sign = 'M';
                for &p in &polygon.index {
                    let _ = write!(outline, "{sign}{}", self.at(p));
                    sign = 'L';
                }
                outline.push_str(if polygon.closed { "Z" } else { "" });
            }
            outline
        };
        path(
            svg,
            &outline(self.thin),
            "stroke=\"#ea580c\" stroke-width=\"1.6\" stroke-dasharray=\"5 3.5\"",
        );
        let bold = outline(self.bold);
        if self.bold.iter().all(|polygon| polygon.closed) {
            path(svg, &bold, "style=\"fill:#3b82f6;fill-opacity:0.12;fill-rule:evenodd\"");
        }
        path(svg, &bold, "stroke=\"#1d4ed8\" stroke-width=\"3\" stroke-linejoin=\"round\"");
        if self.counts().iter().all(|&count| count <= MOST_DOTS) {
            let mut dots = String::new();
            for &p in self.bold.iter().flat_map(|polygon| &polygon.index) {
                let _ = write!(dots, "M{}h0", self.at(p));
            }
            path(svg, &dots, "stroke=\"#1d4ed8\" stroke-width=\"6.5\" stroke-linecap=\"round\"");
            path(svg, &dots, "stroke=\"#ffffff\" stroke-width=\"3\" stroke-linecap=\"round\"");
        }
        for &mark in &self.marks {
            let Point([x, y]) = self.at(mark);
            let _ = writeln!(
                svg,
                "<circle cx=\"{}\" cy=\"{}\" r=\"11\" fill=\"none\" stroke=\"#dc2626\" stroke-width=\"2.5\"/>",
                Number(x),
                Number(y)
            );
        }
    }
}

/// Adds a path, unless it is empty.
fn path(svg: &mut String, path: &str, style: &str) {
    if !path.is_empty() {
        let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" {style}/>");
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// A number with two digits after the point at most.
struct Number(f64);

impl std::fmt::Display for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let text = format!("{:.2}", self.0);
        f.write_str(text.trim_end_matches('0').trim_end_matches('.'))
    }
}

/// A place on a panel.
struct Point([f64; 2]);

impl std::fmt::Display for Point {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", Number(self.0[0]), Number(self.0[1]))
    }
}

#[cfg(test)]
mod tests {
    use shrouds::{Grid, Settings, polygon};

    use super::*;

    fn drawing(nx: usize, ny: usize, title: &str) -> (Occupancy, String) {
        let grid = Grid::new([nx, ny, 1], [2.0, 1.0, 1.0]).unwrap();
        let image = Occupancy::from_fn(grid, |[i, j, _]| i > 0 && (j == 1 || i == 2));
        let found = polygon::separate(&image, &Settings::default()).unwrap();
        let panel = Plan::new(&image).title(title).bold(&found.polygons).thin(&found.polygons);
        let svg = Plan::svg(&[panel.clone().mark([1.0, 1.0]), panel]);
        (image, svg)
    }

    #[test]
    fn every_point_edge_and_vertex_is_drawn() {
        let (image, svg) = drawing(6, 4, "a < b");
        let dots = |width: &str| {
            let path = svg
                .lines()
                .find(|line| line.contains(&format!("stroke-width=\"{width}\" stroke-linecap")));
            path.unwrap().matches("h0").count() as u64
        };
        assert_eq!(dots("8"), image.count());
        assert_eq!(dots("5"), 24 - image.count());
        let found = polygon::separate(&image, &Settings::default()).unwrap();
        assert_eq!(dots("6.5"), found.delta.len() as u64);
        assert_eq!(svg.matches("a &lt; b").count(), 2);
        assert_eq!(svg.matches("<circle").count(), 1);
        // Twice as wide as high, with the margins: 5·48 + 2.8·24 by 3·24 + 2.8·24 and the title.
        assert!(svg.contains(&format!("viewBox=\"0 0 {} {}\"", Number(2.0 * 307.2 + 46.0), 185.2)));
        // The first inside point, (1, 1).
        assert!(svg.contains("M81.6 103.6h0"));
        assert!(!svg.contains("NaN") && svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
    }

    #[test]
    fn large_images_show_pixels() {
        let (_, svg) = drawing(300, 4, "");
        assert!(!svg.contains("h0") && svg.contains("stroke-width=\"24\""));
        assert!(svg.contains("width=\"2000\""));
    }
}
