"""Drives browsers that look into a running simulation: browse_live.py SIMVIS_RUN FOLDER_WITH_SCENE_XML.

Ends with 1 and says what is wrong; ends with 77 and the reason where there is no browser.
"""
import csv
import json
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import accessible
from browser import Browser
from live_host import LiveHost
from seen import LEAST_COLOURS, colours_of_view, panel_bytes, without_exif

PAGE = "(await import('simvis/main.js')).page"
ROW = "[role=treeitem][data-kind={}][data-name={}]"
SLIDER, FIELD = ("[data-element=MOVE] .parameter:nth-of-type(1) input[type=%s]" % kind for kind in ("range", "number"))
VALUE_OF = f"(async () => {{ const {{values, scene}} = {PAGE}; " \
           "return values[scene().parameters.findIndex((each) => each?.element === 'MOVE' && each.name === '%s')]; })()"

# The ranges that the page shows are those of the CSV: true or false.
SHOWS_SCAN = f"""
(async () => {{
  const {{scans, scene}} = {PAGE};
  const scan = scans.get(scene().sensors.findIndex(({{name}}) => name === "SCAN"));
  const expected = %s.map(Math.fround);
  const shown = scan?.columns.get("range_m").values;
  return shown !== undefined && shown.length === expected.length && expected.every((range, i) => range === shown[i]);
}})()
"""

# Both ends of the arrow that drags along z, in pixels of the window.
ARROW = f"""
(async () => {{
  const {{dragging, view}} = {PAGE}, {{proxy, controls}} = dragging;
  const area = view.canvas.getBoundingClientRect();
  const size = proxy.position.distanceTo(view.camera.position) * controls.size / 7;
  return [0.7, 1.7].map((along) => {{
    const place = proxy.position.clone().set(0, 0, along * size).applyQuaternion(proxy.quaternion).add(proxy.position);
    place.project(view.camera);
    return [area.left + (place.x + 1) / 2 * area.width, area.top + (1 - place.y) / 2 * area.height];
  }});
}})()
"""


def measured_with(program, folder, value):
    """The ranges, and the picture of CAM, of a run of the same scene: JavaScript, bytes."""
    out = folder / f"expected_{value}"
    subprocess.run([program, "--quiet", "--set", f"MOVE.x={value}", "--out", out, folder / "scene.xml"], check=True)
    with open(out / "SCAN.csv", encoding="ascii") as lines:
        ranges = [row["range_m"] for row in csv.DictReader(lines)]
    png = without_exif((out / "CAM" / "000000.png").read_bytes())
    return f"[{', '.join(ranges).replace('inf', 'Infinity')}]", png


