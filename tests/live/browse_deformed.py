"""Opens the pages of deformed_page_test.cpp in a browser: browse_deformed.py FILE.html, a recorded one, or
browse_deformed.py SIMVIS_RUN SCENE.xml TRAJECTORY.csv WALK_PER_S, that of a running simulation, where the time of the
element WALK is that of the simulation times WALK_PER_S.

Ends with 1 and says what is wrong; ends with 77 and the reason where there is no browser.
"""
import math
import sys
from pathlib import Path

from browser import Browser
from live_host import LiveHost

# Of the strip's upper edge: x and z of a vertex, and of its normal.
EDGE = """
(async () => {
  const { position, normal } = (await import("simvis/main.js")).page.view.items.children[0].geometry.attributes;
  return [position, normal].flatMap(({ array }) => [array[12], array[14]]);
})()
"""
FLOAT = 2**-22  # the rounding of the numbers, and that of the expected ones
KEPT = "(await import('simvis/main.js')).page.kept"


def expected(walk):
    angle = walk * math.pi / 4
    return [3 + math.sin(angle), 1 + math.cos(angle), -math.cos(angle), math.sin(angle)]


def scrub(browser, number):
    browser.run(f"document.getElementById('scrub').value = {number};"
                "document.getElementById('scrub').dispatchEvent(new Event('input'))")


def faults_of_edge(browser, walk, what):
    edge = browser.run(EDGE)
    if all(abs(a - b) <= FLOAT for a, b in zip(edge, expected(walk))):
        return []
    return [f"{what} the edge is {edge}, not {expected(walk)}"]


def faults_of_recording(browser):
    wrong = []
    for frame in (0, 2, 1, 0, 1):
        browser.wait_for("!!document.documentElement?.dataset.frame", "a frame")
        scrub(browser, frame)
        browser.wait_for(f"document.documentElement?.dataset.frame === '{frame}'", f"frame {frame}")
        wrong += faults_of_edge(browser, frame, f"in frame {frame}")
    return wrong


def faults_of_kept_frames(browser, walk_per_s):
    """Looks back at kept frames while the strip bends on, and follows the simulation again."""
    wrong = []
    browser.wait_for("!!document.documentElement?.dataset.frame", "a frame")
    browser.wait_for(f"(async () => {KEPT}.frames.length > 12)()", "frames that are kept")
    times = browser.run(f"(async () => {KEPT}.frames.map(({{ frame }}) => [frame.frame, frame.time_s]))()")
    for number in (0, 9, 4, 5, 0):
        scrub(browser, number)
        frame, time_s = times[number]
        browser.wait_for(f"document.documentElement.dataset.frame === '{frame}'", f"the kept frame {frame}")
        wrong += faults_of_edge(browser, walk_per_s * time_s, f"in the kept frame {frame}")
    browser.wait_for(f"(async () => {KEPT}.frames.length > {len(times) + 3})()", "further frames")
    wrong += faults_of_edge(browser, walk_per_s * times[0][1], "while the simulation goes on")
    browser.click_on("#latest")
    browser.wait_for(f"document.documentElement.dataset.frame > {times[-1][0]}", "the page follows again")
    browser.run("document.getElementById('play').click()")
    browser.wait_for(f"(async () => {KEPT}.frames.at(-1).frame.playing === false)()", "the simulation is paused")
    time_s = browser.run(f"(async () => {KEPT}.frames.at(-1).frame.time_s)()")
    return wrong + faults_of_edge(browser, walk_per_s * time_s, "in the last frame")


def main():
    if len(sys.argv) == 2:
        with Browser(Path(sys.argv[1]).resolve().as_uri()) as browser:
            wrong = faults_of_recording(browser) + browser.problems
    else:
        program, scene, trajectory, walk_per_s = sys.argv[1:]
        with LiveHost(program, scene, "--real-time", "1", "--rate", "10", "--trajectory", trajectory) as host:
            with Browser(host.url) as browser:
                wrong = faults_of_kept_frames(browser, float(walk_per_s)) + browser.problems
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
