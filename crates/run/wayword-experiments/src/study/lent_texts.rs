//! Chooses the paths of a study, the one for practice, and the paths that lend their texts to others for the control `other-path`, such
//! that nobody reads a text twice if that can be avoided, and never one that practice showed.

use super::candidates::CandidatePath;
use crate::demands::{PlatformDemands, SAME_GOAL_M};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};
use wayword_core::{SceneId, ViewpointId};
use wayword_metrics::SceneDistances;
use wayword_navigation::swap::{SwapCandidate, other_path};
use wayword_run::error::CommandError;
use wayword_study::{ConditionKind, StudyCondition, StudyTask, StudyText};

/// Which paths lie in which scene, and where they end.
pub(super) struct ScenePaths {
    ends: Vec<SwapCandidate>,
    in_scene: BTreeMap<SceneId, Vec<usize>>,
    distances: BTreeMap<SceneId, Arc<SceneDistances>>,
}

impl ScenePaths {
    /// Reads where the paths end.
    ///
    /// # Errors
    /// When a scene cannot be read.
    pub(super) fn of(paths: &[CandidatePath], demands: &PlatformDemands<'_>) -> Result<Self, CommandError> {
        let (mut distances, mut in_scene, mut ends) = (BTreeMap::new(), BTreeMap::<_, Vec<usize>>::new(), Vec::new());
        for (at, item) in paths.iter().enumerate() {
            let scene = item.path.scene.clone();
            let frames = &item.path.frames;
            let goal = item.viewpoints.last().or_else(|| frames.last().and_then(|frame| frame.viewpoint.as_ref()));
            if goal.is_some() && !distances.contains_key(&scene) {
                distances.insert(scene.clone(), demands.scene_distances(&scene)?);
            }
            // A path without viewpoints ends at a place of its own.
            let goal = goal.cloned().or_else(|| ViewpointId::new(format!("end-of-{}", item.id)).ok());
            let Some(goal) = goal else {
                return Err(CommandError::usage(format!("item {}: it has no usable id", item.id), "give it another"));
            };
            in_scene.entry(scene.clone()).or_default().push(at);
            ends.push(SwapCandidate { id: item.id.clone(), scene, goal, cluster: item.name.clone() });
        }
        Ok(Self { ends, in_scene, distances })
    }

    /// The paths in the scene of a path.
    fn beside(&self, at: usize) -> &[usize] {
        self.in_scene.get(&self.ends[at].scene).map_or(&[], Vec::as_slice)
    }

    /// One of some paths that is in the same scene as a path, and has another goal.
    fn draw_other(&self, at: usize, among: impl Iterator<Item = usize>, seed: u64) -> Option<usize> {
        // The path itself comes first, and the others after it.
        let numbers: Vec<usize> = std::iter::once(at).chain(among.filter(|other| *other != at)).collect();
        let ends: Vec<SwapCandidate> = numbers.iter().map(|number| self.ends[*number].clone()).collect();
        let is_far = |a: &SwapCandidate, b: &SwapCandidate| {
            let apart_m = self.distances.get(&a.scene).and_then(|distances| distances.metres_between(&a.goal, &b.goal));
            apart_m.is_none_or(|apart_m| apart_m >= SAME_GOAL_M)
        };
        other_path(&ends, 0, seed, &is_far).map(|found| numbers[found])
    }
}

/// What paths and texts are chosen from.
pub(super) struct TextChoice<'a> {
    pub(super) conditions: &'a [StudyCondition],
    /// The texts of each path by condition, without those of other paths.
    pub(super) texts: &'a [BTreeMap<&'a str, String>],
    pub(super) scenes: ScenePaths,
    pub(super) seed: u64,
}

/// A path by its number, with its texts in the order of the conditions.
type PathTexts = (usize, Vec<StudyText>);

/// The paths of a study.
#[derive(Debug, Default)]
pub(super) struct ChosenPaths {
    /// Each with a text of every condition.
    pub(super) study: Vec<PathTexts>,
    /// The path for practice. Its text of another path may be missing, if practice does not show it.
    pub(super) practice: Option<PathTexts>,
}

