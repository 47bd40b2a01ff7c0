//! Ten episodes in the made-up building: paths with instructions in the style of REVERIE and R2R, and the two JSON files that
//! hold them.

use crate::test_house::{SCAN, viewpoint_id};
use serde_json::{Value, json};

/// A path in the building, with its texts in both styles.
struct TestHouseEpisode {
    /// The viewpoints, by their indices in [`crate::test_house::VIEWPOINTS`].
    path: &'static [usize],
    /// The heading at the start, radians.
    heading: f64,
    /// The target of the REVERIE texts, by its index in [`crate::test_house::OBJECTS`].
    object: usize,
    /// Short instructions that end in a task, as REVERIE has them.
    reverie: [&'static str; 2],
    /// Step-by-step instructions, as R2R has them.
    r2r: [&'static str; 2],
}

/// All episodes. Their numbers in the files are 100, 101 and so on.
const EPISODES: [TestHouseEpisode; 10] = [
    TestHouseEpisode {
        path: &[0, 1, 6, 7, 8, 9, 10],
        heading: 0.0,
        object: 27,
        reverie: [
            "Go upstairs to the bedroom and fluff the pillow that is closer to the door",
            "Head to the bedroom on level 2 and straighten the pillow at the near end of the bed",
        ],
        r2r: [
            "Leave the entryway and follow the hallway to the stairs. Climb them, turn back at the top and walk down the upper hall. Stop just inside the bedroom.",
            "Walk past the console table and go up the stairs. Pass the vase, keep to the hall, and enter the bedroom on the right.",
        ],
    },
    TestHouseEpisode {
        path: &[11, 10, 9, 8, 7, 6, 1],
        heading: 3.1,
        object: 6,
        reverie: [
            "Go down to the hallway on level 1 and dust the console table",
            "Walk downstairs and clear the table opposite the two pictures",
        ],
        r2r: [
            "Walk out of the bedroom and turn left along the hall. Take the stairs down and wait beside the console table.",
            "Pass the foot of the bed and leave the room. Turn left, go down the stairs and stop between the two pictures.",
        ],
    },
    TestHouseEpisode {
        path: &[3, 2, 1, 6, 7, 8, 12],
        heading: 4.6,
        object: 34,
        reverie: [
            "Go to the bathroom on the second floor and wipe the mirror",
            "Head upstairs to the bathroom and check whether the mirror hangs straight",
        ],
        r2r: [
            "Leave the living room with the tv behind you and cross the hallway to the stairs. Go up and enter the bathroom at the top.",
            "Walk past the couch and out into the hallway. Climb the stairs, turn right at the top and stop near the towels.",
        ],
    },
    TestHouseEpisode {
        path: &[13, 9, 8, 7, 6, 1, 4],
        heading: 1.5,
        object: 16,
        reverie: [
            "Go down to the kitchen and turn off the tap of the sink",
            "Walk to the kitchen on level 1 and empty the sink",
        ],
        r2r: [
            "Go out of the office and straight along the hall to the stairs. Walk down, reach the console table and turn right into the kitchen.",
            "Leave the desk behind you and follow the hall past the plant. Descend the stairs and stop in the kitchen beside the sink.",
        ],
    },
    TestHouseEpisode {
        path: &[5, 4, 1, 0, 2],
        heading: 2.2,
        object: 9,
        reverie: [
            "Go to the living room and switch on the lamp in the corner",
            "Walk to the living room and dust the lamp near the cushions",
        ],
        r2r: [
            "Leave the kitchen past the microwave and follow the hallway to the entryway. Turn right into the living room and stop by the lamp.",
            "Walk past the dining table and out of the kitchen. Go to the coat rack, turn right and wait next to the couch.",
        ],
    },
    TestHouseEpisode {
        path: &[2, 0, 1, 4, 5],
        heading: 5.9,
        object: 15,
        reverie: [
            "Go to the kitchen and close the door of the refrigerator",
            "Walk to the far end of the kitchen and open the refrigerator",
        ],
        r2r: [
            "Walk out to the entryway and turn left down the hallway. Enter the kitchen on the left, pass the dining table and stop at the refrigerator.",
            "Leave the cushions and turn left at the bench. Go along the hallway and into the kitchen, and wait near the stove.",
        ],
    },
    TestHouseEpisode {
        path: &[12, 8, 7, 6, 1, 0],
        heading: 0.8,
        object: 1,
        reverie: [
            "Go down to the entryway and pull the bench away from the wall",
            "Return to the entryway on level 1 and sweep under the bench",
        ],
        r2r: [
            "Leave the bathroom and take the stairs down. Go straight along the hallway until you stand in the entryway next to the bench.",
            "Walk out past the vase and descend the stairs. Continue beyond the pictures and stop by the coat rack.",
        ],
    },
    TestHouseEpisode {
        path: &[11, 10, 9, 8, 12],
        heading: 1.1,
        object: 35,
        reverie: [
            "Go to the bathroom and fold the towel on the left",
            "Walk to the bathroom on level 2 and take down the left towel",
        ],
        r2r: [
            "Walk out of the bedroom and turn left along the hall. Turn left again and stop in the bathroom facing the towels.",
            "Leave the dresser behind, pass the bed and go into the hall. Walk by the picture and enter the bathroom.",
        ],
    },
    TestHouseEpisode {
        path: &[6, 7, 8, 9, 13],
        heading: 6.1,
        object: 40,
        reverie: [
            "Go up to the office and load paper into the printer",
            "Head upstairs to the office and unplug the printer",
        ],
        r2r: [
            "Climb the stairs and turn around at the top. Walk straight down the hall and into the office, and stop beside the desk.",
            "Go up past the picture and follow the upper hall to its end. Wait in the office near the bookshelf.",
        ],
    },
    TestHouseEpisode {
        path: &[1, 6, 7, 8, 9, 10, 11],
        heading: 2.9,
        object: 29,
        reverie: [
            "Go to the bedroom upstairs and open the drawer of the nightstand close to the bed",
            "Walk up to the bedroom and tidy the nightstand beside the pillow",
        ],
        r2r: [
            "Take the stairs up and turn around at the top. Follow the hall, enter the bedroom on the right and stop in front of the window.",
            "Leave the console table and climb the stairs. Pass the plant, go into the bedroom and walk beyond the bed to the dresser.",
        ],
    },
];

/// The names of the viewpoints of an episode's path.
fn path_ids(episode: &TestHouseEpisode) -> Vec<String> {
    episode.path.iter().map(|index| viewpoint_id(*index)).collect()
}

/// The contents of `REVERIE_*.json` in the form of the release of 2022.
pub(crate) fn reverie_file() -> Value {
    let item = |(number, episode): (usize, &TestHouseEpisode)| {
        let path_id = 100 + number;
        json!({
            "id": format!("{path_id}_{}", episode.object),
            "path": path_ids(episode),
            "objId": episode.object,
            "instructions": episode.reverie,
            "heading": episode.heading,
            "scan": SCAN,
            "path_id": path_id,
        })
    };
    EPISODES.iter().enumerate().map(item).collect()
}

/// The contents of `R2R_*.json`.
pub(crate) fn r2r_file() -> Value {
    let item = |(number, episode): (usize, &TestHouseEpisode)| {
        json!({
            "distance": 10.0,
            "scan": SCAN,
            "path_id": 100 + number,
            "path": path_ids(episode),
            "heading": episode.heading,
            "instructions": episode.r2r,
        })
    };
    EPISODES.iter().enumerate().map(item).collect()
}
