//! `wayword view` from end to end: panoramas, paths as pictures, GIFs and films, and maps, each read back.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use crate::common::{Building, EPISODES, files};
use image::{AnimationDecoder, ImageReader, RgbImage, codecs::gif::GifDecoder};
use serde_json::Value;
use std::{collections::BTreeSet, fs, io::Cursor, path::Path, time::Duration};
use wayword_core::Platform;
use wayword_house::HousePlatform;

/// A house with two storeys.
const TALL: &str = "house2-3";

fn view(building: &Building, args: &[&str]) -> Value {
    let ran = building.wayword(&[&["view"], args, &["--json"]].concat());
    assert_eq!(ran.code, Some(0), "{ran:?}");
    ran.json()
}

fn refused(building: &Building, args: &[&str]) -> String {
    building.wayword(&[&["view"], args].concat()).refused().to_owned()
}

fn picture(path: &Path) -> RgbImage {
    ImageReader::open(path).unwrap().with_guessed_format().unwrap().decode().unwrap().into_rgb8()
}

fn size(written: &Value) -> (u32, u32) {
    (written["width"].as_u64().unwrap() as u32, written["height"].as_u64().unwrap() as u32)
}

#[test]
fn a_panorama_goes_all_around_without_a_seam() {
    let building = Building::new();
    let around = |degrees: &str, out: &str| {
        let args = ["panorama", "--scan", TALL, "--heading-deg", degrees, "--width", "2000", "--out", out];
        let written = view(&building, &args);
        let picture = picture(&building.path(out));
        assert_eq!(picture.dimensions(), size(&written));
        picture
    };
    let (north, east) = (around("0", "north.png"), around("90", "east.png"));
    // The height: 0.75 of a view's width, times the square root of 1/2, because that is what remains at the seams.
    assert_eq!(north.dimensions(), (2000, (2000.0 * 0.75 * 0.5f64.sqrt() / std::f64::consts::PI) as u32));
    for (x, y, pixel) in east.enumerate_pixels() {
        let same = north.get_pixel((x + 500) % 2000, y);
        let off = pixel.0.iter().zip(same.0).map(|(a, b)| a.abs_diff(b)).max().unwrap();
        assert!(off <= 1, "{x}, {y}");
    }
    let natural = view(&building, &["panorama", "--scan", TALL, "--seed", "4", "--out", "start.jpg"]);
    assert_eq!(size(&natural), (2011, 339));
    assert_eq!(picture(&building.path("start.jpg")).dimensions(), (2011, 339));
}

#[test]
fn panorama_names_the_missing_data_if_it_cannot_be_drawn() {
    let building = Building::new();
    let matterport = ["panorama", "--platform", "matterport", "--data", "data", "--out", "p.png"];
    let told = refused(&building, &matterport);
    assert!(told.contains("has no pictures at this place") && told.contains("wayword platforms"), "{told}");
    wayword_testkit::write_skyboxes(&building.data()).unwrap();
    view(&building, &matterport);
    picture(&building.path("p.png"));
    let told = refused(&building, &["panorama", "--viewpoint", "attic", "--out", "q.png"]);
    assert!(told.contains("no viewpoint attic") && told.contains("it has "), "{told}");
    assert!(refused(&building, &["panorama", "--heading-deg", "NaN", "--out", "q.png"]).contains("--heading-deg"));
    assert!(refused(&building, &["panorama", "--width", "0", "--out", "q.png"]).contains("--width"));
    assert!(refused(&building, &["panorama", "--scan", "moon", "--out", "q.png"]).contains("moon"));
    assert!(!building.path("q.png").exists());
}

#[test]
fn only_what_could_have_been_written_is_overwritten() {
    let building = Building::new();
    building.write("notes.png", "notes");
    for args in [&["panorama"][..], &["map"]] {
        let told = refused(&building, &[args, &["--out", "notes.png"]].concat());
        assert!(told.contains("would overwrite it"), "{told}");
        assert!(refused(&building, &[args, &["--out", "data"]].concat()).contains("ending"));
        assert!(refused(&building, &[args, &["--out", "p.tiff"]].concat()).contains(".png"));
    }
    assert_eq!(fs::read(building.path("notes.png")).unwrap(), b"notes");
    fs::create_dir(building.path("full")).unwrap();
    building.write("full/thesis.txt", "text");
    assert!(refused(&building, &["path", "--out", "full"]).contains("thesis.txt"));
    assert!(refused(&building, &["path", "--out", "walk.avi"]).contains(".gif"));
    assert!(refused(&building, &["path", "--fps", "1000", "--out", "walk.gif"]).contains("--fps"));
    // The platform's own pictures have the same format as the output, and must not be overwritten.
    wayword_testkit::write_skyboxes(&building.data()).unwrap();
    let own =
        files(&building.data()).into_keys().find(|file| file.extension().is_some_and(|end| end == "jpg")).unwrap();
    let own = format!("data/{}", own.display());
    let args = ["panorama", "--platform", "matterport", "--data", "data", "--out", &own];
    assert!(refused(&building, &args).contains("belongs to --data"));
}

