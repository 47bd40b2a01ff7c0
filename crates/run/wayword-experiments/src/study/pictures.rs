//! Draws the pictures of a study: panoramas of the places where people walk, and films of the paths that they watch.

use super::choose_paths::StudyWalk;
use rayon::prelude::*;
use sha2::{Digest as _, Sha256};
use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path as FilePath,
    sync::Arc,
};
use wayword_core::{DVec3, Frame, Heading, Platform, Pose, SceneId, ViewGaze, ViewpointGraph, ViewpointId, hex_text};
use wayword_house::{HouseOptions, HousePlatform};
use wayword_report::view::{
    panorama::draw_panorama,
    path::film_steps::{FilmStep, film_steps},
    picture,
};
use wayword_run::{error::CommandError, interrupt, output::CommandOutput, written_files::write_file};
use wayword_study::{FilmMotion, FilmPicture, StudyScene, StudyViewpoint};

/// Platforms for which this program draws pictures itself, at any place.
const DRAWING_PLATFORMS: [&str; 2] = ["house", "habitat"];
/// Size of the views that are joined into a panorama of a house, pixels. They are high, so that one sees the floor from 1.4 m on.
const HOUSE_VIEW_PX: [u32; 2] = [576, 864];
/// Scenes that are drawn at once. The houses that are ready take memory, and a platform keeps six.
const SCENES_AT_ONCE: usize = 4;
/// Most places between two frames of a film, on platforms that can draw there.
const MAX_FRAMES_BETWEEN: usize = 5;
/// The number of pictures that a film should have: half a minute, at two for each second.
const TARGET_FILM_PICTURES: usize = 60;
/// A film mentions a turn if it is larger than this since the last picture, radians.
const TURNED_RAD: f64 = 0.15;
/// A way is straight where it nowhere leads farther off the line to its end than this, metres.
const STRAIGHT_M: f64 = 0.1;

/// Draws a panorama for each viewpoint that people can reach from the starts of some walks.
///
/// # Errors
/// When a scene cannot be read or drawn, or a picture cannot be written.
pub(super) fn draw_scenes(
    walks: &[StudyWalk],
    platform: &dyn Platform,
    folder: &FilePath,
    output: &CommandOutput,
) -> Result<Vec<StudyScene>, CommandError> {
    let mut starts: BTreeMap<&SceneId, BTreeSet<&ViewpointId>> = BTreeMap::new();
    for walk in walks {
        starts.entry(&walk.path.scene).or_default().extend(walk.viewpoints.first());
    }
    let mut wanted = Vec::new();
    for (scene, starts) in starts {
        let graph = platform.graph_for_scene(scene)?;
        let mut reached: BTreeSet<ViewpointId> = BTreeSet::new();
        for start in starts {
            if !reached.contains(start) {
                let distances = graph.distances_from(start);
                let distances =
                    distances.map_err(|source| wayword_core::PlatformError::Graph { scene: scene.clone(), source })?;
                reached.extend(distances.into_keys().cloned());
            }
        }
        wanted.push((scene.clone(), graph, reached));
    }
    let place_count: usize = wanted.iter().map(|(_, _, reached)| reached.len()).sum();
    let progress = output.progress_bar(place_count, "panoramas");
    let houses = HousePlatform::new(HouseOptions {
        width_px: HOUSE_VIEW_PX[0],
        height_px: HOUSE_VIEW_PX[1],
        ..HouseOptions::default()
    });
    let platform: &dyn Platform = if platform.name() == houses.name() { &houses } else { platform };
    let draw = |(scene, graph, reached): &(SceneId, Arc<ViewpointGraph>, BTreeSet<ViewpointId>)| {
        let place = |id: &ViewpointId| {
            interrupt::check_interrupt()?;
            let place = draw_place(scene, graph, id, platform, folder, output)?;
            progress.inc(1);
            Ok((id.clone(), place))
        };
        // The first place makes the scene ready to be drawn, which no other thread can do meanwhile.
        let first = reached.first().map(place).transpose()?;
        let rest: Vec<&ViewpointId> = reached.iter().skip(1).collect();
        let rest = rest.into_par_iter().map(place).collect::<Result<Vec<_>, CommandError>>()?;
        Ok(StudyScene { scene: scene.clone(), places: first.into_iter().chain(rest).collect() })
    };
    let mut drawn = Vec::with_capacity(wanted.len());
    for scenes in wanted.chunks(SCENES_AT_ONCE) {
        drawn.extend(scenes.par_iter().map(draw).collect::<Result<Vec<_>, CommandError>>()?);
    }
    progress.finish_and_clear();
    Ok(drawn)
}

/// Draws the panorama of one viewpoint, unless an earlier command has drawn it.
fn draw_place(
    scene: &SceneId,
    graph: &ViewpointGraph,
    id: &ViewpointId,
    platform: &dyn Platform,
    folder: &FilePath,
    output: &CommandOutput,
) -> Result<StudyViewpoint, CommandError> {
    let unknown = || wayword_core::PlatformError::UnknownViewpoint { scene: scene.clone(), viewpoint: id.clone() };
    let position = graph.position_of(id).ok_or_else(unknown)?;
    let level = graph.level_of(id);
    let frame = Frame { pose: Pose::looking_level(position, Heading::NORTH), viewpoint: Some(id.clone()), level };
    // The name is a hash of everything that the picture depends on, so that a command with other paths does not take a wrong picture.
    let size = if platform.name() == "house" { format!("{HOUSE_VIEW_PX:?}") } else { String::new() };
    let panorama =
        file_name(&["panorama", platform.name(), scene.as_str(), id.as_str(), &format!("{position:?}"), &size]);
    let file = folder.join(&panorama);
    // A command that was stopped goes on with the pictures that it has.
    if !file.is_file() {
        let whole = draw_panorama(platform, scene, &frame, None, output)?;
        write_file(&file, picture::encode_jpeg(&whole)?)?;
    }
    let neighbours: Vec<ViewpointId> = graph.neighbours_of(id).into_iter().cloned().collect();
    let mut bends = BTreeMap::new();
    for neighbour in &neighbours {
        let position = graph.position_of(neighbour).ok_or_else(unknown)?;
        let to = Frame { pose: Pose::looking_level(position, Heading::NORTH), viewpoint: None, level: None };
        let way = platform.ground().ground_route(scene, &frame, &to)?;
        if let Some(bend) = way.and_then(|way| first_bend(&way.corners)) {
            bends.insert(neighbour.clone(), bend.to_array());
        }
    }
    Ok(StudyViewpoint { position: position.to_array(), level, neighbours, bends, panorama })
}

