"""Opens the recorded page of physics_page_test.cpp in a browser: browse_physics.py FILE.html.

Ends with 1 and says what is wrong; ends with 77 and the reason where there is no browser.
"""
import base64
import json
import sys
from pathlib import Path

from browser import Browser

PAGE = "(await import('simvis/main.js')).page"
LAST_FRAME = 15
WEIGHT_N = 3 * 9.80665
# The solver stops at a remainder; tests/dynamics/force_sensors_test.cpp has the same share.
FORCE_SHARE = 1e-3

# How many pixels of the view are red, blue, ... : those whose colour is within 40 codes of the wanted one.
COUNT_PIXELS = """
(async () => {
  const image = new Image();
  image.src = "data:image/png;base64,%s";
  await image.decode();
  const area = document.getElementById("view").getBoundingClientRect();
  const canvas = Object.assign(document.createElement("canvas"), { width: area.width, height: area.height });
  const context = canvas.getContext("2d");
  context.drawImage(image, area.left, area.top, area.width, area.height, 0, 0, area.width, area.height);
  const data = context.getImageData(0, 0, area.width, area.height).data, wanted = %s;
  let count = 0;
  for (let i = 0; i < data.length; i += 4) count += wanted.every((code, k) => Math.abs(data[i + k] - code) < 40);
  return count;
})()
"""
CONTACT_RED = [229, 72, 77]
# Where the point of a beam is drawn, in pixels of the window.
POINT_OF_BEAM = f"""
(async () => {{
  const {{view, scans}} = {PAGE}, [scan] = scans.values(), beam = 20;
  const rows = scan.world_from_sensor, p = scan.points.subarray(3 * beam, 3 * beam + 3);
  const world = [0, 4, 8].map((row) => rows[row] * p[0] + rows[row + 1] * p[1] + rows[row + 2] * p[2] + rows[row + 3]);
  const place = view.spot.position.clone().set(...world).project(view.camera);
  const area = view.canvas.getBoundingClientRect();
  return [area.left + (place.x + 1) / 2 * area.width, area.top + (1 - place.y) / 2 * area.height];
}})()
"""

# The same of the middle of the robot.
POINT_OF_ROBOT = f"""
(async () => {{
  const {{view}} = {PAGE}, place = view.spot.position.clone().set(-0.1, 0, 0.2).project(view.camera);
  const area = view.canvas.getBoundingClientRect();
  return [area.left + (place.x + 1) / 2 * area.width, area.top + (1 - place.y) / 2 * area.height];
}})()
"""

# The outer corners of the room's walls at the floor, in halves of the view from its middle.
CORNERS_OF_FLOOR = f"""
(async () => {{
  const {{view}} = {PAGE};
  return [[-4.1, -4.1], [-4.1, 4.1], [4.1, -4.1], [4.1, 4.1]].map(([x, y]) => {{
    const place = view.spot.position.clone().set(x, y, 0).project(view.camera);
    return [place.x, place.y];
  }});
}})()
"""
NARROW = (420, 800)  # pixels of a window
SCROLL_ROUNDING_PX = 0.5  # a scrolled row stands at whole pixels
LINK_ROUNDING_M = 0.5e-3 + 1e-9  # numbers of the link have three decimals; the rest is for sums of doubles
LEAST_SPREAD = 0.8  # of 2, which is the whole view


