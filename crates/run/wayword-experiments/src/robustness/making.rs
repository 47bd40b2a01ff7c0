//! Writes the texts of one path in one arm: sets up the arm's world, lets the team write, and lets an agent walk by the result.

use super::{
    arm::Arm,
    base::Base,
    elsewhere::Elsewhere,
    other::{self, Other},
    reader,
    record::{Edit, Line, Told},
    world::{self, World},
};
use crate::demands::Demands;
use std::{collections::BTreeMap, slice};
use wayword_core::{Path, Platform, SceneId, seed::derive};
use wayword_robustness::{
    Change, Whole,
    worlds::{Altered, EyeOf, Labelled, Mirror, QuarterTurn, ScriptedEye, Telling, Thing},
};
use wayword_run::{
    error::Error,
    follow::KnownScenes,
    item::Item,
    pipeline::{Ordered, RunPlatform, panoramas, write},
    settings::Settings,
    styles::Measured,
    team::Team,
};
use wayword_synthesis::repair::Outcome;

/// Writes texts with the models and in the world of the run.
pub(super) struct Crew<'a> {
    pub(super) base: &'a Base,
    /// The world of the run.
    pub(super) platform: &'a dyn Platform,
    /// The models and rules that fill the run's roles.
    pub(super) team: &'a Team,
    /// The same with another sample of each model, for the arm [`Arm::Again`].
    pub(super) again: &'a Team,
    /// The scripted eye that sees in place of labels, if one was given.
    pub(super) eye: Option<EyeOf>,
    pub(super) seed: u64,
    /// How many views of one path are described at a time.
    pub(super) threads: usize,
}

/// The lines of the unchanged arm, by path.
pub(super) type Unchanged = BTreeMap<String, Line>;

/// An arm with its caches of scenes, and the platforms that it needs.
pub(super) struct InArm<'a> {
    pub(super) arm: &'a Arm,
    pub(super) scenes: KnownScenes,
    /// The platform that gives the space for the agent's walks, and its distances.
    pub(super) walks: &'a dyn Platform,
    pub(super) demands: Demands<'a>,
    /// The other platform, in an arm that changes the platform.
    pub(super) elsewhere: Option<Elsewhere>,
    /// The lines of the unchanged arm.
    pub(super) unchanged: &'a Unchanged,
}

impl InArm<'_> {
    /// The number of the candidate to write for each style. A choice among candidates weighs whole texts, and could pick another
    /// one after a change. If the effect of the change on a text is known, the changed world therefore gets the same candidate as
    /// the unchanged one.
    fn candidates(&self, path: &Path) -> BTreeMap<String, u32> {
        let before = self.unchanged.get(&path.id).filter(|_| self.arm.is_exact());
        before.map(Line::candidates).unwrap_or_default()
    }
}

