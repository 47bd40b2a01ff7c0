//! The frames of an item as the page shows them: picture, room, caption, dialogue, and the move to the next frame.

use super::{
    palette::{Colour, colour},
    pictures::{Picture, Pictures},
    places::{frame_anchor, side_words},
};
use serde::Serialize;
use wayword_core::{
    Climb, Compass, Exchange, Found, Heading, Look, Move, Observation, Sighting, Trouble, Turn, Where, Witness,
};
use wayword_run::run_folder::WalkRecord;

/// Most sightings that a frame's card names.
const MOST_ON_CARD: usize = 6;

/// Most boxes that are drawn on a picture.
const MOST_BOXES: usize = 8;

/// Directions that differ by less are the same.
const SAME_RAD: f64 = 0.01;

/// A frame.
#[derive(Debug, Serialize)]
pub(super) struct FrameView {
    /// From 0, as in run folders and on the terminal.
    number: usize,
    anchor: String,
    colour: Colour,
    picture: Option<Picture>,
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
pub(super) fn frames(walk: &WalkRecord, item: &str, shown: usize, pictures: &mut Pictures) -> Vec<FrameView> {
    let moves = walk.path.moves();
    let nothing = Observation::default();
    let frame = |(at, frame): (usize, &wayword_core::Frame)| {
        let observation = walk.observations.get(at).unwrap_or(&nothing);
        let seen: Vec<&Sighting> = sightings(&observation.looks, Witness::Seen).collect();
        let next = moves.get(at);
        FrameView {
            number: at,
            anchor: frame_anchor(item, at),
            colour: colour(at, shown),
            picture: if walk.has_pictures { pictures.take(&walk.path.id, at) } else { None },
            boxes: boxes(&observation.looks, frame.pose.heading),
            alt: format!("View at frame {at}. {}", observation.summary),
            room: observation.looks.iter().find_map(|look| look.caption.room.clone()),
            level: frame.level.filter(|_| walk.path.motion.is_known()),
            caption: observation.summary.clone(),
            seen: seen.iter().take(MOST_ON_CARD).map(|sighting| sighting_words(sighting)).collect(),
            seen_left_out: seen.len().saturating_sub(MOST_ON_CARD),
            turn: next.map(|next| turn_sign(next.turn())),
            then: next.map(move_words),
            looks: observation.looks.iter().map(|look| look_view(look, frame.pose.heading)).collect(),
        }
    };
    walk.path.frames.iter().take(shown).enumerate().map(frame).collect()
}

fn sightings(looks: &[Look], witness: Witness) -> impl Iterator<Item = &Sighting> {
    looks.iter().flat_map(|look| &look.caption.sightings).filter(move |sighting| sighting.witness == witness)
}

/// The boxes of a detector in the view ahead, because the picture shows this view.
fn boxes(looks: &[Look], heading: Heading) -> Vec<BoxView> {
    let ahead = looks.iter().filter(|look| look.gaze.heading.turn_to(heading).abs() < SAME_RAD);
    let seen = ahead.flat_map(|look| &look.caption.sightings).filter(|sighting| sighting.witness == Witness::Seen);
    let mut found: Vec<(&Sighting, Found)> =
        seen.filter_map(|sighting| Some((sighting, sighting.spot?.found))).collect();
    found.sort_by(|a, b| b.1.score.total_cmp(&a.1.score));
    let view = |(sighting, Found { box_px: [left, top, right, bottom], score }): (&Sighting, Found)| BoxView {
        name: sighting.name.clone(),
        percent: (100.0 * score).clamp(0.0, 100.0) as u8,
        metres: sighting.spot.and_then(|spot| spot.distance_m).map(|metres| format!("{metres:.1}")),
        left,
        top,
        width: (right - left).max(0.0),
        height: (bottom - top).max(0.0),
    };
    found.into_iter().take(MOST_BOXES).map(view).collect()
}

fn sighting_words(sighting: &Sighting) -> String {
    let several = if sighting.several { "several " } else { "" };
    let colour = sighting.colour.as_ref().map_or_else(String::new, |colour| format!("{colour} "));
    let place = match sighting.place {
        Some(Where::Left) => ", left",
        Some(Where::Middle) => ", middle",
        Some(Where::Right) => ", right",
        None => "",
    };
    format!("{several}{colour}{}{place}", sighting.name)
}

fn look_view(look: &Look, heading: Heading) -> LookView {
    let names = |witness| {
        let of = look.caption.sightings.iter().filter(|sighting| sighting.witness == witness);
        of.map(sighting_words).collect::<Vec<_>>().join("; ")
    };
    let said = [("seen", Witness::Seen), ("denied", Witness::Denied), ("unsure", Witness::Unsure)];
    LookView {
        direction: direction(look.gaze.heading, heading),
        caption: look.caption.text.clone(),
        by: look.caption.by.clone(),
        transcript: look.caption.transcript.iter().map(exchange_view).collect(),
        said: said
            .map(|(word, witness)| (word, names(witness)))
            .into_iter()
            .filter(|(_, names)| !names.is_empty())
            .collect(),
    }
}

fn exchange_view(exchange: &Exchange) -> ExchangeView {
    ExchangeView {
        question: exchange.question.clone(),
        answer: exchange.answer.clone(),
        asked_twice: exchange.trouble.map(|trouble| match trouble {
            Trouble::Empty => "the first answer was empty",
            Trouble::Echo => "the first answer repeated the question",
            Trouble::Loop => "the first answer repeated itself",
            Trouble::Repeat => "the first answer was the one to an earlier question",
            Trouble::Form => "the first answer did not have the form that was asked for",
            Trouble::Refusal => "the first answer was a refusal",
        }),
    }
}

/// The direction of a gaze in words: ahead if it follows the walker's heading, else a point of the compass or a side of the walker.
fn direction(gaze: Heading, walker: Heading) -> &'static str {
    let is = |other: Heading| gaze.turn_to(other).abs() < SAME_RAD;
    if is(walker) {
        return "ahead";
    }
    Compass::ALL
        .into_iter()
        .find(|point| is(point.heading()))
        .map_or_else(|| side_words(walker.side_of(gaze)), Compass::word)
}

