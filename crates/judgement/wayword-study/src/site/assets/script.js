// The study works without this file: every page is a form. It adds an outbox, so that no answer is lost with the network; a film that plays; and a view that turns.
'use strict';
/* global T: the words of the pages by section, in their language; the server puts them in front of this file. */

const $ = (what, where = document) => where.querySelector(what);
const all = (what, where = document) => [...where.querySelectorAll(what)];
const wait = (ms) => new Promise((done) => setTimeout(done, ms));
const still = matchMedia('(prefers-reduced-motion: reduce)');
const who = () => $('#page').dataset.who;
// Which page this is: two tabs that show the same one need not replace it.
const at = (doc = document) => $('main', doc).dataset.page + '/' + $('main', doc).dataset.at;
const say = (text) => { $('#say').textContent = text; };
const fill = (text, values) => text.replace(/\{(\w+)\}/g, (all, name) => values[name] ?? all);
const net = (text) => { if ($('#net').textContent !== text) $('#net').textContent = text; };

// A browser may refuse storage (private windows, policies). Then all of this works until the page is closed.
function stored(kind) {
  const safely = (act) => { try { return act(window[kind]); } catch { return null; } };
  return {
    get: (key) => safely((box) => box.getItem(key)),
    set: (key, value) => safely((box) => box.setItem(key, value)),
    drop: (key) => safely((box) => box.removeItem(key)),
    keys: () => safely((box) => Object.keys(box)) || [],
  };
}
const kept = stored('localStorage');
const tab = stored('sessionStorage');

// ---- Outbox. An answer is written down before it is sent and struck out only after the server has said that it is on disk.
// The key has the person's mark, so that on a shared machine nothing is sent in the name of the next person.
let busy = false;
const box = () => 'wayword-study ' + who() + ' ';

// What the server takes of a form with texts, bytes, and what a browser sends of one that has to outlive its page.
const LARGEST_FORM = 500000;
const LARGEST_KEPT_ALIVE = 60000;

async function send(answer, leftover) {
  const body = new URLSearchParams(answer.body);
  const keepalive = String(body).length < LARGEST_KEPT_ALIVE;
  for (let tries = 0; ; tries += 1) {
    const slow = setTimeout(() => net(T.script.sending), 800);
    let pause = Math.min(30000, 1000 * 2 ** tries) * (0.75 + Math.random() / 2);
    try {
      const stop = new AbortController();
      const late = setTimeout(() => stop.abort(), 20000);
      const reply = await fetch(answer.url, {
        method: 'POST', body, credentials: 'same-origin', keepalive, signal: stop.signal,
      });
      const doc = new DOMParser().parseFromString(await reply.text(), 'text/html');
      clearTimeout(late);
      // Without our <main> it is the page of a hotel's network or of a proxy, not an answer of the server.
      if (reply.status < 500 && reply.status !== 429 && $('main[data-page]', doc)) {
        // 403: the session is gone, not the answer. It is sent once more when the personal link is opened again.
        if (answer.key && (reply.status !== 403 || leftover)) kept.drop(answer.key);
        return { reply, doc };
      }
      pause = Math.max(pause, 1000 * Number(reply.headers.get('Retry-After')) || 0);
    } catch { /* no network, or too slow: the same again */ } finally { clearTimeout(slow); }
    net(T.script.not_sent);
    await Promise.race([wait(pause), new Promise((done) => addEventListener('online', done, { once: true }))]);
  }
}

addEventListener('submit', async (event) => {
  const form = event.target;
  if (!('submitter' in event)) return;  // an old browser: it cannot tell which button it was, so it sends the form itself
  const pressed = event.submitter;
  event.preventDefault();
  if (busy) return;  // a double click is one answer
  busy = true;
  const body = [...new FormData(form)];
  if (pressed && pressed.name) body.push([pressed.name, pressed.value]);
  if (String(new URLSearchParams(body)).length > LARGEST_FORM) {  // the page stays with what was written
    busy = false;
    net(T.script.too_long);
    return;
  }
  const answer = { url: form.getAttribute('action'), body };
  // Leaving is not kept: who thinks better of it while the network is away must not be taken at the old word.
  if (who() && answer.url !== '/withdraw') {
    answer.key = box() + Date.now() + ' ' + Math.random();
    kept.set(answer.key, JSON.stringify(answer));
  }
  const { reply, doc } = await send(answer);
  if (reply.ok) tab.drop(draft());
  busy = false;
  net('');
  show(doc, reply);
});

