//! Words for the moves of a walk: one move with its numbers, and the whole way in short.

use wayword_core::{ClimbDirection, PathMove, TurnKind};

/// Most sentences of the overview; a longer way has no overview.
const MAX_OVERVIEW_SENTENCES: usize = 40;

/// The name of a frame in reasons and in the overview.
pub(super) fn frame_name(at: usize) -> String {
    format!("Frame {at}")
}

/// The words for a turn of the walk.
pub(super) fn turn_words(turn: TurnKind) -> &'static str {
    match turn {
        TurnKind::Straight => "goes straight on",
        TurnKind::SlightLeft => "turns slightly left",
        TurnKind::SlightRight => "turns slightly right",
        TurnKind::Left => "turns left",
        TurnKind::Right => "turns right",
        TurnKind::Around => "turns around",
    }
}

/// A move in words, with its numbers.
pub(super) fn move_words(step: &PathMove) -> String {
    let deg = step.turn_rad.to_degrees().abs().round();
    let turn = match step.turn() {
        TurnKind::Straight => "straight on".to_owned(),
        turn => format!("{} ({deg} degrees)", turn_words(turn)),
    };
    format!("{turn}, {:.1} metres{}", step.distance_m, climb_words(step.climb(), step.rise_m))
}

fn climb_words(climb: ClimbDirection, rise_m: f64) -> String {
    match climb {
        ClimbDirection::Level => String::new(),
        ClimbDirection::Up => format!(", up {rise_m:.1} metres of stairs"),
        ClimbDirection::Down => format!(", down {:.1} metres of stairs", -rise_m),
    }
}

/// The way in short: a move that goes straight on is joined to the one before.
pub(super) fn way_overview(moves: &[PathMove]) -> Vec<String> {
    // First frame, last frame, the turn at the first frame, climb, length in metres.
    let mut steps: Vec<(usize, usize, TurnKind, ClimbDirection, f64)> = Vec::new();
    for (at, step) in moves.iter().enumerate() {
        match steps.last_mut() {
            Some((_, to, _, climb, length_m)) if step.turn() == TurnKind::Straight && *climb == step.climb() => {
                (*to, *length_m) = (at + 1, *length_m + step.distance_m);
            }
            _ => steps.push((at, at + 1, step.turn(), step.climb(), step.distance_m)),
        }
    }
    if steps.len() > MAX_OVERVIEW_SENTENCES || steps.len() < 2 {
        return Vec::new();
    }
    let sentences = steps.into_iter().map(|(from, to, turn, climb, length_m)| {
        let turn = if turn == TurnKind::Straight { String::new() } else { format!("{}, then ", turn_words(turn)) };
        let stairs = match climb {
            ClimbDirection::Level => "",
            ClimbDirection::Up => " up the stairs",
            ClimbDirection::Down => " down the stairs",
        };
        format!("At {} the walk {turn}goes {length_m:.0} metres{stairs}, to {}", frame_name(from), frame_name(to))
    });
    sentences.collect()
}
