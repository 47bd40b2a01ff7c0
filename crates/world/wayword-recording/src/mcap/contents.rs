//! Finds the topics of an MCAP file, and the places of its messages.
//!
//! Each program that writes to a topic has a channel, and messages carry the channel's number. Messages lie in chunks, which may
//! be compressed.
//!
//! The summary at the end of the file lists both. A file has no summary if its recorder crashed or was set to write none.
//! Then the file is read through once, up to the byte at which it breaks off.

use super::{
    messages::MessageKind,
    record::{McapRecord, RecordPlace},
    records::RecordReader,
};
use mcap::{
    MAGIC,
    records::{Channel, ChunkIndex, Record, Statistics, op},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::File,
    ops::ControlFlow,
};

/// Bytes of a footer, of its record head, and of the magic bytes at the end of the file.
const FOOTER_BYTES: u64 = 20 + 9 + MAGIC.len() as u64;

/// The topics of a file, and the parts of it with messages.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct McapContents {
    /// Topics by name.
    pub(crate) topics: BTreeMap<String, McapTopic>,
    /// The parts of the file with messages, in the order of the file.
    stretches: Vec<MessageStretch>,
    /// The error at the byte where the file breaks off, if it does. Reading that part again has to give the same error.
    pub(crate) broken: Option<String>,
}

/// A topic that has messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct McapTopic {
    /// `None` if this kind of messages cannot be read.
    pub(crate) kind: Option<MessageKind>,
    /// The name of its messages' type.
    pub(crate) schema: String,
    /// The encoding of its messages: `cdr`, `ros1`, `protobuf`, `json`.
    pub(crate) encoding: String,
    channels: BTreeSet<u16>,
}

/// A part of a file in which messages follow each other.
#[derive(Debug, Clone, PartialEq, Eq)]
struct MessageStretch {
    /// Offsets in the file: of the first byte, and of the byte after the last.
    from: u64,
    to: u64,
    /// `Some` if a chunk has to begin at `from`: the channels with messages in it, or an empty set if they are not listed.
    chunk: Option<BTreeSet<u16>>,
}

/// Channels by id, with their topics.
pub(crate) type TopicChannels<'a> = BTreeMap<u16, (&'a str, MessageKind)>;

/// A message of a wanted channel.
pub(crate) struct TopicMessage<'a> {
    pub(crate) topic: &'a str,
    pub(crate) kind: MessageKind,
    pub(crate) logged_ns: i64,
    pub(crate) place: RecordPlace,
    /// Its bytes; of a picture perhaps only the first of them.
    pub(crate) bytes: &'a [u8],
}

impl McapContents {
    /// Reads the topics of a file, and the places of its messages.
    ///
    /// # Errors
    /// When it cannot be read at all.
    pub(crate) fn from_file(file: &File) -> Result<Self, String> {
        let length = file.metadata().map_err(|error| error.to_string())?.len();
        // If the summary is broken or incomplete, the file is read through instead.
        Self::from_summary(file, length).map_or_else(|| Self::from_records(file, length), Ok)
    }

    /// The contents from the file's summary; `None` if the summary is missing, broken or incomplete.
    fn from_summary(file: &File, length: u64) -> Option<Self> {
        let footer_at = length.checked_sub(FOOTER_BYTES)?;
        let mut start = None;
        let _ = RecordReader::new(file, footer_at, length).ok()?.each_record(&|_| 0, &mut |found| {
            if let Record::Footer(footer) = found.parse_record()? {
                start = Some(footer.summary_start).filter(|start| *start > 0);
            }
            Ok(ControlFlow::Break(()))
        });
        let mut listing = McapListing::default();
        listing.take_records(&mut RecordReader::new(file, start?, footer_at).ok()?).ok()?;
        let McapListing { schemas, channels, chunks, counts: Some(counts), .. } = &listing else { return None };
        let complete = counts.chunk_count > 0
            && counts.chunk_count as usize == chunks.len()
            && counts.channel_count as usize == channels.len()
            && channels.values().all(|channel| channel.schema_id == 0 || schemas.contains_key(&channel.schema_id));
        let end = |chunk: &ChunkIndex| chunk.chunk_start_offset.checked_add(chunk.chunk_length);
        if !complete || !chunks.iter().all(|chunk| end(chunk).is_some_and(|end| end <= length)) {
            return None;
        }
        let counts = &counts.channel_message_counts;
        let topics =
            listing.topics_with(|id| counts.is_empty() || counts.get(id).is_some_and(|messages| *messages > 0));
        let stretch = |chunk: &ChunkIndex| {
            let channels = chunk.message_index_offsets.keys().copied().collect();
            Some(MessageStretch { from: chunk.chunk_start_offset, to: end(chunk)?, chunk: Some(channels) })
        };
        let mut stretches: Vec<MessageStretch> = chunks.iter().filter_map(stretch).collect();
        stretches.sort_by_key(|stretch| stretch.from);
        Some(Self { topics, stretches, broken: None })
    }

    /// The contents by reading through the file.
    fn from_records(file: &File, length: u64) -> Result<Self, String> {
        let from = MAGIC.len() as u64;
        let mut listing = McapListing::default();
        let mut records = RecordReader::new(file, from, length)?;
        let broken = match listing.take_records(&mut records) {
            Ok(()) if records.reached_offset() < length => None,
            Ok(()) => Some(format!(
                "byte {length}: the file breaks off without an end record, as after a crash of its recorder"
            )),
            Err(why) => Some(why),
        };
        let stretches = vec![MessageStretch { from, to: records.reached_offset(), chunk: None }];
        Ok(Self { topics: listing.topics_with(|id| listing.channels_with_messages.contains(id)), stretches, broken })
    }

