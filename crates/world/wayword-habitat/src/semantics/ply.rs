//! Reads Matterport3D's `*_semantic.ply`: a mesh with an object's number on each face. Binary and little-endian, as in
//! Habitat's files.
//!
//! `ply-rs-bw` reads the header and one entry after the other. The number of entries is checked against the bytes that
//! are left, so that a file cannot use more memory than a multiple of its own length.

use glam::Vec3;
use ply_rs_bw::{
    parser::{ParseError, Parser, Reader},
    ply::{Encoding, Header, Property, PropertyAccess, PropertyAccessResult},
};
use std::io::ErrorKind;
use wayword_core::contain_panics::run_decoder;

/// Longest header, bytes; a longer one is an error.
const MAX_HEADER_BYTES: usize = 1 << 14;

/// Triangles with the number of their object.
#[derive(Debug, Default, PartialEq)]
pub(super) struct SemanticFaces {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<([u32; 3], u32)>,
}

/// The contents of a vertex or a face; of a vertex only the position is set, of a face only the other fields.
struct PlyEntry {
    position: Vec3,
    corners: Vec<u32>,
    object: u32,
}

/// Parses the whole file, and checks that the faces' vertices exist.
pub(super) fn parse_faces(bytes: &[u8]) -> Result<SemanticFaces, String> {
    run_decoder(|| {
        let faces = read_faces(bytes)?;
        let vertices = faces.positions.len();
        let mut corners = faces.triangles.iter().flat_map(|(corners, _)| corners);
        match corners.find(|corner| **corner as usize >= vertices) {
            Some(corner) => Err(format!("a face has the vertex {corner}, expected below {vertices}")),
            None => Ok(faces),
        }
    })
}

fn read_faces(bytes: &[u8]) -> Result<SemanticFaces, String> {
    let (header, mut rest) = read_header(bytes)?;
    let parser = Parser::<PlyEntry>::new();
    let mut faces = SemanticFaces::default();
    for element in header.elements.values() {
        // Every entry takes at least one byte, so there cannot be more entries than bytes.
        if element.properties.is_empty() || element.count > rest.len() {
            return Err(format!(
                "element {:.40}: the file is too short for a count of {}",
                element.name, element.count
            ));
        }
        for _ in 0..element.count {
            let at = bytes.len() - rest.len();
            let entry = parser.read_little_endian_element(&mut rest, element).map_err(|error| match error.kind() {
                ErrorKind::UnexpectedEof => format!("byte {at}: the file is cut off"),
                _ => format!("byte {at}: {}", brief_message(&error)),
            })?;
            match element.name.as_str() {
                "vertex" => faces.positions.push(entry.position),
                "face" => {
                    let fan = entry.corners.get(1..).unwrap_or_default().windows(2);
                    let triangle = |pair: &[u32]| {
                        let (a, [b, c]) = (entry.corners.first()?, pair.first_chunk::<2>()?);
                        Some(([*a, *b, *c], entry.object))
                    };
                    faces.triangles.extend(fan.filter_map(triangle));
                }
                _ => {}
            }
        }
    }
    Ok(faces)
}

/// The header, and the bytes after it.
fn read_header(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    let within = bytes.get(..MAX_HEADER_BYTES).unwrap_or(bytes);
    let mut reader = Reader::new(within);
    let header = Parser::<PlyEntry>::new().read_header(&mut reader);
    let header = header.map_err(|error| format!("has no header of a PLY file: {}", brief_message(&error)))?;
    if header.encoding != Encoding::BinaryLittleEndian {
        return Err("is not a binary little-endian PLY file".to_owned());
    }
    let (text, rest) = bytes.split_at(within.len() - reader.into_inner().len());
    // If two have the same name, the reader keeps only the last and would misread all later bytes.
    let lines = |word: &[u8]| text.split(|byte| *byte == b'\n').filter(|line| line.starts_with(word)).count();
    let properties: usize = header.elements.values().map(|element| element.properties.len()).sum();
    if lines(b"element") != header.elements.len() || lines(b"property") != properties {
        return Err("its header uses a name twice".to_owned());
    }
    Ok((header, rest))
}

/// The first line of the reader's message; the next one quotes the header, which may be very long.
fn brief_message(error: &ParseError) -> String {
    error.to_string().lines().next().unwrap_or_default().chars().take(200).collect()
}

impl PropertyAccess for PlyEntry {
    fn new() -> Self {
        Self { position: Vec3::ZERO, corners: Vec::new(), object: u32::MAX }
    }

    fn set_property(&mut self, name: &str, value: Property) -> PropertyAccessResult {
        let is_known = match name {
            "x" => value.to_f32_lossy().map(|x| self.position.x = x),
            "y" => value.to_f32_lossy().map(|y| self.position.y = y),
            "z" => value.to_f32_lossy().map(|z| self.position.z = z),
            "vertex_indices" | "vertex_index" => value.to_u32_list().map(|corners| self.corners = corners),
            // -1, which means no object, becomes a number that no object has.
            "object_id" => whole_number(&value).map(|id| self.object = u32::try_from(id).unwrap_or(u32::MAX)),
            _ => return PropertyAccessResult::Ignored,
        };
        if is_known.is_some() { PropertyAccessResult::Set } else { PropertyAccessResult::UnsupportedType }
    }
}

/// The value of a property that is a single whole number.
fn whole_number(property: &Property) -> Option<i64> {
    Some(match *property {
        Property::Char(number) => number.into(),
        Property::UChar(number) => number.into(),
        Property::Short(number) => number.into(),
        Property::UShort(number) => number.into(),
        Property::Int(number) => number.into(),
        Property::UInt(number) => number.into(),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn square() -> Vec<u8> {
        let mut file =
            b"ply\nformat binary_little_endian 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty float y\n\
            property float z\nproperty uchar red\nelement face 1\nproperty list uchar int vertex_indices\n\
            property ushort object_id\nend_header\n"
                .to_vec();
        for (x, y) in [(0.0_f32, 0.0_f32), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            file.extend([x, y, 2.5].iter().flat_map(|number| number.to_le_bytes()));
            file.push(7);
        }
        file.push(4);
        file.extend([0_i32, 1, 2, 3].iter().flat_map(|number| number.to_le_bytes()));
        file.extend(300_u16.to_le_bytes());
        file
    }

    #[test]
    fn faces_become_triangles_that_name_their_object() {
        let faces = parse_faces(&square()).unwrap();
        assert_eq!(faces.positions[2], Vec3::new(1.0, 1.0, 2.5));
        assert_eq!(faces.triangles, [([0, 1, 2], 300), ([0, 2, 3], 300)]);
    }

    #[test]
    fn parse_refuses_cut_and_foreign_ply_files() {
        let cut = square();
        assert!(parse_faces(&cut[..cut.len() - 1]).unwrap_err().contains("the file is cut off"));
        let many = String::from_utf8_lossy(&square()[..60]).replace("vertex 4", "vertex 999999999");
        assert!(parse_faces(many.as_bytes()).unwrap_err().contains("no header"));
        assert!(parse_faces(b"ply\nformat ascii 1.0\nend_header\n").unwrap_err().contains("not a binary"));
    }

    proptest! {
        #[test]
        fn ply_reader_survives_any_bytes(at in 0usize..400, with: [u8; 2]) {
            let mut file = square();
            let at = at % file.len();
            for (byte, new) in file.iter_mut().skip(at).zip(with) {
                *byte = new;
            }
            let _ = parse_faces(&file);
        }
    }
}
