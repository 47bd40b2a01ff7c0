//! The fault of a number: more things than are in sight.

use super::{claims::LandmarkClaim, locate::LocatedPiece, subject::FaultSubject, word_lists::NUMBER_WORDS};

/// Things in sight within this distance of the stretch of a piece count, metres.
const COUNTED_M: f64 = 6.0;

/// The text with a number of things that is larger than that of all in sight, for each thing for which there is one.
pub(super) fn miscount_things(subject: &FaultSubject<'_>) -> Vec<String> {
    let mut edited = Vec::new();
    for (at, piece) in subject.pieces.iter().enumerate() {
        for landmark in &piece.claims.landmarks {
            let in_sight = count_in_sight(subject, piece, landmark);
            let change = subject.text.pieces.get(at).and_then(|words| miscount(words, landmark, in_sight));
            let text = change.and_then(|(span, now)| subject.text.with_words(at, span, &now));
            edited.extend(text.map(|text| text.render()));
        }
    }
    edited
}

/// How many things that a landmark may mean are in sight from the stretch of a piece. Furniture hides nothing here,
/// so a person may see fewer.
fn count_in_sight(subject: &FaultSubject<'_>, piece: &LocatedPiece, landmark: &LandmarkClaim) -> usize {
    let stretch = subject.stretch(piece);
    let things = subject.walk.list_things(landmark.word).filter(|sighted| {
        stretch.iter().filter_map(|spot| sighted.sight_m.get(*spot)).any(|off_m| *off_m <= COUNTED_M)
    });
    things.count()
}

/// New words for a landmark of which `in_sight` are there, with the byte range that they replace; `None` where no
/// number is surely wrong, or the words cannot be put into the plural.
fn miscount(piece: &str, landmark: &LandmarkClaim, in_sight: usize) -> Option<([usize; 2], String)> {
    let old = landmark.number.map(|(_, number)| number);
    let mut numbers = NUMBER_WORDS.iter().rev().filter(|(_, number)| *number > in_sight && Some(*number) != old);
    let (number, _) = numbers.next().filter(|_| in_sight > 0)?;
    if let Some((span, _)) = landmark.number {
        return Some((span, (*number).to_owned()));
    }
    let word = landmark.word;
    if landmark.is_plural || !landmark.has_article || word.one == word.many {
        return None;
    }
    // Between the article and the name are adjectives.
    let phrase = piece.get(landmark.phrase[0]..landmark.name[0])?;
    let (_, adjectives) = phrase.split_once(' ')?;
    Some((landmark.phrase, format!("the {number} {adjectives}{}", word.many)))
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            claims::read_claims,
            plan::HousePlan,
            test_plan::{hallway_house, hallway_subject},
        },
        *,
    };

    /// What a piece with one landmark becomes.
    fn miscounted(piece: &str, in_sight: usize) -> Option<String> {
        let claims = read_claims(piece);
        let ([from, to], now) = miscount(piece, &claims.landmarks[0], in_sight)?;
        Some(format!("{}{now}{}", &piece[..from], &piece[to..]))
    }

    #[test]
    fn miscount_names_more_things_than_are_in_sight() {
        assert_eq!(miscounted("pass the blue vase on it", 1).as_deref(), Some("pass the four blue vases on it"));
        assert_eq!(miscounted("pass the two chairs", 2).as_deref(), Some("pass the four chairs"));
        assert_eq!(miscounted("pass the four chairs", 2).as_deref(), Some("pass the three chairs"));
        assert_eq!(miscounted("pass the four chairs", 3), None);
        assert_eq!(miscounted("pass the blue vase", 4), None);
        assert_eq!(miscounted("pass the blue vase", 0), None, "the generator found none at all");
        assert_eq!(miscounted("pass the chairs", 1), None, "a plural without a number");
        assert_eq!(miscounted("pass the coat hooks", 1), None);
    }

    #[test]
    fn miscount_things_counts_what_is_in_sight_of_the_piece() {
        let plan = HousePlan::new(hallway_house());
        let edited = miscount_things(&hallway_subject(&plan, "Walk past the plant. Turn left. Stop."));
        assert_eq!(edited, ["Walk past the four plants. Turn left. Stop."]);
        let mut house = hallway_house();
        for x in [300, 400, 700] {
            let mut plant = house.furniture[1].clone();
            plant.footprint = wayword_house::RectCm::new(x, 145, x + 50, 194);
            house.furniture.push(plant);
        }
        let plan = HousePlan::new(house);
        assert!(miscount_things(&hallway_subject(&plan, "Walk past the plant. Turn left. Stop.")).is_empty());
    }
}
