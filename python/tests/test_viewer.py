"""The live page of a simulation that a program steps."""
import base64
import json
import os
import re
import socket
import time
import unittest
import urllib.error
import urllib.request
from typing import Any

import simvis
from small_scene import load

PATIENCE_S = 60.0


def status(url: str) -> int:
    try:
        with urllib.request.urlopen(url, timeout=PATIENCE_S) as answer:
            return int(answer.status)
    except urllib.error.HTTPError as error:
        return error.code


class Page:
    """A client of the page's protocol, as far as it asks for something."""

    def __init__(self, url: str) -> None:
        found = re.fullmatch(r"http://([\d.]+):(\d+)(/\?token=.*)", url)
        assert found is not None
        self.socket = socket.create_connection((found[1], int(found[2])), timeout=PATIENCE_S)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall(f"GET {found[3]} HTTP/1.1\r\nHost: {found[1]}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                            f"Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n"
                            "Sec-WebSocket-Protocol: simvis.live.v1\r\n\r\n".encode())
        answer = b""
        while b"\r\n\r\n" not in answer:
            answer += self.socket.recv(4096)
        assert b"101" in answer.split(b"\r\n")[0], answer

    def ask(self, **message: Any) -> None:
        data, mask = json.dumps(message).encode(), os.urandom(4)
        assert len(data) < 126
        masked = bytes(byte ^ mask[i % 4] for i, byte in enumerate(data))
        self.socket.sendall(bytes([0x81, 0x80 | len(data)]) + mask + masked)


class Viewers(unittest.TestCase):
    def until(self, happened: Any, work: Any) -> None:
        end = time.monotonic() + PATIENCE_S
        while not happened():
            self.assertLess(time.monotonic(), end)
            work()

    def test_the_page_opens_with_its_token_alone(self) -> None:
        sim = load()
        viewer = simvis.viewer(sim)
        self.assertIn(viewer.url, repr(viewer))
        self.assertIn(f'<a href="{viewer.url}"', viewer._repr_html_())
        self.assertEqual(status(viewer.url), 200)
        self.assertEqual(status(viewer.url.split("?")[0]), 403)
        sim.step()
        viewer.update()
        viewer.close()
        with self.assertRaises(urllib.error.URLError):
            status(viewer.url)
        with self.assertRaisesRegex(simvis.InputError, "this viewer is closed"):
            viewer.update()
        sim.step()

    def test_what_the_page_asks_for_takes_effect_before_the_next_frame(self) -> None:
        sim: Any = load()
        viewer = simvis.viewer(sim)
        page = Page(viewer.url)
        self.addCleanup(page.socket.close)
        page.ask(op="set", parameter=list(sim.parameters).index("P.x"), value=0.25)
        self.until(lambda: sim["P"].x == 0.25, sim.step)
        page.ask(op="execute", xml='<remove name="BALL"/>')
        self.until(lambda: "BALL" not in repr(sim), viewer.update)
        sim.step_async()
        sim.finish()

    def test_a_simulation_ends_with_its_page_open(self) -> None:
        sim = load()
        first, second = simvis.viewer(sim), simvis.viewer(sim)
        with self.assertRaises(urllib.error.URLError):
            status(first.url)
        self.addCleanup(Page(second.url).socket.close)
        sim.step()
        sim.close()
        with self.assertRaises(urllib.error.URLError):
            status(second.url)


if __name__ == "__main__":
    unittest.main()
