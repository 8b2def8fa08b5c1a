//! Messages of the page, checked.

use clap::ValueEnum;
use serde::Deserialize;
use serde::de::{DeserializeOwned, Error};
use serde_json::{Map, Value};

use super::VIEWS;

/// A message that can be understood.
pub(super) struct Request {
    /// The number that the answer has.
    pub(super) id: u64,
    pub(super) task: Task,
}

/// One that cannot.
#[derive(Debug)]
pub(super) struct Refused {
    /// Its number, if it has one.
    pub(super) id: Option<u64>,
    pub(super) message: String,
}

/// What is to be done.
#[derive(Deserialize, Debug)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum Task {
    Hello {},
    Open {
        slot: Slot,
        source: Origin,
    },
    Select {
        slot: Slot,
        labels: Option<Vec<i64>>,
        threshold: Option<f64>,
    },
    Combine {
        operation: Named<crate::args::Operation>,
        a: Slot,
        b: Slot,
        into: Slot,
    },
    Offset {
        slot: Slot,
        by: f64,
        into: Slot,
    },
    Shroud {
        view: ViewNumber,
        slot: Slot,
        #[serde(default)]
        settings: Settings,
    },
    Run {
        view: ViewNumber,
    },
    Step {
        view: ViewNumber,
    },
    Pause {
        view: ViewNumber,
    },
    Reset {
        view: ViewNumber,
    },
    Cancel {
        view: ViewNumber,
    },
    Ack {
        view: ViewNumber,
        revision: u32,
        /// For whoever reads along.
        #[serde(rename = "iteration")]
        _iteration: u64,
    },
    Numbers {
        view: ViewNumber,
    },
    Sizes {
        view: ViewNumber,
    },
    Pick {
        view: ViewNumber,
        vertex: u32,
    },
    Colours {
        view: ViewNumber,
        field: String,
        range: Option<[f64; 2]>,
    },
    Contours {
        view: ViewNumber,
        axis: Named<crate::args::PlaneAxis>,
        every: f64,
    },
    Points {
        slot: Slot,
        near: u8,
    },
    Slice {
        slot: Slot,
        axis: Named<crate::args::PlaneAxis>,
        index: usize,
    },
    Brush {
        slot: Slot,
        add: bool,
        centre: [f64; 3],
        radius: f64,
        /// Dabs of one stroke have the same number, and are taken back together.
        stroke: Option<u64>,
        #[serde(default)]
        follow: bool,
    },
    Undo {
        slot: Slot,
        #[serde(default)]
        follow: bool,
    },
    Redo {
        slot: Slot,
        #[serde(default)]
        follow: bool,
    },
    Export {
        view: ViewNumber,
        format: String,
        frame: Option<Named<crate::args::FrameChoice>>,
    },
    Report {
        view: ViewNumber,
    },
    Command {
        view: ViewNumber,
    },
    Compare {
        slot: Slot,
        energies: Vec<String>,
        #[serde(default)]
        settings: Settings,
    },
    Scene(SceneSource),
    SceneStep {
        step: usize,
        into: Slot,
    },
}

/// Options by their names on the command line.
pub(super) type Settings = Map<String, Value>;

/// Where a volume is kept.
#[derive(Deserialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(rename_all = "lowercase")]
pub(super) enum Slot {
    A,
    B,
    C,
}

impl Slot {
    pub(super) const COUNT: usize = 3;

    pub(super) fn index(self) -> usize {
        self as usize
    }

    pub(super) fn name(self) -> &'static str {
        ["a", "b", "c"][self.index()]
    }
}

/// Where a surface is shown: 0 to 3.
#[derive(Deserialize, Debug, Clone, Copy, PartialEq, Eq)]
#[serde(try_from = "u64")]
pub(super) struct ViewNumber(u32);

impl TryFrom<u64> for ViewNumber {
    type Error = String;

    fn try_from(number: u64) -> Result<Self, String> {
        let known = u32::try_from(number).ok().filter(|&number| (number as usize) < VIEWS);
        known.map(Self).ok_or_else(|| format!("there is no view {number}; give 0 to {}", VIEWS - 1))
    }
}

impl ViewNumber {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }

    pub(super) fn number(self) -> u32 {
        self.0
    }
}

/// Where a volume comes from: one of a demo, a path and an upload.
#[derive(Deserialize, Debug, Clone, Default)]
#[serde(deny_unknown_fields)]
pub(super) struct Origin {
    pub(super) demo: Option<String>,
    /// Of the demo.
    pub(super) size: Option<u16>,
    pub(super) path: Option<String>,
    pub(super) upload: Option<String>,
    /// Which volume of the file.
    pub(super) frame: Option<u64>,
    pub(super) array: Option<String>,
    pub(super) level: Option<u64>,
}

/// A scene of the sea.
#[derive(Deserialize, Debug, Clone)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneSource {
    pub(super) path: Option<String>,
    pub(super) demo: Option<String>,
}

