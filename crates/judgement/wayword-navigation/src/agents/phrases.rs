//! CLIP-Nav, Seq-CLIP-Nav and GLIP-Nav: one walk, with different parameters and grounders.

use super::{
    Parameters, Start, Walked,
    mind::{Decision, Mind},
};
use crate::{
    WalkError,
    directions::Directions,
    eyes::{Eyes, Sight},
    walk::{Choice, End, Scored, Step},
};
use wayword_core::{Heading, ViewpointId};

/// Walks by an instruction that was taken apart.
///
/// # Errors
/// When the world cannot be looked at, or the grounder fails.
pub fn walk_by_phrases(
    eyes: &Eyes<'_>,
    start: &Start,
    directions: &Directions,
    parameters: &Parameters,
) -> Result<Walked, WalkError> {
    let mut told = directions.phrases.clone();
    told.push(directions.activity.clone());
    let mut mind = Mind::new(parameters, directions.phrases.len());
    let mut steps: Vec<Step> = Vec::new();
    let (mut here, mut heading) = (start.viewpoint.clone(), start.heading);
    let end = loop {
        let sight = eyes.look(&here, &told)?;
        let in_hand = mind.phrase();
        let is_last = steps.len() >= parameters.max_hops;
        let decision = mind.decide(&here, heading, &sight);
        let scored = scored(&sight, in_hand, directions.phrases.len());
        let step =
            |choice| Step { viewpoint: here.clone(), heading_rad: heading, views: scored, phrase: in_hand, choice };
        match decision {
            Decision::Stop | Decision::DeadEnd => {
                steps.push(step(Choice::Stop));
                break if decision == Decision::Stop { End::Stopped } else { End::DeadEnd };
            }
            _ if is_last => {
                steps.push(step(Choice::Stop));
                break End::Cap;
            }
            Decision::Onward { view, to } => {
                steps.push(step(Choice::Onward(view)));
                heading = eyes.heading_to(&here, &to).unwrap_or(heading);
                here = to;
            }
            Decision::Back(over) => {
                steps.push(step(Choice::Back));
                (here, heading) = go_back(eyes, &mut steps, (here, heading), &over, parameters.max_hops);
            }
        }
    };
    let object = eyes.point(&here, &directions.activity)?;
    Ok(Walked { steps, end, object })
}

/// Goes back over nodes; all but the last of them are passed without a look. Returns the last, and the heading there.
fn go_back(
    eyes: &Eyes<'_>,
    steps: &mut Vec<Step>,
    from: (ViewpointId, Heading),
    over: &[ViewpointId],
    max_hops: usize,
) -> (ViewpointId, Heading) {
    let (mut here, mut heading) = from;
    for (at, to) in over.iter().enumerate() {
        heading = eyes.heading_to(&here, to).unwrap_or(heading);
        here = to.clone();
        if at + 1 == over.len() || steps.len() >= max_hops {
            break;
        }
        let (viewpoint, choice) = (here.clone(), Choice::Back);
        steps.push(Step { viewpoint, heading_rad: heading, views: Vec::new(), phrase: 0, choice });
    }
    (here, heading)
}

fn scored(sight: &Sight, in_hand: usize, activity: usize) -> Vec<Scored> {
    let scored = |view: &crate::eyes::Seen| Scored {
        phrase: view.scores[in_hand],
        activity: view.scores[activity],
        ways: view.onward.len(),
    };
    sight.views.iter().map(scored).collect()
}