// An answer that an earlier visit could not send goes first. To send it twice does no harm: the server counts it once.
async function leftovers() {
  if (!who()) return;
  busy = true;
  const keys = kept.keys().filter((key) => key.startsWith(box())).sort();
  for (const key of keys) {
    try { await send(JSON.parse(kept.get(key)), true); } catch { kept.drop(key); }
  }
  busy = false;
  net('');
  if (keys.length) await refresh();
}

// The server knows where the person is. This page asks when it may be old: after "back", or when another tab has sent something.
async function refresh() {
  if (busy || location.pathname !== '/') return;
  try {
    const reply = await fetch('/', { credentials: 'same-origin', cache: 'no-store' });
    const doc = new DOMParser().parseFromString(await reply.text(), 'text/html');
    if (!busy && reply.ok && $('main[data-page]', doc) && (at(doc) !== at() || $('#page', doc).dataset.who !== who())) show(doc, reply);
  } catch { /* no network: the page stays as it is */ }
}
addEventListener('pageshow', (event) => { if (event.persisted) refresh(); });
addEventListener('storage', (event) => { if (event.key && event.key.startsWith(box()) && !event.newValue) refresh(); });

function show(doc, reply) {
  const walked = $('.walk') && $('.walk', doc) && $('.walk').dataset.slot === $('.walk', doc).dataset.slot;
  $('#page').replaceWith(document.adoptNode($('#page', doc)));
  document.title = doc.title;
  if (reply.ok) history.replaceState(null, '', reply.url);
  start();
  if (walked && !$('#error')) {  // a step: the page stays where it is if the view is in sight, and the keys go on working
    $('.view').scrollIntoView({ block: 'nearest' });
    $('.view').focus({ preventScroll: true });
    const words = all('.ways [data-words]').map((way) => way.dataset.words);
    say(words.length ? fill(T.walk.moved, { ways: words.join('; ') }) : T.walk.moved_no_way);
  } else {
    scrollTo(0, 0);
    ($('#error') || $('h1')).focus({ preventScroll: true });
    say($('.where label')?.textContent || '');
  }
}

// ---- What is filled in but not sent outlives a reload.
const draft = () => 'draft ' + who() + ' ' + at();
addEventListener('input', (event) => {
  const form = event.target.form;
  if (form && who()) tab.set(draft(), JSON.stringify([...new FormData(form)]));
});
function redraft() {
  for (const [name, value] of JSON.parse(tab.get(draft())) || []) {
    for (const field of all(`[name="${CSS.escape(name)}"]`)) {
      if (field.type === 'radio') field.checked = field.value === value;
      else if (field.type === 'textarea') field.value = value;
    }
  }
}

// A picture that did not come is asked for again.
function insist(img) {
  let tries = 0;
  img.addEventListener('error', () => {
    tries += 1;
    if (tries < 6) setTimeout(() => { img.src = img.src; }, 1000 * tries);
    else net(T.script.picture_failed);
  });
  if (img.complete && !img.naturalWidth) img.src = img.src;
}

