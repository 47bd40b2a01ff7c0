//! StreamVLN's layout: `annotations.json`, and a folder of pictures for each walk.

use super::{LayoutPack, PackedCounts};
use wayword_formats::{
    training::streamvln::{StreamVlnWalk, write_streamvln_file},
    trajectories::PictureKind,
};
use wayword_run::error::CommandError;

/// The name of this set in the names of folders: SCENE_SET_NUMBER.
const SET_NAME: &str = "wayword";

pub(super) fn pack_streamvln(pack: &LayoutPack<'_>) -> Result<PackedCounts, CommandError> {
    let mut walks = Vec::with_capacity(pack.walks.len());
    for (number, walk) in pack.walks.iter().enumerate() {
        // Readers split the name at "_".
        let scene = walk.trajectory.scene.as_str().replace('_', "-");
        let video = format!("images/{scene}_{SET_NAME}_{number:06}");
        let pictures = pack.read_pictures(walk, 0, PictureKind::Rgb)?;
        let name = |picture| format!("{video}/rgb/{picture:04}.jpg").into();
        pack.place_pictures(walk, (0, PictureKind::Rgb), &pictures, name)?;
        walks.push(StreamVlnWalk {
            id: number.into(),
            video,
            instructions: walk.texts.iter().map(|text| text.text.clone()).collect(),
            actions: walk.trajectory.actions.clone(),
            extra: serde_json::Map::new(),
        });
    }
    write_streamvln_file(&pack.folder.join("annotations.json"), &walks)?;
    Ok(PackedCounts { entries: walks.len(), left_out: 0 })
}
