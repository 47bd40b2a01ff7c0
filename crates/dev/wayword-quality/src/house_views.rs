//! Counts the views on walks through generated houses that show mostly bare wall, and measures the processor time of a view.

use crate::share::ClusteredShare;
use clap::Args;
use serde::Serialize;
use std::{collections::BTreeMap, fmt, time::Duration};
use wayword_core::{PathRequest, Platform, Pose, ViewGaze, seed::derive_seed};
use wayword_house::{HousePlatform, HouseScene, ObjectRole, generate_house};
use wayword_render::PinholeCamera;
use wayword_run::{error::CommandError, output::CommandOutput};
use wayword_testkit::resources;

/// A picture with at least this share of bare wall counts as bare.
const BARE_WALL_SHARE: f64 = 0.5;
/// Width and height of the pictures, pixels.
const SIZE_PX: [u32; 2] = [640, 480];

/// The flags of `house-views`.
#[derive(Debug, Args)]
pub struct HouseViewsArgs {
    /// How many houses.
    #[arg(long, default_value_t = 20)]
    houses: u64,
    /// Seed of the first house.
    #[arg(long, default_value_t = 0)]
    first: u64,
    /// Walks through each house.
    #[arg(long, default_value_t = 10)]
    walks: u64,
    /// Seed of the walks.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// The figures that are printed.
#[derive(Debug, Serialize)]
struct BareWallReport {
    /// Views of which at least half is bare wall, by walk.
    half_wall: Option<ClusteredShare>,
    /// The number of bare views and of all views, by the walker's room.
    rooms: BTreeMap<&'static str, [usize; 2]>,
    /// Processor time of a view, milliseconds.
    cpu_ms: f64,
}

/// One view on a walk.
struct WalkedView {
    /// The seed of the house, and the number of the walk in it.
    walk: (u64, u64),
    /// The word for the room in which the walker is.
    room: &'static str,
    /// Whether at least [`BARE_WALL_SHARE`] of the picture is bare wall.
    is_bare: bool,
}

/// Prints the share of views on walks through generated houses that are mostly bare wall, and the time that a view takes.
///
/// # Errors
/// When a house cannot be drawn, or has no path.
pub fn measure_house_views(flags: &HouseViewsArgs, output: &CommandOutput) -> Result<(), CommandError> {
    let (mut seen, mut spent) = (Vec::new(), Duration::ZERO);
    for house in flags.first..flags.first.saturating_add(flags.houses) {
        let home = HouseScene::new(generate_house(house)).map_err(|error| drawing_error(house, &error))?;
        for (walk, pose) in walk_poses(flags, house)? {
            let before = resources::processor_time();
            let camera = PinholeCamera::for_level_gaze(pose.position, ViewGaze::quarter_view(pose.heading), SIZE_PX);
            let picture = home.render_picture(&camera).map_err(|error| drawing_error(house, &error))?;
            spent += resources::processor_time().saturating_sub(before);
            let eye = pose.position;
            let room = home.house.room_at(eye.x, eye.y, eye.z).map_or("nowhere", |room| room.kind.word());
            seen.push(WalkedView {
                walk: (house, walk),
                room,
                is_bare: bare_share(&home, &picture.ids) >= BARE_WALL_SHARE,
            });
        }
    }
    let report = summarise_views(&seen, flags.seed, spent);
    output.print_result(&report, &report);
    Ok(())
}

fn drawing_error(house: u64, error: &dyn std::error::Error) -> CommandError {
    CommandError::usage(format!("house {house} cannot be drawn: {error}"), "choose other houses with --first")
}

/// Each frame of the walks through a house, with the number of its walk.
fn walk_poses(flags: &HouseViewsArgs, house: u64) -> Result<Vec<(u64, Pose)>, CommandError> {
    let (platform, scene) = (HousePlatform::default(), HousePlatform::scene_of(house)?);
    let mut poses = Vec::new();
    for walk in 0..flags.walks {
        let seed = derive_seed(flags.seed, &["house views", &house.to_string(), &walk.to_string()]);
        let path = platform.sample_path(&scene, &PathRequest::default(), seed)?;
        poses.extend(path.frames.iter().map(|frame| (walk, frame.pose)));
    }
    Ok(poses)
}

/// The share of a picture's pixels that show the wall itself. Hangings, doors and windows are objects with ids of their own.
fn bare_share(home: &HouseScene, ids: &[u32]) -> f64 {
    let is_wall = |id: &&u32| {
        home.objects.get(id).is_some_and(|object| object.role == ObjectRole::Shell && object.name == "wall")
    };
    ids.iter().filter(is_wall).count() as f64 / ids.len().max(1) as f64
}

fn summarise_views(seen: &[WalkedView], seed: u64, spent: Duration) -> BareWallReport {
    let mut rooms: BTreeMap<&'static str, [usize; 2]> = BTreeMap::new();
    for view in seen {
        let [bare, all] = rooms.entry(view.room).or_default();
        (*bare, *all) = (*bare + usize::from(view.is_bare), *all + 1);
    }
    BareWallReport {
        half_wall: ClusteredShare::from_cases(seen.iter().map(|view| (view.walk, view.is_bare)), seed),
        rooms,
        cpu_ms: 1000.0 * spent.as_secs_f64() / seen.len().max(1) as f64,
    }
}

impl fmt::Display for BareWallReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let share = self.half_wall.as_ref().map_or("-".to_owned(), ToString::to_string);
        write!(f, "views of which half or more is bare wall: {share}")?;
        for (room, [bare, all]) in &self.rooms {
            write!(f, "\n  in the {room}: {bare} of {all}")?;
        }
        write!(f, "\nprocessor time per view: {:.1} ms", self.cpu_ms)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bare_share_counts_walls_without_their_hangings() {
        let home = HouseScene::new(generate_house(3)).unwrap();
        let number = |named: &str| *home.objects.iter().find(|(_, object)| object.name == named).unwrap().0;
        let (wall, painting, floor) = (number("wall"), number("painting"), number("floor"));
        assert!((bare_share(&home, &[wall, wall, painting, floor]) - 0.5).abs() < 1e-9);
        assert_eq!(bare_share(&home, &[painting, floor, number("window"), 0]), 0.0);
    }

    #[test]
    fn views_are_counted_by_room() {
        let view = |room, is_bare| WalkedView { walk: (0, 0), room, is_bare };
        let told = summarise_views(
            &[view("hallway", true), view("hallway", false), view("kitchen", false)],
            0,
            Duration::ZERO,
        );
        assert_eq!(told.rooms, BTreeMap::from([("hallway", [1, 2]), ("kitchen", [0, 1])]));
        assert_eq!(told.half_wall.map(|share| (share.count, share.of)), Some((1, 3)));
    }
}
