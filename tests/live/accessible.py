"""Whether the controls of a page have names, can be reached by Tab, show the focus, and whether its texts have contrast."""
import json

LEAST_CONTRAST = 4.5  # WCAG 2.2, AA: of text of normal size
NAMED_ROLES = {"button", "checkbox", "combobox", "slider", "spinbutton", "textbox", "searchbox", "link", "tree", "treeitem",
               "DisclosureTriangle", "Canvas", "img", "image"}

# Each control that a user can see, as a line that says what it is.
CONTROLS = """
const lineOf = (each) => `${each.tagName} ${each.id || each.name || each.getAttribute("aria-label") || each.textContent}`.trim();
const seen = (each) => each.checkVisibility({ visibilityProperty: true }) && !each.disabled && each.closest("[hidden]") === null;
"""
REACHABLE = """
(() => {%s
  return [...document.querySelectorAll("a[href], button, input, select, summary, [tabindex='0']")].filter(seen).map(lineOf);
})()
""" % CONTROLS
FOCUSED = """
(() => {%s
  const each = document.activeElement, style = getComputedStyle(each);
  return each === document.body ? null : [lineOf(each), style.outlineStyle !== "none" && parseFloat(style.outlineWidth) >= 1];
})()
""" % CONTROLS

# Texts whose contrast with what is behind them is too low.
PALE_TEXTS = """
(async () => {
  await Promise.all(document.getAnimations().map((each) => each.finished)); // the colours of the other theme fade
  const canvas = Object.assign(document.createElement("canvas"), { width: 1, height: 1 });
  const context = canvas.getContext("2d", { willReadFrequently: true });
  const numbers = (color) => {
    context.clearRect(0, 0, 1, 1);
    context.fillStyle = color;
    context.fillRect(0, 0, 1, 1);
    const [r, g, b, a] = context.getImageData(0, 0, 1, 1).data;
    return { rgb: [r, g, b], a: a / 255 };
  };
  const luminance = ({ rgb }) => {
    const [r, g, b] = rgb.map((code) => code / 255).map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const behind = (each) => {
    for (; each; each = each.parentElement) {
      const color = numbers(getComputedStyle(each).backgroundColor);
      if (color.a > 0.5) return color;
    }
    return numbers("white");
  };
  const pale = new Set();
  for (const each of document.querySelectorAll("body *")) {
    const own = [...each.childNodes].some((node) => node.nodeType === Node.TEXT_NODE && node.textContent.trim() !== "");
    if (!own || !each.checkVisibility() || each.closest(":disabled")) continue;
    const lights = [luminance(numbers(getComputedStyle(each).color)), luminance(behind(each))].sort();
    const contrast = (lights[1] + 0.05) / (lights[0] + 0.05);
    if (contrast < LEAST) pale.add(`${each.tagName} ${each.className} ${each.textContent.slice(0, 30)}: ${contrast.toFixed(2)}`);
  }
  return [...pale];
})()
""".replace("LEAST", str(LEAST_CONTRAST))


def unnamed_controls(browser):
    unnamed = []
    for node in browser.call("Accessibility.getFullAXTree")["nodes"]:
        role, name = node.get("role", {}).get("value"), node.get("name", {}).get("value", "")
        if not node.get("ignored") and role in NAMED_ROLES and not name.strip():
            unnamed.append(f"{role} without a name: {json.dumps(node.get('properties', []))[:200]}")
    return unnamed


def unreached_controls(browser):
    """Presses Tab until the focus has gone round, wherever it begins."""
    wanted, reached, unmarked = browser.run(REACHABLE), [], []
    browser.run("document.activeElement.blur(); window.getSelection().removeAllRanges()")
    for _ in range(2 * len(wanted)):
        browser.press("Tab", 9)
        focused = browser.run(FOCUSED)
        if focused is None:  # behind the last control
            continue
        reached.append(focused[0])
        if not focused[1]:
            unmarked.append(f"{focused[0]} does not show that it has the focus")
        if set(wanted) <= set(reached):
            break
    return [f"Tab does not reach {each}" for each in sorted(set(wanted) - set(reached))] + sorted(set(unmarked))


def faults(browser):
    """All that is wrong, in light and in dark colours."""
    wrong = unnamed_controls(browser) + unreached_controls(browser)
    for theme in ("dark", "light"):
        browser.set_theme(theme)
        wrong += [f"{theme}: {each}" for each in browser.run(PALE_TEXTS)]
    return wrong
