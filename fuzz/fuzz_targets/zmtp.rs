//! Bytes that come over ThreeDWorld's socket: ZeroMQ's greeting, frames, the version, one answer.
//!
//! No containment: all of this code is our own. Memory: one MiB for each announced message, before it comes, and the
//! reader's buffer of 64 KiB.
#![no_main]

use libfuzzer_sys::fuzz_target;
use std::{
    io::Write,
    net::{Shutdown, TcpStream},
    sync::OnceLock,
    time::Duration,
};
use wayword_fuzz::{Bound, begin, tape};
use wayword_live::tdw::{BuildCommand, ControllerOptions, SendFrequency, TdwController};

const BOUND: Bound = Bound { flat: 4 << 20, per_byte: 64 };

/// The bytes of a correct build.
static GOOD: OnceLock<Vec<u8>> = OnceLock::new();

fn seeds() -> Vec<Vec<u8>> {
    let tapes = ["1.12.27", "1.13.0.0"].map(tape::record);
    GOOD.get_or_init(|| tapes[1].clone());
    // An older peer has a shorter greeting.
    let old = b"\xff\0\0\0\0\0\0\0\x01\x7f\x01\x03\0\0\x01\0\0\x05hello\x01\0\x01\x0a\0\0\0\0ftre\0\0\0\x04\0\0\0\x01";
    tapes.into_iter().chain([old.to_vec()]).collect()
}

/// A peer that sends all bytes at once, and then nothing more.
fn speaker(to: std::net::SocketAddr, bytes: &[u8]) -> Option<TcpStream> {
    let mut stream = TcpStream::connect(to).ok()?;
    stream.set_nonblocking(true).ok()?;
    let _ = stream.write_all(bytes);
    let _ = stream.shutdown(Shutdown::Write);
    Some(stream)
}

fuzz_target!(init: begin("zmtp", &seeds()), |data: &[u8]| {
    let patience = Duration::from_secs(2);
    let options = ControllerOptions {
        address: ([127, 0, 0, 1], 0).into(),
        connect_timeout: patience,
        step_timeout: patience,
    };
    BOUND.hold(data, || {
        let mut controller = TdwController::bind(options).expect("a port");
        // A correct build connects after the fuzzed peer, so that the controller does not wait until its time is up.
        let good = GOOD.get().map_or(&[][..], Vec::as_slice);
        let _speakers = [data, good].map(|bytes| speaker(controller.address(), bytes));
        if controller.connect().is_ok()
            && let Ok(answer) =
                controller.communicate(&[BuildCommand::SendSceneRegions { frequency: SendFrequency::Once }])
        {
            answer.read_outputs().for_each(drop);
        }
    });
});
