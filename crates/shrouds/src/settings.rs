//! Everything a caller can choose, in types and by names.

use std::str::FromStr;

use crate::choice::Choice;
use crate::error::Error;
use crate::mesh::{MeshKind, Triangles};
use crate::optimize::{self, Crease, Preset, Solver, Start, VolumeRule};
use crate::volume::{Border, FaceRule};

/// Everything a caller can choose.
#[derive(Clone, Default)]
pub struct Settings {
    /// How ambiguous faces are cut. Default [`FaceRule::Separate`].
    pub faces: FaceRule,
    /// What lies beyond the volume. Default [`Border::Closed`].
    pub border: Border,
    /// Energy, solver, start and stop rule.
    pub optimize: optimize::Settings,
    /// Which mesh to make. Default [`MeshKind::Primal`].
    pub mesh: MeshKind,
    /// How patches are cut into triangles. Default [`Triangles::Fitted`].
    pub triangles: Triangles,
}

/// A setting as it goes by its name: that of the program's option, with `_` for `-`.
pub struct Setting {
    /// Its name.
    pub name: &'static str,
    /// What it decides, without a full stop.
    pub summary: &'static str,
    /// The names it can have, each with what it does; none where it is not a choice.
    pub choices: Vec<[&'static str; 2]>,
    read: Read,
    write: Write,
}

impl Settings {
    /// All settings that have a name, in the order of the program's help.
    ///
    /// Not among them are those that are data: given δ, intervals, and places that need not be smooth.
    pub fn named() -> Vec<Setting> {
        vec![
            value(
                "energy",
                "What the slice curves minimise: measures with weights, bending+0.3*variation; that of the preset if none is given",
                |settings, text| put(&mut settings.optimize.energy, text.parse().map(Some)),
                |settings| Some(settings.optimize.energy().to_string()),
            ),
            value(
                "crease",
                "Edges stay sharp where a slice curve turns by much more than so many degrees; for the presets fast and default",
                |settings, text| {
                    let crease = |degrees: f64| Some(Crease { angle: degrees.to_radians() });
                    put(&mut settings.optimize.crease, number("crease", text).map(crease))
                },
                |settings| Some(settings.optimize.crease?.angle.to_degrees().to_string()),
            ),
            choice::<Preset>(
                "How much work newton puts into the minimum",
                |settings, text| put(&mut settings.optimize.preset, text.parse()),
                |settings| {
                    let has_preset = settings.optimize.solver == Solver::Newton;
                    has_preset.then(|| settings.optimize.preset.to_string())
                },
            ),
            choice::<Solver>(
                "How the minimum is sought",
                |settings, text| put(&mut settings.optimize.solver, text.parse()),
                |settings| Some(settings.optimize.solver.to_string()),
            ),
            value(
                "tolerance",
                "When to stop, above 0 and below 1; asks for the preset exact",
                |settings, text| {
                    put(&mut settings.optimize.tolerance, number("tolerance", text).map(Some))
                },
                |settings| {
                    let optimize = &settings.optimize;
                    optimize.converges().then(|| optimize.tolerance().to_string())
                },
            ),
            value(
                "max_iterations",
                "Most steps or sweeps, 0 to leave the start as it is",
                |settings, text| {
                    let limit = &mut settings.optimize.max_iterations;
                    put(limit, count("max_iterations", text).map(Some))
                },
                |settings| Some(settings.optimize.max_iterations().to_string()),
            ),
            value(
                "start",
                "Where the vertices start: blur (the blurred volume), midpoint (the middle of the grid edges), inside or outside (one of their ends) or random:SEED",
                |settings, text| put(&mut settings.optimize.start, text.parse()),
                |settings| match &settings.optimize.start {
                    Start::Given(_) => None,
                    start => Some(start.to_string()),
                },
            ),
            value(
                "margin",
                "How near a vertex may come to an end of its grid edge, in edge lengths",
                |settings, text| put(&mut settings.optimize.margin, number("margin", text)),
                |settings| Some(settings.optimize.margin.to_string()),
            ),
            choice::<VolumeRule>(
                "Whether the volume of every connected component is left to the energy",
                |settings, text| put(&mut settings.optimize.volume, text.parse()),
                |settings| Some(settings.optimize.volume.to_string()),
            ),
            choice::<FaceRule>(
                "How ambiguous cell faces are cut",
                |settings, text| put(&mut settings.faces, text.parse()),
                |settings| Some(settings.faces.to_string()),
            ),
            choice::<Border>(
                "What lies beyond the volume",
                |settings, text| put(&mut settings.border, text.parse()),
                |settings| Some(settings.border.to_string()),
            ),
            choice::<MeshKind>(
                "Which mesh to make",
                |settings, text| put(&mut settings.mesh, text.parse()),
                |settings| Some(settings.mesh.to_string()),
            ),
            choice::<Triangles>(
                "How patches are cut into triangles",
                |settings, text| put(&mut settings.triangles, text.parse()),
                |settings| Some(settings.triangles.to_string()),
            ),
        ]
    }

    /// Settings from names and values as the program's options take them; what is not named keeps its
    /// default. A tolerance without a preset asks for the preset `exact`.
    ///
    /// ```
    /// use shrouds::{Settings, optimize::Preset};
    ///
    /// let settings = Settings::from_names([("energy", "bending"), ("tolerance", "1e-4")])?;
    /// assert_eq!(settings.optimize.preset, Preset::Exact);
    /// # Ok::<(), shrouds::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::UnknownSetting`]; [`Error::Choice`] for a value that cannot be read;
    /// [`Error::Setting`] for one outside its range, and for values that do not go together; those of
    /// reading an energy.
    pub fn from_names<'a>(
        pairs: impl IntoIterator<Item = (&'a str, &'a str)>,
    ) -> Result<Self, Error> {
        let (named, mut settings) = (Self::named(), Self::default());
        let mut has_preset = false;
        for (name, value) in pairs {
            let Some(setting) = named.iter().find(|setting| setting.name == name) else {
                let known = named.iter().map(|setting| setting.name).collect::<Vec<_>>();
                return Err(Error::UnknownSetting { name: name.into(), known: known.join(", ") });
            };
            (setting.read)(&mut settings, value)?;
            has_preset |= name == Preset::SETTING;
        }
        settings.settle_preset(has_preset)?;
        settings.optimize.validate()?;
        Ok(settings)
    }

