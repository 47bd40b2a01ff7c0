//! Talks with a running child over its pipes, one request at a time. For a world within this process, a thread answers in
//! place of a child.

use super::{
    answer::{ChildAnswer, MAX_LINE_BYTES, parse_answer},
    fault::ChildFault,
    group::{ProcessGroup, is_ended},
    guard::FAREWELL_WAIT,
    options::{InsideWorld, ProcessOptions},
    stderr::LastWords,
};
use serde_json::{Value, json};
use std::{
    io::{BufReader, Read, Write},
    process::{Command, Stdio},
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};
use wayword_world::output_lines::{OutputLine, OutputListener, read_line, to_safe_text};

/// How long to wait for a child's end after its output has closed, and then for the rest of its error output.
const AFTERMATH_WAIT: Duration = Duration::from_millis(500);
/// How often to check whether a child that has not answered yet still runs. The end of its output is no sure sign,
/// because processes that it started may keep the output open.
const ALIVE_CHECK_INTERVAL: Duration = Duration::from_millis(100);

/// A child process. When it is dropped, its input is closed, which asks it to end; it is killed if it does not end. The
/// processes that it started are killed in either case.
pub(crate) struct RunningChild {
    /// `None` for a world within this process.
    group: Option<ProcessGroup>,
    /// To the thread that writes: a child that does not read must not block the caller. `None` once the child has to
    /// end.
    requests: Option<SyncSender<Vec<u8>>>,
    /// From the thread that reads. It waits until a line is received, so a flood of lines stays in the pipe.
    lines: Receiver<OutputLine>,
    /// The last lines of its error output.
    last_words: LastWords,
    /// The thread that reads its error output; `None` for a world within this process.
    stderr_thread: Option<JoinHandle<()>>,
}

