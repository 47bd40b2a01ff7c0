//! The result of the tool `observe`: the things around a place, as labels, as captions or as pictures of the four views.

use crate::{error::WalkError, one_line::shorten_line, sight::AgentView};
use std::sync::Arc;
use wayword_core::{GroundTruth, Heading, Image, ModelError, ObjectId, ObjectLabel, View, ViewpointId};

/// How the agent perceives a place.
#[derive(Clone, Copy)]
pub enum ToolAgentSight<'a> {
    /// By the platform's labels and the name of the room: ground truth, not perception.
    Labels,
    /// By the four pictures.
    Pictures,
    /// By captions of the four pictures, from another model.
    Captions(&'a dyn ViewDescriber),
}

/// Describes views in words.
pub trait ViewDescriber: Send + Sync {
    /// Describes a view in one or a few sentences.
    ///
    /// # Errors
    /// When the view has no picture, or the model fails.
    fn describe_view(&self, view: &View) -> Result<String, ModelError>;
}

/// Everything around a place, as the prompt describes it.
#[derive(Debug, Clone, Default)]
pub(super) struct ObservedScene {
    /// The name of the room; `None` if the labels have none, or the agent perceives by pictures or captions.
    pub(super) room: Option<String>,
    /// A line for each direction.
    pub(super) lines: Vec<String>,
    /// Pictures, in the order of the lines.
    pub(super) pictures: Vec<Arc<Image>>,
    /// The summary for the map.
    pub(super) brief: String,
    /// The objects with their names; the first has number 1. Empty if the agent need not name an object.
    pub(super) objects: Vec<(ObjectId, String)>,
    /// How many things there are.
    pub(super) things: usize,
    /// Views that could not be described.
    pub(super) undescribed: usize,
}

/// Most things of a place in a prompt; the farthest are left out.
const MAX_LISTED_THINGS: usize = 40;
/// Most characters of all things of a place in a prompt; the farthest things are left out.
const MAX_THING_LIST_CHARS: usize = 2_000;
/// Longest name of a thing or a room, characters; a longer one is cut.
const MAX_NAME_CHARS: usize = 40;
/// Longest caption of a view, characters; a longer one is cut.
const MAX_CAPTION_CHARS: usize = 450;
/// Most names of things in the summary of a place for the map.
const MAX_SUMMARY_NAMES: usize = 6;
/// Longest caption in the summary of a place for the map, characters; a longer one is cut.
const MAX_SUMMARY_CAPTION_CHARS: usize = 40;
/// Sectors of 45 degrees, clockwise from ahead.
const SECTOR_NAMES: [&str; 8] =
    ["ahead", "ahead-right", "right", "behind-right", "behind", "behind-left", "left", "ahead-left"];

/// The sector in which a direction lies, by its turn from ahead (radians, positive right).
fn sector_for_turn(turn_rad: f64) -> usize {
    (turn_rad.to_degrees() / 45.0).round().rem_euclid(8.0) as usize % SECTOR_NAMES.len()
}

/// Looks around a place. `heading` is ahead. Objects get numbers if `numbers_objects`, so that the agent can name one.
pub(super) fn observe_scene(
    agent_view: &AgentView<'_>,
    (here, heading): (&ViewpointId, Heading),
    looks: ToolAgentSight<'_>,
    numbers_objects: bool,
) -> Result<ObservedScene, WalkError> {
    match looks {
        ToolAgentSight::Labels => {
            let GroundTruth { labels, room, .. } =
                agent_view.labels_around(here)?.ok_or_else(|| missing_input("labels"))?;
            Ok(scene_from_labels(labels, room, heading, numbers_objects))
        }
        ToolAgentSight::Pictures => scene_from_pictures(&agent_view.views_around(here)?, heading),
        ToolAgentSight::Captions(by) => scene_from_captions(&agent_view.views_around(here)?, heading, by),
    }
}

