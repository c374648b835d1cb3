"""Opens a recorded page of the test's scene in a browser: browse_page.py FILE.html FOLDER_OF_THE_RUN.

Ends with 1 and says what is wrong; ends with 77 and the reason where there is no browser.
"""
import csv
import sys
from pathlib import Path

from browser import Browser
from seen import LEAST_COLOURS, colours_of_view, panel_bytes, without_exif

def shown_frame(browser, number):
    browser.wait_for(f"document.documentElement?.dataset.frame === '{number}'", f"frame {number}")


FOUND = "at 2 s: MOVE has moved"  # recorded_page_test.cpp has it too
NARROW, PHONE = (420, 800), (390, 844)  # pixels
# The cosine between the direction of the view and that of the beam 2 of SCAN.
ALONG_BEAM = """(async () => {
  const { view, scans, scene } = (await import("simvis/main.js")).page;
  const scan = scans.get(scene().sensors.findIndex(({ name }) => name === "SCAN")), w = scan.world_from_sensor;
  const [x, y, z] = scan.points.subarray(6, 9), length = Math.hypot(x, y, z);
  const beam = [0, 4, 8].map((row) => (w[row] * x + w[row + 1] * y + w[row + 2] * z) / length);
  const ahead = view.camera.getWorldDirection(view.camera.position.clone()).toArray();
  return beam.reduce((sum, value, i) => sum + value * ahead[i], 0);
})()"""
SIDES = ("visible_x_min", "visible_y_min", "visible_x_max", "visible_y_max")
BOXES = """Array.from(document.querySelectorAll('[data-sensor=CAM] .frame img ~ svg rect'), (rect) => {
  const [x, y, width, height] = ["x", "y", "width", "height"].map((name) => Number(rect.getAttribute(name)));
  return [x, y, x + width, y + height];
})"""


