"""Requests of somebody who wants to read, write or break what is not theirs. See README.md beside this file."""

import argparse
import asyncio
import base64
import csv
import html.parser
import json
import random
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote, quote_plus, urlencode

from client import HOST, STUDY_ID, Facts, Faults, Page, Participant, Server, Site, copy_study, share, write_through

RSS_MIB = 64  # more memory than before
HONEST_S = 1.0  # the longest that somebody honest waits
CLOSED_S = 25.0  # after so long a connection that comes to nothing must be closed
PACE = 120  # hostile requests per second: most strangers' must get past the limit of pace, or they test nothing else

HEADERS = [b"content-security-policy", b"x-content-type-options", b"referrer-policy", b"x-frame-options", b"cache-control",
           b"cross-origin-opener-policy", b"cross-origin-resource-policy", b"permissions-policy"]  # fmt: skip

MARK = "xss7391"
SCRIPTS = [f"<script>{MARK}()</script>", f'"><img src=x onerror={MARK}()>', f"'><svg onload={MARK}()>", f"</textarea><script>{MARK}()</script>",
           f"javascript:{MARK}()", "{{ 7*7 }}{% include 'base.html' %}", f"</title><script>{MARK}()</script>", f"<!--<script>{MARK}()//-->"]  # fmt: skip
SQL = ["' OR '1'='1", "'; DROP TABLE slot; --", "1); DELETE FROM person; --", "' UNION SELECT name FROM person --", '" OR ""="', "x'||(SELECT own_text FROM slot)||'"]
OTHER = ["\r\nX-Injected: 1", "\0", "a\0b", "../../study.toml", "${jndi:ldap://127.0.0.1/a}", "%s%n%x", "-1", "1e309", "9" * 40, "18446744073709551616", "٣", "𝟑", " 3",
         "3 ", "+3", "0x3", "NaN", "true", "[]", "\u202e", "A" * 3000]  # fmt: skip
FILES = ["etc/passwd", "study.toml", "study.db", "plan.json", "items.jsonl", "proc/self/environ", "Cargo.toml"]
STEPS = ["../", "..%2f", "%2e%2e/", "%2e%2e%2f", "..%252f", "%252e%252e%252f", "..\\", "..%5c", "....//", "%c0%ae%c0%ae/", "..;/", "/", "//", "%2f", ".%00./"]
INERT = [f"<script>{MARK}()</script>", f'"><img src=x onerror={MARK}()>', '=HYPERLINK("http://127.0.0.1/","x")', "+1+1", "-2+3+cmd|' /C calc'!A0", "@SUM(1+1)",
         "\t=1+1", "\r=1+1", "\uff1d1+1", "'=1+1", 'a,"b"\r\n=1+1,c', "\\input{/etc/passwd}", "\\write18{id}", "$\\catcode`\\%=12$", f"[x](javascript:{MARK}())",
         f"![x](x\" onerror=\"{MARK}())", f"|a|b|\n|-|-|\n<script>{MARK}()</script>", "'; DROP TABLE slot; --", "{{ 7*7 }}{% for x in y %}", "\u202egnp.exe",
         "a\0b\x1b[31mred\x07", "</script></style></textarea></title>" + f"<script>{MARK}()</script>", f"&lt;script&gt;{MARK}()&lt;/script&gt;", "\U0001f6b6" * 1000]  # fmt: skip


@dataclass(slots=True)
class Attack:
    kind: str
    raw: bytes
    whose: str  # "" for a stranger, else the participant whose session it carries
    replies: int = 1
    is_head: bool = False


