"""Stands between the browser and the site: reads every answer of the site, and loses requests or replies when it is told to."""

import http.client
import ssl
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from urllib.parse import urlsplit

HOP = {"connection", "keep-alive", "transfer-encoding", "content-length"}


class Recorder:
    """A server on a free port of this machine that hands everything on to `site`. The headers stay as they are, `Host` too."""

    def __init__(self, site: str, never: list[str]):
        self.site = urlsplit(site)
        self.never = [word.lower().encode() for word in never]
        self.found: list[str] = []
        self.count = 0
        self.posts: list[str] = []
        self.script = True  # whether the page gets its script
        self.losing = ""  # "request" or "reply": what is lost of each post from now on; a browser tries again by itself at first
        recorder = self

        class Handler(BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"

            def log_message(self, *_):
                pass

            def do_GET(self):
                recorder.hand_on(self)

            do_POST = do_HEAD = do_GET

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.server.daemon_threads = True
        self.origin = f"http://127.0.0.1:{self.server.server_port}"
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def close(self):
        self.server.shutdown()

    def connect(self) -> http.client.HTTPConnection:
        if self.site.scheme == "https":  # with --self-signed nobody vouches for the certificate
            return http.client.HTTPSConnection(self.site.netloc, timeout=30, context=ssl._create_unverified_context())
        return http.client.HTTPConnection(self.site.netloc, timeout=30)

    def hand_on(self, request: BaseHTTPRequestHandler):
        body = request.rfile.read(int(request.headers.get("Content-Length") or 0))
        loss = ""
        if request.command == "POST":
            self.posts.append(f"{request.path} {body.decode(errors='replace')}")
            loss = self.losing
        if loss == "request":
            return self.hang_up(request)
        connection = self.connect()
        try:
            headers = {name: value for name, value in request.headers.items() if name.lower() not in HOP}
            headers["Accept-Encoding"] = "identity"
            connection.request(request.command, request.path, body or None, headers)
            reply = connection.getresponse()
            data = reply.read()
        except OSError:
            return self.hang_up(request)
        finally:
            connection.close()
        if request.path == "/script.js" and not self.script:
            data = b""
        self.count += 1
        head = "\n".join(f"{name}: {value}" for name, value in reply.getheaders()).encode()
        for word in self.never:
            if word in (head + data).lower():
                self.found.append(f"{word.decode()!r} is in the reply to {request.command} {urlsplit(request.path).path}")
        if loss == "reply":
            return self.hang_up(request)
        request.send_response(reply.status)
        for name, value in reply.getheaders():
            if name.lower() not in HOP | {"date", "server"}:
                request.send_header(name, value)
        request.send_header("Content-Length", str(len(data)))
        request.end_headers()
        request.wfile.write(data)
        return None

    @staticmethod
    def hang_up(request: BaseHTTPRequestHandler):
        request.close_connection = True
        request.connection.shutdown(2)
