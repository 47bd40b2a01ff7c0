//! A client for VirtualHome's HTTP protocol. The size of answers and the time for them are limited.

#![cfg_attr(
    not(test),
    warn(
        clippy::indexing_slicing,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_possible_wrap
    )
)]

use super::{error::HomeError, graph::EnvironmentGraph};
use crate::decode;
use base64::{Engine, prelude::BASE64_STANDARD};
use image::ImageFormat;
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::{Map, Value, json};
use std::{collections::BTreeMap, time::Duration};
use ureq::Agent;
use wayword_core::DVec3;

/// Largest answer that is read, bytes: a picture of 8192 x 4096 pixels in base64.
const MAX_ANSWER_BYTES: u64 = 128 << 20;
/// Length of the part of the simulator's message that an error quotes, characters.
const QUOTED_CHARS: usize = 200;

/// A simulator at an address.
#[derive(Debug)]
pub struct VirtualHomeClient {
    agent: Agent,
    url: String,
    /// Number of requests so far, and the id of the last one.
    asked: u64,
}

/// Where a camera of the scene is: Unity's position, Euler angles in degrees, vertical field of view in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "the type's documentation names each")]
pub struct VirtualHomeCamera {
    pub position: [f64; 3],
    pub rotation_deg: [f64; 3],
    pub field_of_view_deg: f64,
}

/// The kind of picture that a camera takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CameraMode {
    /// Colours as an eye sees them.
    Normal,
    /// Each object in a different colour.
    Instances,
}

/// An answer of the simulator. The action decides which field has the result.
#[derive(Debug, Deserialize)]
struct VirtualHomeAnswer {
    success: bool,
    #[serde(default)]
    message: Option<String>,
    #[serde(default)]
    value: Option<i64>,
    #[serde(default)]
    message_list: Option<Vec<String>>,
}

fn json_vector([x, y, z]: [f64; 3]) -> Value {
    json!({ "x": x, "y": y, "z": z })
}

fn quote_message(text: &str) -> String {
    text.chars().take(QUOTED_CHARS).collect()
}

impl VirtualHomeClient {
    /// A client of the simulator at an address like `http://127.0.0.1:8080`; each answer takes at most `timeout`.
    #[must_use]
    pub fn new(url: impl Into<String>, timeout: Duration) -> Self {
        let config = Agent::config_builder()
            .http_status_as_error(false)
            .max_redirects(0)
            .timeout_global(Some(timeout))
            // The simulator runs on this machine, where no proxy reaches it.
            .proxy(None)
            .build();
        Self { agent: Agent::new_with_config(config), url: url.into(), asked: 0 }
    }

    /// Its address.
    #[must_use]
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Posts an action with its whole numbers and texts, and returns the answer if it reports success.
    fn post_action(
        &mut self,
        action: &'static str,
        ints: &[i64],
        texts: &[String],
    ) -> Result<VirtualHomeAnswer, HomeError> {
        self.asked += 1;
        let mut request = Map::new();
        request.insert("id".to_owned(), json!(self.asked.to_string()));
        request.insert("action".to_owned(), json!(action));
        if !ints.is_empty() {
            request.insert("intParams".to_owned(), json!(ints));
        }
        if !texts.is_empty() {
            request.insert("stringParams".to_owned(), json!(texts));
        }
        let unreachable = |error: ureq::Error| HomeError::Unreachable { action, reason: error.to_string() };
        let request = Value::Object(request).to_string();
        let sent = self.agent.post(&self.url).header("content-type", "application/json").send(request);
        let (head, mut body) = sent.map_err(unreachable)?.into_parts();
        let body = body.with_config().limit(MAX_ANSWER_BYTES).read_to_vec().map_err(unreachable)?;
        if head.status != 200 {
            let message = quote_message(&String::from_utf8_lossy(&body));
            return Err(HomeError::Status { action, status: head.status.as_u16(), message });
        }
        let answer: VirtualHomeAnswer = parse_answer(action, "JSON with `success`", &body)?;
        if answer.success {
            return Ok(answer);
        }
        Err(HomeError::Failed { action, message: quote_message(&answer.message.unwrap_or_default()) })
    }

    /// Loads one of its homes, and removes the characters and cameras that were there before.
    ///
    /// # Errors
    /// When the simulator is gone or does not have this home.
    pub fn reset(&mut self, home: u32) -> Result<(), HomeError> {
        // Like the genuine client, this goes on if "clear" fails because no home is loaded.
        match self.post_action("clear", &[home.into()], &[]) {
            Ok(_) | Err(HomeError::Failed { .. }) => {}
            Err(error) => return Err(error),
        }
        self.post_action("environment", &[home.into()], &[]).map(drop)
    }

