//! Writes the texts of one path in one arm: sets up the arm's world, lets the team write, and lets an agent walk by the result.

use super::{
    arm::RobustnessArm,
    base::BaseRun,
    other_path::{self, OtherPathChoice},
    other_platform::OtherPlatformScenes,
    reader,
    record::{ArmPathRecord, ArmText, ThingEdit, UnchangedRecords},
    world::{self, ChangedWorld},
};
use crate::demands::PlatformDemands;
use std::{collections::BTreeMap, slice};
use wayword_core::{Path, Platform, SceneId, seed::derive_seed};
use wayword_robustness::{
    Change, WholeChange,
    worlds::{
        AlteredPlatform, EyeQuality, MentionedThing, PathLabels, PathText, QuarterTurn, ScriptedEye, WorldMirror,
    },
};
use wayword_run::{
    error::CommandError,
    follow::KnownScenes,
    item::RunItem,
    pipeline::{ItemTextOrder, RunPlatform, path_panoramas, write_item},
    settings::RunSettings,
    styles::MeasuredStyle,
    team::RoleTeam,
};
use wayword_synthesis::repair::WritingOutcome;

/// Writes texts with the models and in the world of the run.
pub(super) struct ArmTextWriter<'a> {
    pub(super) base: &'a BaseRun,
    /// The world of the run.
    pub(super) platform: &'a dyn Platform,
    /// The models and rules that fill the run's roles.
    pub(super) team: &'a RoleTeam,
    /// The same with another sample of each model, for the arm [`RobustnessArm::RepeatedTexts`].
    pub(super) again: &'a RoleTeam,
    /// The scripted eye that sees in place of labels, if one was given.
    pub(super) eye: Option<EyeQuality>,
    pub(super) seed: u64,
    /// How many views of one path are described at a time.
    pub(super) threads: usize,
}

/// An arm with its caches of scenes, and the platforms that it needs.
pub(super) struct ArmContext<'a> {
    pub(super) arm: &'a RobustnessArm,
    pub(super) scenes: KnownScenes,
    /// The platform that gives the space for the agent's walks, and its distances.
    pub(super) walks: &'a dyn Platform,
    pub(super) demands: PlatformDemands<'a>,
    /// The other platform, in an arm that changes the platform.
    pub(super) elsewhere: Option<OtherPlatformScenes>,
    /// The lines of the unchanged arm.
    pub(super) unchanged: &'a UnchangedRecords,
}

impl ArmContext<'_> {
    /// The number of the candidate to write for each style. A choice among candidates weighs whole texts, and could pick another
    /// one after a change. If the effect of the change on a text is known, the changed world therefore gets the same candidate as
    /// the unchanged one.
    fn chosen_candidates(&self, path: &Path) -> BTreeMap<String, u32> {
        let before = self.unchanged.get(&path.id).filter(|_| self.arm.is_exact());
        before.map(ArmPathRecord::candidates_by_style).unwrap_or_default()
    }
}

