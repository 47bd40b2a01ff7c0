//! A recorded path, and how plausible it is with given axes: how upright its cameras are, where they look and how it climbs.

use crate::axes::{PoseAxes, WorldUpAxis};
use wayword_core::DVec3;

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
/// Least share of the poses that must have an orientation.
const LEAST_ORIENTED_SHARE: f64 = 0.8;
/// A camera has turned where its orientation differs from the first by more than 45 degrees. For the angle of a rotation, this is
/// the trace of its matrix: 1 + 2 cos 45°.
const TURNED_TRACE: f64 = 2.414;
/// A walk has a turn if the camera has turned in at least this share of the places.
const TURNED_PLACES_SHARE: f64 = 0.15;

/// A pose as it was recorded.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PoseSample {
    pub(crate) position: DVec3,
    /// recorded_from_body by its columns, if the pose has an orientation.
    pub(crate) recorded_from_body: Option<[DVec3; 3]>,
}

/// A path in the frame of its recording.
pub(crate) struct RecordedWalk {
    /// At least a step apart.
    places: Vec<DVec3>,
    length_m: f64,
    /// Orientations at those places; empty if too few poses have one.
    recorded_from_body: Vec<[DVec3; 3]>,
}

impl RecordedWalk {
    /// The path of samples in the order of their times; `None` without a valid position.
    pub(crate) fn from_samples(samples: impl IntoIterator<Item = PoseSample>) -> Option<Self> {
        let mut places: Vec<DVec3> = Vec::new();
        let mut orientations = Vec::new();
        for sample in samples.into_iter().filter(|sample| sample.position.is_finite()) {
            if places.last().is_none_or(|last: &DVec3| last.distance(sample.position) >= MIN_STEP_M) {
                places.push(sample.position);
                orientations.push(sample.recorded_from_body);
            }
        }
        let oriented = orientations.iter().flatten().count();
        let mut recorded_from_body: Vec<[DVec3; 3]> = Vec::new();
        if oriented as f64 >= LEAST_ORIENTED_SHARE * places.len() as f64 {
            // A pose without an orientation counts as the one before, so that each place has one.
            let first = orientations.iter().flatten().next().copied();
            for orientation in orientations {
                recorded_from_body.extend(orientation.or(recorded_from_body.last().copied()).or(first));
            }
        }
        let length_m = places.array_windows().map(|[from, to]| from.distance(*to)).sum();
        (!places.is_empty()).then_some(Self { places, length_m, recorded_from_body })
    }

    pub(super) fn length_m(&self) -> f64 {
        self.length_m
    }

    /// Whether enough of its poses have an orientation.
    pub(super) fn is_oriented(&self) -> bool {
        !self.recorded_from_body.is_empty()
    }

    /// The way from each place to the next.
    fn steps(&self) -> impl Iterator<Item = DVec3> {
        self.places.array_windows().map(|[from, to]| *to - *from)
    }

    /// The vertical component of the camera's up direction, pose by pose; empty if too few poses have an orientation.
    fn up_components(&self, axes: PoseAxes) -> impl Iterator<Item = f64> {
        self.recorded_from_body
            .iter()
            .map(move |columns| recorded_direction(columns, axes.body_up()).dot(axes.world.up()))
    }

    /// The mean of [`RecordedWalk::up_components`]; 0 if too few poses have an orientation.
    pub(super) fn mean_up(&self, axes: PoseAxes) -> f64 {
        self.up_components(axes).sum::<f64>() / self.recorded_from_body.len().max(1) as f64
    }

    /// Whether the camera is upright in most of the poses; false if too few of them have an orientation.
    pub(super) fn is_upright(&self, axes: PoseAxes) -> bool {
        let upright = self.up_components(axes).filter(|up| *up >= UPRIGHT_COSINE).count();
        self.is_oriented() && upright as f64 >= UPRIGHT_POSES_SHARE * self.recorded_from_body.len() as f64
    }

    /// How much the camera looks along the path, seen from above, from -1 (back) to 1: the mean cosine of the angle between both,
    /// where each step counts by its length. 0 if too few poses have an orientation.
    pub(super) fn ahead_share(&self, axes: PoseAxes) -> f64 {
        let up = axes.world.up();
        let level = |vector: DVec3| vector - up * vector.dot(up);
        // A direction that is nearly vertical counts little: it is that of a body that was misread.
        let looking = |columns| level(turned_about(recorded_direction(columns, axes.body_ahead()), up, axes));
        let mut looked_m = 0.0;
        for (step, [from, to]) in self.steps().zip(self.recorded_from_body.array_windows()) {
            // Both ends count: the camera turns somewhere between them.
            looked_m += (looking(from) + looking(to)).dot(level(step)) / 2.0;
        }
        looked_m / self.steps().map(|step| level(step).length()).sum::<f64>().max(f64::MIN_POSITIVE)
    }

    /// Whether the camera turned by more than 45 degrees for a part of the walk. Without that, many readings of its numbers fit.
    pub(super) fn has_turn(&self) -> bool {
        let Some(first) = self.recorded_from_body.first() else { return false };
        let trace = |columns: &[DVec3; 3]| columns.iter().zip(first).map(|(column, other)| column.dot(*other)).sum();
        let turned = self.recorded_from_body.iter().filter(|columns| -> bool {
            let trace: f64 = trace(columns);
            trace < TURNED_TRACE
        });
        turned.count() as f64 >= TURNED_PLACES_SHARE * self.recorded_from_body.len() as f64
    }

    /// Whether the path leaves the straight line from its first place to its last by more than a step.
    pub(super) fn bends(&self) -> bool {
        let (Some(first), Some(last)) = (self.places.first(), self.places.last()) else { return false };
        let along = (*last - *first).normalize_or_zero();
        self.places.iter().any(|place| {
            let way = *place - *first;
            (way - along * way.dot(along)).length() > MIN_STEP_M
        })
    }

    /// Whether a large part of the path goes straight up or down.
    pub(super) fn is_climbing(&self, world: WorldUpAxis) -> bool {
        let steep = self.steps().filter(|step| step.dot(world.up()).abs() > STEEP_SHARE * step.length());
        steep.map(DVec3::length).sum::<f64>() >= CLIMBING_SHARE * self.length_m
    }

    /// The distance that the path rises plus the distance that it falls, metres.
    pub(super) fn climbed_m(&self, world: WorldUpAxis) -> f64 {
        self.steps().map(|step| step.dot(world.up()).abs()).sum()
    }

    /// Whether the path stays in a plane that is level in a world.
    pub(super) fn is_level(&self, world: WorldUpAxis) -> bool {
        let low = self.places.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = self.places.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let extent = high - low;
        extent.dot(world.up()).abs() <= MAX_LEVEL_RISE_M.max(MAX_LEVEL_RISE_SHARE * extent.max_element())
    }
}

/// A direction in the body's frame, turned into the recorded frame by the columns of recorded_from_body.
fn recorded_direction([x, y, z]: &[DVec3; 3], of_body: DVec3) -> DVec3 {
    *x * of_body.x + *y * of_body.y + *z * of_body.z
}

/// A direction turned by the camera's mounting, clockwise seen from above.
fn turned_about(recorded: DVec3, up: DVec3, axes: PoseAxes) -> DVec3 {
    // A positive angle about the axis that points up is clockwise in a left-handed world.
    let angle_rad = if axes.world.is_left_handed() { axes.mount_rad } else { -axes.mount_rad };
    let (sine, cosine) = (libm::sin(angle_rad), libm::cos(angle_rad));
    recorded * cosine + up.cross(recorded) * sine + up * (up.dot(recorded) * (1.0 - cosine))
}
