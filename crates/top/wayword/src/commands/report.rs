//! `wayword report`.

use crate::{
    cli::Report,
    error::{Error, Exit},
    output::Output,
    report,
    run::file,
};

pub(super) fn run(args: &Report, output: &Output) -> Result<Exit, Error> {
    let out = args.out.clone().unwrap_or_else(|| args.run.join(file::REPORT));
    let written = report::write(&args.run, &out, args.items)?;
    output.data(&written, &written);
    Ok(Exit::Done)
}
