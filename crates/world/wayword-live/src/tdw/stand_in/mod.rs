//! A program that speaks the TDW build's protocol and draws generated houses, for tests and demonstrations.
//!
//! It carries out the commands that Wayword and its tests send and ignores all others, as the build does with commands
//! that it cannot carry out. The name of the scene chooses the house. Rooms, walls and furniture are those of the house;
//! the objects that commands name are not drawn. [`StandInFurnishing`] sets whether furniture appears only after a command has
//! added an object.

mod answers;
mod flatbuffer_writer;
mod pictures;
mod state;
mod world;

use super::{
    scenes,
    zmtp::{SocketRole, WireError, ZmtpPeer},
};
use crate::houses::{NotShown, ShownAs, StandInHouses};
pub(crate) use pictures::{id_colour, png_file as png};
use serde_json::Value;
use state::BuildState;
use std::{
    net::{SocketAddr, TcpStream},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{JoinHandle, sleep, spawn},
    time::{Duration, Instant},
};
pub use world::StandInWorld;
use world::StandInWorlds;

/// How often it checks whether it has to stop.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(50);
/// How long an exchange may take once it has begun.
const EXCHANGE_TIMEOUT: Duration = Duration::from_secs(60);

/// Which build the stand-in imitates, and which of its faults it has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct StandInOptions {
    /// The version that it reports. Up to 1.12 `vers` is a FlatBuffer, later plain bytes.
    pub version: &'static str,
    /// The houses that it draws: the first as `floorplan_1a`, the next as `floorplan_1b`, and so on through
    /// [`TdwStandIn::shown_scenes`]. All other scenes show the first house.
    pub houses: StandInHouses,
    /// Whether the houses are furnished, and which objects have labels.
    pub furnished: StandInFurnishing,
    /// How many lists of commands it pretends not to have received (`ftre`).
    pub deaf: u32,
    /// After this many answers the connection breaks, once, and a new build takes over.
    pub breaks_after: Option<u32>,
    /// After this many answers it stops sending.
    pub hangs_after: Option<u32>,
    /// Frames with which it answers every list of commands, instead of its own answers.
    pub canned: Option<Vec<Vec<u8>>>,
}

/// Whether the houses of a stand-in are furnished, and which objects have labels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StandInFurnishing {
    /// Furniture, doors and windows have labels. In the genuine build, doors and windows have none.
    WithFixtures,
    /// Only furniture has labels, as in the genuine build's furnished floor plans.
    Always,
    /// As [`StandInFurnishing::Always`], but there is no furniture until a command adds an object.
    OnceAdded,
}

impl Default for StandInOptions {
    fn default() -> Self {
        Self {
            version: "1.13.0.0",
            houses: StandInHouses::with_one_storey(1, 1),
            furnished: StandInFurnishing::WithFixtures,
            deaf: 0,
            breaks_after: None,
            hangs_after: None,
            canned: None,
        }
    }
}

/// A stand-in that runs in a thread of its own until it is dropped or receives the command to end.
#[derive(Debug)]
pub struct TdwStandIn {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl TdwStandIn {
    /// Starts a stand-in, which connects as soon as the controller listens.
    #[must_use]
    pub fn start(controller: SocketAddr, options: StandInOptions) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let thread =
            spawn(move || StandInBuild { controller, options, stop: stopped, answered: 0 }.run_until_stopped());
        Self { stop, thread: Some(thread) }
    }

    /// Each house with the scene that shows it; the scenes are the unfurnished floor plans.
    ///
    /// # Errors
    /// When there are more houses than floor plans.
    pub fn shown_scenes(houses: &StandInHouses) -> Result<Vec<ShownAs>, NotShown> {
        houses.shown_as(scenes::floor_plan_names())
    }

    /// Waits until it has received the command to end.
    pub fn join(mut self) {
        self.thread.take().map(JoinHandle::join);
    }
}

impl Drop for TdwStandIn {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

/// The part of a stand-in that runs in its thread.
struct StandInBuild {
    controller: SocketAddr,
    options: StandInOptions,
    stop: Arc<AtomicBool>,
    /// Number of lists of commands received so far.
    answered: u32,
}

impl StandInBuild {
    fn is_stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Connects again and again: a build that lost its controller waits for the next.
    fn run_until_stopped(&mut self) {
        let mut worlds = None;
        while !self.is_stopped() {
            let outcome = TcpStream::connect(self.controller)
                .map_err(|source| WireError::Io { doing: "connecting", source })
                .and_then(|stream| self.serve_controller(stream, &mut worlds));
            match outcome {
                Ok(()) => return,
                Err(_) => sleep(STOP_CHECK_INTERVAL),
            }
        }
    }