def main():
    page, run = Path(sys.argv[1]), Path(sys.argv[2])
    wrong = []

    def expect(condition, what):
        if not condition:
            wrong.append(what)

    with Browser(page.resolve().as_uri()) as browser:
        shown_frame(browser, 0)
        png = without_exif((run / "CAM" / "000000.png").read_bytes())
        expect(panel_bytes(browser) == png, "the panel does not hold the bytes of the first PNG")

        with open(run / "CAM.csv", newline="") as table:
            boxes = [[float(row[side]) for side in SIDES] for row in csv.DictReader(table) if row["frame"] == "0"]
        expect(len(boxes) == 2, f"the run has {len(boxes)} boxes in its first frame")
        expect(browser.run(BOXES) == boxes, f"boxes on colour are {browser.run(BOXES)}, not {boxes}")

        # The tree selects; F goes there; a click on what is in the middle then selects it again.
        browser.run("document.querySelector('[data-kind=part][data-name=ROBOT]').click()")
        expect(browser.run("document.documentElement.dataset.selected") == "part ROBOT", "a click in the tree selects")
        browser.run("document.getElementById('view').focus()")
        for key in ("f", "Escape"):
            browser.press(key)
        expect(browser.run("document.documentElement.dataset.selected") == "", "Escape selects nothing")
        colours = colours_of_view(browser)
        expect(colours >= LEAST_COLOURS, f"the view has {colours} colours")
        area = browser.run("(({x, y, width, height}) => [x + width / 2, y + height / 2])"
                           "(document.getElementById('view').getBoundingClientRect())")
        browser.click(*area)
        browser.wait_for("document.querySelector('[role=treeitem][aria-selected=true]')?.dataset.name === 'ROBOT'",
                         "a click in the view selects in the tree")

        # The last frame, and back: each has its own values and images.
        value = "document.querySelector('[data-element=MOVE] input[type=number]').value"
        expect(browser.run(value) == "0", f"x of MOVE is {browser.run(value)}")
        for number, x in ((1, "0.5"), (0, "0")):
            browser.run(f"document.getElementById('scrub').value = {number};"
                        "document.getElementById('scrub').dispatchEvent(new Event('input'))")
            shown_frame(browser, number)
            expect(browser.run(value) == x, f"in frame {number} x of MOVE is {browser.run(value)}")
            png = without_exif((run / "CAM" / f"{number:06}.png").read_bytes())
            expect(panel_bytes(browser) == png, f"the panel of frame {number} has other bytes")

        # One frame after the other: the last one is as the first again, which it does not say.
        for number, x in ((1, "0.5"), (2, "0")):
            browser.run("document.getElementById('step').click()")
            shown_frame(browser, number)
            expect(browser.run(value) == x, f"a step later, in frame {number}, x of MOVE is {browser.run(value)}")

        # What a test found stands above the scene in the frame where it was found, until it is closed.
        found = "document.getElementById('news').checkVisibility() && document.querySelector('#news li').textContent"
        expect(browser.run(found) == FOUND, f"the last frame says {browser.run(found)}")
        browser.click_on("#news button")
        expect(not browser.run(found), "it can be closed")
        for number, text in ((1, False), (2, FOUND)):
            browser.run(f"document.getElementById('scrub').value = {number};"
                        "document.getElementById('scrub').dispatchEvent(new Event('input'))")
            shown_frame(browser, number)
            expect(browser.run(found) == text, f"frame {number} says {browser.run(found)}")
        with Browser(f"{page.resolve().as_uri()}#frame=2", *NARROW) as narrow:
            shown_frame(narrow, 2)
            expect(narrow.run(found) == FOUND, "a narrow window says what was found")
            left, _, width, _ = narrow.area("#news")
            expect(left + width <= NARROW[0], f"of a narrow window it reaches to {left + width}")
            wrong += narrow.problems

        # Series that differ by the rounding of their numbers have limits, and few ticks.
        ticks = browser.run("""(async () => {
            const { limitsAround, ticksOf } = await import("simvis/graphs.js");
            return [[9.80665, 9.806650000000002], [101325, 101325.00000000001], [0, 0], [-1e300, 1e300]]
                .map(([low, high]) => ticksOf(limitsAround(low, high), 3).length);
        })()""")
        expect(all(1 <= count <= 6 for count in ticks), f"the numbers of ticks are {ticks}")
        # The names of series stand in the order of their colours, also of one that changes later than others.
        names = browser.run("""(async () => {
            const { Graphs } = await import("simvis/graphs.js");
            const section = Object.assign(document.createElement("details"), { open: true }), root = document.createElement("div");
            section.append(root);
            const graphs = new Graphs(root);
            for (const [time, x, y] of [[0, 0, 0], [1, 0, 5], [2, 3, 5]]) {
                graphs.add("POSE", "x", "m", true, time, x);
                graphs.add("POSE", "y", "m", true, time, y);
                graphs.draw(time);
            }
            return [...root.querySelectorAll(".series span")].map((each) => each.textContent);
        })()""")
        expect(names == ["x 3", "y 5"], f"the series are {names}")

        # At most five digits, and no digits of rounding errors; the full value is the tooltip.
        numbers = browser.run("""(async () => {
            const { short } = await import("simvis/color_ramp.js");
            return [2.74225e-14, -1e-10, 0.00012346, 3.14159265, 123456.7, -0.5, NaN, Infinity].map((value) => short(value, 5));
        })()""")
        expect(numbers == ["0", "0", "1.235e-4", "3.1416", "1.235e+5", "-0.5", "–", "∞"], f"short numbers are {numbers}")
        fields = browser.run("""(async () => {
            const { ParameterPanel } = await import("simvis/parameters.js");
            const set = [], panel = new ParameterPanel(document.createElement("div"), true, (...one) => set.push(one));
            const of = (name, more) => ({ element: "V", type: "velocity_command", insert_at: "ROOT", name, unit: "m/s", summary: "", min: null,
                                          max: null, value: 0, full_turn: false, ...more });
            panel.build([of("command"), of("forward", { value: 2.74225e-14 }), of("turn", { min: -20, max: 20 })]);
            const [, { slider, field }, turn] = panel.rows, seen = [[field.value, field.title]];
            slider.value = slider.max;  // let go at a soft end: it reaches farther; at a limit it does not
            for (const name of ["input", "change"]) slider.dispatchEvent(new Event(name));
            turn.slider.value = turn.slider.max;
            turn.slider.dispatchEvent(new Event("change"));
            seen.push([slider.max, slider.value, turn.slider.max].map((text) => Number(Number(text).toFixed(9))));
            panel.write(1, 100);
            seen.push(Number(slider.max) >= 100 && slider.value === "100");
            // The drive pad: keys that are held, also two of them, and the end of the drive.
            set.length = 0;
            const pad = panel.root.querySelector(".pad"), key = (type, key) => pad.dispatchEvent(new KeyboardEvent(type, { key }));
            key("keydown", "ArrowUp");
            key("keydown", "ArrowLeft");
            key("keyup", "ArrowUp");
            key("keyup", "ArrowLeft");
            await new Promise((resolve) => setTimeout(resolve, 300));
            return [...seen, set];
        })()""")
        commands = [[[1, v], [2, w], [0, n]] for n, (v, w) in enumerate([(0.5, 0), (0.5, 45), (0, 45), (0, 0)], 1)]
        expect(fields == [["0", "2.74225e-14 m/s"], [15, 5, 20], True, [one for each in commands for one in each]],
               f"fields and pad do {fields}")
        limits = browser.run("""(async () => {
            const { limitsAround } = await import("simvis/graphs.js");
            const [low, high] = limitsAround(-1.4e-14, 2.7e-14);
            return high - low;
        })()""")
        expect(limits >= 1e-7, f"rounding errors fill an axis of {limits}")
        expect(browser.run("document.title") == "s – SimVis", f"the title is {browser.run('document.title')}")
        browser.run("document.body.dispatchEvent(new KeyboardEvent('keydown', { key: '?', bubbles: true }))")
        expect("one frame" in browser.run("document.querySelector('#keys-menu[open] dl').innerText"), "? lists the keys")
        browser.run("document.getElementById('keys-menu').open = false")

        # Popovers leave the details in sight, and on a phone the header is one row of large targets.
        browser.click_on(".menu > summary")
        left, _, width, _ = browser.area(".menu[open] > div")
        expect(left + width <= browser.area("aside")[0], "the menu covers the details")
        with Browser(page.resolve().as_uri(), *PHONE) as phone:
            shown_frame(phone, 0)
            expect(phone.area("header")[3] <= 64, f"the header of a phone is {phone.area('header')[3]} px high")
            small = phone.run("""[...document.querySelectorAll("header button, header summary, header select, footer button, aside summary")]
                .filter((each) => each.checkVisibility() && each.getBoundingClientRect().height < 44).map((each) => each.outerHTML)""")
            expect(small == [], f"small targets on a phone: {small}")
            expect(not phone.run("document.getElementById('tree').checkVisibility()"), "the tree of a phone is closed first")
            phone.click_on("#show-tree")
            expect(phone.run("document.getElementById('tree').checkVisibility()"), "a button shows the tree")
            phone.click_on("[role=treeitem][data-kind=sensor] .name")
            expect(not phone.run("document.getElementById('tree').checkVisibility()"), "a choice in the tree closes it")
            wrong += phone.problems
        with Browser(f"{page.resolve().as_uri()}#select=beam:SCAN:2", *NARROW) as failed:
            shown_frame(failed, 0)
            along = failed.run(ALONG_BEAM)
            expect(along > 0.9, f"the view of a failed beam looks along it: {along}")
            wrong += failed.problems

        # Of all sides, from which the way at 28 degrees is free, the first view takes the one without a low wall.
        azimuth = browser.run("""(async () => {
            const { Navigation } = await import("simvis/navigation.js"), { page } = await import("simvis/main.js");
            const camera = page.view.camera.clone();
            const freeReach = (from, { x, y, z }) => (z > 0.2 || Math.atan2(y, x) < -2.5 ? 100 : 2);
            const navigation = Object.create(Navigation.prototype, { view: { value: { camera, freeReach } }, aimAt: { value() {} } });
            navigation.standBefore([[0, 0, 0]], null);
            return Math.atan2(camera.position.y, camera.position.x);
        })()""")
        expect(azimuth < -2.5, f"the first view is from {azimuth} rad")
        wrong += browser.problems
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
