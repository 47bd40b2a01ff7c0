use super::*;
use std::collections::BTreeSet;
use wayword_language::reading::read_instruction;

/// A walk of places a metre apart. Each has a room, things, and the turn in degrees on the way to the next.
fn walk(places: &[(&str, &[&str], f64)]) -> FilmedWalk {
    let place = |(room, things, _): &(&str, &[&str], f64)| FilmedPlace {
        things: things.iter().map(|thing| (*thing).to_owned()).collect(),
        rooms: vec![(*room).to_owned()],
        knows_things: true,
        ..FilmedPlace::default()
    };
    let hop = |(_, _, turn_deg): &(&str, &[&str], f64)| FilmedHop {
        turn_rad: Some(turn_deg.to_radians()),
        rise_m: Some(0.0),
        length_m: Some(1.0),
    };
    FilmedWalk {
        places: places.iter().map(place).collect(),
        hops: places[..places.len() - 1].iter().map(hop).collect(),
    }
}

fn corner() -> FilmedWalk {
    walk(&[
        ("hallway", &["painting"], 0.0),
        ("hallway", &["painting"], 0.0),
        ("hallway", &["sofa"], -90.0),
        ("living room", &["sofa", "lamp"], 0.0),
        ("living room", &["lamp"], 0.0),
        ("living room", &["piano"], 0.0),
    ])
}

fn judge(text: &str, walk: &FilmedWalk) -> JudgedPair {
    let reading = read_instruction(text, &BTreeSet::new()).into_claims();
    JudgedPair::new(&PartedText::from_reading(text, &reading), walk).unwrap()
}

fn fits(text: &str, walk: &FilmedWalk) -> Vec<(String, FilmClaimFit)> {
    let judged = judge(text, walk);
    judged.parts.into_iter().flat_map(|part| part.claims).map(|claim| (claim.what, claim.fit)).collect()
}

fn chance(text: &str, walk: &FilmedWalk) -> f64 {
    PairWeights::for_eye(PairEye::Pictures).chance_wrong(&judge(text, walk), 0.5)
}

const RIGHT: &str = "Walk past the painting. Turn left into the living room. Stop at the piano.";

#[test]
fn each_claim_of_a_right_text_fits_its_stretch() {
    let fits = fits(RIGHT, &corner());
    assert!(fits.iter().all(|(_, fit)| *fit == FilmClaimFit::Fits), "{fits:?}");
    let parts = judge(RIGHT, &corner()).parts;
    assert!(parts.windows(2).all(|pair| pair[0].stretch[1] == pair[1].stretch[0]), "{parts:?}");
}

#[test]
fn a_turn_to_the_other_side_is_the_opposite_and_a_thing_that_nobody_saw_is_nowhere() {
    let text = "Walk past the bathtub. Turn right into the living room. Stop at the piano.";
    let found = fits(text, &corner());
    assert!(found.contains(&("a bathtub".to_owned(), FilmClaimFit::Nowhere)), "{found:?}");
    assert!(found.contains(&("a turn to the right".to_owned(), FilmClaimFit::Opposite)), "{found:?}");
}

#[test]
fn what_is_not_known_decides_nothing() {
    let mut walk = corner();
    walk.hops.iter_mut().for_each(|hop| *hop = FilmedHop::default());
    assert_eq!(walk.motion(), PairMotion::Unknown);
    let found = fits("Turn right. Go up the stairs.", &walk);
    let unknown = |what: &str| found.contains(&(what.to_owned(), FilmClaimFit::Unknown));
    assert!(unknown("a turn to the right") && unknown("stairs up"), "{found:?}");
    walk.places.iter_mut().for_each(|place| *place = FilmedPlace::default());
    let found = fits("Walk to the bathtub.", &walk);
    assert_eq!(found, [("a bathtub".to_owned(), FilmClaimFit::Unknown)]);
}

#[test]
fn an_undecided_turn_does_not_contradict_a_turn() {
    let mut walk = corner();
    walk.hops[2].turn_rad = None;
    let found = fits(RIGHT, &walk);
    assert!(found.contains(&("a turn to the left".to_owned(), FilmClaimFit::Unknown)), "{found:?}");
}

#[test]
fn wrong_texts_have_higher_chances_than_right_ones() {
    let right = chance(RIGHT, &corner());
    for wrong in [
        "Walk past the painting. Turn right into the living room. Stop at the piano.",
        "Go up the stairs and turn right. Walk past the oven and stop at the bathtub.",
        "Walk past the treadmill. Turn left into the garage. Stop at the car.",
    ] {
        assert!(chance(wrong, &corner()) > right + 0.2, "{wrong}: {} against {right}", chance(wrong, &corner()));
    }
}

#[test]
fn a_higher_base_rate_gives_a_higher_chance() {
    let weights = PairWeights::for_eye(PairEye::Labels);
    let judged = judge(RIGHT, &corner());
    let chances = [0.0, 0.2, 0.5, 1.0].map(|rate| weights.chance_wrong(&judged, rate));
    assert!(
        chances.windows(2).all(|pair| pair[0] < pair[1]) && chances.iter().all(|chance| (0.0..=1.0).contains(chance))
    );
}

#[test]
fn shipped_weights_are_those_of_their_files() {
    for (eye, text) in
        [(PairEye::Pictures, include_str!("by_pictures.json")), (PairEye::Labels, include_str!("by_labels.json"))]
    {
        let file = PairWeights::parse(text).unwrap();
        assert_eq!(*PairWeights::for_eye(eye), file);
        assert_eq!(file.weights.len(), 3, "{eye:?}");
    }
    assert!(PairWeights::parse("{}").is_err());
}

#[test]
fn moved_chances_have_the_asked_mean_and_the_same_order() {
    let weighted = [(0.1, 1.0), (0.4, 1.0), (0.9, 2.0)];
    let moved = chances_with_mean(&weighted, 0.2);
    let mean = (moved[0] + moved[1] + 2.0 * moved[2]) / 4.0;
    assert!((mean - 0.2).abs() < 1e-6 && moved[0] < moved[1] && moved[1] < moved[2], "{moved:?}");
}

#[test]
fn a_text_without_steps_and_a_film_of_one_place_are_not_judged() {
    let reading = read_instruction("", &BTreeSet::new()).into_claims();
    assert!(JudgedPair::new(&PartedText::from_reading("", &reading), &corner()).is_none());
    let reading = read_instruction(RIGHT, &BTreeSet::new()).into_claims();
    let parted = PartedText::from_reading(RIGHT, &reading);
    assert!(JudgedPair::new(&parted, &FilmedWalk::default()).is_none());
}
