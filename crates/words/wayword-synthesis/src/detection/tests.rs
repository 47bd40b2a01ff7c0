use super::*;
use std::sync::Arc;
use wayword_checks::{CheckSubject, Evidence, EvidenceSource, check_text, detection::DetectorRates};
use wayword_core::{
    CheckKind, DVec3, DepthImage, DetectedBox, DetectionSpot, DetectorScoring, DialogueExchange, Frame, Ground, Image,
    InstructionStyle, ModelError, PathMotion, PathRequest, PlatformError, SceneId, Verdict, ViewThird, ViewpointGraph,
    path::PathStop,
};

/// A platform with three frames straight ahead, with a picture each.
struct Corridor;

impl Platform for Corridor {
    fn name(&self) -> &'static str {
        "corridor"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        Ok(Vec::new())
    }

    fn graph_for_scene(&self, _: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        panic!("these tests need no graph")
    }

    fn sample_path(&self, _: &SceneId, _: &PathRequest, _: u64) -> Result<Path, PlatformError> {
        panic!("these tests need no random path")
    }

    fn look_from(&self, _: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        let picture = Image::new(90, 60, vec![0; 90 * 60 * 3]).ok().map(Arc::new);
        Ok(View::new(from.pose, gaze.horizontal_fov_rad, picture, None))
    }

    fn ground(&self) -> &dyn Ground {
        self
    }
}

impl Ground for Corridor {
    /// A thing 3 m ahead on the right, before a wall at 6 m; the last frame has no depth.
    fn view_depth(&self, _: &SceneId, from: &Frame, _: ViewGaze) -> Result<Option<DepthImage>, PlatformError> {
        let metres = (0..90 * 60).map(|at| if at % 90 >= 70 { 3.0 } else { 6.0 }).collect();
        Ok((from.pose.position.y < 3.0).then(|| DepthImage::new(90, 60, metres).unwrap()))
    }
}

