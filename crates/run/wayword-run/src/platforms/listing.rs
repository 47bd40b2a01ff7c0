//! The list of all platforms, for `wayword platforms` and for the names that `--platform` takes.

/// A platform, as `wayword platforms` lists it.
#[derive(Debug, Clone, Copy, serde::Serialize)]
pub struct PlatformListing {
    /// Its name, as `--platform` takes it.
    pub name: &'static str,
    /// A short description.
    pub what: &'static str,
    /// The data or address that it needs.
    pub needs: &'static str,
    /// The pictures and labels that it offers.
    pub offers: &'static str,
    /// Whether this build has it.
    pub is_here: bool,
}

/// All platforms, in this build or not.
pub const PLATFORMS: [PlatformListing; 7] = [
    PlatformListing {
        name: "house",
        what: "generated homes, built in",
        needs: "nothing",
        offers: "pictures, labels, rooms, storeys",
        is_here: true,
    },
    PlatformListing {
        name: "matterport",
        what: "Matterport3D's buildings, from files",
        needs: "--data DIR with connectivity/ (docs/DATA.md lists what else is used)",
        offers: "rooms, storeys; labels with REVERIE's boxes or .house files; pictures with photographs",
        is_here: true,
    },
    PlatformListing {
        name: "process",
        what: "any simulator in any language, as a child process (docs/PROCESS.md)",
        needs: "--data FILE: a world file, or the program itself",
        offers: "what that program says it offers",
        is_here: true,
    },
    PlatformListing {
        name: "habitat",
        what: "AI Habitat's scenes, without Habitat",
        needs: "--data FILE or DIR: .glb, .gltf or .stage_config.json, with the .navmesh beside it or baked; or --connectivity DIR of viewpoint graphs",
        offers: "pictures, geodesic paths or paths along the graphs; labels and rooms with semantic files",
        is_here: cfg!(feature = "habitat"),
    },
    PlatformListing {
        name: "tdw",
        what: "ThreeDWorld: waits for a build to connect",
        needs: "a TDW build started with -port 1071, or another as in --at 127.0.0.1:1072; --data PACKAGE for furnished floor plans",
        offers: "pictures; labels of furniture, only in furnished plans (floorplan_1a_0)",
        is_here: cfg!(feature = "live"),
    },
    PlatformListing {
        name: "virtualhome",
        what: "VirtualHome's executable, while it runs",
        needs: "its HTTP address, as in --at http://127.0.0.1:8080 (the default)",
        offers: "pictures, labels, rooms",
        is_here: cfg!(feature = "live"),
    },
    PlatformListing {
        name: "recording",
        what: "recordings of robots: folders of pictures, MP4, MCAP, LeRobot datasets",
        needs: match (cfg!(feature = "mcap"), cfg!(all(feature = "lerobot", feature = "video"))) {
            (true, true) => {
                "--data FILE or DIR, with poses in it or beside it for turns and distances (docs/RECORDINGS.md)"
            }
            (true, false) => {
                "--data DIR of pictures or MCAP, with poses in it or beside it for turns and distances (docs/RECORDINGS.md); MP4 and LeRobot may need the feature full"
            }
            _ => {
                "--data DIR of pictures, with poses beside them for turns and distances (docs/RECORDINGS.md); other recordings may need the feature full"
            }
        },
        offers: "pictures along the recorded path and no labels, so --see has to name a model",
        is_here: true,
    },
];

/// The names of all platforms, as `--platform` takes them.
pub(crate) fn platform_names() -> [&'static str; PLATFORMS.len()] {
    PLATFORMS.map(|platform| platform.name)
}
