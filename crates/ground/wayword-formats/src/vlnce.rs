//! VLN-CE: episodes in Habitat's frame, with a vocabulary.
//!
//! `{episodes, instruction_vocab: {word_list}}`; RxR's files have no vocabulary. An episode has `episode_id`, `trajectory_id`, `scene_id`
//! ("mp3d/SCAN/SCAN.glb"), `start_position`, `start_rotation` (x, y, z, w), `goals` (`position`, `radius`),
//! `reference_path`, `instruction` (`instruction_text`, `instruction_tokens`) and `info`. Its loader builds an episode
//! from exactly these keys and crashes on any other. So no other key is written, and unknown fields of a file that was
//! read are lost.
//!
//! The reader converts positions to the world frame, and the writer converts them back. They lie on the floor. A
//! Matterport3D viewpoint is the camera, about 1.5 m above it, so the caller gives floor positions
//! ([`Episode::floor_positions`]).

use crate::{
    DatasetItem, Episode, FormatError,
    habitat::{habitat_from_heading, habitat_from_wayword, heading_from_habitat, wayword_from_habitat},
    input, limits, output,
    read_tally::ReadTally,
    rxr::language_tag,
    vocabulary::TokenVocabulary,
};
use serde_json::{Map, Value, json};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};
use wayword_core::{DVec3, SceneId};

/// Within this distance of the goal an agent has arrived, metres (VLN-CE's own value).
const GOAL_RADIUS_M: f64 = 3.0;

/// The contents of a VLN-CE file.
#[derive(Debug, Clone, PartialEq)]
pub struct VlnceDataset {
    /// Its episodes. After reading, each has one instruction.
    pub episodes: Vec<Episode>,
    /// The words of their tokens. Keep it, because a trained agent knows the numbers of one vocabulary only.
    pub vocabulary: TokenVocabulary,
}

impl VlnceDataset {
    /// Episodes, with a vocabulary made from their words.
    #[must_use]
    pub fn from_episodes(episodes: Vec<Episode>) -> Self {
        let texts = episodes.iter().flat_map(|episode| &episode.instructions);
        Self { vocabulary: TokenVocabulary::from_texts(texts.map(String::as_str)), episodes }
    }
}

/// Reads a VLN-CE file of R2R or RxR, plain or gzip. Where it has no vocabulary, a new one is made from its words.
///
/// # Errors
/// When the file cannot be read or is not JSON, a field of an episode is missing or wrong, or an `episode_id` is given
/// twice.
pub fn read_vlnce_file(file: &Path) -> Result<VlnceDataset, FormatError> {
    let mut episodes = Vec::new();
    let mut tokens = BTreeMap::new();
    let mut tally = ReadTally::default();
    let mut rest = input::each_item_in(file, "episodes", |mut item| {
        let episode = take_episode(&mut item, &mut tokens)?;
        tally.claim_name(&item, "episode_id", &episode)?;
        // Unknown fields cannot be written back, so they are not kept.
        let episode = tally.finish_episode(episode, item)?;
        episodes.push(Episode { extra: Map::new(), ..episode });
        Ok(())
    })?;
    let Some(words) = word_list(file, rest.remove("instruction_vocab"))? else {
        // Tokens mean nothing without the list that numbers them: RxR's are those of language models.
        return Ok(VlnceDataset::from_episodes(episodes));
    };
    let mut vocabulary = TokenVocabulary::new(words);
    vocabulary.remember_tokens(tokens);
    Ok(VlnceDataset { episodes, vocabulary })
}

/// The vocabulary's list of words. RxR's files have none.
fn word_list(file: &Path, vocabulary: Option<Value>) -> Result<Option<Vec<String>>, FormatError> {
    let Some(words) = vocabulary.and_then(|vocabulary| vocabulary.get("word_list").cloned()) else { return Ok(None) };
    serde_json::from_value(words).map(Some).map_err(|_| {
        let problem = "field \"instruction_vocab.word_list\": expected a list of words";
        FormatError::for_document(file, problem, "leave it out, and Wayword makes a new one")
    })
}