fn scene_from_labels(
    mut labels: Vec<ObjectLabel>,
    room: Option<String>,
    heading: Heading,
    numbers_objects: bool,
) -> ObservedScene {
    labels.sort_by(|a, b| near_m(a).total_cmp(&near_m(b)).then_with(|| a.object.cmp(&b.object)));
    let things = labels.len();
    // The nearest come first, so far things are left out.
    let mut chars = 0;
    let fits = |label: &ObjectLabel| {
        // 22 characters are room for the number and the distance around a name, as in "[12] sofa (1.2 m)".
        chars += label.name.chars().count().min(MAX_NAME_CHARS) + 22;
        chars <= MAX_THING_LIST_CHARS
    };
    let listed = labels.iter().map(fits).take(MAX_LISTED_THINGS).take_while(|fits| *fits).count();
    labels.truncate(listed);
    let named: Vec<(ObjectLabel, String)> = labels
        .into_iter()
        .map(|label| {
            let name = shorten_line(&label.name, MAX_NAME_CHARS);
            (label, name)
        })
        .collect();
    let room = room.map(|room| shorten_line(&room, MAX_NAME_CHARS));
    let lines =
        (0..SECTOR_NAMES.len()).filter_map(|sector| sector_line(sector, &named, heading, numbers_objects)).collect();
    let brief = summarise_names(room.as_deref(), named.iter().map(|(_, name)| name.as_str()));
    let objects = named.into_iter().filter(|_| numbers_objects).map(|(label, name)| (label.object, name)).collect();
    ObservedScene { room, lines, brief, objects, things, ..ObservedScene::default() }
}

/// The summary of a place for the map: the room and the first names, each once.
fn summarise_names<'a>(room: Option<&'a str>, names: impl Iterator<Item = &'a str>) -> String {
    let mut kept: Vec<&str> = Vec::new();
    for name in names {
        if kept.len() < MAX_SUMMARY_NAMES && !kept.contains(&name) {
            kept.push(name);
        }
    }
    let parts: Vec<&str> = room.into_iter().chain(kept).collect();
    if parts.is_empty() { "nothing with a name".to_owned() } else { parts.join(", ") }
}

/// The distance of a labelled thing, metres; infinite if it is not known, so that it sorts last.
fn near_m(label: &ObjectLabel) -> f64 {
    label.distance_m.unwrap_or(f64::INFINITY)
}

/// The line of a sector, as "left: sofa (1.2 m), chair x2"; `None` if it has no things. Things with equal names are counted, and the
/// distance is that of the nearest. With numbers, each thing is listed by itself.
fn sector_line(
    sector: usize,
    named: &[(ObjectLabel, String)],
    heading: Heading,
    numbers_objects: bool,
) -> Option<String> {
    // The name of each thing, its words, and how many things have that name.
    let mut listed: Vec<(&str, String, usize)> = Vec::new();
    let in_sector =
        named.iter().enumerate().filter(|(_, (label, _))| sector_for_turn(heading.turn_to(label.heading)) == sector);
    for (at, (label, name)) in in_sector {
        let far = label.distance_m.map_or(String::new(), |far_m| format!(" ({far_m:.1} m)"));
        let number = if numbers_objects { format!("[{}] ", at + 1) } else { String::new() };
        match listed.iter_mut().find(|(other, ..)| !numbers_objects && other == name) {
            Some((.., count)) => *count += 1,
            None => listed.push((name, format!("{number}{name}{far}"), 1)),
        }
    }
    let words = |(_, words, count)| if count > 1 { format!("{words} x{count}") } else { words };
    let things: Vec<String> = listed.into_iter().map(words).collect();
    (!things.is_empty()).then(|| format!("{}: {}", SECTOR_NAMES[sector], things.join(", ")))
}

/// The views with their turns from ahead (radians, positive right): the view nearest to ahead first, then clockwise.
fn views_from_ahead(views: &[View; 4], heading: Heading) -> Vec<(f64, &View)> {
    let mut turned: Vec<(f64, &View)> = views.iter().map(|view| (heading.turn_to(view.pose.heading), view)).collect();
    turned.sort_by(|a, b| clockwise_turn(a.0).total_cmp(&clockwise_turn(b.0)));
    turned
}

/// A turn in radians, counted clockwise from 45 degrees to the left, so that things ahead sort first.
pub(super) fn clockwise_turn(turn_rad: f64) -> f64 {
    (turn_rad + std::f64::consts::FRAC_PI_4).rem_euclid(std::f64::consts::TAU)
}

fn scene_from_pictures(views: &[View; 4], heading: Heading) -> Result<ObservedScene, WalkError> {
    let mut scene = ObservedScene { brief: "you looked around".to_owned(), ..ObservedScene::default() };
    for (turn_rad, view) in views_from_ahead(views, heading) {
        scene.pictures.push(view.image.clone().ok_or_else(|| missing_input("pictures"))?);
        scene.lines.push(format!("picture {} looks {}", scene.pictures.len(), describe_turn(turn_rad)));
    }
    Ok(scene)
}

