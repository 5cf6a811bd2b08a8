//! How a run ends when it does not end well.

use std::fmt;

/// Why the program stops; each kind has an exit code of its own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Failure {
    /// What the user gave can't be worked with: exit code 2.
    Input(String),
    /// Something failed on the way, or a picture was wrong: exit code 1.
    Run(String),
    /// The user stopped it: exit code 130.
    Interrupted(String),
}

impl Failure {
    /// What the process returns.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Self::Run(_) => 1,
            Self::Input(_) => 2,
            Self::Interrupted(_) => 130,
        }
    }

    /// The same kind of failure with more said.
    pub(crate) fn also(self, more: &str) -> Self {
        let add = |text: String| format!("{text}; {more}");
        match self {
            Self::Input(text) => Self::Input(add(text)),
            Self::Run(text) => Self::Run(add(text)),
            Self::Interrupted(text) => Self::Interrupted(add(text)),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Self::Input(text) | Self::Run(text) | Self::Interrupted(text)) = self;
        f.write_str(text)
    }
}
