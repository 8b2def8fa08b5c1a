//! Pictures against formulas: areas, brightness, what hides what.

mod shapes;

use std::f64::consts::{PI, TAU};

use shrouds::TriMesh;
use shrouds_view::{
    Axis, Camera, Cell, Colours, Error, LineSet, Picture, Projection, Scene, Shading, Style, View,
};

const BLACK: [u8; 3] = [0; 3];
const WHITE: [u8; 3] = [255; 3];
const SAND: [u8; 3] = [222, 184, 128];

/// A small picture without anti-aliasing on black.
fn plain(width: u32, height: u32) -> Style {
    Style { width, height, samples: 1, background: BLACK, ..Style::default() }
}

fn top() -> Camera {
    Camera::default().view(View::Top)
}

fn draw(scene: &Scene, camera: &Camera, style: &Style) -> Picture {
    Picture::draw(scene, camera, style).expect("the scene can be drawn")
}

fn count(picture: &Picture, counts: impl Fn([u8; 3]) -> bool) -> usize {
    picture.pixels().as_chunks().0.iter().filter(|&&pixel| counts(pixel)).count()
}

/// An sRGB byte under a brightness, from the standard's formulas.
fn dimmed(byte: u8, brightness: f64) -> f64 {
    let s = f64::from(byte) / 255.0;
    let linear = if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
    let light = linear * brightness;
    let s = if light <= 0.0031308 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
    s * 255.0
}

/// The brightness of a unit normal in view coordinates.
fn brightness(style: &Style, normal: [f64; 3]) -> f64 {
    let l = style.light;
    let length = (l[0] * l[0] + l[1] * l[1] + l[2] * l[2]).sqrt();
    let cosine = (normal[0] * l[0] + normal[1] * l[1] + normal[2] * l[2]) / length;
    style.ambient + style.diffuse * cosine.max(0.0)
}

#[track_caller]
fn assert_close(pixel: Option<[u8; 3]>, colour: [f64; 3], tolerance: f64) {
    let pixel = pixel.expect("the pixel is in the picture");
    let close = (0..3).all(|i| (f64::from(pixel[i]) - colour[i]).abs() <= tolerance);
    assert!(close, "{pixel:?} is not {colour:?}");
}

