//! Checks whether poses are plausible as they are read. People and robots move on a level plane, hold their cameras upright and
//! look where they go.
//!
//! Stairs climb at 35 degrees. If a path goes straight up again and again and hardly leaves a vertical plane, it was read
//! in the wrong axes, or it is the path of a drone or a lift. Whether the cameras are upright decides between the two. Another
//! reading is only advised if with it the cameras are upright, look along the path, and the path does not climb. The user's
//! settings in a `recording.toml` are not questioned, except where the cameras hang upside down: no picture shows that, and in a
//! mirrored world left and right would be swapped.
//!
//! Some readings differ only in left and right, or in up and down ([`axis_words`]). Poses cannot tell these apart, so all that fit
//! are named.

mod walk;

pub(crate) use walk::{PoseSample, RecordedWalk};

use crate::{
    axes::{PoseAxes, PoseBody, WorldUpAxis},
    describe::RecordingDescription,
    pose_reading::{NumberReading, PoseReading},
};

/// Shorter paths are not judged, metres.
const MIN_PATH_M: f64 = 3.0;
/// Other axes are only suggested if the cameras are this upright on average with them (the cosine of 37 degrees).
const WELL_UPRIGHT: f64 = 0.8;
/// Another reading is only suggested if with it the camera looks along the path at least this much.
const LOOKS_AHEAD: f64 = 0.7;
/// Readings that fit worse than the best by more than this are not suggested: the sum of both measures.
const FIT_SLACK: f64 = 0.1;
/// Most readings that an error lists.
const MAX_LISTED_READINGS: usize = 6;

/// Why poses are probably misread.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum PoseDoubt {
    /// With another reading the path is plausible, or with this one it cannot be right: the user has to choose.
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

/// The doubt about poses whose numbers have one reading, in the order of their times, if they are read with these axes.
#[cfg(any(feature = "lerobot", feature = "mcap", test))]
pub(crate) fn find_doubt(
    samples: &[PoseSample],
    axes: PoseAxes,
    described: &RecordingDescription,
) -> Option<PoseDoubt> {
    let walk = RecordedWalk::from_samples(samples.iter().copied())?;
    find_doubt_among(&[(NumberReading::default(), walk)], axes, described)
}

/// The doubt about poses: `walks` holds the walk for each possible reading of the numbers, and first the one that is used.
pub(crate) fn find_doubt_among(
    walks: &[(NumberReading, RecordedWalk)],
    axes: PoseAxes,
    described: &RecordingDescription,
) -> Option<PoseDoubt> {
    let (numbers, walk) = walks.first().filter(|(_, walk)| walk.length_m() >= MIN_PATH_M)?;
    let climbs = walk.is_climbing(axes.world) && !walk.is_level(axes.world);
    if !walk.is_oriented() {
        return if climbs { find_plane_doubt(walk, axes, described) } else { None };
    }
    let review = PoseReview { walks, present: PoseReading { numbers: *numbers, axes }, described };
    if walk.mean_up(axes) <= -WELL_UPRIGHT {
        return Some(review.doubt_upside_down());
    }
    review.doubt_present(walk, walk.is_upright(axes), climbs)
}

/// The doubt about positions alone: they stay in a plane that would be level in another world.
fn find_plane_doubt(walk: &RecordedWalk, axes: PoseAxes, described: &RecordingDescription) -> Option<PoseDoubt> {
    let is_likely = |world: &WorldUpAxis| *world != axes.world && walk.is_level(*world) && !walk.is_climbing(*world);
    let likely =
        [WorldUpAxis::ZUp, WorldUpAxis::YUp].into_iter().find(is_likely).filter(|_| described.world.is_none())?;
    let others = if likely == WorldUpAxis::YUp {
        "y-down if y grows downwards, unity if the world is left-handed: positions alone do not show which, and a wrong \
         one swaps left and right"
    } else {
        "unreal if the world is left-handed"
    };
    let (now, likely) = (axes.world.name(), likely.name());
    Some(PoseDoubt::Odd(format!(
        "read with world = \"{now}\", the path climbs and falls {:.1} m; read with world = \"{likely}\", it stays \
         level. If that is right, write world = \"{likely}\" into a recording.toml beside it ({others}), else write \
         world = \"{now}\"",
        walk.climbed_m(axes.world)
    )))
}

