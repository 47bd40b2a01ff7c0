//! Hashes that the hub gives to files.

use super::commit::is_hex;
use sha1::Sha1;
use sha2::{Digest, Sha256};
use std::{
    fmt::Write,
    fs::File,
    io::{self, Read},
    path::Path,
};

/// What a file's bytes have to hash to. As text it names the blob, as in the hub's own client.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum BlobHash {
    /// Of large files.
    Sha256(String),
    /// Of small files: git's hash of a blob.
    Git(String),
}

impl BlobHash {
    /// Reads an etag. `None` where it is none of the hub's hashes: what cannot be checked is not used.
    pub(super) fn from_etag(etag: &str) -> Option<Self> {
        let hash = etag.strip_prefix("W/").unwrap_or(etag).trim_matches('"');
        if is_hex(hash, 64) {
            Some(Self::Sha256(hash.to_owned()))
        } else if is_hex(hash, 40) {
            Some(Self::Git(hash.to_owned()))
        } else {
            None
        }
    }

    pub(super) fn as_str(&self) -> &str {
        match self {
            Self::Sha256(hash) | Self::Git(hash) => hash,
        }
    }

    /// Whether a file's bytes hash to this.
    pub(super) fn fits(&self, path: &Path) -> io::Result<bool> {
        let mut file = File::open(path)?;
        let found = match self {
            Self::Sha256(_) => hex_of(&mut file, Sha256::new())?,
            Self::Git(_) => {
                let length = file.metadata()?.len();
                hex_of(&mut file, Sha1::new().chain_update(format!("blob {length}\0")))?
            }
        };
        Ok(found == self.as_str())
    }
}

/// The hex digits of what a reader gives, behind what the hasher has taken already.
fn hex_of(reader: &mut impl Read, mut hasher: impl Digest) -> io::Result<String> {
    let mut buffer = vec![0; 1 << 20];
    loop {
        match reader.read(&mut buffer)? {
            0 => return Ok(hex(&hasher.finalize())),
            read => hasher.update(&buffer[..read]),
        }
    }
}

/// Bytes as hex digits in lower case.
pub(super) fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_held_against_both_kinds_of_hash() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        std::fs::write(&file, "hello\n").unwrap();
        // `echo hello | git hash-object --stdin` and `echo hello | sha256sum`.
        let git = "ce013625030ba8dba906f756967f9e9ca394464a";
        let sha256 = "5891b5b522d5df086d0ff0b110fbd9d21bb4fc7163af34d08286a2e846f6be03";
        for etag in [git, sha256, &format!("\"{git}\""), &format!("W/\"{sha256}\"")] {
            assert!(BlobHash::from_etag(etag).unwrap().fits(&file).unwrap(), "{etag}");
        }
        let other = BlobHash::from_etag(&git.replace('c', "d")).unwrap();
        assert!(!other.fits(&file).unwrap());
    }

    #[test]
    fn what_is_no_hash_is_refused() {
        let etags = ["", "\"\"", "abc", "../../etc/passwd", "5D41402ABC4B2A76B9719D911017C592AAAAAAAA", "bb-bWMd8e2"];
        for etag in etags {
            assert_eq!(BlobHash::from_etag(etag), None, "{etag}");
        }
    }
}