    /// Greets a controller and answers it until the build has to end or the connection breaks.
    fn serve_controller(&mut self, stream: TcpStream, worlds: &mut Option<StandInWorlds>) -> Result<(), WireError> {
        let mut peer = ZmtpPeer::greet(stream, SocketRole::Req, Instant::now() + EXCHANGE_TIMEOUT)?;
        peer.send(&[b"hello"])?;
        let worlds = worlds
            .get_or_insert_with(|| StandInWorlds::new(self.options.houses.clone(), self.options.furnished))
            .clone();
        let mut state = BuildState::new(worlds, self.options.version);
        loop {
            while !peer.has_news(STOP_CHECK_INTERVAL) {
                if self.is_stopped() {
                    return Ok(());
                }
            }
            peer.set_deadline(Instant::now() + EXCHANGE_TIMEOUT);
            let commands = peer.receive()?;
            self.answered += 1;
            if self.options.hangs_after.is_some_and(|after| self.answered > after) {
                continue;
            }
            if self.options.breaks_after.is_some_and(|after| self.answered > after) {
                self.options.breaks_after = None;
                return Err(WireError::Gone { doing: "breaking the connection on purpose" });
            }
            let frames = self.answer_frames(&mut state, &commands);
            peer.set_deadline(Instant::now() + EXCHANGE_TIMEOUT);
            peer.send(&frames)?;
            if state.has_quit {
                return Ok(());
            }
        }
    }

    /// The frames that answer a list of commands, the last one with the frame number.
    fn answer_frames(&mut self, state: &mut BuildState, commands: &[Vec<u8>]) -> Vec<Vec<u8>> {
        if self.options.deaf > 0 {
            self.options.deaf -= 1;
            return vec![b"\0\0\0\0ftre".to_vec(), vec![0; 4]];
        }
        let mut frames = match &self.options.canned {
            Some(frames) if state.is_known() => frames.clone(),
            _ => run_commands(state, commands),
        };
        frames.push(self.answered.to_be_bytes().to_vec());
        frames
    }
}

/// Runs the commands and returns the frames that they ask for.
fn run_commands(state: &mut BuildState, message: &[Vec<u8>]) -> Vec<Vec<u8>> {
    let commands: Vec<Value> = message.first().and_then(|text| serde_json::from_slice(text).ok()).unwrap_or_default();
    let mut frames = Vec::new();
    for command in &commands {
        let kind = command["$type"].as_str().unwrap_or_default();
        state.obey_command(kind, command);
        frames.extend(answers::answer_command(state, kind, command));
    }
    frames.extend(answers::due_pictures(state));
    frames
}

/// An `imag` frame with one raw pass of a size, for [`StandInOptions::canned`]: the build's largest picture.
#[must_use]
pub fn canned_picture(width: u32, height: u32) -> Vec<u8> {
    use flatbuffer_writer::FlatBufferField;
    let pixels = (0..width as usize * height as usize * 3).map(|index| (index % 251) as u8).collect();
    let pass = vec![FlatBufferField::I32(16), FlatBufferField::Bytes(pixels), FlatBufferField::U8(1)];
    let fields = vec![
        FlatBufferField::Text("a".to_owned()),
        FlatBufferField::Text("SensorContainer".to_owned()),
        FlatBufferField::I32(width as i32),
        FlatBufferField::I32(height as i32),
        FlatBufferField::Tables(vec![pass]),
    ];
    flatbuffer_writer::write_buffer(b"imag", fields)
}

/// A small frame of every kind that the stand-in sends, with its id; `vers` in both layouts.
#[cfg(test)]
pub(super) fn frames_of_every_kind() -> &'static [(String, Vec<u8>)] {
    static FRAMES: std::sync::OnceLock<Vec<(String, Vec<u8>)>> = std::sync::OnceLock::new();
    const COMMANDS: &str = r#"[
        {"$type":"create_avatar","type":"A_Img_Caps_Kinematic","id":"a"}, {"$type":"set_screen_size","width":8,"height":6},
        {"$type":"set_pass_masks","pass_masks":["_img","_id","_depth"],"avatar_id":"a"},
        {"$type":"send_version"}, {"$type":"send_images","ids":[],"frequency":"once"}, {"$type":"send_segmentation_colors"},
        {"$type":"send_categories"}, {"$type":"send_scene_regions"}, {"$type":"send_bounds"}, {"$type":"send_transforms"},
        {"$type":"send_occupancy_map","cell_size":2.0,"raycast_y":2.5}, {"$type":"send_avatars"},
        {"$type":"send_camera_matrices"}, {"$type":"send_image_sensors"},
        {"$type":"send_is_on_nav_mesh","position":{"x":2,"y":0,"z":2},"max_distance":2,"id":3},
        {"$type":"send_nav_mesh_path","origin":{"x":1,"y":0,"z":1},"destination":{"x":3,"y":0,"z":3},"id":4},
        {"$type":"terminate"}]"#;
    FRAMES.get_or_init(|| {
        let mut old = BuildState::new(
            StandInWorlds::new(StandInHouses::with_one_storey(1, 1), StandInFurnishing::WithFixtures),
            "1.12.27",
        );
        let mut frames = run_commands(&mut old, &[br#"[{"$type":"send_version"}]"#.to_vec()]);
        let mut new = BuildState::new(old.worlds, "1.13.0.0");
        frames.extend(run_commands(&mut new, &[COMMANDS.as_bytes().to_vec()]));
        frames.into_iter().map(|frame| (String::from_utf8_lossy(&frame[4..8]).into_owned(), frame)).collect()
    })
}
