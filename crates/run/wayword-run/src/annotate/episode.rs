//! Annotates one episode: sees its frames, cuts it into parts, writes the texts, and checks each part's text against its own stretch.

use super::{
    cuts::{FilmPart, PartStart, cut_film},
    phrases::{PartSights, motion_phrase, part_phrase},
    questions::question_for,
    records::{AnnotatedFrame, AnnotatedPart, AnnotatedQuestion, DroppedText, EpisodeAnnotation, EpisodeText},
};
use crate::{
    annotate_args::KeptTexts,
    error::CommandError,
    follow::KnownScenes,
    item::RunItem,
    pairs::{PairPartRecord, PairPartState, filmed_places, hop_between, walk_by_motion},
    pictures::{MOST_PICTURES, evenly_chosen, write_small_picture},
    pipeline::{ItemTextOrder, RunPlatform, write_item},
    settings::RunSettings,
    styles::MeasuredStyle,
    team::RoleTeam,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
};
use wayword_checks::{Evidence, WalkMemory};
use wayword_core::{
    CameraMotion, ModelError, MotionSource, ObjectSighting, Path, Platform, PlatformError, SceneId, ViewGaze, ViewThird,
};
use wayword_follower::{
    alignment::PartedText,
    pair::{FilmedPlace, FilmedWalk, JudgedPair},
};
use wayword_language::{
    languages::ReadableText,
    lexicon::{find_thing, is_fabric, names_agree, same_room},
    reading::read_instruction,
};
use wayword_synthesis::{
    observe::ObserveError,
    repair::{InstructionOrder, OneByOne, WritingOutcome, write_and_repair},
    walk::ObservedWalk,
};

/// Who annotates, and how.
pub(super) struct EpisodeAnnotator<'a> {
    pub(super) platform: &'a dyn Platform,
    pub(super) settings: &'a RunSettings,
    pub(super) team: &'a RoleTeam,
    /// The style of the texts about the whole.
    pub(super) styles: &'a [MeasuredStyle],
    /// The style of the texts about parts.
    pub(super) subtask: &'a MeasuredStyle,
    pub(super) scenes: &'a KnownScenes,
    pub(super) keep: KeptTexts,
    /// Whether anybody sees.
    pub(super) sees: bool,
    /// Where the pictures of the page go.
    pub(super) pictures: &'a FilePath,
    /// Views that are described at the same time.
    pub(super) threads: usize,
}

/// An episode of the dataset.
pub(super) struct DatasetEpisode {
    pub(super) number: i64,
    pub(super) scene: SceneId,
    pub(super) tasks: Vec<String>,
}