class Hostile:
    def __init__(self, site: Site, server: Server, options: argparse.Namespace):
        self.site, self.server, self.options = site, server, options
        self.rng = random.Random(f"hostile/{options.seed}")
        self.faults = Faults()
        self.statuses: dict[str, dict[str, int]] = {}
        self.bare: dict[str, int] = {}
        self.sent = 0
        self.rss: list[float] = []
        self.waits: list[float] = []
        self.disks: list[float] = []
        self.slow: dict[str, list[float]] = {}
        self.victims: list[Participant] = []
        self.attackers: list[Participant] = []
        self.pages: dict[str, Page] = {}
        self.needles: list[tuple[str, bytes, set[str]]] = []
        self.origin = f"http://{HOST}:{server.port}"
        self.makers = [self.forged_session, self.forged_arrival, self.other_slot, self.out_of_turn, self.other_who, self.other_origin, self.method, self.traversal,
                       self.fields, self.recruit, self.sizes, self.broken, self.forwarded, self.pipelined]  # fmt: skip

    def fault(self, kind: str, example: str = "") -> None:
        self.faults.add(kind, example)

    # ---- people

    async def until(self, participant: Participant, items: int, is_written: bool) -> Page:
        """Somebody honest, as far as the item with this number. Practice is one."""
        page = await participant.open(participant.link)
        done, last = 0, ""
        while page.name != "done":
            slot = page.forms.get("/answer") or page.forms.get("/write") or page.forms.get("/move")
            slot = slot.hidden.get("slot", "") if slot else ""
            if slot and slot != last:
                done, last = done + 1, slot
            if slot and done == items and (page.name != "watch" or not is_written):
                break
            page = await participant.submit(participant.fill(page))
        self.pages[participant.pid] = page
        return page

    def person(self, number: int, role: str) -> Participant:
        participant = Participant(self.site, number, f"{role}/{self.options.seed}")
        participant.behaviour = role
        return participant

    async def prepare(self) -> None:
        for number in range(8):
            victim = self.person(number, "victim")
            victim.own_text = f"Private words {self.rng.getrandbits(64):016x} of somebody."
            await self.until(victim, 3, number % 2 == 0)
            self.victims.append(victim)
        for number in range(6):
            attacker = self.person(number, "attacker")
            attacker.own_text = f"Attacker's words {number}."
            await self.until(attacker, 2, number % 2 == 0)
            self.attackers.append(attacker)
        self.probe = self.person(0, "probe")
        await self.until(self.probe, 2, False)
        self.read_needles()

    def read_needles(self) -> None:
        """What no answer may hold, and for whom it is no secret."""
        db = self.site.facts.database()
        people = db.execute("SELECT person.name, recruit.id, recruit.session, person.id FROM person JOIN recruit ON recruit.person = person.id").fetchall()
        for name, pid, session, number in people:
            self.needles += [("a participant's id", value.encode(), {pid}) for value in (name, pid, session)]
            for slot, own_text in db.execute("SELECT name, own_text FROM slot WHERE person = ?", [number]):
                self.needles.append(("another's slot", slot.encode(), {pid}))
                if own_text:
                    self.needles.append(("another's text", own_text.encode(), {pid}))
        db.close()
        for participant in self.victims + self.attackers:
            self.needles.append(("a session", participant.browser.cookies["session"].encode(), set()))
        everybody = {participant.pid for participant in self.victims + self.attackers}
        for item in self.site.facts.items:
            for told in item["texts"]:
                self.needles.append(("the text of an item", told["text"].encode(), everybody))
                if len(told["condition"]) > 3:
                    self.needles.append(("a condition's name", told["condition"].encode(), set()))
        for place in [str(self.site.facts.folder), *(route["name"] for route in self.site.facts.routes)]:
            self.needles.append(("a path or the name of a route", place.encode(), set()))
        secrets = {
            "a file of the system": [b"root:x:0:", b"SQLite format 3", b"PATH=/", b"[recruiter]", b"per_participant", b"[package]"],
            "the inside of the program": [b"panicked", b"RUST_BACKTRACE", b"stack backtrace", b".rs:", b"src/", b"rusqlite", b"sqlite", b"minijinja", b"axum", b"hyper",
                                          b"tokio", b"Failed to ", b"Invalid URL", b"invalid digit", b"deserialize", b"matched route"],  # fmt: skip
        }
        for name, values in secrets.items():
            self.needles += [(name, value, set()) for value in values]

    # ---- requests

    def request(self, method: str, path: str, headers=(), body: bytes | str = b"", origin: str | None = "own", host: str | None = "own", cookie: str = "", version="1.1", close=True) -> bytes:
        body = body.encode("utf-8", "surrogateescape") if isinstance(body, str) else body
        lines = [f"{method} {path} HTTP/{version}"]
        if host is not None:
            lines.append(f"Host: {HOST}:{self.server.port}" if host == "own" else f"Host: {host}")
        if cookie:
            lines.append(f"Cookie: {cookie}")
        if origin is not None and method != "GET":
            lines.append(f"Origin: {self.origin if origin == 'own' else origin}")
        lines += headers
        if body or method in ("POST", "PUT", "PATCH"):
            if not any(line.lower().startswith("content-type") for line in headers):
                lines.append("Content-Type: application/x-www-form-urlencoded")
            if not any(line.lower().startswith(("content-length", "transfer-encoding")) for line in headers):
                lines.append(f"Content-Length: {len(body)}")
        if close:
            lines.append("Connection: close")
        return "\r\n".join(lines).encode("utf-8", "surrogateescape") + b"\r\n\r\n" + body

    def session(self, participant: Participant) -> str:
        return "session=" + participant.browser.cookies["session"]

    def token(self) -> str:
        return base64.urlsafe_b64encode(self.rng.randbytes(16)).decode().rstrip("=")

    def slot(self, participant: Participant) -> str:
        """A slot of this person: the one in hand, or one that was answered."""
        forms = self.pages[participant.pid].forms
        form = forms.get("/answer") or forms.get("/write") or forms.get("/move")
        mine = [one.fields["slot"] for all_sent in self.site.ledger.sent.values() for one in all_sent[:1] if one.fields["pid"] == participant.pid and "slot" in one.fields]
        return self.rng.choice([form.hidden["slot"]] * 2 + mine[:1])

    def who(self, participant: Participant) -> str:
        form = next(iter(self.pages[participant.pid].forms.values()))
        return form.hidden.get("who", "")

    def valid(self, participant: Participant, slot: str | None = None) -> tuple[str, dict[str, str]]:
        """A form that would be kept if the right person sent it."""
        slot = slot or self.slot(participant)
        level = lambda: self.rng.choice("12345")
        rate = {f"q{at}": level() for at in range(4)} | {f"s{at}": level() for at in range(3)} | {"choice": self.rng.choice(["a", "b", "tie", "bad"])}
        return self.rng.choice([("/answer", {"slot": slot} | rate), ("/answer", {"slot": slot} | rate), ("/write", {"slot": slot, "own_text": "Not mine."}),
                                ("/move", {"slot": slot, "seq": "0", "to": "0"}), ("/stop", {"slot": slot, "seq": "0", "looks": "7"}), ("/withdraw", {"delete": "yes"}),
                                ("/withdraw", {"delete": "no"}), ("/attention", {"number": "0", "choice": level()}), ("/understood", {"try": "0", "q0": "2", "q1": "2"})])  # fmt: skip

    def forged_session(self) -> Attack:
        rng, victim = self.rng, self.rng.choice(self.victims)
        true = victim.browser.cookies["session"]
        at = rng.randrange(22)
        near = true[:at] + rng.choice([letter for letter in "AZaz09-_" if letter != true[at]]) + true[at + 1 :]
        forged = rng.choice([self.token(), near, near, true[:-1], true + "A", true.swapcase(), "", '"' + near + '"', self.who(victim), "0" * 22, "A" * 2000, rng.choice(SQL), "null", victim.pid])
        cookie = rng.choice([f"session={forged}", f"session={forged}; session={self.token()}", f"__Host-session={true}", f"Session={true}", f"session ={true}", f"x=session={true}", f"arrival={true}"])
        slot = self.slot(victim)
        if rng.random() < 0.5:
            action, fields = self.valid(victim, slot)
            return Attack("forged session", self.request("POST", action, body=urlencode(fields | rng.choice([{}, {"who": self.who(victim)}])), cookie=cookie), "")
        path = rng.choice(["/", "/withdraw", f"/film/{slot}/0.jpg", f"/look/{slot}/0.jpg", f"/t/{true}", f"/t/{near}", f"/t/{self.token()}", f"/t/{victim.session}"])
        return Attack("forged session", self.request("GET", path, cookie=cookie), "")

    def forged_arrival(self) -> Attack:
        rng, victim = self.rng, self.rng.choice(self.victims)
        recruit = lambda person, study, session: {"recruit": {"person": person, "study": study, "session": session}}
        made = [recruit(victim.pid, STUDY_ID, self.token()), recruit(victim.pid, STUDY_ID, rng.choice(self.victims + self.attackers).session[::-1]), recruit(self.token(), "other", "s"),
                recruit("", STUDY_ID, "s"), recruit(self.token(), STUDY_ID, ""), recruit("A" * 129, STUDY_ID, "s"), recruit(rng.choice(SQL + SCRIPTS), STUDY_ID, "s"),
                recruit("p", STUDY_ID, rng.choice(SQL + SCRIPTS)), {"link": self.token()}, {"link": victim.browser.cookies["session"]}, {"link": rng.choice(SQL)}, {"recruit": None},
                recruit(1, 2, 3), recruit(["a"], STUDY_ID, "s"), [], None, {"admin": True}, recruit(victim.pid + "\0", STUDY_ID, victim.session)]  # fmt: skip
        value = base64.urlsafe_b64encode(json.dumps(rng.choice(made)).encode()).decode().rstrip("=")
        value = rng.choice([value, value, value, value, value[:-3], rng.choice(SQL), base64.urlsafe_b64encode(b"[" * 700).decode().rstrip("="), base64.urlsafe_b64encode(rng.randbytes(60)).decode().rstrip("=")])
        body = urlencode({"agree": rng.choice(["yes", "yes", "yes", "no", "", rng.choice(SCRIPTS)])})
        raw = self.request("POST", "/consent", body=body, cookie="arrival=" + value) if rng.random() < 0.7 else self.request("GET", "/", cookie="arrival=" + value)
        return Attack("forged arrival", raw, "")

    def other_slot(self) -> Attack:
        """A participant with a true session, and the items of others."""
        rng, attacker, victim = self.rng, self.rng.choice(self.attackers), self.rng.choice(self.victims)
        slot, cookie = self.slot(victim), self.session(attacker)
        if rng.random() < 0.3:
            path = rng.choice(["film", "look"])
            return Attack("another's slot", self.request("GET", f"/{path}/{slot}/{rng.randrange(5)}.jpg", cookie=cookie), attacker.pid)
        while True:
            action, fields = self.valid(victim, slot)
            if "slot" in fields:
                break
        fields |= rng.choice([{}, {"who": self.who(attacker)}, {"who": self.who(victim)}])
        body = urlencode(fields)
        if rng.random() < 0.2:
            body = urlencode({"slot": self.slot(attacker)}) + "&" + body  # the last counts
        return Attack("another's slot", self.request("POST", action, body=body, cookie=cookie), attacker.pid)

    def out_of_turn(self) -> Attack:
        """What a participant may not do yet, or not any more."""
        rng, attacker = self.rng, self.rng.choice(self.attackers)
        slot, mode = self.slot(attacker), self.site.facts.mode
        levels = {f"q{at}": "3" for at in range(4)} | {f"s{at}": "3" for at in range(3)} | {"choice": "a"}
        page = self.pages[attacker.pid].name
        options = [("/understood", {"try": "0", "q0": "9", "q1": "9"}), ("/understood", {"try": "1", "q0": "9", "q1": "9"}), ("/understood", {"try": "7", "q0": "1", "q1": "0"}),
                   ("/attention", {"number": rng.choice(["0", "1", "4", "4294967295"]), "choice": rng.choice("12345")}), ("/consent", {"agree": "no"})]  # fmt: skip
        if mode != "follow":
            options += [("/stop", {"slot": slot, "looks": "3"}), ("/move", {"slot": slot, "seq": "0", "to": "0"})]
        else:
            options += [("/move", {"slot": slot, "seq": rng.choice(["5", "199", "200", "18446744073709551615"]), "to": "0"}), ("/move", {"slot": slot, "seq": "0", "to": rng.choice(["99", "18446744073709551615"])})]
        if page in ("watch", "follow"):
            options.append(("/answer", {"slot": slot} | levels))
        action, fields = rng.choice(options)
        return Attack("out of turn", self.request("POST", action, body=urlencode(fields), cookie=self.session(attacker)), attacker.pid)

    def other_who(self) -> Attack:
        """The session of one, the page of another: an old tab on a shared machine."""
        rng, victim = self.rng, self.rng.choice(self.victims)
        action, fields = self.valid(victim)
        who = rng.choice([self.who(rng.choice(self.attackers)), "", self.who(victim)[:-1], self.who(victim) + "0", self.who(victim).upper() + "x", rng.choice(SQL), victim.browser.cookies["session"]])
        return Attack("another's page", self.request("POST", action, body=urlencode(fields | {"who": who}), cookie=self.session(victim)), victim.pid)

    def other_origin(self) -> Attack:
        """A form of another site in the browser of a participant."""
        rng, victim = self.rng, self.rng.choice(self.victims)
        action, fields = self.valid(victim)
        port = self.server.port
        origin = rng.choice([None, "null", "http://evil.example", f"https://{HOST}:{port}", f"http://{HOST}", f"http://{HOST}:{port + 1}", f"http://{HOST}:{port}.evil.example", f"http://localhost:{port}",
                             f"http://evil.example@{HOST}:{port}", f"{self.origin}/", self.origin.upper(), "", " ", "file://", f"http://{HOST}:{port}, http://evil.example", f"http://{HOST}:0{port}"])  # fmt: skip
        headers = rng.choice([[], ["Sec-Fetch-Site: cross-site"], ["Sec-Fetch-Site: same-site"], ["Sec-Fetch-Site: none"], [f"Referer: {self.origin}/"], ["X-Requested-With: XMLHttpRequest"],
                              ["Sec-Fetch-Site: same-origin"] if origin is not None else []])  # fmt: skip
        kind = rng.choice(["application/x-www-form-urlencoded", "text/plain", "multipart/form-data; boundary=x", "application/json"])
        fields |= rng.choice([{}, {"who": self.who(victim)}])
        return Attack("another origin", self.request("POST", action, headers + [f"Content-Type: {kind}"], urlencode(fields), origin, cookie=self.session(victim)), victim.pid)

    def method(self) -> Attack:
        rng, victim = self.rng, self.rng.choice(self.victims)
        action, fields = self.valid(victim)
        method = rng.choice(["GET", "HEAD", "PUT", "DELETE", "PATCH", "OPTIONS", "TRACE", "CONNECT", "PROPFIND", "post", "FOO", "GET"])
        path = action if method != "GET" else f"{'/answer' if action == '/withdraw' else action}?{urlencode(fields)}"
        headers = rng.choice([[], ["X-HTTP-Method-Override: POST"], ["X-Method-Override: POST"], ["X-HTTP-Method: POST"]])
        body = "" if method in ("GET", "HEAD", "CONNECT") else urlencode(fields)
        return Attack("method", self.request(method, path, headers, body, cookie=self.session(victim)), victim.pid, is_head=method == "HEAD")

    def traversal(self) -> Attack:
        rng, person = self.rng, self.rng.choice(self.attackers)
        up, file = rng.choice(STEPS) * rng.randrange(1, 9), rng.choice(FILES)
        slot = self.slot(person)
        path = rng.choice([f"/look/{up}{file}", f"/film/{up}{file}", f"/look/{slot}/{up}{file}", f"/film/{slot}/{up}{file}", f"/film/{slot}/0.jpg/{up}{file}", f"/film/{slot}/{up}{file}.jpg",
                           f"/film/{slot}/{up}{file}%00.jpg", f"/t/{up}{file}", f"/{up}{file}", f"/style.css/{up}{file}", f"/style.css{up}{file}", f"/film/{quote(slot + '/../' + slot, safe='')}/0.jpg",
                           f"/film/{slot}/-1.jpg", f"/film/{slot}/99999999999999999999.jpg", f"/film/{slot}/+1.jpg", f"/look/{slot}/199.jpg", f"file:///{file}", f"/film/{up}/{up}.jpg", f"/static/{up}{file}"])  # fmt: skip
        is_known = rng.random() < 0.6
        return Attack("path", self.request("GET", path, cookie=self.session(person) if is_known else ""), person.pid if is_known else "")

    def fields(self) -> Attack:
        """Script, SQL and odd values in every field; something stays wrong, so that nothing may be kept."""
        rng, attacker = self.rng, self.rng.choice(self.attackers)
        evil = lambda: rng.choice(rng.choice([SCRIPTS, SQL, OTHER]))
        wrong = lambda: rng.choice([value for value in SCRIPTS + SQL + ["0", "6", "-1", "256", "", "3.5", "1e0", "٣"]])
        slot, levels = self.slot(attacker), {f"q{at}": evil() for at in range(4)} | {f"s{at}": evil() for at in range(3)}
        action, fields = rng.choice([
            ("/answer", levels | {"slot": slot, "choice": evil(), "q0": wrong(), "s0": wrong()}), ("/answer", levels | {"slot": evil(), "q0": wrong(), "s0": wrong(), "choice": wrong()}),
            ("/answer", {"slot": rng.choice(SCRIPTS + SQL), "choice": "a"} | {f"q{at}": "3" for at in range(4)} | {f"s{at}": "3" for at in range(3)}),
            ("/write", {"slot": rng.choice(SCRIPTS + SQL), "own_text": evil()}), ("/write", {"slot": slot, "own_text": rng.choice(SCRIPTS) * 60}), ("/move", {"slot": slot, "seq": wrong(), "to": rng.choice(SCRIPTS + SQL)}),
            ("/stop", {"slot": rng.choice(SCRIPTS + SQL), "looks": evil()}), ("/attention", {"number": evil(), "choice": rng.choice(SCRIPTS + SQL)}), ("/understood", {"try": evil(), "q0": rng.choice(SCRIPTS), "q1": evil()}),
            ("/withdraw", {"delete": rng.choice(SCRIPTS + SQL + ["YES", "1", "yes "])}), ("/consent", {"agree": evil()}),
        ])  # fmt: skip
        extra = {evil(): evil()} if rng.random() < 0.3 else {}
        return Attack("fields", self.request("POST", action, body=urlencode(fields | extra), cookie=self.session(attacker)), attacker.pid)

    def recruit(self) -> Attack:
        rng, victim = self.rng, self.rng.choice(self.victims)
        evil = rng.choice(SCRIPTS + SQL + OTHER)
        person, study, session = rng.choice([(victim.pid, STUDY_ID, self.token()), (victim.pid, STUDY_ID, ""), (victim.pid, "other", victim.session), (self.token(), "other", "s"), (evil + "<", STUDY_ID, "s"),
                                             (victim.pid.upper(), "x", victim.session), ("A" * 200, STUDY_ID, "s"), (victim.pid, STUDY_ID + "\0", victim.session), ("", "", "")])  # fmt: skip
        query = urlencode({"PROLIFIC_PID": person, "STUDY_ID": study, "SESSION_ID": session})
        query = rng.choice([query, query, query, query + "&PROLIFIC_PID=%27", query.replace("=", "%3d"), query + "&" + "&".join(f"a{at}={at}" for at in range(800)), "PROLIFIC_PID=%ff%fe&STUDY_ID=%&SESSION_ID=%zz",
                            "PROLIFIC_PID[]=a&PROLIFIC_PID[b]=c", "&&&===", quote_plus(evil), "PROLIFIC_PID=%00", "workerId=a&assignmentId=ASSIGNMENT_ID_NOT_AVAILABLE"])  # fmt: skip
        return Attack("recruiter's link", self.request("GET", f"/join?{query}"), "")

    def sizes(self) -> Attack:
        rng, attacker = self.rng, self.rng.choice(self.attackers)
        cookie, slot = self.session(attacker), self.slot(attacker)
        form = f"slot={slot}&q0=9&own_text="
        make = lambda **more: self.request("POST", "/write", cookie=cookie, **more)
        chunk = b"8000\r\n" + b"a" * 0x8000 + b"\r\n"
        raw = rng.choice([
            lambda: make(body=form + "a" * rng.choice([16 * 1024, 100_000, 1_000_000])),
            lambda: make(body=form + "a" * 20_000, headers=["Expect: 100-continue"]),
            lambda: make(body=form, headers=["Content-Length: 1000000000000"]),
            lambda: make(body=form, headers=["Content-Length: 99999999999999999999999"]),
            lambda: make(body=form, headers=[f"Content-Length: {len(form)}", "Content-Length: 3"]),
            lambda: make(body=form, headers=["Content-Length: -5"]),
            lambda: make(body=form, headers=["Content-Length: +5"]),
            lambda: make(body=form + "a" * 500, headers=["Content-Length: 5"], close=False),
            lambda: make(body=chunk * 40, headers=["Transfer-Encoding: chunked"]),
            lambda: make(body=b"ffffffffffffffff1\r\nabc\r\n", headers=["Transfer-Encoding: chunked"]),
            lambda: make(body=b"zz\r\nabc\r\n0\r\n\r\n", headers=["Transfer-Encoding: chunked"]),
            lambda: make(body=b"5;" + b"x" * 20000 + b"\r\nabcde\r\n0\r\n\r\n", headers=["Transfer-Encoding: chunked"]),
            lambda: make(body=b"1\r\na\r\n0\r\n" + b"X-T: y\r\n" * 3000 + b"\r\n", headers=["Transfer-Encoding: chunked"]),
            lambda: make(body=b"0\r\n\r\nGET / HTTP/1.1\r\n\r\n", headers=["Transfer-Encoding: chunked", "Content-Length: 4"]),
            lambda: make(body=b"0\r\n\r\n", headers=["Transfer-Encoding: gzip, chunked"]),
            lambda: make(body="&".join(f"a{at}=1" for at in range(2500))),
            lambda: make(body="&" * 16000),
            lambda: make(body="own_text=" + "%" * 16000),
            lambda: self.request("GET", "/", headers=["X-Long: " + "a" * 100_000]),
            lambda: self.request("GET", "/", headers=[f"X-{at}: a" for at in range(300)]),
            lambda: self.request("GET", "/", headers=[f"Cookie: c{at}={at}" for at in range(3000)]),
            lambda: self.request("GET", "/", cookie="; ".join(f"c{at}=1" for at in range(2000))),
            lambda: self.request("GET", "/", cookie="; ".join(f"session={self.token()}" for _ in range(300))),
            lambda: self.request("GET", "/?" + "a" * rng.choice([5000, 15000, 70000])),
            lambda: self.request("GET", "/" + "a/" * 6000),
            lambda: self.request("GET", "/film/" + "a" * 9000 + "/0.jpg", cookie=cookie),
        ])()  # fmt: skip
        return Attack("sizes", raw, attacker.pid)

    def broken(self) -> Attack:
        rng, attacker = self.rng, self.rng.choice(self.attackers)
        cookie = self.session(attacker)
        get = self.request("GET", "/")
        raw = rng.choice([
            lambda: self.request("GET", "/t/" + rng.choice(["%", "%zz", "%ff%fe", "%00", "%c3%28", "%ed%a0%80", "%u0041", "\udcff\udcfe", "a\udc80"])),
            lambda: self.request("GET", f"/film/{rng.choice(['%ff', '%00', '%zz', '%'])}/{rng.choice(['%ff', '0', '%00.jpg'])}.jpg", cookie=cookie),
            lambda: self.request("GET", "/\0"),
            lambda: self.request("GET", "/", headers=["X-A: a\0b"]),
            lambda: self.request("GET", "/", cookie="session=\udcff\udcfe"),
            lambda: self.request("POST", "/write", body=b"slot=%ff%fe&own_text=%c3%28\xff\xfe\x00", cookie=cookie),
            lambda: self.request("POST", "/answer", body=b"\xff\xfe" * 50, cookie=cookie),
            lambda: self.request("GET", "/", version=rng.choice(["1.0", "0.9", "2.0", "1.9", "9.9", "1", "", "1.1.1", "-1"])),
            lambda: b"GET /\r\n\r\n",
            lambda: b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n" + bytes(30),
            lambda: b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03" + rng.randbytes(300),
            lambda: rng.randbytes(rng.randrange(1, 2000)) + b"\r\n\r\n",
            lambda: get.replace(b"\r\n", b"\n"),
            lambda: get.replace(b"\r\n", b"\r"),
            lambda: get.replace(b"Host", b" Host"),
            lambda: get.replace(b"Host:", b"Host :"),
            lambda: b"\r\n" * 200 + get,
            lambda: b"GET  /  HTTP/1.1\r\n\r\n",
            lambda: self.request("GET", f"http://evil.example/{rng.choice(['', 'etc/passwd'])}"),
            lambda: self.request("OPTIONS", "*"),
            lambda: self.request("GET", "evil.example:80"),
            lambda: self.request("GET", "/", headers=["Upgrade: h2c", "HTTP2-Settings: AAMAAABkAAQAAP__", "Connection: Upgrade, HTTP2-Settings"]),
            lambda: self.request("GET", "/", headers=["Upgrade: websocket", "Sec-WebSocket-Key: x", "Connection: Upgrade"]),
            lambda: self.request("GET", "/", headers=["Range: bytes=0-18446744073709551615", "If-Modified-Since: never", "Accept-Encoding: gzip;q=nan"]),
        ])()  # fmt: skip
        return Attack("broken", raw, attacker.pid)

    def forwarded(self) -> Attack:
        """Lies about where it comes from and where it goes."""
        rng, victim = self.rng, self.rng.choice(self.victims)
        evil = rng.choice(["evil.example", "127.0.0.1", "localhost", f"{HOST}:{self.server.port}"])
        headers = [f"{name}: {evil}" for name in rng.sample(["X-Forwarded-For", "X-Forwarded-Host", "X-Forwarded-Server", "X-Real-IP", "X-Host", "X-Original-URL", "X-Rewrite-URL", "Forwarded", "True-Client-IP", "Via"], 4)]
        headers += rng.choice([[], ["X-Forwarded-Proto: https"], ["X-Original-URL: /etc/passwd", "X-Rewrite-URL: /study.toml"], ["Forwarded: for=127.0.0.1;host=evil.example;proto=https"]])
        host = rng.choice([None, "", "evil.example", "127.0.0.1", f"{HOST}:{self.server.port}@evil.example", "[::1]", "a" * 300, "evil.example\t", "..", "%00", rng.choice(SCRIPTS)])
        if rng.random() < 0.5:
            action, fields = self.valid(victim)
            # A browser names the page's own origin, whatever else is sent.
            return Attack("host", self.request("POST", action, headers, urlencode(fields), "http://evil.attacker.example", rng.choice(["own", host]), self.session(victim)), victim.pid)
        return Attack("host", self.request("GET", rng.choice(["/", "/join?PROLIFIC_PID=a&STUDY_ID=b&SESSION_ID=c", f"/t/{self.token()}"]), headers, host=host), "")

    def pipelined(self) -> Attack:
        makers = [self.forged_session, self.other_origin, self.other_slot, self.recruit]
        number = self.rng.randrange(2, 6)
        parts = [self.rng.choice(makers)() for _ in range(number)]
        known = {part.whose for part in parts if part.whose}
        raw = b"".join(part.raw.replace(b"\r\nConnection: close", b"") for part in parts[:-1]) + parts[-1].raw
        return Attack("pipelined", raw, ",".join(sorted(known)), number)

    # ---- sending

    async def send(self, attack: Attack) -> None:
        self.sent += 1
        seen = self.statuses.setdefault(attack.kind, {})
        answer = b""
        try:
            reader, writer = await asyncio.wait_for(asyncio.open_connection(HOST, self.server.port), 5)
        except (OSError, asyncio.TimeoutError):
            seen["no connection"] = seen.get("no connection", 0) + 1
            return
        try:
            writer.write(attack.raw)
            async with asyncio.timeout(CLOSED_S):
                while True:
                    part = await reader.read(65536)
                    if not part:
                        break
                    answer += part
        except TimeoutError:
            seen["left open"] = seen.get("left open", 0) + 1
            # A connection that is kept open after a whole answer is none that came to nothing.
            if not answer:
                self.fault(f"{attack.kind}: no answer and no end after {CLOSED_S:.0f} s", repr(attack.raw[:120]))
        except OSError:
            pass
        finally:
            writer.transport.abort()
        self.judge(attack, answer)

    def judge(self, attack: Attack, answer: bytes) -> None:
        seen = self.statuses[attack.kind]
        if not answer:
            seen["closed"] = seen.get("closed", 0) + 1
        rest = answer
        while rest:
            end = rest.find(b"\r\n\r\n")
            if not rest.startswith(b"HTTP/1.") or end < 0:
                self.fault(f"{attack.kind}: not HTTP", repr(rest[:60]))
                break
            head, status = rest[: end + 2], rest[9:12].decode()
            length = re.search(rb"(?i)\r\ncontent-length:\s*(\d+)", head)
            size = 0 if attack.is_head or not length else int(length[1])
            body, rest = rest[end + 4 : end + 4 + size], rest[end + 4 + size :]
            if status == "100":
                continue
            seen[status] = seen.get(status, 0) + 1
            lower = head.lower()
            missing = [name for name in HEADERS if b"\r\n" + name + b":" not in lower]
            if missing and (body or status not in ("400", "431", "414", "505")):
                self.fault(f"{attack.kind}: {status} without {missing[0].decode()}", repr(attack.raw[:120]))
            elif missing:
                self.bare[status] = self.bare.get(status, 0) + 1
            # A body that does not come is answered by "try again", because a slow network sends such bodies too.
            if status[0] == "5" and not (status == "503" and attack.kind in ("slow body", "no end", "sizes")):
                self.fault(f"{attack.kind}: {status}", repr(attack.raw[:120]))
            if b"\r\nx-injected" in lower:
                self.fault(f"{attack.kind}: a header from the request is in the answer")
            if re.search(rb"<script>" + MARK.encode() + rb"|<img src=x onerror|<svg onload|<script>//", body):
                self.fault(f"{attack.kind}: script in a page", repr(attack.raw[:200]))
            if b"data-page" not in body and status[0] in "45" and body:
                self.fault(f"{attack.kind}: {status} is no page of the site", f"{body[:80]!r} to {attack.raw[:80]!r}")
            for name, needle, known in self.needles:
                if needle in head or needle in body:
                    if needle not in attack.raw and not known & set(attack.whose.split(",")):
                        # What stands in the site's own files is no secret.
                        if name == "the inside of the program" and needle in self.own_words:
                            continue
                        self.fault(f"{attack.kind}: {name} in an answer", f"{needle[:40]!r} to {attack.raw[:120]!r}")

    own_words: set[bytes] = set()

    async def wave(self, number: int, pace: float | None) -> None:
        """So many requests, each from a kind by lot, on connections of their own."""
        places, began = asyncio.Semaphore(300), time.monotonic()
        tasks: set[asyncio.Task] = set()

        async def one(attack: Attack) -> None:
            async with places:
                await self.send(attack)

        for at in range(number):
            attack = self.rng.choice(self.makers)() if pace else Attack("flood", self.request("GET", "/"), "")
            task = asyncio.create_task(one(attack))
            tasks.add(task)
            task.add_done_callback(tasks.discard)
            wait = began + at / (pace or 2000) - time.monotonic()
            if wait > 0:
                await asyncio.sleep(wait)
        await asyncio.gather(*tasks)

    async def drip(self, kind: str) -> None:
        """A connection that never gets anywhere: how long the server bears it."""
        self.sent += 1
        attacker = self.rng.choice(self.attackers)
        head = self.request("POST", "/write", [f"Content-Length: {5000}"], b"", cookie=self.session(attacker))
        whole = {"slow head": b"GET / HTTP/1.1\r\nHost: a\r\n" + b"X-A: b\r\n" * 5000, "slow body": head + b"own_text=" + b"a" * 4000,
                 "no end": self.request("POST", "/write", ["Transfer-Encoding: chunked"], b"", cookie=self.session(attacker)) + b"1\r\na\r\n" * 3000, "silent": b""}[kind]  # fmt: skip
        at = len(head) if kind == "slow body" else whole.find(b"\r\n\r\n") + 4 if kind == "no end" else 0
        began, answer = time.monotonic(), b""
        try:
            reader, writer = await asyncio.open_connection(HOST, self.server.port)
            writer.write(whole[:at])
            while time.monotonic() - began < CLOSED_S + 10:
                try:
                    part = await asyncio.wait_for(reader.read(65536), 0.5)
                    if not part:
                        break
                    answer += part
                except asyncio.TimeoutError:
                    step = 6 if kind == "no end" else 1
                    writer.write(whole[at : at + step])
                    at += step
            writer.transport.abort()
        except OSError:
            pass
        took = time.monotonic() - began
        self.slow.setdefault(kind, []).append(took)
        if answer:
            self.statuses.setdefault(kind, {})
            self.judge(Attack(kind, whole[:200], attacker.pid), answer)
        if took > CLOSED_S:
            self.fault(f"{kind}: open after {took:.0f} s")

    # ---- meanwhile

    async def watch_memory(self) -> None:
        while True:
            self.rss.append(self.server.rss_mib())
            await asyncio.sleep(0.2)

    async def watch_disk(self) -> None:
        """How long the disk takes for a small write: nobody can be answered faster who writes."""
        with open(self.site.facts.folder.parent / "probe", "wb", buffering=0) as file:
            while True:
                self.disks.append(await asyncio.to_thread(write_through, file))
                await asyncio.sleep(0.5)

    async def watch_waits(self) -> None:
        """Somebody honest looks at a page each second."""
        while True:
            await asyncio.sleep(1)
            before = time.monotonic()
            await self.probe.open("/")
            self.waits.append(time.monotonic() - before)

    async def honest(self, number: int, role: str = "honest", texts: list[str] | None = None) -> float:
        """Takes part from the link to the end. Returns the longest wait."""
        participant = self.person(number, role)
        page, longest = None, 0.0
        is_slow = role == "honest"
        while page is None or page.name != "done":
            if texts and page and page.name == "watch":
                participant.own_text = texts.pop()
            if is_slow and page:
                await asyncio.sleep(participant.rng.uniform(0.5, 1.5))
            elif role == "writer":
                await asyncio.sleep(0.1)  # below the limit of pace
            before = time.monotonic()
            if page is None:
                page = await participant.open(participant.link)
            else:
                page = await participant.submit(participant.fill(page))
            longest = max(longest, time.monotonic() - before)
            if texts is not None and re.search(rf"<script>{MARK}|<img src=x onerror", page.text):
                self.fault(f"script in the page {page.name} after it was written as a text")
        participant.close()
        return longest

    def rows(self, without: str | None = None) -> dict[str, list[tuple]]:
        """All rows but the signs of life; without those of people of a role."""
        db = self.site.facts.database()
        gone = set()
        if without:
            pids = {self.person(number, without).pid for number in range(50)}
            gone = {person for person, pid in db.execute("SELECT person, id FROM recruit") if pid in pids}
        all_rows = {}
        for table in [name for (name,) in db.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY name")]:
            columns = [row[1] for row in db.execute(f"PRAGMA table_info({table})") if row[1] != "seen_ms"]
            found = [dict(zip(columns, row)) for row in db.execute(f"SELECT {', '.join(columns)} FROM {table}")]
            of = {"person": "id", "move": "slot"}.get(table, "person")
            if table == "move":
                slots = {slot for slot, person in db.execute("SELECT id, person FROM slot") if person in gone}
                found = [row for row in found if row["slot"] not in slots]
            else:
                found = [row for row in found if row.get(of) not in gone]
            all_rows[table] = sorted((tuple(row.items()) for row in found), key=repr)
        db.close()
        return all_rows

    def unchanged(self, before: dict, after: dict, when: str) -> None:
        for table in before:
            lost, made = [row for row in before[table] if row not in after[table]], [row for row in after[table] if row not in before[table]]
            for row in lost[:5]:
                self.fault(f"{when}: a row of {table} is lost or changed", brief(row))
            for row in made[:5]:
                self.fault(f"{when}: a row of {table} is new or changed", brief(row))

    # ---- all of it

    async def run(self) -> None:
        number = self.options.requests
        for path in ("/style.css", "/script.js", "/"):
            reply = await self.person(0, "stranger").browser.send("GET", path)
            self.own_words |= {word for word in (b"src/", b".rs:") if word in reply.body}
        await self.prepare()
        before, started, self.process = self.rows(), self.server.rss_mib(), self.server.process.pid
        self.rss_before = started
        meanwhile = [asyncio.create_task(self.watch_memory()), asyncio.create_task(self.watch_waits()), asyncio.create_task(self.watch_disk())]
        try:
            slow = [self.drip(kind) for kind in ("slow head", "slow body", "no end", "silent") for _ in range(50)]
            flood = min(1500, number // 5)
            await asyncio.gather(self.wave(max(0, (number - 400 - flood) * 6 // 10), PACE), *slow)
            await asyncio.sleep(0.5)
            self.unchanged(before, self.rows(), "nobody else was there")
            people = [asyncio.create_task(self.honest(at)) for at in range(10)]
            await asyncio.sleep(1)
            slow = [self.drip(kind) for kind in ("slow head", "slow body", "no end", "silent") for _ in range(50)]
            await asyncio.gather(self.wave((number - 400 - flood) - (number - 400 - flood) * 6 // 10, PACE), *slow)
            flooded = time.monotonic()
            await asyncio.gather(self.wave(flood, None))
            self.flood_s = time.monotonic() - flooded
            longest = await asyncio.gather(*people)
            self.longest = max(longest)
            self.unchanged(before, self.rows("honest"), "while others took part")
            await asyncio.sleep(2)
            self.afterwards = await self.honest(0, "later")
        finally:
            for task in meanwhile:
                task.cancel()
        await self.inert()
        if self.server.process.poll() is not None:
            self.fault("the server ended")

    async def inert(self) -> None:
        facts = self.site.facts
        self.written = []
        if facts.mode != "rate" or not facts.settings.get("write_first"):
            self.inert_text = "skipped: nobody writes a text in this study"
            return
        texts = INERT * 2
        per_person = facts.plan["per_participant"] + 1
        await asyncio.gather(*[self.honest(at, "writer", texts[at * per_person : (at + 1) * per_person]) for at in range(-(-len(texts) // per_person))])
        out = facts.folder.parent / "results"
        done = await asyncio.to_thread(subprocess.run, [self.options.wayword, "study", "results", str(facts.folder), "--out", str(out)], capture_output=True, text=True, timeout=300)
        if done.returncode:
            self.inert_text = f"skipped: `study results` failed: {done.stderr.strip()[-300:]}"
            return
        files = sorted(path for path in out.rglob("*") if path.is_file())
        db = facts.database()
        kept = {text for (text,) in db.execute("SELECT own_text FROM slot WHERE own_text IS NOT NULL")}
        db.close()
        cells, found = 0, 0
        for path in files:
            text = path.read_bytes().decode("utf-8")
            if path.suffix == ".html":
                look = Inert(text)
                for what in look.found:
                    self.fault(f"{path.name}: what acts in a page", what)
            elif path.suffix == ".csv":
                for row in csv.reader(text.splitlines(keepends=True)):
                    for cell in row:
                        cells += 1
                        found += MARK in cell
                        if cell[:1] in ("=", "+", "-", "@", "\t", "\r", "\n", "\uff1d", "\uff0b", "\uff0d", "\uff20") and not is_number(cell):
                            self.fault(f"{path.name}: a cell begins like a formula", repr(cell[:40]))
                        if re.search("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f\u202a-\u202e\u2066-\u2069]", cell):
                            self.fault(f"{path.name}: a cell has a control character", repr(cell[:40]))
            elif path.suffix == ".md":
                if re.search(rf"<script|<img|<svg|\]\(javascript:", text):
                    self.fault(f"{path.name}: markup of a participant")
            elif path.suffix == ".tex":
                if re.search(r"\\input\{/etc|\\write18|\\catcode", text):
                    self.fault(f"{path.name}: a command of a participant")
            elif path.suffix == ".json":
                json.loads(text)
            elif path.suffix == ".svg" and re.search(r"(?i)<script|\son\w+=", text):
                self.fault(f"{path.name}: script")
        pids = [self.person(number, "victim").pid for number in range(8)]
        for path in files:
            data = path.read_bytes()
            if any(pid.encode() in data for pid in pids):
                self.fault(f"{path.name}: a recruiter's id")
        if not found:
            self.fault("no file of results holds the texts of participants: nothing was tested")
        self.inert_text = f"{len(kept)} texts of participants; {len(files)} files of results, {cells} cells, {found} of them with script"

    def report(self) -> bool:
        if max(self.rss, default=0) - self.rss_before > RSS_MIB:
            self.fault(f"memory grew from {self.rss_before:.0f} to {max(self.rss):.0f} MiB")
        for name, wait in (("somebody at the site meanwhile", max(self.waits, default=0)), ("honest participants meanwhile", self.longest), ("an honest newcomer afterwards", self.afterwards)):
            if wait > HONEST_S:
                self.fault(f"{name} waited {wait:.2f} s")
        counts, wrong = self.site.ledger.check(self.site.facts)
        self.faults.take(wrong)
        for (behaviour, action, status), number in self.site.refusals.items():
            self.fault(f"{number} times {status} to {action} of {behaviour}")
        all_statuses: dict[str, int] = {}
        print(f"mode {self.site.facts.mode}; {self.sent} hostile requests, {len(self.makers)} kinds by lot, 400 slow connections, a flood in {self.flood_s:.1f} s")
        for kind, seen in sorted(self.statuses.items()):
            print(f"  {kind:18}" + ", ".join(f"{status}: {number}" for status, number in sorted(seen.items())))
            if kind != "flood":
                for status, number in seen.items():
                    all_statuses[status] = all_statuses.get(status, 0) + number
        tested = sum(all_statuses.values())
        if all_statuses.get("429", 0) > tested / 10:
            self.fault(f"{all_statuses['429']} of {tested} were only too fast: they tested nothing")
        print("  closed after (s): " + ", ".join(f"{kind} {min(times):.1f} to {max(times):.1f}" for kind, times in sorted(self.slow.items())))
        print(f"answers without the site's headers, all empty, from below the site: {self.bare or 'none'}")
        print(f"memory: {self.rss_before:.1f} MiB before, at most {max(self.rss):.1f} ({max(self.rss) - self.rss_before:+.1f}; limit +{RSS_MIB})")
        print(f"longest wait (s): a page each second {max(self.waits):.3f} (p95 {share(self.waits, 0.95):.3f}), 10 honest participants {self.longest:.3f}, a newcomer afterwards {self.afterwards:.3f}")
        slowest = max(self.site.log.asks, key=lambda ask: ask[3] - ask[2])
        tries = sum(1 for _, status, _, _ in self.site.log.asks if status >= 429) + len(self.site.log.failures)
        print(f"  their slowest request {slowest[3] - slowest[2]:.3f} ({slowest[0]} {slowest[1]}); {tries} of {len(self.site.log.asks)} had to be sent again; a write to disk, alone: p95 {share(self.disks, 0.95):.3f}, max {max(self.disks):.3f}")
        print(f"acknowledged to honest people and checked: {counts}")
        print(f"free text: {self.inert_text}")
        return self.faults.report()


class Inert(html.parser.HTMLParser):
    """What acts in a page, or leads out of it."""

    def __init__(self, text: str):
        super().__init__()
        self.found: list[str] = []
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        if tag in ("script", "iframe", "object", "embed", "form", "base", "link", "img"):
            self.found.append(f"<{tag}> {dict(attributes)}")
        for name, value in attributes:
            value = (value or "").strip().lower()
            if name.startswith("on") or value.startswith(("javascript:", "data:text", "vbscript:")) or name in ("src", "href", "xlink:href", "action") and re.match(r"(\w+:)?//", value):
                self.found.append(f"<{tag} {name}={value[:60]!r}>")


def brief(row: tuple) -> str:
    return ", ".join(f"{name}={value.hex()[:8] if isinstance(value, bytes) else value}" for name, value in row)[:300]


def is_number(cell: str) -> bool:
    return re.fullmatch(r"[+-]?\d+(\.\d+)?([eE][+-]?\d+)?", cell) is not None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--wayword", default="wayword", help="the program")
    parser.add_argument("--study", type=Path, required=True, help="folder of a study; it is copied")
    parser.add_argument("--requests", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="wayword-hostile-") as folder:
        is_rate = Facts(options.study).mode == "rate"
        # No lease ends and no item is full while this runs, so that nothing changes by itself.
        facts = copy_study(options.study, Path(folder) / "study", 36_000, 500, is_rate)
        server = Server(options.wayword, facts.folder)
        try:
            server.start()
            server.wait()
            trial = Hostile(Site(facts, server.port), server, options)
            asyncio.run(trial.run())
        finally:
            server.stop()
        return 0 if trial.report() else 1


if __name__ == "__main__":
    sys.exit(main())
