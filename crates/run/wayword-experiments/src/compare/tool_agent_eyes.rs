//! How the agent `tools` sees: by labels, by pictures, or by the words of another model.

use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};
use wayword_run::settings::RolePlayer;

/// The name of [`ToolAgentEyes::Pictures`] on the command line and in a comparison's settings.
const PICTURES_NAME: &str = "pictures";

/// How the agent `tools` sees, as `--see` names it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum ToolAgentEyes {
    /// Its own language model is shown the pictures.
    Pictures,
    /// Labels, or a model that describes the pictures.
    Player(RolePlayer),
}

impl ToolAgentEyes {
    /// Whether the platform's labels tell the agent about its views.
    #[must_use]
    pub fn are_labels(&self) -> bool {
        *self == Self::Player(RolePlayer::Labels)
    }

    /// The model that describes the pictures to the agent, if there is one.
    #[must_use]
    pub fn describing_model(&self) -> Option<&str> {
        match self {
            Self::Pictures => None,
            Self::Player(player) => player.model_name(),
        }
    }
}

impl FromStr for ToolAgentEyes {
    type Err = String;

    fn from_str(name: &str) -> Result<Self, String> {
        match RolePlayer::Labels.or_model(name) {
            Some(player) => Ok(Self::Player(player)),
            None if name == PICTURES_NAME => Ok(Self::Pictures),
            None => Err(format!(
                "name {}, {PICTURES_NAME}, or a model that sees as provider/model, as in --see ollama/llava",
                RolePlayer::Labels
            )),
        }
    }
}

impl TryFrom<String> for ToolAgentEyes {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        name.parse()
    }
}

impl From<ToolAgentEyes> for String {
    fn from(eyes: ToolAgentEyes) -> Self {
        eyes.to_string()
    }
}

impl fmt::Display for ToolAgentEyes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pictures => f.write_str(PICTURES_NAME),
            Self::Player(player) => player.fmt(f),
        }
    }
}