impl TextChoice<'_> {
    /// Whether a path has a text of each condition for which it needs no other path.
    pub(super) fn has_own_texts(&self, at: usize) -> bool {
        let mut own = self.conditions.iter().filter(|condition| condition.kind != ConditionKind::OtherPath);
        own.all(|condition| self.texts[at].contains_key(condition.name.as_str()))
    }

    /// The condition whose texts are those of other paths.
    fn lent_condition(&self) -> Option<&StudyCondition> {
        self.conditions.iter().find(|condition| condition.kind == ConditionKind::OtherPath)
    }

    /// The text that a path lends to others.
    fn lent_text(&self, at: usize) -> Option<&String> {
        self.texts[at].get(self.lent_condition()?.source.as_str())
    }

    /// Takes at most `asked` paths in their order, and one for practice, which comes last.
    pub(super) fn choose(&self, order: &[usize], asked: usize, mode: StudyTask) -> ChosenPaths {
        // Each path is tried for practice, the last one first: another path may need the only text that this one could lend.
        let mut best = ChosenPaths::default();
        for practice in order.iter().rev().take(MAX_TRIED_PRACTICES) {
            let chosen = self.choose_beside(*practice, order, asked, mode);
            if chosen.study.len() > best.study.len() {
                best = chosen;
            }
            if best.study.len() >= asked {
                break;
            }
        }
        if best.study.is_empty() {
            best.study = self.lend(order, asked, &BTreeSet::new(), &BTreeSet::new());
        }
        best
    }

    /// The paths of a study for which a given one is the practice, and that one.
    fn choose_beside(&self, practice: usize, order: &[usize], asked: usize, mode: StudyTask) -> ChosenPaths {
        let mut barred = BTreeSet::from([practice]);
        let mut shown: BTreeSet<String> = self.texts[practice].values().map(|text| plain_words(text)).collect();
        let rest: Vec<usize> = order.iter().copied().filter(|at| *at != practice).collect();
        // Practice shows one text, or a pair: the second may be lent. Its path is then no part of the study.
        let shown_count = if mode == StudyTask::Pair { 2 } else { 1 };
        let shows_lent = self.conditions.iter().take(shown_count).any(|one| one.kind == ConditionKind::OtherPath);
        let lender =
            if shows_lent { self.find_lender(practice, &rest, &barred, &BTreeSet::new(), &shown) } else { None };
        if let Some(lender) = lender {
            barred.insert(lender);
            shown.extend(self.texts[lender].values().map(|text| plain_words(text)));
        } else if shows_lent {
            return ChosenPaths::default();
        }
        let is_open = |at: &usize| {
            !barred.contains(at) && self.texts[*at].values().all(|text| !shown.contains(&plain_words(text)))
        };
        let open: Vec<usize> = rest.into_iter().filter(is_open).collect();
        let study = self.lend(&open, asked, &barred, &shown);
        ChosenPaths { study, practice: Some((practice, self.condition_texts(practice, lender))) }
    }

    /// The first paths that find a text of another path, where one is asked for, with all their texts.
    fn lend(
        &self,
        order: &[usize],
        asked: usize,
        barred: &BTreeSet<usize>,
        shown: &BTreeSet<String>,
    ) -> Vec<PathTexts> {
        let mut chosen = Vec::new();
        let mut used = BTreeSet::new();
        for at in order {
            if chosen.len() == asked {
                break;
            }
            let lender = match self.lent_condition() {
                Some(_) => match self.find_lender(*at, &order[..asked.min(order.len())], barred, &used, shown) {
                    Some(lender) => Some(lender),
                    None => continue,
                },
                None => None,
            };
            used.extend(lender);
            chosen.push((*at, self.condition_texts(*at, lender)));
        }
        chosen
    }

    /// A path that lends its text to another: rather one that is not in the study and has lent none so far, because nobody gets a text twice.
    fn find_lender(
        &self,
        at: usize,
        in_study: &[usize],
        barred: &BTreeSet<usize>,
        used: &BTreeSet<usize>,
        shown: &BTreeSet<String>,
    ) -> Option<usize> {
        let in_study: BTreeSet<usize> = in_study.iter().copied().collect();
        let own = self.lent_text(at).map(|text| plain_words(text));
        let may_lend = |other: &usize| {
            let words = self.lent_text(*other).map(|text| plain_words(text));
            !barred.contains(other)
                && words.is_some_and(|words| !shown.contains(&words) && Some(&words) != own.as_ref())
        };
        let lenders: Vec<usize> = self.scenes.beside(at).iter().copied().filter(may_lend).collect();
        let draw = |is_in_study: bool, is_used: bool| {
            let among = lenders.iter().copied();
            let among = among.filter(|one| in_study.contains(one) == is_in_study && used.contains(one) == is_used);
            self.scenes.draw_other(at, among, self.seed)
        };
        [(false, false), (true, false), (false, true), (true, true)].into_iter().find_map(|(of, by)| draw(of, by))
    }

    /// A path's texts in the order of the conditions. Without a lender, that of another path is left out.
    fn condition_texts(&self, at: usize, lender: Option<usize>) -> Vec<StudyText> {
        let text = |condition: &StudyCondition| {
            let text = match condition.kind {
                ConditionKind::OtherPath => self.lent_text(lender?),
                _ => self.texts[at].get(condition.name.as_str()),
            };
            Some(StudyText { condition: condition.name.clone(), text: text?.clone(), marks: Vec::new() })
        };
        self.conditions.iter().filter_map(text).collect()
    }
}

