//! Counts the views on walks through generated houses that show mostly bare wall, and measures the processor time of a view.

use crate::share::Share;
use clap::Args;
use serde::Serialize;
use std::{collections::BTreeMap, fmt, time::Duration};
use wayword_core::{Gaze, PathRequest, Platform, Pose, seed::derive};
use wayword_house::{HousePlatform, HouseScene, Role, generate};
use wayword_render::Camera;
use wayword_run::{error::Error, output::Output};
use wayword_testkit::resources;

/// From this share of a picture on, it counts as a picture of bare wall.
const HALF: f64 = 0.5;
/// Width and height of the pictures, pixels.
const SIZE_PX: [u32; 2] = [640, 480];

/// The flags of `house-views`.
#[derive(Debug, Args)]
pub struct Flags {
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
struct Told {
    /// Views of which at least half is bare wall, by walk.
    half_wall: Option<Share>,
    /// The number of bare views and of all views, by the walker's room.
    rooms: BTreeMap<&'static str, [usize; 2]>,
    /// Processor time of a view, milliseconds.
    cpu_ms: f64,
}

/// One view on a walk.
struct Seen {
    walk: (u64, u64),
    room: &'static str,
    is_bare: bool,
}

pub fn measure(flags: &Flags, output: &Output) -> Result<(), Error> {
    let (mut seen, mut spent) = (Vec::new(), Duration::ZERO);
    for house in flags.first..flags.first.saturating_add(flags.houses) {
        let home = HouseScene::new(generate(house)).map_err(|error| refused(house, &error))?;
        for (walk, pose) in poses(flags, house)? {
            let before = resources::cpu();
            let camera = Camera::level(pose.position, Gaze::quarter(pose.heading), SIZE_PX);
            let picture = home.picture(&camera).map_err(|error| refused(house, &error))?;
            spent += resources::cpu().saturating_sub(before);
            let eye = pose.position;
            let room = home.house.room_at(eye.x, eye.y, eye.z).map_or("nowhere", |room| room.kind.word());
            seen.push(Seen { walk: (house, walk), room, is_bare: bare_share(&home, &picture.ids) >= HALF });
        }
    }
    let told = told(&seen, flags.seed, spent);
    output.data(&told, &told);
    Ok(())
}

fn refused(house: u64, error: &dyn std::error::Error) -> Error {
    Error::usage(format!("house {house} cannot be drawn: {error}"), "choose other houses with --first")
}

/// Each frame of the walks through a house, with the number of its walk.
fn poses(flags: &Flags, house: u64) -> Result<Vec<(u64, Pose)>, Error> {
    let (platform, scene) = (HousePlatform::default(), HousePlatform::scene_of(house)?);
    let mut poses = Vec::new();
    for walk in 0..flags.walks {
        let seed = derive(flags.seed, &["house views", &house.to_string(), &walk.to_string()]);
        let path = platform.sample_path(&scene, &PathRequest::default(), seed)?;
        poses.extend(path.frames.iter().map(|frame| (walk, frame.pose)));
    }
    Ok(poses)
}

/// The share of a picture's pixels that show the wall itself. Hangings, doors and windows are objects with ids of their own.
fn bare_share(home: &HouseScene, ids: &[u32]) -> f64 {
    let is_wall = |id: &&u32| home.objects.get(id).is_some_and(|it| it.role == Role::Shell && it.name == "wall");
    ids.iter().filter(is_wall).count() as f64 / ids.len().max(1) as f64
}

fn told(seen: &[Seen], seed: u64, spent: Duration) -> Told {
    let mut rooms: BTreeMap<&'static str, [usize; 2]> = BTreeMap::new();
    for view in seen {
        let [bare, all] = rooms.entry(view.room).or_default();
        (*bare, *all) = (*bare + usize::from(view.is_bare), *all + 1);
    }
    Told {
        half_wall: Share::of(seen.iter().map(|view| (view.walk, view.is_bare)), seed),
        rooms,
        cpu_ms: 1000.0 * spent.as_secs_f64() / seen.len().max(1) as f64,
    }
}

impl fmt::Display for Told {
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
        let home = HouseScene::new(generate(3)).unwrap();
        let number = |named: &str| *home.objects.iter().find(|(_, object)| object.name == named).unwrap().0;
        let (wall, painting, floor) = (number("wall"), number("painting"), number("floor"));
        assert!((bare_share(&home, &[wall, wall, painting, floor]) - 0.5).abs() < 1e-9);
        assert_eq!(bare_share(&home, &[painting, floor, number("window"), 0]), 0.0);
    }

    #[test]
    fn views_are_counted_by_room() {
        let view = |room, is_bare| Seen { walk: (0, 0), room, is_bare };
        let told = told(&[view("hallway", true), view("hallway", false), view("kitchen", false)], 0, Duration::ZERO);
        assert_eq!(told.rooms, BTreeMap::from([("hallway", [1, 2]), ("kitchen", [0, 1])]));
        assert_eq!(told.half_wall.map(|share| (share.count, share.of)), Some((1, 3)));
    }
}
