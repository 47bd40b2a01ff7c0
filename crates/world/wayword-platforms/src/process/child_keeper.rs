//! Keeps a child running: sends it requests, and restarts it after a fault, a bounded number of times.
//!
//! A request that meets a fault is not sent again, because the request itself may kill the child. Its caller gets the
//! error, and the next request goes to a new child.

use super::{
    child::RunningChild,
    fault::ChildFault,
    options::ProcessOptions,
    protocol::{ChildGreeting, PROTOCOL_VERSION, WORLD_FRAME, WorldProgram},
};
use serde::de::DeserializeOwned;
use serde_json::{Value, json};
use std::{
    path::{Path, PathBuf},
    sync::{Mutex, PoisonError},
    time::Duration,
};
use wayword_core::PlatformError;
use wayword_world::output_lines::{OutputListener, to_safe_text};

/// After this many answers the child may be restarted once more.
const ANSWERS_PER_RESTART: u32 = 200;

/// Keeps one child running. Only one thread uses the child at a time.
pub(crate) struct ChildKeeper {
    options: ProcessOptions,
    /// Receives the lines of the child's error output.
    error_listener: OutputListener,
    /// The first greeting; later children must send the same.
    world: WorldProgram,
    state: Mutex<ChildState>,
}

/// The running child, and the history of earlier ones.
struct ChildState {
    running: Option<RunningChild>,
    /// The folder of its pictures, with links resolved.
    images: Option<PathBuf>,
    /// Number of requests so far, to all children; also the id of the last one.
    asked: u64,
    /// Number of requests that a child answered.
    answered: u32,
    restarts_left: u32,
    /// The latest fault that ended a child, in words; empty if there was none.
    last_fault: String,
}

impl ChildKeeper {
    /// Starts the child and reads its greeting.
    pub(crate) fn start(options: ProcessOptions, error_listener: OutputListener) -> Result<Self, PlatformError> {
        let mut state = ChildState {
            running: None,
            images: None,
            asked: 0,
            answered: 0,
            restarts_left: options.restarts,
            last_fault: String::new(),
        };
        // A first child that does not start is an error of its file, and not `Lost`: no request was lost.
        let world = state.launch_child(&options, &error_listener).map_err(|failed| failed.into_file_error(&options))?;
        Ok(Self { options, error_listener, world, state: Mutex::new(state) })
    }

    pub(crate) fn options(&self) -> &ProcessOptions {
        &self.options
    }

    pub(crate) fn world(&self) -> &WorldProgram {
        &self.world
    }

    /// Sends a request, and reads its result from the answer alone, without the child's files.
    pub(crate) fn ask_and_read<T: DeserializeOwned>(
        &self,
        method: &'static str,
        params: &Value,
    ) -> Result<T, PlatformError> {
        self.ask_and_take(method, params, |result, _| {
            serde_path_to_error::deserialize(result).map_err(|error| error.to_string())
        })
    }

    /// Sends a request, and lets `take` read the result before the next request is sent, because the child may then overwrite
    /// its picture file. `take` also gets the folder of the child's pictures.
    pub(crate) fn ask_and_take<T>(
        &self,
        method: &'static str,
        params: &Value,
        take: impl FnOnce(Value, Option<&Path>) -> Result<T, String>,
    ) -> Result<T, PlatformError> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        self.revive_child(&mut state)?;
        let result = state.ask_running_child(&self.options, method, params, self.options.answer_within).map_err(
            |failed| match (&failed.fault, params.get("scene").and_then(Value::as_str)) {
                (ChildFault::Refused { code: Some(code), message }, Some(scene)) if code == "unknown_scene" => {
                    PlatformError::UnknownScene { scene: scene.to_owned(), hint: message.clone() }
                }
                _ => failed.into_error(&self.options),
            },
        )?;
        take(result, state.images.as_deref()).map_err(|reason| self.misfit_error(method, reason))
    }

    /// The error for an answer that has the right form but cannot be used.
    pub(crate) fn misfit_error(&self, method: &'static str, reason: impl Into<String>) -> PlatformError {
        FailedRequest::without_request(ChildFault::Misfit(reason.into()), method).into_error(&self.options)
    }

    /// Starts the child again if it has ended.
    fn revive_child(&self, state: &mut ChildState) -> Result<(), PlatformError> {
        if let Some(running) = state.running.as_ref()
            && running.has_ended()
        {
            // No request was waiting for it, so none is lost.
            state.last_fault = format!(
                "ended by itself{}",
                state.running.take().map_or_else(String::new, RunningChild::kill_with_last_words)
            );
        }
        if state.running.is_some() {
            return Ok(());
        }
        let failed = |fault| FailedRequest::without_request(fault, "hello").into_error(&self.options);
        if state.restarts_left == 0 {
            return Err(failed(ChildFault::GaveUp(state.last_fault.clone())));
        }
        state.restarts_left -= 1;
        let world = state
            .launch_child(&self.options, &self.error_listener)
            .map_err(|failed| failed.into_error(&self.options))?;
        if world != self.world {
            state.running = None;
            state.last_fault = ChildFault::Changed.to_string();
            return Err(failed(ChildFault::Changed));
        }
        Ok(())
    }
}