/// A choice by its name on the command line.
#[derive(Debug, Clone, Copy)]
pub(super) struct Named<T>(pub(super) T);

impl<'de, T: ValueEnum> Deserialize<'de> for Named<T> {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        T::from_str(&text, false).map(Named).map_err(|_| {
            let names = T::value_variants().iter().filter_map(ValueEnum::to_possible_value);
            let names: Vec<String> = names.map(|value| value.get_name().to_owned()).collect();
            D::Error::custom(format!("'{text}' is none of {}", names.join(", ")))
        })
    }
}

impl Task {
    /// The view that it is about.
    pub(super) fn view(&self) -> Option<ViewNumber> {
        match self {
            Self::Shroud { view, .. }
            | Self::Run { view }
            | Self::Step { view }
            | Self::Pause { view }
            | Self::Reset { view }
            | Self::Cancel { view }
            | Self::Ack { view, .. }
            | Self::Numbers { view }
            | Self::Sizes { view }
            | Self::Pick { view, .. }
            | Self::Colours { view, .. }
            | Self::Contours { view, .. }
            | Self::Export { view, .. }
            | Self::Report { view }
            | Self::Command { view } => Some(*view),
            _ => None,
        }
    }
}

impl Request {
    /// Reads a message. An acknowledgement needs no number: it has no answer.
    pub(super) fn read(text: &str) -> Result<Self, Refused> {
        let refuse = |id, problem: &dyn std::fmt::Display| Refused {
            id,
            message: format!("this message cannot be understood: {problem}"),
        };
        let mut fields: Map<String, Value> =
            parse(text).map_err(|problem| refuse(None, &problem))?;
        let id = fields.remove("id").and_then(|id| id.as_u64());
        let is_ack = fields.get("do").is_some_and(|name| name == "ack");
        let task = Task::deserialize(Value::Object(fields));
        let task = task.map_err(|problem| refuse(id, &problem))?;
        match (id, is_ack) {
            (Some(id), _) => Ok(Self { id, task }),
            (None, true) => Ok(Self { id: 0, task }),
            (None, false) => Err(refuse(None, &"it has no id, a whole number")),
        }
    }
}

fn parse<T: DeserializeOwned>(text: &str) -> serde_json::Result<T> {
    serde_json::from_str(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(text: &str) -> String {
        match Request::read(text) {
            Ok(request) => panic!("{text}: {:?}", request.task),
            Err(refused) => refused.message,
        }
    }

    #[test]
    fn messages_are_read() {
        for text in [
            r#"{"id": 1, "do": "hello"}"#,
            r#"{"id": 2, "do": "open", "slot": "a", "source": {"demo": "tori", "size": 32}}"#,
            r#"{"id": 3, "do": "open", "slot": "b", "source": {"path": "x.nii", "frame": 1}}"#,
            r#"{"id": 4, "do": "shroud", "view": 3, "slot": "c", "settings": {"preset": "exact"}}"#,
            r#"{"id": 5, "do": "shroud", "view": 0, "slot": "a"}"#,
            r#"{"do": "ack", "view": 1, "revision": 2, "iteration": 3}"#,
            r#"{"id": 6, "do": "combine", "operation": "xor", "a": "a", "b": "b", "into": "c"}"#,
            r#"{"id": 7, "do": "scene", "demo": "figure11"}"#,
        ] {
            assert!(Request::read(text).is_ok(), "{text}: {}", refusal(text));
        }
    }

    #[test]
    fn what_cannot_be_meant_is_refused_with_its_number() {
        for (text, part) in [
            ("", "EOF"),
            ("[]", "expected a map"),
            (r#"{"do": "hello"}"#, "no id"),
            (r#"{"id": -1, "do": "hello"}"#, "no id"),
            (r#"{"id": 1}"#, "`do`"),
            (r#"{"id": 1, "do": "fly"}"#, "unknown variant `fly`"),
            (r#"{"id": 1, "do": "run"}"#, "`view`"),
            (r#"{"id": 1, "do": "run", "view": 4}"#, "no view 4; give 0 to 3"),
            (r#"{"id": 1, "do": "run", "view": 0, "fast": 1}"#, "unknown field `fast`"),
            (r#"{"id": 1, "do": "hello", "x": 1}"#, "unknown field `x`"),
            (r#"{"id": 1, "do": "undo", "slot": "d"}"#, "unknown variant `d`"),
            (
                r#"{"id": 1, "do": "combine", "operation": "or", "a": "a", "b": "b", "into": "c"}"#,
                "'or' is none of union, intersect",
            ),
        ] {
            assert!(refusal(text).contains(part), "{text}: {}", refusal(text));
        }
        let deep = format!("{{\"id\": 1, \"do\": {}", "[".repeat(100_000));
        assert!(refusal(&deep).contains("recursion limit"));
        let numbered = Request::read(r#"{"id": 7, "do": "fly"}"#).err().unwrap();
        assert_eq!(numbered.id, Some(7));
    }
}
