//! Tests the controller with the stand-in build and its faults, and with a third-party implementation of ZeroMQ.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::{
    io::{Read, Write},
    net::{SocketAddr, TcpStream},
    thread,
    time::{Duration, Instant},
};
use wayword_live::tdw::{
    BuildCommand, BuildOutput, ControllerOptions, SendFrequency, TdwController, TdwError, WireError,
    stand_in::{StandInOptions, TdwStandIn, canned_picture},
};
use zeromq::{Socket, SocketRecv, SocketSend};

fn options() -> ControllerOptions {
    ControllerOptions {
        address: SocketAddr::from(([127, 0, 0, 1], 0)),
        connect_timeout: Duration::from_secs(20),
        step_timeout: Duration::from_secs(20),
    }
}

fn canned() -> StandInOptions {
    StandInOptions { canned: Some(vec![canned_picture(4, 2)]), ..StandInOptions::default() }
}

fn once() -> BuildCommand {
    BuildCommand::SendImages { ids: vec![], frequency: SendFrequency::Once }
}

#[test]
fn build_reports_its_version_and_answers_until_terminated() {
    for version in ["1.12.27", "1.13.0.0"] {
        let mut controller = TdwController::bind(options()).unwrap();
        let build = TdwStandIn::start(controller.address(), StandInOptions { version, ..StandInOptions::default() });
        assert_eq!(controller.connect().unwrap().tdw, version);
        let first =
            controller.communicate(&[BuildCommand::SendSceneRegions { frequency: SendFrequency::Once }]).unwrap();
        let rooms = first.first_output("sreg", "send_scene_regions", |output| match output {
            BuildOutput::Regions(regions) => Some(regions.len()),
            _ => None,
        });
        assert!(rooms.unwrap() >= 3);
        let missing = first.first_output("segm", "send_segmentation_colors", Some).unwrap_err().to_string();
        assert!(missing.contains("`segm`"), "{missing}");
        let second = controller.communicate(&[]).unwrap();
        assert_eq!(second.frame_number, first.frame_number + 1);
        controller.terminate().unwrap();
        assert!(!controller.is_connected());
        build.join();
    }
}

#[test]
fn communicate_resends_commands_that_the_build_did_not_receive() {
    let mut controller = TdwController::bind(options()).unwrap();
    let _build = TdwStandIn::start(controller.address(), StandInOptions { deaf: 7, ..canned() });
    controller.connect().unwrap();
    assert_eq!(controller.communicate(&[once()]).unwrap().read_outputs().count(), 1);
}

#[test]
fn communicate_gives_up_a_build_that_never_receives() {
    let mut controller = TdwController::bind(options()).unwrap();
    let _build = TdwStandIn::start(controller.address(), StandInOptions { deaf: u32::MAX, ..canned() });
    assert!(matches!(controller.connect(), Err(TdwError::NeverHeard { times: 1000 })));
    assert!(!controller.is_connected());
}

#[test]
fn a_lost_build_is_replaced_by_the_next() {
    let mut controller = TdwController::bind(options()).unwrap();
    let _build = TdwStandIn::start(controller.address(), StandInOptions { breaks_after: Some(2), ..canned() });
    controller.connect().unwrap();
    controller.communicate(&[once()]).unwrap();
    let lost = controller.communicate(&[once()]).unwrap_err();
    assert!(matches!(lost, TdwError::Wire { source: WireError::Gone { .. }, .. }), "{lost}");
    assert!(!controller.is_connected());
    assert!(matches!(controller.communicate(&[once()]), Err(TdwError::NoBuild { .. })));
    controller.connect().unwrap();
    assert!(controller.communicate(&[once()]).is_ok());
}

#[test]
fn communicate_times_out_on_a_silent_build() {
    let options = ControllerOptions { step_timeout: Duration::from_secs(2), ..options() };
    let mut controller = TdwController::bind(options).unwrap();
    let _build = TdwStandIn::start(controller.address(), StandInOptions { hangs_after: Some(1), ..canned() });
    controller.connect().unwrap();
    let late = controller.communicate(&[once()]).unwrap_err();
    assert!(matches!(late, TdwError::Wire { source: WireError::Late { .. }, .. }), "{late}");
}

#[test]
fn connect_error_without_a_build_shows_how_to_start_one() {
    let options = ControllerOptions { connect_timeout: Duration::from_millis(50), ..options() };
    let mut controller = TdwController::bind(options).unwrap();
    let error = controller.connect().unwrap_err().to_string();
    assert!(error.contains("TDW.x86_64 -port"), "{error}");
}

/// A build's first message, in its envelope.
const HELLO: &[u8] = b"\x01\x00\x00\x05hello";

/// The greeting and READY of a REQ socket.
fn greeting() -> Vec<u8> {
    let mut bytes = vec![0xff, 0, 0, 0, 0, 0, 0, 0, 1, 0x7f, 3, 0];
    bytes.extend(b"NULL");
    bytes.resize(64, 0);
    bytes.extend(b"\x04\x19\x05READY\x0bSocket-Type\x00\x00\x00\x03REQ");
    bytes
}

/// The controller's error for a connection on which exactly these bytes come.
fn connected_by(bytes: &[u8]) -> TdwError {
    let options = ControllerOptions { connect_timeout: Duration::from_millis(700), ..options() };
    let mut controller = TdwController::bind(options).unwrap();
    let address = controller.address();
    let sent = bytes.to_vec();
    let stranger = thread::spawn(move || {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(&sent).unwrap();
        // Reads until the controller hangs up.
        let _ = stream.set_read_timeout(Some(Duration::from_secs(3)));
        let _ = stream.read_to_end(&mut Vec::new());
    });
    let error = controller.connect().map(|_| ()).unwrap_err();
    drop(controller);
    stranger.join().unwrap();
    error
}

