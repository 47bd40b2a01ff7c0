//! Draws a dose curve: R of the texts over the dose of a change, with the interval of each point.

use crate::pages::robustness::results::DoseCurve;
use serde::Serialize;
use wayword_metrics::MeanEstimate;

/// Size of the drawing, and the margins around the plot for labels, pixels.
const DRAWING_WIDTH_PX: f64 = 320.0;
const DRAWING_HEIGHT_PX: f64 = 180.0;
const MARGIN_LEFT_PX: f64 = 34.0;
const MARGIN_RIGHT_PX: f64 = 10.0;
const MARGIN_TOP_PX: f64 = 8.0;
const MARGIN_BOTTOM_PX: f64 = 24.0;
/// The ends of the axis of R, unless a figure lies beyond them.
const RATIO_AXIS_ENDS: (f64, f64) = (0.0, 1.1);
/// A change matters if R is below this.
const LEAST_UNCHANGED_RATIO: f64 = 0.8;

/// The drawing as the template takes it.
#[derive(Debug, Serialize)]
pub(super) struct CurveDrawing {
    change: String,
    /// The curve in a sentence.
    said: String,
    width: f64,
    height: f64,
    lines: Vec<CurveLine>,
    /// The points of the line through the means, as an SVG `polyline` takes them.
    way: String,
    dots: Vec<CurveDot>,
    labels: Vec<CurveLabel>,
}

#[derive(Debug, Serialize)]
struct CurveLine {
    class: &'static str,
    x1: f64,
    y1: f64,
    x2: f64,
    y2: f64,
}

#[derive(Debug, Serialize)]
struct CurveDot {
    x: f64,
    y: f64,
}

#[derive(Debug, Serialize)]
struct CurveLabel {
    x: f64,
    y: f64,
    anchor: &'static str,
    text: String,
}

/// The conversion from doses and R to places in the drawing.
struct CurveScale {
    doses: (f64, f64),
    ratios: (f64, f64),
}

impl CurveScale {
    fn from_curve(curve: &DoseCurve) -> Self {
        let doses = curve.points.iter().map(|(dose, _)| *dose).chain(curve.unchanged);
        let ends = curve.points.iter().filter_map(|(_, r)| r.as_ref()).flat_map(|r| [r.low, r.high, r.mean]);
        let bounds = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        Self {
            doses: doses.fold((f64::INFINITY, f64::NEG_INFINITY), bounds),
            ratios: ends.fold(RATIO_AXIS_ENDS, bounds),
        }
    }

    fn dose_x(&self, dose: f64) -> f64 {
        let (low, high) = self.doses;
        round_to_tenths(
            MARGIN_LEFT_PX
                + (dose - low) / (high - low).max(f64::MIN_POSITIVE)
                    * (DRAWING_WIDTH_PX - MARGIN_LEFT_PX - MARGIN_RIGHT_PX),
        )
    }

    fn ratio_y(&self, ratio: f64) -> f64 {
        let (low, high) = self.ratios;
        round_to_tenths(
            MARGIN_TOP_PX + (high - ratio) / (high - low) * (DRAWING_HEIGHT_PX - MARGIN_TOP_PX - MARGIN_BOTTOM_PX),
        )
    }
}

/// Rounds to tenths of a pixel; more digits would only make the page larger.
fn round_to_tenths(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

impl CurveDrawing {
    pub(super) fn from_curve(curve: &DoseCurve) -> Self {
        let scale = CurveScale::from_curve(curve);
        let known: Vec<(f64, &MeanEstimate)> =
            curve.points.iter().filter_map(|(dose, r)| r.as_ref().map(|r| (*dose, r))).collect();
        let horizontal = |class, ratio: f64| CurveLine {
            class,
            x1: MARGIN_LEFT_PX,
            y1: scale.ratio_y(ratio),
            x2: DRAWING_WIDTH_PX - MARGIN_RIGHT_PX,
            y2: scale.ratio_y(ratio),
        };
        let vertical = |class, dose: f64, low: f64, high: f64| CurveLine {
            class,
            x1: scale.dose_x(dose),
            y1: scale.ratio_y(low),
            x2: scale.dose_x(dose),
            y2: scale.ratio_y(high),
        };
        let mut lines = vec![
            horizontal("grid", 0.0),
            horizontal("grid", 0.5),
            horizontal("grid", 1.0),
            horizontal("least", LEAST_UNCHANGED_RATIO),
        ];
        lines.extend(curve.unchanged.map(|dose| vertical("unchanged", dose, scale.ratios.0, scale.ratios.1)));
        lines.extend(known.iter().map(|(dose, r)| vertical("whisker", *dose, r.low, r.high)));
        let mut line_points: Vec<(f64, f64)> = known.iter().map(|(dose, r)| (*dose, r.mean)).collect();
        line_points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let line_points: Vec<String> =
            line_points.iter().map(|(dose, r)| format!("{},{}", scale.dose_x(*dose), scale.ratio_y(*r))).collect();
        Self {
            change: curve.change.clone(),
            said: describe_curve(curve),
            width: DRAWING_WIDTH_PX,
            height: DRAWING_HEIGHT_PX,
            lines,
            way: line_points.join(" "),
            dots: known.iter().map(|(dose, r)| CurveDot { x: scale.dose_x(*dose), y: scale.ratio_y(r.mean) }).collect(),
            labels: curve_labels(curve, &scale),
        }
    }
}

fn curve_labels(curve: &DoseCurve, scale: &CurveScale) -> Vec<CurveLabel> {
    let ratio = |ratio: f64| CurveLabel {
        x: MARGIN_LEFT_PX - 5.0,
        y: scale.ratio_y(ratio) + 4.0,
        anchor: "end",
        text: format!("{ratio:.1}"),
    };
    let dose = |dose: f64| CurveLabel {
        x: scale.dose_x(dose),
        y: DRAWING_HEIGHT_PX - 8.0,
        anchor: "middle",
        text: dose.to_string(),
    };
    [0.0, 0.5, LEAST_UNCHANGED_RATIO, 1.0]
        .map(ratio)
        .into_iter()
        .chain(curve.points.iter().map(|(at, _)| dose(*at)))
        .collect()
}

/// The curve in a sentence.
fn describe_curve(curve: &DoseCurve) -> String {
    let slope = curve.slope.map(|slope| format!("R changes by {slope:+.4} for each unit. "));
    let falls: Vec<String> = curve.falls_at.iter().map(|dose| format!("{dose:.3}")).collect();
    let falls = match falls.as_slice() {
        [] => "R does not fall below 0.8 at these doses.".to_owned(),
        falls => format!("R falls below 0.8 at {}.", falls.join(" and ")),
    };
    slope.unwrap_or_default() + &falls
}
