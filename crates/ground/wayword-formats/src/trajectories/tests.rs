//! Tests of writing and reading trajectories with their pictures.

use super::*;
use proptest::prelude::*;

fn trajectory(id: &str, pictures: PictureLocation) -> ActionTrajectory {
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
        off_m: 0.125,
        pictures,
        sha256: PictureDigest::from_pictures(&views(id)),
        instructions: vec![told],
    }
}

fn views(id: &str) -> Vec<Vec<u8>> {
    (0..3).map(|number| format!("picture {number} of {id}").into_bytes()).collect()
}

fn folder_of(id: &str) -> ActionTrajectory {
    trajectory(id, PictureLocation::Folder(format!("images/{id}")))
}

#[test]
fn trajectories_come_back_with_their_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let apart = folder_of("a");
    let key = "000001".to_owned();
    let packed = trajectory("b", PictureLocation::Sample { shard: "shards/000000.tar".to_owned(), key: key.clone() });
    let images = folder.path().join("images/a");
    std::fs::create_dir_all(&images).unwrap();
    std::fs::create_dir_all(folder.path().join("shards")).unwrap();
    for (number, picture) in views("a").iter().enumerate() {
        std::fs::write(images.join(picture_name(number)), picture).unwrap();
    }
    let mut shard = ShardWriter::begin(&folder.path().join("shards/000000.tar")).unwrap();
    shard.add_walk("000000", &trajectory("other", packed.pictures.clone()), &views("other")).unwrap();
    shard.add_walk(&key, &packed, &views("b")).unwrap();
    shard.finish().unwrap();
    // As WebDataset finds them: the files of a sample together, named before the first point by its key.
    let mut tar = tar::Archive::new(std::fs::File::open(folder.path().join("shards/000000.tar")).unwrap());
    let names = tar.entries().unwrap().map(|entry| entry.unwrap().path().unwrap().display().to_string());
    let expected = ["json", "0000.jpg", "0001.jpg", "0002.jpg"];
    let expected = ["000000", "000001"].iter().flat_map(|key| expected.map(|name| format!("{key}.{name}")));
    assert_eq!(names.collect::<Vec<_>>(), expected.collect::<Vec<_>>());
    let file = folder.path().join("trajectories.jsonl");
    write_trajectories(&file, &[apart.clone(), packed.clone()]).unwrap();
    let found = read_trajectories(&file).unwrap();
    assert_eq!(found, [apart, packed]);
    for (trajectory, id) in found.iter().zip(["a", "b"]) {
        assert_eq!(read_pictures(folder.path(), trajectory).unwrap(), views(id));
    }
    std::fs::write(images.join("0001.jpg"), "another picture").unwrap();
    let error = read_pictures(folder.path(), &found[0]).unwrap_err().to_string();
    assert!(error.contains("the pictures of walk a are not those that were written"), "{error}");
    std::fs::remove_file(images.join("0001.jpg")).unwrap();
    assert!(read_pictures(folder.path(), &found[0]).unwrap_err().to_string().contains("0001.jpg"));
}

#[test]
fn a_shard_is_the_same_bytes_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = |name: &str| {
        let file = folder.path().join(name);
        let mut shard = ShardWriter::begin(&file).unwrap();
        shard.add_walk("000000", &folder_of("a"), &views("a")).unwrap();
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
        ("/format", json!("wayword-trajectory/9"), "field \"format\": expected \"wayword-trajectory/1\""),
        ("/trajectory_id", json!("../a"), "field \"trajectory_id\""),
        ("/actions/0", json!(7), "field \"actions[0]\": 7 is no action"),
        ("/actions/0", json!(0), "field \"actions[0]\": it stops before the end"),
        ("/actions/2", json!(1), "field \"actions\": it does not end with a stop"),
        ("/positions", json!([[0, 0, 0]]), "field \"positions\": expected 3 entries"),
        ("/positions/1", json!([0, 0]), "field \"positions[1]\""),
        ("/rotations/2", json!([0, 0, 0, 9]), "field \"rotations[2]\": it gives no heading"),
        ("/frame_steps", json!([2, 0]), "field \"frame_steps\""),
        ("/frame_steps", json!([0, 3]), "field \"frame_steps\""),
        ("/pictures", json!({"folder": "../images"}), "field \"pictures\": it leads out of the folder"),
        ("/pictures", json!({"folder": "/tmp"}), "field \"pictures\": it leads out of the folder"),
        ("/pictures", json!({"sample": {"shard": "a.tar", "key": "x/y"}}), "field \"pictures.sample.key\""),
        ("/sha256", json!("abc"), "field \"sha256\""),
        ("/instructions", json!([]), "field \"instructions\": it is empty"),
        (
            "/instructions/0/sub_instructions/1/span",
            json!([14, 99]),
            "field \"instructions[0].sub_instructions[1].span\"",
        ),
        ("/instructions/0/sub_instructions/1/frames", json!([1, 2]), "sub_instructions[1].frames\""),
        ("/instructions/0/sub_instructions/0/steps", json!([0, 1]), "sub_instructions[0].steps\""),
        ("/off_m", json!("near"), "field \"off_m\""),
    ] {
        let mut second = trajectory_line(&folder_of("b"));
        *second.pointer_mut(field).unwrap() = value;
        std::fs::write(&file, format!("{}\n{second}\n", trajectory_line(&folder_of("a")))).unwrap();
        let error = read_trajectories(&file).unwrap_err().to_string();
        assert!(error.contains("trajectories.jsonl: line 2") && error.contains(told), "{field}: {error}");
    }
    std::fs::write(&file, format!("{0}\n{0}\n", trajectory_line(&folder_of("a")))).unwrap();
    assert!(read_trajectories(&file).unwrap_err().to_string().contains("was given to an earlier line"));
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
            frame_steps: vec![0, 0],
            instructions: vec![TrajectoryInstruction { episode_id: "a".into(), style: "r2r".into(), text: "Stop.".into(), sub_instructions: Vec::new() }],
            ..folder_of("a")
        };
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("trajectories.jsonl");
        write_trajectories(&file, std::slice::from_ref(&written)).unwrap();
        prop_assert_eq!(read_trajectories(&file).unwrap(), vec![written]);
    }
}
