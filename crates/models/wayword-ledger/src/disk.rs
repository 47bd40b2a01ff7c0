//! Recognises network file systems. SQLite's write-ahead log needs memory and locks that all programs with the file
//! open share. Over a network neither is reliable, so a ledger could be lost.
//!
//! The check uses `statfs` and works on Linux alone; on other systems every place is accepted.

use std::path::Path;

/// The `statfs` type numbers of network and cluster file systems, with their common names.
const NETWORK_FILE_SYSTEM_TYPES: [(u32, &str); 20] = [
    (0x0000_6969, "NFS"),
    (0x0bd0_0bd0, "Lustre"),
    (0x4750_4653, "GPFS"),
    (0x1983_0326, "BeeGFS"),
    (0xff53_4d42, "CIFS"),
    (0xfe53_4d42, "SMB"),
    (0x0000_517b, "SMB"),
    (0x00c3_6400, "Ceph"),
    (0x5346_414f, "AFS"),
    (0x6b41_4653, "AFS"),
    (0x2003_0528, "OrangeFS"),
    (0xaad7_aaea, "PanFS"),
    (0x0116_1970, "GFS2"),
    (0x7461_636f, "OCFS2"),
    (0x7375_7245, "Coda"),
    (0x0000_564c, "NCP"),
    (0xbeef_dead, "SNFS"),
    // Folders of a host that a virtual machine sees.
    (0x786f_4256, "vboxsf"),
    (0xbacb_acbc, "vmhgfs"),
    (0x7c7c_6673, "prl_fs"),
];

/// The `statfs` type number that all FUSE file systems share. They are served by programs, and the type of the mount distinguishes them.
const FUSE_TYPE_NUMBER: u32 = 0x6573_5546;

/// Mount types of FUSE network file systems, without `fuse.`. Any other type counts as local, as encrypted folders and
/// NTFS are. 9p counts as local too, because sandboxes and virtual machines use it for the machine's own disk.
const FUSE_NETWORK_TYPES: [&str; 19] = [
    "sshfs",
    "glusterfs",
    "ceph",
    "ceph-fuse",
    "beegfs",
    "moosefs",
    "mfs",
    "lizardfs",
    "juicefs",
    "cvmfs2",
    "s3fs",
    "goofys",
    "geesefs",
    "gcsfuse",
    "blobfuse2",
    "rclone",
    "davfs2",
    "curlftpfs",
    "smbnetfs",
];

/// The name of the network file system that a path is on, or would be on. `None` on this machine's own disks, and where
/// the program cannot find out.
#[must_use]
pub fn network_at(path: &Path) -> Option<&'static str> {
    let path = std::path::absolute(path).ok()?;
    // A path that does not exist yet will be on the same file system as its nearest existing folder.
    let existing = path.ancestors().find(|ancestor| ancestor.exists())?;
    system::network_at(existing)
}

/// The name of a network file system, from its type number and, for FUSE, from the type of its mount.
fn network_file_system(number: u32, mounted_as: Option<&str>) -> Option<&'static str> {
    if number != FUSE_TYPE_NUMBER {
        return NETWORK_FILE_SYSTEM_TYPES.iter().find(|(known, _)| *known == number).map(|(_, name)| *name);
    }
    let served = mounted_as.map(|name| name.strip_prefix("fuse.").unwrap_or(name))?;
    FUSE_NETWORK_TYPES.iter().find(|known| **known == served).copied()
}

#[cfg(target_os = "linux")]
mod system {
    use super::{FUSE_TYPE_NUMBER, network_file_system};
    use std::{fs, os::unix::fs::MetadataExt, path::Path};

    pub(super) fn network_at(path: &Path) -> Option<&'static str> {
        let number = rustix::fs::statfs(path).ok()?.f_type as u32;
        let mounts =
            if number == FUSE_TYPE_NUMBER { fs::read_to_string("/proc/self/mountinfo").ok()? } else { String::new() };
        let device = fs::metadata(path).ok()?.dev();
        network_file_system(number, mounted_as(&mounts, rustix::fs::major(device), rustix::fs::minor(device)))
    }

    /// The type of the mount of a device, as `/proc/self/mountinfo` gives it.
    pub(super) fn mounted_as(mounts: &str, major: u32, minor: u32) -> Option<&str> {
        let device = format!("{major}:{minor}");
        let is_for_device = |line: &&str| line.split(' ').nth(2) == Some(&device);
        mounts.lines().find(is_for_device)?.split_once(" - ")?.1.split(' ').next()
    }
}

#[cfg(not(target_os = "linux"))]
mod system {
    use std::path::Path;

    pub(super) fn network_at(_: &Path) -> Option<&'static str> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_systems_of_networks_are_known_by_their_numbers() {
        for (number, name) in [
            (0x6969, "NFS"),
            (0x0bd0_0bd0, "Lustre"),
            (0x4750_4653, "GPFS"),
            (0x1983_0326, "BeeGFS"),
            (0xff53_4d42, "CIFS"),
        ] {
            assert_eq!(network_file_system(number, None), Some(name));
        }
        let (ext4, xfs, btrfs, tmpfs, overlay, p9) =
            (0xef53, 0x5846_5342, 0x9123_683e, 0x0102_1994, 0x794c_7630, 0x0102_1997);
        for local in [ext4, xfs, btrfs, tmpfs, overlay, p9] {
            assert_eq!(network_file_system(local, None), None, "{local:x}");
        }
    }

    #[test]
    fn fuse_file_systems_are_known_by_their_mounts() {
        assert_eq!(network_file_system(FUSE_TYPE_NUMBER, Some("fuse.sshfs")), Some("sshfs"));
        for local in [Some("fuse.gocryptfs"), Some("fuseblk"), Some("virtiofs"), None] {
            assert_eq!(network_file_system(FUSE_TYPE_NUMBER, local), None, "{local:?}");
        }
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn the_type_of_a_mount_is_read_by_its_device() {
        let mounts = "36 35 98:0 /mnt1 /mnt2 rw,noatime master:1 - ext3 /dev/root rw\n\
                      40 35 0:52 / /home/me/far rw,nosuid shared:2 shared:9 - fuse.sshfs me@far:/home rw,user_id=0\n";
        assert_eq!(system::mounted_as(mounts, 0, 52), Some("fuse.sshfs"));
        assert_eq!(system::mounted_as(mounts, 98, 0), Some("ext3"));
        assert_eq!(system::mounted_as(mounts, 0, 53), None);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_path_that_is_not_there_yet_is_looked_for_in_the_nearest_folder() {
        assert_eq!(network_at(Path::new("/proc/no/such/folder/ledger.db")), None);
        assert_eq!(network_at(Path::new("ledger.db")), network_at(&std::env::current_dir().unwrap()));
    }
}
