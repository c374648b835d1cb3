"""A server of another user at another port gets no secret of the page: browse_neighbour.py SIMVIS_RUN FOLDER_WITH_SCENE_XML.

Ends with 1 and says what is wrong; ends with 77 and the reason where there is no browser.
"""
import json
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import parse_qs, urlparse

from browser import Browser
from live_host import LiveHost

HAS_FRAME = "!!document.documentElement?.dataset.frame && document.getElementById('state')?.textContent === 'connected'"

# What a page of the neighbour can do to the address, with the cookies of the browser.
ATTACK = """
(async () => {
  const address = %s, results = {};
  results.cookie = document.cookie;
  results.fetched = await fetch(address, {credentials: "include"}).then((answer) => answer.text(), () => "");
  results.connected = await new Promise((done) => {
    const socket = new WebSocket(address.replace("http", "ws") + "live", "simvis.live.v1");
    socket.onopen = () => done(true);
    socket.onerror = () => done(false);
  });
  results.ran = await new Promise((done) => {
    const script = Object.assign(document.createElement("script"), {src: address + "main.js"});
    script.onload = () => done(true);
    script.onerror = () => done(false);
    document.head.append(script);
  });
  return results;
})()
"""


class Neighbour:
    """An HTTP server that keeps the text of all requests."""

    def __init__(self):
        requests = self.requests = []

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self):
                requests.append(f"{self.requestline}\n{self.headers}")
                body = f"<!doctype html><link rel=icon href='data:,'><title>neighbour {self.path}</title>".encode()
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_):
                pass

        self.server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()


def follow_link(browser, address, title):
    browser.run(f"(() => {{ const link = document.createElement('a'); link.href = {json.dumps(address)};"
                "document.body.append(link); link.click(); })()")
    browser.wait_for(f"document.readyState === 'complete' && document.title === '{title}'", f"the page of {address}")


def addresses_of_history(browser):
    entries = browser.call("Page.getNavigationHistory")["entries"]
    return [text for entry in entries for text in (entry["url"], entry["userTypedURL"])]


def main():
    program, folder = sys.argv[1], Path(sys.argv[2])
    neighbour, wrong = Neighbour(), []

    def expect(condition, what):
        if not condition:
            wrong.append(what)

    with LiveHost(program, folder / "scene.xml", "--real-time", "1") as host:
        token = parse_qs(urlparse(host.url).query)["token"][0]
        # The printed link stands on a page of another site.
        with Browser(f"http://localhost:{neighbour.port}/links") as browser:
            browser.wait_for("document.readyState === 'complete' && document.title === 'neighbour /links'", "the page with the link")
            follow_link(browser, host.url + "#by=intensity", "SimVis")
            browser.wait_for(HAS_FRAME, "the page behind the printed link")
            page = browser.run("location.href")
            folder_of_page = urlparse(page).path.strip("/")
            expect(token not in page, "the address has the token no longer")
            expect(not any(token in each for each in addresses_of_history(browser)), "nor does the history")
            expect("by=intensity" in urlparse(page).fragment, f"the fragment of the link is kept, not {page}")
            cookies = browser.call("Network.getCookies", urls=[page])["cookies"]
            expect(len(cookies) == 1 and cookies[0]["httpOnly"] and cookies[0]["sameSite"] == "Strict",
                   f"there is one cookie, not {cookies}")
            browser.wait_for("document.readyState === 'complete'", "the whole page")
            browser.run("delete document.documentElement.dataset.frame")
            browser.call("Page.reload")
            browser.wait_for(HAS_FRAME, "the page after it was loaded again")
            expect(browser.problems == [], f"{browser.problems}")

            for path in ("/", "/live", "/index.html", "/scene.glb"):
                follow_link(browser, f"http://127.0.0.1:{neighbour.port}{path}", f"neighbour {path}")
            root = f"http://127.0.0.1:{host.port}/"
            found = browser.run(ATTACK % json.dumps(root))
            expect(found == {"cookie": "", "fetched": "", "connected": False, "ran": False}, f"{found} of the root")
            secrets = [token, folder_of_page, *(each["value"] for each in cookies)]
            expect(len(set(secrets)) == 3 and min(map(len, secrets)) == 32, f"the secrets are three, not {secrets}")
            expect(len(neighbour.requests) >= 5, f"{len(neighbour.requests)} requests have come")
            for request in neighbour.requests:
                expect(not any(each and each in request for each in secrets), f"the neighbour has a secret: {request}")
            # Even a neighbour that has the page's folder may use nothing of it.
            found = browser.run(ATTACK % json.dumps(root + folder_of_page + "/"))
            expect(found == {"cookie": "", "fetched": "", "connected": False, "ran": False}, f"{found} of the page")
    print("\n".join(wrong))
    sys.exit(1 if wrong else 0)


main()