impl EpisodeAnnotator<'_> {
    /// Annotates an episode.
    ///
    /// # Errors
    /// When its files cannot be read, or a model does not answer.
    pub(super) fn annotate(&self, episode: &DatasetEpisode) -> Result<EpisodeAnnotation, CommandError> {
        let film = self.film_of(&episode.scene)?;
        let mut annotation = EpisodeAnnotation {
            episode: episode.number,
            tasks: episode.tasks.clone(),
            motion: motion_word(film.as_ref()).to_owned(),
            parts: Vec::new(),
            texts: Vec::new(),
            questions: Vec::new(),
            dropped: Vec::new(),
            frames: Vec::new(),
        };
        let Some(film) = film else { return Ok(annotation) };
        let seen = self.see(episode, &film, &mut annotation)?;
        if film.stands_still() {
            self.keep_own_task(&mut annotation);
        } else {
            self.add_parts(seen.as_ref(), &film, &mut annotation)?;
        }
        if let Some(walk) = &seen {
            self.add_frames(episode, walk, &film, &mut annotation)?;
        }
        Ok(annotation)
    }

    /// How the camera moves: by poses, else by pictures.
    fn film_of(&self, scene: &SceneId) -> Result<Option<CameraMotion>, PlatformError> {
        match self.platform.film_motion(scene, MotionSource::Poses)? {
            Some(film) => Ok(Some(film)),
            None => self.platform.film_motion(scene, MotionSource::Pictures),
        }
    }

    /// What was seen along an episode. Texts about the whole are added on the way. `None` where nobody sees, or no path leads through the
    /// episode.
    fn see(
        &self,
        episode: &DatasetEpisode,
        film: &CameraMotion,
        annotation: &mut EpisodeAnnotation,
    ) -> Result<Option<ObservedWalk>, CommandError> {
        if !self.sees {
            return Ok(None);
        }
        let path = match self.platform.whole_path(&episode.scene) {
            Ok(Some(path)) => Path { id: episode.scene.to_string(), ..path },
            Ok(None) => return Ok(None),
            Err(error) => {
                annotation.dropped.push(DroppedText { text: String::new(), why: error.to_string() });
                return Ok(None);
            }
        };
        let styles = if film.stands_still() { &[][..] } else { self.styles };
        let order = ItemTextOrder { styles, only: &BTreeMap::new() };
        let world = RunPlatform { platform: self.platform, data: None, scenes: self.scenes };
        let item = RunItem::Walk(Box::new(path));
        let written = match write_item(&item, self.settings, world, self.team, order, self.threads) {
            Err(CommandError::Observe(ObserveError::Model(error @ ModelError::NothingToSee { .. }))) => {
                annotation.dropped.push(DroppedText { text: String::new(), why: error.to_string() });
                return Ok(None);
            }
            written => written?,
        };
        for outcome in written.outcomes {
            self.add_text(outcome, &written.walk, film, annotation);
        }
        Ok(Some(written.walk))
    }

    /// Keeps a text about the whole that passed its checks, if its claims fit the film.
    fn add_text(
        &self,
        outcome: WritingOutcome,
        walk: &ObservedWalk,
        film: &CameraMotion,
        annotation: &mut EpisodeAnnotation,
    ) {
        let (text, why) = match outcome {
            WritingOutcome::Accepted(instruction) => {
                let seen = SeenFilm::new(walk, film);
                let (state, why) = judge_text(&instruction.text, &seen.whole_film());
                if self.keeps(state) {
                    annotation.texts.push(EpisodeText { text: instruction.text, state });
                    return;
                }
                (instruction.text, why)
            }
            WritingOutcome::Rejected { last, reason, .. } => {
                (last.map(|instruction| instruction.text).unwrap_or_default(), reason)
            }
        };
        annotation.dropped.push(DroppedText { text, why });
    }

    fn keeps(&self, state: PairPartState) -> bool {
        match state {
            PairPartState::Fits => true,
            PairPartState::Unverified => self.keep == KeptTexts::Unverified,
            PairPartState::Wrong => false,
        }
    }

    /// Before a camera that stands still nothing is walked: the dataset's own task is all that is done.
    fn keep_own_task(&self, annotation: &mut EpisodeAnnotation) {
        let why = "the camera stands still, so there is no way to tell".to_owned();
        annotation.dropped.push(DroppedText { text: String::new(), why });
        if let Some(task) = annotation.tasks.first() {
            annotation.parts.push(AnnotatedPart {
                from: 0,
                start: start_word(PartStart::Beginning).to_owned(),
                text: task.clone(),
                by: "the dataset".to_owned(),
                state: PairPartState::Unverified,
            });
        }
    }

    fn add_parts(
        &self,
        walk: Option<&ObservedWalk>,
        film: &CameraMotion,
        annotation: &mut EpisodeAnnotation,
    ) -> Result<(), CommandError> {
        let seen = walk.map(|walk| SeenFilm::new(walk, film));
        let rooms = seen.as_ref().map(SeenFilm::room_changes).unwrap_or_default();
        let parts = cut_film(film, &rooms);
        for (number, part) in parts.iter().enumerate() {
            let is_last = number + 1 == parts.len();
            let (text, by, state) = self.part_text(seen.as_ref(), (part, is_last), annotation)?;
            let from = film.pictures.get(part.from).copied().unwrap_or_default();
            let from = if number == 0 { 0 } else { from };
            annotation.parts.push(AnnotatedPart { from, start: start_word(part.start).to_owned(), text, by, state });
        }
        Ok(())
    }

    /// The text of a part: the first of the model's, the rules' and that of the motion alone that is kept.
    fn part_text(
        &self,
        seen: Option<&SeenFilm<'_>>,
        (part, is_last): (&FilmPart, bool),
        annotation: &mut EpisodeAnnotation,
    ) -> Result<(String, String, PairPartState), CommandError> {
        if let Some(seen) = seen {
            let by_rules = (part_phrase(part, &seen.part_sights(part, is_last)), "rules".to_owned());
            for (text, by) in self.model_text(seen, part)?.into_iter().chain([by_rules]) {
                let (state, why) = judge_text(&text, &seen.film_of(part));
                if self.keeps(state) {
                    return Ok((text, by, state));
                }
                annotation.dropped.push(DroppedText { text, why });
            }
        }
        Ok((motion_phrase(part, is_last), "motion".to_owned(), PairPartState::Fits))
    }

    /// What the model that writes tells about a part; `None` where rules write, or the part has too few frames.
    fn model_text(&self, seen: &SeenFilm<'_>, part: &FilmPart) -> Result<Option<(String, String)>, CommandError> {
        if self.settings.roles.write.model_name().is_none() {
            return Ok(None);
        }
        let Some(walk) = seen.walk_of(part) else { return Ok(None) };
        let evidence = walk.evidence().unwrap_or_else(|| Evidence::for_path_alone(&walk.path));
        let memory = WalkMemory::from_path(&evidence, &walk.path);
        let order = InstructionOrder {
            walk: &walk,
            memory: &memory,
            evidence: &evidence,
            evidence_memory: &memory,
            style: &self.subtask.style,
            profile: &self.subtask.profile,
            style_hash: &self.subtask.hash,
            seed: self.settings.seed,
            repairs: self.settings.repairs,
            candidates: 1,
            only: None,
            follower: None,
            earlier: &[],
            pictures: &[],
            views: &[],
            refinements: 0,
            together: &OneByOne,
        };
        Ok(match write_and_repair(self.team.writers(), self.team.observers(), order)? {
            WritingOutcome::Accepted(instruction) => {
                let by = instruction.provenance.finished_for.as_ref().map_or("model", |_| "rules");
                Some((instruction.text, by.to_owned()))
            }
            WritingOutcome::Rejected { .. } => None,
        })
    }

    /// The frames that were looked at, with the pictures of the page and the questions about them.
    fn add_frames(
        &self,
        episode: &DatasetEpisode,
        walk: &ObservedWalk,
        film: &CameraMotion,
        annotation: &mut EpisodeAnnotation,
    ) -> Result<(), CommandError> {
        let shown = evenly_chosen(walk.path.frames.len(), MOST_PICTURES);
        let seen = SeenFilm::new(walk, film);
        let mut known_room = None;
        for (at, (frame, observed)) in walk.path.frames.iter().zip(&walk.observations).enumerate() {
            let place = frame.viewpoint.as_ref().and_then(|viewpoint| film.frames.get(viewpoint));
            let Some(number) = place.and_then(|place| film.pictures.get(*place)).copied() else { continue };
            let picture = if shown.contains(&at) {
                let view =
                    self.platform.look_from(&walk.path.scene, frame, ViewGaze::quarter_view(frame.pose.heading))?;
                write_small_picture(self.pictures, format!("{}_{number}.jpg", episode.number), &view)?
            } else {
                None
            };
            let caption = observed.looks.first().map(|look| &look.caption);
            let room = seen.rooms[at].as_deref();
            let is_sure = |sighting: &ObjectSighting| seen.is_seen_again(at, sighting);
            let new_room = room.filter(|room| known_room != Some(*room));
            if let Some(asked) = caption.and_then(|caption| question_for(caption, new_room, &is_sure)) {
                let (question, answer) = (asked.question, asked.answer);
                annotation.questions.push(AnnotatedQuestion { frame: number, question, answer });
            }
            known_room = room.or(known_room);
            annotation.frames.push(AnnotatedFrame {
                frame: number,
                picture,
                seen: walk.seen_from(at).map(|seen| seen.sighting.name.clone()).collect(),
                room: walk.room_at(at).map(str::to_owned),
            });
        }
        Ok(())
    }
}

