//! Chooses the topic with the camera's pictures, and the topic that describes the camera's lens.

use super::{
    contents::McapTopic,
    messages::{CameraLens, PictureHead},
    pixels,
};
use std::collections::BTreeMap;

/// Most names that an error lists; it gives the number of the others.
const MAX_NAMES: usize = 20;
/// Words in the names of topics with pictures of another kind than a person would see.
const NO_VIEW_WORDS: [&str; 9] =
    ["depth", "disparity", "infra", "thermal", "mask", "segment", "semantic", "label", "debug"];
/// Words in the names of topics with pictures in colour.
const COLOUR_WORDS: [&str; 3] = ["color", "colour", "rgb"];

/// The head of the first message of each camera, by topic.
pub(crate) type PictureHeads = BTreeMap<String, PictureHead>;

/// Topics by name.
pub(crate) type TopicsByName = BTreeMap<String, McapTopic>;

/// The reason why a topic cannot be chosen, and a way out.
pub(crate) type UnclearReason = (String, &'static str);

const NAME_CAMERA_HINT: &str =
    "write `camera = \"TOPIC\"` into a file NAME.toml beside NAME.mcap, or into recording.toml";
const FOREIGN_HINT: &str =
    "record sensor_msgs/msg/Image or CompressedImage with ROS 2; or write the pictures to a folder, or to an MP4 file";
const ROS1_HINT: &str = "convert the ROS 1 bag with `rosbags-convert --src NAME.bag --dst NAME --dst-storage mcap \
                     --dst-typestore ros2_humble` (pip install rosbags)";

/// The camera's topic: the named one, or the obvious one.
pub(crate) fn choose_camera<'a>(
    topics: &'a TopicsByName,
    heads: &PictureHeads,
    named: Option<&str>,
) -> Result<&'a str, UnclearReason> {
    let cameras: Vec<(&str, Option<String>)> = topics
        .iter()
        .filter_map(|(name, topic)| {
            let kind = topic.kind.filter(|kind| kind.is_picture())?;
            // A topic has no head if all its messages come after a break in the file.
            Some((name.as_str(), pixels::unfit_reason(kind, &heads.get(name)?.encoding)))
        })
        .collect();
    if let Some(named) = named {
        return match cameras.iter().find(|(name, _)| *name == named) {
            Some((name, None)) => Ok(name),
            Some((_, Some(why))) => Err((
                format!("the pictures of {named} have the encoding {why}"),
                "name another camera, or leave `camera` out",
            )),
            None => Err((describe_missing_camera(topics, named), "name one of these, or leave `camera` out")),
        };
    }
    let readable: Vec<&str> = cameras.iter().filter(|(_, why)| why.is_none()).map(|(name, _)| *name).collect();
    match obvious_camera(&readable) {
        Some(camera) => Ok(camera),
        None if readable.is_empty() => Err(no_camera(topics, &cameras)),
        None => Err((format!("holds several cameras: {}", list_names(readable.into_iter())), NAME_CAMERA_HINT)),
    }
}

/// The reason why a topic that the user named is no camera.
fn describe_missing_camera(topics: &TopicsByName, named: &str) -> String {
    match topics.get(named) {
        Some(topic) => format!("{named} has no pictures, but {}", describe_topic(topic)),
        None => {
            format!("has no camera {named}; its topics: {}", list_names(topics.keys().map(String::as_str)))
        }
    }
}

/// The error for a file without a camera that can be read.
fn no_camera(topics: &TopicsByName, cameras: &[(&str, Option<String>)]) -> UnclearReason {
    if !cameras.is_empty() {
        let why = cameras.iter().map(|(name, why)| format!("{name}: {}", why.as_deref().unwrap_or_default()));
        let why: Vec<String> = why.take(MAX_NAMES).collect();
        return (format!("has no pictures that can be read ({})", why.join("; ")), FOREIGN_HINT);
    }
    let described = topics.iter().take(MAX_NAMES).map(|(name, topic)| format!("{name} ({})", describe_topic(topic)));
    let described: Vec<String> = described.collect();
    let hint = if topics.values().any(|topic| topic.encoding == "ros1") { ROS1_HINT } else { FOREIGN_HINT };
    match described.is_empty() {
        true => ("has no messages".to_owned(), "record it again, with a camera's topic"),
        false => (format!("has no pictures that can be read; its topics: {}", described.join(", ")), hint),
    }
}

