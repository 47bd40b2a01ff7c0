//! Follows a line over the ground by single actions.
//!
//! The search is greedy. Before each step forward it tries all turns, and takes the one after which the step ends nearest to a point
//! a little ahead on the line. Where the agent got stuck behind a corner, it compares ways over the ground instead of straight lines.

use super::{
    actions::{AgentGait, AgentStance},
    line::GroundLine,
};
use crate::ground::{GeodesicError, NavMeshGround};
use wayword_core::{AgentAction, DVec3, Heading};

/// How far ahead on the line the agent aims, in steps.
const AIM_STEPS: f64 = 2.0;
/// A turn costs as much as this distance to the aim, in steps: the agent turns only for a step that ends so much nearer. This keeps
/// it from turning to and fro on a straight line.
const TURN_STEPS: f64 = 0.04;
/// Least progress of a step forward along the line, in steps.
const PROGRESS_STEPS: f64 = 0.1;
/// Greatest progress of a step forward along the line, in steps: around a corner, more than one.
const REACH_STEPS: f64 = 3.0;
/// Places of the ground with a smaller difference in height are on one level, metres.
const LEVEL_M: f64 = 0.1;
/// Greatest distance of a walk's place from the ground nearest to it, seen from above, metres.
const MAX_BESIDE_GROUND_M: f64 = 0.5;
/// Most actions of one walk; more are an error.
const MAX_ACTIONS: usize = 20_000;

/// A walk by single actions.
#[derive(Debug, Clone, PartialEq)]
pub struct ActionWalk {
    /// The actions; the last is [`AgentAction::Stop`].
    pub actions: Vec<AgentAction>,
    /// The position of the agent before each action.
    pub stances: Vec<AgentStance>,
    /// For each place of the walk, the number of the action before which the agent has reached it.
    pub reached: Vec<usize>,
    /// How far the agent stops from the last place, metres.
    pub off_m: f64,
}

/// Why a walk cannot be followed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WalkFollowError {
    /// There is no ground at a place, or no way to it.
    #[error("place {place} of the walk: {reason}")]
    NoWay {
        /// Its number, from 0.
        place: usize,
        /// Why it cannot be reached.
        reason: GeodesicError,
    },
    /// The nearest ground is not under the place but at some distance from it, so the walk would lead elsewhere.
    #[error("place {place} of the walk: the nearest ground is {off_m:.2} m beside it")]
    Beside {
        /// Its number, from 0.
        place: usize,
        /// Distance of that ground, metres.
        off_m: f64,
    },
    /// No action leads any farther along the walk.
    #[error("blocked after {actions} actions at ({:.2}, {:.2}, {:.2}), {left_m:.2} m before the end: no step forward stays within {tolerance_m} m of the walk", .at.x, .at.y, .at.z)]
    Blocked {
        /// Position of the agent, world frame, metres.
        at: DVec3,
        /// Number of actions that the agent took.
        actions: usize,
        /// Remaining length of the walk, metres.
        left_m: f64,
        /// Greatest distance from the walk that is allowed, metres.
        tolerance_m: f64,
    },
    /// The walk takes too many actions.
    #[error("the walk takes more than {MAX_ACTIONS} actions")]
    TooLong,
}

/// Follows a walk greedily, along the shortest ways from each of its places to the next. The agent begins at the first place and
/// looks along `heading`. Before each step forward it makes the turns after which the step ends nearest to a point two steps ahead.
/// It takes no step that the ground blocks or that ends more than `tolerance_m` off the walk. It stops when less than half a step is
/// left, or where no step leads farther and the end is within `tolerance_m`.
///
/// # Errors
/// [`WalkFollowError`] names the place of the walk, or where the agent was blocked.
pub fn follow_places(
    ground: &NavMeshGround,
    places: &[DVec3],
    heading: Heading,
    gait: AgentGait,
    tolerance_m: f64,
) -> Result<ActionWalk, WalkFollowError> {
    let (line, marks) = join_places(ground, places)?;
    let first = places.first().copied().unwrap_or_default();
    let off_ground = || WalkFollowError::NoWay { place: 0, reason: GeodesicError::OffGround(first) };
    let start = AgentStance::new(ground.nearest_foothold(first).ok_or_else(off_ground)?, heading);
    let follower = LineFollower { ground, line: &line, gait, tolerance_m };
    let walked = follower.walk_line(start, &marks)?;
    let last = places.last().copied().unwrap_or_default();
    let end = walked.stances.last().map_or(last, |stance| stance.foothold.place);
    Ok(ActionWalk { off_m: (end - last).truncate().length(), ..walked })
}

