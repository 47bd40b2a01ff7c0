//! A program that speaks VirtualHome's protocol and shows generated houses, for tests and demonstrations.

mod home;
mod http;

use super::platform::home_names;
use crate::houses::{NotShown, ShownAs, StandInHouses};
use home::GeneratedHome;
use serde_json::{Value, json};
use std::{
    io,
    net::{SocketAddr, TcpListener},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread::{JoinHandle, sleep, spawn},
    time::Duration,
};

/// How often it checks whether it has to stop.
const STOP_CHECK_INTERVAL: Duration = Duration::from_millis(5);

/// A stand-in that runs in a thread of its own until it is dropped.
#[derive(Debug)]
pub struct VirtualHomeStandIn {
    address: SocketAddr,
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl VirtualHomeStandIn {
    /// Starts a stand-in that listens at an address; port 0 lets the system choose. Home `n` is the first generated
    /// house with one storey from seed `n + 1` on.
    ///
    /// # Errors
    /// When the port is taken.
    pub fn start(address: SocketAddr) -> io::Result<Self> {
        Self::serve_homes(address, FilmedHome::default())
    }

    /// Starts a stand-in whose home 0 is the first of these houses, home 1 the next, and so on. It has no other homes.
    ///
    /// # Errors
    /// When the port is taken.
    pub fn showing_houses(address: SocketAddr, houses: StandInHouses) -> io::Result<Self> {
        Self::serve_homes(address, FilmedHome { houses: Some(houses), ..FilmedHome::default() })
    }

    /// Each house with the home that shows it.
    ///
    /// # Errors
    /// When there are more houses than VirtualHome has homes.
    pub fn shown_scenes(houses: &StandInHouses) -> Result<Vec<ShownAs>, NotShown> {
        houses.shown_as(home_names())
    }

    fn serve_homes(address: SocketAddr, mut filmed: FilmedHome) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let stop = Arc::new(AtomicBool::new(false));
        let stopped = stop.clone();
        let thread = spawn(move || {
            while !stopped.load(Ordering::Relaxed) {
                match listener.accept() {
                    // A request that breaks off gets no answer.
                    Ok((stream, _)) => drop(http::serve_request(stream, |request| filmed.answer_request(request))),
                    Err(_) => sleep(STOP_CHECK_INTERVAL),
                }
            }
        });
        Ok(Self { address, stop, thread: Some(thread) })
    }

    /// Its port.
    #[must_use]
    pub fn port(&self) -> u16 {
        self.address.port()
    }

    /// Its address, as clients take it.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}", self.address)
    }
}

impl Drop for VirtualHomeStandIn {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::Relaxed);
        self.thread.take().map(JoinHandle::join);
    }
}

/// The home that is loaded, and the cameras that film it.
#[derive(Debug, Default)]
struct FilmedHome {
    /// The houses of homes 0, 1, and so on; if `None`, every home number has a generated house.
    houses: Option<StandInHouses>,
    home: Option<GeneratedHome>,
    cameras: Vec<Value>,
}

impl FilmedHome {
    /// The seed of a home's house; `None` where this home does not exist.
    fn seed_of(&self, number: u64) -> Option<u64> {
        match &self.houses {
            Some(houses) => houses.seeds().get(usize::try_from(number).ok()?).copied(),
            None => Some(number.saturating_add(1)),
        }
    }

    fn answer_request(&mut self, request: &Value) -> Value {
        let done = self.perform_action(request);
        let (success, fields) =
            done.map_or((false, json!({ "message": "it cannot do that" })), |fields| (true, fields));
        json!({
            "id": request["id"],
            "success": success,
            "message": fields["message"].as_str().unwrap_or_default(),
            "value": fields["value"].as_i64().unwrap_or(0),
            "message_list": fields["message_list"],
        })
    }

    /// The result of an action: a message, a value or a list; `None` where it fails.
    fn perform_action(&mut self, request: &Value) -> Option<Value> {
        let int = |n: usize| request["intParams"][n].as_u64();
        let text = || serde_json::from_str::<Value>(request["stringParams"][0].as_str()?).ok();
        match request["action"].as_str()? {
            // Like the genuine executable, fails where no home is loaded.
            "clear" => drop(self.home.as_ref()?),
            "idle" | "add_character" => {}
            "environment" => {
                self.home = Some(GeneratedHome::from_seed(self.seed_of(int(0).unwrap_or(0))?));
                self.cameras.clear();
            }
            "environment_graph" => return Some(json!({ "message": self.home.as_ref()?.graph_json().to_string() })),
            "instance_colors" => return Some(json!({ "message": self.home.as_ref()?.colours_json().to_string() })),
            "camera_count" => return Some(json!({ "value": self.cameras.len() })),
            "add_camera" => self.cameras.push(text()?),
            "update_camera" => *self.cameras.get_mut(int(0)? as usize)? = text()?,
            "camera_image" => {
                let camera = |index: &Value| self.cameras.get(index.as_u64()? as usize);
                let cameras = request["intParams"].as_array()?.iter().map(camera);
                let wanted = text()?;
                let pictures = cameras.map(|camera| self.home.as_ref()?.encode_picture(camera?, &wanted));
                return Some(json!({ "message_list": pictures.collect::<Option<Vec<String>>>()? }));
            }
            _ => return None,
        }
        Some(json!({}))
    }
}
