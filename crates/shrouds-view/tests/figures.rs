//! Legends, scale bars and captions, measured in pixels.

// The helpers are tests too.
#![allow(clippy::unwrap_used)]

mod shapes;

use shrouds_view::{
    Camera, ColourScale, Colours, Error, Figure, Legend, Picture, Projection, Scene, Style, View,
};

const WHITE: [u8; 3] = [255; 3];

fn style(width: u32, height: u32) -> Style {
    Style { width, height, samples: 1, background: WHITE, ambient: 1.0, ..Style::default() }
}

fn front() -> Camera {
    Camera::default().view(View::Front)
}

fn legend(low: f64, high: f64, beyond: [bool; 2]) -> Legend {
    let scale = ColourScale::new(low, high, 0.0).unwrap();
    Legend { title: "mean curvature".into(), unit: "1/mm²".into(), scale, beyond }
}

/// The columns and the rows between which pixels of some kind lie.
fn extent(
    picture: &Picture,
    columns: std::ops::Range<u32>,
    rows: std::ops::Range<u32>,
    is: impl Fn([u8; 3]) -> bool,
) -> Option<[[u32; 2]; 2]> {
    let mut found: Option<[[u32; 2]; 2]> = None;
    for (x, y) in rows.flat_map(|y| columns.clone().map(move |x| (x, y))) {
        if is(picture.pixel(x, y).unwrap()) {
            let [[left, right], [top, bottom]] = found.unwrap_or([[x, x], [y, y]]);
            found = Some([[left.min(x), right.max(x)], [top.min(y), bottom.max(y)]]);
        }
    }
    found
}

fn is_dark(pixel: [u8; 3]) -> bool {
    pixel.iter().all(|part| *part < 60)
}

/// A cube of 10 units.
fn cube() -> shrouds::TriMesh {
    let mut mesh = shapes::cube();
    let size = mesh.vertices.iter().map(|v| v[0]).fold(f64::NEG_INFINITY, f64::max)
        - mesh.vertices.iter().map(|v| v[0]).fold(f64::INFINITY, f64::min);
    mesh.vertices.iter_mut().flatten().for_each(|x| *x *= 10.0 / size);
    mesh
}

#[test]
fn the_scale_bar_is_as_long_as_it_says() {
    let mesh = cube();
    let scene = Scene::new(&mesh).colours(Colours::One([200, 120, 60]));
    let figure = Figure { scale_bar: Some(["mm"; 2].map(Into::into)), ..Figure::default() };
    for (width, height, zoom, length) in
        [(600, 400, 1.0, 2.0), (600, 400, 0.3, 10.0), (300, 700, 1.0, 2.0), (500, 500, 2.0, 1.0)]
    {
        let camera = Camera { zoom, ..front() };
        let picture = figure.draw(&scene, &camera, &style(width, height)).unwrap();
        assert_eq!((picture.width(), picture.height()), (width, height));
        let strip = height - 40..height;
        let [[left, _], _] = extent(&picture, 0..width, strip.clone(), is_dark).unwrap();
        // The line runs on without a gap; the label does not.
        let row = (strip.start..strip.end)
            .find(|&y| (left..left + 12).all(|x| is_dark(picture.pixel(x, y).unwrap())))
            .unwrap();
        let bar = (left..width).take_while(|&x| is_dark(picture.pixel(x, row).unwrap())).count();
        // The cube would be as wide as this if all of it were seen.
        let above = f64::from(width.min(height - 40));
        let fitted = (f64::from(width) - 0.1 * above).min(f64::from(height - 40) - 0.1 * above);
        let expected = fitted * zoom * length / 10.0;
        assert!((bar as f64 - expected).abs() <= 1.0, "{bar} pixels, not {expected}");
        if zoom == 1.0 {
            let ink = |pixel: [u8; 3]| pixel != WHITE;
            let [[l, r], _] = extent(&picture, 0..width, 0..strip.start, ink).unwrap();
            let seen = f64::from(r - l + 1);
            assert!((bar as f64 - seen * length / 10.0).abs() <= 1.0, "{bar} of {seen}");
        }
        let text = extent(&picture, left + bar as u32..width, strip.clone(), is_dark).unwrap();
        assert!(
            text[0][1] < width - 5 && text[1][1] < height - 3,
            "the label is cut off: {text:?}"
        );
    }
}

