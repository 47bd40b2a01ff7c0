//! `wayword report`.

use super::compare;
use crate::{
    cli::Report,
    error::{Error, Exit},
    output::Output,
    report,
    run::file,
};

pub(super) fn run(args: &Report, output: &Output) -> Result<Exit, Error> {
    let out = args.out.clone().unwrap_or_else(|| args.run.join(file::REPORT));
    if compare::is_comparison(&args.run) {
        let written = compare::write_of_folder(&args.run, &out, args.items)?;
        output.data(&written, &written);
        return Ok(Exit::Done);
    }
    let written = report::write(&args.run, &out, args.items)?;
    output.data(&written, &written);
    Ok(Exit::Done)
}
