//! A walk in progress: calls the model, carries out the tool calls of its reply, and counts calls, tokens and useless replies.

use super::{
    AgentStart, AgentWalk, ModelWalker, ToolAgentSight, choice_for_hop,
    memory::ToolWalkMemory,
    observed_scene::{ObservedScene, clockwise_turn, observe_scene},
    prompt::{PromptSightKind, PromptState, PromptWay, build_request},
    tool_calls::{AgentToolAction, AgentToolCall, ObjectChoice, read_calls},
};
use crate::{
    error::WalkError,
    one_line::shorten_line,
    sight::AgentView,
    walk::{AgentStep, StepChoice, SurroundingsSummary, WalkEffort, WalkEnd},
};
use std::collections::BTreeMap;
use wayword_core::{Heading, ModelError, ModelReply, ModelRequest, ObjectId, ViewpointId};
use wayword_follower::online::WalkerHop;
use wayword_language::lexicon::{names_agree, normalise_name};

/// A walk ends after this number of useless replies in a row.
const MAX_USELESS_REPLIES: usize = 3;
/// Most times that a walk takes one hop in one direction; the next time ends it as [`WalkEnd::Circles`].
const MAX_HOP_REPEATS: usize = 3;
/// Most characters of a useless reply that are recorded; a longer one is cut.
const MAX_RECORDED_REPLY_CHARS: usize = 200;

/// A walk of the agent with a language model, in progress.
pub(super) struct ToolWalker<'a> {
    agent_view: &'a AgentView<'a>,
    /// The instruction.
    text: &'a str,
    /// Whether the model is to name an object when it stops.
    names_object: bool,
    by: ModelWalker<'a>,
    memory: ToolWalkMemory,
    here: ViewpointId,
    /// The number of the current place on the map.
    number: usize,
    heading: Heading,
    /// The scene at the current place, if the agent has looked around.
    scene: Option<ObservedScene>,
    steps: Vec<AgentStep>,
    /// How often the walk has taken each hop, by the nodes at its ends.
    hopped: BTreeMap<(ViewpointId, ViewpointId), usize>,
    pub(super) effort: WalkEffort,
    /// The problem of the last reply, if it was useless.
    trouble: Option<String>,
    /// How many replies in a row were useless, up to the last.
    useless: usize,
    /// The last error of the service.
    failure: Option<ModelError>,
    /// The reason and the object from the model's call of `stop`.
    stop: (Option<String>, Option<ObjectId>),
}

impl<'a> ToolWalker<'a> {
    pub(super) fn new(
        agent_view: &'a AgentView<'a>,
        start: &AgentStart,
        text: &'a str,
        names_object: bool,
        by: ModelWalker<'a>,
    ) -> Self {
        let memory = ToolWalkMemory::new(agent_view.node_position(&start.viewpoint), start.heading, by.limits.memory);
        let mut walker = Self {
            agent_view,
            text,
            names_object,
            by,
            memory,
            here: start.viewpoint.clone(),
            number: 0,
            heading: start.heading,
            scene: None,
            steps: Vec::new(),
            hopped: BTreeMap::new(),
            effort: WalkEffort { usd: Some(0.0), ..WalkEffort::default() },
            trouble: None,
            useless: 0,
            failure: None,
            stop: (None, None),
        };
        walker.arrive_at(start.viewpoint.clone(), start.heading);
        walker
    }

    /// The ways out of the current place, clockwise from ahead, with the nodes that they lead to.
    pub(super) fn ways_out(&self) -> Vec<(ViewpointId, WalkerHop)> {
        let (ways, hops) = self.agent_view.ways_from(&self.here, self.heading);
        let mut ways: Vec<_> = ways.into_iter().zip(hops).collect();
        ways.sort_by(|(_, a), (_, b)| clockwise_turn(a.turn_rad).total_cmp(&clockwise_turn(b.turn_rad)));
        ways
    }

    /// Moves to a place, looking along a heading, and adds it to the map.
    fn arrive_at(&mut self, at: ViewpointId, heading: Heading) {
        let (ways, _) = self.agent_view.ways_from(&at, heading);
        let ways = ways.into_iter().map(|to| (to.clone(), self.agent_view.node_position(&to))).collect();
        self.number = self.memory.reach_place(&at, self.agent_view.node_position(&at), ways);
        (self.here, self.heading, self.scene) = (at, heading, None);
    }

