//! Tests of writing and reading trajectories with their pictures.

use super::*;
use proptest::prelude::*;

fn trajectory(id: &str) -> ActionTrajectory {
    let text = "Turn left and walk to the sofa.".to_owned();
    let part = |span: [usize; 2], frames, steps| SubInstruction {
        text: text[span[0]..span[1]].to_owned(),
        span,
        frames,
        steps,
    };
    let sub_instructions = vec![part([0, 9], [0, 1], [0, 2]), part([14, 30], [1, 1], [2, 2])];
    let told = TrajectoryInstruction {
        episode_id: id.to_owned(),
        style: "r2r".to_owned(),
        text: text.clone(),
        sub_instructions,
        joined_parts: 1,
    };
    ActionTrajectory {
        id: id.to_owned(),
        platform: "house".to_owned(),
        scene: SceneId::new("house2-1").unwrap(),
        split: "train".to_owned(),
        actions: vec![AgentAction::Left, AgentAction::Forward, AgentAction::Stop],
        positions: [0.0, 0.0, 0.25].map(|y| DVec3::new(1.5, y, 0.0)).to_vec(),
        headings: vec![Heading::NORTH; 3],
        frame_steps: vec![0, 2],
        above_floor_m: vec![Some(0.125), None, Some(0.25)],
        off_m: 0.125,
        path_sha256: "0123".to_owned(),
        instructions: vec![told],
    }
}

fn views(id: &str) -> Vec<Vec<u8>> {
    (0..3).map(|number| format!("picture {number} of {id}").into_bytes()).collect()
}

fn set(place: PictureLocation, id: &str) -> PictureSet {
    PictureSet { place, sha256: PictureDigest::from_pictures(&views(id)) }
}

fn camera_walk(id: &str) -> CameraWalk {
    let place = |kind| PictureLocation::Folder(format!("cameras/125cm_0deg/{kind}/{id}"));
    CameraWalk {
        trajectory_id: id.to_owned(),
        world_from_camera: vec![
            wayword_core::DMat4::from_rotation_y(0.5),
            wayword_core::DMat4::IDENTITY,
            wayword_core::DMat4::IDENTITY,
        ],
        rgb: set(place("rgb"), id),
        depth: set(place("depth"), id),
        pixel_goals: vec![Some(PixelGoal { pixel: [7, 9], step: 2 }), None, None],
    }
}

#[test]
fn trajectories_come_back_and_are_written_with_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trajectories.jsonl");
    write_trajectories(&file, &[trajectory("a"), trajectory("b")]).unwrap();
    let (text, found) = (std::fs::read_to_string(&file).unwrap(), read_trajectories(&file).unwrap());
    assert_eq!(found, [trajectory("a"), trajectory("b")]);
    write_trajectories(&file, &found).unwrap();
    assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    assert_eq!(found[0].floor_position(0).unwrap().z, -0.125);
    let pictures = folder.path().join("pictures.jsonl");
    let line = camera_walk_line(&camera_walk("a")).to_string();
    std::fs::write(&pictures, format!("{line}\n")).unwrap();
    let seen = read_camera_walks(&pictures).unwrap();
    assert_eq!(camera_walk_line(&seen[0]).to_string(), line);
    assert_eq!((&seen[0].rgb, &seen[0].pixel_goals), (&camera_walk("a").rgb, &camera_walk("a").pixel_goals));
}

#[test]
fn pictures_are_read_from_folders_and_shards_and_compared_with_their_hash() {
    let folder = tempfile::tempdir().unwrap();
    let shard_place = "cameras/125cm_0deg/shards/000000.tar";
    let shard_file = folder.path().join(shard_place);
    std::fs::create_dir_all(shard_file.parent().unwrap()).unwrap();
    let images = folder.path().join("cameras/125cm_0deg/rgb/a");
    std::fs::create_dir_all(&images).unwrap();
    for (number, picture) in views("a").iter().enumerate() {
        std::fs::write(images.join(PictureKind::Rgb.file_name(number)), picture).unwrap();
    }
    let mut shard = ShardWriter::begin(&shard_file).unwrap();
    for (key, id) in [("000000", "other"), ("000001", "b")] {
        let (rgb, depth) = (views(id), views("depth"));
        shard.add_walk(key, &trajectory(id), &[(PictureKind::Rgb, &rgb), (PictureKind::Depth, &depth)]).unwrap();
    }
    shard.finish().unwrap();
    // As WebDataset finds them: the files of a sample together, named before the first point by its key.
    let mut tar = tar::Archive::new(std::fs::File::open(&shard_file).unwrap());
    let names = tar.entries().unwrap().map(|entry| entry.unwrap().path().unwrap().display().to_string());
    let kinds = [("rgb", "jpg"), ("depth", "png")];
    let files = |key: &str| {
        let pictures = kinds
            .iter()
            .flat_map(move |(kind, ending)| (0..3).map(move |number| format!("{kind}.{number:04}.{ending}")));
        std::iter::once("json".to_owned()).chain(pictures).map(|name| format!("{key}.{name}")).collect::<Vec<_>>()
    };
    assert_eq!(names.collect::<Vec<_>>(), [files("000000"), files("000001")].concat());
    let sample = PictureLocation::Sample { shard: shard_place.to_owned(), key: "000001".to_owned() };
    let read = |set: &PictureSet, kind| read_pictures(folder.path(), set, kind, 3);
    assert_eq!(read(&set(sample.clone(), "b"), PictureKind::Rgb).unwrap(), views("b"));
    assert_eq!(read(&set(sample, "depth"), PictureKind::Depth).unwrap(), views("depth"));
    let apart = camera_walk("a").rgb;
    assert_eq!(read(&apart, PictureKind::Rgb).unwrap(), views("a"));
    std::fs::write(images.join("0001.jpg"), "another picture").unwrap();
    let error = read(&apart, PictureKind::Rgb).unwrap_err().to_string();
    assert!(error.contains("these pictures are not those that were written"), "{error}");
    std::fs::remove_file(images.join("0001.jpg")).unwrap();
    assert!(read(&apart, PictureKind::Rgb).unwrap_err().to_string().contains("0001.jpg"));
}

