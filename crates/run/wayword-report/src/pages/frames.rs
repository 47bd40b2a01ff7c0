//! The frames of an item as the page shows them: picture, room, caption, dialogue, and the move to the next frame.

use super::{
    link_targets::{frame_anchor, side_words},
    palette::{FrameColour, frame_colour},
    pictures::{PagePicture, PagePictures},
};
use serde::Serialize;
use wayword_core::{
    AnswerTrouble, CaptionedView, ClimbDirection, CompassPoint, DetectedBox, DialogueExchange, FrameObservation,
    Heading, ObjectSighting, PathMove, TurnKind, ViewThird, WitnessAnswer,
};
use wayword_run::run_folder::WalkRecord;

/// Most sightings that a frame's card names. It only counts the others.
const MAX_CARD_SIGHTINGS: usize = 6;

/// Most boxes that are drawn on a picture; those with the lowest scores are left out.
const MAX_PICTURE_BOXES: usize = 8;

/// Directions that differ by less count as the same, radians.
const SAME_DIRECTION_RAD: f64 = 0.01;

/// A frame.
#[derive(Debug, Serialize)]
pub(super) struct FrameView {
    /// From 0, as in run folders and on the terminal.
    number: usize,
    anchor: String,
    colour: FrameColour,
    picture: Option<PagePicture>,
    /// The boxes of a detector, those with the highest score first.
    boxes: Vec<BoxView>,
    /// The picture in words, for readers who do not see it.
    alt: String,
    room: Option<String>,
    level: Option<u32>,
    caption: String,
    /// The first things in the view, shown if there is no picture.
    seen: Vec<String>,
    seen_left_out: usize,
    /// Name of the icon for the turn that follows, and the move in words; `None` at the last frame, and if the motion
    /// is not known.
    turn: Option<&'static str>,
    then: Option<String>,
    looks: Vec<LookView>,
}

/// A box that a detector found, in the picture's pixels.
#[derive(Debug, PartialEq, Serialize)]
struct BoxView {
    name: String,
    percent: u8,
    /// How far away it is, where that is known.
    metres: Option<String>,
    left: f32,
    top: f32,
    width: f32,
    height: f32,
}

