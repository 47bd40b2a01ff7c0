"""What the trials of load and of attacks share: a small HTTP client, pages read as a browser reads them, and a server that can be killed."""

import asyncio
import hashlib
import html
import json
import os
import random
import re
import shutil
import signal
import socket
import sqlite3
import subprocess
import time
import tomllib
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import urlencode

HOST = "127.0.0.1"
STUDY_ID = "trial"


class Broken(Exception):
    """The connection went away before the answer was whole."""


class Faults:
    """Kinds of faults, how often each was seen, and one example."""

    def __init__(self):
        self.seen: dict[str, list] = {}

    def add(self, kind: str, example: str = "") -> None:
        self.seen.setdefault(kind, [0, example])[0] += 1

    def take(self, others: "Faults") -> None:
        for kind, (number, example) in others.seen.items():
            self.seen.setdefault(kind, [0, example])[0] += number

    def report(self) -> bool:
        for kind, (number, example) in sorted(self.seen.items(), key=lambda pair: -pair[1][0]):
            print(f"FAULT  {number} x {kind}" + (f"; the first: {example}" if example else ""))
        print("all is well" if not self.seen else f"{len(self.seen)} kinds of faults")
        return not self.seen


# ---- The study


def copy_study(study: Path, to: Path, lease_s: int, per_item: int | None = None, write_first: bool = False) -> "Facts":
    """A copy without answers, for people who come by a recruiter's link."""
    shutil.copytree(study, to, ignore=shutil.ignore_patterns("study.db*"))
    toml = (to / "study.toml").read_text()
    head, _, rest = toml.partition("[recruiter]")
    codes = rest[rest.find("[codes]") :] if "[codes]" in rest else ""
    head = re.sub(r"(?m)^lease_s = .*$", f"lease_s = {lease_s}", head)
    if write_first:
        head = re.sub(r"(?m)^write_first = .*$", "write_first = true", head)
    recruiter = f'[recruiter]\nkind = "parameters"\nperson = "PROLIFIC_PID"\nsession = "SESSION_ID"\nstudy = "STUDY_ID"\nonly_study = "{STUDY_ID}"\n\n'
    (to / "study.toml").write_text(head + recruiter + codes)
    plan = json.loads((to / "plan.json").read_text())
    if per_item:
        plan["per_item"] = per_item
        (to / "plan.json").write_text(json.dumps(plan, indent=2))
    return Facts(to)


class Facts:
    """What a study consists of."""

    def __init__(self, folder: Path):
        self.folder = folder
        self.settings = tomllib.loads((folder / "study.toml").read_text())
        self.plan = json.loads((folder / "plan.json").read_text())
        lines = lambda name: [json.loads(line) for line in (folder / name).read_text().splitlines()]
        self.items, self.routes, self.scenes = lines("items.jsonl"), lines("routes.jsonl"), lines("scenes.jsonl")
        self.mode, self.per_item = self.plan["mode"], self.plan["per_item"]
        self.right = [question["right"] for question in self.settings.get("questions", [])]
        self.counted = [item["id"] for item in self.items if not item["is_practice"]]
        self.demand = self.per_item * len(self.counted)
        self.places = {scene["scene"]: scene["places"] for scene in self.scenes}

    def database(self) -> sqlite3.Connection:
        return sqlite3.connect(f"file:{self.folder / 'study.db'}?mode=ro", uri=True, timeout=5)


# ---- The server


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind((HOST, 0))
        return probe.getsockname()[1]


