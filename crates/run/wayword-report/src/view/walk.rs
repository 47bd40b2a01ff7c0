//! Finds the path to show: one of a file of episodes or records, or a random one.

use crate::view::args::ShownPathArgs;
use std::path::Path as FilePath;
use wayword_core::{Path, Platform};
use wayword_formats::{DatasetFormat, detect_format, jsonl};
use wayword_run::{
    error::CommandError,
    item::{self, RunItem},
    settings::{AskedPlatform, AskedSettings, Draw, Walks},
};

/// Most items that an error names.
const MAX_NAMED_ITEMS: usize = 5;

/// The path that the flags choose.
///
/// # Errors
/// When there is no path of that kind or name, or files cannot be read.
pub(super) fn choose_path(
    walk: &ShownPathArgs,
    asked: &AskedPlatform,
    platform: &dyn Platform,
) -> Result<Path, CommandError> {
    if let Some(file) = &walk.episodes
        && detect_format(file)? == DatasetFormat::Wayword
    {
        // Its records hold their paths frame by frame; only on some platforms do these follow viewpoints.
        return recorded_path(file, walk);
    }
    let asked = AskedSettings {
        walks: Walks {
            houses: None,
            episodes: walk.episodes.clone(),
            paths: walk.episodes.is_none().then_some(1),
            scan: walk.scan.clone().map(|scan| vec![scan]),
            hops: walk.hops.clone(),
            metres: walk.metres.clone(),
        },
        draw: Draw { seed: walk.seed, ..Draw::default() },
        ..AskedSettings::from(asked.clone())
    };
    let settings = asked.resolve()?;
    let items = item::run_items(&settings, platform)?;
    let chosen = items.iter().find(|item| walk.item.as_deref().is_none_or(|id| item.id() == id));
    let chosen = chosen.ok_or_else(|| absent_item(walk, items.iter().map(RunItem::id)))?;
    Ok(chosen.find_path(&settings, platform)?)
}

/// The path of a record in a file of Wayword's own format.
fn recorded_path(file: &FilePath, walk: &ShownPathArgs) -> Result<Path, CommandError> {
    let records = jsonl::read_records(file)?;
    let in_scene = |path: &Path| walk.scan.as_deref().is_none_or(|scan| path.scene.as_str() == scan);
    let paths = || records.iter().map(|record| &record.path).filter(|path| in_scene(path));
    let chosen = paths().find(|path| walk.item.as_ref().is_none_or(|id| path.id == *id));
    if paths().next().is_none() {
        let of_scene = walk.scan.as_ref().map_or_else(String::new, |scan| format!(" in scene {scan}"));
        return Err(CommandError::usage(
            format!("{}: it has no path{of_scene}", file.display()),
            "give another --scan or file",
        ));
    }
    chosen.cloned().ok_or_else(|| absent_item(walk, paths().map(|path| path.id.clone())))
}

fn absent_item(walk: &ShownPathArgs, ids: impl Iterator<Item = String>) -> CommandError {
    let mut some: Vec<String> = ids.collect();
    some.dedup();
    let more = if some.len() > MAX_NAMED_ITEMS { " ..." } else { "" };
    some.truncate(MAX_NAMED_ITEMS);
    let problem = format!("--item {}: there is no such item", walk.item.as_deref().unwrap_or_default());
    CommandError::usage(problem, format!("there are: {}{more}", some.join(", ")))
}
