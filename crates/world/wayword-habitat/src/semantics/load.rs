//! Reads the semantic files of a scene: a mesh that is painted in the colours of its objects, or one with numbered faces.

use super::{
    SceneSemantics, SemanticThing,
    broken_lines::describe_broken_lines,
    hm3d, house,
    paint::{PaintTally, TrianglePaint},
    ply,
    rooms::NumberedRooms,
};
use crate::{
    axes::wayword_from_habitat,
    file_error::{self, FileError},
    scene::{EXPORT_HINT, SceneModel},
};
use glam::{DMat3, UVec2, Vec2, Vec3};
use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};
use wayword_core::{RoomNames, SceneLack};
use wayword_render::{Mesh, MeshMaterial, RenderScene, Texture, TextureFilter};

/// Largest list of objects and largest mesh that are read, bytes; larger ones are errors.
const MAX_TEXT_BYTES: u64 = 64 << 20;
const MAX_MESH_BYTES: u64 = 4 << 30;
const HM3D_HINT: &str =
    "put HM3D's own .semantic.glb and .semantic.txt beside the scene, or neither to go without labels";
const MATTERPORT_HINT: &str =
    "put Matterport3D's own _semantic.ply and .house beside the scene, or neither to go without labels";

/// The id of triangles with painted textures: their objects follow from the colours in the picture.
pub(super) const PAINTED_ID: u32 = u32::MAX;

/// The semantic files of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct SemanticFiles {
    /// HM3D's painted mesh, and the file that maps colours to objects.
    pub(crate) painted: Option<(PathBuf, PathBuf)>,
    /// Matterport3D's mesh with numbered faces, and the file that maps numbers to objects.
    pub(crate) numbered: Option<(PathBuf, PathBuf)>,
}

/// Reads the files; `None` if a scene has none.
pub(crate) fn load_semantics(
    files: &SemanticFiles,
    habitat_from_asset: DMat3,
) -> Result<Option<SceneSemantics>, FileError> {
    if let Some((mesh, text)) = &files.painted {
        return load_painted(mesh, text, habitat_from_asset).map(Some);
    }
    match &files.numbered {
        Some((mesh, text)) => load_numbered(mesh, text, habitat_from_asset).map(Some),
        None => Ok(None),
    }
}

/// What the files offer to a run.
#[derive(Debug, PartialEq)]
pub(crate) struct SemanticFindings {
    pub(crate) has_labels: bool,
    pub(crate) rooms: RoomNames,
    /// The warning about lines that cannot be read.
    pub(crate) broken_lines: Option<String>,
    /// The fault in the labels.
    pub(crate) lack: Option<SceneLack>,
}

/// Reads the files as [`load_semantics`] does, and returns what they offer; `None` if a scene has none.
pub(crate) fn check_semantics(
    files: &SemanticFiles,
    habitat_from_asset: DMat3,
) -> Result<Option<SemanticFindings>, FileError> {
    let rooms = if files.painted.is_some() { RoomNames::Rules } else { RoomNames::Dataset };
    let loaded = load_semantics(files, habitat_from_asset)?;
    Ok(loaded.map(|SceneSemantics { has_labels, broken_lines, lack, .. }| SemanticFindings {
        has_labels,
        broken_lines,
        rooms: if has_labels { rooms } else { RoomNames::Unknown },
        lack,
    }))
}

fn read_text(file: &Path, hint: &'static str) -> Result<String, FileError> {
    file_error::text_if_there(file, MAX_TEXT_BYTES, hint)?
        .ok_or_else(|| FileError::new(file, "there is no such file", hint))
}