/// The name of the icon for a turn, in the page's `signs.html`.
fn turn_sign(turn: Turn) -> &'static str {
    match turn {
        Turn::Straight => "straight",
        Turn::SlightLeft => "slight-left",
        Turn::SlightRight => "slight-right",
        Turn::Left => "left",
        Turn::Right => "right",
        Turn::Around => "around",
    }
}

fn move_words(step: &Move) -> String {
    let deg = step.turn_rad.to_degrees().abs().round();
    let side = if step.turn_rad < 0.0 { "left" } else { "right" };
    let turn = match step.turn() {
        Turn::Straight => String::new(),
        Turn::Around => format!("turn around ({deg}° {side}), "),
        Turn::SlightLeft | Turn::SlightRight => format!("bear {deg}° {side}, "),
        Turn::Left | Turn::Right => format!("turn {deg}° {side}, "),
    };
    let climb = match step.climb() {
        Climb::Level => String::new(),
        Climb::Up => format!(", {:.1} m up", step.rise_m),
        Climb::Down => format!(", {:.1} m down", -step.rise_m),
    };
    format!("{turn}go {:.1} m{climb}", step.distance_m)
}

#[cfg(test)]
mod tests {
    use super::*;
    use wayword_core::{Caption, Gaze, Spot};

    fn step(deg: f64, rise_m: f64) -> Move {
        Move { turn_rad: deg.to_radians(), distance_m: 2.04, rise_m }
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
        let spot = |score| Some(Spot::new(Found { box_px: [1.0, 2.0, 4.0, 8.0], score }, 10, 1.0));
        let seen = |name: &str, score| Sighting { spot: spot(score), ..Sighting::new(name, Witness::Seen, "d") };
        let look = |heading, sightings| Look {
            gaze: Gaze::quarter(heading),
            caption: Caption { sightings, ..Caption::default() },
        };
        let denied = Sighting { spot: spot(0.9), ..Sighting::new("bed", Witness::Denied, "d") };
        let told = Sighting::new("rug", Witness::Seen, "eye");
        let heading = Heading::new(1.0).unwrap();
        let looks = [
            look(heading, vec![seen("lamp", 0.4), seen("sofa", 0.8), denied, told]),
            look(heading.turned(1.5), vec![seen("door", 0.9)]),
        ];
        let drawn = boxes(&looks, heading);
        assert_eq!(drawn.iter().map(|drawn| &*drawn.name).collect::<Vec<_>>(), ["sofa", "lamp"]);
        assert_eq!((drawn[0].percent, drawn[0].width, drawn[0].height), (80, 3.0, 6.0));
    }

    #[test]
    fn direction_names_points_of_the_compass_and_sides() {
        let heading = Heading::new(1.0).unwrap();
        assert_eq!(direction(heading, heading), "ahead");
        assert_eq!(direction(Compass::West.heading(), heading), "west");
        assert_eq!(direction(heading.turned(1.5), heading), "on the right");
    }
}
