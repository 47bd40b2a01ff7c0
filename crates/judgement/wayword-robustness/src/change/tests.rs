use super::*;
use std::collections::BTreeSet;

const HOUSE: ChangeSetting<'static> = ChangeSetting {
    platform: "house",
    sees: SightSource::Labels,
    has_poses: true,
    can_render: true,
    is_graph_bound: false,
};
const MATTERPORT: ChangeSetting<'static> =
    ChangeSetting { platform: "matterport", can_render: false, is_graph_bound: true, ..HOUSE };
const RECORDING: ChangeSetting<'static> = ChangeSetting {
    platform: "recording",
    sees: SightSource::Pictures,
    can_render: false,
    is_graph_bound: false,
    ..HOUSE
};

fn one(text: &str) -> Change {
    text.parse().unwrap()
}

fn refused(text: &str) -> String {
    Change::parse_list(text).unwrap_err().to_string()
}

#[test]
fn a_list_of_numbers_is_one_change_each() {
    let heights = Change::parse_list(" camera_height_m = 0.3, 0.88,1.6").unwrap();
    assert_eq!(heights, [0.3, 0.88, 1.6].map(|height| Change::By(DoseKind::CameraHeight, height)));
    assert_eq!(Change::parse_list("mirror").unwrap(), [Change::Whole(WholeChange::Mirror)]);
    let spec = "habitat:/data/a,b=c@1.2.3.4:5";
    assert_eq!(Change::parse_list(&format!("platform={spec}")).unwrap(), [Change::Platform(spec.to_owned())]);
}

#[test]
fn parse_errors_name_the_range_and_an_example() {
    assert_eq!(refused("blur_px"), "blur_px needs a number between 0 and 40 px, as in blur_px=1,2,4");
    assert_eq!(refused("mirror=1"), "mirror has no number, and \"1\" was given: write just mirror");
    let text = "blur_px: \"\" is not a number; give numbers between 0 and 40 px, as in blur_px=1,2,4";
    assert_eq!(refused("blur_px=1,"), text);
    assert_eq!(refused("blur_px=41"), "blur_px: 41 is not between 0 and 40 px; give numbers as in blur_px=1,2,4");
    assert_eq!(refused("blur_px=1,1.0"), "blur_px: 1 is given twice; leave one out");
    assert!(refused("jpeg_quality_percent=50.5").contains("50.5 is not a whole number"));
    assert!(refused("blur_px=nan").contains("\"nan\" is not a number"));
    assert!(refused("blurr_px=1").contains("there is no change \"blurr_px\"; there are platform, mirror"));
    assert!(refused("platform=").contains("as in platform=habitat"));
    assert!("blur_px=1,2".parse::<Change>().unwrap_err().to_string().contains("2 changes where one"));
}

#[test]
fn every_example_is_in_range_and_every_change_is_its_own_text() {
    let examples = DoseKind::ALL
        .into_iter()
        .flat_map(|dose| Change::parse_list(&format!("{}={}", dose.name(), dose.example_values())).unwrap());
    let whole = WholeChange::ALL.into_iter().map(Change::Whole);
    let others = ["platform=habitat", "platform=habitat:/a", "platform=habitat:/b", "pitch_deg=20"].map(one);
    let all: Vec<Change> = examples.chain(whole).chain(others).collect();
    for change in &all {
        assert_eq!(one(&change.to_string()), *change);
        assert_eq!(serde_json::from_str::<Change>(&serde_json::to_string(change).unwrap()).unwrap(), *change);
        assert!(change.describe_effect().ends_with('.'));
        let is_safe = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "-.".contains(c);
        assert!(change.id().chars().all(is_safe), "{}", change.id());
    }
    let ids: BTreeSet<String> = all.iter().map(Change::id).collect();
    assert_eq!(ids.len(), all.len(), "{ids:?}");
    assert_eq!(one("camera_height_m=0.3").id(), "camera-height-m-0.3");
    assert_eq!(one("pitch_deg=-20").id(), "pitch-deg-minus-20");
    assert_eq!(one("platform=habitat").id(), "platform-habitat");
}

