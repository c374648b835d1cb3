"""Opens the recorded page of objects_page_test.cpp in a browser: browse_objects.py FILE.html [SCREENSHOT.png].

Ends with 1 and says what is wrong; ends with 77 and the reason where there is no browser.
"""
import json
import sys
from pathlib import Path

from browser import Browser

PAGE = "(await import('simvis/main.js')).page"
LAST_FRAME = 7
SIZE_ROUNDING_M = 1e-3  # the crate has settled on the ground by less

# Where a point of the world is drawn, in pixels of the window.
PLACE = """
(async () => {
  const {view} = %s, place = view.spot.position.clone().set(%f, %f, %f).project(view.camera);
  const area = view.canvas.getBoundingClientRect();
  return [area.left + (place.x + 1) / 2 * area.width, area.top + (1 - place.y) / 2 * area.height];
})()
"""
# The size of the box that marks the selection.
MARKED = f"(async () => {PAGE}.view.marks.children.map(({{box}}) => box.max.clone().sub(box.min).toArray()))()"
ROWS = """[...document.querySelectorAll('#tree [role=treeitem]')].map((row) =>
  [row.dataset.kind, row.dataset.name, Number(row.getAttribute('aria-level')), row.querySelector('.what').textContent])"""


def main():
    wrong = []

    def expect(condition, what):
        if not condition:
            wrong.append(what)

    page = Path(sys.argv[1]).resolve().as_uri()
    with Browser(page) as browser:
        browser.wait_for("document.documentElement?.dataset.frame === '0'", "frame 0")
        browser.run(f"document.getElementById('scrub').value = {LAST_FRAME};"
                    "document.getElementById('scrub').dispatchEvent(new Event('input'))")
        browser.wait_for(f"document.documentElement.dataset.frame === '{LAST_FRAME}'", "the last frame")
        browser.run(f"(async () => {{ const {{view, navigation}} = {PAGE}; view.camera.position.set(-0.8, -1.4, 1.3);"
                    "view.camera.lookAt(view.camera.position.clone().set(1.6, 0, 0.4)); view.dirty = true; })()")
        browser.run("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
        rows = {(kind, name): (level, what) for kind, name, level, what in browser.run(ROWS)}
        world = rows["part", "WORLD"][0]
        for model, links in (("ground", ["slab"]), ("wall", ["slab"]), ("crate", ["base", "lid"])):
            expect(rows.get(("model", model), (0,))[0] == world + 1, f"model {model} in the tree: {rows}")
            for link in links:
                expect(rows.get(("link", f"{model}/{link}"), (0,))[0] == world + 2, f"link {model}/{link}: {rows}")
        expect(rows["model", "crate"][1] == "crate", f"the class of a model in the tree: {rows['model', 'crate']}")
        expect(rows["sensor", "IMU"][0] == world + 3, "a sensor stands at its link")
        expect(not any(kind == "frame" for kind, _ in rows), "named places without surfaces are not in the tree")

        def click(x, y, z):
            browser.click(*browser.run(PLACE % (PAGE, x, y, z)))
            return browser.run("document.documentElement.dataset.selected"), browser.run(
                "document.querySelector('#selection').textContent")

        selected, text = click(1.25, 0, 0.2)
        expect(selected == "link crate/base", f"a click on the crate selects {selected}")
        browser.wait_for("document.querySelector('#selection').textContent.includes('ground/slab')", "contacts of the crate")
        text = browser.run("document.querySelector('#selection').textContent")
        for fact in ("pathWORLD/crate/base", "partWORLD", "bodydynamic", "mass4 kg", "ground/slab"):
            expect(fact in text, f"a link says {fact}: {text}")
        size = browser.run(MARKED)
        expect(len(size) == 1 and all(abs(each - 0.5) < SIZE_ROUNDING_M for each in size[0]), f"the box of the link: {size}")
        expect(browser.run("document.querySelector('#tree [aria-selected=true]').dataset.name") == "crate/base", "the tree follows")
        browser.wait_for("location.hash.includes('select=link:crate')", "the link of the page has what is selected")
        address = browser.run("location.href")
        if len(sys.argv) > 2:
            Path(sys.argv[2]).write_bytes(browser.screenshot())
        selected, text = click(2.9, 0.8, 0.5)
        expect(selected == "link wall/slab", f"a click on the wall selects {selected}")
        expect("bodystatic" in text, f"a wall is a static body: {text}")
        selected, _ = click(1.5, 0, 0.6)
        expect(selected == "link crate/lid", f"a click on the lid selects {selected}")
        selected, _ = click(0.45, 1.42, 0.5)
        expect(selected == "part POST", f"a click on a part without links selects {selected}")
        browser.run("document.querySelector('[data-kind=model][data-name=crate]').click()")
        size = browser.run(MARKED)
        expect(len(size) == 1 and abs(size[0][2] - 0.6) < SIZE_ROUNDING_M, f"the box of a model has its links: {size}")
        text = browser.run("document.querySelector('#selection').textContent")
        for fact in ("classcrate", "mass5 kg"):
            expect(fact in text, f"a model says {fact}: {text}")
        with Browser(address) as other:
            other.wait_for("document.documentElement?.dataset.selected === 'link crate/base'", "the link of the page")
            wrong.extend(other.problems)
        wrong.extend(browser.problems)
    print("\n".join(json.dumps(each) if not isinstance(each, str) else each for each in wrong))
    sys.exit(1 if wrong else 0)


main()