/// The first place at which a way turns noticeably off the line to its end; `None` for a straight way.
fn first_bend(corners: &[DVec3]) -> Option<DVec3> {
    let (start, end) = (*corners.first()?, *corners.last()?);
    let between = &corners[1..corners.len().max(2) - 1];
    let along = (end - start).with_z(0.0).normalize_or_zero();
    let aside_m = |corner: &DVec3| {
        let off = (*corner - start).with_z(0.0);
        (off - along * off.dot(along)).length()
    };
    between.iter().any(|corner| aside_m(corner) > STRAIGHT_M).then(|| between[0])
}

/// Draws the film of a walk.
///
/// # Errors
/// When the platform has no picture of the walk, or a picture cannot be written.
pub(super) fn draw_film(
    walk: &StudyWalk,
    platform: &dyn Platform,
    folder: &FilePath,
) -> Result<Vec<FilmPicture>, CommandError> {
    interrupt::check_interrupt()?;
    let draws_anywhere = DRAWING_PLATFORMS.contains(&platform.name()) && walk.path.motion.is_known();
    let between = (TARGET_FILM_PICTURES / walk.path.frames.len().max(1)).saturating_sub(1).min(MAX_FRAMES_BETWEEN);
    let steps = film_steps(&walk.path, if draws_anywhere { between } else { 0 })?;
    let picture = |(number, step): (usize, &FilmStep)| {
        let name = file_name(&["film", platform.name(), walk.path.scene.as_str(), &format!("{:?}", step.frame)]);
        let file = folder.join(&name);
        if !file.is_file() {
            let view =
                platform.look_from(&walk.path.scene, &step.frame, ViewGaze::quarter_view(step.frame.pose.heading))?;
            let Some(image) = view.image else { return Ok(None) };
            write_file(&file, picture::encode_jpeg(&image)?)?;
        }
        let before = number.checked_sub(1).map(|before| &steps[before]);
        let motion = describe_motion(before, step, walk.path.motion.is_known());
        Ok(Some(FilmPicture { file: name, alt: motion.in_english().to_owned() }))
    };
    let pictures: Vec<FilmPicture> = steps
        .par_iter()
        .enumerate()
        .map(picture)
        .collect::<Result<Vec<_>, CommandError>>()?
        .into_iter()
        .flatten()
        .collect();
    if pictures.is_empty() {
        let problem = format!("path {}: there is no picture of it", walk.name);
        return Err(CommandError::usage(
            problem,
            "`wayword platforms` says which platforms have pictures, and what they need",
        ));
    }
    Ok(pictures)
}

/// Describes the motion in a picture of a film, as its alternative text. It names no thing in the picture, because people judge
/// whether the text names the right things.
fn describe_motion(before: Option<&FilmStep>, step: &FilmStep, is_known: bool) -> FilmMotion {
    let Some(before) = before else { return FilmMotion::Begins };
    if !is_known {
        return FilmMotion::GoesOn;
    }
    let turn_rad = before.frame.pose.heading.turn_to(step.frame.pose.heading);
    match turn_rad {
        right if right > TURNED_RAD => FilmMotion::TurnsRight,
        left if left < -TURNED_RAD => FilmMotion::TurnsLeft,
        _ => FilmMotion::GoesOn,
    }
}

/// A file name that does not reveal its content to participants: a hash of the parts.
fn file_name(parts: &[&str]) -> String {
    let mut hash = Sha256::new();
    for part in parts {
        hash.update((part.len() as u64).to_le_bytes());
        hash.update(part.as_bytes());
    }
    format!("{}.jpg", hex_text(&hash.finalize()[..12]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_has_a_bend_where_it_leaves_the_straight_line() {
        let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let corner = Some(at(0.0, 2.0));
        assert_eq!(first_bend(&[at(0.0, 0.0), at(0.0, 2.0), at(2.0, 2.0)]), corner, "round a corner");
        assert_eq!(first_bend(&[at(0.0, 0.0), at(0.0, 2.0), at(1.0, 3.0), at(2.0, 2.0)]), corner, "the first of two");
        assert_eq!(first_bend(&[at(0.0, 0.0), at(0.05, 1.0), at(0.0, 3.0)]), None, "nearly straight");
        assert_eq!(
            first_bend(&[at(0.0, 0.0), DVec3::new(0.0, 1.0, 0.8), DVec3::new(0.0, 2.0, 1.0)]),
            None,
            "up stairs"
        );
        for straight in [&[][..], &[at(0.0, 0.0)], &[at(0.0, 0.0), at(0.0, 0.0)], &[at(1.0, 0.0), at(3.0, 0.0)]] {
            assert_eq!(first_bend(straight), None);
        }
    }
}
