//! Made-up instructions, paths and a building for tests, so that every figure can be worked out by hand.

use crate::stage::MeasuredWorldArgs;
use std::path::PathBuf;
use tempfile::TempDir;
use wayword_core::{
    DVec3, Heading, Instruction, MentionKind, Path, PathMotion, PathRequest, Platform, SceneId, TextMention,
    TextProvenance, Verdict, path::PathStop,
};
use wayword_formats::jsonl::InstructionRecord;
use wayword_house::HousePlatform;

/// An instruction that passed. Each mention is given by its words, which are searched from the end of the last mention.
pub(crate) fn test_instruction(style: &str, text: &str, mentions: &[(&str, MentionKind)]) -> Instruction {
    let mut from = 0;
    let mentions = mentions.iter().map(|(words, kind)| {
        let start = from + text[from..].find(words).unwrap();
        from = start + words.len();
        TextMention { span: [start, from], kind: *kind, frame: 0 }
    });
    let by = |name: &str| name.to_owned();
    Instruction {
        text: text.to_owned(),
        style: style.to_owned(),
        mentions: mentions.collect(),
        parts: Vec::new(),
        verdict: Verdict::Pass,
        findings: Vec::new(),
        ambiguity: None,
        provenance: TextProvenance {
            wayword: by("test"),
            asker: by("rules"),
            answerer: by("labels"),
            detector: None,
            summariser: by("rules"),
            writer: by("rules"),
            checked_against: by("labels"),
            seed: 0,
            style_hash: String::new(),
            prompts_hash: None,
            repairs: 0,
            finished_for: None,
            chosen: None,
            drafts: Vec::new(),
            refined: Vec::new(),
            target_undescribed: false,
        },
    }
}

/// Four metres north, then four to the west: straight ahead, and one left turn. On the lowest storey.
pub(crate) fn test_path(id: &str) -> Path {
    let stop = |x, y| PathStop { position: DVec3::new(x, y, 1.5), viewpoint: None, level: Some(1) };
    let stops = vec![stop(0.0, 0.0), stop(0.0, 4.0), stop(-4.0, 4.0)];
    Path {
        id: id.to_owned(),
        scene: SceneId::new("flat").unwrap(),
        frames: Path::frames_along(stops, Some(Heading::NORTH)),
        motion: PathMotion::Known,
        target: None,
    }
}

pub(crate) fn test_record(id: &str, instruction: Instruction) -> InstructionRecord {
    InstructionRecord::new("made up", test_path(id), instruction)
}

/// A record of the first hop of a walk through a generated house, on which nothing has to be told.
pub(crate) fn house_hop_record() -> InstructionRecord {
    let (platform, scene) = (HousePlatform::default(), HousePlatform::scene_of(0).unwrap());
    let mut path = platform.sample_path(&scene, &PathRequest::default(), 0).unwrap();
    path.frames.truncate(2);
    InstructionRecord::new("house", path, test_instruction("r2r", "Stop.", &[]))
}

/// The test kit's building on disk.
pub(crate) struct TestBuildingFolder(TempDir);

impl TestBuildingFolder {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        wayword_testkit::write_building(folder.path()).unwrap();
        Self(folder)
    }

    pub(crate) fn data_folder(&self) -> PathBuf {
        self.0.path().to_owned()
    }

    pub(crate) fn matterport_world(&self) -> MeasuredWorldArgs {
        MeasuredWorldArgs { platform: "matterport".into(), data: Some(self.data_folder()), scan: None, seed: 0 }
    }
}