fn scene_from_captions(
    views: &[View; 4],
    heading: Heading,
    by: &dyn ViewDescriber,
) -> Result<ObservedScene, WalkError> {
    let mut scene = ObservedScene::default();
    let mut summaries = Vec::new();
    for (turn_rad, view) in views_from_ahead(views, heading) {
        let caption = match by.describe_view(view) {
            Ok(caption) => shorten_line(&caption, MAX_CAPTION_CHARS),
            // If a view cannot be described, for example because a filter refuses its picture, the walk goes on.
            Err(ModelError::Failed { .. }) => {
                scene.undescribed += 1;
                "not known".to_owned()
            }
            Err(error) => return Err(error.into()),
        };
        summaries.push(shorten_line(&caption, MAX_SUMMARY_CAPTION_CHARS));
        scene.lines.push(format!("{}: {caption}", describe_turn(turn_rad)));
    }
    scene.brief = summaries.join(" / ");
    Ok(scene)
}

/// A turn from ahead (radians, positive right) in words and degrees, as "right, 80 degrees right".
pub(super) fn describe_turn(turn_rad: f64) -> String {
    let (words, deg) = (SECTOR_NAMES[sector_for_turn(turn_rad)], turn_rad.to_degrees().round());
    match deg {
        0.0 => words.to_owned(),
        deg if deg > 0.0 => format!("{words}, {deg} degrees right"),
        deg => format!("{words}, {} degrees left", -deg),
    }
}

fn missing_input(needs: &'static str) -> WalkError {
    let hint = "give --see labels on a platform with labels, --see pictures, or a model that sees as provider/model";
    WalkError::Model(ModelError::NothingToSee { name: "the agent tools".to_owned(), needs, hint })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_go_round_once() {
        let words: Vec<String> = [0.0, 44.0, 90.0, 179.0, -90.0, -30.0]
            .into_iter()
            .map(|deg: f64| describe_turn(deg.to_radians()))
            .collect();
        assert_eq!(
            words,
            [
                "ahead",
                "ahead-right, 44 degrees right",
                "right, 90 degrees right",
                "behind, 179 degrees right",
                "left, 90 degrees left",
                "ahead-left, 30 degrees left",
            ]
        );
    }

    fn label(name: &str, deg: f64, distance_m: Option<f64>) -> ObjectLabel {
        ObjectLabel {
            object: ObjectId::new(format!("{name}{deg}").chars().take(100).collect::<String>()).unwrap(),
            name: name.to_owned(),
            heading: Heading::new(f64::to_radians(deg)).unwrap(),
            elevation_rad: 0.0,
            box_px: None,
            distance_m,
            position: None,
            colour: None,
            room: None,
        }
    }

    #[test]
    fn things_of_one_name_and_direction_are_counted_unless_they_have_numbers() {
        let labels = vec![
            label("chair (wooden)", 5.0, Some(2.0)),
            label("chair", 0.0, Some(3.0)),
            label("chair", 10.0, Some(1.0)),
            label("lamp", 90.0, None),
        ];
        let scene = scene_from_labels(labels.clone(), Some("den".into()), Heading::NORTH, false);
        assert_eq!(scene.lines, ["ahead: chair (1.0 m) x2, chair (wooden) (2.0 m)", "right: lamp"]);
        assert_eq!((scene.brief.as_str(), scene.things), ("den, chair, chair (wooden), lamp", 4));
        let scene = scene_from_labels(labels, None, Heading::NORTH, true);
        assert_eq!(scene.lines[0], "ahead: [1] chair (1.0 m), [2] chair (wooden) (2.0 m), [3] chair (3.0 m)");
        assert_eq!(scene.objects[2].1, "chair");
    }

    #[test]
    fn a_place_with_many_things_gets_a_bounded_description() {
        let long = "a cupboard with a carved front and drawers behind two doors";
        let labels =
            (0..500).map(|at| label(&format!("{at} {long}"), f64::from(at % 360), Some(f64::from(at)))).collect();
        let scene = scene_from_labels(labels, None, Heading::NORTH, true);
        assert_eq!(scene.things, 500);
        let chars: usize = scene.lines.iter().map(|line| line.chars().count()).sum();
        assert!(chars <= MAX_THING_LIST_CHARS && chars > MAX_THING_LIST_CHARS / 2, "{chars}");
    }
}
