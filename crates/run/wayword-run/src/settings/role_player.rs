//! Who plays a role of a run: rules, labels, or a model.

use serde::{Deserialize, Serialize};
use std::{fmt, str::FromStr};

/// The name of rules in settings and provenance.
const RULES_NAME: &str = "rules";
/// The name of labels in settings and provenance.
const LABELS_NAME: &str = "labels";

/// Who plays a role of a run. Flags, settings and provenance have its name, which [`fmt::Display`] gives.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum RolePlayer {
    /// The rules of this program.
    Rules,
    /// The platform's ground-truth labels.
    Labels,
    /// A model, named as provider/model.
    Model(String),
}

/// A name that is neither built in nor provider/model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownPlayer(String);

impl RolePlayer {
    /// Its name.
    #[must_use]
    pub fn as_str(&self) -> &str {
        match self {
            Self::Rules => RULES_NAME,
            Self::Labels => LABELS_NAME,
            Self::Model(name) => name,
        }
    }

    /// Whether a provenance with this name means this player.
    #[must_use]
    pub fn is_named(&self, name: &str) -> bool {
        self.as_str() == name
    }

    /// The name of the model; `None` for rules and labels.
    #[must_use]
    pub fn model_name(&self) -> Option<&str> {
        match self {
            Self::Model(name) => Some(name),
            Self::Rules | Self::Labels => None,
        }
    }

    /// The name of the model if it is reached over HTTP.
    #[must_use]
    pub fn remote_model(&self) -> Option<&str> {
        self.model_name().filter(|name| !is_in_process(name))
    }

    /// Whether a model plays that runs inside this program.
    #[must_use]
    pub fn is_in_process(&self) -> bool {
        self.model_name().is_some_and(is_in_process)
    }

    /// Reads the player of a role that a model can play, or this player; `None` for any other name.
    #[must_use]
    pub fn or_model(self, name: &str) -> Option<Self> {
        name.parse().ok().filter(|player| *player == self || matches!(player, Self::Model(_)))
    }
}

/// Whether a model of this name runs inside this program: its provider is `hf`.
#[must_use]
pub fn is_in_process(model: &str) -> bool {
    model.starts_with("hf/")
}

impl FromStr for RolePlayer {
    type Err = UnknownPlayer;

    fn from_str(name: &str) -> Result<Self, UnknownPlayer> {
        match (name, name.split_once('/')) {
            (RULES_NAME, _) => Ok(Self::Rules),
            (LABELS_NAME, _) => Ok(Self::Labels),
            (_, Some((provider, model))) if !provider.is_empty() && !model.is_empty() => {
                Ok(Self::Model(name.to_owned()))
            }
            _ => Err(UnknownPlayer(name.to_owned())),
        }
    }
}

impl TryFrom<String> for RolePlayer {
    type Error = UnknownPlayer;

    fn try_from(name: String) -> Result<Self, UnknownPlayer> {
        name.parse()
    }
}

impl From<RolePlayer> for String {
    fn from(player: RolePlayer) -> Self {
        match player {
            RolePlayer::Model(name) => name,
            RolePlayer::Rules | RolePlayer::Labels => player.to_string(),
        }
    }
}

impl fmt::Display for RolePlayer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Display for UnknownPlayer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} is neither `{RULES_NAME}` nor `{LABELS_NAME}` nor a model as provider/model", self.0)
    }
}

impl std::error::Error for UnknownPlayer {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_written_as_it_was_read() {
        for name in ["rules", "labels", "ollama/llava:7b", "hf/org/name@main", "hf//models/x.GGUF"] {
            let player: RolePlayer = serde_json::from_value(name.into()).unwrap();
            assert_eq!(serde_json::to_value(&player).unwrap(), name);
            assert!(player.is_named(name) && player.to_string() == name);
        }
        for bad in ["gpt", "/x", "x/", "", "Rules"] {
            assert!(bad.parse::<RolePlayer>().is_err(), "{bad}");
        }
    }

    #[test]
    fn a_role_takes_its_own_player_or_a_model() {
        assert_eq!(RolePlayer::Rules.or_model("rules"), Some(RolePlayer::Rules));
        assert_eq!(RolePlayer::Rules.or_model("labels"), None);
        let model = RolePlayer::Labels.or_model("hf/org/name").unwrap();
        assert_eq!((model.model_name(), model.remote_model()), (Some("hf/org/name"), None));
        assert!(model.is_in_process() && !RolePlayer::Labels.is_in_process());
    }
}
