//! The robustness ratio R: how much a change matters to the texts of many paths.
//!
//! Two anchors fix the scale. R is 1 if the text after the change agrees with the original as well as a text for the same unchanged
//! world that is simply generated again, and 0 if it agrees no better than the text of another path.

use crate::agreement::TextAgreement;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use wayword_core::seed::derive_seed;
use wayword_metrics::{MeanEstimate, percentile_interval};

/// Fewest paths for which R is computed.
pub const MIN_RATIO_PATHS: usize = 30;
/// Smallest difference between the two anchors for which R is computed. With nearly equal anchors the ratio would be noise.
pub const MIN_ANCHOR_GAP: f64 = 0.1;

/// The kinds of statements in the order of [`TextAgreement::by_kind`], and the mean of all.
pub const STATEMENT_KINDS: [&str; 5] = ["landmarks", "turns", "rooms", "floors", "mean"];

/// The agreements of the original text of one path with three other texts.
#[derive(Debug, Clone, PartialEq)]
pub struct PathAgreements {
    /// Its scene. Texts of one scene are not independent.
    pub scene: String,
    /// The agreement with the text in the changed world.
    pub changed: TextAgreement,
    /// The agreement with a second text in the unchanged world.
    pub again: TextAgreement,
    /// The agreement with the text of another path.
    pub other: TextAgreement,
}

/// R for one kind of statement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RobustnessRatio {
    /// One of [`STATEMENT_KINDS`].
    pub kind: String,
    /// The ratio with its interval.
    pub r: Option<MeanEstimate>,
    /// Why R cannot be computed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The mean agreement with the text in the changed world, over the same paths as the next two means; `None` without paths.
    pub changed: Option<f64>,
    /// The mean agreement with the second text in the unchanged world.
    pub again: Option<f64>,
    /// The mean agreement with another path's text.
    pub other: Option<f64>,
    /// The number of paths.
    pub paths: usize,
}

/// Options of the bootstrap that gives intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BootstrapOptions {
    /// Number of resamples.
    pub resamples: usize,
    /// The confidence level, as 0.95.
    pub level: f64,
    /// The seed.
    pub seed: u64,
}

/// Computes R for each kind of statement, and for their mean.
///
/// R is `(changed - other) / (again - other)`, where each term is a mean over all paths that have the kind in all three comparisons. In
/// the mean of kinds, each path counts with the kinds that all three comparisons have. The interval is a percentile bootstrap over
/// whole scenes (Efron 1979), in which both anchors vary with the resample; resamples with equal anchors are left out.
#[must_use]
pub fn robustness_ratios(paths: &[PathAgreements], drawing: BootstrapOptions) -> Vec<RobustnessRatio> {
    STATEMENT_KINDS.iter().enumerate().map(|(kind, name)| ratio_of_kind(paths, kind, name, drawing)).collect()
}

/// R for one kind of statement, an index of [`STATEMENT_KINDS`].
fn ratio_of_kind(paths: &[PathAgreements], kind: usize, name: &str, drawing: BootstrapOptions) -> RobustnessRatio {
    let mut scenes: BTreeMap<&str, AgreementSum> = BTreeMap::new();
    for path in paths {
        if let Some(three) = three_agreements(path, kind) {
            scenes.entry(&path.scene).or_default().add_path(&three);
        }
    }
    let scenes: Vec<AgreementSum> = scenes.into_values().collect();
    let all = scenes.iter().fold(AgreementSum::default(), |all, scene| all.plus(scene));
    let gap = all.mean(1) - all.mean(2);
    let reason = match all.paths {
        0 => Some("no path has such statements".to_owned()),
        few if few < MIN_RATIO_PATHS => {
            Some(format!("only {few} paths have such statements, and {MIN_RATIO_PATHS} are needed"))
        }
        _ if gap < MIN_ANCHOR_GAP => Some(format!(
            "asking again agrees in {:.2} and another path in {:.2}; they have to be {MIN_ANCHOR_GAP} apart",
            all.mean(1),
            all.mean(2)
        )),
        _ => None,
    };
    let known_mean = |at: usize| (all.paths > 0).then(|| all.mean(at));
    RobustnessRatio {
        kind: name.to_owned(),
        r: reason.is_none().then(|| ratio_interval(&scenes, &all, name, drawing)),
        reason,
        changed: known_mean(0),
        again: known_mean(1),
        other: known_mean(2),
        paths: all.paths,
    }
}

