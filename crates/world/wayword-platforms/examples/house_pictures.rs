//! Writes views of generated houses into a folder, to be looked at.
//!
//! ```text
//! cargo run --release -p wayword-platforms --example house_pictures -- FOLDER FIRST_SEED HOUSES
//! ```

use std::{error::Error, path::PathBuf};
use wayword_core::DVec3;
use wayword_platforms::house::{HouseScene, generate};
use wayword_render::Camera;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("give a folder")?);
    let first: u64 = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let count: u64 = arguments.next().map_or(Ok(1), |text| text.parse())?;
    std::fs::create_dir_all(&folder)?;
    for seed in first..first + count {
        let scene = HouseScene::new(generate(seed))?;
        for (index, room) in scene.house.rooms.iter().enumerate() {
            let inner = room.inner();
            let (cx, cy) = inner.centre();
            // From a corner to the opposite one shows most of a room.
            let eye = DVec3::new(
                f64::from(inner.x0 + 35) / 100.0,
                f64::from(inner.y0 + 35) / 100.0,
                f64::from(room.base_cm()) / 100.0 + 1.5,
            );
            let ahead = DVec3::new(f64::from(cx) / 100.0, f64::from(cy) / 100.0, eye.z) - eye;
            let camera = Camera::looking_along(eye, ahead, 2.0 * 0.75_f64.atan(), 640, 480);
            let picture = scene.picture(&camera)?;
            let name = format!("house-{seed}-{index:02}-{}.png", room.kind.word().replace(' ', "-"));
            image::save_buffer(
                folder.join(name),
                &picture.rgb,
                picture.width,
                picture.height,
                image::ExtendedColorType::Rgb8,
            )?;
        }
    }
    Ok(())
}
