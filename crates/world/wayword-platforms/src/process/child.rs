//! Talks with a running child over its pipes, one request at a time. A thread takes the child's place for a world within
//! this process.

use super::{
    answer::{Answer, MAX_LINE_BYTES, answer},
    fault::Fault,
    group::{Group, is_ended},
    guard::FAREWELL,
    options::{Inside, ProcessOptions},
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
use wayword_world::said::{Hear, Line, plain, read_line};

/// How long to wait for a child's end after its output has closed, and then for the rest of its error output.
const AFTERMATH: Duration = Duration::from_millis(500);
/// How often to check whether a child that has not answered yet still runs. The end of its output is no sure sign,
/// because processes that it started may keep the output open.
const LOOK_EVERY: Duration = Duration::from_millis(100);

/// A child process. When it is dropped, its input is closed, which asks it to end; it is killed if it does not end. The
/// processes that it started are killed in either case.
pub(crate) struct Running {
    /// `None` for a world within this process.
    group: Option<Group>,
    /// To the thread that writes: a child that does not read must not block the caller. `None` once the child has to
    /// end.
    requests: Option<SyncSender<Vec<u8>>>,
    /// From the thread that reads. It waits until a line is received, so a flood of lines stays in the pipe.
    lines: Receiver<Line>,
    last_words: LastWords,
    /// Hears its error output; `None` for a world within this process.
    listener: Option<JoinHandle<()>>,
}

impl Running {
    /// Starts the program, without sending a request.
    pub(crate) fn start(options: &ProcessOptions, hear: &Hear) -> Result<Self, Fault> {
        if let Some(inside) = &options.inside {
            return Ok(Self::inside(inside.clone()));
        }
        let mut command = Command::new(&options.program);
        command.args(&options.arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        if let Some(folder) = &options.folder {
            command.current_dir(folder);
        }
        let started = Group::start(&mut command, options.guard.as_ref(), hear);
        let (group, (stdin, stdout, stderr)) = started.map_err(Fault::NotStarted)?;
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
        Ok(Self { group: Some(group), requests: Some(requests), lines, last_words, listener: Some(listener) })
    }

    /// Asks a world within this process, in a thread: if it hangs, its caller does not.
    fn inside(world: Inside) -> Self {
        let (requests, to_answer) = sync_channel::<Vec<u8>>(1);
        let (answered, lines) = sync_channel(0);
        thread::spawn(move || {
            while let Ok(request) = to_answer.recv() {
                if answered.send(world.answer(&request)).is_err() {
                    return;
                }
            }
        });
        Self { group: None, requests: Some(requests), lines, last_words: LastWords::default(), listener: None }
    }

    /// Whether it has ended.
    pub(crate) fn has_ended(&self) -> bool {
        self.group.as_ref().is_some_and(|group| group.ends_within(Duration::ZERO))
    }

    /// Sends a request and waits for the answer.
    pub(crate) fn ask(
        &mut self,
        id: u64,
        method: &'static str,
        params: &Value,
        within: Duration,
    ) -> Result<Value, Fault> {
        let mut request = json!({ "id": id, "method": method, "params": params }).to_string();
        request.push('\n');
        // If the request cannot be sent, the child has ended, and reading its output gives the error.
        let _ = self.requests.as_ref().map(|requests| requests.try_send(request.into_bytes()));
        let answer = match self.next_line(within) {
            Ok(Line::Whole(line)) => answer(&line)?,
            Ok(Line::Half(line)) => return Err(self.half(&line)),
            Ok(Line::TooLong) => return Err(Fault::LongLine(MAX_LINE_BYTES)),
            Ok(Line::End) | Err(RecvTimeoutError::Disconnected) => return Err(self.end()),
            Err(RecvTimeoutError::Timeout) => return Err(Fault::Hung(within.as_secs_f64())),
        };
        match answer {
            Answer { id: found, .. } if found != id => Err(Fault::WrongId { asked: id, found }),
            Answer { outcome: Ok(result), .. } => Ok(result),
            Answer { outcome: Err(refusal), .. } => {
                Err(Fault::Refused { code: refusal.code, message: plain(&refusal.message, 1000) })
            }
        }
    }

    /// Waits for a line, but no longer than until the child ends.
    fn next_line(&self, within: Duration) -> Result<Line, RecvTimeoutError> {
        let asked = Instant::now();
        loop {
            let left = within.saturating_sub(asked.elapsed());
            match self.lines.recv_timeout(left.min(LOOK_EVERY)) {
                Err(RecvTimeoutError::Timeout) if left <= LOOK_EVERY => return Err(RecvTimeoutError::Timeout),
                // A world within this process cannot be killed, but its caller need not wait for it.
                Err(RecvTimeoutError::Timeout) if self.group.is_none() && is_ended() => return Ok(Line::End),
                Err(RecvTimeoutError::Timeout) if self.has_ended() => {
                    // Its last line may not have arrived yet.
                    return Ok(self.lines.recv_timeout(AFTERMATH).unwrap_or(Line::End));
                }
                Err(RecvTimeoutError::Timeout) => {}
                line => return line,
            }
        }
    }

    /// The fault for a child that has closed its output: it died, or it still runs but can no longer answer.
    fn end(&self) -> Fault {
        let Some(group) = &self.group else { return Fault::Closed };
        if !group.ends_within(AFTERMATH) {
            return Fault::Closed;
        }
        Fault::Died(group.end().map_or_else(|| "exit status unknown".to_owned(), |status| status.to_string()))
    }

    /// The fault for a line without an end. If it is no answer, the error shows its beginning.
    fn half(&self, line: &[u8]) -> Fault {
        let end = self.end();
        match answer(line) {
            Err(Fault::Nonsense { start, .. }) => {
                Fault::Nonsense { reason: format!("half a line, then it {end}"), start }
            }
            _ => end,
        }
    }

    /// Kills it with its group, and returns the last lines of its error output.
    pub(crate) fn bury(self) -> String {
        if let Some(group) = &self.group {
            group.end();
        }
        // Its last lines may not have arrived yet. The wait is bounded, because a process that left the group may keep
        // the pipe open for ever.
        let mut waited = Duration::ZERO;
        let hears = |running: &Self| running.listener.as_ref().is_some_and(|listener| !listener.is_finished());
        while hears(&self) && waited < AFTERMATH {
            thread::sleep(Duration::from_millis(5));
            waited += Duration::from_millis(5);
        }
        self.last_words.in_words()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.requests = None;
        if let Some(group) = &self.group {
            group.ends_within(FAREWELL);
            group.end();
        }
    }
}

fn write_all(mut pipe: impl Write, requests: &Receiver<Vec<u8>>) {
    while let Ok(request) = requests.recv() {
        if pipe.write_all(&request).and_then(|()| pipe.flush()).is_err() {
            return;
        }
    }
}

fn read_all(pipe: impl Read, lines: &SyncSender<Line>) {
    let mut pipe = BufReader::new(pipe);
    loop {
        let line = read_line(&mut pipe, MAX_LINE_BYTES);
        let goes_on = matches!(line, Line::Whole(_));
        if lines.send(line).is_err() || !goes_on {
            return;
        }
    }
}
