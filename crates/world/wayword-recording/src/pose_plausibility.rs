//! Checks whether poses are plausible with the axes by which they are read: those of the world and those of the body that
//! carries the camera. People and robots move on a level plane with their cameras upright.
//!
//! Stairs climb at 35 degrees. If a path goes straight up again and again and hardly leaves a vertical plane, it was read
//! in the wrong axes, or it is the path of a drone or a lift. Whether the cameras are upright decides between the two. The
//! user's settings `world` and `orientation` in a `recording.toml` are not questioned.

use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis},
    describe::RecordingDescription,
};
use wayword_core::DVec3;

/// Shorter paths are not judged, metres.
const MIN_PATH_M: f64 = 3.0;
/// Least length of a step of a path, metres: shorter ones are the tracker's noise.
const MIN_STEP_M: f64 = 0.4;
/// Steps that rise or fall by more than this share of their length are steeper than stairs and ramps (55 degrees).
const STEEP_SHARE: f64 = 0.82;
/// A path climbs if steep steps make up at least this share of its length. A single ladder makes up less.
const CLIMBING_SHARE: f64 = 0.25;
/// A path is level if it rises by at most this, metres, or by this share of its longest side.
const MAX_LEVEL_RISE_M: f64 = 0.5;
const MAX_LEVEL_RISE_SHARE: f64 = 0.08;
/// A camera is upright if its own up direction is within 60 degrees of the vertical (this is the cosine).
const UPRIGHT_COSINE: f64 = 0.5;
/// Cameras are upright in at least this share of the poses, if these are read with the right axes.
const UPRIGHT_POSES_SHARE: f64 = 0.9;
/// Other axes are only suggested if the cameras are this upright on average with them (the cosine of 37 degrees).
const WELL_UPRIGHT: f64 = 0.8;
/// Least share of the poses that must have an orientation.
const LEAST_ORIENTED_SHARE: f64 = 0.8;

/// A pose as it was recorded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseSample {
    pub(crate) position: DVec3,
    /// recorded_from_body by its columns, if the pose has an orientation.
    pub(crate) recorded_from_body: Option<[DVec3; 3]>,
}

/// Why poses are probably read with the wrong axes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum PoseDoubt {
    /// With other axes the path is plausible: the user has to choose.
    Misread(String),
    /// The path is unusual, but may be right.
    Odd(String),
}

#[cfg(any(feature = "lerobot", feature = "mcap"))]
impl PoseDoubt {
    /// The doubt in words for the user.
    pub(crate) fn into_words(self) -> String {
        match self {
            Self::Misread(words) | Self::Odd(words) => words,
        }
    }
}

/// The doubt about poses, in the order of their times, if they are read with these axes.
pub(crate) fn find_doubt(
    samples: &[PoseSample],
    axes: PoseAxes,
    described: &RecordingDescription,
) -> Option<PoseDoubt> {
    let walk = RecordedWalk::from_samples(samples).filter(|walk| walk.length_m >= MIN_PATH_M)?;
    let climbs = walk.is_climbing(axes.world) && !walk.is_level(axes.world);
    let is_upright = walk.is_upright(axes);
    if is_upright == Some(true) && !climbs {
        return None;
    }
    if let Some(likely) = likely_axes(&walk, axes, described) {
        let oddity = match (is_upright == Some(true), climbs) {
            (true, _) => "the path climbs straight up",
            (false, true) => "the camera lies on its side and the path climbs straight up",
            (false, false) => "the camera lies on its side",
        };
        let words = format!(
            "read with {}, {oddity}; read with {}, the camera is upright and the path is level. Write {} into a \
             recording.toml beside it, or {} if the poses are right as they are",
            axes_setting(axes),
            axes_setting(likely),
            changed_settings(axes, likely),
            axes_setting(axes)
        );
        // A drone may look straight down or go straight up, and a phone may be turned on its side. Only both together are
        // certain.
        let is_misread = climbs && is_upright == Some(false) && likely.world != axes.world;
        return Some(if is_misread { PoseDoubt::Misread(words) } else { PoseDoubt::Odd(words) });
    }
    match is_upright {
        Some(true) => None,
        Some(false) => walk.mean_up(axes).filter(|upright| *upright <= -WELL_UPRIGHT).map(|_| {
            PoseDoubt::Odd(format!(
                "read with {}, the camera is upside down: set `world` and `orientation` in a recording.toml, or \
                 rotate the poses so that z is up",
                axes_setting(axes)
            ))
        }),
        None => find_plane_doubt(&walk, axes, described).filter(|_| climbs),
    }
}

