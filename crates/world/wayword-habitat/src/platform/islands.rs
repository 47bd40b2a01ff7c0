//! Chooses the island of a navmesh that paths stay on.
//!
//! Recast finds ground wherever there is room above it, so the top of a ceiling is ground too. Often it is even the
//! largest island, because no walls or furniture are on it. Two facts give it away: there is nothing above it, and there
//! are rooms below.

use crate::{
    ground::NavMeshGround,
    triangle_columns::{OverheadCover, TriangleColumns},
};
use wayword_core::{DVec3, GroundCover, GroundIsland, seeded_rng};

/// Random places that are examined on each island.
const PLACES_PER_ISLAND: usize = 400;
/// A place of a navmesh that is nearer to a surface lies on it, metres: on stairs it lies a little off.
const ON_SURFACE_M: f64 = 0.5;
/// Most islands that are examined, the largest first; paths never stay on another one, unless the user chooses it.
const MAX_ISLANDS: usize = 64;
/// Least area of an island that is examined, square metres.
const MIN_ISLAND_AREA_M2: f64 = 1.0;
/// Least share of an island that is under a ceiling, or under the sky on firm ground, for paths to stay on it.
const LEAST_USABLE_SHARE: f64 = 1.0 / 3.0;
/// Least share of an indoor island that is under a ceiling.
const LEAST_INDOOR_SHARE: f64 = 0.25;
/// Indoor islands come first only if their rooms have at least this share of the open ground's area: a shelter in a
/// field is not preferred to the field.
const LEAST_ROOMS_SHARE: f64 = 0.1;
/// If another island has this share of the chosen one's area, the user may prefer that one.
const RIVAL_AREA_SHARE: f64 = 0.5;
/// Most islands that an error or warning lists.
const MAX_LISTED_ISLANDS: usize = 6;

/// The cover over the places of an island, as shares of its area.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct IslandSurvey {
    pub(super) number: usize,
    area_m2: f64,
    /// The median height of its places.
    height_m: f64,
    /// Under a ceiling at which a person can stand upright.
    ceiling: f64,
    /// Under the sky, on firm ground.
    sky: f64,
    /// Under the sky, on the roof of a room.
    roof: f64,
    /// Under a ceiling that is too low to stand upright.
    low: f64,
}

/// The island that was chosen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct IslandChoice {
    pub(super) number: usize,
    /// Whether the user may prefer another one.
    pub(super) is_doubtful: bool,
}

/// Examines the islands, the largest first.
pub(super) fn survey_islands(ground: &NavMeshGround, columns: &TriangleColumns) -> Vec<IslandSurvey> {
    let worth =
        ground.islands_m2().enumerate().take(MAX_ISLANDS).take_while(|(_, area_m2)| *area_m2 >= MIN_ISLAND_AREA_M2);
    worth.map(|(number, area_m2)| survey_island(ground, columns, number, area_m2)).collect()
}

/// The share of the largest island that lies on a surface of the scene; 1 if there is no island.
pub(super) fn share_on_surfaces(ground: &NavMeshGround, columns: &TriangleColumns) -> f64 {
    let mut rng = seeded_rng(0, &["habitat surfaces"]);
    let places: Vec<DVec3> = (0..PLACES_PER_ISLAND)
        .filter_map(|_| ground.random_place(0, &mut rng))
        .map(|foothold| foothold.place)
        .collect();
    let lies_on_surface = |place: &&DVec3| {
        columns.drop_m(**place + DVec3::Z * ON_SURFACE_M).is_some_and(|drop_m| drop_m <= 2.0 * ON_SURFACE_M)
    };
    if places.is_empty() { 1.0 } else { places.iter().filter(lies_on_surface).count() as f64 / places.len() as f64 }
}

fn survey_island(ground: &NavMeshGround, columns: &TriangleColumns, number: usize, area_m2: f64) -> IslandSurvey {
    let mut rng = seeded_rng(0, &["habitat islands", &number.to_string()]);
    let places =
        (0..PLACES_PER_ISLAND).filter_map(|_| ground.random_place(number, &mut rng)).map(|foothold| foothold.place);
    let places: Vec<DVec3> = places.collect();
    let covers: Vec<OverheadCover> = places.iter().map(|place| columns.cover_over(*place)).collect();
    let share = |is: fn(&OverheadCover) -> bool| {
        covers.iter().filter(|cover| is(cover)).count() as f64 / covers.len().max(1) as f64
    };
    let mut heights: Vec<f64> = places.iter().map(|place| place.z).collect();
    heights.sort_by(f64::total_cmp);
    IslandSurvey {
        number,
        area_m2,
        height_m: heights.get(heights.len() / 2).copied().unwrap_or_default(),
        ceiling: share(|cover| matches!(cover, OverheadCover::Ceiling(_)) && cover.is_headroom()),
        sky: share(|cover| *cover == OverheadCover::Sky),
        roof: share(|cover| *cover == OverheadCover::SkyOnRoof),
        low: share(|cover| !cover.is_headroom()),
    }
}