impl ArmTextWriter<'_> {
    /// Writes the texts of a path of the run in an arm.
    ///
    /// # Errors
    /// When a view cannot be had, or a model fails.
    pub(super) fn make_record(&self, within: &ArmContext<'_>, path: &Path) -> Result<ArmPathRecord, CommandError> {
        let arm = within.arm;
        let all_frames = |path: &Path| (0..path.frames.len()).collect();
        match arm {
            RobustnessArm::Unchanged => {
                self.make_record_in_world(within, self.team, self.platform, (path.clone(), all_frames(path)), None)
            }
            RobustnessArm::Again => {
                self.make_record_in_world(within, self.again, self.platform, (path.clone(), all_frames(path)), None)
            }
            RobustnessArm::Other => {
                match other_path::find_other_path(self.platform, path, within.unchanged, self.seed)? {
                    Some(OtherPathChoice::Told(line)) => {
                        Ok(ArmPathRecord { arm: arm.id(), path: path.clone(), ..*line })
                    }
                    Some(OtherPathChoice::New(other)) => {
                        let frames = all_frames(&other);
                        self.make_record_in_world(within, self.team, self.platform, (other, frames), None)
                    }
                    None => Ok(ArmPathRecord::left_out(arm, path, "no other path of its building has as many hops")),
                }
            }
            RobustnessArm::Changed(change) if arm.is_edit() => self.make_edited_record(within, change, path),
            RobustnessArm::Forward | RobustnessArm::Changed(_) => {
                let sees_labels = self.eye.is_none() && self.base.settings.roles.model_names().is_empty();
                let world = match &within.elsewhere {
                    Some(elsewhere) => elsewhere.world_for_path(path, sees_labels),
                    None => world::world_for_arm(arm, self.platform, path, self.seed),
                };
                // Even by texts of another platform the agent walks in the run's own world.
                let walked = within.elsewhere.as_ref().map(|_| path);
                match world {
                    Ok(ChangedWorld { platform, path, base_frame_of }) => {
                        self.make_record_in_world(within, self.team, platform.as_ref(), (path, base_frame_of), walked)
                    }
                    Err(reason) => Ok(ArmPathRecord::left_out(arm, path, &reason)),
                }
            }
        }
    }

    fn make_record_in_world(
        &self,
        within: &ArmContext<'_>,
        team: &RoleTeam,
        platform: &dyn Platform,
        (path, base_frame_of): (Path, Vec<usize>),
        walked: Option<&Path>,
    ) -> Result<ArmPathRecord, CommandError> {
        let mut texts = self.write_texts(within, team, platform, &path, &self.base.styles)?;
        let walked = walked.unwrap_or(&path);
        if within.arm.is_walked() {
            for told in &mut texts {
                let Some(text) = &told.text else { continue };
                told.arrived = reader::reader_arrives(within.walks, &within.demands, walked, text)?;
            }
        }
        let path = Path { scene: walked.scene.clone(), ..path };
        Ok(ArmPathRecord { arm: within.arm.id(), path, base_frame_of, texts, left_out: None })
    }

    /// Writes the texts of a path in some styles.
    fn write_texts(
        &self,
        within: &ArmContext<'_>,
        team: &RoleTeam,
        platform: &dyn Platform,
        path: &Path,
        styles: &[MeasuredStyle],
    ) -> Result<Vec<ArmText>, CommandError> {
        let eyed = self.eye.map(|eye| self.through_eye(within, platform, &path.scene, eye));
        let platform = eyed.as_ref().map_or(platform, |eyed| eyed as &dyn Platform);
        let again = within.arm == &RobustnessArm::Again;
        let seed = self.base.settings.seed;
        let seed = if again { derive_seed(seed, &["robustness", "again"]) } else { seed };
        let settings = RunSettings { seed, ..self.base.settings.clone() };
        let world = RunPlatform { platform, data: None, scenes: &within.scenes };
        let item = RunItem::Walk(Box::new(path.clone()));
        let only = within.chosen_candidates(path);
        let written = write_item(&item, &settings, world, team, ItemTextOrder { styles, only: &only }, self.threads)?;
        let told =
            |(outcome, style): (WritingOutcome, &MeasuredStyle)| ArmText::from_outcome(&style.style.name, outcome);
        Ok(written.outcomes.into_iter().zip(styles).map(told).collect())
    }

    /// A platform through a scripted eye. On another platform, the eye answers from the labels of the run's world at the same pose.
    fn through_eye<'w>(
        &'w self,
        within: &ArmContext<'_>,
        platform: &'w dyn Platform,
        scene: &SceneId,
        eye: EyeQuality,
    ) -> ScriptedEye<&'w dyn Platform, &'w dyn Platform> {
        let base_scene = within.elsewhere.as_ref().and_then(|elsewhere| elsewhere.base_scene(scene));
        let eyed = match base_scene {
            Some(base) => {
                ScriptedEye::new(platform, self.platform, eye, self.seed).with_scene(scene.clone(), base.clone())
            }
            None => ScriptedEye::new(platform, platform, eye, self.seed),
        };
        eyed.at_strength(within.arm.change_strength())
    }

    /// Writes the texts of a path after one thing of its world has changed. For each style it is a thing from the text of that style.
    fn make_edited_record(
        &self,
        within: &ArmContext<'_>,
        change: &Change,
        path: &Path,
    ) -> Result<ArmPathRecord, CommandError> {
        let labelled = PathLabels::from_panoramas(&path_panoramas(self.platform, path)?);
        let mut texts = Vec::new();
        for style in &self.base.styles {
            let before = within.unchanged.get(&path.id).and_then(|line| line.text_in_style(&style.style.name));
            let Some((text, before)) = before.and_then(|told| Some((told.text.as_ref()?, told))) else { continue };
            let telling = PathText { text, mentions: &before.mentions, path };
            let Some((platform, edit)) = self.edit_world(change, &labelled, telling) else { continue };
            // Each text has its own changed world, so nothing may come from a cache of another one.
            let own = ArmContext {
                arm: within.arm,
                scenes: KnownScenes::new(),
                walks: within.walks,
                demands: PlatformDemands::new(within.walks),
                elsewhere: None,
                unchanged: within.unchanged,
            };
            for told in self.write_texts(&own, self.team, platform.as_ref(), path, slice::from_ref(style))? {
                texts.push(ArmText { edit: Some(edit.clone()), ..told });
            }
        }
        let base_frame_of = (0..path.frames.len()).collect();
        Ok(ArmPathRecord { arm: within.arm.id(), path: path.clone(), base_frame_of, texts, left_out: None })
    }

    /// The world with one thing removed, recoloured or added; `None` if no thing is suitable.
    fn edit_world<'w>(
        &'w self,
        change: &Change,
        labelled: &PathLabels,
        telling: PathText<'_>,
    ) -> Option<(Box<dyn Platform + 'w>, ThingEdit)> {
        let edit =
            |thing: MentionedThing, colours| ThingEdit { name: thing.words, seen_from: thing.seen_from, colours };
        Some(match change {
            Change::Whole(WholeChange::Remove) => {
                let (thing, removed) = labelled.remove_thing(telling, self.seed)?;
                (Box::new(AlteredPlatform::new(self.platform, removed)), edit(thing, None))
            }
            Change::Whole(WholeChange::Material) => {
                let (thing, recoloured) = labelled.recolour_thing(telling, self.seed)?;
                let colours = thing.colour.clone().map(|before| [before, recoloured.colour.clone()]);
                (Box::new(AlteredPlatform::new(self.platform, recoloured)), edit(thing, colours))
            }
            _ => {
                let (thing, added) = labelled.with_one_more(telling.path, self.seed)?;
                (Box::new(AlteredPlatform::new(self.platform, added)), edit(thing, None))
            }
        })
    }
}

/// The platform that gives the space for an agent that walks by the texts of an arm.
pub(super) fn walked_platform<'a>(arm: &RobustnessArm, platform: &'a dyn Platform) -> Box<dyn Platform + 'a> {
    match arm {
        RobustnessArm::Changed(Change::Whole(WholeChange::Mirror)) => {
            Box::new(AlteredPlatform::new(platform, WorldMirror))
        }
        RobustnessArm::Changed(Change::Whole(WholeChange::Turn)) => {
            Box::new(AlteredPlatform::new(platform, QuarterTurn))
        }
        _ => Box::new(platform),
    }
}