class Checks:
    def __init__(self, browser):
        self.browser, self.wrong = browser, []

    def expect(self, condition, what):
        if not condition:
            self.wrong.append(what)

    def drawn(self):
        """A picture that is drawn after all that was asked for."""
        self.browser.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        return self.browser.screenshot()

    def pixels(self, color):
        return self.browser.run(COUNT_PIXELS % (base64.b64encode(self.drawn()).decode(), json.dumps(color)))

    def text(self, selector):
        return self.browser.run(f"document.querySelector({json.dumps(selector)}).textContent")

    def seek(self, number):
        self.browser.run(f"document.getElementById('scrub').value = {number};"
                         "document.getElementById('scrub').dispatchEvent(new Event('input'))")
        self.browser.wait_for(f"document.documentElement.dataset.frame === '{number}'", f"frame {number}")

    def toggle(self, layer):
        self.browser.run(f"document.getElementById('show-{layer}').click()")

    def physics(self):
        """At the end of the run the box rests on four points that carry its weight; at the start it falls."""
        contacts = f"(async () => {PAGE}.physics.contacts.map(({{force_n}}) => force_n))()"
        self.expect(self.browser.run(contacts) == [], "nothing touches the box that falls")
        self.seek(LAST_FRAME)
        forces = self.browser.run(contacts)
        self.expect(forces and abs(sum(forces) - WEIGHT_N) < FORCE_SHARE * WEIGHT_N, f"the floor carries the box with {forces} N")
        self.browser.run(f"(async () => {{ const {{view}} = {PAGE}; view.camera.position.set(1.2, -1.6, 0.9);"
                         "const look = view.camera.position.clone().set(2, 0, 0.2); view.camera.lookAt(look); view.dirty = true; })()")
        before = self.pixels(CONTACT_RED)
        self.toggle("contacts")
        after = self.pixels(CONTACT_RED)
        self.expect(after > before + 20, f"contacts are {after - before} pixels")
        greatest = self.browser.run(f"(async () => {PAGE}.physics.greatest_n)()")  # of all frames that were shown
        self.expect(greatest >= max(forces), f"the greatest force is {greatest} N")
        scale = next(each for each in (1, 2, 5, 10, 20, 50) if each >= greatest)
        self.expect(f"0.5 m is {scale} N" in self.text("#force-scale"), f"the scale of forces is {self.text('#force-scale')}")
        groups = f"(async () => {PAGE}.physics.bodies.map(({{group}}) => group.children.filter((each) => each.visible).length))()"
        self.expect(self.browser.run(groups) == [0, 0], "shapes are drawn though they are off")
        for layer in ("masses", "collisions"):
            self.toggle(layer)
        self.expect(self.browser.run(groups) == [1, 3], f"the floor's shape; shape, ellipsoid and centre of the box: {self.browser.run(groups)}")

    def graphs(self):
        self.browser.run("document.getElementById('graphs').closest('details').open = true")
        path = "document.querySelector('.graph[data-title=\"BOX_BODY (m)\"] path')?.getAttribute('d')"
        self.browser.wait_for(f"!!{path}", "a graph of the body")
        self.expect("V" in self.browser.run(path) and "L" not in self.browser.run(path), "parameters are drawn as steps")
        titles = self.browser.run("[...document.querySelectorAll('.graph')].map((each) => each.dataset.title)")
        self.expect("IMU (m/s2)" in titles, f"graphs are {titles}")
        names = self.browser.run("[...document.querySelectorAll('.graph[data-title=\"IMU (m/s2)\"] .series span')].map((each) => each.textContent.split(' ')[0])")
        self.expect(len(names) == 3, f"series of the accelerations are {names}")
        lines = self.browser.run(f"(async () => {PAGE}.graphs.csv())()").strip().split("\n")
        column = lines[0].split(",").index("BOX_BODY.z (m)")
        self.expect(len(lines) == LAST_FRAME + 2, f"the CSV has {len(lines)} lines")
        shown = f"(async () => {{ const {{values, scene}} = {PAGE}; return values[scene().parameters.findIndex((each) => each?.element === 'BOX_BODY' && each.name === 'z')]; }})()"
        self.expect(float(lines[-1].split(",")[column]) == self.browser.run(shown), "the CSV has the value of the last frame")
        left, top, width, height = self.browser.area(".graph[data-title=\"BOX_BODY (m)\"] svg")
        self.browser.click(left + 0.3 * width, top + height / 2)
        self.browser.wait_for(f"document.documentElement.dataset.frame !== '{LAST_FRAME}'", "a click into a graph goes to its time")
        self.seek(LAST_FRAME)

    def picking(self):
        left, top, width, height = self.browser.area("#images canvas")
        self.browser.click(left + 32.5 / 64 * width, top + 24.5 / 48 * height)
        text = self.text("#selection")
        for wanted in ("pixel32, 24", "partBOX", "labelparcel", "semantic7 parcel", "depth"):
            self.expect(wanted in text, f"a click on a picture says {wanted}: {text}")
        x, y = self.browser.run(POINT_OF_BEAM)
        self.browser.click(x, y)
        text = self.text("#selection")
        for wanted in ("SCAN beam", "ring, beam0, 20", "azimuth, elevation0.00°, 0.00°", "true range within± ", "parcel", "partBOX"):
            self.expect(wanted in text, f"a click on a point of a scan says {wanted}: {text}")

    def room(self):
        """The whole scene shows what is in the room, from above without its ceiling, and the room fills the view."""
        self.browser.click_on("#whole")
        self.expect(self.browser.run("Number(document.getElementById('cut').value) < 100"), "the ceiling is cut away")
        self.expect(not self.browser.run("document.getElementById('cut-front').checked"), "the walls are whole")
        hides = f"(async () => {{ const {{view}} = {PAGE}; const hit = view.pick({{clientX: %f, clientY: %f}}); return hit?.item?.part ?? hit?.sensor; }})()"
        self.drawn()
        x, y = self.browser.run(POINT_OF_ROBOT)
        self.expect(self.browser.run(hides % (x, y)) == "ROBOT", f"at the robot's place is {self.browser.run(hides % (x, y))}")
        corners = self.browser.run(CORNERS_OF_FLOOR)
        self.expect(all(abs(value) < 1 for place in corners for value in place), f"the room is seen as a whole: {corners}")
        spread = max(max(values) - min(values) for values in zip(*corners))
        self.expect(spread > LEAST_SPREAD, f"the room fills the view: {spread}")
        self.browser.run("(({cut}) => { cut.value = 100; cut.dispatchEvent(new Event('input')); })({cut: document.getElementById('cut')})")
        self.drawn()
        self.expect(self.browser.run(hides % (x, y)) != "ROBOT", "the room is closed again")
        self.browser.click_on("#whole")
        self.browser.click_on("#cut-front")

    def menus(self):
        """No text reaches beyond its menu, and a narrow window has all menus and buttons."""
        for menu in ("menu", "menu#physics-menu"):
            self.browser.run(f"document.querySelector('details.{menu}').open = true")
            beyond = self.browser.run(f"((box) => [...box.querySelectorAll('*')].map((each) => each.getBoundingClientRect().right"
                                      f" - box.getBoundingClientRect().right))(document.querySelector('details.{menu} > div'))")
            self.expect(max(beyond) <= 0, f"things in {menu} reach {max(beyond)} pixels beyond it")
            self.browser.run(f"document.querySelector('details.{menu}').open = false")
        with Browser(self.browser.run("location.href"), *NARROW) as narrow:
            narrow.wait_for("!!document.documentElement?.dataset.frame", "a frame")
            for part in ("#whole", "#focus", "#cut", "#cut-front", ".menu", "#physics-menu"):
                left, _, width, _ = narrow.area(part)
                inside = left >= -SCROLL_ROUNDING_PX and left + width <= NARROW[0] + SCROLL_ROUNDING_PX
                self.expect(width > 0 and inside, f"{part} is from {left} to {left + width}")
            self.wrong += narrow.problems

    def beam_of_link(self):
        """The link has the beam that picking() has selected."""
        self.browser.wait_for("location.hash.includes('select=beam:SCAN:20')", "the link has the beam")
        text = self.text("#selection")
        with Browser(self.browser.run("location.href")) as other:
            other.wait_for("document.documentElement?.dataset.selected === 'beam SCAN'", "the beam of the link")
            self.expect(other.run("document.querySelector('#selection').textContent") == text, "a link shows the beam that it names")
            self.wrong += other.problems
        with Browser(self.browser.run("location.href").replace("SCAN:20", "SCAN:41")) as other:
            other.wait_for("document.documentElement?.dataset.selected === 'beam SCAN'", "a beam that the scan lacks")
            self.expect("no such beam" in other.run("document.querySelector('#selection').textContent"), "a beam too many")
            self.wrong += other.problems

    def link(self, page):
        """A browser that opens the link shows the same."""
        self.browser.run("document.querySelector('[data-kind=part][data-name=BOX]').click()")
        self.browser.wait_for("location.hash.includes('select=part:BOX') && location.hash.includes('cut=front')", "the link has the layout")
        state = f"(async () => {{ const {{view, selected}} = {PAGE}; return [view.camera.position.toArray(), selected()?.name, " \
                "document.getElementById('show-contacts').checked, document.getElementById('cut-front').checked, " \
                "document.getElementById('graphs').closest('details').open, document.documentElement.dataset.frame]; })()"
        expected = self.browser.run(state)
        with Browser(page + self.browser.run("location.hash")) as other:
            other.wait_for(f"document.documentElement?.dataset.frame === '{LAST_FRAME}'", "the frame of the link")
            other.wait_for("document.documentElement.dataset.selected === 'part BOX'", "what the link has selected")
            shown = other.run(state)
            apart = max(abs(a - b) for a, b in zip(shown[0], expected[0]))
            self.expect(apart <= LINK_ROUNDING_M, f"the camera of a link is {apart} m from where it was")
            self.expect(shown[1:] == expected[1:], f"a link shows {shown}, expected {expected}")
            self.wrong += other.problems


def main():
    page = Path(sys.argv[1]).resolve().as_uri()
    with Browser(page) as browser:
        browser.wait_for("document.documentElement?.dataset.frame === '0'", "frame 0")
        checks = Checks(browser)
        for check in (checks.physics, checks.graphs, checks.picking, checks.beam_of_link, checks.room, checks.menus):
            check()
        color = browser.run("document.querySelector('[data-element=LAMP] input[type=color]').value")
        checks.expect(color == "#ffbc89", f"the lamp's colour is {color}")
        beams = browser.run(f"(async () => {{ const {{view}} = {PAGE}; return view.overlay.children.flatMap((each) => each.children)"
                            ".some((each) => each.isLineSegments && each.visible && each.material.opacity === 0.35); })()")
        checks.expect(beams, "the beams that the scene draws for people are shown")
        checks.link(page)
        checks.wrong += browser.problems
    print("\n".join(checks.wrong))
    sys.exit(1 if checks.wrong else 0)


main()