/// The position of an agent before each of these actions and after the last. A step that the ground blocks gives `None`, and ends
/// the sequence.
pub fn replay_actions<'a>(
    ground: &'a NavMeshGround,
    start: AgentStance,
    actions: &'a [AgentAction],
    gait: AgentGait,
) -> impl Iterator<Item = Option<AgentStance>> + 'a {
    let mut now = Some(start);
    std::iter::once(Some(start)).chain(actions.iter().map_while(move |action| {
        let (next, is_blocked) = now?.after_action(*action, ground, gait);
        now = (!is_blocked).then_some(next);
        Some(now)
    }))
}

/// The line along the shortest ways from place to place, and how far along it each place is.
fn join_places(ground: &NavMeshGround, places: &[DVec3]) -> Result<(GroundLine, Vec<f64>), WalkFollowError> {
    let mut line = GroundLine::default();
    let mut marks = Vec::with_capacity(places.len());
    let on_ground = |place: usize| {
        let at = places.get(place).copied().unwrap_or_default();
        let on = ground
            .nearest_foothold(at)
            .ok_or(WalkFollowError::NoWay { place, reason: GeodesicError::OffGround(at) })?
            .place;
        let off_m = (on - at).truncate().length();
        if off_m > MAX_BESIDE_GROUND_M { Err(WalkFollowError::Beside { place, off_m }) } else { Ok(on) }
    };
    marks.push(line.push(on_ground(0)?));
    for (number, pair) in places.windows(2).enumerate() {
        let way = ground.geodesic(pair[0], pair[1]);
        let way = way.map_err(|reason| WalkFollowError::NoWay { place: number + 1, reason })?;
        for corner in way.corners {
            line.push(corner);
        }
        marks.push(line.push(on_ground(number + 1)?));
    }
    Ok((line, marks))
}

/// An agent on its way along a line. It stays within `tolerance_m` metres of the line.
struct LineFollower<'a> {
    ground: &'a NavMeshGround,
    line: &'a GroundLine,
    gait: AgentGait,
    tolerance_m: f64,
}

