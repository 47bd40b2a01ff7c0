use super::*;
use std::sync::Arc;
use wayword_core::{
    CameraStep, Caption, CaptionedView, DVec3, Frame, FrameObservation, Heading, ObjectSighting, PathMotion,
    PathRequest, Pose, View, ViewpointGraph, ViewpointId, WitnessAnswer,
};

/// A film without pictures, of which only the motion is known.
struct FilmAlone(CameraMotion);

impl Platform for FilmAlone {
    fn name(&self) -> &'static str {
        "recording"
    }

    fn list_scenes(&self) -> Result<Vec<SceneId>, PlatformError> {
        Ok(vec![scene()])
    }

    fn graph_for_scene(&self, _: &SceneId) -> Result<Arc<ViewpointGraph>, PlatformError> {
        Ok(Arc::default())
    }

    fn sample_path(&self, _: &SceneId, _: &PathRequest, _: u64) -> Result<Path, PlatformError> {
        Err(PlatformError::OnePlace { episode: String::new() })
    }

    fn film_motion(&self, _: &SceneId, source: MotionSource) -> Result<Option<CameraMotion>, PlatformError> {
        Ok((source == self.0.source).then(|| self.0.clone()))
    }

    fn look_from(&self, _: &SceneId, from: &Frame, gaze: ViewGaze) -> Result<View, PlatformError> {
        Ok(View::new(from.pose, gaze.horizontal_fov_rad, None, None))
    }
}

fn scene() -> SceneId {
    SceneId::new("nav_000003").unwrap()
}

fn id(at: usize) -> ViewpointId {
    ViewpointId::new(format!("frame-{at}")).unwrap()
}

/// A film of four pictures a second; each step is a turn in degrees and a length in metres. Every fourth picture is a frame.
fn film(source: MotionSource, steps: &[[f64; 2]]) -> CameraMotion {
    let step = |[turn, length]: &[f64; 2]| CameraStep {
        turn_rad: Some(turn.to_radians()),
        length_m: (source == MotionSource::Poses).then_some(*length),
        rise_m: None,
        is_still: *turn == 0.0 && *length == 0.0,
    };
    CameraMotion {
        source,
        pictures: (0..=steps.len()).map(|at| 2 * at).collect(),
        times_s: (0..=steps.len()).map(|at| at as f64 / 4.0).collect(),
        steps: steps.iter().map(step).collect(),
        frames: (0..=steps.len()).step_by(4).map(|at| (id(at), at)).collect(),
    }
}

fn corner(source: MotionSource) -> CameraMotion {
    let steps = [vec![[0.0, 0.25]; 8], vec![[-15.0, 0.0]; 6], vec![[0.0, 0.25]; 10]];
    film(source, &steps.concat())
}

fn annotate(platform: &dyn Platform) -> EpisodeAnnotation {
    let job = crate::settings::AskedSettings::default().into_job().unwrap();
    let team = RoleTeam::new(&job.settings, None, platform).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let subtask = crate::styles::find_styles(&["r2r".to_owned()]).unwrap().remove(0);
    let annotator = EpisodeAnnotator {
        platform,
        settings: &job.settings,
        team: &team,
        styles: &[],
        subtask: &subtask,
        scenes: &KnownScenes::new(),
        keep: KeptTexts::Passed,
        sees: false,
        pictures: folder.path(),
        threads: 1,
    };
    let episode = DatasetEpisode { number: 3, scene: scene(), tasks: vec!["drive".to_owned()] };
    annotator.annotate(&episode).unwrap()
}

fn told(annotation: &EpisodeAnnotation) -> Vec<(usize, &str)> {
    annotation.parts.iter().map(|part| (part.from, part.text.as_str())).collect()
}

#[test]
fn without_an_eye_the_motion_alone_is_told_by_poses_or_by_pictures() {
    for source in [MotionSource::Poses, MotionSource::Pictures] {
        let annotation = annotate(&FilmAlone(corner(source)));
        // The eighth of the pictures that the motion was told by is the sixteenth of the film.
        assert_eq!(told(&annotation), [(0, "Go straight ahead."), (16, "Turn left, then stop.")], "{source:?}");
        assert!(annotation.parts.iter().all(|part| part.by == "motion"));
        assert_eq!(annotation.motion, if source == MotionSource::Poses { "poses" } else { "pictures" });
    }
}

#[test]
fn before_a_camera_that_stands_still_the_task_of_the_dataset_is_the_only_part() {
    let annotation = annotate(&FilmAlone(film(MotionSource::Pictures, &[[0.0, 0.0]; 20])));
    assert_eq!(told(&annotation), [(0, "drive")]);
    assert!(annotation.dropped[0].why.contains("stands still"));
}

/// A walk around a corner, with a caption at each frame: its room and the things ahead.
fn seen_walk(film: &CameraMotion, captions: &[(&str, &[&str])]) -> ObservedWalk {
    let mut frames = Vec::new();
    let mut observations = Vec::new();
    for ((viewpoint, at), (room, things)) in film.frames.iter().zip(captions) {
        let pose = Pose::looking_level(DVec3::new(*at as f64, 0.0, 0.0), Heading::NORTH);
        frames.push(Frame { pose, viewpoint: Some(viewpoint.clone()), level: None });
        let sighting = |name: &&str| ObjectSighting {
            place: Some(ViewThird::Middle),
            ..ObjectSighting::new(*name, WitnessAnswer::Seen, "server/eye")
        };
        let caption = Caption {
            room: Some((*room).to_owned()),
            sightings: things.iter().map(sighting).collect(),
            is_structured: true,
            ..Caption::default()
        };
        let looks = vec![CaptionedView { gaze: ViewGaze::quarter_view(Heading::NORTH), caption }];
        observations.push(FrameObservation { looks, summary: String::new(), by: None });
    }
    let path = Path { id: "walk".into(), scene: scene(), frames, motion: PathMotion::Unknown, target: None };
    ObservedWalk::new(path, observations)
}

/// Names sort as texts, so ten frames and fewer keep their order.
fn short_film() -> CameraMotion {
    film(MotionSource::Pictures, &[[0.0, 0.25]; 9])
}

#[test]
fn a_room_that_one_frame_alone_names_is_none() {
    let film = short_film();
    let walk = seen_walk(&film, &[("hallway", &[]), ("garage", &[]), ("hallway", &[])]);
    assert!(SeenFilm::new(&walk, &film).room_changes().is_empty());
    let named = ["hallway", "hallway", "kitchen", "kitchen"].map(|room| Some(room.to_owned()));
    assert_eq!(without_lone_rooms(&named), named);
}

#[test]
fn a_text_is_kept_only_if_its_claims_fit_its_own_part() {
    let film = short_film();
    let things: [(&str, &[&str]); 3] = [("kitchen", &["sink"]), ("kitchen", &["sink"]), ("kitchen", &["oven"])];
    let walk = seen_walk(&film, &things);
    let seen = SeenFilm::new(&walk, &film);
    let part = cut_film(&film, &[]).remove(0);
    let state = |text: &str| judge_text(text, &seen.film_of(&part)).0;
    assert_eq!(state("Walk to the sink."), PairPartState::Fits);
    assert_eq!(state("Turn left at the sink."), PairPartState::Wrong);
    assert_eq!(state("Walk to the piano."), PairPartState::Wrong);
    // Eyes name rooms and things, and leave walls out.
    assert_eq!(state("Walk along the wall."), PairPartState::Unverified);
    // The sink is seen twice and the oven once.
    assert_eq!((seen.goal_at(0).as_deref(), seen.goal_at(2)), (Some("sink"), None));
}