fn describe_topic(topic: &McapTopic) -> String {
    let McapTopic { schema, encoding, .. } = topic;
    if schema.is_empty() {
        format!("messages without a type, as {encoding}")
    } else {
        format!("{schema} as {encoding}")
    }
}

/// Names in one line, cut after the first [`MAX_NAMES`].
pub(crate) fn list_names<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let names: Vec<&str> = names.collect();
    match names.len().saturating_sub(MAX_NAMES) {
        0 => names.join(", "),
        more => format!("{} and {more} more", names.get(..MAX_NAMES).unwrap_or_default().join(", ")),
    }
}

/// The obvious camera among those that can be read: the only one; else the only one that a person would see
/// and that is not also there in compressed form; else the only one of these with colour in its name.
fn obvious_camera<'a>(readable: &[&'a str]) -> Option<&'a str> {
    let only = |names: &[&'a str]| if let [name] = names { Some(*name) } else { None };
    let has = |name: &str, words: &[&str]| words.iter().any(|word| name.to_ascii_lowercase().contains(word));
    let candidates: Vec<&str> = readable.iter().copied().filter(|name| !has(name, &NO_VIEW_WORDS)).collect();
    // The same pictures compressed are a fraction of the bytes.
    let has_compressed_twin =
        |name: &str| candidates.iter().any(|other| *other != name && other.strip_suffix("/compressed") == Some(name));
    let candidates: Vec<&str> = candidates.iter().copied().filter(|name| !has_compressed_twin(name)).collect();
    let colour: Vec<&str> = candidates.iter().copied().filter(|name| has(name, &COLOUR_WORDS)).collect();
    only(readable).or_else(|| only(&candidates)).or_else(|| only(&colour))
}

/// A camera's lens: that of the neighbouring topic, else those with the same frame if all of them have one field of view.
pub(crate) fn find_lens<'a>(
    lenses: &'a BTreeMap<String, CameraLens>,
    camera: &str,
    frame: &str,
) -> Option<&'a CameraLens> {
    let plain = camera.strip_suffix("/compressed").unwrap_or(camera);
    let beside = plain.rsplit_once('/').map_or("", |(parent, _)| parent);
    if let Some(lens) = lenses.get(&format!("{beside}/camera_info")) {
        return Some(lens);
    }
    let mut same = lenses.values().filter(|lens| lens.head.frame == frame);
    let first = same.next()?;
    same.all(|lens| lens.horizontal_fov_rad == first.horizontal_fov_rad).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_colour_camera_is_obvious_and_two_of_them_are_not() {
        let depth = ["/cam/color/image_raw", "/cam/aligned_depth_to_color/image_raw", "/cam/infra1/image_rect_raw"];
        assert_eq!(obvious_camera(&depth), Some("/cam/color/image_raw"));
        assert_eq!(obvious_camera(&["/image_raw", "/image_raw/compressed"]), Some("/image_raw/compressed"));
        assert_eq!(obvious_camera(&["/fisheye/image", "/front/rgb/image"]), Some("/front/rgb/image"));
        assert_eq!(obvious_camera(&["/left/image", "/right/image"]), None);
        // The only camera is taken, whatever its name.
        assert_eq!(obvious_camera(&["/thermal/image"]), Some("/thermal/image"));
        assert_eq!(obvious_camera(&[]), None);
    }

    #[test]
    fn long_lists_are_cut() {
        let names: Vec<String> = (0..25).map(|at| format!("/{at}")).collect();
        assert!(list_names(names.iter().map(String::as_str)).ends_with("/19 and 5 more"));
    }
}
