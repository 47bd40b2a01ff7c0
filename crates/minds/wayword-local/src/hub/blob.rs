//! Fetches the bytes of one file, going on where an earlier try ended.

use super::{
    Progress,
    client::{Client, Opened},
    commit::Commit,
    hash::BlobHash,
    layout::{RepoFolder, beside, make_parent},
    name::OnHub,
    trouble::{Patience, Trouble},
};
use crate::LocalError;
use std::{
    fs::{self, File, OpenOptions},
    io::{Read, Seek, SeekFrom, Write},
    path::Path,
};

/// Bytes that are taken where the hub does not say how many there are: it says so of every large file.
const MOST_UNANNOUNCED: u64 = 64 << 20;

/// So much has to come before earlier failures are forgotten, so that a server that gives byte after byte is given up.
const A_GOOD_PIECE: u64 = 1 << 20;

/// A file of a commit, and what the hub says of its bytes.
pub(super) struct Wanted<'a> {
    pub(super) place: &'a OnHub,
    pub(super) commit: &'a Commit,
    pub(super) file: &'a str,
    pub(super) hash: &'a BlobHash,
    pub(super) size: Option<u64>,
}

/// Sees to it that the blob is in the cache.
pub(super) fn fetch(
    client: &Client,
    repo: &RepoFolder,
    wanted: &Wanted<'_>,
    progress: &dyn Progress,
) -> Result<(), LocalError> {
    let blob = repo.blob(wanted.hash);
    if blob.is_file() {
        return Ok(());
    }
    let _lock = repo.lock(wanted.hash, || progress.waiting(wanted.file))?;
    if blob.is_file() {
        return Ok(());
    }
    make_parent(&blob)?;
    let part = beside(&blob, ".incomplete");
    let mut patience = client.patience();
    let mut resumed = whole(client, wanted, &part, progress, &mut patience)?;
    // The whole file is read again, because the beginning may be of another process, and a disk may be full or worse.
    while !wanted.hash.fits(&part).map_err(|error| LocalError::io(&part, "read", error))? {
        fs::remove_file(&part).map_err(|error| LocalError::io(&part, "remove", error))?;
        if !resumed {
            return Err(LocalError::Download {
                address: address(client, wanted),
                problem: format!("what came does not have the hash {}", wanted.hash.as_str()),
                hint: "try again; where it stays so, something on the way changes what is sent".to_owned(),
            });
        }
        // What an earlier try left was wrong. Once more from the beginning, and then no more.
        whole(client, wanted, &part, progress, &mut patience)?;
        resumed = false;
    }
    fs::rename(&part, &blob).map_err(|error| LocalError::io(&blob, "write", error))
}

fn address(client: &Client, wanted: &Wanted<'_>) -> String {
    client.address(wanted.place, wanted.commit.as_str(), wanted.file)
}

/// Fetches until all bytes are there. Whether some of them were there before.
fn whole(
    client: &Client,
    wanted: &Wanted<'_>,
    part: &Path,
    progress: &dyn Progress,
    patience: &mut Patience,
) -> Result<bool, LocalError> {
    let io = |error| LocalError::io(part, "write", error);
    let mut out = OpenOptions::new().create(true).append(true).open(part).map_err(io)?;
    let length = |out: &File| out.metadata().map(|about| about.len()).map_err(io);
    if wanted.size.is_some_and(|size| length(&out).is_ok_and(|length| length > size)) {
        out.set_len(0).map_err(io)?;
    }
    let resumed = length(&out)? > 0;
    loop {
        let before = length(&out)?;
        if wanted.size.is_some_and(|size| before == size && size > 0) {
            break;
        }
        match piece(client, wanted, &mut out, part, progress) {
            Ok(()) => break,
            Err(trouble) => {
                if length(&out)? >= before.saturating_add(A_GOOD_PIECE) {
                    patience.restored();
                }
                patience.again(trouble, &address(client, wanted))?;
            }
        }
    }
    out.sync_all().map_err(io)?;
    Ok(resumed)
}

/// Fetches what one connection gives.
fn piece(
    client: &Client,
    wanted: &Wanted<'_>,
    out: &mut File,
    part: &Path,
    progress: &dyn Progress,
) -> Result<(), Trouble> {
    let io = |error| Trouble::Lasting(LocalError::io(part, "write", error));
    let there = out.seek(SeekFrom::End(0)).map_err(io)?;
    let Opened { from, mut body } = client.open(wanted.place, wanted.commit, wanted.file, there)?;
    out.set_len(from).map_err(io)?;
    let most = wanted.size.unwrap_or(MOST_UNANNOUNCED);
    let (mut done, mut buffer) = (from, vec![0; 1 << 18]);
    progress.bytes(wanted.file, done, wanted.size);
    loop {
        let read = body.read(&mut buffer).map_err(|error| Trouble::passing(format!("it broke off: {error}")))?;
        if read == 0 {
            break;
        }
        done += read as u64;
        if done > most {
            let problem = format!("it sends more than the {most} bytes that a file of this announcement has");
            // None of it can be trusted.
            out.set_len(0).map_err(io)?;
            return Err(Trouble::Lasting(LocalError::Download {
                address: address(client, wanted),
                problem,
                hint: "try again later; see HF_ENDPOINT where you have set it".to_owned(),
            }));
        }
        out.write_all(&buffer[..read]).map_err(io)?;
        progress.bytes(wanted.file, done, wanted.size);
    }
    if wanted.size.is_some_and(|size| done < size) {
        return Err(Trouble::passing(format!("it broke off after {done} bytes")));
    }
    Ok(())
}
