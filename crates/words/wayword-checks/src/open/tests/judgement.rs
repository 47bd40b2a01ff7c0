//! Tests of the weighing of missing labels: sights, features, weights, corrections and verdicts on places.

use super::{any, path};
use crate::{
    CheckSubject, Evidence, EvidenceSource, PathSurroundings, SeenThing, WorldReach, check_text,
    open::{
        Calibration, ClaimCase, ClaimObservation, ClaimSight, MissedClaim, NameOffsets, PlaceClaim, SilenceWeights,
        class_name, read_claims, sight_of_claim,
    },
};
use std::collections::{BTreeMap, BTreeSet};
use wayword_core::{CheckKind, Verdict};
use wayword_language::{lexicon::ThingClass, reading::read_instruction};

/// The first claim of a text.
fn claim(text: &str) -> PlaceClaim {
    let reading = read_instruction(text, &BTreeSet::new()).into_claims();
    read_claims(&reading).remove(0)
}

fn missed(case: ClaimCase, nearest_m: f64) -> MissedClaim {
    MissedClaim { case, features: Vec::new(), nearest_m }
}

fn sight_in(text: &str, evidence: &Evidence, around: Option<&PathSurroundings>) -> ClaimSight {
    sight_of_claim(&claim(text), evidence, around, SilenceWeights::shipped())
}

/// The sight of the first claim of a text on the path between two viewpoints.
fn sight(text: &str, from: usize, to: usize) -> ClaimSight {
    let (_, evidence, around) = path(from, to);
    sight_in(text, &evidence, Some(&around))
}

/// The missed claim of a text, with its features that count one, and the others.
fn features(text: &str, from: usize, to: usize) -> (MissedClaim, BTreeSet<String>, BTreeMap<String, f64>) {
    let ClaimSight::Missed(missed) = sight(text, from, to) else { panic!("{text} is not missed") };
    let (ones, others): (Vec<_>, Vec<_>) = missed.features.iter().cloned().partition(|(_, value)| *value == 1.0);
    (missed, ones.into_iter().map(|(name, _)| name).collect(), others.into_iter().collect())
}

#[test]
fn sight_is_shown_unknown_or_missed() {
    for (text, wanted) in [
        ("Walk past the wall.", ClaimSight::Shown),
        ("Walk past the corner.", ClaimSight::Shown),
        ("Walk past the sofa.", ClaimSight::Shown),
        ("Walk down the hallway.", ClaimSight::Shown),
        ("Walk through the doorway.", ClaimSight::Shown),
        ("Walk through the door.", ClaimSight::Shown),
        ("Walk past the xylorimba.", ClaimSight::Unknown),
        ("Walk into the basement.", ClaimSight::Unknown),
    ] {
        assert_eq!(sight(text, 0, 3), wanted, "{text}");
    }
    for text in ["Walk past the toilet.", "Walk into the kitchen.", "Walk into the garage.", "Walk past the pillar."] {
        assert!(matches!(sight(text, 0, 3), ClaimSight::Missed(_)), "{text}");
    }
    // In one room, the path crosses no door.
    for text in ["Walk through the doorway.", "Walk through the door."] {
        assert_eq!(sight(text, 1, 3), ClaimSight::Unknown, "{text}");
    }
    let (_, evidence, _) = path(0, 3);
    for text in ["Walk past the toilet.", "Walk into the kitchen.", "Walk through the door."] {
        assert_eq!(sight_in(text, &evidence, None), ClaimSight::Unknown, "{text}");
    }
    assert_eq!(sight_in("Walk down the hallway.", &evidence, None), ClaimSight::Shown);
}

#[test]
fn at_a_stop_only_the_end_of_the_path_shows_a_place() {
    assert_eq!(sight("Walk past the bed.", 0, 3), ClaimSight::Shown);
    assert!(matches!(sight("Stop at the bed.", 0, 3), ClaimSight::Missed(_)));
    assert_eq!(sight("Stop at the chair.", 0, 3), ClaimSight::Shown);
    assert!(matches!(sight("Stop in the bedroom.", 0, 5), ClaimSight::Missed(_)));
    assert_eq!(sight("Stop in the living room.", 0, 5), ClaimSight::Shown);
    // The same by the frames alone.
    let (_, mut evidence, _) = path(0, 3);
    evidence.frames[1].things.push(SeenThing { name: "toilet".into(), ..SeenThing::default() });
    assert_eq!(sight_in("Walk past the toilet.", &evidence, None), ClaimSight::Shown);
    assert_eq!(sight_in("Stop at the toilet.", &evidence, None), ClaimSight::Unknown);
    evidence.frames[3].things.push(SeenThing { name: "toilet".into(), ..SeenThing::default() });
    assert_eq!(sight_in("Stop at the toilet.", &evidence, None), ClaimSight::Shown);
}

