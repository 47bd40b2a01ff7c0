//! Which thing is removed, added or recoloured for a text.

use super::{Added, Recoloured, Removed};
use std::collections::BTreeSet;
use wayword_core::{
    DVec3, Frame, GroundTruth, Heading, Label, Mention, MentionKind, ObjectId, Path, View, seed::derive,
};
use wayword_language::lexicon::{Class, agree, same_colour, thing};

/// What is added: things that people name as landmarks. The first that is not seen along the path is taken.
const ADDED: [&str; 5] = ["piano", "fireplace", "bookshelf", "armchair", "wardrobe"];
/// How far ahead of a frame, and how far to its right, a thing is added, metres.
const ADDED_AT_M: (f64, f64) = (1.2, 0.9);
/// How far below the eye its centre is, metres.
const ADDED_BELOW_M: f64 = 0.8;
/// A thing that is added is seen from no farther than this, metres.
const SEEN_M: f64 = 4.0;
/// A colour has so many words at most.
const COLOUR_WORDS: usize = 2;
/// Colours that a thing may get: the first that neither it nor a namesake has.
const COLOURS: [&str; 5] = ["purple", "orange", "pink", "turquoise", "red"];

/// What is labelled along a path: for each frame the labels all around it.
#[derive(Debug, Clone, Default)]
pub struct Labelled(Vec<Vec<Label>>);

/// A text whose things are changed.
#[derive(Debug, Clone, Copy)]
pub struct Telling<'a> {
    /// Its words.
    pub text: &'a str,
    /// Its statements, each with its frame.
    pub mentions: &'a [Mention],
    /// Its path.
    pub path: &'a Path,
}

/// A thing that a text tells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Thing {
    /// The words of the text.
    pub words: String,
    /// Its name as the labels have it.
    pub name: String,
    /// It and its namesakes in sight of the path.
    pub objects: BTreeSet<ObjectId>,
    /// The frames that see one of these.
    pub seen_from: Vec<usize>,
    /// The word for the colour that the text tells of it.
    pub colour: Option<String>,
}

impl Labelled {
    /// The labels of the views around each frame of a path.
    #[must_use]
    pub fn along(panoramas: &[Vec<View>]) -> Self {
        let labels = |view: &View| view.ground_truth().map(|GroundTruth { labels, .. }| labels.clone());
        let around = |views: &Vec<View>| views.iter().filter_map(labels).flatten().collect();
        Self(panoramas.iter().map(around).collect())
    }

    /// The landmarks that a text tells and that are labelled where it tells them. Its target is none of them.
    #[must_use]
    pub fn told(&self, telling: Telling<'_>) -> Vec<Thing> {
        let Telling { text, mentions, path } = telling;
        let is_target = |name: &str| path.target.as_ref().is_some_and(|target| agree(&target.name, name));
        let landmarks = mentions.iter().filter(|mention| mention.kind == MentionKind::Landmark);
        let told = landmarks.filter_map(|mention| {
            let words = text.get(mention.span[0]..mention.span[1])?;
            let label = self.0.get(mention.frame)?.iter().find(|label| agree(&label.name, words))?;
            let from = text[..mention.span[0]].rmatch_indices(' ').nth(COLOUR_WORDS).map_or(0, |(at, _)| at + 1);
            Some(self.thing(words, &label.name, &text[from..mention.span[1]]))
        });
        told.filter(|thing| can_go(&thing.name) && !is_target(&thing.name)).collect()
    }

    /// A thing of that name, in words of a text. `said` are these and the few before them.
    fn thing(&self, words: &str, name: &str, said: &str) -> Thing {
        let (mut objects, mut seen_from, mut colours) = (BTreeSet::new(), Vec::new(), BTreeSet::new());
        for (frame, labels) in self.0.iter().enumerate() {
            let alike: Vec<&Label> = labels.iter().filter(|label| agree(&label.name, name)).collect();
            if !alike.is_empty() {
                seen_from.push(frame);
            }
            objects.extend(alike.iter().map(|label| label.object.clone()));
            colours.extend(alike.iter().filter_map(|label| label.colour.clone()));
        }
        // "Dark brown" is not "brown".
        let is_said = |colour: &&String| format!(" {said} ").contains(&format!(" {colour} "));
        let colour = colours.iter().filter(is_said).max_by_key(|colour| colour.len()).cloned();
        Thing { words: words.to_owned(), name: name.to_owned(), objects, seen_from, colour }
    }

