//! Errors about files: they name the file, the item and the field, and give advice.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use serde_json::{Value, json};
use std::io::Write;
use wayword_formats::{DatasetFormat, detect_format, read_any_format};

/// The message, without the folder.
fn refusal(format: DatasetFormat, name: &str, bytes: &[u8]) -> String {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join(name);
    std::fs::write(&file, bytes).unwrap();
    let text = format.read_file(&file).unwrap_err().to_string();
    text.replace(&format!("{}/", folder.path().display()), "")
}

fn refusal_of(format: DatasetFormat, field: &str, value: Value) -> String {
    let mut items = crate::common::items(format);
    *items[1].pointer_mut(field).unwrap() = value;
    refusal(format, "data.json", crate::common::text(format, &items).as_bytes())
}

#[test]
fn a_refusal_names_file_item_and_field() {
    assert_eq!(
        refusal_of(DatasetFormat::Reverie, "/heading", json!("abc")),
        "data.json: item 1 (id 1_66): field \"heading\": expected a finite number, found \"abc\"; write it as a JSON number"
    );
    assert_eq!(
        refusal_of(DatasetFormat::R2r, "/path/2", json!(5)),
        "data.json: item 1 (id 1): field \"path[2]\": expected a text, found 5; put it in quotes"
    );
    assert_eq!(
        refusal_of(DatasetFormat::Rxr, "/scan", json!("a/b")),
        "data.json: line 2 (id 1): field \"scan\": scene \"a/b\" could name another folder: path separators are not allowed in \
         an id; give the scan's bare name"
    );
    assert_eq!(
        refusal_of(DatasetFormat::Vlnce, "/start_rotation", json!([0, 0, 0, 0])),
        "data.json: item 1 (id 1): field \"start_rotation\": it gives no heading; write a quaternion of length 1 as x, y, z, w"
    );
    assert_eq!(
        refusal_of(DatasetFormat::Wayword, "/path/frames/1/pose/heading", Value::Null),
        "data.json: line 2 (id house2-1): field \"path.frames[1]\": invalid type: null, expected f64; docs/FORMATS.md says \
         what it should be"
    );
}

#[test]
fn an_item_that_contradicts_itself_is_refused() {
    for (field, value, told) in [
        (
            "/start_position",
            json!([9, 0, 0]),
            "field \"start_position\": it is 7.9 m from the beginning of reference_path",
        ),
        ("/goals/0/position", json!([50, 0, 50]), "field \"goals[0].position\": it is 69.8 m from the end of"),
        ("/goals/0/position", json!([1.5, 9, -2.5]), "m from the end of reference_path"),
        ("/info/geodesic_distance", json!(-5), "field \"info.geodesic_distance\": it is -5.0"),
    ] {
        let told_instead = refusal_of(DatasetFormat::Vlnce, field, value);
        assert!(
            told_instead.starts_with("data.json: item 1 (id 1): ") && told_instead.contains(told),
            "{told_instead}"
        );
    }
    for (field, value, told) in [
        ("/id", json!("9_66"), "it is \"9_66\", but path_id and objId give \"1_66\""),
        ("/objId", json!(67), "it is \"1_66\", but path_id and objId give \"1_67\""),
        ("/path_id", json!(5), "correct id, path_id or objId"),
    ] {
        let told_instead = refusal_of(DatasetFormat::Reverie, field, value);
        assert!(told_instead.contains("field \"id\"") && told_instead.contains(told), "{told_instead}");
    }
}

#[test]
fn ends_near_the_path_and_names_of_another_kind_are_read() {
    let accepts = |format: DatasetFormat, items: &[Value]| {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("data.json");
        std::fs::write(&file, crate::common::text(format, items)).unwrap();
        format.read_file(&file).unwrap().len()
    };
    let mut episodes = crate::common::items(DatasetFormat::Vlnce);
    episodes[0]["start_position"] = json!([1.5, 0.125, 0.4]);
    episodes[1]["goals"] = json!([{"position": [40.0, 0.0, 0.0]}, {"position": [4.0, 0.0, -5.0]}]);
    episodes[2]["info"]["geodesic_distance"] = json!(0);
    assert_eq!(accepts(DatasetFormat::Vlnce, &episodes), 3);
    let mut items = crate::common::items(DatasetFormat::Reverie);
    for (number, item) in items.iter_mut().enumerate() {
        item["id"] = json!(format!("augmented-{number}"));
    }
    assert_eq!(accepts(DatasetFormat::Reverie, &items), 3);
    let mut items = crate::common::items(DatasetFormat::Reverie);
    items[0]["id"] = json!("0");
    items[0].as_object_mut().unwrap().remove("objId");
    assert_eq!(accepts(DatasetFormat::Reverie, &items), 3, "an item without an object has no part in this");
}