    /// The objects, rooms and walls of the home.
    ///
    /// # Errors
    /// When the simulator is gone, or does not send a graph.
    pub fn environment_graph(&mut self) -> Result<EnvironmentGraph, HomeError> {
        let action = "environment_graph";
        let answer = self.post_action(action, &[], &[])?;
        parse_answer(action, "a graph of nodes with boxes", answer.message.unwrap_or_default().as_bytes())
    }

    /// How many cameras there are.
    ///
    /// # Errors
    /// When the simulator is gone, or its answer has no count.
    pub fn camera_count(&mut self) -> Result<i64, HomeError> {
        let action = "camera_count";
        let missing =
            || HomeError::Malformed { action, expected: "JSON with `value`", reason: "it has none".to_owned() };
        self.post_action(action, &[], &[])?.value.ok_or_else(missing)
    }

    /// Adds a camera to the scene; it is the last of [`VirtualHomeClient::camera_count`].
    ///
    /// # Errors
    /// When the simulator is gone or refuses.
    pub fn add_camera(&mut self, camera: &VirtualHomeCamera) -> Result<(), HomeError> {
        self.post_action("add_camera", &[], &[camera.to_json()]).map(drop)
    }

    /// Moves a camera of the scene.
    ///
    /// # Errors
    /// When the simulator is gone or does not have this camera.
    pub fn update_camera(&mut self, index: i64, camera: &VirtualHomeCamera) -> Result<(), HomeError> {
        self.post_action("update_camera", &[index], &[camera.to_json()]).map(drop)
    }

    /// A camera's picture: RGB, rows from the top.
    ///
    /// # Errors
    /// When the simulator is gone, or sends no picture of this size.
    pub fn camera_image(
        &mut self,
        index: i64,
        mode: CameraMode,
        (width, height): (u32, u32),
    ) -> Result<Vec<u8>, HomeError> {
        let action = "camera_image";
        let mode = match mode {
            CameraMode::Normal => "normal",
            CameraMode::Instances => "seg_inst",
        };
        let wanted = json!({ "mode": mode, "image_width": width, "image_height": height });
        let answer = self.post_action(action, &[index], &[wanted.to_string()])?;
        let malformed = |reason: String| HomeError::Malformed { action, expected: "a PNG in base64", reason };
        let pictures = answer.message_list.unwrap_or_default();
        let first = pictures.first().ok_or_else(|| malformed("it has no picture".to_owned()))?;
        let file = BASE64_STANDARD.decode(first).map_err(|error| malformed(error.to_string()))?;
        decode::decode_rgb(&file, ImageFormat::Png, (width, height)).map_err(malformed)
    }

    /// The colour of each object in pictures of instances, by the object's id.
    ///
    /// # Errors
    /// When the simulator is gone, or does not send colours.
    pub fn instance_colors(&mut self) -> Result<BTreeMap<i64, [u8; 3]>, HomeError> {
        let action = "instance_colors";
        let answer = self.post_action(action, &[], &[])?;
        let message = answer.message.unwrap_or_default();
        let colours: BTreeMap<i64, [f64; 3]> = parse_answer(action, "three numbers for each id", message.as_bytes())?;
        // Channels of Unity's colours lie between 0 and 1. A channel above 1 shows that these are bytes.
        let scale = if colours.values().flatten().any(|channel| *channel > 1.0) { 1.0 } else { 255.0 };
        let bytes = |rgb: [f64; 3]| {
            let channels = (DVec3::from_array(rgb) * scale).round();
            channels.clamp(DVec3::ZERO, DVec3::splat(255.0)).as_u8vec3().to_array()
        };
        Ok(colours.into_iter().map(|(id, rgb)| (id, bytes(rgb))).collect())
    }
}

impl VirtualHomeCamera {
    fn to_json(self) -> String {
        let Self { position, rotation_deg, field_of_view_deg } = self;
        let fields = json!({
            "position": json_vector(position),
            "rotation": json_vector(rotation_deg),
            "field_view": field_of_view_deg,
        });
        fields.to_string()
    }
}

fn parse_answer<T: DeserializeOwned>(
    action: &'static str,
    expected: &'static str,
    json: &[u8],
) -> Result<T, HomeError> {
    serde_json::from_slice(json).map_err(|error| HomeError::Malformed { action, expected, reason: error.to_string() })
}