#[test]
fn stairs_are_shown_by_frames_on_stairs() {
    let (_, evidence, _) = path(7, 9);
    assert_eq!(sight_in("Walk to the stairs.", &evidence, None), ClaimSight::Shown);
    let (_, level, _) = path(4, 6);
    assert_eq!(sight_in("Walk to the stairs.", &level, None), ClaimSight::Unknown);
}

#[test]
fn a_room_is_unknown_where_a_frame_or_a_viewpoint_has_none() {
    let (_, mut evidence, around) = path(0, 3);
    assert!(matches!(sight_in("Walk into the kitchen.", &evidence, Some(&around)), ClaimSight::Missed(_)));
    evidence.frames[2].rooms.clear();
    assert_eq!(sight_in("Walk into the kitchen.", &evidence, Some(&around)), ClaimSight::Unknown);
    assert!(matches!(sight_in("Walk past the toilet.", &evidence, Some(&around)), ClaimSight::Missed(_)));
}

#[test]
fn an_object_far_from_the_path_has_these_features() {
    // The refrigerator is at 14 metres, and the path ends at 6.
    let (missed, ones, others) = features("Walk past the refrigerator.", 0, 3);
    assert_eq!(missed.case, ClaimCase::Thing);
    assert!((missed.nearest_m - 65_f64.sqrt()).abs() < 1e-9, "{}", missed.nearest_m);
    for name in [
        "bias",
        "off 8-15m",
        "3-4 hops",
        "3-4 hops far",
        "class fridge",
        "class fridge far",
        "relation past",
        "relation past far",
        "passes no room of it",
        "passes no room of it far",
        "no room of the class",
        "no room of the class fridge",
        "no room of the class far",
        "no room of the class fridge far",
        "salience 3 far",
    ] {
        assert!(ones.contains(name), "{name}: {ones:?}");
    }
    assert_eq!(ones.len(), 15, "{ones:?}");
    // Near the path are three things of the bedroom, two, two and two, a piano, and three at the fourth frame's end.
    let (_, _, around) = path(0, 3);
    let density = around.objects_per_frame().ln_1p();
    let wanted = [("listed nearby", density), ("listed nearby far", density), ("listed in the building", 2_f64.ln())];
    for (name, value) in wanted {
        assert!((others[name] - value).abs() < 1e-9, "{name}: {others:?}");
    }
    assert_eq!(others.len(), 3, "{others:?}");
}

#[test]
fn an_object_at_a_stop_has_features_of_the_end() {
    let (missed, ones, others) = features("Stop at the bed.", 0, 3);
    assert_eq!(missed.case, ClaimCase::ThingAtStop);
    assert!((missed.nearest_m - 37_f64.sqrt()).abs() < 1e-9);
    for name in ["off 5-8m", "3-4 hops", "path near", "relation stop close", "passes its room", "room of the class"] {
        assert!(ones.contains(name), "{name}: {ones:?}");
    }
    let (_, _, around) = path(0, 3);
    assert!((others["listed nearby"] - ((1 + around.objects_at_end()) as f64).ln()).abs() < 1e-9);
    assert!(!ones.iter().any(|name| name.starts_with("kin")), "no bed is near the end: {ones:?}");
}

#[test]
fn kin_and_the_size_of_the_building_are_features() {
    // Seats are near the path, and no bench is listed anywhere.
    let (missed, ones, others) = features("Walk past the bench.", 0, 3);
    assert!(missed.nearest_m.is_infinite());
    for name in ["kin nowhere", "kin seat", "off nowhere", "no way", "no way nowhere"] {
        assert!(ones.contains(name), "{name}: {ones:?}");
    }
    assert_eq!(others["listed in the building"], 0.0);
    assert!((others["size of the building"] - 11_f64.ln()).abs() < 1e-9, "ten viewpoints list things");
    assert!(!ones.contains("passes its room") && !ones.contains("passes no room of it"));
    let (_, ones, _) = features("Walk past the toilet.", 0, 3);
    assert!(!ones.iter().any(|name| name.starts_with("kin")), "{ones:?}");
}

