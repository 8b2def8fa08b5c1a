//! Numbers at the vertices of a mesh as colours, with their legend.

use shrouds::measure::{Curvature, curvatures, mesh_curvatures};
use shrouds::network::Network;
use shrouds::{Grid, Shroud, TriMesh};
use shrouds_io::Frame;
use shrouds_view::{ColourScale, Legend};

use crate::args::Field;
use crate::failure::Failure;

/// The share of the vertices that have colours of their own if no range is asked for.
const SHOWN: f64 = 0.95;

/// Numbers at the vertices of a mesh.
pub(crate) struct Numbers {
    field: Field,
    values: Vec<f64>,
    unit: String,
}

/// What a unit of length is called.
pub(crate) struct Unit(String);

impl Unit {
    /// That of a volume: of its frame, or else voxels where these have unit spacing.
    pub(crate) fn of_volume(frame: &Frame, grid: &Grid) -> Self {
        Self(match frame.unit.as_str() {
            "um" => "µm".into(),
            "unknown" if grid.spacing() == [1.0; 3] => "voxel".into(),
            "unknown" => "unit".into(),
            unit => unit.into(),
        })
    }

    /// That of a mesh file, which does not tell.
    pub(crate) fn unknown() -> Self {
        Self("unit".into())
    }

    /// After 1, and after other numbers.
    pub(crate) fn counted(&self) -> [String; 2] {
        let several = match self.0.as_str() {
            word @ ("voxel" | "unit") => format!("{word}s"),
            symbol => symbol.into(),
        };
        [self.0.clone(), several]
    }
}

impl Numbers {
    /// Places of the vertices of a primal mesh on their grid edges.
    pub(crate) fn deltas(delta: &[f64]) -> Self {
        Self { field: Field::Delta, values: delta.to_vec(), unit: "of grid edge".into() }
    }

    /// How far vertices are from the middles of their grid edges, outwards.
    pub(crate) fn displacements(values: Vec<f64>, unit: &Unit) -> Self {
        // Positive and negative, as curvatures are: they share the range.
        Self { field: Field::MeanCurvature, values, unit: unit.0.clone() }
    }

    /// One for each vertex.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values
    }

    /// Of the numbers.
    pub(crate) fn unit(&self) -> &str {
        &self.unit
    }

    /// Curvatures at the vertices of a shroud with a primal mesh, from its network.
    pub(crate) fn of_primal(field: Field, shroud: &Shroud, unit: &Unit) -> Self {
        let network = Network::trace(&shroud.surface);
        let found = curvatures(&network, &shroud.mesh.vertices, &shroud.mesh.normals);
        Self::of(field, found, unit)
    }

    /// Curvatures at the vertices of any mesh.
    pub(crate) fn of_mesh(field: Field, mesh: &TriMesh, unit: &Unit) -> Result<Self, Failure> {
        Ok(Self::of(field, mesh_curvatures(mesh)?, unit))
    }

    fn of(field: Field, curvatures: Vec<Curvature>, unit: &Unit) -> Self {
        let number: fn(Curvature) -> f64 = match field {
            Field::GaussianCurvature => Curvature::gaussian,
            Field::MaximumCurvature => |curvature| curvature.principal[0],
            Field::MinimumCurvature => |curvature| curvature.principal[1],
            Field::MeanCurvature | Field::Delta => Curvature::mean,
        };
        let square = if field == Field::GaussianCurvature { "²" } else { "" };
        let values = curvatures.into_iter().map(number).collect();
        Self { field, values, unit: format!("1/{}{square}", unit.0) }
    }

    /// The colours of a range, or of what suits the numbers.
    pub(crate) fn scale(&self, range: Option<[f64; 2]>) -> Result<ColourScale, Failure> {
        let centre = if self.field == Field::Delta { 0.5 } else { 0.0 };
        let [low, high] = range.unwrap_or_else(|| self.usual_range());
        Ok(ColourScale::new(low, high, centre)?)
    }

    /// The colour of every vertex and what the colours mean, for a range or what suits the numbers.
    pub(crate) fn coloured(
        &self,
        range: Option<[f64; 2]>,
    ) -> Result<(Vec<[u8; 3]>, Legend), Failure> {
        let scale = self.scale(range)?;
        let [low, high] = scale.range();
        let colours = self.values.iter().map(|&value| scale.colour(value)).collect();
        let beyond = [
            self.values.iter().any(|value| *value < low),
            self.values.iter().any(|value| *value > high),
        ];
        let title = match self.field {
            Field::MeanCurvature => "mean curvature",
            Field::GaussianCurvature => "Gaussian curvature",
            Field::MaximumCurvature => "maximum curvature",
            Field::MinimumCurvature => "minimum curvature",
            Field::Delta => "delta",
        };
        Ok((colours, Legend { title: title.into(), unit: self.unit.clone(), scale, beyond }))
    }

    fn usual_range(&self) -> [f64; 2] {
        if self.field == Field::Delta {
            return [0.0, 1.0];
        }
        let mut sizes: Vec<f64> = self.values.iter().map(|value| value.abs()).collect();
        sizes.sort_unstable_by(f64::total_cmp);
        let last = sizes.len().saturating_sub(1);
        let reach = sizes.get((SHOWN * last as f64).round() as usize).copied().unwrap_or(0.0);
        // Two digits, so that the ends of the legend can be read.
        let step = 10f64.powf(reach.log10().floor() - 1.0);
        let reach = if reach > 0.0 && step > 0.0 { (reach / step).ceil() * step } else { 1.0 };
        [-reach, reach]
    }
}
