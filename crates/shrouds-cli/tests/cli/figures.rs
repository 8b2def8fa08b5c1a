//! `shrouds render` with numbers as colours, contours, scale bar and caption.

use shrouds::{Grid, Occupancy};

use crate::common::Folder;

/// A ball of radius 10 and its mesh.
fn with_ball() -> Folder {
    let folder = Folder::new();
    let ball = Occupancy::from_fn(Grid::new([26; 3], [1.0; 3]).unwrap(), |index| {
        index.iter().map(|&x| (x as f64 - 12.3).powi(2)).sum::<f64>() < 100.0
    });
    folder.volume("ball.npy", &ball);
    folder.succeed("mesh ball.npy -o ball.ply --quiet");
    folder
}

/// Width, height and the pixels of a PNG file.
fn pixels(folder: &Folder, name: &str) -> (usize, usize, Vec<[u8; 3]>) {
    let bytes = folder.bytes(name);
    let decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    let mut reader = decoder.read_info().unwrap();
    let mut data = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut data).unwrap();
    let pixels = data.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    (info.width as usize, info.height as usize, pixels)
}

/// The mean colour of the middle of the picture of the scene, `column` pixels being the legend's.
fn middle(folder: &Folder, name: &str, column: usize) -> [f64; 3] {
    let (width, height, pixels) = pixels(folder, name);
    let (x, y) = ((width - column) / 2, height / 2);
    let mut sum = [0.0; 3];
    for (dx, dy) in (0..21).flat_map(|dy| (0..21).map(move |dx| (dx, dy))) {
        let pixel = pixels[(y + dy - 10) * width + x + dx - 10];
        sum = std::array::from_fn(|i| sum[i] + f64::from(pixel[i]) / 441.0);
    }
    sum
}

#[test]
fn a_ball_is_coloured_by_its_curvature() {
    let folder = with_ball();
    let size = "--width 480 --height 360";
    for input in ["ball.npy", "ball.ply", "ball.npy --surface dual"] {
        for (field, truth) in [
            ("mean-curvature", 0.1),
            ("maximum-curvature", 0.1),
            ("minimum-curvature", 0.1),
            ("gaussian-curvature", 0.01),
        ] {
            // The same number in the middle of the scale and at both ends.
            let at = |low: f64, high: f64| {
                let range = format!("--range {},{}", low * truth, high * truth);
                folder.succeed(&format!(
                    "render {input} -o out.png {size} --colour {field} {range} --quiet"
                ));
                middle(&folder, "out.png", 150)
            };
            let [red, _, blue] = at(-1.5, 1.5);
            assert!(red > blue + 60.0, "{input} {field}: {red} {blue} is not orange");
            let [red, green, blue] = at(-100.0, 100.0);
            assert!((red - blue).abs() < 25.0 && (red - green).abs() < 20.0, "{input} {field}");
        }
    }
    // A cavity is the same the other way round.
    let hollow = Occupancy::from_fn(Grid::new([26; 3], [1.0; 3]).unwrap(), |index| {
        index[0] > 12 && index.iter().map(|&x| (x as f64 - 12.3).powi(2)).sum::<f64>() > 100.0
    });
    folder.volume("bowl.npy", &hollow);
    folder.succeed(&format!(
        "render bowl.npy -o bowl.png {size} --colour mean-curvature --range -0.15,0.15 --azimuth 180 --elevation 0 \
         --quiet"
    ));
    let [red, _, blue] = middle(&folder, "bowl.png", 150);
    assert!(blue > red + 60.0, "{red} {blue} is not blue");
}

#[test]
fn displacements_have_colours_and_a_legend() {
    let folder = with_ball();
    folder.succeed("render ball.npy -o delta.png --width 480 --height 360 --colour delta --quiet");
    folder.succeed("render ball.npy -o plain.png --width 480 --height 360 --quiet");
    let (width, height, delta) = pixels(&folder, "delta.png");
    assert_eq!((width, height), (480, 360));
    let strongly = |pixels: &[[u8; 3]]| {
        // Without the legend.
        let scene: Vec<[u8; 3]> =
            pixels.chunks_exact(480).flat_map(|row| row[..320].to_vec()).collect();
        let is_blue = |p: &&[u8; 3]| p[2] > p[0].saturating_add(40);
        let is_orange = |p: &&[u8; 3]| p[0] > p[2].saturating_add(60);
        [scene.iter().filter(is_blue).count(), scene.iter().filter(is_orange).count()]
    };
    let [blue, orange] = strongly(&delta);
    assert!(blue > 2000 && orange > 2000, "{blue} {orange}");
    assert_eq!(strongly(&pixels(&folder, "plain.png").2)[0], 0);
}

#[test]
fn contours_bars_and_captions_change_what_they_should() {
    let folder = with_ball();
    let draw = |name: &str, options: &str| {
        folder.succeed(&format!("render {options} -o {name} --width 480 --height 360 --quiet"));
        pixels(&folder, name).2
    };
    let dark = |pixels: &[[u8; 3]]| pixels.iter().filter(|p| p.iter().all(|x| *x < 90)).count();
    let plain = draw("plain.png", "ball.ply");
    assert_eq!(dark(&plain), 0);
    let counts = ["z:10", "z:2", "z:2,x:2"]
        .map(|contours| dark(&draw("contours.png", &format!("ball.ply --contours {contours}"))));
    assert!(counts[0] > 200 && counts[1] > 3 * counts[0] && counts[2] > counts[1], "{counts:?}");
    let lattice = draw("k.png", "ball.npy --contours k:2");
    assert!(dark(&lattice) > 3 * counts[0]);
    // The strip below is 40 pixels high.
    let strip = |pixels: &[[u8; 3]]| dark(&pixels[320 * 480..]);
    assert!(strip(&draw("bar.png", "ball.npy --scale-bar")) > 100);
    assert_eq!(strip(&plain), 0);
    let captioned = draw("caption.png", "ball.npy --caption");
    let ink = captioned[320 * 480..].iter().filter(|p| p[0] < 160).count();
    assert!(ink > 500, "{ink}");
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let folder = with_ball();
    let refuse = |options: &str, parts: &[&str]| {
        folder.refuse(&format!("render {options} -o out.png"), 2, parts);
    };
    refuse("ball.ply --colour delta", &["--colour delta", "volume"]);
    refuse("ball.npy --colour delta --surface dual", &["--colour delta", "dual"]);
    refuse("ball.npy --range 0,1", &["--range", "--colour"]);
    refuse("ball.ply --contours k:1", &["axis k", "volume"]);
    refuse("ball.ply --contours z:1e-9", &["planes"]);
    refuse("ball.npy --colour mean-curvature --width 100", &["width", "legend"]);
    refuse("ball.npy --colour mean-curvature --height 150", &["height", "legend"]);
    for option in
        ["--range 1,0", "--contours z:0", "--colour curvature", "--scale-bar --perspective"]
    {
        let done = folder.run(&format!("render ball.ply -o out.png {option}"));
        let named = option.split(' ').next().unwrap();
        assert!(done.code == 2 && done.err.contains(named), "{option}: {}", done.err);
    }
    assert_eq!(folder.names(), ["ball.npy", "ball.ply"]);
}