#[test]
fn a_room_has_features_of_its_group() {
    let (missed, ones, others) = features("Walk through the bathroom.", 0, 3);
    assert_eq!((missed.case, missed.nearest_m), (ClaimCase::Room, 10.0));
    for name in ["bias", "bath 8-15m", "bath 5+ hops", "bath through", "bath through far"] {
        assert!(ones.contains(name), "{name}: {ones:?}");
    }
    assert_eq!((ones.len(), others["rooms nearby"]), (5, 3.0));
    let (missed, ones, _) = features("Walk into the kitchen and stop in the bedroom.", 0, 3);
    assert_eq!((missed.case, ones.contains("fixture enter close")), (ClaimCase::Room, true));
    let (missed, ones, _) = features("Stop in the bedroom.", 0, 3);
    assert_eq!((missed.case, missed.nearest_m), (ClaimCase::RoomAtStop, 6.0));
    assert!(ones.contains("path near") && ones.contains("fixture 5-8m") && ones.contains("fixture 3-4 hops"));
    for text in ["Walk into the garage.", "Stop in the garage."] {
        assert_eq!(features(text, 0, 3).0.case, ClaimCase::RoomLacking, "{text}");
    }
}

#[test]
fn hops_and_metres_fall_into_bins() {
    // The bathroom is at 16 metres, and its bathtub one metre aside: paths that end nearer and nearer to them. A
    // toilet may be a room or a thing, so it is as near as the bathroom.
    for (thing, to, hops, off, reach) in [
        ("toilet", 0, "5+ hops", "off 15m+", "far"),
        ("toilet", 3, "5+ hops", "off 8-15m", "far"),
        ("bathtub", 4, "3-4 hops", "off 8-15m", "far"),
        ("toilet", 4, "3-4 hops", "off 5-8m", "close"),
        ("bathtub", 5, "3-4 hops", "off 5-8m", "close"),
        ("toilet", 6, "2 hops", "off 3-5m", "close"),
        ("bathtub", 6, "2 hops", "off 3-5m", "close"),
    ] {
        let (_, ones, _) = features(&format!("Stop at the {thing}."), 0, to);
        let both = format!("{hops} {reach}");
        for name in [hops, off, &both] {
            assert!(ones.contains(name), "{to} {name}: {ones:?}");
        }
    }
    for thing in ["toilet", "bathtub"] {
        assert_eq!(sight(&format!("Stop at the {thing}."), 0, 7), ClaimSight::Shown);
    }
}

#[test]
fn a_claim_about_a_thing_fails_from_eight_metres_on() {
    assert!(missed(ClaimCase::Thing, 8.0).can_fail() && missed(ClaimCase::Thing, f64::INFINITY).can_fail());
    assert!(!missed(ClaimCase::Thing, 7.9).can_fail());
    for case in &ClaimCase::ALL[1..] {
        assert!(missed(*case, 0.0).can_fail(), "{case:?}");
    }
}

#[test]
fn company_counts_the_other_claims_that_are_shown_and_missed() {
    let mut one = missed(ClaimCase::Thing, 9.0);
    let other = ClaimSight::Missed(missed(ClaimCase::Room, 9.0));
    one.add_company_features(
        [ClaimSight::Shown, ClaimSight::Unknown, ClaimSight::Shown, ClaimSight::Shown, other].iter(),
    );
    let wanted = [("others shown".to_owned(), 4_f64.ln()), ("others missed".to_owned(), 2_f64.ln())];
    assert_eq!(one.features.len(), 2);
    for (found, wanted) in one.features.iter().zip(wanted) {
        assert!(found.0 == wanted.0 && (found.1 - wanted.1).abs() < 1e-12, "{found:?}");
    }
    let mut alone = missed(ClaimCase::Thing, 9.0);
    alone.add_company_features([].iter());
    assert!(alone.features.iter().all(|(_, value)| *value == 0.0));
}

