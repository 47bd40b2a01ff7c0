//! A build that holds no models.

use crate::{
    cli::Models,
    error::{Error, Exit},
    output::Output,
};

/// Refuses.
pub(in crate::commands) fn run(_: &Models, _: &Output) -> Result<Exit, Error> {
    Err(Error::usage(
        "models cannot be fetched or listed: this build runs none in process",
        "build it with `cargo build --release --features full`",
    ))
}