/// A square in the plane z = `height`, counter-clockwise seen from above.
fn square(half: f64, height: f64) -> TriMesh {
    TriMesh {
        vertices: vec![
            [-half, -half, height],
            [half, -half, height],
            [half, half, height],
            [-half, half, height],
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: vec![],
    }
}

#[test]
fn a_sphere_covers_its_disc() {
    let (n, side) = (64, 800.0);
    let style = Style { ambient: 1.0, diffuse: 0.0, ..plain(800, 800) };
    let ball = shapes::sphere(n);
    let covered =
        |camera: &Camera| count(&draw(&Scene::new(&ball), camera, &style), |p| p != BLACK) as f64;
    let radius = side * (0.5 - style.margin);
    // A convex region holds its area's worth of lattice points but for half its perimeter and one.
    let slack = PI * radius + 1.0;
    // Seen along the axis the outline is the equator, a regular polygon.
    let polygon = n as f64 / 2.0 * (TAU / n as f64).sin() * radius * radius;
    assert!((covered(&top()) - polygon).abs() <= slack);
    // From elsewhere it lies between the disc and that of a sphere inside all triangles, and fitting
    // can magnify the one to the other.
    let inner = (PI / n as f64).cos().powi(2);
    let disc = PI * radius * radius;
    for azimuth in [10.0, 77.0] {
        let area = covered(&Camera { azimuth, elevation: 33.0, ..Camera::default() });
        assert!(area <= disc / inner.powi(2) + slack && area >= disc * inner.powi(2) - slack);
    }
}

#[test]
fn a_cube_seen_along_an_axis_is_a_square_of_the_predicted_colour() {
    let cube = shapes::cube();
    let style = plain(200, 100);
    let shine = brightness(&style, [0.0, 0.0, 1.0]);
    let expected = SAND.map(|part| dimmed(part, shine));
    for view in [View::Front, View::Back, View::Left, View::Right, View::Top, View::Bottom] {
        let picture = draw(&Scene::new(&cube), &Camera::default().view(view), &style);
        // The margin is 5 of 100 pixels, so the square is 90 wide.
        let colour = picture.pixel(100, 50).unwrap();
        assert_eq!(count(&picture, |p| p == colour), 90 * 90);
        assert_eq!(count(&picture, |p| p == BLACK), 200 * 100 - 90 * 90);
        assert_close(Some(colour), expected, 1.0);
        assert_eq!(picture.pixel(55, 5), Some(colour));
        assert_eq!(picture.pixel(54, 5), Some(BLACK));
        assert_eq!(picture.pixel(144, 94), Some(colour));
    }
}

#[test]
fn the_light_comes_from_the_upper_left() {
    let ball = shapes::sphere(64);
    let style = plain(200, 200);
    let picture = draw(&Scene::new(&ball), &Camera::default(), &style);
    let at = |x, y| picture.pixel(x, y).unwrap()[0];
    assert!(at(60, 60) > at(140, 60) && at(60, 60) > at(60, 140));
    assert!(at(140, 140) < at(140, 60) && at(140, 140) < at(60, 140));
}

#[test]
fn an_inside_out_mesh_has_the_back_colour() {
    let mut cube = shapes::cube();
    for triangle in &mut cube.triangles {
        triangle.swap(0, 1);
    }
    let style = plain(60, 60);
    let shine = brightness(&style, [0.0, 0.0, 1.0]);
    for projection in [Projection::Orthographic, Projection::Perspective { angle: 50.0 }] {
        let picture = draw(&Scene::new(&cube), &Camera { projection, ..top() }, &style);
        assert_close(picture.pixel(30, 30), style.back.map(|part| dimmed(part, shine)), 1.0);
    }
}

#[test]
fn the_nearer_triangle_hides_the_other() {
    let (low, high) = (square(1.0, 0.0), square(0.5, 0.7));
    let colours = [[[250, 0, 0]; 2], [[0, 250, 0]; 2]];
    for flip in [false, true] {
        for projection in [Projection::Orthographic, Projection::Perspective { angle: 50.0 }] {
            let mut both = if flip { high.clone() } else { low.clone() };
            shapes::append(&mut both, if flip { &low } else { &high });
            let mut colours = colours;
            if flip {
                colours.reverse();
            }
            let scene = Scene::new(&both).colours(Colours::PerTriangle(colours.as_flattened()));
            let picture = draw(&scene, &Camera { projection, ..top() }, &plain(100, 100));
            let [red, green, _] = picture.pixel(50, 50).unwrap();
            assert!(red == 0 && green > 0);
            let [red, green, _] = picture.pixel(10, 10).unwrap();
            assert!(red > 0 && green == 0);
            // Half as wide, or more where nearness magnifies.
            let share =
                count(&picture, |p| p[1] > 0) as f64 / count(&picture, |p| p != BLACK) as f64;
            match projection {
                Projection::Orthographic => assert!((share - 0.25).abs() < 0.02, "{share}"),
                Projection::Perspective { .. } => assert!(share > 0.35, "{share}"),
            }
        }
    }
}

#[test]
fn a_line_behind_the_surface_is_hidden_and_one_in_front_is_seen() {
    let sheet = square(1.0, 0.0);
    for projection in [Projection::Orthographic, Projection::Perspective { angle: 50.0 }] {
        for (height, seen) in [(-0.2, false), (0.0, true), (0.2, true)] {
            let ends = [[-0.8, 0.1, height], [0.8, 0.1, height]];
            let line = LineSet { segments: vec![ends], colour: WHITE, width: 3.0 };
            let camera = Camera { projection, ..top() };
            let picture = draw(&Scene::new(&sheet).lines(&line), &camera, &plain(300, 300));
            let white = count(&picture, |p| p == WHITE);
            // 216 pixels long and 3 wide, with round ends: more where nearness magnifies.
            if seen {
                assert!((640..900).contains(&white), "{white}");
            } else {
                assert_eq!(white, 0);
            }
        }
    }
}

#[test]
fn a_line_on_a_slope_keeps_its_width() {
    // Turned by 45 degrees about x, then seen from above.
    let slope = shapes::moved(&square(1.0, 0.0), |[x, y, _]| [x, y, y]);
    for ends in [[[-0.8, 0.3, 0.3], [0.8, 0.3, 0.3]], [[-0.5, -0.8, -0.8], [0.7, 0.8, 0.8]]] {
        let line = LineSet { segments: vec![ends], colour: WHITE, width: 4.0 };
        let alone = TriMesh { triangles: vec![], ..slope.clone() };
        let frame = Some([[-1.0; 3], [1.0; 3]]);
        let white = [&slope, &alone].map(|mesh| {
            let camera = Camera { frame, ..top() };
            count(&draw(&Scene::new(mesh).lines(&line), &camera, &plain(300, 300)), |p| p == WHITE)
        });
        assert!(white[1] > 800 && white[0] == white[1], "{white:?}");
    }
}

#[test]
fn the_scene_fits_the_frame() {
    let tori = shapes::linked_tori(24);
    let style = plain(300, 200);
    for projection in [Projection::Orthographic, Projection::Perspective { angle: 60.0 }] {
        for (up, azimuth) in [(Axis::X, 20.0), (Axis::Y, 140.0), (Axis::Z, -100.0)] {
            let camera = Camera { up, azimuth, elevation: -20.0, projection, ..Camera::default() };
            let picture = draw(&Scene::new(&tori), &camera, &style);
            let drawn = |x, y| picture.pixel(x, y).unwrap() != BLACK;
            let columns: Vec<u32> = (0..300).filter(|&x| (0..200).any(|y| drawn(x, y))).collect();
            let rows: Vec<u32> = (0..200).filter(|&y| (0..300).any(|x| drawn(x, y))).collect();
            let free = [columns[0], 299 - columns[columns.len() - 1]];
            let free_y = [rows[0], 199 - rows[rows.len() - 1]];
            assert!(free[0].abs_diff(free[1]) <= 1 && free_y[0].abs_diff(free_y[1]) <= 1);
            // 5 % of the shorter side; a rounding of the sharpest tips may cost a pixel.
            let least = free[0].min(free_y[0]);
            assert!((10..=11).contains(&least), "{free:?} {free_y:?}");
        }
    }
}

#[test]
fn a_given_frame_keeps_the_scale() {
    let style = plain(200, 200);
    let frame = Some([[-2.0, -2.0, -2.0], [2.0, 2.0, 2.0]]);
    let camera = Camera { frame, ..top() };
    for half in [0.5, 1.0] {
        let picture = draw(&Scene::new(&square(half, 0.0)), &camera, &style);
        // 180 pixels for 4 units.
        assert_eq!(count(&picture, |p| p != BLACK), (90.0 * half).powi(2) as usize);
    }
    let zoomed = Camera { zoom: 2.0, ..camera };
    let picture = draw(&Scene::new(&square(0.5, 0.0)), &zoomed, &style);
    assert_eq!(count(&picture, |p| p != BLACK), 90 * 90);
    let lost = Camera { frame: Some([[0.0; 3], [1e-5; 3]]), ..top() };
    let far = Picture::draw(&Scene::new(&square(1.0, 0.0)), &lost, &style);
    assert!(matches!(far, Err(Error::TooClose)));
}

#[test]
fn samples_are_averaged_in_linear_light() {
    // With 2 × 2 samples and no margin, a triangle below the diagonal covers 3 of 4 samples (or 1,
    // as the shared edge falls) of each pixel that it cuts.
    let mut half = square(1.0, 0.0);
    half.triangles.truncate(1);
    let style = Style { samples: 2, margin: 0.0, ambient: 1.0, diffuse: 0.0, ..plain(40, 40) };
    let picture = draw(&Scene::new(&half).colours(Colours::One(WHITE)), &top(), &style);
    let shares = [0.25, 0.5, 0.75].map(|share| dimmed(255, share));
    for i in 0..40 {
        let cut = f64::from(picture.pixel(i, 39 - i).unwrap()[0]);
        assert!(shares.iter().any(|share| (share - cut).abs() <= 1.0), "{cut}");
        assert_eq!(picture.pixel(39, i.max(1)), Some(WHITE));
    }
}

#[test]
fn vertex_colours_blend_in_linear_light() {
    let mut half = square(1.0, 0.0);
    half.triangles.truncate(1);
    let style = Style { margin: 0.0, ambient: 1.0, diffuse: 0.0, ..plain(301, 301) };
    let colours = [[255, 0, 0], [0, 255, 0], [0, 0, 255], WHITE];
    for projection in [Projection::Orthographic, Projection::Perspective { angle: 50.0 }] {
        let scene = Scene::new(&half).colours(Colours::PerVertex(&colours));
        let picture = draw(&scene, &Camera { projection, ..top() }, &style);
        // The centre of gravity, two thirds along and down.
        assert_close(picture.pixel(200, 200), [dimmed(255, 1.0 / 3.0); 3], 2.0);
    }
    let scene = Scene::new(&half).colours(Colours::PerVertex(&colours[..3]));
    let short = Picture::draw(&scene, &top(), &style);
    assert!(matches!(short, Err(Error::Length { given: 3, needed: 4, .. })));
}

#[test]
fn smooth_shading_follows_the_normals() {
    let mut ball = shapes::sphere(128);
    let style = Style { shading: Shading::Smooth, ..plain(201, 201) };
    for known in [false, true] {
        let radii = ball.vertices.iter().map(|p| p.map(|x| x as f32));
        ball.normals = if known { radii.collect() } else { vec![] };
        let picture = draw(&Scene::new(&ball), &top(), &style);
        for (x, y) in [(100, 100), (60, 60), (130, 90), (100, 170), (40, 100)] {
            let radius = 201.0 * 0.45;
            let [u, v] = [(f64::from(x) + 0.5) / radius, (f64::from(y) + 0.5) / radius];
            let [u, v] = [u - 0.5 / 0.45, 0.5 / 0.45 - v];
            let normal = [u, v, (1.0 - u * u - v * v).sqrt()];
            let expected = SAND.map(|part| dimmed(part, brightness(&style, normal)));
            assert_close(picture.pixel(x, y), expected, 1.5);
        }
    }
    ball.normals.pop();
    let short = Picture::draw(&Scene::new(&ball), &top(), &style);
    assert!(matches!(short, Err(Error::Length { .. })));
    ball.normals.push([f32::NAN; 3]);
    let broken = Picture::draw(&Scene::new(&ball), &top(), &style);
    assert!(matches!(broken, Err(Error::NotFinite { what: "normal", .. })));
}

#[test]
fn units_and_offsets_do_not_matter() {
    let tori = shapes::linked_tori(16);
    let style = Style { width: 160, height: 120, ..Style::default() };
    let picture = |mesh: &TriMesh| draw(&Scene::new(mesh), &Camera::default(), &style);
    let usual = picture(&tori);
    // Powers of two change no digit.
    let scaled = |factor: f64| shapes::moved(&tori, |p| p.map(|x| x * factor));
    assert!(picture(&scaled(2f64.powi(-30))) == usual);
    assert!(picture(&scaled(2f64.powi(1000))) == usual);
    // Offsets round the coordinates: edges may move by a hair.
    for (unit, offset) in [(1e3, [1e6, -2e6, 3e6]), (1e-3, [5.0, 7.0, -9.0])] {
        let moved = shapes::moved(&tori, |p| std::array::from_fn(|i| p[i] * unit + offset[i]));
        let other = picture(&moved);
        let differing =
            other.pixels().iter().zip(usual.pixels()).filter(|(a, b)| a.abs_diff(**b) > 1);
        assert!(differing.count() < usual.pixels().len() / 500);
    }
}

#[test]
fn what_has_no_area_does_not_show() {
    let style = plain(50, 40);
    let point =
        TriMesh { vertices: vec![[4.0; 3]; 3], triangles: vec![[0, 1, 2]], normals: vec![] };
    let line = TriMesh {
        vertices: vec![[0.0; 3], [1.0, 2.0, 3.0], [0.3, 0.6, 0.9]],
        triangles: vec![[0, 1, 2], [0, 0, 1], [1, 1, 1]],
        normals: vec![],
    };
    let unused = TriMesh { triangles: vec![], ..square(1.0, 0.0) };
    for mesh in [&TriMesh::default(), &unused, &point, &line] {
        for shading in [Shading::Flat, Shading::Smooth] {
            let picture = draw(&Scene::new(mesh), &Camera::default(), &Style { shading, ..style });
            assert_eq!(count(&picture, |p| p == BLACK), 50 * 40);
        }
    }
    // A flat sheet seen edge on.
    let sheet = square(1.0, 0.0);
    let edge_on = draw(&Scene::new(&sheet), &Camera::default().view(View::Front), &style);
    assert_eq!(count(&edge_on, |p| p == BLACK), 50 * 40);
}

#[test]
fn extremes_are_drawn_or_refused_but_never_panic() {
    let one = plain(1, 1);
    let cube = shapes::cube();
    let line = LineSet::new(vec![[[-1.0; 3], [1.0; 3]], [[1.0; 3]; 2]], WHITE);
    draw(&Scene::new(&cube).lines(&line), &Camera::default(), &one);
    for size in [f64::MAX, 1e200, 1e-200, 1e-300] {
        let mesh = shapes::moved(&cube, |p| p.map(|x| x * size));
        for projection in [Projection::Orthographic, Projection::Perspective { angle: 120.0 }] {
            for shading in [Shading::Flat, Shading::Smooth] {
                let camera = Camera { projection, ..Camera::default() };
                let style = Style { shading, ..plain(30, 30) };
                let picture = draw(&Scene::new(&mesh), &camera, &style);
                assert!(count(&picture, |p| p != BLACK) > 300);
            }
        }
    }
}

#[test]
fn damaged_meshes_and_wrong_settings_are_refused() {
    let cube = shapes::cube();
    let picture = |mesh: &TriMesh, camera: Camera, style: Style| {
        Picture::draw(&Scene::new(mesh), &camera, &style).map(|_| ()).unwrap_err()
    };
    let (camera, style) = (Camera::default(), plain(20, 20));
    for bad in [f64::NAN, f64::INFINITY] {
        let mut mesh = cube.clone();
        mesh.vertices[5][1] = bad;
        let error = picture(&mesh, camera, style);
        assert!(matches!(error, Error::NotFinite { what: "vertex", index: 5, .. }));
        let line = LineSet::new(vec![[[0.0; 3], [0.0, bad, 0.0]]], WHITE);
        let error = Picture::draw(&Scene::new(&cube).lines(&line), &camera, &style);
        assert!(matches!(error, Err(Error::NotFinite { index: 1, .. })));
        let setting = |error| assert!(matches!(error, Error::Setting { .. }));
        setting(picture(&cube, Camera { azimuth: bad, ..camera }, style));
        setting(picture(&cube, Camera { elevation: bad, ..camera }, style));
        setting(picture(&cube, Camera { zoom: bad, ..camera }, style));
        setting(picture(&cube, Camera { frame: Some([[bad; 3], [1.0; 3]]), ..camera }, style));
        setting(picture(&cube, camera, Style { ambient: bad, ..style }));
        setting(picture(&cube, camera, Style { light: [bad, 0.0, 0.0], ..style }));
        setting(picture(&cube, camera, Style { margin: bad, ..style }));
        let projection = Projection::Perspective { angle: bad };
        setting(picture(&cube, Camera { projection, ..camera }, style));
    }
    let mut mesh = cube.clone();
    mesh.triangles[3][2] = 8;
    let error = picture(&mesh, camera, style);
    assert!(matches!(error, Error::Index { triangle: 3, vertex: 8, vertices: 8 }));
    for (width, height) in [(0, 5), (5, 0), (Style::MAX_SIDE + 1, 5), (5, u32::MAX)] {
        let error = picture(&cube, camera, Style { width, height, ..style });
        assert!(matches!(error, Error::Size { .. }));
        assert!(error.to_string().contains("between 1 and 32768"));
    }
    assert!(matches!(picture(&cube, camera, Style { samples: 0, ..style }), Error::Setting { .. }));
}

#[test]
fn the_same_bytes_every_time_and_png_brings_the_pixels_back() {
    let tori = shapes::linked_tori(16);
    let lines = LineSet::new(shapes::slices(&tori, 2, 0.2), [20, 60, 170]);
    let scene = Scene::new(&tori).lines(&lines);
    let style = Style { width: 161, height: 99, ..Style::default() };
    let files = [(); 2].map(|()| {
        let mut file = Vec::new();
        draw(&scene, &Camera::default(), &style).write_png(&mut file).unwrap();
        file
    });
    assert!(files[0] == files[1]);

    let picture = draw(&scene, &Camera::default(), &style);
    let mut reader = png::Decoder::new(std::io::Cursor::new(&files[0])).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (161, 99));
    assert_eq!((info.color_type, info.bit_depth), (png::ColorType::Rgb, png::BitDepth::Eight));
    assert!(pixels == picture.pixels());
    assert_eq!(picture.pixels().len(), 161 * 99 * 3);
    assert_eq!(picture.pixel(161, 0), None);
}

