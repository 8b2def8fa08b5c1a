//! Pictures of triangle meshes, drawn in software by a small z-buffer rasteriser.
//!
//! In: a [`TriMesh`](shrouds::TriMesh), optional [`Colours`] and [`LineSet`]s, a [`Camera`] and a
//! [`Style`]. Out: a [`Picture`] of 8-bit RGB pixels, the same bytes on every run, and its PNG file.
//!
//! The look is that of the paper (remark 1): constant shading per triangle, ambient and diffuse
//! light only, since that shows the geometry of a mesh best. The light comes from the viewer's upper
//! left. Faces seen from their inner side have a darker colour of their own, so that an open border
//! or an inside-out mesh is noticed. [`ColourScale`] turns numbers into colours; a [`Figure`] has a
//! [`Legend`] of them, a scale bar and a caption beside the picture; [`Picture::sheet`] puts several
//! pictures on a contact sheet.
//!
//! With the feature `server` there is the test bed, too: `server` serves a page that draws in a browser.
//!
//! Images and their polygons, the method in two dimensions, are drawn as SVG by [`Plan`].
//!
//! ```
//! use shrouds::TriMesh;
//! use shrouds_view::{Camera, LineSet, Picture, Scene, Style, View};
//!
//! let mesh = TriMesh {
//!     vertices: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
//!     triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
//!     normals: vec![],
//! };
//! let edge = LineSet::new(vec![[[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]], [200, 30, 30]);
//!
//! let scene = Scene::new(&mesh).lines(&edge);
//! let camera = Camera::default().view(View::Isometric);
//! let style = Style { width: 320, height: 240, ..Style::default() };
//! let picture = Picture::draw(&scene, &camera, &style)?;
//! let mut file = Vec::new();
//! picture.write_png(&mut file)?;
//! # Ok::<(), shrouds_view::Error>(())
//! ```

mod error;
mod vector;
mod scene;
mod camera;
mod lens;
mod shade;
mod raster;
mod line;
mod paint;
mod picture;
mod text;
mod scale;
mod legend;
mod figure;
mod sheet;
mod plan;
#[cfg(feature = "server")]
pub mod server;

pub use camera::{Axis, Camera, Projection, View};
pub use error::Error;
pub use figure::Figure;
pub use legend::Legend;
pub use picture::Picture;
pub use plan::Plan;
pub use scale::ColourScale;
pub use scene::{Colours, LineSet, Scene};
pub use shade::{Shading, Style};
pub use sheet::Cell;