#[test]
fn cases_and_classes_have_the_names_of_the_file() {
    let names = ClaimCase::ALL.map(ClaimCase::name);
    assert_eq!(names, ["thing", "thing_at_stop", "room", "room_at_stop", "room_lacking"]);
    assert_eq!((class_name(ThingClass::Seat), class_name(ThingClass::WallArt)), ("seat".into(), "wallart".into()));
}

fn small_weights() -> SilenceWeights {
    let file = "[room_groups]\nbath = [\"bathroom\"]\n[homes]\nbed = [\"bedroom\"]\n\
                [cases.thing]\nfails_at = 3.0\n[cases.thing.weights]\nbias = 0.5\nfar = -2.0\n";
    SilenceWeights::read_weights(file).unwrap()
}

#[test]
fn weights_are_summed_by_feature() {
    let weights = small_weights();
    let ratio = |case, features: &[(&str, f64)]| {
        let features = features.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
        weights.log_ratio(&MissedClaim { case, features, nearest_m: 9.0 })
    };
    assert_eq!(ratio(ClaimCase::Thing, &[("bias", 1.0), ("far", 0.25), ("unknown", 9.0)]), Some(0.0));
    assert_eq!(ratio(ClaimCase::Thing, &[("bias", 2.0)]), Some(1.0));
    assert_eq!(ratio(ClaimCase::Thing, &[]), Some(0.0));
    assert_eq!(ratio(ClaimCase::Room, &[("bias", 1.0)]), None);
    assert_eq!(weights.table_for(ClaimCase::Thing).map(|table| table.fails_at), Some(3.0));
    assert!(weights.table_for(ClaimCase::Room).is_none());
}

#[test]
fn rooms_have_groups_and_classes_have_homes() {
    let weights = small_weights();
    assert_eq!(
        ["bathroom", "restroom", "garage", "zorble"].map(|room| weights.room_group(room)),
        ["bath", "bath", "other", "other"]
    );
    assert!(weights.homes_of(ThingClass::Bed).is_some_and(|homes| homes.contains("bedroom")));
    assert!(weights.homes_of(ThingClass::Seat).is_none());
    assert!(SilenceWeights::read_weights("words = 1").is_err());
}

fn calibration(name: &str, close: f64, far: f64, nowhere: f64) -> Calibration {
    let names = BTreeMap::from([(name.to_owned(), NameOffsets { close, far, nowhere })]);
    Calibration { names, ..Calibration::default() }
}

#[test]
fn offsets_are_chosen_by_name_and_distance_and_bounded() {
    let sofa = claim("Walk past the couch.");
    let offset =
        |calibration: &Calibration, nearest_m: f64| calibration.offset_for(&sofa, &missed(ClaimCase::Thing, nearest_m));
    let of_sofas = calibration("sofa", 0.5, 1.0, 2.0);
    let offsets: Vec<f64> = [0.0, 8.0, 8.1, f64::INFINITY].iter().map(|far_m| offset(&of_sofas, *far_m)).collect();
    assert_eq!(offsets, [0.5, 0.5, 1.0, 2.0]);
    assert_eq!(offset(&calibration("lamp", 0.5, 1.0, 2.0), 1.0), 0.0);
    assert_eq!(offset(&calibration("sofa", 99.0, -99.0, 0.0), 1.0), 3.0);
    assert_eq!(offset(&calibration("sofa", 99.0, -99.0, 0.0), 9.0), -3.0);
    // Rooms are counted by their usual names.
    let hall = claim("Walk through the restroom.");
    let bath = calibration("bathroom", 0.5, 0.0, 0.0);
    assert_eq!(bath.offset_for(&hall, &missed(ClaimCase::Room, 1.0)), 0.5);
}

#[test]
fn a_name_leaves_a_missing_label_open_where_it_is_often_right() {
    let open = |close: f64, name: &str| calibration("sofa", close, 0.0, 0.0).leaves_open(name);
    assert_eq!((open(-0.7, "couch"), open(0.7, "sofa")), (Some(true), Some(false)));
    assert_eq!((open(-0.69, "sofa"), open(0.69, "sofa")), (None, None), "the odds do not even double");
    assert_eq!((open(std::f64::consts::LN_2, "sofa"), open(-0.7, "lamp")), (Some(false), None));
    // A member of the kind is known by the kind.
    assert_eq!(calibration("chair", -0.7, 0.0, 0.0).leaves_open("dining chair"), Some(true));
}

