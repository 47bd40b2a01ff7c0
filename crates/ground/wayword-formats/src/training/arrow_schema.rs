//! The Arrow schema in the foot of a Parquet file that pyarrow wrote, with the two columns of language added.
//!
//! pyarrow keeps the types that Parquet cannot tell, such as lists of a fixed size, under the key `ARROW:schema`. A
//! copy of the file with two more columns needs a schema with two more fields: without a schema, those types are lost,
//! and one with too few fields is passed over.
//!
//! The text is base64 of a message: a marker, a length, and a flatbuffer. A flatbuffer names its parts by how far ahead
//! they lie. So no part of the old schema has to be understood or written anew: a new front is put before the old
//! bytes, and its list of fields points ahead into them and into the bytes of the language's fields behind them.

use base64::{Engine as _, engine::general_purpose::STANDARD};

/// A longer text is refused. pyarrow's schemas have about 200 characters for each column.
const MOST_TEXT: usize = 16 << 20;
/// More fields are refused.
const MOST_FIELDS: usize = 100_000;
/// What a message begins with. Messages from before 2019 begin with their length.
const MARKER: u32 = u32::MAX;
/// The kind of message that holds a schema.
const SCHEMA_KIND: u8 = 1;
/// Where the places of the fields begin in the new front, in bytes.
const FRONT: usize = 60;
/// A flatbuffer's values lie at multiples of their size, and none is larger than this. Bytes that move by a multiple of
/// it stay in their right places.
const ALIGNMENT: usize = 8;
/// A schema with only the language's fields (`arrow_schema_language.py` writes it).
const LANGUAGE: &[u8] = include_bytes!("arrow_schema_language.bin");

/// The `ARROW:schema` of a file with the two columns of language behind its own; `None` if the text is no such schema.
///
/// The schema's own notes are left out: they tell of the old columns only. Those of its fields stay. The fields are not
/// checked inside, so a schema that no reader could read before is not mended.
#[must_use]
pub(super) fn with_language_fields(arrow_schema_base64: &str) -> Option<String> {
    if arrow_schema_base64.len() > MOST_TEXT {
        return None;
    }
    let message = STANDARD.decode(arrow_schema_base64).ok()?;
    let joined = joined(&Schema::read(&message)?, &Schema::read(LANGUAGE)?)?;
    Some(STANDARD.encode(joined))
}

/// A flatbuffer from elsewhere: whatever lies outside it, or is left out of it, is `None`.
#[derive(Clone, Copy)]
struct Flatbuffer<'a>(&'a [u8]);

impl Flatbuffer<'_> {
    fn bytes<const N: usize>(self, at: usize) -> Option<[u8; N]> {
        self.0.get(at..)?.first_chunk().copied()
    }

    fn u16(self, at: usize) -> Option<u16> {
        self.bytes(at).map(u16::from_le_bytes)
    }

    fn u32(self, at: usize) -> Option<u32> {
        self.bytes(at).map(u32::from_le_bytes)
    }

    /// The place that is pointed to from here: always ahead.
    fn target(self, at: usize) -> Option<usize> {
        at.checked_add(usize::try_from(self.u32(at)?).ok()?)
    }

    /// The list in which a table keeps where its members lie. It may lie before the table or behind it.
    fn members_of(self, table: usize) -> Option<usize> {
        let back = i32::from_le_bytes(self.bytes(table)?);
        let distance = usize::try_from(back.unsigned_abs()).ok()?;
        if back < 0 { table.checked_add(distance) } else { table.checked_sub(distance) }
    }

    /// Where the table's member of this number lies.
    fn member(self, table: usize, number: usize) -> Option<usize> {
        let members = self.members_of(table)?;
        let entry = 4 + 2 * number;
        if entry + 2 > usize::from(self.u16(members)?) {
            return None;
        }
        let offset = usize::from(self.u16(members.checked_add(entry)?)?);
        if offset == 0 { None } else { table.checked_add(offset) }
    }

    /// The places of the tables in a list of tables. Each must be a table as far as its first bytes tell.
    fn tables(self, list: usize) -> Option<Vec<usize>> {
        let count = usize::try_from(self.u32(list)?).ok()?;
        if count > MOST_FIELDS {
            return None;
        }
        let table = |index| {
            let table = self.target(list.checked_add(4 + 4 * index)?)?;
            self.u16(self.members_of(table)?).map(|_| table)
        };
        (0..count).map(table).collect()
    }
}

/// What the new front takes over from an old message.
struct Schema<'a> {
    /// The flatbuffer of the message.
    flatbuffer: &'a [u8],
    /// The version of the format.
    version: u16,
    /// The order of bytes in the columns.
    byte_order: u16,
    /// Where the list of features lies, if there is one.
    features: Option<usize>,
    /// Where the fields' tables lie.
    fields: Vec<usize>,
}

