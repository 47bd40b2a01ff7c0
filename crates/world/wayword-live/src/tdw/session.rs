//! The sequences of commands for one task each: load a scene, survey it, find a way, take a picture.

use super::{
    commands::{BuildCommand, SendFrequency, TdwQuaternion, TdwVector3},
    controller::{BuildResponse, TdwController},
    error::TdwError,
    output::{BuildOutput, NavMeshPath, OnNavMesh, SegmentedObject, TdwObjectBounds, TdwOccupancyMap},
    pictures::{self, PassKind},
};
use crate::{
    labels::{ObjectPalette, SimulatorObject, colour_id},
    live::{SimulatorShot, SimulatorShotKind, SimulatorSurvey},
    path_sampling::EYE_M,
    raster::FloorRaster,
    unity::{unity_from_wayword, unity_rotation_from_heading, wayword_from_unity},
};
use std::collections::BTreeMap;
use wayword_core::{DVec3, Heading};
use wayword_render::PinholeCamera;

/// The avatar that looks.
const AVATAR_ID: &str = "a";
/// Side of the occupancy map's cells, metres: two fit into a narrow door.
const CELL_M: f64 = 0.25;
/// Height from which the map looks down for obstacles, metres: below ceilings.
const RAYCAST_M: f64 = 2.5;
/// How far a place may be from the navmesh to count as on it, metres.
const SNAP_M: f64 = 0.5;
/// Most commands in one list.
const MAX_BATCH_COMMANDS: usize = 256;

/// Loads a scene and puts the avatar into it.
pub(super) fn load_scene(
    controller: &mut TdwController,
    mut commands: Vec<BuildCommand>,
    (width, height): (u32, u32),
) -> Result<(), TdwError> {
    commands.extend([
        BuildCommand::SetScreenSize { width, height },
        BuildCommand::CreateAvatar { kind: "A_Img_Caps_Kinematic", id: AVATAR_ID.to_owned() },
        BuildCommand::SetImgPassEncoding { value: true },
    ]);
    controller.communicate(&commands).map(drop)
}

/// Asks where the objects are, and where one can walk.
pub(super) fn survey_scene(controller: &mut TdwController) -> Result<SimulatorSurvey, TdwError> {
    let (ids, frequency) = (Vec::new(), SendFrequency::Once);
    let answer = controller.communicate(&[
        BuildCommand::SendSegmentationColors { ids: ids.clone(), frequency },
        BuildCommand::SendBounds { ids, frequency },
        BuildCommand::SendOccupancyMap { cell_size: CELL_M, raycast_y: RAYCAST_M },
    ])?;
    let raster = answer.first_output("occu", "send_occupancy_map", |output| match output {
        BuildOutput::Occupancy(map) => Some(raster_from_map(&map)),
        _ => None,
    })?;
    let unusable = || {
        TdwError::Scene("the build's occupancy map has no usable cells; the scene's floor may not be at y = 0".into())
    };
    let mut raster = raster.ok_or_else(unusable)?;
    raster.keep_largest_part();
    let eyes = eyes_on_navmesh(controller, &raster.viewpoint_places())?;
    let graph = raster.viewpoint_graph(&eyes).map_err(|error| TdwError::Scene(error.to_string()))?;
    // The build's regions have boxes, but no names.
    Ok(SimulatorSurvey {
        graph,
        raster,
        palette: palette_from_response(&answer)?,
        rooms: Vec::new(),
        thresholds: Vec::new(),
    })
}

/// The floor raster of an occupancy map; `None` if the map has no usable cells.
fn raster_from_map(map: &TdwOccupancyMap) -> Option<FloorRaster> {
    let floor = |[x, z]: [f32; 2]| [f64::from(x), f64::from(z)];
    let cells: Vec<_> = map.positions.iter().zip(&map.cells).map(|(at, cell)| (floor(*at), *cell == 0)).collect();
    FloorRaster::from_cells(&cells, CELL_M)
}

/// Objects by their colours. An object without a box is left out, because its place is not known.
fn palette_from_response(answer: &BuildResponse) -> Result<ObjectPalette, TdwError> {
    let bounds = answer.first_output("boun", "send_bounds", |output| match output {
        BuildOutput::Bounds(bounds) => Some(bounds),
        _ => None,
    })?;
    let segments = answer.first_output("segm", "send_segmentation_colors", |output| match output {
        BuildOutput::Segmentation(segments) => Some(segments),
        _ => None,
    })?;
    let by_id: BTreeMap<i32, TdwObjectBounds> = bounds.into_iter().map(|each| (each.id, each)).collect();
    let thing = |segment: &SegmentedObject<'_>| {
        let points = by_id.get(&segment.id)?.points.map(|point| wayword_from_unity(point.map(f64::from)));
        let [front, _, right, _, top, _, centre] = points;
        let name = if segment.category.is_empty() { segment.name } else { segment.category };
        let thing =
            SimulatorObject::new(segment.id.into(), name, centre, [front - centre, right - centre, top - centre])?;
        Some((colour_id(segment.colour), thing))
    };
    Ok(segments.iter().filter_map(thing).collect())
}

