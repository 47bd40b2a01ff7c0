//! The yaw between two pictures.
//!
//! For each candidate yaw the camera is taken to have moved ahead, halfway between its two headings, as a walker does.
//! Then each patch lies on a known curve of the second panorama, and where on it says how near its thing is. So a near
//! wall that slides past at one side is no turn: the patches of the other side do not agree.
#![expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "counts and places of a panorama of a hundred pixels; agreements need no more than f32"
)]

use super::panorama::{PANORAMA_COLUMNS, PicturePanorama};
use super::patches::{ENLARGED, PicturePatch, UNSEEN, matched_patches};

/// Steps ahead that are tried, in distances of the patch's thing.
const STEPS_AHEAD: [f64; 8] = [0.0, 0.025, 0.05, 0.08, 0.12, 0.17, 0.24, 0.32];
/// A far thing is a little likelier than a near one: so much less counts the agreement for a full step ahead.
const NEARNESS_COST: f32 = 0.3;
/// The largest yaw tried, as a share of the field of view, and at all.
const MOST_TURN: (f64, f64) = (0.75, 1.05);
/// Columns around the best yaw in which another yaw is the same peak.
const PEAK_COLUMNS: usize = 7;
/// Pixels by which the picture may have shifted up or down.
const SHIFTS_DOWN: [isize; 7] = [-6, -4, -2, 0, 2, 4, 6];
/// Counts for patches that a yaw moves out of sight, so that a few left do not decide.
const UNSEEN_WEIGHT: f32 = 0.2;

/// Least sum of weights: so many patches that fit one place only.
const LEAST_WEIGHT: f32 = 4.0;
/// Least agreement on no yaw.
const LEAST_AGREEMENT: f32 = 0.34;
/// How much more agreement a yaw needs.
const AGREEMENT_PER_RAD: f32 = 0.3;
/// Least distance to the rival's agreement, and most share of the best that the rival may have: before a wall with a
/// pattern, several yaws agree well.
const LEAST_MARGIN: f32 = 0.1;
/// See [`LEAST_MARGIN`].
const MOST_RIVAL_SHARE: f32 = 0.62;
/// Share of patches that have not moved at all, beyond which the camera has not turned far, and not at all: then a
/// thing passes before it. Some may be part of the robot itself.
pub(crate) const MOST_STILL: (f32, f32) = (0.1, 0.3);
/// What is far.
const FAR_TURN_RAD: f64 = 0.05;
/// Share beyond which it stands still.
const LEAST_STILL: f32 = 0.4;

/// How the camera moved between two pictures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PicturePairMotion {
    /// How far it turned right; none if the pictures do not tell.
    pub(super) yaw_rad: Option<f64>,
    /// Whether it stood still.
    pub(super) is_still: bool,
    /// What decided.
    pub(super) scores: PicturePairScores,
}

/// What decides whether a yaw is believed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct PicturePairScores {
    /// The best yaw, believed or not.
    pub(super) best_yaw_rad: f64,
    /// How well the patches agree on it, 0 to 1.
    pub(super) agreement: f32,
    /// How well they agree on the best of the other yaws.
    pub(super) rival: f32,
    /// Sum of the patches' weights: how many there are that fit few places.
    pub(super) weight: f32,
    /// Share of the patches that have not moved at all.
    pub(super) still: f32,
}

/// Compares two pictures.
pub(super) fn motion_between(from: &PicturePanorama, to: &PicturePanorama) -> PicturePairMotion {
    let patches = matched_patches(from, to);
    let scores = scores(&patches, from);
    let is_still = scores.weight >= LEAST_WEIGHT / 2.0 && scores.still >= LEAST_STILL;
    let yaw_rad = if is_still { Some(0.0) } else { is_sure(&scores).then_some(scores.best_yaw_rad) };
    PicturePairMotion { yaw_rad, is_still, scores }
}

/// Whether the best yaw is to be believed. Little is left in sight after a large yaw and agrees by chance more easily,
/// so that needs more. If much has not moved at all, what moved is something else than the camera.
fn is_sure(scores: &PicturePairScores) -> bool {
    let least = LEAST_AGREEMENT + AGREEMENT_PER_RAD * scores.best_yaw_rad.abs() as f32;
    let most_rival = (scores.agreement - LEAST_MARGIN).min(scores.agreement * MOST_RIVAL_SHARE);
    let is_alone = scores.agreement >= least && scores.rival <= most_rival;
    let most_still = if scores.best_yaw_rad.abs() > FAR_TURN_RAD { MOST_STILL.0 } else { MOST_STILL.1 };
    is_alone && scores.weight >= LEAST_WEIGHT && scores.still < most_still
}

