//! The controller's side of the connection: a REP socket that builds connect to. Each list of commands gets one answer.
//!
//! The build connects to Wayword, and not the other way round, so the controller listens on a port and waits. The last
//! frame of every answer is the number of the frame that the build rendered.

use super::{
    commands::BuildCommand,
    error::TdwError,
    output::{BuildOutput, VersionOutput, frame_id},
    zmtp::{SocketRole, WireError, ZmtpPeer},
};
use std::{
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
    thread::sleep,
    time::{Duration, Instant},
};

/// How often a build may report that it did not receive one list of commands. The Python client
/// (`Controller.communicate`) has the same limit.
const MAX_RESENDS: u32 = 1000;
/// How long a new connection may take for its greeting.
const GREETING_TIMEOUT: Duration = Duration::from_secs(5);

/// Where to wait for a build, and for how long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ControllerOptions {
    /// Where builds connect to. TDW's own port is 1071; only this machine can reach the default.
    pub address: SocketAddr,
    /// How long to wait for a build.
    pub connect_timeout: Duration,
    /// How long to wait for an answer. A scene that has to be downloaded takes minutes.
    pub step_timeout: Duration,
}

impl Default for ControllerOptions {
    fn default() -> Self {
        Self {
            address: SocketAddr::from((Ipv4Addr::LOCALHOST, 1071)),
            connect_timeout: Duration::from_secs(60),
            step_timeout: Duration::from_secs(600),
        }
    }
}

/// A controller: at most one build at a time.
///
/// After an error on the wire the controller drops the build, because it is then unknown which side has to send next.
/// [`TdwController::connect`] takes the next build.
#[derive(Debug)]
pub struct TdwController {
    listener: TcpListener,
    options: ControllerOptions,
    build: Option<ConnectedBuild>,
}

/// The connected build.
#[derive(Debug)]
struct ConnectedBuild {
    peer: ZmtpPeer,
    version: BuildVersion,
}

/// Which build is connected.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct BuildVersion {
    /// TDW's own version.
    pub tdw: String,
    /// Unity's version.
    pub unity: String,
}

impl From<VersionOutput<'_>> for BuildVersion {
    fn from(version: VersionOutput<'_>) -> Self {
        Self { tdw: version.tdw.to_owned(), unity: version.unity.to_owned() }
    }
}

/// A build's answer: frames of output data, and the number of the build's own frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BuildResponse {
    /// The output data, one frame for each kind.
    frames: Vec<Vec<u8>>,
    /// The build's own count of frames.
    pub frame_number: u32,
}

impl BuildResponse {
    /// The frames, read one by one.
    pub fn read_outputs(&self) -> impl Iterator<Item = Result<BuildOutput<'_>, TdwError>> {
        self.frames.iter().map(|frame| Ok(BuildOutput::read(frame)?))
    }

    /// Calls `pick` with each frame that has this `id`, and returns the first result that is not `None`. `asked` names
    /// the command that asked for the frame, for the error.
    ///
    /// # Errors
    /// Where there is no result, or a frame with this id cannot be read.
    pub fn first_output<'a, T>(
        &'a self,
        id: &'static str,
        asked: &'static str,
        pick: impl Fn(BuildOutput<'a>) -> Option<T>,
    ) -> Result<T, TdwError> {
        for output in self.frames.iter().filter(|frame| frame_id(frame).is_some_and(|its| its == id.as_bytes())) {
            if let Some(found) = pick(BuildOutput::read(output)?) {
                return Ok(found);
            }
        }
        Err(TdwError::Missing { id, asked })
    }
}

impl TdwController {
    /// Starts to listen. No build has to run yet.
    ///
    /// # Errors
    /// When the port is taken.
    pub fn bind(options: ControllerOptions) -> Result<Self, TdwError> {
        let refused = |source| TdwError::Bind { address: options.address, source };
        let listener = TcpListener::bind(options.address).map_err(refused)?;
        listener.set_nonblocking(true).map_err(refused)?;
        Ok(Self { listener, options, build: None })
    }

    /// Where builds connect to. Where port 0 was asked for, this has the port that the system chose.
    #[must_use]
    pub fn address(&self) -> SocketAddr {
        self.listener.local_addr().unwrap_or(self.options.address)
    }

    /// Whether a build is connected.
    #[must_use]
    pub fn is_connected(&self) -> bool {
        self.build.is_some()
    }

    /// The version of the connected build.
    #[must_use]
    pub fn build_version(&self) -> Option<&BuildVersion> {
        self.build.as_ref().map(|build| &build.version)
    }

    /// How long the controller waits for a build.
    #[must_use]
    pub fn connect_timeout(&self) -> Duration {
        self.options.connect_timeout
    }

