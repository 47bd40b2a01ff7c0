//! The command that each worker runs, and the check that it contains no password.

use super::{LaunchError, MAX_WORKERS, check::has_control};

/// The command that each worker runs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct LaunchWorker {
    /// The program: a name on the `PATH`, or a path. In Kubernetes it may be empty: then the image's own entry point runs.
    pub program: String,
    /// Its arguments, the command first.
    pub arguments: Vec<String>,
    /// How many workers there are.
    pub workers: u32,
}

impl LaunchWorker {
    /// Whether the script must add each worker's part, because the arguments name neither a queue nor a part.
    pub(super) fn needs_part(&self) -> bool {
        let names = |argument: &String, option: &str| {
            argument.strip_prefix(option).is_some_and(|rest| rest.is_empty() || rest.starts_with('='))
        };
        !self.arguments.iter().any(|argument| names(argument, "--queue") || names(argument, "--shard"))
    }

    /// Checks the command and the number of workers.
    ///
    /// # Errors
    /// When there is no worker or too many, or when an argument has a control character or a password.
    pub(super) fn check_worker(&self) -> Result<(), LaunchError> {
        if !(1..=MAX_WORKERS).contains(&self.workers) {
            return Err(LaunchError::Workers(self.workers));
        }
        for (position, text) in [&self.program].into_iter().chain(&self.arguments).enumerate() {
            if has_control(text) {
                return Err(LaunchError::Control { position });
            }
            if has_password(text) {
                return Err(LaunchError::Password { position });
            }
        }
        Ok(())
    }
}

/// Whether a text names a password with its value: `scheme://user:password@host` or `password=...`.
fn has_password(text: &str) -> bool {
    let lower = text.to_ascii_lowercase();
    let is_named = lower.split("password").skip(1).any(|rest| {
        let value = rest.trim_start().strip_prefix('=').map(str::trim_start);
        value.is_some_and(|value| !value.is_empty() && !value.starts_with('&'))
    });
    is_named || text.split("://").skip(1).any(has_user_with_password)
}

/// Whether the text after `://` begins with `user:password@`.
fn has_user_with_password(rest: &str) -> bool {
    let authority = rest.split(|c: char| c == '/' || c.is_whitespace()).next().unwrap_or_default();
    let user = authority.rsplit_once('@').map(|(user, _)| user);
    user.and_then(|user| user.split_once(':')).is_some_and(|(_, password)| !password.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worker(arguments: &[&str]) -> LaunchWorker {
        let arguments = arguments.iter().map(|&text| text.to_owned()).collect();
        LaunchWorker { program: "wayword".to_owned(), arguments, workers: 2 }
    }

    #[test]
    fn a_part_is_given_to_those_that_have_neither_a_part_nor_a_queue() {
        assert!(worker(&["generate", "--out", "runs/big"]).needs_part());
        assert!(worker(&["generate", "--queues", "--shards=2"]).needs_part());
        for has in [["--queue", "db"].as_slice(), &["--queue=db"], &["--shard", "1/2"], &["--shard=1/2"]] {
            assert!(!worker(has).needs_part(), "{has:?}");
        }
    }

    #[test]
    fn a_password_is_refused_and_not_repeated() {
        for wrong in [
            "postgresql://me:geheim@host/db",
            "--queue=postgresql://me:geheim@host:5432/db",
            "postgresql://me:ge?h#eim@host",
            "http://me:geheim@proxy",
            "host=h password=geheim",
            "host=h PassWord = geheim",
            "postgresql://me@host/db?sslpassword=geheim",
            "--db-password=geheim",
        ] {
            let error = worker(&["generate", wrong]).check_worker().unwrap_err();
            assert!(matches!(error, LaunchError::Password { position: 2 }), "{wrong}: {error}");
            assert!(!error.to_string().contains("geheim") && !format!("{error:?}").contains("geheim"), "{error}");
        }
    }

    #[test]
    fn a_name_without_a_password_is_taken() {
        for right in [
            "postgresql://me@host:5432/db",
            "http://vllm:8000/v1",
            "http://host:8000/a@b",
            "--password-env=PASSWORD",
            "me@host",
            "password",
        ] {
            worker(&["generate", right]).check_worker().unwrap();
        }
    }

    #[test]
    fn control_characters_and_wrong_numbers_of_workers_are_refused() {
        for wrong in ["a\nb", "a\r", "\0", "\u{1b}[2J", "a\u{85}b", "a\u{2028}b"] {
            let error = worker(&[wrong]).check_worker().unwrap_err();
            assert!(matches!(error, LaunchError::Control { position: 1 }), "{wrong:?}: {error}");
        }
        for wrong in [0, MAX_WORKERS + 1] {
            let error = LaunchWorker { workers: wrong, ..worker(&[]) }.check_worker().unwrap_err();
            assert!(error.to_string().starts_with(&format!("--workers {wrong}:")), "{error}");
        }
    }
}