/// Reads HM3D's files. The colour of a triangle's texture, or of its vertices, gives its thing.
fn load_painted(mesh: &Path, annotations: &Path, habitat_from_asset: DMat3) -> Result<SceneSemantics, FileError> {
    let hm3d::Hm3dAnnotations { mut things, by_colour, broken_lines } =
        hm3d::parse_annotations(&read_text(annotations, HM3D_HINT)?)
            .map_err(|reason| FileError::new(annotations, reason, HM3D_HINT))?;
    // Nobody can export again what was downloaded.
    let hint_for = |error: &FileError| if error.hint == EXPORT_HINT { HM3D_HINT } else { error.hint };
    let model = SceneModel::read_file(mesh, habitat_from_asset)
        .map_err(|error| FileError { hint: hint_for(&error), ..error })?;
    let (mut meshes, mut shells, mut tally) = (Vec::new(), Vec::new(), PaintTally::default());
    for each in model.meshes {
        let texture = model.materials.get(each.material).and_then(|material| material.texture);
        let texture = texture.and_then(|texture| model.textures.get(texture));
        let paint = |corners: [u32; 3]| match texture {
            Some(texture) => texel_at(texture, uv_middle(&each.uvs, corners)).map(TrianglePaint::from_texel),
            // The vertices are painted: a triangle belongs to the object of its first corner.
            None => {
                let [first, ..] = corners;
                each.colours.get(first as usize).copied().map(TrianglePaint::from_vertex)
            }
        };
        let mut thing = |corners: [u32; 3]| {
            let paint = paint(corners)?;
            tally.count(paint, &by_colour);
            by_colour.get(&paint.colour).copied()
        };
        let owned_triangles: Vec<OwnedTriangle> =
            each.triangles.iter().map(|corners| (*corners, thing(*corners))).collect();
        measure_things(&each.positions, &owned_triangles, &mut things);
        shells.extend(shell_triangles(&each.positions, &owned_triangles, &things));
        match texture {
            Some(_) => meshes.push(Mesh { id: PAINTED_ID, colours: Vec::new(), ..each }),
            None => {
                let parts = meshes_by_thing(&each.positions, &owned_triangles);
                meshes.extend(parts.map_err(|reason| FileError::new(mesh, reason, HM3D_HINT))?);
            }
        }
    }
    // The picture must have the colours of the file, so no material may change them.
    let bare = |material: MeshMaterial| MeshMaterial { base_colour: [1.0; 4], ..material };
    let mut materials: Vec<MeshMaterial> = model.materials.into_iter().map(bare).collect();
    materials.push(MeshMaterial::default());
    let plain = materials.len() - 1;
    for each in meshes.iter_mut().filter(|each| each.id != PAINTED_ID) {
        each.material = plain;
    }
    let scene = RenderScene::new(meshes, materials, model.textures);
    let scene = scene.map_err(|error| FileError::new(mesh, error.to_string(), HM3D_HINT))?;
    let rooms = NumberedRooms::from_things(&things, shells);
    Ok(SceneSemantics {
        scene: scene.with_filter(TextureFilter::Nearest),
        by_colour,
        things,
        regions: Vec::new(),
        rooms,
        has_labels: tally.knows_any(),
        lists_objects: tally.knows_most(),
        broken_lines: describe_broken_lines(annotations, &broken_lines),
        lack: tally.lack(mesh, annotations),
    })
}

/// Reads Matterport3D's files. The number of a face gives its thing.
fn load_numbered(mesh: &Path, house: &Path, habitat_from_asset: DMat3) -> Result<SceneSemantics, FileError> {
    let house::MatterportHouse { mut things, by_number, regions, broken_lines } =
        house::parse_house(&read_text(house, MATTERPORT_HINT)?)
            .map_err(|reason| FileError::new(house, reason, MATTERPORT_HINT))?;
    let wrong = |reason: String| FileError::new(mesh, reason, MATTERPORT_HINT);
    let faces = ply::parse_faces(&file_error::read_bytes(mesh, MAX_MESH_BYTES, MATTERPORT_HINT)?).map_err(wrong)?;
    let place = |position: &Vec3| wayword_from_habitat(habitat_from_asset * position.as_dvec3()).as_vec3();
    let positions: Vec<Vec3> = faces.positions.iter().map(place).collect();
    let thing = |object: u32| by_number.get(&object).copied();
    let owned_triangles: Vec<OwnedTriangle> =
        faces.triangles.iter().map(|(corners, object)| (*corners, thing(*object))).collect();
    measure_things(&positions, &owned_triangles, &mut things);
    let lists_objects = owned_triangles.iter().any(|(_, thing)| thing.is_some());
    let meshes = meshes_by_thing(&positions, &owned_triangles).map_err(wrong)?;
    // Scans are seen only from inside, and the winding of their faces is not reliable.
    let material = MeshMaterial { double_sided: true, ..MeshMaterial::default() };
    let scene = RenderScene::new(meshes, vec![material], Vec::new()).map_err(|error| wrong(error.to_string()))?;
    Ok(SceneSemantics {
        scene,
        by_colour: BTreeMap::new(),
        things,
        regions,
        rooms: NumberedRooms::default(),
        has_labels: true,
        lists_objects,
        broken_lines: describe_broken_lines(house, &broken_lines),
        lack: (!lists_objects).then(|| SceneLack {
            what: format!("no face of {} belongs to an object of {}", mesh.display(), house.display()),
            hint: "put the .house beside the mesh that came with it to have objects".to_owned(),
        }),
    })
}

