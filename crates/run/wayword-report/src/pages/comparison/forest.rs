//! Forest plots: estimates with their intervals as dots and bars, one below another on a common axis.

use super::{
    super::palette::{FrameColour, frame_colour},
    figures::{ComparisonLine, RoundedFigure},
};
use serde::Serialize;
use wayword_metrics::{MeanEstimate, TrajectoryMetric};

/// A forest plot of success rates. Places are in per cent of the plot's width.
#[derive(Debug, Serialize)]
pub(super) struct ForestView {
    title: String,
    /// The heading of its lines: instructions or swaps.
    label: &'static str,
    rows: Vec<ForestRowView>,
    ticks: Vec<ForestTick>,
    marks: Vec<ForestMark>,
    /// Marks that lie beyond the axis.
    beyond: Vec<String>,
    /// How to read the plot.
    caption: &'static str,
}

/// An estimate with its interval; `at`, `low` and `high` are places on the axis.
#[derive(Debug, Serialize)]
struct ForestRowView {
    agent: String,
    opens: bool,
    label: String,
    at: f64,
    low: f64,
    high: f64,
    /// Filled if the interval excludes zero, or if the plot has no line at zero.
    is_filled: bool,
    colour: FrameColour,
    figure: String,
}

/// A labelled place on the axis.
#[derive(Debug, Serialize)]
struct ForestTick {
    at: f64,
    label: String,
}

/// A vertical line through all rows.
#[derive(Debug, Serialize)]
pub(super) struct ForestMark {
    at: f64,
    class: &'static str,
    name: String,
}

/// The content of a plot, in shares.
pub(super) struct ForestContent<'a> {
    pub(super) title: String,
    pub(super) label: &'static str,
    pub(super) lines: &'a [ComparisonLine<'a>],
    /// Lines through all rows: their class, their name and where they are (a share).
    pub(super) marks: Vec<(&'static str, String, f64)>,
    pub(super) has_zero: bool,
    pub(super) caption: &'static str,
}

/// Most steps of an axis. A longer axis gets larger steps.
const MAX_AXIS_STEPS: f64 = 8.0;
/// How far above the axis' end a line may lie for the axis to be drawn out to it: an upper bound of 100 would press all else together.
const NEAR_AXIS_FACTOR: f64 = 1.5;
/// How much of the plot's width is left free on either side, so that no dot is cut.
const EDGE_PER_CENT: f64 = 2.0;

impl ForestContent<'_> {
    /// Computes the plot; `None` if no line has an estimate.
    pub(super) fn draw_forest(self) -> Option<ForestView> {
        let metric = TrajectoryMetric::SuccessRate;
        let estimates: Vec<(&ComparisonLine<'_>, &MeanEstimate)> =
            self.lines.iter().filter_map(|line| Some((line, line.estimate(metric)?))).collect();
        let ends = estimates.iter().flat_map(|(_, estimate)| [estimate.low, estimate.mean, estimate.high]);
        let mut axis = ForestAxis::over_shares(ends)?;
        let near =
            self.marks.iter().map(|(_, _, share)| *share).filter(|share| 100.0 * share <= NEAR_AXIS_FACTOR * axis.high);
        axis = ForestAxis::over_shares(near.chain([axis.low / 100.0, axis.high / 100.0]))?;
        let mut labels: Vec<&str> = Vec::new();
        for (line, _) in &estimates {
            if !labels.contains(&line.label.as_str()) {
                labels.push(&line.label);
            }
        }
        let row = |(line, estimate): &(&ComparisonLine<'_>, &MeanEstimate)| ForestRowView {
            agent: line.agent_with_kind(),
            opens: line.opens,
            label: line.label.clone(),
            at: axis.place_share(estimate.mean),
            low: axis.place_share(estimate.low),
            high: axis.place_share(estimate.high),
            is_filled: !self.has_zero || estimate.low > 0.0 || estimate.high < 0.0,
            colour: frame_colour(labels.iter().position(|label| *label == line.label).unwrap_or(0), labels.len()),
            figure: RoundedFigure::from_estimate(metric, estimate).to_string().replace('-', "−"),
        };
        let (on, beyond): (Vec<_>, Vec<_>) = self.marks.into_iter().partition(|(_, _, share)| axis.holds_share(*share));
        let zero = self.has_zero.then(|| ForestMark { at: axis.place_share(0.0), class: "zero", name: String::new() });
        let on = on.into_iter().map(|(class, name, share)| ForestMark { at: axis.place_share(share), class, name });
        Some(ForestView {
            title: self.title,
            label: self.label,
            rows: estimates.iter().map(row).collect(),
            ticks: axis.make_ticks(),
            marks: zero.into_iter().chain(on).collect(),
            beyond: beyond.into_iter().map(|(_, name, _)| name).collect(),
            caption: self.caption,
        })
    }
}

