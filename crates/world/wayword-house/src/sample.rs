//! Draws random paths through a house: a shortest way between two viewpoints, with frames along it and a target at its
//! end.

use super::{
    dice::HouseDice,
    graph::EYE_M,
    ground::HouseRoute,
    objects::{NumberedObject, ObjectRole},
    prepared_house::PreparedHouse,
};
use wayword_core::{
    DVec3, Frame, Heading, ObjectLabel, Path, PathRequest, PathTarget, PlatformError, Pose, SceneId, path::PathStop,
    seed::derive_seed,
};
use wayword_world::open_ground::{OpenGroundScene, no_such_walk, sample_open_path};

/// A corner nearer than this to the frame before it gets no frame of its own, metres.
const MIN_CORNER_DISTANCE_M: f64 = 0.4;
/// Upper bound of the length of a route over the length of the exact shortest way.
const MAX_ROUTE_EXCESS_FACTOR: f64 = 1.03;
/// A place this near to the height of a floor lies on it, metres.
const ON_FLOOR_M: f64 = 0.05;
/// Largest distance of a target from the last frame, to the nearest side of its box along the floor, metres.
const TARGET_REACH_M: f64 = 2.5;
/// A target is seen ahead from one of so many last frames.
const APPROACH_FRAMES: usize = 5;
/// Half the width of what a picture ahead shows, degrees.
const PICTURE_HALF_DEG: f64 = 35.0;
/// What is nearer to a walker than this, along the floor, lies below the picture, metres.
const MIN_PICTURED_M: f64 = 1.2;

/// Draws a path of a length that `request` allows, with frames at most `interval_m` apart and at every corner.
///
/// Both ends are random standing places. The path does not end in an opening, because a walker there is in no
/// room, nor on stairs. The target is in the room where the path ends. The first frame looks along the first move.
pub(super) fn sample_house_path(
    scene: &SceneId,
    home: &PreparedHouse,
    request: &PathRequest,
    seed: u64,
    interval_m: f64,
) -> Result<Path, PlatformError> {
    if home.longest_m() * MAX_ROUTE_EXCESS_FACTOR < *request.length_m.start() {
        return Err(no_such_walk(scene, request));
    }
    let dice = HouseDice::new(derive_seed(seed, &["house path"]), &[scene.as_str()]);
    let places = home.standing_places.clone();
    let goals = places.iter().copied().filter(|place| !home.is_in_opening(*place + DVec3::Z * EYE_M)).collect();
    let mut walker = HouseWalker { home, places, goals, dice, interval_m };
    sample_open_path(&mut walker, scene, request, seed)?.ok_or_else(|| no_such_walk(scene, request))
}

/// Chooses random paths through a house.
struct HouseWalker<'a> {
    home: &'a PreparedHouse,
    /// The places at which a path may begin.
    places: Vec<DVec3>,
    /// The places at which a path may end.
    goals: Vec<DVec3>,
    dice: HouseDice,
    interval_m: f64,
}

impl OpenGroundScene for HouseWalker<'_> {
    fn random_ends(&mut self) -> Option<(DVec3, DVec3)> {
        let mut draw_place = |places: &[DVec3]| places[self.dice.index(places.len())];
        (!self.goals.is_empty()).then(|| (draw_place(&self.places), draw_place(&self.goals)))
    }

    fn stops_between(&mut self, from: DVec3, to: DVec3) -> Result<Option<Vec<PathStop>>, PlatformError> {
        if !is_on_floor(to) {
            return Ok(None);
        }
        Ok(self.home.ground.shortest_route(from, to).ok().map(|way| stops_along(&way, self.interval_m)))
    }

    fn target_at(&mut self, frames: &[Frame]) -> Result<Option<PathTarget>, PlatformError> {
        choose_target(self.home, &mut self.dice, frames)
    }
}

/// Whether a place lies on the floor of a storey, and not on stairs.
fn is_on_floor(place: DVec3) -> bool {
    let storey_m = f64::from(super::model::STOREY_CM) / 100.0;
    (place.z - storey_m * (place.z / storey_m).round()).abs() < ON_FLOOR_M
}

/// The places of the frames along a way: at both ends, at corners, and between them at equal distances of at most
/// `interval_m`.
fn stops_along(way: &HouseRoute, interval_m: f64) -> Vec<PathStop> {
    let interval_m = if interval_m.is_finite() { interval_m.max(0.1) } else { 1.0 };
    let mut marks = vec![0];
    let last = way.places.len() - 1;
    for corner in &way.corners {
        let at = nearest_index(&way.places, *corner);
        let before = marks.last().copied().unwrap_or(0);
        let far = |a: usize, b: usize| way.places[a].distance(way.places[b]) >= MIN_CORNER_DISTANCE_M;
        if at > before && far(at, before) && far(at, last) {
            marks.push(at);
        }
    }
    marks.push(last);
    let mut chosen = vec![0];
    for leg in marks.windows(2) {
        let along = &way.places[leg[0]..=leg[1]];
        let length_m: f64 = along.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
        let count = (length_m / interval_m).ceil().max(1.0) as usize;
        chosen.extend((1..=count).map(|step| leg[0] + (leg[1] - leg[0]) * step / count));
    }
    chosen.dedup();
    chosen.into_iter().map(|at| stop_at(way.places[at])).collect()
}

