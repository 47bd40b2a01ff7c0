//! What is seen along walks through generated houses: how often half of a view is bare wall, and how long a view takes.

use std::{collections::BTreeMap, time::Instant};
use wayword::{error::Error, output::Output};
use wayword_core::{Gaze, PathRequest, Platform, PlatformError, seed::derive};
use wayword_house::{EYE_M, HousePlatform, HouseScene, Role, generate};
use wayword_render::Camera;

/// A view of which at least this share is bare wall is half bare wall.
const HALF: f64 = 0.5;
const SIZE_PX: [u32; 2] = [640, 480];

#[derive(Debug, clap::Args)]
pub(crate) struct Flags {
    /// Seed of the first house.
    #[arg(long, default_value_t = 1000)]
    seed: u64,
    /// Houses.
    #[arg(long, default_value_t = 20)]
    houses: u64,
    /// Walks through each.
    #[arg(long, default_value_t = 10)]
    walks: u64,
}

pub(crate) fn measure(flags: &Flags, output: &Output) -> Result<(), Error> {
    let platform = HousePlatform::default();
    let (mut rooms, mut times_ms): (BTreeMap<&str, [usize; 2]>, _) = (BTreeMap::new(), Vec::new());
    for seed in flags.seed..flags.seed + flags.houses {
        let scene = HousePlatform::scene_of(seed)?;
        let drawn = HouseScene::new(generate(seed))
            .map_err(|error| PlatformError::NotDrawn { scene: scene.clone(), reason: error.to_string() })?;
        for walk in 0..flags.walks {
            let path =
                platform.sample_path(&scene, &PathRequest::default(), derive(seed, &["views", &walk.to_string()]))?;
            for frame in &path.frames {
                let camera = Camera::level(frame.pose.position, Gaze::quarter(frame.pose.heading), SIZE_PX);
                let begun = Instant::now();
                let picture =
                    drawn.picture(&camera).map_err(|error| Error::usage(error.to_string(), "another seed"))?;
                times_ms.push(begun.elapsed().as_secs_f64() * 1e3);
                let is_wall = |id: &&u32| {
                    drawn.objects.get(*id).is_some_and(|object| object.role == Role::Shell && object.name == "wall")
                };
                let wall = picture.ids.iter().filter(is_wall).count();
                let eye = frame.pose.position;
                let room = drawn.house.room_at(eye.x, eye.y, eye.z - EYE_M).map_or("?", |room| room.kind.word());
                let counts = rooms.entry(room).or_default();
                counts[0] += 1;
                counts[1] += usize::from(wall as f64 >= HALF * picture.ids.len() as f64);
            }
        }
    }
    times_ms.sort_by(f64::total_cmp);
    let at = |share: f64| times_ms.get((share * times_ms.len() as f64) as usize).copied().unwrap_or_default();
    let [views, bare] = rooms.values().fold([0, 0], |sum, counts| [sum[0] + counts[0], sum[1] + counts[1]]);
    let share = |[views, bare]: [usize; 2]| bare as f64 / views.max(1) as f64;
    let told = serde_json::json!({
        "views": views,
        "half_bare_wall": share([views, bare]),
        "by_room": rooms.iter().map(|(room, counts)| (*room, share(*counts))).collect::<BTreeMap<_, _>>(),
        "median_ms": at(0.5),
        "most_ms": at(0.99),
    });
    let by_room: Vec<String> =
        rooms.iter().map(|(room, counts)| format!("{room} {:.0} % of {}", 100.0 * share(*counts), counts[0])).collect();
    let text = format!(
        "{views} views along walks through {} houses: {:.1} % are half bare wall ({}); a view of 640x480 takes {:.1} ms, 99 % at most {:.1} ms",
        flags.houses,
        100.0 * share([views, bare]),
        by_room.join(", "),
        at(0.5),
        at(0.99)
    );
    output.data(&told, text);
    Ok(())
}