/// The doubt about positions alone: they stay in a plane that would be level in another world.
fn find_plane_doubt(walk: &RecordedWalk, axes: PoseAxes, described: &RecordingDescription) -> Option<PoseDoubt> {
    let is_likely = |world: &WorldUpAxis| *world != axes.world && walk.is_level(*world) && !walk.is_climbing(*world);
    let likely =
        [WorldUpAxis::ZUp, WorldUpAxis::YUp].into_iter().find(is_likely).filter(|_| described.world.is_none())?;
    let (now, likely) = (world_setting(axes.world), world_setting(likely));
    Some(PoseDoubt::Odd(format!(
        "read with {now}, the path climbs and falls {:.1} m; read with {likely}, it stays level. If that is right, \
         write {likely} into a recording.toml beside it (y-down if y grows downwards), else write {now}",
        walk.climbed_m(axes.world)
    )))
}

/// Other axes with which the cameras are upright and the path does not climb. Those that differ least from the present axes come
/// first, then those with which the camera looks in the direction of movement.
fn likely_axes(walk: &RecordedWalk, axes: PoseAxes, described: &RecordingDescription) -> Option<PoseAxes> {
    let worlds = [WorldUpAxis::ZUp, WorldUpAxis::YUp, WorldUpAxis::YDown].into_iter();
    let worlds = worlds.filter(|world| *world == axes.world || described.world.is_none());
    let all = worlds.flat_map(|world| {
        [PoseBody::Robot, PoseBody::Optical, PoseBody::OpenGl].map(|body| PoseAxes { world, body, ..axes })
    });
    let allowed = all.filter(|other| *other != axes && (other.body == axes.body || described.orientation.is_none()));
    let fits = |other: &PoseAxes| {
        walk.mean_up(*other).is_some_and(|upright| upright >= WELL_UPRIGHT) && !walk.is_climbing(other.world)
    };
    let changes = |other: &PoseAxes| usize::from(other.world != axes.world) + usize::from(other.body != axes.body);
    allowed
        .filter(fits)
        .min_by(|a, b| changes(a).cmp(&changes(b)).then(walk.distance_ahead(*b).total_cmp(&walk.distance_ahead(*a))))
}

/// A path in the frame of its recording.
struct RecordedWalk {
    /// At least a step apart.
    places: Vec<DVec3>,
    length_m: f64,
    /// Orientations at those places; empty if too few poses have one.
    recorded_from_body: Vec<[DVec3; 3]>,
}

impl RecordedWalk {
    fn from_samples(samples: &[PoseSample]) -> Option<Self> {
        let mut places: Vec<DVec3> = Vec::new();
        let mut orientations = Vec::new();
        for sample in samples.iter().filter(|sample| sample.position.is_finite()) {
            if places.last().is_none_or(|last: &DVec3| last.distance(sample.position) >= MIN_STEP_M) {
                places.push(sample.position);
                orientations.extend(sample.recorded_from_body);
            }
        }
        if (orientations.len() as f64) < LEAST_ORIENTED_SHARE * places.len() as f64 {
            orientations.clear();
        }
        let length_m = places.array_windows().map(|[from, to]| from.distance(*to)).sum();
        (!places.is_empty()).then_some(Self { places, length_m, recorded_from_body: orientations })
    }