/// Searches for the yaw.
fn scores(patches: &[PicturePatch], from: &PicturePanorama) -> PicturePairScores {
    let model = TurnSearch::new(from);
    let profiles: Vec<PatchProfile> = patches.iter().map(|patch| model.profile(patch)).collect();
    let weight: f32 = profiles.iter().map(|profile| profile.weight).sum();
    if weight <= 0.0 {
        return PicturePairScores::default();
    }
    let still =
        patches.iter().zip(&profiles).map(|(patch, profile)| profile.weight * stillness(patch)).sum::<f32>() / weight;
    let (mut best, mut curve) = ((UNSEEN, 0, 0), vec![]);
    for (at_shift, _) in SHIFTS_DOWN.iter().enumerate() {
        let agreements = model.agreements(&profiles, at_shift, weight);
        let top = agreements.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, UNSEEN));
        if top.1 > best.0 {
            best = (top.1, top.0, at_shift);
            curve.clone_from(&agreements);
        }
    }
    let far = |at: &usize| at.abs_diff(best.1) > PEAK_COLUMNS;
    let rival = (0..curve.len()).filter(far).filter_map(|at| curve.get(at).copied()).fold(0.0, f32::max);
    let shift = SHIFTS_DOWN.get(best.2).copied().unwrap_or(0);
    let column = model.refined(patches, &profiles, best.1.cast_signed() - model.most_turn.cast_signed(), shift);
    PicturePairScores { best_yaw_rad: column * from.column_rad, agreement: best.0, rival, weight, still }
}

/// Where the peak of a parabola through a value and its two neighbours lies, in steps from that value.
pub(crate) fn peak_between(curve: &[f64], at: usize) -> f64 {
    let value = |at: usize| curve.get(at).copied();
    let (Some(before), Some(here), Some(after)) = (at.checked_sub(1).and_then(value), value(at), value(at + 1)) else {
        return 0.0;
    };
    let bend = before - 2.0 * here + after;
    if bend >= -1e-9 { 0.0 } else { (0.5 * (before - after) / bend).clamp(-0.5, 0.5) }
}

/// 1 if the patch agrees with its own place, and better than with those beside it.
fn stillness(patch: &PicturePatch) -> f32 {
    let (column, row) = (patch.column.cast_signed(), patch.row.cast_signed());
    let value = |right: isize, down: isize| patch.plain.at(column + right, row + down);
    let here = value(0, 0);
    let off = [(-1, 0), (1, 0), (0, -1), (0, 1)].map(|(right, down)| value(right, down));
    let is_still = here > 0.8
        && off.iter().all(|&other| here >= other)
        && (off[0] - off[1]).abs() < 0.5 * (here - off[0].min(off[1]));
    f32::from(u8::from(is_still))
}

/// How well a patch agrees with each yaw, for each shift down; none where the yaw moves it out of sight.
struct PatchProfile {
    support: Vec<Option<f32>>,
    weight: f32,
}

/// The candidates that are tried.
struct TurnSearch {
    /// The largest yaw, columns.
    most_turn: usize,
    rows: usize,
    /// For each angle from the way ahead, in half columns, and each step: where a thing there goes.
    approaches: Vec<SeenAfterStep>,
}

/// Where a thing is seen after a step ahead.
struct SeenAfterStep {
    /// Its angle from the way ahead, columns.
    columns: f64,
    /// How much larger it is.
    zoom: f64,
}

impl SeenAfterStep {
    /// A thing at an angle from the way ahead, after a step that is measured in the thing's distance.
    fn of(angle_rad: f64, step: f64, column_rad: f64) -> Self {
        let (side, ahead) = (libm::sin(angle_rad), libm::cos(angle_rad) - step);
        Self { columns: libm::atan2(side, ahead) / column_rad, zoom: 1.0 / libm::hypot(side, ahead) }
    }
}

impl TurnSearch {
    /// Largest angle of a patch from the way ahead, half columns: the edge of the panorama after the largest yaw.
    const MOST_HALF_COLUMNS: isize = 2 * PANORAMA_COLUMNS.cast_signed();

    #[expect(clippy::cast_sign_loss, reason = "less than PANORAMA_COLUMNS")]
    fn new(from: &PicturePanorama) -> Self {
        let most_rad = (MOST_TURN.0 * PANORAMA_COLUMNS as f64 * from.column_rad).min(MOST_TURN.1);
        let approaches = (-Self::MOST_HALF_COLUMNS..=Self::MOST_HALF_COLUMNS)
            .map(|half_columns| half_columns as f64 / 2.0 * from.column_rad)
            .flat_map(|angle_rad| STEPS_AHEAD.map(|step| SeenAfterStep::of(angle_rad, step, from.column_rad)))
            .collect();
        Self { most_turn: (most_rad / from.column_rad) as usize, rows: from.rows, approaches }
    }

    /// The candidate yaws, columns.
    fn turns(&self) -> impl Iterator<Item = isize> {
        -self.most_turn.cast_signed()..=self.most_turn.cast_signed()
    }