    /// Waits for a build, unless one is connected, and asks for its version.
    ///
    /// # Errors
    /// When no build connects in time, or the program that connects does not follow a build's protocol.
    pub fn connect(&mut self) -> Result<&BuildVersion, TdwError> {
        if self.build.is_none() {
            let peer = self.wait_for_build()?;
            self.build = Some(ConnectedBuild { peer, version: BuildVersion::default() });
            let hello = [BuildCommand::SetErrorHandling, BuildCommand::SendVersion];
            let version = self.communicate(&hello).and_then(|response| {
                response.first_output("vers", "send_version", |output| match output {
                    BuildOutput::Version(version) => Some(BuildVersion::from(version)),
                    _ => None,
                })
            });
            match version {
                Ok(version) => self.build.iter_mut().for_each(|build| build.version = version.clone()),
                Err(error) => {
                    self.build = None;
                    return Err(error);
                }
            }
        }
        self.build_version().ok_or_else(|| self.no_build(None))
    }

    /// Accepts connections until one greets as a build does. A connection that stays silent costs five seconds.
    fn wait_for_build(&self) -> Result<ZmtpPeer, TdwError> {
        let deadline = Instant::now() + self.options.connect_timeout;
        let mut last = None;
        while Instant::now() < deadline {
            match self.listener.accept() {
                Ok((stream, _)) => match greet_build(stream, deadline) {
                    Ok(peer) => return Ok(peer),
                    Err(error) => last = Some(error),
                },
                // No connection yet, or one that was closed again.
                Err(_) => sleep(Duration::from_millis(5)),
            }
        }
        Err(self.no_build(last))
    }

    /// The error that no build connected; `last` is the error of the last connection that was tried.
    fn no_build(&self, last: Option<WireError>) -> TdwError {
        TdwError::NoBuild { address: self.address(), seconds: self.options.connect_timeout.as_secs(), last }
    }

    /// Sends commands and waits for the answer. Sends them again as long as the build answers that it did not receive them.
    ///
    /// # Errors
    /// When no build is connected; when it is gone, is late or quits with an error; or when its answer is not valid.
    pub fn communicate(&mut self, commands: &[BuildCommand]) -> Result<BuildResponse, TdwError> {
        let outcome = self.send_commands(commands);
        if outcome.as_ref().is_err_and(TdwError::is_loss) {
            self.build = None;
        }
        outcome
    }

    fn send_commands(&mut self, commands: &[BuildCommand]) -> Result<BuildResponse, TdwError> {
        let address = self.address();
        let Some(build) = &mut self.build else {
            return Err(self.no_build(None));
        };
        let text = serde_json::to_vec(commands).map_err(|error| TdwError::Scene(error.to_string()))?;
        build.peer.set_deadline(Instant::now() + self.options.step_timeout);
        for _ in 0..=MAX_RESENDS {
            let answer = build.peer.send(&[&text]).and_then(|()| build.peer.receive());
            let response = response_from_frames(answer.map_err(|source| TdwError::Wire { address, source })?)?;
            let frame_with_id =
                |id: &[u8; 4]| response.frames.iter().find(|frame| frame_id(frame).is_some_and(|its| its == *id));
            if frame_with_id(b"ftre").is_some() {
                continue;
            }
            return match frame_with_id(b"quit").map(|frame| BuildOutput::read(frame)).transpose()? {
                Some(BuildOutput::Quit(false)) => Err(TdwError::Quit),
                Some(_) => {
                    self.build = None;
                    Ok(response)
                }
                None => Ok(response),
            };
        }
        Err(TdwError::NeverHeard { times: MAX_RESENDS })
    }

    /// Ends the build, where one is connected.
    ///
    /// # Errors
    /// When it does not answer. The controller drops it in any case.
    pub fn terminate(&mut self) -> Result<(), TdwError> {
        if self.is_connected() {
            let outcome = self.communicate(&[BuildCommand::Terminate]);
            self.build = None;
            outcome?;
        }
        Ok(())
    }
}

/// Greets a build that has connected, and discards its first message, which has no meaningful content.
fn greet_build(stream: TcpStream, deadline: Instant) -> Result<ZmtpPeer, WireError> {
    let deadline = deadline.min(Instant::now() + GREETING_TIMEOUT);
    let mut peer = ZmtpPeer::greet(stream, SocketRole::Rep, deadline)?;
    peer.receive()?;
    Ok(peer)
}

/// Splits off the last frame, which is the frame number.
fn response_from_frames(mut frames: Vec<Vec<u8>>) -> Result<BuildResponse, TdwError> {
    let last = frames.pop().unwrap_or_default();
    let number = last.as_slice().try_into().map_err(|_| TdwError::NoFrameNumber { length: last.len() })?;
    Ok(BuildResponse { frames, frame_number: u32::from_be_bytes(number) })
}
