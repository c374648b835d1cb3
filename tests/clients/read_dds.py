"""Receives a scan and the fixed transforms by DDS with the package cyclonedds of PyPI, as the interface definitions of
ROS 2 describe them, and prints their fields, floating-point numbers in hexadecimal.

usage: read_dds.py DOMAIN SENSOR
"""
import sys
import time
from dataclasses import dataclass

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.types import float32, float64, int32, sequence, uint32
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: int32
    nanosec: uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class LaserScan(IdlStruct, typename="sensor_msgs::msg::dds_::LaserScan_"):
    header: Header
    angle_min: float32
    angle_max: float32
    angle_increment: float32
    time_increment: float32
    scan_time: float32
    range_min: float32
    range_max: float32
    ranges: sequence[float32]
    intensities: sequence[float32]


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: float64
    y: float64
    z: float64


@dataclass
class Quaternion(IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    x: float64
    y: float64
    z: float64
    w: float64


@dataclass
class Transform(IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    translation: Vector3
    rotation: Quaternion


@dataclass
class TransformStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    header: Header
    child_frame_id: str
    transform: Transform


@dataclass
class TFMessage(IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    transforms: sequence[TransformStamped]


def one(reader, patience_s=60):
    end = time.monotonic() + patience_s
    while time.monotonic() < end:
        for message in reader.take(1):
            if not hasattr(message, "key"):  # no message, but the end of a writer
                return message
        time.sleep(0.002)
    raise SystemExit("nothing came")


def main():
    participant = DomainParticipant(int(sys.argv[1]))
    scans = DataReader(participant, Topic(participant, f"rt/{sys.argv[2]}/scan", LaserScan), Qos(Policy.Reliability.BestEffort))
    latched = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal)
    fixed = DataReader(participant, Topic(participant, "rt/tf_static", TFMessage), latched)
    scan = one(scans)
    print(scan.header.frame_id)
    print(*(float(x).hex() for x in (scan.angle_min, scan.angle_max)))
    print(len(scan.ranges), *(float(x).hex() for x in scan.ranges))
    print(*(f"{each.header.frame_id}>{each.child_frame_id}" for each in one(fixed).transforms))


main()
