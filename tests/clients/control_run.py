"""Controls a run by the services of simulation_interfaces, as clients of rmw_cyclonedds do: with the package cyclonedds of
PyPI and types that are written down here from the definitions of simulation_interfaces 2.1.0.

usage: control_run.py DOMAIN NODE [step | read | reset FRAMES | drive | record]
"""
import os
import random
import signal
import sys
import time
import types
from dataclasses import dataclass, field

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float64, int32, int64, sequence, uint8, uint16, uint32, uint64
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

MESSAGES = "simulation_interfaces::msg::dds_::"
SERVICES = "simulation_interfaces::srv::dds_::"


@dataclass
class Result(IdlStruct, typename=MESSAGES + "Result_"):
    result: uint8 = 0
    error_message: str = ""


@dataclass
class State(IdlStruct, typename=MESSAGES + "SimulationState_"):
    state: uint8 = 0


@dataclass
class Features(IdlStruct, typename=MESSAGES + "SimulatorFeatures_"):
    features: sequence[uint16] = field(default_factory=list)
    spawn_formats: sequence[str] = field(default_factory=list)
    custom_info: str = ""


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32 = 0
    nanosec: uint32 = 0


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64 = 0.0
    y: float64 = 0.0
    z: float64 = 0.0
    w: float64 = 1.0


