"""Reads and writes a running SimVis simulation from Python. Needs the standard library and NumPy only.

    import simvis_client
    sim = simvis_client.connect("demo", client="driver", timeout_s=5)
    sim["R_POSE"].set(x=1.0, yaw=90)            # as a whole: no frame sees a part of it
    sim["R_POSE"]["x"] = 1.1                    # one number: one store to memory
    while sim.wait_frame():
        scan = sim.latest("FRONT_SCANNER")
        print(scan.frame, scan["range_m"].min())

Units are those of the elements' tables: metres, degrees. The layout of the memory is that of
<simvis_client/shared_memory.h>, and so are its rules. Stores are single ones for the processor; on processors that
reorder stores (ARM) a lock of the standard library stands between those whose order matters.
"""
import ctypes
import fcntl
import math
import mmap
import os
import re
import socket
import stat
import struct
import threading
import time

import numpy as np

MAGIC, VERSION = 0x314D4D48534D5653, 2
CLIENTS, GROUPS, GROUP_VALUES, REQUEST_BYTES = 32, 512, 16, 131072
CHANGE, REQUEST_DONE, REQUEST_REFUSED, VALUE_REFUSED, CLIENT_REFUSED = 1, 2, 3, 4, 5
_RUNNING, _LOCK_BYTE = 1, 0
_ANSWER_S = 5  # a host that answers later is an error
_NUMBER_TYPES = {1: np.float32, 2: np.float64, 3: np.uint8, 4: np.uint32, 5: np.int32}

_u64, _u32, _i64, _f64 = ctypes.c_uint64, ctypes.c_uint32, ctypes.c_int64, ctypes.c_double


class _Text(ctypes.Structure):
    _fields_ = [("offset", _u64), ("size", _u64)]


class _Region(ctypes.Structure):
    _fields_ = [("offset", _u64), ("stride", _u64), ("capacity", _u64), ("count", _u64)]


class _Header(ctypes.Structure):
    _fields_ = ([("magic", _u64), ("version", _u32), ("header_size", _u32), ("generation", _u64), ("host_pid", _i64),
                 ("total_size", _u64), ("clients_offset", _u64)] +
                [(name, _Region) for name in ("elements", "parameters", "values", "applied", "strings", "log", "sensors",
                                              "outputs")] +
                [("ready_futex", _u32), ("reserved32", _u32), ("reserved", _u64 * 7), ("frame_sequence", _u64),
                 ("frame", _u64), ("next_frame", _u64), ("time_ns", _i64), ("frame_futex", _u32), ("state", _u32),
                 ("frame_padding", _u64 * 3)])


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


class _Group(ctypes.Structure):
    _fields_ = [("sequence", _u64), ("element", _u64), ("values", _f64 * GROUP_VALUES)]


class _ClientArea(ctypes.Structure):
    _fields_ = [("connection", _u64), ("name", ctypes.c_char * 64), ("ready_frames", _u64), ("request_head", _u64),
                ("group_count", _u64), ("padding_of_client", _u64 * 19), ("acknowledged", _u64), ("request_tail", _u64),
                ("padding_of_host", _u64 * 14), ("groups", _Group * GROUPS), ("requests", ctypes.c_uint8 * REQUEST_BYTES)]


class SimvisError(RuntimeError):
    """The simulation is not there, or not any more; or a call asked for what there is not."""


class MissingHost(SimvisError):
    """No simulation is served under the name, or its host has ended: one may come later."""


_barrier_lock = threading.Lock()


def _barrier():
    with _barrier_lock:
        pass


def _flock(kind, start):
    return struct.pack("hhqqi4x", kind, os.SEEK_SET, start, 1, 0)


def _lock(file, byte):
    try:
        fcntl.fcntl(file, fcntl.F_OFD_SETLK, _flock(fcntl.F_WRLCK, byte))
        return True
    except OSError:
        return False


def _unlock(file, byte):
    fcntl.fcntl(file, fcntl.F_OFD_SETLK, _flock(fcntl.F_UNLCK, byte))


