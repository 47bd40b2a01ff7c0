//! The recordings that the tests of `wayword-recording` read. All of them show scenes of our own.

use flate2::read::GzDecoder;
use std::{
    fs,
    io::Read,
    path::{Path, PathBuf},
};

/// The folder of fixtures.
pub fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../crates/world/wayword-recording/fixtures")
}

/// The files below a folder, sorted: their paths relative to it, and their unpacked contents.
pub fn files(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    let mut open = vec![folder.to_owned()];
    while let Some(next) = open.pop() {
        for entry in fs::read_dir(next).expect("the fixtures").flatten() {
            let path = entry.path();
            if path.is_dir() {
                open.push(path);
                continue;
            }
            let mut bytes = fs::read(&path).expect("a fixture");
            let name = path.strip_prefix(folder).expect("below it").to_string_lossy().into_owned();
            let name = match name.strip_suffix(".gz") {
                Some(short) => {
                    let mut unpacked = Vec::new();
                    GzDecoder::new(&bytes[..]).read_to_end(&mut unpacked).expect("a packed fixture");
                    bytes = unpacked;
                    short.to_owned()
                }
                None => name,
            };
            files.push((name, bytes));
        }
    }
    files.sort();
    files
}

/// The contents of the fixtures of a kind.
pub fn of_kind(kind: &str) -> Vec<Vec<u8>> {
    files(&fixtures().join(kind)).into_iter().map(|(_, bytes)| bytes).collect()
}

/// Pose files. The first byte of each says of which kind it is.
pub fn poses() -> Vec<Vec<u8>> {
    let texts: [(u8, &str); 7] = [
        (0, "# time x y z qx qy qz qw\n0 0 0 1.5 0 0 0 1\n1 1 0 1.5 0 0 0.7 0.7\n2 2 1 1.5 0 0 0 1\n"),
        (0, "1 0 0 0 0 1 0 0 0 0 1 1.5\n1 0 0 1 0 1 0 0 0 0 1 1.5\n1 0 0 2 0 1 0 0 0 0 1 1.5\n"),
        (1, "time,x,y,z,heading\n0,0,0,1.5,0\n1,1,0,1.5,0.5\n2,2,0,1.5,1\n"),
        (1, "image,x,y,z,qw,qx,qy,qz\n0.png,0,0,1.5,1,0,0,0\n1.png,1,0,1.5,1,0,0,0\n2.png,2,0,1.5,1,0,0,0\n"),
        (
            2,
            r#"[{"time":0,"position":[0,0,1.5],"heading_deg":0},{"time":1,"position":[1,0,1.5]},{"time":2,"position":[2,0,1.5]}]"#,
        ),
        (
            2,
            r#"{"frames":[{"file_path":"0.png","transform_matrix":[[1,0,0,0],[0,1,0,0],[0,0,1,1.5],[0,0,0,1]]},{"file_path":"1.png","transform_matrix":[[1,0,0,1],[0,1,0,0],[0,0,1,1.5],[0,0,0,1]]}]}"#,
        ),
        (3, "camera = \"front\"\ninterval_m = 0.5\ninterval_s = 1\nhorizontal_fov_deg = 80\n"),
    ];
    texts.iter().map(|(which, text)| [&[*which], text.as_bytes()].concat()).collect()
}
