//! One child that runs: its pipes, and one request at a time.

use super::{
    answer::{Answer, MAX_LINE_BYTES, answer},
    fault::Fault,
    options::ProcessOptions,
    stderr::LastWords,
    stop,
};
use serde_json::{Value, json};
use std::{
    io::{BufReader, Read, Write},
    process::{Child, Command, Stdio},
    sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel},
    thread::{self, JoinHandle},
    time::Duration,
};
use wayword_world::said::{Hear, Line, plain, read_line};

/// How long a child whose input was closed may take to end by itself.
const FAREWELL: Duration = Duration::from_millis(500);
/// How long an end is waited for that its closed output announces, and the rest of its error output after it.
const AFTERMATH: Duration = Duration::from_millis(500);

/// A child process. Dropped, it is asked to go by the end of its input, and killed if it stays.
pub(crate) struct Running {
    child: Child,
    /// To the thread that writes: a child that does not read must not hold up whoever asks. `None` once it has to go.
    requests: Option<SyncSender<Vec<u8>>>,
    /// From the thread that reads. It waits until a line is taken, so a flood stays in the pipe.
    lines: Receiver<Line>,
    last_words: LastWords,
    listener: JoinHandle<()>,
}

impl Running {
    /// Starts the program; nothing is asked yet.
    pub(crate) fn start(options: &ProcessOptions, hear: &Hear) -> Result<Self, Fault> {
        let mut command = Command::new(&options.program);
        command.args(&options.arguments).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        if let Some(folder) = &options.folder {
            command.current_dir(folder);
        }
        stop::in_a_group_of_its_own(&mut command);
        let mut child = command.spawn().map_err(Fault::NotStarted)?;
        let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
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
        Ok(Self { child, requests: Some(requests), lines, last_words, listener })
    }

    /// Whether it has ended since it was last asked.
    pub(crate) fn has_ended(&mut self) -> bool {
        stop::ends_within(&mut self.child, Duration::ZERO)
    }

    /// Asks, and waits for the answer.
    pub(crate) fn ask(
        &mut self,
        id: u64,
        method: &'static str,
        params: &Value,
        within: Duration,
    ) -> Result<Value, Fault> {
        let mut request = json!({ "id": id, "method": method, "params": params }).to_string();
        request.push('\n');
        // If it cannot be sent, the child is gone, and its output says the same.
        let _ = self.requests.as_ref().map(|requests| requests.try_send(request.into_bytes()));
        let answer = match self.lines.recv_timeout(within) {
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

    /// What the end of its output means.
    fn end(&mut self) -> Fault {
        if !stop::ends_within(&mut self.child, AFTERMATH) {
            return Fault::Closed;
        }
        Fault::Died(self.child.wait().map_or_else(|error| error.to_string(), |status| status.to_string()))
    }

    fn half(&mut self, line: &[u8]) -> Fault {
        let end = self.end();
        match answer(line) {
            Err(Fault::Nonsense { start, .. }) => {
                Fault::Nonsense { reason: format!("half a line, and then it {end}"), start }
            }
            _ => end,
        }
    }

    /// Kills it, and tells what it said at last.
    pub(crate) fn bury(mut self) -> String {
        stop::kill(&mut self.child);
        // Its last words may still be on their way; something that it started may keep the pipe open for ever.
        let mut waited = Duration::ZERO;
        while !self.listener.is_finished() && waited < AFTERMATH {
            thread::sleep(Duration::from_millis(5));
            waited += Duration::from_millis(5);
        }
        self.last_words.in_words()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        self.requests = None;
        if !stop::ends_within(&mut self.child, FAREWELL) {
            stop::kill(&mut self.child);
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