def _is_locked(file, byte):
    return struct.unpack("hhqqi4x", fcntl.fcntl(file, fcntl.F_OFD_GETLK, _flock(fcntl.F_WRLCK, byte)))[0] != fcntl.F_UNLCK


def _receive_object(name):
    """A file descriptor of the host's memory. Anyone may take a name first, so strangers are refused."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as host:
        host.settimeout(_ANSWER_S)
        try:
            host.connect(f"\0simvis-{name}")
            pid, user, group = struct.unpack("iII", host.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))
            own = os.geteuid()
            if user != own and (own == 0 or group != os.getegid()):
                raise SimvisError(f'"{name}" is served by process {pid} of another user ({user}), expected '
                                  + ("one of root" if own == 0 else "one of this program's user or effective group"))
            files = socket.recv_fds(host, 1, 1, socket.MSG_CMSG_CLOEXEC)[1]
        except ConnectionRefusedError:
            raise MissingHost(f'no simulation is served as "{name}"') from None
        except OSError as error:
            raise SimvisError(f'"{name}": its host does not answer: {error}') from None
    if not files:
        raise SimvisError(f'"{name}" is served to another user or group')
    return files[0]


def _check_object(name, file):
    """The size of the object, which no process can make shorter, and which for root, only root can have written."""
    status = os.fstat(file)
    try:
        is_fixed = fcntl.fcntl(file, fcntl.F_GET_SEALS) & fcntl.F_SEAL_SHRINK
    except OSError:
        is_fixed = False
    if not is_fixed or status.st_size < ctypes.sizeof(_Header):
        raise SimvisError(f'"{name}" is no simulation')
    if os.geteuid() == 0 and status.st_mode & (stat.S_IRWXG | stat.S_IRWXO):
        raise SimvisError(f'"{name}" is served to a group, expected for root one that root alone can write')
    return status.st_size


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
        entry = connection._element(index)
        self.name, self.type = connection._text(entry.name), connection._text(entry.type)
        self.insertion_point = connection._text(entry.insertion_point)
        self._first = entry.first_parameter
        self._names = [connection._text(connection._parameter(self._first + i).name) for i in range(entry.parameter_count)]

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
        return float(self._connection._values[self._index(name)])

    def __setitem__(self, name, value):
        self._connection._values[self._index(name)] = value

    def limits(self, name):
        """(min, max, unit) of a parameter."""
        row = self._connection._parameter(self._index(name))
        return row.min, row.max, self._connection._text(row.unit)

    def set(self, **values):
        """Sets several parameters at once; the others keep their values. Raises if the host has ended."""
        self._connection._require_host()
        whole = [self[name] for name in self._names]
        for name, value in values.items():
            whole[self._index(name) - self._first] = value
        self._connection._set_group(self.id, whole)


class Connection:
    """A connection to a running simulation. One thread at a time."""

    def __init__(self, name, client):
        for each in name, client:
            if not re.fullmatch(r"[A-Za-z0-9._-]{1,63}", each):
                raise SimvisError(f'"{each}": expected 1 to 63 of A-Z a-z 0-9 . _ -')
        self._name, self._own_name = name, client
        self._groups, self._requests = {}, 0
        self._file = _receive_object(name)
        try:
            self._map(name)
            self._take_area(client)
        except BaseException:
            os.close(self._file)
            raise

    def _map(self, name):
        size = _check_object(name, self._file)
        self._memory = mmap.mmap(self._file, size)
        self._header = _Header.from_buffer(self._memory)
        header = self._header
        if header.magic != MAGIC or header.version != VERSION or header.total_size != size:
            raise SimvisError(f'"{name}" has another layout than this client reads')
        self._check_regions(name, size)
        self._require_host()
        self._values = np.frombuffer(self._memory, np.float64, header.values.capacity, header.values.offset)
        self._applied = np.frombuffer(self._memory, np.float64, header.applied.capacity, header.applied.offset)

    def _check_regions(self, name, size):
        header = self._header
        rows = {"elements": _Element, "parameters": _Parameter, "values": _f64, "applied": _f64,
                "strings": ctypes.c_uint8, "log": ctypes.c_uint8, "sensors": _Sensor}
        regions = [(getattr(header, region), ctypes.sizeof(row)) for region, row in rows.items()]
        fits = all(region.stride == stride and region.offset % 8 == 0 and
                   region.offset + region.capacity * stride <= size for region, stride in regions)
        if not fits or header.clients_offset % 8 or header.clients_offset + CLIENTS * ctypes.sizeof(_ClientArea) > size:
            raise SimvisError(f'"{name}" is no simulation')

    def _take_area(self, client):
        for i in range(2 * CLIENTS):
            offset = self._header.clients_offset + i % CLIENTS * ctypes.sizeof(_ClientArea)
            area = _ClientArea.from_buffer(self._memory, offset)
            # The first round leaves areas alone that the host has not read to their end.
            taken = area.connection in (0, area.acknowledged) and area.request_head == area.request_tail
            if i < CLIENTS and not taken or not _lock(self._file, offset):
                continue
            area.connection |= 1
            area.group_count = area.ready_frames = area.request_head = 0
            for group in area.groups:
                group.sequence = 0
            area.name = client.encode()
            _barrier()
            area.connection += 1
            self._area, self._area_byte = area, offset
            return
        raise SimvisError(f"{CLIENTS} clients are connected, no more can be")

    def close(self):
        """Ends the connection; also at the end of a with statement. A second call does nothing."""
        if self._file is None:
            return
        self._area.connection |= 1
        _unlock(self._file, self._area_byte)  # the mapping, which goes with the last array, holds the file open
        os.close(self._file)
        self._file = None

    def reconnect(self, timeout_s=None):
        """Connects to the host that has the name now, after the present one has ended. Elements of before are then
        invalid, and positions in the log begin at 0. If there is none in time, the connection stays as it was."""
        following = connect(self._name, self._own_name, math.inf if timeout_s is None else timeout_s)
        self.close()
        self.__dict__ = following.__dict__

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def alive(self):
        """Whether the host lives."""
        return self._file is not None and self._header.state == _RUNNING and _is_locked(self._file, _LOCK_BYTE)

    def _require_host(self):
        if not self.alive():
            raise MissingHost(f'the host of "{self._name}" has ended')

    def _entry(self, kind, region, index):
        if not 0 <= index < min(region.count, region.capacity):
            raise SimvisError(f"there is no {kind.__name__[1:].lower()} of id {index}")
        return kind.from_buffer(self._memory, region.offset + index * region.stride)

    def _element(self, index):
        return self._entry(_Element, self._header.elements, index)

    def _parameter(self, index):
        return self._entry(_Parameter, self._header.parameters, index)

    def _sensor(self, index):
        return self._entry(_Sensor, self._header.sensors, index)

    def _text(self, text):
        strings = self._header.strings
        if text.offset + text.size > min(strings.count, strings.capacity):
            raise SimvisError("the memory of the simulation is damaged")
        start = strings.offset + text.offset
        return bytes(self._memory[start:start + text.size]).decode()

    def elements(self):
        """The names of all elements."""
        return [self._text(e.name) for e in map(self._element, range(self._header.elements.count)) if not e.removed]

    def sensors(self):
        """The names of all sensors."""
        return [self._text(s.name) for s in map(self._sensor, range(self._header.sensors.count)) if not s.removed]

    def __iter__(self):
        return iter(self.elements())

    def _ipython_key_completions_(self):
        return self.elements()

    def __getitem__(self, name):
        for index in reversed(range(self._header.elements.count)):
            entry = self._element(index)
            if not entry.removed and self._text(entry.name) == name:
                return Element(self, index)
        raise SimvisError(f'there is no element "{name}"')

    def _set_group(self, element, values):
        if len(values) > GROUP_VALUES:
            raise SimvisError(f"an element with more than {GROUP_VALUES} parameters can't be written as a whole")
        number = self._groups.setdefault(element, len(self._groups))
        if number >= GROUPS:
            del self._groups[element]
            raise SimvisError(f"a client writes at most {GROUPS} elements as a whole")
        group = self._area.groups[number]
        sequence = group.sequence
        group.sequence = sequence + 1
        _barrier()
        group.element = element
        group.values[:len(values)] = values
        _barrier()
        group.sequence = sequence + 2
        self._area.group_count = len(self._groups)

    def applied(self):
        """(frames, values of all parameters by id) of the last finished frame, all of one frame."""
        for _ in range(1000):
            sequence = self._header.frame_sequence
            _barrier()
            if sequence % 2 == 0:
                frame, values = self._header.frame, self._applied[:self._header.applied.count].copy()
                _barrier()
                if self._header.frame_sequence == sequence:
                    return frame, values
            time.sleep(1e-5)
        raise SimvisError("the host was killed while it wrote a frame")

    def send(self, xml):
        """Appends a change request; returns its number, which the log names."""
        text = xml.encode()
        area = self._area
        whole = 16 + (len(text) + 7) // 8 * 8
        taken = area.request_tail if area.acknowledged == area.connection else 0
        if whole > REQUEST_BYTES - (area.request_head - taken):
            raise SimvisError("the request is too long, or the host has not taken the earlier ones yet")
        self._requests += 1
        data = struct.pack("QQ", self._requests, len(text)) + text
        for i, byte in enumerate(data):
            area.requests[(area.request_head + i) % REQUEST_BYTES] = byte
        _barrier()
        area.request_head += whole
        return self._requests

    def log(self, position=0):
        """Entries from a position on: ([(kind, request, frame, text), ...], next position)."""
        entries = []
        count, start = min(self._header.log.count, self._header.log.capacity), self._header.log.offset
        while position < count:
            entry = _LogEntry.from_buffer(self._memory, start + position)
            size, text_size = entry.size, entry.text_size
            if not ctypes.sizeof(_LogEntry) + text_size <= size <= count - position:
                raise SimvisError("the memory of the simulation is damaged")
            text_start = start + position + ctypes.sizeof(_LogEntry)
            text = bytes(self._memory[text_start:text_start + text_size]).decode()
            entries.append((entry.kind, entry.request, entry.frame, text))
            position += size
        return entries, position

    def latest(self, sensor):
        """The latest measurement of a sensor, copied; None before the first."""
        for index in reversed(range(self._header.sensors.count)):
            entry = self._sensor(index)
            if not entry.removed and self._text(entry.name) == sensor:
                return self._read(entry)
        raise SimvisError(f'there is no sensor "{sensor}"')

    def _read(self, sensor):
        for _ in range(1000):
            number, slots = sensor.measurement, sensor.slot_count
            if number == 0 or slots == 0:
                return None
            size = sensor.slot_size
            start = sensor.slots_offset + (number - 1) % slots * size
            if size < ctypes.sizeof(_Slot) or start + size > len(self._memory):
                continue  # the slots are being moved
            shared = _Slot.from_buffer(self._memory, start)
            sequence = shared.sequence
            _barrier()
            if sequence % 2 == 1:
                continue
            # One copy at once: nothing is interpreted before it is known to be whole.
            copy = bytearray(memoryview(self._memory)[start:start + size])
            _barrier()
            if shared.sequence == sequence and (slot := _Slot.from_buffer(copy)).measurement == number:
                try:
                    return _measurement(slot, copy)
                except (KeyError, ValueError, OverflowError):
                    raise SimvisError("the memory of the simulation is damaged") from None
        raise SimvisError("the host writes faster than this program reads")

    @property
    def frame(self):
        """The number of frames that the host has finished."""
        return self._header.frame

    @property
    def time_s(self):
        """The simulated time of the last finished frame."""
        return self._header.time_ns / 1e9

    def wait_frame(self, frames=None, timeout_s=None):
        """Waits until more than `frames` (default: the present number) frames are finished. False: the host is gone, or
        the time is over."""
        frames = self.frame if frames is None else frames
        end = None if timeout_s is None else time.monotonic() + timeout_s
        while self.frame <= frames:
            if not self.alive() or end is not None and time.monotonic() >= end:
                return False
            time.sleep(2e-4)
        return True

    def ready(self):
        """Lock-step: the host may make the frame that it makes next."""
        self._area.ready_frames = self._header.next_frame + 1


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
