//! Poses without a valid orientation, and quaternions that are no longer those of a rotation.

use super::rows::{PoseFacing, PoseRow, PoseRows};
use crate::axes::{is_rotation, quaternion_length};

/// How far the length of a quaternion may be from 1: files have few digits.
const LENGTH_SLACK: f64 = 0.1;

/// What becomes of the poses without an orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum UnturnedUse {
    /// Few poses have none, and are left out.
    LeftOut,
    /// Most poses have none: their positions are used.
    PositionsOnly,
}

impl UnturnedUse {
    /// By the number of poses without an orientation, among all.
    pub(crate) const fn for_counts(unturned: usize, all: usize) -> Self {
        if unturned * 2 > all { Self::PositionsOnly } else { Self::LeftOut }
    }

    /// What becomes of them, for the user.
    pub(crate) const fn words(self) -> &'static str {
        match self {
            Self::LeftOut => "these are left out",
            Self::PositionsOnly => {
                "only their positions are used, and there the camera counts as looking along the path"
            }
        }
    }
}

/// Leaves out the poses without a valid orientation, or, where most have none, their orientation. Returns what the user is told of
/// them, and of quaternions that are read although their length is not 1.
pub(super) fn settle_orientations(rows: &mut PoseRows) -> Vec<String> {
    let all = rows.rows.len();
    let mut told = Vec::new();
    let count_where = |rows: &PoseRows, is_wanted: &dyn Fn(&PoseRow) -> bool| {
        let first = rows.rows.iter().find(|row| is_wanted(row)).map(|row| (rows.name_row(row), row.facing));
        first.map(|first| (rows.rows.iter().filter(|row| is_wanted(row)).count(), first))
    };
    if let Some((unturned, (first, _))) = count_where(rows, &|row| is_no_orientation(row.facing)) {
        let becomes = UnturnedUse::for_counts(unturned, all);
        match becomes {
            UnturnedUse::LeftOut => _ = rows.retain_rows(|row| !is_no_orientation(row.facing)),
            UnturnedUse::PositionsOnly => {
                let unturned = rows.rows.iter_mut().filter(|row| is_no_orientation(row.facing));
                unturned.for_each(|row| row.facing = PoseFacing::Unknown);
            }
        }
        told.push(format!(
            "{unturned} of {all} poses have an orientation that is none, such as 0 0 0 0 or nan (the first in {first}): {}",
            becomes.words()
        ));
    }
    if let Some((odd, (first, PoseFacing::Quaternion(quaternion)))) = count_where(rows, &|row| is_odd(row.facing)) {
        told.push(format!(
            "{odd} of {all} quaternions have another length than 1, as none of a rotation has (in {first} {:.2}): they are read as \
             if they had it; check that these are the columns of a quaternion",
            quaternion_length(quaternion)
        ));
    }
    told
}

/// Whether a pose gives an orientation that is none.
fn is_no_orientation(facing: PoseFacing) -> bool {
    match facing {
        PoseFacing::Unknown => false,
        PoseFacing::Quaternion(quaternion) => !is_rotation(quaternion),
        PoseFacing::Columns(columns) => !columns.iter().all(|column| column.is_finite()),
        PoseFacing::Yaw(angle) | PoseFacing::Heading(angle) => !angle.is_finite(),
    }
}

/// Whether a quaternion is not that of a rotation by its length.
fn is_odd(facing: PoseFacing) -> bool {
    matches!(facing, PoseFacing::Quaternion(quaternion) if (quaternion_length(quaternion) - 1.0).abs() > LENGTH_SLACK)
}

#[cfg(test)]
mod tests {
    use crate::{describe::RecordingDescription, poses::read_track};

    /// What is told of a pose file with these orientations, and the number of poses that have one.
    fn told(name: &str, text: &str) -> (String, usize) {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        let times_s: Vec<f64> = (0..10).map(f64::from).collect();
        let track = read_track(&file, &RecordingDescription::default(), &times_s, &|at| format!("{at}.png")).unwrap();
        let turned = times_s.iter().filter(|time_s| track.fix_at(**time_s).is_some_and(|fix| fix.heading.is_some()));
        (track.unread().unwrap_or_default().to_owned(), turned.count())
    }

    fn csv(columns: &str, facing: &dyn Fn(usize) -> String) -> String {
        let rows = (0..10).map(|at| format!("{at},{at},0,1.5,{}\n", facing(at)));
        format!("time_s,x,y,z,{columns}\n{}", rows.collect::<String>())
    }

    #[test]
    fn poses_without_an_orientation_are_counted_and_their_use_is_told() {
        let quaternions = |none: &'static str, from: usize| {
            csv("qx,qy,qz,qw", &move |at| if at >= from { none.to_owned() } else { "0,0,0,1".to_owned() })
        };
        for none in ["0,0,0,0", "nan,nan,nan,nan", "0,0,inf,1"] {
            let (all, turned) = told("poses.csv", &quaternions(none, 0));
            assert!(all.contains("10 of 10 poses have an orientation that is none"), "{all}");
            assert!(all.contains("the first in line 2") && all.contains("looking along the path"), "{all}");
            assert_eq!(turned, 0);
            let (some, turned) = told("poses.csv", &quaternions(none, 7));
            assert!(some.contains("3 of 10 poses") && some.contains("these are left out"), "{some}");
            assert_eq!(turned, 7);
        }
        assert_eq!(told("poses.csv", &quaternions("", 10)).0, "");
        let tum: String = (0..10).map(|at| format!("{at} {at} 0 1.5 0 0 0 0\n")).collect();
        assert!(told("poses.tum", &tum).0.contains("10 of 10 poses"));
        let yaw = csv("yaw_rad", &|at| if at < 2 { "nan".to_owned() } else { "0".to_owned() });
        assert!(told("poses.csv", &yaw).0.contains("2 of 10 poses"));
        let item =
            |at: usize| format!(r#"{{"time_s": {at}, "position": [{at}, 0, 1.5], "orientation": [0, 0, 0, 0]}}"#);
        let json = format!("[{}]", (0..10).map(item).collect::<Vec<_>>().join(","));
        let (json, _) = told("poses.json", &json);
        assert!(json.contains("10 of 10 poses") && json.contains("the first in pose 0"), "{json}");
    }

    #[test]
    fn quaternions_of_another_length_are_told() {
        let long = csv("qx,qy,qz,qw", &|at| if at < 4 { "0,0,0,2".to_owned() } else { "0,0,0,1.02".to_owned() });
        let (told_of_it, turned) = told("poses.csv", &long);
        assert!(told_of_it.contains("4 of 10 quaternions have another length than 1"), "{told_of_it}");
        assert!(told_of_it.contains("in line 2 2.00"), "{told_of_it}");
        assert_eq!(turned, 10);
    }
}
