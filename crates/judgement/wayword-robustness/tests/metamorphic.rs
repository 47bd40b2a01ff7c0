//! Metamorphic tests of the program's default roles (labels, and rules that write) on generated homes: the text for a changed world has
//! to differ from the text for the unchanged one exactly as the change demands.
//!
//! The follower that chooses among candidates in the program is left out. `WAYWORD_METAMORPHIC_PATHS` sets the number of paths,
//! `WAYWORD_METAMORPHIC_SHOW` how many of the differences of each test are printed.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]
#![allow(clippy::print_stderr, reason = "shares and differences are for whoever runs the test")]

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::{Arc, Mutex},
};
use wayword_checks::{Evidence, WalkMemory};
use wayword_core::{
    Frame, Heading, Instruction, InstructionStyle, MentionKind, ObjectId, ObjectLabel, Path, PathRequest, Platform,
    PlatformError, SceneId, TextMention, View, ViewGaze, ViewpointGraph, path::PathStop,
};
use wayword_house::{HouseOptions, HousePlatform};
use wayword_language::{
    lexicon::names_agree,
    reading::{EventContent, read_instruction},
};
use wayword_robustness::{
    metamorphic::{
        AnnotatedText, ChangedThing, ExpectationOutcome, check_added_thing, check_changed_material,
        check_mirrored_world, check_removed_thing, check_reversed_path, check_turned_world,
    },
    worlds::{
        AlteredPlatform, QuarterTurn, ThingAddition, ThingRecolouring, ThingRemoval, WorldAlteration, WorldMirror,
        can_be_removed,
    },
};
use wayword_synthesis::{
    dialogue::{DEFAULT_MAX_QUESTIONS, DialogueMode, RulesAsker, RulesSummariser},
    observe::{ObservationRoles, gazes_around, observe_path},
    offline::{BuildingListing, LabelAnswerer, describe_target, list_around_frame},
    repair::{InstructionOrder, OneByOne, WriterPair, WritingOutcome as Item, write_and_repair},
    style::{StyleProfile, built_in},
    walk::{FrameSelection, ObservedWalk},
    writer::RulesWriter,
};

/// Views by scene, place and gaze.
type Views = BTreeMap<(SceneId, [i64; 5]), View>;

/// A platform that renders each view once and caches it, without its picture, which these tests do not use.
#[derive(Clone)]
struct Drawn {
    platform: Arc<HousePlatform>,
    views: Arc<Mutex<Views>>,
}

impl Platform for Drawn {
    fn name(&self) -> &'static str {
        self.platform.name()
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        self.platform.list_scenes()
    }

    fn graph_for_scene(&self, scene: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        self.platform.graph_for_scene(scene)
    }

    fn sample_path(&self, scene: &SceneId, request: &PathRequest, seed: u64) -> Result<Path, PlatformError> {
        self.platform.sample_path(scene, request, seed)
    }

    /// A change of place and back again is off by the last bits, which would draw each view anew.
    fn look_from(&self, scene: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        let micro = |value: f64| (value * 1e6).round() as i64;
        let turn = micro(Heading::NORTH.turn_to(gaze.heading).rem_euclid(std::f64::consts::TAU - 1e-7));
        let [x, y, z] = from.pose.position.to_array().map(micro);
        let key = (scene.clone(), [x, y, z, turn, micro(gaze.horizontal_fov_rad)]);
        if let Some(view) = self.views.lock().unwrap().get(&key) {
            return Ok(view.clone());
        }
        let view = self.platform.look_from(scene, from, gaze)?;
        let view = View::new(view.pose, view.horizontal_fov_rad, None, view.ground_truth().cloned());
        self.views.lock().unwrap().insert(key, view.clone());
        Ok(view)
    }

    fn inner(&self) -> Option<&dyn Platform> {
        Some(&*self.platform)
    }
}

/// A walk in some world, with everything that a writer gets.
struct Known {
    walk: ObservedWalk,
    memory: WalkMemory,
    evidence: Evidence,
}

const STYLES: [&str; 2] = ["r2r", "reverie"];
const TESTS: [&str; 6] = ["mirror", "turn", "material", "reverse", "remove", "add"];

