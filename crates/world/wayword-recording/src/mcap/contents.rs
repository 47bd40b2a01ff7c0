//! What an MCAP file holds: its topics, and where its messages are.
//!
//! The summary at the end tells it. Where there is none, because the recorder crashed or was told to write none, the file is gone
//! through once, up to where it breaks.

use super::{
    messages::Kind,
    records::{CHANNEL, CHUNK, DATA_END, Found, MESSAGE, Records, SCHEMA},
    shape::{fits, summary_fits},
};
use mcap::{
    Summary,
    records::Record,
    sans_io::summary_reader::{SummaryReadEvent, SummaryReader, SummaryReaderOptions},
};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs::File,
    io::{Read, Seek},
};
use wayword_core::contained;

/// Every MCAP file begins with it.
pub(crate) const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";
/// No schema and no list of a chunk's messages is longer.
const MAX_RECORD_BYTES: usize = 64 << 20;

/// What a file holds.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Contents {
    /// By name.
    pub(crate) topics: BTreeMap<String, Topic>,
    /// Where messages are, in the order of the file.
    pub(crate) stretches: Vec<Stretch>,
    /// Where and how the file ends before its end; then the last stretch may.
    pub(crate) broken: Option<String>,
}

/// A topic that has messages.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Topic {
    /// `None` where it is not read here.
    pub(crate) kind: Option<Kind>,
    /// The name of its messages' type.
    pub(crate) schema: String,
    /// How its messages are written: `cdr`, `ros1`, `protobuf`, `json`.
    pub(crate) encoding: String,
    pub(crate) channels: BTreeSet<u16>,
}

/// A part of a file in which messages follow each other.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Stretch {
    /// Outside of chunks.
    Bare { from: u64, to: u64 },
    /// In a chunk.
    Chunk {
        at: u64,
        /// Whose messages are in it, where that is known.
        channels: Option<BTreeSet<u16>>,
    },
}

impl Stretch {
    pub(crate) fn open<'a>(&self, file: &'a File) -> Result<Records<'a>, String> {
        match self {
            Self::Bare { from, to } => Records::in_file(file, *from, *to),
            Self::Chunk { at, .. } => Records::in_chunk(file, *at),
        }
    }

    pub(crate) fn may_hold(&self, channel: u16) -> bool {
        !matches!(self, Self::Chunk { channels: Some(channels), .. } if !channels.contains(&channel))
    }
}

impl Contents {
    /// Finds out what a file holds.
    ///
    /// # Errors
    /// When it is no MCAP file.
    pub(crate) fn of(file: &File) -> Result<Self, String> {
        let length = file.metadata().map_err(|error| error.to_string())?.len();
        // A summary that is broken, or does not tell all, is no reason to give up.
        let summary = contained(|| summary(file, length)).flatten();
        Ok(summary.and_then(|summary| Self::told(&summary, length)).unwrap_or_else(|| Survey::of(file, length)))
    }

    /// What a summary tells; `None` where it is not all.
    fn told(summary: &Summary, length: u64) -> Option<Self> {
        let counts = summary.stats.as_ref()?;
        let complete = counts.chunk_count > 0
            && counts.chunk_count as usize == summary.chunk_indexes.len()
            && counts.channel_count as usize == summary.channels.len();
        let within = summary
            .chunk_indexes
            .iter()
            .all(|chunk| chunk.chunk_start_offset.checked_add(chunk.chunk_length).is_some_and(|end| end <= length));
        if !(complete && within) {
            return None;
        }
        let mut contents = Self::default();
        let channels: BTreeMap<_, _> = summary.channels.iter().collect();
        for (id, channel) in channels {
            let counts = &counts.channel_message_counts;
            if counts.is_empty() || counts.get(id).is_some_and(|messages| *messages > 0) {
                let schema = channel.schema.as_ref().map_or("", |schema| schema.name.as_str());
                contents.add(*id, &channel.topic, schema, &channel.message_encoding);
            }
        }
        contents.stretches = summary
            .chunk_indexes
            .iter()
            .map(|chunk| {
                let channels = chunk.message_index_offsets.keys().copied().collect();
                // A recorder may leave out which messages are in a chunk.
                let channels = (!chunk.message_index_offsets.is_empty()).then_some(channels);
                Stretch::Chunk { at: chunk.chunk_start_offset, channels }
            })
            .collect();
        contents.stretches.sort_by_key(|stretch| match stretch {
            Stretch::Bare { from: at, .. } | Stretch::Chunk { at, .. } => *at,
        });
        Some(contents)
    }