#[test]
fn check_numbers_names_the_entry_that_is_not_finite() {
    assert_eq!(calibration("sofa", 1.0, 2.0, 3.0).check_numbers(), Ok(()));
    for (close, far, nowhere) in [(f64::NAN, 0.0, 0.0), (0.0, f64::INFINITY, 0.0), (0.0, 0.0, f64::NEG_INFINITY)] {
        let error = calibration("sofa", close, far, nowhere).check_numbers().unwrap_err();
        assert_eq!(error, "\"sofa\" has a number that is not finite");
    }
}

#[test]
fn fit_names_fits_each_name_and_distance_by_itself() {
    let (sofa, lamp) = (claim("Walk past the sofa."), claim("Walk past the lamp."));
    let (near, far) = (missed(ClaimCase::Thing, 5.0), missed(ClaimCase::Thing, 9.0));
    let one = |claim, missed, wrong| ClaimObservation { claim, missed, wrong, weight: 1.0 };
    // Without features the ratio is 1. Four wrong ones against a ridge of four: x = 4 / (4 (1 + e^x)).
    let observed = vec![one(&sofa, &near, true); 4];
    let fitted = Calibration::fit_names("matterport", "a.json", 7, &observed);
    assert_eq!((fitted.platform.as_str(), fitted.from.as_str(), fitted.texts), ("matterport", "a.json", 7));
    let root = fitted.names["sofa"].close;
    assert!((root - 1.0 / (1.0 + root.exp())).abs() < 2e-3, "{root}");
    assert_eq!((fitted.names["sofa"].far, fitted.names["sofa"].nowhere), (0.0, 0.0));
    let right = Calibration::fit_names("matterport", "a.json", 7, &vec![one(&lamp, &far, false); 4]);
    assert!((right.names["lamp"].far + root).abs() < 1e-9 && right.names["lamp"].close == 0.0, "{right:?}");
    // As many right as wrong leave it at the general weights, and a weight counts like so many claims.
    let even = Calibration::fit_names("", "", 0, &[one(&sofa, &near, true), one(&sofa, &near, false)]);
    assert_eq!(even.names["sofa"].close, 0.0);
    let heavy = ClaimObservation { weight: 4.0, ..one(&sofa, &near, true) };
    assert_eq!(Calibration::fit_names("", "", 0, &[heavy]).names["sofa"].close, root);
    let many = vec![one(&sofa, &near, true); 4000];
    assert_eq!(Calibration::fit_names("", "", 0, &many).names["sofa"].close, 3.0, "it is bounded");
}

/// The findings about landmarks: verdict and reason.
fn places(text: &str, evidence: &Evidence, reach: WorldReach<'_>) -> Vec<(Verdict, String)> {
    let style = any();
    let checked = check_text(text, CheckSubject::open_world(evidence, &style, reach));
    let of_places = checked.findings.into_iter().filter(|finding| finding.check == CheckKind::Landmarks);
    of_places.map(|finding| (finding.verdict, finding.reason)).collect()
}

#[test]
fn reasons_of_missing_places_name_the_nearest_one() {
    let (_, evidence, around) = path(0, 3);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let place = |text: &str| places(text, &evidence, reach).remove(0);
    let fail = |reason: &str| (Verdict::Fail, reason.to_owned());
    let open = |reason: &str| (Verdict::Unverified, reason.to_owned());
    let bathroom = "no \"bathroom\" is along the path: the nearest is 10.0 m off";
    assert_eq!(place("Walk through the bathroom."), fail(bathroom));
    assert_eq!(
        place("Walk past the cabinet."),
        open("the labels list no \"cabinet\" along the path, which says little")
    );
    assert_eq!(place("Walk past the xylorimba."), open("the program cannot check whether there is \"xylorimba\""));
    let stop = place("Stop in the garage.");
    assert!(stop.1.contains("where the path ends"), "{stop:?}");
    assert_eq!(place("Walk past the sofa."), (Verdict::Pass, String::new()));
}