/// Prepares a walk as the program does for an item, except for the follower.
fn know(platform: &dyn Platform, mut path: Path) -> Known {
    let all_around = |frame: &Frame| -> Vec<View> {
        let gazes = gazes_around(&path, frame);
        gazes.iter().map(|gaze| platform.look_without_picture(&path.scene, frame, *gaze).unwrap()).collect()
    };
    let views: Vec<Vec<View>> = path.frames.iter().map(all_around).collect();
    if let (Some(target), Some(last), Some(at_end)) = (&mut path.target, path.frames.last(), views.last()) {
        let seen = list_around_frame(BuildingListing::default(), last, at_end, &[]);
        if seen.knows_frame(last) {
            describe_target(target, &path.frames, &seen);
        }
    }
    let observations =
        observe_path(platform, &path, FrameSelection::Central, observers(&RulesAsker::default())).unwrap();
    let walk = ObservedWalk::new(path, observations);
    let evidence = Evidence::from_labels(&walk.path, &views).unwrap();
    let memory = WalkMemory::from_path(&evidence, &walk.path);
    Known { walk, memory, evidence }
}

static LABELS: LabelAnswerer = LabelAnswerer { list_everything: false, calibration: None };

fn observers(asker: &RulesAsker) -> ObservationRoles<'_> {
    ObservationRoles {
        asker,
        answerer: &LABELS,
        summariser: &RulesSummariser,
        mode: DialogueMode::Dialogue { questions: DEFAULT_MAX_QUESTIONS },
        prompts_hash: None,
        detector: None,
    }
}

fn write(known: &Known, (style, profile): &(InstructionStyle, StyleProfile)) -> Instruction {
    let order = InstructionOrder {
        walk: &known.walk,
        memory: &known.memory,
        evidence: &known.evidence,
        evidence_memory: &known.memory,
        style,
        profile,
        style_hash: "",
        seed: 7,
        repairs: 8,
        candidates: 4,
        only: None,
        follower: None,
        earlier: &[],
        pictures: &[],
        views: &[],
        refinements: 0,
        together: &OneByOne,
    };
    let writers = WriterPair { writer: &RulesWriter, finisher: None };
    match write_and_repair(writers, observers(&RulesAsker::default()), order).unwrap() {
        Item::Accepted(instruction) | Item::Rejected { last: Some(instruction), .. } => instruction,
        Item::Rejected { last: None, reason, .. } => {
            unreachable!("{}: {reason}", known.walk.path.id)
        }
    }
}

fn said<'a>(instruction: &'a Instruction, path: &Path) -> AnnotatedText<'a> {
    AnnotatedText { text: &instruction.text, mentions: &instruction.mentions, last_frame: path.frames.len() - 1 }
}

/// The outcomes of each test and style.
type Outcomes = BTreeMap<(&'static str, &'static str), Vec<ExpectationOutcome>>;

/// All tests on one path.
struct Trial<'a> {
    platform: &'a Drawn,
    styles: &'a [(InstructionStyle, StyleProfile)],
    outcomes: Outcomes,
}