fn take_episode(item: &mut DatasetItem<'_>, tokens: &mut BTreeMap<String, Vec<u64>>) -> Result<Episode, FormatError> {
    let id = item.take_field("episode_id")?;
    let id_text = item.checked_name("episode_id", &id)?;
    item.set_id(&id_text);
    // VLN-CE's loader fills in what may be missing: the names of paths here, the goals below.
    let trajectory = item.take_optional("trajectory_id").filter(|name| !name.is_null()).unwrap_or_else(|| id.clone());
    let scene_file = item.take_field("scene_id")?;
    let mut episode =
        Episode::new(id_text, item.checked_name("trajectory_id", &trajectory)?, scene_from_mesh(item, &scene_file)?);
    episode.remember_spelling("episode_id", id);
    episode.remember_spelling("trajectory_id", trajectory);
    episode.remember_spelling("scene_id", scene_file);
    take_positions(item, &mut episode)?;
    take_instruction(item, &mut episode, tokens)?;
    if let Some(info) = item.take_optional("info") {
        if !info.is_object() && !info.is_null() {
            return Err(item.wrong_field("info", "expected an object", "leave it out where there is nothing to say"));
        }
        if let Some(metres) = info.get("geodesic_distance").and_then(Value::as_f64).filter(|metres| *metres < 0.0) {
            let problem = format!("it is {metres:?}, and a distance is not negative");
            return Err(item.wrong_field("info.geodesic_distance", problem, "write metres, or leave it out"));
        }
        episode.remember_spelling("info", info);
    }
    Ok(episode)
}

/// The scene of a mesh file: the file's name without its ending.
fn scene_from_mesh(item: &DatasetItem<'_>, value: &Value) -> Result<SceneId, FormatError> {
    const HINT: &str = "write it as mp3d/SCAN/SCAN.glb";
    let text = item.checked_text("scene_id", value)?;
    let outside = text.starts_with('/') || text.split('/').any(|part| part == "..");
    if outside || text.contains('\\') {
        return Err(item.wrong_field("scene_id", "it points outside the folder of scenes", HINT));
    }
    SceneId::new(bare_scene(text)).map_err(|error| item.wrong_field("scene_id", error.to_string(), HINT))
}

/// A file's name without folders and endings: "SCAN" of "mp3d/SCAN/SCAN.glb".
fn bare_scene(mesh: &str) -> &str {
    let name = mesh.rsplit('/').next().unwrap_or(mesh);
    let bare = name.rsplit_once('.').map_or(name, |(bare, _)| bare);
    // HM3D's stages are x.basis.glb, and a stage may be named by its configuration.
    [".basis", ".stage_config"].iter().find_map(|ending| bare.strip_suffix(ending)).unwrap_or(bare)
}

/// Takes the path with its start and goals. Where there is no path, start and first goal are the path.
fn take_positions(item: &mut DatasetItem<'_>, episode: &mut Episode) -> Result<(), FormatError> {
    let start = item.take_field("start_position")?;
    let start_floor = item.checked_position("start_position", &start)?;
    let rotation = item.take_field("start_rotation")?;
    let heading = heading_from_habitat(item.checked_numbers("start_rotation", &rotation)?);
    episode.start_heading = Some(heading.ok_or_else(|| {
        item.wrong_field("start_rotation", "it gives no heading", "write a quaternion of length 1 as x, y, z, w")
    })?);
    let goals = item.take_optional("goals").unwrap_or_default();
    let goal_floors = goal_positions(item, &goals)?;
    let path = item.take_optional("reference_path").unwrap_or_default();
    let floors = if path.is_null() {
        std::iter::once(start_floor).chain(goal_floors.into_iter().take(1)).collect()
    } else {
        let floors = checked_positions(item, "reference_path", &path)?;
        refuse_far_ends(item, &floors, start_floor, &goal_floors)?;
        floors
    };
    episode.floor_positions = floors.into_iter().map(wayword_from_habitat).collect();
    for (field, value) in
        [("start_position", start), ("start_rotation", rotation), ("goals", goals), ("reference_path", path)]
    {
        episode.remember_spelling(field, value);
    }
    Ok(())
}

/// Refuses a start or goals that lie farther from the path's ends than an agent may stop from a goal.
fn refuse_far_ends(item: &DatasetItem<'_>, floors: &[DVec3], start: DVec3, goals: &[DVec3]) -> Result<(), FormatError> {
    let (Some(first), Some(last)) = (floors.first(), floors.last()) else { return Ok(()) };
    let nearest_goal_m = goals.iter().map(|goal| goal.distance(*last)).min_by(f64::total_cmp);
    for (field, away_m, end) in
        [("start_position", Some(first.distance(start)), "beginning"), ("goals[0].position", nearest_goal_m, "end")]
    {
        if let Some(away_m) = away_m.filter(|away_m| *away_m > GOAL_RADIUS_M) {
            let problem = format!("it is {away_m:.1} m from the {end} of reference_path");
            return Err(item.wrong_field(field, problem, "correct the one that is wrong"));
        }
    }
    Ok(())
}

fn checked_positions(item: &DatasetItem<'_>, field: &str, value: &Value) -> Result<Vec<DVec3>, FormatError> {
    let list = item.checked_list(field, value, limits::MAX_PATH_NODES)?;
    if list.is_empty() {
        return Err(item.wrong_field(field, "it is empty", "add at least one position"));
    }
    list.iter().enumerate().map(|(index, value)| item.checked_position(&format!("{field}[{index}]"), value)).collect()
}

