//! Joins what labels list with what witnesses saw: what one source named surely, and where, is there, whatever the other lacks.

use super::{Evidence, EvidenceSource, FrameEvidence, SeenThing};
use wayword_core::Heading;
use wayword_language::lexicon::{names_agree, same_colour, same_room};

/// A thing of a label and one that a witness names are the same in directions that differ by at most this, degrees.
const SAME_DIRECTION_DEG: f64 = 45.0;

impl Evidence {
    /// Adds what witnesses saw to the evidence of labels, frame by frame: things that no label lists, colours and materials that the
    /// labels lack, and their guesses. Where the two differ, both stand, and what the text says of that is unverified: another colour of a
    /// thing, and another room of a frame. What a witness denies and labels list is there.
    pub fn add_witnesses(&mut self, witnesses: &Evidence) {
        debug_assert!(self.source == EvidenceSource::Labels);
        self.has_witnesses = true;
        for (frame, seen) in self.frames.iter_mut().zip(&witnesses.frames) {
            for thing in &seen.things {
                match alike_mut(frame, thing) {
                    Some(listed) => {
                        listed.is_witnessed = true;
                        add_looks(listed, thing);
                    }
                    None => frame.things.push(SeenThing { is_unlisted: true, ..thing.clone() }),
                }
            }
            let is_listed = |thing: &&SeenThing| frame.things.iter().any(|other| names_agree(&other.name, &thing.name));
            let guesses: Vec<SeenThing> =
                seen.perhaps.things.iter().filter(|thing| !is_listed(thing)).cloned().collect();
            frame.perhaps.things.extend(guesses);
            let knows = |rooms: &[String], room: &String| rooms.iter().any(|other| same_room(other, room));
            let rooms = seen.rooms.iter().chain(&seen.perhaps.rooms).filter(|room| !knows(&frame.rooms, room));
            let rooms: Vec<String> = rooms.cloned().collect();
            match frame.rooms.is_empty() {
                true => frame.rooms.clone_from(&seen.rooms),
                false => frame.perhaps.rooms.extend(rooms),
            }
        }
    }
}

impl Evidence {
    /// The part of joint evidence that witnesses saw: their things, where labels place them. A writer who knows no labels is told of no
    /// other, and of nothing that the checks would refuse.
    #[must_use]
    pub fn witnessed_part(&self) -> Self {
        let mut part = self.clone();
        for frame in &mut part.frames {
            frame.things.retain(|thing| thing.is_witnessed || thing.is_unlisted);
        }
        part
    }
}

/// The listed thing of a frame that a witness names, the nearest in direction.
fn alike_mut<'a>(frame: &'a mut FrameEvidence, thing: &SeenThing) -> Option<&'a mut SeenThing> {
    let off_rad = |listed: &SeenThing| {
        let pair = listed.turn_rad.zip(thing.turn_rad);
        pair.map_or(0.0, |(a, b)| Heading::NORTH.turned_by(a).turn_to(Heading::NORTH.turned_by(b)).abs())
    };
    let alike = frame.things.iter_mut().filter(|listed| !listed.is_unlisted && names_agree(&listed.name, &thing.name));
    let near = alike.filter(|listed| off_rad(listed) <= SAME_DIRECTION_DEG.to_radians() + thing.turn_slack_rad);
    near.min_by(|a, b| off_rad(a).total_cmp(&off_rad(b)))
}

