//! Settings of the page as if they were typed: the parser of the command line reads them, so that names,
//! defaults and messages are the same, and so is the call that does the same.

use clap::{Arg, Args, Command, CommandFactory, FromArgMatches, Parser};
use serde_json::{Map, Value, json};
use shrouds::optimize::Start;

use super::request::Settings;
use crate::args::{FrameChoice, ShroudArgs, VolumeArgs};
use crate::commands::mesh::materials::SETTINGS;
use crate::failure::Failure;
use crate::settings::Job;

/// How a shroud is made.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Making {
    #[command(flatten)]
    shroud: ShroudArgs,
    /// The interfaces between all labels that are chosen, at least two, in place of one body
    #[arg(long)]
    materials: bool,
}

/// How a volume is read.
#[derive(Parser)]
#[command(no_binary_name = true, disable_help_flag = true)]
struct Reading {
    #[command(flatten)]
    volume: VolumeArgs,
}

/// Settings that were understood.
#[derive(Clone)]
pub(super) struct Typed {
    /// The options of the call.
    pub(super) words: Vec<String>,
    pub(super) args: ShroudArgs,
    /// Whether the interfaces between labels are wanted.
    pub(super) materials: bool,
}

impl Typed {
    pub(super) fn read(settings: &Settings) -> Result<Self, Failure> {
        let command = Making::command();
        let names: Vec<&str> = command.get_arguments().filter_map(Arg::get_long).collect();
        if let Some(unknown) = settings.keys().find(|name| !names.contains(&name.as_str())) {
            let known = names.join(", ");
            return Err(Failure::Call(format!(
                "there is no setting '{unknown}'; there are {known}"
            )));
        }
        let given = names.iter().filter_map(|name| Some((*name, settings.get(*name)?)));
        let words: Vec<Option<String>> =
            given.map(|(name, value)| word(name, value)).collect::<Result<_, _>>()?;
        let words: Vec<String> = words.into_iter().flatten().collect();
        let Making { shroud, materials } = parse(&words)?;
        Ok(Self { words, args: shroud, materials })
    }

    /// Checked settings, as `shrouds mesh` has them.
    pub(super) fn job(&self) -> Result<Job, Failure> {
        Job::new(&self.args, FrameChoice::World)
    }
}

/// The options of a volume, as words and understood.
pub(super) fn reading(words: &[String]) -> Result<VolumeArgs, Failure> {
    let Reading { volume } = parse(words)?;
    Ok(volume)
}

/// An option with its value as one word; none where it is left out.
fn word(name: &str, value: &Value) -> Result<Option<String>, Failure> {
    match value {
        Value::Null | Value::Bool(false) => Ok(None),
        Value::Bool(true) => Ok(Some(format!("--{name}"))),
        Value::String(text) => Ok(Some(format!("--{name}={text}"))),
        Value::Number(number) => Ok(Some(format!("--{name}={number}"))),
        Value::Array(_) | Value::Object(_) => {
            Err(Failure::Call(format!("the setting '{name}' is a text, a number, true or null")))
        }
    }
}

fn parse<T: Args + FromArgMatches + Parser>(words: &[String]) -> Result<T, Failure> {
    T::try_parse_from(words).map_err(|error| {
        let text = error.to_string();
        let first: Vec<&str> = text.lines().take_while(|line| !line.is_empty()).collect();
        let message = first.join(" ");
        Failure::Call(message.strip_prefix("error: ").unwrap_or(&message).to_owned())
    })
}

/// All settings with what they can be.
pub(super) fn choices() -> Value {
    let command: Command = Making::command();
    let named = command.get_arguments().filter_map(|arg| Some((arg.get_long()?.to_owned(), arg)));
    let entries = named.enumerate().map(|(order, (name, arg))| (name, choice(order, arg)));
    let mut choices: Map<String, Value> = entries.collect();
    for (name, choice) in &mut choices {
        choice["materials"] = (name == "materials" || SETTINGS.contains(&name.as_str())).into();
    }
    // Not a choice on the command line, where a seed can follow.
    if let Some(start) = choices.get_mut("start") {
        let known = [Start::Blur, Start::Midpoint, Start::Inside, Start::Outside, Start::Random(1)];
        start["values"] =
            known.map(|start| json!({ "value": start.to_string() })).into_iter().collect();
    }
    choices.into()
}