impl<'a> Schema<'a> {
    /// Reads a message: the numbers of the members are those of `Message.fbs` and `Schema.fbs`.
    fn read(message: &'a [u8]) -> Option<Self> {
        let whole = Flatbuffer(message);
        let start = if whole.u32(0)? == MARKER { 8 } else { 4 };
        let length = usize::try_from(whole.u32(start - 4)?).ok()?;
        let flatbuffer = message.get(start..)?.get(..length)?;
        let reader = Flatbuffer(flatbuffer);
        // A number that is left out is 0.
        let number = |table, member| reader.member(table, member).map_or(Some(0), |at| reader.u16(at));
        let message = reader.target(0)?;
        let [kind] = reader.bytes(reader.member(message, 1)?)?;
        if kind != SCHEMA_KIND {
            return None;
        }
        let schema = reader.target(reader.member(message, 2)?)?;
        let features = match reader.member(schema, 3) {
            Some(at) => Some(reader.target(at).filter(|list| reader.u32(*list).is_some())?),
            None => None,
        };
        Some(Self {
            flatbuffer,
            version: number(message, 0)?,
            byte_order: number(schema, 0)?,
            features,
            fields: reader.tables(reader.target(reader.member(schema, 1)?)?)?,
        })
    }
}

/// The message with the fields of both: a new front, the old flatbuffer and the language's.
fn joined(old: &Schema<'_>, language: &Schema<'_>) -> Option<Vec<u8>> {
    let count = old.fields.len() + language.fields.len();
    let old_start = (FRONT + 4 * count).next_multiple_of(ALIGNMENT);
    let language_start = (old_start + old.flatbuffer.len()).next_multiple_of(ALIGNMENT);
    let end = (language_start + language.flatbuffer.len()).next_multiple_of(ALIGNMENT);

    let mut message = Vec::with_capacity(8 + end);
    put_u32(&mut message, &[MARKER, u32::try_from(end).ok()?]);
    put_front(&mut message, old, old_start)?;
    put_u32(&mut message, &[u32::try_from(count).ok()?]);
    let old_fields = old.fields.iter().map(|at| old_start + at);
    let targets = old_fields.chain(language.fields.iter().map(|at| language_start + at));
    for (target, place) in targets.zip((FRONT..).step_by(4)) {
        put_u32(&mut message, &[ahead(place, target)?]);
    }
    for (start, part) in [(old_start, old.flatbuffer), (language_start, language.flatbuffer)] {
        message.resize(8 + start, 0);
        message.extend_from_slice(part);
    }
    message.resize(8 + end, 0);
    Some(message)
}

/// Writes the tables of the message and of the schema, each behind its list of members, up to the list of fields.
fn put_front(message: &mut Vec<u8>, old: &Schema<'_>, old_start: usize) -> Option<()> {
    let (features_member, features) = match old.features {
        Some(at) => (8, ahead(48, old_start + at)?),
        None => (0, 0),
    };
    // 0: where the message's table is. 4: its members: their length, the table's, where version, kind and schema are.
    put_u32(message, &[16]);
    put_u16(message, &[10, 12, 8, 10, 4, 0]);
    // 16: the message's table: how far back its members are, how far ahead the schema is, the version, the kind.
    put_u32(message, &[12, 20]);
    put_u16(message, &[old.version, u16::from(SCHEMA_KIND)]);
    // 28: the schema's members: their length, the table's, where the order of bytes, fields, notes and features are.
    put_u16(message, &[12, 16, 12, 4, 0, features_member]);
    // 40: the schema's table: how far back its members are, how far ahead fields and features are, the order of bytes.
    put_u32(message, &[12, 12, features]);
    put_u16(message, &[old.byte_order, 0]);
    Some(())
}

/// How far `target` lies ahead of `place`.
fn ahead(place: usize, target: usize) -> Option<u32> {
    u32::try_from(target.checked_sub(place)?).ok()
}

