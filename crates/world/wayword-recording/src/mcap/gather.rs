//! Goes through the messages of some topics.

use super::{
    contents::{Contents, Stretch},
    records::MESSAGE,
};
use std::{collections::BTreeMap, fs::File, ops::ControlFlow};

/// A message that was found.
pub(crate) struct Message<'a> {
    pub(crate) channel: u16,
    pub(crate) logged_ns: i64,
    pub(crate) place: Place,
    /// Its bytes, or the first of them.
    pub(crate) bytes: &'a [u8],
}

/// Where a message is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    /// Which of [`Contents::stretches`].
    pub(crate) stretch: usize,
    /// Where its record begins in that.
    pub(crate) at: u64,
}

/// Who is handed messages, and may have enough. What it finds wrong with one is told with its place.
pub(crate) type Hear<'a> = dyn FnMut(Message<'_>) -> Result<ControlFlow<()>, String> + 'a;

/// Hands out the messages of some channels in the order of the file, of each channel's at most so many bytes.
///
/// # Errors
/// When the file is broken, and nobody knew, or `hear` fails.
pub(crate) fn messages(
    file: &File,
    contents: &Contents,
    wanted: &BTreeMap<u16, u64>,
    hear: &mut Hear<'_>,
) -> Result<(), String> {
    let mut bytes = Vec::new();
    for (stretch, part) in contents.stretches.iter().enumerate() {
        if !wanted.keys().any(|channel| part.may_hold(*channel)) {
            continue;
        }
        let ends_early = contents.broken.is_some() && stretch + 1 == contents.stretches.len();
        match through(file, part, stretch, wanted, &mut bytes, hear) {
            Ok(ControlFlow::Continue(())) => {}
            Ok(ControlFlow::Break(())) => return Ok(()),
            Err(Wrong::File(_)) if ends_early => {}
            Err(Wrong::File(why) | Wrong::Message(why)) => return Err(why),
        }
    }
    Ok(())
}

/// What can be wrong.
enum Wrong {
    File(String),
    Message(String),
}

fn through(
    file: &File,
    part: &Stretch,
    stretch: usize,
    wanted: &BTreeMap<u16, u64>,
    bytes: &mut Vec<u8>,
    hear: &mut Hear<'_>,
) -> Result<ControlFlow<()>, Wrong> {
    let mut records = part.open(file).map_err(Wrong::File)?;
    while let Some(found) = records.next().map_err(Wrong::File)? {
        if found.opcode != MESSAGE {
            continue;
        }
        let head = records.message().map_err(Wrong::File)?;
        let Some(most) = wanted.get(&head.channel) else { continue };
        records.body(*most, bytes).map_err(Wrong::File)?;
        let at = found.at;
        let message = Message { channel: head.channel, logged_ns: head.logged_ns, place: Place { stretch, at }, bytes };
        let answer = hear(message).map_err(|why| Wrong::Message(format!("message at {}: {why}", records.place(at))))?;
        if answer.is_break() {
            return Ok(ControlFlow::Break(()));
        }
    }
    Ok(ControlFlow::Continue(()))
}