class Server:
    """`wayword study serve`, which can be killed and started again on the same port."""

    def __init__(self, program: str, folder: Path):
        self.program, self.folder, self.port = program, folder, free_port()
        self.kills: list[float] = []
        self.process: subprocess.Popen | None = None
        self.log = open(folder.parent / "server.log", "ab")

    def start(self) -> None:
        command = [self.program, "study", "serve", str(self.folder), "--listen", f"{HOST}:{self.port}"]
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=self.log, stderr=self.log)

    def wait(self, limit_s: float = 30) -> None:
        until = time.monotonic() + limit_s
        while time.monotonic() < until:
            if self.process.poll() is not None:
                raise SystemExit(f"the server ended: {(self.folder.parent / 'server.log').read_text()[-2000:]}")
            try:
                socket.create_connection((HOST, self.port), 1).close()
                return
            except OSError:
                time.sleep(0.05)
        raise SystemExit("the server does not listen")

    def kill(self) -> None:
        """SIGKILL, and the same command again at once."""
        self.kills.append(time.monotonic())
        self.process.kill()
        self.process.wait()
        self.start()

    def stop(self) -> int | None:
        """Asks it to end, as Ctrl-C does."""
        if self.process is None:
            return None
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.wait(20)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self.log.close()
        return self.process.returncode

    def rss_mib(self) -> float:
        for line in Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1]) / 1024
        return 0.0

    def cpu_s(self) -> float:
        times = Path(f"/proc/{self.process.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(times[11]) + int(times[12])) / os.sysconf("SC_CLK_TCK")


# ---- HTTP


@dataclass(slots=True)
class Reply:
    status: int
    head: bytes
    body: bytes
    sent: float
    got: float

    def header(self, name: bytes) -> str | None:
        found = re.search(rb"(?im)^" + re.escape(name) + rb":[ \t]*(.*?)\r?$", self.head)
        return found[1].decode("latin-1") if found else None

    def cookies(self) -> dict[str, str]:
        return {key.decode(): value.decode() for key, value in re.findall(rb"(?im)^set-cookie:[ \t]*([^=\r\n]+)=([^;\r\n]*)", self.head)}


LENGTH = re.compile(rb"(?i)\r\ncontent-length:[ \t]*(\d+)")


class Connection(asyncio.Protocol):
    """One request at a time. The time of an answer is taken where its bytes arrive, not where the participant goes on."""

    __slots__ = ("transport", "buffer", "waiting", "sent", "is_open", "used")

    def __init__(self):
        self.transport, self.buffer, self.waiting, self.is_open, self.used = None, b"", None, False, 0

    def connection_made(self, transport):
        self.transport, self.is_open = transport, True

    def data_received(self, data):
        self.buffer = self.buffer + data if self.buffer else data
        end = self.buffer.find(b"\r\n\r\n")
        if end < 0 or self.waiting is None or self.waiting.done():
            return
        head = self.buffer[: end + 2]
        length = LENGTH.search(head)
        whole = end + 4 + (int(length[1]) if length else 0)
        if len(self.buffer) < whole:
            return
        body, self.buffer = self.buffer[end + 4 : whole], self.buffer[whole:]
        self.waiting.set_result(Reply(int(head[9:12]), head, body, self.sent, time.monotonic()))

    def connection_lost(self, error):
        self.is_open = False
        if self.waiting and not self.waiting.done():
            self.waiting.set_exception(Broken())

    async def ask(self, request: bytes, limit_s: float) -> Reply:
        if not self.is_open:  # it went away before anything was asked
            raise Broken()
        loop = asyncio.get_running_loop()
        self.waiting, self.used, self.buffer = loop.create_future(), self.used + 1, b""
        late = loop.call_later(limit_s, self.transport.abort)
        self.sent = time.monotonic()
        self.transport.write(request)
        try:
            return await self.waiting
        finally:
            late.cancel()


class Browser:
    """Cookies, and connections that stay open. Two tabs of a browser share the cookies."""

    def __init__(self, port: int, log: "Log"):
        self.port, self.log, self.cookies = port, log, {}
        self.idle: list[Connection] = []

    async def send(self, method: str, path: str, body: str | None = None, kind: str = "page") -> Reply:
        lines = [f"{method} {path} HTTP/1.1", f"Host: {HOST}:{self.port}"]
        if self.cookies:
            lines.append("Cookie: " + "; ".join(f"{key}={value}" for key, value in self.cookies.items()))
        if body is not None:
            lines += [f"Origin: http://{HOST}:{self.port}", "Content-Type: application/x-www-form-urlencoded", f"Content-Length: {len(body)}"]
        request = ("\r\n".join(lines) + "\r\n\r\n" + (body or "")).encode()
        while True:
            connection = None
            while self.idle and (connection is None or not connection.is_open):
                connection = self.idle.pop()
            is_fresh = connection is None or not connection.is_open
            if is_fresh:
                loop = asyncio.get_running_loop()
                try:
                    _, connection = await asyncio.wait_for(loop.create_connection(Connection, HOST, self.port), 5)
                except (OSError, asyncio.TimeoutError) as error:
                    self.log.failed(kind)
                    raise Broken() from error
            try:
                reply = await connection.ask(request, 20)
            except Broken:
                # The server may close a connection that was idle; a browser then opens another.
                if is_fresh or method != "GET":
                    self.log.failed(kind)
                    raise
                continue
            break
        if connection.is_open and b"connection: close" not in reply.head.lower():
            self.idle.append(connection)
        for key, value in reply.cookies().items():
            if value:
                self.cookies[key] = value
            else:
                self.cookies.pop(key, None)
        self.log.asked("full" if b"All places" in reply.body else kind, reply)
        return reply

    async def follow(self, reply: Reply) -> Reply:
        for _ in range(5):
            if reply.status not in (301, 302, 303, 307, 308):
                break
            reply = await self.send("GET", reply.header(b"location") or "/")
        return reply

    def close(self) -> None:
        for connection in self.idle:
            connection.transport.abort()
        self.idle.clear()


class Log:
    """Every request with its times and status."""

    def __init__(self):
        self.asks: list[tuple[str, int, float, float]] = []
        self.failures: list[tuple[str, float]] = []

    def asked(self, kind: str, reply: Reply) -> None:
        self.asks.append((kind, reply.status, reply.sent, reply.got))

    def failed(self, kind: str) -> None:
        self.failures.append((kind, time.monotonic()))


# ---- Pages

MAIN = re.compile(r'<main[^>]*\bdata-page="([^"]*)"[^>]*\bdata-at="([^"]*)"')
FORM = re.compile(r'<form[^>]*\baction="([^"]*)"[^>]*>(.*?)</form>', re.S)
FIELD = re.compile(r"<(input|button|textarea|legend)\b([^>]*)>([^<]*)")
ATTRIBUTE = re.compile(r'([a-z-]+)="([^"]*)"')
LABEL = re.compile(r'<input type="radio" name="choice" value="(\d)"[^>]*>\s*<span>([^<]*)</span>')
PICTURE = re.compile(r'<img[^>]*\bsrc="([^"]*)"')


@dataclass(slots=True)
class Form:
    action: str
    hidden: dict[str, str] = field(default_factory=dict)
    radios: dict[str, list[str]] = field(default_factory=dict)
    buttons: list[tuple[str, str]] = field(default_factory=list)
    areas: list[str] = field(default_factory=list)
    asked: str = ""


class Page:
    """A page as a browser has it."""

    def __init__(self, reply: Reply):
        self.status = reply.status
        self.text = text = reply.body.decode("utf-8", "replace")
        main = MAIN.search(text)
        self.name, self.at = (main[1], html.unescape(main[2])) if main else ("", "")
        self.forms: dict[str, Form] = {}
        for action, inner in FORM.findall(text):
            form = self.forms[action] = Form(action)
            for tag, attributes, after in FIELD.findall(inner):
                if tag == "legend":
                    form.asked = html.unescape(after)
                    continue
                known = dict(ATTRIBUTE.findall(attributes))
                name, value = known.get("name"), html.unescape(known.get("value", ""))
                if not name:
                    continue
                if tag == "textarea":
                    form.areas.append(name)
                elif tag == "button":
                    form.buttons.append((name, value))
                elif known.get("type") == "radio":
                    form.radios.setdefault(name, []).append(value)
                else:
                    form.hidden[name] = value
        picture = PICTURE.search(text)
        self.picture = html.unescape(picture[1]) if picture else None

    def filled(self, facts: Facts, rng: random.Random, own_text: str | None = None, is_wrong: bool = False) -> tuple[str, dict[str, str]] | None:
        """The form that one would send from here, filled in."""
        if self.name == "consent":
            return "/consent", self.forms["/consent"].hidden | {"agree": "yes"}
        if self.name == "understood":
            answers = {f"q{at}": str(right) for at, right in enumerate(facts.right)}
            if is_wrong:
                answers["q0"] = str((facts.right[0] + 1) % 3)
            return "/understood", self.forms["/understood"].hidden | answers
        if self.name == "attention":
            form = self.forms["/attention"]
            wanted = re.search(r"[\u201c\"'](.*?)[\u201d\"']", form.asked)[1]
            levels = {html.unescape(text): value for value, text in LABEL.findall(self.text)}
            return "/attention", form.hidden | {"choice": levels[wanted]}
        if self.name == "watch":
            return "/write", self.forms["/write"].hidden | {"own_text": own_text or f"Go along, then stop near number {rng.randrange(10**9)}."}
        if self.name == "follow":
            ways = self.forms["/move"].buttons
            if ways and rng.random() < 0.7:
                return "/move", self.forms["/move"].hidden | {"to": rng.choice(ways)[1]}
            return "/stop", self.forms["/stop"].hidden | {"looks": str(rng.randrange(9))}
        if self.name in ("rate", "pair", "follow_after"):
            form = self.forms["/answer"]
            return "/answer", form.hidden | {name: rng.choice(values) for name, values in form.radios.items()}
        return None


# ---- What was acknowledged


@dataclass(slots=True)
class Sent:
    fields: dict[str, str]
    first: float
    acknowledged: float | None
    how: str


class Ledger:
    """What participants sent, and what the server said that it keeps."""

    def __init__(self):
        self.sent: dict[tuple, list[Sent]] = {}

    @staticmethod
    def key(pid: str, action: str, fields: dict[str, str]) -> tuple:
        if action == "/attention":
            return (action, pid, fields["number"])
        if action == "/move":
            return (action, fields["slot"], int(fields["seq"]))
        return (action, fields["slot"])

    def begin(self, pid: str, action: str, fields: dict[str, str], how: str) -> Sent | None:
        if action not in ("/answer", "/attention", "/write", "/stop", "/move"):
            return None
        entry = Sent(fields | {"pid": pid}, time.monotonic(), None, how)
        self.sent.setdefault(self.key(pid, action, fields), []).append(entry)
        return entry

    def acknowledged(self) -> int:
        return sum(1 for all_sent in self.sent.values() if any(one.acknowledged for one in all_sent))

    def check(self, facts: Facts) -> tuple[dict[str, int], "Faults"]:
        """Everything acknowledged must be there once, with what was acknowledged first, and nothing that nobody sent."""
        db = facts.database()
        db.row_factory = sqlite3.Row
        pids = {row["person"]: row["id"] for row in db.execute("SELECT person, id FROM recruit")}
        slots = {row["name"]: row for row in db.execute("SELECT * FROM slot")}
        attention = {(pids.get(row["person"]), str(row["number"])): row for row in db.execute("SELECT * FROM attention")}
        moves = {(row["slot"], row["seq"]): row["viewpoint"] for row in db.execute("SELECT * FROM move")}
        counts, wrong = {}, Faults()
        ended = {}  # a step that arrives after the end of its walk is nothing
        for key, all_sent in self.sent.items():
            times = [one.acknowledged for one in all_sent if one.acknowledged]
            if key[0] in ("/stop", "/answer") and times:
                ended[key[1]] = min(times + [ended.get(key[1], times[0])])
        for key, all_sent in sorted(self.sent.items(), key=str):
            times = [one.acknowledged for one in all_sent if one.acknowledged]
            action, hows = key[0], ", ".join(sorted({one.how for one in all_sent}))
            if action == "/attention":
                row = attention.get((key[1], key[2]))
                kept = None if row is None else str(bool(row["passed"]))
                value = lambda one: "True"  # everybody chooses what is asked for
            else:
                row = slots.get(key[1])
                if row is not None and pids.get(row["person"]) != all_sent[0].fields["pid"]:
                    wrong.add(f"{action}: a slot is somebody else's", key[1])
                kept, value = self.stored(facts, row, moves, action, key)
            if not times:
                counts[f"{action} not acknowledged"] = counts.get(f"{action} not acknowledged", 0) + 1
            else:
                counts[action] = counts.get(action, 0) + 1
                if kept is None:
                    if action == "/move" and all_sent[0].first >= ended.get(key[1], 1e18):
                        continue
                    wrong.add(f"{action}: acknowledged and not there ({hows})", str(key[1:]))
                    continue
            if kept is not None:
                first = min(times) if times else 1e18
                may = [one for one in all_sent if one.first <= first]
                if kept not in [value(one) for one in may]:
                    how = ", ".join(f"{value(one)} by {one.how} at {one.first:.3f}, {'acknowledged' if one.acknowledged else 'not acknowledged'}" for one in all_sent)
                    wrong.add(f"{action}: acknowledged, and another one is kept ({hows})", f"{key[1:]}: kept {kept}, sent {how}")
        answered = {name for name, row in slots.items() if row["answer"] is not None}
        unsent = answered - {key[1] for key in self.sent if key[0] == "/answer"}
        if unsent:
            wrong.add("answers that nobody sent", str(len(unsent)))
        for what in ("item", "route"):
            twice = db.execute(f"SELECT count(*) FROM (SELECT 1 FROM slot GROUP BY person, {what} HAVING count(*) > 1)").fetchone()[0]
            if twice:
                wrong.add(f"somebody has the same {what} twice", f"{twice} times")
        for problem in db.execute("PRAGMA integrity_check"):
            if problem[0] != "ok":
                wrong.add("integrity_check", problem[0])
        db.close()
        return counts, wrong

    @staticmethod
    def stored(facts: Facts, row, moves: dict, action: str, key: tuple):
        if row is None:
            return None, lambda one: None
        if action == "/write":
            return row["own_text"], lambda one: one.fields["own_text"].strip()
        if action == "/stop":
            return (None if row["stopped_ms"] is None else str(row["looks"])), lambda one: one.fields["looks"]
        if action == "/move":
            route = facts.routes[row["route"]]
            here = route["viewpoints"][0] if key[2] == 0 else moves.get((row["id"], key[2] - 1))
            ways = facts.places.get(route["scene"], {}).get(here, {}).get("neighbours", [])
            return moves.get((row["id"], key[2])), lambda one: ways[int(one.fields["to"])] if int(one.fields["to"]) < len(ways) else None
        if row["answer"] is None:
            return None, lambda one: None
        answer = json.loads(row["answer"])
        if answer["mode"] == "pair":
            return answer["choice"], lambda one: one.fields["choice"]
        name, letter = ("ratings", "q") if answer["mode"] == "rate" else ("statements", "s")
        many = len(answer[name])
        return "".join(map(str, answer[name])), lambda one: "".join(one.fields[f"{letter}{at}"] for at in range(many))


# ---- A participant


class Participant:
    """Takes part as a person with the site's script does: a form is sent again, the same, until it is acknowledged."""

    def __init__(self, site: "Site", number: int, seed: str):
        self.site, self.number = site, number
        self.rng = random.Random(f"{seed}/{number}")
        self.pid = hashlib.sha256(f"{seed}/pid/{number}".encode()).hexdigest()[:24]
        self.session = hashlib.sha256(f"{seed}/session/{number}".encode()).hexdigest()[:24]
        self.link = f"/join?PROLIFIC_PID={self.pid}&STUDY_ID={STUDY_ID}&SESSION_ID={self.session}"
        self.browser = Browser(site.port, site.log)
        self.behaviour, self.place = "steady", ""
        self.own_text: str | None = None

    async def pause(self, tries: int, reply: Reply | None) -> None:
        pause = min(30, 2**tries) * self.rng.uniform(0.75, 1.25)
        after = reply.header(b"retry-after") if reply else None
        await asyncio.sleep(max(pause, float(after) if after else 0))

    async def open(self, path: str, browser: Browser | None = None) -> Page:
        """A page by GET. A person presses "reload" until it is there."""
        browser = browser or self.browser
        for tries in range(100):
            reply = None
            try:
                reply = await browser.follow(await browser.send("GET", path))
                page = Page(reply)
                if reply.status != 429 and (reply.status < 500 or page.name == "message" and "All places" in page.text):
                    return page
            except Broken:
                pass
            await self.pause(min(tries, 3), reply)
        raise SystemExit(f"no page after 100 tries: {path}")

    async def submit(self, filled: tuple[str, dict[str, str]], browser: Browser | None = None, how: str | None = None) -> Page:
        """What the page's outbox does."""
        browser = browser or self.browser
        action, fields = filled
        body = urlencode(fields)
        sent = self.site.ledger.begin(self.pid, action, fields, how or self.behaviour)
        for tries in range(100):
            reply = None
            try:
                reply = await browser.send("POST", action, body, action)
                if sent and sent.acknowledged is None and (reply.status == 303 or reply.status == 200):
                    sent.acknowledged = reply.got
                if reply.status >= 400 and reply.status not in (429,) and reply.status < 500:
                    self.site.refused(self, how or self.behaviour, action, reply.status)
                reply = await browser.follow(reply)
                if reply.status < 500 and reply.status != 429:
                    return Page(reply)
                page = Page(reply)
                if "All places" in page.text:
                    return page
            except Broken:
                pass
            await self.pause(tries, reply)
        raise SystemExit(f"not acknowledged after 100 tries: {action}")

    async def look(self, page: Page) -> None:
        if page.picture:
            try:
                reply = await self.browser.send("GET", page.picture, kind="picture")
                if reply.status not in (200, 429):
                    self.site.refused(self, self.behaviour, "picture", reply.status)
            except Broken:
                pass

    def fill(self, page: Page, is_wrong: bool = False) -> tuple[str, dict[str, str]] | None:
        return page.filled(self.site.facts, self.rng, self.own_text, is_wrong)

    def close(self) -> None:
        self.browser.close()


class Site:
    """What the participants of a trial share."""

    def __init__(self, facts: Facts, port: int):
        self.facts, self.port = facts, port
        self.log, self.ledger = Log(), Ledger()
        self.refusals: dict[tuple[str, str, int], int] = {}

    def refused(self, participant: Participant, behaviour: str, action: str, status: int) -> None:
        key = (behaviour, action, status)
        self.refusals[key] = self.refusals.get(key, 0) + 1


def share(values: list[float], part: float) -> float:
    return sorted(values)[min(len(values) - 1, int(len(values) * part))] if values else float("nan")


def write_through(file) -> float:
    """Seconds for a small write to the disk. The file is not buffered."""
    before = time.monotonic()
    file.write(bytes(4096))
    os.fsync(file.fileno())
    return time.monotonic() - before
