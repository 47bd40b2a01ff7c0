//! What the tool `observe` tells of a place: labels, captions or pictures of four views.

use super::quoted;
use crate::{error::WalkError, sight::AgentView};
use std::sync::Arc;
use wayword_core::{Heading, Image, Label, ModelError, ObjectId, View, ViewpointId};

/// How the agent sees.
#[derive(Clone, Copy)]
pub enum Looks<'a> {
    /// It is told the platform's labels and the name of the room: ground truth, not perception.
    Labels,
    /// It is shown the four pictures.
    Pictures,
    /// It is told what somebody says of the four pictures.
    Captions(&'a dyn Describes),
}

/// Says in words what a view shows.
pub trait Describes: Send + Sync {
    /// What the view shows, in a sentence or a few.
    ///
    /// # Errors
    /// When it cannot be said.
    fn describe(&self, view: &View) -> Result<String, ModelError>;
}

/// What was seen from a place.
#[derive(Debug, Clone, Default)]
pub(super) struct Scene {
    /// The name of the room, where the agent is told one.
    pub(super) room: Option<String>,
    /// What there is, a line for each direction.
    pub(super) lines: Vec<String>,
    /// Pictures, in the order of the lines.
    pub(super) pictures: Vec<Arc<Image>>,
    /// The names of its things, nearest first where that is known, each once.
    pub(super) names: Vec<String>,
    /// Its objects by their numbers, from 1; empty where the agent is not to name one.
    pub(super) objects: Vec<ObjectId>,
    /// How many things there are.
    pub(super) things: usize,
}

/// Most things of a place that are told.
const MOST_THINGS: usize = 40;
/// Longest name, and longest caption of a view, characters.
const MOST_NAME_CHARS: usize = 40;
const MOST_CAPTION_CHARS: usize = 400;
/// Sectors of 45 degrees, clockwise from ahead.
const SECTORS: [&str; 8] =
    ["ahead", "ahead-right", "right", "behind-right", "behind", "behind-left", "left", "ahead-left"];

/// The sector in which a direction lies, by its turn from ahead (radians, positive right).
pub(super) fn sector(turn_rad: f64) -> usize {
    (turn_rad.to_degrees() / 45.0).round().rem_euclid(8.0) as usize % SECTORS.len()
}

/// The words for a direction.
pub(super) fn direction(turn_rad: f64) -> &'static str {
    SECTORS[sector(turn_rad)]
}

/// Looks around a place along `heading`. Objects get numbers where the agent is to name one.
pub(super) fn look(
    agent_view: &AgentView<'_>,
    at: (&ViewpointId, Heading),
    looks: Looks<'_>,
    numbers_objects: bool,
) -> Result<Scene, WalkError> {
    let (here, heading) = at;
    let views = agent_view.views(here)?;
    match looks {
        Looks::Labels => labelled(&views, heading, numbers_objects),
        Looks::Pictures => pictured(&views, heading),
        Looks::Captions(by) => captioned(&views, heading, by),
    }
}