    /// What a patch says about all candidates.
    fn profile(&self, patch: &PicturePatch) -> PatchProfile {
        let mut support = Vec::with_capacity((2 * self.most_turn + 1) * SHIFTS_DOWN.len());
        let curves: Vec<Vec<PatchSpot>> = self.turns().map(|turn| self.spots(patch, turn)).collect();
        for shift in SHIFTS_DOWN {
            for spots in &curves {
                support.push(best_support(patch, spots, shift));
            }
        }
        let seen: Vec<f32> = support.iter().copied().flatten().collect();
        let mean = seen.iter().sum::<f32>() / (seen.len().max(1)) as f32;
        // A patch that agrees with much of the panorama says little.
        PatchProfile { support, weight: (1.0 - 2.0 * mean).max(0.0) }
    }

    /// Where a patch lies in the second panorama after a turn, for each step ahead.
    fn spots(&self, patch: &PicturePatch, turn: isize) -> Vec<PatchSpot> {
        let height = patch.row as f64 + 0.5 - self.rows as f64 / 2.0;
        let half_columns = 2 * patch.column.cast_signed() + 1 - PANORAMA_COLUMNS.cast_signed() - turn;
        let at = usize::try_from(half_columns + Self::MOST_HALF_COLUMNS).unwrap_or(0);
        let approaches = self.approaches.get(at * STEPS_AHEAD.len()..).unwrap_or(&[]);
        let mut spots: Vec<PatchSpot> = Vec::with_capacity(STEPS_AHEAD.len());
        for (step, approach) in STEPS_AHEAD.iter().zip(approaches) {
            let spot = PatchSpot {
                column: nearest(approach.columns + (PANORAMA_COLUMNS.cast_signed() - 1 - turn) as f64 / 2.0),
                row: nearest(height * approach.zoom + self.rows as f64 / 2.0 - 0.5),
                is_enlarged: approach.zoom > f64::midpoint(1.0, ENLARGED),
                cost: *step as f32 * NEARNESS_COST,
            };
            // The search around the place before covers a place beside it already.
            if spots.last().is_none_or(|kept| !kept.is_same_place(&spot)) {
                spots.push(spot);
            }
        }
        spots
    }

    /// The yaw near a candidate on which the patches agree best, to fractions of a column.
    fn refined(&self, patches: &[PicturePatch], profiles: &[PatchProfile], near: isize, shift_down: isize) -> f64 {
        const REACH: isize = 3;
        let agreement = |turn: isize| -> f64 {
            let support = |(patch, profile): (&PicturePatch, &PatchProfile)| {
                profile.weight * fine_support(patch, &self.spots(patch, turn), shift_down)
            };
            patches.iter().zip(profiles).map(support).map(f64::from).sum()
        };
        let curve: Vec<f64> = (near - REACH..=near + REACH).map(agreement).collect();
        let inner = curve.iter().enumerate().skip(1).take(curve.len() - 2);
        let top = inner.max_by(|a, b| a.1.total_cmp(b.1)).map_or(0, |(at, _)| at);
        near as f64 + top as f64 - REACH as f64 + peak_between(&curve, top)
    }

    /// How well all patches agree on each yaw, with one shift down.
    fn agreements(&self, profiles: &[PatchProfile], at_shift: usize, weight: f32) -> Vec<f32> {
        let turns = 2 * self.most_turn + 1;
        (0..turns)
            .map(|turn| {
                let (mut sum, mut seen) = (0.0, 0.0);
                for profile in profiles {
                    if let Some(support) = profile.support.get(at_shift * turns + turn).copied().flatten() {
                        sum += profile.weight * support;
                        seen += profile.weight;
                    }
                }
                sum / (seen + UNSEEN_WEIGHT * weight) * (1.0 + UNSEEN_WEIGHT)
            })
            .collect()
    }
}

/// A place where a patch may be found again.
struct PatchSpot {
    column: isize,
    row: isize,
    is_enlarged: bool,
    cost: f32,
}

impl PatchSpot {
    fn is_same_place(&self, other: &Self) -> bool {
        (self.column, self.row, self.is_enlarged) == (other.column, other.row, other.is_enlarged)
    }
}

/// The nearest whole number to a place on a panorama.
fn nearest(place: f64) -> isize {
    libm::round(place) as isize
}

/// How well a patch agrees with the best of some places: 0 for chance, 1 for the same.
fn best_support(patch: &PicturePatch, spots: &[PatchSpot], shift_down: isize) -> Option<f32> {
    let mut best: Option<f32> = None;
    for spot in spots {
        let surface = if spot.is_enlarged { &patch.enlarged } else { &patch.plain };
        let agreement = surface.best_near(spot.column, spot.row + shift_down);
        if agreement > UNSEEN {
            let support = ((agreement - 0.6) / 0.35).clamp(0.0, 1.0) - spot.cost;
            best = Some(best.map_or(support, |best| best.max(support)));
        }
    }
    best
}

/// The same to the column, and with more regard for small differences, which tell places between columns apart.
fn fine_support(patch: &PicturePatch, spots: &[PatchSpot], shift_down: isize) -> f32 {
    let mut best = 0.0_f32;
    for spot in spots {
        let surface = if spot.is_enlarged { &patch.enlarged } else { &patch.plain };
        for down in -1..=1 {
            best = best.max(surface.at(spot.column, spot.row + shift_down + down) - 0.3 - spot.cost);
        }
    }
    best
}