fn put_u16(bytes: &mut Vec<u8>, values: &[u16]) {
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

fn put_u32(bytes: &mut Vec<u8>, values: &[u32]) {
    bytes.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `action`, lists of two numbers, and `timestamp`, with a note, in a schema with a note `huggingface`.
    const EXAMPLE: &str = concat!(
        "/////2ABAAAQAAAAAAAKAA4ABgAFAAgACgAAAAABBAAQAAAAAAAKAAwAAAAEAAgACgAAADQAAAAEAAAAAQAAAAQAAACI////EAAA",
        "AAQAAAACAAAAe30AAAsAAABodWdnaW5nZmFjZQACAAAAgAAAABgAAAAAABIAGAAIAAYABwAMAAAAEAAUABIAAAAAAAEDFAAAAFAA",
        "AAAIAAAAGAAAAAAAAAAJAAAAdGltZXN0YW1wAAAAAQAAAAwAAAAIAAwABAAIAAgAAAAQAAAABAAAAAEAAABzAAAABAAAAHVuaXQA",
        "AAAAjv///wAAAQDI////AAABEBQAAAAkAAAABAAAAAEAAAAwAAAABgAAAGFjdGlvbgAAAAAGAAgABAAGAAAAAgAAABAAFAAIAAYA",
        "BwAMAAAAEAAQAAAAAAABAxAAAAAcAAAABAAAAAAAAAAEAAAAaXRlbQAABgAIAAYABgAAAAAAAQAAAAAA",
    );

    fn names(message: &[u8]) -> Vec<String> {
        let schema = Schema::read(message).unwrap();
        let reader = Flatbuffer(schema.flatbuffer);
        let name = |field: &usize| {
            let text = reader.target(reader.member(*field, 0)?)?;
            let length = usize::try_from(reader.u32(text)?).ok()?;
            String::from_utf8(schema.flatbuffer.get(text + 4..)?.get(..length)?.to_vec()).ok()
        };
        schema.fields.iter().map(|field| name(field).unwrap()).collect()
    }

    #[test]
    fn the_fields_of_language_stand_behind_the_old_ones() {
        let told = with_language_fields(EXAMPLE).unwrap();
        let message = STANDARD.decode(&told).unwrap();
        assert_eq!(names(&message), ["action", "timestamp", "language_persistent", "language_events"]);
        let (old, new) = (STANDARD.decode(EXAMPLE).unwrap(), Schema::read(&message).unwrap());
        let old = Schema::read(&old).unwrap();
        assert_eq!((new.version, new.byte_order, new.features), (old.version, old.byte_order, old.features));
        let notes = |schema: &Schema<'_>| {
            let reader = Flatbuffer(schema.flatbuffer);
            let table = reader.target(reader.member(reader.target(0)?, 2)?)?;
            reader.member(table, 2)
        };
        assert!(notes(&old).is_some() && notes(&new).is_none());
        // What is written can be read and added to in turn.
        assert_eq!(names(&STANDARD.decode(with_language_fields(&told).unwrap()).unwrap()).len(), 6);
        assert_eq!(names(LANGUAGE), ["language_persistent", "language_events"]);
    }

    #[test]
    fn features_and_the_order_of_bytes_stay() {
        let mut schema = Schema { flatbuffer: &[0; 24], version: 3, byte_order: 1, features: Some(12), fields: vec![] };
        for (given, told) in [(Some(12), Some(72 + 12)), (None, None)] {
            schema.features = given;
            let message = joined(&schema, &Schema::read(LANGUAGE).unwrap()).unwrap();
            let new = Schema::read(&message).unwrap();
            assert_eq!((new.version, new.byte_order, new.features, new.fields.len()), (3, 1, told, 2));
        }
    }

    #[test]
    fn other_texts_are_refused() {
        let message = STANDARD.decode(EXAMPLE).unwrap();
        let mut batch = message.clone();
        assert_eq!(std::mem::replace(&mut batch[8 + 21], 3), SCHEMA_KIND);
        let cut = (0..message.len()).map(|length| message[..length].to_vec());
        for bytes in cut.chain([batch, vec![0; 64], vec![255; 64], b"PAR1".to_vec()]) {
            assert_eq!(with_language_fields(&STANDARD.encode(&bytes)), None, "{bytes:?}");
        }
        for text in ["", "no base64", "{}", "\u{e9}", "/////w=="] {
            assert_eq!(with_language_fields(text), None, "{text}");
        }
        assert_eq!(with_language_fields(&"A".repeat(MOST_TEXT + 4)), None);
        // Messages from before 2019 have no marker.
        assert_eq!(with_language_fields(&STANDARD.encode(&message[4..])), with_language_fields(EXAMPLE));
    }

    #[test]
    fn too_many_fields_are_refused() {
        let told = |count: usize| {
            let mut many = Schema::read(LANGUAGE).unwrap();
            many.fields = many.fields.iter().copied().cycle().take(count).collect();
            let message = joined(&many, &Schema { fields: vec![], ..Schema::read(LANGUAGE).unwrap() }).unwrap();
            with_language_fields(&STANDARD.encode(message))
        };
        assert!(told(MOST_FIELDS).is_some());
        assert_eq!(told(MOST_FIELDS + 1), None);
    }

    #[test]
    fn damaged_texts_do_no_harm() {
        let message = STANDARD.decode(EXAMPLE).unwrap();
        let mut state = 1_u64;
        let mut random = |below: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            usize::try_from(state >> 33).unwrap() % below
        };
        for _ in 0..20_000 {
            let mut damaged = message.clone();
            for _ in 0..=random(4) {
                // Mostly in the front, where the places stand.
                let most = [64, message.len()][random(2)];
                let at = random(most);
                damaged[at] = [0, 1, 4, 127, 128, 255, u8::try_from(random(256)).unwrap()][random(7)];
            }
            if let Some(told) = with_language_fields(&STANDARD.encode(&damaged)) {
                let (old, new) = (Schema::read(&damaged).unwrap(), STANDARD.decode(told).unwrap());
                let new = Schema::read(&new).unwrap();
                assert_eq!(new.fields.len(), old.fields.len() + 2);
            }
        }
    }
}