#[test]
fn broken_json_is_refused_at_the_place_where_it_breaks() {
    let text = crate::common::text(DatasetFormat::R2r, &crate::common::items(DatasetFormat::R2r));
    let at = text.rfind("1.5").unwrap();
    assert_eq!(
        refusal(DatasetFormat::R2r, "data.json", &text.as_bytes()[..at]),
        format!(
            "data.json: item 2: field \"heading\": the file is cut off (line 1, column {at}); fetch or write it again, to \
             its end"
        )
    );
    let twice = text.replacen("\"scan\":", "\"scan\":\"x\",\"scan\":", 1);
    assert!(
        refusal(DatasetFormat::R2r, "data.json", twice.as_bytes())
            .starts_with("data.json: item 0: field \"scan\": it is given twice")
    );
    assert!(refusal(DatasetFormat::R2r, "data.json", b"{}").contains("line 1: field \"path_id\": it is missing"));
    assert!(refusal(DatasetFormat::Vlnce, "data.json", b"{}").contains("field \"episodes\" is missing"));
    let words = b"{\"episodes\": [], \"instruction_vocab\": {\"word_list\": [1]}}";
    assert!(refusal(DatasetFormat::Vlnce, "data.json", words).contains("instruction_vocab.word_list"));
    assert!(refusal(DatasetFormat::R2r, "data.json", b"[] []").contains("something follows the end of the JSON"));
}

#[test]
fn evidence_that_leads_out_of_its_text_or_path_is_refused() {
    for (field, value) in
        [("/mentions/0/span", json!([12, 999])), ("/mentions/0/span", json!([16, 12])), ("/mentions/0/frame", json!(2))]
    {
        let text = refusal_of(DatasetFormat::Wayword, field, value);
        assert!(text.contains("field \"mentions[0]\": it points outside the text or the path"), "{text}");
    }
}

#[test]
fn a_long_text_is_refused_before_it_is_in_memory() {
    let long = format!("\"{}\"", "x".repeat(3 << 20));
    for (format, text, place) in [
        (DatasetFormat::R2r, long.clone(), ""),
        (DatasetFormat::R2r, format!("[{{\"scan\": {long}}}]"), "item 0: field \"scan\""),
        (DatasetFormat::Vlnce, format!("{{\"episodes\": [{{{long}: 1}}]}}"), "item 0"),
        (DatasetFormat::Vlnce, format!("{{\"notes\": {long}}}"), ""),
    ] {
        let told = refusal(format, "data.json", text.as_bytes());
        assert!(told.starts_with(&format!("data.json: {place}")), "{told}");
        assert!(told.contains("a text or number in it is longer than 1 MiB"), "{told}");
    }
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("data.json");
    std::fs::write(&file, &long).unwrap();
    assert!(detect_format(&file).unwrap_err().to_string().contains("longer than 1 MiB"));
    let many = refusal_of(DatasetFormat::R2r, "/distance", json!(vec!["x".repeat(1 << 20); 17]));
    assert!(many.contains("it has more than 16 MiB of text"), "{many}");
    let around = format!("{{{}\"episodes\": []}}", (0..30).map(|n| format!("\"f{n}\": 1,")).collect::<String>());
    assert!(refusal(DatasetFormat::Vlnce, "data.json", around.as_bytes()).contains("too many fields"));
}