#[test]
fn a_contact_sheet_has_every_picture_and_caption() {
    let colours = [[200, 0, 0], [0, 200, 0], [0, 0, 200]];
    let cells: Vec<Cell> = colours
        .iter()
        .map(|&background| {
            let style = Style { background, ..plain(150, 60) };
            let picture = draw(&Scene::new(&TriMesh::default()), &Camera::default(), &style);
            Cell { picture, title: "bending".into(), note: "+1.2 %".into() }
        })
        .collect();
    let paper = [250, 250, 240];
    let sheet = Picture::sheet(&cells, 2, paper).expect("it is small");
    for colour in colours {
        assert_eq!(count(&sheet, |pixel| pixel == colour), 150 * 60);
    }
    let place = |colour| {
        let pixels = sheet.pixels().as_chunks().0;
        let first = pixels.iter().position(|&pixel: &[u8; 3]| pixel == colour).unwrap() as u32;
        [first % sheet.width(), first / sheet.width()]
    };
    let [first, second, third] = colours.map(place);
    assert_eq!((first[1], first[0]), (second[1], third[0]));
    assert!(second[0] > first[0] + 150 && third[1] > first[1] + 60);
    // Each caption is written below its picture; the fourth place is empty.
    let ink = |[x, y]: [u32; 2]| {
        let marks = |(x, y)| sheet.pixel(x, y).is_some_and(|p| p != paper);
        let below =
            (y + 60..third[1] - first[1] + y - 10).flat_map(|y| (x..x + 150).map(move |x| (x, y)));
        below.filter(|&at| marks(at)).count()
    };
    assert!(ink(first) > 300 && ink(first) == ink(second) && ink(first) == ink(third));
    assert_eq!(ink([second[0], third[1]]), 0);

    let size = |sheet: Result<Picture, Error>| assert!(matches!(sheet, Err(Error::Size { .. })));
    size(Picture::sheet(&[], 2, paper));
    size(Picture::sheet(&cells, 0, paper));
    let wide = draw(&Scene::new(&square(1.0, 0.0)), &top(), &plain(Style::MAX_SIDE, 1));
    let cell = Cell { picture: wide, ..cells[0].clone() };
    size(Picture::sheet(&[cell], 1, paper));
}
