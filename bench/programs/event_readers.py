"""expelliarmus and faery: events of a camera that turns in front of bars, written as EVT 3.0, beside the same as arrays.

packages: expelliarmus==1.1.12 faery==0.7.1 numpy==2.4.6
"""
import time

import expelliarmus
import faery
import numpy as np

import bars
import trial


def table(events, names):
    return np.column_stack([np.asarray(events[name]).astype(np.int64) for name in names])


def measure(folder):
    (folder / "turn.csv").write_text("time_s,TURN.yaw\n0,0\n0.2,4\n")
    out = trial.simvis_run(bars.scene(), folder, "--trajectory", folder / "turn.csv", "--rate", 10, "--format", "scan=evt3,npz")
    begin, total, faery_wrong, expelliarmus_wrong, late_us = time.monotonic(), 0, 0, 0, 0
    for file in sorted(out.glob("EYE/*.raw")):
        true = table(np.load(file.with_suffix(".npz")), ("t_us", "x", "y", "polarity"))
        if len(true) == 0:
            continue  # expelliarmus returns None
        one = table(np.concatenate(list(faery.events_stream_from_file(file))), ("t", "x", "y", "on"))
        other = table(expelliarmus.Wizard(encoding="evt3").read(str(file)), ("t", "x", "y", "p"))
        faery_wrong += (one != true).any(1).sum()
        expelliarmus_wrong += (other[:, 1:] != true[:, 1:]).any(1).sum()
        late_us = max(late_us, (other[:, 0] - true[:, 0]).max())
        total += len(true)
    seconds = time.monotonic() - begin
    return [("events", total, "", seconds), ("that differ by faery", faery_wrong, "", seconds),
            ("with another pixel or polarity by expelliarmus", expelliarmus_wrong, "", seconds),
            ("time by expelliarmus, largest difference", late_us, "us", seconds)]


trial.main(measure)
