"""Many participants at once, while the server is killed again and again. See README.md beside this file."""

import argparse
import asyncio
import gc
import math
import os
import sys
import tempfile
import time
from pathlib import Path

from client import Browser, Facts, Faults, Page, Participant, Server, Site, copy_study, share, write_through

# What one person in five does instead of going straight on.
TROUBLE = ["vanish", "reload", "back", "twice", "device", "tab"]
# Seconds after a kill that do not count.
AFTER_KILL_S = 2.0
LIMIT_MS = 100
WRITES = ("/answer", "/attention", "/write", "/stop", "/move")
ITEMS = ("watch", "rate", "pair", "follow", "follow_after", "attention")


class Trial:
    def __init__(self, site: Site, server: Server, options: argparse.Namespace):
        self.site, self.server, self.options = site, server, options
        self.next, self.is_full = 0, False
        self.ends: dict[str, int] = {}
        self.behaviours: dict[str, int] = {}
        self.faults = Faults()
        self.lags: list[float] = []
        self.disks: list[float] = []
        self.samples: list[tuple[int, int, int]] = []
        self.worst = (0, 0, 0)
        self.server_cpu_s = 0.0
        self.total = 0
        self.here: set[Participant] = set()

    # ---- participants

    def behaviour(self, participant: Participant) -> str:
        drawn = participant.rng.random()
        if drawn < self.options.late:
            return "late"
        return participant.rng.choice(TROUBLE) if drawn < self.options.late + self.options.trouble else "steady"

    async def seat(self) -> None:
        """One participant after another, until the study wants no more."""
        while not self.is_full:
            participant = Participant(self.site, self.next, f"{self.options.seed}")
            self.next += 1
            participant.behaviour = self.behaviour(participant)
            self.behaviours[participant.behaviour] = self.behaviours.get(participant.behaviour, 0) + 1
            self.here.add(participant)
            end = await self.takes_part(participant)
            self.here.discard(participant)
            self.ends[end] = self.ends.get(end, 0) + 1
            participant.close()

    async def takes_part(self, participant: Participant) -> str:
        rng, behaviour, seen, old = participant.rng, participant.behaviour, 0, []
        is_wrong = rng.random() < 0.05
        page = await participant.open(participant.link)
        while True:
            participant.place = f"{page.name} {page.status}"
            await participant.look(page)
            await asyncio.sleep(rng.uniform(1, 3))
            if page.name == "done":
                return page.at
            if page.name == "message":
                is_full = "All places" in page.text
                if is_full:
                    if self.is_full:
                        return "no place"
                    await asyncio.sleep(rng.uniform(1, 3))
                elif page.status == 403:
                    self.faults.add(f"a participant ({behaviour}) is not known any more", page.text[page.text.find("<h1") :][:120])
                    return "not known"
                page = await participant.open("/")  # where the page's button leads
                if is_full and page.status == 200 and page.name == "message":
                    self.faults.add("\"Try again\" on the page of a full study leads to a page that knows no study")
                    page = await participant.open(participant.link)
                continue
            is_item = page.name in ITEMS
            seen += is_item
            filled = participant.fill(page, is_wrong and page.at == "0")
            if filled is None:
                self.faults.add("a page without a form", f"{page.name!r} {page.status}")
                return "stuck"
            if is_item and behaviour != "steady" and rng.random() < 0.4:
                if behaviour == "vanish" and seen > 1:
                    return "vanished"
                page = await self.trouble(participant, page, filled, old)
            else:
                page = await participant.submit(filled)
            if is_item:
                old.append(filled)

    async def trouble(self, participant: Participant, page: Page, filled: tuple[str, dict[str, str]], old: list) -> Page:
        rng, behaviour = participant.rng, participant.behaviour
        other = participant.fill(page)  # the same page, perhaps answered otherwise
        if behaviour == "reload":
            again = await participant.open("/")
            if (again.name, again.at) != (page.name, page.at):
                self.faults.add("after a reload another page", f"{again.name} {again.at} instead of {page.name} {page.at}")
            return await participant.submit(participant.fill(again))
        if behaviour == "back" and old:
            action, fields = rng.choice(old)
            changed = {name: rng.choice("12345") if name[0] in "qs" and name[1:].isdigit() else value for name, value in fields.items()}
            if action == "/answer" and "choice" in fields:
                changed["choice"] = rng.choice(["a", "b", "tie", "bad"])
            await participant.submit((action, changed))
            return await participant.submit(filled)
        if behaviour == "twice":
            return (await asyncio.gather(participant.submit(filled), participant.submit(filled)))[0]
        if behaviour == "late":
            await asyncio.sleep(self.options.lease + rng.uniform(1, 4))
            return await participant.submit(filled)
        if behaviour == "tab":
            # The link is opened again in another tab: the cookie is another one then, and the first tab goes on.
            await participant.open(participant.link)
            return await participant.submit(filled)
        if behaviour == "device":
            device = Browser(self.site.port, self.site.log)
            page = await participant.open(participant.link, device)
            there = participant.fill(page)
            if there is None:
                pass
            elif rng.random() < 0.5:
                await asyncio.gather(participant.submit(filled), participant.submit(there, device, "other device"))
            else:
                await participant.submit(there, device, "other device")
                await participant.submit(other or filled)
            # They go on with either.
            if rng.random() < 0.5:
                participant.browser, device = device, participant.browser
            device.close()
            return await participant.open("/")
        return await participant.submit(filled)

    # ---- what happens meanwhile

    async def kill(self) -> None:
        """Kills go by progress, so that all fall into the time in which people answer."""
        kills, wanted = self.options.kills, self.site.facts.demand
        for number in range(kills):
            while self.total < wanted * (number + 0.6) / (kills + 0.6) or self.server.kills and time.monotonic() - self.server.kills[-1] < 3:
                await asyncio.sleep(0.02)
            self.server_cpu_s += self.server.cpu_s()
            self.server.kill()

    async def sample(self) -> None:
        """How full the items are, once a second."""
        while True:
            await asyncio.sleep(1)
            try:
                rows = await asyncio.to_thread(self.counts)
            except Exception:  # the database is being recovered after a kill
                continue
            per_item = self.site.facts.per_item
            for item, answered, live, expired, late in rows:
                over = answered + live - per_item
                if over > self.worst[0]:
                    self.worst = (over, late, item)
                if over > late:
                    self.faults.add("answered and live exceed --per-item by more than the leases that had ended", f"item {item}: {answered} answered, {live} live, {late} after the lease")
            self.total = sum(row[1] for row in rows)
            self.samples.append((self.total, sum(row[2] for row in rows), sum(row[3] + row[4] for row in rows)))
            if sum(min(row[1], per_item) for row in rows) >= self.site.facts.demand:
                self.is_full = True

    def counts(self) -> list[tuple]:
        db = self.site.facts.database()
        try:
            # A lease that ends while the rows are read is taken as ended.
            now = time.time() * 1000 + 50
            return db.execute(
                "SELECT item, sum(state = 'answered'), sum(state = 'live' AND lease_ms > ?1), sum(state = 'live' AND lease_ms <= ?1), "
                "sum(state = 'answered' AND answered_ms > lease_ms) FROM slot WHERE position IS NOT NULL GROUP BY item",
                [now],
            ).fetchall()
        finally:
            db.close()

    async def lag(self) -> None:
        """How late this program itself is: what it measures cannot be finer."""
        while True:
            before = time.monotonic()
            await asyncio.sleep(0.01)
            self.lags.append(time.monotonic() - before - 0.01)

    async def disk(self) -> None:
        """How long the disk takes for a small write beside the database: an acknowledgement cannot be faster."""
        with open(self.site.facts.folder.parent / "probe", "wb", buffering=0) as file:
            while True:
                await asyncio.sleep(0.5)
                self.disks.append(await asyncio.to_thread(write_through, file))

    async def run(self) -> float:
        began = time.monotonic()
        around = [asyncio.create_task(work()) for work in (self.kill, self.sample, self.lag, self.disk)]
        seats = [asyncio.create_task(self.seat()) for _ in range(self.options.people)]
        _, unfinished = await asyncio.wait(seats, timeout=self.options.limit * 60)
        if unfinished:
            self.faults.add(f"participants were still there after {self.options.limit} minutes", ", ".join(sorted(one.place for one in self.here))[:300])
        for task in [*unfinished, *around]:
            task.cancel()
        for result in await asyncio.gather(*seats, *around, return_exceptions=True):
            if isinstance(result, BaseException) and not isinstance(result, asyncio.CancelledError):
                self.faults.add("the trial itself failed", repr(result))
        return time.monotonic() - began

    # ---- what came of it

    def outside(self, sent: float, got: float) -> bool:
        """Whether a request had nothing to do with a kill."""
        return all(got < kill or sent > kill + AFTER_KILL_S for kill in self.server.kills)

    def report(self, took_s: float) -> bool:
        log, facts = self.site.log, self.site.facts
        counts, wrong = self.site.ledger.check(facts)
        wrong.take(self.faults)
        if len(self.server.kills) < self.options.kills:
            wrong.add(f"the server was killed {len(self.server.kills)} times instead of {self.options.kills}: give more --minutes")
        per_item = {item: 0 for item in facts.counted} | {row[0]: row[1] for row in self.counts()}
        late = sum(row[4] for row in self.counts())
        few, many = min(per_item.values()), max(per_item.values())
        if many - few > 1 and not self.options.late:
            wrong.add(f"answers per item differ by more than one: {few} to {many} ({late} after the lease)")
        if few < facts.per_item:
            wrong.add(f"an item has {few} answers of {facts.per_item}")
        honest = ("steady", "reload", "twice", "vanish")
        for (behaviour, action, status), number in sorted(self.site.refusals.items()):
            # The study became full while they read what they consent to.
            if behaviour in honest and (action, status) != ("/consent", 409):
                wrong.add(f"{status} to {action} of participants who did nothing wrong ({behaviour})", f"{number} times")

        print(f"mode {facts.mode}, {len(facts.counted)} items x {facts.per_item} answers, {facts.plan['per_participant']} per participant, lease {self.options.lease} s")
        print(f"{self.next} participants came, {self.options.people} at once; {took_s:.0f} s; {len(self.server.kills)} kills; load of the machine {os.getloadavg()[0]:.1f}")
        table("how they behave", self.behaviours)
        table("how it ended for them", self.ends)
        table("acknowledged and checked", counts)
        table("refused (status)", {f"{behaviour} {action} {status}": number for (behaviour, action, status), number in self.site.refusals.items()})
        print("\nrequest to acknowledgement, milliseconds, outside the 2 s after a kill")
        print(f"{'':24}{'number':>8}{'p50':>8}{'p95':>8}{'p99':>8}{'max':>8}")
        rows = {"writes": WRITES, **{kind: (kind,) for kind in WRITES}, "consent, understood": ("/consent", "/understood"), "pages": ("page",), "pictures": ("picture",)}
        for name, kinds in rows.items():
            times = [(got - sent) * 1000 for kind, status, sent, got in log.asks if kind in kinds and status < 400 and self.outside(sent, got)]
            if times:
                row(name, times)
                if name == "writes" and share(times, 0.95) >= LIMIT_MS:
                    wrong.add(f"p95 of writes is {share(times, 0.95):.0f} ms, and {LIMIT_MS} ms is the limit")
        row("lag of this program", [lag * 1000 for lag in self.lags])
        row("4 KiB to disk, alone", [disk * 1000 for disk in self.disks])
        inside = [(got - sent) * 1000 for kind, status, sent, got in log.asks if kind in WRITES and status == 303 and not self.outside(sent, got)]
        if inside:
            row("writes near a kill", inside)
        back = []
        for kill in self.server.kills:
            after = [got - kill for _, status, sent, got in log.asks if sent > kill and status < 500]
            back += [min(after) * 1000] if after else []
        if back:
            row("kill to first answer", back)
        busy = {}
        for kind, status, sent, got in log.asks:
            if status >= 429 and kind != "full":
                where = "outside" if self.outside(sent, got) else "near a kill"
                busy[f"{status} {where}"] = busy.get(f"{status} {where}", 0) + 1
        for _, at in log.failures:
            where = "outside" if self.outside(at, at) else "near a kill"
            busy[f"no connection, {where}"] = busy.get(f"no connection, {where}", 0) + 1
        table("not answered at once", busy)
        print(f"pages that say that all places are taken: {sum(1 for ask in log.asks if ask[0] == 'full')}")
        writes = sum(1 for kind, status, _, _ in log.asks if kind in WRITES and status == 303)
        cpu = self.server_cpu_s
        print(f"\n{len(log.asks) / took_s:.0f} requests and {writes / took_s:.0f} acknowledged writes per second; server {cpu / took_s:.2f} cores, this program {time.process_time() / took_s:.2f}")
        print(f"answers per item {few} to {many} of {facts.per_item}; answered after the lease: {late}; samples: {len(self.samples)}; most over --per-item: {self.worst[0]} (after the lease there: {self.worst[1]})")
        return wrong.report()


