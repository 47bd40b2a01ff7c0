//! NaVILA's layouts: decisions of a policy with all pictures before them (`annotations.json`, `frames/`), and videos for which the
//! instruction is the answer (`speaker.json`, `videos/`).

use super::{LayoutPack, PackedCounts, write_motion_jpeg};
use std::fs;
use wayword_formats::{
    training::navila::{NavilaSpeakerItem, navila_samples, write_navila_samples, write_navila_speaker},
    trajectories::PictureKind,
};
use wayword_run::{error::CommandError, interrupt};

/// Pictures each second of a video.
const VIDEO_FPS: u32 = 4;

pub(super) fn pack_navila(pack: &LayoutPack<'_>) -> Result<PackedCounts, CommandError> {
    let videos = pack.folder.join("videos");
    fs::create_dir_all(&videos).map_err(CommandError::io(&videos, "make the folder"))?;
    let mut speaker = Vec::new();
    for walk in &pack.walks {
        interrupt::check_interrupt()?;
        let id = &walk.trajectory.id;
        let pictures = pack.read_pictures(walk, 0, PictureKind::Rgb)?;
        let frame = |number| format!("frames/{}", frame_name(id, number)).into();
        pack.place_pictures(walk, (0, PictureKind::Rgb), &pictures, frame)?;
        let name = format!("{id}.avi");
        write_motion_jpeg(&videos.join(&name), &pictures, &pack.cameras[0], VIDEO_FPS)?;
        let item = |text: &str| NavilaSpeakerItem { video: name.clone(), instruction: text.to_owned() };
        speaker.extend(walk.texts.iter().map(|text| item(&text.text)));
    }
    write_navila_speaker(&pack.folder.join("speaker.json"), &speaker)?;
    let mut entries = 0;
    let samples = pack.walks.iter().flat_map(|walk| {
        let (id, actions) = (&walk.trajectory.id, &walk.trajectory.actions);
        walk.texts.iter().flat_map(move |text| navila_samples(id, &text.text, actions, |number| frame_name(id, number)))
    });
    write_navila_samples(&pack.folder.join("annotations.json"), samples.inspect(|_| entries += 1))?;
    Ok(PackedCounts { entries, left_out: 0 })
}

fn frame_name(walk: &str, number: usize) -> String {
    format!("{walk}/frame_{number}.jpg")
}