impl RunningChild {
    /// Starts the program, without sending a request.
    pub(crate) fn start(options: &ProcessOptions, hear: &OutputListener) -> Result<Self, ChildFault> {
        if let Some(inside) = &options.inside {
            return Ok(Self::for_inside_world(inside.clone()));
        }
        let mut command = Command::new(&options.program);
        command.args(&options.arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        if let Some(folder) = &options.folder {
            command.current_dir(folder);
        }
        let started = ProcessGroup::start(&mut command, options.guard.as_ref(), hear);
        let (group, (stdin, stdout, stderr)) = started.map_err(ChildFault::NotStarted)?;
        let (requests, to_write) = sync_channel::<Vec<u8>>(1);
        let (read, lines) = sync_channel(0);
        let last_words = LastWords::default();
        let (words, hear) = (last_words.clone(), hear.clone());
        thread::spawn(move || stdin.map(|pipe| write_all(pipe, &to_write)));
        thread::spawn(move || stdout.map(|pipe| read_all(pipe, &read)));
        let listener = thread::spawn(move || {
            if let Some(pipe) = stderr {
                words.listen(pipe, &hear);
            }
        });
        Ok(Self { group: Some(group), requests: Some(requests), lines, last_words, stderr_thread: Some(listener) })
    }

    /// Asks a world within this process, in a thread: if it hangs, its caller does not.
    fn for_inside_world(world: InsideWorld) -> Self {
        let (requests, to_answer) = sync_channel::<Vec<u8>>(1);
        let (answered, lines) = sync_channel(0);
        thread::spawn(move || {
            while let Ok(request) = to_answer.recv() {
                if answered.send(world.answer_line(&request)).is_err() {
                    return;
                }
            }
        });
        Self { group: None, requests: Some(requests), lines, last_words: LastWords::default(), stderr_thread: None }
    }

    /// Whether it has ended.
    pub(crate) fn has_ended(&self) -> bool {
        self.group.as_ref().is_some_and(|group| group.ends_within(Duration::ZERO))
    }

    /// Sends a request and waits for the answer.
    pub(crate) fn send_request(
        &mut self,
        id: u64,
        method: &'static str,
        params: &Value,
        within: Duration,
    ) -> Result<Value, ChildFault> {
        let mut request = json!({ "id": id, "method": method, "params": params }).to_string();
        request.push('\n');
        // If the request cannot be sent, the child has ended, and reading its output gives the error.
        let _ = self.requests.as_ref().map(|requests| requests.try_send(request.into_bytes()));
        let answer = match self.next_line(within) {
            Ok(OutputLine::Whole(line)) => parse_answer(&line)?,
            Ok(OutputLine::Half(line)) => return Err(self.half_line_fault(&line)),
            Ok(OutputLine::TooLong) => return Err(ChildFault::LongLine(MAX_LINE_BYTES)),
            Ok(OutputLine::End) | Err(RecvTimeoutError::Disconnected) => return Err(self.end_fault()),
            Err(RecvTimeoutError::Timeout) => return Err(ChildFault::Hung(within.as_secs_f64())),
        };
        match answer {
            ChildAnswer { id: found, .. } if found != id => Err(ChildFault::WrongId { asked: id, found }),
            ChildAnswer { outcome: Ok(result), .. } => Ok(result),
            ChildAnswer { outcome: Err(refusal), .. } => {
                Err(ChildFault::Refused { code: refusal.code, message: to_safe_text(&refusal.message, 1000) })
            }
        }
    }

    /// Waits for a line, but no longer than until the child ends.
    fn next_line(&self, within: Duration) -> Result<OutputLine, RecvTimeoutError> {
        let asked = Instant::now();
        loop {
            let left = within.saturating_sub(asked.elapsed());
            match self.lines.recv_timeout(left.min(ALIVE_CHECK_INTERVAL)) {
                Err(RecvTimeoutError::Timeout) if left <= ALIVE_CHECK_INTERVAL => {
                    return Err(RecvTimeoutError::Timeout);
                }
                // A world within this process cannot be killed, but its caller need not wait for it.
                Err(RecvTimeoutError::Timeout) if self.group.is_none() && is_ended() => return Ok(OutputLine::End),
                Err(RecvTimeoutError::Timeout) if self.has_ended() => {
                    // Its last line may not have arrived yet.
                    return Ok(self.lines.recv_timeout(AFTERMATH_WAIT).unwrap_or(OutputLine::End));
                }
                Err(RecvTimeoutError::Timeout) => {}
                line => return line,
            }
        }
    }

    /// The fault for a child that has closed its output: it died, or it still runs but can no longer answer.
    fn end_fault(&self) -> ChildFault {
        let Some(group) = &self.group else { return ChildFault::Closed };
        if !group.ends_within(AFTERMATH_WAIT) {
            return ChildFault::Closed;
        }
        ChildFault::Died(
            group.end_group().map_or_else(|| "exit status unknown".to_owned(), |status| status.to_string()),
        )
    }

    /// The fault for a line without an end. If it is no answer, the error shows its beginning.
    fn half_line_fault(&self, line: &[u8]) -> ChildFault {
        let end = self.end_fault();
        match parse_answer(line) {
            Err(ChildFault::Nonsense { start, .. }) => {
                ChildFault::Nonsense { reason: format!("half a line, then it {end}"), start }
            }
            _ => end,
        }
    }

    /// Kills it with its group, and returns the last lines of its error output.
    pub(crate) fn kill_with_last_words(self) -> String {
        if let Some(group) = &self.group {
            group.end_group();
        }
        // Its last lines may not have arrived yet. The wait is bounded, because a process that left the group may keep
        // the pipe open for ever.
        let mut waited = Duration::ZERO;
        let hears = |running: &Self| running.stderr_thread.as_ref().is_some_and(|listener| !listener.is_finished());
        while hears(&self) && waited < AFTERMATH_WAIT {
            thread::sleep(Duration::from_millis(5));
            waited += Duration::from_millis(5);
        }
        self.last_words.in_words()
    }
}

impl Drop for RunningChild {
    fn drop(&mut self) {
        self.requests = None;
        if let Some(group) = &self.group {
            group.ends_within(FAREWELL_WAIT);
            group.end_group();
        }
    }
}

/// Writes requests to a pipe until there are no more, or the pipe breaks.
fn write_all(mut pipe: impl Write, requests: &Receiver<Vec<u8>>) {
    while let Ok(request) = requests.recv() {
        if pipe.write_all(&request).and_then(|()| pipe.flush()).is_err() {
            return;
        }
    }
}

/// Reads lines from a pipe and passes them on, until the pipe ends or sends a line that is too long.
fn read_all(pipe: impl Read, lines: &SyncSender<OutputLine>) {
    let mut pipe = BufReader::new(pipe);
    loop {
        let line = read_line(&mut pipe, MAX_LINE_BYTES);
        let goes_on = matches!(line, OutputLine::Whole(_));
        if lines.send(line).is_err() || !goes_on {
            return;
        }
    }
}