#[test]
fn a_path_is_the_one_that_generate_walks() {
    let building = Building::new();
    let ran = building.wayword(&["generate", "--scan", TALL, "--paths", "1", "--seed", "3", "--out", "run"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let walked = building.records("run").remove(0).path;
    let seeded = view(&building, &["path", "--scan", TALL, "--seed", "3", "--out", "seeded"]);
    let frames = walked.frames.len();
    assert_eq!((seeded["frames"].as_u64(), size(&seeded)), (Some(frames as u64), (640, 480)));
    let made = files(&building.path("seeded"));
    assert_eq!(made.len(), frames);
    for (name, bytes) in &made {
        let read = image::load_from_memory(bytes).unwrap();
        assert_eq!((read.width(), read.height()), (640, 480), "{name:?}");
    }
    let of_run = ["path", "--episodes", "run/instructions.jsonl", "--item", &walked.id, "--out"];
    view(&building, &[&of_run[..], &["recorded/"]].concat());
    assert_eq!(files(&building.path("recorded")), made);
    // The same command may replace its own pictures. Pictures of a longer path must not be mixed with them.
    view(&building, &[&of_run[..], &["recorded/"]].concat());
    fs::write(building.path("recorded/frame-00999.png"), []).unwrap();
    assert!(refused(&building, &[&of_run[..], &["recorded/"]].concat()).contains("frame-00999.png"));
    let none = ["path", "--episodes", "run/instructions.jsonl", "--item", "nobody", "--out", "x"];
    assert!(refused(&building, &none).contains(&walked.id));
}

#[test]
fn a_gif_shows_every_frame_as_long_as_asked() {
    let building = Building::new();
    let shown = |args: &[&str]| {
        let all = ["path", "--scan", TALL, "--seed", "3", "--width", "160", "--out", "walk.gif"];
        let written = view(&building, &[&all[..], args].concat());
        let bytes = fs::read(building.path("walk.gif")).unwrap();
        let frames = GifDecoder::new(Cursor::new(bytes)).unwrap().into_frames().collect_frames().unwrap();
        assert_eq!(written["frames"].as_u64().unwrap() as usize, frames.len());
        for frame in &frames {
            assert_eq!(frame.buffer().dimensions(), (160, 120));
        }
        (frames.len(), Duration::from(frames[0].delay()).as_millis())
    };
    let (own, each_ms) = shown(&[]);
    assert_eq!(each_ms, 1000);
    assert_eq!(shown(&["--smooth", "2"]), (3 * (own - 1) + 1, 80));
    assert_eq!(shown(&["--fps", "4"]), (own, 250));
}

#[test]
fn view_between_viewpoints_is_refused_on_a_graph() {
    let building = Building::new();
    let path = ["path", "--platform", "matterport", "--data", "data", "--episodes", EPISODES, "--out", "frames"];
    assert!(refused(&building, &path).contains("there is no picture for any of its"));
    assert!(!building.path("frames").exists());
    wayword_testkit::write_skyboxes(&building.data()).unwrap();
    let told = refused(&building, &[&path[..], &["--smooth", "2"]].concat());
    assert!(told.contains("no pictures between") && told.contains("--smooth"), "{told}");
    let _ = fs::remove_dir_all(building.path("frames"));
    assert!(view(&building, &path)["frames"].as_u64().unwrap() > 1);
}

#[cfg(not(feature = "video"))]
#[test]
fn a_build_without_films_says_how_to_get_one() {
    let told = refused(&Building::new(), &["path", "--out", "walk.mp4"]);
    assert!(told.contains("--features full") && told.contains(".gif"), "{told}");
}

/// Every frame of an MP4 file, decoded. Its samples follow one another in `mdat`, and each unit comes after its length.
#[cfg(feature = "video")]
fn decoded(bytes: &[u8]) -> Vec<RgbImage> {
    use openh264::{decoder::Decoder, formats::YUVSource};
    let find = |name: &[u8]| bytes.windows(4).position(|four| four == name).unwrap();
    let unit = |at: usize, length: usize| [&[0, 0, 0, 1][..], &bytes[at..at + length]].concat();
    let long =
        |at: usize, count: usize| bytes[at..at + count].iter().fold(0, |sum, byte| sum << 8 | usize::from(*byte));
    let config = find(b"avcC") + 4;
    let sequence = long(config + 6, 2);
    let mut decoder = Decoder::new().unwrap();
    decoder.decode(&unit(config + 8, sequence)).unwrap();
    decoder.decode(&unit(config + 8 + sequence + 3, long(config + 9 + sequence, 2))).unwrap();
    let (start, mut frames) = (find(b"mdat"), Vec::new());
    let (mut at, end) = (start + 4, start - 4 + long(start - 4, 4));
    while at < end {
        let length = long(at, 4);
        if let Some(frame) = decoder.decode(&unit(at + 4, length)).unwrap() {
            let (width, height) = frame.dimensions();
            let mut rgb = vec![0; 3 * width * height];
            frame.write_rgb8(&mut rgb);
            frames.push(RgbImage::from_raw(width as u32, height as u32, rgb).unwrap());
        }
        at += 4 + length;
    }
    for frame in decoder.flush_remaining().unwrap() {
        let (width, height) = frame.dimensions();
        let mut rgb = vec![0; 3 * width * height];
        frame.write_rgb8(&mut rgb);
        frames.push(RgbImage::from_raw(width as u32, height as u32, rgb).unwrap());
    }
    frames
}

#[cfg(feature = "video")]
#[test]
fn a_film_shows_the_pictures_in_their_order() {
    let building = Building::new();
    let walk = ["path", "--scan", TALL, "--seed", "3", "--width", "321", "--out"];
    view(&building, &[&walk[..], &["frames"]].concat());
    let written = view(&building, &[&walk[..], &["walk.mp4"]].concat());
    let pictures: Vec<RgbImage> = files(&building.path("frames"))
        .values()
        .map(|bytes| image::load_from_memory(bytes).unwrap().into_rgb8())
        .collect();
    let film = decoded(&fs::read(building.path("walk.mp4")).unwrap());
    // One picture a second is ten frames a second.
    assert_eq!((written["frames"].as_u64().unwrap() as usize, film.len()), (pictures.len(), 10 * pictures.len()));
    for (at, frame) in film.iter().enumerate() {
        // H.264 needs an even width and height.
        assert_eq!(frame.dimensions(), (320, 240));
        let differs = |picture: &RgbImage| {
            let off = |(x, y, pixel): (u32, u32, &image::Rgb<u8>)| {
                pixel.0.iter().zip(picture.get_pixel(x, y).0).map(|(a, b)| u64::from(a.abs_diff(b))).sum::<u64>()
            };
            frame.enumerate_pixels().map(off).sum::<u64>() as f64 / (3.0 * 320.0 * 240.0)
        };
        let nearest = (0..pictures.len()).min_by(|a, b| differs(&pictures[*a]).total_cmp(&differs(&pictures[*b])));
        assert_eq!(nearest, Some(at / 10), "frame {at}");
        assert!(differs(&pictures[at / 10]) < 4.0, "frame {at}: {}", differs(&pictures[at / 10]));
    }
}

/// The titles of the discs on a map.
fn named(svg: &str) -> BTreeSet<String> {
    let titles = svg.split("<circle").skip(1).filter_map(|mark| mark.split_once("<title>"));
    titles.map(|(_, rest)| rest.split('<').next().unwrap().to_owned()).collect()
}

#[test]
fn maps_of_all_levels_hold_every_viewpoint_and_the_storey_beneath() {
    let building = Building::new();
    let platform = HousePlatform::default();
    let scene = platform.list_scenes().unwrap().into_iter().find(|scene| scene.as_str() == TALL).unwrap();
    let graph = platform.graph_for_scene(&scene).unwrap();
    let on_level = |level: u32| -> BTreeSet<String> {
        graph.viewpoints().filter(|node| graph.level_of(node) == Some(level)).map(ToString::to_string).collect()
    };
    for level in [1, 2] {
        let number = level.to_string();
        view(&building, &["map", "--scan", TALL, "--level", &number, "--out", "map.svg"]);
        let svg = fs::read_to_string(building.path("map.svg")).unwrap();
        assert_eq!(named(&svg), on_level(level));
        assert!(svg.contains("<image ") && svg.contains(" m</text>") && svg.contains(">N</text>"));
    }
    let told = refused(&building, &["map", "--scan", TALL, "--level", "3", "--out", "map.svg"]);
    assert!(told.contains("1, 2"), "{told}");
}

#[test]
fn a_map_shows_a_path_with_numbers_in_both_formats() {
    let building = Building::new();
    let walk = ["map", "--platform", "matterport", "--data", "data", "--episodes", EPISODES, "--out"];
    let drawn = view(&building, &[&walk[..], &["path.svg"]].concat());
    let svg = fs::read_to_string(building.path("path.svg")).unwrap();
    let frames = wayword_formats::read_any_format(&building.reverie()).unwrap().remove(0).viewpoints.len();
    for number in 0..frames {
        assert!(svg.contains(&format!(">{number}</text>")), "{number}: {svg}");
    }
    assert!(!svg.contains("<image "));
    let painted = view(&building, &[&walk[..], &["path.png"]].concat());
    let (width, height) = picture(&building.path("path.png")).dimensions();
    assert_eq!(size(&painted), (width, height));
    assert!(width.abs_diff(2 * size(&drawn).0) <= 2 && height.abs_diff(2 * size(&drawn).1) <= 2);
    // The same command gives the same bytes.
    let before = fs::read(building.path("path.png")).unwrap();
    view(&building, &[&walk[..], &["path.png"]].concat());
    assert_eq!(fs::read(building.path("path.png")).unwrap(), before);
}
