//! `*_semantic.ply` of Matterport3D: a mesh whose faces name objects. Binary, little-endian, as Habitat's files are.

use glam::Vec3;

/// Longest header, bytes.
const MAX_HEADER: usize = 1 << 14;

/// Triangles with the number of their object.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Faces {
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<([u32; 3], u32)>,
}

/// A property: its name, the type of its entries, and for a list the type of its length.
struct Property {
    name: String,
    kind: Kind,
    length: Option<Kind>,
}

#[derive(Clone, Copy)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

pub(super) fn parse(bytes: &[u8]) -> Result<Faces, String> {
    let (elements, at) = header(bytes)?;
    let mut body = Body { bytes, at };
    let mut faces = Faces::default();
    for element in &elements {
        // Every entry takes at least a byte: more of them than bytes cannot be.
        if element.properties.is_empty() || element.count > body.bytes.len() - body.at {
            return Err(format!("{} entries of {} do not fit into the file", element.count, element.name));
        }
        for _ in 0..element.count {
            match element.name.as_str() {
                "vertex" => faces.positions.push(body.vertex(element)?),
                "face" => body.face(element, &mut faces)?,
                _ => body.skip(element)?,
            }
        }
    }
    let vertices = faces.positions.len();
    let astray = faces.triangles.iter().flat_map(|(corners, _)| corners).find(|corner| **corner as usize >= vertices);
    astray.map_or(Ok(()), |corner| Err(format!("a face names vertex {corner} of {vertices}")))?;
    Ok(faces)
}

fn header(bytes: &[u8]) -> Result<(Vec<Element>, usize), String> {
    let end = b"end_header\n";
    let within = &bytes[..bytes.len().min(MAX_HEADER)];
    let at =
        within.windows(end.len()).position(|window| window == end).ok_or("has no header of a PLY file")? + end.len();
    let text = std::str::from_utf8(&bytes[..at]).map_err(|_| "its header is no text")?;
    if !text.starts_with("ply") || !text.contains("format binary_little_endian") {
        return Err("is no binary little-endian PLY file".to_owned());
    }
    let mut elements: Vec<Element> = Vec::new();
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match (words.as_slice(), elements.last_mut()) {
            (["element", name, count], _) => {
                let count = count.parse().map_err(|_| format!("{count:.20?} is no count"))?;
                elements.push(Element { name: (*name).to_owned(), count, properties: Vec::new() });
            }
            (["property", "list", length, kind, name], Some(element)) => {
                let length = Some(Kind::of(length)?);
                element.properties.push(Property { name: (*name).to_owned(), kind: Kind::of(kind)?, length });
            }
            (["property", kind, name], Some(element)) => {
                element.properties.push(Property { name: (*name).to_owned(), kind: Kind::of(kind)?, length: None });
            }
            _ => {}
        }
    }
    Ok((elements, at))
}

impl Kind {
    fn of(word: &str) -> Result<Self, String> {
        Ok(match word {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return Err(format!("{word:.20?} is no type of PLY")),
        })
    }
}

struct Body<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Body<'_> {
    fn array<const N: usize>(&mut self) -> Result<[u8; N], String> {
        let taken = self.bytes.get(self.at..).and_then(|rest| rest.first_chunk::<N>());
        let array = *taken.ok_or_else(|| format!("byte {}: the file is cut off", self.at))?;
        self.at += N;
        Ok(array)
    }

    fn number(&mut self, kind: Kind) -> Result<f64, String> {
        Ok(match kind {
            Kind::I8 => f64::from(i8::from_le_bytes(self.array()?)),
            Kind::U8 => f64::from(u8::from_le_bytes(self.array()?)),
            Kind::I16 => f64::from(i16::from_le_bytes(self.array()?)),
            Kind::U16 => f64::from(u16::from_le_bytes(self.array()?)),
            Kind::I32 => f64::from(i32::from_le_bytes(self.array()?)),
            Kind::U32 => f64::from(u32::from_le_bytes(self.array()?)),
            Kind::F32 => f64::from(f32::from_le_bytes(self.array()?)),
            Kind::F64 => f64::from_le_bytes(self.array()?),
        })
    }

    /// The numbers of a property: one, or those of a list.
    fn numbers(&mut self, property: &Property) -> Result<Vec<f64>, String> {
        let count = match property.length {
            None => 1,
            Some(kind) => self.number(kind)?.max(0.0) as usize,
        };
        if count > self.bytes.len() - self.at {
            return Err(format!("byte {}: a list of {count} entries does not fit into the file", self.at));
        }
        (0..count).map(|_| self.number(property.kind)).collect()
    }

    fn skip(&mut self, element: &Element) -> Result<(), String> {
        element.properties.iter().try_for_each(|property| self.numbers(property).map(|_| ()))
    }

    fn vertex(&mut self, element: &Element) -> Result<Vec3, String> {
        let mut position = Vec3::ZERO;
        for property in &element.properties {
            let numbers = self.numbers(property)?;
            let axis = ["x", "y", "z"].iter().position(|name| *name == property.name);
            if let (Some(axis), Some(number)) = (axis, numbers.first()) {
                position[axis] = *number as f32;
            }
        }
        Ok(position)
    }

    fn face(&mut self, element: &Element, faces: &mut Faces) -> Result<(), String> {
        let (mut corners, mut object) = (Vec::new(), u32::MAX);
        for property in &element.properties {
            let numbers = self.numbers(property)?;
            match (property.name.as_str(), numbers.first()) {
                ("vertex_indices" | "vertex_index", _) => {
                    corners = numbers.iter().map(|number| *number as u32).collect();
                }
                // Casts saturate; -1, which is no object, becomes one that nobody has.
                ("object_id", Some(number)) if *number >= 0.0 => object = *number as u32,
                _ => {}
            }
        }
        let fan = corners.get(1..).unwrap_or_default().windows(2);
        faces.triangles.extend(fan.map(|pair| ([corners[0], pair[0], pair[1]], object)));
        Ok(())
    }
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
        let faces = parse(&square()).unwrap();
        assert_eq!(faces.positions[2], Vec3::new(1.0, 1.0, 2.5));
        assert_eq!(faces.triangles, [([0, 1, 2], 300), ([0, 2, 3], 300)]);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let cut = square();
        assert!(parse(&cut[..cut.len() - 1]).unwrap_err().contains("the file is cut off"));
        let many = String::from_utf8_lossy(&square()[..60]).replace("vertex 4", "vertex 999999999");
        assert!(parse(many.as_bytes()).unwrap_err().contains("no header"));
        assert!(parse(b"ply\nformat ascii 1.0\nend_header\n").unwrap_err().contains("no binary"));
    }

    proptest! {
        #[test]
        fn no_bytes_make_the_reader_fall_over(at in 0usize..400, with: [u8; 2]) {
            let mut file = square();
            let at = at % file.len();
            for (byte, new) in file.iter_mut().skip(at).zip(with) {
                *byte = new;
            }
            let _ = parse(&file);
        }
    }
}