impl Crew<'_> {
    /// Writes the texts of a path of the run in an arm.
    ///
    /// # Errors
    /// When a view cannot be had, or a model fails.
    pub(super) fn line(&self, within: &InArm<'_>, path: &Path) -> Result<Line, Error> {
        let arm = within.arm;
        let all_frames = |path: &Path| (0..path.frames.len()).collect();
        match arm {
            Arm::Unchanged => self.line_of(within, self.team, self.platform, (path.clone(), all_frames(path)), None),
            Arm::Again => self.line_of(within, self.again, self.platform, (path.clone(), all_frames(path)), None),
            Arm::Other => match other::other(self.platform, path, within.unchanged, self.seed)? {
                Some(Other::Told(line)) => Ok(Line { arm: arm.id(), path: path.clone(), ..*line }),
                Some(Other::New(other)) => {
                    let frames = all_frames(&other);
                    self.line_of(within, self.team, self.platform, (other, frames), None)
                }
                None => Ok(Line::left_out(arm, path, "no other path of its building has as many hops")),
            },
            Arm::Changed(change) if arm.is_edit() => self.edited(within, change, path),
            Arm::Forward | Arm::Changed(_) => {
                let sees_labels = self.eye.is_none() && self.base.settings.roles.models().is_empty();
                let world = match &within.elsewhere {
                    Some(elsewhere) => elsewhere.world(path, sees_labels),
                    None => world::of(arm, self.platform, path, self.seed),
                };
                // Even by texts of another platform the agent walks in the run's own world.
                let walked = within.elsewhere.as_ref().map(|_| path);
                match world {
                    Ok(World { platform, path, base_frame_of }) => {
                        self.line_of(within, self.team, platform.as_ref(), (path, base_frame_of), walked)
                    }
                    Err(reason) => Ok(Line::left_out(arm, path, &reason)),
                }
            }
        }
    }

    fn line_of(
        &self,
        within: &InArm<'_>,
        team: &Team,
        platform: &dyn Platform,
        (path, base_frame_of): (Path, Vec<usize>),
        walked: Option<&Path>,
    ) -> Result<Line, Error> {
        let mut texts = self.texts(within, team, platform, &path, &self.base.styles)?;
        let walked = walked.unwrap_or(&path);
        if within.arm.is_walked() {
            for told in &mut texts {
                let Some(text) = &told.text else { continue };
                told.arrived = reader::arrives(within.walks, &within.demands, walked, text)?;
            }
        }
        let path = Path { scene: walked.scene.clone(), ..path };
        Ok(Line { arm: within.arm.id(), path, base_frame_of, texts, left_out: None })
    }

    /// Writes the texts of a path in some styles.
    fn texts(
        &self,
        within: &InArm<'_>,
        team: &Team,
        platform: &dyn Platform,
        path: &Path,
        styles: &[Measured],
    ) -> Result<Vec<Told>, Error> {
        let eyed = self.eye.map(|eye| self.eyed(within, platform, &path.scene, eye));
        let platform = eyed.as_ref().map_or(platform, |eyed| eyed as &dyn Platform);
        let again = within.arm == &Arm::Again;
        let seed = self.base.settings.seed;
        let seed = if again { derive(seed, &["robustness", "again"]) } else { seed };
        let settings = Settings { seed, ..self.base.settings.clone() };
        let world = RunPlatform { platform, data: None, scenes: &within.scenes };
        let item = Item::Walk(Box::new(path.clone()));
        let only = within.candidates(path);
        let written = write(&item, &settings, world, team, Ordered { styles, only: &only }, self.threads)?;
        let told = |(outcome, style): (Outcome, &Measured)| Told::of(&style.style.name, outcome);
        Ok(written.outcomes.into_iter().zip(styles).map(told).collect())
    }

    /// A platform through a scripted eye. On another platform, the eye answers from the labels of the run's world at the same pose.
    fn eyed<'w>(
        &'w self,
        within: &InArm<'_>,
        platform: &'w dyn Platform,
        scene: &SceneId,
        eye: EyeOf,
    ) -> ScriptedEye<&'w dyn Platform, &'w dyn Platform> {
        let base_scene = within.elsewhere.as_ref().and_then(|elsewhere| elsewhere.base_scene(scene));
        let eyed = match base_scene {
            Some(base) => {
                ScriptedEye::new(platform, self.platform, eye, self.seed).with_scene(scene.clone(), base.clone())
            }
            None => ScriptedEye::new(platform, platform, eye, self.seed),
        };
        eyed.at(within.arm.strength())
    }

    /// Writes the texts of a path after one thing of its world has changed. For each style it is a thing from the text of that style.
    fn edited(&self, within: &InArm<'_>, change: &Change, path: &Path) -> Result<Line, Error> {
        let labelled = Labelled::along(&panoramas(self.platform, path)?);
        let mut texts = Vec::new();
        for style in &self.base.styles {
            let before = within.unchanged.get(&path.id).and_then(|line| line.told(&style.style.name));
            let Some((text, before)) = before.and_then(|told| Some((told.text.as_ref()?, told))) else { continue };
            let telling = Telling { text, mentions: &before.mentions, path };
            let Some((platform, edit)) = self.edit(change, &labelled, telling) else { continue };
            // Each text has its own changed world, so nothing may come from a cache of another one.
            let own = InArm {
                arm: within.arm,
                scenes: KnownScenes::new(),
                walks: within.walks,
                demands: Demands::new(within.walks),
                elsewhere: None,
                unchanged: within.unchanged,
            };
            for told in self.texts(&own, self.team, platform.as_ref(), path, slice::from_ref(style))? {
                texts.push(Told { edit: Some(edit.clone()), ..told });
            }
        }
        let base_frame_of = (0..path.frames.len()).collect();
        Ok(Line { arm: within.arm.id(), path: path.clone(), base_frame_of, texts, left_out: None })
    }

    /// The world with one thing removed, recoloured or added; `None` if no thing is suitable.
    fn edit<'w>(
        &'w self,
        change: &Change,
        labelled: &Labelled,
        telling: Telling<'_>,
    ) -> Option<(Box<dyn Platform + 'w>, Edit)> {
        let edit = |thing: Thing, colours| Edit { name: thing.words, seen_from: thing.seen_from, colours };
        Some(match change {
            Change::Whole(Whole::Remove) => {
                let (thing, removed) = labelled.without(telling, self.seed)?;
                (Box::new(Altered::new(self.platform, removed)), edit(thing, None))
            }
            Change::Whole(Whole::Material) => {
                let (thing, recoloured) = labelled.recoloured(telling, self.seed)?;
                let colours = thing.colour.clone().map(|before| [before, recoloured.colour.clone()]);
                (Box::new(Altered::new(self.platform, recoloured)), edit(thing, colours))
            }
            _ => {
                let (thing, added) = labelled.with_one_more(telling.path, self.seed)?;
                (Box::new(Altered::new(self.platform, added)), edit(thing, None))
            }
        })
    }
}

/// The platform that gives the space for an agent that walks by the texts of an arm.
pub(super) fn walked<'a>(arm: &Arm, platform: &'a dyn Platform) -> Box<dyn Platform + 'a> {
    match arm {
        Arm::Changed(Change::Whole(Whole::Mirror)) => Box::new(Altered::new(platform, Mirror)),
        Arm::Changed(Change::Whole(Whole::Turn)) => Box::new(Altered::new(platform, QuarterTurn)),
        _ => Box::new(platform),
    }
}
