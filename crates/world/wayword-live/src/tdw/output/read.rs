//! Reads output data from the bytes of a frame, one function per kind of frame.

use super::{
    super::flatbuffer_reader::{FlatBufferError, FlatBufferTable},
    AvatarImages, AvatarPose, AvatarSensor, BuildOutput, NavMeshPath, OnNavMesh, OutputError, PicturePass,
    SegmentedObject, TdwCameraMatrices, TdwObjectBounds, TdwObjectTransform, TdwOccupancyMap, TdwRegion, VersionOutput,
};

/// The id of a frame: bytes 4 to 8, a FlatBuffer's file identifier.
pub(in super::super) fn frame_id(frame: &[u8]) -> Option<[u8; 4]> {
    frame.get(4..)?.first_chunk().copied()
}

impl<'a> BuildOutput<'a> {
    /// Reads a frame.
    ///
    /// # Errors
    /// Where its bytes do not fit its id.
    pub fn read(frame: &'a [u8]) -> Result<Self, OutputError> {
        let id = frame_id(frame).ok_or(OutputError {
            id: String::new(),
            source: FlatBufferError { at: 4, expected: "an id of four letters" },
        })?;
        Self::for_id(id, frame).map_err(|source| OutputError { id: id.escape_ascii().to_string(), source })
    }

    /// Reads a frame that has this id.
    fn for_id(id: [u8; 4], frame: &'a [u8]) -> Result<Self, FlatBufferError> {
        let table = || FlatBufferTable::root_table(frame);
        Ok(match &id {
            b"imag" => Self::Images(read_images(&table()?)?),
            b"segm" => Self::Segmentation(read_segments(&table()?)?),
            b"path" => Self::Path(read_path(&table()?)?),
            b"sreg" => Self::Regions(read_regions(&table()?)?),
            b"occu" => Self::Occupancy(read_occupancy(&table()?)?),
            b"avki" => Self::Avatar(read_avatar(&table()?)?),
            b"tran" => Self::Transforms(read_transforms(&table()?)?),
            b"boun" => Self::Bounds(read_bounds(&table()?)?),
            b"cate" => Self::Categories(read_categories(&table()?)?),
            b"cama" => Self::Camera(read_camera(&table()?)?),
            b"imse" => read_sensors(&table()?)?,
            b"isnm" => Self::OnNavMesh(read_on_nav_mesh(&table()?)?),
            b"quit" => Self::Quit(table()?.read_bool(0)?),
            b"vers" => Self::Version(read_version(frame)?),
            b"ftre" => Self::FailedToReceive,
            _ => Self::Other(id),
        })
    }
}

/// Checks that a vector has the length that fits the vectors it belongs to.
fn check_length(
    (table, slot): (&FlatBufferTable<'_>, usize),
    count: usize,
    fitting: usize,
    expected: &'static str,
) -> Result<(), FlatBufferError> {
    if count == fitting { Ok(()) } else { Err(table.field_error(slot, expected)) }
}

/// A colour as three bytes; an error that names the field if a channel is out of range.
fn byte_colour((table, slot): (&FlatBufferTable<'_>, usize), rgb: [i32; 3]) -> Result<[u8; 3], FlatBufferError> {
    let byte = |channel: i32| u8::try_from(channel).map_err(|_| table.field_error(slot, "colour channels of 0 to 255"));
    let [red, green, blue] = rgb;
    Ok([byte(red)?, byte(green)?, byte(blue)?])
}

fn read_images<'a>(table: &FlatBufferTable<'a>) -> Result<AvatarImages<'a>, FlatBufferError> {
    let side = |slot| {
        let side = table.read_i32(slot, 0)?;
        u32::try_from(side).map_err(|_| table.field_error(slot, "a picture's width and height"))
    };
    let pass = |pass: FlatBufferTable<'a>| {
        Ok(PicturePass { mask: pass.read_i32(0, 1)?, bytes: pass.read_bytes(1)?, extension: pass.read_u8(2, 1)? })
    };
    Ok(AvatarImages {
        avatar: table.read_text(0)?,
        sensor: table.read_text(1)?,
        width: side(2)?,
        height: side(3)?,
        passes: table.read_tables(4)?.into_iter().map(pass).collect::<Result<_, _>>()?,
    })
}

