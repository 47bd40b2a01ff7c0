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
    /// The same models and rules, but with another sample of each model, for the arm [`RobustnessArm::Again`].
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
    /// The platform in which the agent walks, and the distances in its scenes.
    pub(super) walk_platform: &'a dyn Platform,
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
    pub(super) fn make_record(&self, context: &ArmContext<'_>, path: &Path) -> Result<ArmPathRecord, CommandError> {
        let arm = context.arm;
        let all_frames = |path: &Path| (0..path.frames.len()).collect();
        match arm {
            RobustnessArm::Unchanged => {
                self.make_record_in_world(context, self.team, self.platform, (path.clone(), all_frames(path)), None)
            }
            RobustnessArm::Again => {
                self.make_record_in_world(context, self.again, self.platform, (path.clone(), all_frames(path)), None)
            }
            RobustnessArm::Other => {
                match other_path::find_other_path(self.platform, path, context.unchanged, self.seed)? {
                    Some(OtherPathChoice::Told(line)) => {
                        Ok(ArmPathRecord { arm: arm.id(), path: path.clone(), ..*line })
                    }
                    Some(OtherPathChoice::New(other)) => {
                        let frames = all_frames(&other);
                        self.make_record_in_world(context, self.team, self.platform, (other, frames), None)
                    }
                    None => Ok(ArmPathRecord::left_out(arm, path, "no other path of its building has as many hops")),
                }
            }
            RobustnessArm::Changed(change) if arm.is_edit() => self.make_edited_record(context, change, path),
            RobustnessArm::Forward | RobustnessArm::Changed(_) => {
                let sees_labels = self.eye.is_none() && self.base.settings.roles.model_names().is_empty();
                let world = match &context.elsewhere {
                    Some(elsewhere) => elsewhere.world_for_path(path, sees_labels),
                    None => world::world_for_arm(arm, self.platform, path, self.seed),
                };
                // Even by texts of another platform the agent walks in the run's own world.
                let walked = context.elsewhere.as_ref().map(|_| path);
                match world {
                    Ok(ChangedWorld { platform, path, base_frame_of }) => {
                        self.make_record_in_world(context, self.team, platform.as_ref(), (path, base_frame_of), walked)
                    }
                    Err(reason) => Ok(ArmPathRecord::left_out(arm, path, &reason)),
                }
            }
        }
    }

    fn make_record_in_world(
        &self,
        context: &ArmContext<'_>,
        team: &RoleTeam,
        platform: &dyn Platform,
        (path, base_frame_of): (Path, Vec<usize>),
        walked: Option<&Path>,
    ) -> Result<ArmPathRecord, CommandError> {
        let mut texts = self.write_texts(context, team, platform, &path, &self.base.styles)?;
        let walked = walked.unwrap_or(&path);
        if context.arm.is_walked() {
            for arm_text in &mut texts {
                let Some(text) = &arm_text.text else { continue };
                arm_text.arrived = reader::reader_arrives(context.walk_platform, &context.demands, walked, text)?;
            }
        }
        let path = Path { scene: walked.scene.clone(), ..path };
        Ok(ArmPathRecord { arm: context.arm.id(), path, base_frame_of, texts, left_out: None })
    }

    /// Writes the texts of a path in some styles.
    fn write_texts(
        &self,
        context: &ArmContext<'_>,
        team: &RoleTeam,
        platform: &dyn Platform,
        path: &Path,
        styles: &[MeasuredStyle],
    ) -> Result<Vec<ArmText>, CommandError> {
        let seen_by_eye = self.eye.map(|eye| self.through_eye(context, platform, &path.scene, eye));
        let platform = seen_by_eye.as_ref().map_or(platform, |seen_by_eye| seen_by_eye as &dyn Platform);
        let is_repeated = context.arm == &RobustnessArm::Again;
        let seed = self.base.settings.seed;
        let seed = if is_repeated { derive_seed(seed, &["robustness", "again"]) } else { seed };
        let settings = RunSettings { seed, ..self.base.settings.clone() };
        let world = RunPlatform { platform, data: None, scenes: &context.scenes };
        let item = RunItem::Walk(Box::new(path.clone()));
        let only = context.chosen_candidates(path);
        let written = write_item(&item, &settings, world, team, ItemTextOrder { styles, only: &only }, self.threads)?;
        let to_arm_text =
            |(outcome, style): (WritingOutcome, &MeasuredStyle)| ArmText::from_outcome(&style.style.name, outcome);
        Ok(written.outcomes.into_iter().zip(styles).map(to_arm_text).collect())
    }

    /// A platform through a scripted eye. On another platform, the eye answers from the labels of the run's world at the same pose.
    fn through_eye<'w>(
        &'w self,
        context: &ArmContext<'_>,
        platform: &'w dyn Platform,
        scene: &SceneId,
        eye: EyeQuality,
    ) -> ScriptedEye<&'w dyn Platform, &'w dyn Platform> {
        let base_scene = context.elsewhere.as_ref().and_then(|elsewhere| elsewhere.base_scene(scene));
        let scripted_eye = match base_scene {
            Some(base) => {
                ScriptedEye::new(platform, self.platform, eye, self.seed).with_scene(scene.clone(), base.clone())
            }
            None => ScriptedEye::new(platform, platform, eye, self.seed),
        };
        scripted_eye.at_strength(context.arm.change_strength())
    }

    /// Writes the texts of a path after one thing of its world has changed. For each style it is a thing from the text of that style.
    fn make_edited_record(
        &self,
        context: &ArmContext<'_>,
        change: &Change,
        path: &Path,
    ) -> Result<ArmPathRecord, CommandError> {
        let path_labels = PathLabels::from_panoramas(&path_panoramas(self.platform, path)?);
        let mut texts = Vec::new();
        for style in &self.base.styles {
            let before = context.unchanged.get(&path.id).and_then(|line| line.text_in_style(&style.style.name));
            let Some((text, before)) = before.and_then(|arm_text| Some((arm_text.text.as_ref()?, arm_text))) else {
                continue;
            };
            let path_text = PathText { text, mentions: &before.mentions, path };
            let Some((platform, edit)) = self.edit_world(change, &path_labels, path_text) else { continue };
            // Each text has its own changed world, so nothing may come from a cache of another one.
            let own_context = ArmContext {
                arm: context.arm,
                scenes: KnownScenes::new(),
                walk_platform: context.walk_platform,
                demands: PlatformDemands::new(context.walk_platform),
                elsewhere: None,
                unchanged: context.unchanged,
            };
            for arm_text in
                self.write_texts(&own_context, self.team, platform.as_ref(), path, slice::from_ref(style))?
            {
                texts.push(ArmText { edit: Some(edit.clone()), ..arm_text });
            }
        }
        let base_frame_of = (0..path.frames.len()).collect();
        Ok(ArmPathRecord { arm: context.arm.id(), path: path.clone(), base_frame_of, texts, left_out: None })
    }

    /// The world with one thing removed, recoloured or added; `None` if no thing is suitable.
    fn edit_world<'w>(
        &'w self,
        change: &Change,
        path_labels: &PathLabels,
        path_text: PathText<'_>,
    ) -> Option<(Box<dyn Platform + 'w>, ThingEdit)> {
        let edit =
            |thing: MentionedThing, colours| ThingEdit { name: thing.words, seen_from: thing.seen_from, colours };
        Some(match change {
            Change::Whole(WholeChange::Remove) => {
                let (thing, removed) = path_labels.remove_thing(path_text, self.seed)?;
                (Box::new(AlteredPlatform::new(self.platform, removed)), edit(thing, None))
            }
            Change::Whole(WholeChange::Material) => {
                let (thing, recoloured) = path_labels.recolour_thing(path_text, self.seed)?;
                let colours = thing.colour.clone().map(|before| [before, recoloured.colour.clone()]);
                (Box::new(AlteredPlatform::new(self.platform, recoloured)), edit(thing, colours))
            }
            _ => {
                let (thing, added) = path_labels.add_thing(path_text.path, self.seed)?;
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