    /// The channels of some topics.
    pub(crate) fn channels_where(&self, wanted: impl Fn(&str, MessageKind) -> bool) -> TopicChannels<'_> {
        let topics = self.topics.iter().filter_map(|(name, topic)| Some((name.as_str(), topic.kind?, &topic.channels)));
        let wanted = topics.filter(|(name, kind, _)| wanted(name, *kind));
        wanted.flat_map(|(name, kind, channels)| channels.iter().map(move |id| (*id, (name, kind)))).collect()
    }

    /// Hands out the messages of some channels in the order of the file, until `hear` stops it. Errors of a message
    /// include its place.
    ///
    /// # Errors
    /// When the file is broken at another place than [`McapContents::broken`], or `hear` fails.
    pub(crate) fn each_message(
        &self,
        file: &File,
        wanted: &TopicChannels<'_>,
        hear: &mut dyn FnMut(TopicMessage<'_>) -> Result<ControlFlow<()>, String>,
    ) -> Result<(), String> {
        let max_bytes = |id| wanted.get(&id).map_or(0, |(_, kind)| kind.max_indexed_bytes());
        let mut hear = |found: McapRecord<'_>| {
            if found.opcode == op::MESSAGE
                && let Record::Message { header, data } = found.parse_record()?
                && let Some((topic, kind)) = wanted.get(&header.channel_id).copied()
            {
                let logged_ns = i64::try_from(header.log_time).unwrap_or(i64::MAX);
                let message = TopicMessage { topic, kind, logged_ns, place: found.place, bytes: &data };
                return hear(message).map_err(|why| format!("message at {}: {why}", found.place));
            }
            Ok(ControlFlow::Continue(()))
        };
        // A recorder may leave out the index of a chunk's messages.
        let may_hold = |channels: &BTreeSet<u16>| channels.is_empty() || wanted.keys().any(|id| channels.contains(id));
        for MessageStretch { from, to, chunk } in &self.stretches {
            if !chunk.as_ref().is_none_or(may_hold) {
                continue;
            }
            let mut records = RecordReader::new(file, *from, *to)?;
            if chunk.is_some() {
                records.enter_chunk()?;
            }
            match records.each_record(&max_bytes, &mut hear) {
                Ok(ControlFlow::Break(())) => break,
                Ok(ControlFlow::Continue(())) => {}
                Err(why) if self.broken.as_ref() == Some(&why) => {}
                Err(why) => return Err(why),
            }
        }
        Ok(())
    }
}

/// The schemas, channels and chunks that the records of a file list.
#[derive(Default)]
struct McapListing {
    /// Names, by id.
    schemas: BTreeMap<u16, String>,
    channels: BTreeMap<u16, Channel>,
    /// Channels that have messages.
    channels_with_messages: BTreeSet<u16>,
    chunks: Vec<ChunkIndex>,
    counts: Option<Statistics>,
}

impl McapListing {
    /// Takes in all records.
    fn take_records(&mut self, records: &mut RecordReader<'_>) -> Result<(), String> {
        let mut take = |found: McapRecord<'_>| {
            match found.parse_record()? {
                Record::Schema { header, .. } => drop(self.schemas.insert(header.id, header.name)),
                Record::Channel(channel) => {
                    let channel = Channel { metadata: BTreeMap::new(), ..channel };
                    self.channels.insert(channel.id, channel);
                }
                Record::Message { header, .. } => drop(self.channels_with_messages.insert(header.channel_id)),
                Record::ChunkIndex(chunk) => self.chunks.push(chunk),
                Record::Statistics(counts) => self.counts = Some(counts),
                _ => {}
            }
            Ok(ControlFlow::Continue(()))
        };
        records.each_record(&|_| 0, &mut take).map(drop)
    }

    /// The topics of the channels that have messages.
    fn topics_with(&self, has_messages: impl Fn(&u16) -> bool) -> BTreeMap<String, McapTopic> {
        let mut topics = BTreeMap::new();
        for (id, channel) in self.channels.iter().filter(|(id, _)| has_messages(id)) {
            let schema = self.schemas.get(&channel.schema_id).map_or("", String::as_str);
            let encoding = channel.message_encoding.as_str();
            let topic: &mut McapTopic = topics.entry(channel.topic.clone()).or_insert_with(|| McapTopic {
                kind: MessageKind::from_schema(schema).filter(|_| encoding == "cdr"),
                schema: schema.to_owned(),
                encoding: encoding.to_owned(),
                channels: BTreeSet::new(),
            });
            // Several nodes may write to a topic, but channels with another type or encoding than the first are
            // ignored.
            if topic.schema == schema && topic.encoding == encoding {
                topic.channels.insert(*id);
            }
        }
        topics
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_summaries_of_other_programs_are_believed() {
        for name in ["messages_zstd", "odometry_lz4", "odometry_zstd", "poses_zstd", "tree_chunks"] {
            let path = format!("{}/fixtures/mcap/{name}.mcap", env!("CARGO_MANIFEST_DIR"));
            let file = File::open(path).unwrap();
            let length = file.metadata().unwrap().len();
            assert!(McapContents::from_summary(&file, length).is_some(), "{name}");
            assert!(McapContents::from_summary(&file, length - 1).is_none(), "{name} without its last byte");
        }
    }
}