fn read_segments<'a>(table: &FlatBufferTable<'a>) -> Result<Vec<SegmentedObject<'a>>, FlatBufferError> {
    let (ids, names, categories) = (table.read_i32s(0)?, table.read_texts(1)?, table.read_texts(2)?);
    let colours = table.read_i32s(3)?;
    check_length((table, 1), names.len(), ids.len(), "a name for each id")?;
    check_length((table, 2), categories.len(), ids.len(), "a category for each id")?;
    check_length((table, 3), colours.len(), 3 * ids.len(), "three colour channels for each id")?;
    let rows = ids.into_iter().zip(names).zip(categories).zip(colours.as_chunks::<3>().0);
    rows.map(|(((id, name), category), rgb)| {
        Ok(SegmentedObject { id, name, category, colour: byte_colour((table, 3), *rgb)? })
    })
    .collect()
}

fn read_path(table: &FlatBufferTable<'_>) -> Result<NavMeshPath, FlatBufferError> {
    let raw = table.read_bytes(0)?;
    let (corners, rest) = raw.as_chunks::<12>();
    check_length((table, 0), rest.len(), 0, "a path of whole points of 12 bytes")?;
    let corners = corners.iter().map(|point| little_endian_floats(point)).collect();
    Ok(NavMeshPath { corners, state: table.read_u8(1, 1)?, id: table.read_i32(2, 0)? })
}

/// `N` little-endian numbers; zeros beyond the bytes' end.
fn little_endian_floats<const N: usize>(bytes: &[u8]) -> [f32; N] {
    let mut numbers = [0.0; N];
    for (number, word) in numbers.iter_mut().zip(bytes.as_chunks().0) {
        *number = f32::from_le_bytes(*word);
    }
    numbers
}

fn read_regions(table: &FlatBufferTable<'_>) -> Result<Vec<TdwRegion>, FlatBufferError> {
    let raw = table.read_vector(0, 28)?.raw_bytes();
    let region = |region: &[u8; 28]| {
        let [id, x, y, z, w, h, d] = little_endian_floats(region);
        TdwRegion { id: id.to_bits().cast_signed(), centre: [x, y, z], size: [w, h, d] }
    };
    Ok(raw.as_chunks().0.iter().map(region).collect())
}

fn read_occupancy(table: &FlatBufferTable<'_>) -> Result<TdwOccupancyMap, FlatBufferError> {
    let expected = "a shape of two sides";
    let &[columns, rows] = table.read_i32s(2)?.as_slice() else { return Err(table.field_error(2, expected)) };
    let side = |side: i32| usize::try_from(side).map_err(|_| table.field_error(2, expected));
    let (rows, columns) = (side(rows)?, side(columns)?);
    let cells: Vec<i8> = table.read_bytes(0)?.iter().map(|cell| cell.cast_signed()).collect();
    check_length((table, 0), cells.len(), rows.saturating_mul(columns), "as many cells as the shape has")?;
    let positions = table.read_f32s(1)?.as_chunks().0.to_vec();
    check_length((table, 1), positions.len(), cells.len(), "a position for each cell")?;
    Ok(TdwOccupancyMap { shape: [rows, columns], cells, positions })
}

fn read_avatar<'a>(table: &FlatBufferTable<'a>) -> Result<AvatarPose<'a>, FlatBufferError> {
    Ok(AvatarPose {
        id: table.read_text(0)?,
        position: table.read_floats(1)?,
        rotation: table.read_floats(2)?,
        forward: table.read_floats(3)?,
    })
}

fn read_transforms(table: &FlatBufferTable<'_>) -> Result<Vec<TdwObjectTransform>, FlatBufferError> {
    let (ids, positions) = (table.read_i32s(0)?, table.read_f32s(1)?);
    let (rotations, forwards) = (table.read_f32s(2)?, table.read_f32s(3)?);
    check_length((table, 1), positions.len(), 3 * ids.len(), "a position for each id")?;
    check_length((table, 2), rotations.len(), 4 * ids.len(), "a rotation for each id")?;
    check_length((table, 3), forwards.len(), 3 * ids.len(), "a direction for each id")?;
    let rows = ids.into_iter().zip(positions.as_chunks().0).zip(rotations.as_chunks().0).zip(forwards.as_chunks().0);
    let transforms = rows.map(|(((id, position), rotation), forward)| TdwObjectTransform {
        id,
        position: *position,
        rotation: *rotation,
        forward: *forward,
    });
    Ok(transforms.collect())
}

