//! Converts records to items of R2R, REVERIE, RxR and VLN-CE, and writes these formats.

use super::habitat_scenes::HabitatSceneSource;
use crate::export::args::ExportFormat;
use serde_json::{Value, json};
use std::{
    collections::{BTreeMap, btree_map::Entry},
    path::{Path, PathBuf},
};
use wayword_core::{ObjectId, SceneId};
use wayword_formats::{
    DatasetFormat, Episode, jsonl,
    jsonl::InstructionRecord,
    r2r, reverie, rxr,
    vlnce::{self, VlnceDataset},
    write_sidecar,
};
use wayword_run::{error::CommandError, output::CommandOutput};

/// Height of the eye over the floor, metres: Matterport3D's camera, and the eye in houses. VLN-CE's positions are on
/// the floor.
const EYE_HEIGHT_M: f64 = 1.5;

/// Whether items have a place for provenance: VLN-CE's loader fails on unknown fields, and an R2R item holds several
/// instructions.
fn bears_provenance(format: DatasetFormat) -> bool {
    matches!(format, DatasetFormat::Reverie | DatasetFormat::Rxr)
}

/// The records as items, one for each.
pub fn episodes_from_records(
    format: DatasetFormat,
    runs: &[PathBuf],
    records: &[InstructionRecord],
    output: &CommandOutput,
) -> Vec<Episode> {
    let mut episodes: Vec<Episode> =
        records.iter().map(|record| episode_from_record(record, bears_provenance(format))).collect();
    if let (DatasetFormat::Vlnce, [run]) = (format, runs) {
        let mut world = HabitatSceneSource::from_run(run, records);
        // Scene by scene, because a scene takes long to read, and only a few are kept.
        let mut pairs: Vec<_> = records.iter().zip(&mut episodes).collect();
        pairs.sort_by(|(a, _), (b, _)| a.path.scene.cmp(&b.path.scene));
        let bar = output.progress_bar(pairs.len(), "episodes");
        for (record, episode) in pairs {
            world.describe_scene(record, episode);
            bar.inc(1);
        }
        bar.finish_and_clear();
        if let Some(warning) = world.lack_warning() {
            output.say(warning);
        }
    }
    episodes
}

/// Writes one of these formats. If its items have no place for provenance, that goes into a second file in the same folder, and the
/// name of that file is returned.
pub fn write_items(
    format: DatasetFormat,
    file: &Path,
    records: &[InstructionRecord],
    episodes: Vec<Episode>,
) -> Result<Option<PathBuf>, CommandError> {
    match format {
        DatasetFormat::R2r => r2r::write_r2r_file(file, &episodes)?,
        DatasetFormat::Reverie => reverie::write_reverie_file(file, &gather_reverie_items(episodes))?,
        DatasetFormat::Rxr => rxr::write_rxr_file(file, &episodes)?,
        DatasetFormat::Vlnce => {
            vlnce::write_vlnce_file(file, &VlnceDataset::from_episodes(gather_path_items(episodes)))?;
        }
        DatasetFormat::Wayword => jsonl::write_records(file, records)?,
        DatasetFormat::Streamvln | DatasetFormat::Navila | DatasetFormat::Internnav | DatasetFormat::Lerobot => {
            let problem = format!("format {format} has pictures too, and is no file of items");
            return Err(CommandError::usage(problem, format!("use `wayword export --format {format}`")));
        }
    }
    if bears_provenance(format) {
        return Ok(None);
    }
    write_provenance(file, records)
}

/// Writes the provenance of records into a second file beside a dataset, and returns its name.
pub(super) fn write_provenance(file: &Path, records: &[InstructionRecord]) -> Result<Option<PathBuf>, CommandError> {
    let lines: Vec<Value> = records
        .iter()
        .map(|record| json!({"path": record.path.id, "text": record.instruction.text, "wayword": provenance_json(record)}))
        .collect();
    Ok(write_sidecar(file, &lines)?)
}

