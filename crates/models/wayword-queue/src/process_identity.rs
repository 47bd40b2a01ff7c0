//! Names a process so that another process of the same machine can find out whether it still lives.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};
use std::{fs, process};

/// A process of a machine. On systems without `/proc` the place is empty, and no process is ever known to be gone.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProcessIdentity {
    /// The name of its machine, to be shown.
    pub host: String,
    /// Identifies the machine, its boot and its container, because process numbers are unique only within these.
    pub place: String,
    /// The number of the process.
    pub pid: u32,
    /// The start time of the process in its machine's units, to recognise another process with the same number.
    pub began: String,
}

impl ProcessIdentity {
    /// This process.
    #[must_use]
    pub fn this_process() -> Self {
        Self::beside_this(process::id())
    }

    /// The process of this number on this machine. Its start is empty if there is none.
    #[must_use]
    pub fn beside_this(pid: u32) -> Self {
        let read = |path: &str| fs::read_to_string(path).unwrap_or_default().trim().to_owned();
        let pid_namespace = fs::read_link("/proc/self/ns/pid").unwrap_or_default();
        let boot = read("/proc/sys/kernel/random/boot_id");
        let place = if boot.is_empty() { String::new() } else { format!("{boot} {}", pid_namespace.display()) };
        Self { host: read("/proc/sys/kernel/hostname"), place, pid, began: process_start(pid).unwrap_or_default() }
    }

    /// Whether both processes have their numbers from the same list, so that one can look for the other.
    #[must_use]
    pub fn is_beside(&self, other: &Self) -> bool {
        !self.place.is_empty() && self.place == other.place
    }

    /// Whether it is known that this process has ended. Of a process of another machine that is never known.
    #[must_use]
    pub fn has_ended(&self) -> bool {
        self.is_beside(&Self::this_process()) && !self.began.is_empty() && !self.lives_here()
    }

    /// Whether a process of this machine has this number and start time.
    #[must_use]
    pub fn lives_here(&self) -> bool {
        process_start(self.pid).as_ref() == Some(&self.began)
    }

    /// A short word for the place; equal places have equal words.
    pub(crate) fn place_word(&self) -> String {
        Sha256::digest(&self.place).iter().take(4).map(|byte| format!("{byte:02x}")).collect()
    }
}

/// The start time of a process of this machine; `None` if there is no process of this number, or it has ended and only its
/// parent has not noticed.
pub(crate) fn process_start(pid: u32) -> Option<String> {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name of the program comes second, in brackets, and may hold anything.
    let (_, fields) = stat.rsplit_once(')')?;
    let mut fields = fields.split_whitespace();
    if matches!(fields.next()?, "Z" | "X") {
        return None;
    }
    // The start time is field 22 of the file (man proc_pid_stat), and the state is number 3.
    fields.nth(18).map(str::to_owned)
}

#[cfg(test)]
#[cfg(target_os = "linux")]
mod tests {
    use super::*;
    use std::process::Command;

    #[test]
    fn only_a_process_of_this_machine_is_known_to_have_ended() {
        let this = ProcessIdentity::this_process();
        assert!(!this.has_ended() && this.lives_here());
        let mut child = Command::new("sleep").arg("60").spawn().unwrap();
        let other = ProcessIdentity::beside_this(child.id());
        assert!(!other.has_ended());
        child.kill().unwrap();
        // Also before its parent has asked for its end.
        while !other.has_ended() {
            std::thread::yield_now();
        }
        child.wait().unwrap();
        assert!(other.has_ended());
        let elsewhere = ProcessIdentity { place: "another".into(), ..other.clone() };
        let nowhere = ProcessIdentity { place: String::new(), ..other.clone() };
        assert!(!elsewhere.has_ended() && !nowhere.has_ended());
        let other_with_same_number = ProcessIdentity { began: "0".into(), ..this.clone() };
        assert!(other_with_same_number.has_ended());
        assert_eq!(this.place_word(), other.place_word());
        assert_ne!(this.place_word(), elsewhere.place_word());
    }
}
