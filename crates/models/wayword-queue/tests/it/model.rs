//! A model of many workers on one board and one ledger. The model checker stateright tries every course of events.
//!
//! Workers claim chunks by the rules of `ChunkRow`, make a call that costs money, and complete. Each may be suspended until its lease
//! is over and go on later, or be killed and come back; a completion may arrive late and twice. Whatever happens, each chunk is
//! recorded once, by the claim that held, and a call is paid again only if it was in flight when its worker was killed or
//! suspended.

#![allow(clippy::print_stderr, reason = "the test tells how many states there are")]

use stateright::{Checker, HasDiscoveries, Model, Property};
use wayword_queue::{ChunkRow, ChunkState};

const WORKERS: usize = 2;
const CHUNKS: usize = 2;
/// Kills and suspensions of one course of events.
const BLOWS: u8 = 2;

/// The step that a worker is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
enum Doing {
    /// It has no chunk.
    Nothing,
    /// It has a chunk, and has not asked its question.
    Begun { chunk: usize, epoch: i64 },
    /// Its request is on its way.
    InFlight { chunk: usize, epoch: i64 },
    /// It has the answer.
    Answered { chunk: usize, epoch: i64 },
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
struct World {
    board: [ChunkRow<usize>; CHUNKS],
    workers: [Doing; WORKERS],
    /// Workers with a heartbeat that is too old.
    is_gone: [bool; WORKERS],
    /// Workers that are suspended at the moment.
    is_suspended: [bool; WORKERS],
    /// Completions on their way to the board. A set: one that is there twice arrives twice by staying.
    sent: Vec<(usize, i64)>,
    /// The epochs of the results that were recorded, by chunk.
    recorded: [Vec<i64>; CHUNKS],
    /// The ledger: the worker that makes the call of a chunk, and whether the call is answered.
    asking: [Option<usize>; CHUNKS],
    is_answered: [bool; CHUNKS],
    /// Requests that were paid, and those that were in flight when their worker was killed or suspended.
    paid: [u8; CHUNKS],
    struck: [u8; CHUNKS],
    blows: u8,
}

#[derive(Debug, Clone, PartialEq, Eq, Hash)]
enum Event {
    Claim(usize),
    Ask(usize),
    Hear(usize),
    Send(usize),
    Arrive(usize, i64, bool),
    Kill(usize),
    Suspend(usize),
    Resume(usize),
    HandBack(usize),
}

/// The rules, or the rules with a mistake that the properties must find.
#[derive(Clone, Copy, PartialEq)]
enum Rules {
    Right,
    /// The board records a result without looking at its epoch.
    NoEpoch,
    /// Workers do not ask the ledger before they send a request.
    NoLedger,
}

impl Model for Rules {
    type State = World;
    type Action = Event;

    fn init_states(&self) -> Vec<World> {
        vec![World {
            board: Default::default(),
            workers: [Doing::Nothing; WORKERS],
            is_gone: [false; WORKERS],
            is_suspended: [false; WORKERS],
            sent: Vec::new(),
            recorded: Default::default(),
            asking: [None; CHUNKS],
            is_answered: [false; CHUNKS],
            paid: [0; CHUNKS],
            struck: [0; CHUNKS],
            blows: 0,
        }]
    }

    fn actions(&self, world: &World, events: &mut Vec<Event>) {
        for worker in 0..WORKERS {
            if world.is_suspended[worker] {
                events.push(Event::Resume(worker));
                continue;
            }
            events.extend(match world.workers[worker] {
                Doing::Nothing => vec![Event::Claim(worker)],
                Doing::Begun { .. } => vec![Event::Ask(worker), Event::HandBack(worker)],
                Doing::InFlight { .. } => vec![Event::Hear(worker)],
                Doing::Answered { .. } => vec![Event::Send(worker)],
            });
            if world.blows < BLOWS {
                events.extend([Event::Kill(worker), Event::Suspend(worker)]);
            }
        }
        for (chunk, epoch) in &world.sent {
            events.extend([Event::Arrive(*chunk, *epoch, false), Event::Arrive(*chunk, *epoch, true)]);
        }
    }

