//! The words for a part of a film by rules: its turn, its stairs, the room that it enters, and a thing that it goes to.

use super::cuts::FilmPart;
use wayword_core::TurnKind;
use wayword_language::lexicon::room_name;

/// What a part leads to, as far as somebody saw it.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct PartSights {
    /// The room at its end, where that is another than at its beginning.
    pub(super) enters: Option<String>,
    /// A thing that it goes to.
    pub(super) towards: Option<String>,
    /// Whether the walk ends with it.
    pub(super) is_last: bool,
}

/// The least rise that is told, metres.
const TOLD_RISE_M: f64 = 0.8;

/// What the motion of a part tells, without anything seen.
pub(super) fn motion_phrase(part: &FilmPart, is_last: bool) -> String {
    part_phrase(part, &PartSights { is_last, ..PartSights::default() })
}

/// A sentence for a part.
pub(super) fn part_phrase(part: &FilmPart, sights: &PartSights) -> String {
    let turn = match TurnKind::from_rad(part.turn_rad) {
        TurnKind::Straight => None,
        TurnKind::SlightLeft => Some("bear left"),
        TurnKind::SlightRight => Some("bear right"),
        TurnKind::Left => Some("turn left"),
        TurnKind::Right => Some("turn right"),
        TurnKind::Around => Some("turn around"),
    };
    let climb = match part.rise_m {
        rise if rise >= TOLD_RISE_M => Some("go up the stairs".to_owned()),
        rise if rise <= -TOLD_RISE_M => Some("go down the stairs".to_owned()),
        _ => None,
    };
    let enters = sights.enters.as_deref().map(|room| match room_name(room) {
        Some("stairs") => "walk to the stairs".to_owned(),
        name => format!("go into the {}", name.unwrap_or(room)),
    });
    let towards = sights.towards.as_deref();
    let way = match (climb, enters, towards) {
        (Some(climb), _, _) => Some(climb),
        (None, Some(enters), _) => Some(enters),
        (None, None, Some(thing)) if sights.is_last => Some(format!("stop at the {thing}")),
        (None, None, Some(thing)) => Some(format!("walk to the {thing}")),
        (None, None, None) if turn.is_none() && !sights.is_last => Some("go straight ahead".to_owned()),
        (None, None, None) => None,
    };
    let ends = sights.is_last && !way.as_deref().is_some_and(|way| way.starts_with("stop"));
    let steps = [turn.map(str::to_owned), way, ends.then(|| "stop".to_owned())];
    let steps: Vec<String> = steps.into_iter().flatten().collect();
    let sentence = match steps.as_slice() {
        [] => "go straight ahead".to_owned(),
        [only] => only.clone(),
        [first, rest @ ..] => format!("{first}, then {}", rest.join(" and ")),
    };
    let mut letters = sentence.chars();
    let first = letters.next().map(|first| first.to_uppercase().to_string()).unwrap_or_default();
    format!("{first}{}.", letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::annotate::cuts::PartStart;

    fn phrase(turn_deg: f64, rise_m: f64, enters: Option<&str>, towards: Option<&str>, is_last: bool) -> String {
        let part = FilmPart { from: 0, to: 4, start: PartStart::Turn, turn_rad: turn_deg.to_radians(), rise_m };
        let sights = PartSights { enters: enters.map(str::to_owned), towards: towards.map(str::to_owned), is_last };
        part_phrase(&part, &sights)
    }

    #[test]
    fn each_fact_of_a_part_has_its_words() {
        assert_eq!(phrase(-90.0, 0.0, None, None, false), "Turn left.");
        assert_eq!(phrase(40.0, 0.0, Some("kitchen"), Some("sink"), false), "Bear right, then go into the kitchen.");
        assert_eq!(phrase(0.0, 1.5, None, None, false), "Go up the stairs.");
        assert_eq!(phrase(0.0, -1.5, None, None, true), "Go down the stairs, then stop.");
        assert_eq!(phrase(0.0, 0.0, None, Some("sofa"), false), "Walk to the sofa.");
        assert_eq!(phrase(170.0, 0.0, None, Some("sofa"), true), "Turn around, then stop at the sofa.");
        assert_eq!(phrase(0.0, 0.0, None, None, false), "Go straight ahead.");
        assert_eq!(phrase(0.0, 0.0, None, None, true), "Stop.");
    }
}