/// The positions of the goals; none in test splits.
fn goal_positions(item: &DatasetItem<'_>, value: &Value) -> Result<Vec<DVec3>, FormatError> {
    if value.is_null() {
        return Ok(Vec::new());
    }
    let goal = |(index, goal): (usize, &Value)| {
        let field = format!("goals[{index}].position");
        let position =
            goal.get("position").ok_or_else(|| item.wrong_field(&field, "it is missing", "each goal has one"))?;
        item.checked_position(&field, position)
    };
    item.checked_list("goals", value, limits::MAX_PATH_NODES)?.iter().enumerate().map(goal).collect()
}

/// Takes the text. Its tokens go into `tokens` by the text, so that an unchanged text keeps them.
fn take_instruction(
    item: &mut DatasetItem<'_>,
    episode: &mut Episode,
    tokens: &mut BTreeMap<String, Vec<u64>>,
) -> Result<(), FormatError> {
    let instruction = item.take_field("instruction")?;
    let text = instruction.get("instruction_text").unwrap_or(&Value::Null);
    let text = item.checked_instruction("instruction.instruction_text", text)?;
    match instruction.get("instruction_tokens") {
        None | Some(Value::Null) => {}
        // RxR's files have them as words.
        Some(Value::Array(words)) if words.iter().all(Value::is_string) => {}
        Some(numbers) => {
            let field = "instruction.instruction_tokens";
            let numbers = item.checked_list(field, numbers, limits::MAX_INSTRUCTION_BYTES)?.iter().map(Value::as_u64);
            let numbers = numbers.collect::<Option<Vec<_>>>();
            let wrong =
                || item.wrong_field(field, "expected whole numbers", "leave them out, and Wayword makes new ones");
            tokens.insert(text.clone(), numbers.ok_or_else(wrong)?);
        }
    }
    if let Some(tag) = instruction.get("language").filter(|tag| !tag.is_null()) {
        episode.languages = vec![item.checked_text("instruction.language", tag)?.to_owned()];
    }
    episode.instructions = vec![text];
    Ok(())
}

/// Writes a VLN-CE file, one episode per instruction; gzip where the name ends in `.gz`.
///
/// An episode's name is its item's id, or `ID_0`, `ID_1`, ... where the item has several instructions. Where the path
/// is not the one that was read, its goal is its last position (radius 3 m), and `info.geodesic_distance` is the
/// distance over the scene's navmesh where the item has it, else the length of the path; `info.geodesic_distance_over`
/// names which. Facts that do not fit into the format belong in a sidecar ([`crate::write_sidecar`]).
///
/// # Errors
/// When an item has no floor positions, two episodes would have the same id, or the file cannot be written.
pub fn write_vlnce_file(file: &Path, dataset: &VlnceDataset) -> Result<(), FormatError> {
    let mut ids = BTreeSet::new();
    let mut episodes = Vec::new();
    for episode in &dataset.episodes {
        for (index, text) in episode.instructions.iter().enumerate() {
            let id = match episode.instructions.len() {
                1 => episode.name_field("episode_id", &episode.id),
                _ => format!("{}_{index}", episode.id).into(),
            };
            if !ids.insert(id.to_string()) {
                let problem = format!("two episodes would have the same id {id}");
                return Err(FormatError::for_document(file, problem, "put instructions for one path into one item"));
            }
            let mut fields = Map::new();
            fields.insert("episode_id".to_owned(), id);
            add_place(file, &mut fields, episode)?;
            let tokens = dataset.vocabulary.tokens_of(text);
            let instruction = json!({ "instruction_text": text, "instruction_tokens": tokens });
            fields.insert("instruction".to_owned(), instruction);
            episodes.push(fields);
        }
    }
    let vocabulary = json!({ "word_list": dataset.vocabulary.words() });
    output::write_file(file, |out| {
        out.write_all(b"{\"episodes\": ")?;
        output::write_list(out, &episodes)?;
        write!(out, ",\n\"instruction_vocab\": {vocabulary}}}")
    })
}

