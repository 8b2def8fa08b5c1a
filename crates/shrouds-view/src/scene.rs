//! What is drawn: one mesh, its colours, and lines on it.

use shrouds::TriMesh;

use crate::error::{Error, require};
use crate::vector::{Vector, is_finite};

/// Colours of the outer side of the surface: sRGB, 8 bits each of red, green, blue.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Colours<'a> {
    /// The same everywhere.
    One([u8; 3]),
    /// One per vertex, blended across triangles.
    PerVertex(&'a [[u8; 3]]),
    /// One per triangle.
    PerTriangle(&'a [[u8; 3]]),
}

/// Straight segments of one colour, for instance the curves of a network or contours.
#[derive(Debug, Clone, PartialEq)]
pub struct LineSet {
    /// Both ends of every segment, `S × 2 × 3`, in the world coordinates of the mesh.
    pub segments: Vec<[[f64; 3]; 2]>,
    /// sRGB red, green, blue; lines are not shaded.
    pub colour: [u8; 3],
    /// Width in pixels of the finished picture.
    pub width: f32,
}

impl LineSet {
    /// Lines of the usual width, 1.5 pixels.
    pub fn new(segments: Vec<[[f64; 3]; 2]>, colour: [u8; 3]) -> Self {
        Self { segments, colour, width: 1.5 }
    }
}

/// A mesh and the lines that lie on it.
#[derive(Debug, Clone)]
pub struct Scene<'a> {
    pub(crate) mesh: &'a TriMesh,
    pub(crate) colours: Colours<'a>,
    pub(crate) lines: Vec<&'a LineSet>,
}

impl<'a> Scene<'a> {
    /// A mesh in the usual sand colour, without lines. Nothing is copied.
    pub fn new(mesh: &'a TriMesh) -> Self {
        Self { mesh, colours: Colours::One([222, 184, 128]), lines: Vec::new() }
    }

    /// The same scene with other colours on the outer side of the surface.
    #[must_use]
    pub fn colours(mut self, colours: Colours<'a>) -> Self {
        self.colours = colours;
        self
    }

    /// The same scene with one more set of lines. Lines are hidden by what lies in front of them and
    /// win against the surface they lie on; of two lines at one place the later set wins.
    #[must_use]
    pub fn lines(mut self, lines: &'a LineSet) -> Self {
        self.lines.push(lines);
        self
    }

    /// The corners of a triangle in world coordinates.
    pub(crate) fn corners(&self, triangle: [u32; 3]) -> [Vector; 3] {
        triangle.map(|vertex| self.mesh.vertices[vertex as usize])
    }

    /// Every point that is drawn: corners of triangles (vertices come up once for each of their
    /// triangles, unused vertices never) and ends of segments.
    pub(crate) fn points(&self) -> impl Iterator<Item = Vector> + '_ {
        let corners = self.mesh.triangles.iter().flat_map(|&triangle| self.corners(triangle));
        let ends = self.lines.iter().flat_map(|set| set.segments.iter().flatten().copied());
        corners.chain(ends)
    }

    /// Whether every index, number and length is usable.
    pub(crate) fn check(&self) -> Result<(), Error> {
        let mesh = self.mesh;
        let vertices = mesh.vertices.len();
        finite("vertex", &mesh.vertices)?;
        for (triangle, corners) in mesh.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= vertices) {
                return Err(Error::Index { triangle, vertex, vertices });
            }
        }
        let (what, given, needed) = match self.colours {
            Colours::One(_) => ("colours", 0, 0),
            Colours::PerVertex(colours) => ("colours per vertex", colours.len(), vertices),
            Colours::PerTriangle(colours) => {
                ("colours per triangle", colours.len(), mesh.triangles.len())
            }
        };
        if given != needed {
            return Err(Error::Length { what, given, needed });
        }
        for set in &self.lines {
            finite("end of line", set.segments.as_flattened())?;
            let fits = set.width > 0.0 && set.width <= 100.0;
            require(fits, "the line width", set.width, "above 0 and at most 100 pixels")?;
        }
        Ok(())
    }
}

/// Whether all the vectors are finite.
pub(crate) fn finite(what: &'static str, vectors: &[Vector]) -> Result<(), Error> {
    match vectors.iter().position(|&value| !is_finite(value)) {
        Some(index) => Err(Error::NotFinite { what, index, value: vectors[index] }),
        None => Ok(()),
    }
}
