//! `wayword platforms`: lists the platforms, with the data that each needs and offers.

use std::fmt::Write as _;
use wayword_run::{
    error::{CommandError, Exit},
    output::CommandOutput,
    platforms::PLATFORMS,
};

pub(crate) fn list_platforms(output: &CommandOutput) -> Result<Exit, CommandError> {
    let mut text = String::new();
    for platform in PLATFORMS {
        let absent = if platform.is_here { "" } else { " (not in this build: --features full)" };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{}{absent}: {}", platform.name, platform.what);
        let _ = writeln!(text, "    needs:  {}\n    offers: {}", platform.needs, platform.offers);
    }
    output.print_result(&PLATFORMS, text);
    Ok(Exit::Done)
}