    /// The limit that ends the walk, if one is reached.
    pub(super) fn exhausted_limit(&self) -> Option<WalkEnd> {
        let limits = &self.by.limits;
        // If prices are not known, the limit may already be exceeded.
        let is_spent = limits.max_usd.is_some_and(|most| self.effort.usd.is_none_or(|usd| usd >= most));
        match () {
            () if self.useless >= MAX_USELESS_REPLIES => Some(WalkEnd::NoUse),
            () if self.effort.calls >= limits.max_calls => Some(WalkEnd::Calls),
            () if is_spent => Some(WalkEnd::Money),
            () => None,
        }
    }

    /// The request for the next call of the model.
    pub(super) fn next_request(&self) -> Result<ModelRequest, WalkError> {
        let way = |(to, hop): &(ViewpointId, WalkerHop)| {
            PromptWay::new(
                hop,
                self.memory.place_number(to),
                &self.memory.format_spot(self.agent_view.node_position(to)),
            )
        };
        let ways: Vec<PromptWay> = self.ways_out().iter().map(way).collect();
        build_request(&PromptState {
            text: self.text,
            sees: match self.by.looks {
                ToolAgentSight::Labels => PromptSightKind::Labels,
                ToolAgentSight::Pictures => PromptSightKind::Pictures,
                ToolAgentSight::Captions(_) => PromptSightKind::Captions,
            },
            names_object: self.names_object,
            memory: &self.memory,
            here: (self.number, self.heading),
            ways: &ways,
            scene: self.scene.as_ref(),
            limits: &self.by.limits,
            calls: self.effort.calls,
            hops: self.steps.len(),
            trouble: self.trouble.as_deref(),
            seed: self.by.seed,
        })
    }

    /// Calls the model and reads its tool calls. `None` if the reply is useless.
    pub(super) fn ask_model(&mut self) -> Result<Option<Vec<AgentToolCall>>, WalkError> {
        let request = self.next_request()?;
        self.effort.calls += 1;
        let reply = match self.by.model.complete_requests(&[request]).pop() {
            Some(Ok(reply)) => reply,
            // The service answered this prompt with an unusable reply. The next prompt may get a better one.
            Some(Err(error @ ModelError::Failed { .. })) => {
                self.effort.useless.failed += 1;
                self.note_useless_reply("it was empty or refused".to_owned(), &error.to_string());
                self.failure = Some(error);
                return Ok(None);
            }
            Some(Err(error)) => return Err(error.into()),
            None => return Err(self.no_reply_error().into()),
        };
        self.count_usage(&reply);
        let calls = read_calls(&reply.text);
        if calls.is_empty() {
            self.effort.useless.no_call += 1;
            self.note_useless_reply("it called no tool".to_owned(), &reply.text);
            return Ok(None);
        }
        Ok(Some(calls))
    }

    /// The error for a model that gives no result at all for a request.
    fn no_reply_error(&self) -> ModelError {
        ModelError::Failed { model: self.by.model.name().to_owned(), reason: "it gave no reply".to_owned() }
    }

    /// Adds the tokens, the cost and the time of a reply. The cost of the walk is not known if that of one reply is not.
    fn count_usage(&mut self, reply: &ModelReply) {
        let Some(usage) = reply.usage else {
            self.effort.usd = None;
            return;
        };
        let usd = usage.usd.or_else(|| self.by.price.map(|price| price(usage.tokens_in, usage.tokens_out)));
        let effort = &mut self.effort;
        effort.tokens_in += usage.tokens_in;
        effort.most_tokens_in = effort.most_tokens_in.max(usage.tokens_in);
        effort.tokens_out += usage.tokens_out;
        effort.usd = effort.usd.zip(usd).map(|(all, usd)| all + usd);
        effort.seconds += usage.seconds;
    }

    /// Records a useless reply and its problem. `reply` is its text, or the error if the service gave none.
    fn note_useless_reply(&mut self, trouble: String, reply: &str) {
        self.effort.last_useless = Some(format!("{trouble}: {}", shorten_line(reply, MAX_RECORDED_REPLY_CHARS)));
        self.trouble = Some(trouble);
        self.useless += 1;
    }