#[test]
fn a_shard_is_the_same_bytes_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |name: &str| {
        let file = folder.path().join(name);
        let mut shard = ShardWriter::begin(&file).unwrap();
        shard.add_walk("000000", &trajectory("a"), &[(PictureKind::Rgb, &views("a"))]).unwrap();
        shard.finish().unwrap();
        std::fs::read(file).unwrap()
    };
    assert_eq!(bytes("one.tar"), bytes("two.tar"));
}

#[test]
fn read_refuses_broken_rules_with_line_and_field() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trajectories.jsonl");
    for (field, value, told) in [
        ("/format", json!("wayword-trajectory/9"), "field \"format\": expected \"wayword-trajectory/2\""),
        ("/trajectory_id", json!("../a"), "field \"trajectory_id\""),
        ("/actions/0", json!(7), "field \"actions[0]\": 7 is no action"),
        ("/actions/0", json!(0), "field \"actions[0]\": it stops before the end"),
        ("/actions/2", json!(1), "field \"actions\": it does not end with a stop"),
        ("/positions", json!([[0, 0, 0]]), "field \"positions\": expected 3 entries"),
        ("/positions/1", json!([0, 0]), "field \"positions[1]\""),
        ("/rotations/2", json!([0, 0, 0, 9]), "field \"rotations[2]\": it gives no heading"),
        ("/frame_steps", json!([2, 0]), "field \"frame_steps\""),
        ("/frame_steps", json!([0, 3]), "field \"frame_steps\""),
        ("/above_floor_m", json!([0.1]), "field \"above_floor_m\": expected 3 entries"),
        ("/path_sha256", json!("a/b"), "field \"path_sha256\""),
        ("/instructions", json!([]), "field \"instructions\": it is empty"),
        (
            "/instructions/0/sub_instructions/1/span",
            json!([14, 99]),
            "field \"instructions[0].sub_instructions[1].span\"",
        ),
        ("/instructions/0/sub_instructions/1/frames", json!([1, 2]), "sub_instructions[1].frames\""),
        ("/instructions/0/sub_instructions/0/steps", json!([0, 1]), "sub_instructions[0].steps\""),
        ("/instructions/0/sub_instructions/0/frames", json!([1, 1]), "sub_instructions[0].steps\""),
        ("/off_m", json!("near"), "field \"off_m\""),
    ] {
        let mut second = trajectory_line(&trajectory("b"));
        *second.pointer_mut(field).unwrap() = value;
        std::fs::write(&file, format!("{}\n{second}\n", trajectory_line(&trajectory("a")))).unwrap();
        let error = read_trajectories(&file).unwrap_err().to_string();
        assert!(error.contains("trajectories.jsonl: line 2") && error.contains(told), "{field}: {error}");
    }
    std::fs::write(&file, format!("{0}\n{0}\n", trajectory_line(&trajectory("a")))).unwrap();
    assert!(read_trajectories(&file).unwrap_err().to_string().contains("was given to an earlier line"));
}

#[test]
fn what_a_camera_saw_is_refused_with_line_and_field() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("pictures.jsonl");
    for (field, value, told) in [
        ("/rgb/place", json!({"folder": "../images"}), "field \"rgb.place\": it leads out of the folder"),
        ("/rgb/place", json!({"folder": "/tmp"}), "field \"rgb.place\": it leads out of the folder"),
        ("/depth/place", json!({"sample": {"shard": "a.tar", "key": "x/y"}}), "field \"depth.place.sample.key\""),
        ("/rgb/sha256", json!("abc"), "field \"rgb.sha256\""),
        ("/pixel_goals", json!([null]), "field \"pixel_goals\": expected 3 entries"),
        ("/pixel_goals/0/1", json!(3), "field \"pixel_goals[0]\": it is no later action of the walk"),
        ("/world_from_camera/0", json!([1]), "field \"world_from_camera"),
    ] {
        let mut line = camera_walk_line(&camera_walk("a"));
        *line.pointer_mut(field).unwrap() = value;
        std::fs::write(&file, format!("{line}\n")).unwrap();
        let error = read_camera_walks(&file).unwrap_err().to_string();
        assert!(error.contains("pictures.jsonl: line 1") && error.contains(told), "{field}: {error}");
    }
}

proptest! {
    #[test]
    fn poses_are_read_as_they_were_written(x in -50.0..50.0f64, y in -50.0..50.0f64, z in -5.0..5.0f64, rad in 0.0..std::f64::consts::TAU) {
        let (position, heading) = round_pose(DVec3::new(x, y, z), Heading::new(rad).unwrap());
        prop_assert!(position.distance(DVec3::new(x, y, z)) < 1e-5);
        let written = ActionTrajectory {
            actions: vec![AgentAction::Stop],
            positions: vec![position],
            headings: vec![heading],
            above_floor_m: vec![None],
            frame_steps: vec![0, 0],
            instructions: vec![TrajectoryInstruction { episode_id: "a".into(), style: "r2r".into(), text: "Stop.".into(), sub_instructions: Vec::new(), joined_parts: 0 }],
            ..trajectory("a")
        };
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("trajectories.jsonl");
        write_trajectories(&file, std::slice::from_ref(&written)).unwrap();
        prop_assert_eq!(read_trajectories(&file).unwrap(), vec![written]);
    }
}
