//! `wayword house`.

use crate::{
    cli::House,
    error::{Error, Exit},
    output::Output,
};
use wayword_house::{generate, save};

pub(super) fn run(args: &House, output: &Output) -> Result<Exit, Error> {
    std::fs::create_dir_all(&args.out).map_err(Error::io(&args.out, "make the folder"))?;
    let saved = save(&generate(args.seed), &args.out)?;
    let [semantics, names] = &saved.semantics;
    let files = [&saved.model, &saved.navigation, &saved.stage, semantics, names];
    output.data(&saved, files.map(|file| file.display().to_string()).join("\n"));
    Ok(Exit::Done)
}
