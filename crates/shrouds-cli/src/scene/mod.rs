//! Scenes of the sea: from a file to a scene, what is wrong being told with its line, and to pictures.

mod painter;
mod tables;

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

use shrouds::Grid;
use shrouds::containment::{
    self, Contact, Depths, Floor, Scene, Sea, SoundSpeed, Terrain, Track, Waypoint,
};
use shrouds_io::{Frame, VolumeOptions, read_volume};
use toml::Spanned;

use crate::failure::Failure;

pub(crate) use painter::{Painter, lines};
use tables::{FloorTable, GridTable, PathName, SceneTable, SeaTable, SoundTable, SpacingValue};

/// Largest scene file, in bytes.
const LARGEST: u64 = 1 << 26;
/// Speed of sound where a scene does not give it, in m/s.
const SPEED: f64 = 1500.0;

/// Scenes that come with the program: those of three figures of the paper.
pub(crate) const EXAMPLES: [&str; 3] = ["figure9", "figure10", "figure11"];

/// What a scene file tells.
pub(crate) struct Told {
    pub(crate) scene: Scene,
    /// Where the target truly is, if the file says so: its course is of no meaning.
    pub(crate) truth: Option<Track>,
}

/// A scene file, for messages about it.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

/// The world of a scene: x east, y north, z up.
pub(crate) fn frame() -> Frame {
    Frame { name: "ENU".into(), unit: "m".into(), source: "options" }
}

/// Reads a scene.
pub(crate) fn read(path: &Path) -> Result<Told, Failure> {
    let unreadable = |cause: String| {
        let advice = "give a scene file, see docs/containment.md";
        Failure::Undone(format!("{}: cannot read it ({cause}); {advice}", path.display()))
    };
    let size = fs::metadata(path).map_err(|cause| unreadable(cause.to_string()))?.len();
    if size > LARGEST {
        return Err(unreadable(format!("{size} bytes are too many")));
    }
    let text = fs::read_to_string(path).map_err(|cause| unreadable(cause.to_string()))?;
    parse(path, &text)
}

/// The scene of one of [`EXAMPLES`].
pub(crate) fn example(name: &str) -> Result<Told, Failure> {
    let text = match name {
        "figure9" => include_str!("../../../../examples/scenes/figure9.toml"),
        "figure10" => include_str!("../../../../examples/scenes/figure10.toml"),
        "figure11" => include_str!("../../../../examples/scenes/figure11.toml"),
        _ => {
            let known = EXAMPLES.join(", ");
            return Err(Failure::Call(format!("there is no scene '{name}'; there are {known}")));
        }
    };
    parse(Path::new(&format!("{name}.toml")), text)
}

/// The scene of a text that is known by a path.
fn parse(path: &Path, text: &str) -> Result<Told, Failure> {
    let source = Source { path, text };
    let table: SceneTable = toml::from_str(text)
        .map_err(|error| source.wrong(error.span().unwrap_or(0..0), error.message(), true))?;
    source.told(&table)
}