    /// The way from each place to the next.
    fn steps(&self) -> impl Iterator<Item = DVec3> {
        self.places.array_windows().map(|[from, to]| *to - *from)
    }

    /// The vertical component of the camera's up direction, pose by pose; empty if too few poses have an orientation.
    fn up_components(&self, axes: PoseAxes) -> impl Iterator<Item = f64> {
        self.recorded_from_body
            .iter()
            .map(move |columns| axes.wayword_from_recorded(recorded_direction(columns, axes.body_up())).z)
    }

    /// The mean of [`RecordedWalk::up_components`].
    fn mean_up(&self, axes: PoseAxes) -> Option<f64> {
        (!self.recorded_from_body.is_empty())
            .then(|| self.up_components(axes).sum::<f64>() / self.recorded_from_body.len() as f64)
    }

    /// Whether the camera is upright in most of the poses; `None` if too few of them have an orientation.
    fn is_upright(&self, axes: PoseAxes) -> Option<bool> {
        let upright = self.up_components(axes).filter(|up| *up >= UPRIGHT_COSINE).count();
        (!self.recorded_from_body.is_empty())
            .then_some(upright as f64 >= UPRIGHT_POSES_SHARE * self.recorded_from_body.len() as f64)
    }

    /// Distance that the steps cover in the camera's view direction, metres.
    fn distance_ahead(&self, axes: PoseAxes) -> f64 {
        self.steps()
            .zip(&self.recorded_from_body)
            .map(|(step, columns)| recorded_direction(columns, axes.body_ahead()).dot(step))
            .sum()
    }

    /// Whether a large part of the path goes straight up or down.
    fn is_climbing(&self, world: WorldUpAxis) -> bool {
        let up = up_direction(world);
        let steep = self.steps().filter(|step| step.dot(up).abs() > STEEP_SHARE * step.length());
        steep.map(DVec3::length).sum::<f64>() >= CLIMBING_SHARE * self.length_m
    }

    /// The distance that the path rises plus the distance that it falls, metres.
    fn climbed_m(&self, world: WorldUpAxis) -> f64 {
        self.steps().map(|step| step.dot(up_direction(world)).abs()).sum()
    }

    /// Whether the path stays in a plane that is level in a world.
    fn is_level(&self, world: WorldUpAxis) -> bool {
        let low = self.places.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = self.places.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let extent = high - low;
        extent.dot(up_direction(world)).abs() <= MAX_LEVEL_RISE_M.max(MAX_LEVEL_RISE_SHARE * extent.max_element())
    }
}

/// A direction in the body's frame, turned into the recorded frame by the columns of recorded_from_body.
fn recorded_direction([x, y, z]: &[DVec3; 3], of_body: DVec3) -> DVec3 {
    *x * of_body.x + *y * of_body.y + *z * of_body.z
}

/// The up direction in the recorded frame.
fn up_direction(world: WorldUpAxis) -> DVec3 {
    match world {
        WorldUpAxis::ZUp => DVec3::Z,
        WorldUpAxis::YUp => DVec3::Y,
        WorldUpAxis::YDown => DVec3::NEG_Y,
    }
}

fn world_setting(world: WorldUpAxis) -> String {
    format!("world = \"{}\"", world.name())
}

fn axes_setting(axes: PoseAxes) -> String {
    format!("world = \"{}\" and orientation = \"{}\"", axes.world.name(), axes.body.name())
}

/// The settings that differ between two sets of axes, as they are written in `recording.toml`.
fn changed_settings(from: PoseAxes, to: PoseAxes) -> String {
    let world = (from.world != to.world).then(|| world_setting(to.world));
    let body = (from.body != to.body).then(|| format!("orientation = \"{}\"", to.body.name()));
    world.into_iter().chain(body).collect::<Vec<_>>().join(" and ")
}

#[cfg(test)]
mod tests;
