//! The kinds of faults.

use super::{
    counts::miscount_things,
    extents::lengthen_pieces,
    flights::leave_out_flights,
    landmarks::{exchange_sides, take_other_things},
    order::exchange_pieces,
    repeats::repeat_texts,
    stops::{relate_wrongly, stop_elsewhere},
    subject::FaultSubject,
    turns::{TurnMove, flip_turns, leave_out_turns, move_turns, put_turns_after_rooms},
};

/// A way to make a text about a house wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum HouseFaultKind {
    /// A turn to the other side.
    TurnFlipped,
    /// A turn behind the room that is entered after it.
    TurnAfterRoom,
    /// A turn before something that is passed before it.
    TurnEarly,
    /// A turn behind something that is passed after it.
    TurnLate,
    /// A turn left out where one can walk straight on.
    TurnLeftOut,
    /// Two neighbouring pieces exchanged.
    PartsExchanged,
    /// A thing on the other side.
    SideExchanged,
    /// A thing replaced by one of another piece.
    LandmarkOfOtherPart,
    /// The stop at another thing in sight.
    WrongEndInSight,
    /// The stairs left out.
    FlightLeftOut,
    /// A sentence or the whole text repeated.
    SaidTwice,
    /// More things than are in sight.
    CountWrong,
    /// A relation between things at the stop that does not hold.
    RelationWrong,
    /// To the end of a hallway that the walk leaves before, or over too many metres.
    ExtentWrong,
}

impl HouseFaultKind {
    /// All kinds.
    pub(super) const ALL: [Self; 14] = [
        Self::TurnFlipped,
        Self::TurnAfterRoom,
        Self::TurnEarly,
        Self::TurnLate,
        Self::TurnLeftOut,
        Self::PartsExchanged,
        Self::SideExchanged,
        Self::LandmarkOfOtherPart,
        Self::WrongEndInSight,
        Self::FlightLeftOut,
        Self::SaidTwice,
        Self::CountWrong,
        Self::RelationWrong,
        Self::ExtentWrong,
    ];

    /// Its name in tables and in JSON.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::TurnFlipped => "turn_flipped",
            Self::TurnAfterRoom => "turn_after_room",
            Self::TurnEarly => "turn_early",
            Self::TurnLate => "turn_late",
            Self::TurnLeftOut => "turn_left_out",
            Self::PartsExchanged => "parts_exchanged",
            Self::SideExchanged => "side_exchanged",
            Self::LandmarkOfOtherPart => "landmark_of_other_part",
            Self::WrongEndInSight => "wrong_end_in_sight",
            Self::FlightLeftOut => "flight_left_out",
            Self::SaidTwice => "said_twice",
            Self::CountWrong => "count_wrong",
            Self::RelationWrong => "relation_wrong",
            Self::ExtentWrong => "extent_wrong",
        }
    }

    /// All texts that a fault of this kind can make of a text. The plan shows each of them to be wrong.
    pub(super) fn list_edits(self, subject: &FaultSubject<'_>) -> Vec<String> {
        match self {
            Self::TurnFlipped => flip_turns(subject),
            Self::TurnAfterRoom => put_turns_after_rooms(subject),
            Self::TurnEarly => move_turns(subject, TurnMove::Earlier),
            Self::TurnLate => move_turns(subject, TurnMove::Later),
            Self::TurnLeftOut => leave_out_turns(subject),
            Self::PartsExchanged => exchange_pieces(subject),
            Self::SideExchanged => exchange_sides(subject),
            Self::LandmarkOfOtherPart => take_other_things(subject),
            Self::WrongEndInSight => stop_elsewhere(subject),
            Self::FlightLeftOut => leave_out_flights(subject),
            Self::SaidTwice => repeat_texts(subject),
            Self::CountWrong => miscount_things(subject),
            Self::RelationWrong => relate_wrongly(subject),
            Self::ExtentWrong => lengthen_pieces(subject),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            plan::HousePlan,
            test_plan::{hallway_house, hallway_subject},
        },
        *,
    };
    use std::collections::BTreeSet;

    #[test]
    fn all_kinds_are_listed_once_under_names_of_their_own() {
        let names: BTreeSet<&str> = HouseFaultKind::ALL.map(HouseFaultKind::name).into();
        assert_eq!(names.len(), HouseFaultKind::ALL.len());
    }

    #[test]
    fn list_edits_changes_the_text_and_begins_it_with_a_capital() {
        let plan = HousePlan::new(hallway_house());
        let text = "Walk past the bookshelf, pass the plant on your left. Walk down the hallway. Turn left and enter \
                    the bedroom. Pass the bed, stop by the dresser.";
        let subject = hallway_subject(&plan, text);
        let mut kinds = 0;
        for kind in HouseFaultKind::ALL {
            let edits = kind.list_edits(&subject);
            kinds += usize::from(!edits.is_empty());
            for edited in edits {
                assert_ne!(edited, text, "{kind:?}");
                assert!(edited.starts_with(|c: char| c.is_uppercase()) && edited.ends_with('.'), "{kind:?}: {edited}");
                assert!(!edited.contains("  ") && !edited.contains(" ."), "{kind:?}: {edited}");
            }
        }
        assert!(kinds >= 8, "{kinds}");
    }
}