/// Adds the looks that a witness gives a listed thing.
fn add_looks(listed: &mut SeenThing, seen: &SeenThing) {
    match (&listed.colour, &seen.colour) {
        (None, Some(_)) => {
            listed.colour.clone_from(&seen.colour);
            listed.more_colours.clone_from(&seen.more_colours);
        }
        (Some(known), Some(other)) if !same_colour(known, other) => listed.disputed_colour = Some(other.clone()),
        _ => {}
    }
    listed.material = listed.material.take().or_else(|| seen.material.clone());
    listed.detail = listed.detail.take().or_else(|| seen.detail.clone());
    listed.stands_out |= seen.stands_out;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        CheckSubject, check_own_text, check_text,
        tests::{frame, walk},
    };
    use wayword_core::{CheckKind, InstructionStyle, Verdict};

    fn seen(name: &str, colour: Option<&str>, deg: f64) -> SeenThing {
        SeenThing {
            name: name.to_owned(),
            colour: colour.map(str::to_owned),
            turn_rad: Some(deg.to_radians()),
            turn_slack_rad: 0.26,
            ..SeenThing::default()
        }
    }

    /// Labels list a sofa ahead and a chair, and a witness saw a green sofa, a grey laptop on the left, and perhaps a clock.
    fn joined(labelled: Option<&str>) -> Evidence {
        let mut labels = walk(vec![frame("den", Some(&["sofa", "chair"]), 1); 3], &[(0.0, 0.0), (0.0, 0.0)]);
        let mut captions = walk(vec![frame("kitchen", Some(&[]), 1); 3], &[(0.0, 0.0), (0.0, 0.0)]);
        for (listed, frame) in labels.frames.iter_mut().zip(&mut captions.frames) {
            listed.things.iter_mut().for_each(|thing| thing.turn_rad = Some(0.0));
            listed.things[0].colour = labelled.map(str::to_owned);
            frame.things = vec![seen("couch", Some("green"), 10.0), seen("laptop", Some("grey"), -30.0)];
            frame.perhaps.things = vec![seen("clock", None, 0.0)];
            frame.denied = vec!["chair".to_owned()];
        }
        labels.add_witnesses(&captions);
        labels
    }

    fn verdict_on(text: &str, evidence: &Evidence) -> Verdict {
        let style = InstructionStyle { name: "r2r".to_owned(), ..InstructionStyle::default() };
        let checked = check_text(text, CheckSubject::closed_world(evidence, &style, None));
        let landmarks = checked.findings.iter().filter(|finding| finding.check == CheckKind::Landmarks);
        landmarks.map(|finding| finding.verdict).max().unwrap()
    }

    #[test]
    fn what_one_source_named_is_there_whatever_the_other_lacks() {
        let evidence = joined(None);
        assert_eq!(evidence.source_name(), "labels, captions");
        for (text, wanted) in [
            ("Walk past the grey laptop on your left.", Verdict::Pass),
            ("Walk past the green sofa.", Verdict::Pass),
            // A witness who does not see what labels list is wrong.
            ("Walk past the chair.", Verdict::Pass),
            ("Walk past the red laptop.", Verdict::Fail),
            ("Walk past the treadmill.", Verdict::Fail),
            ("Walk past the clock.", Verdict::Unverified),
            // The sources differ on the room.
            ("Stop in the den.", Verdict::Pass),
            ("Stop in the kitchen.", Verdict::Unverified),
        ] {
            assert_eq!(verdict_on(text, &evidence), wanted, "{text}");
        }
    }

    #[test]
    fn the_witnessed_part_has_what_witnesses_saw_and_no_other_label() {
        let part = joined(None).witnessed_part();
        let names: Vec<&str> = part.frames[0].things.iter().map(|thing| thing.name.as_str()).collect();
        assert_eq!(names, ["sofa", "laptop"]);
    }

    #[test]
    fn a_difference_of_the_sources_makes_that_claim_alone_unverified() {
        let evidence = joined(Some("red"));
        assert_eq!(verdict_on("Walk past the green sofa.", &evidence), Verdict::Unverified);
        assert_eq!(verdict_on("Walk past the red sofa.", &evidence), Verdict::Pass);
        assert_eq!(verdict_on("Walk past the sofa.", &evidence), Verdict::Pass);
        let style = InstructionStyle { name: "r2r".to_owned(), ..InstructionStyle::default() };
        let own = check_own_text("Walk past the laptop.", CheckSubject::closed_world(&evidence, &style, None));
        assert_ne!(own.verdict(), Verdict::Fail, "{own:?}");
    }
}