fn nearest_index(places: &[DVec3], to: DVec3) -> usize {
    let off = |at: &usize| places[*at].distance_squared(to);
    (0..places.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0)
}

fn stop_at(place: DVec3) -> PathStop {
    let half_storey_m = f64::from(super::model::STOREY_CM) / 200.0;
    PathStop {
        position: place + DVec3::Z * EYE_M,
        viewpoint: None,
        level: Some(1 + u32::from(place.z > half_storey_m)),
    }
}

/// Chooses a target among the pieces of furniture in reach that the walker comes to see ahead: one without a namesake in the room, and
/// otherwise one that differs in colour from its namesakes.
fn choose_target(
    home: &PreparedHouse,
    dice: &mut HouseDice,
    frames: &[Frame],
) -> Result<Option<PathTarget>, PlatformError> {
    let Some(last) = frames.last().map(|frame| frame.pose) else { return Ok(None) };
    let house = &home.scene.house;
    let labels = home.labels_around(last)?;
    let room_of = |pose: &Pose| {
        let feet = pose.position - DVec3::Z * EYE_M;
        house.room_at(feet.x, feet.y, feet.z)
    };
    let room = room_of(&last);
    let stands_here =
        |object: &NumberedObject| object.role == ObjectRole::Furniture && house.rooms.get(object.room) == room;
    let furniture = || home.scene.objects.values().filter(|object| stands_here(object));
    let object_of = |label: &ObjectLabel| home.scene.objects.get(&label.object.as_str().parse::<u32>().ok()?);
    let in_reach = |label: &&ObjectLabel| {
        let feet = last.position - DVec3::Z * EYE_M;
        object_of(label)
            .is_some_and(|object| stands_here(object) && floor_distance_m(feet, object.bounds_m) <= TARGET_REACH_M)
    };
    let can_be_target = |label: &&ObjectLabel| label.name != "ceiling light" && label.name != "curtain";
    let near: Vec<&ObjectLabel> = labels.iter().filter(in_reach).filter(can_be_target).collect();
    let approach =
        frames.iter().rev().take(APPROACH_FRAMES).map(|frame| frame.pose).filter(|pose| room_of(pose) == room);
    let views = approach.map(|pose| Ok((pose, home.labels_ahead(pose)?))).collect::<Result<Vec<_>, PlatformError>>()?;
    let is_ahead = |label: &&ObjectLabel| {
        let is_seen = |seen: &[ObjectLabel]| seen.iter().any(|other| other.object == label.object);
        let sees = |pose: &Pose| label.position.is_some_and(|at| is_in_picture(pose, at));
        views.iter().any(|(pose, seen)| sees(pose) && is_seen(seen))
    };
    // How many pieces in the room have the label's kind, and pass the test.
    let alike = |label: &ObjectLabel, is_alike: &dyn Fn(&NumberedObject) -> bool| {
        furniture()
            .filter(|other| kind_word(&other.name) == kind_word(&label.name))
            .filter(|other| is_alike(other))
            .count()
    };
    let is_alone = |label: &&ObjectLabel| alike(label, &|_| true) == 1;
    let differs = |label: &&ObjectLabel| alike(label, &|other| other.colour == label.colour.as_deref()) == 1;
    let ahead: Vec<&ObjectLabel> = near.into_iter().filter(is_ahead).collect();
    let choices: [Vec<&ObjectLabel>; 2] =
        [ahead.iter().copied().filter(is_alone).collect(), ahead.iter().copied().filter(differs).collect()];
    let likely = choices.into_iter().find(|labels| !labels.is_empty());
    Ok(likely.map(|likely| likely[dice.index(likely.len())]).map(|label| PathTarget {
        object: label.object.clone(),
        name: label.name.clone(),
        told_by: Vec::new(),
        has_namesake: labels.iter().filter(|other| other.name == label.name).count() > 1,
        descriptions: Vec::new(),
        hangs: false,
        storeys: 0,
    }))
}

/// The word of a name that says what kind of thing it is: the last one.
fn kind_word(name: &str) -> &str {
    name.rsplit(' ').next().unwrap_or(name)
}

/// Whether a place is in the field of view of a picture ahead from a pose.
fn is_in_picture(pose: &Pose, at: DVec3) -> bool {
    let to = at - pose.position;
    let is_far_enough = to.truncate().length() >= MIN_PICTURED_M;
    is_far_enough
        && Heading::towards(pose.position, at)
            .is_some_and(|towards| pose.heading.turn_to(towards).to_degrees().abs() <= PICTURE_HALF_DEG)
}

/// The distance along the floor from a walker's feet to a box, metres.
fn floor_distance_m(feet: DVec3, (low, high): (DVec3, DVec3)) -> f64 {
    let nearest = feet.clamp(low.with_z(f64::MIN), high.with_z(f64::MAX));
    (nearest - feet).truncate().length()
}