impl LineFollower<'_> {
    /// Walks from the line's beginning to its end. `marks` are the distances along the line of the places to reach, metres.
    fn walk_line(&self, mut now: AgentStance, marks: &[f64]) -> Result<ActionWalk, WalkFollowError> {
        let forward_m = self.gait.forward_m();
        let (mut actions, mut stances, mut reached) = (Vec::new(), Vec::new(), Vec::new());
        let mut along = 0.0;
        while self.line.length_m() - along > forward_m / 2.0 {
            while marks.get(reached.len()).is_some_and(|mark| *mark <= along + forward_m / 2.0) {
                reached.push(actions.len());
            }
            if actions.len() > MAX_ACTIONS {
                return Err(WalkFollowError::TooLong);
            }
            let Some((turns, next)) = self.best_step(now, along) else {
                let (at, tolerance_m) = (now.foothold.place, self.tolerance_m);
                let left_m = self.line.length_m() - along;
                let end = self.line.place_at(self.line.length_m());
                if left_m.max((end - at).truncate().length()) <= tolerance_m {
                    break;
                }
                return Err(WalkFollowError::Blocked { at, actions: actions.len(), left_m, tolerance_m });
            };
            let turn = if turns < 0 { AgentAction::Left } else { AgentAction::Right };
            for action in std::iter::repeat_n(turn, turns.unsigned_abs() as usize).chain([AgentAction::Forward]) {
                stances.push(now);
                actions.push(action);
                (now, _) = now.after_action(action, self.ground, self.gait);
            }
            along = next;
        }
        reached.resize(marks.len(), actions.len());
        stances.push(now);
        actions.push(AgentAction::Stop);
        Ok(ActionWalk { actions, stances, reached, off_m: 0.0 })
    }

    /// The number of turns before the next step forward (negative to the left), and how far along the line that step ends. Of equally
    /// good steps, the one with fewer turns wins, and then the one to the left.
    fn best_step(&self, now: AgentStance, along: f64) -> Option<(i32, f64)> {
        let aim = self.line.place_at(along + AIM_STEPS * self.gait.forward_m());
        let steps = self.possible_steps(now, along).filter(|step| step.along - along >= self.least_m());
        let straight = |step: CandidateStep| ((step.end - aim).truncate().length() + self.price_m(step.turns), step);
        let found = cheapest_step(steps.map(straight)).or_else(|| self.round_a_corner(now, along, aim))?;
        Some((found.turns, found.along))
    }

    /// The step that shortens the way to the aim most. It is needed where no step gets farther along the line, because the agent cut a
    /// corner and now faces the wall behind it.
    fn round_a_corner(&self, now: AgentStance, along: f64, aim: DVec3) -> Option<CandidateStep> {
        let left_m = |place: DVec3| self.ground.geodesic(place, aim).ok().map(|way| way.length_m);
        let before_m = left_m(now.foothold.place)?;
        let from_m = (along - REACH_STEPS * self.gait.forward_m()).max(0.0);
        let steps = self.possible_steps(now, from_m).filter_map(|step| {
            let left_m = left_m(step.end)?;
            let step = CandidateStep { along: step.along.max(along), ..step };
            (before_m - left_m >= self.least_m()).then_some((left_m + self.price_m(step.turns), step))
        });
        cheapest_step(steps)
    }

    /// The steps forward that the ground allows and that end within the tolerance, for every number of turns before them.
    fn possible_steps(&self, now: AgentStance, from_m: f64) -> impl Iterator<Item = CandidateStep> {
        let to_m = from_m + REACH_STEPS * self.gait.forward_m();
        let turns = (0..=self.gait.turns_around()).flat_map(|turns| [-turns, turns]);
        turns.filter_map(move |turns| {
            let stride = now.turned_by(turns).stride_ahead(self.ground, self.gait);
            let (along, off_m) = self.line.nearest_point(stride.end.place, from_m, to_m)?;
            if stride.is_blocked || off_m > self.tolerance_m {
                return None;
            }
            // Otherwise the step could end next to a part of the walk that is beyond a wall or on another level.
            let on_line = self.ground.nearest_foothold(self.line.place_at(along))?.place;
            let across = self.ground.stride_to(&stride.end, on_line);
            let is_beside = !across.is_blocked && (across.end.place.z - on_line.z).abs() <= LEVEL_M;
            is_beside.then_some(CandidateStep { turns, end: stride.end.place, along })
        })
    }

    /// Least progress of a step, metres.
    fn least_m(&self) -> f64 {
        PROGRESS_STEPS * self.gait.forward_m()
    }

    /// The cost of some turns, as a distance to the aim, metres.
    fn price_m(&self, turns: i32) -> f64 {
        f64::from(turns.abs()) * TURN_STEPS * self.gait.forward_m()
    }
}

/// A step forward after some turns.
#[derive(Clone, Copy)]
struct CandidateStep {
    turns: i32,
    end: DVec3,
    /// How far along the line it ends, metres.
    along: f64,
}

/// The step with the least cost; of equal ones, the first.
fn cheapest_step(steps: impl Iterator<Item = (f64, CandidateStep)>) -> Option<CandidateStep> {
    steps.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, step)| step)
}

#[cfg(test)]
mod tests;