fn motion_word(film: Option<&CameraMotion>) -> &'static str {
    match film.map(|film| film.source) {
        Some(MotionSource::Poses) => "poses",
        Some(MotionSource::Pictures) => "pictures",
        None => "unknown",
    }
}

fn start_word(start: PartStart) -> &'static str {
    match start {
        PartStart::Beginning => "beginning",
        PartStart::Turn => "turn",
        PartStart::Stairs => "stairs",
        PartStart::Room => "room",
        PartStart::Halt => "halt",
        PartStart::Length => "length",
    }
}

/// What was seen along a film.
struct SeenFilm<'a> {
    walk: &'a ObservedWalk,
    film: &'a CameraMotion,
    evidence: Evidence,
    /// The places of the frames, as texts are judged by them.
    places: Vec<FilmedPlace>,
    /// For each frame, its index among the pictures that the motion was told by.
    at: Vec<usize>,
    /// The room of each frame, without rooms that one frame alone names.
    rooms: Vec<Option<String>>,
}

impl<'a> SeenFilm<'a> {
    fn new(walk: &'a ObservedWalk, film: &'a CameraMotion) -> Self {
        let evidence = walk.evidence().unwrap_or_else(|| Evidence::for_path_alone(&walk.path));
        let places = filmed_places(&evidence);
        let index = |frame: &wayword_core::Frame| film.frames.get(frame.viewpoint.as_ref()?).copied();
        let at = walk.path.frames.iter().map(|frame| index(frame).unwrap_or_default()).collect();
        let named: Vec<Option<String>> =
            (0..walk.path.frames.len()).map(|frame| walk.room_at(frame).map(str::to_owned)).collect();
        Self { walk, film, evidence, places, at, rooms: without_lone_rooms(&named) }
    }

