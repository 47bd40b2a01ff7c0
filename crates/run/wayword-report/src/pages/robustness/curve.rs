//! Draws a dose curve: R of the texts over the dose of a change, with the interval of each point.

use crate::pages::robustness::results::Curve;
use serde::Serialize;
use wayword_metrics::Estimate;

/// Size of the drawing, and the margins around the plot for labels, pixels.
const WIDTH: f64 = 320.0;
const HEIGHT: f64 = 180.0;
const LEFT: f64 = 34.0;
const RIGHT: f64 = 10.0;
const TOP: f64 = 8.0;
const BOTTOM: f64 = 24.0;
/// The ends of the axis of R, unless a figure lies beyond them.
const AXIS: (f64, f64) = (0.0, 1.1);
/// A change matters if R is below this.
const LEAST: f64 = 0.8;

/// The drawing as the template takes it.
#[derive(Debug, Serialize)]
pub(super) struct Drawing {
    change: String,
    said: String,
    width: f64,
    height: f64,
    lines: Vec<Line>,
    way: String,
    dots: Vec<Dot>,
    labels: Vec<Label>,
}

#[derive(Debug, Serialize)]
struct Line {
    class: &'static str,
    x1: f64,
    y1: f64,
    x2: f64,
    y2: f64,
}

#[derive(Debug, Serialize)]
struct Dot {
    x: f64,
    y: f64,
}

#[derive(Debug, Serialize)]
struct Label {
    x: f64,
    y: f64,
    anchor: &'static str,
    text: String,
}

/// The conversion from doses and R to places in the drawing.
struct Scale {
    doses: (f64, f64),
    ratios: (f64, f64),
}

impl Scale {
    fn of(curve: &Curve) -> Self {
        let doses = curve.points.iter().map(|(dose, _)| *dose).chain(curve.unchanged);
        let ends = curve.points.iter().filter_map(|(_, r)| r.as_ref()).flat_map(|r| [r.low, r.high, r.mean]);
        let bounds = |(low, high): (f64, f64), value: f64| (low.min(value), high.max(value));
        Self { doses: doses.fold((f64::INFINITY, f64::NEG_INFINITY), bounds), ratios: ends.fold(AXIS, bounds) }
    }

    fn x(&self, dose: f64) -> f64 {
        let (low, high) = self.doses;
        tenths(LEFT + (dose - low) / (high - low).max(f64::MIN_POSITIVE) * (WIDTH - LEFT - RIGHT))
    }

    fn y(&self, ratio: f64) -> f64 {
        let (low, high) = self.ratios;
        tenths(TOP + (high - ratio) / (high - low) * (HEIGHT - TOP - BOTTOM))
    }
}

/// Rounds to tenths of a pixel; more digits would only make the page larger.
fn tenths(value: f64) -> f64 {
    (value * 10.0).round() / 10.0
}

impl Drawing {
    pub(super) fn of(curve: &Curve) -> Self {
        let scale = Scale::of(curve);
        let known: Vec<(f64, &Estimate)> =
            curve.points.iter().filter_map(|(dose, r)| r.as_ref().map(|r| (*dose, r))).collect();
        let across =
            |class, ratio: f64| Line { class, x1: LEFT, y1: scale.y(ratio), x2: WIDTH - RIGHT, y2: scale.y(ratio) };
        let up = |class, dose: f64, low: f64, high: f64| Line {
            class,
            x1: scale.x(dose),
            y1: scale.y(low),
            x2: scale.x(dose),
            y2: scale.y(high),
        };
        let mut lines = vec![across("grid", 0.0), across("grid", 0.5), across("grid", 1.0), across("least", LEAST)];
        lines.extend(curve.unchanged.map(|dose| up("unchanged", dose, scale.ratios.0, scale.ratios.1)));
        lines.extend(known.iter().map(|(dose, r)| up("whisker", *dose, r.low, r.high)));
        let mut way: Vec<(f64, f64)> = known.iter().map(|(dose, r)| (*dose, r.mean)).collect();
        way.sort_by(|a, b| a.0.total_cmp(&b.0));
        let way: Vec<String> = way.iter().map(|(dose, r)| format!("{},{}", scale.x(*dose), scale.y(*r))).collect();
        Self {
            change: curve.change.clone(),
            said: said(curve),
            width: WIDTH,
            height: HEIGHT,
            lines,
            way: way.join(" "),
            dots: known.iter().map(|(dose, r)| Dot { x: scale.x(*dose), y: scale.y(r.mean) }).collect(),
            labels: labels(curve, &scale),
        }
    }
}

fn labels(curve: &Curve, scale: &Scale) -> Vec<Label> {
    let ratio =
        |ratio: f64| Label { x: LEFT - 5.0, y: scale.y(ratio) + 4.0, anchor: "end", text: format!("{ratio:.1}") };
    let dose = |dose: f64| Label { x: scale.x(dose), y: HEIGHT - 8.0, anchor: "middle", text: dose.to_string() };
    [0.0, 0.5, LEAST, 1.0].map(ratio).into_iter().chain(curve.points.iter().map(|(at, _)| dose(*at))).collect()
}

/// The curve in a sentence.
fn said(curve: &Curve) -> String {
    let slope = curve.slope.map(|slope| format!("R changes by {slope:+.4} for each unit. "));
    let falls: Vec<String> = curve.falls_at.iter().map(|dose| format!("{dose:.3}")).collect();
    let falls = match falls.as_slice() {
        [] => "R does not fall below 0.8 at these doses.".to_owned(),
        falls => format!("R falls below 0.8 at {}.", falls.join(" and ")),
    };
    slope.unwrap_or_default() + &falls
}