/// Most paths that are tried for practice.
const MAX_TRIED_PRACTICES: usize = 100;

/// A text without the differences that nobody reads.
fn plain_words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The choice over paths of scenes that are named by letters, each with a text of its own and a corrupted one.
    fn choose(scenes: &str, asked: usize, mode: StudyTask, with: impl Fn(usize) -> String) -> ChosenPaths {
        let condition = |name: &str, kind| StudyCondition {
            name: name.to_owned(),
            kind,
            source: "ours".to_owned(),
            shows_doubts: false,
        };
        let conditions = [condition("ours", ConditionKind::Run), condition("other-path", ConditionKind::OtherPath)];
        let count = scenes.len();
        let texts: Vec<BTreeMap<&str, String>> = (0..count).map(|at| BTreeMap::from([("ours", with(at))])).collect();
        let (mut in_scene, mut ends) = (BTreeMap::<_, Vec<usize>>::new(), Vec::new());
        for (at, scene) in scenes.chars().enumerate() {
            let scene = SceneId::new(scene.to_string()).unwrap();
            let goal = ViewpointId::new(format!("goal{at}")).unwrap();
            in_scene.entry(scene.clone()).or_default().push(at);
            ends.push(SwapCandidate { id: at.to_string(), scene, goal, cluster: at.to_string() });
        }
        let scenes = ScenePaths { ends, in_scene, distances: BTreeMap::new() };
        let choice = TextChoice { conditions: &conditions, texts: &texts, scenes, seed: 1 };
        choice.choose(&(0..count).collect::<Vec<_>>(), asked, mode)
    }

    fn own_text(at: usize) -> String {
        format!("Go to door {at}.")
    }

    #[test]
    fn the_texts_of_practice_come_never_again() {
        for (scenes, asked) in [("aaa", 2), ("aaab", 3), ("aaaaaa", 3), ("aabbcc", 6), ("aaabbb", 4), ("abab", 3)] {
            for mode in [StudyTask::Follow, StudyTask::Rate, StudyTask::Pair] {
                let chosen = choose(scenes, asked, mode, own_text);
                let study = &chosen.study;
                assert!(!study.is_empty() && study.len() <= asked, "{scenes} {mode:?}: {chosen:?}");
                assert!(study.iter().all(|(_, texts)| texts.len() == 2), "each has a text of every condition");
                let Some((practice, shown)) = &chosen.practice else {
                    // A pair of practice takes two paths out of the scene, which has only three.
                    assert!(mode == StudyTask::Pair && scenes.starts_with("aaa") && asked <= 3, "{scenes}: {chosen:?}");
                    continue;
                };
                let shown_count = if mode == StudyTask::Pair { 2 } else { 1 };
                for text in study.iter().flat_map(|(_, texts)| texts) {
                    assert_ne!(text.text, own_text(*practice), "{scenes} {mode:?}: {chosen:?}");
                    assert!(shown[..shown_count].iter().all(|shown| !shown.reads_like(text)), "{scenes}: {chosen:?}");
                }
            }
        }
    }

    #[test]
    fn the_path_for_practice_is_one_whose_text_no_other_path_needs() {
        // Of the two paths in b, one would lose the only text that it can borrow.
        let chosen = choose("aaabb", 4, StudyTask::Follow, own_text);
        assert_eq!(chosen.study.len(), 4, "{chosen:?}");
        assert!(chosen.practice.as_ref().unwrap().0 < 3, "practice is in a: {chosen:?}");
    }

    #[test]
    fn texts_are_lent_by_paths_outside_the_study_each_once_while_there_are_any() {
        let chosen = choose("aaaaaaaaa", 4, StudyTask::Follow, own_text);
        let in_study: Vec<usize> = chosen.study.iter().chain(&chosen.practice).map(|(at, _)| *at).collect();
        let lent: BTreeSet<&str> = chosen.study.iter().map(|(_, texts)| texts[1].text.as_str()).collect();
        assert_eq!(lent.len(), 4, "{chosen:?}");
        assert!(in_study.iter().all(|at| !lent.contains(own_text(*at).as_str())), "{chosen:?}");
    }

    #[test]
    fn a_text_that_reads_like_that_of_practice_is_no_text_of_the_study() {
        let with = |at: usize| if at >= 3 { "Walk  on. ".to_owned() } else { own_text(at) };
        let chosen = choose("aaaaa", 4, StudyTask::Follow, with);
        let (_, shown) = chosen.practice.as_ref().unwrap();
        let mut texts = chosen.study.iter().flat_map(|(_, texts)| texts);
        assert!(texts.all(|text| !text.reads_like(&shown[0])), "{chosen:?}");
    }
}