/// A detector that finds each name at the given frames, on the right of the picture.
struct Finds(Vec<(&'static str, Vec<usize>)>);

impl ObjectDetector for Finds {
    fn name(&self) -> &str {
        "test/detector"
    }

    fn scoring(&self) -> DetectorScoring {
        DetectorScoring { means: "given", find_threshold: 0.5, phrases_interact: false }
    }

    fn detect_phrases(&self, views: &[&View], phrases: &[&str]) -> Vec<Result<Vec<Vec<DetectedBox>>, ModelError>> {
        let found = |view: &View, phrase: &str| {
            let frame = (view.pose.position.y / 2.0).round() as usize;
            let hit = self.0.iter().any(|(name, frames)| *name == phrase && frames.contains(&frame));
            let best = DetectedBox { box_px: [70.0, 20.0, 90.0, 40.0], score: 0.9 };
            let again = DetectedBox { box_px: [71.0, 20.0, 90.0, 40.0], score: 0.6 };
            let unsure = DetectedBox { box_px: [0.0, 20.0, 10.0, 40.0], score: 0.4 };
            if hit { vec![best, again, unsure] } else { vec![unsure] }
        };
        let of_view = |view: &&View| Ok(phrases.iter().map(|phrase| found(view, phrase)).collect());
        views.iter().map(of_view).collect()
    }
}

fn path() -> Path {
    let stop = |at: usize| PathStop { position: DVec3::new(0.0, 2.0 * at as f64, 1.5), viewpoint: None, level: None };
    let frames = Path::frames_along((0..3).map(stop).collect(), None);
    Path { id: "p".into(), scene: SceneId::new("s").unwrap(), frames, motion: PathMotion::Known, target: None }
}

/// Figures of a detector that finds a real thing with probability 0.95, mostly from two or three frames.
fn figures() -> DetectorFigures {
    let all = DetectorRates {
        shown: 2000,
        found: 1900,
        absent: 2000,
        alarms: 40,
        missed_before: 100,
        missed_again: 5,
        runs: vec![0, 50, 50],
    };
    DetectorFigures { found_from: 0.5, all, ..DetectorFigures::default() }
}

/// The captions of the frames after a detector looked; `captions` has the names that each frame's caption saw.
fn after(captions: [&[&str]; 3], finds: Vec<(&'static str, Vec<usize>)>, nouns: &[&str]) -> Vec<FrameObservation> {
    let path = path();
    let observed = |(frame, names): (&Frame, &[&str])| {
        let sightings = names.iter().map(|name| ObjectSighting::new(*name, WitnessAnswer::Seen, "eye")).collect();
        let transcript = vec![DialogueExchange::new("what is there?", "all that")];
        let caption = Caption { text: names.join(", "), sightings, transcript, ..Caption::default() };
        FrameObservation {
            looks: vec![CaptionedView { gaze: ViewGaze::quarter_view(frame.pose.heading), caption }],
            ..FrameObservation::default()
        }
    };
    let mut observations: Vec<FrameObservation> = path.frames.iter().zip(captions).map(observed).collect();
    let nouns: Vec<String> = nouns.iter().map(|noun| (*noun).to_owned()).collect();
    let seeker = CaptionDetector { detector: &Finds(finds), figures: &figures(), nouns: &nouns };
    seek_along_path(&Corridor, &path, &mut observations, seeker).unwrap();
    observations
}

fn of_frame<'a>(seen: &'a [FrameObservation], at: usize, name: &str) -> Option<&'a ObjectSighting> {
    seen[at].looks[0].caption.sightings.iter().find(|sighting| sighting.name == name)
}

#[test]
fn seek_marks_finds_as_seen_with_box_and_side() {
    let seen = after([&["sofa"], &["sofa"], &[]], vec![("sofa", vec![0, 1])], &[]);
    let sofa = of_frame(&seen, 0, "sofa").unwrap();
    assert_eq!((sofa.witness, sofa.place, sofa.by.as_str()), (WitnessAnswer::Seen, Some(ViewThird::Right), "eye"));
    let spot = sofa.spot.unwrap();
    assert_eq!(spot.found.score, 0.9);
    assert!(
        (spot.off_rad - (35.0_f64 / 45.0).atan()).abs() < 1e-6,
        "the middle of the box is 35 px right of the picture's"
    );
}

#[test]
fn seek_takes_distances_from_depth_where_it_is_known() {
    let seen = after([&["sofa"], &["sofa"], &["sofa"]], vec![("sofa", vec![0, 1, 2])], &[]);
    let far_m = |at| of_frame(&seen, at, "sofa").unwrap().spot.unwrap().distance_m;
    let [first, second, third] = [0, 1, 2].map(far_m);
    let metres = first.unwrap();
    // The box reaches from 25 px to 45 px right of the middle, and the nearer quarter of its middle counts.
    assert!((3.0 * f64::hypot(1.0, 30.0 / 45.0)..3.0 * f64::hypot(1.0, 40.0 / 45.0)).contains(&metres), "{metres}");
    assert_eq!((second, third), (first, None));
    assert!(!of_frame(&seen, 0, "sofa").unwrap().is_far);
    let evidence = Evidence::from_detector(&path(), &detector_evidence(&seen, "test/detector")).unwrap();
    assert_eq!([0, 2].map(|at| evidence.frames[at].things[0].distance_m), [first, None]);
}

#[test]
fn of_several_finds_the_nearest_counts_and_a_door_has_no_distance() {
    let spot =
        |score, distance_m| DetectionSpot { found: DetectedBox { box_px: [0.0; 4], score }, off_rad: 0.0, distance_m };
    let spots = [spot(0.9, Some(6.0)), spot(0.6, Some(2.0))];
    assert_eq!(corrections::nearest_spot(&spots, "chair"), spots[1]);
    assert_eq!(corrections::nearest_spot(&spots, "door"), spot(0.9, None), "it would be that of the room behind");
    let unknown = [spot(0.9, None), spot(0.6, None)];
    assert_eq!(corrections::nearest_spot(&unknown, "chair"), unknown[0]);
}

#[test]
fn records_without_distances_are_read() {
    let old = r#"{"found":{"box_px":[1.0,2.0,3.0,4.0],"score":0.5},"off_rad":0.25}"#;
    let spot: DetectionSpot = serde_json::from_str(old).unwrap();
    assert_eq!((spot.off_rad, spot.distance_m), (0.25, None));
    assert_eq!(serde_json::to_string(&spot).unwrap(), old);
}

#[test]
fn seek_removes_denied_things_from_the_words() {
    let seen = after([&["sofa"], &["sofa", "piano"], &[]], vec![("sofa", vec![0, 1])], &[]);
    let piano = of_frame(&seen, 1, "piano").unwrap();
    assert_eq!((piano.witness, piano.by.as_str()), (WitnessAnswer::Denied, "test/detector"));
    let caption = &seen[1].looks[0].caption;
    assert!(caption.text.contains("sofa") && !caption.text.contains("sofa, piano"), "{}", caption.text);
    assert_eq!(caption.by.as_deref(), Some("rules"));
    assert!(of_frame(&seen, 0, "piano").is_none(), "nobody named it there");
}

#[test]
fn seek_leaves_words_of_unchanged_captions() {
    let seen = after([&["ghost story"], &[], &[]], vec![], &[]);
    assert_eq!(seen[0].looks[0].caption.text, "ghost story", "a name that the lexicon does not have is not looked for");
}

#[test]
fn seek_adds_proposals_only_if_found_often_enough() {
    let seen = after([&[], &[], &[]], vec![("bed", vec![0, 1, 2]), ("vase", vec![1])], &["bed", "vase", "sink"]);
    for at in 0..3 {
        let bed = of_frame(&seen, at, "bed").unwrap();
        assert_eq!((bed.witness, bed.by.as_str(), bed.several), (WitnessAnswer::Seen, "test/detector", false));
    }
    assert!((0..3).all(|at| of_frame(&seen, at, "vase").is_none() && of_frame(&seen, at, "sink").is_none()));
}

#[test]
fn claims_without_captions_pass_fail_or_stay_open() {
    let path = path();
    let claims = ["sofa", "piano", "lamp"].map(str::to_owned).into();
    let mut figures = figures();
    figures.names.insert("lamp".into(), DetectorRates { found: 600, missed_again: 70, ..figures.all.clone() });
    let seeker = CaptionDetector { detector: &Finds(vec![("sofa", vec![0, 1])]), figures: &figures, nouns: &[] };
    let seen = seek_claims(&Corridor, &path, &claims, seeker).unwrap();
    let evidence = Evidence::from_detector(&path, &seen).unwrap();
    assert_eq!(evidence.source, EvidenceSource::Detector);
    let style = InstructionStyle { name: "s".into(), ..InstructionStyle::default() };
    for (text, wanted) in [
        ("Walk past the sofa.", Verdict::Pass),
        ("Walk past the piano.", Verdict::Fail),
        ("Walk past the lamp.", Verdict::Unverified),
        ("Walk past the clock.", Verdict::Unverified),
    ] {
        let checked = check_text(text, CheckSubject::closed_world(&evidence, &style, None));
        let places = checked.findings.iter().filter(|finding| finding.check == CheckKind::Landmarks);
        assert_eq!(places.map(|finding| finding.verdict).max(), Some(wanted), "{text}");
    }
}

#[test]
fn seek_claims_looks_all_around_only_with_known_motion() {
    let claims = ["sofa".to_owned()].into();
    let (finds, figures) = (Finds(Vec::new()), figures());
    for (motion, directions) in [(PathMotion::Known, 4), (PathMotion::Unknown, 1)] {
        let path = Path { motion, ..path() };
        let seeker = CaptionDetector { detector: &finds, figures: &figures, nouns: &[] };
        let seen = seek_claims(&Corridor, &path, &claims, seeker).unwrap();
        let looks: Vec<usize> = seen.iter().map(|seen| seen.looks.len()).collect();
        assert_eq!(looks, [directions; 3]);
        assert_eq!(seen[0].looks[0].gaze, ViewGaze::quarter_view(path.frames[0].pose.heading), "ahead comes first");
    }
}