impl Trial<'_> {
    fn path(&mut self, path: &Path) {
        let base = know(self.platform, path.clone());
        let texts: Vec<Instruction> = self.styles.iter().map(|style| write(&base, style)).collect();
        self.space(path, &texts, "mirror", WorldMirror, check_mirrored_world);
        self.space(path, &texts, "turn", QuarterTurn, check_turned_world);
        self.back(path);
        for (at, text) in texts.iter().enumerate() {
            for (object, colour) in told_colours(text) {
                self.recolour(path, &base, at, text, &object, &colour);
            }
            for name in told_things(text) {
                self.remove(path, &base, at, text, &name);
            }
        }
        self.add(path, &base, &texts);
    }

    fn judge(&mut self, test: &'static str, style: usize, outcome: ExpectationOutcome) {
        self.outcomes.entry((test, STYLES[style])).or_default().push(outcome);
    }

    fn space(
        &mut self,
        path: &Path,
        texts: &[Instruction],
        test: &'static str,
        alter: impl WorldAlteration + Copy,
        judge: fn(AnnotatedText<'_>, AnnotatedText<'_>) -> ExpectationOutcome,
    ) {
        let changed = know(&AlteredPlatform::new(self.platform.clone(), alter), alter.path_after(path.clone()));
        for (at, text) in texts.iter().enumerate() {
            let other = write(&changed, &self.styles[at]);
            self.judge(test, at, judge(said(text, path), said(&other, path)));
        }
    }

    /// Checks the path in both directions, without a target, which is at one end only, and without a turn before the first step.
    fn back(&mut self, path: &Path) {
        let along = |reversed: bool| {
            let mut stops: Vec<PathStop> = path
                .frames
                .iter()
                .map(|frame| PathStop {
                    position: frame.pose.position,
                    viewpoint: frame.viewpoint.clone(),
                    level: frame.level,
                })
                .collect();
            if reversed {
                stops.reverse();
            }
            Path { frames: Path::frames_along(stops, None), target: None, ..path.clone() }
        };
        let (there, back) = (know(self.platform, along(false)), know(self.platform, along(true)));
        for at in 0..self.styles.len() {
            let (there, back) = (write(&there, &self.styles[at]), write(&back, &self.styles[at]));
            self.judge("reverse", at, check_reversed_path(said(&there, path), said(&back, path)));
        }
    }

    fn recolour(&mut self, path: &Path, base: &Known, at: usize, text: &Instruction, name: &str, colour: &str) {
        let things = || base.evidence.frames.iter().flat_map(|frame| &frame.things);
        let is_it = |thing: &&wayword_checks::SeenThing| {
            names_agree(&thing.name, name) && thing.colour.as_deref() == Some(colour)
        };
        let objects: BTreeSet<ObjectId> = things().filter(is_it).filter_map(|thing| thing.object.clone()).collect();
        let is_free = |new: &&str| things().all(|thing| thing.colour.as_deref() != Some(new));
        // Of as many words, for a text has its length.
        let shade = if colour.contains(' ') { "light " } else { "" };
        let others = ["purple", "orange", "pink", "turquoise"].map(|other| format!("{shade}{other}"));
        let new = others.iter().map(String::as_str).find(is_free).unwrap();
        let alter = ThingRecolouring { objects, colour: new.to_owned() };
        let changed = know(&AlteredPlatform::new(self.platform.clone(), alter.clone()), alter.path_after(path.clone()));
        let other = write(&changed, &self.styles[at]);
        self.judge("material", at, check_changed_material(said(text, path), said(&other, path), colour, new));
    }

    fn remove(&mut self, path: &Path, base: &Known, at: usize, text: &Instruction, name: &str) {
        // The target is given with the path.
        if path.target.as_ref().is_some_and(|target| names_agree(&target.name, name)) {
            return;
        }
        let is_it = |thing: &&wayword_checks::SeenThing| names_agree(&thing.name, name);
        let frames = base.evidence.frames.iter().enumerate();
        let seen_from: Vec<usize> =
            frames.filter(|(_, frame)| frame.things.iter().any(|t| is_it(&t))).map(|(at, _)| at).collect();
        let things = base.evidence.frames.iter().flat_map(|frame| &frame.things);
        let objects: BTreeSet<ObjectId> = things.filter(is_it).filter_map(|thing| thing.object.clone()).collect();
        let alter = ThingRemoval { objects };
        let changed = know(&AlteredPlatform::new(self.platform.clone(), alter.clone()), alter.path_after(path.clone()));
        let other = write(&changed, &self.styles[at]);
        self.judge(
            "remove",
            at,
            check_removed_thing(said(text, path), said(&other, path), ChangedThing { name, seen_from: &seen_from }),
        );
    }

    /// Adds a thing that no home has, near the middle of the path and near its end.
    fn add(&mut self, path: &Path, base: &Known, texts: &[Instruction]) {
        let last = path.frames.len() - 1;
        let things = || base.evidence.frames.iter().flat_map(|frame| &frame.things);
        let is_new = |name: &&str| things().all(|thing| !names_agree(&thing.name, name));
        let Some(name) = ["piano", "fireplace", "statue"].into_iter().find(is_new) else { return };
        for by in BTreeSet::from([last / 2, last]) {
            let seen_from: Vec<usize> = (by.saturating_sub(1)..=(by + 1).min(last)).collect();
            let frame = &path.frames[by];
            let beside = frame.pose.heading.turned_by(0.7).unit_vector() * 1.2;
            let object = ObjectLabel {
                object: ObjectId::new("added").unwrap(),
                name: name.to_owned(),
                heading: Heading::NORTH,
                elevation_rad: 0.0,
                box_px: None,
                distance_m: None,
                position: Some(frame.pose.position + beside),
                colour: None,
                room: None,
            };
            let frames = seen_from.iter().map(|at| path.frames[*at].clone()).collect();
            let alter = ThingAddition { scene: path.scene.clone(), object, seen_from: frames };
            let changed =
                know(&AlteredPlatform::new(self.platform.clone(), alter.clone()), alter.path_after(path.clone()));
            for (at, text) in texts.iter().enumerate() {
                let other = write(&changed, &self.styles[at]);
                self.judge(
                    "add",
                    at,
                    check_added_thing(
                        said(text, path),
                        said(&other, path),
                        ChangedThing { name, seen_from: &seen_from },
                    ),
                );
            }
        }
    }
}

