"""Pulls at a body of a running simulation in a browser: browse_pull.py SIMVIS_RUN SCENE.xml of physics_page_test.cpp.

Ends with 1 and says what is wrong; ends with 77 and the reason where there is no browser.
"""
import sys

from browser import Browser
from live_host import LiveHost

PAGE = "(await import('simvis/main.js')).page"
# The camera looks at the box from the side, with nothing between.
LINK = "#cam=2,-2.5,0.6,2,0,0.6&layers=contacts"
VALUE = f"(async () => {{ const {{values, scene}} = {PAGE}; return values[scene().parameters.findIndex((each) => each?.element === '%s' && each.name === '%s')]; }})()"
# In pixels of the window: the middle of the box, and a place 0.6 m above it.
PLACES = f"""
(async () => {{
  const {{view}} = {PAGE}, area = view.canvas.getBoundingClientRect();
  return [0.3, 0.9].map((z) => {{
    const place = view.spot.position.clone().set(2, 0, z).project(view.camera);
    return [area.left + (place.x + 1) / 2 * area.width, area.top + (1 - place.y) / 2 * area.height];
  }});
}})()
"""


def main():
    wrong = []
    with LiveHost(sys.argv[1], sys.argv[2], "--real-time", "1") as host, Browser(host.url + LINK) as page:
        page.wait_for("!!document.documentElement?.dataset.frame", "a frame")
        page.wait_for(f"(async () => {PAGE}.physics.contacts.length > 0)()", "the box stands on the floor")
        z = VALUE % ("BOX_BODY", "z")
        start, end = page.run(PLACES)
        page.run("document.getElementById('pull').click()")
        page.mouse("mouseMoved", *start, buttons=0)
        page.mouse("mousePressed", *start)
        page.mouse("mouseMoved", *end)
        # In the end its middle hangs 0.2 m below the place at its side, which the spring holds 0.15 m below the pointer:
        # at 0.12 m. It stood at -0.1 m.
        page.wait_for(f"(async () => await {z} > 0.11)()", "the body follows the pointer")
        if not page.run(f"(async () => {PAGE}.pulling.line.visible)()"):
            wrong.append("the spring is not drawn")
        page.mouse("mouseReleased", *end)
        page.wait_for(f"(async () => await {z} < -0.09)()", "the body falls when it is let go")
        page.run("document.getElementById('restart').click()")
        page.wait_for(f"(async () => await {VALUE % ('PHYSICS', 'restarts')} === 1)()", "the bodies begin again")
        wrong += page.problems
        if not host.runs():
            wrong.append("the host has ended")
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
