//! Tests checkpoints as training leaves them, whole, damaged and malicious.

use super::*;
use std::io::Write;
use zip::{ZipWriter, write::SimpleFileOptions};

fn fixture() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/glip/glip.pth")
}

/// An archive with this pickle, and the storage `0` of 16 bytes.
fn made(folder: &Path, pickle: &[u8]) -> PathBuf {
    let path = folder.join("made.pth");
    let mut archive = ZipWriter::new(File::create(&path).unwrap());
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, bytes) in
        [("a/data.pkl", pickle), ("a/data/0", &[0, 0, 128, 63, 0, 0, 0, 64, 0, 0, 64, 64, 0, 0, 128, 64])]
    {
        archive.start_file(name, stored).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap();
    path
}

/// A pickle of {"model": {"module.w": tensor}} with these numbers: of the storage, before the tensor, shape, stride.
fn pickle(count: u8, offset: u8, shape: &[u8], strides: &[u8]) -> Vec<u8> {
    let text = |text: &str| [&[b'X', text.len() as u8, 0, 0, 0][..], text.as_bytes()].concat();
    let tuple =
        |numbers: &[u8]| [&[b'('][..], &numbers.iter().flat_map(|&n| [b'K', n]).collect::<Vec<_>>(), b"t"].concat();
    let storage = [
        b"(".to_vec(),
        text("storage"),
        b"ctorch\nFloatStorage\n".to_vec(),
        text("0"),
        text("cpu"),
        vec![b'K', count],
        b"tQ".to_vec(),
    ]
    .concat();
    let tensor = [
        b"ctorch._utils\n_rebuild_tensor_v2\n(".to_vec(),
        storage,
        vec![b'K', offset],
        tuple(shape),
        tuple(strides),
        b"\x89ccollections\nOrderedDict\n)RtR".to_vec(),
    ]
    .concat();
    [b"\x80\x02}".to_vec(), text("model"), b"}".to_vec(), text("module.w"), tensor, b"ss.".to_vec()].concat()
}

fn told(folder: &Path, pickle: &[u8], shape: &[usize]) -> Result<Vec<f32>, String> {
    let file = TrainingCheckpoint::open(&made(folder, pickle)).map_err(|error| error.to_string())?;
    let tensor = file.read_tensor("w", shape).map_err(|error| error.to_string())?;
    Ok(tensor.flatten_all().unwrap().to_vec1().unwrap())
}

#[test]
fn only_the_weights_are_read() {
    let file = TrainingCheckpoint::open(&fixture()).unwrap();
    assert!(file.tensor_names().all(|name| !name.starts_with("module.") && !name.contains("exp_avg")));
    assert_eq!(file.tensor_shape("rpn.head.bias0").unwrap(), [1]);
    let bias = file.read_tensor("rpn.head.bias0", &[1]).unwrap().to_vec1::<f32>().unwrap()[0];
    assert!((-1.5..-0.5).contains(&bias), "{bias}");
    let index = "backbone.body.layers.0.blocks.0.attn.relative_position_index";
    assert_eq!(file.read_tensor(index, &[9, 9]).unwrap().to_vec2::<i64>().unwrap()[8][8], 80);
    let error = file.read_tensor("rpn.head.bias0", &[2]).unwrap_err().to_string();
    assert!(
        error.contains("glip.pth") && error.contains("rpn.head.bias0") && error.contains("[1], not [2]"),
        "{error}"
    );
}

#[test]
fn a_tensor_may_be_a_part_of_its_storage() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(told(folder.path(), &pickle(4, 0, &[2, 2], &[2, 1]), &[2, 2]).unwrap(), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(told(folder.path(), &pickle(4, 1, &[2, 1], &[1, 7]), &[2, 1]).unwrap(), [2.0, 3.0]);
}

#[test]
fn contradictory_sizes_are_reported_with_the_tensor() {
    let folder = tempfile::tempdir().unwrap();
    for (pickle, shape, problem) in [
        (pickle(4, 3, &[2], &[1]), &[2][..], "larger than"),
        (pickle(5, 0, &[5], &[1]), &[5], "16 bytes, not 20"),
        (pickle(255, 0, &[255], &[1]), &[255], "larger than"),
        (pickle(4, 0, &[2, 2], &[1, 2]), &[2, 2], "in order"),
    ] {
        let error = told(folder.path(), &pickle, shape).unwrap_err();
        assert!(error.contains("made.pth") && error.contains("tensor w") && error.contains(problem), "{error}");
    }
}

#[test]
fn a_pickle_that_calls_an_unknown_name_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    for (pickle, problem) in [
        (&b"cos\nsystem\n(X\x04\x00\x00\x00true\x85R."[..], "\"os.system\""),
        (b"ctorch\nHalfStorage\n.", "torch.HalfStorage"),
        (b"\x80\x04\x8c\x01a.", "0x8c"),
        (b"ccollections\nOrderedDict\n(K\x01tR.", "to be called"),
        (b"}.", "no table \"model\""),
        (b"K\x01.", "not hold a table"),
        (b"h\x07.", "not kept"),
        (b"}X\xff\xff\xff\xff", "cut off"),
        (b"(", "cut off"),
        (b"R", "not there"),
        (b"(K\x01u", "no table"),
        (b"", "cut off"),
        (&[&[b'N'][..], &[0x85; 100_000]].concat(), "deeper than 16"),
    ] {
        let error = told(folder.path(), pickle, &[1]).unwrap_err();
        assert!(error.contains("made.pth") && error.contains(problem), "{problem}: {error}");
    }
}

#[test]
fn a_file_that_is_cut_off_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (whole, path) = (std::fs::read(fixture()).unwrap(), folder.path().join("cut.pth"));
    for length in [0, 30, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..length]).unwrap();
        let error = TrainingCheckpoint::open(&path).err().expect("it is refused").to_string();
        assert!(error.contains("cut.pth") && error.contains("cut off"), "{error}");
    }
    // A number of a tensor that was changed is found by its checksum.
    let mut changed = whole;
    let name = b"/data/0";
    let at = changed.windows(name.len()).position(|window| window == name).unwrap() + 200;
    changed[at] ^= 0x40;
    std::fs::write(&path, &changed).unwrap();
    let file = TrainingCheckpoint::open(&path).unwrap();
    let problems =
        file.tensor_names().filter(|name| file.read_tensor(name, &file.tensor_shape(name).unwrap()).is_err()).count();
    assert_eq!(problems, 1);
}
