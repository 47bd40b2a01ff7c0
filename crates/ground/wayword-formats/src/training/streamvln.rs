//! StreamVLN's trajectory data, which JanusVLN and NAVIDA read too: `annotations.json`, a list of walks, and the pictures of each in
//! `VIDEO/rgb`.
//!
//! Source: InternRobotics/StreamVLN, `streamvln/dataset/vln_action_dataset.py` (`VLNActionDataset`). `actions[0]` is -1, a dummy;
//! picture i is the view before `actions[i + 1]`, and the stop at the end is implied: it is the action before which the last
//! picture was taken.

use super::put_back::{TextsOfWalk, TextsPutBack};
use crate::{DatasetItem, Episode, FormatError, input, item::is_path_below, limits, output, read_tally::ReadTally};
use serde_json::{Map, Value, json};
use std::path::Path;
use wayword_core::{AgentAction, SceneId};

/// The first action, which the loader skips.
const DUMMY_ACTION: i64 = -1;
/// Most actions of a walk.
const MAX_ACTIONS: usize = 25_000;

/// A walk of StreamVLN's file.
#[derive(Debug, Clone, PartialEq)]
pub struct StreamVlnWalk {
    /// Its number or name.
    pub id: Value,
    /// The folder of its pictures, below that of the file; they lie in `rgb` in it.
    pub video: String,
    /// Its texts.
    pub instructions: Vec<String>,
    /// Its actions, the last of which is a stop. There are as many pictures.
    pub actions: Vec<AgentAction>,
    /// Fields that StreamVLN does not name.
    pub extra: Map<String, Value>,
}

impl StreamVlnWalk {
    /// The scene under which its pictures are a recording: the last folder of `video`.
    #[must_use]
    pub fn scene_name(&self) -> &str {
        self.video.trim_end_matches('/').rsplit('/').next().unwrap_or_default()
    }
}

/// Writes `annotations.json`.
///
/// # Errors
/// When it cannot be written.
pub fn write_streamvln_file(file: &Path, walks: &[StreamVlnWalk]) -> Result<(), FormatError> {
    output::write_file(file, |out| output::write_list(out, walks.iter().map(walk_item)))
}

fn walk_item(walk: &StreamVlnWalk) -> Value {
    let moves = walk.actions.iter().filter(|action| **action != AgentAction::Stop);
    let actions: Vec<i64> =
        std::iter::once(DUMMY_ACTION).chain(moves.map(|action| i64::from(u8::from(*action)))).collect();
    let mut item = json!({
        "id": walk.id,
        "video": walk.video,
        "instructions": walk.instructions,
        "actions": actions,
    });
    if let Some(fields) = item.as_object_mut() {
        fields.extend(walk.extra.clone());
    }
    item
}

/// Reads `annotations.json`, plain or gzip.
///
/// # Errors
/// When the file cannot be read, or an item breaks a rule of the layout; the error names item and field.
pub fn read_streamvln_file(file: &Path) -> Result<Vec<StreamVlnWalk>, FormatError> {
    let mut walks = Vec::new();
    input::each_item(file, |mut item| {
        let walk = take_walk(&mut item)?;
        walks.push(StreamVlnWalk { extra: item.into_rest(), ..walk });
        Ok(())
    })?;
    Ok(walks)
}

fn take_walk(item: &mut DatasetItem<'_>) -> Result<StreamVlnWalk, FormatError> {
    let id = item.take_field("id")?;
    item.set_id(&item.checked_name("id", &id)?);
    let video = item.take_field("video")?;
    let video = take_relative_path(item, "video", &video)?;
    let value = item.take_field("instructions")?;
    let instructions = match &value {
        // The loader takes a single text too.
        Value::String(_) => vec![item.checked_instruction("instructions", &value)?],
        _ => {
            let list = item.checked_list("instructions", &value, limits::MAX_INSTRUCTIONS)?;
            let text = |(at, text): (usize, &Value)| item.checked_instruction(&format!("instructions[{at}]"), text);
            list.iter().enumerate().map(text).collect::<Result<_, _>>()?
        }
    };
    let value = item.take_field("actions")?;
    let actions = take_actions(item, &value)?;
    Ok(StreamVlnWalk { id, video, instructions, actions, extra: Map::new() })
}

/// The actions without the dummy, and with the stop.
fn take_actions(item: &DatasetItem<'_>, value: &Value) -> Result<Vec<AgentAction>, FormatError> {
    let list = item.checked_list("actions", value, MAX_ACTIONS)?;
    if list.first().and_then(Value::as_i64) != Some(DUMMY_ACTION) {
        let hint = "StreamVLN's loader skips the first action: write -1 before the actions";
        return Err(item.wrong_field("actions[0]", "it is not -1", hint));
    }
    let mut actions = Vec::with_capacity(list.len());
    for (at, value) in list.iter().enumerate().skip(1) {
        let field = format!("actions[{at}]");
        let action: AgentAction = item.parse_value(&field, value.clone())?;
        if action == AgentAction::Stop {
            return Err(item.wrong_field(
                &field,
                "it is a stop",
                "leave the stop out: it is implied after the last picture",
            ));
        }
        actions.push(action);
    }
    actions.push(AgentAction::Stop);
    Ok(actions)
}