@dataclass
class Pose(IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    position: Vector3 = field(default_factory=Vector3)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass
class PoseStamped(IdlStruct, typename="geometry_msgs::msg::dds_::PoseStamped_"):
    header: Header = field(default_factory=Header)
    pose: Pose = field(default_factory=Pose)


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass
class EntityState(IdlStruct, typename=MESSAGES + "EntityState_"):
    header: Header = field(default_factory=Header)
    pose: Pose = field(default_factory=Pose)
    twist: Twist = field(default_factory=Twist)
    acceleration: Twist = field(default_factory=Twist)


@dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str = ""


@dataclass
class Resource(IdlStruct, typename=MESSAGES + "Resource_"):
    uri: str = ""
    resource_string: str = ""


@dataclass
class Category(IdlStruct, typename=MESSAGES + "EntityCategory_"):
    category: uint8 = 0


@dataclass
class Tags(IdlStruct, typename=MESSAGES + "TagsFilter_"):
    tags: sequence[str] = field(default_factory=list)
    filter_mode: uint8 = 0


@dataclass
class Bounds(IdlStruct, typename=MESSAGES + "Bounds_"):
    type: uint8 = 0
    points: sequence[Vector3] = field(default_factory=list)


@dataclass
class Filters(IdlStruct, typename=MESSAGES + "EntityFilters_"):
    filter: str = ""
    categories: sequence[Category] = field(default_factory=list)
    tags: Tags = field(default_factory=Tags)
    bounds: Bounds = field(default_factory=Bounds)


@dataclass
class Spawn(IdlStruct, typename=MESSAGES + "SpawnEntity_"):
    name: str = ""
    allow_renaming: bool = False
    entity_resource: Resource = field(default_factory=Resource)
    entity_namespace: str = ""
    initial_pose: PoseStamped = field(default_factory=PoseStamped)


@dataclass
class Spawned(IdlStruct, typename=MESSAGES + "SpawnResult_"):
    result: Result = field(default_factory=Result)
    entity_name: str = ""


def service(name, request, reply):
    """Makes the types of a request and of its reply. Both begin with the header of rmw_cyclonedds."""

    def message(suffix, fields):
        fields = fields or {"structure_needs_at_least_one_member": uint8}
        annotations = {"guid": uint64, "sequence_number": int64} | fields
        made = types.new_class(name + suffix, (IdlStruct,), {"typename": f"{SERVICES}{name}{suffix}_"},
                               lambda body: body.update(__annotations__=annotations))
        return dataclass(made)

    return message("_Request", request), message("_Response", reply)


SPAWN = {"name": str, "allow_renaming": bool, "entity_resource": Resource, "entity_namespace": str,
         "initial_pose": PoseStamped}
TYPES = {
    "get_simulator_features": service("GetSimulatorFeatures", {}, {"features": Features}),
    "get_entities": service("GetEntities", {"filters": Filters}, {"result": Result, "entities": sequence[str]}),
    "get_entity_state": service("GetEntityState", {"entity": str}, {"result": Result, "state": EntityState}),
    "get_entities_states": service("GetEntitiesStates", {"filters": Filters},
                                   {"result": Result, "entities": sequence[str], "states": sequence[EntityState]}),
    "set_entity_state": service("SetEntityState", {"entity": str, "state": EntityState, "set_pose": bool,
                                                   "set_twist": bool, "set_acceleration": bool}, {"result": Result}),
    "spawn_entity": service("SpawnEntity", SPAWN, {"result": Result, "entity_name": str}),
    "spawn_entities": service("SpawnEntities", {"spawn_requests": sequence[Spawn]},
                              {"result": Result, "results": sequence[Spawned]}),
    "delete_entity": service("DeleteEntity", {"entity": str}, {"result": Result}),
    "get_simulation_state": service("GetSimulationState", {}, {"state": State, "result": Result}),
    "set_simulation_state": service("SetSimulationState", {"state": State}, {"result": Result}),
    "step_simulation": service("StepSimulation", {"steps": uint64}, {"result": Result}),
    "reset_simulation": service("ResetSimulation", {"scope": uint8}, {"result": Result}),
}
UNSUPPORTED, OK, FAILED = 0, 1, 4
STOPPED, PLAYING, PAUSED, QUITTING = range(4)


class Client:
    def __init__(self, domain, node):
        self.participant = DomainParticipant(domain)
        self.guid = random.getrandbits(63)
        self.node, self.sequence, self.ends = node, 0, {}
        self.qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(10),
                       Policy.DataRepresentation(use_cdrv0_representation=True))

    def connect(self, name, patience_s=60):
        if name in self.ends:
            return
        request, reply = (Topic(self.participant, f"{prefix}{self.node}/{name}{suffix}", type_)
                          for prefix, suffix, type_ in zip(("rq", "rr"), ("Request", "Reply"), TYPES[name]))
        writer = DataWriter(self.participant, request, self.qos)
        reader = DataReader(self.participant, reply, self.qos)
        self.ends[name] = writer, reader
        end = time.monotonic() + patience_s
        while not (writer.get_matched_subscriptions() and reader.get_matched_publications()):
            if time.monotonic() > end:
                raise SystemExit(f"there is no service {name}")
            time.sleep(0.01)
        time.sleep(0.2)  # until the other side has found both ends too

    def send(self, name, *fields):
        self.connect(name)
        self.sequence += 1
        if not fields:
            fields = (0,)  # of a request without fields
        self.ends[name][0].write(TYPES[name][0](self.guid, self.sequence, *fields))
        return self.sequence

    def receive(self, name, sequence_number, patience_s=60):
        end = time.monotonic() + patience_s
        while time.monotonic() < end:
            for reply in self.ends[name][1].take(10):
                if getattr(reply, "guid", None) == self.guid and reply.sequence_number == sequence_number:
                    return reply
            time.sleep(0.005)
        raise SystemExit(f"{name} was not answered")

    def call(self, name, *fields):
        return self.receive(name, self.send(name, *fields))


def check(result, expected):
    if result.result != expected:
        raise SystemExit(f"expected result {expected}, found {result}")


def at(x, y, z):
    return Pose(position=Vector3(float(x), float(y), float(z)))


def time_s(client):
    stamp = client.call("get_entity_state", "CART").state.header.stamp
    return stamp.sec + stamp.nanosec / 1e9


def entities(client):
    return client.call("get_entities", Filters()).entities


