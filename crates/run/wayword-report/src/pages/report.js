"use strict";
// The script of the pages, without which they show everything too: it filters, sorts, searches and samples the list, and lights
// up the parts of a text with their frames. It loads nothing and sends nothing.
(() => {
  const byId = (id) => document.getElementById(id);

  // ---- The list ----

  const SAMPLE = 20;
  const list = byId("list");
  const controls = byId("controls");

  /** Numbers from 0 to 1 that are the same for the same seed (mulberry32). */
  function randomFrom(seed) {
    let state = seed >>> 0;
    return () => {
      state = (state + 0x6d2b79f5) >>> 0;
      let mixed = Math.imul(state ^ (state >>> 15), state | 1);
      mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
      return ((mixed ^ (mixed >>> 14)) >>> 0) / 4294967296;
    };
  }

  function startList() {
    const rows = Array.from(list.children, (element, worst) => {
      const { kinds = "", style = "", scene = "", place, length, unverified, cost } = element.dataset;
      return {
        element, worst, style, scene,
        kinds: new Set(kinds.split(" ")),
        place: Number(place), length: Number(length), unverified: Number(unverified), cost: Number(cost || 0),
        words: null,
      };
    });
    // In the order of the run, so that a seed draws the same texts however the list is sorted.
    const inRun = rows.slice().sort((a, b) => a.place - b.place || a.worst - b.worst);
    const orders = {
      worst: (a, b) => a.worst - b.worst,
      run: (a, b) => a.place - b.place || a.worst - b.worst,
      unverified: (a, b) => b.unverified - a.unverified || a.worst - b.worst,
      long: (a, b) => b.length - a.length || a.worst - b.worst,
      short: (a, b) => a.length - b.length || a.worst - b.worst,
      cost: (a, b) => b.cost - a.cost || a.worst - b.worst,
    };
    const links = Array.from(document.querySelectorAll("[data-show]"));
    const [find, style, scene, sort, seed] = ["find", "by-style", "by-scene", "sort", "seed"].map(byId);
    const fresh = () => ({ show: "all", style: "", scene: "", sort: "worst", find: "", seed: "" });
    let state = fresh();

    function readAddress() {
      const asked = new URLSearchParams(location.hash.slice(1));
      if (!asked.has("show")) return false;
      state = fresh();
      for (const key of Object.keys(state)) if (asked.has(key)) state[key] = asked.get(key);
      if (!(state.sort in orders)) state.sort = "worst";
      return true;
    }

    function writeAddress() {
      const changed = Object.entries(state).filter(([key, value]) => key === "show" || value !== fresh()[key]);
      const isPlain = changed.length === 1 && state.show === "all";
      const address = isPlain ? location.pathname + location.search : "#" + new URLSearchParams(changed);
      try { history.replaceState(null, "", address); } catch { /* Some browsers refuse it for files. */ }
    }

    function matches(row, asked) {
      if (state.show !== "all" && !row.kinds.has(state.show)) return false;
      if (state.style !== "" && row.style !== state.style) return false;
      if (state.scene !== "" && row.scene !== state.scene) return false;
      if (asked.length === 0) return true;
      row.words ??= row.element.textContent.toLowerCase();
      return asked.every((word) => row.words.includes(word));
    }

    function drawSample(found) {
      const random = randomFrom(Number(state.seed));
      const rest = found.slice();
      for (let at = 0; at < Math.min(SAMPLE, rest.length); at += 1) {
        const other = at + Math.floor(random() * (rest.length - at));
        [rest[at], rest[other]] = [rest[other], rest[at]];
      }
      return rest.slice(0, SAMPLE);
    }

    function update() {
      const asked = state.find.toLowerCase().split(/\s+/).filter(Boolean);
      let found = inRun.filter((row) => matches(row, asked));
      if (state.seed !== "") found = drawSample(found);
      const shown = new Set(found);
      for (const row of rows) row.element.hidden = !shown.has(row);
      list.append(...rows.slice().sort(orders[state.sort]).map((row) => row.element));
      for (const link of links) {
        if (link.dataset.show === state.show) link.setAttribute("aria-current", "true");
        else link.removeAttribute("aria-current");
      }
      find.value = state.find;
      if (style) style.value = state.style;
      if (scene) scene.value = state.scene;
      sort.value = state.sort;
      seed.value = state.seed;
      const drawn = state.seed === "" ? "" : `, drawn with seed ${state.seed}`;
      byId("shown").textContent = `${found.length} of ${rows.length} shown${drawn}`;
      byId("reset").hidden = Object.entries(state).every(([key, value]) => value === fresh()[key]);
    }

    function change(key, value) {
      state[key] = value;
      writeAddress();
      update();
    }

    for (const link of links) {
      link.addEventListener("click", (event) => {
        event.preventDefault();
        change("show", link.dataset.show);
      });
    }
    find.addEventListener("input", () => change("find", find.value));
    sort.addEventListener("change", () => change("sort", sort.value));
    if (style) style.addEventListener("change", () => change("style", style.value));
    if (scene) scene.addEventListener("change", () => change("scene", scene.value));
    seed.addEventListener("change", () => change("seed", seed.value.replace(/\D/g, "").slice(0, 9)));
    byId("sample").addEventListener("click", () => change("seed", String(Math.floor(Math.random() * 1e6))));
    byId("reset").addEventListener("click", () => {
      state = fresh();
      writeAddress();
      update();
      find.focus();
    });
    addEventListener("hashchange", () => { if (readAddress()) update(); });
    controls.hidden = false;
    byId("more").open = matchMedia("(min-width: 52rem)").matches;
    readAddress();
    update();
  }

  if (list && controls) startList();

  // ---- Parts of a text, and their frames ----

  /** What an element of an item is about: the parts of its texts, and the first and last frame. */
  function subjectOf(article, element) {
    const part = element.closest("[data-part]");
    if (part) return { parts: [part.dataset.part], from: Number(part.dataset.from), to: Number(part.dataset.to) };
    const frame = element.closest("[data-frame]");
    if (!frame) return null;
    const number = Number(frame.dataset.frame);
    const holds = ({ dataset }) => Number(dataset.from) <= number && number <= Number(dataset.to);
    const parts = Array.from(article.querySelectorAll("[data-part]")).filter(holds).map(({ dataset }) => dataset.part);
    return parts.length ? { parts, from: number, to: number } : null;
  }

  function lightUp(article, subject) {
    article.classList.toggle("lit", Boolean(subject));
    const isLit = ({ dataset }) => {
      if (!subject) return false;
      if (dataset.part !== undefined) return subject.parts.includes(dataset.part);
      const number = Number(dataset.frame ?? dataset.hop);
      return subject.from <= number && (dataset.hop === undefined ? number <= subject.to : number < subject.to);
    };
    for (const element of article.querySelectorAll("[data-part], [data-frame], [data-hop]")) {
      element.classList.toggle("on", isLit(element));
    }
  }

  for (const article of document.querySelectorAll("article.item")) {
    // What was tapped stays lit until another tap.
    let kept = null;
    const show = (event) => lightUp(article, (event && subjectOf(article, event.target)) || kept);
    article.addEventListener("pointerover", (event) => { if (event.pointerType === "mouse") show(event); });
    article.addEventListener("pointerleave", () => show(null));
    article.addEventListener("focusin", show);
    article.addEventListener("focusout", () => show(null));
    article.addEventListener("click", (event) => {
      if (event.target.closest("a, summary")) return;
      const subject = subjectOf(article, event.target);
      const isSame = subject && kept && subject.parts.join() === kept.parts.join() && subject.from === kept.from;
      kept = isSame ? null : subject;
      lightUp(article, kept);
    });
  }
})();