/// A path below the folder of the file.
pub(super) fn take_relative_path(item: &DatasetItem<'_>, field: &str, value: &Value) -> Result<String, FormatError> {
    let path = item.checked_text(field, value)?;
    if is_path_below(path) {
        return Ok(path.to_owned());
    }
    Err(item.wrong_field(field, "it leads out of the folder", "write a path below the folder of this file"))
}

/// Writes the walks of `file` again with other texts, by the name of their scene. Walks without a text are left out. Returns what was put
/// back.
///
/// # Errors
/// When `file` cannot be read, or `out` cannot be written.
pub fn write_streamvln_texts(file: &Path, out: &Path, texts: TextsOfWalk<'_>) -> Result<TextsPutBack, FormatError> {
    let (mut walks, mut count) = (Vec::new(), TextsPutBack::default());
    for walk in read_streamvln_file(file)? {
        let instructions = texts(walk.scene_name());
        if count.take_walk(instructions.len()) {
            walks.push(StreamVlnWalk { instructions, ..walk });
        }
    }
    write_streamvln_file(out, &walks)?;
    Ok(count)
}

/// Reads the walks as episodes of recordings: the scene of each is the folder of its pictures.
///
/// # Errors
/// As [`read_streamvln_file`]; when a folder's name is no name of a scene, or two walks have one.
pub fn read_streamvln_episodes(file: &Path) -> Result<Vec<Episode>, FormatError> {
    let mut tally = ReadTally::default();
    let mut episodes = Vec::new();
    input::each_item(file, |mut item| {
        let walk = take_walk(&mut item)?;
        let scene = SceneId::new(walk.scene_name())
            .map_err(|error| item.wrong_field("video", error.to_string(), "give the folder another name"))?;
        let episode = Episode::for_recording(scene, walk.instructions);
        tally.claim_name(&item, "video", &episode)?;
        // Unknown fields are for StreamVLN alone.
        let episode = tally.finish_episode(episode, item)?;
        episodes.push(Episode { extra: Map::new(), ..episode });
        Ok(())
    })?;
    tally.finish_file(episodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walk() -> StreamVlnWalk {
        StreamVlnWalk {
            id: 3.into(),
            video: "images/house2-1_wayword_000003".to_owned(),
            instructions: vec!["Turn left.".to_owned(), "Go left.".to_owned()],
            actions: [2, 1, 1, 0].map(|number| AgentAction::try_from(number).unwrap()).to_vec(),
            extra: Map::new(),
        }
    }

    fn read(text: &str) -> Result<Vec<StreamVlnWalk>, String> {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("annotations.json");
        std::fs::write(&file, text).unwrap();
        read_streamvln_file(&file).map_err(|error| error.to_string())
    }

    #[test]
    fn a_file_comes_back_and_is_written_with_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a.json", "b.json"].map(|name| folder.path().join(name));
        let mut extra = walk();
        extra.extra.insert("source".to_owned(), "people".into());
        write_streamvln_file(&first, &[walk(), extra]).unwrap();
        let text = std::fs::read_to_string(&first).unwrap();
        assert!(text.contains("\"actions\":[-1,2,1,1]"), "{text}");
        let read = read_streamvln_file(&first).unwrap();
        assert_eq!(read[0], walk());
        write_streamvln_file(&second, &read).unwrap();
        assert_eq!(std::fs::read_to_string(&second).unwrap(), text);
        let episodes = read_streamvln_episodes(&first).unwrap_err().to_string();
        assert!(episodes.contains("item 1") && episodes.contains("was given to an earlier item"), "{episodes}");
    }

    #[test]
    fn broken_rules_are_refused_by_field() {
        for (change, told) in [
            (r#""actions":[2,1]"#, "field \"actions[0]\": it is not -1"),
            (r#""actions":[-1,1,0]"#, "field \"actions[2]\": it is a stop"),
            (r#""actions":[-1,7]"#, "field \"actions[1]\""),
            (r#""video":"../x","actions":[-1,1]"#, "field \"video\": it leads out of the folder"),
        ] {
            let video = if change.contains("video") { "" } else { r#""video":"images/a","# };
            let text = format!(r#"[{{"id":1,{video}"instructions":["Go."],{change}}}]"#);
            let error = read(&text).unwrap_err();
            assert!(error.contains("item 0 (id 1)") && error.contains(told), "{change}: {error}");
        }
    }
}