/// The axis of a plot, in per cent of success. It always contains zero.
struct ForestAxis {
    low: f64,
    high: f64,
    step: f64,
}

impl ForestAxis {
    /// An axis that contains all finite shares; `None` if there are none. It stays within -100 to 100 per cent, even for wild values.
    fn over_shares(shares: impl Iterator<Item = f64>) -> Option<Self> {
        let (mut low, mut high, mut is_any) = (0.0f64, 0.0f64, false);
        for share in shares.filter(|share| share.is_finite()) {
            let per_cent = (100.0 * share).clamp(-100.0, 100.0);
            (low, high, is_any) = (low.min(per_cent), high.max(per_cent), true);
        }
        let span = (high - low).max(1.0);
        let step = [0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0]
            .into_iter()
            .find(|step| span / step <= MAX_AXIS_STEPS)
            .unwrap_or(25.0);
        let (low, high) = ((low / step).floor() * step, (high / step).ceil() * step);
        is_any.then_some(Self { low, high: high.max(low + step), step })
    }

    fn holds_share(&self, share: f64) -> bool {
        (self.low..=self.high).contains(&(100.0 * share))
    }

    /// The place of a share in per cent of the plot's width, rounded to hundredths.
    fn place_share(&self, share: f64) -> f64 {
        let along = (100.0 * share).clamp(self.low, self.high) - self.low;
        let place = EDGE_PER_CENT + along / (self.high - self.low) * (100.0 - 2.0 * EDGE_PER_CENT);
        (place * 100.0).round() / 100.0
    }

    fn make_ticks(&self) -> Vec<ForestTick> {
        let count = ((self.high - self.low) / self.step).round() as usize;
        let tick = |at: usize| {
            let per_cent = self.low + at as f64 * self.step;
            // Sums of tenths are inexact in binary, so the label is rounded.
            ForestTick {
                at: self.place_share(per_cent / 100.0),
                label: ((per_cent * 10.0).round() / 10.0 + 0.0).to_string().replace('-', "−"),
            }
        };
        (0..=count).map(tick).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axis_contains_zero_and_all_its_shares() {
        for shares in [vec![0.07, 0.16], vec![-0.3, -0.01], vec![0.0], vec![-1.0, 1.0], vec![f64::MAX, -0.002]] {
            let axis = ForestAxis::over_shares(shares.iter().copied()).unwrap();
            let ticks = axis.make_ticks();
            assert!((2..=10).contains(&ticks.len()), "{shares:?}: {}", ticks.len());
            assert!(
                axis.holds_share(0.0) && shares.iter().all(|share| (0.0..=100.0).contains(&axis.place_share(*share)))
            );
            assert!(ticks.iter().any(|tick| tick.label == "0"), "{shares:?}: {ticks:?}");
            assert!(ticks.windows(2).all(|pair| pair[0].at < pair[1].at));
        }
        assert!(ForestAxis::over_shares([f64::NAN].into_iter()).is_none());
    }

    #[test]
    fn axis_places_larger_shares_further_right() {
        let axis = ForestAxis::over_shares([-0.04, 0.11].into_iter()).unwrap();
        assert!(axis.place_share(-0.04) < axis.place_share(0.0) && axis.place_share(0.0) < axis.place_share(0.11));
    }
}
