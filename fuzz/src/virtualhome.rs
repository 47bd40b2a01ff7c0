//! The part of VirtualHome's executable that it takes to hand a graph to the platform.

use base64::{Engine, prelude::BASE64_STANDARD};
use serde_json::{Value, json};
use std::{
    io::{self, BufRead, BufReader, Read, Write},
    net::{TcpListener, TcpStream},
    sync::{Mutex, PoisonError},
    thread,
};

/// What is sent as the graph.
static GRAPH: Mutex<String> = Mutex::new(String::new());

/// Sets what is sent as the graph from now on.
pub fn set_graph(text: String) {
    *GRAPH.lock().unwrap_or_else(PoisonError::into_inner) = text;
}

/// Starts to listen; returns the address, as clients take it.
pub fn start() -> String {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let url = format!("http://{}", listener.local_addr().expect("its address"));
    thread::spawn(move || {
        for stream in listener.incoming().flatten() {
            thread::spawn(move || talk(stream));
        }
    });
    url
}

fn talk(stream: TcpStream) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let mut reader = BufReader::new(stream);
    loop {
        let mut length = 0;
        loop {
            let mut line = String::new();
            if reader.read_line(&mut line)? == 0 {
                return Ok(());
            }
            let Some((name, value)) = line.split_once(':') else {
                if line.trim().is_empty() { break } else { continue }
            };
            if name.eq_ignore_ascii_case("content-length") {
                length = value.trim().parse().unwrap_or(0);
            }
        }
        let mut body = Vec::new();
        reader.by_ref().take(length).read_to_end(&mut body)?;
        let content = answer(&serde_json::from_slice(&body).unwrap_or_default()).to_string();
        write!(reader.get_mut(), "HTTP/1.1 200 OK\r\nContent-Length: {}\r\n\r\n{content}", content.len())?;
    }
}

fn answer(request: &Value) -> Value {
    let message = match request["action"].as_str().unwrap_or_default() {
        "environment_graph" => GRAPH.lock().unwrap_or_else(PoisonError::into_inner).clone(),
        "instance_colors" => r#"{"1": [0.5, 0.25, 1], "2": [0, 0.5, 0], "3": [1, 0, 0]}"#.to_owned(),
        _ => String::new(),
    };
    let pictures = [BASE64_STANDARD.encode(crate::seeds::picture::png(16, 12))];
    json!({ "success": true, "message": message, "value": 1, "message_list": pictures })
}