// ---- Film: one picture after another; nothing plays by itself.
function film(section) {
  const [img, slider, play] = ['.frame', '[type=range]', '[data-do=play]'].map((what) => $(what, section));
  const { slot, frames, perSecond } = section.dataset;
  const alts = all('.frames span', section).map((span) => span.textContent);
  const ready = [img];  // pictures asked for so far
  const seenKey = 'pictures ' + who() + slot;
  const seen = new Set(JSON.parse(tab.get(seenKey)) || []);  // a reload does not begin to count anew
  let n = 0;
  let timer = 0;
  const picture = (k) => {
    if (!ready[k]) { ready[k] = new Image(); insist(ready[k]); ready[k].src = `/film/${slot}/${k}.jpg`; }
    return ready[k];
  };
  const go = (k) => {
    n = Math.max(0, Math.min(frames - 1, k));
    img.src = `/film/${slot}/${n}.jpg`;
    img.alt = alts[n] || '';
    slider.value = n + 1;
    const position = fill(T.film.position, { number: n + 1, pictures: frames });
    slider.setAttribute('aria-valuetext', `${position}. ${img.alt}`);
    $('.at', section).textContent = position;
    seen.add(n);
    tab.set(seenKey, JSON.stringify([...seen]));
    for (const field of all('[name=pictures]')) field.value = seen.size;
    for (let k = n + 1; k < Math.min(n + 5, frames); k += 1) picture(k);
  };
  const pause = () => { clearInterval(timer); timer = 0; play.textContent = T.script.play; };
  const acts = {
    back: () => { pause(); go(n - 1); },
    next: () => { pause(); go(n + 1); },
    play: () => {
      if (timer) { pause(); return; }
      if (n === frames - 1) go(0);
      play.textContent = T.script.pause;
      timer = setInterval(() => {
        if (!section.isConnected || n >= frames - 1) pause();
        else if (picture(n + 1).complete) go(n + 1);  // else it waits for the network
      }, 1000 / perSecond);
    },
  };
  for (const button of all('[data-do]', section)) button.addEventListener('click', acts[button.dataset.do]);
  slider.addEventListener('input', () => { pause(); go(slider.value - 1); });
  $('.controls', section).hidden = false;
  insist(img);
  go(0);
}

// ---- Walk: the picture is a cylinder, its middle is heading 0. It is the ground of the view and repeats, so that one can turn around
// and around. Heights on it are metres for each metre along the floor: the horizon is 0, and the floor 2 m away is -0.75.
const turnTo = (deg) => ((deg % 360) + 540) % 360 - 180;  // into -180..180
const SHOWN_HALF = 0.6;  // of these heights, how much the view shows above and below its middle
let lookAt = -0.2;  // the height in the middle of the view: a little down, to where one goes; it stays from place to place

// The words for a turn, by their key, as in ways.rs.
function directionKey(deg) {
  const turn = Math.abs(deg);
  const side = deg < 0 ? 'left' : 'right';
  if (turn < 15) return 'ahead';
  if (turn > 155) return 'back';
  if (turn < 60) return `slightly_${side}`;
  return turn < 120 ? side : `back_${side}`;
}

// Gives the ways their words for a walker who looks along a heading, and their order from left to right. No two have the same words.
function nameWays(ways, heading) {
  const groups = new Map();
  for (const one of ways) one.turn = turnTo(one.deg - heading);
  ways.sort((a, b) => a.turn - b.turn);
  for (const one of ways) {
    const way = T.walk[directionKey(one.turn)];
    const words = one.stairs ? fill(T.walk[one.stairs], { way }) : way;
    groups.set(words, [...(groups.get(words) || []), one]);
  }
  for (const [words, group] of groups) {
    const [a, b] = group;
    const inLine = group.length === 2 && Math.abs(a.turn - b.turn) < 8 && a.length !== b.length;
    group.forEach((one, rank) => {
      let key = 'numbered_one';
      if (inLine) key = one.length === Math.min(a.length, b.length) ? 'near_one' : 'far_one';
      else if (group.length === 2) key = ['left_one', 'right_one'][rank];
      else if (group.length === 3) key = ['left_one', 'middle_one', 'right_one'][rank];
      one.words = group.length === 1 ? words : fill(T.walk[key], { way: words, number: rank + 1 });
    });
  }
}

// What the keys do. The walk that is shown sets it, so that they work wherever the focus is.
let keyActs = null;
addEventListener('keydown', (event) => {
  if (event.altKey || event.ctrlKey || event.metaKey || event.shiftKey) return;  // alt and left is "back"
  // A long text scrolls by keys, and a field keeps its own.
  if (!$('.walk') || event.target.closest?.('.task, .strip, input, textarea, select, summary')) return;
  const { top, bottom } = $('.view').getBoundingClientRect();
  const act = bottom > 0 && top < innerHeight && keyActs?.[event.key];  // keys scroll the page where the view is not in sight
  if (act) { event.preventDefault(); act(event); }
});

