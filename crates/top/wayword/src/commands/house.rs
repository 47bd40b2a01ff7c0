//! `wayword house`.

use crate::{
    cli::House,
    error::{Error, Exit},
    output::Output,
};
use serde::Serialize;
use std::path::PathBuf;
use wayword_platforms::house::{generate, save};

#[derive(Serialize)]
struct Saved {
    model: PathBuf,
    navigation: PathBuf,
}

pub(super) fn run(args: &House, output: &Output) -> Result<Exit, Error> {
    std::fs::create_dir_all(&args.out).map_err(Error::io(&args.out, "make the folder"))?;
    let [model, navigation] = save(&generate(args.seed), &args.out)?;
    let text = format!("{}\n{}", model.display(), navigation.display());
    output.data(&Saved { model, navigation }, text);
    Ok(Exit::Done)
}
