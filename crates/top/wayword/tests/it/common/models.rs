//! Shared by the tests with models: a provider that plays every role, and runs of the binary against it.

#![allow(dead_code, reason = "each test binary uses its own part")]

use crate::common::{self, Building, Ran, run};
use std::{path::Path, process::Command};
use wayword_testkit::provider::{
    PictureGallery, ProviderBehaviour, ProviderDialect, ScriptedProvider,
    scripts::{FlawedEye, ScriptedCast},
};

/// The variable that holds the provider's key.
pub(crate) const KEY_ENV: &str = "WAYWORD_TEST_KEY";
/// The key. No other text contains this string.
pub(crate) const KEY: &str = "sk-test-7f3b19c2d4e5f6a7";

/// A provider's behaviour with a careless cast behind two names.
pub(crate) fn cast() -> ProviderBehaviour {
    cast_as(["words", "eye"])
}

/// The same behind names of the caller's choice.
pub(crate) fn cast_as<const N: usize>(models: [&str; N]) -> ProviderBehaviour {
    let cast = ScriptedCast::new(FlawedEye::new(PictureGallery::default(), 1, 0.15), 1, 0.2);
    models.into_iter().fold(ProviderBehaviour::default(), |behaviour, model| behaviour.and_model(model, cast.clone()))
}

/// The building with pictures, and a provider.
pub(crate) struct Stage {
    pub(crate) building: Building,
    pub(crate) provider: ScriptedProvider,
}

impl Stage {
    pub(crate) fn new(behaviour: ProviderBehaviour) -> Self {
        let building = Building::new();
        wayword_testkit::write_distinct_skyboxes(&building.data()).unwrap();
        Self { building, provider: ScriptedProvider::start(behaviour).unwrap() }
    }

    /// The flags that name the models.
    pub(crate) fn models(&self) -> Vec<String> {
        let base = self.provider.base_url(ProviderDialect::OpenAi);
        [
            "--llm",
            "server/words",
            "--see",
            "server/eye",
            "--base-url",
            &base,
            "--ledger",
            "ledger.db",
            "--key-env",
            KEY_ENV,
        ]
        .map(str::to_owned)
        .to_vec()
    }

    /// `wayword COMMAND --platform matterport --data data MODELS ARGS` with the key in the environment.
    pub(crate) fn command(&self, command: &str, args: &[&str]) -> Command {
        let models = self.models();
        let mut all = vec![command, "--platform", "matterport", "--data", "data"];
        all.extend(models.iter().map(String::as_str));
        all.extend(args);
        let mut command = self.building.command(&all);
        command.env(KEY_ENV, KEY);
        command
    }

    /// The same for `generate --out OUT --style r2r --hops 3..7 --evidence captions ARGS`.
    pub(crate) fn generating(&self, out: &str, args: &[&str]) -> Command {
        let mut all = vec!["--out", out, "--style", "r2r", "--hops", "3..7", "--evidence", "captions"];
        all.extend(args);
        self.command("generate", &all)
    }

    pub(crate) fn generate(&self, out: &str, args: &[&str]) -> Ran {
        run(&mut self.generating(out, args))
    }

    /// Whether a run here and a run of `other` wrote the same files, byte for byte.
    pub(crate) fn same_results(&self, other: &Self, out: &str) -> bool {
        ["walks.jsonl", "instructions.jsonl", "rejected.jsonl"].iter().all(|name| {
            let read = |stage: &Self| std::fs::read(stage.building.path(out).join(name)).unwrap();
            read(self) == read(other)
        })
    }
}

/// Asserts that the key is in no file below a folder.
pub(crate) fn holds_no_key(folder: &Path) {
    for (name, bytes) in common::files(folder) {
        let held = bytes.windows(KEY.len()).any(|window| window == KEY.as_bytes());
        assert!(!held, "{} holds the key", name.display());
    }
}