    /// The things of a name and colour that are labelled anywhere along the path.
    fn of_colour(&self, name: &str, colour: &str) -> BTreeSet<ObjectId> {
        let is_it = |label: &&Label| agree(&label.name, name) && label.colour.as_deref() == Some(colour);
        self.0.iter().flatten().filter(is_it).map(|label| label.object.clone()).collect()
    }

    /// Whether a thing of that name has a colour that people would call by such a word.
    fn has_colour(&self, name: &str, colour: &str) -> bool {
        let mut alike = self.0.iter().flatten().filter(|label| agree(&label.name, name));
        alike.any(|label| label.colour.as_ref().is_some_and(|other| same_colour(other, colour)))
    }

    /// A thing that the text tells, drawn by the seed, and the world without it and its namesakes.
    #[must_use]
    pub fn without(&self, telling: Telling<'_>, seed: u64) -> Option<(Thing, Removed)> {
        let told = self.told(telling);
        let thing = told.get(drawn(seed, "remove", telling.path, told.len())?)?.clone();
        let objects = thing.objects.clone();
        Some((thing, Removed { objects }))
    }

    /// A thing whose colour the text tells, drawn by the seed, and the world in which it and its namesakes of that colour have
    /// another, which no namesake has.
    #[must_use]
    pub fn recoloured(&self, telling: Telling<'_>, seed: u64) -> Option<(Thing, Recoloured)> {
        let told: Vec<Thing> = self.told(telling).into_iter().filter(|thing| thing.colour.is_some()).collect();
        let thing = told.get(drawn(seed, "material", telling.path, told.len())?)?.clone();
        let colour = COLOURS.iter().find(|colour| !self.has_colour(&thing.name, colour))?;
        let objects = self.of_colour(&thing.name, thing.colour.as_deref()?);
        Some((thing, Recoloured { objects, colour: (*colour).to_owned() }))
    }

    /// A thing that nothing along the path is called, beside a frame that the seed draws, and the world with it.
    #[must_use]
    pub fn with_one_more(&self, path: &Path, seed: u64) -> Option<(Thing, Added)> {
        let is_new = |name: &&&str| !self.0.iter().flatten().any(|label| agree(&label.name, name));
        let name = (*ADDED.iter().find(is_new)?).to_owned();
        let frame = path.frames.get(drawn(seed, "add", path, path.frames.len())?)?;
        let (ahead_m, right_m) = ADDED_AT_M;
        let to = frame.pose.heading;
        let beside = to.turned(std::f64::consts::FRAC_PI_2).direction() * right_m;
        let position = frame.pose.position + to.direction() * ahead_m + beside - DVec3::Z * ADDED_BELOW_M;
        let is_near = |frame: &Frame| frame.pose.position.distance(position) <= SEEN_M;
        let seen_from: Vec<usize> = (0..path.frames.len()).filter(|at| is_near(&path.frames[*at])).collect();
        let object = ObjectId::new(format!("added-{name}")).ok()?;
        let label = Label {
            object: object.clone(),
            name: name.clone(),
            heading: Heading::NORTH,
            elevation_rad: 0.0,
            box_px: None,
            distance_m: None,
            position: Some(position),
            colour: None,
        };
        let frames = seen_from.iter().map(|at| path.frames[*at].clone()).collect();
        let added = Added { scene: path.scene.clone(), object: label, seen_from: frames };
        let objects = BTreeSet::from([object]);
        Some((Thing { words: name.clone(), name, objects, seen_from, colour: None }, added))
    }
}

/// Whether a thing can be taken away: doors and stairs stay where the way leads through them.
#[must_use]
pub fn can_go(name: &str) -> bool {
    let is_built_in = |class: Class| matches!(class, Class::Door | Class::Stairs | Class::Fabric);
    thing(name).is_none_or(|thing| !is_built_in(thing.class))
}

/// One of so many, by the seed and the path's name; `None` of none.
fn drawn(seed: u64, purpose: &str, path: &Path, of: usize) -> Option<usize> {
    let number = derive(seed, &["robustness", purpose, &path.id]);
    number.checked_rem(of as u64).and_then(|at| usize::try_from(at).ok())
}
