"""A static binary finds names and checks certificates in a folder that holds nothing else: no library, no certificates, no /proc.

It needs Linux, Python 3.11, `unshare` (util-linux) and `openssl`, and no network: everything happens in a network namespace of its own.
"""

import argparse
import fcntl
import http.server
import json
import os
import shutil
import socket
import socketserver
import ssl
import struct
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

HERE = "127.0.0.1"
PLAIN, SECRET = 8000, 8443
BY_FILE = "file.wayword.test"
BY_SERVER = "server.wayword.test"
UNKNOWN = "unknown.wayword.test"
MODEL = "server/trial"
INSIDE = "WAYWORD_TRIAL_INSIDE"
# What desktops write there: services whose libraries a static binary cannot load stand before `dns`.
DESKTOP = "hosts: files mymachines mdns4_minimal [NOTFOUND=return] resolve [!UNAVAIL=return] dns\n"
# The name of a root certificate that the public web relies on, as it stands in the list of roots.
ROOT_CERTIFICATE = b"ISRG Root X1"

A, ANY_FAMILY = 1, (1, 28)
FLAGS_FOUND, FLAGS_NO_SUCH_NAME = 0x8580, 0x8583


class Faults(list):
    def expect(self, is_met: bool, what: str, found: str = "") -> None:
        print(f"{'ok     ' if is_met else 'FAULT  '}{what}" + ("" if is_met else f"; found: {found.strip()[-600:]}"))
        if not is_met:
            self.append(what)


# ---- The servers


class Names(socketserver.BaseRequestHandler):
    """Answers for one name, and says of all others that there are none."""

    asked: list[str] = []

    def handle(self):
        query, to = self.request
        labels, at = [], 12
        while query[at]:
            labels.append(query[at + 1 : at + 1 + query[at]].decode())
            at += 1 + query[at]
        question = query[12 : at + 5]
        kind = struct.unpack("!H", query[at + 1 : at + 3])[0]
        name = ".".join(labels)
        self.asked.append(name)
        is_known = name == BY_SERVER and kind in ANY_FAMILY
        has_answer = is_known and kind == A
        head = struct.pack("!6H", *struct.unpack("!H", query[:2]), FLAGS_FOUND if is_known else FLAGS_NO_SUCH_NAME, 1, has_answer, 0, 0)
        answer = struct.pack("!3HLH", 0xC00C, A, 1, 60, 4) + socket.inet_aton(HERE) if has_answer else b""
        to.sendto(head + question + answer, self.client_address)


class Models(http.server.BaseHTTPRequestHandler):
    """A service with one model, which always says the same."""

    hosts: list[str] = []

    def do_GET(self):
        self.reply({"object": "list", "data": [{"id": MODEL.split("/")[1], "object": "model"}]})

    def do_POST(self):
        self.rfile.read(int(self.headers["content-length"]))
        message = {"role": "assistant", "content": "Walk ahead and stop."}
        usage = {"prompt_tokens": 1, "completion_tokens": 1}
        self.reply({"choices": [{"message": message, "finish_reason": "stop"}], "usage": usage})

    def reply(self, value):
        self.hosts.append(self.headers["host"].split(":")[0])
        body = json.dumps(value).encode()
        self.send_response(200)
        self.send_header("content-type", "application/json")
        self.send_header("content-length", str(len(body)))
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_):
        pass


class Quiet(http.server.ThreadingHTTPServer):
    def handle_error(self, *_):
        """A client that refuses a certificate hangs up; that is what is tried."""


def serve(folder: Path) -> None:
    key, certificate = folder / "key.pem", folder / "certificate.pem"
    subprocess.run(
        ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "2"]
        + ["-subj", f"/CN={BY_SERVER}", "-addext", f"subjectAltName=DNS:{BY_SERVER}", "-addext", "basicConstraints=critical,CA:FALSE"]
        + ["-keyout", key, "-out", certificate],
        check=True,
        capture_output=True,
    )
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    behind_tls = Quiet((HERE, SECRET), Models)
    behind_tls.socket = context.wrap_socket(behind_tls.socket, server_side=True, do_handshake_on_connect=False)
    for server in (socketserver.ThreadingUDPServer((HERE, 53), Names), Quiet((HERE, PLAIN), Models), behind_tls):
        threading.Thread(target=server.serve_forever, daemon=True).start()


# ---- The empty root


