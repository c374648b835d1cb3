"""Reads and writes a running SimVis simulation from Python. Needs the standard library and NumPy only.

    import simvis_client
    sim = simvis_client.connect("demo", client="driver", timeout_s=5)
    sim["R_POSE"].set(x=1.0, yaw=90)            # as a whole: no frame sees a part of it
    sim["R_POSE"]["x"] = 1.1                    # one number: one store to memory
    while sim.wait_frame():
        scan = sim.latest("FRONT_SCANNER")
        print(scan.frame, scan["range_m"].min())

Units are those of the elements' tables: metres, degrees. Every call is one of libsimvis-client, which needs the C library
alone: that of SIMVIS_CLIENT_LIBRARY, beside this file, of the package simvis, of the installation, the build tree or the
checkout that has this file, or of the system's folders. A library that another user can change is left out.
"""
import ctypes
import os
import stat
import time
from pathlib import Path

import numpy as np

CHANGE, REQUEST_DONE, REQUEST_REFUSED, VALUE_REFUSED, CLIENT_REFUSED = 1, 2, 3, 4, 5
_NUMBER_TYPES = {1: np.float32, 2: np.float64, 3: np.uint8, 4: np.uint32, 5: np.int32}
_WAIT_MS = 100  # between two looks for signals of the interpreter

_u64, _u32, _i64, _f64, _int = ctypes.c_uint64, ctypes.c_uint32, ctypes.c_int64, ctypes.c_double, ctypes.c_int
_pointer, _bytes = ctypes.c_void_p, ctypes.c_char_p


class _Text(ctypes.Structure):
    _fields_ = [("offset", _u64), ("size", _u64)]


class _Element(ctypes.Structure):
    _fields_ = [("name", _Text), ("type", _Text), ("insertion_point", _Text), ("first_parameter", _u64),
                ("parameter_count", _u32), ("removed", _u32)]


class _Parameter(ctypes.Structure):
    _fields_ = [("name", _Text), ("unit", _Text), ("min", _f64), ("max", _f64), ("element", _u64), ("flags", _u32),
                ("reserved", _u32)]


class _LogEntry(ctypes.Structure):
    _fields_ = [("size", _u32), ("kind", _u32), ("request", _u64), ("client", _u32), ("text_size", _u32), ("frame", _u64)]


class _Output(ctypes.Structure):
    _fields_ = [("offset", _u64), ("name_offset", _u32), ("name_size", _u32), ("unit_offset", _u32), ("unit_size", _u32),
                ("rows", _u32), ("columns", _u32), ("channels", _u32), ("type", _u32)]


class _Slot(ctypes.Structure):
    _fields_ = [("sequence", _u64), ("measurement", _u64), ("frame", _u64), ("time_ns", _i64),
                ("world_from_sensor", _f64 * 16), ("output_count", _u32), ("reserved", _u32)]


class _Sensor(ctypes.Structure):
    _fields_ = [("name", _Text), ("type", _Text), ("slots_offset", _u64), ("slot_size", _u64), ("slot_count", _u32),
                ("removed", _u32), ("measurement", _u64)]


class _View(ctypes.Structure):
    _fields_ = [("slot", ctypes.POINTER(_Slot)), ("sequence", _u64), ("slot_size", _u64)]


_SIGNATURES = {  # of <simvis_client/client.h>: the result, then what follows the client
    "disconnect": (None,), "alive": (_int,), "find_element": (_i64, _bytes), "find_sensor": (_i64, _bytes),
    "element_count": (_u64,), "parameter_count": (_u64,), "sensor_count": (_u64,),
    "element_at": (ctypes.POINTER(_Element), _i64), "parameter_at": (ctypes.POINTER(_Parameter), _i64),
    "sensor_at": (ctypes.POINTER(_Sensor), _i64), "text_at": (_pointer, _Text), "get": (_f64, _i64), "set": (_int, _i64, _f64),
    "set_element": (_int, _i64, ctypes.POINTER(_f64), ctypes.c_size_t),
    "applied": (_i64, _u64, ctypes.POINTER(_f64), ctypes.c_size_t), "send": (_u64, _bytes),
    "next_log": (ctypes.POINTER(_LogEntry), ctypes.POINTER(_u64), ctypes.POINTER(_pointer)),
    "latest": (_int, _i64, ctypes.POINTER(_View)), "frame": (_u64,), "time_ns": (_i64,), "wait_frame": (_int, _u64, _int),
    "ready": (_int,),
}


def _can_change(path, trusted):
    """Whether others than the trusted users can change a file or folder. In one such as /tmp each changes what is its own."""
    status = os.stat(path)
    is_open = status.st_mode & stat.S_IWOTH and not (stat.S_ISDIR(status.st_mode) and status.st_mode & stat.S_ISVTX)
    return bool(is_open) or status.st_uid not in trusted