    fn next_state(&self, before: &World, event: Event) -> Option<World> {
        let mut world = before.clone();
        match event {
            Event::Claim(worker) => {
                world.is_gone[worker] = false;
                let gone = world.is_gone;
                let is_free = |other: &usize| gone[*other] || *other == worker;
                let (chunk, epoch) = world
                    .board
                    .iter_mut()
                    .enumerate()
                    .find_map(|(chunk, row)| Some((chunk, row.claim_chunk(&worker, is_free)?)))?;
                world.workers[worker] = Doing::Begun { chunk, epoch };
            }
            Event::Ask(worker) => {
                let Doing::Begun { chunk, epoch } = world.workers[worker] else { return None };
                if *self != Rules::NoLedger {
                    if world.is_answered[chunk] {
                        world.workers[worker] = Doing::Answered { chunk, epoch };
                        return Some(world);
                    }
                    // A call that another living worker has in flight is waited for.
                    if world.asking[chunk].is_some_and(|other| other != worker && !world.is_gone[other]) {
                        return None;
                    }
                }
                world.asking[chunk] = Some(worker);
                world.paid[chunk] += 1;
                world.workers[worker] = Doing::InFlight { chunk, epoch };
            }
            Event::Hear(worker) => {
                let Doing::InFlight { chunk, epoch } = world.workers[worker] else { return None };
                world.is_answered[chunk] = true;
                if world.asking[chunk] == Some(worker) {
                    world.asking[chunk] = None;
                }
                world.workers[worker] = Doing::Answered { chunk, epoch };
            }
            Event::Send(worker) => {
                let Doing::Answered { chunk, epoch } = world.workers[worker] else { return None };
                world.sent.push((chunk, epoch));
                world.sent.sort_unstable();
                world.sent.dedup();
                world.workers[worker] = Doing::Nothing;
            }
            Event::Arrive(chunk, epoch, again) => {
                if !again {
                    world.sent.retain(|sent| *sent != (chunk, epoch));
                }
                let row = &mut world.board[chunk];
                let epoch_seen =
                    if *self == Rules::NoEpoch && row.state == ChunkState::Running { row.epoch } else { epoch };
                if row.complete_claim(epoch_seen) || (*self == Rules::NoEpoch && row.state == ChunkState::Done) {
                    // Once a fault shows, its consequences need not be followed.
                    if world.recorded[chunk].len() > 1 {
                        return None;
                    }
                    world.recorded[chunk].push(epoch);
                }
            }
            Event::Kill(worker) => {
                world.strike(worker);
                // It comes back under another name: here, under its own once it is taken for gone.
                world.is_gone[worker] = true;
                if let Some(chunk) = world.asking.iter().position(|by| *by == Some(worker)) {
                    world.asking[chunk] = None;
                }
                world.workers[worker] = Doing::Nothing;
            }
            Event::Suspend(worker) => {
                world.strike(worker);
                (world.is_suspended[worker], world.is_gone[worker]) = (true, true);
            }
            Event::Resume(worker) => (world.is_suspended[worker], world.is_gone[worker]) = (false, false),
            Event::HandBack(worker) => {
                let Doing::Begun { chunk, epoch } = world.workers[worker] else { return None };
                world.board[chunk].hand_back(epoch);
                world.workers[worker] = Doing::Nothing;
                // Handing back for ever leads nowhere.
                world.blows += 1;
                if world.blows > BLOWS {
                    return None;
                }
            }
        }
        (world != *before).then_some(world)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("each chunk is recorded once", |_, world: &World| {
                world.recorded.iter().all(|results| results.len() <= 1)
            }),
            Property::always("the result is of the claim that held", |_, world: &World| {
                let of =
                    |(row, results): (&ChunkRow<usize>, &Vec<i64>)| results.iter().all(|epoch| *epoch == row.epoch);
                world.board.iter().zip(&world.recorded).all(of)
            }),
            Property::always("a call is paid again only if its worker was struck in flight", |_, world: &World| {
                (0..CHUNKS).all(|chunk| world.paid[chunk] <= 1 + world.struck[chunk])
            }),
            Property::sometimes("everything is done", |_, world: &World| {
                world.board.iter().all(|row| row.state == ChunkState::Done)
            }),
            Property::sometimes("a late result is dropped", |_, world: &World| {
                world.board.iter().any(|row| row.state == ChunkState::Done && row.epoch > 1)
            }),
        ]
    }
}

impl World {
    fn strike(&mut self, worker: usize) {
        self.blows += 1;
        if let Doing::InFlight { chunk, .. } = self.workers[worker] {
            self.struck[chunk] += 1;
        }
    }
}

/// States that must be reachable: otherwise the model might be right only because it does so little.
const POSSIBLE: [&str; 2] = ["everything is done", "a late result is dropped"];

#[test]
fn each_chunk_is_recorded_once_and_no_call_is_paid_twice() {
    let checker = Rules::Right.checker().threads(2).spawn_bfs().join();
    eprintln!("{} states", checker.unique_state_count());
    let mut found: Vec<&str> = checker.discoveries().into_keys().collect();
    found.sort_unstable_by_key(|name| POSSIBLE.iter().position(|possible| possible == name));
    assert_eq!(found, POSSIBLE);
}

#[test]
fn without_epochs_or_without_the_ledger_the_model_finds_the_fault() {
    for rules in [Rules::NoEpoch, Rules::NoLedger] {
        let checker = rules.checker().finish_when(HasDiscoveries::AnyFailures).threads(2).spawn_bfs().join();
        assert!(checker.discoveries().keys().any(|name| !POSSIBLE.contains(name)), "no fault was found");
    }
}
