//! `wayword view path`: draws the view ahead along a path, as a folder of pictures, a strip, a GIF or a video.

pub mod film_steps;

use super::{WrittenView, film, open_platform, platform_of_texts, walk};
use crate::view::args::ViewPath;
use film_steps::FilmStep;
use image::imageops::{self, FilterType};
use std::sync::Arc;
use wayword_core::{Image, Platform, PlatformError, SceneId, ViewGaze};
use wayword_run::{count::count_phrase, error::CommandError, output::CommandOutput};

/// Most pictures of a path. A path that needs more is refused.
const MAX_PICTURES: usize = 20_000;
/// Pictures for each second: with the path's own frames only, and with pictures between them.
const DEFAULT_FPS: [f64; 2] = [1.0, 12.0];
/// The rates that can be asked for: a GIF counts in hundredths of a second.
const FPS_RANGE: std::ops::RangeInclusive<f64> = 0.1..=50.0;
/// Pictures of a strip, unless `--pictures` gives another number.
const STRIP_PICTURES: usize = 3;
/// Greatest width of the pictures, pixels. A wider one is refused.
const MAX_WIDTH_PX: u32 = 8192;

pub(super) fn write_path(args: &ViewPath, output: &CommandOutput) -> Result<WrittenView, CommandError> {
    let fps = args.fps.unwrap_or(DEFAULT_FPS[usize::from(args.smooth.is_some_and(|between| between > 0))]);
    if !FPS_RANGE.contains(&fps) {
        return Err(CommandError::usage(format!("--fps {fps} is out of range"), "give a number from 0.1 to 50"));
    }
    if args.width.is_some_and(|width| !(1..=MAX_WIDTH_PX).contains(&width)) {
        return Err(CommandError::usage("--width is out of range", format!("give a number from 1 to {MAX_WIDTH_PX}")));
    }
    let asked = platform_of_texts(&args.platform, args.walk.episodes.as_deref());
    let place = film::FilmPlace::from_out(&args.out, asked.data.as_deref())?;
    let platform = open_platform(&asked)?;
    let path = walk::choose_path(&args.walk, &asked, &*platform)?;
    let mut steps = film_steps::film_steps(&path, args.smooth.unwrap_or(0))?;
    if place.is_strip() && args.fps.is_some() {
        return Err(CommandError::usage("--fps is for a film", "end --out in .gif or .mp4, or leave --fps out"));
    }
    match (place.is_strip(), args.pictures) {
        (true, asked) => steps = evenly_spaced(steps, asked.map_or(STRIP_PICTURES, usize::from)),
        (false, Some(_)) => {
            return Err(CommandError::usage("--pictures is for one picture", "end --out in .jpg or .png"));
        }
        (false, None) => {}
    }
    if steps.len() > MAX_PICTURES {
        let problem = format!("the path would need {} pictures, but at most {MAX_PICTURES} are allowed", steps.len());
        return Err(CommandError::usage(problem, "ask for a shorter path, or a smaller --smooth"));
    }
    let mut film = place.open_writer(fps, steps.len())?;
    let bar = output.progress_bar(steps.len(), "pictures");
    let (mut size, mut frames) = (None, 0);
    for step in &steps {
        if let Some(image) = look_ahead(&*platform, &path.scene, step)? {
            let size = *size.get_or_insert_with(|| picture_size(&image, args.width));
            let picture = fit_size(image, size)?;
            film.add_picture(&picture)?;
            frames += 1;
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    let Some((width, height)) = size else {
        let problem =
            format!("path {}: there is no picture for any of its {}", path.id, count_phrase(steps.len(), "frame"));
        let hint = "`wayword view map` draws the way without pictures; `wayword platforms` says which platforms have them, and what they need";
        return Err(CommandError::usage(problem, hint));
    };
    if frames < steps.len() {
        let without = steps.len() - frames;
        output.say(format_args!("no picture for {without} of {}; left out", count_phrase(steps.len(), "frame")));
    }
    Ok(WrittenView { scene: path.scene, files: film.finish()?, width, height, frames, islands: Vec::new() })
}

/// At most this many of the steps, evenly spaced, with the first and the last among them; a single one is the last.
fn evenly_spaced(steps: Vec<FilmStep>, most: usize) -> Vec<FilmStep> {
    let (last, gaps) = (steps.len().saturating_sub(1), most.saturating_sub(1));
    if most > last {
        return steps;
    }
    let chosen: Vec<usize> = (0..most).map(|at| (at * last).checked_div(gaps).unwrap_or(last)).collect();
    steps.into_iter().enumerate().filter(|(at, _)| chosen.contains(at)).map(|(_, step)| step).collect()
}

/// The picture of the view ahead. If there is none, that is an error between two frames, and `None` at a frame of the path.
fn look_ahead(platform: &dyn Platform, scene: &SceneId, step: &FilmStep) -> Result<Option<Arc<Image>>, CommandError> {
    let view = platform.look_from(scene, &step.frame, ViewGaze::quarter_view(step.frame.pose.heading));
    let nothing_between = || {
        let problem = format!("platform {} has no pictures between the frames of a path", platform.name());
        Err(CommandError::usage(problem, "leave --smooth out to see the frames only"))
    };
    match view {
        Err(PlatformError::NotAViewpoint { .. } | PlatformError::UnknownViewpoint { .. }) if step.is_between => {
            nothing_between()
        }
        Err(error) => Err(error.into()),
        Ok(view) if view.image.is_none() && step.is_between => nothing_between(),
        Ok(view) => Ok(view.image),
    }
}

/// The size of all pictures: that of the first, scaled to `width` if the user chose one.
fn picture_size(first: &Image, width: Option<u32>) -> (u32, u32) {
    let size = (first.width_px(), first.height_px());
    width.map_or(size, |width| {
        let height = f64::from(size.1) * f64::from(width) / f64::from(size.0.max(1));
        (width, (height.round() as u32).clamp(1, MAX_WIDTH_PX))
    })
}

/// The picture, scaled to a size if it has another.
fn fit_size(image: Arc<Image>, (width, height): (u32, u32)) -> Result<Arc<Image>, CommandError> {
    if (image.width_px(), image.height_px()) == (width, height) {
        return Ok(image);
    }
    let broken = || CommandError::usage("a picture has no pixels", "check the platform's files");
    let given = image::RgbImage::from_raw(image.width_px(), image.height_px(), image.rgb_bytes().to_vec());
    let given = given.filter(|given| given.width() > 0 && given.height() > 0).ok_or_else(broken)?;
    let scaled = imageops::resize(&given, width, height, FilterType::Triangle);
    Image::new(width, height, scaled.into_raw()).map(Arc::new).map_err(|_| broken())
}