/// A view with the questions and answers about it.
#[derive(Debug, Serialize)]
struct LookView {
    /// Its direction.
    direction: &'static str,
    caption: String,
    /// Who wrote the caption, if it was not the run's summariser.
    by: Option<String>,
    transcript: Vec<ExchangeView>,
    /// The names of things that are seen, denied or unsure, under these words.
    said: Vec<(&'static str, String)>,
}

/// A question with its answer.
#[derive(Debug, Serialize)]
struct ExchangeView {
    question: String,
    answer: String,
    /// Why it was asked a second time, if it was.
    asked_twice: Option<&'static str>,
}

/// The first `shown` frames of a walk.
pub(super) fn frame_views(
    walk: &WalkRecord,
    item: &str,
    shown: usize,
    pictures: &mut PagePictures<'_>,
) -> Vec<FrameView> {
    let moves = walk.path.moves();
    let nothing = FrameObservation::default();
    let frame = |(at, frame): (usize, &wayword_core::Frame)| {
        let observation = walk.observations.get(at).unwrap_or(&nothing);
        let seen: Vec<&ObjectSighting> = sightings_by_witness(&observation.looks, WitnessAnswer::Seen).collect();
        let next = moves.get(at);
        FrameView {
            number: at,
            anchor: frame_anchor(item, at),
            colour: frame_colour(at, shown),
            picture: if walk.has_pictures { pictures.take_picture(&walk.path.id, at) } else { None },
            boxes: box_views(&observation.looks, frame.pose.heading),
            alt: format!("View at frame {at}. {}", observation.summary),
            room: observation.looks.iter().find_map(|look| look.caption.room.clone()),
            level: frame.level.filter(|_| walk.path.motion.is_known()),
            caption: observation.summary.clone(),
            seen: seen.iter().take(MAX_CARD_SIGHTINGS).map(|sighting| sighting_words(sighting)).collect(),
            seen_left_out: seen.len().saturating_sub(MAX_CARD_SIGHTINGS),
            turn: next.map(|next| turn_sign(next.turn())),
            then: next.map(move_words),
            looks: observation.looks.iter().map(|look| look_view(look, frame.pose.heading)).collect(),
        }
    };
    walk.path.frames.iter().take(shown).enumerate().map(frame).collect()
}

fn sightings_by_witness(looks: &[CaptionedView], witness: WitnessAnswer) -> impl Iterator<Item = &ObjectSighting> {
    looks.iter().flat_map(|look| &look.caption.sightings).filter(move |sighting| sighting.witness == witness)
}

/// The boxes of a detector in the view ahead, because the picture shows this view.
fn box_views(looks: &[CaptionedView], heading: Heading) -> Vec<BoxView> {
    let ahead = looks.iter().filter(|look| look.gaze.heading.turn_to(heading).abs() < SAME_DIRECTION_RAD);
    let seen =
        ahead.flat_map(|look| &look.caption.sightings).filter(|sighting| sighting.witness == WitnessAnswer::Seen);
    let mut found: Vec<(&ObjectSighting, DetectedBox)> =
        seen.filter_map(|sighting| Some((sighting, sighting.spot?.found))).collect();
    found.sort_by(|a, b| b.1.score.total_cmp(&a.1.score));
    let view =
        |(sighting, DetectedBox { box_px: [left, top, right, bottom], score }): (&ObjectSighting, DetectedBox)| {
            BoxView {
                name: sighting.name.clone(),
                percent: (100.0 * score).clamp(0.0, 100.0) as u8,
                metres: sighting.spot.and_then(|spot| spot.distance_m).map(|metres| format!("{metres:.1}")),
                left,
                top,
                width: (right - left).max(0.0),
                height: (bottom - top).max(0.0),
            }
        };
    found.into_iter().take(MAX_PICTURE_BOXES).map(view).collect()
}

fn sighting_words(sighting: &ObjectSighting) -> String {
    let several = if sighting.several { "several " } else { "" };
    let colour = sighting.colour.as_ref().map_or_else(String::new, |colour| format!("{colour} "));
    let place = match sighting.place {
        Some(ViewThird::Left) => ", left",
        Some(ViewThird::Middle) => ", middle",
        Some(ViewThird::Right) => ", right",
        None => "",
    };
    format!("{several}{colour}{}{place}", sighting.name)
}

fn look_view(look: &CaptionedView, heading: Heading) -> LookView {
    let names = |witness| {
        let named = look.caption.sightings.iter().filter(|sighting| sighting.witness == witness);
        named.map(sighting_words).collect::<Vec<_>>().join("; ")
    };
    let answers = [("seen", WitnessAnswer::Seen), ("denied", WitnessAnswer::Denied), ("unsure", WitnessAnswer::Unsure)];
    LookView {
        direction: direction_words(look.gaze.heading, heading),
        caption: look.caption.text.clone(),
        by: look.caption.by.clone(),
        transcript: look.caption.transcript.iter().map(exchange_view).collect(),
        said: answers
            .map(|(word, witness)| (word, names(witness)))
            .into_iter()
            .filter(|(_, names)| !names.is_empty())
            .collect(),
    }
}

fn exchange_view(exchange: &DialogueExchange) -> ExchangeView {
    ExchangeView {
        question: exchange.question.clone(),
        answer: exchange.answer.clone(),
        asked_twice: exchange.trouble.map(|trouble| match trouble {
            AnswerTrouble::Empty => "the first answer was empty",
            AnswerTrouble::Echo => "the first answer repeated the question",
            AnswerTrouble::Loop => "the first answer repeated itself",
            AnswerTrouble::Repeat => "the first answer was the one to an earlier question",
            AnswerTrouble::Form => "the first answer did not have the form that was asked for",
            AnswerTrouble::Refusal => "the first answer was a refusal",
        }),
    }
}

/// The direction of a gaze in words: ahead if it follows the walker's heading, else a point of the compass or a side of the walker.
fn direction_words(gaze: Heading, walker: Heading) -> &'static str {
    let looks_to = |other: Heading| gaze.turn_to(other).abs() < SAME_DIRECTION_RAD;
    if looks_to(walker) {
        return "ahead";
    }
    CompassPoint::ALL
        .into_iter()
        .find(|point| looks_to(point.to_heading()))
        .map_or_else(|| side_words(walker.side_of(gaze)), CompassPoint::word)
}

