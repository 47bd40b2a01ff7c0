//! The agent by a language model: it looks around and steps from node to node by calling tools.
//!
//! At each call the model is told its instruction, a map of where it was, its last steps with their reasons, its own
//! note, the ways out of where it stands and, once it has looked around, what is there. It is told nothing of nodes
//! where it did not stand. Replies that are no use are counted, told to the model, and bounded: the walk is scored as it
//! stands.

mod limits;
mod memory;
mod prompt;
mod rehearsal;
mod reply;
mod scene;

pub use limits::Limits;
pub use prompt::wording;
pub use rehearsal::rehearse;
pub use scene::{Describes, Looks};

use super::{Start, Walked, choice};
use crate::{
    directions::one_line,
    error::WalkError,
    sight::AgentView,
    walk::{Choice, Effort, End, Step, Told},
};
use memory::Memory;
use prompt::{Sees, State, Way, request};
use reply::{Act, Called, Pointed, read};
use scene::{Scene, clockwise, look};
use std::collections::BTreeMap;
use wayword_core::{Heading, LanguageModel, ModelError, ObjectId, Reply, Request, ViewpointId};
use wayword_follower::online::Hop;

/// Replies of no use in a row that end a walk.
const MOST_USELESS: usize = 3;
/// How often a walk may take one hop in one direction.
const MOST_TIMES_A_HOP: usize = 3;

/// Who walks, and with what.
#[derive(Clone, Copy)]
pub struct Tools<'a> {
    /// The model that decides.
    pub model: &'a dyn LanguageModel,
    /// How it sees.
    pub looks: Looks<'a>,
    /// What a walk may take.
    pub limits: Limits,
    /// Seed of the model's sampling, for models that accept one.
    pub seed: u64,
}

/// Walks by an instruction as a language model decides. Where `names_object`, the model is asked for the object that the
/// instruction means.
///
/// # Errors
/// When the platform gives no view, there is nothing of what the model is to see, or its service is lost or answers no
/// more.
pub fn walk_by_tools(
    agent_view: &AgentView<'_>,
    start: &Start,
    text: &str,
    names_object: bool,
    tools: Tools<'_>,
) -> Result<Walked, WalkError> {
    let mut walker = Walker::new(agent_view, start, text, names_object, tools);
    let end = loop {
        if let Some(end) = walker.spent() {
            break end;
        }
        let Some(calls) = walker.ask()? else { continue };
        if let Some(end) = walker.act(calls)? {
            break end;
        }
    };
    Ok(walker.done(end))
}

/// A text that somebody else wrote, in one line and cut.
fn quoted(text: &str, most_chars: usize) -> String {
    let line = one_line(text);
    match line.char_indices().nth(most_chars) {
        Some((at, _)) => format!("{} ...", &line[..at]),
        None => line,
    }
}

/// A walk in progress.
struct Walker<'a> {
    agent_view: &'a AgentView<'a>,
    text: &'a str,
    names_object: bool,
    tools: Tools<'a>,
    memory: Memory,
    here: ViewpointId,
    /// The number of the place where it stands.
    number: usize,
    heading: Heading,
    /// What was seen where it stands, if it looked.
    scene: Option<Scene>,
    steps: Vec<Step>,
    hopped: BTreeMap<(ViewpointId, ViewpointId), usize>,
    effort: Effort,
    /// What was wrong with the last reply, and with how many in a row something was.
    trouble: Option<String>,
    useless: usize,
    /// Why it stops, and at which object.
    stop: (Option<String>, Option<ObjectId>),
}

impl<'a> Walker<'a> {
    fn new(agent_view: &'a AgentView<'a>, start: &Start, text: &'a str, names_object: bool, tools: Tools<'a>) -> Self {
        let memory = Memory::new(agent_view.position(&start.viewpoint), start.heading, tools.limits.memory);
        let mut walker = Self {
            agent_view,
            text,
            names_object,
            tools,
            memory,
            here: start.viewpoint.clone(),
            number: 0,
            heading: start.heading,
            scene: None,
            steps: Vec::new(),
            hopped: BTreeMap::new(),
            effort: Effort { usd: Some(0.0), ..Effort::default() },
            trouble: None,
            useless: 0,
            stop: (None, None),
        };
        walker.arrive(start.viewpoint.clone(), start.heading);
        walker
    }