    /// Carries out the calls of a reply, but at most one step, because the model does not know the ways of the next place yet.
    /// Returns the reason if the walk ends.
    pub(super) fn carry_out(&mut self, calls: Vec<AgentToolCall>) -> Result<Option<WalkEnd>, WalkError> {
        // Numbers of objects refer to the list in the prompt, even if an earlier call of this reply looks around anew.
        let shown = self.scene.as_ref().map(|scene| scene.objects.clone()).unwrap_or_default();
        let (mut is_useful, mut has_stepped) = (false, false);
        for AgentToolCall { act, why, note } in calls {
            self.memory.note = note.or(self.memory.note.take());
            match act {
                AgentToolAction::Observe if self.scene.is_none() => {
                    self.observe_here()?;
                    is_useful = true;
                }
                AgentToolAction::Observe => {}
                AgentToolAction::Step(_) if has_stepped => {}
                AgentToolAction::Step(way) => match self.take_step(way, &why) {
                    Ok(None) => (is_useful, has_stepped) = (true, true),
                    Ok(end) => return Ok(end),
                    Err(trouble) => {
                        self.effort.useless.no_way += 1;
                        self.note_useless_reply(trouble, &format!("step {way:?}"));
                        return Ok(None);
                    }
                },
                AgentToolAction::Stop(object) => {
                    let object = object.filter(|_| self.names_object);
                    let object = object.map(|object| self.find_object(&object, &shown)).transpose()?.flatten();
                    self.stop = (Some(why), object);
                    return Ok(Some(WalkEnd::Stopped));
                }
            }
        }
        if is_useful {
            (self.trouble, self.useless) = (None, 0);
        } else {
            self.effort.useless.idle += 1;
            self.note_useless_reply("you have already looked around here: step or stop".to_owned(), "observe");
        }
        Ok(None)
    }

    /// Looks around at the current place, and keeps the scene for the prompts.
    fn observe_here(&mut self) -> Result<(), WalkError> {
        let at = (&self.here, self.heading);
        let scene = observe_scene(self.agent_view, at, self.by.looks, self.names_object)?;
        self.effort.looks += 1;
        self.effort.undescribed += scene.undescribed;
        self.memory.remember_scene(self.number, &scene);
        self.scene = Some(scene);
        Ok(())
    }

    /// Takes a way out. Returns the reason if the walk ends instead. An error names the problem with the way's number.
    fn take_step(&mut self, way: Option<usize>, why: &str) -> Result<Option<WalkEnd>, String> {
        let ways = self.ways_out();
        let Some(number) = way else { return Err("a step needs the number of a way".to_owned()) };
        let to = number.checked_sub(1).and_then(|at| ways.get(at));
        let Some((to, _)) = to else {
            return Err(format!("there is no way {number} here: there are {}", ways.len()));
        };
        if self.steps.len() >= self.by.limits.max_hops {
            return Ok(Some(WalkEnd::Cap));
        }
        let times = self.hopped.entry((self.here.clone(), to.clone())).or_default();
        if *times >= MAX_HOP_REPEATS {
            return Ok(Some(WalkEnd::Circles));
        }
        *times += 1;
        let from = self.number;
        let chosen = choice_for_hop(self.agent_view, &self.steps, &self.here, to);
        let heading = self.agent_view.heading_to(&self.here, to).unwrap_or(self.heading);
        self.record_step(chosen, Some(why.to_owned()));
        self.arrive_at(to.clone(), heading);
        self.memory.remember_hop(from, self.number, why);
        Ok(None)
    }

    /// Records the decision at the current place as a step of the walk.
    fn record_step(&mut self, choice: StepChoice, reason: Option<String>) {
        let scene = self.scene.as_ref();
        let surroundings = SurroundingsSummary {
            room: scene.and_then(|scene| scene.room.clone()),
            ways: self.ways_out().len(),
            things: scene.map_or(0, |scene| scene.things),
        };
        let reason = reason.filter(|reason| !reason.is_empty());
        let step = AgentStep::new(self.here.clone(), self.heading, choice);
        self.steps.push(AgentStep { told: Some(surroundings), reason, ..step });
    }

    /// The object that the model names: one of those in the prompt, or the one around the place that its words fit best.
    fn find_object(&self, object: &ObjectChoice, shown: &[(ObjectId, String)]) -> Result<Option<ObjectId>, WalkError> {
        match object {
            ObjectChoice::Number(number) => {
                Ok(number.checked_sub(1).and_then(|at| shown.get(at)).map(|(id, _)| id.clone()))
            }
            ObjectChoice::Words(words) => {
                let named = shown.iter().find(|(_, name)| normalise_name(name) == normalise_name(words));
                match named.or_else(|| shown.iter().find(|(_, name)| names_agree(name, words))) {
                    Some((id, _)) => Ok(Some(id.clone())),
                    None => self.agent_view.point_at_object(&self.here, words),
                }
            }
        }
    }

    /// Ends the walk and returns it; an error if no call got an answer.
    pub(super) fn finish_walk(mut self, end: WalkEnd) -> Result<AgentWalk, WalkError> {
        if let Some(failure) = self.failure.take().filter(|_| self.effort.calls == self.effort.useless.failed) {
            return Err(failure.into());
        }
        let (reason, object) = std::mem::take(&mut self.stop);
        self.record_step(StepChoice::Stop, reason);
        Ok(AgentWalk { steps: self.steps, end, object, effort: Some(self.effort) })
    }
}