#[test]
fn a_calibration_moves_a_claim_over_the_threshold() {
    let (_, evidence, around) = path(0, 3);
    let place = |calibration: &Calibration| {
        let reach = WorldReach { surroundings: Some(&around), calibration: Some(calibration) };
        places("Walk through the bathroom.", &evidence, reach).remove(0).0
    };
    assert_eq!(place(&calibration("sofa", 0.0, -3.0, 0.0)), Verdict::Fail);
    let name = |far: f64| place(&calibration("bathroom", 0.0, far, 0.0));
    assert_eq!((name(3.0), name(-3.0)), (Verdict::Fail, Verdict::Unverified));
}

#[test]
fn a_place_beyond_the_end_needs_no_label() {
    let (_, mut evidence, around) = path(0, 3);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    let text = "Stop at the chair next to the bathroom.";
    assert_ne!(places(text, &evidence, reach)[0].0, Verdict::Pass);
    evidence.beyond.rooms.push("bathroom".into());
    assert_eq!(places(text, &evidence, reach), [(Verdict::Pass, String::new())]);
}

#[test]
fn a_detector_denies_what_it_would_have_found() {
    let (_, mut evidence, _) = path(0, 3);
    evidence.source = EvidenceSource::Detector;
    evidence.frames[0].denied.push("toilet".into());
    let reach = WorldReach::default();
    let reason = "the detector finds no \"toilet\" along the path, and would have found one";
    assert_eq!(places("Walk past the toilet.", &evidence, reach), [(Verdict::Fail, reason.to_owned())]);
    assert_eq!(places("Walk past the stove.", &evidence, reach)[0].0, Verdict::Unverified);
    evidence.source = EvidenceSource::Captions;
    assert_eq!(places("Walk past the toilet.", &evidence, reach)[0].0, Verdict::Unverified);
    evidence.source = EvidenceSource::Detector;
    evidence.frames[1].things.push(SeenThing { name: "toilet".into(), ..SeenThing::default() });
    assert_eq!(places("Walk past the toilet.", &evidence, reach)[0].0, Verdict::Pass);
}

#[test]
fn a_colour_that_no_label_has_is_in_doubt() {
    let (_, mut evidence, _) = path(0, 3);
    let reach = WorldReach::default();
    let place = |evidence: &Evidence, text: &str| places(text, evidence, reach).remove(0);
    let mut colour = |colour: Option<&str>| {
        evidence.frames[1].things =
            vec![SeenThing { name: "sofa".into(), colour: colour.map(str::to_owned), ..SeenThing::default() }];
        evidence.clone()
    };
    let text = "Walk past the brown sofa.";
    let doubt = (Verdict::Unverified, "the program cannot check whether \"sofa\" is brown".to_owned());
    assert_eq!(place(&colour(Some("brown")), text).0, Verdict::Pass);
    assert_eq!(place(&colour(Some("dark brown")), text).0, Verdict::Pass);
    assert_eq!(place(&colour(Some("brown")), "Walk past the dark brown sofa.").0, Verdict::Pass);
    assert_eq!(place(&colour(Some("red")), text), doubt);
    assert_eq!(place(&colour(None), text), doubt);
    assert_eq!(place(&colour(None), "Walk past the sofa.").0, Verdict::Pass);
}

#[test]
fn an_open_world_without_evidence_is_unverified_even_if_no_place_is_named() {
    let (path, ..) = path(0, 3);
    let evidence = Evidence::for_path_alone(&path);
    let reason = "the program does not know what can be seen along the path";
    let found = places("Walk straight ahead.", &evidence, WorldReach::default());
    assert_eq!(found, [(Verdict::Unverified, reason.to_owned())]);
    assert_eq!(places("Walk past the sofa.", &evidence, WorldReach::default()).len(), 1);
}

#[test]
fn a_sentence_about_a_thing_that_is_there_changes_no_failure() {
    let (_, evidence, around) = path(0, 3);
    let reach = WorldReach { surroundings: Some(&around), calibration: None };
    for text in ["Walk through the bathroom.", "Walk past the sofa.", "Walk past the xylorimba."] {
        let more = format!("{text} Stop at the chair.");
        let alone = places(text, &evidence, reach)[0].0;
        assert_eq!(places(&more, &evidence, reach)[0].0, alone, "{more}");
    }
}
