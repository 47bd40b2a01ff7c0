//! Reads output data from the bytes of a frame, one function per kind of frame.

use super::{
    super::flat::{Misread, Table},
    Avatar, Bounds, Camera, Images, NavMeshPath, Occupancy, OnNavMesh, Output, OutputError, Pass, Region, Segment,
    Sensor, Transform, Version,
};

/// The id of a frame: bytes 4 to 8, a FlatBuffer's file identifier.
pub(in super::super) fn id_of(frame: &[u8]) -> Option<[u8; 4]> {
    frame.get(4..)?.first_chunk().copied()
}

impl<'a> Output<'a> {
    /// Reads a frame.
    ///
    /// # Errors
    /// Where its bytes do not fit its id.
    pub fn read(frame: &'a [u8]) -> Result<Self, OutputError> {
        let id = id_of(frame)
            .ok_or(OutputError { id: String::new(), source: Misread { at: 4, expected: "an id of four letters" } })?;
        Self::of(id, frame).map_err(|source| OutputError { id: id.escape_ascii().to_string(), source })
    }

    fn of(id: [u8; 4], frame: &'a [u8]) -> Result<Self, Misread> {
        let table = || Table::root(frame);
        Ok(match &id {
            b"imag" => Self::Images(images(&table()?)?),
            b"segm" => Self::Segmentation(segments(&table()?)?),
            b"path" => Self::Path(path(&table()?)?),
            b"sreg" => Self::Regions(regions(&table()?)?),
            b"occu" => Self::Occupancy(occupancy(&table()?)?),
            b"avki" => Self::Avatar(avatar(&table()?)?),
            b"tran" => Self::Transforms(transforms(&table()?)?),
            b"boun" => Self::Bounds(bounds(&table()?)?),
            b"cate" => Self::Categories(categories(&table()?)?),
            b"cama" => Self::Camera(camera(&table()?)?),
            b"imse" => sensors(&table()?)?,
            b"isnm" => Self::OnNavMesh(on_nav_mesh(&table()?)?),
            b"quit" => Self::Quit(table()?.bool(0)?),
            b"vers" => Self::Version(version(frame)?),
            b"ftre" => Self::FailedToReceive,
            _ => Self::Other(id),
        })
    }
}

/// Checks that a vector has the length that fits the vectors it belongs to.
fn has_length(
    (table, slot): (&Table<'_>, usize),
    count: usize,
    fitting: usize,
    expected: &'static str,
) -> Result<(), Misread> {
    if count == fitting { Ok(()) } else { Err(table.misfit(slot, expected)) }
}

fn colour((table, slot): (&Table<'_>, usize), rgb: [i32; 3]) -> Result<[u8; 3], Misread> {
    if rgb.iter().all(|channel| (0..256).contains(channel)) {
        Ok(rgb.map(|channel| channel as u8))
    } else {
        Err(table.misfit(slot, "colour channels of 0 to 255"))
    }
}

fn images<'a>(table: &Table<'a>) -> Result<Images<'a>, Misread> {
    let side = |slot| {
        let side = table.i32(slot, 0)?;
        u32::try_from(side).map_err(|_| table.misfit(slot, "a picture's width and height"))
    };
    let pass = |pass: Table<'a>| Ok(Pass { mask: pass.i32(0, 1)?, bytes: pass.bytes(1)?, extension: pass.u8(2, 1)? });
    Ok(Images {
        avatar: table.text(0)?,
        sensor: table.text(1)?,
        width: side(2)?,
        height: side(3)?,
        passes: table.tables(4)?.into_iter().map(pass).collect::<Result<_, _>>()?,
    })
}

fn segments<'a>(table: &Table<'a>) -> Result<Vec<Segment<'a>>, Misread> {
    let (ids, names, categories) = (table.i32s(0)?, table.texts(1)?, table.texts(2)?);
    let colours = table.i32s(3)?;
    has_length((table, 1), names.len(), ids.len(), "a name for each id")?;
    has_length((table, 2), categories.len(), ids.len(), "a category for each id")?;
    has_length((table, 3), colours.len(), 3 * ids.len(), "three colour channels for each id")?;
    let rows = ids.into_iter().zip(names).zip(categories).zip(colours.as_chunks::<3>().0);
    rows.map(|(((id, name), category), rgb)| Ok(Segment { id, name, category, colour: colour((table, 3), *rgb)? }))
        .collect()
}

fn path(table: &Table<'_>) -> Result<NavMeshPath, Misread> {
    let raw = table.bytes(0)?;
    let (corners, rest) = raw.as_chunks::<12>();
    has_length((table, 0), rest.len(), 0, "a path of whole points of 12 bytes")?;
    let corners = corners.iter().map(|point| floats(point)).collect();
    Ok(NavMeshPath { corners, state: table.u8(1, 1)?, id: table.i32(2, 0)? })
}

/// `N` little-endian numbers; zeros beyond the bytes' end.
fn floats<const N: usize>(bytes: &[u8]) -> [f32; N] {
    let mut numbers = [0.0; N];
    for (number, word) in numbers.iter_mut().zip(bytes.as_chunks().0) {
        *number = f32::from_le_bytes(*word);
    }
    numbers
}

