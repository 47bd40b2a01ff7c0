//! Chooses the thing that is removed, added or recoloured for a text: one that the text mentions, or a new one near its path.

use super::{ThingAddition, ThingRecolouring, ThingRemoval};
use std::collections::BTreeSet;
use wayword_core::{
    DVec3, Frame, GroundTruth, Heading, MentionKind, ObjectId, ObjectLabel, Path, TextMention, View, seed::derive_seed,
};
use wayword_language::lexicon::{ThingClass, find_thing, names_agree, same_colour};

/// Names of things to add, which people use as landmarks. The first one that is not visible along the path is taken.
const ADDED_THING_NAMES: [&str; 5] = ["piano", "fireplace", "bookshelf", "armchair", "wardrobe"];
/// Distances ahead of a frame and to its right at which a thing is added, metres.
const ADDED_OFFSET_M: (f64, f64) = (1.2, 0.9);
/// Distance of its centre below the eye, metres.
const ADDED_BELOW_M: f64 = 0.8;
/// Largest distance from which an added thing is visible, metres.
const MAX_SEEN_DISTANCE_M: f64 = 4.0;
/// Most words of a colour. So many words before a thing's name are searched for one.
const MAX_COLOUR_WORDS: usize = 2;
/// Colours to give to a thing: the first one that neither it nor a namesake has is taken.
const NEW_COLOURS: [&str; 5] = ["purple", "orange", "pink", "turquoise", "red"];

/// The labels along a path: for each frame, those of all views around it.
#[derive(Debug, Clone, Default)]
pub struct PathLabels(Vec<Vec<ObjectLabel>>);

/// A text with its mentions and its path, for which a thing is to be changed.
#[derive(Debug, Clone, Copy)]
pub struct PathText<'a> {
    /// The text.
    pub text: &'a str,
    /// Its statements, each with its frame.
    pub mentions: &'a [TextMention],
    /// Its path.
    pub path: &'a Path,
}

/// A thing that a text mentions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MentionedThing {
    /// Its name in the words of the text.
    pub words: String,
    /// Its name in the labels.
    pub name: String,
    /// The object itself and its namesakes that are visible from the path.
    pub objects: BTreeSet<ObjectId>,
    /// The frames from which one of these is visible.
    pub seen_from: Vec<usize>,
    /// The word for its colour in the text, if there is one.
    pub colour: Option<String>,
}

impl PathLabels {
    /// The labels of the views around each frame of a path.
    #[must_use]
    pub fn from_panoramas(panoramas: &[Vec<View>]) -> Self {
        let labels = |view: &View| view.ground_truth().map(|GroundTruth { labels, .. }| labels.clone());
        let around = |views: &Vec<View>| views.iter().filter_map(labels).flatten().collect();
        Self(panoramas.iter().map(around).collect())
    }

    /// The landmarks that a text mentions and that have a label at the frame of the mention. The target is left out.
    #[must_use]
    pub fn mentioned_things(&self, path_text: PathText<'_>) -> Vec<MentionedThing> {
        let PathText { text, mentions, path } = path_text;
        let is_target = |name: &str| path.target.as_ref().is_some_and(|target| names_agree(&target.name, name));
        let landmarks = mentions.iter().filter(|mention| mention.kind == MentionKind::Landmark);
        let things = landmarks.filter_map(|mention| {
            let words = text.get(mention.span[0]..mention.span[1])?;
            let label = self.0.get(mention.frame)?.iter().find(|label| names_agree(&label.name, words))?;
            let from = text[..mention.span[0]].rmatch_indices(' ').nth(MAX_COLOUR_WORDS).map_or(0, |(at, _)| at + 1);
            Some(self.collect_thing(words, &label.name, &text[from..mention.span[1]]))
        });
        things.filter(|thing| can_be_removed(&thing.name) && !is_target(&thing.name)).collect()
    }

    /// Collects the objects of a name along the path. `words` are the text's name for it, and `phrase` has in addition the few words
    /// before them, in which the colour is looked for.
    fn collect_thing(&self, words: &str, name: &str, phrase: &str) -> MentionedThing {
        let (mut objects, mut seen_from, mut colours) = (BTreeSet::new(), Vec::new(), BTreeSet::new());
        for (frame, labels) in self.0.iter().enumerate() {
            let alike: Vec<&ObjectLabel> = labels.iter().filter(|label| names_agree(&label.name, name)).collect();
            if !alike.is_empty() {
                seen_from.push(frame);
            }
            objects.extend(alike.iter().map(|label| label.object.clone()));
            colours.extend(alike.iter().filter_map(|label| label.colour.clone()));
        }
        // "Dark brown" is not "brown".
        let is_in_phrase = |colour: &&String| format!(" {phrase} ").contains(&format!(" {colour} "));
        let colour = colours.iter().filter(is_in_phrase).max_by_key(|colour| colour.len()).cloned();
        MentionedThing { words: words.to_owned(), name: name.to_owned(), objects, seen_from, colour }
    }

