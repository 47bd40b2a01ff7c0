//! Tests of reading training data as recordings.

use super::*;

fn write_picture(file: &Path) {
    std::fs::create_dir_all(file.parent().unwrap()).unwrap();
    image::RgbImage::from_pixel(8, 6, image::Rgb([9, 90, 200])).save(file).unwrap();
}

#[test]
fn streamvln_walks_have_a_pose_before_each_action() {
    let folder = tempfile::tempdir().unwrap();
    let item = r#"[{"id":0,"video":"images/flat_set_000000","instructions":["Go."],"actions":[-1,1,2]}]"#;
    std::fs::write(folder.path().join("annotations.json"), item).unwrap();
    let rgb = folder.path().join("images/flat_set_000000/rgb");
    (1..=2).for_each(|number| write_picture(&rgb.join(format!("{number:03}.jpg"))));
    let error = open_annotated(folder.path()).err().unwrap().to_string();
    assert!(error.contains("holds 2 pictures, and its walk has 3 actions"), "{error}");
    write_picture(&rgb.join("003.jpg"));
    let walks = open_annotated(folder.path()).unwrap().unwrap();
    let scene = walks.scenes().pop().unwrap();
    assert_eq!(scene.as_str(), "flat_set_000000");
    let recording = walks.open(&scene).unwrap();
    assert_eq!((recording.reel.times_s().len(), recording.reel.picture_name(2)), (3, "003.jpg".to_owned()));
    let last = recording.track.unwrap().fix_at(2.0).unwrap();
    assert!((last.position.y - 0.25).abs() < 1e-9 && last.heading.unwrap().rad() > 6.0);
    assert_eq!(walks.files(&scene).unwrap().len(), 4);
}

#[test]
fn navila_walks_without_all_actions_have_no_poses() {
    let folder = tempfile::tempdir().unwrap();
    let sample = |answer: &str| {
        format!(r#"[{{"video_id":"a-1","q":"Go.","a":"The next action is {answer}.","frames":["a/frame_0.jpg"]}}]"#)
    };
    let write = |text: String| std::fs::write(folder.path().join("annotations.json"), text).unwrap();
    write(sample("stop"));
    assert!(open_annotated(folder.path()).err().unwrap().to_string().contains("in none of the folders beside it"));
    write_picture(&folder.path().join("train/a/frame_0.jpg"));
    let is_known = || {
        let walks = open_annotated(folder.path()).unwrap().unwrap();
        walks.open(&walks.scenes()[0]).unwrap().track.is_some()
    };
    assert!(is_known());
    write(sample("dance"));
    assert!(!is_known());
    std::fs::write(folder.path().join("annotations.json"), r#"[{"notes": 1}]"#).unwrap();
    assert!(open_annotated(folder.path()).unwrap().is_none());
}
