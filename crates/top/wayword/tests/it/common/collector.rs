//! A collector of OpenTelemetry that keeps the requests that it gets.

use opentelemetry_proto::tonic::{
    collector::trace::v1::ExportTraceServiceRequest,
    common::v1::any_value::Value,
    trace::v1::{ResourceSpans, Span},
};
use prost::Message;
use std::{
    collections::BTreeSet,
    io::{BufReader, Write},
    net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream},
    sync::{Arc, Mutex},
    thread,
};
use wayword_testkit::read_http_request;

#[derive(Default)]
struct Received {
    /// Request line and headers of each request.
    heads: Vec<String>,
    bodies: Vec<Vec<u8>>,
}

/// Listens until the test ends.
pub(crate) struct Collector {
    address: SocketAddr,
    received: Arc<Mutex<Received>>,
}

impl Collector {
    pub(crate) fn start() -> Self {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).unwrap();
        let (address, received) = (listener.local_addr().unwrap(), Arc::<Mutex<Received>>::default());
        let kept = Arc::clone(&received);
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let kept = Arc::clone(&kept);
                thread::spawn(move || serve(stream, &kept));
            }
        });
        Self { address, received }
    }

    /// For `OTEL_EXPORTER_OTLP_ENDPOINT`.
    pub(crate) fn endpoint(&self) -> String {
        format!("http://{}", self.address)
    }

    pub(crate) fn heads(&self) -> Vec<String> {
        self.received.lock().unwrap().heads.clone()
    }

    /// Whether a text is in anything that came.
    pub(crate) fn holds(&self, text: &str) -> bool {
        let received = self.received.lock().unwrap();
        received.bodies.iter().any(|body| body.windows(text.len()).any(|window| window == text.as_bytes()))
    }

    fn groups(&self) -> Vec<ResourceSpans> {
        let received = self.received.lock().unwrap();
        let group = |body: &Vec<u8>| ExportTraceServiceRequest::decode(&body[..]).unwrap().resource_spans;
        received.bodies.iter().flat_map(group).collect()
    }

    pub(crate) fn spans(&self) -> Vec<Span> {
        self.groups().into_iter().flat_map(|group| group.scope_spans).flat_map(|scope| scope.spans).collect()
    }

    /// The values of a resource attribute.
    pub(crate) fn resource(&self, key: &str) -> BTreeSet<String> {
        let attributes = self.groups().into_iter().filter_map(|group| group.resource).flat_map(|who| who.attributes);
        let text = |value| match value {
            Some(Value::StringValue(text)) => text,
            other => format!("{other:?}"),
        };
        let values = attributes.filter(|attribute| attribute.key == key);
        values.map(|attribute| text(attribute.value.and_then(|value| value.value))).collect()
    }
}

/// Answers the requests of a connection until it is closed.
fn serve(stream: TcpStream, received: &Mutex<Received>) {
    let mut answers = stream.try_clone().unwrap();
    let mut requests = BufReader::new(stream);
    while let Some((head, body)) = read_http_request(&mut requests) {
        let mut received = received.lock().unwrap();
        received.heads.push(head);
        received.bodies.push(body);
        answers
            .write_all(b"HTTP/1.1 200 OK\r\ncontent-type: application/x-protobuf\r\ncontent-length: 0\r\n\r\n")
            .unwrap();
    }
}