def _load():
    """The library, from the places that the text at the top lists."""
    here, real = Path(__file__).absolute(), Path(__file__).resolve()
    own = {here, *here.parents, real, *real.parents}  # who can change these runs code here anyway
    trusted = {0, os.geteuid(), *(os.stat(each).st_uid for each in own)}
    folders = [here.parent / each for each in (".", "simvis/lib", "../lib", "../../../lib", "../../build/release/lib")]
    found = []
    for file in (file for each in folders for file in sorted(each.resolve().glob("libsimvis-client.so*"))):
        real = file.resolve()
        if not any(_can_change(each, trusted) for each in {*file.parents, real, *real.parents} - own):
            found.append(os.fspath(file))
    library = ctypes.CDLL([*filter(None, [os.environ.get("SIMVIS_CLIENT_LIBRARY")]), *found, "libsimvis-client.so.0.1"][0])
    for name, (result, *arguments) in _SIGNATURES.items():
        function = getattr(library, f"simvis_{name}")
        function.restype, function.argtypes = result, [_pointer, *arguments]
    library.simvis_connect.restype, library.simvis_connect.argtypes = _pointer, [_bytes, _bytes, _int]
    library.simvis_client_error.restype, library.simvis_client_error.argtypes = _bytes, []
    library.simvis_view_is_whole.argtypes = [ctypes.POINTER(_View)]
    return library


_library = _load()
_functions = {name: getattr(_library, f"simvis_{name}") for name in _SIGNATURES}


class SimvisError(RuntimeError):
    """The simulation is not there, or not any more; or a call asked for what there is not."""


class MissingHost(SimvisError):
    """No simulation is served under the name, or its host has ended: one may come later."""


def _error():
    return SimvisError(_library.simvis_client_error().decode(errors="replace"))


class Measurement:
    """A copy of one measurement: measurement["range_m"] and its kind are NumPy arrays (rows, columns[, channels])."""

    def __init__(self, number, frame, time_s, world_from_sensor, outputs, units):
        self.number, self.frame, self.time_s = number, frame, time_s
        self.world_from_sensor = world_from_sensor  # 4 x 4; x forward, y left, z up, metres
        self.outputs = outputs
        self.units = units  # by name: "m", "rad/s"; empty: none

    def __getitem__(self, name):
        return self.outputs[name]

    def keys(self):
        return self.outputs.keys()


def _measurement(slot, data):
    outputs, units = {}, {}
    for output in (_Output * slot.output_count).from_buffer_copy(data, ctypes.sizeof(_Slot)):
        name = data[output.name_offset:output.name_offset + output.name_size].decode()
        shape = (output.rows, output.columns) + ((output.channels,) if output.channels > 1 else ())
        array = np.frombuffer(data, _NUMBER_TYPES[output.type], int(np.prod(shape)), output.offset)
        outputs[name] = array.reshape(shape)
        units[name] = data[output.unit_offset:output.unit_offset + output.unit_size].decode()
    pose = np.array(slot.world_from_sensor).reshape(4, 4).T
    return Measurement(slot.measurement, slot.frame, slot.time_ns / 1e9, pose, outputs, units)


class Element:
    """An element of the scene; a mapping from its parameters' names to their values."""

    def __init__(self, connection, index):
        self._connection, self.id = connection, index
        entry = connection._entry("element", index)
        self.name, self.type = connection._text(entry.name), connection._text(entry.type)
        self.insertion_point = connection._text(entry.insertion_point)
        self._first = entry.first_parameter
        self._names = [connection._text(connection._entry("parameter", self._first + i).name) for i in range(entry.parameter_count)]

    def keys(self):
        return list(self._names)

    def __iter__(self):
        return iter(self._names)

    def _ipython_key_completions_(self):
        return self._names

    def _index(self, name):
        try:
            return self._first + self._names.index(name)
        except ValueError:
            raise SimvisError(f'element "{self.name}" has no parameter "{name}", expected one of: '
                              f'{", ".join(self._names)}') from None

    def __getitem__(self, name):
        return self._connection._call("get", self._index(name))

    def __setitem__(self, name, value):
        self._connection._checked("set", self._index(name), value)

    def limits(self, name):
        """(min, max, unit) of a parameter."""
        row = self._connection._entry("parameter", self._index(name))
        return row.min, row.max, self._connection._text(row.unit)

    def set(self, **values):
        """Sets several parameters at once; the others keep their values. Raises if the host has ended."""
        self._connection._require_host()
        whole = [self[name] for name in self._names]
        for name, value in values.items():
            whole[self._index(name) - self._first] = value
        self._connection._checked("set_element", self.id, (_f64 * len(whole))(*whole), len(whole))


