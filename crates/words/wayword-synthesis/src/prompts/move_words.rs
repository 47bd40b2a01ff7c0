//! Words for the moves of a walk.

use wayword_core::{ClimbDirection, TurnKind};

/// The name of a frame in reasons.
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

/// The words for a climb, behind the length of the way.
pub(super) fn climb_words(climb: ClimbDirection, rise_m: f64) -> String {
    match climb {
        ClimbDirection::Level => String::new(),
        ClimbDirection::Up => format!(", up {rise_m:.1} metres of stairs"),
        ClimbDirection::Down => format!(", down {:.1} metres of stairs", -rise_m),
    }
}