function walk(section) {
  const img = $('.around', section);
  const view = $('.view', section);
  const list = $('.ways ul', section);
  const looksKey = 'looks ' + who() + section.dataset.slot;
  const looksField = $('[name=looks]');
  let heading = Number(section.dataset.facing);
  let looks = Number(tab.get(looksKey));

  const ways = all('.ways [data-deg]', section).map((way) => {
    const go = document.createElement('button');
    go.type = 'button';
    go.tabIndex = -1;  // the same way is a button in the list below, for keys and screen readers
    go.className = 'go';
    const { deg, length, metres, spotDeg, spotSlope, stairs } = way.dataset;
    go.textContent = fill(T.walk[stairs ? `spot_${stairs}` : 'spot'], { metres });
    go.hidden = spotDeg === undefined;  // the picture does not show the floor of this way
    go.addEventListener('click', () => way.click());
    const one = {
      deg: Number(deg), spotDeg: Number(spotDeg), slope: Number(spotSlope), stairs, length: Number(length), metres, way, go,
    };
    way.addEventListener('focus', draw);
    way.addEventListener('blur', draw);
    return one;
  });
  const marks = document.createElement('div');
  marks.setAttribute('aria-hidden', 'true');
  marks.append(...ways.map((one) => one.go));
  const notice = document.createElement('p');
  notice.className = 'notice';
  notice.hidden = true;
  notice.setAttribute('aria-hidden', 'true');
  view.append(marks, notice);

  // The way that arrow up takes: the nearest to the middle, if it is about in front.
  const ahead = () => ways.filter((one) => Math.abs(turnTo(one.deg - heading)) < 60)
    .sort((a, b) => Math.abs(turnTo(a.deg - heading)) - Math.abs(turnTo(b.deg - heading)))[0];
  const half = () => Math.PI * (img.naturalHeight / img.naturalWidth || 0.17);  // of the whole picture, in heights
  const shown = () => Math.min(half(), SHOWN_HALF);
  const perRad = () => view.clientHeight / (2 * shown());  // pixels
  const perDeg = () => perRad() * Math.PI / 180;
  const middle = () => Math.max(shown() - half(), Math.min(half() - shown(), lookAt));

  function draw() {
    const across = view.clientWidth / 2;
    const down = view.clientHeight / 2;
    const focused = ways.find((one) => one.way === document.activeElement);
    const next = focused || ahead();
    view.style.backgroundSize = `auto ${2 * half() * perRad()}px`;
    view.style.backgroundPosition = `${across - (heading + 180) * perDeg()}px ${down - (half() - middle()) * perRad()}px`;
    const placed = [];
    // The nearest first: they keep their places, and what would cover them moves up, as if it were farther away.
    for (const one of ways.filter((way) => !way.go.hidden).sort((a, b) => a.slope - b.slope)) {
      const [width, height] = [one.go.offsetWidth, one.go.offsetHeight];
      const x = across + turnTo(one.spotDeg - heading) * perDeg();
      let y = down - (one.slope - middle()) * perRad();
      y = Math.max(height / 2 + 4, Math.min(view.clientHeight - height / 2 - 4, y));
      for (const other of placed) {
        if (Math.abs(other.x - x) < (other.width + width) / 2 && Math.abs(other.y - y) < (other.height + height) / 2 + 2) {
          y = other.y - (other.height + height) / 2 - 2;
        }
      }
      placed.push({ x, y, width, height });
      placed.sort((a, b) => b.y - a.y);
      one.go.style.transform = `translate(${x - width / 2}px, ${y - height / 2}px)`;
      one.go.classList.toggle('next', one === next);
    }
  }
  // The names and the order of the list follow where one looks.
  function rename() {
    const focused = document.activeElement;
    nameWays(ways, heading);
    for (const one of ways) {
      one.way.textContent = fill(T.walk.go, { way: one.words, metres: one.metres });
      one.way.dataset.words = one.words;
      list.append(one.way.parentElement);
    }
    if (list.contains(focused)) focused.focus({ preventScroll: true });
  }
  function looked() {
    notice.hidden = true;
    looks += 1;
    looksField.value = looks;
    tab.set(looksKey, looks);
  }
  // Says something to everybody: over the picture, and to screen readers.
  let quiet = 0;
  function tell(text) {
    say(text);
    notice.textContent = text;
    notice.hidden = false;
    clearTimeout(quiet);
    quiet = setTimeout(() => { notice.hidden = true; }, 3000);
  }
  let turning = null;  // where the turn that is under way ends
  function turn(by) {
    looked();
    const from = heading;
    const to = (turning ?? heading) + by;
    const began = performance.now();
    const step = (now) => {
      if (turning !== to || !view.isConnected) return;
      const part = still.matches ? 1 : Math.min(1, Math.max(0, (now - began) / 180));
      heading = from + (to - from) * part;
      if (part === 1) { turning = null; rename(); } else requestAnimationFrame(step);
      draw();
    };
    turning = to;
    step(began);
    const next = ways.find((one) => Math.abs(turnTo(one.deg - to)) < 20);
    const turned = by < 0 ? T.walk.turned_left : T.walk.turned_right;
    say(next ? `${turned} ${fill(T.walk.way_in_front, { metres: next.metres })}` : turned);
  }
  function look(up) {
    const before = middle();
    lookAt = before + up * 0.25;
    lookAt = middle();
    if (lookAt === before) { tell(up > 0 ? T.walk.no_higher : T.walk.no_lower); return; }
    looked();
    say(up > 0 ? T.walk.looked_up : T.walk.looked_down);
    draw();
  }

  let held = null;
  view.addEventListener('pointerdown', (event) => {
    if (event.button || event.target.closest('.go')) return;
    held = { x: event.clientX, y: event.clientY, heading, height: middle() };
    turning = null;
    view.setPointerCapture(event.pointerId);
  });
  view.addEventListener('pointermove', (event) => {
    if (!held) return;
    heading = held.heading - (event.clientX - held.x) / perDeg();
    lookAt = held.height + (event.clientY - held.y) / perRad();
    draw();
  });
  const drop = () => {
    if (held && (Math.abs(heading - held.heading) > 2 || Math.abs(middle() - held.height) > 0.05)) { looked(); rename(); }
    lookAt = middle();
    held = null;
  };
  for (const end of ['pointerup', 'pointercancel']) view.addEventListener(end, drop);
  for (const button of all('[data-look]', section)) button.addEventListener('click', () => look(Number(button.dataset.look)));
  for (const button of all('[data-turn]', section)) button.addEventListener('click', () => turn(Number(button.dataset.turn)));
  keyActs = {
    ArrowLeft: () => turn(-30),
    ArrowRight: () => turn(30),
    PageUp: () => look(1),
    PageDown: () => look(-1),
    ArrowUp: (event) => {
      if (event.repeat) return;
      if (ahead()) ahead().way.click(); else tell(T.walk.no_way_ahead);
    },
  };

  looksField.value = looks;
  for (const one of all('.view, .turns, #keys', section)) one.hidden = false;
  $('.strip', section).hidden = $('.strip-note', section).hidden = true;
  $('.ways-note', section).textContent = T.walk.ways_note;
  const loaded = () => {
    view.style.backgroundImage = `url("${img.src}")`;
    for (const button of all('[data-look]', section)) button.hidden = half() <= shown();
    draw();
  };
  img.addEventListener('load', loaded);
  insist(img);
  if (img.complete && img.naturalWidth) loaded();
  draw();
  new ResizeObserver(draw).observe(view);
  // The text stays on top: what gets the focus must not come to lie under it. If it is long, it scrolls by keys too.
  const task = $('.task');
  const fade = () => task.classList.toggle('more', task.scrollTop + task.clientHeight < task.scrollHeight - 2);
  task.addEventListener('scroll', fade);
  new ResizeObserver(() => {
    if (!task.isConnected) return;
    const sticks = getComputedStyle(task).position === 'sticky';
    document.documentElement.style.scrollPaddingTop = sticks ? `${task.offsetHeight + 8}px` : '';
    const rest = task.scrollHeight > task.clientHeight + 1;
    fade();
    if (rest) task.tabIndex = 0; else task.removeAttribute('tabindex');
  }).observe(task);
}

function start() {
  document.documentElement.style.scrollPaddingTop = '';
  all('.film').forEach(film);
  all('.walk').forEach(walk);
  // Coarse: the server keeps it to the nearest 50 pixels.
  const pointer = matchMedia('(pointer: coarse)').matches ? 'touch' : 'mouse';
  for (const field of all('[name=window]')) field.value = `${innerWidth} ${innerHeight} ${devicePixelRatio} ${pointer}`;
  redraft();
}
start();
leftovers();
