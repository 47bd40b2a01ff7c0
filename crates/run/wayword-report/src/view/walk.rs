//! Finds the path to show: one of a file of episodes or records, or a random one.

use crate::view::args::Walk;
use std::path::Path as FilePath;
use wayword_core::{Path, Platform};
use wayword_formats::{Format, detect, jsonl};
use wayword_run::{
    error::Error,
    item::{self, Item},
    settings::{Asked, AskedPlatform, Draw, Walks},
};

/// Most items that an error names.
const TOLD: usize = 5;

/// The path that the flags choose.
///
/// # Errors
/// When there is no path of that kind or name, or files cannot be read.
pub(super) fn path(walk: &Walk, asked: &AskedPlatform, platform: &dyn Platform) -> Result<Path, Error> {
    if let Some(file) = &walk.episodes
        && detect(file)? == Format::Wayword
    {
        // Its records hold their paths frame by frame; only on some platforms do these follow viewpoints.
        return recorded(file, walk);
    }
    let asked = Asked {
        walks: Walks {
            episodes: walk.episodes.clone(),
            paths: walk.episodes.is_none().then_some(1),
            scan: walk.scan.clone().map(|scan| vec![scan]),
            hops: walk.hops.clone(),
            metres: walk.metres.clone(),
        },
        draw: Draw { seed: walk.seed, ..Draw::default() },
        ..Asked::from(asked.clone())
    };
    let settings = asked.resolve()?;
    let items = item::items(&settings, platform)?;
    let chosen = items.iter().find(|item| walk.item.as_deref().is_none_or(|id| item.id() == id));
    let chosen = chosen.ok_or_else(|| absent(walk, items.iter().map(Item::id)))?;
    Ok(chosen.path(&settings, platform)?)
}

/// The path of a record in a file of Wayword's own format.
fn recorded(file: &FilePath, walk: &Walk) -> Result<Path, Error> {
    let records = jsonl::read(file)?;
    let in_scene = |path: &Path| walk.scan.as_deref().is_none_or(|scan| path.scene.as_str() == scan);
    let paths = || records.iter().map(|record| &record.path).filter(|path| in_scene(path));
    let chosen = paths().find(|path| walk.item.as_ref().is_none_or(|id| path.id == *id));
    if paths().next().is_none() {
        let of_scene = walk.scan.as_ref().map_or_else(String::new, |scan| format!(" in scene {scan}"));
        return Err(Error::usage(
            format!("{}: it has no path{of_scene}", file.display()),
            "give another --scan or file",
        ));
    }
    chosen.cloned().ok_or_else(|| absent(walk, paths().map(|path| path.id.clone())))
}

fn absent(walk: &Walk, ids: impl Iterator<Item = String>) -> Error {
    let mut some: Vec<String> = ids.collect();
    some.dedup();
    let more = if some.len() > TOLD { " ..." } else { "" };
    some.truncate(TOLD);
    let problem = format!("--item {}: there is no such item", walk.item.as_deref().unwrap_or_default());
    Error::usage(problem, format!("there are: {}{more}", some.join(", ")))
}
