//! The settings of the cache and the hub, and how they are read from environment variables.

use crate::LocalError;
use std::{
    ffi::OsString,
    fmt,
    path::{Path, PathBuf},
    time::Duration,
};

/// The address of the public hub.
const PUBLIC_ENDPOINT: &str = "https://huggingface.co";

/// The wait before a second attempt. It doubles with each further one.
const FIRST_WAIT: Duration = Duration::from_millis(300);

/// The settings of the cache and the hub.
#[derive(Debug, Clone)]
pub struct HubConfig {
    /// The cache's folder.
    pub cache: PathBuf,
    /// The hub's address.
    pub endpoint: String,
    /// Whether the network is left alone, and only files on this machine are used.
    pub offline: bool,
    /// Whether snapshots contain links to the blobs, and not copies.
    pub symlinks: bool,
    /// The SHA-256 that a checkpoint of the form `hf/ORG/NAME:FILE.pth` must have. If it is not set, the file must have
    /// the published hash, or the one that it had when it was first used.
    pub trust: Option<String>,
    /// The token that gives access to private and gated models.
    pub(super) token: Option<HubToken>,
    /// The wait before a second attempt. Tests shorten it.
    pub(super) first_wait: Duration,
}

/// A token for the hub. Debug output shows `***` instead of it.
#[derive(Clone)]
pub(super) struct HubToken(String);

impl HubConfig {
    /// Settings with this cache, and the public hub without a token.
    #[must_use]
    pub fn new(cache: PathBuf) -> Self {
        Self {
            cache,
            endpoint: PUBLIC_ENDPOINT.to_owned(),
            offline: false,
            symlinks: true,
            trust: None,
            token: None,
            first_wait: FIRST_WAIT,
        }
    }

    /// Reads the settings from the environment, with the variables of the hub's own client: `HF_HUB_CACHE`, else `hub`
    /// in `HF_HOME`, else `hub` in `huggingface` of `XDG_CACHE_HOME` or `~/.cache`; `HF_ENDPOINT`; `HF_TOKEN`;
    /// `HF_HUB_OFFLINE` and `WAYWORD_OFFLINE`; `HF_HUB_DISABLE_SYMLINKS`. A token file of the client's login command is
    /// not read.
    ///
    /// # Errors
    /// When there is neither a variable nor a home folder, or the token is not valid.
    pub fn from_env() -> Result<Self, LocalError> {
        Self::from_variables(&|name| std::env::var_os(name), std::env::home_dir().as_deref())
    }

    /// Like [`HubConfig::from_env`], with variables from a function and this home folder, for tests.
    pub(super) fn from_variables(
        variable: &dyn Fn(&str) -> Option<OsString>,
        home: Option<&Path>,
    ) -> Result<Self, LocalError> {
        let path = |name: &str| {
            let path = PathBuf::from(variable(name).filter(|value| !value.is_empty())?);
            // `~/` at the beginning is the home folder.
            Some(match (path.strip_prefix("~"), home) {
                (Ok(rest), Some(home)) => home.join(rest),
                _ => path,
            })
        };
        let text = |name: &str| {
            let text = variable(name)?.into_string().ok()?.trim().to_owned();
            (!text.is_empty()).then_some(text)
        };
        // The values that count as yes for the hub's own client.
        let is_yes = |value: String| ["1", "on", "yes", "true"].iter().any(|yes| value.eq_ignore_ascii_case(yes));
        let is_set = |name: &str| text(name).is_some_and(is_yes);
        let default_home = || Some(path("XDG_CACHE_HOME").or_else(|| Some(home?.join(".cache")))?.join("huggingface"));
        let cache = path("HF_HUB_CACHE")
            .or_else(|| path("HUGGINGFACE_HUB_CACHE"))
            .or_else(|| Some(path("HF_HOME").or_else(default_home)?.join("hub")));
        let cache = cache.ok_or_else(|| LocalError::Missing {
            file: PathBuf::from("~/.cache/huggingface/hub"),
            what: "the home folder, where models are kept,",
            hint: "put the path of a folder for models into the variable HF_HUB_CACHE".to_owned(),
        })?;
        Ok(Self {
            endpoint: text("HF_ENDPOINT").unwrap_or_else(|| PUBLIC_ENDPOINT.to_owned()),
            offline: ["WAYWORD_OFFLINE", "HF_HUB_OFFLINE", "TRANSFORMERS_OFFLINE"].iter().any(|name| is_set(name)),
            symlinks: !is_set("HF_HUB_DISABLE_SYMLINKS"),
            token: text("HF_TOKEN").map(|token| HubToken::new(&token)).transpose()?,
            ..Self::new(cache)
        })
    }
}

impl HubToken {
    pub(super) fn new(token: &str) -> Result<Self, LocalError> {
        if !token.bytes().all(|byte| (0x21..0x7f).contains(&byte)) {
            return Err(LocalError::download_failed(
                "HF_TOKEN",
                "the variable contains spaces or characters that no token has",
                "copy the token again from the settings page of the hub, or unset the variable",
            ));
        }
        Ok(Self(token.to_owned()))
    }

    /// The value of the header with the token.
    pub(super) fn header_value(&self) -> String {
        format!("Bearer {}", self.0)
    }
}

impl fmt::Debug for HubToken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("***")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(variables: &[(&str, &str)]) -> HubConfig {
        let variables: Vec<(String, String)> =
            variables.iter().map(|(name, value)| ((*name).to_owned(), (*value).to_owned())).collect();
        let variable = |name: &str| {
            variables.iter().find(|(known, _)| known == name).map(|(_, value)| OsString::from(value.clone()))
        };
        HubConfig::from_variables(&variable, Some(Path::new("/home/me"))).unwrap()
    }

    #[test]
    fn the_cache_is_where_the_hubs_own_client_has_it() {
        for (variables, cache) in [
            (&[][..], "/home/me/.cache/huggingface/hub"),
            (&[("XDG_CACHE_HOME", "/x")], "/x/huggingface/hub"),
            (&[("HF_HOME", "~/hf"), ("XDG_CACHE_HOME", "/x")], "/home/me/hf/hub"),
            (&[("HF_HUB_CACHE", "/c"), ("HF_HOME", "/h")], "/c"),
            (&[("HUGGINGFACE_HUB_CACHE", "/old"), ("HF_HUB_CACHE", "")], "/old"),
        ] {
            assert_eq!(read(variables).cache, Path::new(cache), "{variables:?}");
        }
    }

    #[test]
    fn three_variables_turn_the_network_off() {
        assert!(!read(&[]).offline && !read(&[("WAYWORD_OFFLINE", "0")]).offline);
        for name in ["WAYWORD_OFFLINE", "HF_HUB_OFFLINE", "TRANSFORMERS_OFFLINE"] {
            assert!(read(&[(name, "1")]).offline && read(&[(name, "True")]).offline, "{name}");
        }
        assert!(!read(&[("HF_HUB_DISABLE_SYMLINKS", "1")]).symlinks && read(&[]).symlinks);
    }

    #[test]
    fn debug_output_and_errors_hide_the_token() {
        let config = read(&[("HF_TOKEN", " hf_0123456789\n"), ("HF_ENDPOINT", "https://mirror.example")]);
        assert_eq!(config.token.as_ref().unwrap().header_value(), "Bearer hf_0123456789");
        let shown = format!("{config:?}");
        assert!(shown.contains("mirror.example") && shown.contains("***") && !shown.contains("0123456789"), "{shown}");
        let error = HubToken::new("hf_012 345").unwrap_err().to_string();
        assert!(error.contains("HF_TOKEN") && !error.contains("hf_012"), "{error}");
    }
}