/// Writes a file of RxR-CE, one episode per instruction; gzip where the name ends in `.gz`. Returns the name of each episode, in the order
/// of the instructions.
///
/// Its loader (`RxRVLNCEDatasetV1` in jacobkrantz/VLN-CE, `habitat_extensions/task.py`) crashes on fields that it does not know, its trainer
/// looks for episodes by names that are texts, and for features by `instruction_id`, which has to be a number. So episodes are
/// numbered. There is no vocabulary: tokens are those of language models. A text without a language gets that of its
/// script: "en-US" for Latin letters. RxR's own loader knows en-US, en-IN, hi-IN and te-IN.
///
/// # Errors
/// When an item has no floor positions, or the file cannot be written.
pub fn write_rxrce_file(file: &Path, episodes: &[Episode]) -> Result<Vec<String>, FormatError> {
    let (mut written, mut names) = (Vec::new(), Vec::new());
    for episode in episodes {
        for (index, text) in episode.instructions.iter().enumerate() {
            let number = (written.len() + 1).to_string();
            let mut fields = Map::new();
            fields.insert("episode_id".to_owned(), number.as_str().into());
            add_place(file, &mut fields, episode)?;
            // A number would be read too, but episodes of other files have texts here.
            if let Some(Value::Number(path)) = fields.get("trajectory_id") {
                let path = path.to_string();
                fields.insert("trajectory_id".to_owned(), path.into());
            }
            let language = episode.language_of(index).unwrap_or_else(|| language_tag(text));
            let instruction = json!({
                "instruction_id": number,
                "instruction_text": text,
                "language": language,
                "annotator_id": null,
                "edit_distance": null,
                "timed_instruction": null,
                "instruction_tokens": null,
            });
            fields.insert("instruction".to_owned(), instruction);
            written.push(fields);
            names.push(number);
        }
    }
    output::write_file(file, |out| {
        out.write_all(b"{\"episodes\": ")?;
        output::write_list(out, &written)?;
        out.write_all(b"}")
    })?;
    Ok(names)
}

/// Adds the scene, the path with its start and goal, and `info`.
fn add_place(file: &Path, fields: &mut Map<String, Value>, episode: &Episode) -> Result<(), FormatError> {
    let (Some(start), Some(goal)) = (episode.floor_positions.first(), episode.floor_positions.last()) else {
        let problem = format!("item {:?} has no floor positions, and this format requires them", episode.id);
        return Err(FormatError::for_document(file, problem, "write it as r2r, reverie, rxr or wayword"));
    };
    let path: Value = episode.floor_positions.iter().map(|position| habitat_value(*position)).collect();
    let read_path = episode.as_read.get("reference_path");
    // Where the file had no path, the path from its start to its goal counts as the one that was read.
    let same_path = read_path.is_some_and(|as_read| as_read.is_null() || *as_read == path);
    let scene = &episode.scene;
    let heading = episode.start_heading.unwrap_or(wayword_core::Heading::NORTH);
    let same_heading = |value: &Value| {
        let rotation = serde_json::from_value::<[f64; 4]>(value.clone()).ok();
        rotation.and_then(heading_from_habitat) == Some(heading)
    };
    let same_scene = |value: &Value| value.as_str().map(bare_scene) == Some(scene.as_str());
    let mut put = |key: &str, value: Value| drop(fields.insert(key.to_owned(), value));
    put("trajectory_id", episode.name_field("trajectory_id", &episode.path_id));
    let scene_id = || episode.in_habitat.scene_id.clone().unwrap_or_else(|| format!("mp3d/{scene}/{scene}.glb"));
    put("scene_id", episode.field_value("scene_id", same_scene, || scene_id().into()));
    put("start_position", episode.field_value("start_position", |_| same_path, || habitat_value(*start)));
    put("start_rotation", episode.field_value("start_rotation", same_heading, || json!(habitat_from_heading(heading))));
    let goals = || json!([{ "position": habitat_value(*goal), "radius": GOAL_RADIUS_M }]);
    put("goals", episode.field_value("goals", |_| same_path, goals));
    put("reference_path", read_path.filter(|_| same_path).cloned().unwrap_or(path));
    put("info", episode.field_value("info", |_| same_path, || info_field(episode)));
    Ok(())
}

/// The field `info`, in which loaders accept any key.
fn info_field(episode: &Episode) -> Value {
    let (length_m, over) = match episode.in_habitat.geodesic_m {
        Some(geodesic_m) => (Some(geodesic_m), "navmesh"),
        None if episode.viewpoints.is_empty() => (episode.floor_length_m(), "frames"),
        None => (episode.floor_length_m(), "graph"),
    };
    let mut info = json!({ "geodesic_distance": length_m, "geodesic_distance_over": over });
    if let (Some(needs), Some(fields)) = (&episode.in_habitat.scene_needs, info.as_object_mut()) {
        fields.insert("scene_needs".to_owned(), needs.as_str().into());
    }
    info
}

/// A position as the file has it: three numbers in Habitat's frame.
fn habitat_value(floor: DVec3) -> Value {
    json!(habitat_from_wayword(floor).to_array())
}