def make_root(root: Path, binary: Path) -> None:
    (root / "etc").mkdir(parents=True)
    (root / "work").mkdir()
    shutil.copy2(binary, root / "wayword")
    (root / "etc/hosts").write_text(f"{HERE} localhost\n{HERE} {BY_FILE}\n")
    (root / "etc/resolv.conf").write_text(f"nameserver {HERE}\noptions timeout:1 attempts:1\n")


def wayword(root: Path, *args: str) -> subprocess.CompletedProcess:
    def enter():
        os.chroot(root)
        os.chdir("/work")

    return subprocess.run(["/wayword", *args], preexec_fn=enter, env={}, capture_output=True, text=True, timeout=120)


def doctor(root: Path, scheme: str, name: str, port: int) -> subprocess.CompletedProcess:
    return wayword(root, "doctor", "--llm", MODEL, "--base-url", f"{scheme}://{name}:{port}/v1", "--ledger", "calls.db")


def try_names(root: Path, faults: Faults) -> None:
    for name, source in ((BY_FILE, "/etc/hosts"), (BY_SERVER, "a name server")):
        Models.hosts.clear()
        asked = doctor(root, "http", name, PLAIN)
        is_found = asked.returncode == 0 and set(Models.hosts) == {name}
        faults.expect(is_found, f"a name that {source} knows is found", asked.stdout + asked.stderr)
    asked = doctor(root, "http", UNKNOWN, PLAIN)
    told = asked.stdout + asked.stderr
    faults.expect(asked.returncode == 1 and UNKNOWN in told, "a name that nothing knows is told as an error", told)


def try_run(root: Path, out: str, faults: Faults) -> None:
    Models.hosts.clear()
    service = ["--write", MODEL, "--base-url", f"http://{BY_SERVER}:{PLAIN}/v1", "--ledger", f"{out}.db"]
    made = wayword(root, "generate", "--paths", "1", "--style", "r2r", *service, "--out", out)
    is_made = made.returncode == 0 and (root / "work" / out / "instructions.jsonl").stat().st_size > 0
    faults.expect(is_made and BY_SERVER in Models.hosts, "a run asks a model by its name", made.stdout + made.stderr)


def try_certificates(root: Path, faults: Faults) -> None:
    Models.hosts.clear()
    asked = doctor(root, "https", BY_SERVER, SECRET)
    told = asked.stdout + asked.stderr
    is_refused = asked.returncode == 1 and "UnknownIssuer" in told and not Models.hosts
    faults.expect(is_refused, "a certificate that no known authority signed is refused", told)
    is_there = ROOT_CERTIFICATE in (root / "wayword").read_bytes()
    faults.expect(is_there, "the authorities of the public web are part of the binary")


# ---- The trial


def bring_up_loopback() -> None:
    get, put, up = 0x8913, 0x8914, 0x1
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as any_socket:
        request = struct.pack("16sh14x", b"lo", 0)
        flags = struct.unpack("16sh14x", fcntl.ioctl(any_socket, get, request))[1]
        fcntl.ioctl(any_socket, put, struct.pack("16sh14x", b"lo", flags | up))


def trial(binary: Path) -> int:
    faults = Faults()
    bring_up_loopback()
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder, "root")
        make_root(root, binary)
        serve(Path(folder))
        try:
            version = wayword(root, "--version")
        except FileNotFoundError:
            print(f"{binary}: it does not start in an empty root, because it is not static; `release/static` makes one that is")
            return 1
        faults.expect(version.returncode == 0, "it runs in an empty root", version.stderr)
        try_names(root, faults)
        try_run(root, "first", faults)
        try_certificates(root, faults)
        (root / "etc/nsswitch.conf").write_text(DESKTOP)
        print("-- with services in nsswitch.conf that it cannot load")
        try_names(root, faults)
    faults.expect({BY_SERVER, UNKNOWN} <= set(Names.asked) and BY_FILE not in Names.asked, "the name server was asked for nothing else")
    print(f"{len(faults)} faults" if faults else "all is well")
    return 1 if faults else 0


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--wayword", type=Path, default=Path("target/static/wayword"), help="the binary")
    binary = parser.parse_args().wayword.resolve()
    if not binary.is_file():
        parser.error(f"{binary}: there is no such file; `release/static` makes it")
    if INSIDE in os.environ:
        return trial(binary)
    # Root of a new user namespace may do what is needed here, on systems that let users have one.
    user = ["--user", "--map-root-user"] if os.geteuid() else []
    return subprocess.run(["unshare", "--net", *user, sys.executable, *sys.argv], env=os.environ | {INSIDE: "1"}).returncode


if __name__ == "__main__":
    sys.exit(main())