/// A triangle and the thing that it belongs to.
type OwnedTriangle = ([u32; 3], Option<usize>);

/// Extends the boxes of things to contain their triangles.
fn measure_things(positions: &[Vec3], owned_triangles: &[OwnedTriangle], things: &mut [SemanticThing]) {
    for (corners, thing) in owned_triangles {
        if let Some(thing) = thing.and_then(|thing| things.get_mut(thing)) {
            let places = corners.iter().filter_map(|corner| positions.get(*corner as usize));
            places.for_each(|place| thing.include_place(place.as_dvec3()));
        }
    }
}

/// The triangles of floors, stairs and ceilings of numbered rooms, each with the index of its thing.
fn shell_triangles(
    positions: &[Vec3],
    owned_triangles: &[OwnedTriangle],
    things: &[SemanticThing],
) -> Vec<([Vec3; 3], u32)> {
    let place = |corner: u32| positions.get(corner as usize).copied().unwrap_or_default();
    let is_shell = |thing: usize| things.get(thing).is_some_and(|thing| thing.part.is_some() && thing.room.is_some());
    let owned_triangles = owned_triangles.iter().filter_map(|(corners, thing)| Some((corners, (*thing)?)));
    owned_triangles
        .filter(|(_, thing)| is_shell(*thing))
        .filter_map(|(corners, thing)| Some((corners.map(place), u32::try_from(thing).ok()?)))
        .collect()
}

/// The id of a thing in drawn pictures: its index plus 1, or 0 for no thing. A list of [`MAX_TEXT_BYTES`] bytes cannot have more
/// things than there are ids.
pub(super) fn picture_id(thing: Option<usize>) -> u32 {
    thing.and_then(|thing| u32::try_from(thing).ok()?.checked_add(1)).unwrap_or(0)
}

/// One mesh for each thing, with the thing's id.
///
/// # Errors
/// If a thing has more corners than a mesh may have.
fn meshes_by_thing(positions: &[Vec3], owned_triangles: &[OwnedTriangle]) -> Result<Vec<Mesh>, String> {
    let mut parts: BTreeMap<u32, Mesh> = BTreeMap::new();
    for (corners, thing) in owned_triangles {
        let id = picture_id(*thing);
        let part = parts.entry(id).or_insert_with(|| Mesh { id, ..Mesh::default() });
        let end = u32::try_from(part.positions.len() + 3)
            .map_err(|_| format!("one object has more than {} triangles", part.triangles.len()))?;
        part.positions.extend(corners.map(|corner| positions.get(corner as usize).copied().unwrap_or_default()));
        part.triangles.push([end - 3, end - 2, end - 1]);
    }
    Ok(parts.into_values().collect())
}

/// The texture coordinates in the middle of a triangle.
fn uv_middle(uvs: &[Vec2], corners: [u32; 3]) -> Vec2 {
    corners.iter().filter_map(|corner| uvs.get(*corner as usize)).copied().sum::<Vec2>() / 3.0
}

/// The texel at texture coordinates.
fn texel_at(texture: &Texture, uv: Vec2) -> Option<[u8; 3]> {
    let size = UVec2::new(texture.width, texture.height);
    let place = ((uv - uv.floor()) * size.as_vec2()).as_uvec2().min(size.saturating_sub(UVec2::ONE));
    let index = place.y as usize * texture.width as usize + place.x as usize;
    let [red, green, blue, _] = *texture.texels.get(index)?;
    Some([red, green, blue])
}
