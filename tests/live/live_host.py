"""A running simvis-run --live, which is killed at the end."""
import re
import subprocess
import tempfile
import time
import urllib.parse

PATIENCE_S = 90


class LiveHost:
    def __init__(self, program, scene, *options, port=0):
        self.output = tempfile.TemporaryFile("w+")
        self.process = subprocess.Popen([program, "--live", str(port), str(scene), *options], stdout=self.output,
                                        stderr=subprocess.STDOUT)
        self.url = self.wait_for_text(r"live view: (http://127\.0\.0\.1:\d+/\?token=\w+)\n")
        self.port = urllib.parse.urlparse(self.url).port

    def wait_for_text(self, pattern):
        end = time.time() + PATIENCE_S
        while time.time() < end and self.process.poll() is None:
            self.output.seek(0)
            found = re.search(pattern, self.output.read())
            if found:
                return found[1]
            time.sleep(0.02)
        self.output.seek(0)
        raise RuntimeError(f"simvis-run --live has not printed {pattern}: {self.output.read()}")

    def runs(self):
        return self.process.poll() is None

    def kill(self):
        self.process.kill()
        self.process.wait()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.kill()