    /// The ways out of where it stands, clockwise from ahead, and the nodes that they lead to.
    fn ways(&self) -> Vec<(ViewpointId, Hop)> {
        let (ways, hops) = self.agent_view.ways(&self.here, self.heading);
        let mut ways: Vec<_> = ways.into_iter().zip(hops).collect();
        ways.sort_by(|(_, a), (_, b)| clockwise(a.turn_rad).total_cmp(&clockwise(b.turn_rad)));
        ways
    }

    /// Comes to a place, looking along a heading.
    fn arrive(&mut self, at: ViewpointId, heading: Heading) {
        let (ways, _) = self.agent_view.ways(&at, heading);
        let ways = ways.into_iter().map(|to| (to.clone(), self.agent_view.position(&to))).collect();
        self.number = self.memory.reach(&at, self.agent_view.position(&at), ways);
        (self.here, self.heading, self.scene) = (at, heading, None);
    }

    /// Why it may not go on, where it may not.
    fn spent(&self) -> Option<End> {
        let limits = &self.tools.limits;
        let is_spent = limits.max_usd.zip(self.effort.usd).is_some_and(|(most, usd)| usd >= most);
        match () {
            () if self.useless >= MOST_USELESS => Some(End::Useless),
            () if self.effort.calls >= limits.max_calls => Some(End::Calls),
            () if is_spent => Some(End::Money),
            () => None,
        }
    }

    /// What the model is asked where it stands.
    fn request(&self) -> Result<Request, WalkError> {
        let ways: Vec<Way> = self.ways().iter().map(|(to, hop)| Way::new(hop, self.memory.number(to))).collect();
        request(&State {
            text: self.text,
            sees: match self.tools.looks {
                Looks::Labels => Sees::Labels,
                Looks::Pictures => Sees::Pictures,
                Looks::Captions(_) => Sees::Captions,
            },
            names_object: self.names_object,
            memory: &self.memory,
            here: (self.number, self.heading),
            ways: &ways,
            scene: self.scene.as_ref(),
            limits: &self.tools.limits,
            calls: self.effort.calls,
            hops: self.steps.len(),
            trouble: self.trouble.as_deref(),
            seed: self.tools.seed,
        })
    }

    /// Asks the model. `None` where its reply is of no use.
    fn ask(&mut self) -> Result<Option<Vec<Called>>, WalkError> {
        let asked = self.request()?;
        self.effort.calls += 1;
        let reply = match self.tools.model.complete(&[asked]).pop() {
            Some(Ok(reply)) => reply,
            // The service answered this prompt with nothing that can be used. Another prompt may do better.
            Some(Err(ModelError::Failed { .. })) | None => {
                self.effort.useless.failed += 1;
                self.refuse("it was empty or refused".to_owned());
                return Ok(None);
            }
            Some(Err(error)) => return Err(error.into()),
        };
        self.count(&reply);
        let calls = read(&reply.text);
        if calls.is_empty() {
            self.effort.useless.no_call += 1;
            self.refuse("it called no tool".to_owned());
            return Ok(None);
        }
        Ok(Some(calls))
    }

    fn count(&mut self, reply: &Reply) {
        let Some(usage) = reply.usage else {
            self.effort.usd = None;
            return;
        };
        let effort = &mut self.effort;
        effort.tokens_in += usage.tokens_in;
        effort.most_tokens_in = effort.most_tokens_in.max(usage.tokens_in);
        effort.tokens_out += usage.tokens_out;
        effort.usd = effort.usd.zip(usage.usd).map(|(all, usd)| all + usd);
        effort.seconds += usage.seconds;
    }

    fn refuse(&mut self, trouble: String) {
        self.trouble = Some(trouble);
        self.useless += 1;
    }

