"""Chromium without a window, driven over its DevTools protocol."""
import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import urllib.request

SKIPPED = 77
PATIENCE_S = 90


def skip(reason):
    print(reason)
    sys.exit(SKIPPED)


try:
    import websocket
except ImportError:
    skip("Python's websocket (python3-websocket) is not installed")


class Navigated(RuntimeError):
    """The page went away while a script ran in it."""


class Browser:
    """Opens one page. `problems` has every error of its console and every exception."""

    def __init__(self, url, width=1280, height=800, dark=False):
        program = shutil.which("chromium") or skip("chromium is not installed")
        self.folder = tempfile.mkdtemp()
        self.process = subprocess.Popen(
            [program, "--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-angle=swiftshader",
             "--enable-unsafe-swiftshader", "--remote-debugging-port=0", "--remote-allow-origins=*",
             f"--user-data-dir={self.folder}", f"--window-size={width},{height}", "about:blank"],
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.problems, self.number = [], 0
        self.socket = websocket.create_connection(self.page_address(), timeout=PATIENCE_S)
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self.set_theme("dark" if dark else "light")
        self.call("Page.navigate", url=url)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def page_address(self):
        file, end = os.path.join(self.folder, "DevToolsActivePort"), time.time() + PATIENCE_S
        while time.time() < end:
            try:
                with open(file, encoding="ascii") as lines:
                    port = int(lines.readline())
                with urllib.request.urlopen(f"http://127.0.0.1:{port}/json/list", timeout=10) as answer:
                    pages = [each for each in json.load(answer) if each["type"] == "page"]
                if pages:
                    return pages[0]["webSocketDebuggerUrl"]
            except (OSError, ValueError):
                pass
            time.sleep(0.05)
        return skip("chromium does not start here")

    def call(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self.socket.recv())
            if message.get("id") == self.number:
                if "error" in message:
                    has_left = "navigated" in message["error"].get("message", "")
                    raise (Navigated if has_left else RuntimeError)(f"{method}: {message['error']}")
                return message["result"]
            self.note(message)

    def note(self, message):
        parameters = message.get("params", {})
        if message.get("method") == "Runtime.exceptionThrown":
            self.problems.append(json.dumps(parameters["exceptionDetails"])[:2000])
        if message.get("method") == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.problems.append(parameters["entry"]["text"])
        if message.get("method") == "Runtime.consoleAPICalled" and parameters["type"] in ("error", "assert"):
            self.problems.append(json.dumps(parameters["args"])[:2000])

    def run(self, script):
        result = self.call("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(json.dumps(result["exceptionDetails"])[:2000])
        return result["result"].get("value")

    def wait_for(self, script, what):
        end = time.time() + PATIENCE_S
        while time.time() < end:
            try:
                value = self.run(script)
            except Navigated:
                value = None
            if value:
                return value
            time.sleep(0.05)
        raise RuntimeError(f"{what}: not within {PATIENCE_S} s; {self.problems}")

    def press(self, key, code=0):
        for kind in ("keyDown", "keyUp"):
            self.call("Input.dispatchKeyEvent", type=kind, key=key, windowsVirtualKeyCode=code)

    def mouse(self, kind, x, y, buttons=1):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left" if buttons else "none", buttons=buttons,
                  clickCount=1)

    def click(self, x, y):
        for kind in ("mousePressed", "mouseReleased"):
            self.mouse(kind, x, y)

    def drag(self, start, end, steps=4):
        self.mouse("mouseMoved", *start, buttons=0)
        self.mouse("mousePressed", *start)
        for i in range(1, steps + 1):
            self.mouse("mouseMoved", *(a + (b - a) * i / steps for a, b in zip(start, end)))
        self.mouse("mouseReleased", *end)

    def area(self, selector):
        """Left, top, width and height of an element, which is scrolled to where it is seen."""
        self.wait_for(f"!!document.querySelector({json.dumps(selector)})", selector)
        return self.run("((found) => { found.scrollIntoView({block: 'nearest'}); const {x, y, width, height} ="
                        f" found.getBoundingClientRect(); return [x, y, width, height]; }})(document.querySelector({json.dumps(selector)}))")

    def click_on(self, selector):
        x, y, width, height = self.area(selector)
        self.click(x + width / 2, y + height / 2)

    def set_theme(self, theme):
        self.call("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": theme}])

    def screenshot(self):
        """The bytes of a PNG."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])
