//! `wayword view panorama`: joins the four views from a frame into one picture of 360 degrees.

use super::{WrittenView, choose_scene, file_kind::FileKind, open_platform, picture};
use crate::view::args::ViewPanorama;
use std::sync::Arc;
use wayword_core::{Frame, Heading, Image, PathRequest, Platform, Pose, SceneId, Side, View, ViewGaze, ViewpointId};
use wayword_render::{QuarterView, join_panorama};
use wayword_run::{error::CommandError, output::CommandOutput, written_files::write_file};

/// The colour of a view without a picture.
const MISSING_VIEW_GREY: [u8; 3] = [128; 3];
/// How far a view may differ from the requested one, radians: less than a pixel.
const NEAR_RAD: f64 = 1e-4;
/// Most viewpoints that an error names.
const MAX_NAMED_VIEWPOINTS: usize = 5;

pub(super) fn write_panorama(args: &ViewPanorama, output: &CommandOutput) -> Result<WrittenView, CommandError> {
    let kind = FileKind::one_among(&[FileKind::Png, FileKind::Jpeg], &args.out)?;
    kind.check_free(&args.out, args.platform.data.as_deref())?;
    let platform = open_platform(&args.platform)?;
    let scene = choose_scene(&*platform, args.scan.as_deref())?;
    let mut frame = choose_frame(args, &*platform, &scene)?;
    if let Some(degrees) = args.heading_deg {
        let heading = Heading::new(degrees.to_radians());
        frame.pose.heading = heading.map_err(|error| {
            CommandError::usage(format!("--heading-deg: {error}"), "give degrees, as in --heading-deg 90")
        })?;
    }
    let whole = draw_panorama(&*platform, &scene, &frame, args.width, output)?;
    let bytes = if kind == FileKind::Png { picture::encode_png(&whole)? } else { picture::encode_jpeg(&whole)? };
    write_file(&args.out, &bytes)?;
    let (width, height) = (whole.width_px(), whole.height_px());
    Ok(WrittenView { scene, files: vec![args.out.clone()], width, height, frames: 1, islands: Vec::new() })
}

/// The frame from which the panorama is seen: the chosen viewpoint, or the start of a random path.
fn choose_frame(args: &ViewPanorama, platform: &dyn Platform, scene: &SceneId) -> Result<Frame, CommandError> {
    let graph = platform.graph_for_scene(scene)?;
    if args.seed.is_some() || graph.is_empty() {
        let path = platform.sample_path(scene, &PathRequest::default(), args.seed.unwrap_or(0))?;
        let start = path.frames.into_iter().next();
        return start.ok_or_else(|| CommandError::usage("the path has no frame", "choose another --seed"));
    }
    let viewpoint = match &args.viewpoint {
        Some(name) => ViewpointId::new(name.as_str()).ok(),
        None => graph.viewpoints().next().cloned(),
    };
    let found = viewpoint.and_then(|viewpoint| Some((graph.position_of(&viewpoint)?, viewpoint)));
    let Some((position, viewpoint)) = found else {
        let some: Vec<&str> = graph.viewpoints().take(MAX_NAMED_VIEWPOINTS).map(ViewpointId::as_str).collect();
        let name = args.viewpoint.as_deref().unwrap_or_default();
        let (all, some) = (graph.len(), some.join(", "));
        let hint = format!("it has {all}: {some} ...; `wayword view map --out map.svg` draws and names them all");
        return Err(CommandError::usage(format!("scene {scene} has no viewpoint {name}"), hint));
    };
    let level = graph.level_of(&viewpoint);
    Ok(Frame { pose: Pose::looking_level(position, Heading::NORTH), viewpoint: Some(viewpoint), level })
}

/// Draws the panorama of a frame, with its heading in the middle; `width` pixels wide, or wide enough to keep the detail of the views.
///
/// # Errors
/// When more than one of the four views has no picture, or a view has another direction or width than requested.
pub fn draw_panorama(
    platform: &dyn Platform,
    scene: &SceneId,
    frame: &Frame,
    width: Option<u32>,
    output: &CommandOutput,
) -> Result<Image, CommandError> {
    let mut images: [Option<Arc<Image>>; 4] = [const { None }; 4];
    for (image, gaze) in images.iter_mut().zip(ViewGaze::around_heading(frame.pose.heading)) {
        let view = platform.look_from(scene, frame, gaze)?;
        check_view(&view, gaze)?;
        *image = view.image;
    }
    let missing: Vec<&str> =
        Side::ALL.into_iter().zip(&images).filter(|(_, image)| image.is_none()).map(side_word).collect();
    match missing.len() {
        0 => {}
        1 => output.say(format_args!("the view {} has no picture and is drawn grey", missing[0])),
        4 => {
            let problem = format!("scene {scene} has no pictures at this place");
            return Err(CommandError::usage(
                problem,
                "`wayword platforms` says what pictures need; `wayword view path` shows the pictures of a recording",
            ));
        }
        _ => {
            let problem = format!("scene {scene}: these views have no picture: {}", missing.join(", "));
            let hint = "a panorama needs pictures of at least three sides; `wayword view path` shows which there are";
            return Err(CommandError::usage(problem, hint));
        }
    }
    let quarters = images.each_ref().map(|image| {
        let image = image.as_deref()?;
        Some(QuarterView { width: image.width_px(), height: image.height_px(), rgb: image.rgb_bytes() })
    });
    let unfit = |error: String| {
        CommandError::usage(format!("the views cannot become a panorama: {error}"), "try another --width")
    };
    let whole = join_panorama(quarters, width, MISSING_VIEW_GREY).map_err(|error| unfit(error.to_string()))?;
    Image::new(whole.width, whole.height, whole.rgb).map_err(|error| unfit(error.to_string()))
}

fn side_word((side, _): (Side, &Option<Arc<Image>>)) -> &'static str {
    match side {
        Side::Ahead => "ahead",
        Side::Right => "on the right",
        Side::Behind => "behind",
        Side::Left => "on the left",
    }
}

/// Refuses a view with another direction or width than requested, because it would be put in the wrong place.
fn check_view(view: &View, gaze: ViewGaze) -> Result<(), CommandError> {
    let is_turned =
        view.pose.heading.turn_to(gaze.heading).abs() > NEAR_RAD || view.pose.elevation_rad.abs() > NEAR_RAD;
    let is_wider = (view.horizontal_fov_rad - gaze.horizontal_fov_rad).abs() > NEAR_RAD;
    if view.image.is_some() && (is_turned || is_wider) {
        let (heading, fov) = (view.pose.heading.deg(), view.horizontal_fov_rad.to_degrees());
        let problem = format!(
            "this platform shows only what a camera saw ({fov:.1} degrees wide, heading {heading:.1}), and a panorama \
             needs four views of 90 degrees"
        );
        return Err(CommandError::usage(problem, "`wayword view path` shows which pictures there are"));
    }
    Ok(())
}