def row(name: str, times: list[float]) -> None:
    print(f"{name:24}{len(times):8}{share(times, 0.5):8.1f}{share(times, 0.95):8.1f}{share(times, 0.99):8.1f}{max(times):8.1f}")


def table(title: str, numbers: dict[str, int]) -> None:
    if numbers:
        print(f"{title}: " + ", ".join(f"{name} {number}" for name, number in sorted(numbers.items())))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--wayword", default="wayword", help="the program")
    parser.add_argument("--study", type=Path, required=True, help="folder of a study; it is copied")
    parser.add_argument("--people", type=int, default=200, help="participants at once")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--minutes", type=float, help="set the answers per item so that it takes about so long")
    parser.add_argument("--lease", type=int, default=15, help="lease_s of the copy")
    parser.add_argument("--trouble", type=float, default=0.2, help="share of participants who make trouble")
    parser.add_argument("--late", type=float, default=0.0, help="share of participants who come back after the lease")
    parser.add_argument("--limit", type=float, default=30, help="minutes after which the trial gives up")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="wayword-load-") as folder:
        per_item = None
        if options.minutes:
            plain = Facts(options.study)
            # A page takes two seconds. Of a participant's pages some are not counted: consent, questions, practice, checks.
            each = {"pair": 1, "rate": 1 + plain.settings.get("write_first", False), "follow": 5}[plain.mode]
            items = plain.plan["per_participant"]
            pages = 2 + each * (items + 1) + plain.settings["attention_checks"]
            per_item = math.ceil(options.minutes * 60 * options.people / 2 * items / pages / len(plain.counted))
        facts = copy_study(options.study, Path(folder) / "study", options.lease, per_item)
        server = Server(options.wayword, facts.folder)
        try:
            server.start()
            server.wait()
            trial = Trial(Site(facts, server.port), server, options)
            gc.freeze()
            took_s = asyncio.run(trial.run())
            trial.server_cpu_s += server.cpu_s()
        finally:
            server.stop()
        return 0 if trial.report(took_s) else 1


if __name__ == "__main__":
    sys.exit(main())