#[test]
fn connect_errors_about_strangers_name_position_and_expectation() {
    let http = connected_by(b"GET / HTTP/1.1\r\n\r\n").to_string();
    assert!(http.contains("byte 0 of the connection: expected the signature of a ZeroMQ socket"), "{http}");
    let mut publisher = greeting();
    let kind_at = publisher.len() - 3;
    publisher[kind_at..].copy_from_slice(b"PUB");
    let kind = connected_by(&publisher).to_string();
    assert!(kind.contains("REQ talks to REP") && kind.contains("found a PUB socket"), "{kind}");
}

#[test]
fn receive_allocates_no_memory_for_announced_lengths() {
    for length in [u64::MAX, 1 << 40, (256 << 20) + 1] {
        let announced = [&greeting()[..], b"\x01\x00\x02", &length.to_be_bytes()].concat();
        let error = connected_by(&announced).to_string();
        assert!(error.contains(&format!("one of {length} bytes")), "{error}");
    }
    // A length within the limit costs no memory either: the controller waits for the bytes.
    let announced = [&greeting()[..], b"\x01\x00\x02", &(200_u64 << 20).to_be_bytes(), b"abc"].concat();
    assert!(connected_by(&announced).to_string().contains("timed out while reading a message"));
}

#[test]
fn an_answer_without_its_frame_number_is_refused() {
    let answer = [&greeting()[..], HELLO, b"\x01\x00\x00\x03abc"].concat();
    let error = connected_by(&answer);
    assert!(matches!(error, TdwError::NoFrameNumber { length: 3 }), "{error}");
}

/// NetMQ before 4.0.1 speaks ZMTP 2.0, which the crate `zeromq` refuses.
#[test]
fn a_build_with_an_older_zeromq_is_understood() {
    let mut controller = TdwController::bind(options()).unwrap();
    let address = controller.address();
    let build = thread::spawn(move || {
        let mut stream = TcpStream::connect(address).unwrap();
        stream.write_all(&[0xff, 0, 0, 0, 0, 0, 0, 0, 1, 0x7f, 1, 3, 0, 0]).unwrap();
        let mut theirs = [0; 14];
        stream.read_exact(&mut theirs).unwrap();
        assert_eq!(theirs[10..], [3, 4, 0, 0], "revision, REP, no identity");
        stream.write_all(HELLO).unwrap();
        stream.read_exact(&mut [0; 4]).unwrap();
        stream.write_all(b"\x01\x00\x01\x1b\0\0\0\0vers\x01\x081.13.0.02020.3.24\x00\x04\0\0\0\x09").unwrap();
    });
    assert_eq!(controller.connect().unwrap().unity, "2020.3.24");
    build.join().unwrap();
}

/// A third-party implementation plays the build: each side can read the other's bytes.
#[test]
fn the_zeromq_crate_agrees_about_the_bytes() {
    let mut controller = TdwController::bind(options()).unwrap();
    let address = controller.address();
    let sent = canned_picture(640, 480);
    let build = thread::spawn(move || {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let mut socket = zeromq::ReqSocket::new();
            socket.connect(&format!("tcp://{address}")).await.unwrap();
            socket.send("hello".into()).await.unwrap();
            let hello = socket.recv().await.unwrap();
            assert!(String::from_utf8_lossy(hello.get(0).unwrap()).contains("send_version"));
            for frames in [b"\0\0\0\0vers\x01\x081.13.0.02020.3.24".to_vec(), sent] {
                let mut message = zeromq::ZmqMessage::from(frames);
                message.push_back(vec![0, 0, 0, 5].into());
                socket.send(message).await.unwrap();
                let _ = socket.recv().await;
            }
        });
    });
    controller.connect().unwrap();
    let commands = vec![once(); 5000];
    let response = controller.communicate(&commands).unwrap();
    assert_eq!(response.frame_number, 5);
    let pixels = response.first_output("imag", "send_images", |output| match output {
        BuildOutput::Images(images) => Some((images.width, images.height, images.passes[0].bytes.len())),
        _ => None,
    });
    assert_eq!(pixels.unwrap(), (640, 480, 640 * 480 * 3));
    drop(controller);
    build.join().unwrap();
}

/// 10,000 steps with frames of 900 kB; prints the time for a step and the memory of the process. Run it yourself,
/// because it takes a while (`cargo test --release -p wayword-live --test controller -- --ignored --nocapture`).
#[test]
#[ignore = "takes a minute; for measuring"]
fn ten_thousand_steps_need_no_more_memory_than_a_hundred() {
    let mut controller = TdwController::bind(options()).unwrap();
    let canned = Some(vec![canned_picture(640, 480)]);
    let _build = TdwStandIn::start(controller.address(), StandInOptions { canned, ..StandInOptions::default() });
    controller.connect().unwrap();
    let resident_kb = || {
        let status = std::fs::read_to_string("/proc/self/status").unwrap();
        let line = status.lines().find(|line| line.starts_with("VmRSS")).unwrap().to_owned();
        line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap()
    };
    let mut early_kb = 0;
    let start = Instant::now();
    for step in 0..10_000 {
        assert_eq!(controller.communicate(&[once()]).unwrap().read_outputs().filter(Result::is_ok).count(), 1);
        if step == 100 {
            early_kb = resident_kb();
        }
    }
    let late_kb = resident_kb();
    println!(
        "{:.3} ms a step; {early_kb} kB after 100 steps, {late_kb} kB after 10,000",
        start.elapsed().as_secs_f64() / 10.0
    );
    assert!(late_kb < early_kb + 8 * 1024, "{early_kb} kB grew to {late_kb} kB");
}
