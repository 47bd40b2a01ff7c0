//! Measures a round trip over loopback with a frame of 900 kB: commands to a build, its answer, reading the picture.

#![allow(clippy::expect_used, missing_docs, reason = "a benchmark may fail")]

use criterion::{Criterion, criterion_group, criterion_main};
use std::{hint::black_box, net::SocketAddr, time::Duration};
use wayword_live::tdw::{
    BuildCommand, BuildOutput, ControllerOptions, SendFrequency, TdwController,
    stand_in::{StandInOptions, TdwStandIn, canned_picture},
};

fn round_trip(criterion: &mut Criterion) {
    let options = ControllerOptions { address: SocketAddr::from(([127, 0, 0, 1], 0)), ..ControllerOptions::default() };
    let mut controller = TdwController::bind(options).expect("a free port");
    let picture = canned_picture(640, 480);
    let _build = TdwStandIn::start(
        controller.address(),
        StandInOptions { canned: Some(vec![picture]), ..StandInOptions::default() },
    );
    controller.connect().expect("the stand-in connects");
    let commands = [BuildCommand::SendImages { ids: Vec::new(), frequency: SendFrequency::Once }];
    criterion.bench_function("round trip with a frame of 921,600 bytes", |bencher| {
        bencher.iter(|| {
            let response = controller.communicate(&commands).expect("an answer");
            let read = response.first_output("imag", "send_images", |output| match output {
                BuildOutput::Images(images) => Some(images.passes[0].bytes.len()),
                _ => None,
            });
            assert_eq!(black_box(read.expect("a picture")), 640 * 480 * 3);
        });
    });
}

criterion_group! {
    name = benches;
    config = Criterion::default().measurement_time(Duration::from_secs(5));
    targets = round_trip
}
criterion_main!(benches);
