//! Tells from its first bytes what a file is that should be a GLB or glTF file.

const WHOLE_HINT: &str = "this copy of the file is not whole: copy or download it once more, or export the scene again";
const FOREIGN_HINT: &str = "give a GLB or glTF file";
const LFS_HINT: &str = "fetch the file itself with git lfs pull";
/// The beginnings of other kinds of files, and what they are.
const FOREIGN_KINDS: [(&[u8], &str); 7] = [
    (b"<", "a web page or XML"),
    (b"PK\x03\x04", "a ZIP archive"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"ply", "a PLY file"),
    (b"solid", "an STL file"),
    (b"Kaydara FBX", "an FBX file"),
    (b"BLENDER", "a Blender file"),
];
/// Most bytes of an unknown file that an error shows.
const MAX_SHOWN_BYTES: usize = 8;

/// Why a file cannot be read, and what to do.
#[derive(Debug, PartialEq)]
pub(super) struct KindFault {
    pub(super) reason: String,
    pub(super) hint: &'static str,
}

/// Checks that the bytes can be those of a whole GLB, or of a glTF file, which is JSON.
pub(super) fn check_file_kind(bytes: &[u8]) -> Result<(), KindFault> {
    let fault = |reason: String, hint| Err(KindFault { reason, hint });
    if bytes.is_empty() {
        return fault("is empty".to_owned(), WHOLE_HINT);
    }
    if let Some(rest) = bytes.strip_prefix(b"glTF") {
        // After "glTF" a GLB has its version and its length.
        let told = rest.get(4..).and_then(|rest| rest.first_chunk::<4>()).map(|length| u32::from_le_bytes(*length));
        return match told {
            Some(told) if told as usize <= bytes.len() => Ok(()),
            Some(told) => fault(format!("is cut off: it should have {told} bytes and has {}", bytes.len()), WHOLE_HINT),
            None => fault(format!("is cut off after {} bytes", bytes.len()), WHOLE_HINT),
        };
    }
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes).trim_ascii_start();
    if text.starts_with(b"{") {
        return match serde_json::from_slice::<serde::de::IgnoredAny>(text) {
            Err(error) if error.is_eof() => fault(format!("is cut off: {error}"), WHOLE_HINT),
            _ => Ok(()),
        };
    }
    if bytes.iter().all(|byte| *byte == 0) {
        return fault(format!("has {} bytes, and all of them are 0", bytes.len()), WHOLE_HINT);
    }
    if bytes.starts_with(b"version https://git-lfs") {
        return fault("is a pointer of Git LFS, not the file itself".to_owned(), LFS_HINT);
    }
    match FOREIGN_KINDS.iter().find(|(beginning, _)| text.starts_with(beginning)) {
        Some((_, kind)) => fault(format!("is {kind}, not a GLB or glTF file"), FOREIGN_HINT),
        None => {
            let shown = bytes.get(..MAX_SHOWN_BYTES).unwrap_or(bytes).escape_ascii();
            fault(format!("is not a GLB or glTF file: it begins with \"{shown}\""), FOREIGN_HINT)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_no_scene_is_called_what_it_is() {
        let told = |bytes: &[u8]| {
            let fault = check_file_kind(bytes).unwrap_err();
            format!("{}; {}", fault.reason, fault.hint)
        };
        assert_eq!(told(b""), format!("is empty; {WHOLE_HINT}"));
        assert_eq!(told(b"glTF\x02\0"), format!("is cut off after 6 bytes; {WHOLE_HINT}"));
        let cut = b"glTF\x02\0\0\0\xe8\x03\0\0JSON";
        assert_eq!(told(cut), format!("is cut off: it should have 1000 bytes and has 16; {WHOLE_HINT}"));
        assert!(told(b"{\"asset\": {\"version\"").starts_with("is cut off: EOF while parsing"));
        assert_eq!(told(&[0; 64]), format!("has 64 bytes, and all of them are 0; {WHOLE_HINT}"));
        assert_eq!(told(b"version https://git-lfs.github.com/spec/v1\n").split_once("; ").unwrap().1, LFS_HINT);
        assert!(told(b"\n<!DOCTYPE html>").starts_with("is a web page or XML"));
        assert!(told(b"PK\x03\x04aaaa").starts_with("is a ZIP archive"));
        assert!(told(b"ply\nformat ascii 1.0").starts_with("is a PLY file"));
        assert_eq!(
            told(b"\x89PNG\r\n\x1a\n...."),
            format!("is not a GLB or glTF file: it begins with \"\\x89PNG\\r\\n\\x1a\\n\"; {FOREIGN_HINT}")
        );
        for whole in [&b"\xef\xbb\xbf { }"[..], b"{\"asset\": 3}", b"{nonsense", b"glTF\x02\0\0\0\x0c\0\0\0"] {
            assert_eq!(check_file_kind(whole), Ok(()), "what is wrong in it is told where it is read");
        }
    }
}
