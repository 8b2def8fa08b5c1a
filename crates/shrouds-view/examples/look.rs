//! Draws a few shapes with lines on them into a folder: `cargo run --example look -- FOLDER`.

#[path = "../tests/shapes/mod.rs"]
mod shapes;

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;
use std::time::Instant;

use shrouds::TriMesh;
use shrouds_view::{Camera, Colours, LineSet, Picture, Projection, Scene, Shading, Style, View};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".into()));
    let draw = |name: &str, scene: &Scene, camera: &Camera, style: &Style| {
        let start = Instant::now();
        let picture = Picture::draw(scene, camera, style)?;
        let seconds = start.elapsed().as_secs_f64();
        println!("{name}: {seconds:.3} s");
        let file = File::create(folder.join(name).with_extension("png"))?;
        picture.write_png(BufWriter::new(file))?;
        Ok::<(), Box<dyn std::error::Error>>(())
    };
    let (camera, style) = (Camera::default(), Style::default());
    let smooth = Style { shading: Shading::Smooth, ..style };
    let wide = Camera { projection: Projection::Perspective { angle: 60.0 }, ..camera };

    let tori = shapes::linked_tori(48);
    let network = network(&tori, 0.1);
    let scene = Scene::new(&tori);
    draw("tori", &scene, &camera, &style)?;
    draw("tori-smooth", &scene, &camera, &smooth)?;
    draw("tori-perspective", &scene, &wide, &style)?;
    let lined = network.iter().fold(scene.clone(), Scene::lines);
    draw("tori-network", &lined, &camera, &style)?;
    draw("tori-top", &lined, &camera.view(View::Top), &style)?;

    let ball = shapes::sphere(64);
    let network = self::network(&ball, 0.125);
    let lined = network.iter().fold(Scene::new(&ball), Scene::lines);
    draw("sphere", &lined, &camera.view(View::Isometric), &style)?;

    let mut bowl = ball.clone();
    bowl.triangles.retain(|t| t.iter().any(|&v| ball.vertices[v as usize][2] < 0.4));
    draw("bowl", &Scene::new(&bowl), &camera, &style)?;

    let hues: Vec<[u8; 3]> =
        tori.vertices.iter().map(|p| p.map(|x| (128.0 + 50.0 * x) as u8)).collect();
    draw("hues", &Scene::new(&tori).colours(Colours::PerVertex(&hues)), &wide, &smooth)?;

    let large = shapes::linked_tori(354);
    draw("large", &Scene::new(&large), &camera, &Style { samples: 2, ..style })?;
    draw("large-fine", &Scene::new(&large), &camera, &style)
}

/// Slices across x in red, across y in white and across z in blue.
fn network(mesh: &TriMesh, step: f64) -> [LineSet; 3] {
    let colours = [[196, 30, 36], [255, 255, 255], [30, 60, 170]];
    [0, 1, 2].map(|axis| LineSet::new(shapes::slices(mesh, axis, step), colours[axis]))
}
