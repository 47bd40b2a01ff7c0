//! VLN-CE's files of ground truth actions (`SPLIT_gt.json.gz`), which belong to a file of episodes: for each episode
//! `actions`, `forward_steps`, and the `locations` of the agent at the start and after each step forward.

use crate::{
    DatasetItem, FormatError,
    habitat::{habitat_from_wayword, wayword_from_habitat},
    input, output,
};
use serde_json::{Value, json};
use std::{collections::BTreeMap, path::Path};
use wayword_core::{AgentAction, DVec3};

/// Most actions of one episode; a file with more in one is refused.
const MAX_ACTIONS: usize = 25_000;

/// Most actions of all episodes together that are kept in memory; a file with more is refused.
const MAX_ACTIONS_IN_MEMORY: usize = 20_000_000;

/// The actions of an agent in an episode, and the places that they lead to.
#[derive(Debug, Clone, PartialEq)]
pub struct EpisodeActions {
    /// Its actions; the last is [`AgentAction::Stop`].
    pub actions: Vec<AgentAction>,
    /// Where it is at the start and after each step forward, on the floor, world frame, metres.
    pub locations: Vec<DVec3>,
}

impl EpisodeActions {
    /// The actions of an episode, from the agent's position before each of them.
    #[must_use]
    pub fn from_positions(actions: &[AgentAction], positions: &[DVec3]) -> Self {
        let after_steps = actions.iter().zip(positions.iter().skip(1));
        let after_steps =
            after_steps.filter(|(action, _)| **action == AgentAction::Forward).map(|(_, position)| *position);
        let locations = positions.iter().take(1).copied().chain(after_steps).collect();
        Self { actions: actions.to_vec(), locations }
    }
}

/// Writes the actions of each episode; gzip where the name ends in `.gz`.
///
/// # Errors
/// When the file cannot be written.
pub fn write_actions(file: &Path, acted: &BTreeMap<String, EpisodeActions>) -> Result<(), FormatError> {
    let entry_json = |acted: &EpisodeActions| {
        let locations: Vec<_> = acted.locations.iter().map(|place| habitat_from_wayword(*place).to_array()).collect();
        let forward_steps = acted.actions.iter().filter(|action| **action == AgentAction::Forward).count();
        json!({ "locations": locations, "forward_steps": forward_steps, "actions": acted.actions })
    };
    output::write_file(file, |out| {
        let mut separator = "{\n";
        for (episode, acted) in acted {
            write!(out, "{separator}{}: {}", Value::from(episode.as_str()), entry_json(acted))?;
            separator = ",\n";
        }
        out.write_all(if separator == "{\n" { b"{}" } else { b"\n}" })
    })
}

/// Reads the actions of each episode; plain or gzip.
///
/// # Errors
/// When the file cannot be read, or an episode breaks a rule; the error names it and the field.
pub fn read_actions(file: &Path) -> Result<BTreeMap<String, EpisodeActions>, FormatError> {
    let mut all = BTreeMap::new();
    let mut kept = 0;
    input::each_entry(file, |episode, mut item| {
        let acted = take_actions(&mut item)?;
        kept += acted.actions.len();
        if kept > MAX_ACTIONS_IN_MEMORY {
            let problem = "its episodes have more than 20,000,000 actions";
            return Err(FormatError::for_document(file, problem, "split it into parts"));
        }
        all.insert(episode.to_owned(), acted);
        Ok(())
    })?;
    Ok(all)
}