fn labelled(views: &[View; 4], heading: Heading, numbers_objects: bool) -> Result<Scene, WalkError> {
    let mut labels: Vec<&Label> = Vec::new();
    let mut room = None;
    for view in views {
        let truth = view.ground_truth().ok_or_else(|| missing("labels"))?;
        labels.extend(&truth.labels);
        room = room.or(truth.room.as_deref());
    }
    labels.sort_by(|a, b| near_m(a).total_cmp(&near_m(b)).then_with(|| a.object.cmp(&b.object)));
    let things = labels.len();
    labels.truncate(MOST_THINGS);
    let mut names: Vec<String> = Vec::new();
    for label in &labels {
        let name = quoted(&label.name, MOST_NAME_CHARS);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let lines = (0..SECTORS.len()).filter_map(|sector| line(sector, &labels, heading, numbers_objects)).collect();
    let objects = labels.iter().filter(|_| numbers_objects).map(|label| label.object.clone()).collect();
    let room = room.map(|room| quoted(room, MOST_NAME_CHARS));
    Ok(Scene { room, lines, pictures: Vec::new(), names, objects, things })
}

/// How far away a labelled thing is; those of which it is not known come last.
fn near_m(label: &Label) -> f64 {
    label.distance_m.unwrap_or(f64::INFINITY)
}

/// The things of a sector, as "left: sofa (1.2 m), 2 chairs"; `None` where there is none.
fn line(of: usize, labels: &[&Label], heading: Heading, numbers_objects: bool) -> Option<String> {
    let mut told: Vec<(String, usize)> = Vec::new();
    for (at, label) in labels.iter().enumerate().filter(|(_, label)| sector(heading.turn_to(label.heading)) == of) {
        let name = quoted(&label.name, MOST_NAME_CHARS);
        let far = label.distance_m.map_or(String::new(), |far_m| format!(" ({far_m:.1} m)"));
        match told.iter_mut().find(|(other, _)| !numbers_objects && other.split(" (").next() == Some(&name)) {
            Some((_, count)) => *count += 1,
            None if numbers_objects => told.push((format!("[{}] {name}{far}", at + 1), 1)),
            None => told.push((format!("{name}{far}"), 1)),
        }
    }
    let words = |(name, count): (String, usize)| if count > 1 { format!("{name} x{count}") } else { name };
    let told: Vec<String> = told.into_iter().map(words).collect();
    (!told.is_empty()).then(|| format!("{}: {}", SECTORS[of], told.join(", ")))
}

/// The views by their turn from ahead, the one nearest to ahead first, then clockwise.
fn from_ahead(views: &[View; 4], heading: Heading) -> Vec<(f64, &View)> {
    let mut turned: Vec<(f64, &View)> = views.iter().map(|view| (heading.turn_to(view.pose.heading), view)).collect();
    turned.sort_by(|a, b| clockwise(a.0).total_cmp(&clockwise(b.0)));
    turned
}

/// A turn, counted clockwise from 45 degrees to the left, so that what lies ahead comes first.
pub(super) fn clockwise(turn_rad: f64) -> f64 {
    (turn_rad + std::f64::consts::FRAC_PI_4).rem_euclid(std::f64::consts::TAU)
}

fn pictured(views: &[View; 4], heading: Heading) -> Result<Scene, WalkError> {
    let mut scene = Scene::default();
    for (turn_rad, view) in from_ahead(views, heading) {
        let picture = view.image.clone().ok_or_else(|| missing("pictures"))?;
        scene.pictures.push(picture);
        scene.lines.push(format!("picture {} looks {}", scene.pictures.len(), turned(turn_rad)));
    }
    Ok(scene)
}

fn captioned(views: &[View; 4], heading: Heading, by: &dyn Describes) -> Result<Scene, WalkError> {
    let mut scene = Scene::default();
    for (turn_rad, view) in from_ahead(views, heading) {
        let caption = quoted(&by.describe(view)?, MOST_CAPTION_CHARS);
        scene.lines.push(format!("{}: {caption}", turned(turn_rad)));
    }
    Ok(scene)
}

/// A turn from ahead in words and degrees.
pub(super) fn turned(turn_rad: f64) -> String {
    let deg = turn_rad.to_degrees().round();
    match deg {
        0.0 => "ahead".to_owned(),
        deg if deg > 0.0 => format!("{}, {deg} degrees right", direction(turn_rad)),
        deg => format!("{}, {} degrees left", direction(turn_rad), -deg),
    }
}

fn missing(needs: &'static str) -> WalkError {
    let hint = "give --see labels on a platform with labels, --see pictures, or a model that sees as provider/model";
    WalkError::Model(ModelError::NothingToSee { name: "the agent tools".to_owned(), needs, hint })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_go_round_once() {
        let words: Vec<&str> = [0.0, 44.0, 90.0, 179.0, -179.0, -90.0, -30.0, -20.0]
            .into_iter()
            .map(|deg: f64| direction(deg.to_radians()))
            .collect();
        assert_eq!(words, ["ahead", "ahead-right", "right", "behind", "behind", "left", "ahead-left", "ahead"]);
        assert_eq!(turned(-0.5), "ahead-left, 29 degrees left");
        assert_eq!(turned(0.0), "ahead");
    }
}