fn choice(order: usize, arg: &Arg) -> Value {
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let default = arg.get_default_values().first().and_then(|value| value.to_str());
    let mut entry = json!({ "order": order, "help": help, "default": default });
    if !arg.get_action().takes_values() {
        (entry["flag"], entry["default"]) = (true.into(), false.into());
        return entry;
    }
    let values: Vec<Value> = arg
        .get_possible_values()
        .iter()
        .map(|value| {
            let help = value.get_help().map(ToString::to_string);
            json!({ "value": value.get_name(), "help": help })
        })
        .collect();
    match values.is_empty() {
        true => entry["text"] = true.into(),
        false => entry["values"] = values.into(),
    }
    entry
}

/// Words as a shell takes them.
pub(super) fn quoted<'a>(words: impl IntoIterator<Item = &'a str>) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_=./:,+%@".contains(c);
    let quote = |word: &str| match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', r"'\''")),
    };
    words.into_iter().map(quote).collect::<Vec<String>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::commands::mesh::materials::refuse_other_settings;

    fn typed(settings: Value) -> Result<Typed, Failure> {
        Typed::read(settings.as_object().unwrap())
    }

    #[test]
    fn settings_are_those_of_the_command_line() {
        let given = json!({
            "energy": "bending+0.3*variation", "max-iterations": 7, "preset": "exact", "crease": null,
            "strict": true, "start": "random:3",
        });
        let Typed { words, args, .. } = typed(given).unwrap();
        let expected = [
            "--energy=bending+0.3*variation",
            "--preset=exact",
            "--max-iterations=7",
            "--start=random:3",
            "--strict",
        ];
        assert!(words.len() == 5 && expected.iter().all(|word| words.iter().any(|w| w == word)));
        assert_eq!(args.solve.max_iterations, Some(7));
        assert!(typed(json!({ "crease": true })).unwrap().job().is_ok());
    }

    #[test]
    fn wrong_settings_are_refused_in_one_line() {
        for (settings, part) in [
            (json!({ "colour": "red" }), "no setting 'colour'; there are energy"),
            (json!({ "preset": "slow" }), "fast, default, exact"),
            (json!({ "energy": "beauty" }), "beauty"),
            (json!({ "tolerance": 2 }), "above 0 and below 1"),
            (json!({ "preset": ["fast"] }), "a text, a number"),
            (json!({ "strict": "--help" }), "strict"),
        ] {
            let failure = typed(settings.clone()).err().unwrap();
            let message = failure.message();
            assert!(message.contains(part) && !message.contains('\n'), "{settings}: {message}");
        }
        assert!(typed(json!({ "preset": "fast", "strict": true })).unwrap().job().is_err());
    }

    #[test]
    fn choices_have_defaults_and_help() {
        let choices = choices();
        assert_eq!(choices["start"]["default"], "blur");
        assert_eq!(choices["faces"]["values"][1]["value"], "join");
        assert_eq!(choices["strict"]["flag"], true);
        assert_eq!(choices["tolerance"]["text"], true);
        assert!(choices.as_object().unwrap().values().all(|entry| entry["help"] != ""));
    }

    #[test]
    fn what_interfaces_have_not_is_refused_with_them() {
        let refused = [
            ("energy", json!("linear")),
            ("crease", json!(true)),
            ("parameter", json!("chord")),
            ("solver", json!("sweeps")),
            ("border", json!("open")),
            ("surface", json!("dual")),
            ("triangles", json!("fixed")),
            ("strict", json!(true)),
        ];
        let mut known: Vec<String> = refused.iter().map(|(name, _)| (*name).to_owned()).collect();
        for (name, value) in refused {
            let args = typed(json!({ name: value, "materials": true })).unwrap().args;
            let failure = refuse_other_settings(&args).unwrap_err();
            assert!(failure.message().contains(name), "{}", failure.message());
        }
        // All others they have.
        let choices = choices();
        let others = choices.as_object().unwrap().iter();
        let others = others.filter(|(_, choice)| choice["materials"] == false);
        let mut others: Vec<String> = others.map(|(name, _)| name.clone()).collect();
        known.sort();
        others.sort();
        assert_eq!(known, others);
    }

    #[test]
    fn words_are_quoted_for_a_shell() {
        let words = ["a.nii", "--energy=bending", "2*x", "it's", ""];
        assert_eq!(quoted(words), r"a.nii --energy=bending '2*x' 'it'\''s' ''");
    }
}