class Connection:
    """A connection to a running simulation. One thread at a time."""

    def __init__(self, name, client):
        self._name, self._own_name = name, client
        self._client = _library.simvis_connect(name.encode(), client.encode(), 0)
        if self._client is None:
            raise MissingHost(str(_error())) if _library.simvis_is_missing() else _error()

    def _call(self, function, *arguments):
        if self._client is None:
            raise SimvisError("the connection is closed")
        return _functions[function](self._client, *arguments)

    def _checked(self, function, *arguments):
        result = self._call(function, *arguments)
        if result < 0:
            raise _error()
        return result

    def close(self):
        """Ends the connection; also at the end of a with statement. A second call does nothing; others then raise."""
        if self._client is not None:
            _library.simvis_disconnect(self._client)
        self._client = None

    def reconnect(self, timeout_s=None):
        """Connects to the host that has the name now, after the present one has ended. Elements of before are then
        invalid, and positions in the log begin at 0. If there is none in time, the connection stays as it was."""
        following = connect(self._name, self._own_name, float("inf") if timeout_s is None else timeout_s)
        self.close()
        self._client = following._client

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def alive(self):
        """Whether the host lives."""
        return self._client is not None and bool(self._call("alive"))

    def _require_host(self):
        if not self.alive():
            raise MissingHost(f'the host of "{self._name}" has ended')

    def _entry(self, kind, index):
        entry = self._call(f"{kind}_at", index)
        if not entry:
            raise SimvisError(f"there is no {kind} of id {index}")
        return entry.contents

    def _text(self, text):
        start = self._call("text_at", text)
        if start is None:
            raise SimvisError("the memory of the simulation is damaged")
        return ctypes.string_at(start, text.size).decode()

    def _names(self, kind):
        entries = [self._entry(kind, index) for index in range(self._call(f"{kind}_count"))]
        return [self._text(entry.name) for entry in entries if not entry.removed]

    def elements(self):
        """The names of all elements."""
        return self._names("element")

    def sensors(self):
        """The names of all sensors."""
        return self._names("sensor")

    def __iter__(self):
        return iter(self.elements())

    def _ipython_key_completions_(self):
        return self.elements()

    def __getitem__(self, name):
        return Element(self, self._checked("find_element", name.encode()))

    def applied(self):
        """(frames, values of all parameters by id) of the last finished frame, all of one frame."""
        values = (_f64 * self._call("parameter_count"))()
        frame = self._checked("applied", 0, values, len(values))
        return frame, np.frombuffer(values)

    def send(self, xml):
        """Appends a change request; returns its number, which the log names."""
        if "\0" in xml:
            raise SimvisError("the request has a NUL, expected XML")
        number = self._call("send", xml.encode())
        if number == 0:
            raise _error()
        return number

    def log(self, position=0):
        """Entries from a position on: ([(kind, request, frame, text), ...], next position)."""
        entries, at, text = [], _u64(position), _pointer()
        while entry := self._call("next_log", ctypes.byref(at), ctypes.byref(text)):
            row = entry.contents
            entries.append((row.kind, row.request, row.frame, ctypes.string_at(text, row.text_size).decode()))
        return entries, at.value

    def latest(self, sensor):
        """The latest measurement of a sensor, copied; None before the first."""
        index, view = self._checked("find_sensor", sensor.encode()), _View()
        for _ in range(1000):
            if self._call("latest", index, ctypes.byref(view)) != 0:
                if self._entry("sensor", index).measurement == 0:
                    return None
                raise _error()
            # One copy at once: nothing is interpreted before it is known to be whole.
            copy = bytearray(view.slot_size)
            ctypes.memmove((ctypes.c_char * len(copy)).from_buffer(copy), view.slot, len(copy))
            if _library.simvis_view_is_whole(ctypes.byref(view)):
                try:
                    return _measurement(_Slot.from_buffer_copy(copy), copy)
                except (KeyError, ValueError, OverflowError):
                    raise SimvisError("the memory of the simulation is damaged") from None
        raise SimvisError("the host writes faster than this program reads")

    @property
    def frame(self):
        """The number of frames that the host has finished."""
        return self._call("frame")

    @property
    def time_s(self):
        """The simulated time of the last finished frame."""
        return self._call("time_ns") / 1e9

    def wait_frame(self, frames=None, timeout_s=None):
        """Waits until more than `frames` (default: the present number) frames are finished. False: the host is gone, or
        the time is over."""
        frames = self.frame if frames is None else frames
        end = None if timeout_s is None else time.monotonic() + timeout_s
        while True:
            rest_ms = _WAIT_MS if end is None else min(_WAIT_MS, max(0, round(1000 * (end - time.monotonic()))))
            if found := self._call("wait_frame", frames, rest_ms):
                return found > 0
            if end is not None and time.monotonic() >= end:
                return False

    def ready(self):
        """Lock-step: the host may make the frame that it makes next."""
        self._call("ready")


def connect(name, client="python", timeout_s=0.0):
    """Connects to the simulation that is served as `name`, and waits for it up to `timeout_s`. Other errors than
    MissingHost are raised at once."""
    end = time.monotonic() + timeout_s
    while True:
        try:
            return Connection(name, client)
        except MissingHost:
            if time.monotonic() >= end:
                raise
            time.sleep(0.02)