/// Chooses the island that paths stay on: of the indoor islands, the one with the most area under a ceiling; an island
/// under the open sky only if the scene has almost no rooms. `None` if no island is a place to walk on.
pub(super) fn choose_island(surveys: &[IslandSurvey]) -> Option<IslandChoice> {
    let usable = || surveys.iter().filter(|survey| survey.ceiling + survey.sky >= LEAST_USABLE_SHARE);
    let best = |area: fn(&IslandSurvey) -> f64, candidates: Vec<&IslandSurvey>| {
        let better = |a: &&IslandSurvey, b: &&IslandSurvey| area(a).total_cmp(&area(b)).then(b.number.cmp(&a.number));
        candidates.into_iter().max_by(better).copied()
    };
    let open = best(IslandSurvey::open_m2, usable().collect());
    let rooms = best(IslandSurvey::rooms_m2, usable().filter(|survey| survey.ceiling >= LEAST_INDOOR_SHARE).collect());
    let open_m2 = open.map_or(0.0, |open| open.open_m2());
    let (chosen, room_m2): (IslandSurvey, fn(&IslandSurvey) -> f64) =
        match rooms.filter(|rooms| rooms.rooms_m2() >= LEAST_ROOMS_SHARE * open_m2) {
            Some(rooms) => (rooms, IslandSurvey::rooms_m2),
            None => (open?, IslandSurvey::open_m2),
        };
    let is_rival =
        |other: &&IslandSurvey| other.number != chosen.number && room_m2(other) >= RIVAL_AREA_SHARE * room_m2(&chosen);
    let is_doubtful =
        surveys.iter().any(|other| other.area_m2 > chosen.area_m2) || usable().any(|other| is_rival(&other));
    Some(IslandChoice { number: chosen.number, is_doubtful })
}

impl IslandSurvey {
    fn rooms_m2(&self) -> f64 {
        self.area_m2 * self.ceiling
    }

    fn open_m2(&self) -> f64 {
        self.area_m2 * self.sky
    }

    /// The island for display. `walked` is the number of the island that paths stay on.
    pub(super) fn ground_island(&self, walked: Option<usize>) -> GroundIsland {
        let covers = [
            (self.ceiling, GroundCover::Ceiling),
            (self.sky, GroundCover::Sky),
            (self.roof, GroundCover::OnRoof),
            (self.low, GroundCover::Low),
        ];
        // If two shares are equal, the first counts.
        let most = covers.into_iter().reduce(|best, other| if other.0 > best.0 { other } else { best });
        GroundIsland {
            number: self.number,
            area_m2: self.area_m2,
            height_m: self.height_m,
            cover: most.map_or(GroundCover::Sky, |(_, cover)| cover),
            is_walked: walked == Some(self.number),
        }
    }
}

/// The islands in words, the largest first.
pub(super) fn list_islands(surveys: &[IslandSurvey]) -> String {
    if surveys.is_empty() {
        return format!("it has no island of at least {MIN_ISLAND_AREA_M2} m2");
    }
    let named: Vec<String> =
        surveys.iter().take(MAX_LISTED_ISLANDS).map(|survey| survey.ground_island(None).to_string()).collect();
    let more = surveys.len().saturating_sub(MAX_LISTED_ISLANDS);
    let rest = if more > 0 { format!("; and {more} smaller") } else { String::new() };
    format!("{}{rest}", named.join("; "))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares: ceiling, sky, roof.
    fn island(number: usize, area_m2: f64, [ceiling, sky, roof]: [f64; 3]) -> IslandSurvey {
        IslandSurvey { number, area_m2, height_m: 0.0, ceiling, sky, roof, low: 1.0 - ceiling - sky - roof }
    }

    fn chosen(islands: &[IslandSurvey]) -> Option<(usize, bool)> {
        choose_island(islands).map(|choice| (choice.number, choice.is_doubtful))
    }

    #[test]
    fn the_top_of_a_ceiling_is_not_walked_on_however_large() {
        let flat = [island(0, 67.0, [0.0, 0.1, 0.9]), island(1, 43.5, [1.0, 0.0, 0.0])];
        assert_eq!(chosen(&flat), Some((1, true)), "a larger island might have been meant");
        assert_eq!(chosen(&flat[..1]), None);
    }

    #[test]
    fn rooms_come_before_the_garden_and_a_shelter_does_not_come_before_a_field() {
        let garden = island(0, 300.0, [0.02, 0.98, 0.0]);
        assert_eq!(chosen(&[garden, island(1, 80.0, [0.9, 0.1, 0.0])]), Some((1, true)));
        assert_eq!(chosen(&[garden, island(1, 4.0, [1.0, 0.0, 0.0])]), Some((0, false)));
        let house_with_garden = island(0, 300.0, [0.3, 0.7, 0.0]);
        assert_eq!(chosen(&[house_with_garden]), Some((0, false)));
    }

    #[test]
    fn a_scene_without_a_roof_is_walked_on_its_largest_ground() {
        let scene =
            [island(0, 50.0, [0.0, 1.0, 0.0]), island(1, 30.0, [0.0, 1.0, 0.0]), island(2, 2.0, [0.0, 1.0, 0.0])];
        assert_eq!(chosen(&scene), Some((0, true)), "another is more than half as large");
        assert_eq!(chosen(&[scene[0], scene[2]]), Some((0, false)));
    }

    #[test]
    fn no_island_is_chosen_without_headroom() {
        assert_eq!(chosen(&[island(0, 50.0, [0.1, 0.0, 0.0])]), None);
        assert_eq!(chosen(&[]), None);
    }

    #[test]
    fn listed_islands_show_area_height_and_cover() {
        let told = list_islands(&[island(0, 67.04, [0.0, 0.1, 0.9]), island(1, 43.5, [1.0, 0.0, 0.0])]);
        assert_eq!(
            told,
            "island 0: 67.0 m2 at height 0.0 m, on top of a roof; island 1: 43.5 m2 at height 0.0 m, under a ceiling"
        );
    }
}
