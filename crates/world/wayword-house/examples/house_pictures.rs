//! Writes views of generated houses into a folder for a person to look at, with a list of their labels.
//!
//! ```text
//! cargo run --release -p wayword-house --example house_pictures -- FOLDER FIRST_SEED HOUSES VIEWS_EACH
//! ```
//!
//! Each view is taken at a random viewpoint. Of the four compass directions there, the program keeps the one that shows
//! the most different objects. `FOLDER/labels.txt` lists the labels, one line per view.

use std::{collections::BTreeSet, error::Error, fmt::Write, path::PathBuf, time::Instant};
use wayword_core::{Platform, View, ViewGaze, seed::derive_seed};
use wayword_house::HousePlatform;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("name the output folder as the first argument")?);
    let mut number = |otherwise: u64| arguments.next().map_or(Ok(otherwise), |text| text.parse());
    let (first, houses, views) = (number(0)?, number(1)?, number(8)?);
    std::fs::create_dir_all(&folder)?;
    let platform = HousePlatform::default();
    let mut told = String::new();
    for seed in first..first + houses {
        let scene = HousePlatform::scene_of(seed)?;
        let begun = Instant::now();
        platform.graph_for_scene(&scene)?;
        let (built, begun) = (begun.elapsed(), Instant::now());
        let graph = platform.graph_for_scene(&scene)?;
        let viewpoints: Vec<_> = graph.viewpoints().cloned().collect();
        for index in 0..views {
            let at = derive_seed(seed, &["view", &index.to_string()]) as usize % viewpoints.len();
            let frame = graph.path_frames(&viewpoints[at..=at], None)?.remove(0);
            let looks = ViewGaze::compass_views().map(|gaze| platform.look_from(&scene, &frame, gaze));
            let looks = looks.into_iter().collect::<Result<Vec<_>, _>>()?;
            let Some(view) = looks.into_iter().max_by_key(variety) else {
                continue;
            };
            let (Some(image), Some(truth)) = (&view.image, view.ground_truth()) else {
                continue;
            };
            let name = format!("view-{seed}-{index}.png");
            let colour = image::ExtendedColorType::Rgb8;
            image::save_buffer(folder.join(&name), image.rgb_bytes(), image.width_px(), image.height_px(), colour)?;
            let names: Vec<_> = truth.labels.iter().map(|label| label.name.as_str()).collect();
            writeln!(told, "{name}\t{}\t{}", truth.room.as_deref().unwrap_or("?"), names.join(", "))?;
        }
        writeln!(told, "{scene}: built in {built:.0?}, {views} panoramas in {:.0?}", begun.elapsed())?;
    }
    std::fs::write(folder.join("labels.txt"), told)?;
    Ok(())
}

/// How many differently named objects a view shows.
fn variety(view: &View) -> usize {
    let labels = view.ground_truth().map_or(&[][..], |truth| &truth.labels);
    labels.iter().map(|label| &label.name).collect::<BTreeSet<_>>().len()
}