    /// Does what a reply calls, one step at most: the ways of the next place are not known before. Returns why the walk
    /// ends, where it does.
    fn act(&mut self, calls: Vec<Called>) -> Result<Option<End>, WalkError> {
        let mut has_done = false;
        let mut has_stepped = false;
        for Called { act, why, note } in calls {
            self.memory.note = note.or(self.memory.note.take());
            match act {
                Act::Observe if self.scene.is_none() => {
                    self.observe()?;
                    has_done = true;
                }
                Act::Observe => {}
                Act::Step(_) if has_stepped => {}
                Act::Step(way) => match self.step(way, why) {
                    Ok(None) => (has_done, has_stepped) = (true, true),
                    Ok(end) => return Ok(end),
                    Err(trouble) => {
                        self.effort.useless.no_way += 1;
                        self.refuse(trouble);
                        return Ok(None);
                    }
                },
                Act::Stop(object) => {
                    let object = object.filter(|_| self.names_object);
                    let object = object.map(|object| self.pointed(&object)).transpose()?.flatten();
                    self.stop = (Some(why), object);
                    return Ok(Some(End::Stopped));
                }
            }
        }
        if has_done {
            (self.trouble, self.useless) = (None, 0);
        } else {
            self.effort.useless.idle += 1;
            self.refuse("you have already looked around here: step or stop".to_owned());
        }
        Ok(None)
    }

    fn observe(&mut self) -> Result<(), WalkError> {
        let at = (&self.here, self.heading);
        let scene = look(self.agent_view, at, self.tools.looks, self.names_object)?;
        self.effort.looks += 1;
        self.memory.saw(self.number, &scene);
        self.scene = Some(scene);
        Ok(())
    }

    /// Takes a way. Returns why the walk ends instead, where it does; an error says why there is no such way.
    fn step(&mut self, way: Option<usize>, why: String) -> Result<Option<End>, String> {
        let ways = self.ways();
        let Some(number) = way else { return Err("a step needs the number of a way".to_owned()) };
        let to = number.checked_sub(1).and_then(|at| ways.get(at));
        let Some((to, _)) = to else {
            return Err(format!("there is no way {number} here: there are {}", ways.len()));
        };
        if self.steps.len() >= self.tools.limits.max_hops {
            return Ok(Some(End::Cap));
        }
        let times = self.hopped.entry((self.here.clone(), to.clone())).or_default();
        if *times >= MOST_TIMES_A_HOP {
            return Ok(Some(End::Circles));
        }
        *times += 1;
        let from = self.number;
        let chosen = choice(self.agent_view, &self.steps, &self.here, to);
        let heading = self.agent_view.heading_to(&self.here, to).unwrap_or(self.heading);
        self.stand(chosen, Some(why.clone()));
        self.arrive(to.clone(), heading);
        self.memory.hopped(from, self.number, why);
        Ok(None)
    }

    /// Adds the step at the place where it stands.
    fn stand(&mut self, choice: Choice, reason: Option<String>) {
        let scene = self.scene.as_ref();
        let told = Told {
            room: scene.and_then(|scene| scene.room.clone()),
            ways: self.ways().len(),
            things: scene.map_or(0, |scene| scene.things),
        };
        self.steps.push(Step {
            viewpoint: self.here.clone(),
            heading_rad: self.heading,
            views: Vec::new(),
            phrase: 0,
            told: Some(told),
            choice,
            reason: reason.filter(|reason| !reason.is_empty()),
        });
    }

    /// The object that the model names: one of those that it was shown, or what its words fit best.
    fn pointed(&self, object: &Pointed) -> Result<Option<ObjectId>, WalkError> {
        match object {
            Pointed::Number(number) => {
                let shown = self.scene.as_ref().map_or(&[][..], |scene| &scene.objects);
                Ok(number.checked_sub(1).and_then(|at| shown.get(at)).cloned())
            }
            Pointed::Words(words) => self.agent_view.point(&self.here, words),
        }
    }

    fn done(mut self, end: End) -> Walked {
        let (reason, object) = std::mem::take(&mut self.stop);
        self.stand(Choice::Stop, reason);
        Walked { steps: self.steps, end, object, effort: Some(self.effort) }
    }
}

#[cfg(test)]
mod tests;