fn regions(table: &Table<'_>) -> Result<Vec<Region>, Misread> {
    let raw = table.vector(0, 28)?.raw();
    let region = |region: &[u8; 28]| {
        let [id, x, y, z, w, h, d] = floats(region);
        Region { id: id.to_bits() as i32, centre: [x, y, z], size: [w, h, d] }
    };
    Ok(raw.as_chunks().0.iter().map(region).collect())
}

fn occupancy(table: &Table<'_>) -> Result<Occupancy, Misread> {
    let expected = "a shape of two sides";
    let [columns, rows] = table.i32s(2)?[..] else { return Err(table.misfit(2, expected)) };
    let side = |side: i32| usize::try_from(side).map_err(|_| table.misfit(2, expected));
    let shape = [side(rows)?, side(columns)?];
    let cells: Vec<i8> = table.bytes(0)?.iter().map(|cell| *cell as i8).collect();
    has_length((table, 0), cells.len(), shape[0].saturating_mul(shape[1]), "as many cells as the shape has")?;
    let positions = table.f32s(1)?.as_chunks().0.to_vec();
    has_length((table, 1), positions.len(), cells.len(), "a position for each cell")?;
    Ok(Occupancy { shape, cells, positions })
}

fn avatar<'a>(table: &Table<'a>) -> Result<Avatar<'a>, Misread> {
    Ok(Avatar { id: table.text(0)?, position: table.floats(1)?, rotation: table.floats(2)?, forward: table.floats(3)? })
}

fn transforms(table: &Table<'_>) -> Result<Vec<Transform>, Misread> {
    let (ids, positions) = (table.i32s(0)?, table.f32s(1)?);
    let (rotations, forwards) = (table.f32s(2)?, table.f32s(3)?);
    has_length((table, 1), positions.len(), 3 * ids.len(), "a position for each id")?;
    has_length((table, 2), rotations.len(), 4 * ids.len(), "a rotation for each id")?;
    has_length((table, 3), forwards.len(), 3 * ids.len(), "a direction for each id")?;
    let (positions, rotations) = (positions.as_chunks().0, rotations.as_chunks().0);
    let transform = |(index, id)| Transform {
        id,
        position: positions[index],
        rotation: rotations[index],
        forward: forwards.as_chunks().0[index],
    };
    Ok(ids.into_iter().enumerate().map(transform).collect())
}

fn bounds(table: &Table<'_>) -> Result<Vec<Bounds>, Misread> {
    let (ids, numbers) = (table.i32s(0)?, table.f32s(1)?);
    has_length((table, 1), numbers.len(), 21 * ids.len(), "seven points for each id")?;
    let points = numbers.as_chunks::<3>().0.as_chunks::<7>().0;
    Ok(ids.into_iter().zip(points).map(|(id, points)| Bounds { id, points: *points }).collect())
}

fn categories<'a>(table: &Table<'a>) -> Result<Vec<(&'a str, [u8; 3])>, Misread> {
    let one = |category: Table<'a>| Ok((category.text(1)?, colour((&category, 0), category.three_i32(0)?)?));
    table.tables(0)?.into_iter().map(one).collect()
}

fn camera<'a>(table: &Table<'a>) -> Result<Camera<'a>, Misread> {
    let matrix = |slot| {
        let numbers = table.f32s(slot)?;
        numbers.try_into().map_err(|_| table.misfit(slot, "a matrix of 16 numbers"))
    };
    Ok(Camera { avatar: table.text(0)?, sensor: table.text(1)?, projection: matrix(2)?, camera: matrix(3)? })
}

fn sensors<'a>(table: &Table<'a>) -> Result<Output<'a>, Misread> {
    let one = |sensor: Table<'a>| {
        Ok(Sensor {
            name: sensor.text(0)?,
            is_on: sensor.bool(1)?,
            rotation: sensor.floats(2)?,
            forward: sensor.floats(3)?,
            field_of_view_deg: sensor.f32(4)?,
        })
    };
    let sensors = table.tables(1)?.into_iter().map(one).collect::<Result<_, _>>()?;
    Ok(Output::Sensors(table.text(0)?, sensors))
}

fn on_nav_mesh(table: &Table<'_>) -> Result<OnNavMesh, Misread> {
    let position = table.f32s(0)?;
    let position = position.try_into().map_err(|_| table.misfit(0, "a position of three numbers"))?;
    Ok(OnNavMesh { position, is_on: table.bool(1)?, id: table.i32(2, 0)? })
}

/// From 1.13 on the version is not a FlatBuffer, although its id is the same. It is a flag, a length and two texts.
fn version(frame: &[u8]) -> Result<Version<'_>, Misread> {
    if let Some(version) = plain_version(frame) {
        return Ok(version);
    }
    let table = Table::root(frame)?;
    Ok(Version { unity: table.text(0)?, tdw: table.text(1)?, standalone: table.bool(2)? })
}

fn plain_version(frame: &[u8]) -> Option<Version<'_>> {
    let [standalone @ 0..=1, length, texts @ ..] = frame.get(8..)? else { return None };
    let (tdw, unity) = texts.split_at_checked(usize::from(*length))?;
    let is_printed = !tdw.is_empty() && texts.iter().all(u8::is_ascii_graphic);
    let text = |bytes| std::str::from_utf8(bytes).ok();
    is_printed.then_some(())?;
    Some(Version { tdw: text(tdw)?, unity: text(unity)?, standalone: *standalone == 1 })
}