    /// Where another room begins: halfway between the last frame in the one and the first in the other.
    fn room_changes(&self) -> Vec<usize> {
        let mut changes = Vec::new();
        let mut last: Option<(usize, &str)> = None;
        for (frame, room) in self.rooms.iter().enumerate() {
            let Some(room) = room.as_deref() else { continue };
            if let Some((before, known)) = last
                && !same_room(known, room)
            {
                changes.push(self.at[before].midpoint(self.at[frame]));
            }
            last = Some((frame, room));
        }
        changes
    }

    /// The frames of a part.
    fn frames_of(&self, part: &FilmPart) -> Vec<usize> {
        (0..self.at.len()).filter(|frame| (part.from..=part.to).contains(&self.at[*frame])).collect()
    }

    /// The walk of a part; `None` where it has fewer than two frames.
    fn walk_of(&self, part: &FilmPart) -> Option<ObservedWalk> {
        let frames = self.frames_of(part);
        let (first, last) = (*frames.first()?, *frames.last()?);
        if first == last {
            return None;
        }
        let path = Path {
            id: format!("{}-{first}-{last}", self.walk.path.id),
            frames: self.walk.path.frames[first..=last].to_vec(),
            target: None,
            ..self.walk.path.clone()
        };
        Some(ObservedWalk::new(path, self.walk.observations[first..=last].to_vec()))
    }

    /// Whether another frame shows the same thing, in the same colour where it has one.
    fn is_seen_again(&self, frame: usize, sighting: &ObjectSighting) -> bool {
        let others = (0..self.at.len()).filter(|other| *other != frame).flat_map(|other| self.walk.seen_from(other));
        let is_same = |other: &ObjectSighting| {
            names_agree(&other.name, &sighting.name) && (sighting.colour.is_none() || other.colour == sighting.colour)
        };
        others.map(|seen| seen.sighting).any(is_same)
    }

    /// What a part leads to.
    fn part_sights(&self, part: &FilmPart, is_last: bool) -> PartSights {
        let room_by = |end: usize| {
            let mut known = self.rooms.iter().zip(&self.at).filter(|(room, at)| room.is_some() && **at <= end);
            known.next_back().and_then(|(room, _)| room.as_deref())
        };
        // The frame in which the next part begins shows where this one leads.
        let next = self.at.iter().copied().find(|at| *at >= part.to).unwrap_or(part.to);
        // At the middle between two rooms the walk is in the new one.
        let first = match part.start {
            PartStart::Room => self.at.iter().copied().find(|at| *at >= part.from).unwrap_or(part.from),
            _ => part.from,
        };
        let (before, after) = (room_by(first), room_by(next));
        let enters = after.filter(|after| before.is_some_and(|before| !same_room(before, after)));
        let last = self.frames_of(part).last().copied();
        PartSights { enters: enters.map(str::to_owned), towards: last.and_then(|frame| self.goal_at(frame)), is_last }
    }

