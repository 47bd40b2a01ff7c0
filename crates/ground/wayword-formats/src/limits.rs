//! Limits on untrusted files, in one place. They are far above the sizes of the field's datasets. A file beyond a limit
//! is refused, with an error that names the limit.

/// Largest file, in bytes, both on the disk and after gunzip.
pub(crate) const MAX_FILE_BYTES: u64 = 1 << 30;
/// Most items in a file.
pub(crate) const MAX_ITEMS: usize = 1_000_000;
/// Most JSON values within one item. Without this limit, a small file of zeros takes forty times its size in memory.
pub(crate) const MAX_VALUES_PER_ITEM: usize = 200_000;
/// Most JSON values of a whole file (or of files that are merged) that are kept in memory.
pub(crate) const MAX_VALUES_IN_MEMORY: usize = 20_000_000;
/// Longest line of a JSON Lines file, bytes; also the most bytes of text in one item of a JSON list.
pub(crate) const MAX_LINE_BYTES: usize = 16 << 20;
/// Longest JSON text or number of a file, bytes: fifty times the longest instruction.
pub(crate) const MAX_TOKEN_BYTES: usize = 1 << 20;
/// Most nodes or positions of one path.
pub(crate) const MAX_PATH_NODES: usize = 1_000;
/// Longest instruction, bytes. Writers keep to it as well, so that Wayword can read what a run writes.
pub(crate) const MAX_INSTRUCTION_BYTES: usize = wayword_core::MAX_TEXT_BYTES;
/// Most instructions of one item.
pub(crate) const MAX_INSTRUCTIONS: usize = 1_000;
/// Longest name (of a path, an item, a split), bytes.
pub(crate) const MAX_NAME_BYTES: usize = 128;
/// Most entries of one submitted trajectory. Agents that look around submit one entry per look.
pub(crate) const MAX_TRAJECTORY_POSES: usize = 10_000;
/// Most entries of a submission's trajectories together.
pub(crate) const MAX_POSES_IN_MEMORY: usize = 4_000_000;
/// Most problems of a submission that are listed one by one. The others are only counted.
pub(crate) const MAX_LISTED_PROBLEMS: usize = 1_000;

/// A limit as errors write it, with commas between groups of three digits.
pub(crate) fn group_digits(limit: usize) -> String {
    let digits = limit.to_string();
    let groups: Vec<_> = digits.as_bytes().rchunks(3).rev().map(String::from_utf8_lossy).collect();
    groups.join(",")
}

/// What is said of a file with more than [`MAX_FILE_BYTES`], packed or unpacked.
pub(crate) const TOO_LARGE: &str = "it is larger than 1 GiB";
/// What to do about it.
pub(crate) const SPLIT_HINT: &str = "split it into parts";
