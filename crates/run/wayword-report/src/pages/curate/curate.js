"use strict";
// The script of the curators' pages, without which they show everything too: it takes decisions by key or button, keeps them in
// the browser, saves them as a file, and lights up the parts of a text with their frames. It loads nothing and sends nothing.
(() => {
  const byId = (id) => document.getElementById(id);
  const main = byId("pairs");
  const [status, bar, done, dialog] = ["status", "decide", "done", "keys"].map(byId);
  const pairs = Array.from(document.querySelectorAll("article.pair"), (element) => ({
    element, id: JSON.parse(element.dataset.pair), number: element.dataset.number, verdict: element.querySelector(".verdict"), kept: null,
  }));
  const pairOf = new Map(pairs.map((pair) => [pair.id, pair]));
  const now = () => new Date().toISOString();

  function say(words) {
    byId("notice").textContent = words;
    byId("notice").hidden = words === "";
  }

  function warn(words) {
    byId("warning").textContent = words;
    byId("warning").hidden = false;
  }

  // ---- Decisions ----

  // By pair: the decision (null after an undo), when it was made, and what the last saved file says. Each has a key of its own
  // in the browser's store, so that two tabs do not overwrite each other's.
  const STORE = "wayword-curate ";
  const PREFIX = `${STORE}${JSON.stringify(JSON.parse(main.dataset.key))} `;
  const decisions = new Map();
  let isKept = true;
  let isShared = true;

  const decisionOf = (pair) => decisions.get(pair.id)?.decision ?? null;
  const isUnsaved = (entry) => entry.decision !== entry.saved;
  const isDecision = (value) => value === "accept" || value === "reject";

  /** Takes a decision from elsewhere, unless a newer one is known. */
  function take(id, { decision, at, saved }) {
    const time = Math.min(Date.parse(at), Date.now());
    if (Number.isNaN(time) || !(isDecision(decision) || decision === null)) return false;
    const entry = { decision, at: new Date(time).toISOString(), saved: isDecision(saved) ? saved : null };
    const known = decisions.get(id);
    if (known && known.at > entry.at) return false;
    decisions.set(id, entry);
    return true;
  }

  function takeStored(key, text) {
    try {
      return take(key.slice(PREFIX.length), JSON.parse(text));
    } catch {
      return false; // Not written by these pages.
    }
  }

  function stopKeeping() {
    if (isKept) warn("This browser keeps no decisions for this page. They are lost when you leave it: save them as a file (s).");
    isKept = false;
  }

  function readStore() {
    try {
      for (const key of Object.keys(localStorage)) if (key.startsWith(PREFIX)) takeStored(key, localStorage.getItem(key));
      localStorage.setItem(`${STORE}test`, "");
    } catch {
      stopKeeping();
    }
  }

  function keep(id, entry) {
    decisions.set(id, entry);
    if (!isKept) return;
    try {
      localStorage.setItem(PREFIX + id, JSON.stringify(entry));
    } catch {
      stopKeeping();
    }
  }

  function decideAs(pair, decision) {
    const entry = { decision, at: now(), saved: decisions.get(pair.id)?.saved ?? null };
    keep(pair.id, entry);
    return entry;
  }

  const PAUSE_MS = 120_000;
  /** How fast the last decisions were made, without pauses; 0 if there are too few to tell. */
  function pairsAnHour(made) {
    const times = made.map(({ at }) => Date.parse(at)).filter((time) => Date.now() - time < 15 * PAUSE_MS).sort((a, b) => b - a);
    const gaps = times.slice(0, 60).map((time, at) => time - times[at + 1]).filter((gap) => gap < PAUSE_MS);
    const spent = gaps.reduce((sum, gap) => sum + gap, 0);
    return gaps.length < 5 || spent === 0 ? 0 : Math.round((gaps.length * 3_600_000) / spent);
  }

  function save() {
    const made = Array.from(decisions).filter(([, entry]) => entry.decision !== null);
    if (made.length === 0 && !Array.from(decisions.values()).some(isUnsaved)) return say("There are no decisions to save yet.");
    made.sort(([a, first], [b, second]) => (first.at < second.at || (first.at === second.at && a < b) ? -1 : 1));
    const lines = made.map(([pair, { decision, at }]) => `${JSON.stringify({ pair, decision, at })}\n`);
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob(lines, { type: "application/x-ndjson" }));
    link.download = "decisions.jsonl";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
    for (const [id, entry] of decisions) if (isUnsaved(entry)) keep(id, { ...entry, saved: entry.decision });
    update();
    say(`${made.length} decisions were saved as decisions.jsonl.`);
  }

  async function load(file) {
    let [taken, older, here, unread] = [0, 0, 0, 0];
    for (const line of (await file.text()).split("\n")) {
      if (line.trim() === "") continue;
      try {
        const { pair, decision, at } = JSON.parse(line);
        if (typeof pair !== "string" || !isDecision(decision) || Number.isNaN(Date.parse(at))) throw new TypeError("no decision");
        if (pairOf.has(pair)) here += 1;
        if (take(pair, { decision, at, saved: decision })) {
          keep(pair, decisions.get(pair));
          taken += 1;
        } else older += 1;
      } catch {
        unread += 1;
      }
    }
    update();
    if (current && decisionOf(current) !== null) goTo(nextAfter(current));
    const also = [`${here} are of this page`];
    if (older) also.push(`${older} are older than what is known`);
    if (unread) also.push(`${unread} lines hold no decision`);
    say(`${taken} decisions were loaded: ${also.join(", ")}.`);
  }

  // ---- The current pair ----

  let current = null;
  let show = "all";
  const undoable = [];
  const shownPairs = () => pairs.filter(({ element }) => !element.hidden);

  function update() {
    const counts = { all: pairs.length, undecided: 0, rejected: 0 };
    for (const pair of pairs) {
      const decision = decisionOf(pair);
      if (decision === null) counts.undecided += 1;
      if (decision === "reject") counts.rejected += 1;
      pair.element.hidden = (show === "undecided" && decision !== null) || (show === "rejected" && decision !== "reject");
      pair.element.classList.toggle("decided", decision !== null);
      pair.verdict.hidden = decision === null;
      pair.verdict.textContent = { accept: "✓ accepted", reject: "✗ rejected" }[decision] ?? "";
      pair.verdict.className = `mark verdict ${decision === "reject" ? "bad" : "good"}`;
    }
    for (const button of status.querySelectorAll("[data-show]")) {
      button.setAttribute("aria-pressed", String(button.dataset.show === show));
      button.querySelector("b").textContent = counts[button.dataset.show];
    }
    const made = Array.from(decisions.values()).filter(({ decision }) => decision !== null);
    const rejected = made.filter(({ decision }) => decision === "reject").length;
    const unsaved = Array.from(decisions.values()).filter(isUnsaved).length;
    const speed = pairsAnHour(made);
    byId("progress").textContent = `${made.length} of ${main.dataset.total} decided, ${rejected} rejected${speed ? `, ${speed} pairs an hour` : ""}`;
    byId("unsaved").textContent = unsaved ? `(${unsaved} new)` : "";
    byId("meter").style.width = `${Math.min(100, (100 * made.length) / Math.max(1, Number(main.dataset.total)))}%`;
    byId("done-words").textContent = counts.undecided === 0 ? `Every pair of this page is decided.`
      : `${counts.undecided} of the ${counts.all} pairs of this page ${counts.undecided === 1 ? "has" : "have"} no decision yet.`;
  }

  /** How much of an element can be seen between the two bars, and whether that is enough to judge by. */
  function seenOf(element) {
    const { top, bottom, height } = element.getBoundingClientRect();
    const [from, to] = [Math.max(0, status.getBoundingClientRect().bottom), bar.getBoundingClientRect().top];
    const seen = Math.min(bottom, to) - Math.max(top, from);
    return { seen, isEnough: seen >= Math.min(height * 0.7, (to - from) / 3) };
  }

  function bringUp(element) {
    // Twice: elements above may get their true height only when they come near.
    for (let turn = 0; turn < 2; turn += 1) {
      scrollBy({ top: element.getBoundingClientRect().top - status.offsetHeight - 6, behavior: "instant" });
    }
  }

  /** Makes a pair the current one; `null` is the end of the page. */
  function goTo(pair, isBroughtUp = true) {
    if (current && current !== pair) keepLit(current, null);
    current?.element.classList.remove("current");
    current?.element.removeAttribute("aria-current");
    current = pair;
    for (const button of [byId("accept"), byId("reject")]) button.disabled = !pair;
    byId("which").textContent = pair ? `Pair ${pair.number}` : "End";
    pair?.element.classList.add("current");
    pair?.element.setAttribute("aria-current", "true");
    if (isBroughtUp) bringUp(pair ? pair.element : done);
    // Who uses the buttons stays at them, unless they have no more to decide.
    const focused = document.activeElement ?? document.body;
    const isFree = focused === document.body || focused.disabled || (isBroughtUp ? focused.closest("main") && !focused.closest("#status, #decide") : focused.matches(".pair"));
    if (isFree) (pair ? pair.element : byId("next-page") ?? byId("done-title")).focus({ preventScroll: true });
    const shown = shownPairs();
    for (const near of shown.slice(shown.indexOf(pair), shown.indexOf(pair) + 4)) {
      for (const picture of near.element.querySelectorAll("img")) picture.loading = "eager";
    }
  }

  /** After scrolling by hand: the current pair is one that can be seen. */
  function followScroll() {
    if (seenOf(current ? current.element : done).isEnough) return false;
    let [best, most] = [null, 0];
    for (const pair of shownPairs()) {
      const { seen } = seenOf(pair.element);
      if (seen > most) [best, most] = [pair, seen];
    }
    if (!best || best === current) return false;
    goTo(best, false);
    return true;
  }

  function nextAfter(pair, shown = shownPairs()) {
    const at = pairs.indexOf(pair);
    const after = shown.filter((other) => pairs.indexOf(other) > at);
    if (show === "rejected") return after[0] ?? null;
    return after.concat(shown).find((other) => decisionOf(other) === null) ?? null;
  }

  function decide(decision) {
    // What was not on the screen is not decided.
    if (followScroll() || !current) return;
    say("");
    const before = decisionOf(current);
    undoable.push({ pair: current, before, at: decideAs(current, decision).at });
    update();
    goTo(nextAfter(current));
  }

  function undo() {
    say("");
    let pair = current;
    let last;
    do last = undoable.pop(); while (last && decisions.get(last.pair.id).at !== last.at); // Another tab decided since.
    if (last) {
      pair = last.pair;
      decideAs(pair, last.before);
    } else if (pair && decisionOf(pair) !== null) decideAs(pair, null);
    else return say("There is nothing to undo here.");
    update();
    if (pair.element.hidden) filter("all");
    goTo(pair);
  }

  function step(by) {
    const shown = shownPairs();
    const at = current ? shown.indexOf(current) + by : by < 0 ? shown.length - 1 : shown.length;
    if (at >= 0) goTo(shown[at] ?? null);
  }

  function filter(kind) {
    show = kind;
    update();
    if (!current || current.element.hidden) goTo(shownPairs().find((pair) => decisionOf(pair) === null) ?? shownPairs()[0] ?? null);
    else bringUp(current.element);
  }

  // ---- Keys and buttons ----

  const toggleHelp = () => (dialog.open ? dialog.close() : dialog.showModal());
  const turn = (id) => () => (byId(id) ? byId(id).click() : say("There is no such page."));
  const actions = {
    a: () => decide("accept"), r: () => decide("reject"), u: undo, Backspace: undo, s: save, "?": toggleHelp,
    n: turn("next-page"), p: turn("previous-page"),
    j: () => step(1), ArrowDown: () => step(1), k: () => step(-1), ArrowUp: () => step(-1),
  };
  const REPEATED = new Set(["j", "k", "ArrowDown", "ArrowUp"]);

  document.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    if (event.target.closest?.("input:not([type=file]), textarea, select, [contenteditable]")) return;
    // On keyboards with other letters, the key that stands where it does on a Latin one.
    const isLatin = /^[ -~]/.test(event.key) && event.key !== "Process";
    const key = isLatin ? (event.key.length === 1 ? event.key.toLowerCase() : event.key) : event.code.replace(/^Key/, "").toLowerCase();
    if (!Object.hasOwn(actions, key) || (dialog.open && key !== "?")) return;
    event.preventDefault();
    if (!event.repeat || REPEATED.has(key)) actions[key]();
  });
  for (const [id, action] of [["accept", actions.a], ["reject", actions.r], ["undo", undo], ["save", save], ["help", toggleHelp], ["close", toggleHelp]]) {
    byId(id).addEventListener("click", action);
  }
  for (const button of status.querySelectorAll("[data-show]")) button.addEventListener("click", () => filter(button.dataset.show));
  byId("load").addEventListener("change", async ({ target }) => {
    if (target.files.length) await load(target.files[0]);
    target.value = "";
    target.blur();
  });

  let isAwaited = false;
  addEventListener("scroll", () => {
    if (isAwaited) return;
    isAwaited = true;
    requestAnimationFrame(() => {
      isAwaited = false;
      followScroll();
    });
  }, { passive: true });

  // ---- Other pages and tabs ----

  let isTurning = false;
  for (const link of document.querySelectorAll(".pager a, .done a")) {
    link.addEventListener("click", () => {
      if (!isKept || !isShared) return;
      isTurning = true;
      setTimeout(() => { isTurning = false; }, 1000);
      // The other page looks for the time of this, and so learns whether it shares this one's decisions.
      const time = String(Date.now());
      try { localStorage.setItem(`${STORE}turned`, time); } catch { /* Then they are not shared. */ }
      link.hash = `turned-${time}`;
    });
  }
  addEventListener("beforeunload", (event) => {
    if (!isTurning && Array.from(decisions.values()).some(isUnsaved)) event.preventDefault();
  });
  addEventListener("storage", ({ key, newValue }) => {
    if (!key?.startsWith(PREFIX) || newValue === null || !takeStored(key, newValue)) return;
    update();
    if (current?.element.hidden) goTo(nextAfter(current));
  });
  addEventListener("pageshow", (event) => {
    isTurning = false;
    if (!event.persisted) return;
    readStore();
    update();
  });

  function lookForOtherPages() {
    const turned = /^#turned-(\d+)$/.exec(location.hash);
    if (!turned || !isKept) return;
    isShared = Number(localStorage.getItem(`${STORE}turned`)) >= Number(turned[1]);
    if (!isShared) warn("This browser keeps the decisions of each page apart. Save a file (s) on every page.");
    try { history.replaceState(null, "", location.pathname + location.search); } catch { /* Some browsers refuse it for files. */ }
  }

  // ---- Parts of a text, and their frames ----

  /** What an element of a pair is about: the parts of its text, and the first and last frame. */
  function subjectOf(article, element) {
    const part = element.closest("[data-part]")?.dataset;
    if (part) return { parts: [part.part], from: Number(part.from ?? NaN), to: Number(part.to ?? NaN) };
    const frame = element.closest("[data-frame]");
    if (!frame) return null;
    const number = Number(frame.dataset.frame);
    const holds = ({ dataset }) => Number(dataset.from) <= number && number <= Number(dataset.to);
    const parts = Array.from(article.querySelectorAll(".words [data-part]")).filter(holds).map(({ dataset }) => dataset.part);
    return { parts, from: number, to: number };
  }

  function lightUp(article, subject) {
    article.classList.toggle("lit", Boolean(subject));
    for (const element of article.querySelectorAll("[data-part], [data-frame]")) {
      const { part, frame } = element.dataset;
      const isOn = subject && (part === undefined ? subject.from <= Number(frame) && Number(frame) <= subject.to : subject.parts.includes(part));
      element.classList.toggle("on", Boolean(isOn));
    }
  }

  /** What was tapped stays lit until another tap or pair. */
  function keepLit(pair, subject) {
    pair.kept = subject;
    pair.element.classList.toggle("kept", Boolean(subject));
    lightUp(pair.element, subject);
  }

  // A mouse that rests while the page moves under it points to nothing.
  let mouse = "";
  const placeOf = ({ screenX, screenY }) => `${screenX} ${screenY}`;
  const isAtRest = (event) => {
    if (mouse === "") mouse = placeOf(event);
    return placeOf(event) === mouse;
  };
  for (const kind of ["pointermove", "pointerdown"]) addEventListener(kind, (event) => { mouse = placeOf(event); }, { passive: true });

  for (const pair of pairs) {
    const article = pair.element;
    const point = (event) => lightUp(article, (event && subjectOf(article, event.target)) || pair.kept);
    article.addEventListener("pointerover", (event) => { if (event.pointerType === "mouse" && !isAtRest(event)) point(event); });
    article.addEventListener("pointerleave", () => point(null));
    article.addEventListener("focusin", point);
    article.addEventListener("focusout", () => point(null));
    article.addEventListener("click", (event) => {
      if (pair !== current) goTo(pair, !seenOf(article).isEnough);
      const subject = subjectOf(article, event.target);
      if (subject) event.preventDefault();
      const { kept } = pair;
      const isSame = subject && kept && subject.parts.join() === kept.parts.join() && Object.is(subject.from, kept.from);
      keepLit(pair, isSame ? null : subject);
    });
  }

  // ---- Start ----

  try { history.scrollRestoration = "manual"; } catch { /* Then the browser scrolls where it was. */ }
  document.body.classList.add("scripted");
  status.hidden = false;
  bar.hidden = false;
  readStore();
  lookForOtherPages();
  update();
  const asked = pairs.find(({ element }) => `#${element.id}` === location.hash);
  const first = asked ?? pairs.find((pair) => decisionOf(pair) === null) ?? pairs[0] ?? null;
  goTo(first, first !== pairs[0]);
})();
