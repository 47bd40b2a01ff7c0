//! A child and whatever it starts: one process group, which ends as a whole.
//!
//! A group's number may be another's as soon as nobody is in it. So the group is killed first and its leader reaped
//! afterwards: a leader that has ended and was not reaped keeps the number.

use super::guard::Guard;
use std::{
    io,
    path::Path,
    process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus},
    sync::{Arc, Mutex, MutexGuard, PoisonError, Weak},
    thread,
    time::{Duration, Instant},
};
use wayword_world::said::Hear;

/// How often an end that is waited for is looked for.
const LOOK_EVERY: Duration = Duration::from_millis(5);
/// How long the end of a killed child is waited for. One that hangs in a driver takes longer, and is left to it.
const REAPED_WITHIN: Duration = Duration::from_secs(1);

/// Every group that runs, for [`end_all`].
static LIVING: Mutex<Living> = Mutex::new(Living { is_closed: false, groups: Vec::new() });

struct Living {
    /// Whether no other group may start.
    is_closed: bool,
    groups: Vec<Weak<Mutex<Members>>>,
}

/// Kills every child that a [`ProcessPlatform`](super::ProcessPlatform) of this program has started, with whatever it has
/// started, and lets no other start: for a program that ends because of a signal. A request that is under way fails at once.
///
/// It takes a second at most. It may be called more than once, from any thread, but not within a signal handler itself: it
/// takes locks.
pub fn end_all() {
    let mut living = lock(&LIVING);
    living.is_closed = true;
    let groups: Vec<_> = living.groups.drain(..).filter_map(|group| group.upgrade()).collect();
    drop(living);
    for group in &groups {
        lock(group).kill();
    }
    let deadline = Instant::now() + REAPED_WITHIN;
    for group in &groups {
        lock(group).reap(deadline);
    }
}

/// A child's ends of its three pipes.
pub(crate) type Pipes = (Option<ChildStdin>, Option<ChildStdout>, Option<ChildStderr>);

/// A child that was started, and its group. Dropped, the group is killed.
pub(crate) struct Group(Arc<Mutex<Members>>);

struct Members {
    child: Child,
    /// The leader of the group, where there is one; the child is otherwise.
    guard: Option<Guard>,
    /// Whether the leader was reaped: the group's number may be another's now.
    is_over: bool,
}

impl Group {
    /// Starts a command as a group of its own: a script that starts the simulator (`xvfb-run`, say) has to end together
    /// with it, and Ctrl-C in the terminal is for Wayword.
    ///
    /// # Errors
    /// When it cannot be started, or the program is ending.
    pub(crate) fn start(command: &mut Command, guard: Option<&Path>, hear: &Hear) -> io::Result<(Self, Pipes)> {
        let guard = guard.and_then(|program| match Guard::start(program) {
            Ok(guard) => Some(guard),
            Err(error) => {
                hear(&format!("no guard can be started ({error}): if Wayword is killed, end the simulator by hand"));
                None
            }
        });
        // Held while the child starts, so that `end_all` finds it or keeps it from starting.
        let mut living = lock(&LIVING);
        if living.is_closed {
            return Err(io::Error::other("this program is ending"));
        }
        #[cfg(unix)]
        {
            let leader = guard.as_ref().map_or(0, Guard::id);
            std::os::unix::process::CommandExt::process_group(command, leader.cast_signed());
        }
        let mut child = command.spawn()?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let members = Arc::new(Mutex::new(Members { child, guard, is_over: false }));
        living.groups.retain(|group| group.strong_count() > 0);
        living.groups.push(Arc::downgrade(&members));
        Ok((Self(members), pipes))
    }

    /// Whether the child ends within a time. Whatever it has started may live on.
    pub(crate) fn ends_within(&self, within: Duration) -> bool {
        let asked = Instant::now();
        loop {
            if lock(&self.0).has_ended() {
                return true;
            }
            if asked.elapsed() >= within {
                return false;
            }
            thread::sleep(LOOK_EVERY);
        }
    }

    /// Kills the group, and reaps the child; how the child ended, where it did.
    pub(crate) fn end(&self) -> Option<ExitStatus> {
        let mut members = lock(&self.0);
        members.kill();
        members.reap(Instant::now() + REAPED_WITHIN);
        members.child.try_wait().ok().flatten()
    }
}

impl Drop for Group {
    fn drop(&mut self) {
        self.end();
    }
}

impl Members {
    fn has_ended(&mut self) -> bool {
        self.is_over || look(&mut self.child) != Look::Runs
    }

    /// It can only fail where nobody is left.
    fn kill(&mut self) {
        if self.is_over {
            return;
        }
        #[cfg(unix)]
        {
            let leader = self.guard.as_mut().map_or(&mut self.child, Guard::process);
            // Where somebody else has reaped the leader, the number may be another's.
            if look(leader) != Look::Unknown {
                use rustix::process::{Pid, Signal, kill_process_group};
                let _ = kill_process_group(Pid::from_child(leader), Signal::KILL);
            }
        }
        // It may have left the group.
        let _ = self.child.kill();
    }

    /// Only after [`Self::kill`].
    fn reap(&mut self, deadline: Instant) {
        while !self.is_over && matches!(self.child.try_wait(), Ok(None)) && Instant::now() < deadline {
            thread::sleep(LOOK_EVERY);
        }
        self.is_over = true;
        self.guard = None;
    }
}

/// What is known of a process that was started here.
#[derive(PartialEq)]
enum Look {
    Runs,
    /// It is still to be reaped.
    Ended,
    /// Somebody else reaped it.
    Unknown,
}

/// Looks without reaping.
#[cfg(unix)]
fn look(process: &mut Child) -> Look {
    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
    let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    match waitid(WaitId::Pid(Pid::from_child(process)), options) {
        Ok(None) => Look::Runs,
        Ok(Some(_)) => Look::Ended,
        Err(_) => Look::Unknown,
    }
}

#[cfg(not(unix))]
fn look(process: &mut Child) -> Look {
    match process.try_wait() {
        Ok(None) => Look::Runs,
        Ok(Some(_)) => Look::Ended,
        Err(_) => Look::Unknown,
    }
}

fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}
