//! LeRobot's layout, v3.0 with its columns of language: an episode for each text, with a stretch of a video.

use super::{LayoutPack, PackedCounts, PackedWalk};
use crate::view::film::{FilmWriter, open_training_video};
use std::{collections::BTreeMap, fs};
use wayword_core::Image;
use wayword_formats::{
    training::lerobot::{ColourStatistics, LEROBOT_FPS, LeRobotEpisode, lerobot_video, write_lerobot_dataset},
    trajectories::{PictureKind, TrajectoryInstruction},
};
use wayword_run::{error::CommandError, interrupt, output::CommandOutput};

/// Most frames of one video file.
const MAX_VIDEO_FRAMES: usize = 10_000;

pub(super) fn pack_lerobot(pack: &LayoutPack<'_>, output: &CommandOutput) -> Result<PackedCounts, CommandError> {
    let camera = &pack.cameras[0];
    let size = [camera.width_px, camera.height_px];
    let mut colours = ColourStatistics { pictures: 0, counts: [[0; 256]; 3] };
    let mut episodes: Vec<LeRobotEpisode> = Vec::new();
    let mut video: Option<Box<dyn FilmWriter>> = None;
    let (mut number, mut frames) = (0, 0);
    let bar = output.progress_bar(pack.walks.len(), "walks");
    for walk in &pack.walks {
        let pictures = decoded_pictures(pack, walk)?;
        pictures.iter().for_each(|picture| count_colours(&mut colours, picture));
        for text in &walk.texts {
            interrupt::check_interrupt()?;
            if frames > 0 && frames + pictures.len() > MAX_VIDEO_FRAMES {
                video.take().map(FilmWriter::finish).transpose()?;
                (number, frames) = (number + 1, 0);
            }
            // Each text has frames of its own: LeRobot's tools cut and join videos by episodes.
            let film = match &mut video {
                Some(film) => film,
                None => {
                    let file = pack.folder.join(lerobot_video(number));
                    let folder = file.parent().unwrap_or(&file);
                    fs::create_dir_all(folder).map_err(CommandError::io(folder, "make the folder"))?;
                    video.insert(open_training_video(&file, f64::from(LEROBOT_FPS))?)
                }
            };
            pictures.iter().try_for_each(|picture| film.add_picture(picture))?;
            episodes.push(episode(walk, text, [number, frames]));
            frames += pictures.len();
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    video.map(FilmWriter::finish).transpose()?;
    write_lerobot_dataset(&pack.folder, &episodes, size, &colours)?;
    Ok(PackedCounts { entries: episodes.len(), left_out: 0 })
}

fn decoded_pictures(pack: &LayoutPack<'_>, walk: &PackedWalk<'_>) -> Result<Vec<Image>, CommandError> {
    let unreadable = |error: &dyn std::error::Error| {
        CommandError::usage(format!("a picture of the steps cannot be read: {error}"), "make the steps again")
    };
    let decode = |jpeg: &Vec<u8>| {
        let pixels = image::load_from_memory(jpeg).map_err(|error| unreadable(&error))?.into_rgb8();
        Image::new(pixels.width(), pixels.height(), pixels.into_raw()).map_err(|error| unreadable(&error))
    };
    pack.read_pictures(walk, 0, PictureKind::Rgb)?.iter().map(decode).collect()
}

fn count_colours(colours: &mut ColourStatistics, picture: &Image) {
    colours.pictures += 1;
    for pixel in picture.rgb_bytes().as_chunks::<3>().0 {
        for (channel, value) in pixel.iter().enumerate() {
            colours.counts[channel][usize::from(*value)] += 1;
        }
    }
}

fn episode(walk: &PackedWalk<'_>, text: &TrajectoryInstruction, [video, video_from]: [usize; 2]) -> LeRobotEpisode {
    let trajectory = walk.trajectory;
    let parts: Vec<(String, usize)> = match text.sub_instructions.as_slice() {
        [] => vec![(text.text.clone(), 0)],
        parts => parts.iter().map(|part| (part.text.clone(), part.steps[0])).collect(),
    };
    let state = |(position, heading): (&wayword_core::DVec3, &wayword_core::Heading)| {
        // Counter-clockwise from +x, where a heading is clockwise from +y.
        let yaw = std::f64::consts::FRAC_PI_2 - heading.rad();
        [position.x, position.y, position.z, yaw].map(|part| part as f32)
    };
    // One question at the start of each part.
    let goals: BTreeMap<usize, [u32; 2]> = parts
        .iter()
        .filter_map(|(_, start)| Some((*start, walk.seen[0].pixel_goals.get(*start)?.as_ref()?.pixel)))
        .collect();
    LeRobotEpisode {
        task: text.text.clone(),
        other_texts: walk.texts.iter().map(|other| other.text.clone()).collect(),
        parts,
        actions: trajectory.actions.clone(),
        states: trajectory.positions.iter().zip(&trajectory.headings).map(state).collect(),
        goals,
        names: [trajectory.id.clone(), text.episode_id.clone(), text.style.clone()],
        video,
        video_from,
    }
}