def outcome_of(client, request):
    """Sends a change request until its outcome comes, since the log is not sent before it has readers."""
    writer = DataWriter(client.participant, Topic(client.participant, f"rt{client.node}/request", String), client.qos)
    best_effort = Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(100))
    reader = DataReader(client.participant, Topic(client.participant, f"rt{client.node}/log", String), best_effort)
    end = time.monotonic() + 60
    while time.monotonic() < end:
        writer.write(String(request))
        time.sleep(0.2)
        for said in reader.take(100):
            if hasattr(said, "data"):
                return said.data
    raise SystemExit("there was no text on the log")


def read(domain, node):
    """Without the permission to change something."""
    client = Client(domain, node)
    assert entities(client) == ["CART"]
    assert client.call("get_entity_state", "CART").state.pose.position.x == 4
    check(client.call("delete_entity", "CART").result, UNSUPPORTED)
    check(client.call("reset_simulation", 0).result, UNSUPPORTED)
    check(client.call("set_simulation_state", State(PAUSED)).result, UNSUPPORTED)
    assert entities(client) == ["CART"]
    print("the run was read")


def reset(domain, node, frames):
    """Of a run of 10 frames each second, at real time, that ends by itself."""
    client = Client(domain, node)
    for name in ("get_entity_state", "reset_simulation", "set_simulation_state", "step_simulation"):
        client.connect(name)
    while time_s(client) < 3:
        time.sleep(0.05)
    start = time.monotonic()
    check(client.call("reset_simulation", 0).result, OK)
    while time_s(client) < 2:
        time.sleep(0.02)
    # The frame at 2 s begins 2 s after that at 0 s, which comes after the request.
    assert time.monotonic() - start > 1.9, "the run was faster than the wall clock"
    check(client.call("set_simulation_state", State(PAUSED)).result, OK)
    made = round(time_s(client) * 10) + 1  # the first frame is at 0 s
    result = client.call("step_simulation", 1_000_000).result
    check(result, FAILED)
    assert result.error_message.startswith(f"{frames - made} of 1000000 steps were made"), result
    client.send("set_simulation_state", State(QUITTING))  # too late: the run is whole
    print("the run was reset")


def drive(domain, node, resets):
    """Of a run of 10 frames each second whose trajectory moves CART from x = 4 m on at 0.1 m/s."""
    client = Client(domain, node)

    def cart():
        return client.call("get_entity_state", "CART").state.pose.position.x

    def step(count, time_before_s):
        check(client.call("step_simulation", count).result, OK)
        now_s = time_s(client)
        assert round((now_s - time_before_s) * 10) == count, (now_s, time_before_s)
        assert abs(cart() - (4 + 0.1 * now_s)) < 1e-12, (cart(), now_s)
        return now_s

    check(client.call("set_simulation_state", State(PAUSED)).result, OK)
    now_s = time_s(client)
    assert abs(cart() - (4 + 0.1 * now_s)) < 1e-12, (cart(), now_s)  # of the last frame, not of the next one
    features = client.call("get_simulator_features").features.features
    assert (20 in features) == resets and 23 in features, features
    now_s = step(3, now_s)
    for name, request in ("reset_simulation", 0), ("set_simulation_state", State(STOPPED)):
        check(client.call(name, request).result, OK if resets else UNSUPPORTED)
        if not resets:
            assert time_s(client) == now_s
            continue
        assert (time_s(client), cart()) == (0, 4)
        check(client.call("step_simulation", 1).result, OK)
        assert (time_s(client), cart()) == (0, 4)  # the first frame is at 0 s
        now_s = step(2, 0)
    check(client.call("spawn_entity", "CHAIR", False, Resource("chair.urdf"), "", PoseStamped(pose=at(2, 0, 0))).result, OK)
    now_s = step(2, now_s)
    check(client.call("delete_entity", "CHAIR").result, OK)
    now_s = step(1, now_s)
    check(client.call("set_entity_state", "CART", EntityState(pose=at(1, 0, 0)), True, False, False).result, OK)
    assert abs(cart() - 1) < 1e-12, cart()
    now_s = step(1, now_s)
    check(client.call("reset_simulation", 4).result, OK)
    check(client.call("delete_entity", "CART").result, OK)
    check(client.call("step_simulation", 1).result, OK)
    assert entities(client) == []
    time.sleep(0.3)  # longer than a frame: a run that ends while it is paused is not late
    check(client.call("set_simulation_state", State(QUITTING)).result, OK)
    print("the run was driven")