#[test]
fn the_unchanged_dose_is_in_range_and_has_no_strength() {
    for dose in DoseKind::ALL {
        let (low, high) = dose.value_range();
        let Some(unchanged) = dose.unchanged_value() else { continue };
        assert!((low..=high).contains(&unchanged), "{dose:?}");
        assert_eq!(Change::By(dose, unchanged).dose_strength(), Some(0.0));
    }
    assert_eq!(one("jpeg_quality_percent=1").dose_strength(), Some(1.0));
    assert_eq!(one("blur_px=10").dose_strength(), Some(0.25));
    assert_eq!(one("frame_spacing_m=1").dose_strength(), None);
}

#[test]
fn the_default_set_can_be_made_where_everything_is_drawn() {
    assert_eq!(Change::default_set().len(), 16);
    for change in Change::default_set() {
        assert_eq!(change.refusal_reason(&HOUSE), None);
        assert_eq!(one(&change.to_string()), change);
    }
}

#[test]
fn refusal_of_picture_changes_with_labels() {
    for text in
        ["blur_px=1", "noise_percent=1", "jpeg_quality_percent=9", "exposure_stops=1", "colour_temperature_k=3000"]
    {
        assert!(one(text).refusal_reason(&HOUSE).unwrap().contains("labels are not read from pictures"), "{text}");
        for sees in [SightSource::Eye, SightSource::Pictures] {
            assert_eq!(one(text).refusal_reason(&ChangeSetting { sees, ..HOUSE }), None, "{text}");
        }
    }
    for text in ["remove", "add", "material"] {
        assert!(
            one(text)
                .refusal_reason(&ChangeSetting { sees: SightSource::Pictures, ..HOUSE })
                .unwrap()
                .contains("not the pictures")
        );
        assert_eq!(one(text).refusal_reason(&ChangeSetting { sees: SightSource::Eye, ..RECORDING }), None);
    }
}

#[test]
fn fixed_pictures_have_the_camera_that_took_them() {
    for text in ["camera_height_m=1", "field_of_view_deg=60", "pitch_deg=5", "roll_deg=5"] {
        for there in [MATTERPORT, RECORDING] {
            assert!(one(text).refusal_reason(&there).unwrap().contains("taken before"), "{text}");
        }
        assert_eq!(one(text).refusal_reason(&HOUSE), None);
    }
    assert!(one("reverse").refusal_reason(&RECORDING).unwrap().contains("the way back"));
    assert!(one("start_heading_deg=90").refusal_reason(&RECORDING).unwrap().contains("other directions"));
    assert_eq!(one("reverse").refusal_reason(&MATTERPORT), None);
    let finer = one("frame_spacing_m=1").refusal_reason(&MATTERPORT).unwrap();
    assert_eq!(
        finer,
        "frame_spacing_m=1 means nothing here: platform matterport has views only from viewpoints, about 2.25 m apart, so that frames can be left out but not put between"
    );
    assert_eq!(one("frame_spacing_m=3").refusal_reason(&MATTERPORT), None);
}

#[test]
fn refusal_of_changes_that_need_poses_without_poses() {
    let blind = ChangeSetting { has_poses: false, ..RECORDING };
    for text in [
        "platform=house",
        "mirror",
        "turn",
        "reverse",
        "frame_spacing_m=3",
        "heading_noise_deg=5",
        "start_heading_deg=5",
    ] {
        assert!(one(text).refusal_reason(&blind).unwrap().contains("no poses"), "{text}");
    }
    assert_eq!(one("dropped_frames_percent=10").refusal_reason(&blind), None);
    assert_eq!(one("blur_px=2").refusal_reason(&blind), None);
}