/// A name for the episode of each record, in their order: that of its path, and where a path has several texts also the
/// style and the number of the text.
#[cfg(feature = "habitat")]
pub fn episode_names(records: &[InstructionRecord]) -> Vec<String> {
    let mut texts: BTreeMap<&str, usize> = BTreeMap::new();
    for record in records {
        *texts.entry(&record.path.id).or_default() += 1;
    }
    let mut taken = std::collections::BTreeSet::new();
    let name = |record: &InstructionRecord| match texts.get(record.path.id.as_str()) {
        Some(1) => record.path.id.clone(),
        _ => format!("{}-{}", record.path.id, wayword_run::run_folder::text_file_name(record)),
    };
    let free = |name: String| {
        let other = (2..).map(|number| format!("{name}_{number}"));
        let found = std::iter::once(name.clone()).chain(other).find(|name| taken.insert(name.clone()));
        found.unwrap_or(name)
    };
    records.iter().map(name).map(free).collect()
}

/// Refuses recordings without poses, because all of these formats contain the agent's position and heading.
pub(super) fn refuse_without_poses(format: ExportFormat, records: &[InstructionRecord]) -> Result<(), CommandError> {
    match records.iter().find(|record| !record.path.motion.is_known()) {
        Some(record) => Err(CommandError::usage(
            format!("format {format} needs poses, and path {} is from a recording without poses", record.path.id),
            "use --format wayword",
        )),
        None => Ok(()),
    }
}

/// REVERIE names an item by its path and object. Items that share a path, a start and an object, or have none, become one
/// item with several instructions; those without an object that start with another heading become another path.
fn gather_reverie_items(episodes: Vec<Episode>) -> Vec<Episode> {
    let mut items: Vec<Episode> = Vec::new();
    let mut starts: BTreeMap<(String, Option<ObjectId>, Option<u64>), usize> = BTreeMap::new();
    let mut starts_of_path: BTreeMap<String, usize> = BTreeMap::new();
    for mut episode in episodes {
        let object = episode.target_object.clone();
        let start = (episode.path_id.clone(), object, episode.start_heading.map(|heading| heading.rad().to_bits()));
        if let Some(at) = starts.get(&start) {
            join_episodes(&mut items[*at], episode);
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

/// VLN-CE names an episode by its item and the number of the text, so the texts of one path become one item.
fn gather_path_items(episodes: Vec<Episode>) -> Vec<Episode> {
    let mut items: Vec<Episode> = Vec::new();
    let mut places: BTreeMap<(String, SceneId), usize> = BTreeMap::new();
    for episode in episodes {
        match places.entry((episode.id.clone(), episode.scene.clone())) {
            Entry::Occupied(place) => join_episodes(&mut items[*place.get()], episode),
            Entry::Vacant(place) => {
                place.insert(items.len());
                items.push(episode);
            }
        }
    }
    items
}

fn join_episodes(item: &mut Episode, other: Episode) {
    item.instructions.extend(other.instructions);
    item.encodings.extend(other.encodings);
    for (key, value) in other.extra {
        if let (Some(Value::Array(all)), Value::Array(more)) = (item.extra.get_mut(&key), value) {
            all.extend(more);
        }
    }
}

/// A record as an item of a dataset. Provenance is a list, one entry for each instruction.
fn episode_from_record(record: &InstructionRecord, with_provenance: bool) -> Episode {
    let mut episode = Episode::from_path(&record.path, vec![record.instruction.text.clone()])
        .with_floor_positions(&record.path, EYE_HEIGHT_M);
    episode.path_id = record.path_id();
    if with_provenance {
        episode.extra.insert("wayword".into(), json!([provenance_json(record)]));
    }
    episode
}

fn provenance_json(record: &InstructionRecord) -> Value {
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
    fn reverie_items_without_an_object_gather_by_path_and_start() {
        let items = gather_reverie_items(vec![
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