def main(domain, node):
    client, other = Client(domain, node), Client(domain, node)
    features = client.call("get_simulator_features").features.features
    assert sorted(features) == [0, 1, 10, 11, 20, 23, 24, 25, 26, 31, 32, 50], features
    assert client.call("get_simulation_state").state.state == PLAYING

    # A paused run stands still and answers.
    check(client.call("set_simulation_state", State(PAUSED)).result, OK)
    before = time_s(client)
    time.sleep(0.3)
    assert time_s(client) == before
    check(client.call("step_simulation", 5).result, OK)
    assert round((time_s(client) - before) * 100) == 5  # frames of 10 ms
    assert outcome_of(client, "<nonsense/>")

    # Two clients at once: one steps, the other one is refused, and reads and changes meanwhile.
    number = client.send("step_simulation", 1_000_000)
    while other.call("get_simulation_state").state.state != PLAYING:
        pass
    check(other.call("step_simulation", 1).result, FAILED)
    check(other.call("spawn_entity", "CHAIR", False, Resource("chair.urdf"), "", PoseStamped(pose=at(2, 0, 0))).result, OK)
    check(other.call("set_entity_state", "CART", EntityState(pose=at(1, 2, 3)), True, False, False).result, OK)
    check(other.call("set_simulation_state", State(PAUSED)).result, OK)
    check(client.receive("step_simulation", number).result, FAILED)
    position = client.call("get_entity_state", "CART").state.pose.position
    assert max(abs(position.x - 1), abs(position.y - 2), abs(position.z - 3)) < 1e-12, position
    spawn = Spawn("CHAIR", True, Resource("chair.urdf"))
    spawned = client.call("spawn_entities", [spawn, spawn])
    check(spawned.result, OK)
    assert [each.entity_name for each in spawned.results] == ["CHAIR_2", "CHAIR_3"]
    assert entities(client) == ["CART", "CHAIR", "CHAIR_2", "CHAIR_3"]
    check(client.call("delete_entity", "CHAIR_2").result, OK)

    # A client that is killed while its steps are made ends nothing.
    child = os.fork()
    if child == 0:
        os.execv(sys.executable, [sys.executable, __file__, str(domain), node, "step"])
    while other.call("get_simulation_state").state.state != PLAYING:
        pass
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    check(client.call("set_simulation_state", State(PAUSED)).result, OK)

    check(client.call("reset_simulation", 0).result, OK)
    assert entities(client) == ["CART"]
    assert client.call("get_entity_state", "CART").state.pose.position.x == 4
    assert time_s(client) == 0
    check(client.call("step_simulation", 3).result, OK)
    assert round(time_s(client) * 100) == 2  # the first frame is at 0 s
    check(client.call("set_simulation_state", State(STOPPED)).result, OK)
    assert client.call("get_simulation_state").state.state == STOPPED
    check(client.call("set_simulation_state", State(PLAYING)).result, OK)
    states = client.call("get_entities_states", Filters())
    assert states.entities == ["CART"] and states.states[0].header.frame_id == "map"
    check(client.call("set_simulation_state", State(QUITTING)).result, OK)
    print("the run was controlled")


if sys.argv[3:] == ["step"]:
    Client(int(sys.argv[1]), sys.argv[2]).call("step_simulation", 1_000_000)
if sys.argv[3:] == ["read"]:
    read(int(sys.argv[1]), sys.argv[2])
elif sys.argv[3:] in (["drive"], ["record"]):
    drive(int(sys.argv[1]), sys.argv[2], resets=sys.argv[3] == "drive")
elif sys.argv[3:4] == ["reset"]:
    reset(int(sys.argv[1]), sys.argv[2], int(sys.argv[4]))
else:
    main(int(sys.argv[1]), sys.argv[2])
