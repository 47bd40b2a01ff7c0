//! The material of a study: items with their texts, the routes that the texts describe, and the scenes that people walk.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_core::{DVec3, DoubtGrade, Heading, SceneId, TextDoubt, ViewpointGraph, ViewpointId, graph::GraphError};

/// The unit of the participants' work: a route with one text, or with two where texts are compared.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyItem {
    /// Its number in the study, from 0.
    pub id: u32,
    /// The number of its route.
    pub route: u32,
    /// Whether it is only for practice. Each participant gets it first, and no figure includes it.
    #[serde(default)]
    pub is_practice: bool,
    /// One text; two where texts are compared.
    pub texts: Vec<StudyText>,
}

/// A text and the condition to which it belongs.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyText {
    /// Name of the condition.
    pub condition: String,
    /// The instruction.
    pub text: String,
    /// The words that are marked as doubtful for those who walk by the text, in the order of the text.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub marks: Vec<TextMark>,
}

impl StudyText {
    /// Whether somebody who has read the other text would know this one: both have the same words.
    #[must_use]
    pub fn reads_like(&self, other: &Self) -> bool {
        self.text.split_whitespace().eq(other.text.split_whitespace())
    }
}

impl StudyItem {
    /// Whether two items have a text in common.
    #[must_use]
    pub fn shares_text_with(&self, other: &Self) -> bool {
        self.texts.iter().any(|text| other.texts.iter().any(|known| text.reads_like(known)))
    }
}

/// Words that are marked for the participants because a reader should doubt them.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TextMark {
    /// Their byte range in the text.
    pub span: [usize; 2],
    /// How much they are doubted.
    pub grade: DoubtGrade,
    /// Replacements, the best first; `None` means that the words are better left out.
    pub alternatives: Vec<Option<String>>,
}

impl From<TextDoubt> for TextMark {
    fn from(doubt: TextDoubt) -> Self {
        let alternatives = doubt.alternatives.into_iter().map(|one| one.words).collect();
        Self { span: doubt.span, grade: doubt.grade, alternatives }
    }
}

/// A path that texts describe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyRoute {
    /// Its number in the study, from 0.
    pub id: u32,
    /// Its name in the dataset or run, unique over all scenes.
    pub name: String,
    /// The scene.
    pub scene: SceneId,
    /// The viewpoints from start to goal; empty where the path has none.
    pub viewpoints: Vec<ViewpointId>,
    /// The heading of the walker at the start.
    pub start_heading: Heading,
    /// The pictures along it, in order; empty where people walk by themselves.
    #[serde(default)]
    pub film: Vec<FilmPicture>,
}

/// A picture of a film.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmPicture {
    /// Its file in the folder `pictures`.
    pub file: String,
    /// The alternative text for those who cannot see it. It does not name things that only the picture shows.
    pub alt: String,
}

/// A scene that people walk.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyScene {
    /// The scene.
    pub scene: SceneId,
    /// Its viewpoints.
    pub places: BTreeMap<ViewpointId, StudyViewpoint>,
}

/// A viewpoint with its panorama and its neighbours.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudyViewpoint {
    /// Metres, in the world frame, at the height of the eye.
    pub position: [f64; 3],
    /// Its storey, if it is known. The lowest is 1.
    pub level: Option<u32>,
    /// The viewpoints to which one can walk from it.
    pub neighbours: Vec<ViewpointId>,
    /// The first bend of the way to a neighbour, a point of the floor in the world frame, metres. A neighbour that is not here is reached
    /// straight, as far as the platform knows. A way with a bend leads round a corner or a piece of furniture, so one may not see its end.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub bends: BTreeMap<ViewpointId, [f64; 3]>,
    /// Its panorama: a file in the folder `pictures`. North is in the middle.
    pub panorama: String,
}

impl StudyViewpoint {
    /// Its position, metres.
    #[must_use]
    pub fn eye_position(&self) -> DVec3 {
        DVec3::from_array(self.position)
    }
}

impl StudyScene {
    /// The graph of its places.
    ///
    /// # Errors
    /// When a place names a neighbour that the scene does not have.
    pub fn to_graph(&self) -> Result<ViewpointGraph, GraphError> {
        let mut graph = ViewpointGraph::default();
        for (id, place) in &self.places {
            graph.add_viewpoint(id.clone(), place.eye_position(), place.level)?;
        }
        for (id, place) in &self.places {
            for neighbour in &place.neighbours {
                graph.join_viewpoints(id, neighbour)?;
            }
        }
        Ok(graph)
    }
}
