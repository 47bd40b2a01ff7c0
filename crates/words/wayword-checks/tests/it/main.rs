//! The integration tests of `wayword-checks`, one program: what has to hold of verdicts whatever the text is.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod relations;
mod verdicts;

use wayword_checks::{CheckSubject, EndSurroundings, Evidence, EvidenceSource, FrameEvidence, SeenThing, check_text};
use wayword_core::{CheckFinding, InstructionStyle, PathMotion, PathMove, Verdict};

/// A frame of a room, with things in directions (degrees from the heading, positive right).
fn frame(room: &str, things: &[(&str, f64)]) -> FrameEvidence {
    let seen = |(name, deg): &(&str, f64)| SeenThing {
        name: (*name).to_owned(),
        turn_rad: Some(deg.to_radians()),
        ..SeenThing::default()
    };
    FrameEvidence {
        rooms: vec![room.to_owned()],
        things: things.iter().map(seen).collect(),
        knows_things: true,
        level: Some(1),
        ..FrameEvidence::default()
    }
}

/// A walk through frames, with the turns (degrees) before its moves of two metres.
fn walk(frames: Vec<FrameEvidence>, turns_deg: &[f64]) -> Evidence {
    let step = |deg: &f64| PathMove { turn_rad: deg.to_radians(), distance_m: 2.0, rise_m: 0.0 };
    Evidence {
        frames,
        moves: turns_deg.iter().map(step).collect(),
        motion: PathMotion::Known,
        source: EvidenceSource::Labels,
        has_witnesses: false,
        beyond: EndSurroundings::default(),
    }
}

/// Past a plant, a sofa and a lamp in the hallway, then right into the bedroom.
fn flat() -> Evidence {
    let frames = vec![
        frame("hallway", &[("plant", -60.0)]),
        frame("hallway", &[("sofa", 60.0)]),
        frame("hallway", &[("lamp", -60.0), ("mirror", 70.0)]),
        frame("bedroom", &[("bed", 20.0), ("dresser", -40.0)]),
    ];
    walk(frames, &[0.0, 0.0, 90.0])
}

fn style() -> InstructionStyle {
    InstructionStyle { name: "any".into(), ..InstructionStyle::default() }
}

fn findings(text: &str, evidence: &Evidence) -> Vec<CheckFinding> {
    check_text(text, CheckSubject::closed_world(evidence, &style(), None)).findings
}

fn verdict(text: &str, evidence: &Evidence) -> Verdict {
    check_text(text, CheckSubject::closed_world(evidence, &style(), None)).verdict()
}
