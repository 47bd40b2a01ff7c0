//! `wayword export`.

mod highlight;
mod in_habitat;

use crate::{
    cli::{AskedWorld, Export},
    count::count,
    error::{Error, Exit},
    output::Output,
    run::file,
    settings::AskedPlatform,
};
use in_habitat::World;
use serde::Serialize;
use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};
use wayword_core::ObjectId;
use wayword_formats::{
    Episode, Format, jsonl,
    jsonl::Record,
    r2r, reverie, rxr, split,
    vlnce::{self, Dataset},
    write_sidecar,
};

/// Height of the eye over the floor, metres: Matterport3D's camera, and the eye in houses. VLN-CE's positions are on
/// the floor.
const EYE_HEIGHT_M: f64 = 1.5;
/// Most scenes for which the screen says what they need.
const NEEDS_SHOWN: usize = 5;

/// What was written.
#[derive(Debug, Serialize)]
struct Written {
    instructions: usize,
    file: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    provenance: Option<PathBuf>,
    /// What the user has to do before Habitat finds the scenes.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    scene_needs: BTreeSet<String>,
}

pub(super) fn run(args: &Export, output: &Output) -> Result<Exit, Error> {
    match &args.highlight {
        Some(name) => highlight::write(args, name, output),
        None => dataset(args, output),
    }
}

/// What an export to a dataset needs: the format, and the file.
fn asked(args: &Export) -> Result<(Format, &Path), Error> {
    if args.texts.is_some() || args.platform != AskedPlatform::default() || args.world != AskedWorld::default() {
        let problem = "--texts, --world and the flags of a platform are for --highlight";
        return Err(Error::usage(problem, "leave them out, or give --highlight NAME"));
    }
    let lacks = |what: &str| {
        Error::usage(format!("{what} is missing"), "give --run, --format and --out for a dataset, or --highlight NAME")
    };
    if args.run.is_empty() {
        return Err(lacks("--run"));
    }
    let format = args.format.as_ref().ok_or_else(|| lacks("--format"))?;
    let format = format.parse().map_err(|error| Error::usage(format!("{error}"), "see wayword export --help"))?;
    Ok((format, args.out.as_deref().ok_or_else(|| lacks("--out"))?))
}

fn dataset(args: &Export, output: &Output) -> Result<Exit, Error> {
    let (format, out) = asked(args)?;
    let mut records = records(&args.run, args.style.as_deref())?;
    if out.exists() {
        output.say(format_args!("overwriting the old file {}", out.display()));
    }
    let mut scene_needs = BTreeSet::new();
    let provenance = if format == Format::Wayword {
        if let Some(share) = args.val_share {
            if !(0.0..=1.0).contains(&share) {
                return Err(Error::usage(format!("--val-share {share} is not a share"), "give a number from 0 to 1"));
            }
            split(&mut records, share, args.seed);
        }
        jsonl::write(out, &records)?;
        None
    } else {
        refuse_what_only_records_bear(args, format)?;
        refuse_without_poses(format, &records)?;
        let episodes = episodes(format, &args.run, &records, output);
        scene_needs.extend(episodes.iter().filter_map(|episode| episode.in_habitat.scene_needs.clone()));
        write_as(format, out, &records, episodes)?
    };
    if !scene_needs.is_empty() {
        output.say(format_args!(
            "do this so that Habitat finds the scenes (SCENES is its folder of scenes, scenes_dir):"
        ));
        scene_needs.iter().take(NEEDS_SHOWN).for_each(|needs| output.say(format_args!("  {needs}")));
        if let Some(more) = scene_needs.len().checked_sub(NEEDS_SHOWN).filter(|more| *more > 0) {
            output.say(format_args!("  and {more} more; info.scene_needs of each episode says what it needs"));
        }
    }
    let written = Written { instructions: records.len(), file: out.to_owned(), provenance, scene_needs };
    let beside =
        written.provenance.as_ref().map_or(String::new(), |file| format!("; provenance in {}", file.display()));
    output.data(
        &written,
        format_args!("{} written to {}{beside}", count(written.instructions, "instruction"), out.display()),
    );
    Ok(Exit::Done)
}

/// The records of runs, merged; only those of one style if it is named.
fn records(runs: &[PathBuf], style: Option<&str>) -> Result<Vec<Record>, Error> {
    let files: Vec<PathBuf> = runs.iter().map(|run| run.join(file::INSTRUCTIONS)).collect();
    let mut records = jsonl::merge(&files)?;
    let styles: BTreeSet<String> = records.iter().map(|record| record.instruction.style.clone()).collect();
    records.retain(|record| style.is_none_or(|style| record.instruction.style == style));
    if records.is_empty() {
        let runs = runs.iter().map(|run| run.display().to_string()).collect::<Vec<_>>().join(", ");
        return Err(match style.filter(|_| !styles.is_empty()) {
            Some(style) => {
                let styles = styles.into_iter().collect::<Vec<_>>().join(", ");
                Error::usage(format!("{runs}: no instruction of style {style}"), format!("there are: {styles}"))
            }
            None => Error::usage(format!("{runs}: no instruction"), "see errors.jsonl and rejected.jsonl of the run"),
        });
    }
    Ok(records)
}

fn refuse_what_only_records_bear(args: &Export, format: Format) -> Result<(), Error> {
    if args.run.len() > 1 {
        let problem = format!("format {format} takes one run only");
        return Err(Error::usage(problem, "merge runs with --format wayword"));
    }
    if args.val_share.is_some() {
        return Err(Error::usage(
            format!("format {format} has no splits within a file"),
            "use --val-share with --format wayword",
        ));
    }
    if args.style.is_none() {
        return Err(Error::usage(
            format!("a file of format {format} has texts of one style only"),
            "choose it with --style",
        ));
    }
    Ok(())
}

