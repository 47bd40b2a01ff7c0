//! How much of an untrusted file is believed.

/// Largest file, in bytes: as it lies on the disk, and again after gunzip.
pub(crate) const FILE_BYTES: u64 = 1 << 30;
/// Most items in a file.
pub(crate) const ITEMS: usize = 1_000_000;
/// Most JSON values within one item; without it, a small file of zeros becomes a tree forty times its size.
pub(crate) const VALUES_PER_ITEM: usize = 200_000;
/// Most JSON values that are held of a whole file (or of files that are merged).
pub(crate) const VALUES_KEPT: usize = 20_000_000;
/// Longest line of a JSON Lines file, bytes; the texts of one item of a JSON list hold no more either.
pub(crate) const LINE_BYTES: usize = 16 << 20;
/// Longest JSON text or number of a file, bytes: fifty times the longest instruction.
pub(crate) const TOKEN_BYTES: usize = 1 << 20;
/// Most nodes or positions of one path.
pub(crate) const PATH_NODES: usize = 1_000;
/// Longest instruction, bytes. A writer's is not longer either: what a run writes can be read again.
pub(crate) const INSTRUCTION_BYTES: usize = wayword_core::LONGEST_TEXT_BYTES;
/// Most instructions of one item.
pub(crate) const INSTRUCTIONS: usize = 1_000;
/// Longest name (of a path, an item, a split), bytes.
pub(crate) const NAME_BYTES: usize = 128;
/// Most entries of one submitted trajectory; agents that look around hand in one per look.
pub(crate) const TRAJECTORY_POSES: usize = 10_000;
/// Most entries of a submission's trajectories together.
pub(crate) const POSES_KEPT: usize = 4_000_000;
/// Most problems of a submission that are told one by one.
pub(crate) const PROBLEMS: usize = 1_000;
