"""Opens the recorded page of deformed_page_test.cpp in a browser: browse_deformed.py FILE.html.

Ends with 1 and says what is wrong; ends with 77 and the reason where there is no browser.
"""
import math
import sys
from pathlib import Path

from browser import Browser

# Of the strip's upper edge: x and z of a vertex, and of its normal.
EDGE = """
(async () => {
  const { position, normal } = (await import("simvis/main.js")).page.view.items.children[0].geometry.attributes;
  return [position, normal].flatMap(({ array }) => [array[12], array[14]]);
})()
"""
FLOAT = 2**-22  # the rounding of the numbers, and that of the expected ones


def expected(frame):
    angle = frame * math.pi / 4
    return [3 + math.sin(angle), 1 + math.cos(angle), -math.cos(angle), math.sin(angle)]


def main():
    wrong = []
    with Browser(Path(sys.argv[1]).resolve().as_uri()) as browser:
        for frame in (0, 2, 1, 0, 1):
            browser.wait_for("!!document.documentElement?.dataset.frame", "a frame")
            browser.run(f"document.getElementById('scrub').value = {frame};"
                        "document.getElementById('scrub').dispatchEvent(new Event('input'))")
            browser.wait_for(f"document.documentElement?.dataset.frame === '{frame}'", f"frame {frame}")
            edge = browser.run(EDGE)
            if any(abs(a - b) > FLOAT for a, b in zip(edge, expected(frame))):
                wrong.append(f"in frame {frame} the edge is {edge}, not {expected(frame)}")
        wrong += browser.problems
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
