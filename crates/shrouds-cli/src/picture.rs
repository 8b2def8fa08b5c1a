//! Pictures of meshes, with the slice curves if wanted.

use shrouds::network::Network;
use shrouds::{Shroud, TriMesh};
use shrouds_view::{Camera, Colours, Figure, LineSet, Picture, Projection, Scene, Shading, Style};

use crate::args::{AZIMUTH, ELEVATION, Paint, ViewArgs};
use crate::failure::Failure;

/// Curves across x, y, z, as the paper colours them.
const RED_WHITE_BLUE: [[u8; 3]; 3] = [[196, 30, 36], [255, 255, 255], [30, 60, 170]];

/// Why there are no curves on a dual mesh.
pub(crate) const NETWORK_ON_DUAL: &str =
    "--network cannot go with --surface dual: the slice curves do not lie on the dual mesh";

/// From where and how.
pub(crate) struct View {
    camera: Camera,
    style: Style,
    colour: Option<[u8; 3]>,
}

impl View {
    /// What looks well without being asked for.
    pub(crate) fn usual() -> Self {
        let camera = Camera { azimuth: AZIMUTH, elevation: ELEVATION, ..Camera::default() };
        Self { camera, style: Style::default(), colour: None }
    }

    /// The same side in so many pixels across and down, of what lies in a box, which fills them.
    pub(crate) fn small([width, height]: [u32; 2], frame: Option<[[f64; 3]; 2]>) -> Self {
        let usual = Self::usual();
        let camera = Camera { frame, ..usual.camera };
        Self { camera, style: Style { width, height, margin: 0.0, ..usual.style }, ..usual }
    }

    pub(crate) fn new(args: &ViewArgs, colour: Paint) -> Self {
        let projection = match args.perspective {
            Some(angle) => Projection::Perspective { angle },
            None => Projection::Orthographic,
        };
        let camera = Camera {
            azimuth: args.azimuth,
            elevation: args.elevation,
            zoom: args.zoom,
            projection,
            ..Camera::default()
        };
        let shading = if args.smooth { Shading::Smooth } else { Shading::Flat };
        let style = Style { width: args.width, height: args.height, shading, ..Style::default() };
        match colour {
            Paint::Plain(colour) => Self { camera, style, colour: Some(colour) },
            // Less shade, so that a colour looks like that of the legend.
            Paint::Field(_) => Self {
                camera,
                style: Style { ambient: 0.45, diffuse: 0.55, ..style },
                colour: None,
            },
        }
    }

    /// Draws the mesh and the lines on it.
    pub(crate) fn draw(&self, mesh: &TriMesh, lines: &[LineSet]) -> Result<Picture, Failure> {
        self.draw_figure(mesh, None, lines, &Figure::default())
    }

    /// The same with a colour for every vertex, if there are some, and all that belongs to a figure.
    pub(crate) fn draw_figure(
        &self,
        mesh: &TriMesh,
        colours: Option<&[[u8; 3]]>,
        lines: &[LineSet],
        figure: &Figure,
    ) -> Result<Picture, Failure> {
        let scene = match (colours, self.colour) {
            (Some(colours), _) => Scene::new(mesh).colours(Colours::PerVertex(colours)),
            (None, Some(colour)) => Scene::new(mesh).colours(Colours::One(colour)),
            (None, None) => Scene::new(mesh),
        };
        let scene = lines.iter().fold(scene, Scene::lines);
        Ok(figure.draw(&scene, &self.camera, &self.style)?)
    }

    /// Draws a scene in colours of its own.
    pub(crate) fn draw_scene(&self, scene: &Scene) -> Result<Picture, Failure> {
        Ok(Picture::draw(scene, &self.camera, &self.style)?)
    }
}

/// The planar curves of a shroud with a primal mesh: one set of lines for each axis.
pub(crate) fn network_lines(shroud: &Shroud) -> Vec<LineSet> {
    let mut lines: Vec<LineSet> =
        RED_WHITE_BLUE.map(|colour| LineSet::new(Vec::new(), colour)).into();
    let vertices = &shroud.mesh.vertices;
    for curve in Network::trace(&shroud.surface).curves() {
        let count = curve.vertices.len();
        let segments = if curve.closed { count } else { count.saturating_sub(1) };
        lines[curve.axis].segments.extend(
            (0..segments)
                .map(|n| [n, (n + 1) % count].map(|n| vertices[curve.vertices[n] as usize])),
        );
    }
    lines
}