#[test]
fn a_mark_before_utf_8_is_passed_over_and_utf_16_is_named() {
    for (format, name) in
        [(DatasetFormat::R2r, "data.json"), (DatasetFormat::Rxr, "data.jsonl"), (DatasetFormat::Vlnce, "data.json")]
    {
        let text = crate::common::text(format, &crate::common::items(format));
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(name);
        std::fs::write(&file, format!("\u{feff}{text}")).unwrap();
        let marked = format.read_file(&file).unwrap();
        assert_eq!(detect_format(&file).unwrap(), format);
        std::fs::write(&file, &text).unwrap();
        assert_eq!(format.read_file(&file).unwrap(), marked);
        let wide: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
        assert_eq!(refusal(format, name, &wide), format!("{name}: it is text in UTF-16; save it as UTF-8"));
    }
}

#[cfg(unix)]
#[test]
fn a_pipe_is_refused_and_not_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.json");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for told in [
        DatasetFormat::R2r.read_file(&pipe).unwrap_err(),
        detect_format(&pipe).unwrap_err(),
        detect_format("/dev/zero".as_ref()).unwrap_err(),
    ] {
        assert!(told.to_string().contains("it is not a file but a pipe or a device"), "{told}");
    }
}

#[test]
fn limits_on_texts_and_lists_are_enforced() {
    let long = refusal_of(DatasetFormat::R2r, "/instructions/0", json!("x".repeat(20_001)));
    assert!(long.contains("field \"instructions[0]\": it has 20001 bytes"), "{long}");
    let many = refusal_of(DatasetFormat::R2r, "/instructions", json!(vec!["x"; 1_001]));
    assert!(many.contains("it has 1001 entries"), "{many}");
    let parts = refusal_of(DatasetFormat::R2r, "/distance", json!(vec![0; 200_001]));
    assert!(parts.contains("it has more than 200,000 values"), "{parts}");
    let line = refusal(DatasetFormat::Rxr, "data.jsonl", &vec![b' '; (16 << 20) + 2]);
    assert_eq!(line, "data.jsonl: line 1 is longer than 16 MiB; write one JSON object per line");
    let lines = refusal(DatasetFormat::Rxr, "data.jsonl", &vec![b'\n'; 1_000_001]);
    assert_eq!(lines, "data.jsonl: it has more than 1,000,000 lines; split it into parts");
}

#[test]
fn a_gzip_bomb_ends_at_the_limit_of_a_line() {
    let mut bomb = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    for _ in 0..64 {
        bomb.write_all(&vec![b' '; 1 << 20]).unwrap();
    }
    let bomb = bomb.finish().unwrap();
    assert!(bomb.len() < 1 << 20);
    assert!(refusal(DatasetFormat::Rxr, "bomb.jsonl.gz", &bomb).contains("line 1"));
}

#[test]
fn a_file_of_more_than_a_gibibyte_is_not_even_read() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("huge.json");
    // Sparse: it takes no space on the disk.
    std::fs::File::create(&file).unwrap().set_len((1 << 30) + 1).unwrap();
    assert!(read_any_format(&file).unwrap_err().to_string().contains("it is larger than 1 GiB"));
}

#[test]
fn detect_explains_why_a_file_is_no_dataset() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("notes.txt");
    for text in ["", "hello", "[]", "[1]", "{\"a\": 1}"] {
        std::fs::write(&file, text).unwrap();
        let error = detect_format(&file).unwrap_err().to_string();
        assert!(error.contains("notes.txt: its beginning does not fit any known format"), "{text:?}: {error}");
    }
    std::fs::write(&file, "").unwrap();
    assert!(detect_format(&file).unwrap_err().to_string().contains("known format: it is empty"));
    for (text, place) in [("{\"a\": 1", "line 1, column 7"), ("[\n{\"scan\": ", "line 2, column 9")] {
        std::fs::write(&file, text).unwrap();
        let error = detect_format(&file).unwrap_err().to_string();
        assert!(
            error.ends_with(&format!("notes.txt: the file is cut off at {place}; fetch or write it again, to its end")),
            "{error}"
        );
    }
    assert!(detect_format(folder.path()).unwrap_err().to_string().contains("is not a file but a folder"));
    let none = detect_format(&folder.path().join("none")).unwrap_err().to_string();
    assert!(none.contains("cannot open it") && none.ends_with("; check the spelling of the path"), "{none}");
}