/// Takes an episode's actions, and checks that `forward_steps` and `locations` agree with them.
fn take_actions(item: &mut DatasetItem<'_>) -> Result<EpisodeActions, FormatError> {
    let (actions, locations) = (item.take_field("actions")?, item.take_field("locations")?);
    let action =
        |(at, value): (usize, &Value)| item.parse_value::<AgentAction>(&format!("actions[{at}]"), value.clone());
    let actions: Vec<AgentAction> = item
        .checked_list("actions", &actions, MAX_ACTIONS)?
        .iter()
        .enumerate()
        .map(action)
        .collect::<Result<_, _>>()?;
    let place = |(at, value): (usize, &Value)| item.checked_position(&format!("locations[{at}]"), value);
    let locations = item.checked_list("locations", &locations, MAX_ACTIONS)?.iter().enumerate().map(place);
    let locations: Vec<DVec3> = locations.map(|place| place.map(wayword_from_habitat)).collect::<Result<_, _>>()?;
    let forward = actions.iter().filter(|action| **action == AgentAction::Forward).count();
    let steps = item.take_field("forward_steps")?;
    if steps.as_u64() != Some(forward as u64) {
        let problem = format!("expected {forward}, the number of steps forward among the actions, found {steps}");
        return Err(item.wrong_field("forward_steps", problem, "count the actions that are 1"));
    }
    if actions.iter().position(|action| *action == AgentAction::Stop) != actions.len().checked_sub(1) {
        return Err(item.wrong_field(
            "actions",
            "it does not end with its only stop",
            "the last action is 0, and no other",
        ));
    }
    if locations.len() != forward + 1 {
        let problem =
            format!("expected {}, the start and one for each step forward, found {}", forward + 1, locations.len());
        return Err(item.wrong_field(
            "locations",
            problem,
            "write where the agent is at the start and after each action 1",
        ));
    }
    Ok(EpisodeActions { actions, locations })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn acted() -> BTreeMap<String, EpisodeActions> {
        let positions = [0.0, 0.0, 0.25, 0.5].map(|y| DVec3::new(1.0, y, 3.0));
        let acted = EpisodeActions::from_positions(
            &[AgentAction::Left, AgentAction::Forward, AgentAction::Forward, AgentAction::Stop],
            &positions,
        );
        BTreeMap::from([("house2-1-0".to_owned(), acted)])
    }

    #[test]
    fn actions_come_back_and_look_as_vln_ce_has_them() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["train_gt.json", "train_gt.json.gz"] {
            let file = folder.path().join(name);
            write_actions(&file, &acted()).unwrap();
            assert_eq!(read_actions(&file).unwrap(), acted());
        }
        let text = std::fs::read_to_string(folder.path().join("train_gt.json")).unwrap();
        let read: Value = serde_json::from_str(&text).unwrap();
        let episode = &read["house2-1-0"];
        assert_eq!((&episode["actions"], &episode["forward_steps"]), (&json!([2, 1, 1, 0]), &json!(2)));
        assert_eq!(episode["locations"], json!([[1.0, 3.0, 0.0], [1.0, 3.0, -0.25], [1.0, 3.0, -0.5]]));
    }

    #[test]
    fn read_names_the_episode_and_field_that_break_a_rule() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("gt.json");
        for (text, told) in [
            (
                r#"{"7": {"actions": [1, 9], "locations": [], "forward_steps": 1}}"#,
                "(id 7): field \"actions[1]\": 9 is no action",
            ),
            (r#"{"7": {"actions": [1, 0], "locations": [[0, 0]], "forward_steps": 1}}"#, "field \"locations[0]\""),
            (
                r#"{"7": {"actions": [1, 0], "locations": [], "forward_steps": 2}}"#,
                "field \"forward_steps\": expected 1",
            ),
            (r#"{"7": {"actions": [1], "locations": [], "forward_steps": 1}}"#, "field \"actions\": it does not end"),
            (
                r#"{"7": {"actions": [1, 0], "locations": [[0, 0, 0]], "forward_steps": 1}}"#,
                "field \"locations\": expected 2",
            ),
            (r#"{"7": []}"#, "expected an object"),
            ("[]", "expected"),
        ] {
            std::fs::write(&file, text).unwrap();
            let error = read_actions(&file).unwrap_err().to_string();
            assert!(error.contains("gt.json") && error.contains(told), "{error}");
        }
    }
}