/// The three agreements of a path for a kind, or for the mean of the kinds that all three have.
fn three_agreements(path: &PathAgreements, kind: usize) -> Option<[f64; 3]> {
    let kinds = [path.changed.by_kind(), path.again.by_kind(), path.other.by_kind()];
    let agreements = |kind: usize| Some([kinds[0][kind]?, kinds[1][kind]?, kinds[2][kind]?]);
    if kind < kinds[0].len() {
        return agreements(kind);
    }
    let all: Vec<[f64; 3]> = (0..kinds[0].len()).filter_map(agreements).collect();
    let mean = |at: usize| all.iter().map(|three| three[at]).sum::<f64>() / all.len() as f64;
    (!all.is_empty()).then(|| [mean(0), mean(1), mean(2)])
}

/// Sums of agreements over paths, and the number of paths.
#[derive(Debug, Clone, Copy, Default)]
struct AgreementSum {
    /// The sums of the agreements with the changed, the repeated and the other path's text.
    sums: [f64; 3],
    paths: usize,
}

impl AgreementSum {
    fn add_path(&mut self, three: &[f64; 3]) {
        *self = self.plus(&Self { sums: *three, paths: 1 });
    }

    fn plus(&self, other: &Self) -> Self {
        Self { sums: std::array::from_fn(|at| self.sums[at] + other.sums[at]), paths: self.paths + other.paths }
    }

    fn mean(&self, at: usize) -> f64 {
        self.sums[at] / self.paths.max(1) as f64
    }

    fn ratio(&self) -> f64 {
        (self.mean(0) - self.mean(2)) / (self.mean(1) - self.mean(2))
    }
}

/// R over all paths, with its interval by resampling scenes.
fn ratio_interval(scenes: &[AgreementSum], all: &AgreementSum, name: &str, drawing: BootstrapOptions) -> MeanEstimate {
    let draw = |resample: usize, at: usize| {
        let words = ["robustness", name, &resample.to_string(), &at.to_string()];
        &scenes[(derive_seed(drawing.seed, &words) >> 16) as usize % scenes.len()]
    };
    let resampled =
        |resample: usize| (0..scenes.len()).fold(AgreementSum::default(), |sum, at| sum.plus(draw(resample, at)));
    let has_gap = |sum: &AgreementSum| sum.mean(1) - sum.mean(2) > f64::EPSILON;
    let ratios = (0..drawing.resamples.max(1)).map(resampled).filter(has_gap).map(|sum| sum.ratio()).collect();
    let mean = all.ratio();
    let [low, high] = percentile_interval(ratios, drawing.level).unwrap_or([mean; 2]);
    MeanEstimate { mean, low, high, values: all.paths, clusters: scenes.len() }
}

/// The change of R per unit of the dose: the slope of a least squares line. `None` for fewer than two different doses.
#[must_use]
pub fn dose_slope(points: &[(f64, f64)]) -> Option<f64> {
    let count = points.len() as f64;
    let (dose, ratio) = (
        points.iter().map(|point| point.0).sum::<f64>() / count,
        points.iter().map(|point| point.1).sum::<f64>() / count,
    );
    let across: f64 = points.iter().map(|point| (point.0 - dose) * (point.1 - ratio)).sum();
    let spread: f64 = points.iter().map(|point| (point.0 - dose) * (point.0 - dose)).sum();
    (spread > 0.0).then(|| across / spread)
}

