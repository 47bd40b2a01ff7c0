//! Reads the messages of all parts of a recording: a file, or the files of a bag.

use super::{
    MCAP_HINT,
    contents::{McapContents, TopicChannels, TopicMessage},
    message_times::MessageTimes,
    messages::{self, CameraLens, MessageKind, PictureHead},
    poses::RecordedPoses,
    reel::PicturePlace,
    topics::{PictureHeads, TopicsByName},
};
use crate::file_kind;
use ::mcap::MAGIC;
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::File,
    io::Read,
    ops::ControlFlow,
    path::{Path, PathBuf},
};
use wayword_core::PlatformError;
use wayword_world::files;

const RECOVER_HINT: &str = "if it is damaged, `mcap recover IN.mcap -o OUT.mcap` saves what can be saved";

/// An open MCAP file, with the list of its contents.
pub(super) struct McapPart {
    path: PathBuf,
    file: File,
    contents: McapContents,
}

/// The times of a picture, and its place in the files.
#[derive(Debug, Clone, Copy)]
pub(super) struct PictureShot {
    pub(super) times: MessageTimes,
    pub(super) place: PicturePlace,
}

impl McapPart {
    /// Opens a file and lists its contents.
    ///
    /// # Errors
    /// When it is no MCAP file, or cannot be read at all.
    pub(super) fn open(path: &Path) -> Result<Self, PlatformError> {
        check_magic(path)?;
        let broken = |why: String| files::file_error(path, why, RECOVER_HINT);
        let file = File::open(path).map_err(|error| broken(error.to_string()))?;
        let contents = McapContents::from_file(&file).map_err(broken)?;
        Ok(Self { path: path.to_owned(), file, contents })
    }

    /// Where this file breaks off, for the user; `None` if it is whole.
    pub(super) fn describe_break(&self) -> Option<String> {
        let end = self.contents.broken.as_ref()?;
        let name = self.path.file_name().unwrap_or_default().display();
        Some(format!("{name} is cut off or damaged ({end})"))
    }

    /// The error for a recording that breaks off in this file, of which a reason is known; `None` if the file is whole.
    pub(super) fn broken_error(&self, why: &str) -> Option<PlatformError> {
        let end = self.contents.broken.as_ref()?;
        Some(self.damage_error(format!("{why} (it can be read only up to {end})")))
    }

    fn damage_error(&self, why: String) -> PlatformError {
        files::file_error(&self.path, why, RECOVER_HINT)
    }

    fn each_message(
        &self,
        wanted: &TopicChannels<'_>,
        hear: &mut dyn FnMut(TopicMessage<'_>) -> Result<ControlFlow<()>, String>,
    ) -> Result<(), PlatformError> {
        self.contents.each_message(&self.file, wanted, hear).map_err(|why| self.damage_error(why))
    }
}

/// Checks whether the first bytes of a file are those of an MCAP file.
fn check_magic(path: &Path) -> Result<(), PlatformError> {
    let mut begin = [0; MAGIC.len()];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut begin));
    if read.is_ok() && begin == *MAGIC {
        return Ok(());
    }
    let reason = match read {
        Err(error) if error.kind() != std::io::ErrorKind::UnexpectedEof => error.to_string(),
        _ => "byte 0: does not begin like an MCAP file".to_owned(),
    };
    Err(file_kind::refuse_file(path, "an MCAP file", (reason, MCAP_HINT)))
}

/// The topics of all parts.
pub(super) fn join_topics(parts: &[McapPart]) -> TopicsByName {
    let mut topics = TopicsByName::new();
    for (name, topic) in parts.iter().flat_map(|part| &part.contents.topics) {
        topics.entry(name.clone()).or_insert_with(|| topic.clone());
    }
    topics
}

/// The head of the first message of each camera, and the first message of each lens.
///
/// # Errors
/// When a file is broken, or a message is not what its topic says.
pub(super) fn read_beginnings(
    parts: &[McapPart],
) -> Result<(PictureHeads, BTreeMap<String, CameraLens>), PlatformError> {
    let (mut heads, mut lenses) = (PictureHeads::new(), BTreeMap::new());
    let mut known: BTreeSet<String> = BTreeSet::new();
    for part in parts {
        let is_wanted =
            |topic: &str, kind: MessageKind| (kind.is_picture() || kind == MessageKind::Lens) && !known.contains(topic);
        let wanted = part.contents.channels_where(is_wanted);
        let mut missing: BTreeSet<&str> = wanted.values().map(|(topic, _)| *topic).collect();
        part.each_message(&wanted, &mut |TopicMessage { topic, kind, bytes, .. }| {
            // Only the first message of a topic counts.
            if !missing.remove(topic) {
            } else if kind == MessageKind::Lens {
                // A lens that cannot be read counts as unknown.
                lenses.extend(CameraLens::read(bytes).ok().map(|lens| (topic.to_owned(), lens)));
            } else {
                heads.insert(topic.to_owned(), PictureHead::read(kind, bytes)?);
            }
            Ok(if missing.is_empty() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })?;
        known.extend(heads.keys().cloned());
        known.extend(lenses.keys().cloned());
    }
    Ok((heads, lenses))
}

/// The places of all pictures of a camera, and all poses, in the order of the files.
///
/// # Errors
/// When a file is broken, or a message is not what its topic says.
pub(super) fn gather_messages(
    parts: &[McapPart],
    camera: &str,
    frame: &str,
) -> Result<(Vec<PictureShot>, RecordedPoses), PlatformError> {
    let (mut shots, mut poses) = (Vec::new(), RecordedPoses::new(frame));
    for (number, part) in parts.iter().enumerate() {
        let wanted = part.contents.channels_where(|topic, kind| kind.is_pose() || topic == camera);
        part.each_message(&wanted, &mut |TopicMessage { topic, kind, logged_ns, place, bytes }| {
            if kind.is_picture() {
                let stamp_ns = PictureHead::read(kind, bytes)?.head.stamp_ns;
                let place = PicturePlace { part: number, place };
                shots.push(PictureShot { times: MessageTimes { stamp_ns, logged_ns }, place });
            } else {
                poses.add_message(topic, kind, logged_ns, messages::read_transforms(kind, bytes)?);
            }
            Ok(ControlFlow::Continue(()))
        })?;
    }
    Ok((shots, poses))
}
