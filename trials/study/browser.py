"""A real browser takes part in a study of `wayword study serve`. See README.md beside this file."""

import argparse
import base64
import re
import subprocess
import sys
import time
import tomllib
from pathlib import Path
from urllib.parse import urlsplit

from recorder import Recorder
from selenium import webdriver
from selenium.common.exceptions import WebDriverException
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement

TAGS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]
# Each takes part once, with a link of its own.
RUNS = {
    "desktop": {"size": (1280, 800)},
    "phone": {"size": (390, 844), "touch": True},
    "keys": {"size": (1280, 800), "keys": True},
    "noscript": {"size": (390, 844), "touch": True, "script": False},
    "withdraw": {"size": (390, 844), "touch": True, "leaves": True},
}


class Fault(Exception):
    """Something that a participant would suffer from."""


class Participant:
    def __init__(self, name: str, link: str, options: argparse.Namespace, recorder: Recorder):
        self.name, self.link, self.options, self.recorder = name, link, options, recorder
        self.how = RUNS[name]
        self.keys = self.how.get("keys", False)
        self.script = self.how.get("script", True)
        self.seen: set[str] = set()
        self.faults: list[str] = []
        self.pages = 0
        self.items = 0
        self.disturbed: set[str] = set()
        # The driver cannot click where script is switched off, so the page's script is taken away: all of it is in one file.
        recorder.script = self.script
        chrome = webdriver.ChromeOptions()
        for argument in ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars", "--lang=en"]:
            chrome.add_argument(argument)
        width, height = self.how["size"]
        chrome.add_argument(f"--window-size={width},{height}")
        if self.how.get("touch"):
            chrome.add_experimental_option("mobileEmulation", {"deviceMetrics": {"width": width, "height": height, "pixelRatio": 2.0, "touch": True}})
        chrome.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=chrome, service=webdriver.ChromeService(options.chromedriver) if options.chromedriver else None)
        if not self.how.get("touch"):
            self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    # ---- small tools

    def cdp(self, command: str, **arguments):
        return self.driver.execute_cdp_cmd(command, arguments)

    def js(self, code: str, *arguments):
        return self.driver.execute_script(code, *arguments)

    def find(self, what: str) -> WebElement | None:
        found = self.all(what)
        return found[0] if found else None

    def all(self, what: str) -> list[WebElement]:
        return self.driver.find_elements(By.CSS_SELECTOR, what)

    def place(self) -> tuple[str, str]:
        """Which page is shown, and which one of its kind."""
        for _ in range(100):
            main = self.find("main[data-page]")
            if main:
                try:
                    return main.get_attribute("data-page"), main.get_attribute("data-at")
                except Exception:  # replaced at this moment
                    pass
            time.sleep(0.05)
        raise Fault("a page without <main data-page>: " + self.driver.page_source[:200])

    def wait_for(self, what, seconds: float = 10.0, why: str = "nothing happened"):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                value = what()
            except Exception:  # an element went away with its page
                value = None
            if value:
                return value
            time.sleep(0.03)
        raise Fault(why)

    def fault(self, text: str):
        main = self.find("main[data-page]")
        page = main.get_attribute("data-page") if main else "no page"
        self.faults.append(f"{self.name}, {page}: {text}")
        print(f"  FAULT {self.name}, {page}: {text}", flush=True)

    def console(self, expected: str = ""):
        """Errors in the console are faults; `expected` is a pattern of those that this trial made itself."""
        for line in self.driver.get_log("browser"):
            if line["level"] in ("SEVERE", "WARNING") and not (expected and re.search(expected, line["message"])):
                self.fault("console: " + line["message"])

    # ---- what a hand does

    def press(self, element: WebElement):
        if self.keys:
            self.tab_to(element)
            ActionChains(self.driver).send_keys(Keys.ENTER).perform()
        else:
            self.js("arguments[0].scrollIntoView({block: 'center'})", element)
            element.click()

    def tab_to(self, element: WebElement):
        """Reaches an element with the Tab key alone, and looks whether one sees where the focus is on the way there."""
        for _ in range(120):
            active = self.driver.switch_to.active_element
            if active == element:
                self.look_at_focus()
                return
            ActionChains(self.driver).send_keys(Keys.TAB).perform()
            self.look_at_focus()
        raise Fault("the Tab key does not reach " + element.get_attribute("outerHTML")[:120])

    def look_at_focus(self):
        seen = self.js("""
            const e = document.activeElement;
            if (!e || e === document.body) return 'body';
            const box = e.getBoundingClientRect(), style = getComputedStyle(e);
            const points = [[.5, .5], [.1, .1], [.9, .9], [.1, .9], [.9, .1]].map(([x, y]) => [box.x + x * box.width, box.y + y * box.height]);
            const free = points.some(([x, y]) => { const top = document.elementFromPoint(x, y); return top && (e.contains(top) || (e.labels && [...e.labels].some((l) => l.contains(top)))); });
            const what = e.outerHTML.slice(0, 100);
            if (!free) return 'covered or out of sight: ' + what;
            if (style.outlineStyle === 'none' || parseFloat(style.outlineWidth) < 2) return 'not visibly focused: ' + what;
            return '';""")
        if seen and seen != "body":
            self.fault("focus " + seen)

    def choose(self, name: str, value: str):
        group = self.all(f'input[name="{name}"]')
        wanted = next(one for one in group if one.get_attribute("value") == value)
        if not self.keys:
            label = wanted.find_element(By.XPATH, "./ancestor::label")
            self.js("arguments[0].scrollIntoView({block: 'center'})", label)
            label.click()
        else:
            checked = next((one for one in group if one.is_selected()), None)
            self.tab_to(checked or group[0])
            if not checked:
                ActionChains(self.driver).send_keys(Keys.SPACE).perform()
            for _ in group:
                if wanted.is_selected():
                    break
                ActionChains(self.driver).send_keys(Keys.ARROW_DOWN).perform()
                self.look_at_focus()
        if not wanted.is_selected():
            raise Fault(f"{name}={value} cannot be chosen")

    def write(self, field: WebElement, text: str):
        if self.keys:
            self.tab_to(field)
            ActionChains(self.driver).send_keys(text).perform()
        else:
            field.send_keys(text)

    def send(self, button: WebElement):
        """Presses a button that leads on, and waits for the page after it."""
        before = self.place()
        self.press(button)
        self.wait_for(lambda: self.place() != before, 60, f"the button leads nowhere: {button_text(button)}")
        self.settle()

    def settle(self):
        self.wait_for(lambda: self.js("return document.readyState") == "complete", 20, "the page does not load")
        self.wait_for(lambda: self.js("return [...document.images].every((i) => i.loading === 'lazy' || i.complete)"), 20, "a picture does not load")

    # ---- what is looked at on each page

    def examine(self, kind: str):
        """Once per kind of page: pictures of it, axe in light and dark, 320 pixels."""
        if kind in self.seen:
            return
        self.seen.add(kind)
        stem = self.options.out / f"{self.name}-{len(self.seen):02}-{kind}"
        self.settle()
        self.js("scrollTo(0, 0)")
        self.shot(Path(f"{stem}.png"))
        self.shot(Path(f"{stem}-full.png"), whole=True)
        self.axe("light")
        self.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
        self.axe("dark")
        self.shot(Path(f"{stem}-dark.png"))
        self.cdp("Emulation.setEmulatedMedia", features=[])
        width, height = self.how["size"]
        for narrow, high in [(320, 568), (320, 256)]:
            self.cdp("Emulation.setDeviceMetricsOverride", width=narrow, height=high, deviceScaleFactor=1, mobile=bool(self.how.get("touch")))
            time.sleep(0.1)
            wide = self.js("return document.documentElement.scrollWidth")
            if wide > narrow:
                self.fault(f"at {narrow} pixels it is {wide} wide")
            if (narrow, high) == (320, 568):
                self.axe("320 pixels")
                self.shot(Path(f"{stem}-320.png"), whole=True)
        if self.how.get("touch"):
            self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=2, mobile=True)
        else:
            self.cdp("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        if self.script:
            self.sees_motion(kind)
        if kind != "not-sent":
            self.console()

    def sees_motion(self, kind: str):
        self.cdp("Emulation.setEmulatedMedia", features=[{"name": "prefers-reduced-motion", "value": "reduce"}])
        moving = self.js("return [...document.querySelectorAll('button, a, label')].filter((e) => parseFloat(getComputedStyle(e).transitionDuration) > 0).length")
        if moving:
            self.fault(f"{kind}: {moving} things move although reduced motion is asked for")
        self.cdp("Emulation.setEmulatedMedia", features=[])

    def shot(self, path: Path, whole: bool = False):
        data = self.cdp("Page.captureScreenshot", format="png", captureBeyondViewport=whole, **({"clip": self.page_clip()} if whole else {}))["data"]
        path.write_bytes(base64.b64decode(data))

    def page_clip(self):
        size = self.cdp("Page.getLayoutMetrics")["cssContentSize"]
        return {"x": 0, "y": 0, "width": size["width"], "height": size["height"], "scale": 1}

    def axe(self, what: str):
        if not self.options.axe:
            return
        self.js(self.options.axe_source)
        found = self.driver.execute_async_script("""
            const done = arguments[arguments.length - 1];
            axe.run(document, {runOnly: {type: 'tag', values: arguments[0]}, rules: {'target-size': {enabled: true}}, resultTypes: ['violations']}).then(
              (r) => done(r.violations.map((v) => v.id + ': ' + v.help + ' ' + v.nodes.map((n) => n.html.slice(0, 120) + ' ' + (n.any[0] || n.all[0] || n.none[0] || {}).message).join(' | '))),
              (e) => done(['axe failed: ' + e]));""", TAGS)
        for violation in found:
            self.fault(f"axe ({what}): {violation}")

    # ---- the pages

    def take_part(self):
        self.driver.get(self.link)
        self.settle()
        for _ in range(400):
            page, at = self.place()
            self.pages += 1
            kind = page
            if self.find(".note.wrong"):
                kind += "-error" if self.find("#error") else "-again"
            self.examine(kind)
            if page == "done":
                break
            act = getattr(self, "on_" + page, None)
            if act is None:
                raise Fault(f"the page {page!r}: {self.find('main').text[:200]}")
            act()
            self.console()
        self.reload("the end")
        print(f"  {self.name}: {self.pages} pages, {self.items} items; {self.find('h1').text!r}", flush=True)

    def on_consent(self):
        if self.find("button[value=no]").rect["height"] < self.find("button[value=yes]").rect["height"]:
            self.fault("it is harder to say no than to say yes")
        self.send(self.find("button[value=yes]"))

    def on_understood(self):
        if self.script and "half" not in self.disturbed and not self.keys:
            self.half_filled_in()
        right = self.options.right
        for number, group in enumerate(self.groups()):
            self.choose(group, str(right[number]) if number < len(right) else "0")
        self.send(self.submit())

    def on_watch(self):
        self.film()
        self.write(self.find("textarea"), "Go out of the room <b>&</b> turn left.")
        self.send(self.submit())

    def on_rate(self):
        self.item()
        self.film()
        for number, group in enumerate(self.groups()):
            self.choose(group, str(1 + (self.items + number) % 5))
        self.answer()

    def on_pair(self):
        self.item()
        self.film()
        self.choose("choice", ["a", "b", "tie", "bad"][self.items % 4])
        self.answer()

    def on_follow(self):
        self.item()
        for step in range(3):
            if not self.all(".ways button"):
                break
            if self.script:
                self.look_around()
            self.go(step)
        self.examine("follow-later")
        self.send(self.find(".stop button"))

    def on_follow_after(self):
        for number, group in enumerate(self.groups()):
            self.choose(group, str(1 + (self.items + number) % 5))
        self.answer()

    def on_attention(self):
        legend = self.find("legend").text
        for label in sorted(self.all(".options label"), key=lambda label: -len(label.text)):
            if re.search(rf"\b{re.escape(label.text.strip().lower())}\b", legend.lower()):
                self.choose("choice", label.find_element(By.CSS_SELECTOR, "input").get_attribute("value"))
                break
        self.send(self.submit())

    def submit(self) -> WebElement:
        return self.find("form button.main")

    def groups(self) -> list[str]:
        return list(dict.fromkeys(one.get_attribute("name") for one in self.all("input[type=radio]")))

    def item(self):
        """At the second item the visit is disturbed: a reload, back, a second tab, and a look at the page for leaving."""
        self.items += 1
        if self.items != 2:
            return
        self.reload("a reload")
        place = self.place()
        self.driver.back()
        self.driver.forward()
        self.wait_for(lambda: self.place() == place, 10, "back and forward lead to another place")
        self.settle()
        first = self.driver.current_window_handle
        self.driver.switch_to.new_window("tab")
        self.driver.get(self.recorder.origin + "/")
        if self.place() != place:
            self.fault(f"a second tab shows {self.place()}, the first {place}")
        self.driver.close()
        self.driver.switch_to.window(first)
        if not self.keys:
            self.driver.get(self.link)
            if self.place() != place:
                self.fault(f"the link leads to {self.place()}, not to {place}")
        leave = self.find("a.leave")
        if not leave:
            self.fault("there is no way to stop taking part")
            return
        self.press(leave)
        self.wait_for(lambda: self.place()[0] == "withdraw", 10, "the link does not lead to the page for leaving")
        self.examine("withdraw")
        self.press(self.find("main a.button"))
        self.wait_for(lambda: self.place() == place, 10, "one does not come back from the page for leaving")
        self.settle()
        self.console()

    def reload(self, what: str):
        place = self.place()
        self.driver.refresh()
        self.settle()
        if self.place() != place:
            self.fault(f"after {what} it shows {self.place()}, before {place}")

    def answer(self):
        """Sends an answer; once by a double click beside a second tab, once with its request lost, once with the reply lost."""
        done = self.done()
        if self.script and self.items == 2 and "request" not in self.disturbed:
            self.lossy("request")
        elif self.script and self.items == 3 and "reply" not in self.disturbed:
            self.lossy("reply")
        elif self.script and self.items == 1 and not self.keys:
            self.two_tabs()
        else:
            self.send(self.submit())
        now = self.done()
        if done is not None and now is not None and now not in (done, done + 1):
            self.fault(f"one answer led from {done} to {now} done")

    def done(self) -> int | None:
        progress = self.find("#progress")
        return int(float(progress.get_attribute("value"))) if progress else None

    def lossy(self, what: str):
        self.disturbed.add(what)
        before, sent = self.place(), len(self.recorder.posts)
        self.recorder.losing = what
        self.press(self.submit())
        self.wait_for(lambda: "Not sent yet" in self.find("#net").text, 10, "a lost network is not told")
        self.examine("not-sent")
        self.recorder.losing = ""
        self.wait_for(lambda: self.place() != before, 60, f"with a lost {what} it does not go on")
        self.settle()
        if self.find("#net").text:
            self.fault("it still says: " + self.find("#net").text)
        if len(set(self.recorder.posts[sent:])) != 1:
            self.fault(f"it sent different things: {self.recorder.posts[sent:]}")
        self.console("ERR_|Failed to load resource")

    def two_tabs(self):
        """The same page in two tabs. What one sends shows in the other."""
        before, first = self.place(), self.driver.current_window_handle
        self.driver.switch_to.new_window("tab")
        self.driver.get(self.recorder.origin + "/")
        second = self.driver.current_window_handle
        self.driver.switch_to.window(first)
        button = self.submit()
        self.js("arguments[0].scrollIntoView({block: 'center'})", button)
        ActionChains(self.driver).double_click(button).perform()
        self.wait_for(lambda: self.place() != before, 30, "the answer leads nowhere")
        after = self.place()
        self.driver.switch_to.window(second)
        try:
            self.wait_for(lambda: self.place() == after, 10, f"the second tab still shows {self.place()}, the first {after}")
        except Fault as fault:
            self.fault(str(fault))
        self.driver.close()
        self.driver.switch_to.window(first)
        self.settle()

    def half_filled_in(self):
        """A form that is not complete comes back with an error, and with what was chosen."""
        self.disturbed.add("half")
        groups = self.groups()
        self.choose(groups[0], "0")
        self.driver.refresh()
        self.settle()
        if not self.find(f'input[name="{groups[0]}"][value="0"]').is_selected():
            self.fault("a reload forgets what was chosen")
        if len(groups) < 2:
            return
        self.js("for (const e of document.querySelectorAll('[required]')) e.required = false")
        self.press(self.submit())
        self.wait_for(lambda: self.find("#error"), 10, "an incomplete form brings no error")
        self.console("422")
        self.examine("incomplete")
        if self.js("return document.activeElement.id") != "error":
            self.fault("the focus is not at the error")
        if not self.find(f'input[name="{groups[0]}"][value="0"]').is_selected():
            self.fault("an incomplete form forgets what was chosen")

    def film(self):
        if not self.script:
            self.press(self.find("summary"))
            return
        controls = {name: self.find(f"[data-do={name}]") for name in ["back", "play", "next"]}
        at = self.find(".controls .at")
        frames = int(self.find(".film").get_attribute("data-frames"))
        if not at.text.startswith("Picture 1 "):
            self.fault("the film plays by itself")
        self.press(controls["next"])
        self.wait_for(lambda: at.text.startswith("Picture 2 "), 5, "Next does not show the next picture")
        self.press(controls["back"])
        self.wait_for(lambda: at.text.startswith("Picture 1 "), 5, "Back does not show the picture before")
        self.press(controls["play"])
        self.wait_for(lambda: at.text.startswith("Picture 3 "), 20, "the film does not play")
        self.press(controls["play"])
        if self.keys:
            slider = self.find("[type=range]")
            self.tab_to(slider)
            ActionChains(self.driver).send_keys(Keys.END).perform()
            self.wait_for(lambda: at.text.startswith(f"Picture {frames} "), 5, "the End key does not lead to the last picture")
        self.settle()
        self.examine("film-played")

    def look_around(self):
        view = self.find(".view")
        where = lambda: self.js("return getComputedStyle(arguments[0]).backgroundPositionX", view)
        before = where()
        looks = int(self.find("[name=looks]").get_attribute("value"))
        if self.keys:
            self.tab_to(view)
            ActionChains(self.driver).send_keys(Keys.ARROW_RIGHT).perform()
        else:
            self.press(self.find("[data-turn='30']"))
        self.wait_for(lambda: where() != before, 5, "the view does not turn")
        time.sleep(0.4)
        before = where()
        if self.keys:
            ActionChains(self.driver).send_keys(Keys.ARROW_LEFT).perform()
        else:
            self.js("arguments[0].scrollIntoView({block: 'center'})", view)
            ActionChains(self.driver).move_to_element_with_offset(view, 0, -60).click_and_hold().move_by_offset(-40, 0).move_by_offset(-40, 0).release().perform()
        self.wait_for(lambda: where() != before, 5, "the view does not turn by the mouse or the left arrow")
        time.sleep(0.4)
        if int(self.find("[name=looks]").get_attribute("value")) != looks + 2:
            self.fault("looks are not counted")

    def go(self, step: int):
        before = self.place()
        if self.keys and step == 0:
            self.tab_to(self.find(".view"))
            for _ in range(12):
                if self.find(".view .next"):
                    break
                ActionChains(self.driver).send_keys(Keys.ARROW_RIGHT).perform()
                time.sleep(0.3)
            ActionChains(self.driver).send_keys(Keys.ARROW_UP).perform()
        elif self.script and not self.keys and step == 1 and self.find(".view .next"):
            self.find(".view .next").click()
        else:
            self.press(self.find(".ways button"))
        self.wait_for(lambda: self.place() != before, 20, "it does not go")
        self.settle()
        if self.place()[0] != "follow":
            raise Fault("a step leads to " + self.place()[0])
        if self.script:
            self.wait_for(lambda: self.js("return document.activeElement.className") == "view", 5, "after a step the focus is not at the view")
            said = self.find("#say").get_attribute("textContent")
            if not said.startswith("You moved."):
                self.fault(f"after a step it says {said!r}")

    # ---- a way out

    def withdraws(self):
        """Somebody who stops at once."""
        self.driver.get(self.link)
        self.send(self.find("button[value=yes]"))
        self.press(self.find("a.leave"))
        self.wait_for(lambda: self.place()[0] == "withdraw", 10, "the link does not lead to the page for leaving")
        self.choose("delete", "yes")
        self.send(self.find("form button"))
        if self.place() != ("done", "withdrawn"):
            self.fault(f"after leaving it shows {self.place()}")
        self.examine("withdrawn")
        # Nothing is left by which the site could know this person.
        self.driver.refresh()
        self.settle()
        if self.place()[0] != "message":
            self.fault(f"after leaving and a reload it shows {self.place()}")


def button_text(button: WebElement) -> str:
    try:
        return button.text
    except Exception:
        return "(gone)"


def links(options: argparse.Namespace) -> list[str]:
    """Personal links: as given, from a file, or as a recruiter makes them."""
    given = list(options.url)
    if options.links:
        given += re.findall(r"\S*/t/[\w-]+", Path(options.links).read_text())
    if not given and options.study:
        recruiter = tomllib.loads((options.study / "study.toml").read_text())["recruiter"]
        if recruiter["kind"] == "parameters":
            tag = f"{time.time_ns():x}"
            study = f"&{recruiter['study']}={recruiter.get('only_study') or 'trial'}" if recruiter.get("study") else ""
            given = [f"/join?{recruiter['person']}=p{tag}{n}&{recruiter['session']}=s{tag}{n}{study}" for n in range(len(RUNS))]
    if not given:
        sys.exit("give --url or --links: this study has personal links, and no recruiter")
    return given


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", nargs="?", type=Path, help="folder of a study; it is served for the trial (and so gets participants)")
    parser.add_argument("--wayword", default="wayword", help="the program")
    parser.add_argument("--site", help="a site that runs already, as http://127.0.0.1:8080; without it the study is served")
    parser.add_argument("--url", action="append", default=[], help="a personal link; one per run is used")
    parser.add_argument("--links", help="a file with personal links")
    parser.add_argument("--right", help="the right answers of the questions about the task, as 1,0; without it as study.toml says")
    parser.add_argument("--runs", default=",".join(RUNS), help="which runs (default: %(default)s)")
    parser.add_argument("--axe", type=Path, help="axe.min.js of the npm package axe-core; without it nothing is checked by axe")
    parser.add_argument("--never", action="append", default=[], help="a word that no reply may have, as a system's name; may be given again")
    parser.add_argument("--out", type=Path, required=True, help="folder for the screenshots")
    parser.add_argument("--chromedriver", default=None, help="the driver (default: as found by selenium)")
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    options.axe_source = options.axe.read_text() if options.axe else ""
    settings = tomllib.loads((options.study / "study.toml").read_text()) if options.study else {}
    if options.right is None:
        options.right = [question["right"] for question in settings.get("questions", [])]
    else:
        options.right = [int(one) for one in options.right.split(",") if one]
    given = links(options)
    server = None
    site = options.site
    if not site and not options.study:
        site = "{0.scheme}://{0.netloc}".format(urlsplit(given[0]))
    if not site:
        site = "http://127.0.0.1:18173"
        server = subprocess.Popen([options.wayword, "study", "serve", str(options.study), "--listen", "127.0.0.1:18173"])
    faults: list[str] = []
    try:
        recorder = Recorder(site, options.never)
        for _ in range(100):
            try:
                connection = recorder.connect()
                connection.request("GET", "/style.css")
                connection.getresponse().read()
                break
            except OSError:
                time.sleep(0.1)
        else:
            sys.exit(f"{site} does not answer")
        runs = options.runs.split(",")
        if len(given) < len(runs):
            sys.exit(f"{len(runs)} runs need as many personal links, {len(given)} were given")
        for name, link in zip(runs, given):
            parts = urlsplit(link)
            link = recorder.origin + parts.path + (f"?{parts.query}" if parts.query else "")
            print(name, flush=True)
            participant = Participant(name, link, options, recorder)
            try:
                participant.withdraws() if participant.how.get("leaves") else participant.take_part()
            except (Fault, WebDriverException) as fault:
                participant.fault(str(fault))
                participant.shot(options.out / f"{name}-fault.png", whole=True)
            finally:
                recorder.losing = ""
                faults += participant.faults
                participant.driver.quit()
        faults += recorder.found
        print(f"{recorder.count} replies read, {len(options.never)} words looked for; {len(faults)} faults; pictures in {options.out}")
    finally:
        if server:
            server.terminate()
            server.wait(20)
    for fault in faults:
        print("FAULT", fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