fn read_bounds(table: &FlatBufferTable<'_>) -> Result<Vec<TdwObjectBounds>, FlatBufferError> {
    let (ids, numbers) = (table.read_i32s(0)?, table.read_f32s(1)?);
    check_length((table, 1), numbers.len(), 21 * ids.len(), "seven points for each id")?;
    let points = numbers.as_chunks::<3>().0.as_chunks::<7>().0;
    Ok(ids.into_iter().zip(points).map(|(id, points)| TdwObjectBounds { id, points: *points }).collect())
}

fn read_categories<'a>(table: &FlatBufferTable<'a>) -> Result<Vec<(&'a str, [u8; 3])>, FlatBufferError> {
    let read_category = |category: FlatBufferTable<'a>| {
        Ok((category.read_text(1)?, byte_colour((&category, 0), category.three_i32(0)?)?))
    };
    table.read_tables(0)?.into_iter().map(read_category).collect()
}

fn read_camera<'a>(table: &FlatBufferTable<'a>) -> Result<TdwCameraMatrices<'a>, FlatBufferError> {
    let matrix = |slot| {
        let numbers = table.read_f32s(slot)?;
        numbers.try_into().map_err(|_| table.field_error(slot, "a matrix of 16 numbers"))
    };
    Ok(TdwCameraMatrices {
        avatar: table.read_text(0)?,
        sensor: table.read_text(1)?,
        projection: matrix(2)?,
        camera: matrix(3)?,
    })
}

fn read_sensors<'a>(table: &FlatBufferTable<'a>) -> Result<BuildOutput<'a>, FlatBufferError> {
    let read_sensor = |sensor: FlatBufferTable<'a>| {
        Ok(AvatarSensor {
            name: sensor.read_text(0)?,
            is_on: sensor.read_bool(1)?,
            rotation: sensor.read_floats(2)?,
            forward: sensor.read_floats(3)?,
            field_of_view_deg: sensor.read_f32(4)?,
        })
    };
    let sensors = table.read_tables(1)?.into_iter().map(read_sensor).collect::<Result<_, _>>()?;
    Ok(BuildOutput::Sensors(table.read_text(0)?, sensors))
}

fn read_on_nav_mesh(table: &FlatBufferTable<'_>) -> Result<OnNavMesh, FlatBufferError> {
    let position = table.read_f32s(0)?;
    let position = position.try_into().map_err(|_| table.field_error(0, "a position of three numbers"))?;
    Ok(OnNavMesh { position, is_on: table.read_bool(1)?, id: table.read_i32(2, 0)? })
}

/// From 1.13 on the version is not a FlatBuffer, although its id is the same. It is a flag, a length and two texts.
fn read_version(frame: &[u8]) -> Result<VersionOutput<'_>, FlatBufferError> {
    if let Some(version) = plain_version(frame) {
        return Ok(version);
    }
    let table = FlatBufferTable::root_table(frame)?;
    Ok(VersionOutput { unity: table.read_text(0)?, tdw: table.read_text(1)?, standalone: table.read_bool(2)? })
}

/// The version in the layout from 1.13 on; `None` if the frame does not have it.
fn plain_version(frame: &[u8]) -> Option<VersionOutput<'_>> {
    let [standalone @ 0..=1, length, texts @ ..] = frame.get(8..)? else { return None };
    let (tdw, unity) = texts.split_at_checked(usize::from(*length))?;
    let is_printed = !tdw.is_empty() && texts.iter().all(u8::is_ascii_graphic);
    let text = |bytes| std::str::from_utf8(bytes).ok();
    is_printed.then_some(())?;
    Some(VersionOutput { tdw: text(tdw)?, unity: text(unity)?, standalone: *standalone == 1 })
}