class Checks:
    def __init__(self, program, folder):
        self.program, self.folder, self.wrong = program, folder, []

    def expect(self, condition, what):
        if not condition:
            self.wrong.append(what)

    def shows(self, page, value, who):
        """Waits until the page shows what is measured with this x of MOVE."""
        ranges, png = measured_with(self.program, self.folder, value)
        page.wait_for(SHOWS_SCAN % ranges, f"{who} shows the scan of MOVE.x={value}")
        for _ in range(200):
            if panel_bytes(page) == png:
                return
        self.wrong.append(f"{who}: the panel does not hold the bytes of the PNG of MOVE.x={value}")

    def selection(self, page):
        page.click_on(ROW.format("part", "ROBOT"))
        self.expect(page.run("document.documentElement.dataset.selected") == "part ROBOT", "a click in the tree selects")
        page.run("document.getElementById('view').focus()")
        page.press("f")
        page.press("Escape")
        self.expect(page.run("document.documentElement.dataset.selected") == "", "Escape selects nothing")
        colours = colours_of_view(page)
        self.expect(colours >= LEAST_COLOURS, f"the view has {colours} colours")
        left, top, width, height = page.area("#view")
        page.click(left + width / 2, top + height / 2)
        page.wait_for("document.querySelector('[role=treeitem][aria-selected=true]')?.dataset.name === 'ROBOT'",
                      "a click in the view selects in the tree")

    def slider(self, pages):
        left, top, width, height = pages[0].area(SLIDER)
        before, middle = pages[0].run(VALUE_OF % "x"), top + height / 2
        pages[0].drag((left + width / 2, middle), (left + 0.55 * width, middle))
        value = pages[0].wait_for(f"(async () => {{ const x = await {VALUE_OF % 'x'}; return x !== {before} && "
                                  f"x === Number(document.querySelector({json.dumps(SLIDER)}).value) && String(x); }})()",
                                  "the slider sets MOVE.x")
        for page, who in zip(pages, ("the browser with the slider", "the other browser")):
            self.shows(page, value, who)

    def value_under_pointer(self, page):
        """It stays while new pictures come."""
        for shown in ("img", "canvas"):
            page.run(f"document.querySelector('#images {shown}').scrollIntoView({{ block: 'center' }})")
            left, top, width, height = page.area(f"#images {shown}")
            page.mouse("mouseMoved", left + width / 2, top + height / 2, 0)
            value = f"document.querySelector('#images {shown}').closest('figure').querySelector('output').textContent"
            page.wait_for(f"{value}.startsWith('(32, 24) ')", f"the value under the pointer ({shown})")
            frame = int(page.run("document.documentElement.dataset.frame"))
            page.wait_for(f"document.documentElement.dataset.frame > {frame + 2}", "further frames")
            self.expect(page.run(f"{value}.startsWith('(32, 24) ')"), f"the value under the pointer goes with the next {shown}")

    def dragging(self, page):
        page.click_on(ROW.format("element", "MOVE"))
        page.run("document.getElementById('view').focus()")
        page.press("f")
        page.run("[...document.querySelectorAll('#selection button')].find((each) => each.textContent.startsWith('Drag')).id = 'drag'")
        page.click_on("#drag")
        colours_of_view(page)  # the arrows have been drawn
        start, end = page.run(ARROW)
        page.drag(start, end)
        page.wait_for(f"(async () => await {VALUE_OF % 'z'} > 0.05)()", "an arrow that is dragged moves the robot")

    def looking_back(self, page):
        """An old frame stays while the simulation goes on, until the page follows it again."""
        kept = f"(async () => {PAGE}.kept.frames.length)()"
        page.wait_for(f"(async () => (await {kept}) > 5)()", "frames that are kept")
        page.run("document.getElementById('first').click()")
        page.wait_for("!document.getElementById('latest').hidden", "the page looks back")
        frame, count = page.run("document.documentElement.dataset.frame"), page.run(kept)
        page.wait_for(f"(async () => (await {kept}) > {count + 3})()", "further frames are kept")
        self.expect(page.run("document.documentElement.dataset.frame") == frame, "the old frame stays")
        self.expect(page.run("Number(document.getElementById('scrub').max)") > count, "the bar has the further frames")
        page.click_on("#latest")
        page.wait_for(f"document.documentElement.dataset.frame > {int(frame) + count}", "the page follows again")
        self.expect(page.run("document.getElementById('latest').hidden"), "there is nothing to go to")

    def color(self, page):
        page.run("(() => { const field = document.querySelector('[data-element=LAMP] input[type=color]');"
                 "field.value = '#ff8000'; field.dispatchEvent(new Event('input')); })()")
        value = VALUE_OF.replace("'MOVE'", "'LAMP'") % "green"
        page.wait_for(f"(async () => Math.abs(await {value} - 0.2159) < 1e-4)()", "a colour sets the light's linear green")

    def new_sensor(self, page):
        page.run("document.getElementById('place-section').open = true")
        page.click_on("#place [type=submit]")
        page.wait_for(f"!!document.querySelector('{ROW.format('sensor', 'NEW_SENSOR')}')", "a sensor is inserted")
        page.click_on("#place [type=submit]")
        page.wait_for("/NEW_SENSOR/.test(document.getElementById('alerts').textContent)", "the refusal of the same name")
        page.click_on("#save")
        page.wait_for("/saved/.test(document.getElementById('state').textContent)", "the scene is saved")
        self.expect('name="NEW_SENSOR"' in (self.folder / "scene.xml").read_text(), "the file has the new sensor")

    def restart(self, page, host):
        host.kill()
        page.wait_for("document.getElementById('state').classList.contains('wrong')", "the page tells that nothing answers")
        page.run("delete document.documentElement.dataset.frame")
        with LiveHost(self.program, self.folder / "scene.xml", "--real-time", "1", port=host.port) as next_host:
            page.wait_for("/another run/.test(document.getElementById('state').textContent)", "the page asks for the new link")
            page.call("Page.navigate", url=next_host.url)
            page.wait_for("!!document.documentElement?.dataset.frame && document.getElementById('state')?.textContent === 'connected'",
                          "the page has found the next host")
            self.expect(page.run(f"!!document.querySelector('{ROW.format('sensor', 'NEW_SENSOR')}')"), "it has the saved scene")


def main():
    checks = Checks(sys.argv[1], Path(sys.argv[2]))
    with LiveHost(checks.program, checks.folder / "scene.xml", "--real-time", "1") as host:
        with ThreadPoolExecutor() as threads:
            starting = [threads.submit(Browser, host.url, dark=dark) for dark in (False, True)]
            first, second = (each.result() for each in starting)
        with first, second:
            for page in (first, second):
                page.wait_for("!!document.documentElement?.dataset.frame", "a frame")
            checks.selection(first)
            checks.slider((first, second))
            checks.value_under_pointer(first)
            second.process.kill()
            frame = int(first.run("document.documentElement.dataset.frame"))
            first.wait_for(f"document.documentElement.dataset.frame > {frame + 3}", "frames after a browser was killed")
            checks.dragging(first)
            checks.looking_back(first)
            checks.color(first)
            checks.wrong += accessible.faults(first)
            checks.new_sensor(first)
            checks.expect(host.runs(), "the host runs")
            checks.wrong += first.problems
            checks.restart(first, host)
    print("\n".join(checks.wrong))
    sys.exit(1 if checks.wrong else 0)


main()