/// The things on the way that a text names and that can be taken away.
fn told_things(text: &Instruction) -> BTreeSet<String> {
    let is_thing = |mention: &&TextMention| mention.kind == MentionKind::Landmark;
    text.mentions
        .iter()
        .filter(is_thing)
        .map(|mention| name_in(text, mention.span))
        .filter(|name| can_be_removed(name))
        .collect()
}

/// The things of a text that have a colour in it, with the colour.
fn told_colours(text: &Instruction) -> BTreeSet<(String, String)> {
    let events = read_instruction(&text.text, &BTreeSet::new()).events;
    let coloured = events.into_iter().filter_map(|event| match event.what {
        EventContent::Place(place) if place.is_thing => Some((place.name.clone(), place.colour?)),
        _ => None,
    });
    coloured.collect()
}

fn name_in(text: &Instruction, span: [usize; 2]) -> String {
    text.text[span[0]..span[1]].to_lowercase()
}

fn outcomes(paths: usize) -> Outcomes {
    let styles: Vec<(InstructionStyle, StyleProfile)> = STYLES
        .iter()
        .map(|name| {
            let style = built_in(name).unwrap();
            let profile = StyleProfile::for_style(&style);
            (style, profile)
        })
        .collect();
    let of_thread = |first: usize, step: usize| {
        let options = HouseOptions { width_px: 320, height_px: 240, ..HouseOptions::default() };
        let mut all = Outcomes::new();
        for number in (first..paths).step_by(step) {
            let platform = Drawn { platform: Arc::new(HousePlatform::new(options.clone())), views: Arc::default() };
            let scene = HousePlatform::scene_of(number as u64).unwrap();
            let Ok(path) = platform.sample_path(&scene, &PathRequest::default(), number as u64) else { continue };
            let mut trial = Trial { platform: &platform, styles: &styles, outcomes: Outcomes::new() };
            trial.path(&path);
            trial.outcomes.into_iter().for_each(|(key, found)| all.entry(key).or_default().extend(found));
        }
        all
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        let running: Vec<_> = (0..threads).map(|first| scope.spawn(move || of_thread(first, threads))).collect();
        let mut all = Outcomes::new();
        for thread in running {
            thread.join().unwrap().into_iter().for_each(|(key, found)| all.entry(key).or_default().extend(found));
        }
        all
    })
}

/// How many paths the tests are made of by default.
const PATHS: usize = 12;

/// Each test has to hold in at least this share of the texts that mention the changed thing. A text that fails a check is written again,
/// and a thing that is removed can be why it failed or not: so once in a while the whole text is another one.
const LEAST: [(&str, f64); 6] =
    [("mirror", 1.0), ("turn", 1.0), ("material", 1.0), ("reverse", 0.99), ("remove", 0.97), ("add", 0.75)];

#[test]
fn texts_of_changed_worlds_are_what_the_change_makes_of_them() {
    let number = |name: &str, usual: usize| std::env::var(name).map_or(usual, |value| value.parse().unwrap());
    let all = outcomes(number("WAYWORD_METAMORPHIC_PATHS", PATHS));
    let show = number("WAYWORD_METAMORPHIC_SHOW", 0);
    let mut short: Vec<String> = Vec::new();
    for test in TESTS {
        for style in STYLES {
            let found = all.get(&(test, style)).map_or(&[][..], Vec::as_slice);
            let told = found.iter().filter(|outcome| **outcome != ExpectationOutcome::NotTold).count();
            let holds = found.iter().filter(|outcome| **outcome == ExpectationOutcome::Holds).count();
            let share = if told == 0 { 1.0 } else { holds as f64 / told as f64 };
            eprintln!("{test:9} {style:8} {holds:4} of {told:4} told ({:.1} %), {} tried", share * 100.0, found.len());
            let differs = found.iter().filter_map(|outcome| match outcome {
                ExpectationOutcome::Differs(why) => Some(why),
                _ => None,
            });
            differs.take(show).for_each(|why| eprintln!("    {why}"));
            let least = LEAST.iter().find(|(name, _)| *name == test).map_or(1.0, |(_, least)| *least);
            if share < least {
                short.push(format!("{test} in {style}: {share:.3}, not {least}"));
            }
        }
    }
    assert!(short.is_empty(), "{short:?}");
}
