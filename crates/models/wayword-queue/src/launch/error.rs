//! Errors of the launchers.

use super::MAX_WORKERS;

/// No text can be made for a launcher.
#[derive(Debug, thiserror::Error)]
pub enum LaunchError {
    /// A value cannot be used. The value itself is not repeated where it may be a secret.
    #[error("{option}: {problem}\nhint: {hint}")]
    Value {
        /// The option that gives it.
        option: &'static str,
        /// The problem.
        problem: String,
        /// How the user can fix it.
        hint: &'static str,
    },
    /// There would be no worker, or too many.
    #[error("--workers {0}: this is no number of workers\nhint: give a number from 1 to {MAX_WORKERS}")]
    Workers(u32),
    /// An argument of the worker has a character that must not be in a script.
    #[error("argument {position} of the worker has a line break or another control character\nhint: take it out")]
    Control {
        /// Which, from 1; the program itself is 0.
        position: usize,
    },
    /// An argument of the worker holds a password. It is not repeated.
    #[error(
        "argument {position} of the worker holds a password, which the script, lists of processes and logs would show\nhint: take it out; name the secret instead: PGPASSFILE, or an environment variable for --password-env"
    )]
    Password {
        /// Which, from 1; the program itself is 0.
        position: usize,
    },
    /// The template is broken.
    #[error("the text cannot be written: {0:#}\nhint: report this as a bug")]
    Template(#[from] minijinja::Error),
}
