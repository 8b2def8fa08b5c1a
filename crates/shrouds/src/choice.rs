//! Choices among a few that go by a name.

use crate::error::Error;

/// A choice among a few. Each has the same name in the library, the program, its reports, Python and
/// the page of the test bed; [`FromStr`](std::str::FromStr) reads it and
/// [`Display`](std::fmt::Display) writes it.
pub trait Choice: Copy + PartialEq + Send + Sync + 'static {
    /// What the setting is called.
    const SETTING: &'static str;
    /// All there are, the usual one not always first.
    const ALL: &'static [Named<Self>];

    /// The name of this one.
    fn name(self) -> &'static str {
        // A macro lists every variant, so that there is one.
        Self::ALL.iter().find(|named| named.value == self).map_or("", |named| named.name)
    }

    /// The one of this name.
    ///
    /// # Errors
    /// [`Error::Choice`] with the names there are.
    fn by_name(name: &str) -> Result<Self, Error> {
        let found = Self::ALL.iter().find(|named| named.name == name);
        found.map(|named| named.value).ok_or_else(|| Error::Choice {
            setting: Self::SETTING,
            value: name.into(),
            known: Self::ALL.iter().map(|named| named.name).collect::<Vec<_>>().join(", "),
        })
    }
}

/// One of the values of a [`Choice`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Named<T> {
    /// What it is.
    pub value: T,
    /// How it is written.
    pub name: &'static str,
    /// What it does, without a full stop.
    pub summary: &'static str,
}

/// Names the variants of an enum: `choice!(Type, "setting": Variant = "name", "summary"; …)`. One that is
/// left out does not compile.
macro_rules! choice {
    ($type:ty, $setting:literal: $($variant:ident = $name:literal, $summary:literal;)+) => {
        impl $crate::choice::Choice for $type {
            const SETTING: &'static str = $setting;
            const ALL: &'static [$crate::choice::Named<Self>] = {
                const fn all_are_named(value: &$type) {
                    match value {
                        $(<$type>::$variant => (),)+
                    }
                }
                &[$({
                    all_are_named(&<$type>::$variant);
                    $crate::choice::Named {
                        value: <$type>::$variant,
                        name: $name,
                        summary: $summary,
                    }
                }),+]
            };
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str($crate::choice::Choice::name(*self))
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::error::Error;

            fn from_str(name: &str) -> Result<Self, Self::Err> {
                $crate::choice::Choice::by_name(name)
            }
        }
    };
}
pub(crate) use choice;