    /// The thing ahead of a frame that stands out most, and that more than one frame shows.
    fn goal_at(&self, frame: usize) -> Option<String> {
        let is_goal = |sighting: &ObjectSighting| {
            sighting.place == Some(ViewThird::Middle)
                && !sighting.is_far
                && !sighting.several
                && !is_fabric(&sighting.name)
                && self.evidence.frames_with_thing(&sighting.name).len() > 1
        };
        let ahead = self.walk.seen_from(frame).map(|seen| seen.sighting).filter(|sighting| is_goal(sighting));
        let salience = |sighting: &&ObjectSighting| find_thing(&sighting.name).map_or(0, |thing| thing.salience);
        ahead.max_by_key(salience).map(|sighting| sighting.name.clone())
    }

    /// The film of the whole.
    fn whole_film(&self) -> FilmedWalk {
        walk_by_motion(&self.walk.path, &self.evidence, self.film).unwrap_or_default()
    }

    /// The film of a part, with the frames before and after it. What lies outside of it counts as straight, because its turns belong to other
    /// parts.
    fn film_of(&self, part: &FilmPart) -> FilmedWalk {
        let mut nodes: Vec<(usize, FilmedPlace)> = Vec::new();
        let before = self.at.iter().rposition(|at| *at < part.from);
        let after = self.at.iter().position(|at| *at > part.to);
        let frames = before.into_iter().chain(self.frames_of(part)).chain(after);
        nodes.extend(frames.map(|frame| (self.at[frame], self.places[frame].clone())));
        for end in [part.from, part.to] {
            if nodes.iter().all(|(at, _)| *at != end) {
                nodes.push((end, FilmedPlace::default()));
            }
        }
        nodes.sort_by_key(|(at, _)| *at);
        let hops = nodes
            .windows(2)
            .map(|pair| {
                let within = |at: usize| at.clamp(part.from, part.to);
                hop_between(self.film, within(pair[0].0), within(pair[1].0))
            })
            .collect();
        FilmedWalk { places: nodes.into_iter().map(|(_, place)| place).collect(), hops }
    }
}

/// Whether the claims of a text fit a film, and the reasons where they do not.
fn judge_text(text: &str, walk: &FilmedWalk) -> (PairPartState, String) {
    let readable = ReadableText::new(text, None);
    let reading = read_instruction(readable.english(), &BTreeSet::new()).into_claims();
    let judged = JudgedPair::new(&PartedText::from_reading(readable.english(), &reading), walk);
    let Some(judged) = judged else { return (PairPartState::Unverified, "it tells no step".to_owned()) };
    let parts: Vec<PairPartRecord> = judged.parts.iter().map(|part| PairPartRecord::new(part, walk)).collect();
    let state = parts.iter().map(|part| part.state).max().unwrap_or(PairPartState::Fits);
    let reasons = parts.iter().flat_map(|part| &part.findings).map(|finding| finding.reason.clone());
    (state, reasons.collect::<Vec<_>>().join("; "))
}

/// The rooms without those that one frame alone names between two that agree.
fn without_lone_rooms(named: &[Option<String>]) -> Vec<Option<String>> {
    let agree =
        |a: &Option<String>, b: &Option<String>| a.as_ref().zip(b.as_ref()).is_some_and(|(a, b)| same_room(a, b));
    (0..named.len())
        .map(|frame| {
            let before = frame.checked_sub(1).and_then(|before| named.get(before));
            let after = named.get(frame + 1);
            let is_lone = ![before, after].into_iter().flatten().any(|other| agree(other, &named[frame]));
            let has_two = named.len() > 2;
            named[frame].clone().filter(|_| !(is_lone && has_two))
        })
        .collect()
}

#[cfg(test)]
mod tests;