/// The doubt about the hand of a world with y up whose walk turns: of positions alone, nobody can tell Unity's from others.
pub(crate) fn find_hand_doubt(walk: &RecordedWalk, world: WorldUpAxis) -> Option<PoseDoubt> {
    let is_in_doubt = world == WorldUpAxis::YUp && walk.length_m() >= MIN_PATH_M && walk.bends();
    is_in_doubt.then(|| {
        PoseDoubt::Odd(
            "has positions only, and these do not show whether the world is left-handed. With world = \"y-up\" it is \
             read as right-handed (ARKit, OpenGL); if it is Unity's, write world = \"unity\", else left and right are swapped"
                .to_owned(),
        )
    })
}

/// Poses with orientations, the way they are read, and the other ways.
struct PoseReview<'a> {
    walks: &'a [(NumberReading, RecordedWalk)],
    present: PoseReading,
    described: &'a RecordingDescription,
}

impl PoseReview<'_> {
    /// Cameras hang upside down: whatever the user set is wrong, so all other readings are tried.
    fn doubt_upside_down(&self) -> PoseDoubt {
        let fitting = self.fitting_readings(|_| true);
        let now = self.present.all_settings();
        PoseDoubt::Misread(if fitting.is_empty() {
            format!(
                "read with {now}, the camera is upside down. Set `world` and `orientation` in a recording.toml; if the \
                 world is left-handed, \"unity\" or \"unreal\""
            )
        } else {
            format!(
                "read with {now}, the camera is upside down. {}",
                self.advice(&fitting, "into a recording.toml beside it", None)
            )
        })
    }

    /// The doubt about the present reading, with which the cameras do not hang upside down.
    fn doubt_present(&self, walk: &RecordedWalk, is_upright: bool, climbs: bool) -> Option<PoseDoubt> {
        let ahead = walk.ahead_share(self.present.axes);
        if is_upright && !climbs && ahead >= LOOKS_AHEAD && walk.mean_up(self.present.axes) >= WELL_UPRIGHT {
            return None;
        }
        let oddity = match (is_upright, climbs) {
            (true, true) => "the path climbs straight up",
            (false, true) => "the camera lies on its side and the path climbs straight up",
            (false, false) => "the camera lies on its side",
            (true, false) => "the camera looks away from the path",
        };
        // Once the camera has turned, hardly any wrong reading keeps it upright and ahead: a camera that looks to the side, back or
        // down, or is held on its side, has none.
        if walk.has_turn() {
            let fitting = self.fitting_readings(|other| self.is_allowed(other));
            if !fitting.is_empty() {
                return Some(PoseDoubt::Misread(self.describe(&fitting, oddity)));
            }
        }
        // On a straight walk, numbers in another order fit by chance, and so may the axes of another body.
        let has_same_numbers = |other: &PoseReading| other.numbers == self.present.numbers;
        if is_upright && !climbs {
            let fitting = self.fitting_readings(has_same_numbers);
            let looks_back = ahead <= -LOOKS_AHEAD && walk.has_turn() && !fitting.is_empty();
            return looks_back.then(|| PoseDoubt::Odd(self.describe(&fitting, "the camera looks back along the path")));
        }
        let fitting = self.fitting_readings(|other| self.is_allowed(other) && has_same_numbers(other));
        let first = fitting.first()?;
        let words = self.describe(&fitting, oddity);
        let is_certain = climbs && !is_upright && first.axes.world != self.present.axes.world;
        Some(if is_certain { PoseDoubt::Misread(words) } else { PoseDoubt::Odd(words) })
    }

    /// Whether the user's settings leave a reading open.
    fn is_allowed(&self, other: &PoseReading) -> bool {
        let present = self.present.axes;
        (self.described.world.is_none() || other.axes.world == present.world)
            && (self.described.orientation.is_none() || other.axes.body == present.body)
    }

    /// The other readings with which the cameras are upright and look along a path that does not climb, without those that fit
    /// clearly worse than the best. Those that differ least from the present one come first.
    fn fitting_readings(&self, is_wanted: impl Fn(&PoseReading) -> bool) -> Vec<PoseReading> {
        let mut fitting = Vec::new();
        // Read the other way round, a walk around a thing hardly moves, and would fit by chance.
        for (numbers, walk) in self.walks.iter().filter(|(_, walk)| walk.length_m() >= MIN_PATH_M) {
            let all = candidate_axes(self.present.axes).map(|axes| PoseReading { numbers: *numbers, axes });
            for other in all.filter(|other| *other != self.present && is_wanted(other)) {
                let (up, ahead) = (walk.mean_up(other.axes), walk.ahead_share(other.axes));
                let fits = walk.is_upright(other.axes) && up >= WELL_UPRIGHT && ahead >= LOOKS_AHEAD;
                if fits && !walk.is_climbing(other.axes.world) {
                    fitting.push((up + ahead, other));
                }
            }
        }
        let best = fitting.iter().map(|(fit, _)| *fit).fold(0.0, f64::max);
        fitting.retain(|(fit, _)| *fit >= best - FIT_SLACK);
        let mut fitting: Vec<PoseReading> = fitting.into_iter().map(|(_, other)| other).collect();
        fitting.sort_by_key(|other| other.count_changes(self.present));
        fitting.truncate(MAX_LISTED_READINGS);
        fitting
    }

    /// What is wrong with the present reading, and the settings to write.
    fn describe(&self, fitting: &[PoseReading], oddity: &str) -> String {
        let now = self.present.all_settings();
        let as_is = self.present.settings_against(fitting);
        let file = "into a recording.toml beside it";
        let likely = match fitting {
            [only] => format!("read with {}, ", only.all_settings()),
            _ => "read in another way, ".to_owned(),
        };
        format!(
            "read with {now}, {oddity}; {likely}the camera is upright and the path is level. {}",
            self.advice(fitting, file, Some(&as_is))
        )
    }

    /// The settings to write for each reading that fits; `as_is` are those with which nothing changes.
    fn advice(&self, fitting: &[PoseReading], file: &str, as_is: Option<&str>) -> String {
        let keep = as_is.map_or(String::new(), |now| format!(", or {now} if the poses are right as they are"));
        let settings = |other: &PoseReading| other.settings_from(self.present, self.described.orientation.is_some());
        match fitting {
            [only] => format!("Write {} {file}{keep}", settings(only)),
            _ => {
                let each = fitting.iter().map(|other| format!("{} ({})", settings(other), axis_words(other.axes)));
                let each = each.collect::<Vec<_>>().join(", or ");
                format!(
                    "These fit, and differ in left and right or in up and down; the poses do not show which is right. \
                     Write {each} {file}{keep}"
                )
            }
        }
    }
}

