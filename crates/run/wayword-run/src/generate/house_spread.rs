//! Says how many generated houses the random paths of a run lie in.

use crate::{
    count::count_phrase,
    item::RunItem,
    settings::{RunSettings, houses::HOUSE_PLATFORM},
};
use std::collections::BTreeMap;
use wayword_core::SceneId;

/// How many houses the random paths of a run lie in, as a line for the user; `None` for other runs, and where the user named the
/// houses.
pub(super) fn house_spread(settings: &RunSettings, items: &[RunItem]) -> Option<String> {
    if settings.platform != HOUSE_PLATFORM || settings.episodes.is_some() || !settings.scan.is_empty() {
        return None;
    }
    let mut paths_in: BTreeMap<&SceneId, usize> = BTreeMap::new();
    for item in items {
        *paths_in.entry(item.scene()).or_default() += 1;
    }
    let (least, most) = (paths_in.values().min()?, paths_in.values().max()?);
    let (paths, houses) = (items.len(), paths_in.len());
    let each = if least == most { format!("{most} each") } else { format!("{least} to {most} each") };
    let spread = format!("{} through {}", count_phrase(paths, "path"), count_phrase(houses, "house"));
    Some(match houses < paths {
        true => format!("{spread}, {each}; --houses {paths} for as many houses"),
        false => format!("{spread}, {each}"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        item::run_items,
        platforms,
        settings::{AskedSettings, Draw, Walks},
    };
    use wayword_house::scene_name;

    fn asked(paths: Option<usize>, houses: usize, seed: u64) -> AskedSettings {
        AskedSettings {
            walks: Walks { paths, houses: Some(houses), ..Walks::default() },
            draw: Draw { seed: Some(seed), ..Draw::default() },
            ..AskedSettings::default()
        }
    }

    fn scenes(settings: &RunSettings) -> Vec<String> {
        let platform = platforms::open_platform(settings).unwrap();
        run_items(settings, platform.as_ref()).unwrap().iter().map(|item| item.scene().to_string()).collect()
    }

    #[test]
    fn each_path_lies_in_its_own_house_where_there_are_as_many() {
        let settings = asked(Some(30), 30, 7).resolve().unwrap();
        assert_eq!(scenes(&settings), (7..37).map(scene_name).collect::<Vec<_>>());
        let platform = platforms::open_platform(&settings).unwrap();
        let items = run_items(&settings, platform.as_ref()).unwrap();
        assert_eq!(house_spread(&settings, &items).unwrap(), "30 paths through 30 houses, 1 each");
    }

    #[test]
    fn paths_are_spread_evenly_over_fewer_houses() {
        let settings = asked(Some(7), 2, 0).resolve().unwrap();
        let names = scenes(&settings);
        assert_eq!(names[..4], ["house2-0"; 4]);
        assert_eq!(names[4..], ["house2-1"; 3]);
        let platform = platforms::open_platform(&settings).unwrap();
        let items = run_items(&settings, platform.as_ref()).unwrap();
        let told = house_spread(&settings, &items).unwrap();
        assert_eq!(told, "7 paths through 2 houses, 3 to 4 each; --houses 7 for as many houses");
        // Without the flag there are twenty.
        let usual = AskedSettings { walks: Walks { paths: Some(500), ..Walks::default() }, ..AskedSettings::default() };
        let usual = usual.resolve().unwrap();
        let items = run_items(&usual, platform.as_ref()).unwrap();
        let told = house_spread(&usual, &items).unwrap();
        assert_eq!(told, "500 paths through 20 houses, 25 each; --houses 500 for as many houses");
    }
}