#[test]
fn the_legend_has_every_colour_at_its_number() {
    let mesh = cube();
    let (width, height) = (640, 480);
    for (low, high, beyond) in
        [(-0.2, 0.2, [false; 2]), (-1.0, 3.0, [true, false]), (0.5, 2.0, [true; 2])]
    {
        let legend = legend(low, high, beyond);
        let scale = legend.scale;
        let column = width - legend.width()..width;
        let figure = Figure { legend: Some(legend), ..Figure::default() };
        let picture = figure.draw(&Scene::new(&mesh), &front(), &style(width, height)).unwrap();
        // The longest run of one column of pixels that has no background: the bar.
        let x = column.start + 14 + 12;
        let rows: Vec<u32> = (0..height).filter(|&y| picture.pixel(x, y) != Some(WHITE)).collect();
        let runs = rows.chunk_by(|a, b| a + 1 == *b);
        let bar = runs.max_by_key(|run| run.len()).unwrap();
        let point = |is: bool| if is { 11 } else { 0 };
        let (top, end) = (bar[0] + point(beyond[1]), bar[bar.len() - 1] - point(beyond[0]));
        let long = f64::from(end - top + 1);
        for y in top..=end {
            let value = high - (f64::from(y - top) + 0.5) / long * (high - low);
            assert_eq!(picture.pixel(x, y), Some(scale.colour(value)), "{low} {high}: row {y}");
        }
        // Ticks stand beside the bar where their numbers are.
        let ticks: Vec<u32> = (top - 2..end + 2)
            .filter(|&y| is_dark(picture.pixel(column.start + 14 + 24 + 3, y).unwrap()))
            .collect();
        let step = if high - low < 1.0 {
            0.1
        } else if high - low > 2.0 {
            1.0
        } else {
            0.5
        };
        let count = ((high - low) / step).round() as usize + 1;
        assert_eq!(ticks.len(), count, "{low} {high}: {ticks:?}");
        for (n, y) in ticks.iter().rev().enumerate() {
            let value = low + n as f64 * step;
            let expected = f64::from(top) + (high - value) / (high - low) * long;
            assert!((f64::from(*y) - expected).abs() <= 1.0, "{value} at {y}, not {expected}");
        }
        // Nothing is cut off at the right, and the scene keeps out of the column.
        let ink = |pixel: [u8; 3]| pixel != WHITE;
        let [[left, right], [above, below]] =
            extent(&picture, column.clone(), 0..height, ink).unwrap();
        assert!(left >= column.start + 10 && right < width - 10, "{left} {right}");
        assert!(above > 10 && below < height - 10, "{above} {below}");
    }
}

#[test]
fn captions_are_below_and_never_over_the_bar() {
    let mesh = cube();
    let scene = Scene::new(&mesh);
    let caption = Some("a ".repeat(200));
    let plain = Picture::draw(&scene, &front(), &style(400, 260)).unwrap();
    let figure = Figure { caption: caption.clone(), ..Figure::default() };
    let captioned = figure.draw(&scene, &front(), &style(400, 300)).unwrap();
    assert_eq!(captioned.pixels()[..plain.pixels().len()], *plain.pixels());
    let figure =
        Figure { caption, scale_bar: Some(["µm"; 2].map(Into::into)), ..Figure::default() };
    let both = figure.draw(&scene, &front(), &style(400, 300)).unwrap();
    let [[left, _], _] = extent(&both, 0..400, 260..300, is_dark).unwrap();
    assert!((left - 8..left).all(|x| (260..300).all(|y| both.pixel(x, y) == Some(WHITE))));
    // Without anything wanted it is the plain picture.
    let none = Figure::default().draw(&scene, &front(), &style(400, 260)).unwrap();
    assert_eq!(none, plain);
}

#[test]
fn figures_that_cannot_be_drawn() {
    let mesh = cube();
    let scene = Scene::new(&mesh);
    let with_legend = Figure { legend: Some(legend(-1.0, 1.0, [true; 2])), ..Figure::default() };
    for size in [style(120, 400), style(400, 120)] {
        let found = with_legend.draw(&scene, &front(), &size);
        assert!(matches!(found, Err(Error::Setting { .. })), "{found:?}");
    }
    let bar = Figure { scale_bar: Some(["mm"; 2].map(Into::into)), ..Figure::default() };
    assert!(bar.draw(&scene, &front(), &style(60, 400)).is_err());
    let perspective =
        Camera { projection: Projection::Perspective { angle: 40.0 }, ..Camera::default() };
    assert!(bar.draw(&scene, &perspective, &style(400, 400)).is_err());
    let nothing = shrouds::TriMesh::default();
    let empty = bar.draw(&Scene::new(&nothing), &front(), &style(400, 300)).unwrap();
    assert!(empty.pixels().iter().all(|part| *part == 255));
}

#[test]
fn a_sphere_of_known_curvature_has_its_colour_everywhere() {
    let mesh = shapes::sphere(32);
    let scale = ColourScale::new(-2.0, 2.0, 0.0).unwrap();
    for radius in [0.75f64, 1.0, 4.0] {
        let colours = vec![scale.colour(radius.recip()); mesh.vertices.len()];
        let scene = Scene::new(&mesh).colours(Colours::PerVertex(&colours));
        let lit = Style { diffuse: 0.0, ..style(200, 200) };
        let picture = Picture::draw(&scene, &front(), &lit).unwrap();
        let expected = scale.colour(radius.recip());
        assert!(picture.pixels().as_chunks().0.iter().all(|&p| p == WHITE || p == expected));
        assert_eq!(picture.pixel(100, 100), Some(expected));
    }
}