impl ChildState {
    /// Starts a child and reads its greeting.
    fn launch_child(
        &mut self,
        options: &ProcessOptions,
        error_listener: &OutputListener,
    ) -> Result<WorldProgram, FailedRequest> {
        let started = RunningChild::start(options, error_listener).map_err(|fault| {
            self.last_fault = fault.to_string();
            FailedRequest::without_request(fault, "hello")
        })?;
        self.running = Some(started);
        let params = json!({ "protocol": PROTOCOL_VERSION, "frame": WORLD_FRAME });
        let greeting = self.ask_running_child(options, "hello", &params, options.start_within);
        let world = greeting
            .and_then(|greeting| self.accept_greeting(greeting).map_err(|fault| self.failure_after(fault, "hello")));
        world.inspect_err(|_| self.running = None)
    }

    /// Checks a greeting, and notes the folder of the child's pictures.
    fn accept_greeting(&mut self, greeting: Value) -> Result<WorldProgram, ChildFault> {
        // The version is checked first, because another version may have another greeting.
        if let Some(version) = greeting.get("protocol").and_then(Value::as_u64)
            && version != PROTOCOL_VERSION
        {
            return Err(ChildFault::Version(version));
        }
        let greeting: ChildGreeting =
            serde_path_to_error::deserialize(greeting).map_err(|error| ChildFault::Greeting(error.to_string()))?;
        if greeting.protocol != PROTOCOL_VERSION {
            return Err(ChildFault::Version(greeting.protocol));
        }
        if greeting.frame != WORLD_FRAME {
            return Err(ChildFault::Frame(greeting.frame.chars().take(80).collect()));
        }
        let unusable =
            |folder: &Path, reason: String| ChildFault::Greeting(format!("`images` {}: {reason}", folder.display()));
        self.images = match &greeting.images {
            Some(folder) if !folder.is_absolute() => return Err(unusable(folder, "is not absolute".into())),
            Some(folder) => Some(folder.canonicalize().map_err(|error| unusable(folder, error.to_string()))?),
            None => None,
        };
        greeting.to_world_program().map_err(ChildFault::Greeting)
    }

    /// Sends a request to the running child, and counts its answers.
    fn ask_running_child(
        &mut self,
        options: &ProcessOptions,
        method: &'static str,
        params: &Value,
        within: Duration,
    ) -> Result<Value, FailedRequest> {
        self.asked += 1;
        let Some(running) = self.running.as_mut() else {
            return Err(self.failure_after(ChildFault::Closed, method));
        };
        let result = running.send_request(self.asked, method, params, within);
        if result.as_ref().err().is_none_or(ChildFault::leaves_child_usable) {
            self.answered += 1;
            if self.answered.is_multiple_of(ANSWERS_PER_RESTART) && self.restarts_left < options.restarts {
                self.restarts_left += 1;
            }
        }
        result.map_err(|fault| self.failure_after(fault, method))
    }

    /// The failure of a request after a fault. If the child cannot be used any more, it is killed here.
    fn failure_after(&mut self, fault: ChildFault, method: &'static str) -> FailedRequest {
        let mut last_words = String::new();
        if !fault.leaves_child_usable() {
            last_words = self.running.take().map_or_else(String::new, RunningChild::kill_with_last_words);
            self.last_fault = format!("{fault}, when asked request {} ({method}){last_words}", self.asked);
        }
        FailedRequest { fault, method, id: Some(self.asked), last_words }
    }
}

/// A request that failed.
struct FailedRequest {
    fault: ChildFault,
    method: &'static str,
    /// The id of the request; `None` if the failure belongs to no request.
    id: Option<u64>,
    /// The end of the child's error output, for the message.
    last_words: String,
}

impl FailedRequest {
    /// A failure that does not belong to one request.
    fn without_request(fault: ChildFault, method: &'static str) -> Self {
        Self { fault, method, id: None, last_words: String::new() }
    }

    /// The error for a child that was in use: `Lost` if it cannot be used any more.
    fn into_error(self, options: &ProcessOptions) -> PlatformError {
        if self.fault.leaves_child_usable() {
            return self.into_file_error(options);
        }
        let (file, reason) = self.place_and_reason(options);
        PlatformError::Lost { world: file.display().to_string(), reason, hint: self.fault.hint() }
    }

    /// The error for a child that the user has to correct, as a fault of its file.
    fn into_file_error(self, options: &ProcessOptions) -> PlatformError {
        let (file, reason) = self.place_and_reason(options);
        PlatformError::File { file, reason, hint: self.fault.hint() }
    }

    /// The file that the error names, and the reason. If the program cannot be started, this is the world file if there is
    /// one, because the user has to correct the command there.
    fn place_and_reason(&self, options: &ProcessOptions) -> (PathBuf, String) {
        let Self { fault, method, id, last_words } = self;
        match (fault, &options.world_file) {
            (ChildFault::NotStarted(_), Some(file)) => {
                let program = to_safe_text(&options.program.to_string_lossy(), 200);
                (file.clone(), format!("field \"command\": the world program {program} {fault}"))
            }
            (ChildFault::NotStarted(_), None) => (options.program.clone(), format!("the world program {fault}")),
            _ => {
                let request = id.map_or_else(|| format!("`{method}`"), |id| format!("request {id} (`{method}`)"));
                (options.shown_command(), format!("{request}: the world program {fault}{last_words}"))
            }
        }
    }
}