impl Source<'_> {
    fn told(&self, table: &SceneTable) -> Result<Told, Failure> {
        let grid = self.grid(&table.sea)?;
        let floor = self.floor(&table.floor, table.sea.as_ref())?;
        let sound = self.sound(table.sound.as_ref())?;
        let sea = Sea::new(grid, floor, sound).map_err(|error| self.of(&table.floor, error))?;
        let points = table.platform.iter().map(|point| {
            let point = point.as_ref();
            let course = point.course;
            Waypoint { time: point.time, position: point.position, depth: point.depth, course }
        });
        let track = Track::new(points.collect())
            .map_err(|error| self.of_number(&table.platform, "waypoint ", error))?;
        let contacts = table.contact.iter().map(|contact| {
            let contact = contact.as_ref();
            Contact {
                time: contact.time,
                bearing: contact.bearing,
                half_width: contact.half_width,
                path: match contact.path {
                    PathName::Direct => containment::Path::Direct,
                    PathName::Bounce => containment::Path::Bounce,
                    PathName::Either => containment::Path::Either,
                },
                range: contact.range,
            }
        });
        let scene = Scene::new(sea, track, contacts.collect(), table.target.as_ref().speed)
            .map_err(|error| match error.to_string().starts_with("contact ") {
                true => self.of_number(&table.contact, "contact ", error),
                false => self.of(&table.target, error),
            })?;
        Ok(Told { scene, truth: self.truth(table)? })
    }

    /// The lattice: its highest layer at the surface, its lowest at the depth or just below it.
    fn grid(&self, sea: &Spanned<SeaTable>) -> Result<Grid, Failure> {
        let SeaTable { from, to, depth, spacing } = *sea.as_ref();
        let spacing = match spacing {
            SpacingValue::All(step) => [step; 3],
            SpacingValue::Each(steps) => steps,
        };
        let wrong = |problem: &str| self.wrong(sea.span(), problem, false);
        if !spacing.iter().all(|step| *step > 0.0 && step.is_finite()) {
            return Err(wrong("the spacing of the sea must be above 0"));
        }
        if !((0..2).all(|d| to[d] > from[d]) && depth > 0.0) {
            return Err(wrong(
                "the sea must go from a smaller x and y to larger ones, and have a depth above 0",
            ));
        }
        let steps = [
            ((to[0] - from[0]) / spacing[0] + 1e-9).floor(),
            ((to[1] - from[1]) / spacing[1] + 1e-9).floor(),
            (depth / spacing[2] - 1e-9).ceil(),
        ];
        // Casts saturate; so many points are refused.
        let dims = steps.map(|steps| (steps as usize).saturating_add(1));
        let mut affine = [[0.0; 4]; 3];
        for (d, first) in [from[0], from[1], -steps[2] * spacing[2]].into_iter().enumerate() {
            (affine[d][d], affine[d][3]) = (spacing[d], first);
        }
        Grid::with_affine(dims, affine).map_err(|error| self.of(sea, error))
    }

    fn floor(&self, floor: &Spanned<FloorTable>, sea: &SeaTable) -> Result<Floor, Failure> {
        Ok(match floor.as_ref() {
            FloorTable::Flat(flat) => Floor::flat(flat.depth),
            FloorTable::Slope(plane) => Floor::Plane { depth: plane.depth, slope: plane.slope },
            FloorTable::Ridge(ridge) => Floor::Ridge {
                depth: ridge.depth,
                height: ridge.height,
                width: ridge.width,
                through: ridge.through,
                course: ridge.course,
            },
            FloorTable::Fractal(fractal) => {
                let terrain = Terrain {
                    depth: fractal.depth,
                    relief: fractal.relief,
                    longest: fractal.longest,
                    shortest: fractal.shortest,
                    seed: fractal.seed,
                };
                terrain.floor([sea.from, sea.to]).map_err(|error| self.of(floor, error))?
            }
            FloorTable::Grid(grid) => {
                let (dims, depths) = self.depths(grid, floor.span())?;
                Depths::new(grid.from, grid.spacing, dims, depths)
                    .map(Floor::Grid)
                    .map_err(|error| self.of(floor, error))?
            }
        })
    }

    /// Points along x and y, and their depths.
    fn depths(
        &self,
        grid: &GridTable,
        span: Range<usize>,
    ) -> Result<([usize; 2], Vec<f64>), Failure> {
        match (&grid.rows, &grid.file) {
            (Some(rows), None) => {
                let across = rows.first().map_or(0, Vec::len);
                if rows.iter().any(|row| row.len() != across) {
                    let problem = "the rows of depths must have as many depths as the first";
                    return Err(self.wrong(span, problem, false));
                }
                Ok(([across, rows.len()], rows.concat()))
            }
            (None, Some(file)) => {
                let file: PathBuf = self.path.parent().unwrap_or(Path::new("")).join(file);
                let volume = read_volume(&file, &VolumeOptions::default())?;
                match volume.grid.dims() {
                    [nx, ny, 1] => Ok(([nx, ny], volume.values.to_f64())),
                    _ => Err(Failure::Undone(format!(
                        "{}: has several slices; depths are an image of one",
                        file.display()
                    ))),
                }
            }
            _ => Err(self.wrong(span, "a grid of depths needs either rows or a file", false)),
        }
    }

    fn sound(&self, sound: Option<&Spanned<SoundTable>>) -> Result<SoundSpeed, Failure> {
        let Some(table) = sound else { return Ok(SoundSpeed::constant(SPEED)?) };
        let found = match table.as_ref() {
            SoundTable { speed: Some(speed), profile: None } => SoundSpeed::constant(*speed),
            SoundTable { speed: None, profile: Some(knots) } => SoundSpeed::profile(knots),
            _ => {
                let problem = "sound needs either a speed or a profile";
                return Err(self.wrong(table.span(), problem, false));
            }
        };
        found.map_err(|error| self.of(table, error))
    }

    fn truth(&self, table: &SceneTable) -> Result<Option<Track>, Failure> {
        if table.truth.is_empty() {
            return Ok(None);
        }
        let points = table.truth.iter().map(|place| {
            let place = place.as_ref();
            let course = Some(0.0);
            Waypoint { time: place.time, position: place.position, depth: place.depth, course }
        });
        let track = Track::new(points.collect());
        track.map(Some).map_err(|error| self.of_number(&table.truth, "waypoint ", error))
    }

    /// What the library says of a table.
    fn of<T>(&self, table: &Spanned<T>, error: shrouds::Error) -> Failure {
        self.wrong(table.span(), &error.to_string(), false)
    }

    /// What the library says of one of several tables, which it numbers from 1 after these words.
    fn of_number<T>(&self, tables: &[Spanned<T>], words: &str, error: shrouds::Error) -> Failure {
        let text = error.to_string();
        let digits = text.strip_prefix(words).and_then(|rest| rest.split([' ', ':']).next());
        let number = digits.and_then(|digits| digits.parse::<usize>().ok()).unwrap_or(1);
        let table = tables.get(number.saturating_sub(1));
        self.wrong(table.map_or(0..0, Spanned::span), &text, false)
    }

    /// A message with its line, and with the key before the place in it.
    fn wrong(&self, span: Range<usize>, message: &str, with_key: bool) -> Failure {
        let before = &self.text[..span.start.min(self.text.len())];
        let number = before.matches('\n').count() + 1;
        let line = self.text.lines().nth(number - 1).unwrap_or_default();
        let key = line.split_once('=').map(|(key, _)| key.trim());
        let key = key.filter(|key| with_key && !key.is_empty() && !key.starts_with(['#', '[']));
        let key = key.map_or(String::new(), |key| format!(", key {key}"));
        let message = message.trim().replace('\n', "; ");
        Failure::Undone(format!("{}: line {number}{key}: {message}", self.path.display()))
    }
}