    /// The settings in force by their names; left out is what has no meaning beside the others.
    pub fn to_names(&self) -> Vec<(&'static str, String)> {
        let named = Self::named().into_iter();
        named.filter_map(|setting| Some((setting.name, (setting.write)(self)?))).collect()
    }

    /// The preset that the other settings ask for, if none was asked for itself.
    fn settle_preset(&mut self, is_given: bool) -> Result<(), Error> {
        let optimize = &mut self.optimize;
        let refuse = |range| {
            Err(Error::Setting { name: Preset::SETTING, value: optimize.preset.to_string(), range })
        };
        match optimize.solver {
            Solver::Sweeps if is_given => refuse("left out for the sweeps, which always converge"),
            Solver::Newton if optimize.tolerance.is_none() => Ok(()),
            Solver::Newton if is_given && optimize.preset != Preset::Exact => {
                refuse("exact with a tolerance, as the others stop before convergence")
            }
            _ => {
                optimize.preset = Preset::Exact;
                Ok(())
            }
        }
    }
}

/// How a setting is read from a text.
type Read = fn(&mut Settings, &str) -> Result<(), Error>;
/// How a setting is written, where it has a meaning.
type Write = fn(&Settings) -> Option<String>;

/// A setting that is a [`Choice`].
fn choice<T: Choice>(summary: &'static str, read: Read, write: Write) -> Setting {
    let choices = T::ALL.iter().map(|named| [named.name, named.summary]).collect();
    Setting { name: T::SETTING, summary, choices, read, write }
}

/// A setting that is none.
fn value(name: &'static str, summary: &'static str, read: Read, write: Write) -> Setting {
    Setting { name, summary, choices: Vec::new(), read, write }
}

fn put<T>(place: &mut T, value: Result<T, Error>) -> Result<(), Error> {
    *place = value?;
    Ok(())
}

fn number(setting: &'static str, text: &str) -> Result<f64, Error> {
    parse(setting, text, "a number")
}

fn count(setting: &'static str, text: &str) -> Result<usize, Error> {
    parse(setting, text, "a whole number from 0 up")
}

fn parse<T: FromStr>(setting: &'static str, text: &str, known: &str) -> Result<T, Error> {
    let refuse = |_| Error::Choice { setting, value: text.into(), known: known.into() };
    text.parse().map_err(refuse)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn round_trip(pairs: &[(&str, &str)]) -> Vec<(&'static str, String)> {
        let names = Settings::from_names(pairs.iter().copied()).unwrap().to_names();
        let again = names.iter().map(|(name, value)| (*name, value.as_str()));
        assert_eq!(Settings::from_names(again).unwrap().to_names(), names);
        names
    }

    #[test]
    fn every_value_of_every_choice_comes_back() {
        round_trip(&[]);
        for setting in Settings::named() {
            for [value, summary] in &setting.choices {
                assert!(!summary.ends_with('.'));
                let names = round_trip(&[(setting.name, value)]);
                assert!(names.contains(&(setting.name, (*value).to_owned())), "{names:?}");
            }
        }
        for start in ["blur", "midpoint", "inside", "outside", "random:18446744073709551615"] {
            assert!(round_trip(&[("start", start)]).contains(&("start", start.into())));
        }
        let energy = ("energy", "bending+0.3*curvature(chord)");
        let names = round_trip(&[energy, ("max_iterations", "7"), ("margin", "0.01")]);
        assert!(names.contains(&("energy", energy.1.into())));
        assert!(names.contains(&("max_iterations", "7".into())));
        assert!(names.contains(&("margin", "0.01".into())));
    }

    #[test]
    fn a_tolerance_asks_for_the_preset_that_converges() {
        let settings = Settings::from_names([("tolerance", "1e-3")]).unwrap();
        assert_eq!(settings.optimize.preset, Preset::Exact);
        for preset in ["fast", "default"] {
            let error = Settings::from_names([("tolerance", "1e-3"), ("preset", preset)]);
            assert!(matches!(error, Err(Error::Setting { name: "preset", .. })));
        }
        let error = Settings::from_names([("preset", "exact"), ("solver", "sweeps")]);
        assert!(matches!(error, Err(Error::Setting { name: "preset", .. })));
    }

    #[test]
    fn what_cannot_be_is_refused_with_what_can() {
        let message = |name, value| match Settings::from_names([(name, value)]) {
            Err(error) => error.to_string(),
            Ok(_) => panic!("{name}={value} was taken"),
        };
        assert!(message("prest", "fast").contains("energy, crease, preset, solver"));
        assert_eq!(
            message("preset", "fats"),
            r#"preset is "fats", but must be fast, default, exact"#
        );
        for start in ["random", "random:", "random:-1", "blur:1"] {
            assert!(message("start", start).contains("random:SEED"));
        }
        assert!(message("max_iterations", "-1").contains("whole number"));
        assert!(message("tolerance", "nan").contains("above 0"));
        assert!(message("crease", "1000").contains("radians"));
        assert!(message("energy", "bnding").contains("bending"));
    }
}
