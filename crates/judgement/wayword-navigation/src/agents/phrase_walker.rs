//! The agents CLIP-Nav, Seq-CLIP-Nav and GLIP-Nav. They are the same walk with different parameters and grounders: go where the
//! current key phrase fits best, and stop where the activity fits. `policy.rs` decides; this file walks and records.

use super::{
    AgentStart, AgentWalk, PhraseWalkParameters,
    policy::{PhraseDecision, PhrasePolicy},
};
use crate::{
    directions::SplitInstruction,
    error::WalkError,
    sight::{AgentView, NodeSight},
    walk::{AgentStep, StepChoice, StepViewScores, WalkEnd},
};
use wayword_core::{Heading, ViewpointId};

/// Walks by a split instruction.
///
/// # Errors
/// When the platform gives no view, or the grounder fails.
pub fn walk_by_phrases(
    agent_view: &AgentView<'_>,
    start: &AgentStart,
    directions: &SplitInstruction,
    parameters: &PhraseWalkParameters,
) -> Result<AgentWalk, WalkError> {
    // The texts to score: the key phrases, then the activity.
    let mut texts = directions.phrases.clone();
    texts.push(directions.activity.clone());
    let mut policy = PhrasePolicy::new(parameters, directions.phrases.len());
    let mut steps: Vec<AgentStep> = Vec::new();
    let (mut here, mut heading) = (start.viewpoint.clone(), start.heading);
    let end = loop {
        let sight = agent_view.look_from(&here, &texts)?;
        let phrase = policy.current_phrase();
        let is_last = steps.len() >= parameters.max_hops;
        let decision = policy.decide(&here, heading, &sight);
        let views = score_views(&sight, phrase, directions.phrases.len());
        let viewpoint = here.clone();
        let step = |choice| AgentStep { views, phrase, ..AgentStep::new(viewpoint, heading, choice) };
        match decision {
            PhraseDecision::Stop | PhraseDecision::DeadEnd => {
                steps.push(step(StepChoice::Stop));
                break if decision == PhraseDecision::Stop { WalkEnd::Stopped } else { WalkEnd::DeadEnd };
            }
            _ if is_last => {
                steps.push(step(StepChoice::Stop));
                break WalkEnd::Cap;
            }
            PhraseDecision::Onward { view, to } => {
                steps.push(step(StepChoice::Onward(view)));
                heading = agent_view.heading_to(&here, &to).unwrap_or(heading);
                here = to;
            }
            PhraseDecision::Back(over) => {
                steps.push(step(StepChoice::Back));
                (here, heading) = go_back(agent_view, &mut steps, (here, heading), &over, parameters.max_hops);
            }
        }
    };
    let object = agent_view.point_at_object(&here, &directions.activity)?;
    Ok(AgentWalk { steps, end, object, effort: None })
}

/// Goes back over the nodes `over`; all but the last of them are passed without a look. Returns the last, and the heading there.
fn go_back(
    agent_view: &AgentView<'_>,
    steps: &mut Vec<AgentStep>,
    from: (ViewpointId, Heading),
    over: &[ViewpointId],
    max_hops: usize,
) -> (ViewpointId, Heading) {
    let (mut here, mut heading) = from;
    for (at, to) in over.iter().enumerate() {
        heading = agent_view.heading_to(&here, to).unwrap_or(heading);
        here = to.clone();
        if at + 1 == over.len() || steps.len() >= max_hops {
            break;
        }
        steps.push(AgentStep::new(here.clone(), heading, StepChoice::Back));
    }
    (here, heading)
}

/// The scores of the four views for a phrase and for the activity, both given by their index among the scored texts.
fn score_views(sight: &NodeSight, phrase: usize, activity: usize) -> Vec<StepViewScores> {
    let scored = |view: &crate::sight::SightView| StepViewScores {
        phrase: view.scores[phrase],
        activity: view.scores[activity],
        ways: view.onward.len(),
    };
    sight.views.iter().map(scored).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        agents::BacktrackParameters,
        grounders::{GrounderScope, LexicalGrounder},
        testing::{Cross, scene},
    };

    fn directions(phrases: &[&str], activity: &str) -> SplitInstruction {
        SplitInstruction {
            phrases: phrases.iter().map(|phrase| (*phrase).to_owned()).collect(),
            activity: activity.to_owned(),
        }
    }

    fn walked(
        things: &[(&'static str, &'static str)],
        directions: &SplitInstruction,
        parameters: &PhraseWalkParameters,
    ) -> AgentWalk {
        let (world, grounder) = (Cross::new(things), LexicalGrounder::new(GrounderScope::Views));
        let agent_view = AgentView::new(&world, &grounder, false, &scene()).unwrap();
        walk_by_phrases(&agent_view, &Cross::start(), directions, parameters).unwrap()
    }

    fn parameters(back: Option<BacktrackParameters>) -> PhraseWalkParameters {
        PhraseWalkParameters { back, ..PhraseWalkParameters::default_of("clip-nav", "labels/lexical") }
    }

    fn stood(walked: &AgentWalk) -> Vec<&str> {
        walked.steps.iter().map(|step| step.viewpoint.as_str()).collect()
    }

    #[test]
    fn phrase_walk_stops_at_its_task_and_points_at_the_thing() {
        let walked = walked(&[("n2", "sink")], &directions(&[], "wipe the sink"), &parameters(None));
        assert_eq!(stood(&walked), ["middle", "n1", "n2"]);
        assert_eq!(walked.end, WalkEnd::Stopped);
        assert_eq!(walked.object.unwrap().as_str(), "sink");
    }

    /// The first phrase names a thing on the way. The task counts only after that phrase is done.
    #[test]
    fn key_phrases_come_one_after_the_other() {
        let listens = PhraseWalkParameters { stop_with_phrases_left: 0, ..parameters(None) };
        let route = directions(&["past the bed"], "wipe the sink");
        let walked = walked(&[("n2", "sink"), ("s2", "bed"), ("w2", "sink")], &route, &listens);
        let of_bed = walked.steps.iter().position(|step| step.viewpoint.as_str() == "s2").unwrap();
        assert!(walked.steps[..=of_bed].iter().all(|step| step.phrase == 0), "{:?}", stood(&walked));
        assert!(walked.steps[of_bed + 1..].iter().all(|step| step.phrase == 1));
        assert_eq!(walked.end, WalkEnd::Stopped, "{:?}", stood(&walked));
    }

    #[test]
    fn hops_back_follow_edges_and_count_as_hops() {
        let back = Some(BacktrackParameters { window: 2, threshold: 0.9, nodes: 2 });
        let limited = PhraseWalkParameters { max_hops: 7, ..parameters(back) };
        let walked = walked(&[], &directions(&["the bed"], "wipe the sink"), &limited);
        assert_eq!(stood(&walked)[..5], ["middle", "n1", "n2", "n1", "middle"]);
        assert!(
            matches!(walked.steps[2].choice, StepChoice::Back) && matches!(walked.steps[3].choice, StepChoice::Back)
        );
        assert!(walked.steps[3].views.is_empty(), "what is passed on the way back is not looked at");
        assert_eq!((walked.steps.len(), walked.end), (8, WalkEnd::Cap));
    }
}