/// The name of the icon for a turn, in the page's `signs.html`.
pub(super) fn turn_sign(turn: TurnKind) -> &'static str {
    match turn {
        TurnKind::Straight => "straight",
        TurnKind::SlightLeft => "slight-left",
        TurnKind::SlightRight => "slight-right",
        TurnKind::Left => "left",
        TurnKind::Right => "right",
        TurnKind::Around => "around",
    }
}

fn move_words(step: &PathMove) -> String {
    let deg = step.turn_rad.to_degrees().abs().round();
    let side = if step.turn_rad < 0.0 { "left" } else { "right" };
    let turn = match step.turn() {
        TurnKind::Straight => String::new(),
        TurnKind::Around => format!("turn around ({deg}° {side}), "),
        TurnKind::SlightLeft | TurnKind::SlightRight => format!("bear {deg}° {side}, "),
        TurnKind::Left | TurnKind::Right => format!("turn {deg}° {side}, "),
    };
    let climb = match step.climb() {
        ClimbDirection::Level => String::new(),
        ClimbDirection::Up => format!(", {:.1} m up", step.rise_m),
        ClimbDirection::Down => format!(", {:.1} m down", -step.rise_m),
    };
    format!("{turn}go {:.1} m{climb}", step.distance_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{Caption, DetectionSpot, ViewGaze};

    fn step(deg: f64, rise_m: f64) -> PathMove {
        PathMove { turn_rad: deg.to_radians(), distance_m: 2.04, rise_m }
    }

    #[test]
    fn move_words_give_angle_length_and_climb() {
        let told =
            [step(5.0, 0.0), step(-40.0, 0.0), step(91.0, 1.25), step(-170.0, -2.0)].map(|step| move_words(&step));
        let expected = [
            "go 2.0 m",
            "bear 40° left, go 2.0 m",
            "turn 91° right, go 2.0 m, 1.2 m up",
            "turn around (170° left), go 2.0 m, 2.0 m down",
        ];
        assert_eq!(told, expected);
    }

    #[test]
    fn boxes_are_drawn_on_the_picture_that_they_are_in_the_surest_first() {
        let spot = |score| Some(DetectionSpot::new(DetectedBox { box_px: [1.0, 2.0, 4.0, 8.0], score }, 10, 1.0));
        let seen = |name: &str, score| ObjectSighting {
            spot: spot(score),
            ..ObjectSighting::new(name, WitnessAnswer::Seen, "d")
        };
        let look = |heading, sightings| CaptionedView {
            gaze: ViewGaze::quarter_view(heading),
            caption: Caption { sightings, ..Caption::default() },
        };
        let denied = ObjectSighting { spot: spot(0.9), ..ObjectSighting::new("bed", WitnessAnswer::Denied, "d") };
        let told = ObjectSighting::new("rug", WitnessAnswer::Seen, "eye");
        let heading = Heading::new(1.0).unwrap();
        let looks = [
            look(heading, vec![seen("lamp", 0.4), seen("sofa", 0.8), denied, told]),
            look(heading.turned_by(1.5), vec![seen("door", 0.9)]),
        ];
        let drawn = box_views(&looks, heading);
        assert_eq!(drawn.iter().map(|drawn| &*drawn.name).collect::<Vec<_>>(), ["sofa", "lamp"]);
        assert_eq!((drawn[0].percent, drawn[0].width, drawn[0].height), (80, 3.0, 6.0));
    }

    #[test]
    fn direction_names_points_of_the_compass_and_sides() {
        let heading = Heading::new(1.0).unwrap();
        assert_eq!(direction_words(heading, heading), "ahead");
        assert_eq!(direction_words(CompassPoint::West.to_heading(), heading), "west");
        assert_eq!(direction_words(heading.turned_by(1.5), heading), "on the right");
    }
}
