//! A test server: a closure decides what each connection gets.

use std::{
    io::{BufReader, Write},
    net::{TcpListener, TcpStream},
    sync::{
        Arc, Mutex,
        atomic::{AtomicUsize, Ordering},
    },
    thread,
    time::Duration,
};
use wayword_testkit::read_http_request;

/// Listens on a port that the system chose, and remembers all requests.
pub(crate) struct Server {
    port: u16,
    requests: Arc<Mutex<Vec<String>>>,
}

impl Server {
    /// `act` gets the number of earlier requests, the request (head and body) and the connection, and writes the response.
    /// If it returns true, the connection stays open for another request.
    pub(crate) fn start(act: impl Fn(usize, &str, &mut TcpStream) -> bool + Send + Sync + 'static) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let requests = Arc::new(Mutex::new(Vec::new()));
        let (act, count, seen) = (Arc::new(act), Arc::new(AtomicUsize::new(0)), Arc::clone(&requests));
        thread::spawn(move || {
            for stream in listener.incoming().map_while(Result::ok) {
                let (act, count, seen) = (Arc::clone(&act), Arc::clone(&count), Arc::clone(&seen));
                thread::spawn(move || serve(stream, &*act, &count, &seen));
            }
        });
        Self { port, requests }
    }

    pub(crate) fn base_url(&self) -> String {
        format!("http://127.0.0.1:{}/v1", self.port)
    }

    /// All requests so far.
    pub(crate) fn requests(&self) -> Vec<String> {
        self.requests.lock().unwrap().clone()
    }
}

fn serve(
    mut stream: TcpStream,
    act: &dyn Fn(usize, &str, &mut TcpStream) -> bool,
    count: &AtomicUsize,
    seen: &Mutex<Vec<String>>,
) {
    stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    stream.set_nodelay(true).unwrap();
    let mut reader = BufReader::new(stream.try_clone().unwrap());
    while let Some((head, body)) = read_http_request(&mut reader) {
        let request = head + &String::from_utf8_lossy(&body);
        seen.lock().unwrap().push(request.clone());
        if !act(count.fetch_add(1, Ordering::SeqCst), &request, &mut stream) {
            return;
        }
    }
}

/// Writes a complete response.
pub(crate) fn reply(stream: &mut TcpStream, status: u16, headers: &str, body: &str) -> bool {
    let head = format!(
        "HTTP/1.1 {status} X\r\ncontent-type: application/json\r\n{headers}content-length: {}\r\n\r\n",
        body.len()
    );
    stream.write_all((head + body).as_bytes()).is_ok()
}

/// The body of an answer in OpenAI's dialect.
pub(crate) fn answer(text: &str) -> String {
    ended(text, "stop")
}

/// The body of an answer with the reason for its end.
pub(crate) fn ended(text: &str, reason: &str) -> String {
    serde_json::json!({
        "choices": [{ "message": { "role": "assistant", "content": text }, "finish_reason": reason }],
        "usage": { "prompt_tokens": 10, "completion_tokens": 2 },
    })
    .to_string()
}