/// Whether items have a place for provenance: VLN-CE's loader fails on unknown fields, and an R2R item holds several
/// instructions.
fn bears_provenance(format: Format) -> bool {
    matches!(format, Format::Reverie | Format::Rxr)
}

/// The records as items of one of the field's formats.
fn episodes(format: Format, runs: &[PathBuf], records: &[Record], output: &Output) -> Vec<Episode> {
    let mut episodes: Vec<Episode> = records.iter().map(|record| episode(record, bears_provenance(format))).collect();
    if let (Format::Vlnce, [run]) = (format, runs) {
        let mut world = World::of(run, records);
        for (record, episode) in records.iter().zip(&mut episodes) {
            world.tell(record, episode);
        }
        if let Some(warning) = world.warning() {
            output.say(warning);
        }
    }
    if format == Format::Reverie { gathered(episodes) } else { episodes }
}

/// Writes one of the field's formats, and a file of provenance beside it if the format's items have no place for that.
fn write_as(format: Format, file: &Path, records: &[Record], episodes: Vec<Episode>) -> Result<Option<PathBuf>, Error> {
    match format {
        Format::R2r => r2r::write(file, &episodes)?,
        Format::Reverie => reverie::write(file, &episodes)?,
        Format::Rxr => rxr::write(file, &episodes)?,
        Format::Vlnce => vlnce::write(file, &Dataset::of(episodes))?,
        Format::Wayword => jsonl::write(file, records)?,
    }
    if bears_provenance(format) {
        return Ok(None);
    }
    let lines: Vec<Value> = records
        .iter()
        .map(|record| json!({"path": record.path.id, "text": record.instruction.text, "wayword": about(record)}))
        .collect();
    Ok(Some(write_sidecar(file, &lines)?))
}

/// Refuses recordings without poses, because all of the field's formats say where the agent stands and looks.
fn refuse_without_poses(format: Format, records: &[Record]) -> Result<(), Error> {
    match records.iter().find(|record| !record.path.motion.is_known()) {
        Some(record) => Err(Error::usage(
            format!("format {format} needs poses, and path {} is from a recording without poses", record.path.id),
            "use --format wayword",
        )),
        None => Ok(()),
    }
}

/// REVERIE names an item by its path and object. Items that share a path, a start and an object, or have none, become one
/// item with several instructions; those without an object that start with another heading become another path.
fn gathered(episodes: Vec<Episode>) -> Vec<Episode> {
    let mut items: Vec<Episode> = Vec::new();
    let mut starts: BTreeMap<(String, Option<ObjectId>, Option<u64>), usize> = BTreeMap::new();
    let mut starts_of_path: BTreeMap<String, usize> = BTreeMap::new();
    for mut episode in episodes {
        let object = episode.target_object.clone();
        let start = (episode.path_id.clone(), object, episode.start_heading.map(|heading| heading.rad().to_bits()));
        if let Some(at) = starts.get(&start) {
            join(&mut items[*at], episode);
            continue;
        }
        if episode.target_object.is_some() {
            starts.insert(start, items.len());
            items.push(episode);
            continue;
        }
        let others = starts_of_path.entry(episode.path_id.clone()).or_default();
        if *others > 0 {
            episode.path_id = format!("{}-{others}", episode.path_id);
        }
        *others += 1;
        starts.insert(start, items.len());
        items.push(episode);
    }
    items
}

fn join(item: &mut Episode, other: Episode) {
    item.instructions.extend(other.instructions);
    for (key, value) in other.extra {
        if let (Some(Value::Array(all)), Value::Array(more)) = (item.extra.get_mut(&key), value) {
            all.extend(more);
        }
    }
}

/// A record as an item of a dataset. Provenance is a list, one entry for each instruction.
fn episode(record: &Record, with_provenance: bool) -> Episode {
    let mut episode =
        Episode::from_path(&record.path, vec![record.instruction.text.clone()]).on_floor_of(&record.path, EYE_HEIGHT_M);
    episode.path_id = record.path_id();
    if with_provenance {
        episode.extra.insert("wayword".into(), json!([about(record)]));
    }
    episode
}

fn about(record: &Record) -> Value {
    json!({
        "verdict": record.instruction.verdict,
        "provenance": record.instruction.provenance,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{Heading, SceneId};

    fn episode(path_id: &str, object: Option<&str>, heading: f64, text: &str) -> Episode {
        let mut episode = Episode::new(text, path_id, SceneId::new("s").unwrap());
        episode.target_object = object.map(|object| ObjectId::new(object).unwrap());
        episode.start_heading = Some(Heading::new(heading).unwrap());
        episode.instructions = vec![text.to_owned()];
        episode.extra.insert("wayword".into(), json!([text]));
        episode
    }

    #[test]
    fn items_without_an_object_gather_by_path_and_start() {
        let items = gathered(vec![
            episode("7", None, 1.0, "a"),
            episode("7", Some("3"), 1.0, "b"),
            episode("7", None, 1.0, "c"),
            episode("7", None, 2.0, "d"),
            episode("7", Some("3"), 1.0, "e"),
        ]);
        let told: Vec<_> = items.iter().map(|item| (item.path_id.as_str(), item.instructions.join(" "))).collect();
        assert_eq!(told, [("7", "a c".into()), ("7", "b e".into()), ("7-1", "d".into())]);
        assert_eq!(items[0].extra["wayword"], json!(["a", "c"]));
    }
}
