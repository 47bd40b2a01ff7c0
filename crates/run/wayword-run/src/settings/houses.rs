//! `--houses`: how many generated houses the random paths of a run lie in.

use super::{RunSettings, Walks};
use crate::error::CommandError;
use wayword_core::SceneId;
use wayword_house::scene_name;

/// The platform of generated houses.
pub(crate) const HOUSE_PLATFORM: &str = "house";

/// Refuses a number of houses that does not fit the other settings.
pub(super) fn refuse_unfit_houses(
    houses: usize,
    paths: usize,
    seed: u64,
    platform: &str,
    walks: &Walks,
) -> Result<(), CommandError> {
    let refused = |problem: String, hint: &str| Err(CommandError::usage(problem, hint));
    if platform != HOUSE_PLATFORM {
        let problem = format!("--houses is for generated houses, and the platform is {platform}");
        return refused(problem, "leave --houses out; --scan names the scenes of a platform");
    }
    if walks.episodes.is_some() || walks.scan.is_some() {
        let other = if walks.scan.is_some() { "--scan" } else { "--episodes" };
        return refused(format!("--houses and {other} cannot be combined"), "give one of them");
    }
    if houses == 0 {
        return refused("--houses 0 leaves no house".to_owned(), "give at least 1, or leave the flag out for 20");
    }
    if houses > paths {
        return refused(
            format!("--houses {houses} is more than --paths {paths}, and a path lies in one house"),
            "ask for as many paths, or for fewer houses",
        );
    }
    if seed.checked_add(houses as u64 - 1).is_none() {
        return refused(format!("--seed {seed} leaves no seeds for {houses} houses"), "give a smaller seed");
    }
    Ok(())
}

/// The houses of a run that asks for a number of them, in the order of their seeds.
///
/// # Errors
/// When a name of a house is no name of a scene.
pub(crate) fn asked_houses(settings: &RunSettings) -> Result<Option<Vec<SceneId>>, CommandError> {
    let Some(houses) = settings.houses else { return Ok(None) };
    let seeds = (0..houses as u64).map(|number| settings.seed.wrapping_add(number));
    let scene = |seed: u64| {
        SceneId::new(scene_name(seed))
            .map_err(|error| CommandError::usage(format!("house {seed}: {error}"), "report this as a bug"))
    };
    seeds.map(scene).collect::<Result<_, _>>().map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{AskedPlatform, AskedSettings, Draw};

    fn asked(paths: Option<usize>, houses: usize, seed: u64) -> AskedSettings {
        AskedSettings {
            walks: Walks { paths, houses: Some(houses), ..Walks::default() },
            draw: Draw { seed: Some(seed), ..Draw::default() },
            ..AskedSettings::default()
        }
    }

    #[test]
    fn houses_that_do_not_fit_are_refused_with_words() {
        let told = |asked: AskedSettings| asked.resolve().unwrap_err().to_string();
        assert!(told(asked(Some(5), 0, 0)).contains("--houses 0"));
        assert!(told(asked(Some(5), 6, 0)).contains("--houses 6 is more than --paths 5"));
        assert!(told(asked(None, 11, 0)).contains("--paths 10"));
        assert!(told(asked(Some(5), 5, u64::MAX - 1)).contains("--seed"));
        assert!(asked(Some(5), 2, u64::MAX - 1).resolve().is_ok());
        let platform = AskedPlatform { platform: Some("matterport".into()), ..AskedPlatform::default() };
        let elsewhere = AskedSettings { platform, ..asked(Some(5), 5, 0) };
        assert!(told(elsewhere).contains("the platform is matterport"));
        let with = |walks: Walks| AskedSettings { walks, ..AskedSettings::default() };
        let episodes = Walks { episodes: Some("x.json".into()), houses: Some(1), ..Walks::default() };
        assert!(told(with(episodes)).contains("--houses and --episodes"));
        let scan = Walks { scan: Some(vec!["house2-1".into()]), houses: Some(1), ..Walks::default() };
        assert!(told(with(scan)).contains("--houses and --scan"));
    }

    #[test]
    fn a_flag_for_houses_replaces_the_scenes_and_the_episodes_of_a_file() {
        let file: AskedSettings = toml::from_str("scan = [\"house2-3\"]\nepisodes = \"x.json\"").unwrap();
        let both = asked(Some(4), 2, 0).or_file(file).resolve().unwrap();
        assert_eq!((both.houses, both.scan.len(), both.episodes), (Some(2), 0, None));
        let file: AskedSettings = toml::from_str("houses = 3\npaths = 9").unwrap();
        let scan = Walks { scan: Some(vec!["house2-3".into()]), ..Walks::default() };
        let named = AskedSettings { walks: scan, ..AskedSettings::default() }.or_file(file).resolve().unwrap();
        assert_eq!((named.houses, named.paths), (None, 9));
    }
}
