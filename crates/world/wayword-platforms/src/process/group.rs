//! Runs a child, and all processes that it starts, as one process group that is ended as a whole.
//!
//! The system may give a group's number to another group as soon as no process is in it. So the group is killed first
//! and its leader is reaped afterwards, because a leader that has ended but was not reaped keeps the number.

use super::guard::{GroupGuard, GuardProgram};
use std::{
    io,
    process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus},
    sync::{Arc, Mutex, MutexGuard, PoisonError, Weak},
    thread,
    time::{Duration, Instant},
};
use wayword_world::output_lines::OutputListener;

/// How often to check whether a child has ended, while waiting for its end.
const END_CHECK_INTERVAL: Duration = Duration::from_millis(5);
/// How long to wait for the end of a killed child. A child that hangs in a driver takes longer, and is not waited for.
const REAP_TIMEOUT: Duration = Duration::from_secs(1);

/// Every running group, for [`end_all`].
static LIVING_GROUPS: Mutex<LivingGroups> = Mutex::new(LivingGroups { is_closed: false, groups: Vec::new() });

/// The running groups.
struct LivingGroups {
    /// Whether no more groups may start.
    is_closed: bool,
    groups: Vec<Weak<Mutex<GroupMembers>>>,
}

/// Kills every child that a [`ProcessPlatform`](super::ProcessPlatform) of this program has started, with the processes
/// that the child started, and prevents new ones from starting: for a program that ends because of a signal. A request
/// that is under way fails at once.
///
/// It takes at most a second. It may be called more than once, from any thread, but not within a signal handler itself,
/// because it takes locks.
pub fn end_all() {
    let mut living = lock_ignoring_poison(&LIVING_GROUPS);
    living.is_closed = true;
    let groups: Vec<_> = living.groups.drain(..).filter_map(|group| group.upgrade()).collect();
    drop(living);
    for group in &groups {
        lock_ignoring_poison(group).kill_group();
    }
    let deadline = Instant::now() + REAP_TIMEOUT;
    for group in &groups {
        lock_ignoring_poison(group).reap_child(deadline);
    }
}

/// Whether all children were ended, and none may start.
pub(crate) fn is_ended() -> bool {
    lock_ignoring_poison(&LIVING_GROUPS).is_closed
}

/// Lets children start again after [`end_all`], in a program that did not end.
pub fn start_again() {
    lock_ignoring_poison(&LIVING_GROUPS).is_closed = false;
}

/// Our ends of a child's three pipes.
pub(crate) type ChildPipes = (Option<ChildStdin>, Option<ChildStdout>, Option<ChildStderr>);

/// A started child and its group. When it is dropped, the group is killed.
pub(crate) struct ProcessGroup(Arc<Mutex<GroupMembers>>);

/// The processes of a group that this program started itself.
struct GroupMembers {
    child: Child,
    /// The leader of the group, if there is a guard; otherwise the child is the leader.
    guard: Option<GroupGuard>,
    /// Whether the leader was reaped: another group may have the group's number now.
    is_over: bool,
}

impl ProcessGroup {
    /// Starts a command in a group of its own. A script that starts the simulator (such as `xvfb-run`) has to end
    /// together with the simulator, and Ctrl-C in the terminal must reach only Wayword.
    ///
    /// # Errors
    /// If the command cannot be started, or this program is ending.
    pub(crate) fn start(
        command: &mut Command,
        guard: Option<&GuardProgram>,
        hear: &OutputListener,
    ) -> io::Result<(Self, ChildPipes)> {
        let guard = guard.and_then(|program| match GroupGuard::start(program) {
            Ok(guard) => Some(guard),
            Err(error) => {
                hear(&format!(
                    "the guard cannot be started ({error}): if Wayword is killed, end the simulator yourself"
                ));
                None
            }
        });
        // The lock is held while the child starts, so that `end_all` finds the child or prevents its start.
        let mut living = lock_ignoring_poison(&LIVING_GROUPS);
        if living.is_closed {
            return Err(io::Error::other("this program is ending"));
        }
        #[cfg(unix)]
        {
            let leader = guard.as_ref().map_or(0, GroupGuard::process_id);
            std::os::unix::process::CommandExt::process_group(command, leader.cast_signed());
        }
        let mut child = command.spawn()?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let members = Arc::new(Mutex::new(GroupMembers { child, guard, is_over: false }));
        living.groups.retain(|group| group.strong_count() > 0);
        living.groups.push(Arc::downgrade(&members));
        Ok((Self(members), pipes))
    }

    /// Whether the child ends within a time. The processes that it started may still run.
    pub(crate) fn ends_within(&self, within: Duration) -> bool {
        let asked = Instant::now();
        loop {
            if lock_ignoring_poison(&self.0).has_ended() {
                return true;
            }
            if asked.elapsed() >= within {
                return false;
            }
            thread::sleep(END_CHECK_INTERVAL);
        }
    }

    /// Kills the group and reaps the child. Returns the child's exit status if it has ended.
    pub(crate) fn end_group(&self) -> Option<ExitStatus> {
        let mut members = lock_ignoring_poison(&self.0);
        members.kill_group();
        members.reap_child(Instant::now() + REAP_TIMEOUT);
        members.child.try_wait().ok().flatten()
    }
}

impl Drop for ProcessGroup {
    fn drop(&mut self) {
        self.end_group();
    }
}

impl GroupMembers {
    fn has_ended(&mut self) -> bool {
        self.is_over || process_state(&mut self.child) != ProcessState::Runs
    }

    /// Kills the group. This fails only if no process is left in it.
    fn kill_group(&mut self) {
        if self.is_over {
            return;
        }
        #[cfg(unix)]
        {
            let leader = self.guard.as_mut().map_or(&mut self.child, GroupGuard::guard_process);
            // If other code has reaped the leader, another group may have the number.
            if process_state(leader) != ProcessState::Unknown {
                use rustix::process::{Pid, Signal, kill_process_group};
                let _ = kill_process_group(Pid::from_child(leader), Signal::KILL);
            }
        }
        // The child may have left the group.
        let _ = self.child.kill();
    }

    /// Reaps the child. Call this only after [`Self::kill_group`].
    fn reap_child(&mut self, deadline: Instant) {
        while !self.is_over && matches!(self.child.try_wait(), Ok(None)) && Instant::now() < deadline {
            thread::sleep(END_CHECK_INTERVAL);
        }
        self.is_over = true;
        self.guard = None;
    }
}

/// The state of a process that was started here.
#[derive(PartialEq)]
enum ProcessState {
    /// It has not ended.
    Runs,
    /// It has ended and is not reaped yet.
    Ended,
    /// Other code reaped it.
    Unknown,
}

/// Returns the state without reaping.
#[cfg(unix)]
fn process_state(process: &mut Child) -> ProcessState {
    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    match waitid(WaitId::Pid(Pid::from_child(process)), options) {
        Ok(None) => ProcessState::Runs,
        Ok(Some(_)) => ProcessState::Ended,
        Err(_) => ProcessState::Unknown,
    }
}

#[cfg(not(unix))]
fn process_state(process: &mut Child) -> ProcessState {
    match process.try_wait() {
        Ok(None) => ProcessState::Runs,
        Ok(Some(_)) => ProcessState::Ended,
        Err(_) => ProcessState::Unknown,
    }
}

/// Locks a mutex, also after a thread panicked while it held the lock: the data stay usable.
fn lock_ignoring_poison<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