/// The doses at which R falls below `least`: at most one below the unchanged dose, and one above it. If there is no unchanged dose, the
/// search goes upwards from the lowest dose. R is interpolated linearly between doses, and is taken as 1 at the unchanged dose.
#[must_use]
pub fn falling_doses(points: &[(f64, f64)], unchanged: Option<f64>, least: f64) -> Vec<f64> {
    let fall_in_direction = |sign: f64| {
        // `sign` is 1 for rising doses and -1 for falling ones.
        let is_ahead = |dose: f64| unchanged.is_none_or(|unchanged| (dose - unchanged) * sign > 0.0);
        let mut ahead: Vec<(f64, f64)> = points.iter().copied().filter(|(dose, _)| is_ahead(*dose)).collect();
        ahead.sort_by(|a, b| (a.0 * sign).total_cmp(&(b.0 * sign)));
        let mut before = unchanged.map(|dose| (dose, 1.0));
        for point in ahead {
            if point.1 < least {
                let between = |(dose, ratio): (f64, f64)| dose + (point.0 - dose) * (ratio - least) / (ratio - point.1);
                return Some(before.map_or(point.0, between));
            }
            before = Some(point);
        }
        None
    };
    let ways: &[f64] = if unchanged.is_some() { &[-1.0, 1.0] } else { &[1.0] };
    ways.iter().filter_map(|sign| fall_in_direction(*sign)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const DRAWING: BootstrapOptions = BootstrapOptions { resamples: 400, level: 0.95, seed: 1 };

    fn turns(share: f64) -> TextAgreement {
        TextAgreement { turns: Some(share), ..TextAgreement::default() }
    }

    fn paths(count: usize, changed: impl Fn(usize) -> f64) -> Vec<PathAgreements> {
        let path = |at: usize| PathAgreements {
            scene: format!("house2-{}", at % 10),
            changed: turns(changed(at)),
            again: turns(0.8),
            other: turns(0.2 + 0.1 * (at % 2) as f64),
        };
        (0..count).map(path).collect()
    }

    fn of_turns(paths: &[PathAgreements]) -> RobustnessRatio {
        robustness_ratios(paths, DRAWING).remove(1)
    }

    #[test]
    fn robustness_ratio_is_1_for_a_second_text_and_0_for_another_path() {
        let again = of_turns(&paths(40, |_| 0.8)).r.unwrap();
        assert!((again.mean - 1.0).abs() < 1e-12 && (again.low - 1.0).abs() < 1e-12, "{again:?}");
        let other = of_turns(&paths(40, |at| 0.2 + 0.1 * (at % 2) as f64)).r.unwrap();
        assert!(other.mean.abs() < 1e-12, "{other:?}");
        let half = of_turns(&paths(40, |_| 0.525)).r.unwrap();
        assert!((half.mean - 0.5).abs() < 1e-12 && half.clusters == 10);
    }

    #[test]
    fn without_enough_paths_or_anchors_apart_there_is_a_reason() {
        let few = of_turns(&paths(29, |_| 0.5));
        assert_eq!(few.r, None);
        assert_eq!(few.reason.unwrap(), "only 29 paths have such statements, and 30 are needed");
        let mut near = paths(40, |_| 0.5);
        near.iter_mut().for_each(|path| path.other = turns(0.75));
        assert!(of_turns(&near).reason.unwrap().contains("0.1 apart"));
        assert_eq!(robustness_ratios(&near, DRAWING)[0].reason.as_deref(), Some("no path has such statements"));
    }

    #[test]
    fn the_mean_takes_the_kinds_that_all_three_have() {
        let mut paths = paths(40, |_| 0.8);
        paths.iter_mut().for_each(|path| path.changed.rooms = Some(0.0));
        assert_eq!(robustness_ratios(&paths, DRAWING)[4].r.unwrap().mean, 1.0);
    }

    #[test]
    fn the_dose_at_which_it_falls_lies_between_two() {
        let falls = |points: &[(f64, f64)], unchanged: f64| falling_doses(points, Some(unchanged), 0.75);
        assert_eq!(falls(&[(1.0, 1.0), (3.0, 0.5)], 0.0), [2.0]);
        assert_eq!(falls(&[(60.0, 0.5), (120.0, 0.9)], 90.0), [75.0]);
        assert!(falls(&[(1.0, 0.9)], 0.0).is_empty());
        assert_eq!(falling_doses(&[(3.0, 0.5), (1.0, 1.0)], None, 0.75), [2.0]);
        assert_eq!(dose_slope(&[(0.0, 1.0), (2.0, 0.5)]), Some(-0.25));
        assert_eq!(dose_slope(&[(1.0, 0.5)]), None);
    }

    proptest! {
        #[test]
        fn an_interval_holds_what_varies_between_scenes(off in 0.0..0.2f64) {
            let found = of_turns(&paths(60, |at| 0.5 + off * ((at % 10) as f64 - 4.5) / 4.5)).r.unwrap();
            prop_assert!(found.low <= found.mean + 1e-9 && found.mean <= found.high + 1e-9);
        }
    }
}
