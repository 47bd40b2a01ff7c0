//! The bytes that a build of ThreeDWorld sends, recorded between the stand-in and a controller.

use std::{
    io::{Read, Write},
    net::{TcpListener, TcpStream},
    thread,
    time::Duration,
};
use wayword_live::tdw::{
    BuildCommand, ControllerOptions, SendFrequency, TdwController, TdwVector3,
    stand_in::{StandInOptions, TdwStandIn},
};

/// Everything that the stand-in of a version sends for one list of commands, including its greeting.
pub fn record(version: &'static str) -> Vec<u8> {
    let options = ControllerOptions {
        address: ([127, 0, 0, 1], 0).into(),
        connect_timeout: Duration::from_secs(60),
        step_timeout: Duration::from_secs(60),
    };
    let mut controller = TdwController::bind(options).expect("a port");
    let target = controller.address();
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let between = listener.local_addr().expect("its address");
    let copying = thread::spawn(move || {
        let (build, _) = listener.accept().expect("the stand-in");
        let controller = TcpStream::connect(target).expect("the controller");
        let (from, to) = (controller.try_clone().expect("a stream"), build.try_clone().expect("a stream"));
        let back = thread::spawn(move || copy(from, to));
        let tape = copy(build, controller);
        drop(back.join());
        tape
    });
    let build = TdwStandIn::start(between, StandInOptions { version, ..StandInOptions::default() });
    controller.connect().expect("the stand-in greets");
    controller.communicate(&commands()).expect("the stand-in answers");
    controller.terminate().expect("the stand-in ends");
    build.join();
    drop(controller);
    copying.join().expect("a tape")
}

fn copy(mut from: TcpStream, mut to: TcpStream) -> Vec<u8> {
    let mut tape = Vec::new();
    let mut part = [0; 4096];
    while let Ok(count @ 1..) = from.read(&mut part) {
        tape.extend_from_slice(&part[..count]);
        if to.write_all(&part[..count]).is_err() {
            break;
        }
    }
    let _ = to.shutdown(std::net::Shutdown::Write);
    tape
}

fn commands() -> Vec<BuildCommand> {
    let (id, frequency) = (String::from("a"), SendFrequency::Once);
    let place = |x, z| TdwVector3 { x, y: 0.0, z };
    vec![
        BuildCommand::CreateAvatar { kind: "A_Img_Caps_Kinematic", id: id.clone() },
        BuildCommand::SetScreenSize { width: 8, height: 6 },
        BuildCommand::SetPassMasks { pass_masks: vec!["_img", "_id", "_depth"], avatar_id: id },
        BuildCommand::SendImages { ids: Vec::new(), frequency },
        BuildCommand::SendSegmentationColors { ids: Vec::new(), frequency },
        BuildCommand::SendCategories { frequency },
        BuildCommand::SendSceneRegions { frequency },
        BuildCommand::SendBounds { ids: Vec::new(), frequency },
        BuildCommand::SendTransforms { ids: Vec::new(), frequency },
        BuildCommand::SendOccupancyMap { cell_size: 2.0, raycast_y: 2.5 },
        BuildCommand::SendAvatars { ids: Vec::new(), frequency },
        BuildCommand::SendCameraMatrices { ids: Vec::new(), frequency },
        BuildCommand::SendImageSensors { ids: Vec::new(), frequency },
        BuildCommand::SendIsOnNavMesh { position: place(2.0, 2.0), max_distance: 2.0, id: 3 },
        BuildCommand::SendNavMeshPath { origin: place(1.0, 1.0), destination: place(3.0, 3.0), id: 4 },
    ]
}

/// The frames of a tape, without ZMTP 3.0's framing.
pub fn frames(tape: &[u8]) -> Vec<Vec<u8>> {
    // 64 bytes of greeting come first.
    let mut rest = tape.get(64..).unwrap_or_default();
    let mut frames = Vec::new();
    while let [flags, after @ ..] = rest {
        let (length, after) = if flags & 2 == 0 {
            let Some((length, after)) = after.split_first() else { break };
            (usize::from(*length), after)
        } else {
            let Some((length, after)) = after.split_first_chunk() else { break };
            (u64::from_be_bytes(*length) as usize, after)
        };
        let Some((frame, after)) = after.split_at_checked(length) else { break };
        frames.push(frame.to_vec());
        rest = after;
    }
    frames
}