/// Eye positions above those of the places that are on the navmesh.
fn eyes_on_navmesh(controller: &mut TdwController, places: &[[f64; 2]]) -> Result<Vec<DVec3>, TdwError> {
    let mut eyes = Vec::new();
    for batch in places.chunks(MAX_BATCH_COMMANDS) {
        let ask = |(id, [x, y]): (usize, &[f64; 2])| BuildCommand::SendIsOnNavMesh {
            position: unity_vector(DVec3::new(*x, *y, 0.0)),
            max_distance: SNAP_M,
            id: id as i32,
        };
        let commands: Vec<BuildCommand> = batch.iter().enumerate().map(ask).collect();
        let answer = controller.communicate(&commands)?;
        let mut found: Vec<Option<f64>> = vec![None; batch.len()];
        for output in answer.read_outputs() {
            if let BuildOutput::OnNavMesh(OnNavMesh { id, is_on: true, position }) = output?
                && let Some(height) = usize::try_from(id).ok().and_then(|id| found.get_mut(id))
            {
                *height = Some(f64::from(position[1])).filter(|height| height.is_finite());
            }
        }
        let above = batch.iter().zip(found).filter_map(|([x, y], height)| Some(DVec3::new(*x, *y, height? + EYE_M)));
        eyes.extend(above);
    }
    Ok(eyes)
}

/// The corners of the way between two eye positions, all at eye height; `None` where the navmesh has no way.
pub(super) fn navmesh_way(
    controller: &mut TdwController,
    from: DVec3,
    to: DVec3,
) -> Result<Option<Vec<DVec3>>, TdwError> {
    let [origin, destination] = [from, to].map(|eye| unity_vector(eye - DVec3::Z * EYE_M));
    let answer = controller.communicate(&[BuildCommand::SendNavMeshPath { origin, destination, id: 0 }])?;
    let path = answer.first_output("path", "send_nav_mesh_path", |output| match output {
        BuildOutput::Path(path) => Some(path),
        _ => None,
    })?;
    let NavMeshPath { corners, state: 1, .. } = path else { return Ok(None) };
    let eye = |corner: [f32; 3]| wayword_from_unity(corner.map(f64::from)) + DVec3::Z * EYE_M;
    let way: Vec<DVec3> = corners.into_iter().map(eye).collect();
    Ok(Some(way).filter(|way| way.len() >= 2 && way.iter().all(|corner| corner.is_finite())))
}

/// Takes a picture through a camera of the size that the scene was loaded with. If `is_camera_set` is true, the camera is
/// already set to send exactly the `wanted` passes.
pub(super) fn take_picture(
    controller: &mut TdwController,
    camera: &PinholeCamera,
    (wanted, is_camera_set): (SimulatorShotKind, bool),
) -> Result<SimulatorShot, TdwError> {
    let size = (camera.width, camera.height);
    let avatar_id = || AVATAR_ID.to_owned();
    let heading = Heading::new(camera.heading_rad).unwrap_or(Heading::NORTH);
    let [x, y, z, w] = unity_rotation_from_heading(heading);
    let field_of_view = camera.vertical_fov_rad.to_degrees();
    let passes: &[PassKind] = match wanted {
        SimulatorShotKind::Picture => &[PassKind::Img, PassKind::Id],
        SimulatorShotKind::Ids => &[PassKind::Id],
    };
    let pass_masks = passes.iter().map(|pass| pass.name()).collect();
    let set_passes = (!is_camera_set).then(|| BuildCommand::SetPassMasks { pass_masks, avatar_id: avatar_id() });
    let look_commands = [
        BuildCommand::TeleportAvatarTo { position: unity_vector(camera.position), avatar_id: avatar_id() },
        BuildCommand::RotateAvatarTo { rotation: TdwQuaternion { w, x, y, z }, avatar_id: avatar_id() },
        BuildCommand::SetFieldOfView { field_of_view, avatar_id: avatar_id() },
        BuildCommand::SendImages { ids: vec![avatar_id()], frequency: SendFrequency::Once },
    ];
    let answer = controller.communicate(&set_passes.into_iter().chain(look_commands).collect::<Vec<_>>())?;
    let images = answer.first_output("imag", "send_images", |output| match output {
        BuildOutput::Images(images) if images.avatar == AVATAR_ID => Some(images),
        _ => None,
    })?;
    if (images.width, images.height) != size {
        let reason = format!("it has {} x {} pixels: expected {} x {}", images.width, images.height, size.0, size.1);
        return Err(TdwError::Picture { pass: PassKind::Img.name(), reason });
    }
    let pixels = |kind: PassKind| {
        let pass = images.passes.iter().find(|pass| pass.mask == kind.pass_mask());
        let missing = || TdwError::Picture { pass: kind.name(), reason: "it was not sent".to_owned() };
        pictures::decode_pass(pass.ok_or_else(missing)?, kind, size)
    };
    let ids = pixels(PassKind::Id)?.as_chunks().0.iter().map(|rgb| colour_id(*rgb)).collect();
    let rgb = (wanted == SimulatorShotKind::Picture).then(|| pixels(PassKind::Img)).transpose()?;
    Ok(SimulatorShot { rgb, ids })
}

fn unity_vector(place: DVec3) -> TdwVector3 {
    let [x, y, z] = unity_from_wayword(place);
    TdwVector3 { x, y, z }
}