    /// The objects of a name and colour with a label anywhere along the path.
    fn objects_of_colour(&self, name: &str, colour: &str) -> BTreeSet<ObjectId> {
        let is_it = |label: &&ObjectLabel| names_agree(&label.name, name) && label.colour.as_deref() == Some(colour);
        self.0.iter().flatten().filter(is_it).map(|label| label.object.clone()).collect()
    }

    /// Whether any thing of that name has a colour that people would describe by this word.
    fn has_colour(&self, name: &str, colour: &str) -> bool {
        let mut alike = self.0.iter().flatten().filter(|label| names_agree(&label.name, name));
        alike.any(|label| label.colour.as_ref().is_some_and(|other| same_colour(other, colour)))
    }

    /// Draws a thing that the text mentions, and returns it with the change that removes it and its namesakes.
    #[must_use]
    pub fn remove_thing(&self, path_text: PathText<'_>, seed: u64) -> Option<(MentionedThing, ThingRemoval)> {
        let things = self.mentioned_things(path_text);
        let thing = things.get(draw_index(seed, "remove", path_text.path, things.len())?)?.clone();
        let objects = thing.objects.clone();
        Some((thing, ThingRemoval { objects }))
    }

    /// Draws a thing with a colour in the text, and returns it with the change that gives it and its namesakes of that colour another
    /// one, which no namesake has.
    #[must_use]
    pub fn recolour_thing(&self, path_text: PathText<'_>, seed: u64) -> Option<(MentionedThing, ThingRecolouring)> {
        let things: Vec<MentionedThing> =
            self.mentioned_things(path_text).into_iter().filter(|thing| thing.colour.is_some()).collect();
        let thing = things.get(draw_index(seed, "material", path_text.path, things.len())?)?.clone();
        let colour = NEW_COLOURS.iter().find(|colour| !self.has_colour(&thing.name, colour))?;
        let objects = self.objects_of_colour(&thing.name, thing.colour.as_deref()?);
        Some((thing, ThingRecolouring { objects, colour: (*colour).to_owned() }))
    }

    /// Chooses a thing with a name that no label along the path has, and returns it with the change that puts it next to a drawn frame.
    #[must_use]
    pub fn add_thing(&self, path: &Path, seed: u64) -> Option<(MentionedThing, ThingAddition)> {
        let is_new = |name: &&&str| !self.0.iter().flatten().any(|label| names_agree(&label.name, name));
        let name = (*ADDED_THING_NAMES.iter().find(is_new)?).to_owned();
        let frame = path.frames.get(draw_index(seed, "add", path, path.frames.len())?)?;
        let (ahead_m, right_m) = ADDED_OFFSET_M;
        let facing = frame.pose.heading;
        let beside = facing.turned_by(std::f64::consts::FRAC_PI_2).unit_vector() * right_m;
        let position = frame.pose.position + facing.unit_vector() * ahead_m + beside - DVec3::Z * ADDED_BELOW_M;
        let is_near = |frame: &Frame| frame.pose.position.distance(position) <= MAX_SEEN_DISTANCE_M;
        let seen_from: Vec<usize> = (0..path.frames.len()).filter(|at| is_near(&path.frames[*at])).collect();
        let object = ObjectId::new(format!("added-{name}")).ok()?;
        let label = ObjectLabel {
            object: object.clone(),
            name: name.clone(),
            heading: Heading::NORTH,
            elevation_rad: 0.0,
            box_px: None,
            distance_m: None,
            position: Some(position),
            colour: None,
            room: None,
        };
        let frames = seen_from.iter().map(|at| path.frames[*at].clone()).collect();
        let added = ThingAddition { scene: path.scene.clone(), object: label, seen_from: frames };
        let objects = BTreeSet::from([object]);
        Some((MentionedThing { words: name.clone(), name, objects, seen_from, colour: None }, added))
    }
}

/// Whether things of this name can be removed. Doors, stairs and parts of the building cannot, because paths may lead through them.
#[must_use]
pub fn can_be_removed(name: &str) -> bool {
    let is_built_in = |class: ThingClass| matches!(class, ThingClass::Door | ThingClass::Stairs | ThingClass::Fabric);
    find_thing(name).is_none_or(|thing| !is_built_in(thing.class))
}

/// Draws an index below `count` by the seed and the path's id; `None` if `count` is 0.
fn draw_index(seed: u64, purpose: &str, path: &Path, count: usize) -> Option<usize> {
    let number = derive_seed(seed, &["robustness", purpose, &path.id]);
    number.checked_rem(count as u64).and_then(|at| usize::try_from(at).ok())
}