/// All axes that are tried in place of others. Unreal Engine's world is left out: it differs from a robot's only in left and right.
fn candidate_axes(present: PoseAxes) -> impl Iterator<Item = PoseAxes> {
    let right_handed = [WorldUpAxis::ZUp, WorldUpAxis::YUp, WorldUpAxis::YDown].into_iter();
    let right_handed =
        right_handed.flat_map(|world| [PoseBody::Robot, PoseBody::Optical, PoseBody::OpenGl].map(|body| (world, body)));
    let own_bodies = [(WorldUpAxis::Unity, PoseBody::Unity), (WorldUpAxis::Ned, PoseBody::Frd)];
    let own = (present.world, present.body);
    let all = right_handed.chain(own_bodies).chain((present.world == WorldUpAxis::Unreal).then_some(own));
    all.map(move |(world, body)| PoseAxes { world, body, ..present })
}

/// How the axes of a reading lie, for a user who has to choose.
const fn axis_words(axes: PoseAxes) -> &'static str {
    match axes.world {
        WorldUpAxis::ZUp => "z points up",
        WorldUpAxis::YUp => "y points up",
        WorldUpAxis::YDown => "y points down",
        WorldUpAxis::Unity => "left-handed, y points up: Unity",
        WorldUpAxis::Ned => "z points down: north-east-down",
        WorldUpAxis::Unreal => "left-handed, z points up: Unreal Engine",
    }
}

#[cfg(test)]
mod tests;