    fn add(&mut self, id: u16, name: &str, schema: &str, encoding: &str) {
        let kind = Kind::of(schema).filter(|_| encoding == "cdr");
        let topic =
            || Topic { kind, schema: schema.to_owned(), encoding: encoding.to_owned(), channels: BTreeSet::new() };
        let topic = self.topics.entry(name.to_owned()).or_insert_with(topic);
        // Several nodes may write to a topic, but not in several languages.
        if topic.schema == schema && topic.encoding == encoding {
            topic.channels.insert(id);
        }
    }
}

/// The summary at the end of a file, if there is one that can be read.
fn summary(mut file: &File, length: u64) -> Option<Summary> {
    if !summary_fits(file, length, MAX_RECORD_BYTES as u64) {
        return None;
    }
    let options = SummaryReaderOptions::default().with_file_size(length).with_record_length_limit(MAX_RECORD_BYTES);
    let mut reader = SummaryReader::new_with_options(options);
    while let Some(event) = reader.next_event() {
        match event.ok()? {
            SummaryReadEvent::ReadRequest(count) => {
                let read = file.read(reader.insert(count)).ok()?;
                reader.notify_read(read);
            }
            SummaryReadEvent::SeekRequest(to) => reader.notify_seeked(file.seek(to).ok()?),
        }
    }
    reader.finish()
}

/// A file that is gone through.
#[derive(Default)]
struct Survey {
    schemas: BTreeMap<u16, String>,
    /// Topic, schema, and how messages are written.
    channels: BTreeMap<u16, (String, u16, String)>,
    /// Those that have messages.
    spoken: BTreeSet<u16>,
    stretches: Vec<Stretch>,
    /// Whether there were any since the last chunk.
    heard: bool,
}

impl Survey {
    fn of(file: &File, length: u64) -> Contents {
        let mut survey = Self::default();
        let broken = survey.walk(file, length).err();
        let mut contents = Contents { stretches: survey.stretches, broken, ..Contents::default() };
        for (id, (topic, schema, encoding)) in &survey.channels {
            if survey.spoken.contains(id) {
                let schema = survey.schemas.get(schema).map_or("", String::as_str);
                contents.add(*id, topic, schema, encoding);
            }
        }
        contents
    }

    fn walk(&mut self, file: &File, length: u64) -> Result<(), String> {
        let begin = MAGIC.len() as u64;
        let mut at = begin;
        // Again behind each chunk: who reads in it has moved the file's cursor.
        loop {
            let mut records = Records::in_file(file, at, length)?;
            let from = at;
            let chunk = loop {
                let Some(found) = records.next().inspect_err(|_| self.bare(from, at))? else {
                    self.bare(from, length);
                    return Err(format!("byte {length}: the file has no end, as if its recorder had crashed"));
                };
                at = from + found.at;
                match found.opcode {
                    DATA_END => {
                        self.bare(from, at);
                        return Ok(());
                    }
                    CHUNK => break at,
                    _ => self.take(found, &mut records).inspect_err(|_| self.bare(from, at))?,
                }
                at = from + records.behind();
            };
            self.bare(from, chunk);
            at = from + records.behind();
            self.chunk(file, chunk)?;
        }
    }

    fn bare(&mut self, from: u64, to: u64) {
        // Behind chunks there are lists of what is in them.
        if std::mem::take(&mut self.heard) {
            self.stretches.push(Stretch::Bare { from, to });
        }
    }

    fn chunk(&mut self, file: &File, at: u64) -> Result<(), String> {
        self.stretches.push(Stretch::Chunk { at, channels: None });
        let mut records = Records::in_chunk(file, at)?;
        while let Some(found) = records.next()? {
            self.take(found, &mut records)?;
        }
        self.heard = false;
        Ok(())
    }

    fn take(&mut self, found: Found, records: &mut Records<'_>) -> Result<(), String> {
        match found.opcode {
            MESSAGE => {
                self.spoken.insert(records.message()?.channel);
                self.heard = true;
            }
            SCHEMA | CHANNEL => {
                let mut body = Vec::new();
                records.body(MAX_RECORD_BYTES as u64, &mut body)?;
                if !fits(found.opcode, &body) {
                    return Err(format!("{}: a length in the record leads out of it", records.place(found.at)));
                }
                let parsed = contained(|| {
                    mcap::parse_record(found.opcode, &body).map(Record::into_owned).map_err(|error| error.to_string())
                });
                let parsed = parsed.unwrap_or_else(|| Err("is broken".to_owned()));
                match parsed.map_err(|why| format!("{}: {why}", records.place(found.at)))? {
                    Record::Schema { header, .. } => drop(self.schemas.insert(header.id, header.name)),
                    Record::Channel(channel) => {
                        let told = (channel.topic, channel.schema_id, channel.message_encoding);
                        self.channels.insert(channel.id, told);
                    }
                    _ => {}
                }
            }
            _ => {}
        }
        Ok(())
    }
}
